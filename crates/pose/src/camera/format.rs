//! Camera file formats: detection, reading and writing.

use std::path::Path;

use super::fields::Fields;
use super::{Camera, CameraError, colmap, kalibr, matrix_yaml, mrcal, nerf, xml, yaml};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};

/// A camera file format that is read and written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraFormat {
    /// OpenCV FileStorage YAML (XML is read too): 5 coefficients, or 8; `fisheye_model` with 4.
    OpenCv,
    /// ROS `camera_info` YAML: `plumb_bob` (5 coefficients), `rational_polynomial` (8) or `equidistant` (a fisheye's 4).
    Ros,
    /// Kalibr camchain YAML: `pinhole` with `radtan` or `equidistant` (4 coefficients each).
    Kalibr,
    /// mrcal `.cameramodel`: LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5 or 8.
    Mrcal,
}

impl CameraFormat {
    /// All formats with the names a user gives them.
    pub const ALL: [(CameraFormat, &str); 4] = [
        (CameraFormat::OpenCv, "opencv"),
        (CameraFormat::Ros, "ros"),
        (CameraFormat::Kalibr, "kalibr"),
        (CameraFormat::Mrcal, "mrcal"),
    ];

    /// Returns the name a user gives the format.
    pub fn name(self) -> &'static str {
        CameraFormat::ALL[self as usize].1
    }
}

impl Camera {
    /// Reads a camera file: of any [`CameraFormat`], or of COLMAP, NeRF programs, EuRoC, or a script around OpenCV.
    pub fn open(path: &Path) -> Result<Camera, CameraError> {
        Camera::parse(&files::read_text(path)?, path)
    }

    /// Reads the camera with a name (or an id) from a file of several; without a name as [`Camera::open`].
    pub fn open_named(path: &Path, name: Option<&str>) -> Result<Camera, CameraError> {
        let read = parse(&files::read_text(path)?, name);
        read.map_err(|fault| FileError::content(path, fault).into())
    }

    /// Parses the text of a camera file; `path` is only named in errors.
    pub fn parse(text: &str, path: &Path) -> Result<Camera, CameraError> {
        parse(text, None).map_err(|fault| FileError::content(path, fault).into())
    }

    /// Returns the camera as the text of a file; every number reads back unchanged. Returns an error if the format's models cannot express the
    /// camera.
    pub fn write(&self, format: CameraFormat) -> Result<String, CameraError> {
        let written = self.check().and_then(|()| match format {
            CameraFormat::OpenCv => Ok(matrix_yaml::write_opencv(self)),
            CameraFormat::Ros => Ok(matrix_yaml::write_ros(self)),
            CameraFormat::Kalibr => kalibr::write(self),
            CameraFormat::Mrcal => mrcal::write(self),
        });
        let format = format.name();
        written.map_err(|fault| message!("the camera cannot be written as {format}: {fault}").into())
    }
}

/// Parses the only camera of a file's text, or the one with the given name. The format is detected from the content, never from the file's name.
fn parse(text: &str, name: Option<&str>) -> Result<Camera, Message> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        bail!("the file is empty");
    }
    let camera = if text.trim_start().starts_with('<') {
        xml::read(text)?
    } else if mrcal::is(text) {
        mrcal::read(text)?
    } else if colmap::is(text) {
        colmap::read(text, name)?
    } else {
        keyed(Fields::of_yaml(text)?, name)?
    };
    let camera = yaml::read_marks(text, camera)?;
    camera.check()?;
    Ok(camera)
}

/// Reads a camera from a file with named values.
fn keyed(fields: Fields, name: Option<&str>) -> Result<Camera, Message> {
    if nerf::is(&fields) {
        nerf::read(fields)
    } else if matrix_yaml::MATRIX.iter().any(|name| fields.has(name)) {
        matrix_yaml::read(fields)
    } else if kalibr::is_one(&fields) {
        kalibr::read_one(fields, "the camera")
    } else {
        kalibr::read_chain(fields, name)
    }
}
