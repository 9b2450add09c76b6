//! Frames, and the trait of whatever gives them.

use image::RgbImage;

use super::error::SourceError;
use super::live::CameraSettings;

/// One image of a source.
#[derive(Debug, Clone)]
pub struct SourceFrame {
    /// Name that the source gives it: for people, never a path that is written to.
    pub name: String,
    /// Time at which it was taken, RFC 3339, where the source knows.
    pub taken: Option<String>,
    pub original: Original,
}

/// Original of a frame, as its source has it.
#[derive(Debug, Clone)]
pub enum Original {
    /// A JPEG or PNG file; it is kept byte for byte.
    Encoded(Vec<u8>),
    /// The pixels of a camera that gives no file; kept as PNG that lies as the sensor does.
    Pixels(RgbImage),
    /// No original, for the reason in the sentence.
    Unreadable(String),
}

impl SourceFrame {
    /// Creates a frame whose source does not know when it was taken.
    pub fn untimed(name: String, original: Original) -> SourceFrame {
        SourceFrame {
            name,
            taken: None,
            original,
        }
    }
}

impl Original {
    /// Returns the original of a file that was read, or that cannot be.
    pub fn from_file(read: Result<Vec<u8>, impl ToString>) -> Original {
        read.map_or_else(|e| Original::Unreadable(e.to_string()), Original::Encoded)
    }
}

/// Source of frames.
pub trait FrameSource {
    /// Waits for the next frame; `None` when there will be no more.
    ///
    /// # Errors
    /// The source itself is gone; a single bad frame is an [`Original::Unreadable`].
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError>;

    /// Returns true if a frame follows the last one so closely that their difference tells whether the camera moves. Otherwise each is a photo
    /// that somebody took on purpose.
    fn is_stream(&self) -> bool {
        false
    }

    /// Returns the settings of a camera; `None` for sources that are none, and while it still settles.
    fn settings(&self) -> Option<CameraSettings> {
        None
    }
}
