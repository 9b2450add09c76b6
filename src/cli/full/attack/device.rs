//! `--device` of the commands that run networks.

use scaleproof_gradients::device::DeviceKind;

#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(in crate::cli) struct OnDevice {
    /// What the networks run on: cpu; cuda or wgpu where the program was built with it
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = by_name(DeviceKind::ALL, DeviceKind::name, "cpu, cuda and wgpu are the devices"))]
    pub device: DeviceKind,
}

/// Takes the name of one of these, or says which there are.
pub(super) fn by_name<T: Copy, const N: usize>(
    all: [T; N],
    name: fn(T) -> &'static str,
    known: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let found = all.into_iter().find(|one| name(*one) == text);
        found.ok_or_else(|| known.to_owned())
    }
}
