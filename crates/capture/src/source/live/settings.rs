//! Settings of a camera, as stored beside each photo.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Settings of a camera when its photos were taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSettings {
    /// Name that the camera gives itself.
    pub device: String,
    /// Pixel format, size and images a second, as the camera gives them.
    pub format: String,
    pub exposure: Setting,
    pub focus: Setting,
    pub white_balance: Setting,
}

/// One setting.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// True if it stays as it is until the capture ends.
    pub is_locked: bool,
    /// Value in the driver's unit: exposure on Linux in 100 µs, white balance in kelvin. `None` where the driver does not say.
    pub value: Option<i64>,
}

/// A line for the photographer: what may change from photo to photo.
impl fmt::Display for CameraSettings {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {}: ", self.device, self.format)?;
        let all = [
            ("exposure", &self.exposure),
            ("focus", &self.focus),
            ("white balance", &self.white_balance),
        ];
        let loose = all.iter().filter(|(_, setting)| !setting.is_locked);
        let loose: Vec<&str> = loose.map(|(name, _)| *name).collect();
        if loose.is_empty() {
            return f.write_str("exposure, focus and white balance are held");
        }
        let loose = loose.join(", ");
        write!(
            f,
            "{loose} cannot be held by this program and may change from photo to photo"
        )
    }
}
