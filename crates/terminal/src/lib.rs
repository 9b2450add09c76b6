//! Output to a terminal: notes, errors and progress, in which no foreign text moves the cursor.
//!
//! - [`say!`]: one sentence on standard error, unless it is a note and `--quiet` was given;
//! - [`Visible`]: a writer that shows control characters by their numbers;
//! - [`progress`]: a bar in a terminal, and a plain line every few seconds elsewhere.
//!
//! ```
//! use std::io::Write;
//! use scaleproof_terminal::Visible;
//!
//! let mut out = Vec::new();
//! write!(Visible(&mut out), "a\x1b[2Jb").unwrap();
//! assert_eq!(out, b"a\\u001b[2Jb");
//! ```

pub mod progress;
mod say;

pub use say::{Visible, be_quiet, is_quiet, say};
