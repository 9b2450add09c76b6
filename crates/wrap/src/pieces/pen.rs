//! Drawing of one piece's lines and signs on its page.

use super::BLEED_MM;
use super::flat::Piece;
use super::labels::{Label, NUMBER_RING_MM, Signs};
use scaleproof_core::geometry::{Point2, between, circle, distance};
use scaleproof_plot::lettering::fitting_size_mm;
use scaleproof_print::raster::Pose;
use scaleproof_print::sheet::{BLACK, Mark, TextAnchor, WHITE};
use scaleproof_print::wrap::{Region, cut_line, moved};

const LETTER_MM: f64 = 3.0;
const NUMBER_MM: f64 = 3.8;
pub const LINE_MM: f64 = 0.15;
/// Width of the halo under a line that crosses the bleed, so that the line is visible on any colour.
pub const HALO_MM: f64 = 0.45;

/// Drawing tool for a piece's plane.
pub struct Pen<'a> {
    pub piece: &'a Piece,
    pub pose: Pose,
}

/// Returns the line along which a region of the page is cut, as drawn and for a plotter.
pub fn cut(region: &Region) -> Vec<Mark> {
    let mut marks = cut_line(region, [0.0; 2]);
    marks.push(Mark::Cut {
        outlines: moved(region.contours(), [0.0; 2]),
        is_piece: true,
    });
    marks
}

impl Pen<'_> {
    /// Returns a point slightly away from the border, so that nothing of the line stays on the piece.
    fn off_line(&self, border: Point2, to: Point2) -> Point2 {
        between(border, to, 0.4 / distance(border, to).max(0.4))
    }

    /// Converts a point of the piece's plane to the page.
    pub fn place(&self, p: Point2) -> Point2 {
        self.pose.at(p)
    }

    /// Converts a region of the piece's plane to the page.
    pub fn region(&self, region: &Region) -> Region {
        region.moved(|p| self.pose.at(p))
    }

    /// Draws a line from the border outwards.
    pub fn tick(&self, [border, end]: [Point2; 2]) -> [Mark; 2] {
        self.haloed([self.off_line(border, end), end])
    }

    pub fn line(&self, ends: [Point2; 2], width_mm: f64, dash_mm: Option<(f64, f64)>) -> Mark {
        Mark::stroke(ends.map(|p| self.place(p)), width_mm, dash_mm, BLACK)
    }

    fn haloed(&self, ends: [Point2; 2]) -> [Mark; 2] {
        let ends = ends.map(|p| self.place(p));
        [(HALO_MM, WHITE), (LINE_MM, BLACK)].map(|(width_mm, colour)| Mark::stroke(ends, width_mm, None, colour))
    }

    /// Draws ticks, then letters and the number with their leaders.
    pub fn signs(&self, signs: &Signs) -> Vec<Mark> {
        let ticks = signs.ticks.iter().flat_map(|tick| self.tick(*tick));
        ticks
            .chain(signs.labels.iter().flat_map(|label| self.label(label)))
            .collect()
    }

    /// Draws a letter or number with its leader.
    fn label(&self, label: &Label) -> Vec<Mark> {
        let away = distance(label.at, label.names);
        let mut marks = Vec::new();
        let on_tab = away < BLEED_MM + label.radius_mm;
        let (rim, most) = if label.is_number {
            (NUMBER_RING_MM, NUMBER_MM)
        } else {
            (label.radius_mm, LETTER_MM)
        };
        if away - rim > BLEED_MM + 1.0 && !on_tab {
            let end = between(label.names, label.at, (away - rim) / away);
            marks.extend(self.haloed([self.off_line(label.names, label.at), end]));
        }
        let (at, size) = (self.place(label.at), (most, 1.7 * rim));
        if label.is_number {
            marks.extend(self.ring(label.at));
            marks.push(Mark::centred(at, size, &label.text));
        } else {
            let size_mm = fitting_size_mm(&label.text, size.0, size.1);
            let baseline = [at[0], at[1] - 0.28 * size_mm];
            marks.push(Mark::text(baseline, size_mm, TextAnchor::Centre, &label.text));
        }
        marks
    }

    /// Draws the ring around a number, with the arrow that points up on the model.
    fn ring(&self, at: Point2) -> Vec<Mark> {
        let ring: Vec<Point2> = circle(at, NUMBER_RING_MM, 32).map(|p| self.place(p)).collect();
        let mut marks: Vec<Mark> = Mark::outline(&ring, LINE_MM, BLACK).collect();
        let up = self.piece.up[1].atan2(self.piece.up[0]);
        let arrow = [(1.3, 0.0), (0.0, 0.35), (0.0, -0.35)].map(|(beyond, turn)| {
            let (s, c) = (up + turn).sin_cos();
            let radius = NUMBER_RING_MM + beyond;
            self.place([at[0] + radius * c, at[1] + radius * s])
        });
        marks.push(Mark::black(vec![arrow.to_vec()]));
        marks
    }
}
