//! The framework's device of each kind.

use burn::tensor::{Device, DeviceType};

use super::quietly::quietly;
use crate::device::{DeviceError, DeviceKind};

impl DeviceKind {
    /// The first device of this kind.
    ///
    /// # Errors
    /// A kind the program was built without, or of which the machine has none.
    pub fn open(self) -> Result<Device, DeviceError> {
        let kind = match self {
            DeviceKind::Cpu => DeviceType::Flex,
            #[cfg(feature = "cuda")]
            DeviceKind::Cuda => DeviceType::Cuda,
            #[cfg(feature = "wgpu")]
            DeviceKind::Wgpu => DeviceType::Wgpu,
            #[allow(unreachable_patterns)] // where the program was built with both
            _ => return Err(DeviceError::NotBuilt(self.name())),
        };
        // Without a driver the framework panics instead of finding none.
        let found = quietly(|| Device::enumerate(kind).into_vec().into_iter().next());
        found.flatten().ok_or(DeviceError::NotThere(self.name()))
    }
}
