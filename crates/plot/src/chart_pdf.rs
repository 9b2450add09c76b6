//! Charts for papers: the SVG that this program draws, as a PDF of one page with its font inside.
//!
//! Only what our charts are made of is known: groups that are moved or turned, lines, rectangles, polygons, circles, upright and level paths, text.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use lopdf::{Dictionary, Document, Object, Stream, dictionary};
use roxmltree::Node;

use crate::lettering;
use crate::pdf::{self, PdfError};

/// CSS pixels to points.
const POINTS: f64 = 0.75;

/// The PDF of a chart; `title` is what viewers call it.
pub fn pdf_of_svg(title: &str, svg: &str) -> Result<Vec<u8>, PdfError> {
    let failed = |reason: String| PdfError { reason };
    let parsed = roxmltree::Document::parse(svg).map_err(|e| failed(e.to_string()))?;
    let root = parsed.root_element();
    let [width, height] = ["width", "height"].map(|side| number(root, side, 0.0));
    let mut page = Page {
        size: [width, height],
        content: format!("{POINTS} 0 0 -{POINTS} 0 {} cm\n", points(height)),
        opacities: BTreeSet::new(),
    };
    page.draw(root).map_err(failed)?;
    pdf::bytes_of(page.document(title))
}

/// What is drawn so far, in PDF's operators (ISO 32000-1, annex A).
struct Page {
    /// In CSS pixels.
    size: [f64; 2],
    content: String,
    /// In hundredths, those that are not whole.
    opacities: BTreeSet<u32>,
}

impl Page {
    fn draw(&mut self, node: Node) -> Result<(), String> {
        let placed = node.attribute("transform").map(matrix).transpose()?;
        if let Some(m) = placed {
            self.put(format_args!(
                "q {} {} {} {} {} {} cm",
                m[0], m[1], m[2], m[3], m[4], m[5]
            ));
        }
        match node.tag_name().name() {
            "svg" | "g" => node
                .children()
                .filter(Node::is_element)
                .try_for_each(|child| self.draw(child))?,
            "title" => {}
            "text" => self.text(node)?,
            _ => {
                let path = self.path(node)?;
                self.paint(node, &path)?;
            }
        }
        if placed.is_some() {
            self.put(format_args!("Q"));
        }
        Ok(())
    }

    fn put(&mut self, operators: std::fmt::Arguments) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.content, "{operators}");
    }

    fn path(&self, node: Node) -> Result<String, String> {
        let of = |attribute: &str| number(node, attribute, 0.0);
        let side = |attribute: &str, whole: f64| number(node, attribute, whole);
        Ok(match node.tag_name().name() {
            "line" => format!("{} {} m {} {} l", of("x1"), of("y1"), of("x2"), of("y2")),
            "rect" => {
                let [width, height] = [side("width", self.size[0]), side("height", self.size[1])];
                format!("{} {} {width} {height} re", of("x"), of("y"))
            }
            "circle" => circle(of("cx"), of("cy"), of("r")),
            "polyline" => through(node),
            "polygon" => through(node) + " h",
            "path" => straight(node.attribute("d").unwrap_or_default())?,
            other => return Err(format!("the chart has a `{other}`, which is not drawn")),
        })
    }

    fn paint(&mut self, node: Node, path: &str) -> Result<(), String> {
        let fill = inherited(node, "fill").unwrap_or("#000");
        let fill = colour(fill)?.filter(|_| node.tag_name().name() != "line");
        let stroke = colour(inherited(node, "stroke").unwrap_or("none"))?;
        if let Some(rgb) = fill {
            let opacity = self.opacity(number(node, "fill-opacity", 1.0));
            self.put(format_args!("q {opacity}{rgb} rg {path} f Q"));
        }
        if let Some(rgb) = stroke {
            let dashes = node.attribute("stroke-dasharray").unwrap_or_default();
            let width = number(node, "stroke-width", 1.0);
            self.put(format_args!("q {rgb} RG {width} w [{dashes}] 0 d {path} S Q"));
        }
        Ok(())
    }

    /// The operator that sets it; nothing for what is not seen through.
    fn opacity(&mut self, share: f64) -> String {
        let hundredths = (share.clamp(0.0, 1.0) * 100.0).round() as u32;
        if hundredths == 100 {
            return String::new();
        }
        self.opacities.insert(hundredths);
        format!("/O{hundredths} gs ")
    }

    fn text(&mut self, node: Node) -> Result<(), String> {
        let content: String = node
            .descendants()
            .filter_map(|n| n.text().filter(|_| n.is_text()))
            .collect();
        let content = latin_1(&content);
        let size = number(node, "font-size", 16.0);
        let width = lettering::width_mm(&content, size);
        let before = match inherited(node, "text-anchor") {
            Some("middle") => 0.5 * width,
            Some("end") => width,
            _ => 0.0,
        };
        let (x, y) = (number(node, "x", 0.0) - before, number(node, "y", 0.0));
        let fill = colour(inherited(node, "fill").unwrap_or("#000"))?.unwrap_or_default();
        let letters: String = content.chars().map(|c| format!("{:02x}", win_ansi(c))).collect();
        // The page is upside down for SVG's sake; letters are turned back.
        let shown = format!("BT /F {size} Tf 1 0 0 -1 {x} {y} Tm");
        if let Some(halo) = colour(inherited(node, "stroke").unwrap_or("none"))? {
            let width = number(node, "stroke-width", 1.0);
            self.put(format_args!(
                "q {halo} RG {width} w 1 j {shown} 1 Tr <{letters}> Tj ET Q"
            ));
        }
        // There is one font: what is bold has a line of its own colour around it.
        let bold = match inherited(node, "font-weight") {
            Some("600" | "bold") => format!("{fill} RG {} w 2 Tr ", 0.035 * size),
            _ => String::new(),
        };
        self.put(format_args!("q {fill} rg {shown} {bold}<{letters}> Tj ET Q"));
        Ok(())
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

/// To a thousandth of a point.
fn points(pixels: f64) -> f64 {
    (pixels * POINTS * 1000.0).round() / 1000.0
}

/// What stands at an element or at what it is in.
fn inherited<'a>(node: Node<'a, '_>, attribute: &str) -> Option<&'a str> {
    node.ancestors().find_map(|n| n.attribute(attribute))
}

/// A length; `otherwise` stands for what is not there and for all of it (`100%`).
fn number(node: Node, attribute: &str, otherwise: f64) -> f64 {
    let text = node.attribute(attribute).unwrap_or_default();
    text.parse().ok().filter(|v: &f64| v.is_finite()).unwrap_or(otherwise)
}

/// `none`, or three shares of full as PDF's operators take them.
fn colour(text: &str) -> Result<Option<String>, String> {
    let digits = match text.strip_prefix('#') {
        None if text == "none" => return Ok(None),
        Some(short) if short.len() == 3 => short.chars().flat_map(|c| [c, c]).collect(),
        digits => digits.unwrap_or_default().to_owned(),
    };
    let unknown = || format!("the colour `{text}` is not known");
    let rgb = u32::from_str_radix(&digits, 16).map_err(|_| unknown())?;
    if digits.len() != 6 {
        return Err(unknown());
    }
    let share = |shift: u32| f64::from(rgb >> shift & 0xff) / 255.0;
    Ok(Some(format!("{:.4} {:.4} {:.4}", share(16), share(8), share(0))))
}

/// The matrix of an SVG transform, moves and turns in their order, as PDF's six numbers.
///
/// # Errors
/// A transform that none of our charts has.
pub fn matrix(text: &str) -> Result<[f64; 6], String> {
    let unknown = || format!("the transform `{text}` is not known");
    let mut all = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    for step in text.split_inclusive(')') {
        let (what, numbers) = step.trim().trim_end_matches(')').split_once('(').ok_or_else(unknown)?;
        let numbers: Vec<f64> = numbers.split([' ', ',']).filter_map(|n| n.parse().ok()).collect();
        let [a, b, c, d, e, f] = all;
        all = match (what, numbers.as_slice()) {
            ("translate", [x, y]) => [a, b, c, d, a * x + c * y + e, b * x + d * y + f],
            // Lettering along an axis that goes up.
            ("rotate", [angle]) if (angle.to_radians() + FRAC_PI_2).abs() < 1e-9 => [-c, -d, a, b, e, f],
            _ => return Err(unknown()),
        };
    }
    Ok(all)
}

fn through(node: Node) -> String {
    let text = node.attribute("points").unwrap_or_default();
    let corners = text.split_whitespace().filter_map(|corner| corner.split_once(','));
    let parts = corners
        .enumerate()
        .map(|(i, (x, y))| format!("{x} {y} {}", if i == 0 { "m" } else { "l" }));
    parts.collect::<Vec<_>>().join(" ")
}

/// Four Bézier curves, off by at most 0.03 % of the radius.
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

/// Paths of the commands M, H, V and h.
fn straight(text: &str) -> Result<String, String> {
    let unknown = || format!("the path `{text}` is not known");
    let (mut at, mut path) = ([0.0, 0.0], String::new());
    for (start, command) in text.match_indices(|c: char| c.is_ascii_alphabetic()) {
        let rest = &text[start + 1..];
        let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let numbers: Vec<f64> = rest[..end].split([' ', ',']).filter_map(|n| n.parse().ok()).collect();
        at = match (command, numbers.as_slice()) {
            ("M", [x, y]) => [*x, *y],
            ("H", [x]) => [*x, at[1]],
            ("h", [by]) => [at[0] + by, at[1]],
            ("V", [y]) => [at[0], *y],
            _ => return Err(unknown()),
        };
        let _ = write!(path, "{} {} {} ", at[0], at[1], if command == "M" { "m" } else { "l" });
    }
    Ok(path)
}

/// In the letters that the font has.
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
