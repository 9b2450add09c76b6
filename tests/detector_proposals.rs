//! `detectors add`: every family from a network made here, the real ones, honest questions where the file does not tell, and
//! bad input.

use crate::common;
use crate::common::onnx;

use std::path::{Path, PathBuf};

use common::{assert_refused, program, shared, stdout};
use onnx::{Input, Output};
use scaleproof_detect::{Family, Hints, Labels, Manifest, Proposal, Runtime, propose};

/// Width 96, height 64: 126 cells at strides 8, 16 and 32, and 2 more at stride 64.
fn picture() -> Input {
    Input::floats("images", &[1, 3, 64, 96])
}

fn proposed(network: &[u8], hints: Hints) -> Result<Proposal, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.onnx");
    std::fs::write(&path, network).unwrap();
    propose(Runtime::load().unwrap(), &path, "made.onnx", "made", hints).map_err(|e| e.to_string())
}

fn coco(labels: Labels) -> Hints {
    Hints {
        labels: Some(labels),
        ..Hints::default()
    }
}

/// An output with one number everywhere.
fn filled(name: &str, shape: &[usize], value: f32) -> Output {
    Output::floats(name, shape, vec![value; shape.iter().product()])
}

/// Rows of centre, size in pixels, then scores.
fn boxes_in_pixels(rows: usize, columns: usize) -> Vec<f32> {
    let row = |i: usize| {
        let before = [(i * 7 % 96) as f32, (i * 5 % 64) as f32, 20.0, 12.0];
        before
            .into_iter()
            .chain(std::iter::repeat_n(0.25, columns - 4))
            .collect::<Vec<_>>()
    };
    (0..rows).flat_map(row).collect()
}

fn turned(rows: usize, columns: usize, data: &[f32]) -> Vec<f32> {
    (0..rows * columns)
        .map(|i| data[i % rows * columns + i / rows])
        .collect()
}

/// The family is found without hints but the labels, and the manifest holds these lines.
fn is(family: Family, hints: Hints, inputs: &[Input], outputs: &[Output], lines: &[&str]) {
    let proposal = proposed(&onnx::network(inputs, outputs), hints).unwrap();
    assert_eq!(proposal.family, family, "{:?}", proposal.notes);
    for line in lines {
        assert!(
            proposal.text.lines().any(|l| l == *line),
            "`{line}` is not in\n{}",
            proposal.text
        );
    }
    assert_eq!(Manifest::parse(&proposal.text, "made.toml").unwrap(), proposal.manifest);
}

#[test]
fn one_stage_families_are_told_by_their_grids() {
    let none = Hints::default();
    let letterbox = [
        "size_px = [96, 64]",
        "resize = \"letterbox_centre_rounded\"",
        "pad = 114",
        "labels = \"coco80\"",
    ];
    let v5 = |columns| Output::floats("output0", &[1, 378, columns], boxes_in_pixels(378, columns));
    is(
        Family::Yolov5,
        none,
        &[picture()],
        &[v5(85)],
        &[&letterbox[..], &["kind = \"yolov5\""]].concat(),
    );
    let voc = ["labels = \"voc20\""];
    is(Family::Yolov5, none, &[picture()], &[v5(25)], &voc);
    // The old exports' grids beside the table, and a single label, whose table is as wide as YOLOv10's.
    is(
        Family::Yolov5,
        none,
        &[picture()],
        &[v5(85), filled("340", &[1, 3, 8, 12, 85], 4.0)],
        &letterbox,
    );
    let one = Hints {
        labels: Some(Labels::of_names(vec!["car".into()]).unwrap()),
        ..none
    };
    is(Family::Yolov5, one, &[picture()], &[v5(6)], &["labels = [\"car\"]"]);
    let v8 = turned(126, 84, &boxes_in_pixels(126, 84));
    let v8 = Output::floats("output0", &[1, 84, 126], v8);
    is(
        Family::Yolov8,
        none,
        &[picture()],
        &[v8],
        &[&letterbox[..], &["kind = \"yolov8\""]].concat(),
    );
    // Offsets in cells and logarithms of sizes; a NanoDet-Plus of 53 labels would have the same shape.
    let mut raw = [-0.4, 1.3, -0.7, 1.1].to_vec();
    raw.resize(85, 0.2);
    let raw = Output::floats("output", &[1, 126, 85], raw.repeat(126));
    let yolox = [
        "resize = \"letterbox_top_left\"",
        "channels = \"bgr\"",
        "std = [1.0, 1.0, 1.0]",
    ];
    is(Family::Yolox, none, &[picture()], &[raw], &yolox);
    let plus: Vec<f32> = (0..128 * 112).map(|i| if i % 112 < 80 { 0.1 } else { -3.0 }).collect();
    let plus = Output::floats("output", &[1, 128, 112], plus);
    is(
        Family::NanodetPlus,
        none,
        &[picture()],
        &[plus],
        &["strides = [8, 16, 32, 64]", "std = [57.375, 57.12, 58.395]"],
    );
    let grids = [(96, 80), (96, 32), (24, 80), (24, 32), (6, 80), (6, 32)];
    let nanodet = grids.map(|(n, row)| filled(&format!("{n}_{row}"), &[1, n, row], 0.2));
    is(
        Family::Nanodet,
        none,
        &[picture()],
        &nanodet,
        &["strides = [8, 16, 32]", "resize = \"letterbox_centre\""],
    );
    // As the first exports gave them: without a batch axis, and here with a grid more.
    let more = [
        (96, 80),
        (96, 32),
        (24, 80),
        (24, 32),
        (6, 80),
        (6, 32),
        (2, 80),
        (2, 32),
    ];
    let nanodet = more.map(|(n, row)| filled(&format!("{n}_{row}"), &[n, row], 0.2));
    let strides = ["strides = [8, 16, 32, 64]", "kind = \"nanodet\""];
    is(Family::Nanodet, none, &[picture()], &nanodet, &strides);
    let v3 = [8, 16, 32].map(|s| filled(&format!("grid_{s}"), &[1, 255, 64 / s, 96 / s], -2.0));
    let darknet = [
        "kind = \"yolov3\"",
        "resize = \"letterbox_centre\"",
        "pad = 128",
        "labels = \"coco80\"",
    ];
    let yolov3 = Hints {
        family: Some(Family::Yolov3),
        ..none
    };
    is(Family::Yolov3, yolov3, &[picture()], &v3, &darknet);
    // YOLOv5 before its decoding has the same shapes and the same anchors, and decodes otherwise.
    let error = proposed(&onnx::network(&[picture()], &v3), none).unwrap_err();
    assert!(
        error.contains("of YOLOv3 or of a later YOLO, which decodes them otherwise"),
        "{error}"
    );
    // 9 anchors for each of 96 + 24 + 6 + 2 + 1 cells.
    for (score, scores) in [(-4.0, "scores = \"logits\""), (0.1, "scores = \"probabilities\"")] {
        let tables = [
            filled("regression", &[1, 1161, 4], 0.1),
            filled("classification", &[1, 1161, 90], score),
            // zylo117's export has its features and anchors, too.
            filled("features", &[1, 64, 8, 12], 2.0),
            filled("anchors", &[1, 1161, 4], 20.0),
        ];
        let lines = [
            "kind = \"efficientdet\"",
            scores,
            "labels = \"coco91\"",
            "resize = \"letterbox_top_left\"",
        ];
        is(Family::Efficientdet, none, &[picture()], &tables, &lines);
    }
    is(
        Family::Fastestdet,
        none,
        &[picture()],
        &[filled("758", &[1, 85, 4, 6], 0.1)],
        &["kind = \"fastestdet\""],
    );
    let v4 = [8, 16, 32].map(|s| filled(&format!("Identity_{s}"), &[1, 64 / s, 96 / s, 3, 85], 0.3));
    let bytes_last = Input::floats("input_1:0", &[1, 64, 96, 3]);
    is(
        Family::Yolov4,
        none,
        &[bytes_last],
        &v4,
        &["layout = \"nhwc\"", "pad = 128", "nms_iou = 0.213"],
    );
}

#[test]
fn families_that_list_their_boxes_are_told_by_inputs_and_names() {
    let (c80, c91) = (coco(Labels::Coco80), coco(Labels::Coco91));
    let listed = |names: [&str; 3], shape: &[usize], side: f32| {
        let boxes = [shape, &[4]].concat();
        [
            filled(names[0], &boxes, side),
            Output::whole(names[1], shape, &vec![3; shape.iter().product()]),
            filled(names[2], shape, 0.4),
        ]
    };
    let rows = listed(["boxes", "labels", "scores"], &[1, 3], 20.0);
    let size = || Input::whole("orig_target_sizes", &[-1, 2]);
    is(
        Family::Deim,
        c80,
        &[picture(), size()],
        &rows,
        &["kernel = \"antialiased\"", "kind = \"deim\""],
    );
    let end_to_end = Output::floats("output0", &[1, 300, 6], [1.0, 2.0, 30.0, 40.0, 0.5, 7.0].repeat(300));
    is(
        Family::Yolov10,
        c80,
        &[picture()],
        &[end_to_end],
        &["kind = \"yolov10\""],
    );
    is(
        Family::Rtdetr,
        Hints::default(),
        &[picture()],
        &[filled("output0", &[1, 300, 84], 0.3)],
        &["kind = \"rtdetr\""],
    );
    let hf = |columns| {
        [
            filled("logits", &[1, 300, columns], -4.0),
            filled("pred_boxes", &[1, 300, 4], 0.3),
            filled("enc_topk_logits", &[1, 300, columns], -4.0),
        ]
    };
    let plain = [
        "kind = \"rfdetr\"",
        "kernel = \"antialiased\"",
        "mean = [0.0, 0.0, 0.0]",
        "labels = \"coco80\"",
    ];
    is(Family::HfDetr, Hints::default(), &[picture()], &hf(80), &plain);
    // DETR and YOLOS have neither that output nor sampled features; their last column is "no object".
    for logits in ["logits", "pred_logits"] {
        let detr = [
            filled(logits, &[1, 100, 92], -4.0),
            filled("pred_boxes", &[1, 100, 4], 0.3),
        ];
        let lines = [
            "kind = \"detr\"",
            "labels = \"coco91\"",
            "std = [58.395, 57.12, 57.375]",
        ];
        is(Family::Detr, Hints::default(), &[picture()], &detr, &lines);
    }
    let rfdetr = [filled("dets", &[1, 300, 4], 0.3), filled("labels", &[1, 300, 91], -4.0)];
    let imagenet = ["mean = [123.675, 116.28, 103.53]", "labels = \"coco91\""];
    is(Family::Rfdetr, Hints::default(), &[picture()], &rfdetr, &imagenet);
    let ssd = listed(["bboxes", "labels", "scores"], &[1, 3], 0.3);
    is(Family::SsdResnet34, c80, &[picture()], &ssd, &["first_label = 1"]);
    let tf = [
        filled("detection_boxes:0", &[1, 3, 4], 0.4),
        filled("detection_classes:0", &[1, 3], 3.0),
        filled("detection_scores:0", &[1, 3], 0.4),
        filled("num_detections:0", &[1], 3.0),
    ];
    let bytes = Input::bytes("image_tensor:0", &[1, -1, -1, 3]);
    let lines = [
        "values = \"u8\"",
        "resize = \"original\"",
        "std = [1.0, 1.0, 1.0]",
        "first_label = 0",
    ];
    is(Family::TfOd, c91, &[bytes], &tf, &lines);
    let open = || Input::floats("image", &[3, -1, -1]);
    let zoo = listed(["6568", "6570", "6572"], &[3], 20.0);
    let lines = [
        "layout = \"chw\"",
        "resize = \"short_side\"",
        "size_px = [800, 800]",
        "first_label = 1",
    ];
    is(Family::ZooRcnn, c80, &[open()], &zoo, &lines);
    let torchvision = listed(["boxes", "labels", "scores"], &[3], 20.0);
    is(
        Family::Torchvision,
        c91,
        &[open()],
        &torchvision,
        &["resize = \"original\"", "first_label = 0"],
    );
    // Neither names nor shapes tell these two apart.
    let unnamed = listed(["a", "b", "c"], &[3], 20.0);
    let error = proposed(&onnx::network(&[open()], &unnamed), c80).unwrap_err();
    assert!(
        error.contains("zoo_rcnn") && error.contains("torchvision") && error.contains("fed differently"),
        "{error}"
    );
}

#[test]
fn what_a_file_does_not_tell_is_asked() {
    let asked = |outputs: &[Output], hints: Hints, words: &[&str]| {
        let error = proposed(&onnx::network(&[picture()], outputs), hints).unwrap_err();
        assert!(!error.contains('\n'), "{error}");
        for word in words {
            assert!(error.contains(word), "`{word}` is not in: {error}");
        }
    };
    let none = Hints::default();
    let named = |family| Hints {
        family: Some(family),
        ..none
    };
    // Decoded boxes, one a cell: YOLOv6 takes letterboxed RGB, YOLOX BGR in the corner.
    let decoded = || [Output::floats("outputs", &[1, 126, 85], boxes_in_pixels(126, 85))];
    asked(&decoded(), none, &["yolox_decoded", "yolov5", "fed differently"]);
    let vague = [filled("output", &[1, 126, 85], 0.5)];
    asked(&vague, none, &["nanodet_plus", "yolox", "fed differently"]);
    let chosen = proposed(&onnx::network(&[picture()], &decoded()), named(Family::YoloxDecoded)).unwrap();
    assert!(chosen.text.contains("letterbox_top_left") && chosen.text.contains("kind = \"yolov5\""));
    asked(
        &decoded(),
        named(Family::Yolox),
        &["YOLOX", "no logarithm", "decoded already"],
    );
    asked(
        &decoded(),
        named(Family::Yolov8),
        &["not those of YOLOv8", "could be of", "yolox"],
    );
    // Labels.
    let six = || {
        [Output::floats(
            "output0",
            &[1, 300, 6],
            [1.0, 2.0, 30.0, 40.0, 0.5, 7.0].repeat(300),
        )]
    };
    asked(&six(), none, &["what the labels are"]);
    asked(
        &[Output::floats("o", &[1, 378, 12], boxes_in_pixels(378, 12))],
        none,
        &["room for 7 labels, which the file does not name"],
    );
    asked(
        &decoded(),
        coco(Labels::Voc20),
        &["room for 53 or 80 labels, and 20 are named"],
    );
    let three = Labels::of_names(["car", "bus", "van"].map(String::from).to_vec()).unwrap();
    asked(&six(), coco(three), &["label 7", "not among the 3"]);
    // Numbers that are not the family's.
    let v8_logits = filled("output0", &[1, 84, 126], -6.5);
    asked(&[v8_logits], none, &["YOLOv8", "a score is -6.5", "sigmoid"]);
    let raw_v5 = filled("output0", &[1, 378, 85], 0.5);
    asked(&[raw_v5], none, &["YOLOv5", "not decoded"]);
    let probabilities = [filled("boxes", &[1, 300, 4], 0.3), filled("scores", &[1, 300, 91], 0.1)];
    asked(&probabilities, none, &["RF-DETR", "probabilities already"]);
    let nan = filled("output0", &[1, 84, 126], f32::NAN);
    asked(&[nan], none, &["NaN in its output output0"]);
    asked(
        &[filled("mystery", &[1, 7], 0.0)],
        none,
        &[
            "mystery 1×7",
            "no known family",
            "docs/guide/reference/detector-manifest.md",
        ],
    );
    let masks = onnx::network(&[picture()], &[filled("output0", &[1, 84, 126], 0.5)]);
    let error = proposed(&[masks, onnx::metadata("task", "segment")].concat(), none).unwrap_err();
    assert!(error.contains("task is \"segment\""), "{error}");
}

#[test]
fn names_and_size_that_ultralytics_writes_are_used() {
    let open = Input::floats("images", &[-1, 3, -1, -1]);
    let v8 = |labels: usize| {
        let data = turned(126, 4 + labels, &boxes_in_pixels(126, 4 + labels));
        Output::floats("output0", &[1, 4 + labels, 126], data)
    };
    let with = |network: Vec<u8>, names: &str| {
        let entries = [
            ("names", names),
            ("imgsz", "[64, 96]"),
            ("task", "detect"),
            ("license", "AGPL-3.0"),
        ];
        let entries = entries.iter().flat_map(|(key, text)| onnx::metadata(key, text));
        network.into_iter().chain(entries).collect::<Vec<u8>>()
    };
    let network = onnx::network(&[open], &[v8(2)]);
    let proposal = proposed(
        &with(network.clone(), "{0: 'toy car', 1: \"driver's seat\"}"),
        Hints::default(),
    )
    .unwrap();
    let labels = proposal.manifest.labels;
    assert_eq!(
        (labels.name(0), labels.name(1)),
        (Some("toy car"), Some("driver's seat"))
    );
    assert!(proposal.text.contains("size_px = [96, 64]") && proposal.text.contains("licence = \"AGPL-3.0\""));
    assert!(
        proposal
            .notes
            .iter()
            .any(|n| n.to_string().contains("leaves the input's size open: 96×64"))
    );
    // The names are another network's.
    let error = proposed(&with(network.clone(), "{0: 'car'}"), Hints::default()).unwrap_err();
    assert!(error.contains("room for 2 labels, and 1 are named"), "{error}");
    // Without them the size is not known, and at the usual one the rows are no grid.
    assert!(proposed(&network, Hints::default()).is_err());
    let hints = Hints {
        size_px: Some([96, 64]),
        labels: Some(labels),
        ..Hints::default()
    };
    assert_eq!(proposed(&network, hints).unwrap().family, Family::Yolov8);
}

fn add(model: &Path, more: &[&str]) -> std::process::Output {
    program()
        .args(["detectors", "add"])
        .arg(model)
        .args(more)
        .output()
        .unwrap()
}

#[test]
fn the_manifest_that_add_writes_runs() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("my car detector.onnx");
    let answer = Output::floats("output0", &[1, 300, 6], [10.0, 10.0, 50.0, 40.0, 0.5, 1.0].repeat(300));
    std::fs::write(&model, onnx::network(&[picture()], &[answer])).unwrap();
    let names = folder.path().join("names.txt");
    std::fs::write(&names, "bus\ncar\n\n").unwrap();
    let output = add(&model, &["--labels", names.to_str().unwrap()]);
    assert!(output.status.success(), "{}", common::stderr(&output));
    assert!(
        common::stderr(&output).contains("note: YOLOv10 or YOLO26") && common::stderr(&output).contains("no file says")
    );
    let manifest = folder.path().join("my car detector.toml");
    let photo = common::skyline().join("normal_000.jpg");
    let check = program()
        .args(["detectors", "check", "--json", "--detector"])
        .arg(&manifest)
        .arg(&photo)
        .output()
        .unwrap();
    let line: serde_json::Value = serde_json::from_str(stdout(&check).lines().next().unwrap()).unwrap();
    assert_eq!(
        (&line["detector"], &line["label"]),
        (&"my_car_detector".into(), &"car".into())
    );
    // What is there is not written over; elsewhere the weights are named by their whole path.
    let before = std::fs::read(&manifest).unwrap();
    assert_refused(
        &add(&model, &["--labels", "coco80"]),
        &["my car detector.toml is already there"],
    );
    assert_eq!(std::fs::read(&manifest).unwrap(), before);
    let elsewhere = tempfile::tempdir().unwrap();
    let other = elsewhere.path().join("other.toml");
    assert!(
        add(&model, &["--labels", "coco80", "-o", other.to_str().unwrap()])
            .status
            .success()
    );
    let check = program()
        .args(["detectors", "check", "--detector"])
        .arg(&other)
        .arg(&photo)
        .output()
        .unwrap();
    assert!(check.status.success(), "{}", common::stderr(&check));
}

/// A network that finds its second label, of "bus" and "PKW", on the whole image, and the file with the labels.
fn german(folder: &Path) -> (PathBuf, String) {
    let (model, names) = (folder.join("mine.onnx"), folder.join("names.txt"));
    let answer = Output::floats("output0", &[1, 300, 6], [10.0, 10.0, 50.0, 40.0, 0.5, 1.0].repeat(300));
    std::fs::write(&model, onnx::network(&[picture()], &[answer])).unwrap();
    std::fs::write(&names, "bus\nPKW\n").unwrap();
    (model, names.display().to_string())
}

#[test]
fn a_label_of_the_users_own_is_mapped_and_the_onnx_file_names_its_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let (model, names) = german(folder.path());
    let check = |detector: &Path, more: &[&str]| {
        let mut command = program();
        command.args(["detectors", "check", "--detector"]).arg(detector);
        command
            .arg(common::skyline().join("normal_000.jpg"))
            .args(more)
            .output()
            .unwrap()
    };
    assert_refused(
        &check(&model, &[]),
        &[
            "mine.onnx has no manifest",
            "mine.toml beside it",
            "run `scaleproof detectors add",
        ],
    );
    for (map, words) in [
        (
            "PWK=car",
            &["class_map has `PWK`, which is no label of this detector; its labels are `PKW`, `bus`"][..],
        ),
        ("PKW", &["as in PKW=car"]),
        ("PKW=car,PKW=bus", &["--map names `PKW` twice"]),
    ] {
        assert_refused(&add(&model, &["--labels", &names, "--map", map]), words);
        assert!(!folder.path().join("mine.toml").exists());
    }
    let output = add(&model, &["--labels", &names, "--map", "PKW=car", "--json"]);
    let line: serde_json::Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    assert_eq!((&line["name"], &line["family"]), (&"mine".into(), &"yolov10".into()));
    let manifest = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    assert!(manifest.contains("[class_map]\nPKW = \"car\""), "{manifest}");
    let found = check(&model, &[]);
    assert!(
        stdout(&found).contains("PKW") && stdout(&found).contains("counts as car"),
        "{}",
        stdout(&found)
    );

    // The boxes are drawn into copies; the photo stays as it is.
    let saved = folder.path().join("saved");
    let found = check(&model, &["--save", saved.to_str().unwrap()]);
    let copy = saved.join("normal_000_detections.jpg");
    assert!(
        stdout(&found).contains("normal_000_detections.jpg"),
        "{}",
        common::stderr(&found)
    );
    let (before, after) = (common::skyline().join("normal_000.jpg"), copy);
    let [before, after] = [before, after].map(|path| image::open(path).unwrap().to_rgb8());
    assert_eq!(before.dimensions(), after.dimensions());
    // Orange, on the left edge of the box: 10 of 96 × 64 from the letterboxed left, somewhere in the photo.
    let is_drawn = |p: &image::Rgb<u8>| p.0[0] > 200 && (130..190).contains(&p.0[1]) && p.0[2] < 60;
    let count = |picture: &image::RgbImage| picture.pixels().filter(|p| is_drawn(p)).count();
    assert!(
        count(&after) > count(&before) + 500,
        "{} {}",
        count(&before),
        count(&after)
    );

    // Nothing of the user's is replaced: neither beside the photos nor elsewhere.
    std::fs::write(saved.join("normal_000_detections.jpg"), "mine").unwrap();
    assert_refused(
        &check(&model, &["--save", saved.to_str().unwrap()]),
        &[
            "normal_000_detections.jpg is in the way: no earlier run has drawn it",
            "hint: name another folder by --save",
        ],
    );
    assert_eq!(std::fs::read(saved.join("normal_000_detections.jpg")).unwrap(), b"mine");
    let stored = common::skyline();
    assert_refused(
        &check(&model, &["--save", stored.to_str().unwrap()]),
        &["holds the photo", "hint: name another folder by --save"],
    );

    std::fs::rename(folder.path().join("mine.onnx"), folder.path().join("other.onnx")).unwrap();
    std::fs::copy(folder.path().join("mine.toml"), folder.path().join("other.toml")).unwrap();
    assert_refused(
        &check(&folder.path().join("other.onnx"), &[]),
        &[
            "other.toml describes mine.onnx and not",
            "name the manifest of this network",
        ],
    );
    assert_refused(
        &check(&folder.path().join("none.onnx"), &[]),
        &["there is no file", "none.onnx"],
    );
}

#[test]
fn a_registered_detector_is_found_by_its_name_until_it_is_removed() {
    let (folder, data) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (model, names) = german(folder.path());
    let with = |arguments: &[&str]| {
        let mut command = program();
        command
            .arg("detectors")
            .args(arguments)
            .env("XDG_DATA_HOME", data.path());
        command.output().unwrap()
    };
    let photo = common::skyline().join("normal_000.jpg").display().to_string();
    let output = with(&["add", model.to_str().unwrap(), "--labels", &names, "--register"]);
    assert!(stdout(&output).contains("registered: "), "{}", common::stderr(&output));
    assert!(stdout(&output).contains("--detector mine PHOTO"));
    let found = with(&["check", "--detector", "mine", &photo]);
    assert!(stdout(&found).contains("PKW"), "{}", common::stderr(&found));
    assert!(stdout(&with(&["list"])).contains("mine.onnx"));
    assert_refused(
        &with(&["check", "--detector", "mime", &photo]),
        &["no detector is called mime", "deimv2_atto, mine"],
    );
    // The same again changes nothing; another by that name is refused.
    let manifest = folder.path().join("mine.toml");
    assert!(with(&["register", manifest.to_str().unwrap()]).status.success());
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replace("title = \"mine\"", "title = \"mine too\"")).unwrap();
    assert_refused(
        &with(&["register", manifest.to_str().unwrap()]),
        &["a detector called mine is registered already", "detectors remove mine"],
    );
    assert_refused(
        &with(&["register", "yolox_nano"]),
        &["yolox_nano ships with scaleproof"],
    );
    assert!(stdout(&with(&["remove", "mine"])).contains("mine: taken off the list"));
    assert_refused(
        &with(&["check", "--detector", "mine", &photo]),
        &["no detector is called mine"],
    );
    assert_refused(
        &with(&["remove", "mine"]),
        &["no registered detector is called mine: none is registered"],
    );
    assert!(manifest.exists() && model.exists());
}

#[test]
fn bad_input_is_one_sentence_and_no_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("bad.onnx");
    let refused = |bytes: &[u8], more: &[&str], words: &[&str]| {
        std::fs::write(&model, bytes).unwrap();
        assert_refused(&add(&model, more), words);
        assert!(!model.with_extension("toml").exists(), "a manifest was left behind");
    };
    let answer = || [filled("output0", &[1, 300, 6], 0.5)];
    let of = |inputs: &[Input]| onnx::network(inputs, &answer());
    let good = of(&[picture()]);
    assert_refused(
        &add(&folder.path().join("none.onnx"), &[]),
        &["cannot read", "none.onnx"],
    );
    assert_refused(&add(folder.path(), &[]), &["cannot read"]);
    refused(b"", &[], &["bad.onnx is not a model"]);
    refused(b"not a network", &[], &["bad.onnx is not a model"]);
    refused(&good[..good.len() / 2], &[], &["bad.onnx is not a model"]);
    refused(
        &of(&[Input::floats("tokens", &[1, 77])]),
        &[],
        &["no input is an image", "tokens 1×77"],
    );
    refused(
        &of(&[picture(), Input::floats("right", &[1, 3, 64, 96])]),
        &[],
        &["several inputs", "images", "right"],
    );
    refused(
        &of(&[picture(), Input::floats("scale", &[1, 2])]),
        &[],
        &["besides the image", "scale 1×2"],
    );
    refused(
        &of(&[Input::whole("images", &[1, 3, 64, 96])]),
        &[],
        &["neither float32 nor uint8"],
    );
    refused(
        &of(&[Input::floats("images", &[4, 3, 64, 96])]),
        &[],
        &["several images at once", "4×3×64×96"],
    );
    let endless = Input::floats("images", &[1, 3, 1_000_000, 1_000_000]);
    refused(&of(&[endless]), &[], &["1000000×1000000 pixels", "32 to 8192"]);
    // What the user can do about it names the options.
    let vague = [filled("output", &[1, 126, 85], 0.5)];
    let vague = onnx::network(&[picture()], &vague);
    refused(
        &vague,
        &[],
        &["which are fed differently", "hint: name yours by --family"],
    );
    let rows = [1.0, 2.0, 30.0, 40.0, 0.5, 7.0].repeat(300);
    let unnamed = onnx::network(&[picture()], &[Output::floats("o", &[1, 300, 6], rows)]);
    refused(&unnamed, &[], &["hint: name the labels by --labels, as coco80"]);
    refused(&good, &["--size", "64"], &["hint: leave --size out"]);
    refused(&good, &["--size", "64"], &["fixed at 96×64 pixels, not 64×64"]);
    refused(&good, &["--size", "7"], &["--size", "32 to 8192"]);
    refused(
        &good,
        &["--family", "yolo99"],
        &["there is no family `yolo99`", "yolov5"],
    );
    refused(&good, &["--labels", "coco99"], &["neither coco80, coco91 nor voc20"]);
    refused(
        &good,
        &["-o", "manifest.json"],
        &["manifest.json does not end in .toml"],
    );
    let renamed = folder.path().join("model.bin");
    let rows = Output::floats("output0", &[1, 300, 6], [10.0, 10.0, 50.0, 40.0, 0.5, 1.0].repeat(300));
    std::fs::write(&renamed, onnx::network(&[picture()], &[rows])).unwrap();
    assert_refused(
        &add(&renamed, &["--labels", "coco80"]),
        &["model.bin", "weights.file", ".onnx or .ort"],
    );
    assert!(!renamed.with_extension("toml").exists(), "a manifest was left behind");
    let twice = folder.path().join("twice.txt");
    std::fs::write(&twice, "car\ncar\n").unwrap();
    refused(
        &good,
        &["--labels", twice.to_str().unwrap()],
        &["\"car\" is listed twice"],
    );
}

/// Where the file can tell, `add` proposes what the manifests that ship say; labels of DEIM it asks for.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_real_detectors_get_the_manifests_that_ship() {
    let weights = shared("detectors");
    let none = Hints::default();
    let asked = ["deimv2_femto", "deimv2_atto"];
    for built_in in Manifest::all().unwrap() {
        let path = weights.join(&built_in.weights.file);
        let run = |hints| propose(Runtime::load().unwrap(), &path, &built_in.weights.file, "mine", hints);
        if asked.contains(&built_in.name.as_str()) {
            let error = run(none).unwrap_err().to_string();
            assert!(error.contains("labels"), "{}: {error}", built_in.name);
        }
        let hints = if asked.contains(&built_in.name.as_str()) {
            coco(Labels::Coco80)
        } else {
            none
        };
        let found = run(hints).unwrap().manifest;
        assert_eq!(found.labels, built_in.labels, "{}", built_in.name);
        assert_eq!(found.input, built_in.input, "{}", built_in.name);
        assert_eq!(found.head, built_in.head, "{}", built_in.name);
        assert_eq!(found.weights.sha256, built_in.weights.sha256, "{}", built_in.name);
        println!("{}: the same input, head, labels and SHA-256", built_in.name);
    }
}
