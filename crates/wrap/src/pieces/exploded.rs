//! The pieces moved apart, from two sides, with their numbers. What is nearer hides what is behind it, pixel by pixel.

use std::sync::Arc;

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};

use super::flat::Piece;
use scaleproof_plot::lettering::CAP_HEIGHT;
use scaleproof_print::print::sheet::{Mark, PointMm, RectMm, TextAnchor, WHITE};

/// From where the two views look: azimuth from the front, elevation.
const VIEWS_DEG: [(f64, f64); 2] = [(40.0, 32.0), (220.0, 32.0)];
/// How far pieces move: as a share of their way from the middle, and along their normal as a share of the model's length.
const APART: f64 = 0.28;
const OUTWARDS: f64 = 0.06;
const PIXELS_PER_MM: f64 = 10.0;
/// The pixels of both views together may be no more.
const MOST_PIXELS: f64 = 4e7;
/// The view is drawn no larger than the model.
const MOST_SCALE: f64 = 1.0;
const NUMBER_MM: f64 = 3.2;
const LEAST_NUMBER_MM: f64 = 1.7;
/// Views used to find out what is seen in neither.
const PROBE: RectMm = RectMm {
    left_mm: 0.0,
    bottom_mm: 0.0,
    right_mm: 150.0,
    top_mm: 200.0,
};
const TINTS: [[u8; 3]; 6] = [
    [198, 219, 239],
    [253, 224, 190],
    [206, 231, 201],
    [240, 209, 221],
    [222, 214, 236],
    [240, 236, 190],
];
const BACK: [u8; 3] = [226, 226, 226];
const EDGE: [u8; 3] = [70, 70, 70];
const NOTHING: u32 = u32::MAX;

/// The colour of a piece at a place of one of its triangles: piece, triangle, shares of its corners.
pub type Colours<'a> = &'a dyn Fn(usize, usize, [f64; 3]) -> [u8; 3];

/// Both views one above the other, or side by side where the room is wide. Without colours each piece has a tint.
pub fn views(pieces: &[Piece], colours: Option<Colours>, room: RectMm) -> Vec<Mark> {
    let drawn = drawn(pieces, colours, room);
    let mut marks = Vec::new();
    for (view, other) in [(0, 1), (1, 0)] {
        let Some(this) = &drawn[view] else { continue };
        marks.push(Mark::Image {
            image: Arc::new(this.image()),
            area: this.area,
        });
        for i in 0..pieces.len() {
            let beside = drawn[other].as_ref().map_or(0.0, |view| view.spots[i].room_mm);
            let spot = this.spots[i];
            // A number stands where it is read well, and at least in the better view.
            if spot.room_mm > 0.0
                && (spot.room_mm >= 1.2 || spot.room_mm > beside || (spot.room_mm == beside && view == 0))
            {
                let size_mm = (1.5 * spot.room_mm).clamp(LEAST_NUMBER_MM, NUMBER_MM);
                if colours.is_some() {
                    marks.push(disc(spot, 0.8 * size_mm));
                }
                let at = (spot.x_mm, spot.y_mm - 0.5 * CAP_HEIGHT * size_mm);
                marks.push(Mark::text(at, size_mm, TextAnchor::Centre, (i + 1).to_string()));
            }
        }
    }
    marks
}

/// White below a number, so that it is read on any colour.
fn disc(spot: NumberSpot, radius_mm: f64) -> Mark {
    const CORNERS: u32 = 24;
    let corner = |i: u32| {
        let (s, c) = (f64::from(i) * std::f64::consts::TAU / f64::from(CORNERS)).sin_cos();
        PointMm::new(spot.x_mm + radius_mm * c, spot.y_mm + radius_mm * s)
    };
    Mark::Area {
        outlines: vec![(0..CORNERS).map(corner).collect()],
        colour: WHITE,
    }
}

/// The pieces that no view shows, by index.
pub fn unseen(pieces: &[Piece]) -> Vec<usize> {
    let drawn = drawn(pieces, None, PROBE);
    let shown = |i: usize| drawn.iter().flatten().any(|view| view.spots[i].room_mm > 0.0);
    (0..pieces.len()).filter(|i| !shown(*i)).collect()
}

fn drawn(pieces: &[Piece], colours: Option<Colours>, room: RectMm) -> [Option<View>; 2] {
    let beside = room.width_mm() > 1.6 * room.height_mm();
    let (x, y) = (
        0.5 * (room.left_mm + room.right_mm),
        0.5 * (room.bottom_mm + room.top_mm),
    );
    let rooms = if beside {
        [
            RectMm {
                right_mm: x - 1.0,
                ..room
            },
            RectMm {
                left_mm: x + 1.0,
                ..room
            },
        ]
    } else {
        [
            RectMm {
                bottom_mm: y + 1.0,
                ..room
            },
            RectMm {
                top_mm: y - 1.0,
                ..room
            },
        ]
    };
    let view = |i: usize| View::new((pieces, colours), VIEWS_DEG[i], rooms[i]);
    [view(0), view(1)]
}

/// Where a number stands and how much room it has around it; 0 where the piece does not show.
#[derive(Debug, Clone, Copy, Default)]
struct NumberSpot {
    x_mm: f64,
    y_mm: f64,
    room_mm: f64,
}

/// How a triangle is drawn.
struct Look<C> {
    /// Twice the index of its piece, and 1 more for its back.
    id: u32,
    shade: f32,
    colour: Option<C>,
}

/// One view, rendered.
struct View {
    area: RectMm,
    width: usize,
    height: usize,
    /// Of each pixel the piece it shows: twice its index, and 1 more for its back.
    shown: Vec<u32>,
    shade: Vec<f32>,
    /// Where colours were given.
    colour: Vec<[u8; 3]>,
    spots: Vec<NumberSpot>,
}

impl View {
    fn new(
        (pieces, colours): (&[Piece], Option<Colours>),
        (azimuth, elevation): (f64, f64),
        room: RectMm,
    ) -> Option<Self> {
        let frame = ViewFrame::new(azimuth, elevation);
        let moves = moves(pieces);
        let corners = || {
            pieces
                .iter()
                .zip(&moves)
                .flat_map(|(p, by)| p.corners.iter().map(move |c| c.map(|q| q + by)))
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in corners().flatten() {
            let [x, y, _] = frame.project(&p);
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
        }
        let (wide, tall) = (high[0] - low[0], high[1] - low[1]);
        let scale = (room.width_mm() / wide).min(room.height_mm() / tall).min(MOST_SCALE);
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let (width_mm, height_mm) = (scale * wide, scale * tall);
        let density = PIXELS_PER_MM.min((0.5 * MOST_PIXELS / (width_mm * height_mm)).sqrt());
        let (width, height) = (
            (density * width_mm).ceil() as usize + 1,
            (density * height_mm).ceil() as usize + 1,
        );
        let left = room.left_mm + 0.5 * (room.width_mm() - width_mm);
        let top = room.top_mm - 0.5 * (room.height_mm() - height_mm);
        let pixel_mm = 1.0 / density;
        let mut view = Self {
            area: RectMm::new(
                left,
                top - height as f64 * pixel_mm,
                left + width as f64 * pixel_mm,
                top,
            ),
            width,
            height,
            shown: vec![NOTHING; width * height],
            shade: vec![0.0; width * height],
            colour: vec![[255; 3]; if colours.is_some() { width * height } else { 0 }],
            spots: Vec::new(),
        };
        let mut depth = vec![f64::NEG_INFINITY; width * height];
        let to_pixel = |p: &Point3<f64>| {
            let [x, y, out] = frame.project(p);
            [(x - low[0]) * scale * density, (high[1] - y) * scale * density, out]
        };
        for (i, (piece, by)) in pieces.iter().zip(&moves).enumerate() {
            for (t, corners) in piece.corners.iter().enumerate() {
                let normal = scaleproof_surface::mesh::doubled_area(corners).normalize();
                let facing = normal.dot(&frame.towards);
                let id = 2 * i as u32 + u32::from(facing < 0.0);
                let shade = 0.72 + 0.28 * normal.dot(&frame.light).abs();
                let look = Look {
                    id,
                    shade: shade as f32,
                    colour: colours.map(|colours| move |shares| colours(i, t, shares)),
                };
                view.triangle(corners.map(|p| to_pixel(&(p + by))), &look, &mut depth);
            }
        }
        view.find_spots(pieces.len(), pixel_mm);
        Some(view)
    }

    fn triangle(&mut self, [a, b, c]: [[f64; 3]; 3], look: &Look<impl Fn([f64; 3]) -> [u8; 3]>, depth: &mut [f64]) {
        let cross = |o: &[f64], s: &[f64], t: &[f64]| (s[0] - o[0]) * (t[1] - o[1]) - (s[1] - o[1]) * (t[0] - o[0]);
        let whole = cross(&a, &b, &c);
        if whole == 0.0 {
            return;
        }
        let span = |axis: usize, count: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize + 1).min(count)
        };
        for row in span(1, self.height) {
            for column in span(0, self.width) {
                let p = [column as f64 + 0.5, row as f64 + 0.5];
                let [s, t, u] = [cross(&b, &c, &p), cross(&c, &a, &p), cross(&a, &b, &p)].map(|part| part / whole);
                if s < -1e-9 || t < -1e-9 || u < -1e-9 {
                    continue;
                }
                let out = s * a[2] + t * b[2] + u * c[2];
                let at = row * self.width + column;
                if out > depth[at] {
                    depth[at] = out;
                    self.shown[at] = look.id;
                    self.shade[at] = look.shade;
                    if let (Some(colour), Some(pixel)) = (&look.colour, self.colour.get_mut(at)) {
                        *pixel = colour([s, t, u]);
                    }
                }
            }
        }
    }

    /// Of each piece the pixel of its front that is farthest from anything else.
    fn find_spots(&mut self, pieces: usize, pixel_mm: f64) {
        let distance = self.to_others();
        self.spots = vec![NumberSpot::default(); pieces];
        for (at, id) in self
            .shown
            .iter()
            .enumerate()
            .filter(|(_, id)| **id != NOTHING && **id % 2 == 0)
        {
            let room_mm = f64::from(distance[at]) / 3.0 * pixel_mm;
            let spot = &mut self.spots[*id as usize / 2];
            if room_mm > spot.room_mm {
                let (column, row) = ((at % self.width) as f64, (at / self.width) as f64);
                *spot = NumberSpot {
                    x_mm: self.area.left_mm + (column + 0.5) * pixel_mm,
                    y_mm: self.area.top_mm - (row + 0.5) * pixel_mm,
                    room_mm,
                };
            }
        }
    }

    /// Thrice the distance in pixels to the nearest pixel that shows something else (chamfer distance: Borgefors 1986).
    fn to_others(&self) -> Vec<u32> {
        let (width, height) = (self.width as i64, self.height as i64);
        let mut distance = vec![u32::MAX / 2; self.shown.len()];
        let index = |column: i64, row: i64| {
            let inside = (0..width).contains(&column) && (0..height).contains(&row);
            inside.then_some((row * width + column) as usize)
        };
        let mut relax = |column: i64, row: i64, steps: [(i64, i64); 4]| {
            let at = (row * width + column) as usize;
            for (dx, dy) in steps {
                let cost = if dx != 0 && dy != 0 { 4 } else { 3 };
                distance[at] = distance[at].min(match index(column + dx, row + dy) {
                    Some(other) if self.shown[other] == self.shown[at] => distance[other] + cost,
                    _ => cost,
                });
            }
        };
        for row in 0..height {
            for column in 0..width {
                relax(column, row, [(-1, 0), (-1, -1), (0, -1), (1, -1)]);
            }
        }
        for row in (0..height).rev() {
            for column in (0..width).rev() {
                relax(column, row, [(1, 0), (1, 1), (0, 1), (-1, 1)]);
            }
        }
        distance
    }

    fn image(&self) -> RgbImage {
        let shown = |column: usize, row: usize| {
            let inside = column < self.width && row < self.height;
            if inside {
                self.shown[row * self.width + column]
            } else {
                NOTHING
            }
        };
        RgbImage::from_fn(self.width as u32, self.height as u32, |column, row| {
            let (column, row) = (column as usize, row as usize);
            let here = shown(column, row);
            if here != shown(column + 1, row) || here != shown(column, row + 1) || here != shown(column + 1, row + 1) {
                return Rgb(EDGE);
            }
            let tint = match here {
                NOTHING => return Rgb([255; 3]),
                id if id % 2 == 1 => BACK,
                _ if !self.colour.is_empty() => self.colour[row * self.width + column],
                id => TINTS[id as usize / 2 % TINTS.len()],
            };
            let shade = self.shade[row * self.width + column];
            Rgb(tint.map(|v| (f32::from(v) * shade) as u8))
        })
    }
}

/// How far each piece is moved.
fn moves(pieces: &[Piece]) -> Vec<Vector3<f64>> {
    let mut corners = pieces.iter().flat_map(|piece| piece.corners.iter().flatten());
    let Some(first) = corners.next() else { return Vec::new() };
    let (low, high) = corners.fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
    let middle = nalgebra::center(&low, &high);
    let length = (high - low).norm();
    let one = |piece: &Piece| APART * (piece.middle - middle) + OUTWARDS * length * piece.normal;
    pieces.iter().map(one).collect()
}

/// The axes of a view.
struct ViewFrame {
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards: Vector3<f64>,
    light: Vector3<f64>,
}

impl ViewFrame {
    fn new(azimuth_deg: f64, elevation_deg: f64) -> Self {
        let (sa, ca) = azimuth_deg.to_radians().sin_cos();
        let (se, ce) = elevation_deg.to_radians().sin_cos();
        let towards = Vector3::new(ce * ca, ce * sa, se);
        let right = Vector3::new(-sa, ca, 0.0);
        let up = towards.cross(&right);
        Self {
            light: (0.5 * up - 0.4 * right + 0.7 * towards).normalize(),
            right,
            up,
            towards,
        }
    }

    /// Right, up, towards the viewer.
    fn project(&self, p: &Point3<f64>) -> [f64; 3] {
        [self.right, self.up, self.towards].map(|axis| axis.dot(&p.coords))
    }
}
