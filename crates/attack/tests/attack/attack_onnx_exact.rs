//! The networks that gradients pass, in 64 bits: what differs from ONNX Runtime then is not our rounding.

use crate::attack_onnx::parity;
use crate::common;

use parity::{FOLLOWED, as_written, by_network, by_onnx_runtime, numbers, photo, photos, session, worst_difference};
use scaleproof_detect::Manifest;
use scaleproof_gradients::onnx::OnnxNetwork;

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn outputs_in_64_bits_are_those_of_onnx_runtime() {
    for (name, file, side) in FOLLOWED {
        let path = common::shared(&format!("detectors/{file}"));
        let (bytes, manifest) = (std::fs::read(path).unwrap(), Manifest::named(name).unwrap());
        let shape = [1, 3, side, side];
        let network = OnnxNetwork::<f64>::read(&bytes, file, &shape, Some([side as u32; 2])).unwrap();
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
