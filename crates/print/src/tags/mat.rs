//! Ground mat: everything on the table, seen from above. Geometry only, in the ground frame; [`super::ground`] distributes it over paper.
//!
//! *Ground frame*: the ground seen from above, the model's front to the right: x and y of the model frame, millimetres. Windows onto it show the same
//! drawing on a sheet of the mat, on a place strip, and on the map.

use nalgebra::Point3;

use super::arrange::Arrangement;
use super::tent::Tent;
use super::{TagPrintError, image_of};
use crate::shapes::{OutlineMm, TagPlacement, black_modules, clipped, overlap, stroke, stroked};
use crate::sheet::{BLACK, Mark, RectMm, Srgb8};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm, number, printable};
use scaleproof_pose::scene::{ScaleModel, Scene, Tag};

pub const GREY: Srgb8 = [110, 110, 110];
/// Width of the free border around everything.
const BORDER_MM: f64 = 8.0;
pub const LINE_MM: f64 = 0.4;
const TEXT_MM: f64 = 4.0;
const TITLE_MM: f64 = 8.0;
const UP_MM: f64 = 4.0;
/// Length of the arrow at the model's front.
pub const ARROW_MM: f64 = 18.0;

/// All shapes on the mat, in painting order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mat {
    pub shapes: Vec<GroundShape>,
    pub labels: Vec<Label>,
    /// Name and required ground of each object: tags with their white ring.
    footprints: Vec<(String, OutlineMm)>,
    /// Outline, cross and arrow of the model.
    pub model: Vec<OutlineMm>,
    /// Bounds of the model and the flat tags, with a border.
    pub core: RectMm,
    pub tents: Vec<RectMm>,
    /// Flat tags with their white rings, by id.
    pub tags: Vec<(u32, OutlineMm)>,
}

/// Convex outlines of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundShape {
    pub outlines: Vec<OutlineMm>,
    pub colour: Srgb8,
}

/// Centred text; `at` is the middle of its capitals.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub at: Point2,
    pub size_mm: f64,
    pub text: String,
}

impl Mat {
    /// Creates the mat of a scene: the model's outline, the flat tags, and an outline for each tent card.
    pub fn new(scene: &Scene, arrangement: &Arrangement) -> Result<Mat, TagPrintError> {
        let mut mat = Mat::default();
        mat.add_model(&scene.model);
        for tag in &arrangement.flat {
            mat.add_flat_tag(tag)?;
        }
        let drawn_on = mat.shapes.iter().flat_map(|shape| shape.outlines.iter().flatten());
        mat.core = RectMm::around(drawn_on).grown(BORDER_MM);
        for (i, tent) in arrangement.tents.iter().enumerate() {
            mat.add_tent(i + 1, tent);
        }
        Ok(mat)
    }

    /// Returns the names of objects that overlap, or are closer than a tag's white ring.
    pub fn overlaps(&self) -> impl Iterator<Item = [String; 2]> {
        let pairs = (0..self.footprints.len()).flat_map(|i| (i + 1..self.footprints.len()).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| (&self.footprints[i], &self.footprints[j]))
            .filter(|((_, a), (_, b))| overlap(a, b))
            .map(|((a, _), (b, _))| [a.clone(), b.clone()])
    }

    fn add_model(&mut self, model: &ScaleModel) {
        let [length, width, _] = model.size_mm;
        let (front, side) = (length / 2.0, width / 2.0);
        let ground = RectMm::new(-front, -side, front, side).outline();
        let mut outlines = stroked(&ground, LINE_MM);
        self.footprints.push(("the model".to_owned(), ground));
        let cross = |x: f64, y: f64| stroke([-x, -y], [x, y], LINE_MM);
        outlines.extend([cross(8.0, 0.0), cross(0.0, 8.0)]);
        let arrow = [(0.0, -ARROW_MM / 3.0), (ARROW_MM, 0.0), (0.0, ARROW_MM / 3.0)];
        outlines.push(arrow.map(|(x, y)| [front + 2.0 + x, y]).to_vec());
        self.model.clone_from(&outlines);
        self.shapes.push(GroundShape { outlines, colour: GREY });
        let size = format!("{} × {} mm", number(length), number(width));
        let text_mm = TITLE_MM.min(width / 8.0);
        let name = printable(&model.name);
        let name_mm = fitting_size_mm(&name, text_mm, 0.9 * length);
        self.label([0.0, side / 2.0], name_mm, name);
        self.label([0.0, -side / 2.0], text_mm, size);
        self.label([front - 3.0 * text_mm, 0.0], text_mm, "FRONT".to_owned());
    }

    fn add_flat_tag(&mut self, tag: &Tag) -> Result<(), TagPrintError> {
        let image = image_of(tag)?;
        let half = image.width_mm(tag.size_mm) / 2.0;
        let right = level_unit(tag.right.x, tag.right.y);
        let place = TagPlacement::new(&image, tag.size_mm, on_mat(&tag.centre_mm), right);
        let ground = place.rectangle(-half, -half, half, half);
        self.tags.push((tag.id, ground.clone()));
        self.footprints.push((format!("tag {}", tag.id), ground));
        let mut outlines = black_modules(image.modules(), &place);
        outlines.push(place.up_mark(0.0, half, UP_MM));
        self.shapes.push(GroundShape {
            outlines,
            colour: BLACK,
        });
        let below = place.at(0.0, -half - TEXT_MM);
        self.label(below, TEXT_MM, format!("id {}", tag.id));
        Ok(())
    }

    fn add_tent(&mut self, number: usize, tent: &Tent) {
        let feet = tent.foot_mm();
        let outline = feet.each_ref().map(on_mat);
        self.footprints.push((format!("tent card T{number}"), outline.to_vec()));
        let mut outlines = stroked(&outline, LINE_MM);
        outlines.extend(tent.middle_marks());
        self.shapes.push(GroundShape { outlines, colour: GREY });
        self.tents.push(RectMm::around(&outline).grown(BORDER_MM));
        let [a_left, a_right, b_right, b_left] = feet;
        let middle = nalgebra::center(&a_left, &b_right);
        let size_mm = TITLE_MM.min(tent.base_mm / 4.0);
        self.label([middle.x, middle.y], size_mm, format!("T{number}"));
        for (tag, ends) in tent.tags.iter().zip([[a_left, a_right], [b_right, b_left]]) {
            // Slightly inside the foot of the face that carries the tag.
            let at = nalgebra::center(&ends[0], &ends[1]);
            let at = at + (middle - at).normalize() * (1.2 * size_mm);
            self.label([at.x, at.y], (0.5 * size_mm).max(2.0), format!("id {}", tag.id));
        }
    }

    fn label(&mut self, [x, y]: Point2, size_mm: f64, text: String) {
        let at = [x, y - 0.5 * CAP_HEIGHT * size_mm];
        self.labels.push(Label { at, size_mm, text });
    }

    pub fn whole(&self) -> RectMm {
        self.tents.iter().copied().fold(self.core, RectMm::union)
    }

    /// Returns the parts of the shapes visible through a window, clipped to a rectangle of the page.
    pub fn marks(&self, window: &GroundWindow, to: RectMm) -> Vec<Mark> {
        let seen = |shape: &GroundShape| {
            let (outlines, colour) = (window.clipped(&shape.outlines, to), shape.colour);
            (!outlines.is_empty()).then_some(Mark::Area { outlines, colour })
        };
        self.shapes.iter().filter_map(seen).collect()
    }

    /// Draws grey lines along an outline, and its name in the middle.
    pub fn add_outline(&mut self, outline: &[Point2], at: Point2, name: String) {
        self.shapes.push(GroundShape {
            outlines: stroked(outline, LINE_MM),
            colour: GREY,
        });
        self.label(at, TEXT_MM, name);
    }
}

pub fn on_mat(point: &Point3<f64>) -> Point2 {
    [point.x, point.y]
}

fn level_unit(x: f64, y: f64) -> Point2 {
    let length = x.hypot(y);
    [x / length, y / length]
}

/// Similarity transform from the ground to a page: translation, rotation and scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundWindow {
    pub centre: Point2,
    /// Position of `centre` on the page.
    pub at: Point2,
    /// Unit vector of the ground that points right on the page.
    pub right: Point2,
    pub scale: f64,
}

impl GroundWindow {
    /// Returns a window with the model's front to the right.
    pub fn level(centre: Point2, at: Point2, scale: f64) -> Self {
        Self {
            centre,
            at,
            right: [1.0, 0.0],
            scale,
        }
    }

    pub fn on_page(&self, p: Point2) -> Point2 {
        let (x, y) = (p[0] - self.centre[0], p[1] - self.centre[1]);
        let [c, s] = self.right;
        [
            self.at[0] + self.scale * (c * x + s * y),
            self.at[1] + self.scale * (c * y - s * x),
        ]
    }

    pub fn outline(&self, outline: &[Point2]) -> OutlineMm {
        outline.iter().map(|p| self.on_page(*p)).collect()
    }

    /// Returns the parts of outlines visible inside a rectangle of the page.
    pub fn clipped(&self, outlines: &[OutlineMm], to: RectMm) -> Vec<OutlineMm> {
        let seen = outlines.iter().map(|outline| clipped(&self.outline(outline), to));
        seen.filter(|outline| outline.len() > 2).collect()
    }
}
