//! Output of texts to the terminal. Foreign texts (file names, names in sessions and palettes, tensors) may contain characters that move the cursor,
//! change colours or reverse the direction of reading: these are shown by their numbers. A word longer than any path is cut in its middle.

use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag set once, at the start, by `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Suppresses notes and progress from now on.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Returns true if notes and progress are suppressed.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints a sentence on standard error, unless it is a note that `--quiet` suppresses. Write errors are ignored.
pub fn say(sentence: fmt::Arguments) {
    let text = without_endless_words(&sentence.to_string()).replace('\n', "\\u000a");
    if is_quiet() && is_note(&text) {
        return;
    }
    let _ = writeln!(Visible(io::stderr().lock()), "{text}");
}

/// Maximum length of a word: no path is longer (Linux, `PATH_MAX`), nor is a readable name, number or label.
const LONGEST_WORD: usize = 4096;

/// Shortens overlong words of a text to their beginning, their end, and their length.
fn without_endless_words(text: &str) -> String {
    const SHOWN: usize = 60;
    let shown = |word: &str| {
        if word.len() <= LONGEST_WORD {
            return word.to_owned();
        }
        let letters: Vec<char> = word.chars().collect();
        let [head, tail] =
            [&letters[..SHOWN], &letters[letters.len() - SHOWN..]].map(|part| part.iter().collect::<String>());
        format!("{head}…{tail} ({} letters)", letters.len())
    };
    text.split(' ').map(shown).collect::<Vec<_>>().join(" ")
}

/// Returns true for `note: …`, or `note on PHOTO: …`. The outcome for an input (`no pose for PHOTO: …`) is a result.
fn is_note(sentence: &str) -> bool {
    ["note: ", "note on "].iter().any(|begin| sentence.starts_with(begin))
}

/// `eprintln!` for foreign texts.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => {
        $crate::say(format_args!($($text)*))
    };
}

/// Writer that shows control characters as `\u001b`, as JSON does. Line ends and tabs are kept.
pub struct Visible<W>(pub W);

impl<W: Write> Write for Visible<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let text = String::from_utf8_lossy(bytes);
        if text.chars().any(is_hidden) {
            self.0.write_all(shown(&text).as_bytes())?
        } else {
            self.0.write_all(bytes)?
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

fn shown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_hidden(c) {
            shown.push_str(&format!("\\u{:04x}", u32::from(c)))
        } else {
            shown.push(c)
        }
    }
    shown
}

/// Returns true for control characters (C0, DEL, C1), and for those that change the direction of reading (Unicode Standard Annex 9) or end a line
/// invisibly.
fn is_hidden(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        c => c.is_control(),
    }
}

#[cfg(test)]
#[path = "tests/say.rs"]
mod tests;
