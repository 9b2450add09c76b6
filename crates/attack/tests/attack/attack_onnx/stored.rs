//! Outputs and gradients beside those that another engine, on the tensors of burn 0.22, answered with before it left.
//!
//! `SCALEPROOF_STORE=1` writes the file anew.

use std::collections::BTreeMap;
use std::path::PathBuf;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_detect::Manifest;
use scaleproof_gradients::onnx::OnnxNetwork;

use super::others;
use super::parity::{FOLLOWED, numbers, photo, photos};
use crate::common::{shared, variable};

/// Count of the numbers that are stored of each output and of the gradient.
const SAMPLED: usize = 120;
/// Rows of a list of boxes that are looked at: further down near equals change places.
const ROWS: usize = 8;

/// Some numbers of each output, and of the gradient of a weighting of all outputs by the image.
type Looked = BTreeMap<String, Vec<f32>>;

fn file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/networks.json")
}

fn sampled(numbers: &[f32]) -> Vec<f32> {
    let step = numbers.len().div_ceil(SAMPLED).max(1);
    // An odd step meets all columns of a table.
    numbers.iter().step_by(step | 1).copied().collect()
}

fn looked(network: &OnnxNetwork, image: Vec<f32>) -> Looked {
    let pass = network.forward(image, true).unwrap();
    let is_list = pass.outputs.iter().any(|o| o.is_whole);
    let (mut found, mut weights) = (Looked::new(), Vec::new());
    let mut rng = Pcg32::seed_from_u64(69);
    for output in &pass.outputs {
        let (values, rows) = (output.values(), output.shape.get(1).copied().unwrap_or(1));
        let row = values.len() / rows;
        let head = if is_list { &values[..ROWS * row] } else { &values[..] };
        found.insert(output.name.clone(), sampled(head));
        weights.push(if is_list {
            // The sum of the best scores, whatever their order.
            let is_scores = row == 1 && !output.is_whole;
            (0..values.len())
                .map(|i| f32::from(u8::from(is_scores && i < ROWS)))
                .collect()
        } else {
            (0..values.len()).map(|_| rng.random::<f32>() - 0.5).collect()
        });
    }
    found.insert("gradient".to_owned(), sampled(&pass.vjp(weights)));
    found
}

fn all() -> Vec<(Manifest, PathBuf, Option<[u32; 2]>)> {
    let known = FOLLOWED.map(|(name, file, side)| {
        let path = shared(&format!("detectors/{file}"));
        (Manifest::named(name).unwrap(), path, Some([side as u32; 2]))
    });
    // What no engine before followed has no truth.
    let others = others()
        .into_iter()
        .filter(|(manifest, _)| manifest.name != "yolo26n_320");
    known
        .into_iter()
        .chain(others.map(|(manifest, path)| (manifest, path, None)))
        .collect()
}

/// The largest difference, in shares of the largest number (of an output at least 1).
fn difference(ours: &[f32], theirs: &[f32], least: f32) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    let largest = theirs.iter().fold(least, |largest, v| largest.max(v.abs()));
    let apart = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs() / largest);
    apart.fold(0.0, f32::max)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn outputs_and_gradients_are_those_of_the_engine_before() {
    let mut found: BTreeMap<String, Looked> = BTreeMap::new();
    let photo = photo(&photos()[1]);
    for (manifest, path, photo_size) in all() {
        let [width, height] = manifest.input.size_px.map(|side| side as usize);
        let (bytes, shape) = (std::fs::read(path).unwrap(), [1, 3, height, width]);
        let network = OnnxNetwork::<f32>::read(&bytes, &manifest.name, &shape, photo_size);
        found.insert(
            manifest.name.clone(),
            looked(&network.unwrap(), numbers(&photo, &manifest)),
        );
    }
    if variable("SCALEPROOF_STORE").is_some() {
        std::fs::write(
            file(),
            serde_json::to_string(&found).unwrap().replace("],", "],\n") + "\n",
        )
        .unwrap();
    }
    let text = std::fs::read_to_string(file()).unwrap();
    let stored: BTreeMap<String, Looked> = serde_json::from_str(&text).unwrap();
    assert_eq!(found.keys().collect::<Vec<_>>(), stored.keys().collect::<Vec<_>>());
    for (name, looked) in &found {
        assert_eq!(
            looked.keys().collect::<Vec<_>>(),
            stored[name].keys().collect::<Vec<_>>()
        );
        for (output, numbers) in looked {
            let is_gradient = output == "gradient";
            let apart = difference(numbers, &stored[name][output], if is_gradient { 0.0 } else { 1.0 });
            println!("{name}, {output}: {} numbers within {apart:.1e}", numbers.len());
            assert!(numbers.iter().any(|v| *v != 0.0), "{name}, {output}");
            assert!(
                apart < if is_gradient { 5e-4 } else { 2e-5 },
                "{name}, {output}: {apart}"
            );
        }
    }
}
