//! AP and recall against pycocotools: this project's own cases (see `data/make_ap_cases.py`) and the shared oracle.

use crate::common;

use std::path::Path;

use common::{home, read_json, shared};
use scaleproof_core::geometry::BoxPx;
use scaleproof_score::{ApDefinition, ImageBoxes, average_precision, average_precision_as, over_ious};
use serde_json::Value;

fn box_of(v: &Value) -> BoxPx {
    serde_json::from_value(v["box"].clone()).unwrap()
}

fn images_of(case: &Value) -> Vec<ImageBoxes> {
    let of = |list: &str, image: &Value| -> Vec<Value> {
        case[list]
            .as_array()
            .unwrap()
            .iter()
            .filter(|v| &v["image"] == image)
            .cloned()
            .collect()
    };
    case["images"]
        .as_array()
        .unwrap()
        .iter()
        .map(|image| ImageBoxes {
            truths: of("truth", image).iter().map(box_of).collect(),
            detections: of("detections", image)
                .iter()
                .map(|d| (d["score"].as_f64().unwrap(), box_of(d)))
                .collect(),
            ..ImageBoxes::default()
        })
        .collect()
}

fn check(path: &Path, count: usize) {
    let file = read_json(path);
    let cases = file["cases"].as_array().unwrap();
    assert_eq!(cases.len(), count);
    for (i, case) in cases.iter().enumerate() {
        let images = images_of(case);
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
#[ignore = "needs the shared material: ./run test --shared"]
fn the_oracle_agrees_with_pycocotools() {
    check(&shared("oracles/ap_pycocotools.json"), 60);
}

/// Precision and recall after each detection, matched and counted here, the slow way.
fn points(images: &[ImageBoxes], iou: f64) -> Vec<(f64, f64)> {
    let mut judged = Vec::new();
    for image in images {
        let mut free: Vec<BoxPx> = image.truths.clone();
        let mut detections = image.detections.clone();
        detections.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (score, b) in detections.into_iter().take(100) {
            let overlaps = free.iter().map(|t| t.iou(&b)).collect::<Vec<_>>();
            let best = overlaps.iter().copied().fold(0.0, f64::max);
            let found = best >= iou.min(1.0 - 1e-10);
            if found {
                free.remove(overlaps.iter().rposition(|o| *o == best).unwrap());
            }
            judged.push((score, found));
        }
    }
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    let truths: usize = images.iter().map(|i| i.truths.len()).sum();
    let right = |n: usize| judged[..n].iter().filter(|j| j.1).count() as f64;
    (1..=judged.len())
        .map(|n| (right(n) / n as f64, right(n) / truths as f64))
        .collect()
}

/// The definitions as their papers say them: integrals over recall of "the best precision at this recall or beyond".
fn by_the_words(definition: ApDefinition, points: &[(f64, f64)]) -> f64 {
    let best = |recall: f64| {
        points
            .iter()
            .filter(|p| p.1 >= recall - 1e-12)
            .map(|p| p.0)
            .fold(0.0, f64::max)
    };
    match definition {
        ApDefinition::Coco101 => (0..101).map(|i| best(f64::from(i) / 100.0)).sum::<f64>() / 101.0,
        ApDefinition::Voc11 => (0..11).map(|i| best(f64::from(i) / 10.0)).sum::<f64>() / 11.0,
        ApDefinition::AllPoint => {
            let mut recalls: Vec<f64> = points.iter().map(|p| p.1).filter(|r| *r > 0.0).collect();
            recalls.dedup();
            let before = [0.0].into_iter().chain(recalls.iter().copied());
            recalls
                .iter()
                .zip(before)
                .map(|(r, before)| (r - before) * best(*r))
                .sum()
        }
        ApDefinition::Yolov5Ramp => unreachable!("has its own test"),
    }
}

#[test]
fn all_point_and_voc_agree_with_a_second_implementation() {
    let file = read_json(&home().join("tests/data/ap_cases.json"));
    let (mut compared, mut differ) = (0, 0);
    for case in file["cases"].as_array().unwrap() {
        let (images, iou) = (images_of(case), case["iou"].as_f64().unwrap());
        let points = points(&images, iou);
        for definition in [ApDefinition::Coco101, ApDefinition::AllPoint, ApDefinition::Voc11] {
            let Some(found) = average_precision_as(definition, &images, iou) else {
                continue;
            };
            let wanted = by_the_words(definition, &points);
            assert!(
                (found.ap - wanted).abs() < 1e-9,
                "{definition:?}: {} is not {wanted}",
                found.ap
            );
            differ += usize::from((found.ap - average_precision(&images, iou).unwrap().ap).abs() > 1e-3);
            compared += 1;
        }
    }
    assert!(
        compared > 60 && differ > 20,
        "{compared} compared, {differ} differ from COCO's"
    );
}

#[test]
fn the_other_definitions_agree_with_numpy() {
    let cases = read_json(&home().join("tests/data/ap_cases.json"));
    let by_numpy = read_json(&home().join("tests/data/ap_definitions.json"));
    let (cases, by_numpy) = (
        cases["cases"].as_array().unwrap(),
        by_numpy["cases"].as_array().unwrap(),
    );
    assert_eq!(cases.len(), by_numpy.len());
    let (mut compared, mut worst) = (0, 0.0_f64);
    for (case, wanted) in cases.iter().zip(by_numpy) {
        for definition in [ApDefinition::AllPoint, ApDefinition::Voc11, ApDefinition::Yolov5Ramp] {
            let found = average_precision_as(definition, &images_of(case), case["iou"].as_f64().unwrap());
            assert_eq!(found.is_none(), wanted.is_null());
            if let Some(found) = found {
                worst = worst.max((found.ap - wanted[definition.name()].as_f64().unwrap()).abs());
                compared += 1;
            }
        }
    }
    println!("{compared} figures of three definitions agree with numpy's within {worst:.1e}");
    assert!(worst < 1e-9 && compared > 60);
}

/// What numpy gives for YOLOv5's recipe: the envelope of (0, 1), the curve and (1, 0), `interp` at 101 recalls, `trapz`.
#[test]
fn the_yolov5_ramp_on_a_curve_with_a_false_positive() {
    // Two truths found at ranks 1 and 3, of four: precisions 1, 1/2, 2/3 at recalls 1/4, 1/4, 1/2.
    let curve = [(1.0, 0.25), (0.5, 0.25), (2.0 / 3.0, 0.5)];
    // By hand: 1 up to 0.25, there 2/3 from the recall itself on (interp takes the last of equal points), 2/3 up to 0.5, ramp to 0.
    let by_hand = 0.24 + 0.01 * (1.0 + 2.0 / 3.0) / 2.0 + 0.25 * 2.0 / 3.0 + 0.5 * (2.0 / 3.0) / 2.0;
    let found = ApDefinition::Yolov5Ramp.of_curve(&curve);
    assert!((found - by_hand).abs() < 1e-9, "{found} is not {by_hand}");
    assert_eq!(ApDefinition::from_name("yolov5-ramp"), Ok(ApDefinition::Yolov5Ramp));
    assert!(
        ApDefinition::from_name("mAP")
            .unwrap_err()
            .to_string()
            .contains("coco-101, all-point")
    );
}

/// `data/make_ap_crowds.py`: what lies in a crowd counts neither for nor against.
#[test]
fn crowds_count_as_in_pycocotools() {
    let cases = read_json(&home().join("tests/data/ap_crowds.json"));
    let cases = cases.as_array().unwrap();
    assert_eq!(cases.len(), 24);
    let corners = |b: &[Value]| {
        let [x, y, width, height] = [0, 1, 2, 3].map(|i| b[i].as_f64().unwrap());
        BoxPx::new(x, y, x + width, y + height)
    };
    let mut changed = 0;
    for (i, case) in cases.iter().enumerate() {
        let boxes = |image: &Value, key: &str| -> Vec<BoxPx> {
            let listed = image[key].as_array().unwrap().iter();
            listed.map(|b| corners(b.as_array().unwrap())).collect()
        };
        let detections = |image: &Value| -> Vec<(f64, BoxPx)> {
            let listed = image["detections"]
                .as_array()
                .unwrap()
                .iter()
                .map(|d| d.as_array().unwrap());
            listed.map(|d| (d[0].as_f64().unwrap(), corners(&d[1..]))).collect()
        };
        let of = |image: &Value| ImageBoxes {
            truths: boxes(image, "truths"),
            crowds: boxes(image, "crowds"),
            detections: detections(image),
        };
        let mut images: Vec<ImageBoxes> = case["images"].as_array().unwrap().iter().map(of).collect();
        let coco = ApDefinition::Coco101;
        let found = [
            average_precision_as(coco, &images, 0.5).unwrap().ap,
            over_ious(coco, &images).unwrap().ap,
        ];
        for (key, found) in ["ap_50", "ap_50_95"].into_iter().zip(found) {
            let wanted = case[key].as_f64().unwrap();
            assert!(
                (found - wanted).abs() < 1e-9,
                "case {i}: {key} {found}, pycocotools says {wanted}"
            );
        }
        images.iter_mut().for_each(|image| image.crowds.clear());
        changed += usize::from(average_precision_as(coco, &images, 0.5).unwrap().ap != found[0]);
    }
    assert!(changed > 12, "the crowds change {changed} of 24 cases only");
}
