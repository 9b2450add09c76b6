//! The lines of mesh files that are text, as programs of all systems write them.

use std::borrow::Cow;

pub(super) const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Returns the lines of a text, which old programs for the Macintosh end with a carriage return alone.
pub(super) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.trim_start_matches(BYTE_ORDER_MARK)
        .split(end)
        .map(|line| line.trim_end_matches('\r'))
}

/// Returns the text with lines that end with a backslash joined to the next; every other line keeps its number.
pub(super) fn joined(text: &str) -> Cow<'_, str> {
    if !["\\\n", "\\\r"].iter().any(|end| text.contains(end)) {
        return text.into();
    }
    let (mut whole, mut skipped) = (String::with_capacity(text.len()), String::new());
    for line in lines(text) {
        match line.strip_suffix('\\') {
            Some(start) => {
                whole += start;
                whole.push(' ');
                skipped.push('\n');
            }
            None => {
                whole += line;
                whole.push('\n');
                whole += &std::mem::take(&mut skipped);
            }
        }
    }
    whole.into()
}
