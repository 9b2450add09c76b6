//! `cargo bench --features attack --bench whitebox_speed -- WEIGHTS [NAME…]`: milliseconds a picture through the detectors of an attack, beside ONNX Runtime.
//!
//! ONNX Runtime's forward pass on one thread, ours, and ours with the backward pass, on one thread and on two; the median of some rounds in which they
//! take turns, and ratios to ONNX Runtime. WEIGHTS is a folder with the weights; without names all known detectors that are there.

use std::path::{Path, PathBuf};
use std::time::Instant;

use ort::environment::Environment;
use ort::session::Session;
use scaleproof::{BoxPx, Boxes, DeviceKind, Manifest, OnnxDetector, WhiteBox};

const ROUNDS: usize = 15;
/// Pictures a thread looks at while two are at work.
const TOGETHER: usize = 4;
const CAR: usize = 2;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let Some((folder, names)) = arguments.split_first() else {
        println!("usage: cargo bench --features attack --bench whitebox_speed -- WEIGHTS [NAME…]");
        return;
    };
    let library = std::env::var("ORT_DYLIB_PATH").expect("ORT_DYLIB_PATH, as ./run sets it");
    let environment = ort::init_from(library)
        .expect("ONNX Runtime")
        .build()
        .expect("ONNX Runtime");
    environment.set_log_level(ort::logging::LogLevel::Error);
    let known = ["yolox_nano", "nanodet_m", "fastestdet", "deimv2_femto", "deimv2_atto"];
    println!(
        "{:<14} {:>10} {:>9} {:>16} {:>9} {:>9}",
        "detector", "ort ms", "forward", "forward + back", "of ort", "2 threads"
    );
    for name in known
        .iter()
        .filter(|name| names.is_empty() || names.iter().any(|n| n == *name))
    {
        let manifest = Manifest::named(name).expect("a known detector");
        let path = Path::new(folder).join(&manifest.weights.file);
        if path.exists() {
            measure(&environment, &manifest, &path);
        }
    }
}

fn measure(environment: &Environment, manifest: &Manifest, weights: &Path) {
    let detector = OnnxDetector::open(manifest, weights, &[CAR], DeviceKind::Cpu).expect("a detector");
    let (picture, size) = picture();
    let best = detector.predictions(&picture, size).expect("predictions");
    let best = best
        .iter()
        .max_by(|a, b| a.confidence.total_cmp(&b.confidence))
        .expect("a car");
    let outline: BoxPx = best.box_px;
    let mut session = session(environment, weights);
    let look = || {
        detector
            .loss_and_gradient(&picture, size, &outline, Boxes::Strongest)
            .expect("a gradient")
            .expect("a car")
    };
    let mut ms: [Vec<f64>; 4] = Default::default();
    for _ in 0..ROUNDS {
        ms[0].push(time(|| forward(&mut session, manifest.input.size_px)));
        ms[1].push(time(|| drop(detector.predictions(&picture, size))));
        ms[2].push(time(|| drop(look())));
        let together = time(|| {
            std::thread::scope(|scope| {
                (0..2).for_each(|_| drop(scope.spawn(|| (0..TOGETHER).for_each(|_| drop(look())))));
            });
        });
        ms[3].push(together / (2 * TOGETHER) as f64);
    }
    let [ort, forward, both, two] = ms.map(median);
    let (ratio, faster) = (both / ort, both / two);
    println!(
        "{:<14} {ort:>10.1} {forward:>9.1} {both:>16.1} {ratio:>8.1}× {faster:>8.2}×",
        manifest.name
    );
}

fn time(work: impl FnOnce()) -> f64 {
    let started = Instant::now();
    work();
    started.elapsed().as_secs_f64() * 1e3
}

fn median(mut ms: Vec<f64>) -> f64 {
    ms.sort_by(f64::total_cmp);
    ms[ms.len() / 2]
}

/// A stored photo, as large as the frames of an attack.
fn picture() -> (Vec<[f64; 3]>, [u32; 2]) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("captures/skyline");
    let files = std::fs::read_dir(folder)
        .expect("the stored session")
        .map(|file| file.expect("a file").path());
    let photo = files
        .filter(|f| f.extension().is_some_and(|e| e == "jpg"))
        .min()
        .expect("a photo");
    let photo = image::open(photo).expect("a photo").to_rgb8();
    let small = image::imageops::thumbnail(&photo, 256, 192);
    let pixels = small.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
    (pixels, [small.width(), small.height()])
}

fn session(environment: &Environment, weights: &Path) -> Session {
    let builder = Session::builder(environment).expect("ONNX Runtime");
    let mut builder = builder.with_intra_threads(1).expect("one thread");
    builder.commit_from_file(weights).expect("a session")
}

fn forward(session: &mut Session, [width, height]: [u32; 2]) {
    let numbers = vec![0.5_f32; 3 * (width * height) as usize];
    let shape = vec![1, 3, height as usize, width as usize];
    let image = ort::value::Tensor::from_array((shape, numbers)).expect("a tensor");
    let mut inputs = Vec::from(ort::inputs![image]);
    if session.inputs().len() == 2 {
        let size = vec![i64::from(width), i64::from(height)];
        inputs.extend(ort::inputs![
            ort::value::Tensor::from_array((vec![1, 2], size)).expect("a size")
        ]);
    }
    session.run(&inputs[..]).expect("ONNX Runtime's outputs");
}
