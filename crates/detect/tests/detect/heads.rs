//! Boxes encoded as networks encode them come back.

use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{AnchorHead, CandidateBox, Data, Head, HeadError, Manifest, StridesHead, Tensor, candidates};

fn floats(shape: &[usize], data: Vec<f32>) -> Tensor {
    Tensor {
        name: String::new(),
        shape: shape.to_vec(),
        data: Data::F32(data),
    }
}

const fn head(nms_iou: f64) -> AnchorHead {
    let labels = None;
    AnchorHead { nms_iou, labels }
}

fn decode(head: Head, outputs: &[Tensor], size: [u32; 2]) -> Result<Vec<CandidateBox>, HeadError> {
    let manifest = Manifest {
        head,
        ..Manifest::named("yolox_nano").unwrap()
    };
    assert_eq!(manifest.labels.count(), 80);
    candidates(&manifest, outputs, size)
}

#[test]
fn a_box_of_fastestdet_comes_back() {
    let (columns, rows, plane) = (22, 20, 440);
    let mut data = vec![0.0_f32; 85 * plane];
    // Cell (10, 5) of a 352×320 input; centre (10.3, 5.6) cells, size 0.25 × 0.1 of the input.
    let cell = 5 * columns + 10;
    for (channel, value) in [
        (0, 0.8),
        (1, 0.3_f32.atanh()),
        (2, 0.6_f32.atanh()),
        (3, (0.25_f32 / 0.75).ln()),
        (4, (0.1_f32 / 0.9).ln()),
        (5 + 2, 0.5),
    ] {
        data[channel * plane + cell] = value;
    }
    let tensor = floats(&[1, 85, rows, columns], data);
    let found = decode(Head::Fastestdet(head(0.45)), &[tensor], [352, 320]).unwrap();
    assert_eq!((found.len(), found[0].label), (1, 2));
    assert!((found[0].score - 0.8_f64.powf(0.6) * 0.5_f64.powf(0.4)).abs() < 1e-6);
    let b = found[0].b;
    assert!(
        (b.x1 - (164.8 - 44.0)).abs() < 1e-3 && (b.y2 - (89.6 + 16.0)).abs() < 1e-3,
        "{b:?}"
    );
}

const BINS: usize = 8;

fn nanodet() -> Head {
    Head::Nanodet(StridesHead {
        strides: vec![8, 16, 32],
        nms_iou: 0.6,
        labels: None,
    })
}

/// Logits whose softmax mean is `distance`: all weight on the two bins around it.
fn logits(distance: f64) -> [f32; BINS] {
    let low = distance.floor();
    let share = (distance - low).max(1e-9);
    let mut out = [-60.0; BINS];
    out[low as usize] = (1.0 - share).ln() as f32;
    out[low as usize + 1] = share.ln() as f32;
    out
}

#[test]
fn a_box_of_nanodet_comes_back() {
    let sizes = [(52 * 40, 8.0), (26 * 20, 16.0), (13 * 10, 32.0)];
    let mut outputs: Vec<Tensor> = Vec::new();
    for (cells, _) in sizes {
        outputs.push(floats(&[1, cells, 80], vec![0.0; cells * 80]));
        outputs.push(floats(&[1, cells, 32], vec![0.0; cells * 32]));
    }
    // Stride 16, cell (12, 6): centre (199.5, 103.5); box 150…260 × 80…120.
    let cell = 6 * 26 + 12;
    let ltrb = [49.5 / 16.0, 23.5 / 16.0, 60.5 / 16.0, 16.5 / 16.0]
        .map(logits)
        .concat();
    if let Data::F32(v) = &mut outputs[2].data {
        v[cell * 80 + 7] = 0.75;
    }
    if let Data::F32(v) = &mut outputs[3].data {
        v[cell * 32..][..32].copy_from_slice(&ltrb);
    }
    outputs.reverse(); // picked by shape, not by order
    let found = decode(nanodet(), &outputs, [416, 320]).unwrap();
    assert_eq!((found.len(), found[0].label, found[0].score), (1, 7, 0.75));
    let b = found[0].b;
    let expected = BoxPx::new(150.0, 80.0, 260.0, 120.0);
    assert!(b.iou(&expected) > 0.999, "{b:?}");
    assert!(
        decode(nanodet(), &outputs[1..], [416, 320])
            .unwrap_err()
            .to_string()
            .contains("does not fit")
    );
}

const YOLOX: Head = Head::Yolox(head(0.45));

/// Encodes a box as the network would answer it, at the cell its centre falls into.
fn encoded(cx: f32, cy: f32, w: f32, h: f32, stride_index: usize) -> Tensor {
    let cells = 52 * 40 + 26 * 20 + 13 * 10;
    let first: usize = [0, 52 * 40, 52 * 40 + 26 * 20][stride_index];
    let s = [8.0, 16.0, 32.0][stride_index];
    let (x, y) = ((cx / s).floor(), (cy / s).floor());
    let mut data = vec![0.0; cells * 85];
    let row = &mut data[(first + y as usize * (416 / s as usize) + x as usize) * 85..][..85];
    row[..5].copy_from_slice(&[cx / s - x, cy / s - y, (w / s).ln(), (h / s).ln(), 0.9]);
    row[5 + 2] = 0.5;
    floats(&[1, cells, 85], data)
}

#[test]
fn an_encoded_box_comes_back_from_every_stride() {
    for stride_index in 0..3 {
        let found = decode(YOLOX, &[encoded(203.0, 101.5, 90.0, 33.0, stride_index)], [416, 320]).unwrap();
        assert_eq!(found.len(), 1);
        let (c, b) = (&found[0], found[0].b);
        assert!((c.score - 0.45).abs() < 1e-6 && c.label == 2);
        assert!((b.x1 - 158.0).abs() < 1e-3 && (b.y2 - 118.0).abs() < 1e-3, "{b:?}");
    }
}

#[test]
fn nan_outputs_and_other_shapes_give_no_box() {
    let mut t = encoded(200.0, 100.0, 50.0, 50.0, 0);
    if let Data::F32(v) = &mut t.data {
        v.iter_mut().for_each(|v| *v = f32::NAN);
    }
    assert!(decode(YOLOX, std::slice::from_ref(&t), [416, 320]).unwrap().is_empty());
    t.shape = vec![1, 3549, 85];
    assert!(
        decode(YOLOX, &[t], [416, 320])
            .unwrap_err()
            .to_string()
            .contains("does not fit")
    );
}

fn outputs(labels: Vec<i64>, scores: Vec<f32>) -> Vec<Tensor> {
    let n = scores.len();
    let boxes = (0..n).flat_map(|i| [i as f32, 2.0, i as f32 + 30.0, 40.0]).collect();
    vec![
        Tensor {
            name: "labels".into(),
            shape: vec![1, n],
            data: Data::I64(labels),
        },
        floats(&[1, n, 4], boxes),
        floats(&[1, n], scores),
    ]
}

#[test]
fn rows_come_back_and_a_strange_label_is_named() {
    let found = decode(
        Head::Deim {},
        &outputs(vec![2, 7, 91, -1], vec![0.2, 0.9, 0.0, 0.0]),
        [320, 320],
    )
    .unwrap();
    assert_eq!(
        found.iter().map(|c| (c.label, c.b.x1)).collect::<Vec<_>>(),
        [(2, 0.0), (7, 1.0)]
    );
    for strange in [91, 80, -1, i64::MIN] {
        let error = decode(Head::Deim {}, &outputs(vec![2, strange], vec![0.2, 0.01]), [320, 320])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(&format!("label {strange}, which is not among the 80")),
            "{error}"
        );
    }
    assert!(decode(Head::Deim {}, &outputs(vec![2], vec![0.2, 0.9]), [320, 320]).is_err());
}
