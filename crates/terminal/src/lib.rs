//! Output to a terminal: notes, errors and progress, in which no foreign text moves the cursor.
//!
//! ```
//! use std::io::Write;
//! use scaleproof_terminal::Visible;
//!
//! let mut out = Vec::new();
//! write!(Visible(&mut out), "a\x1b[2Jb").unwrap();
//! assert_eq!(out, b"a\\u001b[2Jb");
//! ```

pub mod progress; // a bar in a terminal, a plain line every few seconds elsewhere
mod say; // sentences on standard error; control characters shown by their numbers

pub use say::{Visible, be_quiet, is_quiet, say};
