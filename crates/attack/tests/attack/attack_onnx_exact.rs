//! The networks that gradients pass, in 64 bits: what differs from ONNX Runtime then is not our rounding. A process of its own, since the
//! precision is one for the whole process.

use crate::attack_onnx::parity;
use crate::common;

use burn::tensor::{Device, FloatDType};
use parity::{FOLLOWED, as_written, by_network, by_onnx_runtime, numbers, photo, photos, session, worst_difference};
use scaleproof_detect::Manifest;
use scaleproof_gradients::network::onnx::OnnxNetwork;

/// Tells the test that it runs in the process that it started.
const ALONE: &str = "SCALEPROOF_IN_64_BITS";

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn outputs_in_64_bits_are_those_of_onnx_runtime() {
    if common::variable(ALONE).is_some() {
        return compare_in_64_bits();
    }
    let this = std::env::current_exe().unwrap();
    let mut command = std::process::Command::new(this);
    command.args([
        "--exact",
        "attack_onnx_exact::outputs_in_64_bits_are_those_of_onnx_runtime",
        "--ignored",
        "--nocapture",
    ]);
    let output = command.env(ALONE, "1").output().unwrap();
    print!("{}", common::stdout(&output));
    assert!(output.status.success(), "{}", common::stderr(&output));
    assert!(common::stdout(&output).contains("1 passed"));
}

fn compare_in_64_bits() {
    let mut device = Device::flex();
    device.configure(FloatDType::F64).unwrap();
    for (name, file, side) in FOLLOWED {
        let path = common::shared(&format!("detectors/{file}"));
        let (bytes, manifest) = (std::fs::read(path).unwrap(), Manifest::named(name).unwrap());
        let shape = [1, 3, side, side];
        let network = OnnxNetwork::read(&bytes, file, &shape, Some([side as u32; 2]), &device).unwrap();
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
