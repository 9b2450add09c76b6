//! Large runs: results kept and taken up again, shards merged, photos decoded reduced. The detector is a network made here.

use crate::common;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use common::kills::{send, stop_at};
use common::{assert_refused, program, read_json, shared, skyline, stderr};
use image::imageops::{self, FilterType};
use scaleproof_detect::{Detection, Detector, Kernel, Manifest, Runtime, WeightFolders};
use scaleproof_photo::Photo;
use scaleproof_score as score;
use scaleproof_score::{Cache, EvaluatedDetector, Options, Scores};
use scaleproof_session::Session;

use crate::common::onnx;

/// Six photos of the stored session, one of them cut short, and one without tags; and a detector that answers with one car.
struct Set {
    folder: tempfile::TempDir,
}

impl Set {
    fn new() -> Set {
        let set = Set {
            folder: tempfile::tempdir().unwrap(),
        };
        let names = [
            "normal_000",
            "normal_001",
            "normal_002",
            "random_008",
            "random_009",
            "random_010",
        ];
        let mut photos = Vec::new();
        for name in names {
            let bytes = std::fs::read(skyline().join(format!("{name}.jpg"))).unwrap();
            let kept = if name == "random_009" {
                bytes.len() / 2
            } else {
                bytes.len()
            };
            std::fs::write(set.path(&format!("{name}.jpg")), &bytes[..kept]).unwrap();
            photos.push(serde_json::json!({"file": format!("{name}.jpg"), "variant": &name[..6], "place": "yard"}));
        }
        image::RgbImage::from_pixel(1280, 960, image::Rgb([90; 3]))
            .save(set.path("blank.jpg"))
            .unwrap();
        photos.push(serde_json::json!({"file": "blank.jpg", "variant": "normal"}));
        let session = serde_json::json!({"scene": "scene.toml", "camera": "camera.yaml", "photos": photos});
        std::fs::write(set.path("session.json"), session.to_string()).unwrap();
        for name in ["scene.toml", "camera.yaml"] {
            std::fs::copy(skyline().join(name), set.path(name)).unwrap();
        }
        set.write_detector();
        set
    }

    /// A network that finds a car in the middle, whatever it is shown.
    fn write_detector(&self) {
        let mut answer = vec![0.0_f32; 3549 * 85];
        let row = &mut answer[(13 * 52 + 26) * 85..][..85];
        row[..5].copy_from_slice(&[0.0, 4.0, 14.0_f32.ln(), 6.0_f32.ln(), 0.9]);
        row[5 + 2] = 0.8;
        let network = onnx::network(
            &[onnx::Input::floats("images", &[1, 3, 416, 416])],
            &[onnx::Output::floats("output", &[1, 3549, 85], answer)],
        );
        std::fs::write(self.path("mine.onnx"), &network).unwrap();
        let built_in =
            std::fs::read_to_string(common::home().join("crates/detect/src/manifests/yolox_nano.toml")).unwrap();
        let mine = built_in
            .replace("\"yolox_nano\"", "\"mine\"")
            .replace("yolox_nano.onnx", "mine.onnx")
            .replace(
                "695e750a5d5754bb5a8d5325643b59282191a7e7a564e435a415fd3c578eab14",
                &scaleproof_core::files::sha256_hex(&network),
            );
        std::fs::write(self.path("mine.toml"), mine).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = program();
        command.arg("score").arg(self.folder.path()).arg("--detector");
        command.arg(self.path("mine.toml")).arg("--out").arg(self.path(out));
        command
            .args(["--cache".as_ref(), self.path("cache").as_os_str()])
            .args(more);
        command
    }

    fn score(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    /// Scores and returns every output file by its name.
    fn outputs(&self, out: &str, more: &[&str]) -> BTreeMap<String, Vec<u8>> {
        let output = self.score(out, more);
        assert!(output.status.success(), "{}", stderr(&output));
        contents(&self.path(out))
    }

    fn cache_entries(&self) -> Vec<PathBuf> {
        let Ok(folders) = std::fs::read_dir(self.path("cache")) else {
            return Vec::new();
        };
        folders
            .flat_map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap())
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_none())
            .collect()
    }
}

fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    entries
        .map(|path| {
            (
                path.file_name().unwrap().to_string_lossy().into(),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect()
}

/// Fails with the name of the file that differs, not with its bytes.
fn assert_same(a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>) {
    assert!(a.keys().eq(b.keys()), "{:?} and {:?}", a.keys(), b.keys());
    for (name, bytes) in a {
        assert!(bytes == &b[name], "{name} differs");
    }
}

#[test]
fn a_kept_result_needs_no_detector() {
    let set = Set::new();
    let manifest = Manifest::open(&set.path("mine.toml")).unwrap();
    let live = EvaluatedDetector::live(manifest.clone(), &WeightFolders::new(None), &"car".parse().unwrap()).unwrap();
    let without_weights = || EvaluatedDetector::ran_elsewhere(manifest.clone(), &"car".parse().unwrap()).unwrap();
    let run = |detector: EvaluatedDetector, cache: &str| -> Result<Scores, score::ScoreError> {
        let options = Options {
            cache: Some(Cache::open(&set.path(cache), "").unwrap()),
            ..Options::default()
        };
        let session = Session::open(set.folder.path()).unwrap();
        score::score(vec![session], vec![detector], &options, || {})
    };
    let error = run(without_weights(), "empty").unwrap_err().to_string();
    assert!(error.contains("mine.onnx is not a model"), "{error}");
    let (first, again) = (run(live, "cache").unwrap(), run(without_weights(), "cache").unwrap());
    assert_eq!(first.photos.len(), 5);
    for (a, b) in first.photos.iter().zip(&again.photos) {
        assert!(a.detections == b.detections && a.detections[0].len() == 1, "{}", a.file);
        assert!(a.viewpoint == b.viewpoint && a.truth == b.truth && a.preview_jpeg == b.preview_jpeg);
    }
}

#[test]
fn threads_and_kept_results_change_no_byte() {
    let set = Set::new();
    let first = set.outputs("first", &["--threads", "1"]);
    let entries = set.cache_entries().len();
    // Tags of six photos (one of them has none); detections, a preview and a perceptual hash of five.
    assert_eq!(entries, 21);
    assert_same(&first, &set.outputs("again", &["--threads", "3"]));
    assert_eq!(set.cache_entries().len(), entries);
    std::fs::remove_dir_all(set.path("cache")).unwrap();
    assert_same(&first, &set.outputs("anew", &["--threads", "3"]));
    assert_refused(&set.score("no", &["--threads", "0"]), &["--threads"]);
    std::fs::write(set.path("file"), b"").unwrap();
    let file = set.path("file").display().to_string();
    let output = program()
        .arg("score")
        .arg(set.folder.path())
        .args(["--out", &format!("{file}-out"), "--cache", &file, "--detector"])
        .arg(set.path("mine.toml"))
        .output();
    assert_refused(&output.unwrap(), &["cannot write", "is a file"]);
}

#[test]
fn damaged_entries_are_reported_and_computed_again() {
    let set = Set::new();
    let first = set.outputs("first", &[]);
    for (i, path) in set.cache_entries().iter().enumerate() {
        let mut bytes = std::fs::read(path).unwrap();
        match i % 3 {
            0 => bytes.truncate(bytes.len() / 2),
            1 => bytes.clear(),
            _ => *bytes.last_mut().unwrap() ^= 1,
        }
        std::fs::write(path, bytes).unwrap();
    }
    let output = set.score("again", &[]);
    assert!(output.status.success());
    let said: Vec<_> = stderr(&output)
        .lines()
        .filter(|l| l.contains("cache"))
        .map(str::to_owned)
        .collect();
    assert!(
        said.len() == 1 && said[0].starts_with("note: 21 damaged entries of the cache"),
        "{said:?}"
    );
    assert_same(&first, &contents(&set.path("again")));
    let output = set.score("third", &[]);
    assert!(!stderr(&output).contains("cache"), "mended: {}", stderr(&output));
}

#[test]
fn an_interrupted_run_is_taken_up_again() {
    let set = Set::new();
    let whole = set.outputs("whole", &[]);
    interrupt(&set);
    let kept = set.cache_entries();
    assert!(
        (3..21).contains(&kept.len()) && !set.path("out").exists(),
        "{}",
        kept.len()
    );
    let written = |path: &PathBuf| std::fs::metadata(path).unwrap().modified().unwrap();
    let before: Vec<_> = kept.iter().map(written).collect();
    assert_same(&whole, &set.outputs("out", &[]));
    assert_eq!(
        kept.iter().map(written).collect::<Vec<_>>(),
        before,
        "nothing was done twice"
    );
}

/// Starts a run without anything kept, and interrupts it after three photos.
fn interrupt(set: &Set) {
    std::fs::remove_dir_all(set.path("cache")).unwrap();
    let _ = std::fs::remove_dir_all(set.path("out"));
    let (mut command, folder) = (set.command("out", &["--threads", "1"]), tempfile::tempdir().unwrap());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = stop_at(&mut command, folder.path(), 4);
    // Ends it as Ctrl-C does; that signal itself is ignored by whatever a shell started in the background.
    send(&["-TERM", "-CONT"], &child);
    assert!(!child.wait().unwrap().success());
}

fn merge(set: &Set, shards: &[&str], out: &str) -> Output {
    let mut command = program();
    command.arg("merge").args(shards.iter().map(|s| set.path(s)));
    command.arg("-o").arg(set.path(out)).output().unwrap()
}

#[test]
fn three_shards_merged_are_one_run_byte_for_byte() {
    let set = Set::new();
    let whole = set.outputs("whole", &[]);
    for shard in ["1/3", "2/3", "3/3"] {
        let output = set.score("parts", &["--shard", shard]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let names = [1, 2, 3].map(|i| format!("parts/shard_{i}_of_3.scaleproof"));
    assert_eq!(contents(&set.path("parts")).len(), 3, "no report of a part");
    let [one, two, three] = names.each_ref().map(String::as_str);
    let output = merge(&set, &[three, one, two], "merged");
    assert!(output.status.success(), "{}", stderr(&output));
    assert_same(&whole, &contents(&set.path("merged")));
    assert!(
        stderr(&output).contains("random_009.jpg ends in the middle"),
        "{}",
        stderr(&output)
    );

    let refused = |shards: &[&str], words: &[&str]| {
        assert_refused(&merge(&set, shards, "no"), words);
        assert!(!set.path("no").exists());
    };
    refused(&[one, three], &["2 of 3 shards are here", "missing: 2"]);
    refused(&[one, two, one], &["are the same shard"]);
    refused(&["mine.toml"], &["mine.toml is not a shard"]);
    // Of a run with another number of shards.
    assert!(set.score("other", &["--shard", "1/2"]).status.success());
    refused(
        &[one, "other/shard_1_of_2.scaleproof"],
        &["different runs", "numbers of shards"],
    );
    // Damaged, and of another version.
    let bytes = std::fs::read(set.path(two)).unwrap();
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 2] ^= 1;
    std::fs::write(set.path("damaged"), damaged).unwrap();
    refused(&[one, "damaged", three], &["damaged is damaged"]);
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    let at = bytes.windows(version.len()).position(|w| w == version).unwrap();
    let mut older = bytes;
    older[at] = b'9';
    std::fs::write(set.path("older"), older).unwrap();
    refused(&[one, "older", three], &["written by scaleproof 9"]);
    // What is merged must be what was scored.
    let scene = std::fs::read_to_string(set.path("scene.toml")).unwrap();
    std::fs::write(set.path("scene.toml"), format!("{scene}\n# moved a card\n")).unwrap();
    refused(&[one, two, three], &["has changed since the shards were scored"]);
    std::fs::write(set.path("scene.toml"), scene).unwrap();
    let manifest = std::fs::read_to_string(set.path("mine.toml")).unwrap();
    std::fs::write(
        set.path("mine.toml"),
        manifest.replace("nms_iou = 0.45", "nms_iou = 0.5"),
    )
    .unwrap();
    refused(&[one, two, three], &["a manifest or a recording has changed"]);
}

#[test]
fn a_shard_is_found_in_the_environment_only_when_asked() {
    let set = Set::new();
    let slurm = [("ID", "4"), ("MIN", "3"), ("MAX", "5"), ("COUNT", "3")];
    let mut command = set.command("parts", &["--shard", "slurm"]);
    command.envs(slurm.map(|(name, value)| (format!("SLURM_ARRAY_TASK_{name}"), value)));
    assert!(command.output().unwrap().status.success());
    assert!(set.path("parts/shard_2_of_3.scaleproof").exists());
    let mut command = set.command("parts", &["--shard", "k8s/3"]);
    assert!(
        command
            .env("JOB_COMPLETION_INDEX", "2")
            .output()
            .unwrap()
            .status
            .success()
    );
    assert!(set.path("parts/shard_3_of_3.scaleproof").exists());
    let mut command = set.command("whole", &[]);
    assert!(
        command
            .env("JOB_COMPLETION_INDEX", "2")
            .output()
            .unwrap()
            .status
            .success()
    );
    assert!(
        set.path("whole/report.html").exists(),
        "a report, as nobody asked for a shard"
    );
    for (shard, word) in [
        ("4/3", "4/3"),
        ("two", "two"),
        ("slurm", "SLURM_ARRAY_TASK_MIN is not set"),
    ] {
        assert_refused(&set.score("no", &["--shard", shard]), &[word]);
    }
    let mut cleared = set.command("no", &["--shard", "k8s/3"]);
    let output = cleared.env("JOB_COMPLETION_INDEX", "").output().unwrap();
    assert_refused(&output, &["JOB_COMPLETION_INDEX is not set"]);
}

/// A photo of the stored session enlarged to 12 megapixels.
fn enlarged(name: &str, folder: &Path) -> PathBuf {
    let photo = image::open(skyline().join(name)).unwrap().into_rgb8();
    let large = imageops::resize(&photo, 4000, 3000, FilterType::CatmullRom);
    let path = folder.join(name);
    let mut file = std::fs::File::create(&path).unwrap();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 92)
        .encode_image(&large)
        .unwrap();
    path
}

/// What a detector says of a 12-megapixel photo decoded reduced, against the photo decoded whole.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn a_reduced_photo_is_detected_as_the_whole_one() {
    let weights = shared("detectors");
    let folder = tempfile::tempdir().unwrap();
    let (mut worst_score, mut worst_px) = (0.0_f64, 0.0_f64);
    for name in ["normal_000.jpg", "random_011.jpg"] {
        let file = Photo::open(&enlarged(name, folder.path())).unwrap();
        let whole = file.rgb(1).unwrap();
        for manifest in Manifest::all().unwrap() {
            let path = weights.join(&manifest.weights.file);
            let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &path).unwrap();
            let reduction = file.reduction(manifest.least_px(file.width, file.height));
            // Only a kernel that averages may see a reduced photo.
            let averages = manifest.input.kernel == Kernel::Antialiased;
            assert_eq!(reduction >= 2, averages, "{}", manifest.name);
            let reduced = file.rgb(reduction).unwrap();
            let best = &detector.detect(&whole).unwrap()[0];
            let found = detector.detect_reduced(&reduced, file.width, file.height).unwrap();
            let same = |d: &&Detection| d.label == best.label && d.box_px.iou(&best.box_px) > 0.5;
            let again = found.iter().find(same).expect("what was best is still found");
            // In pixels of the stored photo, of which these are 3.125.
            let corners = |d: &Detection| <[f64; 4]>::from(d.box_px).map(|v| v / 3.125);
            let distances = corners(best)
                .into_iter()
                .zip(corners(again))
                .map(|(a, b)| (a - b).abs());
            let off_px = distances.fold(0.0, f64::max);
            let (a, b) = (best.score, again.score);
            println!(
                "{:<14} {name} at 1/{reduction}: {a:.3} → {b:.3}, {off_px:.2} px",
                manifest.name
            );
            worst_score = worst_score.max((a - b).abs());
            worst_px = worst_px.max(off_px);
        }
    }
    println!("reduced against whole: scores within {worst_score:.3}, boxes within {worst_px:.2} px of 1280");
    assert!(worst_score < 0.1 && worst_px < 10.0);
}

/// What is noticed at full size is noticed at every size.
#[test]
fn damage_is_noticed_at_every_size() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    let mut random = 1_u64;
    let mut next = || {
        random = random
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (random >> 33) as usize
    };
    let path = folder.path().join("damaged.jpg");
    let mut refused = [0; 3];
    for _ in 0..60 {
        let mut copy = bytes.clone();
        for _ in 0..20 {
            let at = 700 + next() % (copy.len() - 702);
            copy[at] = next() as u8;
        }
        std::fs::write(&path, copy).unwrap();
        let Ok(file) = Photo::open(&path) else {
            refused.iter_mut().for_each(|count| *count += 1);
            continue;
        };
        refused[0] += u32::from(file.rgb(1).is_err());
        refused[1] += u32::from(file.rgb(4).is_err());
        refused[2] += u32::from(file.luma().is_err());
    }
    println!(
        "of 60 damaged photos, refused whole {}, at a quarter {}, as brightness {}",
        refused[0], refused[1], refused[2]
    );
    assert!(
        refused.iter().all(|count| *count >= 54 && *count == refused[0]),
        "{refused:?}"
    );
}

#[test]
fn a_large_photo_that_is_cut_or_turned_is_still_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = enlarged("normal_000.jpg", folder.path());
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = Photo::open(&path).unwrap_err().to_string();
    assert!(error.contains("ends in the middle"), "{error}");
    // Turned by EXIF: every size is upright.
    let exif: &[u8] = b"\xFF\xE1\x00\x22Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    std::fs::write(&path, [&bytes[..2], exif, &bytes[2..]].concat()).unwrap();
    let file = Photo::open(&path).unwrap();
    assert_eq!((file.width, file.height, file.turned_deg), (3000, 4000, 90));
    assert_eq!(file.luma().unwrap().dimensions(), (3000, 4000));
    let (whole, small) = (file.rgb(1).unwrap(), file.rgb(4).unwrap());
    assert_eq!(small.dimensions(), (750, 1000));
    let shrunk = imageops::thumbnail(&whole, 750, 1000);
    let difference: u64 = small
        .as_raw()
        .iter()
        .zip(shrunk.as_raw())
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    assert!(
        difference < 3 * small.as_raw().len() as u64,
        "mean {}",
        difference as f64 / small.as_raw().len() as f64
    );
}

#[test]
fn of_many_photos_a_thousand_are_kept_as_pictures_and_the_worst_shown() {
    let set = Set::new();
    let mut session = read_json(&set.path("session.json"));
    let bytes = std::fs::read(set.path("normal_000.jpg")).unwrap();
    let small = image::load_from_memory(&bytes).unwrap().thumbnail(64, 48).into_rgb8();
    small.save(set.path("small.png")).unwrap();
    let photos: Vec<_> = (0..1200)
        .map(|i| {
            let file = format!("{i}.png");
            std::fs::hard_link(set.path("small.png"), set.path(&file)).unwrap();
            let viewpoint = serde_json::json!({"azimuth_deg": f64::from(i % 360), "pitch_deg": f64::from(10 + 5 * (i / 360)), "distance_mm": 900.0});
            serde_json::json!({"file": file, "variant": "normal", "box_xyxy_px": [5, 5, 60, 40], "viewpoint": viewpoint})
        })
        .collect();
    session["photos"] = photos.into();
    std::fs::write(set.path("session.json"), session.to_string()).unwrap();
    let outputs = set.outputs("out", &[]);
    let page = String::from_utf8(outputs["report.html"].clone()).unwrap();
    let shown =
        "Shown are the 400 of 1200 photos that the most detectors missed, among 1000 that the run kept previews of";
    assert!(page.contains(shown));
    assert_eq!(page.matches("data:image/jpeg").count(), 400);
    assert_eq!(read_json(&set.path("out/summary.json"))["photos_scored"], 1200);
}
