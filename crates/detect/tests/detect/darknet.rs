//! Darknet networks become ONNX files that compute what OpenCV's importer computes (`tests/data/cases/darknet/make_darknet.py`).

use ort::session::Session;
use proptest::prelude::*;
use scaleproof_detect::{Family, Hints, Labels, Runtime, darknet_contents_to_onnx, darknet_to_onnx, propose};

use crate::common::{home, read_json};

const FOLDER: &str = "tests/data/cases/darknet";

fn converted(name: &str) -> Vec<u8> {
    let [cfg, weights] = ["cfg", "weights"].map(|ending| home().join(FOLDER).join(format!("{name}.{ending}")));
    darknet_to_onnx(&cfg, &weights).unwrap()
}

/// Rows of the decoded table for the image of the script.
fn answer(network: &[u8]) -> Vec<Vec<f32>> {
    let environment = &Runtime::load().unwrap().environment;
    let mut session = Session::builder(environment)
        .unwrap()
        .commit_from_memory(network)
        .unwrap();
    let image: Vec<f32> = (0..3 * 96 * 64).map(|i| ((7 * i + 3) % 101) as f32 / 100.0).collect();
    let image = ort::value::Tensor::from_array((vec![1, 3, 96, 64], image)).unwrap();
    let outputs = session.run(ort::inputs![image]).unwrap();
    let (_, data) = outputs[0].try_extract_tensor::<f32>().unwrap();
    data.chunks(9).map(<[f32]>::to_vec).collect()
}

/// OpenCV lists the anchors of a cell one after the other, and sets scores below 0.2 to 0; the table lists the cells of an anchor.
#[test]
fn outputs_are_those_of_opencvs_importer() {
    let expected = read_json(&home().join(FOLDER).join("expected.json"));
    for (name, grids) in [("tiny_v4", &[6, 24][..]), ("v4", &[6]), ("fastest", &[24])] {
        let (rows, opencv) = (answer(&converted(name)), expected[name].as_array().unwrap());
        assert_eq!(rows.len(), opencv.len(), "{name}");
        let (mut first, mut scores) = (0, 0);
        for cells in grids {
            for i in 0..3 * cells {
                let (row, theirs) = (&rows[first + i], &opencv[first + i % cells * 3 + i / cells]);
                let theirs: Vec<f64> = theirs.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
                let ours = [64.0, 96.0, 64.0, 96.0, 1.0]
                    .iter()
                    .zip(row)
                    .map(|(by, v)| f64::from(*v) / by);
                for (ours, theirs) in ours.zip(&theirs) {
                    assert!(
                        (ours - theirs).abs() < 1e-3 * theirs.abs().max(1.0),
                        "{name} {i}: {row:?} {theirs:?}"
                    );
                }
                for (label, theirs) in theirs[5..].iter().enumerate().filter(|(_, score)| **score > 0.0) {
                    scores += 1;
                    let ours = f64::from(row[4] * row[5 + label]);
                    assert!((ours - theirs).abs() < 1e-3, "{name} {i}: {row:?} {theirs:?}");
                }
            }
            first += 3 * cells;
        }
        assert!(scores > 10, "{name}: {scores} scores compared");
    }
}

#[test]
fn a_converted_network_is_one_of_darknet() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.onnx");
    std::fs::write(&path, converted("tiny_v4")).unwrap();
    let labels = ["a", "b", "c", "d"].map(String::from).to_vec();
    let hints = Hints {
        labels: Some(Labels::of_names(labels).unwrap()),
        ..Hints::default()
    };
    let proposal = propose(Runtime::load().unwrap(), &path, "small.onnx", "small", hints).unwrap();
    assert_eq!(proposal.family, Family::Darknet);
    for line in ["size_px = [64, 96]", "resize = \"stretch\"", "labels = \"all\""] {
        assert!(proposal.text.lines().any(|l| l == line), "{line}: {}", proposal.text);
    }
}

/// Darknet looks for a key from the front of a section.
#[test]
fn of_a_key_that_is_there_twice_the_first_counts() {
    let file = |ending: &str| home().join(FOLDER).join(format!("tiny_v4.{ending}"));
    let (cfg, weights) = (
        std::fs::read_to_string(file("cfg")).unwrap(),
        std::fs::read(file("weights")).unwrap(),
    );
    let twice = cfg.replacen("size=3\n", "size=3\nsize=5\n", 1);
    assert_ne!(twice, cfg);
    let network = darknet_contents_to_onnx(&twice, "twice.cfg", &weights, "tiny_v4.weights").unwrap();
    assert!(network == converted("tiny_v4"));
}

#[test]
fn what_is_not_read_is_named_with_its_line() {
    let read = |name: &str| {
        let path = home().join(FOLDER).join(name);
        (
            std::fs::read_to_string(path.with_extension("cfg")).unwrap(),
            std::fs::read(path.with_extension("weights")).unwrap(),
        )
    };
    let (cfg, weights) = read("fastest");
    let refused = |cfg: &str, weights: &[u8], words: &[&str]| {
        let error = darknet_contents_to_onnx(cfg, "x.cfg", weights, "x.weights")
            .unwrap_err()
            .to_string();
        for word in words {
            assert!(error.contains(word), "`{word}` is not in: {error}");
        }
    };
    refused(
        &cfg,
        &weights[..weights.len() - 8],
        &["x.weights", "2 numbers fewer than x.cfg", "another network"],
    );
    refused(&cfg, &[&weights[..], &[0; 4]].concat(), &["1 numbers more"]);
    refused(&cfg, &weights[..weights.len() - 1], &["ends within a number"]);
    refused(
        &cfg,
        b"PK\x03\x04 zip file",
        &["its version is", "is it Darknet's .weights?"],
    );
    refused(
        &cfg.replace("[dropout]", "[gru]"),
        &weights,
        &["x.cfg, line", "[gru] is not read here"],
    );
    refused(
        &cfg.replace("activation=relu\n", "activation=stair\n"),
        &weights,
        &["activation=stair"],
    );
    refused(&cfg.replace("from=-5", "from=-50"), &weights, &["names layer -50"]);
    refused(
        &cfg.replace("filters=27", "filters=28"),
        &weights,
        &["needs 27 channels"],
    );
    refused(
        &cfg.replace("stride=2", "stride=two"),
        &weights,
        &["stride=two", "give a number"],
    );
    refused(
        "import torch\n",
        &weights,
        &["line 1", "neither a [section] nor key=value"],
    );
    refused("", &weights, &["does not begin with [net]"]);
    refused(&cfg[..cfg.find("[yolo]").unwrap()], &weights, &["no [yolo]"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_configuration_and_no_weights_end_the_program(
        cfg in "(\\[net\\]\nwidth=64\nheight=64\n)?(\\[(convolutional|maxpool|route|shortcut|upsample|yolo|sam)\\]\n((filters|size|stride|layers|from|pad|groups|mask|anchors|classes)=-?[0-9]{1,20}(,[0-9]{1,3})?\n){0,5}){0,6}",
        weights in proptest::collection::vec(any::<u8>(), 0..200),
    ) {
        let _: Result<Vec<u8>, _> = darknet_contents_to_onnx(&cfg, "x.cfg", &weights, "x.weights");
    }
}

/// A configuration says how many numbers a layer has, and how many layers there are: the weights say how many there are.
#[test]
fn nothing_is_held_because_a_configuration_says_so() {
    let head = "[net]\nwidth=416\nheight=416\nchannels=3\n";
    let layer = |filters: usize, size: usize| {
        format!("[convolutional]\nfilters={filters}\nsize={size}\nstride=1\npad=1\nactivation=leaky\n")
    };
    let tail = "[yolo]\nmask=0\nanchors=10,14\nclasses=1\nnum=1\n";
    let weights = [&[0_u8; 16][..], &[0; 4000]].concat();
    let refusal = |cfg: &str| {
        darknet_contents_to_onnx(cfg, "x.cfg", &weights, "x.weights")
            .unwrap_err()
            .to_string()
    };
    // 490 and 816 MB, were they made; what is missing is counted all the same.
    let small = "[net]\nwidth=32\nheight=32\nchannels=3\n";
    let large = format!("{small}{}{}{}{tail}", layer(4000, 101), layer(5, 101), layer(6, 1));
    let missing = 4000 * (1 + 3 * 101 * 101) + 5 * (1 + 4000 * 101 * 101) + 6 * (1 + 5) - 1000;
    assert!(
        refusal(&large).contains(&format!("{missing} numbers fewer")),
        "{}",
        refusal(&large)
    );
    // 20,000 × 260 kB.
    let deep = format!("{head}{}{}{tail}", layer(255, 1).repeat(20_000), layer(6, 1));
    assert!(refusal(&deep).contains("numbers fewer"), "{}", refusal(&deep));
    let cells = format!("[net]\nwidth=8192\nheight=8192\nchannels=3\n{}{tail}", layer(2, 1));
    assert!(refusal(&cells).contains("8192 × 8192 cells"), "{}", refusal(&cells));
}
