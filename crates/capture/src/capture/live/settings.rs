//! What a camera is set to, as it is kept beside each photo.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a camera was set to when its photos were taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSettings {
    /// As the camera calls itself.
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
    /// Whether it stays as it is until the capture ends.
    pub is_locked: bool,
    /// In the driver's unit: exposure on Linux in 100 µs, white balance in kelvin. `None` where the driver does not say.
    pub value: Option<i64>,
}

impl CameraSettings {
    /// The settings that may change from photo to photo.
    fn loose(&self) -> Vec<&'static str> {
        let all = [
            ("exposure", &self.exposure),
            ("focus", &self.focus),
            ("white balance", &self.white_balance),
        ];
        let loose = all.into_iter().filter(|(_, setting)| !setting.is_locked);
        loose.map(|(name, _)| name).collect()
    }
}

/// A line for the photographer.
impl fmt::Display for CameraSettings {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {}: ", self.device, self.format)?;
        match self.loose().as_slice() {
            [] => f.write_str("exposure, focus and white balance are held"),
            loose => write!(
                f,
                "{} cannot be held by this program and may change from photo to photo",
                loose.join(", ")
            ),
        }
    }
}
