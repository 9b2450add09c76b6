//! Running cameras.

mod camera; // the thread that reads a camera, and its newest image
mod device; // the interface of a camera's driver
mod error; // reasons why a running camera gives nothing
mod jpegs; // JPEG files cut out of a stream of bytes
mod pixels; // what cameras send, as JPEG files or colours
mod settings; // exposure, focus and white balance of a camera
mod system; // the cameras of this machine

pub use camera::{LiveCamera, LiveName};
pub use device::Device;
pub use error::LiveCameraError;
pub use jpegs::Jpegs;
pub use pixels::{PixelFormat, RawImage, jpeg_size};
pub use settings::{CameraSettings, Setting};
pub use system::{choose_format, list_cameras};
