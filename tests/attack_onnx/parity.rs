//! A detector's outputs beside ONNX Runtime's.

use std::path::{Path, PathBuf};

use image::RgbImage;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use scaleproof::detect::{Manifest, Runtime};
use scaleproof::whitebox::onnx::OnnxNetwork;

use crate::tests::common::{home, shared};

/// Name, shape and numbers of an output.
pub type Answered = (String, Vec<usize>, Vec<f32>);

/// The detectors whose networks can be differentiated, with the shape of their input.
pub const FOLLOWED: [(&str, &str, usize); 3] = [
    ("yolox_nano", "yolox_nano.onnx", 416),
    ("nanodet_m", "nanodet_m_416.onnx", 416),
    ("fastestdet", "FastestDet.onnx", 352),
];

/// The 16 stored photos and, of the shared material, more of real and toy cars: 20 in all.
pub fn photos() -> Vec<PathBuf> {
    let images = |folder: &Path| {
        let files = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path());
        let mut files: Vec<PathBuf> = files
            .filter(|f| f.extension().is_some_and(|e| e == "jpg" || e == "png"))
            .collect();
        files.sort();
        files
    };
    let mut photos = images(&home().join("captures/skyline"));
    for folder in ["photos/cars", "photos/toys"] {
        photos.extend(shared(folder).iter().flat_map(|f| images(f)).take(2));
    }
    photos
}

pub fn photo(path: &Path) -> RgbImage {
    image::open(path).unwrap().to_rgb8()
}

/// What ONNX Runtime answers: name, shape and numbers of each output.
pub fn by_onnx_runtime(session: &mut Session, shape: &[usize], numbers: &[f32]) -> Vec<Answered> {
    let tensor = ort::value::Tensor::from_array((shape.to_vec(), numbers.to_vec())).unwrap();
    let outputs = session.run(ort::inputs![tensor]).unwrap();
    let read = outputs.iter().map(|(name, value)| {
        let (shape, data) = value.try_extract_tensor::<f32>().unwrap();
        (
            name.to_owned(),
            shape.iter().map(|d| *d as usize).collect(),
            data.to_vec(),
        )
    });
    read.collect()
}

pub fn session(bytes: &[u8]) -> Session {
    Session::builder(&Runtime::load().unwrap().environment)
        .unwrap()
        .commit_from_memory(bytes)
        .unwrap()
}

/// Node by node, without the fusions that change where it rounds.
pub fn as_written(bytes: &[u8]) -> Session {
    Session::builder(&Runtime::load().unwrap().environment)
        .unwrap()
        .with_optimization_level(GraphOptimizationLevel::Disable)
        .unwrap()
        .commit_from_memory(bytes)
        .unwrap()
}

pub fn by_network(network: &OnnxNetwork, numbers: &[f32]) -> Vec<Answered> {
    let outputs = network.forward(numbers.to_vec(), false).unwrap().outputs;
    outputs
        .iter()
        .map(|o| (o.name.clone(), o.shape.clone(), o.values()))
        .collect()
}

/// The largest difference between two answers; of numbers above 1, relative to them.
pub fn worst_difference(ours: &[Answered], theirs: &[Answered]) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    let mut worst = 0.0_f32;
    for ((our_name, our_shape, ours), (name, shape, theirs)) in ours.iter().zip(theirs) {
        assert_eq!((our_name, our_shape), (name, shape));
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(theirs) {
            assert!(a.is_finite() && b.is_finite(), "{name}: {a} {b}");
            worst = worst.max((a - b).abs() / b.abs().max(1.0));
        }
    }
    worst
}

/// A photo as some input: stretched, BGR, normalised by the manifest. Not exactly the detector's own way, which is not asked here.
pub fn numbers(photo: &RgbImage, manifest: &Manifest) -> Vec<f32> {
    let [width, height] = manifest.input.size_px;
    let small = image::imageops::thumbnail(photo, width, height);
    let channel = |c: usize| {
        let (mean, std) = (manifest.input.mean[c], manifest.input.std[c]);
        small.pixels().map(move |p| (f32::from(p.0[2 - c]) - mean) / std)
    };
    (0..3).flat_map(channel).collect()
}
