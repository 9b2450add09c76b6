//! Frames: images of a model whose truth is known, in one format on disk, and [`surrogate`] renderers that predict them in any paint.
//!
//! A set of frames is a folder with `frames.json`, whose keys stand in docs/guide/reference/frames-json.md, and the PNG files it names.
//!
//! **A flat colour** is the paint's diffuse reflectance as 8-bit sRGB: `flat_rgb` [188, 188, 188] reflects half of the light (0.5 in linear
//! light). It is not the colour the paint has in the image. The same holds for a texture's texels and a pattern's cells, which lie on the model as
//! [`world_aligned`](scaleproof_surface::pattern::world_aligned) says.
//!
//! Frames with the same `T_camera_model` may share masks, positions and sides. Those made of photos ([`photos`]) have the camera's
//! tone curve instead of sRGB's, and only paint in the mask that every photo sees.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_frames::{FrameSet, views};
//!
//! let set = FrameSet::open(Path::new("../../captures/skyline_frames"))?;
//! assert!(views(&set.list.frames).len() < set.list.frames.len(), "each view in several paints");
//! # Ok::<(), scaleproof_frames::FramesError>(())
//! ```

pub mod drawn; // a mesh as a pinhole camera sees it, as masks and positions of a frame
mod error; // the error of the crate
mod images; // PNG files of frames, written and read
pub mod import; // frames of other engines: folders in CARLA's layout, FCA's files
mod list; // frames.json: the camera, the frames and their files
pub mod photos; // frames from photos of the real model in flat colours
pub mod raster; // the z-buffer of a mesh
mod read; // sets of frames, checked and read
pub mod render; // frames from Blender Cycles
pub mod shaded; // the model in its textures, drawn without Blender
pub mod six_views; // the model from its six sides
pub mod surrogate; // models that predict the image of a view in any paint

pub use error::FramesError;
pub(crate) use error::of_file;
pub(crate) use images::reduced;
pub use images::{Coverage, encode_grey, encode_linear, encode_positions, encode_rgb};
pub use list::{FORMAT, Frame, FrameList, FramePaint, LIST, Pinhole, Positions, views};
pub use read::{FrameSet, SurfacePoint, outline, syntax};
pub use scaleproof_surface::pattern::light;
