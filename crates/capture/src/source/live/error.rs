//! Why a running camera gives nothing.

/// Why a running camera gives nothing, as a clause; the source says which camera it is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LiveCameraError {
    /// What its driver says.
    #[error("{0}")]
    Driver(String),
    #[error("its driver failed")]
    DriverPanicked,
    #[error("the system does not allow the use of cameras")]
    NotAllowed,
    #[error("it has no image of the shape of the camera file's, {width} × {height}: calibrate it at a size it has")]
    NoFittingSize { width: u32, height: u32 },
    #[error("its pixel format is not known")]
    UnknownPixelFormat,
    #[error("it did not open within {seconds} s: unplug it and plug it in again")]
    SlowToOpen { seconds: u64 },
    #[error("none came for {seconds} s")]
    NoImage { seconds: u64 },
    #[error("its images are {} × {} px, of another shape than the camera file's", size[0], size[1])]
    OtherShape { size: [u32; 2] },
    /// It will give no more, whatever is tried: why, as a clause.
    #[error("{0}")]
    Ended(String),
    /// It may give images again: what it is about, as a sentence.
    #[error("{0}")]
    Waiting(String),
}

impl LiveCameraError {
    /// Whether it is over at once, instead of after several tries.
    pub(super) fn is_final(&self) -> bool {
        matches!(self, LiveCameraError::Ended(_))
    }
}
