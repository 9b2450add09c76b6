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

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    #[error("this program was built without {0}")]
    NotBuilt(&'static str),
    #[error("{0} finds no device on this machine: install its driver")]
    NotThere(&'static str),
}

impl DeviceKind {
    pub const ALL: [Self; 3] = [Self::Cpu, Self::Cuda, Self::Wgpu];

    pub fn name(self) -> &'static str {
        ["cpu", "cuda", "wgpu"][self as usize]
    }
}
