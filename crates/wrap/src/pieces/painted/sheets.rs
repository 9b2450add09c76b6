//! The sheets: pieces to paint by number, and the stencils of a paint. Each piece lies at one place on all of them.

use super::regions::Upright;
use super::{PaintedPieces, PieceStencil};
use crate::pieces::labels::Signs;
use crate::pieces::pages;
use crate::pieces::pen::{LINE_MM, Pen};
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm};
use scaleproof_print::print::frame::PageFrame;
use scaleproof_print::print::paint::plane::{Area, PlaneOutline, mm};
use scaleproof_print::print::paint::{OPENING, cross, disc, mirrored, swatch};
use scaleproof_print::print::sheet::{BLACK, Mark, PointMm, RectMm, Sheet, Srgb8, TextAnchor};
use scaleproof_print::print::template::Captions;
use scaleproof_print::print::wrap::{Contour, EDGE_DASH_MM, EDGE_LINE_MM, Point, Region, cut_line, moved};

const BORDER_MM: f64 = 0.12;
const NUMBER_MM: f64 = 3.5;
/// Smaller numbers are not read.
const LEAST_NUMBER_MM: f64 = 0.9;
/// Height of a number, of the width of the room for it.
const NUMBER_SHARE: f64 = 0.9;
/// How much of a paint's colour the patches to paint by number show.
const TINT: f64 = 0.35;
const TAG_MM: f64 = 2.8;
const OUTLINE_DASH_MM: (f64, f64) = (1.2, 0.8);
/// From a registration hole's edge to the end of its cross.
const ARM_MM: f64 = 1.2;
/// Height of a sheet's paint above its number, and of its swatch.
const PAINT_MM: f64 = 3.5;
const PAINT_AT_MM: f64 = 7.5;
const SWATCH_MM: f64 = 4.0;

/// An area that was turned upright, in its piece's plane.
pub fn flat(area: &Area, upright: &Upright) -> Region {
    Region::new(
        area.pieces
            .iter()
            .map(|piece| piece.iter().map(|o| contour(o, upright)).collect())
            .collect(),
    )
}

fn contour(outline: &PlaneOutline, upright: &Upright) -> Contour {
    outline.iter().map(|p| upright.back([mm(p.x), mm(p.y)])).collect()
}

/// Draws the sheets of one model.
pub struct Drawing<'a> {
    made: &'a PaintedPieces,
    signs: &'a [Signs],
    captions: &'a Captions,
    mirror: bool,
    hole_mm: f64,
}

impl<'a> Drawing<'a> {
    pub fn new(made: &'a PaintedPieces, signs: &'a [Signs], captions: &'a Captions, mirror: bool) -> Self {
        Self {
            hole_mm: scaleproof_print::print::paint::hole_mm(made.min_feature_mm),
            made,
            signs,
            captions,
            mirror,
        }
    }

    /// The sheets to paint by number, then those of the stencils, paint by paint. A sheet without a stencil is left out.
    pub fn all(&self, frames: &[PageFrame]) -> Vec<(String, Sheet)> {
        let mut sheets = Vec::new();
        for (page, frame) in frames.iter().enumerate() {
            let on_page = self
                .made
                .places
                .iter()
                .enumerate()
                .filter(|(_, place)| place.page == page);
            let marks = on_page.flat_map(|(i, _)| self.numbers(i)).collect();
            let sheet = pages::sheet(frame, marks, self.captions, (page, frames.len()));
            sheets.push((format!("numbers-{}", page + 1), sheet));
        }
        for paint in 1..self.made.painted.paints.len() {
            for (page, frame) in frames.iter().enumerate() {
                let is_here = |s: &&PieceStencil| s.paint == paint && self.made.places[s.piece].page == page;
                let stencils: Vec<_> = self.made.stencils.iter().filter(is_here).collect();
                if stencils.is_empty() {
                    continue;
                }
                let mut marks: Vec<Mark> = stencils.into_iter().flat_map(|stencil| self.stencil(stencil)).collect();
                if self.mirror {
                    marks = marks.into_iter().map(|mark| mirrored(mark, frame.printable)).collect();
                }
                marks.extend(self.paint_name(frame, paint));
                let sheet = pages::sheet(frame, marks, self.captions, (page, frames.len()));
                sheets.push((format!("paint{}-{}", paint + 1, page + 1), sheet));
            }
        }
        sheets
    }

    fn pen(&self, piece: usize) -> Pen<'a> {
        Pen {
            piece: &self.made.pieces[piece],
            pose: self.made.places[piece].pose,
        }
    }

    /// An area of a piece on its page.
    fn on_page(&self, piece: usize, area: &Area) -> Vec<Vec<PointMm>> {
        let (pose, upright) = (self.made.places[piece].pose, self.made.regions[piece].upright);
        moved(flat(area, &upright).moved(|p| pose.at(p)).contours(), [0.0; 2])
    }

    /// A piece's letters, ticks and number.
    fn signs(&self, piece: usize) -> Vec<Mark> {
        let (pen, signs) = (self.pen(piece), &self.signs[piece]);
        let ticks = signs.ticks.iter().flat_map(|tick| pen.tick(*tick));
        ticks
            .chain(signs.labels.iter().flat_map(|label| pen.label(label)))
            .collect()
    }

    fn holes(&self, piece: usize) -> impl Iterator<Item = (f64, f64)> {
        let pen = self.pen(piece);
        let at = move |hole: &Point| {
            let p = pen.place(*hole);
            (p.x_mm, p.y_mm)
        };
        self.made.materials[piece].holes.iter().map(at)
    }

    /// The piece with each patch in a tint of its paint, and the paint's number in it.
    fn numbers(&self, piece: usize) -> Vec<Mark> {
        let mut marks = Vec::new();
        let areas = || self.made.regions[piece].areas.iter().zip(&self.made.painted.paints);
        for (area, used) in areas() {
            marks.push(Mark::Area {
                outlines: self.on_page(piece, area),
                colour: tint(used.paint.rgb),
            });
        }
        for (area, _) in areas() {
            marks.extend(self.on_page(piece, area).iter().flat_map(|o| lines(o, BORDER_MM)));
        }
        for (paint, (area, _)) in areas().enumerate() {
            for patch in &area.pieces {
                marks.extend(self.number(piece, paint, patch));
            }
        }
        let outline = self.made.pieces[piece]
            .region
            .moved(|p| self.made.places[piece].pose.at(p));
        marks.extend(cut_line(&outline, [0.0; 2]));
        marks.push(Mark::Cut {
            outlines: moved(outline.contours(), [0.0; 2]),
            is_piece: true,
        });
        marks.extend(self.signs(piece));
        let far = 0.5 * self.hole_mm + ARM_MM;
        marks.extend(self.holes(piece).flat_map(|at| cross(at, 0.0, far)));
        marks
    }

    /// A paint's number where its patch has most room; none where it would not be read.
    fn number(&self, piece: usize, paint: usize, patch: &[PlaneOutline]) -> Option<Mark> {
        let upright = self.made.regions[piece].upright;
        let region = Region::new(vec![patch.iter().map(|o| contour(o, &upright)).collect()]);
        let middle = region.innermost();
        let room_mm = -2.0 * region.distance_mm(middle);
        let text = (paint + 1).to_string();
        let size_mm = fitting_size_mm(&text, NUMBER_MM.min(NUMBER_SHARE * room_mm), NUMBER_SHARE * room_mm);
        let at = self.pen(piece).place(middle);
        let place = (at.x_mm, at.y_mm - 0.5 * CAP_HEIGHT * size_mm);
        (size_mm >= LEAST_NUMBER_MM).then(|| Mark::text(place, size_mm, TextAnchor::Centre, text))
    }

    /// What is cut out tinted, the sheet's outer edge, and the piece's outline on it.
    fn stencil(&self, stencil: &PieceStencil) -> Vec<Mark> {
        let piece = stencil.piece;
        let mut openings = self.on_page(piece, &stencil.openings);
        openings.extend(self.holes(piece).map(|at| disc(at, 0.5 * self.hole_mm)));
        let sheet = self.on_page(piece, &self.made.materials[piece].sheet);
        let mut marks = vec![Mark::Area {
            outlines: openings.clone(),
            colour: OPENING,
        }];
        let pen = self.pen(piece);
        let folds = pen.piece.folds.iter();
        marks.extend(folds.map(|ends| pen.line(*ends, EDGE_LINE_MM, Some(EDGE_DASH_MM))));
        let outline = self.made.pieces[piece].region.edges();
        marks.extend(outline.map(|(a, b)| pen.line([*a, *b], BORDER_MM, Some(OUTLINE_DASH_MM))));
        marks.extend(sheet.iter().flat_map(|outline| lines(outline, LINE_MM)));
        marks.extend([(openings, false), (sheet, true)].map(|(outlines, is_piece)| Mark::Cut { outlines, is_piece }));
        marks.extend(self.signs(piece));
        let near = 0.5 * self.hole_mm;
        marks.extend(self.holes(piece).flat_map(|at| cross(at, near, near + ARM_MM)));
        if let Some(tag) = self.made.materials[piece].tag {
            let at = pen.place(tag);
            let text = format!("P{}", stencil.paint + 1);
            let size_mm = fitting_size_mm(&text, TAG_MM, 2.0 * super::material::TAG_MM);
            let place = (at.x_mm, at.y_mm - 0.5 * CAP_HEIGHT * size_mm);
            marks.push(Mark::text(place, size_mm, TextAnchor::Centre, text));
        }
        marks
    }

    /// The paint of a sheet of stencils, above the sheet's number.
    fn paint_name(&self, frame: &PageFrame, paint: usize) -> Vec<Mark> {
        let (right, y) = (frame.printable.right_mm, frame.printable.bottom_mm + PAINT_AT_MM);
        let area = RectMm::new(right - SWATCH_MM, y - 0.6, right, y - 0.6 + SWATCH_MM);
        let mut marks = swatch(area, self.made.painted.paints[paint].paint.rgb).to_vec();
        let side = if self.mirror { "back, " } else { "" };
        let text = format!("{side}paint {}", paint + 1);
        let size_mm = fitting_size_mm(&text, PAINT_MM, 16.0);
        marks.push(Mark::text(
            (right - SWATCH_MM - 1.5, y),
            size_mm,
            TextAnchor::Right,
            text,
        ));
        marks
    }
}

fn tint(rgb: Srgb8) -> Srgb8 {
    rgb.map(|v| (255.0 - TINT * (255.0 - f64::from(v))).round() as u8)
}

/// The lines around an outline.
fn lines(outline: &[PointMm], width_mm: f64) -> Vec<Mark> {
    let next = outline.iter().cycle().skip(1);
    let line = |(from, to): (&PointMm, &PointMm)| Mark::Line {
        from: *from,
        to: *to,
        width_mm,
        dash_mm: None,
        colour: BLACK,
    };
    outline.iter().zip(next).map(line).collect()
}
