//! ONNX files as files: what one says that ONNX Runtime does not tell.

mod read;
mod wire;

pub(super) use read::{Affine, OnnxFile};
