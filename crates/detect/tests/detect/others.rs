//! Networks of other lineages, with their own weights: `propose` finds their manifests, and what they see on the stored session is what an independent
//! decoding sees (`notes/detectors.md` of the shared material).

use std::path::{Path, PathBuf};

use crate::common::{home, read_json, shared};
use scaleproof_detect::{AnchorLabels, Detector, Family, Head, Hints, Labels, Manifest, Proposal, Runtime, propose};

fn proposed(network: &Path, hints: Hints) -> Proposal {
    propose(Runtime::load().unwrap(), network, "network.onnx", "network", hints).unwrap()
}

/// The mean over the stored photos of a variant of the best confidence of a car.
fn mean_of_cars(manifest: &Manifest, network: &Path, variant: &str) -> f64 {
    let mut detector = Detector::open(Runtime::load().unwrap(), manifest, network).unwrap();
    let session = read_json(&home().join("captures/skyline/session.json"));
    let photos = session["photos"].as_array().unwrap().iter();
    let files: Vec<PathBuf> = photos
        .filter(|photo| photo["variant"] == variant)
        .map(|photo| home().join("captures/skyline").join(photo["file"].as_str().unwrap()))
        .collect();
    assert_eq!(files.len(), 8);
    let best = files.iter().map(|file| {
        let found = detector.detect(&image::open(file).unwrap().to_rgb8()).unwrap();
        let cars = found.iter().filter(|d| manifest.labels.name(d.label) == Some("car"));
        cars.map(|d| d.score).fold(0.0, f64::max)
    });
    best.sum::<f64>() / 8.0
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn networks_of_other_lineages_see_what_they_should() {
    let networks = [
        ("yolov4_tiny", Family::Darknet, [0.74, 0.02]),
        ("ssdlite_mobilenet_v2_coco", Family::SsdTable, [0.83, 0.67]),
        ("yolo_fastest_xl", Family::Darknet, [0.57, 0.12]),
        ("picodet_s_320", Family::Picodet, [0.87, 0.58]),
    ];
    for (name, family, expected) in networks {
        let network = shared(&format!("detectors_more/{name}.onnx"));
        let proposal = proposed(&network, Hints::default());
        assert_eq!(proposal.family, family, "{name}: {}", proposal.text);
        for (variant, expected) in ["normal", "random"].into_iter().zip(expected) {
            let mean = mean_of_cars(&proposal.manifest, &network, variant);
            println!("{name}, {variant}: {mean:.3}, by an independent decoding {expected}");
            assert!((mean - expected).abs() < 0.02, "{name}, {variant}: {mean}");
        }
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn only_the_best_label_of_an_anchor_counts_where_the_manifest_says_so() {
    let network = shared("detectors_more/yolo_fastest_xl.onnx");
    let mut manifest = proposed(&network, Hints::default()).manifest;
    assert_eq!(manifest.head.anchor_labels(), AnchorLabels::All);
    let Head::Yolov5(head) = &mut manifest.head else {
        panic!("{:?}", manifest.head);
    };
    head.labels = Some(AnchorLabels::Best);
    let mean = mean_of_cars(&manifest, &network, "random");
    assert!((mean - 0.03).abs() < 0.02, "{mean}");
    assert_eq!(Manifest::parse(&manifest.to_toml().unwrap(), "").unwrap(), manifest);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn labels_of_an_ssd_are_coco_ids() {
    let network = shared("detectors_more/ssdlite_mobilenet_v2_coco.onnx");
    let manifest = proposed(&network, Hints::default()).manifest;
    assert_eq!(manifest.labels, Labels::Coco91);
    assert_eq!((manifest.input.mean, manifest.input.std), ([0.0; 3], [1.0; 3]));
}
