//! The one way to the terminal. Texts from elsewhere (file names, names in sessions and palettes, tensors) may hold characters that move the
//! cursor, colour what follows or turn the direction of reading: they are shown by their numbers. A word longer than any path is cut in its middle.

use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once, at the start, by `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on, notes and progress are not shown.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether notes and progress are not to be shown.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Says a sentence on standard error, unless it is a note that `--quiet` silences. Nobody may be there to read it.
pub fn say(sentence: fmt::Arguments) {
    let text = without_endless_words(&sentence.to_string()).replace('\n', "\\u000a");
    if is_quiet() && is_note(&text) {
        return;
    }
    let _ = writeln!(Visible(io::stderr().lock()), "{text}");
}

/// No path is longer (Linux, `PATH_MAX`), nor is a name, a number or a label that anybody would read.
const LONGEST_WORD: usize = 4096;

/// A text with its words; of a longer one its beginning, its end, and how long it is.
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

/// `note: …`, or `note on PHOTO: …`. What became of an input (`no pose for PHOTO: …`) is a result.
fn is_note(sentence: &str) -> bool {
    ["note: ", "note on "].iter().any(|begin| sentence.starts_with(begin))
}

/// `eprintln!` for texts from elsewhere.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => {
        $crate::say(format_args!($($text)*))
    };
}

/// Shows control characters as `\u001b`, which is also how JSON writes them. Lines and tabs stay.
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

/// Control characters (C0, DEL, C1), and those that turn the direction of reading (Unicode Standard Annex 9) or end a line unseen.
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
