//! Sheets → SVG, one file a sheet: what Inkscape opens as a page, and what a cutter's program places as one job.
//!
//! A user unit is a millimetre. Whatever is printed is in the layer "print"; the layer "cut" holds the outline of the piece,
//! and of what is cut out of it, and is hidden, so that it is on paper only where someone wants it. Text stays text, in [`lettering::FAMILY`] where that is
//! installed and squeezed to the same width where it is not.

use std::fmt::Write;
use std::io::Cursor;
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine};
use image::{ImageFormat, RgbImage};

use super::sheet::{Fill, Mark, PointMm, RectMm, Sheet, Srgb8, Stamp, TextAnchor};
use scaleproof_plot::lettering::{self, FAMILY};

/// Writes one sheet. The same sheet gives the same text.
pub fn write(title: &str, sheet: &Sheet) -> String {
    let [width, height] = [sheet.width_mm, sheet.height_mm].map(length);
    let page = SvgPage::of(sheet);
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
        page.cut_shapes(sheet.trim),
    )
}

const CUT_LINE: &str = "fill=\"none\" stroke=\"#ff0000\" stroke-width=\"0.1\"";

/// A sheet on its way to SVG, whose y runs down.
struct SvgPage {
    height_mm: f64,
    stamps: Vec<Arc<Stamp>>,
    images: Vec<Arc<RgbImage>>,
    clips: usize,
    definitions: String,
    content: String,
    /// What a cutter follows besides the trim.
    cuts: String,
    /// False where an outline is cut instead of the trim.
    cuts_trim: bool,
}

impl SvgPage {
    fn of(sheet: &Sheet) -> Self {
        let mut page = Self {
            height_mm: sheet.height_mm,
            stamps: Vec::new(),
            images: Vec::new(),
            clips: 0,
            definitions: String::new(),
            content: String::new(),
            cuts: String::new(),
            cuts_trim: true,
        };
        sheet.marks.iter().for_each(|mark| page.mark(mark));
        page
    }

    // Writing to a String cannot fail, so the results below are dropped.
    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Fill(Fill { area, colour }) => {
                let (rect, fill) = (self.corner_and_size(*area), hex(*colour));
                let _ = writeln!(self.content, "<rect {rect} fill=\"{fill}\"/>");
            }
            Mark::Line {
                from,
                to,
                width_mm,
                dash_mm,
                colour,
            } => self.line([*from, *to], *width_mm, *dash_mm, *colour),
            Mark::Text {
                at,
                size_mm,
                anchor,
                text,
                colour,
            } => self.text(*at, *size_mm, *anchor, text, *colour),
            Mark::Area { outlines, colour } => self.filled(outlines, *colour),
            Mark::Stamped { stamp, at, clip } => self.stamped(stamp, at, *clip),
            Mark::Clipped { to, marks } => {
                let path = self.path(to);
                self.clip(&format!("<path d=\"{path}\"/>"));
                marks.iter().for_each(|mark| self.mark(mark));
                self.content.push_str("</g>\n");
            }
            Mark::Cut { outlines, is_piece } => {
                self.cut(outlines);
                self.cuts_trim &= !is_piece;
            }
            Mark::Image { image, area } => self.image(image, *area),
        }
    }

    /// One path, so that outlines which share an edge show no hairline; SVG fills by the nonzero rule, as the PDF does.
    fn filled(&mut self, outlines: &[Vec<PointMm>], colour: Srgb8) {
        let path = self.path(outlines);
        let _ = writeln!(self.content, "<path d=\"{path}\" fill=\"{}\"/>", hex(colour));
    }

    fn path(&self, outlines: &[Vec<PointMm>]) -> String {
        outlines.iter().map(|outline| self.closed(outline)).collect()
    }

    /// A PNG inside the file, whose pixels stay squares where they are enlarged; it stands there once, however often it is placed.
    fn image(&mut self, image: &Arc<RgbImage>, area: RectMm) {
        let known = self.images.iter().position(|known| Arc::ptr_eq(known, image));
        let number = known.unwrap_or_else(|| self.define_image(image));
        let [x, y] = [area.left_mm, self.height_mm - area.top_mm].map(length);
        let [width, height] = [area.width_mm(), area.height_mm()].map(length);
        let _ = writeln!(
            self.content,
            "<use xlink:href=\"#image{number}\" transform=\"translate({x} {y}) scale({width} {height})\"/>"
        );
    }

    /// As a square of 1 mm.
    fn define_image(&mut self, image: &Arc<RgbImage>) -> usize {
        let number = self.images.len();
        self.images.push(Arc::clone(image));
        let mut png = Cursor::new(Vec::new());
        // Encoding into memory cannot fail: the image is not empty and 8-bit RGB.
        let _ = image.write_to(&mut png, ImageFormat::Png);
        let data = BASE64_STANDARD.encode(png.into_inner());
        let _ = writeln!(
            self.definitions,
            "<image id=\"image{number}\" width=\"1\" height=\"1\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
             xlink:href=\"data:image/png;base64,{data}\"/>"
        );
        number
    }

    /// Opens a group that shows only what lies inside a shape.
    fn clip(&mut self, shape: &str) {
        let clip = self.clips;
        self.clips += 1;
        let _ = writeln!(self.definitions, "<clipPath id=\"clip{clip}\">{shape}</clipPath>");
        let _ = writeln!(self.content, "<g clip-path=\"url(#clip{clip})\">");
    }

    /// A path an outline, so that a cutter can order them.
    fn cut(&mut self, outlines: &[Vec<PointMm>]) {
        for outline in outlines {
            let shape = format!("<path d=\"{}\"", self.closed(outline));
            let _ = writeln!(self.cuts, "{shape} {CUT_LINE}/>");
        }
    }

    fn closed(&self, outline: &[PointMm]) -> String {
        let mut path = String::new();
        for (i, corner) in outline.iter().enumerate() {
            let (x, y) = self.place(*corner);
            let _ = write!(path, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
        }
        path.push('Z');
        path
    }

    fn line(&mut self, ends: [PointMm; 2], width_mm: f64, dash_mm: Option<(f64, f64)>, colour: Srgb8) {
        let [(x1, y1), (x2, y2)] = ends.map(|end| self.place(end));
        let dash = dash_mm.map_or(String::new(), |(dash, gap)| {
            format!(" stroke-dasharray=\"{} {}\"", length(dash), length(gap))
        });
        let (stroke, width) = (hex(colour), length(width_mm));
        let _ = writeln!(
            self.content,
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke=\"{stroke}\" stroke-width=\"{width}\"{dash}/>"
        );
    }

    fn text(&mut self, at: PointMm, size_mm: f64, anchor: TextAnchor, text: &str, colour: Srgb8) {
        let (x, y) = self.place(at);
        let anchor = match anchor {
            TextAnchor::Left => "start",
            TextAnchor::Centre => "middle",
            TextAnchor::Right => "end",
        };
        let (size, width) = (length(size_mm), length(lettering::width_mm(text, size_mm)));
        let _ = writeln!(
            self.content,
            "<text x=\"{x}\" y=\"{y}\" font-family=\"{FAMILY}, Verdana, sans-serif\" font-size=\"{size}\" \
             text-anchor=\"{anchor}\" textLength=\"{width}\" lengthAdjust=\"spacingAndGlyphs\" fill=\"{}\">{}</text>",
            hex(colour),
            escaped(text)
        );
    }

    fn stamped(&mut self, stamp: &Arc<Stamp>, at: &[PointMm], clip: RectMm) {
        let stamp = self.stamp(stamp);
        let clip_rect = self.corner_and_size(clip);
        self.clip(&format!("<rect {clip_rect}/>"));
        for place in at {
            let (x, y) = self.place(*place);
            let _ = writeln!(self.content, "<use xlink:href=\"#stamp{stamp}\" x=\"{x}\" y=\"{y}\"/>");
        }
        self.content.push_str("</g>\n");
    }

    /// The number of a stamp, which is defined when it is first met.
    fn stamp(&mut self, stamp: &Arc<Stamp>) -> usize {
        if let Some(known) = self.stamps.iter().position(|known| Arc::ptr_eq(known, stamp)) {
            return known;
        }
        let number = self.stamps.len();
        self.stamps.push(Arc::clone(stamp));
        let _ = writeln!(self.definitions, "<g id=\"stamp{number}\">");
        for Fill { area, colour } in &stamp.fills {
            let rect = rect(area.left_mm, -area.top_mm, *area);
            let _ = writeln!(self.definitions, "<rect {rect} fill=\"{}\"/>", hex(*colour));
        }
        self.definitions.push_str("</g>\n");
        number
    }

    /// Everything a cutter follows, the trim last.
    fn cut_shapes(&self, trim: RectMm) -> String {
        let mut shapes = self.cuts.clone();
        if self.cuts_trim {
            let _ = writeln!(shapes, "<rect {} {CUT_LINE}/>", self.corner_and_size(trim));
        }
        shapes
    }

    fn place(&self, p: PointMm) -> (String, String) {
        (length(p.x_mm), length(self.height_mm - p.y_mm))
    }

    fn corner_and_size(&self, area: RectMm) -> String {
        rect(area.left_mm, self.height_mm - area.top_mm, area)
    }
}

/// The attributes of a rectangle with its top-left corner at (x, y).
fn rect(x: f64, y: f64, area: RectMm) -> String {
    let [x, y, width, height] = [x, y, area.width_mm(), area.height_mm()].map(length);
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// Millimetres to a tenth of a micrometre, without trailing zeros.
fn length(mm: f64) -> String {
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

/// Text for XML. Control characters, which no XML may hold, become question marks.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            c if c.is_control() => safe.push('?'),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_break_the_file() {
        assert_eq!(escaped("a<b>&\"c\"\u{7}"), "a&lt;b&gt;&amp;&quot;c&quot;?");
    }

    #[test]
    fn lengths_are_plain() {
        assert_eq!([0.0, -0.00001, 7.375, 100.0].map(length), ["0", "0", "7.375", "100"]);
    }
}
