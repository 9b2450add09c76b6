//! The one font of every sheet, embedded, so that a print shop's machine letters it as ours does.

use lopdf::{Dictionary, Document, Object, Stream};
use printpdf::BuiltinFont;

use super::name;
use crate::print::lettering;

/// DejaVu Sans, Latin-1 only; where it comes from and its licence are in `print/fonts`.
const FILE: &[u8] = scaleproof_core::FONT;
/// With the tag of a subset (ISO 32000-1, 9.6.4).
const NAME: &str = "LATINA+DejaVuSans";
/// What the pages call their font until [`embed`] exchanges it. printpdf encodes the text of its built-in fonts in WinAnsi,
/// one byte a letter, which is all a Latin-1 font needs; its own embedding would number the glyphs anew for every file.
pub const STAND_IN: BuiltinFont = BuiltinFont::Helvetica;

/// Exchanges the stand-in for the embedded font.
pub fn embed(document: &mut Document) {
    let is_stand_in = |object: &Object| {
        let base_font = object
            .as_dict()
            .and_then(|font| font.get(b"BaseFont"))
            .and_then(Object::as_name);
        base_font.is_ok_and(|base_font| base_font == STAND_IN.get_id().as_bytes())
    };
    let found = document.objects.iter().find(|(_, object)| is_stand_in(object));
    if let Some(id) = found.map(|(id, _)| *id) {
        let font = font(document);
        document.set_object(id, font);
    }
}

/// A simple TrueType font (ISO 32000-1, 9.6.3) and its descriptor (9.8).
pub fn font(document: &mut Document) -> Dictionary {
    let length = Dictionary::from_iter([("Length1", Object::Integer(FILE.len() as i64))]);
    let file = document.add_object(Stream::new(length, FILE.to_vec()));
    // From the font's head, hhea and glyf tables, in thousandths of the em.
    let descriptor = document.add_object(Dictionary::from_iter([
        ("Type", name("FontDescriptor")),
        ("FontName", name(NAME)),
        ("Flags", Object::Integer(NONSYMBOLIC)),
        (
            "FontBBox",
            [-1021, -463, 1793, 1232].map(Object::Integer).to_vec().into(),
        ),
        ("ItalicAngle", Object::Integer(0)),
        ("Ascent", Object::Integer(928)),
        ("Descent", Object::Integer(-236)),
        ("CapHeight", Object::Integer(729)),
        ("StemV", Object::Integer(87)),
        ("FontFile2", Object::Reference(file)),
    ]));
    let widths = (FIRST..=LAST).map(|code| Object::Integer(width(code)));
    Dictionary::from_iter([
        ("Type", name("Font")),
        ("Subtype", name("TrueType")),
        ("BaseFont", name(NAME)),
        ("Encoding", name("WinAnsiEncoding")),
        ("FirstChar", Object::Integer(FIRST.into())),
        ("LastChar", Object::Integer(LAST.into())),
        ("Widths", widths.collect::<Vec<_>>().into()),
        ("FontDescriptor", Object::Reference(descriptor)),
    ])
}

const FIRST: u8 = 0x20;
const LAST: u8 = 0xff;
/// Font flag 6: the font's letters are those of the standard Latin set (ISO 32000-1, table 123).
const NONSYMBOLIC: i64 = 1 << 5;

/// The advance of a WinAnsi code. It agrees with Latin-1 but for 0x80 to 0x9f, of which only the ellipsis is ever written.
fn width(code: u8) -> i64 {
    match code {
        0x85 => lettering::thousandths('…').into(),
        0x7f..=0xa0 => 0,
        _ => lettering::thousandths(char::from(code)).into(),
    }
}
