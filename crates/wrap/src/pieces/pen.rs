//! Lines and signs of one piece on its page.

use super::BLEED_MM;
use super::flat::Piece;
use super::labels::{Label, NUMBER_RING_MM};
use scaleproof_core::geometry::distance;
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm};
use scaleproof_print::print::raster::Pose;
use scaleproof_print::print::sheet::{BLACK, Mark, PointMm, TextAnchor, WHITE};
use scaleproof_print::print::wrap::Point;

const LETTER_MM: f64 = 3.0;
const NUMBER_MM: f64 = 3.8;
pub const LINE_MM: f64 = 0.15;
/// Under a line that crosses the bleed, so that it shows on any colour.
pub const HALO_MM: f64 = 0.45;

/// Draws in a piece's plane.
pub struct Pen<'a> {
    pub piece: &'a Piece,
    pub pose: Pose,
}

impl Pen<'_> {
    /// A little away from the border, so that nothing stays on the piece.
    fn off_line(&self, border: Point, to: Point) -> Point {
        let share = 0.4 / distance(border, to).max(0.4);
        [0, 1].map(|axis| border[axis] + share * (to[axis] - border[axis]))
    }

    pub fn place(&self, p: Point) -> PointMm {
        let [x, y] = self.pose.at(p);
        PointMm::new(x, y)
    }

    /// A line from the border outwards.
    pub fn tick(&self, [border, end]: [Point; 2]) -> [Mark; 2] {
        self.haloed([self.off_line(border, end), end])
    }

    pub fn line(&self, ends: [Point; 2], width_mm: f64, dash_mm: Option<(f64, f64)>) -> Mark {
        let [from, to] = ends.map(|p| self.place(p));
        Mark::Line {
            from,
            to,
            width_mm,
            dash_mm,
            colour: BLACK,
        }
    }

    fn haloed(&self, ends: [Point; 2]) -> [Mark; 2] {
        let [from, to] = ends.map(|p| self.place(p));
        [(HALO_MM, WHITE), (LINE_MM, BLACK)].map(|(width_mm, colour)| Mark::Line {
            from,
            to,
            width_mm,
            dash_mm: None,
            colour,
        })
    }

    /// A letter or number with its leader.
    pub fn label(&self, label: &Label) -> Vec<Mark> {
        let away = distance(label.at, label.names);
        let mut marks = Vec::new();
        let on_tab = away < BLEED_MM + label.radius_mm;
        let rim = if label.is_number {
            NUMBER_RING_MM
        } else {
            label.radius_mm
        };
        if away - rim > BLEED_MM + 1.0 && !on_tab {
            let share = (away - rim) / away;
            let end = [0, 1].map(|axis| label.names[axis] + share * (label.at[axis] - label.names[axis]));
            marks.extend(self.haloed([self.off_line(label.names, label.at), end]));
        }
        if label.is_number {
            marks.extend(self.ring(label.at));
        }
        let most = if label.is_number { NUMBER_MM } else { LETTER_MM };
        let size_mm = fitting_size_mm(&label.text, most, 1.7 * rim);
        let at = self.place(label.at);
        let baseline = at.y_mm - if label.is_number { 0.5 * CAP_HEIGHT } else { 0.28 } * size_mm;
        marks.push(Mark::text(
            (at.x_mm, baseline),
            size_mm,
            TextAnchor::Centre,
            label.text.clone(),
        ));
        marks
    }

    /// The ring around a number, with the arrow that points up on the model.
    fn ring(&self, at: Point) -> Vec<Mark> {
        const CORNERS: usize = 32;
        let polar = |radius: f64, angle: f64| {
            let (s, c) = angle.sin_cos();
            [at[0] + radius * c, at[1] + radius * s]
        };
        let corner = |i: usize| polar(NUMBER_RING_MM, std::f64::consts::TAU * i as f64 / CORNERS as f64);
        let mut marks: Vec<Mark> = (0..CORNERS)
            .map(|i| self.line([corner(i), corner(i + 1)], LINE_MM, None))
            .collect();
        let up = self.piece.up[1].atan2(self.piece.up[0]);
        let arrow = [
            polar(NUMBER_RING_MM + 1.3, up),
            polar(NUMBER_RING_MM, up + 0.35),
            polar(NUMBER_RING_MM, up - 0.35),
        ];
        marks.push(Mark::Area {
            outlines: vec![arrow.map(|p| self.place(p)).to_vec()],
            colour: BLACK,
        });
        marks
    }
}
