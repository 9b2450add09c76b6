//! What the networks run on, chosen at run time among what the program was built with.

/// A kind of device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DeviceKind {
    #[default]
    Cpu,
    /// NVIDIA's (Cargo feature `cuda`).
    Cuda,
    /// Whatever has a driver for Vulkan, Metal or DirectX (Cargo feature `wgpu`).
    Wgpu,
}

/// Why a device cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    #[error("this program was built without {0}")]
    NotBuilt(&'static str),
    #[cfg_attr(not(any(feature = "cuda", feature = "wgpu")), allow(dead_code))]
    #[error("{0} finds no device on this machine: install its driver")]
    NotThere(&'static str),
}

impl DeviceKind {
    pub const ALL: [Self; 3] = [Self::Cpu, Self::Cuda, Self::Wgpu];

    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Cuda => "cuda",
            Self::Wgpu => "wgpu",
        }
    }

    /// The first device of this kind.
    ///
    /// # Errors
    /// A kind the program was built without, or of which the machine has none.
    #[cfg(feature = "attack")]
    pub fn open(self) -> Result<burn::tensor::Device, DeviceError> {
        match self {
            Self::Cpu => Ok(burn::tensor::Device::flex()),
            Self::Cuda => self.cuda(),
            Self::Wgpu => self.wgpu(),
        }
    }

    #[cfg(feature = "cuda")]
    fn cuda(self) -> Result<burn::tensor::Device, DeviceError> {
        self.first(burn::tensor::DeviceType::Cuda)
    }

    #[cfg(feature = "wgpu")]
    fn wgpu(self) -> Result<burn::tensor::Device, DeviceError> {
        self.first(burn::tensor::DeviceType::Wgpu)
    }

    #[cfg(all(feature = "attack", not(feature = "cuda")))]
    fn cuda(self) -> Result<burn::tensor::Device, DeviceError> {
        Err(DeviceError::NotBuilt(self.name()))
    }

    #[cfg(all(feature = "attack", not(feature = "wgpu")))]
    fn wgpu(self) -> Result<burn::tensor::Device, DeviceError> {
        Err(DeviceError::NotBuilt(self.name()))
    }

    /// Without a driver the framework panics instead of finding none.
    #[cfg(any(feature = "cuda", feature = "wgpu"))]
    fn first(self, kind: burn::tensor::DeviceType) -> Result<burn::tensor::Device, DeviceError> {
        let found = crate::quietly::quietly(|| burn::tensor::Device::enumerate(kind).into_vec().into_iter().next());
        found.flatten().ok_or(DeviceError::NotThere(self.name()))
    }
}
