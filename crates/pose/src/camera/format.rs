//! The camera file formats: which one a text is, reading and writing.

use std::path::Path;

use super::{Camera, CameraError, CameraFault, kalibr, marks, mrcal, opencv_yaml, ros_yaml};
use scaleproof_core::files::{self, FileError};

/// A camera file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraFormat {
    /// OpenCV FileStorage YAML: 5 coefficients, or 8.
    OpenCv,
    /// ROS `camera_info` YAML: `plumb_bob` (5 coefficients) or `rational_polynomial` (8).
    Ros,
    /// Kalibr camchain YAML with one camera: `pinhole` with `radtan` (4 coefficients).
    Kalibr,
    /// mrcal `.cameramodel`: LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5 or 8.
    Mrcal,
}

impl CameraFormat {
    /// Every format with the name a user gives it.
    pub const ALL: [(CameraFormat, &str); 4] = [
        (CameraFormat::OpenCv, "opencv"),
        (CameraFormat::Ros, "ros"),
        (CameraFormat::Kalibr, "kalibr"),
        (CameraFormat::Mrcal, "mrcal"),
    ];

    /// The name a user gives the format.
    pub fn name(self) -> &'static str {
        CameraFormat::ALL
            .iter()
            .find(|(f, _)| *f == self)
            .map_or("", |(_, name)| name)
    }

    /// The format of a camera file's text, by what it says; a file's name may say anything.
    fn of_text(text: &str) -> Option<CameraFormat> {
        let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        let says = |word: &str| lines.clone().any(|line| line.contains(word));
        if says("lensmodel") && text_starts_with_brace(text) {
            Some(CameraFormat::Mrcal)
        } else if says("camera_matrix") {
            let is_ros = says("distortion_model") || says("projection_matrix");
            Some(if is_ros {
                CameraFormat::Ros
            } else {
                CameraFormat::OpenCv
            })
        } else if says("camera_model") || says("distortion_coeffs") {
            Some(CameraFormat::Kalibr)
        } else {
            None
        }
    }
}

/// True when a brace is the first thing that is no comment.
fn text_starts_with_brace(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim_start);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with('#'));
    first.is_some_and(|line| line.starts_with('{'))
}

impl Camera {
    /// Reads a camera file of any [`CameraFormat`].
    pub fn open(path: &Path) -> Result<Camera, CameraError> {
        Camera::parse(&files::read_text(path)?, path)
    }

    /// Parses the text of a camera file; `path` is only named in errors.
    pub fn parse(text: &str, path: &Path) -> Result<Camera, CameraError> {
        parse(text).map_err(|fault| FileError::content(path, fault).into())
    }

    /// The camera as the text of a file; every number reads back as it is. Refuses what the format's models cannot say.
    pub fn write(&self, format: CameraFormat) -> Result<String, CameraError> {
        self.check()
            .and_then(|()| match format {
                CameraFormat::OpenCv => Ok(opencv_yaml::write(self)),
                CameraFormat::Ros => Ok(ros_yaml::write(self)),
                CameraFormat::Kalibr => kalibr::write(self),
                CameraFormat::Mrcal => Ok(mrcal::write(self)),
            })
            .map_err(|fault| CameraError::NotInFormat {
                format: format.name(),
                fault,
            })
    }
}

fn parse(text: &str) -> Result<Camera, CameraFault> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        return Err(CameraFault::Empty);
    }
    let camera = match CameraFormat::of_text(text) {
        Some(CameraFormat::OpenCv) => opencv_yaml::read(text)?,
        Some(CameraFormat::Ros) => ros_yaml::read(text)?,
        Some(CameraFormat::Kalibr) => kalibr::read(text)?,
        Some(CameraFormat::Mrcal) => mrcal::read(text)?,
        None => return Err(CameraFault::UnknownFormat),
    };
    let camera = marks::read(text, camera)?;
    camera.check()?;
    Ok(camera)
}
