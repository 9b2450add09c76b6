//! Every detector family: known boxes are written as its network would answer them, a network made here answers so through
//! ONNX Runtime, and the boxes must come back in the photo. Encoding and placement are written down here a second time.

use crate::common::onnx;

use onnx::{Input, Output};
use scaleproof_detect::{Detector, Manifest, Runtime};

/// Width, height of the photos: odd, wide and tall, larger and smaller than the inputs.
const PHOTOS: [[u32; 2]; 3] = [[1001, 613], [613, 1001], [333, 217]];

/// A box: label as COCO-80 counts, score, x1 y1 x2 y2 as shares of the photo.
type Truth = (usize, f32, [f64; 4]);
const TRUTH: [Truth; 3] = [
    (2, 0.93, [0.11, 0.2, 0.45, 0.71]),
    (7, 0.41, [0.5, 0.33, 0.97, 0.9]),
    (0, 0.07, [0.7, 0.05, 0.82, 0.2]),
];

/// Where a photo lies in the input: input pixels = photo pixels · scale + offset.
#[derive(Clone, Copy)]
struct Place {
    scale: [f64; 2],
    offset: [f64; 2],
    /// Width, height of the input.
    net: [u32; 2],
}

fn stretched(photo: [u32; 2], net: [u32; 2]) -> Place {
    let scale = [0, 1].map(|i| f64::from(net[i]) / f64::from(photo[i]));
    Place {
        scale,
        offset: [0.0; 2],
        net,
    }
}

/// As the YOLO programs since v5 map back: the gain, and half the rounded rest.
fn letterboxed(photo: [u32; 2], net: [u32; 2]) -> Place {
    let gain = (f64::from(net[0]) / f64::from(photo[0])).min(f64::from(net[1]) / f64::from(photo[1]));
    let rest = |i: usize| f64::from(net[i]) - (f64::from(photo[i]) * gain).round();
    Place {
        scale: [gain; 2],
        offset: [0, 1].map(|i| (rest(i) / 2.0 - 0.1).round()),
        net,
    }
}

/// As the zoo's YOLOv4 prepares a photo: sizes and rests cut to whole pixels.
fn letterboxed_truncated(photo: [u32; 2], net: [u32; 2]) -> Place {
    let gain = (f64::from(net[0]) / f64::from(photo[0])).min(f64::from(net[1]) / f64::from(photo[1]));
    let kept = photo.map(|side| (f64::from(side) * gain).floor());
    let scale = [0, 1].map(|i| kept[i] / f64::from(photo[i]));
    Place {
        scale,
        offset: [0, 1].map(|i| ((f64::from(net[i]) - kept[i]) / 2.0).floor()),
        net,
    }
}

/// As the zoo's R-CNN prepares a photo: shorter side 800, then up to a multiple of 32.
fn short_side_800(photo: [u32; 2]) -> Place {
    let ratio = 800.0 / f64::from(photo[0].min(photo[1]));
    let net = photo.map(|side| ((f64::from(side) * ratio) as u32).div_ceil(32) * 32);
    Place {
        scale: [ratio; 2],
        offset: [0.0; 2],
        net,
    }
}

impl Place {
    /// The corners of a truth box in input pixels.
    fn corners(&self, photo: [u32; 2], truth: &Truth) -> [f32; 4] {
        [0, 1, 2, 3].map(|i| {
            let axis = i % 2;
            (truth.2[i] * f64::from(photo[axis]) * self.scale[axis] + self.offset[axis]) as f32
        })
    }

    /// Its centre and size in input pixels.
    fn centre(&self, photo: [u32; 2], truth: &Truth) -> [f32; 4] {
        let [x1, y1, x2, y2] = self.corners(photo, truth);
        [(x1 + x2) / 2.0, (y1 + y2) / 2.0, x2 - x1, y2 - y1]
    }
}

/// Rows of `columns` numbers, all `empty` but some, spread over the whole output.
fn rows(count: usize, columns: usize, empty: f32, filled: &[Vec<f32>]) -> Vec<f32> {
    let mut data = vec![empty; count * columns];
    for (i, row) in filled.iter().enumerate() {
        data[(i + 1) * (count / 5) * columns..][..row.len()].copy_from_slice(row);
    }
    data
}

/// A row of `before`, then 80 scores with one that is not `empty`.
fn labelled(before: &[f32], label: usize, score: f32, empty: f32) -> Vec<f32> {
    let mut row = before.to_vec();
    row.resize(before.len() + 80, empty);
    row[before.len() + label] = score;
    row
}

/// Nothing here compares it with the network.
const NO_HASH: &str = "0000000000000000000000000000000000000000000000000000000000000000";

fn manifest(labels: &str, input: &str, head: &str) -> Manifest {
    let text = format!(
        "name = \"made\"\ntitle = \"Made\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = {labels}\n\
         [weights]\nfile = \"made.onnx\"\nsha256 = \"{NO_HASH}\"\n\
         [input]\n{input}\nkernel = \"opencv_linear\"\nchannels = \"rgb\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n\
         [head]\n{head}\n"
    );
    Manifest::parse(&text, "made.toml").unwrap()
}

fn run(manifest: &Manifest, network: &[u8], [width, height]: [u32; 2]) -> Result<Vec<(usize, f64, [f64; 4])>, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.onnx");
    std::fs::write(&path, network).unwrap();
    let mut detector = Detector::open(Runtime::load().unwrap(), manifest, &path).unwrap();
    let found = detector
        .detect(&image::RgbImage::new(width, height))
        .map_err(|e| e.to_string())?;
    Ok(found.iter().map(|d| (d.label, d.score, d.box_px.into())).collect())
}

/// On every photo size, exactly the truth comes back; `number` is the label's number in the manifest's list.
fn proves(
    manifest: &Manifest,
    inputs: &[Input],
    number: impl Fn(usize) -> usize,
    outputs: impl Fn([u32; 2]) -> Vec<Output>,
) {
    let (mut worst_px, mut worst_score) = (0.0_f64, 0.0_f64);
    for photo in PHOTOS {
        let found = run(manifest, &onnx::network(inputs, &outputs(photo)), photo).unwrap();
        assert_eq!(found.len(), TRUTH.len(), "{photo:?}: {found:?}");
        // Both are in falling order of scores.
        for ((label, score, b), truth) in found.iter().zip(&TRUTH) {
            assert_eq!(*label, number(truth.0), "{photo:?}: {found:?}");
            worst_score = worst_score.max((score - f64::from(truth.1)).abs());
            for i in 0..4 {
                worst_px = worst_px.max((b[i] - truth.2[i] * f64::from(photo[i % 2])).abs());
            }
        }
    }
    println!(
        "{:?}: boxes off by up to {worst_px:.3} px, scores by {worst_score:.1e}",
        manifest.head
    );
    assert!(worst_px < 0.5 && worst_score < 1e-4, "{worst_px} px, {worst_score}");
}

const LETTERBOX_640: &str = "size_px = [640, 480]\nresize = \"letterbox_centre_rounded\"\npad = 114";
const STRETCH: &str = "size_px = [640, 480]\nresize = \"stretch\"";
const NET: [u32; 2] = [640, 480];

fn picture() -> [Input; 1] {
    [Input::floats("images", &[1, 3, 480, 640])]
}

#[test]
fn yolov5_v6_v7() {
    let m = manifest("\"coco80\"", LETTERBOX_640, "kind = \"yolov5\"\nnms_iou = 0.45");
    proves(
        &m,
        &picture(),
        |l| l,
        |photo| {
            let row = |t: &Truth| {
                let [cx, cy, w, h] = letterboxed(photo, NET).centre(photo, t);
                labelled(&[cx, cy, w, h, 0.95], t.0, t.1 / 0.95, 0.0)
            };
            // An older export gives its grids too, and a second, worse box over the first is suppressed.
            let mut filled: Vec<_> = TRUTH.iter().map(row).collect();
            let mut shifted = row(&TRUTH[0]);
            (shifted[0], shifted[4]) = (shifted[0] + 4.0, 0.5);
            filled.push(shifted);
            let grid = Output::floats("grid", &[1, 3, 2, 2, 85], vec![9.0; 1020]);
            vec![
                grid,
                Output::floats("output0", &[1, 900, 85], rows(900, 85, 0.0, &filled)),
            ]
        },
    );
}

#[test]
fn yolov8_to_v12() {
    let m = manifest("\"coco80\"", LETTERBOX_640, "kind = \"yolov8\"\nnms_iou = 0.7");
    proves(
        &m,
        &picture(),
        |l| l,
        |photo| {
            let place = letterboxed(photo, NET);
            let filled: Vec<_> = TRUTH
                .iter()
                .map(|t| labelled(&place.centre(photo, t), t.0, t.1, 0.0))
                .collect();
            let upright = rows(6300, 84, 0.0, &filled);
            let turned = (0..84 * 6300).map(|i| upright[i % 6300 * 84 + i / 6300]).collect();
            vec![Output::floats("output0", &[1, 84, 6300], turned)]
        },
    );
}

#[test]
fn yolov10_and_26() {
    let m = manifest("\"coco80\"", LETTERBOX_640, "kind = \"yolov10\"");
    proves(
        &m,
        &picture(),
        |l| l,
        |photo| {
            let place = letterboxed(photo, NET);
            let filled: Vec<_> = TRUTH
                .iter()
                .map(|t| [&place.corners(photo, t)[..], &[t.1, t.0 as f32]].concat())
                .collect();
            vec![Output::floats("output0", &[1, 300, 6], rows(300, 6, 0.0, &filled))]
        },
    );
}

#[test]
fn yolov3_grids_of_logits() {
    let input = "size_px = [416, 320]\nresize = \"letterbox_centre\"\npad = 128";
    let m = manifest("\"coco80\"", input, "kind = \"yolov3\"\nnms_iou = 0.45");
    // Stride, which of the three anchors and its size; a box per grid.
    let grids = [(8, 2, [33.0, 23.0]), (16, 0, [30.0, 61.0]), (32, 1, [156.0, 198.0])];
    let logit = |p: f32| (p / (1.0 - p)).ln();
    let inputs = [Input::floats("000_net", &[1, 3, 320, 416])];
    proves(
        &m,
        &inputs,
        |l| l,
        |photo| {
            let output = |(i, (stride, which, anchor)): (usize, &(usize, usize, [f32; 2]))| {
                let (columns, rows) = (416 / stride, 320 / stride);
                let mut data = vec![-40.0; 255 * columns * rows];
                let [cx, cy, w, h] = letterboxed_truncated(photo, [416, 320]).centre(photo, &TRUTH[i]);
                let (x, y) = (cx / *stride as f32, cy / *stride as f32);
                let before = [
                    logit(x.fract()),
                    logit(y.fract()),
                    (w / anchor[0]).ln(),
                    (h / anchor[1]).ln(),
                    logit(0.98),
                ];
                let row = labelled(&before, TRUTH[i].0, logit(TRUTH[i].1 / 0.98), -40.0);
                let cell = y as usize * columns + x as usize;
                for (k, number) in row.iter().enumerate() {
                    data[(85 * which + k) * columns * rows + cell] = *number;
                }
                Output::floats(&format!("grid_{i}"), &[1, 255, rows, columns], data)
            };
            grids.iter().enumerate().map(output).collect()
        },
    );
}

#[test]
fn efficientdet_by_its_anchors() {
    for (scores, of) in [
        ("logits", (|p: f32| (p / (1.0 - p)).ln()) as fn(f32) -> f32),
        ("probabilities", |p| p),
    ] {
        let input = "size_px = [512, 512]\nresize = \"letterbox_top_left\"";
        let head = format!("kind = \"efficientdet\"\nscores = \"{scores}\"\nnms_iou = 0.5");
        let m = manifest("\"coco91\"", input, &head);
        let empty = of(1e-9);
        let inputs = [Input::floats("input", &[1, 3, 512, 512])];
        proves(&m, &inputs, category, |photo| {
            let gain = (512.0 / f64::from(photo[0])).min(512.0 / f64::from(photo[1]));
            let place = Place {
                scale: [gain; 2],
                offset: [0.0; 2],
                net: [512, 512],
            };
            let (mut boxes, mut labels) = (vec![0.0; 49104 * 4], vec![empty; 49104 * 90]);
            for (i, t) in TRUTH.iter().enumerate() {
                let [cx, cy, w, h] = place.centre(photo, t);
                // Stride 32, behind 9 · (64² + 32²) anchors; size 2^(i/3), aspect 1.4 × 0.7.
                let (x, y) = ((cx / 32.0) as usize, (cy / 32.0) as usize);
                let side = 128.0 * 2_f32.powf(i as f32 / 3.0);
                let (aw, ah) = (1.4 * side, 0.7 * side);
                let at = 9 * (64 * 64 + 32 * 32) + (y * 16 + x) * 9 + 3 * i + 1;
                let own = [x, y].map(|cell| (cell as f32 + 0.5) * 32.0);
                let offsets = [(cy - own[1]) / ah, (cx - own[0]) / aw, (h / ah).ln(), (w / aw).ln()];
                boxes[4 * at..4 * at + 4].copy_from_slice(&offsets);
                labels[90 * at + category(t.0) - 1] = of(t.1);
            }
            vec![
                Output::floats("regression", &[1, 49104, 4], boxes),
                Output::floats("classification", &[1, 49104, 90], labels),
            ]
        });
    }
}

#[test]
fn yolov4_channels_last() {
    let input = "size_px = [416, 320]\nlayout = \"nhwc\"\nresize = \"letterbox_centre\"\npad = 128";
    let m = manifest("\"coco80\"", input, "kind = \"yolov4\"\nnms_iou = 0.213");
    // Stride, s, and the first anchor of each grid; a box per grid.
    let grids = [
        (8, 1.2, [12.0, 16.0]),
        (16, 1.1, [36.0, 75.0]),
        (32, 1.05, [142.0, 110.0]),
    ];
    proves(
        &m,
        &[Input::floats("input_1:0", &[1, 320, 416, 3])],
        |l| l,
        |photo| {
            let output = |(i, (stride, s, anchor)): (usize, &(usize, f32, [f32; 2]))| {
                let (columns, rows) = (416 / stride, 320 / stride);
                let mut data = vec![0.0; columns * rows * 3 * 85];
                let [cx, cy, w, h] = letterboxed_truncated(photo, [416, 320]).centre(photo, &TRUTH[i]);
                let (x, y) = (cx / *stride as f32, cy / *stride as f32);
                let raw = |v: f32| {
                    let share = (v.fract() + (s - 1.0) / 2.0) / s;
                    (share / (1.0 - share)).ln()
                };
                let before = [raw(x), raw(y), (w / anchor[0]).ln(), (h / anchor[1]).ln(), 0.98];
                let cell = (y as usize * columns + x as usize) * 3;
                data[cell * 85..][..85].copy_from_slice(&labelled(&before, TRUTH[i].0, TRUTH[i].1 / 0.98, 0.0));
                Output::floats(&format!("Identity_{i}:0"), &[1, rows, columns, 3, 85], data)
            };
            grids.iter().enumerate().map(output).collect()
        },
    );
}

#[test]
fn deim_d_fine_and_rt_detr_with_the_photo_size() {
    let m = manifest("\"coco80\"", STRETCH, "kind = \"deim\"");
    let inputs = [
        Input::floats("images", &[1, 3, 480, 640]),
        Input::whole("orig_target_sizes", &[1, 2]),
    ];
    proves(
        &m,
        &inputs,
        |l| l,
        |photo| {
            let place = stretched(photo, photo);
            let boxes = TRUTH.iter().rev().flat_map(|t| place.corners(photo, t)).collect();
            vec![
                Output::whole("labels", &[1, 3], &[0, 7, 2]),
                Output::floats("boxes", &[1, 3, 4], boxes),
                Output::floats("scores", &[1, 3], vec![0.07, 0.41, 0.93]),
            ]
        },
    );
}

/// Centre and size as shares of the input.
fn shares(photo: [u32; 2], t: &Truth) -> [f32; 4] {
    let [cx, cy, w, h] = stretched(photo, NET).centre(photo, t);
    [cx / 640.0, cy / 480.0, w / 640.0, h / 480.0]
}

#[test]
fn rt_detr_of_ultralytics() {
    let m = manifest("\"coco80\"", STRETCH, "kind = \"rtdetr\"");
    proves(
        &m,
        &picture(),
        |l| l,
        |photo| {
            let filled: Vec<_> = TRUTH
                .iter()
                .map(|t| labelled(&shares(photo, t), t.0, t.1, 0.0))
                .collect();
            vec![Output::floats("output0", &[1, 300, 84], rows(300, 84, 0.0, &filled))]
        },
    );
}

/// The COCO category ids of the truth's labels.
fn category(label: usize) -> usize {
    [(2, 3), (7, 8), (0, 1)].iter().find(|(l, _)| *l == label).unwrap().1
}

#[test]
fn rf_detr_by_category_ids() {
    let m = manifest("\"coco91\"", STRETCH, "kind = \"rfdetr\"");
    proves(&m, &picture(), category, |photo| {
        let boxes: Vec<Vec<f32>> = TRUTH.iter().map(|t| shares(photo, t).to_vec()).collect();
        let logits = |t: &Truth| {
            let mut row = vec![-30.0; 91];
            row[category(t.0)] = (t.1 / (1.0 - t.1)).ln();
            row[12] = 5.0; // a gap of COCO's ids, which no file could keep
            row
        };
        let logits: Vec<_> = TRUTH.iter().map(logits).collect();
        vec![
            Output::floats("dets", &[1, 300, 4], rows(300, 4, 0.5, &boxes)),
            Output::floats("labels", &[1, 300, 91], rows(300, 91, -30.0, &logits)),
        ]
    });
}

#[test]
fn tensorflow_object_detection_takes_bytes_of_any_size() {
    let m = manifest(
        "\"coco91\"",
        "layout = \"nhwc\"\nvalues = \"u8\"\nresize = \"original\"",
        "kind = \"tf_od\"\nfirst_label = 0",
    );
    proves(&m, &[Input::bytes("image_tensor:0", &[1, -1, -1, 3])], category, |_| {
        // A fourth row lies beyond the count and is not a detection.
        let mut boxes: Vec<f32> = TRUTH.iter().flat_map(|t| [1, 0, 3, 2].map(|i| t.2[i] as f32)).collect();
        boxes.extend([0.0, 0.0, 1.0, 1.0]);
        vec![
            Output::floats("detection_classes:0", &[1, 4], vec![3.0, 8.0, 1.0, 1.0]),
            Output::floats("detection_scores:0", &[1, 4], vec![0.93, 0.41, 0.07, 0.99]),
            Output::floats("detection_boxes:0", &[1, 4, 4], boxes),
            Output::floats("num_detections:0", &[1], vec![3.0]),
        ]
    });
}

#[test]
fn faster_and_mask_rcnn_of_the_zoo() {
    let input = "size_px = [800, 800]\nlayout = \"chw\"\nresize = \"short_side\"";
    let m = manifest("\"coco80\"", input, "kind = \"rcnn\"\nfirst_label = 1");
    proves(
        &m,
        &[Input::floats("image", &[3, -1, -1])],
        |l| l,
        |photo| {
            let place = short_side_800(photo);
            assert!(place.net.iter().all(|side| side % 32 == 0));
            let boxes = TRUTH.iter().flat_map(|t| place.corners(photo, t)).collect();
            vec![
                Output::floats("6568", &[3, 4], boxes),
                Output::whole("6570", &[3], &[3, 8, 1]),
                Output::floats("6572", &[3], vec![0.93, 0.41, 0.07]),
                Output::floats("6887", &[3, 1, 28, 28], vec![0.5; 3 * 784]),
            ]
        },
    );
}

#[test]
fn torchvision_takes_the_photo_as_it_is_and_may_find_nothing() {
    let m = manifest(
        "\"coco91\"",
        "layout = \"chw\"\nresize = \"original\"",
        "kind = \"rcnn\"\nfirst_label = 0",
    );
    let input = [Input::floats("images", &[3, -1, -1])];
    proves(&m, &input, category, |photo| {
        let place = stretched(photo, photo);
        let boxes = TRUTH.iter().flat_map(|t| place.corners(photo, t)).collect();
        vec![
            Output::floats("boxes", &[3, 4], boxes),
            Output::floats("scores", &[3], vec![0.93, 0.41, 0.07]),
            Output::whole("labels", &[3], &[3, 8, 1]),
        ]
    });
    let nothing = [
        Output::floats("boxes", &[0, 4], vec![]),
        Output::whole("labels", &[0], &[]),
        Output::floats("scores", &[0], vec![]),
    ];
    assert_eq!(run(&m, &onnx::network(&input, &nothing), PHOTOS[0]).unwrap(), []);
}

#[test]
fn ssd_resnet34() {
    let m = manifest("\"coco80\"", STRETCH, "kind = \"ssd_resnet34\"\nfirst_label = 1");
    proves(
        &m,
        &picture(),
        |l| l,
        |_| {
            let boxes = TRUTH.iter().flat_map(|t| t.2.map(|v| v as f32)).collect();
            vec![
                Output::floats("bboxes", &[1, 3, 4], boxes),
                Output::whole("labels", &[1, 3], &[3, 8, 1]),
                Output::floats("scores", &[1, 3], vec![0.93, 0.41, 0.07]),
            ]
        },
    );
}

/// `rf_detr_by_category_ids` with the names and the 80 labels of Transformers' exports.
#[test]
fn rt_detr_and_d_fine_of_transformers() {
    let m = manifest("\"coco80\"", STRETCH, "kind = \"rfdetr\"");
    proves(
        &m,
        &picture(),
        |l| l,
        |photo| {
            let boxes: Vec<Vec<f32>> = TRUTH.iter().map(|t| shares(photo, t).to_vec()).collect();
            let logits: Vec<_> = TRUTH
                .iter()
                .map(|t| labelled(&[], t.0, (t.1 / (1.0 - t.1)).ln(), -30.0))
                .collect();
            vec![
                Output::floats("logits", &[1, 300, 80], rows(300, 80, -30.0, &logits)),
                Output::floats("pred_boxes", &[1, 300, 4], rows(300, 4, 0.5, &boxes)),
            ]
        },
    );
}

#[test]
fn nanodet_plus() {
    let head = "kind = \"nanodet_plus\"\nstrides = [8, 16, 32, 64]\nnms_iou = 0.6";
    let m = manifest("\"coco80\"", "size_px = [416, 416]\nresize = \"stretch\"", head);
    proves(
        &m,
        &[Input::floats("data", &[1, 3, 416, 416])],
        |l| l,
        |photo| {
            let mut data = vec![0.0; 3598 * 112];
            for t in &TRUTH {
                // Stride 64 reaches every side; its cells come last: 52² + 26² + 13².
                let [x1, y1, x2, y2] = stretched(photo, [416, 416]).corners(photo, t);
                let (x, y) = (((x1 + x2) / 128.0).round(), ((y1 + y2) / 128.0).round());
                let mut row = labelled(&[], t.0, t.1, 0.0);
                for distance in [x * 64.0 - x1, y * 64.0 - y1, x2 - x * 64.0, y2 - y * 64.0] {
                    let bin = distance / 64.0;
                    let mut logits = [-60.0; 8];
                    logits[bin as usize] = (1.0 - bin.fract()).ln();
                    logits[bin as usize + 1] = bin.fract().ln();
                    row.extend(logits);
                }
                let cell = 2704 + 676 + 169 + y as usize * 7 + x as usize;
                data[cell * 112..][..112].copy_from_slice(&row);
            }
            vec![Output::floats("output", &[1, 3598, 112], data)]
        },
    );
}

#[test]
fn nan_outputs_and_other_shapes_are_named() {
    let heads = [
        ("kind = \"yolov5\"\nnms_iou = 0.5", [1, 40, 85]),
        ("kind = \"yolov8\"\nnms_iou = 0.5", [1, 84, 40]),
        ("kind = \"yolov10\"", [1, 40, 6]),
        ("kind = \"rtdetr\"", [1, 40, 84]),
    ];
    for (head, shape) in heads {
        let m = manifest("\"coco80\"", STRETCH, head);
        let nan = Output::floats("output0", &shape, vec![f32::NAN; shape.iter().product()]);
        let error = run(&m, &onnx::network(&picture(), &[nan]), [97, 61]).unwrap_err();
        assert!(
            error.contains("made answered with NaN in its output output0"),
            "{head}: {error}"
        );
    }
    let all = [
        "yolov4",
        "yolov5",
        "yolov8",
        "yolov10",
        "rtdetr",
        "rfdetr",
        "tf_od",
        "ssd_resnet34",
        "rcnn",
        "nanodet_plus",
    ];
    for kind in all {
        let more = match kind {
            "yolov4" | "yolov5" | "yolov8" => "nms_iou = 0.5",
            "nanodet_plus" => "strides = [8]\nnms_iou = 0.5",
            "tf_od" | "ssd_resnet34" | "rcnn" => "first_label = 1",
            _ => "",
        };
        let m = manifest("\"coco80\"", STRETCH, &format!("kind = \"{kind}\"\n{more}"));
        let other = Output::floats("mystery", &[1, 7, 3], vec![0.0; 21]);
        let error = run(&m, &onnx::network(&picture(), &[other]), [97, 61]).unwrap_err();
        let named = error.contains(&format!("{kind} head")) && error.contains("mystery [1, 7, 3]");
        assert!(named && error.contains("does not fit this file"), "{error}");
    }
}
