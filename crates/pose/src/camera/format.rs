//! The camera file formats: which one a text is, reading and writing.

use std::path::Path;

use super::{Camera, CameraError, CameraFault, kalibr, matrix_yaml, mrcal, yaml};
use scaleproof_core::files::{self, FileError};

/// A camera file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraFormat {
    /// OpenCV FileStorage YAML (XML is read too): 5 coefficients, or 8; `fisheye_model` with 4.
    OpenCv,
    /// ROS `camera_info` YAML: `plumb_bob` (5 coefficients), `rational_polynomial` (8) or `equidistant` (a fisheye's 4).
    Ros,
    /// Kalibr camchain YAML with one camera: `pinhole` with `radtan` or `equidistant` (4 coefficients each).
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
        CameraFormat::ALL[self as usize].1
    }

    /// The format of a camera file's text, by what it says; a file's name may say anything.
    fn detect(text: &str) -> Option<CameraFormat> {
        let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        let says = |word: &str| lines.clone().any(|line| line.contains(word));
        let mut starts = lines.clone().map(str::trim_start).filter(|line| !line.is_empty());
        if says("lensmodel") && starts.next().is_some_and(|line| line.starts_with('{')) {
            Some(CameraFormat::Mrcal)
        } else if says("camera_matrix") && (says("distortion_model") || says("projection_matrix")) {
            Some(CameraFormat::Ros)
        } else if says("camera_matrix") {
            Some(CameraFormat::OpenCv)
        } else if says("camera_model") || says("distortion_coeffs") {
            Some(CameraFormat::Kalibr)
        } else {
            None
        }
    }
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
        let written = self.check().and_then(|()| match format {
            CameraFormat::OpenCv => Ok(matrix_yaml::write_opencv(self)),
            CameraFormat::Ros => Ok(matrix_yaml::write_ros(self)),
            CameraFormat::Kalibr => kalibr::write(self),
            CameraFormat::Mrcal => mrcal::write(self),
        });
        let format = format.name();
        written.map_err(|fault| CameraError::NotInFormat { format, fault })
    }
}

fn parse(text: &str) -> Result<Camera, CameraFault> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        return Err(CameraFault::Empty);
    }
    let camera = match CameraFormat::detect(text).ok_or(CameraFault::UnknownFormat)? {
        CameraFormat::OpenCv => matrix_yaml::read_opencv(text)?,
        CameraFormat::Ros => matrix_yaml::read_ros(text)?,
        CameraFormat::Kalibr => kalibr::read(text)?,
        CameraFormat::Mrcal => mrcal::read(text)?,
    };
    let camera = yaml::read_marks(text, camera)?;
    camera.check()?;
    Ok(camera)
}
