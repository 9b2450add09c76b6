//! Manifests and networks of strangers: what they make the program write, what their numbers come to, and how long they hold it up.

use crate::common::onnx;

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Output as Ended;
use std::time::Duration;

use image::RgbImage;
use onnx::{Input, Output};
use scaleproof_core::files::sha256_hex;
use scaleproof_detect::{DetectError, Detection, Detector, Hints, Manifest, Runtime, propose};

use crate::common::{assert_refused, program, stderr};

const CONTENT: &[u8] = b"chosen by a stranger";

/// A line of the table `weights` as a stranger writes it, and words of the refusal. `FOLDER` is the test's own folder.
type Line = (&'static str, &'static [&'static str]);

#[rustfmt::skip]
const LINES: &[Line] = &[
    ("file = '../evil.onnx'", &["weights.file is \"../evil.onnx\"", ".onnx or .ort"]),
    ("file = '../../evil.onnx'", &["weights.file"]),
    ("file = 'weights/../../evil.onnx'", &["weights.file"]),
    ("file = './evil.onnx'", &["weights.file"]),
    ("file = 'evil.onnx/'", &["weights.file"]),
    ("file = 'FOLDER/evil.onnx'", &["weights.file"]),
    ("file = 'FOLDER/inner/../evil.onnx'", &["weights.file"]),
    ("file = '..\\evil.onnx'", &["weights.file"]),
    ("file = '.bashrc'", &["weights.file"]),
    ("file = '.evil.onnx'", &["weights.file"]),
    ("file = 'other.toml'", &["weights.file"]),
    ("file = 'evil.onnx.toml'", &["weights.file"]),
    ("file = 'evil'", &["weights.file"]),
    ("file = '.'", &["weights.file"]),
    ("file = '..'", &["weights.file"]),
    ("file = ''", &["weights.file is \"\""]),
    ("file = \"evil\\u0000.onnx\"", &["weights.file is \"evil\\0.onnx\""]),
    ("file = \"evil\\n.onnx\"", &["weights.file is \"evil\\n.onnx\""]),
    ("file = \"evil\\u001b[2J.onnx\"", &["weights.file is \"evil\\u{1b}[2J.onnx\""]),
    ("url = 'file:///etc/passwd'", &["weights.url is \"file:///etc/passwd\"", "https://"]),
    ("url = 'ftp://example.org/evil.onnx'", &["weights.url"]),
    ("url = '/etc/passwd'", &["weights.url"]),
    ("url = \"http://127.0.0.1/\\r\\nevil\"", &["weights.url"]),
    ("sha256 = ''", &["weights.sha256 is \"\"", "64 lower-case hex digits"]),
    ("sha256 = '00'", &["weights.sha256"]),
    ("sha256 = '../../evil'", &["weights.sha256"]),
    ("sha256 = 'C0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FFEEC0FF'", &["weights.sha256"]),
];

/// What lies in the folder of weights already, and words of the refusal.
type Place = (&'static str, fn(&Path), &'static [&'static str]);

#[rustfmt::skip]
const PLACES: &[Place] = &[
    ("another file", another_file, &["evil.onnx is already there", "move it away"]),
    ("a folder", a_folder, &["evil.onnx", "not a file"]),
    ("a link in the place of the part", a_link, &["evil.onnx.part is a link or a folder", "remove it"]),
    ("a folder in the place of the part", a_folder_as_part, &["evil.onnx.part is a link or a folder"]),
];

fn another_file(weights: &Path) {
    std::fs::write(weights.join("evil.onnx"), "mine").unwrap();
}

fn a_folder(weights: &Path) {
    std::fs::create_dir(weights.join("evil.onnx")).unwrap();
}

fn a_folder_as_part(weights: &Path) {
    std::fs::create_dir(weights.join("evil.onnx.part")).unwrap();
}

fn a_link(weights: &Path) {
    std::fs::write(weights.join("../mine.txt"), "mine").unwrap();
    std::os::unix::fs::symlink("../mine.txt", weights.join("evil.onnx.part")).unwrap();
}

/// A server on this machine that answers every request with the same content, until the test program ends.
fn serve() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/evil.onnx", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let lines = BufReader::new(stream.try_clone().unwrap()).lines();
            lines.map_while(Result::ok).take_while(|l| !l.is_empty()).for_each(drop);
            let head = format!(
                "HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
                CONTENT.len()
            );
            let _ = stream
                .write_all(head.as_bytes())
                .and_then(|()| stream.write_all(CONTENT));
        }
    });
    url
}

const REST: &str = "[input]\nsize_px = [64, 64]\nresize = \"stretch\"\nkernel = \"opencv_linear\"\nchannels = \"rgb\"\n\
                    mean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\n";

/// A manifest of a detector with one label.
fn manifest(weights: &str, head: &str) -> String {
    format!(
        "name = \"made\"\ntitle = \"Made\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = [\"car\"]\n[weights]\n{weights}\n{REST}{head}\n"
    )
}

/// A folder with a manifest and an empty folder of weights inside another: what leaves the inner two is seen in the outer.
struct Stage {
    folder: tempfile::TempDir,
}

impl Stage {
    /// The line replaces the manifest's own of that key.
    fn new(url: &str, line: &str) -> Stage {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("inner/weights")).unwrap();
        let line = line.replace("FOLDER", folder.path().to_str().unwrap());
        let own = [
            "file = 'evil.onnx'".to_owned(),
            format!("url = '{url}'"),
            format!("sha256 = '{}'", sha256_hex(CONTENT)),
        ];
        let key = |line: &str| line.split(' ').next().unwrap_or_default().to_owned();
        let lines = own.map(|own| if key(&own) == key(&line) { line.clone() } else { own });
        let text = manifest(&lines.join("\n"), "kind = \"yolov10\"");
        std::fs::write(folder.path().join("inner/evil.toml"), text).unwrap();
        Stage { folder }
    }

    fn weights(&self) -> PathBuf {
        self.folder.path().join("inner/weights")
    }

    fn fetch(&self) -> Ended {
        let mut command = program();
        for name in ["HTTP_PROXY", "http_proxy", "ALL_PROXY", "all_proxy"] {
            command.env_remove(name);
        }
        command
            .args(["detectors", "fetch"])
            .arg(self.folder.path().join("inner/evil.toml"))
            .arg("--detectors")
            .arg(self.weights())
            .output()
            .unwrap()
    }

    /// Everything in the outer folder: files with their content, links with what they name, folders.
    fn tree(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut tree = BTreeMap::new();
        let mut waiting = vec![self.folder.path().to_owned()];
        while let Some(path) = waiting.pop() {
            let about = std::fs::symlink_metadata(&path).unwrap();
            let content = if about.is_symlink() {
                std::fs::read_link(&path).unwrap().into_os_string().into_encoded_bytes()
            } else if about.is_dir() {
                waiting.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
                Vec::new()
            } else {
                std::fs::read(&path).unwrap()
            };
            tree.insert(path, content);
        }
        tree
    }
}

#[test]
fn a_manifest_cannot_say_where_a_download_is_written() {
    let url = serve();
    for (line, words) in LINES {
        let stage = Stage::new(&url, line);
        let before = stage.tree();
        let output = stage.fetch();
        println!("{line}: {}", stderr(&output).trim_end());
        assert_refused(&output, &[&["evil.toml is not valid"][..], *words].concat());
        assert_eq!(stage.tree(), before, "{line}");
    }
    // The same manifest without such a line is fetched, and into the folder of weights.
    let stage = Stage::new(&url, "");
    let mut expected = stage.tree();
    let output = stage.fetch();
    assert!(output.status.success(), "{}", stderr(&output));
    expected.insert(stage.weights().join("evil.onnx"), CONTENT.to_vec());
    assert_eq!(stage.tree(), expected);
}

#[test]
fn a_download_replaces_nothing_that_is_there() {
    let url = serve();
    for (place, prepare, words) in PLACES {
        let stage = Stage::new(&url, "");
        prepare(&stage.weights());
        let before = stage.tree();
        assert_refused(&stage.fetch(), words);
        assert_eq!(stage.tree(), before, "{place}");
    }
}

fn picture() -> Input {
    Input::floats("images", &[1, 3, 64, 64])
}

/// A detector made of a network and a head, on a black image of the network's size.
fn answered(network: &[u8], head: &str, time_limit: Option<Duration>) -> Result<Vec<Detection>, DetectError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.onnx");
    std::fs::write(&path, network).unwrap();
    let weights = format!("file = 'made.onnx'\nsha256 = '{}'", sha256_hex(network));
    let manifest = Manifest::parse(&manifest(&weights, head), "made.toml").unwrap();
    let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &path).unwrap();
    if let Some(limit) = time_limit {
        detector.time_limit = limit;
    }
    detector.detect(&RgbImage::new(64, 64))
}

const NONE: f32 = f32::NEG_INFINITY;

fn one(shape: &[usize], data: &[f32]) -> Vec<Output> {
    vec![Output::floats("output0", shape, data.to_vec())]
}

/// Boxes, labels and scores of a network that lists them.
fn listed(boxes: [f32; 4], score: f32) -> Vec<Output> {
    vec![
        Output::floats("boxes", &[1, 4], boxes.to_vec()),
        Output::whole("labels", &[1], &[0]),
        Output::floats("scores", &[1], vec![score]),
    ]
}

/// The first cell of a YOLOX network, whose sizes are logarithms.
fn yolox(first: [f32; 6]) -> Vec<Output> {
    // 64 + 16 + 4 cells at strides 8, 16 and 32.
    let mut data = vec![0.0; 84 * 6];
    data[..6].copy_from_slice(&first);
    one(&[1, 84, 6], &data)
}

/// The first cell of a NanoDet-Plus network with one stride: its score, and the same logit for every bin of its sides.
fn nanodet_plus(score: f32, logit: f32) -> Vec<Output> {
    let mut data = vec![0.0; 4 * 33];
    data[..33].fill(logit);
    data[0] = score;
    one(&[1, 4, 33], &data)
}

/// A head, what a network answers, and words of the refusal.
type Numbers = (&'static str, Vec<Output>, &'static [&'static str]);

#[rustfmt::skip]
fn refused_numbers() -> Vec<Numbers> {
    let named: &[&str] = &["made answered with a box that is not finite", "in its output output0"];
    vec![
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[8.0, 8.0, NONE, 56.0, 0.9, 0.0]), named),
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[NONE, NONE, NONE, NONE, 0.002, 0.0]), named),
        ("kind = \"yolov8\"\nnms_iou = 0.7", one(&[1, 5, 1], &[32.0, 32.0, NONE, 9.0, 0.9]), named),
        ("kind = \"yolov5\"\nnms_iou = 0.45", one(&[1, 1, 6], &[NONE, 32.0, 9.0, 9.0, 0.9, 0.9]), named),
        ("kind = \"rtdetr\"", one(&[1, 1, 5], &[0.5, 0.5, NONE, 0.1, 0.9]), named),
        // e^1000 is beyond every number.
        ("kind = \"yolox\"\nnms_iou = 0.45", yolox([0.0, 0.0, 1000.0, 1.0, 0.9, 0.9]), named),
        ("kind = \"yolox\"\nnms_iou = 0.45", yolox([0.0, NONE, 1.0, 1.0, 0.9, 0.9]), named),
        ("kind = \"nanodet_plus\"\nstrides = [32]\nnms_iou = 0.6", nanodet_plus(0.9, NONE), named),
        ("kind = \"rcnn\"\nfirst_label = 0", listed([8.0, 8.0, NONE, 56.0], 0.9), &["made answered with a box that is not finite", "-inf"]),
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[8.0, 8.0, f32::INFINITY, 56.0, 0.9, 0.0]), &["infinity in its output output0"]),
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[8.0, 8.0, f32::NAN, 56.0, 0.9, 0.0]), &["NaN in its output output0"]),
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[8.0, 8.0, 56.0, 56.0, 1.1, 0.0]), &["the score 1.1", "sigmoid"]),
    ]
}

#[test]
fn numbers_that_are_none_make_an_answer_untrusted() {
    for (head, outputs, words) in refused_numbers() {
        let error = answered(&onnx::network(&[picture()], &outputs), head, None).unwrap_err();
        let text = error.to_string();
        println!("{head}: {text}");
        for word in words {
            assert!(text.contains(word), "{head}: `{word}` is not in: {text}");
        }
    }
}

/// A head, what a network answers, and the scores that are found.
#[rustfmt::skip]
fn accepted_numbers() -> Vec<(&'static str, Vec<Output>, &'static [f64])> {
    let logits = vec![
        Output::floats("dets", &[1, 2, 4], [0.5, 0.5, 0.2, 0.2].repeat(2)),
        Output::floats("labels", &[1, 2, 1], vec![2.0, NONE]),
    ];
    vec![
        // A logit of minus infinity is a score of 0, and σ(2) = 0.880797.
        ("kind = \"rfdetr\"", logits, &[0.880797]),
        ("kind = \"nanodet_plus\"\nstrides = [32]\nnms_iou = 0.6", nanodet_plus(0.9, -3.0), &[0.9]),
        // Rows of padding may have anything in their boxes.
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[NONE, NONE, NONE, NONE, 0.0, 0.0]), &[]),
        ("kind = \"rcnn\"\nfirst_label = 0", listed([NONE; 4], 0.0), &[]),
        // A sigmoid that rounds up.
        ("kind = \"yolov10\"", one(&[1, 1, 6], &[8.0, 8.0, 56.0, 56.0, 1.0005, 0.0]), &[1.0]),
    ]
}

#[test]
fn minus_infinity_where_it_means_never_is_a_number_like_any_other() {
    for (head, outputs, expected) in accepted_numbers() {
        let found = answered(&onnx::network(&[picture()], &outputs), head, None).unwrap();
        let scores: Vec<f64> = found.iter().map(|d| d.score).collect();
        assert_eq!(&scores[..], expected, "{head}");
    }
}

/// So many boxes that lie apart, in the rows of YOLOv8: centre, size, score.
fn apart(from_x: f32) -> Vec<Output> {
    const COUNT: usize = 300_000;
    let mut data = vec![0.0; 5 * COUNT];
    for i in 0..COUNT {
        let cell = [(i % 600) as f32 * 64.0 / 600.0, (i / 600) as f32 * 64.0 / 500.0];
        let row = [from_x + cell[0] + 0.04, cell[1] + 0.04, 0.05, 0.05, 0.5];
        (0..5).for_each(|k| data[k * COUNT + i] = row[k]);
    }
    one(&[1, 5, COUNT], &data)
}

#[test]
fn hundreds_of_thousands_of_boxes_are_searched_to_their_end() {
    // Inside the photo the best hundred are enough; outside it none counts, and the search must end all the same.
    for (from_x, count) in [(0.0, 100), (1000.0, 0)] {
        let network = onnx::network(&[picture()], &apart(from_x));
        let found = answered(&network, "kind = \"yolov8\"\nnms_iou = 0.7", None).unwrap();
        assert_eq!(found.len(), count, "from x = {from_x}");
    }
}

const YOLOV10: &str = "kind = \"yolov10\"";

/// A network with a loop of so many turns.
fn turning(turns: i64) -> Vec<u8> {
    let answer = Output::floats("output0", &[1, 1, 6], vec![8.0, 8.0, 56.0, 56.0, 0.9, 0.0]);
    onnx::loop_network(&picture(), &answer, turns)
}

#[test]
fn a_network_that_never_answers_is_stopped() {
    let second = Duration::from_secs(1);
    // Networks with loops are fine, and a limit that is far away holds nothing up.
    for limit in [None, Some(Duration::from_secs(3600))] {
        assert_eq!(answered(&turning(4), YOLOV10, limit).unwrap().len(), 1);
    }
    let endless = turning(i64::MAX);
    let error = answered(&endless, YOLOV10, Some(second)).unwrap_err();
    assert!(matches!(error, DetectError::TooLong(_)), "{error}");
    let text = error.to_string();
    assert!(
        text.contains("made has not answered within 1 s") && !text.contains('\n'),
        "{text}"
    );
    // The trial runs of `detectors add`, too.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("endless.onnx");
    std::fs::write(&path, endless).unwrap();
    let runtime = Runtime::load().unwrap();
    let hints = Hints {
        time_limit: Some(second),
        ..Hints::default()
    };
    let proposed = propose(runtime, &path, "endless.onnx", "endless", hints);
    let text = proposed.unwrap_err().to_string();
    assert!(text.contains("endless.onnx has not answered within 1 s"), "{text}");
}

/// 239 bytes of a configuration ask for 1.6 GB of numbers.
#[test]
fn a_configuration_takes_no_memory_that_its_weights_do_not_fill() {
    let cases = crate::common::home().join("tests/data/cases/hold2");
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command
        .args(["detectors", "add"])
        .args([cases.join("large_filters.cfg"), cases.join("ones.weights")])
        .arg("-o")
        .arg(out.path().join("x.toml"));
    let ended = crate::hostile::bounded::run(&mut command);
    assert_refused(&ended.output, &["large_filters.cfg", "is it a Darknet configuration?"]);
    assert!(ended.memory < 400 << 20, "{} MB", ended.memory >> 20);
    assert_eq!(std::fs::read_dir(out.path()).unwrap().count(), 0);
}

/// A network whose text ONNX Runtime would log.
#[test]
fn what_a_network_says_of_itself_reaches_the_terminal_in_one_sentence_without_escapes() {
    let network = crate::common::home().join("tests/data/cases/hold2/ort_log_escape.onnx");
    let out = tempfile::tempdir().unwrap();
    for more in [
        &[][..],
        &["--labels", "coco80"],
        &["--labels", "coco80", "--family", "yolov8"],
    ] {
        let mut command = program();
        command.args(["detectors", "add"]).arg(&network).args(more);
        command.arg("-o").arg(out.path().join("x.toml"));
        let output = command.output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        assert!(
            !said.iter().any(|byte| byte.is_ascii_control() && !b"\n".contains(byte)),
            "{}",
            String::from_utf8_lossy(&said).escape_debug()
        );
        let said = String::from_utf8_lossy(&said);
        assert!(
            said.lines().filter(|line| line.starts_with("error: ")).count() <= 1,
            "{said}"
        );
    }
}
