//! ONNX files as files: what one says that ONNX Runtime does not tell, and files of our own.

mod external; // files beside that hold tensors
pub mod model; // a file as nodes and constants
mod read; // what prepares the image
mod wire; // Protocol Buffers
mod write; // files of our own

pub(super) use external::external_files;
pub(super) use read::{Affine, OnnxFile};
pub(super) use write::{Attribute, GraphWriter};
