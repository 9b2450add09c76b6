//! The model's surface: triangles with a material and texture coordinates each, read from `.glb`, `.obj`, `.stl` or `.ply` and put into the
//! model frame.
//!
//! One file per format; [`place`](MeshPlacement) brings what they give into the model frame: origin on the ground under the
//! model's centre, x to its front, y to its left, z up; mm.

mod axes;
mod error;
mod faces;
mod frame;
mod glb;
mod gltf_data;
mod gltf_look;
mod image;
mod load;
mod mtl;
mod obj;
mod paint;
mod placement;
mod ply;
mod polygon;
#[cfg(feature = "full")]
mod simplify;
mod soup;
mod stl;
mod text;
mod triangles;

pub use axes::{AxesDoubt, AxesProposal, propose_axes};
pub use error::MeshError;
pub use faces::FaceList;
pub use image::{ImageSource, Look, Wrap};
pub use paint::{PaintDoubt, propose_paint};
pub use placement::{MeshPlacement, is_gltf};
pub use scaleproof_core::geometry::SignedAxis;
#[cfg(feature = "full")]
pub use simplify::Simplified;
pub use soup::{MAX_BYTES, MAX_TRIANGLES};
pub use triangles::{Mesh, TextureCoordinates, Triangle, doubled_area, edges};
