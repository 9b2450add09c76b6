//! Networks as their own frameworks export them, with random weights: `propose` finds each manifest with the labels alone named, and the boxes are those that the
//! framework finds itself, from the photo on. `benches/exported_networks.py` made the files.

use std::path::PathBuf;

use crate::common::{home, onnx, read_json};
use onnx::{Input, Output};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Detection, Detector, Family, Hints, Labels, Manifest, Resize, Runtime, propose};

pub(crate) fn stored(name: &str) -> PathBuf {
    home().join("tests/data/exported").join(name)
}

/// `--labels` of the networks that do not name theirs.
pub(crate) const LABELS: [&str; 5] = ["car", "bus", "truck", "person", "dog"];

pub(crate) fn labelled(names: &[&str]) -> Hints {
    Hints {
        labels: Some(Labels::of_names(names.iter().map(|name| (*name).to_owned()).collect()).unwrap()),
        ..Hints::default()
    }
}

/// Label, score, box in photo pixels.
type Found = (usize, f64, BoxPx);

/// The largest difference of a score and of a box's side, px, to the detection that is most like it, if one has its label and nearly its box.
fn distance(label: usize, score: f64, b: &BoxPx, others: &[Found]) -> Option<(f64, f64)> {
    let sides = |b: &BoxPx| <[f64; 4]>::from(*b);
    let off = |o: &Found| {
        let px = sides(b)
            .into_iter()
            .zip(sides(&o.2))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        ((o.1 - score).abs(), px)
    };
    let like = others
        .iter()
        .filter(|o| o.0 == label)
        .map(off)
        .filter(|(_, px)| *px < 2.0);
    like.min_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)))
}

#[test]
fn exported_networks_find_what_their_frameworks_find() {
    let cases = [
        ("yolo26", Family::Yolov8),
        ("yolo26_end2end", Family::Yolov10),
        ("detr", Family::Detr),
        ("rtdetr_v2", Family::HfDetr),
        ("torchvision_ssd", Family::Torchvision),
        ("effdet_grids", Family::Efficientdet),
    ];
    let truth = read_json(&stored("detections.json"));
    for (name, family) in cases {
        let network = stored(&format!("{name}.onnx"));
        let names_itself = truth[name]["labels"].is_null();
        let hints = if names_itself {
            Hints::default()
        } else {
            labelled(&LABELS)
        };
        let proposal = propose(Runtime::load().unwrap(), &network, "n.onnx", "n", hints).unwrap();
        assert_eq!(proposal.family, family, "{name}");
        let mut manifest = proposal.manifest;
        if family == Family::Detr {
            assert_eq!(
                (manifest.input.resize, manifest.input.size_px),
                (Resize::ShortestEdge, [800, 1333])
            );
            // This network's own, as its processor has it.
            manifest.input.size_px = [160, 266];
        }
        let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &network).unwrap();
        for (photo, rows) in truth[name]["photos"].as_object().unwrap() {
            let found = detector.detect(&image::open(stored(photo)).unwrap().to_rgb8()).unwrap();
            let ours: Vec<Found> = found
                .iter()
                .map(
                    |Detection {
                         label, score, box_px, ..
                     }| (*label, *score, *box_px),
                )
                .collect();
            let number = |v: &serde_json::Value| v.as_f64().unwrap();
            let theirs: Vec<Found> = rows
                .as_array()
                .unwrap()
                .iter()
                .map(|r| {
                    let b = BoxPx::new(number(&r[2]), number(&r[3]), number(&r[4]), number(&r[5]));
                    (number(&r[0]) as usize, number(&r[1]), b)
                })
                .collect();
            assert!(theirs.len() >= 10, "{name}, {photo}: {}", theirs.len());
            let least = theirs.last().unwrap().1 + 2e-3;
            let (mut worst_score, mut worst_px) = (0.0_f64, 0.0_f64);
            for (of, in_others, whose) in [(&theirs, &ours, "theirs"), (&ours, &theirs, "ours")] {
                for (label, score, b) in of.iter().filter(|d| d.1 > least) {
                    let off = distance(*label, *score, b, in_others);
                    let (score, px) =
                        off.unwrap_or_else(|| panic!("{name}, {photo}: {whose} alone: {label} {score} {b:?}"));
                    (worst_score, worst_px) = (worst_score.max(score), worst_px.max(px));
                }
            }
            println!(
                "{name}, {photo}: {} boxes, off by {worst_score:.5}, {worst_px:.3} px",
                theirs.len()
            );
            assert!(
                worst_score <= 1e-3 && worst_px <= 0.5,
                "{name}, {photo}: {worst_score}, {worst_px} px"
            );
        }
    }
}

/// With "no object" among the labels a softmax would pass for the sigmoids of one label more.
#[test]
fn no_object_is_no_label_of_detr() {
    let named = [&LABELS[..], &["no object"]].concat();
    let error = propose(
        Runtime::load().unwrap(),
        &stored("detr.onnx"),
        "n.onnx",
        "n",
        labelled(&named),
    )
    .unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("last column is \"no object\"") && error.contains("room for 5 labels, and 6 are named"),
        "{error}"
    );
    // Its sides without photos: 177·301 would be 160 · 272, and 272 is more than 266.
    let manifest = Manifest::parse(DETR, "").unwrap();
    for (photo, size) in [
        ([320, 240], [213, 160]),
        ([177, 301], [156, 266]),
        ([160, 200], [160, 200]),
    ] {
        let placement = scaleproof_detect::InputPlacement::new(&manifest.input, photo[0], photo[1]);
        assert_eq!((placement.size, placement.canvas), (size, size));
    }
}

const DETR: &str = r#"
name = "n"
title = "n"
licence = "none"
origin = "made"
labels = ["car"]
[weights]
file = "n.onnx"
sha256 = "0000000000000000000000000000000000000000000000000000000000000000"
[input]
size_px = [160, 266]
resize = "shortest_edge"
kernel = "antialiased"
channels = "rgb"
mean = [0.0, 0.0, 0.0]
std = [255.0, 255.0, 255.0]
[head]
kind = "detr"
"#;

/// With three labels and "no object" the logits have four columns, as the boxes have.
#[test]
fn a_detr_of_three_labels_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let logits = [0.0, 3.0, 1.0, -2.0].repeat(100);
    let outputs = [
        Output::floats("logits", &[1, 100, 4], logits),
        Output::floats("pred_boxes", &[1, 100, 4], [0.5, 0.5, 0.2, 0.4].repeat(100)),
    ];
    let path = folder.path().join("n.onnx");
    std::fs::write(
        &path,
        onnx::network(&[Input::floats("pixel_values", &[1, 3, 100, 200])], &outputs),
    )
    .unwrap();
    let hints = labelled(&LABELS[..3]);
    let proposal = propose(Runtime::load().unwrap(), &path, "n.onnx", "n", hints).unwrap();
    assert_eq!(proposal.family, Family::Detr);
    let mut detector = Detector::open(Runtime::load().unwrap(), &proposal.manifest, &path).unwrap();
    let found = detector.detect(&image::RgbImage::new(200, 100)).unwrap();
    let sum = [0.0, 3.0, 1.0, -2.0_f64].map(f64::exp).iter().sum::<f64>();
    let Detection {
        label, score, box_px, ..
    } = &found[0];
    assert_eq!(*label, 1);
    assert!((score - 3.0_f64.exp() / sum).abs() < 1e-4, "{score}");
    let sides = <[f64; 4]>::from(*box_px);
    let off = sides.iter().zip([80.0, 30.0, 120.0, 70.0]).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 0.01, "{sides:?}");
}

/// Transformers' file says how a photo is prepared, and of which of two families with these shapes the network is.
#[test]
fn what_a_preprocessor_says_is_written_into_the_manifest() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["detr.onnx", "detr.onnx.data"] {
        std::fs::copy(stored(name), folder.path().join(name)).unwrap();
    }
    let propose = |config: &str, labels: &[&str]| {
        std::fs::write(folder.path().join("preprocessor_config.json"), config).unwrap();
        let network = folder.path().join("detr.onnx");
        propose(Runtime::load().unwrap(), &network, "n.onnx", "n", labelled(labels))
    };
    let of = |more: &str| {
        format!(
            "{{\"do_normalize\": true, \"do_rescale\": true, \"do_resize\": true, \"image_mean\": [0.5, 0.4, 0.3], \"image_std\": [0.2, 0.2, 0.2],
             \"rescale_factor\": 0.00392156862745098, \"resample\": 2, \"size\": {{\"shortest_edge\": 160, \"longest_edge\": 266}}{more}}}"
        )
    };
    let found = propose(&of(""), &LABELS).unwrap();
    let input = &found.manifest.input;
    assert_eq!(
        (found.family, input.resize, input.size_px),
        (Family::Detr, Resize::ShortestEdge, [160, 266])
    );
    assert_eq!((input.mean, input.std), ([127.5, 102.0, 76.5], [51.0; 3]));
    let notes: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
    assert!(
        notes
            .iter()
            .any(|n| n.contains("input.mean, input.std are those of preprocessor_config.json")),
        "{notes:?}"
    );
    assert!(!notes.iter().any(|n| n.contains("usual")), "{notes:?}");
    // Six sigmoids instead of five labels and "no object".
    let six = [&LABELS[..], &["cat"]].concat();
    let conditional = of(", \"image_processor_type\": \"ConditionalDetrImageProcessor\"");
    let found = propose(&conditional, &six).unwrap();
    assert_eq!(found.family, Family::ConditionalDetr);
    let fixed = "{\"do_normalize\": false, \"size\": {\"height\": 192, \"width\": 224}}";
    let input = propose(fixed, &LABELS).unwrap().manifest.input;
    assert_eq!(
        (input.resize, input.size_px, input.mean),
        (Resize::Stretch, [224, 192], [0.0; 3])
    );
    assert!(input.std.iter().all(|v| (v - 255.0).abs() < 1e-3), "{:?}", input.std);
    for (config, reason) in [
        ("{\"resample\": 3}", "otherwise than bilinearly"),
        ("{\"image_std\": [0, 1, 1]}", "no number that photos are prepared with"),
        ("{\"size\": {\"height\": 1, \"width\": 64}}", "sides from 32 to 8192"),
        ("[", "EOF"),
    ] {
        let error = propose(config, &LABELS).unwrap_err().to_string();
        assert!(
            error.contains("preprocessor_config.json") && error.contains(reason),
            "{error}"
        );
    }
}
