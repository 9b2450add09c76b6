//! Page for content that is not tiled: rulers along two edges, captions at the foot, and a free area between them.

use super::frame::PageFrame;
use super::printer::corrected_one;
use super::sheet::{Mark, RectMm, Sheet, TextAnchor};
use super::template::rulers;
use scaleproof_plot::lettering::printable;

const CAPTION_MM: f64 = 2.5;
const LEADING_MM: f64 = 3.3;
const LABEL_MM: f64 = 5.0;
const LABEL_WIDTH_MM: f64 = 24.0;

impl PageFrame {
    /// Returns a sheet with some marks, the rulers, captions at the foot (four lines at most) and a label in the corner, corrected for the printer;
    /// cut out at `trim`.
    pub fn labelled(&self, trim: RectMm, mut marks: Vec<Mark>, captions: &[String], label: &str) -> Sheet {
        let [left_mm, bottom_mm, right_mm, _] = self.printable.edges();
        marks.extend(rulers(self));
        let most_mm = self.printable.width_mm() - LABEL_WIDTH_MM;
        let captions: Vec<String> = captions.iter().rev().map(|line| printable(line)).collect();
        let lines = captions.iter().map(String::as_str);
        marks.extend(Mark::lines(lines, left_mm, (CAPTION_MM, most_mm), |i| {
            bottom_mm + 0.8 + i as f64 * LEADING_MM
        }));
        let room = (LABEL_MM, LABEL_WIDTH_MM - 2.0);
        marks.push(Mark::fitted(
            [right_mm, bottom_mm + 0.8],
            room,
            TextAnchor::Right,
            label,
        ));
        corrected_one(self.sheet(trim, trim, marks), self.setup.stretch())
    }
}
