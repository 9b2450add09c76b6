//! ONNX files as files: what one says that ONNX Runtime does not tell, and files of our own.

mod external;
pub mod model;
mod read;
mod wire;
mod write;

pub(super) use external::external_files;
pub(super) use read::{Affine, OnnxFile};
pub(super) use write::{Attribute, GraphWriter};
