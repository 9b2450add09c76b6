//! The one font of every sheet, embedded, so that a print shop's machine letters it as ours does.

use lopdf::{Document, Object};
use printpdf::BuiltinFont;

use scaleproof_plot::pdf::font;

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
