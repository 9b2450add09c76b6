//! Sources of frames: stored sessions, watched folders, cameras and streams.

mod error; // reasons why a source ends
mod frame; // frames, and the trait of whatever gives them
pub mod live; // cameras of this machine, and what all running cameras share
mod name; // sources as users name them
mod programs; // programs that write images for a source, and their end
mod replay; // the photos of a stored session
pub mod stream; // cameras that stream, by ffmpeg
mod watch; // a folder that photos are copied into

pub use error::SourceError;
pub use frame::{FrameSource, Original, SourceFrame};
pub use live::{CameraSettings, LiveCamera};
pub use name::SourceName;
pub use programs::interrupt_programs;
pub use replay::Replay;
pub use watch::Watch;
