//! Detectors that gradients pass: outputs against ONNX Runtime, gradients against finite differences, confidences against scoring.
#![cfg(feature = "attack")]

mod common;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use common::{home, shared};
use image::RgbImage;
use ort::environment::Environment;
use ort::session::Session;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof::attack::net::detector::OnnxDetector;
use scaleproof::attack::net::onnx::Network;
use scaleproof::attack::white_box::WhiteBox;
use scaleproof::detect::{Detector, Manifest, Runtime};

#[path = "common/onnx.rs"]
mod onnx;

const CAR: usize = 2;

/// The detectors whose networks can be followed backwards, with the shape of their input.
const FOLLOWED: [(&str, &str, usize); 3] = [
    ("yolox_nano", "yolox_nano.onnx", 416),
    ("nanodet_m", "nanodet_m_416.onnx", 416),
    ("fastestdet", "FastestDet.onnx", 352),
];

/// The 16 stored photos and, of the shared material, more of real and toy cars: 20 in all.
fn photos() -> Vec<PathBuf> {
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

fn photo(path: &Path) -> RgbImage {
    image::open(path).unwrap().to_rgb8()
}

fn environment() -> &'static Environment {
    static ENVIRONMENT: OnceLock<std::sync::Arc<Environment>> = OnceLock::new();
    ENVIRONMENT.get_or_init(|| {
        let file = std::env::var("ORT_DYLIB_PATH").unwrap_or("libonnxruntime.so".into());
        ort::init_from(file)
            .unwrap()
            .with_telemetry(false)
            .with_name("attack_onnx")
            .build()
            .unwrap()
    })
}

/// What ONNX Runtime answers: name, shape and numbers of each output.
fn by_onnx_runtime(session: &mut Session, shape: &[usize], numbers: &[f32]) -> Vec<(String, Vec<usize>, Vec<f32>)> {
    let tensor = ort::value::Tensor::from_array((shape.to_vec(), numbers.to_vec())).unwrap();
    let outputs = session.run(ort::inputs![tensor]).unwrap();
    let read = |(name, value): (&str, ort::value::ValueRef<'_>)| {
        let (shape, data) = value.try_extract_tensor::<f32>().unwrap();
        (
            name.to_owned(),
            shape.iter().map(|d| *d as usize).collect(),
            data.to_vec(),
        )
    };
    outputs.iter().map(read).collect()
}

fn session(bytes: &[u8]) -> Session {
    Session::builder(environment())
        .unwrap()
        .commit_from_memory(bytes)
        .unwrap()
}

/// The largest difference between our outputs and ONNX Runtime's.
fn worst_difference(network: &Network, session: &mut Session, shape: &[usize], numbers: &[f32]) -> f32 {
    let theirs = by_onnx_runtime(session, shape, numbers);
    let ours = network.answer(numbers.to_vec()).unwrap().outputs;
    assert_eq!(ours.len(), theirs.len());
    let mut worst = 0.0_f32;
    for (ours, (name, shape, theirs)) in ours.iter().zip(&theirs) {
        assert_eq!((&ours.name, &ours.shape), (name, shape));
        let values = ours.values();
        assert_eq!(values.len(), theirs.len());
        for (a, b) in values.iter().zip(theirs) {
            assert!(a.is_finite() && b.is_finite(), "{name}: {a} {b}");
            worst = worst.max((a - b).abs());
        }
    }
    worst
}

/// A photo as some input: stretched, BGR, normalised by the manifest. Not exactly the detector's own way, which is not asked here.
fn numbers(photo: &RgbImage, manifest: &Manifest) -> Vec<f32> {
    let [width, height] = manifest.input.size_px;
    let small = image::imageops::thumbnail(photo, width, height);
    let channel = |c: usize| {
        let (mean, std) = (manifest.input.mean[c], manifest.input.std[c]);
        small.pixels().map(move |p| (f32::from(p.0[2 - c]) - mean) / std)
    };
    (0..3).flat_map(channel).collect()
}

#[test]
fn outputs_are_those_of_onnx_runtime() {
    for (name, file, side) in FOLLOWED {
        let Some(path) = shared(&format!("detectors/{file}")) else {
            return;
        };
        let (bytes, manifest) = (std::fs::read(path).unwrap(), Manifest::named(name).unwrap());
        let shape = [1, 3, side, side];
        let started = Instant::now();
        let network = Network::read(&bytes, file, &shape).unwrap();
        let opened = started.elapsed();
        let mut session = session(&bytes);
        let photos = photos();
        assert_eq!(photos.len(), 20);
        let each = photos
            .iter()
            .map(|p| worst_difference(&network, &mut session, &shape, &numbers(&photo(p), &manifest)));
        let worst = each.fold(0.0, f32::max);
        println!("{name}: opened in {opened:.2?}; outputs of 20 photos within {worst:.1e} of ONNX Runtime");
        assert!(worst < 1e-4, "{name}: {worst}");
    }
}

fn opened(name: &str, file: &str, labels: &[usize]) -> Option<(OnnxDetector, PathBuf)> {
    let path = shared(&format!("detectors/{file}"))?;
    let detector = OnnxDetector::open(&Manifest::named(name).unwrap(), &path, labels).unwrap();
    Some((detector, path))
}

fn picture(photo: &RgbImage) -> (Vec<[f64; 3]>, [u32; 2]) {
    let pixels = photo.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
    (pixels, [photo.width(), photo.height()])
}

/// Weights that pick the claims of highest confidence.
fn best_claims(confidences: &[f64], count: usize) -> Vec<f64> {
    let mut order: Vec<usize> = (0..confidences.len()).collect();
    order.sort_by(|a, b| confidences[*b].total_cmp(&confidences[*a]));
    let mut weights = vec![0.0; confidences.len()];
    order.iter().take(count).for_each(|i| weights[*i] = 1.0);
    weights
}

fn loss(detector: &dyn WhiteBox, picture: &[[f64; 3]], size: [u32; 2], weights: &[f64]) -> f64 {
    let look = detector.look(picture, size).unwrap();
    look.claims().iter().zip(weights).map(|(claim, w)| w * claim.loss).sum()
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        .sum()
}

#[test]
fn gradients_are_those_of_finite_differences() {
    let mut rng = Pcg32::seed_from_u64(5);
    for (name, file, _) in FOLLOWED {
        let Some((detector, _)) = opened(name, file, &[CAR]) else {
            return;
        };
        let mut worst = 0.0_f64;
        for path in photos().iter().step_by(5) {
            let photo = photo(path);
            let (width, height) = (photo.width().min(640), photo.height().min(480));
            let (picture, size) = picture(&image::imageops::thumbnail(&photo, width, height));
            let look = detector.look(&picture, size).unwrap();
            let confidences: Vec<f64> = look.claims().iter().map(|c| c.confidence).collect();
            let weights = best_claims(&confidences, 3);
            let gradient = look.pull_back(&weights);
            let length = dot(&gradient, &gradient).sqrt();
            for _ in 0..2 {
                // Half along the gradient, so that the derivative stands out of the noise of 32 bits, half anywhere.
                let noise: Vec<[f64; 3]> = gradient
                    .iter()
                    .map(|_| std::array::from_fn(|_| rng.random::<f64>() - 0.5))
                    .collect();
                let noise_length = dot(&noise, &noise).sqrt();
                let direction: Vec<[f64; 3]> = (gradient.iter().zip(&noise))
                    .map(|(g, n)| std::array::from_fn(|c| g[c] / length + n[c] / noise_length))
                    .collect();
                let expected = dot(&gradient, &direction);
                let step = 2e-3 / expected;
                let moved = |by: f64| -> Vec<[f64; 3]> {
                    let pixels = picture.iter().zip(&direction);
                    pixels.map(|(p, d)| std::array::from_fn(|c| p[c] + by * d[c])).collect()
                };
                let [up, down] = [step, -step].map(|by| loss(&detector, &moved(by), size, &weights));
                let found = (up - down) / (2.0 * step);
                println!(
                    "{name} {}: C {:.3}, {expected:.5} by gradient, {found:.5} by differences",
                    path.file_name().unwrap().to_string_lossy(),
                    confidences.iter().copied().fold(0.0, f64::max)
                );
                worst = worst.max((found / expected - 1.0).abs());
            }
        }
        println!("{name}: directional derivatives within {:.2} %", 100.0 * worst);
        assert!(worst < 0.01, "{name}: {worst}");
    }
}

#[test]
fn confidences_are_those_of_scoring() {
    let all: Vec<usize> = (0..80).collect();
    for (name, file, side) in FOLLOWED {
        let Some((detector, path)) = opened(name, file, &all) else {
            return;
        };
        let (cars, _) = opened(name, file, &[CAR]).unwrap();
        let mut scorer = Detector::open(Runtime::load().unwrap(), &Manifest::named(name).unwrap(), &path).unwrap();
        for (i, file) in photos().iter().enumerate().step_by(3) {
            // At the network's own size nothing is resized or rounded; at others the rounding to 8 bits is left out here.
            let own_size = i % 2 == 0;
            let side = if own_size { side as u32 } else { 500 };
            let photo = image::imageops::resize(&photo(file), side, side, image::imageops::FilterType::Triangle);
            let (picture, size) = picture(&photo);
            let found = scorer.detect(&photo).unwrap();
            let look = detector.look(&picture, size).unwrap();
            let best = look
                .claims()
                .iter()
                .max_by(|a, b| a.confidence.total_cmp(&b.confidence))
                .unwrap();
            let tolerance = if own_size { (1e-4, 0.1) } else { (0.03, 8.0) };
            assert!(
                (best.confidence - found[0].score).abs() < tolerance.0,
                "{name} {i}: {best:?} {:?}",
                found[0]
            );
            let look = cars.look(&picture, size).unwrap();
            for car in found.iter().filter(|d| d.label == CAR && d.score > 0.2 && own_size) {
                let corners: [f64; 4] = car.box_px.into();
                let same = look.claims().iter().find(|claim| {
                    let b: [f64; 4] = claim.box_px.into();
                    (claim.confidence - car.score).abs() < tolerance.0
                        && (0..4).all(|k| (b[k] - corners[k]).abs() < tolerance.1)
                });
                assert!(same.is_some(), "{name} {i}: no claim is {car:?}");
            }
        }
    }
}

#[test]
fn time_of_one_step() {
    for (name, file, _) in FOLLOWED {
        let Some((detector, _)) = opened(name, file, &[CAR]) else {
            return;
        };
        let (picture, size) = picture(&image::imageops::thumbnail(&photo(&photos()[0]), 640, 480));
        let (mut forth, mut back) = (Vec::new(), Vec::new());
        for _ in 0..6 {
            let started = Instant::now();
            let look = detector.look(&picture, size).unwrap();
            forth.push(started.elapsed().as_secs_f64() * 1e3);
            let weights = vec![1.0; look.claims().len()];
            let started = Instant::now();
            let gradient = look.pull_back(&weights);
            back.push(started.elapsed().as_secs_f64() * 1e3);
            assert!(dot(&gradient, &gradient) > 0.0);
        }
        let median = |mut v: Vec<f64>| {
            v.sort_by(f64::total_cmp);
            v[v.len() / 2]
        };
        println!(
            "{name}: {:.0} ms forwards, {:.0} ms backwards",
            median(forth),
            median(back)
        );
    }
}
