//! Drawing of the sheets: pieces to paint by number, and the stencils of a paint. Each piece is at one place on all of them.

use super::regions::Upright;
use super::{PaintedPieces, PieceStencil};
use crate::pieces::labels::Signs;
use crate::pieces::pages;
use crate::pieces::pen::{LINE_MM, Pen, cut};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::fitting_size_mm;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::paint::plane::{Area, PlaneOutline, mm};
use scaleproof_print::paint::{OPENING, cross, disc, mirrored, swatch};
use scaleproof_print::sheet::{BLACK, Mark, RectMm, Sheet, TextAnchor};
use scaleproof_print::template::Captions;
use scaleproof_print::wrap::{Contour, EDGE_DASH_MM, EDGE_LINE_MM, Region, moved};

const BORDER_MM: f64 = 0.12;
const NUMBER_MM: f64 = 3.5;
/// Minimum size of a number; smaller ones are illegible.
const LEAST_NUMBER_MM: f64 = 0.9;
/// Height of a number, as a share of the room for it.
const NUMBER_SHARE: f64 = 0.9;
/// Strength of a paint's colour in the patches to paint by number.
const TINT: f64 = 0.35;
const TAG_MM: f64 = 2.8;
const OUTLINE_DASH_MM: (f64, f64) = (1.2, 0.8);
/// Length of a cross's arm beyond a registration hole's edge.
const ARM_MM: f64 = 1.2;
/// Font size of a sheet's paint name, its height above the page's foot, and the size of its swatch.
const PAINT_MM: f64 = 3.5;
const PAINT_AT_MM: f64 = 7.5;
const SWATCH_MM: f64 = 4.0;

/// Rotates an upright area back to its piece's plane.
pub fn flat(area: &Area, upright: &Upright) -> Region {
    let contour = |outline: &PlaneOutline| -> Contour {
        let places = outline.iter().map(|p| upright.back([mm(p.x), mm(p.y)]));
        places.collect()
    };
    let pieces = area.pieces.iter();
    Region::new(pieces.map(|piece| piece.iter().map(contour).collect()).collect())
}

pub struct Drawing<'a> {
    pub made: &'a PaintedPieces,
    pub signs: &'a [Signs],
    pub captions: &'a Captions,
    pub mirror: bool,
    pub hole_mm: f64,
}

impl<'a> Drawing<'a> {
    /// Returns the sheets to paint by number, then those of the stencils, paint by paint. A sheet without a stencil is left out.
    pub fn all(&self, frames: &[PageFrame]) -> Vec<(String, Sheet)> {
        let mut sheets = Vec::new();
        for (page, frame) in frames.iter().enumerate() {
            let here = |i: &usize| self.made.places[*i].page == page;
            let here = (0..self.made.places.len()).filter(here);
            let marks = here.flat_map(|i| self.numbers(i)).collect();
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

    fn on_page(&self, piece: usize, area: &Area) -> Vec<Vec<Point2>> {
        let region = flat(area, &self.made.regions[piece].upright);
        moved(self.pen(piece).region(&region).contours(), [0.0; 2])
    }

    fn holes(&self, piece: usize) -> impl Iterator<Item = Point2> {
        let pen = self.pen(piece);
        self.made.materials[piece]
            .holes
            .iter()
            .map(move |hole| pen.place(*hole))
    }

    /// Draws the piece with each patch in a tint of its paint, and the paint's number in it.
    fn numbers(&self, piece: usize) -> Vec<Mark> {
        let mut marks = Vec::new();
        let tint = |v: u8| (255.0 - TINT * (255.0 - f64::from(v))).round() as u8;
        let areas = || self.made.regions[piece].areas.iter().zip(&self.made.painted.paints);
        for (area, used) in areas() {
            marks.push(Mark::Area {
                outlines: self.on_page(piece, area),
                colour: used.paint.rgb.map(tint),
            });
        }
        for (area, _) in areas() {
            let outlines = self.on_page(piece, area);
            marks.extend(outlines.iter().flat_map(|o| Mark::outline(o, BORDER_MM, BLACK)));
        }
        for (paint, (area, _)) in areas().enumerate() {
            for patch in &area.pieces {
                marks.extend(self.number(piece, paint, patch));
            }
        }
        let pen = self.pen(piece);
        marks.extend(cut(&pen.region(&pen.piece.region)));
        marks.extend(pen.signs(&self.signs[piece]));
        let far = 0.5 * self.hole_mm + ARM_MM;
        marks.extend(self.holes(piece).flat_map(|at| cross(at, 0.0, far)));
        marks
    }

    /// Draws a paint's number where its patch has most room; none if it would be illegible.
    fn number(&self, piece: usize, paint: usize, patch: &[PlaneOutline]) -> Option<Mark> {
        let upright = self.made.regions[piece].upright;
        let region = flat(&Area::from_piece(patch), &upright);
        let middle = region.innermost();
        let room_mm = -2.0 * region.distance_mm(middle);
        let text = (paint + 1).to_string();
        let size_mm = fitting_size_mm(&text, NUMBER_MM.min(NUMBER_SHARE * room_mm), NUMBER_SHARE * room_mm);
        let size = (size_mm, f64::INFINITY);
        (size_mm >= LEAST_NUMBER_MM).then(|| Mark::centred(self.pen(piece).place(middle), size, text))
    }

    /// Draws the openings tinted, the sheet's outer edge, and the piece's outline on it.
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
        let outline = pen.piece.region.edges();
        marks.extend(outline.map(|(a, b)| pen.line([*a, *b], BORDER_MM, Some(OUTLINE_DASH_MM))));
        marks.extend(sheet.iter().flat_map(|outline| Mark::outline(outline, LINE_MM, BLACK)));
        marks.extend([(openings, false), (sheet, true)].map(|(outlines, is_piece)| Mark::Cut { outlines, is_piece }));
        marks.extend(pen.signs(&self.signs[piece]));
        let near = 0.5 * self.hole_mm;
        marks.extend(self.holes(piece).flat_map(|at| cross(at, near, near + ARM_MM)));
        if let Some(tag) = self.made.materials[piece].tag {
            let text = format!("P{}", stencil.paint + 1);
            let size = (TAG_MM, 2.0 * super::material::TAG_MM);
            marks.push(Mark::centred(pen.place(tag), size, text));
        }
        marks
    }

    /// Draws the paint of a sheet of stencils, above the sheet's number.
    fn paint_name(&self, frame: &PageFrame, paint: usize) -> Vec<Mark> {
        let (right, y) = (frame.printable.right_mm, frame.printable.bottom_mm + PAINT_AT_MM);
        let area = RectMm::new(right - SWATCH_MM, y - 0.6, right, y - 0.6 + SWATCH_MM);
        let mut marks = swatch(area, self.made.painted.paints[paint].paint.rgb).to_vec();
        let side = if self.mirror { "back, " } else { "" };
        let text = format!("{side}paint {}", paint + 1);
        let at = [right - SWATCH_MM - 1.5, y];
        marks.push(Mark::fitted(at, (PAINT_MM, 16.0), TextAnchor::Right, text));
        marks
    }
}
