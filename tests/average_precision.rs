//! AP and recall against pycocotools: this project's own cases (see `data/make_ap_cases.py`) and the shared oracle.

mod common;

use std::path::Path;

use common::{home, read_json, shared};
use scaleproof::geometry::BoxPx;
use scaleproof::score::{ImageBoxes, average_precision};
use serde_json::Value;

fn box_of(v: &Value) -> BoxPx {
    serde_json::from_value(v["box"].clone()).unwrap()
}

fn check(path: &Path, count: usize) {
    let file = read_json(path);
    let cases = file["cases"].as_array().unwrap();
    assert_eq!(cases.len(), count);
    for (i, case) in cases.iter().enumerate() {
        let of = |list: &str, image: &Value| -> Vec<Value> {
            case[list]
                .as_array()
                .unwrap()
                .iter()
                .filter(|v| &v["image"] == image)
                .cloned()
                .collect()
        };
        let images: Vec<ImageBoxes> = case["images"]
            .as_array()
            .unwrap()
            .iter()
            .map(|image| ImageBoxes {
                truths: of("truth", image).iter().map(box_of).collect(),
                detections: of("detections", image)
                    .iter()
                    .map(|d| (d["score"].as_f64().unwrap(), box_of(d)))
                    .collect(),
            })
            .collect();
        let (ap, recall) = match average_precision(&images, case["iou"].as_f64().unwrap()) {
            Some(found) => (found.ap, found.recall),
            None => (-1.0, -1.0), // pycocotools' way to say that there is no truth
        };
        for (what, found) in [("ap_coco101", ap), ("recall", recall)] {
            let wanted = case[what].as_f64().unwrap();
            assert!(
                (found - wanted).abs() < 1e-9,
                "case {i}: {what} {found}, pycocotools says {wanted}"
            );
        }
    }
}

#[test]
fn our_own_cases_agree_with_pycocotools() {
    check(&home().join("tests/data/ap_cases.json"), 25);
}

#[test]
fn the_oracle_agrees_with_pycocotools() {
    if let Some(oracle) = shared("oracles/ap_pycocotools.json") {
        check(&oracle, 60);
    }
}
