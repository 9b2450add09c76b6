//! Networks of other lineages, with their own weights: `propose` finds their manifests, and what they see on the stored session is what an independent
//! decoding sees (`notes/detectors.md` of the shared material).

use std::path::{Path, PathBuf};

use crate::common::onnx::{self, Input, Output};
use crate::common::{home, read_json, shared};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{
    AnchorLabels, CandidateBox, Data, Detector, Family, Head, Hints, Labels, Manifest, Proposal, Runtime, Scores,
    SsdBoxes, SsdHead, Tensor, candidates, propose,
};

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

/// The manifest with this choice among an anchor's labels.
fn keeping(labels: AnchorLabels, manifest: &Manifest) -> Manifest {
    let mut manifest = manifest.clone();
    if manifest.head.anchor_labels() != labels {
        manifest.head = manifest.head.with_other_labels().unwrap().0;
    }
    assert_eq!(Manifest::parse(&manifest.to_toml().unwrap(), "").unwrap(), manifest);
    manifest
}

/// The notes' figures count an anchor of Darknet's for its best label alone, which Darknet itself does not: those for all labels are of a second
/// decoding, in Python. So is that of PicoDet behind cubic resizing, where the notes resize linearly (0.580).
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn networks_of_other_lineages_see_what_they_should() {
    use AnchorLabels::{All, Best};
    let networks = [
        ("yolov4_tiny", Family::Darknet, Best, [0.740, 0.016]),
        ("yolov4_tiny", Family::Darknet, All, [0.757, 0.044]),
        ("yolo_fastest_xl", Family::Darknet, Best, [0.577, 0.124]),
        ("yolo_fastest_xl", Family::Darknet, All, [0.582, 0.171]),
        ("ssdlite_mobilenet_v2_coco", Family::SsdTable, All, [0.833, 0.673]),
        ("picodet_s_320", Family::Picodet, All, [0.866, 0.567]),
    ];
    for (name, family, labels, expected) in networks {
        let network = shared(&format!("detectors_more/{name}.onnx"));
        let proposal = proposed(&network, Hints::default());
        assert_eq!(proposal.family, family, "{name}: {}", proposal.text);
        assert_eq!(proposal.manifest.head.anchor_labels(), All, "{name}");
        let manifest = keeping(labels, &proposal.manifest);
        for (variant, expected) in ["normal", "random"].into_iter().zip(expected) {
            let mean = mean_of_cars(&manifest, &network, variant);
            println!("{name}, {labels:?}, {variant}: {mean:.3}, by an independent decoding {expected}");
            assert!((mean - expected).abs() < 0.01, "{name}, {variant}: {mean}");
        }
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn labels_of_an_ssd_are_coco_ids() {
    let network = shared("detectors_more/ssdlite_mobilenet_v2_coco.onnx");
    let manifest = proposed(&network, Hints::default()).manifest;
    assert_eq!(manifest.labels, Labels::Coco91);
    assert_eq!((manifest.input.mean, manifest.input.std), ([0.0; 3], [1.0; 3]));
}

/// What is proposed for a network that answers always alike.
fn of_made(inputs: &[Input], outputs: &[Output], hints: Hints) -> Result<Proposal, String> {
    of_bytes(&onnx::network(inputs, outputs), hints)
}

fn of_bytes(network: &[u8], hints: Hints) -> Result<Proposal, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.onnx");
    std::fs::write(&path, network).unwrap();
    propose(Runtime::load().unwrap(), &path, "made.onnx", "made", hints).map_err(|e| e.to_string())
}

fn of_family(name: &str) -> Hints {
    Hints {
        family: Some(Family::from_name(name).unwrap()),
        ..Hints::default()
    }
}

/// Width 96, height 64.
fn picture() -> Input {
    Input::floats("images", &[1, 3, 64, 96])
}

fn filled(name: &str, shape: &[usize], value: f32) -> Output {
    Output::floats(name, shape, vec![value; shape.iter().product()])
}

fn has(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(text.lines().any(|l| l == *line), "`{line}` is not in\n{text}");
    }
}

#[test]
fn grids_that_several_networks_of_darknet_have_are_asked_about() {
    let grids = || [16, 32].map(|s| filled(&format!("grid_{s}"), &[1, 255, 64 / s, 96 / s], -2.0));
    let error = of_made(&[picture()], &grids(), Hints::default()).unwrap_err();
    for word in ["yolov3_tiny", "yolov4_tiny", "yolo_fastest", "fed differently"] {
        assert!(error.contains(word), "{error}");
    }
    let named = of_made(&[picture()], &grids(), of_family("yolov4_tiny")).unwrap();
    has(&named.text, &["kind = \"yolov3\"", "stride = 16", "scale_xy = 1.05"]);
    // Anchors that the file gives count, and a manifest reads back as the same.
    let own = "[[[1, 2], [3, 4], [5, 6]], [[7, 8], [9, 10], [11, 12]]]";
    let network = [onnx::network(&[picture()], &grids()), onnx::metadata("anchors", own)].concat();
    let Head::Yolov3(head) = of_bytes(&network, of_family("yolov3_tiny")).unwrap().manifest.head else {
        panic!("another head");
    };
    assert_eq!(head.grids[1].anchors, [[7.0, 8.0], [9.0, 10.0], [11.0, 12.0]]);
}

/// The four orders in which exporters give the numbers of a grid hold the same boxes.
#[test]
fn a_grid_is_read_in_every_order() {
    let manifest = of_made(
        &[picture()],
        &[16, 32].map(|s| filled(&format!("grid_{s}"), &[1, 255, 64 / s, 96 / s], -2.0)),
        of_family("yolov4_tiny"),
    );
    let manifest = manifest.unwrap().manifest;
    // One box at stride 16: second anchor, row 1, column 4; σ(0) is half a cell.
    let value = |nth: usize, row: usize, column: usize, k: usize| match (nth, row, column, k) {
        (1, 1, 4, 0..=1) => 0.0,
        (1, 1, 4, 2) => 2_f32.ln(),
        (1, 1, 4, 3) => 0.0,
        (1, 1, 4, 4 | 7) => 9.0,
        _ => -30.0,
    };
    let (rows, columns) = (4, 6);
    let filled = |of: &dyn Fn(usize) -> f32| (0..3 * 85 * rows * columns).map(of).collect::<Vec<f32>>();
    let planes = filled(&|i| value(i / (85 * 24), i / 6 % 4, i % 6, i / 24 % 85));
    let anchors_first = filled(&|i| value(i / (85 * 24), i / (85 * 6) % 4, i / 85 % 6, i % 85));
    let last = filled(&|i| value(i / 85 % 3, i / (255 * 6), i / 255 % 6, i % 85));
    let orders = [
        (vec![1, 255, 4, 6], planes),
        (vec![1, 3, 4, 6, 85], anchors_first),
        (vec![1, 4, 6, 3, 85], last.clone()),
        (vec![1, 4, 6, 255], last),
    ];
    for (shape, data) in orders {
        let tensor = |shape: Vec<usize>, data| Tensor {
            name: "grid".into(),
            shape,
            data: Data::F32(data),
        };
        let outputs = [
            tensor(shape.clone(), data),
            tensor(vec![1, 255, 2, 3], vec![-30.0; 255 * 6]),
        ];
        let found = candidates(&manifest, &outputs, [96, 64]).unwrap();
        let CandidateBox { label, b, .. } = found[0];
        assert_eq!((found.len(), label), (1, 2), "{shape:?}");
        // Centre (4.5, 1.5) · 16; anchor 37 × 58, twice as wide.
        let expected = [72.0 - 37.0, 24.0 - 29.0, 72.0 + 37.0, 24.0 + 29.0];
        assert!(
            <[f64; 4]>::from(b)
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-3),
            "{shape:?} {b:?}"
        );
    }
}

#[test]
fn tflites_operator_is_known_whatever_its_outputs_are_called() {
    let input = || Input::floats("serving_default_images:0", &[1, 64, 96, 3]);
    let outputs = || {
        [
            filled("StatefulPartitionedCall:1", &[1, 3], 0.4),
            filled("StatefulPartitionedCall:3", &[1, 3, 4], 0.3),
            filled("StatefulPartitionedCall:0", &[], 3.0),
            Output::floats("StatefulPartitionedCall:2", &[1, 3], vec![0.0, 2.0, 7.0]),
        ]
    };
    let labelled = |labels, first_label| Hints {
        labels: Some(labels),
        first_label,
        ..Hints::default()
    };
    let proposal = of_made(&[input()], &outputs(), labelled(Labels::Coco80, None)).unwrap();
    assert_eq!(proposal.family, Family::TfliteSsd);
    has(
        &proposal.text,
        &[
            "first_label = 0",
            "mean = [127.5, 127.5, 127.5]",
            "outputs = [\"StatefulPartitionedCall:3\", \"StatefulPartitionedCall:2\", \"StatefulPartitionedCall:1\", \"StatefulPartitionedCall:0\"]",
        ],
    );
    // COCO's category ids, counted from 0.
    let ids = of_made(&[input()], &outputs(), labelled(Labels::Coco91, None)).unwrap();
    has(&ids.text, &["first_label = -1"]);
    let other = of_made(&[input()], &outputs(), labelled(Labels::Coco80, Some(-3))).unwrap();
    has(&other.text, &["first_label = -3"]);
    let settings = proposal.notes.last().unwrap().to_string();
    assert!(
        settings.contains("head.first_label") && !settings.contains("nms_iou") && !settings.contains("pad"),
        "{settings}"
    );
}

/// The prior boxes of TensorFlow's own graph of an SSDLite for 300×300 pixels: centre and size, by their numbers.
#[test]
fn offsets_of_nothing_are_the_prior_boxes_of_tensorflow() {
    let truth = [
        (0, [0.02632, 0.02632, 0.1, 0.1]),
        (1, [0.02632, 0.02632, 0.28284, 0.14142]),
        (2, [0.02632, 0.02632, 0.14142, 0.28284]),
        (1082, [0.97368, 0.97368, 0.14142, 0.28284]),
        (1083, [0.05, 0.05, 0.35, 0.35]),
        (1088, [0.05, 0.05, 0.41833, 0.41833]),
        (1500, [0.95, 0.65, 0.60622, 0.20207]),
        (1911, [0.5, 0.5, 0.95, 0.95]),
        (1916, [0.5, 0.5, 0.97468, 0.97468]),
    ];
    let head = SsdHead {
        boxes: SsdBoxes::Offsets,
        scores: Scores::Probabilities,
        nms_iou: 0.6,
        labels: None,
    };
    let manifest = Manifest {
        head: Head::Ssd(head),
        labels: Labels::Coco91,
        ..Manifest::named("yolox_nano").unwrap()
    };
    let tensor = |name: &str, columns: usize, data: Vec<f32>| Tensor {
        name: name.into(),
        shape: vec![1, 1917, columns],
        data: Data::F32(data),
    };
    for (number, [cx, cy, w, h]) in truth {
        // The background in the first column counts for nothing.
        let mut scores = vec![0.0; 1917 * 91];
        (scores[number * 91], scores[number * 91 + 3]) = (0.9, 0.5);
        let outputs = [
            tensor("box_encodings", 4, vec![0.0; 1917 * 4]),
            tensor("class_predictions", 91, scores),
        ];
        let found = candidates(&manifest, &outputs, [300, 300]).unwrap();
        assert_eq!((found.len(), found[0].label), (1, 3));
        let expected = BoxPx::new(cx - w / 2.0, cy - h / 2.0, cx + w / 2.0, cy + h / 2.0);
        let [ours, theirs] = [found[0].b, expected].map(<[f64; 4]>::from);
        assert!(
            (0..4).all(|i| (ours[i] / 300.0 - theirs[i]).abs() < 1e-4),
            "{number}: {ours:?}"
        );
    }
}

/// Boxes beside scores are read as corners where they are, in the order in which they come.
#[test]
fn corners_beside_scores_are_told_by_how_they_move() {
    let cells: Vec<(f32, f32)> = (0..1500)
        .map(|i| ((i % 50) as f32 / 50.0, (i / 50) as f32 / 30.0))
        .collect();
    let boxes =
        |order: &dyn Fn(f32, f32) -> [f32; 4]| cells.iter().flat_map(|(x, y)| order(*x, *y)).collect::<Vec<f32>>();
    let kinds: [(&str, Vec<f32>); 3] = [
        ("xyxy", boxes(&|x, y| [x, y, x + 0.1, y + 0.1])),
        ("yxyx", boxes(&|x, y| [y, x, y + 0.1, x + 0.1])),
        (
            "xyxy_pixels",
            boxes(&|x, y| [96.0 * x, 64.0 * y, 96.0 * x + 9.0, 64.0 * y + 9.0]),
        ),
    ];
    for (kind, data) in kinds {
        let outputs = [
            Output::floats("boxes", &[1, 1500, 4], data),
            filled("scores", &[1, 1500, 81], 0.01),
        ];
        let proposal = of_made(&[picture()], &outputs, Hints::default()).unwrap();
        assert_eq!(proposal.family, Family::Ssd);
        has(
            &proposal.text,
            &[
                &format!("boxes = \"{kind}\""),
                "scores = \"probabilities\"",
                "labels = \"coco80\"",
            ],
        );
    }
    let shares = boxes(&|x, y| [x, y, x + 0.1, y + 0.1]);
    let outputs = [
        Output::floats("boxes", &[1, 1500, 1, 4], shares),
        filled("confs", &[1, 1500, 80], 0.01),
    ];
    let proposal = of_made(&[picture()], &outputs, Hints::default()).unwrap();
    assert_eq!(proposal.family, Family::Yolov4Pytorch);
    has(&proposal.text, &["boxes = \"xyxy\"", "labels = \"best\""]);
}

#[test]
fn tables_of_shares_are_read_as_such() {
    let row = |i: usize, of: usize| {
        let before = [(i * 7 % 96) as f32 / 96.0, (i * 5 % 64) as f32 / 64.0, 0.2, 0.2];
        before
            .into_iter()
            .chain(std::iter::repeat_n(0.25, of - 4))
            .collect::<Vec<f32>>()
    };
    let v8: Vec<f32> = (0..84 * 126).map(|i| row(i % 126, 84)[i / 126]).collect();
    let proposal = of_made(
        &[picture()],
        &[Output::floats("o", &[1, 84, 126], v8)],
        Hints::default(),
    )
    .unwrap();
    assert_eq!(proposal.family, Family::Yolov8);
    has(&proposal.text, &["boxes = \"shares\""]);
    let v5: Vec<f32> = (0..378).flat_map(|i| row(i, 85)).collect();
    let proposal = of_made(
        &[picture()],
        &[Output::floats("o", &[1, 378, 85], v5)],
        Hints::default(),
    )
    .unwrap();
    assert_eq!(proposal.family, Family::Yolov5);
    has(&proposal.text, &["boxes = \"shares\""]);
    let raw: Vec<f32> = (0..84 * 126).map(|i| if i / 126 < 4 { -0.3 } else { 0.1 }).collect();
    let error = of_made(
        &[picture()],
        &[Output::floats("o", &[1, 84, 126], raw)],
        Hints::default(),
    )
    .unwrap_err();
    assert!(
        error.contains("YOLOv8") && error.contains("its boxes are not decoded"),
        "{error}"
    );
}

/// YOLO26's distances are plain numbers: where it sees nothing, some boxes are turned round. Most of them are only where the numbers mean something else.
#[test]
fn most_boxes_decide_whether_they_are_decoded() {
    let table = |every: usize| -> Vec<f32> {
        let size = |i: usize| if i.is_multiple_of(every) { -3.0 } else { 20.0 };
        let value = |k: usize, i: usize| [(i * 7 % 96) as f32, (i * 5 % 64) as f32, size(i), size(i)][k];
        (0..84 * 126)
            .map(|i| if i / 126 < 4 { value(i / 126, i % 126) } else { 0.2 })
            .collect()
    };
    let rows = |every: usize| -> Vec<f32> {
        let row = |i: usize| {
            if i.is_multiple_of(every) {
                [20.0, 20.0, 9.0, 9.0, 0.4, 3.0]
            } else {
                [2.0, 2.0, 9.0, 9.0, 0.5, 7.0]
            }
        };
        (0..300).flat_map(row).collect()
    };
    let of = |shape: &[usize], data: Vec<f32>| {
        let hints = Hints {
            labels: Some(Labels::Coco80),
            ..Hints::default()
        };
        of_made(&[picture()], &[Output::floats("output0", shape, data)], hints)
    };
    assert_eq!(of(&[1, 84, 126], table(8)).unwrap().family, Family::Yolov8);
    let error = of(&[1, 84, 126], table(1)).unwrap_err();
    assert!(
        error.contains("a box's size is -3: its boxes are not decoded"),
        "{error}"
    );
    assert_eq!(of(&[1, 300, 6], rows(8)).unwrap().family, Family::Yolov10);
    let error = of(&[1, 300, 6], rows(1)).unwrap_err();
    assert!(error.contains("a box ends before it begins"), "{error}");
}

/// Transformers' `OnnxConfig(dynamic=True)` leaves all axes open.
#[test]
fn an_image_may_leave_its_channels_open() {
    let outputs = || {
        [
            filled("logits", &[1, 300, 80], -4.0),
            filled("pred_boxes", &[1, 300, 4], 0.3),
            filled("enc_topk_logits", &[1, 300, 80], -4.0),
        ]
    };
    let proposal = of_made(&[Input::floats("pixel_values", &[-1; 4])], &outputs(), Hints::default()).unwrap();
    assert_eq!(
        (proposal.family, proposal.manifest.input.size_px),
        (Family::HfDetr, [640, 640])
    );
    assert!(
        proposal
            .notes
            .iter()
            .any(|note| note.to_string().contains("leaves the input's size open"))
    );
    let error = of_made(
        &[Input::floats("pixel_values", &[1, 5, 64, 64])],
        &outputs(),
        Hints::default(),
    )
    .unwrap_err();
    assert!(error.contains("exported with three channels fixed"), "{error}");
}

/// PicoDet and NanoDet have the same tables.
#[test]
fn four_strides_of_distances_are_paddles_or_asked_about() {
    let tables = |prefix: &str| {
        [
            (96, 80),
            (96, 32),
            (24, 80),
            (24, 32),
            (6, 80),
            (6, 32),
            (2, 80),
            (2, 32),
        ]
        .map(|(n, row)| filled(&format!("{prefix}{n}_{row}"), &[1, n, row], 0.2))
    };
    let error = of_made(&[picture()], &tables("o"), Hints::default()).unwrap_err();
    assert!(error.contains("nanodet (NanoDet) or picodet (PicoDet)"), "{error}");
    let proposal = of_made(&[picture()], &tables("save_infer_model/scale_"), Hints::default()).unwrap();
    assert_eq!(proposal.family, Family::Picodet);
    has(
        &proposal.text,
        &[
            "channels = \"rgb\"",
            "resize = \"stretch\"",
            "strides = [8, 16, 32, 64]",
        ],
    );
}

/// Its first nodes tell what values a network takes.
#[test]
fn a_network_that_brings_values_into_range_itself_is_given_them_as_they_are() {
    let table: Vec<f32> = (0..378)
        .flat_map(|i| [(i * 7 % 96) as f32, (i * 5 % 64) as f32, 20.0, 12.0, 0.2, 0.3])
        .collect();
    let proposal = |by: f32| {
        let steps = [
            onnx::constant("by", &[1], &[by]),
            onnx::constant("mean", &[1, 3, 1, 1], &[0.48, 0.46, 0.41]),
            onnx::constant("table", &[1, 378, 6], &table),
            onnx::step("Mul", &["images", "by"], &["range"], &[]),
            onnx::step("Sub", &["range", "mean"], &["normalised"], &[]),
            onnx::step(
                "ReduceMean",
                &["normalised"],
                &["one"],
                &[onnx::whole_attribute("keepdims", 0)],
            ),
            onnx::step("Sub", &["one", "one"], &["zero"], &[]),
            onnx::step("Add", &["table", "zero"], &["output"], &[]),
        ];
        let one = Hints {
            labels: Some(Labels::of_names(vec!["car".into()]).unwrap()),
            ..Hints::default()
        };
        of_bytes(&onnx::graph(&picture(), &steps, &["output"], 13), one).unwrap()
    };
    let of_bytes = proposal(1.0 / 255.0);
    has(&of_bytes.text, &["mean = [0.0, 0.0, 0.0]", "std = [1.0, 1.0, 1.0]"]);
    assert!(
        of_bytes
            .notes
            .iter()
            .any(|note| note.to_string().contains("values 0 to 255"))
    );
    has(&proposal(2.0).text, &["std = [255.0, 255.0, 255.0]"]);
}

#[test]
fn a_refusal_says_what_there_is_and_what_each_family_would_have() {
    let error = of_made(
        &[picture()],
        &[filled("detections", &[1, 1333, 99], 0.5)],
        Hints::default(),
    )
    .unwrap_err();
    for word in [
        "detections 1×1333×99",
        "for an input of 96×64",
        "378 or",
        "YOLOv8 to 12",
        "EfficientDet 1×1161×4",
        "Darknet's small YOLOs one of 90",
    ] {
        assert!(error.contains(word), "`{word}` is not in: {error}");
    }
    assert!(!error.contains("room for"), "{error}");
    let wrong = Hints {
        labels: Some(Labels::Voc20),
        ..Hints::default()
    };
    let table: Vec<f32> = (0..90)
        .flat_map(|i| {
            [(i * 7 % 96) as f32, (i * 5 % 64) as f32, 20.0, 12.0]
                .into_iter()
                .chain([0.2; 81])
        })
        .collect();
    let error = of_made(&[picture()], &[Output::floats("o", &[1, 90, 85], table)], wrong).unwrap_err();
    assert!(
        error.contains("darknet (a YOLO of Darknet with its decoding), with room for 80 labels, and 20 are named"),
        "{error}"
    );
}
