//! Charts for papers: a drawing as a PDF of one page with its font embedded.

use std::collections::BTreeSet;
use std::fmt::Write;

use lopdf::{Dictionary, Document, Object, Stream, dictionary};

use crate::mark::{Colour, Mark, Shape, Text};
use crate::pdf::{self, PdfError};
use crate::{Drawing, lettering};

/// Points per CSS pixel.
const POINTS: f64 = 0.75;

impl Drawing {
    /// Returns a PDF file, whose title is the label.
    ///
    /// # Errors
    /// Only if the PDF library fails; no mark is refused.
    pub fn pdf(&self) -> Result<Vec<u8>, PdfError> {
        let [left, top, width, height] = self.area;
        let mut page = Page {
            size: [width, height],
            content: format!("{POINTS} 0 0 -{POINTS} {} {} cm\n", points(-left), points(top + height)),
            opacities: BTreeSet::new(),
        };
        self.marks.iter().for_each(|mark| page.draw(mark));
        pdf::bytes_of(page.document(&self.label))
    }
}

/// Page drawn so far, in PDF's operators (ISO 32000-1, annex A).
struct Page {
    /// Size in CSS pixels.
    size: [f64; 2],
    content: String,
    /// Opacities used, in hundredths, except 100.
    opacities: BTreeSet<u32>,
}

impl Page {
    fn draw(&mut self, mark: &Mark) {
        match &mark.shape {
            Shape::Group([x, y], marks) => {
                self.put(format_args!("q 1 0 0 1 {x} {y} cm"));
                marks.iter().for_each(|mark| self.draw(mark));
                self.put(format_args!("Q"));
            }
            Shape::Text(text) => self.text(mark, text),
            Shape::Line([[x1, y1], [x2, y2]]) => self.paint(mark, &format!("{x1} {y1} m {x2} {y2} l")),
            Shape::Polyline(points) => self.paint(mark, &through(points)),
            Shape::Polygon(points) => self.paint(mark, &(through(points) + " h")),
            Shape::Rect([x, y], [w, h]) => self.paint(mark, &format!("{x} {y} {w} {h} re")),
            Shape::Circle([x, y], radius) => self.paint(mark, &circle(*x, *y, *radius)),
        }
    }

    fn put(&mut self, operators: std::fmt::Arguments) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.content, "{operators}");
    }

    fn paint(&mut self, mark: &Mark, path: &str) {
        if let Some(fill) = mark.fill {
            let (opacity, rgb) = (self.opacity(mark.opacity), shares(fill));
            self.put(format_args!("q {opacity}{rgb} rg {path} f Q"));
        }
        if let Some((colour, width)) = mark.stroke {
            let rgb = shares(colour);
            let dashes = if mark.is_dashed { "4 3" } else { "" };
            let join = u8::from(matches!(mark.shape, Shape::Polyline(_)));
            self.put(format_args!("q {rgb} RG {width} w {join} j [{dashes}] 0 d {path} S Q"));
        }
    }

    /// Returns the operator that sets an opacity; empty for full opacity.
    fn opacity(&mut self, share: f64) -> String {
        let hundredths = (share.clamp(0.0, 1.0) * 100.0).round() as u32;
        if hundredths == 100 {
            return String::new();
        }
        self.opacities.insert(hundredths);
        format!("/O{hundredths} gs ")
    }

    fn text(&mut self, mark: &Mark, text: &Text) {
        let (words, size) = (latin_1(&text.words), text.size);
        let before = [0.0, 0.5, 1.0][text.anchor as usize] * lettering::width_mm(&words, size);
        // The page is flipped, as charts have y down; letters are flipped back.
        let place = match text.at {
            [x, y] if text.is_upright => format!("0 -1 -1 0 {x} {}", y + before),
            [x, y] => format!("1 0 0 -1 {} {y}", x - before),
        };
        let letters: String = words.chars().map(|c| format!("{:02x}", win_ansi(c))).collect();
        let shown = format!("BT /F {size} Tf {place} Tm");
        if let Some((colour, width)) = mark.stroke {
            let rgb = shares(colour);
            self.put(format_args!(
                "q {rgb} RG {width} w 1 j {shown} 1 Tr <{letters}> Tj ET Q"
            ));
        }
        if let Some(fill) = mark.fill.map(shares) {
            // There is one font: bold text has a stroke of its own colour.
            let bold = text.is_bold.then(|| format!("{fill} RG {} w 2 Tr ", 0.035 * size));
            let bold = bold.unwrap_or_default();
            self.put(format_args!("q {fill} rg {shown} {bold}<{letters}> Tj ET Q"));
        }
    }

    fn document(self, title: &str) -> Document {
        let mut document = Document::with_version("1.7");
        let font = pdf::font(&mut document);
        let font = document.add_object(font);
        let mut states = Dictionary::new();
        for hundredths in self.opacities {
            let share = hundredths as f32 / 100.0;
            states.set(
                format!("O{hundredths}"),
                dictionary! { "Type" => "ExtGState", "ca" => share },
            );
        }
        let resources = dictionary! { "Font" => dictionary! { "F" => font }, "ExtGState" => states };
        let content = document.add_object(Stream::new(Dictionary::new(), self.content.into_bytes()));
        let pages = document.new_object_id();
        let whole = [0.0, 0.0, points(self.size[0]), points(self.size[1])].map(|v| Object::Real(v as f32));
        let page = document.add_object(dictionary! {
            "Type" => "Page",
            "Parent" => pages,
            "MediaBox" => whole.to_vec(),
            "Resources" => resources,
            "Contents" => content,
        });
        let kids = vec![Object::Reference(page)];
        document.set_object(pages, dictionary! { "Type" => "Pages", "Kids" => kids, "Count" => 1 });
        let catalogue = document.add_object(dictionary! { "Type" => "Catalog", "Pages" => pages });
        let creator = concat!("scaleproof ", env!("CARGO_PKG_VERSION"));
        let info = document.add_object(dictionary! {
            "Title" => lopdf::text_string(title),
            "Creator" => lopdf::text_string(creator),
        });
        document.trailer.set("Root", catalogue);
        document.trailer.set("Info", info);
        document
    }
}

/// Converts pixels to points, rounded to a thousandth of a point.
fn points(pixels: f64) -> f64 {
    (pixels * POINTS * 1000.0).round() / 1000.0
}

/// Formats three channels from 0 to 1, as PDF's operators take them.
fn shares(Colour(rgb): Colour) -> String {
    let share = |shift: u32| f64::from(rgb >> shift & 0xff) / 255.0;
    format!("{:.4} {:.4} {:.4}", share(16), share(8), share(0))
}

fn through(points: &[[f64; 2]]) -> String {
    let step = |(i, [x, y]): (usize, &[f64; 2])| format!("{x} {y} {}", if i == 0 { "m" } else { "l" });
    points.iter().enumerate().map(step).collect::<Vec<_>>().join(" ")
}

/// Returns a circle of four Bézier curves, with an error of at most 0.03 % of the radius.
fn circle(x: f64, y: f64, r: f64) -> String {
    let k = 0.552_284_75 * r;
    let (left, right, top, bottom) = (x - r, x + r, y - r, y + r);
    format!(
        "{right} {y} m {right} {} {} {bottom} {x} {bottom} c {} {bottom} {left} {} {left} {y} c {left} {} {} {top} {x} {top} c {} {top} {right} {} \
         {right} {y} c h",
        y + k,
        x + k,
        x - k,
        y + k,
        y - k,
        x - k,
        x + k,
        y - k
    )
}

/// Returns the text in the characters that the font has.
fn latin_1(text: &str) -> String {
    let text = text
        .replace(['−', '–'], "-")
        .replace('→', "to")
        .replace(['“', '”'], "\"");
    lettering::printable(&text.replace('≥', ">=").replace('≤', "<="))
}

fn win_ansi(c: char) -> u8 {
    match c {
        '…' => 0x85,
        c => u8::try_from(u32::from(c)).unwrap_or(b'?'),
    }
}
