//! Choice of one camera from a file of several.

use super::CameraFault;

/// Returns the camera with the given name or, without a name, the only one.
pub(super) fn chosen<T>(mut cameras: Vec<(String, T)>, name: Option<&str>) -> Result<(String, T), CameraFault> {
    let names = || {
        cameras
            .iter()
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let found = match name {
        Some(wanted) => cameras.iter().position(|(name, _)| name == wanted),
        None if cameras.len() > 1 => return Err(CameraFault::SeveralCameras { names: names() }),
        None => Some(0).filter(|_| !cameras.is_empty()),
    };
    match (found, name) {
        (Some(at), _) => Ok(cameras.swap_remove(at)),
        (None, Some(name)) => Err(CameraFault::NoSuchCamera {
            name: name.to_owned(),
            names: names(),
        }),
        (None, None) => Err(CameraFault::NoCamera),
    }
}
