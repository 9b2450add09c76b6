//! Detectors that are programs: started here, fed with photos over standard input, and read from standard output, a line of JSON for each.
//! `docs/guide/detector-programs.md` is the protocol.

mod answer; // answers: boxes, losses with their derivatives, changed images
mod child; // a running program, whose lines have a longest length and a time limit
mod defence; // programs that change images
mod detector; // programs that find objects, and as many of each as may run
mod error;
mod groups; // process groups, which end with this program
mod hello; // the first line of a program
mod spec; // command lines and manifests with `command`

pub use defence::ProgramDefence;
pub use detector::{ProgramDetector, ProgramImage, ProgramPhoto};
pub use error::ProgramError;
pub(super) use error::untrusted;
pub use groups::{keep_programs_in_our_group, kill_programs};
pub use hello::Gradients;
pub use spec::ProgramSpec;
pub(super) use spec::interpreter;

/// Reads what a program says: its first line and its answers.
pub mod protocol {
    pub use crate::program::answer::{FoundBox, FoundLabel, NoAnswer, checked, derivatives, detections, image, loss};
    pub use crate::program::hello::{Hello, InputRule};
}
