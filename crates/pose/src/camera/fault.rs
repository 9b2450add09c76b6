//! Faults of camera files and of cameras' numbers.

/// Fault of a camera, as a sentence that says what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CameraFault {
    #[error("the file is empty")]
    Empty,
    #[error(
        "not a camera file: give one of OpenCV, ROS, Kalibr, EuRoC, mrcal, COLMAP (cameras.txt) or a NeRF program (transforms.json)"
    )]
    UnknownFormat,
    #[error("not {what}: {reason}")]
    Syntax { what: &'static str, reason: String },
    #[error("{name} says {rows} × {cols} but has {found} numbers")]
    Matrix {
        name: String,
        rows: f64,
        cols: f64,
        found: usize,
    },
    #[error("camera_matrix must be [fx 0 cx; 0 fy cy; 0 0 1], 3 rows of 3")]
    NoCameraMatrix,
    #[error("its models cannot hold a fisheye lens: write opencv, ros or kalibr")]
    Fisheye,
    #[error("a fisheye has 4 coefficients, k1 to k4, but distortion_coefficients has {0}")]
    FisheyeCoefficients(usize),
    #[error("distortion_coefficients has {0} numbers: OpenCV knows 4, 5 or 8")]
    CoefficientCount(usize),
    #[error("thin-prism and tilt coefficients are not supported: calibrate with at most 8")]
    ThinPrismOrTilt,
    #[error("distortion_model {0} is not supported: use plumb_bob, rational_polynomial or equidistant")]
    RosModel(String),
    #[error(
        "distortion_model {model} has {limit} coefficients but distortion_coefficients has {found}: is it rational_polynomial?"
    )]
    RosCoefficients { model: String, limit: usize, found: usize },
    #[error("it has no calibrated camera")]
    NoCamera,
    #[error(
        "it has several cameras ({names}): write the one that took the photos into a file of its own (camera convert, with its name)"
    )]
    SeveralCameras { names: String },
    #[error("it has no camera {name}; it has {names}")]
    NoSuchCamera { name: String, names: String },
    #[error("{key} {model} of {camera} is not supported: calibrate with pinhole and radtan or equidistant")]
    KalibrModel {
        key: &'static str,
        model: String,
        camera: String,
    },
    #[error(
        "{camera} must have 4 intrinsics (fu, fv, pu, pv) and {count} distortion_coeffs, it has {intrinsics} and {coefficients}"
    )]
    KalibrNumbers {
        camera: String,
        count: usize,
        intrinsics: usize,
        coefficients: usize,
    },
    #[error("its radtan model has only k1, k2, p1 and p2, and this camera has more: write another format")]
    BeyondRadtan,
    #[error("{0} is not supported: convert it to LENSMODEL_OPENCV8 with mrcal-convert-lensmodel")]
    MrcalModel(String),
    #[error("{model} has {count} intrinsics, the file has {found}")]
    MrcalNumbers {
        model: &'static str,
        count: usize,
        found: usize,
    },
    #[error("the comment “{mark}…” must be followed by {count} number(s) not below 0")]
    Comment { mark: &'static str, count: usize },
    #[error("the image size {width}×{height} must lie between 1 and 100000 pixels a side")]
    Size { width: u32, height: u32 },
    #[error("the focal lengths fx {fx} and fy {fy} must lie between {least} and {most} px for this image size")]
    Focal { fx: f64, fy: f64, least: f64, most: f64 },
    #[error("the principal point ({cx}, {cy}) lies far outside the image")]
    PrincipalPoint { cx: f64, cy: f64 },
    #[error("the distortion coefficient {0} is no finite number below 1e9")]
    Coefficient(f64),
}
