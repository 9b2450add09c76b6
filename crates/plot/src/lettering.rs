//! Width of text, and fitting it.
//!
//! All sheets use DejaVu Sans (`fonts`).

pub use scaleproof_core::geometry::length::number;

/// Name of the font where it is not embedded (SVG).
pub const FAMILY: &str = "DejaVu Sans";
/// Height of capitals, as a share of the em (its `H` is 1493 of 2048 units high).
pub const CAP_HEIGHT: f64 = 0.729;

/// Advance widths of the characters space to tilde in thousandths of the em (the font's `hmtx` table).
#[rustfmt::skip]
const ASCII_WIDTHS: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,
    636, 636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531,
    1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,
    603, 787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500,
    500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,
    635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];

/// Advance widths of the characters 0xa1 to 0xff in thousandths of the em (the font's `hmtx` table).
#[rustfmt::skip]
const LATIN_1_WIDTHS: [u16; 95] = [
    401, 636, 636, 636, 636, 337, 500, 500, 1000, 471, 612, 838, 361, 1000, 500,
    500, 838, 401, 401, 500, 636, 636, 318, 500, 401, 471, 612, 969, 969, 969, 531,
    684, 684, 684, 684, 684, 684, 974, 698, 632, 632, 632, 632, 295, 295, 295, 295,
    775, 748, 787, 787, 787, 787, 787, 838, 787, 732, 732, 732, 732, 611, 605, 630,
    613, 613, 613, 613, 613, 613, 982, 550, 615, 615, 615, 615, 278, 278, 278, 278,
    612, 634, 612, 612, 612, 612, 612, 838, 612, 634, 634, 634, 634, 592, 635, 592,
];

pub fn size((width, height): (f64, f64)) -> String {
    format!("{} × {}", number(width), number(height))
}

pub fn width_mm(text: &str, size_mm: f64) -> f64 {
    let advance_em = |c| f64::from(thousandths(c)) / 1000.0;
    text.chars().map(advance_em).sum::<f64>() * size_mm
}

/// Returns the advance width in thousandths of the em. A character that the font lacks counts as the widest, so that text measured to fit does fit.
pub fn thousandths(c: char) -> u16 {
    match c {
        ' '..='~' => ASCII_WIDTHS[c as usize - ' ' as usize],
        '\u{a1}'..='\u{ff}' => LATIN_1_WIDTHS[c as usize - 0xa1],
        _ => 1000,
    }
}

/// Returns the text with every character that the font cannot show (outside Latin-1 and the ellipsis) as a question mark.
pub fn printable(text: &str) -> String {
    let is_known = |c: &char| matches!(c, ' '..='~' | '\u{a1}'..='\u{ff}' | '…');
    text.chars().map(|c| Some(c).filter(is_known).unwrap_or('?')).collect()
}

/// Returns the text, with as much of its middle replaced by an ellipsis as is needed to stay within `most_mm`.
pub fn shortened(text: &str, size_mm: f64, most_mm: f64) -> String {
    let letters: Vec<char> = text.chars().collect();
    let mut kept = letters.len();
    let mut short = text.to_owned();
    while kept > 0 && width_mm(&short, size_mm) > most_mm {
        kept -= 1;
        let tail = kept / 2;
        let head = letters[..kept - tail].iter();
        short = head.chain(&['…']).chain(&letters[letters.len() - tail..]).collect();
    }
    short
}

/// Breaks the text at spaces into lines of at most `most_mm`. A wider word gets a line of its own.
pub fn wrapped(text: &str, size_mm: f64, most_mm: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_mm(line, size_mm) + width_mm(word, size_mm) + width_mm(" ", size_mm) <= most_mm => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns the size at which a line is at most `most_mm` wide: `size_mm`, or smaller.
pub fn fitting_size_mm(text: &str, size_mm: f64, most_mm: f64) -> f64 {
    size_mm.min(size_mm * most_mm / width_mm(text, size_mm).max(f64::MIN_POSITIVE))
}
