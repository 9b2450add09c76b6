//! Why a video gave no (more) frames, each as one sentence.

use scaleproof_core::files::FileError;

/// Why a video gave no (more) frames. `name` is what the input is called: a file's path, or a stream's address.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(
        "{name} is read with the programs ffmpeg and ffprobe, and this system has no {program}: install them (Debian: apt install ffmpeg)"
    )]
    NoDecoder { name: String, program: &'static str },
    #[error("{name} is empty: copy it from the camera again")]
    Empty { name: String },
    #[error(
        "{name} is no video that is read here ({reason}): use the MP4, MOV, MKV or WebM file of the camera, and copy it again if it is one"
    )]
    NotAVideo { name: String, reason: String },
    #[error("{name} has sound and no picture: use the file that the camera wrote as a video")]
    NoPicture { name: String },
    #[error("{name} is encrypted: use a copy without protection")]
    Encrypted { name: String },
    #[error("{name} has no frame that can be shown: copy it from the camera again")]
    NoFrames { name: String },
    #[error("{name} has frames of {size}: scale it down with `ffmpeg -i IN -vf scale=3840:-2 OUT`")]
    TooLarge { name: String, size: String },
    #[error(
        "{name} has pixels that are not square ({ratio}), which no camera file describes: film without an anamorphic mode"
    )]
    NotSquare { name: String, ratio: String },
    #[error(
        "{name} is an HDR video ({transfer}), whose colours this system's ffmpeg cannot convert, as it lacks the filter zscale: install an ffmpeg built with libzimg, or film with HDR switched off"
    )]
    Hdr { name: String, transfer: &'static str },
    #[error("{name} is damaged or cut after {after_s:.2} s ({reason}): copy it from the camera again")]
    Damaged {
        name: String,
        /// Time of the last whole frame, s.
        after_s: f64,
        reason: String,
    },
    #[error(
        "{name} was not decoded: ffmpeg {version} does not take what this program tells it ({reason}): install another (5.1 to 9.0 were tried)"
    )]
    OtherDecoder {
        name: String,
        version: String,
        reason: String,
    },
    #[error("{name} gave no frame for {waited_s:.0} s")]
    Silent { name: String, waited_s: f64 },
    #[error("ffmpeg gave no colours of frames of {name}: call this again")]
    NotConverted { name: String },
    #[error("{program} could not be started for {name}: {reason}")]
    NotStarted {
        name: String,
        program: &'static str,
        reason: String,
    },
}
