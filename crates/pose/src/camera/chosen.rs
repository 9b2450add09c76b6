//! Choice of one camera from a file of several.

use scaleproof_core::message::{Message, bail, message};

/// Returns the camera with the given name or, without a name, the only one.
pub(super) fn chosen<T>(mut cameras: Vec<(String, T)>, name: Option<&str>) -> Result<(String, T), Message> {
    let names = || {
        cameras
            .iter()
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let found = match name {
        Some(wanted) => cameras.iter().position(|(name, _)| name == wanted),
        None if cameras.len() > 1 => bail!(
            "it has several cameras ({names}): write the one that took the photos into a file of its own (camera convert, with its name)",
            names = names()
        ),
        None => Some(0).filter(|_| !cameras.is_empty()),
    };
    match (found, name) {
        (Some(at), _) => Ok(cameras.swap_remove(at)),
        (None, Some(name)) => Err(message!("it has no camera {name}; it has {names}", names = names())),
        (None, None) => Err(message!("it has no calibrated camera")),
    }
}
