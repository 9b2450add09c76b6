//! How wide text is, and how it is made to fit.
//!
//! Every sheet is lettered in Helvetica, one of the 14 fonts each PDF reader has (ISO 32000-1, 9.6.2.2).

/// Height of capitals and digits, as a share of the em (Adobe Helvetica AFM, `CapHeight 718`).
pub const CAP_HEIGHT: f64 = 0.718;

/// Advance widths of the characters space to tilde in thousandths of the em (Adobe Helvetica AFM).
#[rustfmt::skip]
const ASCII_WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,
    333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,
    556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Width of one line of text.
pub fn width_mm(text: &str, size_mm: f64) -> f64 {
    text.chars().map(advance).sum::<f64>() * size_mm
}

/// Advance in em. Rare characters count as the widest, so that what is measured to fit does fit.
fn advance(c: char) -> f64 {
    let thousandths = match c {
        ' '..='~' => ASCII_WIDTHS[c as usize - ' ' as usize],
        '·' => 278,
        '×' => 584,
        '\u{c0}'..='\u{ff}' => 850,
        _ => 1000,
    };
    f64::from(thousandths) / 1000.0
}

/// Only what the font can show: anything outside Latin-1 (and the ellipsis) becomes a question mark.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| {
            if matches!(c, ' '..='~' | '\u{a1}'..='\u{ff}' | '…') {
                c
            } else {
                '?'
            }
        })
        .collect()
}

/// The text, with as much of its middle replaced by an ellipsis as is needed to stay within `most_mm`.
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

/// The size at which a line is at most `most_mm` wide: `size_mm`, or smaller.
pub fn fitting_size_mm(text: &str, size_mm: f64, most_mm: f64) -> f64 {
    size_mm.min(size_mm * most_mm / width_mm(text, size_mm).max(f64::MIN_POSITIVE))
}

/// A number with up to three decimals and no trailing zeros.
pub fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_lose_their_middle() {
        let short = shortened("a-very-long-file-name-of-a-pattern.png", 2.0, 20.0);
        assert!(
            short.starts_with("a-v") && short.ends_with(".png") && short.contains('…'),
            "{short}"
        );
        assert!(width_mm(&short, 2.0) <= 20.0);
        assert_eq!(shortened("short.png", 2.0, 20.0), "short.png");
    }

    #[test]
    fn numbers_are_plain() {
        assert_eq!(
            [number(118.0), number(7.375), number(0.1 + 0.2)],
            ["118", "7.375", "0.3"]
        );
    }
}
