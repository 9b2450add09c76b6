//! The networks that gradients pass, in 64 bits: what differs from ONNX Runtime then is not our rounding. A program of its own, since the
//! precision is one for the whole process.
#![cfg(feature = "attack")]

mod common;
#[path = "attack_onnx/parity.rs"]
mod parity;

use burn::tensor::{Device, FloatDType};
use parity::{FOLLOWED, as_written, by_network, by_onnx_runtime, numbers, photo, photos, session, worst_difference};
use scaleproof::detect::Manifest;
use scaleproof::whitebox::onnx::Network;

#[test]
fn outputs_in_64_bits_are_those_of_onnx_runtime() {
    let mut device = Device::flex();
    device.configure(FloatDType::F64).unwrap();
    for (name, file, side) in FOLLOWED {
        let Some(path) = common::shared(&format!("detectors/{file}")) else {
            return;
        };
        let (bytes, manifest) = (std::fs::read(path).unwrap(), Manifest::named(name).unwrap());
        let shape = [1, 3, side, side];
        let network = Network::read(&bytes, file, &shape, &device).unwrap();
        let mut sessions = [session(&bytes), as_written(&bytes)];
        let photos = photos();
        assert_eq!(photos.len(), 20);
        let mut worst = [0.0_f32; 2];
        for path in &photos {
            let numbers = numbers(&photo(path), &manifest);
            let ours = by_network(&network, &numbers);
            for (session, worst) in sessions.iter_mut().zip(&mut worst) {
                *worst = worst.max(worst_difference(&ours, &by_onnx_runtime(session, &shape, &numbers)));
            }
        }
        let [optimised, written] = worst;
        println!(
            "{name}: outputs of 20 photos in 64 bits within {optimised:.1e} of ONNX Runtime's, {written:.1e} of its for the file as written"
        );
        assert!(optimised < 1e-4 && written < 1e-4, "{name}: {worst:?}");
    }
}
