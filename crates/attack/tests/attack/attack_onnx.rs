//! Detectors that gradients pass: outputs against ONNX Runtime, gradients against finite differences, confidences against scoring.

use crate::common;

use std::path::{Path, PathBuf};
use std::time::Instant;

use common::{home, shared};
use image::RgbImage;
use parity::{FOLLOWED, as_written, by_network, by_onnx_runtime, numbers, photo, photos, session, worst_difference};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::view_set::{TextureMapping, ViewSet};
use scaleproof_attack::run::weights::Against;
use scaleproof_attack::run::{Attack, AttackConfig};
use scaleproof_detect::{Detector, Hints, Labels, Manifest, Runtime, propose};
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::projection::Grid;
use scaleproof_gradients::detector::OnnxDetector;
use scaleproof_gradients::onnx::OnnxNetwork;
use scaleproof_gradients::{Boxes, Prediction, WhiteBox};

use crate::common::onnx;
#[path = "attack_onnx/parity.rs"]
pub(super) mod parity;
#[path = "attack_onnx/stored.rs"]
mod stored;

const CAR: usize = 2;

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn outputs_are_those_of_onnx_runtime() {
    for (name, file, side) in FOLLOWED {
        let path = shared(&format!("detectors/{file}"));
        let (bytes, manifest) = (std::fs::read(path).unwrap(), Manifest::named(name).unwrap());
        let shape = [1, 3, side, side];
        let started = Instant::now();
        let network = OnnxNetwork::<f32>::read(&bytes, file, &shape, Some([side as u32; 2])).unwrap();
        let opened = started.elapsed();
        let mut session = session(&bytes);
        let mut as_written = as_written(&bytes);
        let photos = photos();
        assert_eq!(photos.len(), 20);
        let (mut worst, mut from_fused, mut its_own) = (0.0_f32, 0.0_f32, 0.0_f32);
        for path in &photos {
            let numbers = numbers(&photo(path), &manifest);
            let ours = by_network(&network, &numbers);
            let plain = by_onnx_runtime(&mut as_written, &shape, &numbers);
            let fused = by_onnx_runtime(&mut session, &shape, &numbers);
            worst = worst.max(worst_difference(&ours, &plain));
            from_fused = from_fused.max(worst_difference(&ours, &fused));
            its_own = its_own.max(worst_difference(&plain, &fused));
        }
        println!(
            "{name}: opened in {opened:.2?}; outputs of 20 photos within {worst:.1e} of ONNX Runtime's for the file as written, \
             {from_fused:.1e} for the file as it optimises it; these two differ by {its_own:.1e}"
        );
        // Each rounds in its own places; `attack_onnx_exact` asks what is left without our rounding.
        assert!(worst.min(from_fused) < 1e-4 + its_own, "{name}: {worst} {from_fused}");
        assert!(worst.max(from_fused) < 1.3e-4, "{name}: {worst} {from_fused}");
    }
}

fn opened(name: &str, file: &str, labels: &[usize]) -> (OnnxDetector, PathBuf) {
    let path = shared(&format!("detectors/{file}"));
    let detector = OnnxDetector::<f32>::open(&Manifest::named(name).unwrap(), &path, labels).unwrap();
    (detector, path)
}

/// Networks of other lineages, with the manifests that `detectors add` proposes; those whose labels somebody has to name, with their own.
fn others() -> Vec<(Manifest, PathBuf)> {
    let more = |name: &str, end: &str| shared(&format!("detectors_more/{name}.{end}"));
    let proposed = |name: &str| {
        let path = more(name, "onnx");
        let found = propose(Runtime::load().unwrap(), &path, "network.onnx", name, Hints::default()).unwrap();
        (found.manifest, path)
    };
    let named = |name: &str| {
        let text = std::fs::read_to_string(more(name, "toml")).unwrap();
        (Manifest::parse(&text, name).unwrap(), more(name, "onnx"))
    };
    let without_labels = ["yolov8n_640", "yolo26n_320_table", "yolo26n_320"];
    let names = [
        "yolov4_tiny",
        "ssdlite_mobilenet_v2_coco",
        "yolo_fastest_xl",
        "picodet_s_320",
    ];
    names
        .iter()
        .map(|name| proposed(name))
        .chain(without_labels.map(named))
        .collect()
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn outputs_of_other_lineages_are_those_of_onnx_runtime() {
    for (manifest, path) in others() {
        let bytes = std::fs::read(path).unwrap();
        let [width, height] = manifest.input.size_px.map(|side| side as usize);
        let shape = [1, 3, height, width];
        let network = OnnxNetwork::<f32>::read(&bytes, &manifest.name, &shape, None).unwrap();
        let mut as_written = as_written(&bytes);
        let mut worst = 0.0_f32;
        for path in photos().iter().step_by(4) {
            let numbers = numbers(&photo(path), &manifest);
            let (ours, theirs) = (
                by_network(&network, &numbers),
                by_onnx_runtime(&mut as_written, &shape, &numbers),
            );
            worst = worst.max(worst_difference(&ours, &theirs));
        }
        println!(
            "{}: outputs of 5 photos within {worst:.1e} of ONNX Runtime's",
            manifest.name
        );
        assert!(worst < 1e-4, "{}: {worst}", manifest.name);
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn gradients_of_other_lineages_are_those_of_finite_differences() {
    let mut rng = Pcg32::seed_from_u64(5);
    for (manifest, path) in others() {
        let car = manifest.labels.find("car").unwrap();
        let detectors = both(&manifest, &path, &[car]);
        for path in photos().iter().step_by(7) {
            let (picture, size) = picture(&image::imageops::thumbnail(&photo(path), 640, 480));
            let (worst, jumps) = worst_derivative(&detectors, &picture, size, &mut rng);
            assert!(jumps == 0 && worst < 0.01, "{}: {worst}, {jumps} jumps", manifest.name);
        }
    }
}

fn picture(photo: &RgbImage) -> (Vec<[f64; 3]>, [u32; 2]) {
    let pixels = photo.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
    (pixels, [photo.width(), photo.height()])
}

/// Weights that pick the predictions of highest confidence.
fn best_predictions(confidences: &[f64], count: usize) -> Vec<f64> {
    let mut order: Vec<usize> = (0..confidences.len()).collect();
    order.sort_by(|a, b| confidences[*b].total_cmp(&confidences[*a]));
    let mut weights = vec![0.0; confidences.len()];
    order.iter().take(count).for_each(|i| weights[*i] = 1.0);
    weights
}

/// Detectors that list their predictions by confidence.
const SORTED: [&str; 5] = [
    "deimv2_femto",
    "deimv2_atto",
    "yolo26n_320",
    "yolo26_end2end",
    "rtdetr_v2",
];

/// Σ weight · loss of some predictions, each met again in another image by its place in the list or, in lists that are sorted by
/// confidence, as the one that is nearest.
fn loss(
    detector: &OnnxDetector<f64>,
    picture: &[[f64; 3]],
    size: [u32; 2],
    known: &[Prediction],
    weights: &[f64],
) -> f64 {
    let predictions = detector.predictions(picture, size).unwrap();
    let is_sorted = SORTED.contains(&detector.name());
    let again = |i: usize| {
        if is_sorted {
            predictions
                .iter()
                .min_by(|a, b| distance(a, &known[i]).total_cmp(&distance(b, &known[i])))
                .unwrap()
        } else {
            &predictions[i]
        }
    };
    let weighted = weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
    weighted.map(|(i, weight)| weight * again(i).loss).sum()
}

/// In pixels; a hundredth of confidence counts as one.
fn distance(a: &Prediction, b: &Prediction) -> f64 {
    let [c, d]: [[f64; 4]; 2] = [a.box_px.into(), b.box_px.into()];
    (0..4).map(|i| (c[i] - d[i]).abs()).sum::<f64>() + 100.0 * (a.confidence - b.confidence).abs()
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        .sum()
}

/// A detector of 32 bits, and the same in 64, whose differences are not drowned by rounding.
type Both = (OnnxDetector, OnnxDetector<f64>);

fn both(manifest: &Manifest, path: &Path, labels: &[usize]) -> Both {
    let exact = OnnxDetector::open(manifest, path, labels).unwrap();
    (OnnxDetector::<f32>::open(manifest, path, labels).unwrap(), exact)
}

/// By how much directional derivatives of the three best predictions' losses differ from central differences, relatively; the worst of some
/// directions, and in how many the loss jumps.
///
/// Networks that choose queries choose others a little further on: the loss has a jump there, and differences over other steps are others.
fn worst_derivative((detector, exact): &Both, picture: &[[f64; 3]], size: [u32; 2], rng: &mut Pcg32) -> (f64, usize) {
    let look = detector.forward(picture, size).unwrap();
    let known = look.predictions().to_vec();
    let confidences: Vec<f64> = known.iter().map(|c| c.confidence).collect();
    let weights = best_predictions(&confidences, 3);
    let gradient = look.vjp(&weights);
    let length = dot(&gradient, &gradient).sqrt();
    let before = loss(exact, picture, size, &known, &weights);
    let (mut worst, mut jumps) = (0.0_f64, 0);
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
        // Rounding disturbs small steps, bends of the network large ones.
        let steps = [0.01, 0.003, 0.001, 0.0003].map(|share| share * before / expected);
        let moved = |by: f64| -> Vec<[f64; 3]> {
            let pixels = picture.iter().zip(&direction);
            pixels.map(|(p, d)| std::array::from_fn(|c| p[c] + by * d[c])).collect()
        };
        let slopes = steps.map(|step| {
            let [up, down] = [step, -step].map(|by| loss(exact, &moved(by), size, &known, &weights));
            (up - down) / (2.0 * step)
        });
        // Where two steps agree best neither disturbs; across a jump none agree, since it counts the more the smaller the step is.
        let apart = |pair: &&[f64]| (pair[0] - pair[1]).abs() / pair[0].abs();
        let best = slopes.windows(2).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let Some([found, _]) = best.filter(|pair| apart(pair) < 0.02) else {
            println!("{}: {expected:.5} by gradient, the loss jumps", detector.name());
            jumps += 1;
            continue;
        };
        println!(
            "{}: {expected:.5} by gradient, {found:.5} by differences",
            detector.name()
        );
        worst = worst.max((found / expected - 1.0).abs());
    }
    (worst, jumps)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn gradients_are_those_of_finite_differences() {
    let mut rng = Pcg32::seed_from_u64(5);
    for (name, file, _) in FOLLOWED {
        let path = shared(&format!("detectors/{file}"));
        let detectors = both(&Manifest::named(name).unwrap(), &path, &[CAR]);
        let (mut worst, mut jumps) = (0.0_f64, 0);
        for path in photos().iter().step_by(5) {
            let (picture, size) = picture(&image::imageops::thumbnail(&photo(path), 640, 480));
            let (of_photo, of_photo_jumps) = worst_derivative(&detectors, &picture, size, &mut rng);
            worst = worst.max(of_photo);
            jumps += of_photo_jumps;
        }
        println!(
            "{name}: directional derivatives within {:.2} %, {jumps} of 8 at jumps",
            100.0 * worst
        );
        assert!(jumps == 0 || name.starts_with("deim") && jumps <= 2, "{name}: {jumps}");
        assert!(worst < 0.01, "{name}: {worst}");
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn confidences_are_those_of_scoring() {
    let all: Vec<usize> = (0..80).collect();
    for (name, file, side) in FOLLOWED {
        let (detector, path) = opened(name, file, &all);
        let (cars, _) = opened(name, file, &[CAR]);
        let mut scorer = Detector::open(Runtime::load().unwrap(), &Manifest::named(name).unwrap(), &path).unwrap();
        for (i, file) in photos().iter().enumerate().step_by(3) {
            // At the network's own size nothing is resized or rounded; at others the rounding to 8 bits is left out here.
            let own_size = i % 2 == 0;
            let side = if own_size { side as u32 } else { 500 };
            let photo = image::imageops::resize(&photo(file), side, side, image::imageops::FilterType::Triangle);
            let (picture, size) = picture(&photo);
            let found = scorer.detect(&photo).unwrap();
            let look = detector.forward(&picture, size).unwrap();
            let best = look
                .predictions()
                .iter()
                .max_by(|a, b| a.confidence.total_cmp(&b.confidence))
                .unwrap();
            let tolerance = if own_size { (1e-4, 0.1) } else { (0.03, 8.0) };
            assert!(
                (best.confidence - found[0].score).abs() < tolerance.0,
                "{name} {i}: {best:?} {:?}",
                found[0]
            );
            let look = cars.forward(&picture, size).unwrap();
            for car in found.iter().filter(|d| d.label == CAR && d.score > 0.2 && own_size) {
                let corners: [f64; 4] = car.box_px.into();
                let same = look.predictions().iter().find(|prediction| {
                    let b: [f64; 4] = prediction.box_px.into();
                    (prediction.confidence - car.score).abs() < tolerance.0
                        && (0..4).all(|k| (b[k] - corners[k]).abs() < tolerance.1)
                });
                assert!(same.is_some(), "{name} {i}: no prediction is {car:?}");
            }
        }
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_same_seed_gives_the_same_pattern_on_any_number_of_threads() {
    let grid = Grid {
        columns: 8,
        rows: 8,
        cell_mm: 30.0,
    };
    let frames = FrameSet::open(&home().join("captures/skyline_attack")).unwrap();
    let view_set = ViewSet::open(&[frames], grid, TextureMapping::World, &Eot::NONE, || {}).unwrap();
    let (detector, _) = opened("fastestdet", "FastestDet.onnx", &[CAR]);
    let detectors: Vec<Box<dyn WhiteBox>> = vec![Box::new(detector)];
    let config = AttackConfig {
        cells: 8,
        tile_mm: 240.0,
        steps: 2,
        batch: 5,
        learning_rate: 0.03,
        boxes: Boxes::Strongest,
        floor: 0.001,
        against: Against::Mean,
        hard: 0.0,
        seed: 7,
        ..AttackConfig::usual("car".parse().unwrap())
    };
    let run = |threads: usize| {
        let folder = tempfile::tempdir().unwrap();
        let attack = Attack::begin(&view_set, &detectors, &config, folder.path()).unwrap();
        let mut of_steps = Vec::new();
        let run = attack.over_threads(threads).run(folder.path(), |_, entry| {
            of_steps.push((entry.loss.map(f64::to_bits), entry.held_out));
        });
        (run.unwrap().0, of_steps)
    };
    let alone = run(1);
    assert!(alone.1.iter().all(|(loss, _)| *loss > Some(0)), "{:?}", alone.1);
    for threads in [2, 5] {
        assert_eq!(run(threads), alone, "{threads} threads");
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn time_of_one_step() {
    let known = FOLLOWED.map(|(name, file, _)| (name.to_owned(), opened(name, file, &[CAR]).0));
    let others = others().into_iter().map(|(manifest, path)| {
        let car = manifest.labels.find("car").unwrap();
        (
            manifest.name.clone(),
            OnnxDetector::<f32>::open(&manifest, &path, &[car]).unwrap(),
        )
    });
    for (name, detector) in known.into_iter().chain(others) {
        let (picture, size) = picture(&image::imageops::thumbnail(&photo(&photos()[0]), 640, 480));
        let (mut forth, mut back) = (Vec::new(), Vec::new());
        for _ in 0..6 {
            let started = Instant::now();
            let look = detector.forward(&picture, size).unwrap();
            forth.push(started.elapsed().as_secs_f64() * 1e3);
            let weights = vec![1.0; look.predictions().len()];
            let started = Instant::now();
            let gradient = look.vjp(&weights);
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

/// A network of a few nodes, for an input of some shape.
struct Small {
    name: &'static str,
    shape: Vec<usize>,
    parts: Vec<Vec<u8>>,
    outputs: Vec<&'static str>,
    opset: u64,
}

impl Small {
    fn bytes(&self) -> Vec<u8> {
        let sides: Vec<i64> = self.shape.iter().map(|side| *side as i64).collect();
        onnx::graph(
            &onnx::Input::floats("x", &sides),
            &self.parts,
            &self.outputs,
            self.opset,
        )
    }
}

fn small(name: &'static str, shape: &[usize], parts: Vec<Vec<u8>>) -> Small {
    Small {
        name,
        shape: shape.to_vec(),
        parts,
        outputs: vec!["y"],
        opset: 13,
    }
}

/// y = operator(x), with attributes.
fn unary(name: &'static str, attributes: &[Vec<u8>]) -> Small {
    small(name, &[1, 2, 3, 4], vec![onnx::step(name, &["x"], &["y"], attributes)])
}

fn spread(count: usize, seed: u64) -> Vec<f32> {
    let mut rng = Pcg32::seed_from_u64(seed);
    (0..count).map(|_| rng.random::<f32>() * 2.0 - 1.0).collect()
}

fn activations() -> Vec<Small> {
    use onnx::{constant, float_attribute, step};
    let alpha = |v| float_attribute("alpha", v);
    let mut found: Vec<Small> = [
        "Sigmoid", "Relu", "Tanh", "Exp", "Softplus", "Neg", "Abs", "Identity", "Erf",
    ]
    .map(|name| unary(name, &[]))
    .into();
    found.push(unary("LeakyRelu", &[alpha(0.1)]));
    found.push(unary("Elu", &[alpha(0.7)]));
    found.push(unary("HardSigmoid", &[alpha(0.3), float_attribute("beta", 0.4)]));
    found.push(Small {
        opset: 14,
        ..unary("HardSwish", &[])
    });
    found.push(Small {
        opset: 18,
        ..unary("Mish", &[])
    });
    // Roots and logarithms of x + 2, which is above 0.
    for name in ["Sqrt", "Log", "Reciprocal"] {
        let shifted = [
            constant("two", &[], &[2.0]),
            step("Add", &["x", "two"], &["shifted"], &[]),
        ]
        .concat();
        found.push(small(
            name,
            &[1, 2, 3, 4],
            vec![shifted, step(name, &["shifted"], &["y"], &[])],
        ));
    }
    let limits = [constant("low", &[], &[-0.3]), constant("high", &[], &[0.4])].concat();
    found.push(small(
        "Clip",
        &[1, 2, 3, 4],
        vec![limits, step("Clip", &["x", "low", "high"], &["y"], &[])],
    ));
    let slopes = constant("slopes", &[2, 1, 1], &[0.2, 0.5]);
    found.push(small(
        "PRelu",
        &[1, 2, 3, 4],
        vec![slopes, step("PRelu", &["x", "slopes"], &["y"], &[])],
    ));
    // As YOLOv4 of the zoo writes Mish, and as all others write SiLU.
    let mish = [
        step("Softplus", &["x"], &["a"], &[]),
        step("Tanh", &["a"], &["b"], &[]),
        step("Mul", &["x", "b"], &["y"], &[]),
    ];
    found.push(small("Softplus + Tanh", &[1, 2, 3, 4], mish.into()));
    let silu = [
        step("Sigmoid", &["x"], &["s"], &[]),
        step("Mul", &["x", "s"], &["y"], &[]),
    ];
    found.push(small("SiLU", &[1, 2, 3, 4], silu.into()));
    found
}

fn arithmetic() -> Vec<Small> {
    use onnx::{constant, step};
    let mut found = Vec::new();
    for name in ["Add", "Sub", "Mul", "Div", "Max", "Min"] {
        let other = constant("c", &[3, 1], &[1.5, -0.7, 0.4]);
        found.push(small(
            name,
            &[1, 2, 3, 4],
            vec![other, step(name, &["x", "c"], &["y"], &[])],
        ));
    }
    // Both operands follow the image, of different ranks.
    let two = [
        constant("w", &[4, 1], &spread(4, 7)),
        step("MatMul", &["x", "w"], &["a"], &[]),
        step("Sub", &["a", "x"], &["y"], &[]),
    ];
    found.push(small("MatMul, Sub", &[1, 2, 3, 4], two.into()));
    let power = [constant("e", &[], &[2.0]), step("Pow", &["x", "e"], &["y"], &[])];
    found.push(small("Pow", &[1, 2, 3, 4], power.into()));
    let product = [
        constant("w", &[5, 4], &spread(20, 8)),
        constant("b", &[5], &spread(5, 9)),
        step("Gemm", &["x", "w", "b"], &["y"], &[onnx::whole_attribute("transB", 1)]),
    ];
    found.push(small("Gemm", &[3, 4], product.into()));
    let product = [
        constant("w", &[4, 5], &spread(20, 8)),
        constant("b", &[5], &spread(5, 9)),
        step("MatMul", &["x", "w"], &["p"], &[]),
        step("Add", &["p", "b"], &["y"], &[]),
    ];
    found.push(small("MatMul, Add", &[2, 3, 4], product.into()));
    // The distribution over bins of YOLOv8's boxes.
    let bins = [
        onnx::whole_constant("s", &[4], &[1, 4, 4, 6]),
        step("Reshape", &["x", "s"], &["r"], &[]),
        step(
            "Transpose",
            &["r"],
            &["t"],
            &[onnx::list_attribute("perm", &[0, 2, 1, 3])],
        ),
        step("Softmax", &["t"], &["p"], &[onnx::whole_attribute("axis", 1)]),
        constant("w", &[1, 4, 1, 1], &[0.0, 1.0, 2.0, 3.0]),
        step("Conv", &["p", "w"], &["y"], &[]),
    ];
    found.push(small("Softmax over bins", &[1, 16, 6], bins.into()));
    let axes = onnx::whole_constant("axes", &[1], &[-1]);
    let kept = onnx::whole_attribute("keepdims", 0);
    found.push(small(
        "ReduceSum",
        &[1, 2, 3, 4],
        vec![axes, step("ReduceSum", &["x", "axes"], &["y"], &[kept])],
    ));
    for name in ["ReduceMean", "ReduceMax", "ReduceMin"] {
        found.push(unary(name, &[onnx::list_attribute("axes", &[1, 3])]));
    }
    found
}

fn convolutions() -> Vec<Small> {
    use onnx::{constant, list_attribute as list, step, text_attribute, whole_attribute as whole};
    let picture = [1, 4, 7, 6];
    let conv = |name, weight: &[usize], attributes: &[Vec<u8>]| {
        let count = weight.iter().product();
        let weight = constant("w", weight, &spread(count, 11));
        let bias = constant("b", &[4], &spread(4, 12));
        small(
            name,
            &picture,
            vec![weight, bias, step("Conv", &["x", "w", "b"], &["y"], attributes)],
        )
    };
    let pool = |name, operator, attributes: &[Vec<u8>]| {
        small(name, &picture, vec![step(operator, &["x"], &["y"], attributes)])
    };
    let three = || list("kernel_shape", &[3, 3]);
    let norm = ["scale", "shift", "mean"].map(|name| constant(name, &[4], &spread(4, 13)));
    let norm = [norm.concat(), constant("variance", &[4], &[0.5, 1.0, 2.0, 0.1])].concat();
    let names = ["x", "scale", "shift", "mean", "variance"];
    let up = [
        constant("w", &[4, 2, 2, 2], &spread(32, 14)),
        step("ConvTranspose", &["x", "w"], &["y"], &[list("strides", &[2, 2])]),
    ];
    vec![
        conv("Conv", &[4, 4, 3, 3], &[list("pads", &[1, 1, 1, 1])]),
        conv(
            "Conv, stride 2, one-sided border",
            &[4, 4, 3, 3],
            &[list("pads", &[0, 0, 1, 1]), list("strides", &[2, 2])],
        ),
        conv(
            "Conv, SAME_UPPER",
            &[4, 4, 3, 3],
            &[text_attribute("auto_pad", "SAME_UPPER"), list("strides", &[2, 2])],
        ),
        conv(
            "Conv, dilated",
            &[4, 4, 3, 3],
            &[list("dilations", &[2, 2]), list("pads", &[2, 2, 2, 2])],
        ),
        conv(
            "Conv, depthwise",
            &[4, 1, 3, 3],
            &[whole("group", 4), list("pads", &[1, 1, 1, 1])],
        ),
        conv("Conv, two groups", &[4, 2, 1, 1], &[whole("group", 2)]),
        conv(
            "Conv, two groups of 3 × 2",
            &[4, 2, 3, 2],
            &[whole("group", 2), list("pads", &[1, 0, 0, 1]), list("strides", &[2, 1])],
        ),
        conv("Conv, a point", &[4, 4, 1, 1], &[]),
        conv("Conv, a point, stride 2", &[4, 4, 1, 1], &[list("strides", &[2, 2])]),
        conv(
            "Conv, depthwise, stride 2",
            &[4, 1, 5, 5],
            &[whole("group", 4), list("pads", &[2, 2, 2, 2]), list("strides", &[2, 2])],
        ),
        conv(
            "Conv, depthwise, stride 2, dilated, one-sided border",
            &[4, 1, 3, 2],
            &[
                whole("group", 4),
                list("pads", &[0, 1, 2, 3]),
                list("strides", &[2, 3]),
                list("dilations", &[2, 3]),
            ],
        ),
        small("ConvTranspose", &picture, up.into()),
        small(
            "BatchNormalization",
            &picture,
            vec![norm, step("BatchNormalization", &names, &["y"], &[])],
        ),
        pool("MaxPool", "MaxPool", &[three(), list("pads", &[1, 1, 1, 1])]),
        pool(
            "MaxPool, 5 × 5",
            "MaxPool",
            &[list("kernel_shape", &[5, 5]), list("pads", &[2, 2, 2, 2])],
        ),
        pool(
            "MaxPool, stride 2, ceil",
            "MaxPool",
            &[three(), list("strides", &[2, 2]), whole("ceil_mode", 1)],
        ),
        pool(
            "AveragePool",
            "AveragePool",
            &[three(), list("strides", &[2, 2]), list("pads", &[1, 1, 1, 1])],
        ),
        pool(
            "AveragePool, border counts",
            "AveragePool",
            &[three(), list("pads", &[1, 1, 1, 1]), whole("count_include_pad", 1)],
        ),
        pool("GlobalAveragePool", "GlobalAveragePool", &[]),
        pool("GlobalMaxPool", "GlobalMaxPool", &[]),
    ]
}

fn resizes() -> Vec<Small> {
    use onnx::{constant, step, text_attribute as text, whole_constant};
    let mut found = Vec::new();
    for (name, mode, coordinates, nearest, scales) in [
        ("nearest ×2", "nearest", "asymmetric", "floor", [2.0, 2.0]),
        (
            "nearest ×1.5, half pixel",
            "nearest",
            "half_pixel",
            "round_prefer_floor",
            [1.5, 2.5],
        ),
        ("linear ×2, half pixel", "linear", "half_pixel", "floor", [2.0, 2.0]),
        (
            "linear ×2, aligned corners",
            "linear",
            "align_corners",
            "floor",
            [2.0, 2.0],
        ),
        (
            "linear ×2, PyTorch",
            "linear",
            "pytorch_half_pixel",
            "floor",
            [2.0, 1.5],
        ),
        ("linear, smaller", "linear", "asymmetric", "floor", [0.5, 0.6]),
    ] {
        let attributes = [
            text("mode", mode),
            text("coordinate_transformation_mode", coordinates),
            text("nearest_mode", nearest),
        ];
        let scales = constant("scales", &[4], &[1.0, 1.0, scales[0], scales[1]]);
        found.push(small(
            name,
            &[1, 2, 4, 5],
            vec![scales, step("Resize", &["x", "", "scales"], &["y"], &attributes)],
        ));
    }
    // As Paddle writes it: a region that only another mode looks at.
    let (region, scales) = (
        constant("region", &[8], &[0.0; 8]),
        constant("scales", &[4], &[1.0, 1.0, 2.0, 2.0]),
    );
    let attributes = [
        text("mode", "nearest"),
        text("coordinate_transformation_mode", "half_pixel"),
    ];
    found.push(Small {
        opset: 11,
        ..small(
            "Resize with a region of interest",
            &[1, 2, 4, 5],
            vec![
                region,
                scales,
                step("Resize", &["x", "region", "scales"], &["y"], &attributes),
            ],
        )
    });
    let sizes = whole_constant("sizes", &[4], &[1, 2, 8, 10]);
    let attributes = [
        text("mode", "nearest"),
        text("coordinate_transformation_mode", "asymmetric"),
        text("nearest_mode", "floor"),
    ];
    found.push(small(
        "Resize to a size",
        &[1, 2, 4, 5],
        vec![sizes, step("Resize", &["x", "", "", "sizes"], &["y"], &attributes)],
    ));
    for mode in ["constant", "reflect", "edge"] {
        let pads = [
            whole_constant("pads", &[8], &[0, 0, 1, 2, 0, 0, 0, 1]),
            constant("v", &[], &[0.3]),
        ]
        .concat();
        found.push(small(
            "Pad",
            &[1, 2, 4, 5],
            vec![pads, step("Pad", &["x", "pads", "v"], &["y"], &[text("mode", mode)])],
        ));
    }
    found
}

fn rearrangements() -> Vec<Small> {
    use onnx::{list_attribute as list, step, whole_attribute as whole, whole_constant};
    let shape = [1, 2, 3, 4];
    let slice = |name, starts: &[i64], ends: &[i64], axes: &[i64], steps: &[i64]| {
        let n = starts.len();
        let numbers = [
            whole_constant("starts", &[n], starts),
            whole_constant("ends", &[n], ends),
            whole_constant("axes", &[n], axes),
            whole_constant("steps", &[n], steps),
        ];
        small(
            name,
            &shape,
            vec![
                numbers.concat(),
                step("Slice", &["x", "starts", "ends", "axes", "steps"], &["y"], &[]),
            ],
        )
    };
    let gather = |name, shape_of_places: &[usize], places: &[i64], axis| {
        let places = whole_constant("places", shape_of_places, places);
        small(
            name,
            &shape,
            vec![places, step("Gather", &["x", "places"], &["y"], &[whole("axis", axis)])],
        )
    };
    let with = |operator: &'static str, numbers: &[i64]| {
        let constant = whole_constant("n", &[numbers.len()], numbers);
        small(
            operator,
            &shape,
            vec![constant, step(operator, &["x", "n"], &["y"], &[])],
        )
    };
    let blocks = |operator: &'static str, shape: &[usize], mode: &[Vec<u8>]| {
        let attributes = [&[whole("blocksize", 2)], mode].concat();
        small(operator, shape, vec![step(operator, &["x"], &["y"], &attributes)])
    };
    // The shape of the image, computed with: rows · columns as the new last side.
    let calculated = [
        step("Shape", &["x"], &["s"], &[]),
        whole_constant("two", &[], &[2]),
        whole_constant("three", &[], &[3]),
        whole_constant("zero", &[1], &[0]),
        step("Gather", &["s", "two"], &["rows"], &[]),
        step("Gather", &["s", "three"], &["columns"], &[]),
        step("Mul", &["rows", "columns"], &["cells"], &[]),
        step("Unsqueeze", &["cells", "zero"], &["side"], &[]),
        whole_constant("front", &[2], &[1, -1]),
        step("Concat", &["front", "side"], &["target"], &[whole("axis", 0)]),
        step("Reshape", &["x", "target"], &["y"], &[]),
    ];
    let split = [
        whole_constant("sizes", &[2], &[1, 3]),
        step("Split", &["x", "sizes"], &["a", "b"], &[whole("axis", 3)]),
        step("Mul", &["a", "b"], &["y"], &[]),
    ];
    let halves = [
        step("Split", &["x"], &["a", "b"], &[whole("axis", 1)]),
        step("Concat", &["b", "x", "a"], &["y"], &[whole("axis", 1)]),
    ];
    vec![
        with("Reshape", &[0, -1, 2]),
        with("Expand", &[2, 1, 3, 4]),
        with("Tile", &[1, 2, 1, 3]),
        with("Squeeze", &[0]),
        with("Unsqueeze", &[1, -1]),
        unary("Flatten", &[whole("axis", 2)]),
        unary("Transpose", &[list("perm", &[0, 3, 1, 2])]),
        slice("Slice", &[0, -3], &[1, i64::MAX], &[1, 3], &[1, 1]),
        slice("Slice, every second", &[1, 0], &[4, 3], &[3, 2], &[2, 2]),
        slice("Slice, backwards", &[-1], &[i64::MIN], &[3], &[-1]),
        gather("Gather, one", &[], &[-1], 2),
        gather("Gather, in disorder", &[3], &[3, 0, 3], 3),
        gather("Gather, a table", &[2, 2], &[0, 1, 2, 0], 2),
        small("Split in halves, Concat", &shape, halves.into()),
        small("Split by sizes", &shape, split.into()),
        small("Shape arithmetic", &shape, calculated.into()),
        blocks("DepthToSpace", &[1, 8, 2, 3], &[]),
        blocks("DepthToSpace", &[2, 12, 2, 3], &[onnx::text_attribute("mode", "CRD")]),
        blocks("SpaceToDepth", &[1, 2, 4, 6], &[]),
    ]
}

fn choices() -> Vec<Small> {
    use onnx::{constant, float_attribute, step, text_attribute as text, whole_attribute as whole, whole_constant};
    let shape = [1, 2, 3, 4];
    // The indices depend on the image: they are repeated, and used along another tensor.
    let used = [
        whole_constant("k", &[1], &[2]),
        step("TopK", &["x", "k"], &["best", "where"], &[whole("axis", 2)]),
        step("Mul", &["x", "x"], &["squares"], &[]),
        step("GatherElements", &["squares", "where"], &["taken"], &[whole("axis", 2)]),
        step("Add", &["best", "taken"], &["y"], &[]),
    ];
    let repeated = [
        whole_constant("k", &[1], &[3]),
        whole_constant("last", &[1], &[-1]),
        whole_constant("flat", &[2], &[1, -1]),
        whole_constant("times", &[3], &[1, 1, 4]),
        whole_constant("six_by_four", &[3], &[1, 6, 4]),
        step(
            "ReduceMax",
            &["x"],
            &["row_bests"],
            &[onnx::list_attribute("axes", &[-1]), whole("keepdims", 0)],
        ),
        step("Reshape", &["row_bests", "flat"], &["rows"], &[]),
        step("TopK", &["rows", "k"], &["best", "where"], &[whole("largest", 0)]),
        step("Unsqueeze", &["where", "last"], &["column"], &[]),
        step("Tile", &["column", "times"], &["columns"], &[]),
        step("Reshape", &["x", "six_by_four"], &["lines"], &[]),
        step("GatherElements", &["lines", "columns"], &["y"], &[whole("axis", 1)]),
    ];
    // Places from far outside to the middle, which move with the image.
    let sampled = |name, padding: &str, align: i64| {
        let places: Vec<f32> = (0..24).map(|i| (i * 7 % 24) as f32 / 8.0 - 1.45).collect();
        let parts = vec![
            constant("places", &[2, 3, 2, 2], &places),
            whole_constant("images", &[4], &[2, 1, 3, 4]),
            whole_constant("grid", &[4], &[2, 3, 2, 2]),
            constant("tenth", &[], &[0.1]),
            step("Reshape", &["x", "images"], &["seen"], &[]),
            step("Reshape", &["x", "grid"], &["numbers"], &[]),
            step("Mul", &["numbers", "tenth"], &["shifts"], &[]),
            step("Add", &["places", "shifts"], &["grid_places"], &[]),
            step(
                "GridSample",
                &["seen", "grid_places"],
                &["y"],
                &[
                    text("mode", "bilinear"),
                    text("padding_mode", padding),
                    whole("align_corners", align),
                ],
            ),
        ];
        Small {
            opset: 16,
            ..small(name, &shape, parts)
        }
    };
    let scale: Vec<f32> = (0..12).map(|i| 0.5 + i as f32 / 10.0).collect();
    let norm = [
        constant("scale", &[3, 4], &scale),
        constant("shift", &[3, 4], &[0.25; 12]),
        step(
            "LayerNormalization",
            &["x", "scale", "shift"],
            &["y"],
            &[whole("axis", 2), float_attribute("epsilon", 1e-3)],
        ),
    ];
    let softmax = small(
        "Softmax",
        &shape,
        vec![step("Softmax", &["x"], &["y"], &[whole("axis", 1)])],
    );
    let product = |name, parts: [Vec<u8>; 2]| small(name, &shape, parts.into());
    let vectors = constant("v", &[4], &[0.5, -1.0, 2.0, 0.25]);
    let rows = constant("v", &[3], &[0.5, -1.0, 2.0]);
    let mut found = vec![
        // Before opset 13 all axes from there on are one.
        Small {
            name: "Softmax, opset 11",
            opset: 11,
            ..softmax
        },
        product("MatMul, a column", [vectors, step("MatMul", &["x", "v"], &["y"], &[])]),
        product("MatMul, a row", [rows, step("MatMul", &["v", "x"], &["y"], &[])]),
        small("TopK and GatherElements", &shape, used.into()),
        small("The least rows", &shape, repeated.into()),
        sampled("GridSample, zeros", "zeros", 0),
        sampled("GridSample, corners", "zeros", 1),
        sampled("GridSample, border", "border", 0),
        Small {
            opset: 17,
            ..small("LayerNormalization", &shape, norm.into())
        },
    ];
    found.extend(extremes());
    found
}

/// Uses of the index of the largest or smallest number: looked up, compared, or as a place in a batch.
fn extremes() -> Vec<Small> {
    use onnx::{step, whole_attribute as whole, whole_constant};
    let shape = [1, 2, 3, 4];
    let largest = [
        step("ArgMax", &["x"], &["where"], &[whole("axis", 3)]),
        step("GatherElements", &["x", "where"], &["y"], &[whole("axis", 3)]),
    ];
    let smallest = [
        whole_constant("axes", &[1], &[1]),
        step("ArgMin", &["x"], &["flat"], &[whole("axis", 1), whole("keepdims", 0)]),
        step("Unsqueeze", &["flat", "axes"], &["where"], &[]),
        step("GatherElements", &["x", "where"], &["y"], &[whole("axis", 1)]),
    ];
    let compared = |operator: &'static str| {
        let parts = [
            whole_constant("one", &[], &[1]),
            step("ArgMax", &["x"], &["where"], &[whole("axis", 2)]),
            step(operator, &["where", "one"], &["is"], &[]),
            step("Cast", &["is"], &["mask"], &[whole("to", 1)]),
            step("Mul", &["x", "mask"], &["y"], &[]),
        ];
        small(operator, &shape, parts.into())
    };
    // Rows of a batch that depend on the image, and numbers of its rows.
    let of_batch = |name, axis: i64, order: &[i64], batch_dims: i64| {
        let parts = [
            whole_constant("batch", &[3], &[2, 3, 4]),
            step("Reshape", &["x", "batch"], &["rows"], &[]),
            step("ArgMax", &["rows"], &["best"], &[whole("axis", axis)]),
            step(
                "Transpose",
                &["best"],
                &["where"],
                &[onnx::list_attribute("perm", order)],
            ),
            step(
                "GatherND",
                &["rows", "where"],
                &["y"],
                &[whole("batch_dims", batch_dims)],
            ),
        ];
        small(name, &shape, parts.into())
    };
    let pairs = [
        whole_constant("batch", &[3], &[2, 3, 4]),
        whole_constant("places", &[2, 3, 2], &[0, 1, 2, 3, -1, 0, 1, 1, 0, 0, 2, -2]),
        step("Reshape", &["x", "batch"], &["rows"], &[]),
        step("GatherND", &["rows", "places"], &["y"], &[whole("batch_dims", 1)]),
    ];
    vec![
        small("ArgMax", &shape, largest.into()),
        small("ArgMin without its axis", &shape, smallest.into()),
        compared("Greater"),
        compared("Less"),
        compared("Equal"),
        of_batch("GatherND of a batch, rows", 1, &[0, 2, 1], 1),
        of_batch("GatherND of two axes of a batch", 2, &[0, 1, 2], 2),
        small("GatherND of a batch, pairs", &shape, pairs.into()),
    ]
}

#[test]
fn every_operator_answers_and_derives_as_it_should() {
    let mut count = 0;
    let nets = [
        activations(),
        arithmetic(),
        convolutions(),
        resizes(),
        rearrangements(),
        choices(),
    ];
    for net in nets.into_iter().flatten() {
        let bytes = net.bytes();
        let network = OnnxNetwork::<f32>::read(&bytes, net.name, &net.shape, None)
            .unwrap_or_else(|e| panic!("{}: {e}", net.name));
        let mut session = session(&bytes);
        let x = spread(net.shape.iter().product(), 21);
        let theirs = by_onnx_runtime(&mut session, &net.shape, &x);
        let worst = worst_difference(&by_network(&network, &x), &theirs);
        assert!(worst < 1e-5, "{}: {worst}", net.name);
        // Σ slope · output along a direction, both random.
        let answer = network.forward(x.clone(), true).unwrap();
        let slopes: Vec<Vec<f32>> = answer.outputs.iter().map(|o| spread(o.raw.len(), 22)).collect();
        let sum = |x: &[f32]| -> f64 {
            let outputs = network.forward(x.to_vec(), false).unwrap().outputs;
            let pairs = outputs.iter().zip(&slopes).flat_map(|(o, s)| o.raw.iter().zip(s));
            pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        let direction = spread(x.len(), 23);
        let moved = |by: f32| -> Vec<f32> { x.iter().zip(&direction).map(|(x, d)| x + by * d).collect() };
        let found = (sum(&moved(2e-3)) - sum(&moved(-2e-3))) / 4e-3;
        let gradient = answer.vjp(slopes.clone());
        let expected: f64 = gradient
            .iter()
            .zip(&direction)
            .map(|(g, d)| f64::from(*g) * f64::from(*d))
            .sum();
        assert!(
            (found - expected).abs() < 2e-3 * (1.0 + expected.abs()),
            "{}: {found} {expected}",
            net.name
        );
        count += 1;
    }
    println!("{count} small networks answer as ONNX Runtime and derive as finite differences say");
}

/// A YOLOv5 head of one box whose objectness and labels have all the logit `bias` + the image's mean.
fn one_box(bias: f32) -> Vec<u8> {
    use onnx::{constant, step, whole_attribute, whole_constant};
    let parts = [
        step(
            "ReduceMean",
            &["x"],
            &["mean"],
            &[onnx::list_attribute("axes", &[1, 2, 3])],
        ),
        whole_constant("s", &[3], &[1, 1, 1]),
        step("Reshape", &["mean", "s"], &["m"], &[]),
        constant("bias", &[1, 1, 81], &[bias; 81]),
        step("Add", &["m", "bias"], &["logits"], &[]),
        step("Sigmoid", &["logits"], &["scores"], &[]),
        constant("box", &[1, 1, 4], &[20.0, 16.0, 8.0, 6.0]),
        step("Concat", &["box", "scores"], &["y"], &[whole_attribute("axis", 2)]),
    ];
    onnx::graph(&onnx::Input::floats("x", &[1, 3, 32, 32]), &parts, &["y"], 13)
}

const ONE_BOX: &str = r#"
name = "one_box"
title = "One box"
licence = "none"
origin = "made in a test"
labels = "coco80"
[weights]
file = "one_box.onnx"
sha256 = "0000000000000000000000000000000000000000000000000000000000000000"
[input]
size_px = [32, 32]
resize = "stretch"
kernel = "antialiased"
channels = "rgb"
mean = [0.0, 0.0, 0.0]
std = [255.0, 255.0, 255.0]
[head]
kind = "yolov5"
nms_iou = 0.45
"#;

fn one_box_manifest() -> Manifest {
    Manifest::parse(ONE_BOX, "one_box.toml").unwrap()
}

const NMS: &str = "nms_iou = 0.45";

/// Small networks that end as those of the families do, with random weights, for images of 64 × 64.
fn families() -> [(&'static str, Vec<u8>, [&'static str; 3]); 6] {
    use onnx::{constant, list_attribute as list, step, whole_attribute as whole, whole_constant};
    let conv = |side: usize, channels: usize, from: &str, to: &str| {
        let weight = format!("w{side}");
        let strides = [list("strides", &[side as i64; 2])];
        let weights: Vec<f32> = spread(channels * 3 * side * side, side as u64)
            .iter()
            .map(|w| w * 12.0 / side as f32)
            .collect();
        [
            constant(&weight, &[channels, 3, side, side], &weights),
            step("Conv", &[from, &weight], &[to], &strides),
        ]
        .concat()
    };
    let v8 = [
        conv(8, 84, "x", "c"),
        whole_constant("s", &[3], &[1, 84, 64]),
        step("Reshape", &["c", "s"], &["r"], &[]),
        whole_constant("sizes", &[2], &[4, 80]),
        step("Split", &["r", "sizes"], &["box", "labels"], &[whole("axis", 1)]),
        step("Sigmoid", &["labels"], &["scores"], &[]),
        step("Softplus", &["box"], &["sides"], &[]),
        constant("eight", &[], &[8.0]),
        step("Mul", &["sides", "eight"], &["pixels"], &[]),
        step("Concat", &["pixels", "scores"], &["y"], &[whole("axis", 1)]),
    ];
    let v5 = [
        conv(8, 255, "x", "c"),
        whole_constant("s", &[5], &[1, 3, 85, 8, 8]),
        step("Reshape", &["c", "s"], &["r"], &[]),
        step("Transpose", &["r"], &["t"], &[list("perm", &[0, 1, 3, 4, 2])]),
        step("Sigmoid", &["t"], &["o"], &[]),
        whole_constant("sizes", &[3], &[2, 2, 81]),
        step("Split", &["o", "sizes"], &["xy", "wh", "scores"], &[whole("axis", 4)]),
        constant("sixteen", &[], &[16.0]),
        step("Mul", &["xy", "sixteen"], &["centre"], &[]),
        constant("two", &[], &[2.0]),
        step("Mul", &["wh", "two"], &["twice"], &[]),
        step("Pow", &["twice", "two"], &["squared"], &[]),
        step("Mul", &["squared", "sixteen"], &["size"], &[]),
        step("Concat", &["centre", "size", "scores"], &["rows"], &[whole("axis", 4)]),
        whole_constant("all", &[3], &[1, -1, 85]),
        step("Reshape", &["rows", "all"], &["y"], &[]),
    ];
    let mut v4 = vec![step("Transpose", &["x"], &["planes"], &[list("perm", &[0, 3, 1, 2])])];
    for (side, [c, t, r, o, out]) in [
        (8, ["c1", "t1", "r1", "o1", "y1"]),
        (16, ["c2", "t2", "r2", "o2", "y2"]),
        (32, ["c3", "t3", "r3", "o3", "y3"]),
    ] {
        let cells = 64 / side as i64;
        let [shape, sizes, xy, rest, scores] = ["s", "z", "b", "k", "p"].map(|name| format!("{name}{side}"));
        v4.extend([
            conv(side, 255, "planes", c),
            step("Transpose", &[c], &[t], &[list("perm", &[0, 2, 3, 1])]),
            whole_constant(&shape, &[5], &[1, cells, cells, 3, 85]),
            step("Reshape", &[t, &shape], &[r], &[]),
            whole_constant(&sizes, &[2], &[4, 81]),
            step("Split", &[r, &sizes], &[&xy, &rest], &[whole("axis", 4)]),
            step("Sigmoid", &[&rest], &[&scores], &[]),
            step("Concat", &[&xy, &scores], &[o], &[whole("axis", -1)]),
            step("Identity", &[o], &[out], &[]),
        ]);
    }
    let mut v3 = Vec::new();
    for (side, out) in [(8, "y1"), (16, "y2"), (32, "y3")] {
        v3.push(conv(side, 255, "x", out));
    }
    // Numbers made of the image's mean colour alone, so many a row.
    let table = |rows: usize, columns: usize| {
        let count = rows * columns;
        [
            step("GlobalAveragePool", &["x"], &["mean"], &[]),
            whole_constant("flat", &[2], &[1, 3]),
            step("Reshape", &["mean", "flat"], &["colour"], &[]),
            constant("weights", &[3, count], &spread(3 * count, 31)),
            step("MatMul", &["colour", "weights"], &["numbers"], &[]),
            whole_constant("rows", &[3], &[1, rows as i64, columns as i64]),
            step("Reshape", &["numbers", "rows"], &["table"], &[]),
        ]
    };
    // 9 anchors for each of 64 + 16 + 4 + 1 + 1 cells, and the 90 category ids from 1 on.
    let efficientdet = [
        &table(774, 94)[..],
        &[
            whole_constant("sizes", &[2], &[4, 90]),
            step(
                "Split",
                &["table", "sizes"],
                &["regression", "classification"],
                &[whole("axis", 2)],
            ),
        ],
    ];
    let rfdetr = [
        &table(20, 85)[..],
        &[
            whole_constant("sizes", &[2], &[4, 81]),
            step(
                "Split",
                &["table", "sizes"],
                &["numbers_of_boxes", "labels"],
                &[whole("axis", 2)],
            ),
            step("Sigmoid", &["numbers_of_boxes"], &["dets"], &[]),
        ],
    ];
    let planar = onnx::Input::floats("x", &[1, 3, 64, 64]);
    let last = onnx::Input::floats("x", &[1, 64, 64, 3]);
    [
        ("yolov8", onnx::graph(&planar, &v8, &["y"], 13), ["nchw", "coco80", NMS]),
        ("yolov5", onnx::graph(&planar, &v5, &["y"], 13), ["nchw", "coco80", NMS]),
        (
            "yolov4",
            onnx::graph(&last, &v4, &["y1", "y2", "y3"], 13),
            ["nhwc", "coco80", NMS],
        ),
        (
            "yolov3",
            onnx::graph(&planar, &v3, &["y1", "y2", "y3"], 13),
            ["nchw", "coco80", NMS],
        ),
        (
            "efficientdet",
            onnx::graph(&planar, &efficientdet.concat(), &["regression", "classification"], 13),
            ["nchw", "coco91", "scores = \"logits\"\nnms_iou = 0.45"],
        ),
        (
            "rfdetr",
            onnx::graph(&planar, &rfdetr.concat(), &["dets", "labels"], 13),
            ["nchw", "coco80", ""],
        ),
    ]
}

#[test]
fn networks_that_end_as_the_families_do_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg32::seed_from_u64(9);
    let photo = RgbImage::from_fn(64, 64, |x, y| {
        image::Rgb([(x * 4) as u8, (y * 3 + 20) as u8, (x * y / 17) as u8])
    });
    let (picture, size) = picture(&photo);
    for (head, bytes, [layout, labels, rest]) in families() {
        let path = folder.path().join(format!("{head}.onnx"));
        std::fs::write(&path, &bytes).unwrap();
        let text = ONE_BOX.replace("yolov5", head).replace("[32, 32]", "[64, 64]");
        let text = text.replace(NMS, rest).replace("coco80", labels);
        let manifest =
            Manifest::parse(&text.replace("resize", &format!("layout = \"{layout}\"\nresize")), head).unwrap();
        let all: Vec<usize> = (0..manifest.labels.count())
            .filter(|l| manifest.labels.name(*l).is_some())
            .collect();
        let detector = OnnxDetector::<f32>::open(&manifest, &path, &all).unwrap();
        let predictions = detector.predictions(&picture, size).unwrap();
        // Scoring keeps boxes to a hundredth of a pixel, and none that is thinner.
        let solid = predictions
            .iter()
            .filter(|c| c.box_px.width().min(c.box_px.height()) > 0.02);
        let best = solid.map(|c| c.confidence).fold(0.0, f64::max);
        let found = Detector::open(Runtime::load().unwrap(), &manifest, &path)
            .unwrap()
            .detect(&photo)
            .unwrap();
        assert!(
            (best - found[0].score).abs() < 1e-5 && best > 0.1,
            "{head}: {best} {:?}",
            found[0]
        );
        let cars = both(&manifest, &path, &[2, 5, 7]);
        let (worst, jumps) = worst_derivative(&cars, &picture, size, &mut rng);
        assert_eq!(jumps, 0, "{head}");
        assert!(worst < 0.01, "{head}: {worst}");
    }
}

/// Networks as their own frameworks export them, with random weights.
#[test]
fn exported_networks_are_followed() {
    let mut rng = Pcg32::seed_from_u64(7);
    let folder = home().join("tests/data/exported");
    let labels = ["car", "bus", "truck", "person", "dog"].map(str::to_owned);
    let named = Hints {
        labels: Some(Labels::of_names(labels.to_vec()).unwrap()),
        ..Hints::default()
    };
    let photo = photo(&folder.join("wide.png"));
    let (picture, size) = picture(&photo);
    for (name, hints) in [
        ("yolo26", Hints::default()),
        ("yolo26_end2end", Hints::default()),
        ("rtdetr_v2", named),
    ] {
        let path = folder.join(format!("{name}.onnx"));
        let manifest = propose(Runtime::load().unwrap(), &path, "network.onnx", name, hints)
            .unwrap()
            .manifest;
        let (bytes, [width, height]) = (std::fs::read(&path).unwrap(), manifest.input.size_px);
        let shape = [1, 3, height as usize, width as usize];
        let network = OnnxNetwork::<f32>::read(&bytes, name, &shape, None).unwrap();
        let numbers = numbers(&photo, &manifest);
        let theirs = by_onnx_runtime(&mut as_written(&bytes), &shape, &numbers);
        let worst = worst_difference(&by_network(&network, &numbers), &theirs);
        assert!(worst < 1e-4, "{name}: {worst}");
        let (worst, jumps) = worst_derivative(&both(&manifest, &path, &[0]), &picture, size, &mut rng);
        println!("{name}: derivatives within {:.2} %", 100.0 * worst);
        assert!(jumps == 0 && worst < 0.01, "{name}: {worst}, {jumps} jumps");
    }
}

#[test]
fn a_saturated_confidence_has_a_finite_loss_and_a_gradient() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one_box.onnx");
    for bias in [-80.0_f32, 0.0, 8.0, 16.5, 17.5, 40.0, 200.0, 600.0] {
        std::fs::write(&path, one_box(bias)).unwrap();
        let detector = OnnxDetector::<f32>::open(&one_box_manifest(), &path, &[2, 5, 7]).unwrap();
        let picture = vec![[0.25; 3]; 64 * 64];
        let look = detector.forward(&picture, [64, 64]).unwrap();
        let prediction = look.predictions()[0];
        let z = f64::from(bias) + 0.25;
        // C = σ(z)²; 1 − C = (1 − σ)(1 + σ), with 1 − σ = σ(−z).
        let (sigma, rest) = (1.0 / (1.0 + (-z).exp()), 1.0 / (1.0 + z.exp()));
        let loss = -(rest * (1.0 + sigma)).ln();
        assert!(
            (prediction.loss - loss).abs() < 1e-6 * (1.0 + loss),
            "{bias}: {prediction:?}, not {loss}"
        );
        assert!(
            (prediction.confidence - sigma * sigma).abs() < 1e-6 && prediction.box_px.width() == 16.0,
            "{prediction:?}"
        );
        // d loss / dz = 2 σ² / (1 + σ), spread over the mean of all values.
        let gradient = look.vjp(&[1.0]);
        let slope: f64 = gradient.iter().flatten().sum();
        let expected = 2.0 * sigma * sigma / (1.0 + sigma);
        assert!(
            (slope - expected).abs() < 1e-4 * expected + 1e-30,
            "{bias}: {slope}, not {expected}"
        );
    }
}

#[test]
fn damaged_files_are_refused_in_a_sentence_or_read() {
    let mut rng = Pcg32::seed_from_u64(31);
    let (mut refused, mut all) = (0, 0);
    for net in [activations(), arithmetic(), convolutions(), resizes(), rearrangements()]
        .into_iter()
        .flatten()
    {
        let whole = net.bytes();
        for _ in 0..40 {
            let mut bytes = whole.clone();
            match rng.random_range(0..3) {
                0 => bytes.truncate(rng.random_range(0..whole.len())),
                1 => bytes[rng.random_range(0..whole.len())] = rng.random(),
                _ => {
                    let at = rng.random_range(0..whole.len());
                    bytes[at] ^= 1 << rng.random_range(0..8_u32);
                }
            }
            all += 1;
            if let Err(e) = OnnxNetwork::<f32>::read(&bytes, "damaged.onnx", &net.shape, None) {
                refused += 1;
                let sentence = e.to_string();
                assert!(
                    sentence.starts_with("damaged.onnx") && !sentence.contains('\n'),
                    "{sentence}"
                );
            }
        }
    }
    println!("{refused} of {all} damaged networks refused");
    assert!(refused > all / 3);
}

/// Files of some hundred bytes that ask for more numbers than any machine has.
#[test]
fn tensors_without_bound_are_refused_before_they_are_made() {
    use onnx::{step, whole_constant};
    let wide = |name: &str, sides: [i64; 2]| {
        let shape = format!("{name}_shape");
        [
            whole_constant(&shape, &[2], &sides),
            step("ConstantOfShape", &[&shape], &[name], &[]),
        ]
        .concat()
    };
    let two = |operator: &'static str| {
        vec![
            wide("a", [1 << 20, 1]),
            wide("b", [1, 1 << 20]),
            step(operator, &["a", "b"], &["c"], &[]),
            step("ReduceSum", &["c"], &["s"], &[]),
            step("Add", &["x", "s"], &["y"], &[]),
        ]
    };
    let range = |start: i64, limit: i64, by: i64| {
        vec![
            whole_constant("start", &[], &[start]),
            whole_constant("limit", &[], &[limit]),
            whole_constant("by", &[], &[by]),
            step("Range", &["start", "limit", "by"], &["r"], &[]),
            step("Reshape", &["x", "r"], &["y"], &[]),
        ]
    };
    let many = (0..50).flat_map(|i| {
        let name = format!("m{i}");
        [
            wide(&name, [1 << 14, 1 << 14]),
            step("Relu", &[&name], &[&format!("r{i}")], &[]),
        ]
    });
    let many = many.chain([step("Relu", &["x"], &["y"], &[])]).collect();
    let nets = [
        two("Add"),
        two("MatMul"),
        range(i64::MIN, i64::MAX, 1),
        range(i64::MAX - 1, i64::MAX, 2),
        many,
    ];
    for (i, parts) in nets.into_iter().enumerate() {
        let bytes = onnx::graph(&onnx::Input::floats("x", &[1, 3, 32, 32]), &parts, &["y"], 13);
        let error = OnnxNetwork::<f32>::read(&bytes, "huge.onnx", &[1, 3, 32, 32], None).err();
        let error = error.unwrap_or_else(|| panic!("network {i} is taken")).to_string();
        println!("{i}: {error}");
        assert_eq!(error.lines().count(), 1, "{i}: {error}");
    }
}

#[test]
fn what_cannot_be_followed_is_refused_in_a_sentence() {
    use onnx::step;
    let parts = [
        step("Sin", &["x"], &["a"], &[]),
        step("Round", &["a"], &["b"], &[]),
        step("Relu", &["b"], &["y"], &[]),
    ];
    let unknown = onnx::graph(&onnx::Input::floats("x", &[1, 3, 32, 32]), &parts, &["y"], 13);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("net.onnx");
    let refusal = |bytes: &[u8], manifest: &Manifest, labels: &[usize]| {
        std::fs::write(&path, bytes).unwrap();
        let error = OnnxDetector::<f32>::open(manifest, &path, labels)
            .err()
            .expect("refused")
            .to_string();
        assert_eq!(error.lines().count(), 1, "{error}");
        error
    };
    let manifest = one_box_manifest();
    let error = refusal(&unknown, &manifest, &[2]);
    assert!(error.contains("net.onnx") && error.contains("Round, Sin;"), "{error}");
    let whole = one_box(0.0);
    for share in [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
        let cut = &whole[..(whole.len() as f64 * share) as usize];
        let error = refusal(cut, &manifest, &[2]);
        assert!(error.contains("cannot be differentiated"), "{share}: {error}");
    }
    let error = refusal(&whole, &Manifest::named("yolox_nano").unwrap(), &[2]);
    assert!(
        error.contains("cannot be differentiated") && error.contains("does not fit this file"),
        "{error}"
    );
    let error = refusal(&whole, &manifest, &[2, 80]);
    assert!(error.contains("[2, 80] are not among its 80"), "{error}");
    let head = ONE_BOX.rfind("kind = ").unwrap();
    let chosen = Manifest::parse(&format!("{}kind = \"detr\"\n", &ONE_BOX[..head]), "chosen.toml").unwrap();
    let error = refusal(&whole, &chosen, &[2]);
    assert!(error.contains("chooses boxes by itself"), "{error}");
}
