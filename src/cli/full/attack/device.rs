//! `--device` of the commands that run networks.

use scaleproof_gradients::device::DeviceKind;

#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(in crate::cli) struct OnDevice {
    /// What the networks run on: cpu; cuda or wgpu where the program was built with it
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = kind)]
    pub device: DeviceKind,
}

fn kind(text: &str) -> Result<DeviceKind, String> {
    let found = DeviceKind::ALL.into_iter().find(|kind| kind.name() == text);
    found.ok_or_else(|| "cpu, cuda and wgpu are the devices".to_owned())
}
