//! A video as a sequence of frames: upright, with their true times, decoded by the system's `ffmpeg` and described by its `ffprobe`. Nothing
//! here decodes video. The audio is never read.
//!
//! ```no_run
//! use std::path::Path;
//! use scaleproof_video::{Selection, Video};
//!
//! let video = Video::open(Path::new("walk.mp4"))?;
//! println!("{} × {}, {:?} s", video.width, video.height, video.duration_s);
//! for frame in video.luma(&Selection::default())? {
//!     let frame = frame?;
//!     println!("frame {} at {:.3} s: {} px wide", frame.number, frame.time_s, frame.image.width());
//! }
//! # Ok::<(), scaleproof_video::VideoError>(())
//! ```

mod fault; // reasons why a video gives no (more) frames
mod frames; // the frames, one after another
mod input; // what ffmpeg reads
pub mod log; // ffmpeg's lines: times of frames, and errors
mod planes; // pictures as the decoder leaves them: luma now, colours later
mod probe; // a video's description before a frame is decoded
mod program; // ffmpeg and ffprobe: found, started, ended

pub use fault::VideoError;
pub use frames::{Frame, Frames, Pixels, Selection};
pub use input::Input;
pub use planes::{Colours, Picture, Pictures, Planes};
pub use probe::{Range, Video};
pub use program::end_decoders;
