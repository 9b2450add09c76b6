//! Writing of sheets as SVG, one file per sheet, which Inkscape opens as a page and a cutter's program as one job.
//!
//! A user unit is a millimetre. Printed marks are in the layer "print"; the hidden layer "cut" has the outlines of the piece and of its openings, so
//! that they are printed only on request. Text stays text, in [`lettering::FAMILY`] if that is installed, else squeezed to the same width.

use std::fmt::Write;
use std::io::Cursor;
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine};
use image::{ImageFormat, RgbImage};

use super::sheet::{Fill, Mark, RectMm, Sheet, Srgb8, Stamp, TextAnchor, number_of};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{self, FAMILY};

/// Writes one sheet. The same sheet gives the same text.
pub fn write(title: &str, sheet: &Sheet) -> String {
    let [width, height] = [sheet.width_mm, sheet.height_mm].map(length);
    let page = SvgPage::new(sheet);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<defs>\n{}</defs>\n\
         <g id=\"print\" inkscape:groupmode=\"layer\" inkscape:label=\"print\">\n{}</g>\n\
         <g id=\"cut\" inkscape:groupmode=\"layer\" inkscape:label=\"cut\" style=\"display:none\">\n\
         {}</g>\n</svg>\n",
        escaped(title),
        page.definitions,
        page.content,
        page.cuts,
    )
}

const CUT_LINE: &str = "fill=\"none\" stroke=\"#ff0000\" stroke-width=\"0.1\"";

/// SVG of a sheet under construction; its y points down.
#[derive(Default)]
struct SvgPage {
    height_mm: f64,
    stamps: Vec<Arc<Stamp>>,
    images: Vec<Arc<RgbImage>>,
    clips: usize,
    definitions: String,
    content: String,
    cuts: String,
    /// True if an outline is cut instead of the trim.
    cuts_piece: bool,
}

impl SvgPage {
    fn new(sheet: &Sheet) -> Self {
        let mut page = Self {
            height_mm: sheet.height_mm,
            ..Self::default()
        };
        sheet.marks.iter().for_each(|mark| page.mark(mark));
        if !page.cuts_piece {
            let _ = writeln!(page.cuts, "<rect {} {CUT_LINE}/>", page.corner_and_size(sheet.trim));
        }
        page
    }

    // Writing to a String cannot fail, so the results below are dropped.
    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Fill(Fill { area, colour }) => {
                let (rect, fill) = (self.corner_and_size(*area), hex(*colour));
                let _ = writeln!(self.content, "<rect {rect} fill=\"{fill}\"/>");
            }
            Mark::Line(line) => {
                let [(x1, y1), (x2, y2)] = [line.from, line.to].map(|end| self.place(end));
                let dash = line.dash_mm.map_or(String::new(), |(dash, gap)| {
                    format!(" stroke-dasharray=\"{} {}\"", length(dash), length(gap))
                });
                let (stroke, width) = (hex(line.colour), length(line.width_mm));
                let _ = writeln!(
                    self.content,
                    "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke=\"{stroke}\" stroke-width=\"{width}\"{dash}/>"
                );
            }
            Mark::Text(line) => {
                let (x, y) = self.place(line.at);
                let anchor = match line.anchor {
                    TextAnchor::Left => "start",
                    TextAnchor::Centre => "middle",
                    TextAnchor::Right => "end",
                };
                let width_mm = lettering::width_mm(&line.text, line.size_mm);
                let [size, width] = [line.size_mm, width_mm].map(length);
                let _ = writeln!(
                    self.content,
                    "<text x=\"{x}\" y=\"{y}\" font-family=\"{FAMILY}, Verdana, sans-serif\" font-size=\"{size}\" \
                     text-anchor=\"{anchor}\" textLength=\"{width}\" lengthAdjust=\"spacingAndGlyphs\" fill=\"{}\">{}</text>",
                    hex(line.colour),
                    escaped(&line.text)
                );
            }
            // One path, so that outlines which share an edge show no hairline; SVG fills by the nonzero rule, as the PDF does.
            Mark::Area { outlines, colour } => {
                let path = self.path(outlines);
                let _ = writeln!(self.content, "<path d=\"{path}\" fill=\"{}\"/>", hex(*colour));
            }
            Mark::Stamped { stamp, at, clip } => self.stamped(stamp, at, *clip),
            Mark::Clipped { to, marks } => {
                let path = self.path(to);
                self.clip(&format!("<path d=\"{path}\"/>"));
                marks.iter().for_each(|mark| self.mark(mark));
                self.content.push_str("</g>\n");
            }
            Mark::Cut { outlines, is_piece } => {
                // One path per outline, so that a cutter can order them.
                for outline in outlines {
                    let _ = writeln!(self.cuts, "<path d=\"{}\" {CUT_LINE}/>", self.closed(outline));
                }
                self.cuts_piece |= is_piece;
            }
            Mark::Image { image, area } => self.image(image, *area),
        }
    }

    fn path(&self, outlines: &[Vec<Point2>]) -> String {
        outlines.iter().map(|outline| self.closed(outline)).collect()
    }

    /// Embeds a PNG, whose enlarged pixels stay squares; it is stored once, however often it is placed.
    fn image(&mut self, image: &Arc<RgbImage>, area: RectMm) {
        let (number, is_new) = number_of(&mut self.images, image);
        if is_new {
            let mut png = Cursor::new(Vec::new());
            // Encoding into memory cannot fail: the image is not empty and 8-bit RGB.
            let _ = image.write_to(&mut png, ImageFormat::Png);
            let data = BASE64_STANDARD.encode(png.into_inner());
            // Size: a square of 1 mm.
            let _ = writeln!(
                self.definitions,
                "<image id=\"image{number}\" width=\"1\" height=\"1\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
                 xlink:href=\"data:image/png;base64,{data}\"/>"
            );
        }
        let [x, y] = [area.left_mm, self.height_mm - area.top_mm].map(length);
        let [width, height] = [area.width_mm(), area.height_mm()].map(length);
        let _ = writeln!(
            self.content,
            "<use xlink:href=\"#image{number}\" transform=\"translate({x} {y}) scale({width} {height})\"/>"
        );
    }

    /// Opens a group that is clipped to a shape.
    fn clip(&mut self, shape: &str) {
        let clip = self.clips;
        self.clips += 1;
        let _ = writeln!(self.definitions, "<clipPath id=\"clip{clip}\">{shape}</clipPath>");
        let _ = writeln!(self.content, "<g clip-path=\"url(#clip{clip})\">");
    }

    fn closed(&self, outline: &[Point2]) -> String {
        let mut path = String::new();
        for (i, corner) in outline.iter().enumerate() {
            let (x, y) = self.place(*corner);
            let _ = write!(path, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
        }
        path.push('Z');
        path
    }

    fn stamped(&mut self, stamp: &Arc<Stamp>, at: &[Point2], clip: RectMm) {
        let (number, is_new) = number_of(&mut self.stamps, stamp);
        if is_new {
            let _ = writeln!(self.definitions, "<g id=\"stamp{number}\">");
            for Fill { area, colour } in &stamp.fills {
                let rect = rect(area.left_mm, -area.top_mm, *area);
                let _ = writeln!(self.definitions, "<rect {rect} fill=\"{}\"/>", hex(*colour));
            }
            self.definitions.push_str("</g>\n");
        }
        let clip_rect = self.corner_and_size(clip);
        self.clip(&format!("<rect {clip_rect}/>"));
        for place in at {
            let (x, y) = self.place(*place);
            let _ = writeln!(self.content, "<use xlink:href=\"#stamp{number}\" x=\"{x}\" y=\"{y}\"/>");
        }
        self.content.push_str("</g>\n");
    }

    fn place(&self, p: Point2) -> (String, String) {
        (length(p[0]), length(self.height_mm - p[1]))
    }

    fn corner_and_size(&self, area: RectMm) -> String {
        rect(area.left_mm, self.height_mm - area.top_mm, area)
    }
}

/// Returns the attributes of a rectangle with its top-left corner at (x, y).
fn rect(x: f64, y: f64, area: RectMm) -> String {
    let [x, y, width, height] = [x, y, area.width_mm(), area.height_mm()].map(length);
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// Formats millimetres to a tenth of a micrometre, without trailing zeros.
pub fn length(mm: f64) -> String {
    let text = format!("{mm:.4}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

fn hex([r, g, b]: Srgb8) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes text for XML. Control characters, which XML does not allow, become question marks.
pub fn escaped(text: &str) -> String {
    let letter = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        c if c.is_control() => "?".to_owned(),
        c => c.to_string(),
    };
    text.chars().map(letter).collect()
}
