//! A detector's outputs beside ONNX Runtime's.

use std::path::{Path, PathBuf};

use image::RgbImage;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use scaleproof_detect::{Manifest, Runtime};
use scaleproof_gradients::layers::Number;
use scaleproof_gradients::onnx::OnnxNetwork;

use crate::common::{shared, skyline};

/// Name, shape and numbers of an output.
pub type Answered = (String, Vec<usize>, Vec<f32>);

/// The detectors whose networks can be differentiated, with the shape of their input.
pub const FOLLOWED: [(&str, &str, usize); 5] = [
    ("yolox_nano", "yolox_nano.onnx", 416),
    ("nanodet_m", "nanodet_m_416.onnx", 416),
    ("fastestdet", "FastestDet.onnx", 352),
    ("deimv2_femto", "deimv2_hgnetv2_femto_coco.onnx", 416),
    ("deimv2_atto", "deimv2_hgnetv2_atto_coco.onnx", 320),
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
    let mut photos = images(&skyline());
    for folder in ["photos/cars", "photos/toys"] {
        photos.extend(images(&shared(folder)).into_iter().take(2));
    }
    photos
}

pub fn photo(path: &Path) -> RgbImage {
    image::open(path).unwrap().to_rgb8()
}

/// What ONNX Runtime answers: name, shape and numbers of each output. A second input is the photo's width and height: those of the input.
pub fn by_onnx_runtime(session: &mut Session, shape: &[usize], numbers: &[f32]) -> Vec<Answered> {
    let tensor = ort::value::Tensor::from_array((shape.to_vec(), numbers.to_vec())).unwrap();
    let mut inputs = Vec::from(ort::inputs![tensor]);
    if session.inputs().len() == 2 {
        let size = vec![shape[3] as i64, shape[2] as i64];
        inputs.extend(ort::inputs![
            ort::value::Tensor::from_array((vec![1, 2], size)).unwrap()
        ]);
    }
    let outputs = session.run(&inputs[..]).unwrap();
    let read = outputs.iter().map(|(name, value)| {
        let (shape, data) = match value.try_extract_tensor::<f32>() {
            Ok((shape, data)) => (shape, data.to_vec()),
            Err(_) => {
                let (shape, data) = value.try_extract_tensor::<i64>().unwrap();
                (shape, data.iter().map(|v| *v as f32).collect())
            }
        };
        (name.to_owned(), shape.iter().map(|d| *d as usize).collect(), data)
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

pub fn by_network<T: Number>(network: &OnnxNetwork<T>, numbers: &[f32]) -> Vec<Answered> {
    let outputs = network.forward(numbers.to_vec(), false).unwrap().outputs;
    outputs
        .iter()
        .map(|o| (o.name.clone(), o.shape.clone(), o.values()))
        .collect()
}

/// The largest difference between two answers; of numbers above 1, relative to them. Answers that list boxes best first are compared box
/// by box, since equals may come in either order.
pub fn worst_difference(ours: &[Answered], theirs: &[Answered]) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    if let Some(worst) = listed(ours)
        .zip(listed(theirs))
        .map(|(ours, theirs)| worst_of_rows(&ours, &theirs))
    {
        return worst;
    }
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

/// Label, score and corners in shares of the largest number of all boxes.
type Row = (f32, f32, [f32; 4]);

fn listed(answer: &[Answered]) -> Option<Vec<Row>> {
    // Rows of a box, its score and its label.
    if let [(_, shape, rows)] = answer
        && let [1, _, 6] = shape[..]
    {
        let largest = rows.iter().fold(1.0_f32, |largest, v| largest.max(*v));
        let rows = rows.chunks_exact(6);
        return Some(
            rows.map(|row| (row[5].round(), row[4], std::array::from_fn(|i| row[i] / largest)))
                .collect(),
        );
    }
    let named = |name: &str| answer.iter().find(|(n, ..)| n == name).map(|(.., data)| data);
    let (labels, scores, boxes) = (named("labels")?, named("scores")?, named("boxes")?);
    let largest = boxes.iter().fold(1.0_f32, |largest, v| largest.max(*v));
    let rows = labels.iter().zip(scores).zip(boxes.chunks_exact(4));
    Some(
        rows.map(|((label, score), b)| (*label, *score, std::array::from_fn(|i| b[i] / largest)))
            .collect(),
    )
}

/// The largest difference of a row from the nearest of its label in the other list. Rows that are among the best by less than 1e-3 may be
/// missing there.
fn worst_of_rows(ours: &[Row], theirs: &[Row]) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    let least = theirs.iter().map(|(_, score, _)| *score).fold(1.0, f32::min);
    let from = |rows: &[Row], others: &[Row]| {
        let kept = rows.iter().filter(|(_, score, _)| *score > least + 1e-3);
        let nearest = kept.map(|(label, score, b)| {
            let same = others.iter().filter(|(other, ..)| other == label);
            let differences =
                same.map(|(_, other, c)| (0..4).fold((score - other).abs(), |d, i| d.max((b[i] - c[i]).abs())));
            differences.fold(f32::INFINITY, f32::min)
        });
        nearest.fold(0.0, f32::max)
    };
    from(ours, theirs).max(from(theirs, ours))
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
