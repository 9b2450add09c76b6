//! A recorded video in place of a running camera: each of its frames is judged as that camera's would be.

use std::path::Path;

use image::RgbImage;

use super::source::{FrameSource, Original, Purpose, SourceError, SourceFrame};
use scaleproof_core::files;
use scaleproof_pose::camera::Camera;
use scaleproof_session::session::VideoFrame;
use scaleproof_video::{Frames, Selection, Video};

/// A running camera gives so many frames a second; of a faster video some are left out.
const FRAMES_PER_S: f64 = 20.0;

/// The frames of a video file, each of them however long it takes to judge.
pub struct Film {
    name: String,
    sha256: String,
    turned_deg: u32,
    frames: Frames<RgbImage>,
    /// When the last frame was shown, s since the start.
    last_s: Option<f64>,
}

impl Film {
    /// Starts to decode a video that was made with a camera.
    ///
    /// # Errors
    /// As [`open_video`]; a file that cannot be read.
    pub fn open(path: &Path, camera: &Camera) -> Result<Film, SourceError> {
        let video = open_video(path, camera)?;
        let rate = video.frames_per_s.unwrap_or(FRAMES_PER_S);
        let selection = Selection {
            // 20.3 frames a second are not halved.
            every: (rate / FRAMES_PER_S - 0.1).ceil().max(1.0) as u64,
            ..Selection::default()
        };
        Ok(Film {
            name: files::name_of(path),
            sha256: files::sha256_of_file(path)?,
            turned_deg: video.turned_deg,
            frames: video.rgb(&selection)?,
            last_s: None,
        })
    }
}

/// Describes a video whose frames a camera file fits.
///
/// # Errors
/// No ffmpeg; a file that is no video, or none that can be decoded within bounds; frames of another shape than the camera file's.
pub fn open_video(path: &Path, camera: &Camera) -> Result<Video, SourceError> {
    let video = Video::open(path)?;
    match camera.for_photo(video.width, video.height, video.turned_deg) {
        Ok(_) => Ok(video),
        Err(reason) => Err(SourceError::OtherCamera {
            video: path.to_owned(),
            reason: reason.to_string(),
        }),
    }
}

impl FrameSource for Film {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        let Some(frame) = self.frames.next().transpose()? else {
            return Ok(None);
        };
        let after_s = frame.time_s - self.last_s.replace(frame.time_s).unwrap_or(frame.time_s);
        let name = format!("{}, frame {} at {:.3} s", self.name, frame.number, frame.time_s);
        let original = Original::Pixels {
            upright: frame.image,
            turned_deg: self.turned_deg,
        };
        let purpose = Purpose::Filmed {
            after_ms: (1000.0 * after_s).round() as u32,
            frame: Box::new(VideoFrame {
                video: self.name.clone(),
                sha256: self.sha256.clone(),
                number: frame.number,
                time_s: frame.time_s,
            }),
        };
        Ok(Some(SourceFrame {
            purpose,
            ..SourceFrame::untimed(name, original)
        }))
    }

    fn is_stream(&self) -> bool {
        true
    }
}
