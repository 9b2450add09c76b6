//! Exploded views of the pieces from two sides, with their numbers. Nearer pieces hide those behind, pixel by pixel (z-buffer).

use std::sync::Arc;

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};

use super::flat::Piece;
use scaleproof_core::geometry::{Point2, view_axes};
use scaleproof_print::paint::disc;
use scaleproof_print::sheet::{Mark, RectMm, WHITE};
use scaleproof_surface::zbuffer::ZBuffer;

/// Directions of the two views: azimuth from the front, elevation.
const VIEWS_DEG: [(f64, f64); 2] = [(40.0, 32.0), (220.0, 32.0)];
/// Displacement of pieces: as a share of their distance from the middle, and along their normal as a share of the model's length.
const APART: f64 = 0.28;
const OUTWARDS: f64 = 0.06;
const PIXELS_PER_MM: f64 = 10.0;
/// Maximum number of pixels of both views together.
const MOST_PIXELS: f64 = 4e7;
/// Maximum scale of the views relative to the model.
const MOST_SCALE: f64 = 1.0;
const NUMBER_MM: f64 = 3.2;
const LEAST_NUMBER_MM: f64 = 1.7;
/// Area of the views used to find pieces that are visible in neither.
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

/// Returns the colour of a piece at a point of one of its triangles: piece, triangle, barycentric coordinates.
pub type Colours<'a> = &'a dyn Fn(usize, usize, [f64; 3]) -> [u8; 3];

/// Draws both views one above the other, or side by side in a wide area. Without colours each piece has a tint.
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
            // A number is drawn where it is legible, and at least in the better view.
            if spot.room_mm > 0.0
                && (spot.room_mm >= 1.2 || spot.room_mm > beside || (spot.room_mm == beside && view == 0))
            {
                let size_mm = (1.5 * spot.room_mm).clamp(LEAST_NUMBER_MM, NUMBER_MM);
                let at = spot.at_mm;
                // White below a number, so that it is legible on any colour.
                let below = colours.map(|_| Mark::Area {
                    outlines: vec![disc(at, 0.8 * size_mm)],
                    colour: WHITE,
                });
                marks.extend(below);
                marks.push(Mark::centred(at, (size_mm, f64::INFINITY), (i + 1).to_string()));
            }
        }
    }
    marks
}

/// Returns the indices of the pieces that no view shows.
pub fn unseen(pieces: &[Piece]) -> Vec<usize> {
    let drawn = drawn(pieces, None, PROBE);
    let shown = |i: usize| drawn.iter().flatten().any(|view| view.spots[i].room_mm > 0.0);
    (0..pieces.len()).filter(|i| !shown(*i)).collect()
}

fn drawn(pieces: &[Piece], colours: Option<Colours>, room: RectMm) -> [Option<View>; 2] {
    let [mut first, mut second] = [room; 2];
    if room.width_mm() > 1.6 * room.height_mm() {
        let x = 0.5 * (room.left_mm + room.right_mm);
        (first.right_mm, second.left_mm) = (x - 1.0, x + 1.0);
    } else {
        let y = 0.5 * (room.bottom_mm + room.top_mm);
        (first.bottom_mm, second.top_mm) = (y + 1.0, y - 1.0);
    }
    let view = |direction, room| View::new((pieces, colours), direction, room);
    [view(VIEWS_DEG[0], first), view(VIEWS_DEG[1], second)]
}

/// Position of a number and the free room around it; 0 if the piece is not visible.
#[derive(Debug, Clone, Copy, Default)]
struct NumberSpot {
    at_mm: Point2,
    room_mm: f64,
}

/// Piece at a pixel, and its colour there.
#[derive(Debug, Clone, Copy)]
struct Pixel {
    /// Twice the index of the piece, plus 1 for its back.
    id: u32,
    rgb: [u8; 3],
}

struct View {
    area: RectMm,
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
    spots: Vec<NumberSpot>,
}

impl View {
    fn new(
        (pieces, colours): (&[Piece], Option<Colours>),
        (azimuth, elevation): (f64, f64),
        room: RectMm,
    ) -> Option<Self> {
        let axes = view_axes(azimuth, elevation);
        let [right, up, towards] = axes;
        let light = (0.5 * up - 0.4 * right + 0.7 * towards).normalize();
        let project = |p: &Point3<f64>| axes.map(|axis| axis.dot(&p.coords));
        let moves = moves(pieces);
        let moved = pieces.iter().zip(&moves);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in moved.flat_map(|(piece, by)| piece.corners.iter().flatten().map(move |p| p + by)) {
            let [x, y, _] = project(&p);
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
        }
        let (wide, tall) = (high[0] - low[0], high[1] - low[1]);
        let scale = (room.width_mm() / wide).min(room.height_mm() / tall).min(MOST_SCALE);
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let (width_mm, height_mm) = (scale * wide, scale * tall);
        let density = PIXELS_PER_MM.min((0.5 * MOST_PIXELS / (width_mm * height_mm)).sqrt());
        let [width, height] = [width_mm, height_mm].map(|mm| (density * mm).ceil() as usize + 1);
        let left = room.left_mm + 0.5 * (room.width_mm() - width_mm);
        let top = room.top_mm - 0.5 * (room.height_mm() - height_mm);
        let pixel_mm = 1.0 / density;
        let (right, bottom) = (left + width as f64 * pixel_mm, top - height as f64 * pixel_mm);
        let mut nearest = ZBuffer::new(0..width as i64, 0..height as i64, 0.5);
        let to_pixel = |p: Point3<f64>| {
            let [x, y, out] = project(&p);
            [(x - low[0]) * scale * density, (high[1] - y) * scale * density, out]
        };
        for (i, (piece, by)) in pieces.iter().zip(&moves).enumerate() {
            for (t, corners) in piece.corners.iter().enumerate() {
                let normal = scaleproof_surface::mesh::doubled_area(corners).normalize();
                let is_back = normal.dot(&towards) < 0.0;
                let shade = (0.72 + 0.28 * normal.dot(&light).abs()) as f32;
                let colour = |shares| match colours {
                    _ if is_back => BACK,
                    Some(colours) => colours(i, t, shares),
                    None => TINTS[i % TINTS.len()],
                };
                let corners = corners.map(|p| to_pixel(p + by));
                let [a, b, c] = corners.map(|[.., out]| out);
                let id = 2 * i as u32 + u32::from(is_back);
                nearest.draw(
                    corners.map(|[x, y, _]| [x, y]),
                    |[s, t, u]| -(s * a + t * b + u * c),
                    |shares| Pixel {
                        id,
                        rgb: colour(shares).map(|v| (f32::from(v) * shade) as u8),
                    },
                );
            }
        }
        let nothing = Pixel {
            id: NOTHING,
            rgb: [255; 3],
        };
        let shown = nearest
            .pixels()
            .iter()
            .map(|pixel| pixel.map_or(nothing, |nearest| nearest.item));
        let mut view = Self {
            area: RectMm::new(left, bottom, right, top),
            width,
            height,
            pixels: shown.collect(),
            spots: vec![NumberSpot::default(); pieces.len()],
        };
        view.find_spots(pixel_mm);
        Some(view)
    }

    /// Finds, for each piece, the pixel of its front that is farthest from anything else.
    fn find_spots(&mut self, pixel_mm: f64) {
        let distance = self.to_others();
        let ids = self.pixels.iter().map(|pixel| pixel.id).enumerate();
        for (at, id) in ids.filter(|(_, id)| *id != NOTHING && id % 2 == 0) {
            let room_mm = f64::from(distance[at]) / 3.0 * pixel_mm;
            let spot = &mut self.spots[id as usize / 2];
            if room_mm > spot.room_mm {
                let (column, row) = ((at % self.width) as f64, (at / self.width) as f64);
                *spot = NumberSpot {
                    at_mm: [
                        self.area.left_mm + (column + 0.5) * pixel_mm,
                        self.area.top_mm - (row + 0.5) * pixel_mm,
                    ],
                    room_mm,
                };
            }
        }
    }

    /// Returns thrice the distance in pixels to the nearest pixel that shows something else (chamfer distance: Borgefors 1986).
    fn to_others(&self) -> Vec<u32> {
        let (width, height) = (self.width as i64, self.height as i64);
        let mut distance = vec![u32::MAX / 2; self.pixels.len()];
        let index = |column: i64, row: i64| {
            let inside = (0..width).contains(&column) && (0..height).contains(&row);
            inside.then_some((row * width + column) as usize)
        };
        let mut relax = |column: i64, row: i64, steps: [(i64, i64); 4]| {
            let at = (row * width + column) as usize;
            for (dx, dy) in steps {
                let cost = if dx != 0 && dy != 0 { 4 } else { 3 };
                distance[at] = distance[at].min(match index(column + dx, row + dy) {
                    Some(other) if self.pixels[other].id == self.pixels[at].id => distance[other] + cost,
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
            let is_inside = column < self.width && row < self.height;
            is_inside.then(|| self.pixels[row * self.width + column].id)
        };
        RgbImage::from_fn(self.width as u32, self.height as u32, |column, row| {
            let (column, row) = (column as usize, row as usize);
            let here = self.pixels[row * self.width + column];
            let beside = [(column + 1, row), (column, row + 1), (column + 1, row + 1)];
            let is_edge = |(column, row)| shown(column, row).unwrap_or(NOTHING) != here.id;
            Rgb(if beside.into_iter().any(is_edge) {
                EDGE
            } else {
                here.rgb
            })
        })
    }
}

fn moves(pieces: &[Piece]) -> Vec<Vector3<f64>> {
    let mut corners = pieces.iter().flat_map(|piece| piece.corners.iter().flatten());
    let Some(first) = corners.next() else { return Vec::new() };
    let (low, high) = corners.fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
    let middle = nalgebra::center(&low, &high);
    let length = (high - low).norm();
    let one = |piece: &Piece| APART * (piece.middle - middle) + OUTWARDS * length * piece.normal;
    pieces.iter().map(one).collect()
}
