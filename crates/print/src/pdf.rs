//! Writing of sheets as PDF, by `printpdf`, in true size. The same sheets give the same bytes: no date, no random ids.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

use image::RgbImage;
use lopdf::{Dictionary, Document, Object};
use printpdf::{
    BuiltinFont, Color, CurTransMat, DictItem, ExternalStream, ExternalXObject, Line, LineDashPattern, LinePoint, Op,
    PaintMode, PdfDocument, PdfFontHandle, PdfPage, PdfSaveOptions, Point, Polygon, PolygonRing, Pt, Rect, TextItem,
    TextMatrix, WindingOrder, XObject, XObjectId, XObjectTransform,
};

use super::SheetError;
use super::sheet::{Fill, Mark, RectMm, Sheet, Srgb8, Stamp, TextAnchor, number_of};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering;
use scaleproof_plot::pdf::{PdfError, bytes_of, font, name};

/// Placeholder font of every sheet until [`embed_font`] replaces it. printpdf encodes the text of its built-in fonts in WinAnsi, one byte a letter,
/// which is all a Latin-1 font needs; its own embedding would number the glyphs differently in every file.
const STAND_IN: BuiltinFont = BuiltinFont::Helvetica;

/// Writes the sheets as the pages of one PDF.
///
/// # Errors
/// Only if the PDF library fails; no sheet is refused.
pub fn write(title: &str, sheets: &[Sheet]) -> Result<Vec<u8>, SheetError> {
    let mut pdf = PdfDocument::new(title);
    let mut stamps = Stamps::default();
    for sheet in sheets {
        let marks = sheet.marks.iter();
        let ops = marks.flat_map(|mark| mark_ops(mark, &mut stamps)).collect();
        pdf.pages.push(PdfPage {
            ops,
            ..blank_page(sheet)
        });
    }
    pdf.resources.xobjects.map = stamps.into_objects();
    // Nothing to optimise: images are external streams, and compression comes last.
    let options = PdfSaveOptions {
        image_optimization: None,
        ..PdfSaveOptions::default()
    };
    let mut document = pdf.to_lopdf_document(&options, &mut Vec::new());
    finish(&mut document, title, sheets).map_err(|e| PdfError { reason: e.to_string() })?;
    Ok(bytes_of(document)?)
}

fn blank_page(sheet: &Sheet) -> PdfPage {
    let mut page = PdfPage::new(printpdf::Mm(0.0), printpdf::Mm(0.0), Vec::new());
    let whole = Rect::from_wh(pt(sheet.width_mm), pt(sheet.height_mm));
    (page.media_box, page.crop_box, page.trim_box) = (whole.clone(), whole.clone(), whole);
    page
}

/// Sets the entries that printpdf does not write, or writes differently on every run.
fn finish(document: &mut Document, title: &str, sheets: &[Sheet]) -> Result<(), lopdf::Error> {
    // ViewerPreferences /PickTrayByPDFSize came with PDF 1.7 (ISO 32000-1, table 150).
    document.version = "1.7".to_owned();
    let preferences = Dictionary::from_iter([
        ("PrintScaling", name("None")),
        ("PickTrayByPDFSize", Object::Boolean(true)),
        ("DisplayDocTitle", Object::Boolean(true)),
    ]);
    document.catalog_mut()?.set("ViewerPreferences", preferences);
    embed_font(document);
    let pages: Vec<_> = document.page_iter().collect();
    for (page, sheet) in pages.into_iter().zip(sheets) {
        // printpdf writes a box as x, y, width, height; a PDF requires two corners.
        let page = document.get_object_mut(page)?.as_dict_mut()?;
        page.set("TrimBox", corners(sheet.trim));
        page.set("BleedBox", corners(sheet.bleed));
    }
    let info = Dictionary::from_iter([
        ("Title", lopdf::text_string(title)),
        (
            "Creator",
            lopdf::text_string(concat!("scaleproof ", env!("CARGO_PKG_VERSION"))),
        ),
        ("Producer", lopdf::text_string("printpdf")),
    ]);
    if let Ok(old) = document.trailer.get(b"Info").and_then(Object::as_reference) {
        document.set_object(old, info);
    }
    Ok(())
}

/// Replaces the placeholder by the embedded font, so that text looks the same on any machine.
fn embed_font(document: &mut Document) {
    let is_stand_in = |object: &Object| {
        let base_font = object.as_dict().and_then(|dict| dict.get(b"BaseFont"));
        let name = base_font.and_then(Object::as_name);
        name.is_ok_and(|name| name == STAND_IN.get_id().as_bytes())
    };
    let found = document.objects.iter().find(|(_, object)| is_stand_in(object));
    if let Some(id) = found.map(|(id, _)| *id) {
        let font = font(document);
        document.set_object(id, font);
    }
}

fn corners(area: RectMm) -> Vec<Object> {
    area.edges().map(|mm| Object::Real(points(mm) as f32)).to_vec()
}

/// Stamps and images used so far; each becomes one XObject however often it is placed.
#[derive(Default)]
struct Stamps {
    stamps: Vec<Arc<Stamp>>,
    images: Vec<Arc<RgbImage>>,
}

impl Stamps {
    fn id_of(&mut self, stamp: &Arc<Stamp>) -> XObjectId {
        XObjectId(format!("Stamp{}", number_of(&mut self.stamps, stamp).0))
    }

    fn id_of_image(&mut self, image: &Arc<RgbImage>) -> XObjectId {
        XObjectId(format!("Picture{}", number_of(&mut self.images, image).0))
    }

    fn into_objects(self) -> BTreeMap<XObjectId, XObject> {
        let stamps = self.stamps.iter().enumerate();
        let forms = stamps.map(|(i, stamp)| (XObjectId(format!("Stamp{i}")), form(stamp)));
        let images = self.images.iter().enumerate();
        let images = images.map(|(i, image)| (XObjectId(format!("Picture{i}")), image_object(image)));
        forms.chain(images).collect()
    }
}

/// Creates a lossless image XObject with every pixel unchanged: printpdf's own image type goes through its optimiser.
fn image_object(image: &RgbImage) -> XObject {
    let number = |n: u32| DictItem::Int(i64::from(n));
    let entries = [
        ("Subtype", named("Image")),
        ("Width", number(image.width())),
        ("Height", number(image.height())),
        ("ColorSpace", named("DeviceRGB")),
        ("BitsPerComponent", number(8)),
        ("Interpolate", DictItem::Bool(false)),
    ];
    external(entries, image.as_raw().clone())
}

fn named(name: &str) -> DictItem {
    DictItem::Name(name.as_bytes().to_vec())
}

fn external(entries: impl IntoIterator<Item = (&'static str, DictItem)>, content: Vec<u8>) -> XObject {
    let entries = [("Type", named("XObject"))].into_iter().chain(entries);
    let stream = ExternalStream {
        dict: entries.map(|(key, item)| (key.to_owned(), item)).collect(),
        content,
        compress: true,
    };
    XObject::External(ExternalXObject {
        stream,
        width: None,
        height: None,
        dpi: None,
    })
}

/// Creates a form XObject. printpdf's own form type cannot carry the required BBox, so this is an "external" stream.
fn form(stamp: &Stamp) -> XObject {
    let edges = stamp.bounds.edges();
    let bounds = edges.map(|mm| DictItem::Real(points(mm) as f32)).to_vec();
    let entries = [
        ("Subtype", named("Form")),
        ("BBox", DictItem::Array(bounds)),
        ("Resources", DictItem::Dict { map: BTreeMap::new() }),
    ];
    let mut content = String::new();
    for fill in &stamp.fills {
        let [r, g, b] = fill.colour.map(unit);
        let area = fill.area;
        let [x, y, w, h] = [area.left_mm, area.bottom_mm, area.width_mm(), area.height_mm()].map(points);
        // Writing to a String cannot fail.
        let _ = writeln!(content, "{r} {g} {b} rg {x} {y} {w} {h} re f");
    }
    external(entries, content.into_bytes())
}

fn mark_ops(mark: &Mark, stamps: &mut Stamps) -> Vec<Op> {
    let fill = |colour: Srgb8| Op::SetFillColor { col: color(colour) };
    match mark {
        Mark::Fill(Fill { area, colour }) => vec![fill(*colour), rectangle(*area, PaintMode::Fill)],
        Mark::Line(line) => {
            let solid = LineDashPattern::solid;
            let dashed = |(dash, gap)| LineDashPattern::new(0.0, &[pt(dash).0, pt(gap).0]);
            let dash = line.dash_mm.map_or_else(solid, dashed);
            let drawn = Line {
                points: [line.from, line.to].iter().map(line_point).collect(),
                is_closed: false,
            };
            vec![
                Op::SetOutlineColor {
                    col: color(line.colour),
                },
                Op::SetOutlineThickness { pt: pt(line.width_mm) },
                Op::SetLineDashPattern { dash },
                Op::DrawLine { line: drawn },
            ]
        }
        Mark::Text(line) => {
            let (at, width_mm) = (line.at, lettering::width_mm(&line.text, line.size_mm));
            let left_mm = match line.anchor {
                TextAnchor::Left => at[0],
                TextAnchor::Centre => at[0] - 0.5 * width_mm,
                TextAnchor::Right => at[0] - width_mm,
            };
            vec![
                Op::StartTextSection,
                fill(line.colour),
                Op::SetFont {
                    font: PdfFontHandle::Builtin(STAND_IN),
                    size: pt(line.size_mm),
                },
                Op::SetTextMatrix {
                    matrix: TextMatrix::Translate(pt(left_mm), pt(at[1])),
                },
                Op::ShowText {
                    items: vec![TextItem::Text(line.text.clone())],
                },
                Op::EndTextSection,
            ]
        }
        Mark::Area { outlines, colour } => vec![fill(*colour), polygon(outlines, PaintMode::Fill)],
        Mark::Cut { .. } => Vec::new(),
        // An empty path would clip nothing.
        Mark::Clipped { to, .. } if to.is_empty() => Vec::new(),
        Mark::Clipped { to, marks } => {
            let inner = marks.iter().flat_map(|mark| mark_ops(mark, stamps));
            saved([polygon(to, PaintMode::Clip)].into_iter().chain(inner))
        }
        Mark::Image { image, area } => {
            let [x, y, width, height] = corner_and_size(*area).map(|pt| pt.0);
            let transform = XObjectTransform {
                no_auto_scale: true,
                ..XObjectTransform::default()
            };
            let id = stamps.id_of_image(image);
            // An image fills the unit square of its frame.
            let matrix = CurTransMat::Raw([width, 0.0, 0.0, height, x, y]);
            saved([Op::SetTransformationMatrix { matrix }, Op::UseXobject { id, transform }])
        }
        Mark::Stamped { stamp, at, clip } => {
            let id = stamps.id_of(stamp);
            let places = at.iter().map(|place| Op::UseXobject {
                id: id.clone(),
                transform: XObjectTransform {
                    translate_x: Some(pt(place[0])),
                    translate_y: Some(pt(place[1])),
                    no_auto_scale: true,
                    ..XObjectTransform::default()
                },
            });
            saved([rectangle(*clip, PaintMode::Clip)].into_iter().chain(places))
        }
    }
}

/// Wraps operations so that their clip and transformation end with them.
fn saved(ops: impl IntoIterator<Item = Op>) -> Vec<Op> {
    let inner = [Op::SaveGraphicsState].into_iter().chain(ops);
    inner.chain([Op::RestoreGraphicsState]).collect()
}

fn corner_and_size(area: RectMm) -> [Pt; 4] {
    [area.left_mm, area.bottom_mm, area.width_mm(), area.height_mm()].map(pt)
}

fn rectangle(area: RectMm, mode: PaintMode) -> Op {
    let [x, y, width, height] = corner_and_size(area);
    let rectangle = Rect {
        x,
        y,
        width,
        height,
        mode: Some(mode),
        winding_order: Some(WindingOrder::NonZero),
    };
    Op::DrawRectangle { rectangle }
}

fn line_point(p: &Point2) -> LinePoint {
    let p = Point {
        x: pt(p[0]),
        y: pt(p[1]),
    };
    LinePoint { p, bezier: false }
}

fn polygon(outlines: &[Vec<Point2>], mode: PaintMode) -> Op {
    let ring = |outline: &Vec<Point2>| PolygonRing {
        points: outline.iter().map(line_point).collect(),
    };
    let polygon = Polygon {
        rings: outlines.iter().map(ring).collect(),
        mode,
        winding_order: WindingOrder::NonZero,
    };
    Op::DrawPolygon { polygon }
}

/// Converts millimetres to points, in double precision and to a thousandth of a point (0.35 µm). printpdf's own `Mm` works in single precision with a
/// factor of seven digits, and shorter numbers make a shorter file.
fn points(mm: f64) -> f64 {
    (mm * 72.0 / 25.4 * 1000.0).round() / 1000.0
}

/// Converts millimetres to points as `printpdf` has them.
pub fn pt(mm: f64) -> Pt {
    Pt(points(mm) as f32)
}

/// Converts an 8-bit channel to 0–1, with enough digits to restore the same 8 bits.
fn unit(channel: u8) -> f64 {
    (f64::from(channel) / 255.0 * 10_000.0).round() / 10_000.0
}

fn color(colour: Srgb8) -> Color {
    let [r, g, b] = colour.map(|channel| unit(channel) as f32);
    Color::Rgb(printpdf::Rgb {
        r,
        g,
        b,
        icc_profile: None,
    })
}
