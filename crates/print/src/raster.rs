//! Rasterisation of a painted surface to pixels of a page: each pixel is the mean linear light over its area, and the colours of the nearest place
//! extend over the cut. For textures of cells, each cell is weighted by its area in the pixel; other textures are sampled.

use image::{Rgb, RgbImage};

use super::buckets::{Buckets, bounds};
use super::polygon::{Affine, area, each_slice, within};
use super::sheet::RectMm;
use super::wrap::Region;
use scaleproof_core::geometry::length::shown;
use scaleproof_core::geometry::{Point2, distance, doubled_area, nearest_share};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::light;
use scaleproof_surface::texture::{SurfacePoint, Texture};

/// Samples of a pixel, per side: few at first, then many if these differ; up to the maximum for fine textures.
const SAMPLES: [usize; 2] = [2, 6];
const MOST_SAMPLES: usize = 12;
/// Side, in pixels, of the blocks tested first: most lie in one triangle and one cell.
const BLOCK: u32 = 16;
/// Maximum number of cells in a pixel that are weighted by area; with more, samples are as good.
const MOST_CELLS: i64 = 4096;
/// Distances from a border into the surface beside it, at which its colour is sampled.
const INTO_MM: [f64; 4] = [0.002, 0.01, 0.05, 0.2];
/// Inset of an image's edges, as a share of a pixel: a PDF's numbers have a precision of 0.35 µm.
const INSET: f64 = 0.01;
const MM_PER_INCH: f64 = 25.4;
/// Maximum number of pixels; more would take gigabytes.
const MOST_PIXELS: f64 = 3e8;
/// Range of accepted resolutions.
const DPI: std::ops::RangeInclusive<f64> = 36.0..=2400.0;

#[derive(Debug, Clone)]
pub struct FlatTriangle {
    pub flat_mm: [Point2; 3],
    /// Height of each corner along the outward direction: of several triangles over a place, the outermost is visible.
    pub height_mm: [f64; 3],
    /// Index of the triangle in the mesh.
    pub triangle: usize,
    /// Barycentric coordinates of each corner in that triangle.
    pub weights: [[f64; 3]; 3],
}

impl FlatTriangle {
    /// Returns true if no other layer lies over or under it.
    fn is_alone(&self) -> bool {
        self.height_mm == [0.0; 3]
    }
}

/// Rotation about the origin, then a translation: from a plane to a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Cosine and sine of the rotation.
    pub turn: [f64; 2],
    pub by: Point2,
}

impl Pose {
    /// Returns a pure translation.
    pub fn moved(by: Point2) -> Self {
        let turn = [1.0, 0.0];
        Self { turn, by }
    }

    pub fn at(&self, [x, y]: Point2) -> Point2 {
        let [c, s] = self.turn;
        [c * x - s * y + self.by[0], s * x + c * y + self.by[1]]
    }

    fn back(&self, [x, y]: Point2) -> Point2 {
        let [c, s] = self.turn;
        let (x, y) = (x - self.by[0], y - self.by[1]);
        [c * x + s * y, c * y - s * x]
    }
}

/// Pixel grid of a page: squares of one size from its top-left corner on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelGrid {
    page_height_mm: f64,
    pixel_mm: f64,
}

impl PixelGrid {
    pub fn new(page_height_mm: f64, dpi: f64) -> Self {
        Self {
            page_height_mm,
            pixel_mm: MM_PER_INCH / dpi,
        }
    }

    /// Returns the range of pixels that touch an area: left, top, right, bottom.
    fn around(&self, area: RectMm) -> [i64; 4] {
        let column = |mm: f64| mm / self.pixel_mm;
        let row = |mm: f64| (self.page_height_mm - mm) / self.pixel_mm;
        [
            column(area.left_mm).floor() as i64,
            row(area.top_mm).floor() as i64,
            column(area.right_mm).ceil() as i64,
            row(area.bottom_mm).ceil() as i64,
        ]
    }

    /// Returns the position on the page of a (fractional) pixel corner.
    fn place(&self, column: f64, row: f64) -> Point2 {
        [column * self.pixel_mm, self.page_height_mm - row * self.pixel_mm]
    }
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RasterError {
    #[error("a resolution of {} dpi cannot be printed; use 36 to 2400 dpi, as in 300", shown(*dpi))]
    Dpi { dpi: f64 },
    #[error("this would take {millions:.0} million pixels, more than {:.0}; use a lower resolution", MOST_PIXELS / 1e6)]
    TooMany { millions: f64 },
}

/// Returns an error for a resolution that no printer has, and for areas that need too many pixels.
pub fn check(dpi: f64, area_mm2: f64) -> Result<(), RasterError> {
    if !DPI.contains(&dpi) {
        return Err(RasterError::Dpi { dpi });
    }
    let pixels = area_mm2 * (dpi / MM_PER_INCH).powi(2);
    if pixels <= MOST_PIXELS {
        Ok(())
    } else {
        Err(RasterError::TooMany { millions: pixels / 1e6 })
    }
}

/// Flat painted surface, prepared for colour queries.
pub struct FlatPaint<'a> {
    mesh: &'a Mesh,
    texture: &'a Texture,
    triangles: &'a [FlatTriangle],
    /// Column and row of each triangle's cells; `None` for a texture without cells, or overlapping layers.
    cells: Vec<Option<[Affine; 2]>>,
    outline: &'a Region,
    /// Lowest and highest corner of each triangle.
    boxes: Vec<(Point2, Point2)>,
    faces: Buckets,
    borders: Buckets,
    ends: Vec<[Point2; 2]>,
}

impl<'a> FlatPaint<'a> {
    /// Creates a surface laid flat as `triangles`, whose common outline is `outline`; colours extend beyond it by `bleed_mm`.
    pub fn new(
        mesh: &'a Mesh,
        texture: &'a Texture,
        triangles: &'a [FlatTriangle],
        outline: &'a Region,
        bleed_mm: f64,
    ) -> Self {
        let (low, high) = outline.bounds().unwrap_or_default();
        let ends: Vec<[Point2; 2]> = outline.edges().map(|(a, b)| [*a, *b]).collect();
        let beside = 1.5 * bleed_mm + 0.1;
        let low_out = low.map(|mm| mm - beside);
        let high_out = high.map(|mm| mm + beside);
        let cells = |flat: &FlatTriangle| {
            let corners = texture.in_cells(mesh, flat.triangle)?;
            let at = |axis: usize| flat.weights.map(|w| (0..3).map(|k| w[k] * corners[k][axis]).sum());
            let [across, up] = [0, 1].map(|axis| Affine::through(&flat.flat_mm, at(axis)));
            Some([across?, up?]).filter(|_| flat.is_alone())
        };
        let boxes: Vec<(Point2, Point2)> = triangles.iter().map(|t| bounds(&t.flat_mm, 0.0)).collect();
        Self {
            mesh,
            texture,
            triangles,
            cells: triangles.iter().map(cells).collect(),
            outline,
            faces: Buckets::new(low, high, boxes.iter().copied()),
            boxes,
            borders: Buckets::new(low_out, high_out, ends.iter().map(|e| bounds(e, beside))),
            ends,
        }
    }

    /// Returns an image of the part of the surface, grown by the bleed, within an area of a page, and its area; `None` if it is empty.
    pub fn image(&self, pose: &Pose, grid: PixelGrid, bleed_mm: f64, within: RectMm) -> Option<(RgbImage, RectMm)> {
        let (low, high) = self.outline.moved(|p| pose.at(p)).bounds()?;
        let grown = RectMm::new(low[0], low[1], high[0], high[1]).grown(bleed_mm);
        let area = RectMm::new(
            grown.left_mm.max(within.left_mm),
            grown.bottom_mm.max(within.bottom_mm),
            grown.right_mm.min(within.right_mm),
            grown.top_mm.min(within.top_mm),
        );
        if area.width_mm() <= 0.0 || area.height_mm() <= 0.0 {
            return None;
        }
        let [left, top, right, bottom] = grid.around(area);
        let (wide, high) = (u32::try_from(right - left).ok()?, u32::try_from(bottom - top).ok()?);
        let mut image = RgbImage::from_pixel(wide, high, Rgb([255; 3]));
        let place = |x: u32, y: u32| [(left + i64::from(x)) as f64, (top + i64::from(y)) as f64];
        let mut last = 0;
        for (x, y) in blocks(wide, high) {
            let to = [(x + BLOCK).min(wide), (y + BLOCK).min(high)];
            let one = self.of_block(pose, grid, [place(x, y), place(to[0], to[1])], &mut last);
            for (x, y) in (y..to[1]).flat_map(|y| (x..to[0]).map(move |x| (x, y))) {
                if let Some(rgb) = one.or_else(|| self.pixel(pose, grid, place(x, y), &mut last)) {
                    image.put_pixel(x, y, Rgb(rgb));
                }
            }
        }
        // Slightly inside, so that no renderer's rounding at this resolution adds a row.
        let [left, top] = grid.place(left as f64 + INSET, top as f64 + INSET);
        let [right, bottom] = grid.place(right as f64 - INSET, bottom as f64 - INSET);
        Some((image, RectMm::new(left, bottom, right, top)))
    }

    /// Returns the single colour of the pixels between two corners, if that is quickly known.
    fn of_block(&self, pose: &Pose, grid: PixelGrid, [from, to]: [Point2; 2], last: &mut usize) -> Option<[u8; 3]> {
        let square =
            [from, [to[0], from[1]], to, [from[0], to[1]]].map(|[column, row]| pose.back(grid.place(column, row)));
        self.locate(square[0], last)?;
        self.one_colour(*last, &square)
    }

    /// Returns the colour of a convex polygon that lies in triangle `i`, and there in a single cell; else `None`.
    fn one_colour(&self, i: usize, polygon: &[Point2]) -> Option<[u8; 3]> {
        let [across, up] = self.cells.get(i).copied()??;
        let flat = &self.triangles[i];
        let cells = [across.cells(polygon), up.cells(polygon)];
        let is_one = cells.iter().all(|cells| cells.start() == cells.end());
        let is_in = |p: &Point2| inside(&flat.flat_mm, *p).is_some();
        (is_one && polygon.iter().all(is_in))
            .then(|| self.texture.cell(flat.triangle, cells.map(|cells| *cells.start())))
    }

    /// Returns the mean over a pixel, or the colour of the border near it; `None` far beside the surface. `last` is the triangle found last.
    fn pixel(&self, pose: &Pose, grid: PixelGrid, corner: Point2, last: &mut usize) -> Option<[u8; 3]> {
        let place = |[across, down]: Point2| pose.back(grid.place(corner[0] + across, corner[1] + down));
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(place);
        if let Some(rgb) = self.one_colour(*last, &square) {
            return Some(rgb);
        }
        let found = self.by_area(&square, last).unwrap_or_else(|| {
            let [few, many] = SAMPLES;
            let found = self.sampled(place, few, last);
            if found.alike || found.first.is_none() {
                return found;
            }
            let texel_mm = self.texture.texel_mm(self.mesh, self.triangles[*last].triangle);
            let texels = texel_mm.map_or(0.0, |mm| grid.pixel_mm / mm);
            let count = ((2.0 * texels).ceil() as usize).clamp(many, MOST_SAMPLES);
            self.sampled(place, count, last)
        });
        found.mean().or_else(|| {
            let point = self.nearest(place([0.5; 2]), last)?;
            Some(self.texture.colour(self.mesh, &point))
        })
    }

    fn sampled(&self, place: impl Fn(Point2) -> Point2, count: usize, last: &mut usize) -> Found {
        let mut found = Found::default();
        for at in spread(count * count) {
            if let Some(point) = self.locate(place(at), last) {
                found.add(self.texture.colour(self.mesh, &point), 1.0);
            }
        }
        found
    }

    /// Returns the colours of all cells in a convex polygon, weighted by area; `None` if part of it is not in cells.
    fn by_area(&self, polygon: &[Point2], last: &mut usize) -> Option<Found> {
        let mut found = Found::default();
        let is_in = |t: &FlatTriangle| polygon.iter().all(|p| inside(&t.flat_mm, *p).is_some());
        if self.triangles.get(*last).is_some_and(is_in) {
            self.add_cells(*last, polygon, &mut found)?;
            return Some(found);
        }
        let (low, high) = bounds(polygon, 0.0);
        for i in self.faces.over((low, high)) {
            let (i, (from, to)) = (i as usize, self.boxes[i as usize]);
            if (0..2).any(|axis| to[axis] < low[axis] || high[axis] < from[axis]) {
                continue;
            }
            let part = within(polygon, &self.triangles[i].flat_mm);
            if part.len() > 2 {
                self.add_cells(i, &part, &mut found)?;
                *last = i;
            }
        }
        Some(found)
    }

    fn add_cells(&self, i: usize, polygon: &[Point2], found: &mut Found) -> Option<()> {
        let [across, up] = self.cells[i]?;
        let (columns, rows) = (across.cells(polygon), up.cells(polygon));
        let count = |cells: &std::ops::RangeInclusive<i64>| cells.end() - cells.start() + 1;
        if count(&columns).saturating_mul(count(&rows)) > MOST_CELLS {
            return None;
        }
        each_slice(polygon, &across, columns, |column, strip| {
            each_slice(strip, &up, rows.clone(), |row, cell| {
                let colour = self.texture.cell(self.triangles[i].triangle, [column, row]);
                found.add(colour, area(cell));
            });
        });
        Some(())
    }

    /// Returns the outermost surface over a point of the plane.
    pub fn locate(&self, p: Point2, last: &mut usize) -> Option<SurfacePoint> {
        let bucket = self.faces.at(p)?;
        // Most neighbours lie in the same triangle; of overlapping layers the outermost counts.
        if let Some(weights) = self.triangles.get(*last).and_then(|t| inside(&t.flat_mm, p))
            && self.triangles[*last].is_alone()
        {
            return Some(self.surface_point(*last, weights));
        }
        let over = bucket.iter().filter_map(|i| {
            let flat = &self.triangles[*i as usize];
            let weights = inside(&flat.flat_mm, p)?;
            let height: f64 = (0..3).map(|c| weights[c] * flat.height_mm[c]).sum();
            Some((height, *i as usize, weights))
        });
        // The first of equal ones.
        let (_, i, weights) = over.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
        *last = i;
        Some(self.surface_point(i, weights))
    }

    fn surface_point(&self, i: usize, shares: [f64; 3]) -> SurfacePoint {
        let flat = &self.triangles[i];
        let weight = |k: usize| (0..3).map(|c| shares[c] * flat.weights[c][k]).sum();
        SurfacePoint {
            triangle: flat.triangle,
            weights: [weight(0), weight(1), weight(2)],
        }
    }

    /// Returns the surface at the border nearest to a point beside it.
    fn nearest(&self, p: Point2, last: &mut usize) -> Option<SurfacePoint> {
        let near = self.borders.at(p)?.iter().map(|i| self.ends[*i as usize]);
        let foot = |[a, b]: [Point2; 2]| {
            let along = nearest_share(p, [a, b]);
            let foot = [0, 1].map(|axis| a[axis] + along * (b[axis] - a[axis]));
            let squared: f64 = [0, 1].map(|axis| (foot[axis] - p[axis]).powi(2)).iter().sum();
            (squared, foot, [a, b])
        };
        let (squared, foot, [a, b]) = near.map(foot).min_by(|one, other| one.0.total_cmp(&other.0))?;
        let away = squared.sqrt();
        // Outlines run counter-clockwise, so the surface is to their left.
        let length = distance(a, b).max(f64::MIN_POSITIVE);
        let left = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
        let on = if away > 1e-6 {
            [(foot[0] - p[0]) / away, (foot[1] - p[1]) / away]
        } else {
            left
        };
        // At a corner, this direction may run along the border; the edge's own inner side is tried, too.
        INTO_MM
            .iter()
            .flat_map(|mm| [on, left].map(|d| [foot[0] + mm * d[0], foot[1] + mm * d[1]]))
            .find_map(|q| self.locate(q, last))
    }
}

/// Returns the first pixels of all blocks of an image.
fn blocks(wide: u32, high: u32) -> impl Iterator<Item = (u32, u32)> {
    let step = BLOCK as usize;
    (0..high)
        .step_by(step)
        .flat_map(move |y| (0..wide).step_by(step).map(move |x| (x, y)))
}

/// Returns points of the unit square of which no two share a row or a column (Hammersley 1960), so that the share on one side of an edge is estimated
/// closely.
fn spread(count: usize) -> impl Iterator<Item = Point2> {
    (0..count as u32).map(move |i| {
        let half = 0.5 / count as f64;
        let reversed = f64::from(i.reverse_bits()) / 4_294_967_296.0;
        [f64::from(i) / count as f64 + half, (reversed + half).min(1.0 - half)]
    })
}

#[derive(Default)]
struct Found {
    first: Option<[u8; 3]>,
    alike: bool,
    linear: [f64; 3],
    weight: f64,
}

impl Found {
    fn add(&mut self, rgb: [u8; 3], weight: f64) {
        if weight <= 0.0 {
            return;
        }
        self.alike = self.first.is_none_or(|first| self.alike && first == rgb);
        self.first.get_or_insert(rgb);
        let linear = LINEAR.with(|table| rgb.map(|v| table[usize::from(v)]));
        (0..3).for_each(|c| self.linear[c] += weight * linear[c]);
        self.weight += weight;
    }

    /// Returns the mean colour; `None` without samples.
    fn mean(&self) -> Option<[u8; 3]> {
        let first = self.first?;
        Some(if self.alike {
            first
        } else {
            light::rgb_of(self.linear.map(|sum| sum / self.weight))
        })
    }
}

thread_local! {
    /// Linear light of each 8-bit value.
    static LINEAR: [f64; 256] = std::array::from_fn(|v| light::decode(v as f64 / 255.0));
}

/// Returns the barycentric coordinates of a point in a triangle; `None` outside.
fn inside(&[a, b, c]: &[Point2; 3], p: Point2) -> Option<[f64; 3]> {
    let whole = doubled_area(a, b, c);
    let shares = [[b, c], [c, a], [a, b]].map(|[from, to]| doubled_area(from, to, p) / whole);
    shares.iter().all(|share| *share >= -1e-9).then_some(shares)
}
