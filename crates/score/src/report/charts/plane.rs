//! Plot area for shares from 0 to 1.

use scaleproof_plot::Anchor::{End, Middle};
use scaleproof_plot::{BLACK, FAINT, Mark, NOTE};

/// Plot area for shares from 0 to 1, one to the right and one up; its size in px.
pub(crate) struct Plane {
    pub width: f64,
    pub height: f64,
}

/// Plot area in which both shares have the same length.
pub(crate) const SQUARE: Plane = Plane {
    width: SIDE,
    height: SIDE,
};
pub(crate) const SIDE: f64 = 180.0;

impl Plane {
    pub(crate) fn at(&self, across: f64, up: f64) -> [f64; 2] {
        [across * self.width, (1.0 - up) * self.height]
    }

    /// Draws lines at 0, 0.5 and 1 with their numbers at x = `left`; upright lines too where `below` has the place of their numbers below the area.
    pub(crate) fn grid(&self, left: f64, below: Option<f64>) -> Vec<Mark> {
        let mut marks = Vec::new();
        for tick in [0.0, 0.5, 1.0] {
            let [x, y] = self.at(tick, tick);
            marks.extend(below.map(|_| Mark::line([x, 0.0], [x, self.height], FAINT)));
            marks.push(Mark::line([0.0, y], [self.width, y], FAINT));
            marks.extend(below.map(|below| Mark::text([x, self.height + below], 9.0, Middle, NOTE, tick)));
            marks.push(Mark::text([left, y + 3.0], 9.0, End, NOTE, tick));
        }
        marks
    }

    /// Draws the title of the upright axis, along it.
    pub(crate) fn upright_title(&self, left: f64, title: &str) -> Mark {
        Mark::text([left, self.height / 2.0], 10.0, Middle, BLACK, title).upright()
    }
}
