//! Common parts of all PDFs of this program: the one font, embedded, and an identifier derived from the content.

use std::io::Write;
use std::sync::Mutex;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use lopdf::{Dictionary, Document, Object, Stream, StringFormat, dictionary};

use crate::lettering;
use scaleproof_core::{files, workers};

/// Error for a PDF that could not be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the PDF could not be put together: {reason}")]
pub struct PdfError {
    pub reason: String,
}

/// DejaVu Sans, Latin-1 only; its origin and licence are in `crates/core/fonts`.
const FILE: &[u8] = scaleproof_core::FONT;
/// Font name with the tag of a subset (ISO 32000-1, 9.6.4).
const NAME: &str = "LATINA+DejaVuSans";

/// Compresses and saves, with an identifier derived from the content instead of printpdf's counter.
pub fn bytes_of(mut document: Document) -> Result<Vec<u8>, PdfError> {
    let failed = |e: std::io::Error| PdfError { reason: e.to_string() };
    compress(&mut document);
    document.trailer.remove(b"ID");
    let mut bytes = Vec::new();
    document.save_to(&mut bytes).map_err(failed)?;
    let hash = files::sha256_hex(&bytes).into_bytes()[..32].to_vec();
    let id = Object::String(hash, StringFormat::Literal);
    document.trailer.set("ID", vec![id.clone(), id]);
    bytes.clear();
    document.save_to(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

/// Compresses streams on all cores, since images of sheets are much work. A stream that cannot be compressed stays unchanged.
fn compress(document: &mut Document) {
    let streams = document
        .objects
        .values_mut()
        .filter_map(|object| object.as_stream_mut().ok());
    let streams: Vec<_> = streams
        .filter(|stream| stream.allows_compression)
        .map(Mutex::new)
        .collect();
    workers::each(&streams, |stream| {
        if let Ok(mut stream) = stream.lock() {
            let _ = compress_one(&mut stream);
        }
    });
}

/// Compresses a stream at zlib's default level: the highest, which `lopdf` uses, takes four times as long here for a file that is a thirtieth
/// smaller.
fn compress_one(stream: &mut Stream) -> std::io::Result<()> {
    if stream.dict.has(b"Filter") {
        return Ok(());
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&stream.content)?;
    let compressed = encoder.finish()?;
    if compressed.len() + "/Filter/FlateDecode".len() < stream.content.len() {
        stream.dict.set("Filter", name("FlateDecode"));
        stream.set_content(compressed);
    }
    Ok(())
}

/// Returns a PDF name object.
pub fn name(text: &str) -> Object {
    Object::Name(text.as_bytes().to_vec())
}

/// Returns a simple TrueType font (ISO 32000-1, 9.6.3) and adds its descriptor (9.8).
pub fn font(document: &mut Document) -> Dictionary {
    let length = dictionary! { "Length1" => FILE.len() as i64 };
    let file = document.add_object(Stream::new(length, FILE.to_vec()));
    // Values of the font's head, hhea and glyf tables, in thousandths of the em.
    let bounds = [-1021, -463, 1793, 1232].map(Object::Integer);
    let descriptor = document.add_object(dictionary! {
        "Type" => "FontDescriptor",
        "FontName" => NAME,
        "Flags" => NONSYMBOLIC,
        "FontBBox" => bounds.to_vec(),
        "ItalicAngle" => 0,
        "Ascent" => 928,
        "Descent" => -236,
        "CapHeight" => 729,
        "StemV" => 87,
        "FontFile2" => file,
    });
    let widths = (FIRST..=LAST).map(|code| Object::Integer(width(code)));
    dictionary! {
        "Type" => "Font",
        "Subtype" => "TrueType",
        "BaseFont" => NAME,
        "Encoding" => "WinAnsiEncoding",
        "FirstChar" => FIRST,
        "LastChar" => LAST,
        "Widths" => widths.collect::<Vec<_>>(),
        "FontDescriptor" => descriptor,
    }
}

const FIRST: u8 = 0x20;
const LAST: u8 = 0xff;
/// Font flag 6: the font has the letters of the standard Latin set (ISO 32000-1, table 123).
const NONSYMBOLIC: i64 = 1 << 5;

/// Returns the advance width of a WinAnsi code. It agrees with Latin-1 except for 0x80 to 0x9f, of which only the ellipsis is ever written.
fn width(code: u8) -> i64 {
    match code {
        0x85 => lettering::thousandths('…').into(),
        0x7f..=0xa0 => 0,
        _ => lettering::thousandths(char::from(code)).into(),
    }
}
