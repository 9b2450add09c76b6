//! `advise`: what it advises without the truth, held against the best choice with it; abstention where a session cannot tell; and `score --settings`.

use std::path::Path;
use std::process::Output;

use crate::tests::common;

use common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr, stdout};
use image::{GrayImage, Luma};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof::advise::{Choice, PoseAdvice, Question, Sample, advise_poses};
use scaleproof::camera::Camera;
use scaleproof::chart::{Spoil, locate::is_silently_wrong, true_views};
use scaleproof::photo::Photo;
use scaleproof::scene::{Scene, Viewpoint};
use scaleproof::session::Session;
use serde_json::Value;

/// A session whose truth is known.
struct Known {
    name: &'static str,
    samples: Vec<Sample>,
    truths: Vec<Viewpoint>,
    scene: Scene,
    camera: Camera,
}

/// Photos of each session: enough to tell, in a minute.
const PHOTOS: usize = 10;

/// The stored photos.
fn stored() -> Known {
    let session = Session::open(&skyline()).unwrap();
    let files: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_views(&skyline().join("truth.json"), &files).unwrap();
    let sample = |file: &&str| {
        let photo = Photo::open(&skyline().join(file)).unwrap();
        Sample {
            file: (*file).to_owned(),
            luma: photo.luma().unwrap(),
            turned_deg: 0,
        }
    };
    Known {
        name: "as stored",
        samples: files.iter().take(PHOTOS).map(sample).collect(),
        truths: truths[..PHOTOS].to_vec(),
        scene: session.scene.clone(),
        camera: session.camera.clone().unwrap(),
    }
}

impl Known {
    fn with(&self, name: &'static str, change: impl Fn(&GrayImage) -> GrayImage) -> Known {
        let samples = self.samples.iter().map(|sample| Sample {
            luma: change(&sample.luma),
            ..sample.clone()
        });
        Known {
            name,
            samples: samples.collect(),
            truths: self.truths.clone(),
            scene: self.scene.clone(),
            camera: self.camera.clone(),
        }
    }

    fn spoiled(&self, name: &'static str, by: &[(Spoil, f64)]) -> Known {
        self.with(name, |luma| {
            let mut rng = Pcg64Mcg::seed_from_u64(4);
            by.iter().fold(luma.clone(), |luma, (spoil, amount)| {
                spoil.apply(&luma, *amount, &[], &mut rng)
            })
        })
    }

    /// As a lens of other distortion would have taken the photos.
    fn through(&self, name: &'static str, distortion: &[f64]) -> Known {
        let camera = self.camera.clone().with_distortion(distortion);
        let bent = self.with(name, |luma| {
            GrayImage::from_fn(luma.width(), luma.height(), |x, y| {
                let ray = camera.point_at([f64::from(x), f64::from(y)]);
                let at = ray.and_then(|[u, v]| self.camera.project(&nalgebra::Point3::new(u, v, 1.0)));
                Luma([at.map_or(128, |at| sampled(luma, at))])
            })
        });
        Known { camera, ..bent }
    }
}

/// Bilinear; grey outside.
fn sampled(luma: &GrayImage, [x, y]: [f64; 2]) -> u8 {
    let (left, top) = (x.floor(), y.floor());
    let inside =
        left >= 0.0 && top >= 0.0 && left + 1.0 < f64::from(luma.width()) && top + 1.0 < f64::from(luma.height());
    if !inside {
        return 128;
    }
    let at = |dx: u32, dy: u32| f64::from(luma.get_pixel(left as u32 + dx, top as u32 + dy).0[0]);
    let (fx, fy) = (x - left, y - top);
    let upper = at(0, 0) * (1.0 - fx) + at(1, 0) * fx;
    let lower = at(0, 1) * (1.0 - fx) + at(1, 1) * fx;
    (upper * (1.0 - fy) + lower * fy).round() as u8
}

/// Mean angle between the true directions and those of a choice.
fn true_error_deg(choice: &Choice, truths: &[Viewpoint]) -> f64 {
    let direction = |v: &Viewpoint| {
        let (azimuth, pitch) = (v.azimuth_deg.to_radians(), v.pitch_deg.to_radians());
        nalgebra::Vector3::new(azimuth.cos() * pitch.cos(), azimuth.sin() * pitch.cos(), pitch.sin())
    };
    let located = choice
        .viewpoints
        .iter()
        .zip(truths)
        .filter_map(|(own, truth)| Some((own.as_ref()?, truth)));
    let errors: Vec<f64> = located
        .map(|(own, truth)| direction(own).angle(&direction(truth)).to_degrees())
        .collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn advice(known: &Known) -> PoseAdvice {
    advise_poses(&known.samples, &known.scene, &known.camera, || {}).unwrap()
}

/// Twelve sessions that differ: few tags, bent lenses, small photos, bad light. What is advised without the truth is held against the best choice of each question with it.
#[test]
fn what_is_advised_is_nearly_the_best_choice() {
    let stored = stored();
    let half = |luma: &GrayImage| {
        image::imageops::resize(
            luma,
            luma.width() / 2,
            luma.height() / 2,
            image::imageops::FilterType::Triangle,
        )
    };
    let few = |most: usize| {
        let mut scene = stored.scene.clone();
        scene.tags.retain(|tag| tag.id as usize % 8 < most);
        scene
    };
    let sessions = [
        stored.with("as stored", GrayImage::clone),
        stored.spoiled("out of focus", &[(Spoil::Blur, 1.5)]),
        stored.spoiled("noisy", &[(Spoil::Noise, 12.0)]),
        stored.spoiled("dark and noisy", &[(Spoil::Exposure, -2.5), (Spoil::Noise, 6.0)]),
        stored.spoiled("bright", &[(Spoil::Exposure, 0.8)]),
        stored.spoiled("moved", &[(Spoil::Motion, 4.0)]),
        stored.spoiled("poor JPEG", &[(Spoil::Jpeg, 20.0)]),
        stored.with("small photos", half),
        Known {
            scene: few(6),
            ..stored.with("six tags of eight", GrayImage::clone)
        },
        stored.through("barrel distortion", &[-0.22, 0.06]),
        stored.through("strong barrel distortion, shifted", &[-0.3, 0.12, 0.002, -0.002]),
        stored
            .through("pincushion, ", &[0.12, -0.03])
            .spoiled("pincushion, noisy", &[(Spoil::Noise, 8.0)]),
    ];
    let mut regrets = Vec::new();
    for known in &sessions {
        let advice = advice(known);
        for question in Question::ALL {
            let Some(advised) = advice.advised(question) else {
                println!("{:<34} {:<17} no advice", known.name, question.title());
                continue;
            };
            let usual = advice.of(question).find(|choice| choice.is_usual).unwrap();
            let own = true_error_deg(advised, &known.truths);
            let as_many = advice.of(question).filter(|choice| choice.located >= usual.located);
            let best = as_many
                .map(|choice| true_error_deg(choice, &known.truths))
                .fold(f64::INFINITY, f64::min);
            let regret = own / best - 1.0;
            println!(
                "{:<34} {:<17} {:<20} {own:.4}°, the best {best:.4}°: {:.1} %",
                known.name,
                question.title(),
                advised.name,
                100.0 * regret
            );
            regrets.push(regret);
            // Never another bin.
            for (view, truth) in advised.viewpoints.iter().zip(&known.truths) {
                assert!(
                    !view.is_some_and(|view| is_silently_wrong(&view, truth, &known.scene)),
                    "{}: {}",
                    known.name,
                    advised.name
                );
            }
            assert!(advised.located >= usual.located);
        }
    }
    regrets.sort_by(f64::total_cmp);
    let median = regrets[regrets.len() / 2];
    println!(
        "{} answers, median regret {:.2} %, the largest {:.1} %",
        regrets.len(),
        100.0 * median,
        100.0 * regrets[regrets.len() - 1]
    );
    assert!(regrets.len() >= 40, "it hardly ever answers: {}", regrets.len());
    assert!(median <= 0.05, "{median}");
}

fn advise(session: &Path, out: &Path, more: &[&str]) -> Output {
    program()
        .arg("advise")
        .arg(session)
        .arg("-o")
        .arg(out)
        .args(more)
        .output()
        .unwrap()
}

#[test]
fn the_stored_session_is_scored_by_its_advice() {
    let out = tempfile::tempdir().unwrap();
    let output = advise(&skyline(), out.path(), &["--recorded"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let json = read_json(&out.path().join("advice.json"));
    let choices = json["poses"]["choices"].as_array().unwrap();
    for question in ["tag_detector", "solver", "camera_model", "tags", "resolution"] {
        let own: Vec<&Value> = choices.iter().filter(|choice| choice["question"] == question).collect();
        assert_eq!(
            own.iter().filter(|choice| choice["is_usual"] == true).count(),
            1,
            "{question}"
        );
        assert_eq!(
            own.iter().filter(|choice| choice["verdict"] == "advised").count(),
            1,
            "{question}: {own:?}"
        );
    }
    // A single tag is not enough where two are seen, and its photos are lost.
    let one = choices
        .iter()
        .find(|choice| choice["question"] == "tags" && choice["name"] == "1")
        .unwrap();
    assert!(one["verdict"] != "advised" && one["verdict"] != "enough", "{one}");
    let page = std::fs::read_to_string(out.path().join("advice.html")).unwrap();
    assert!(page.contains("What skyline needs") && page.contains("<svg") && page.contains("definition of AP"));
    assert!(stdout(&output).contains("← advised"), "{}", stdout(&output));

    let scored = |more: &[&str]| {
        let report = tempfile::tempdir().unwrap();
        let output = program()
            .arg("score")
            .arg(skyline())
            .args(["--recorded", "-o"])
            .arg(report.path())
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        read_json(&report.path().join("summary.json"))
    };
    let toml = out.path().join("advice.toml");
    let (usual, by_advice) = (scored(&[]), scored(&["--settings", toml.to_str().unwrap()]));
    let text = std::fs::read_to_string(&toml).unwrap();
    let named = text
        .lines()
        .find_map(|line| line.strip_prefix("tag_detector = \""))
        .unwrap()
        .trim_end_matches('"');
    let advised = choices
        .iter()
        .find(|choice| choice["question"] == "tag_detector" && choice["verdict"] == "advised")
        .unwrap();
    assert_eq!(advised["name"], named);
    for summary in [&usual, &by_advice] {
        assert_eq!(summary["photos_scored"], 16);
    }
    let rates = |summary: &Value| -> Vec<Value> {
        let results = summary["results"].as_array().unwrap();
        results
            .iter()
            .map(|result| result["overall"]["hit_rate"]["rate"].clone())
            .collect()
    };
    assert_eq!(rates(&usual), rates(&by_advice));

    // Another tag detector than the usual one is in the provenance, and a lens without its terms moves the poses.
    let other = out.path().join("other.toml");
    std::fs::write(&other, "tag_detector = \"apriltag\"\nlens_terms = 0\nap = \"voc-11\"\n").unwrap();
    let by_other = scored(&["--settings", other.to_str().unwrap()]);
    assert_ne!(
        by_other["provenance"]["tag_detector"],
        usual["provenance"]["tag_detector"]
    );
    assert_eq!(by_other["ap_definition"], "voc-11");
    let stated = &by_other["provenance"]["settings"];
    assert_eq!(
        (&stated["file"], &stated["lens_terms"]),
        (&"other.toml".into(), &0.into())
    );
    let cautions = by_other["cautions"].to_string();
    assert!(
        cautions.contains("without its lens model, as other.toml says"),
        "{cautions}"
    );
    assert!(usual["provenance"].get("settings").is_none());
}

/// A scene of one tag leaves none out; nothing is advised, and what would help is said.
#[test]
fn what_cannot_tell_says_so() {
    let session = copy_of_skyline();
    let scene = session.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let (head, tags) = text.split_at(text.find("[[tag]]").unwrap());
    let first = tags.split("[[tag]]").nth(1).unwrap();
    std::fs::write(&scene, format!("{head}[[tag]]{first}")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = advise(session.path(), out.path(), &[]);
    let said = stdout(&output) + &stderr(&output);
    match output.status.success() {
        true => assert!(
            said.contains("no advice on tag detector") && said.contains("print more tags"),
            "{said}"
        ),
        false => assert_refused(&output, &["no photo of the session is located"]),
    }

    // Two photos are too few for anything.
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    file["photos"].as_array_mut().unwrap().truncate(2);
    std::fs::write(&path, file.to_string()).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = advise(session.path(), out.path(), &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("at least 6 are needed: take more photos"),
        "{}",
        stdout(&output)
    );
    assert!(!stdout(&output).contains("← advised"));
    let toml = std::fs::read_to_string(out.path().join("advice.toml")).unwrap();
    assert!(toml.lines().all(|line| line.starts_with('#')), "{toml}");
    // One texture has no drop.
    let refused = advise(session.path(), out.path(), &["--recorded"]);
    assert_refused(
        &refused,
        &["findings need photos of `normal` and of another texture", "has normal"],
    );

    let empty = tempfile::tempdir().unwrap();
    assert_refused(&advise(empty.path(), out.path(), &[]), &["no session.json"]);
}

#[test]
fn settings_that_are_none_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let toml = folder.path().join("own.toml");
    let out = folder.path().join("out");
    let score = |more: &[&str]| {
        let mut command = program();
        command
            .arg("score")
            .arg(skyline())
            .args(["--recorded", "--settings"])
            .arg(&toml)
            .arg("-o")
            .arg(&out);
        command.args(more).output().unwrap()
    };
    assert_refused(&score(&[]), &["own.toml"]);
    for (text, words) in [
        ("tag_detector = \"aprltag\"", &["own.toml", "aprltag"][..]),
        ("lens_terms = 9", &["`lens_terms` is 9", "0 to 8"]),
        ("ap = \"best\"", &["own.toml", "best"]),
        ("tags = 3", &["own.toml", "tags"]),
        ("tag_detector", &["own.toml"]),
        ("\u{0}", &["own.toml"]),
    ] {
        std::fs::write(&toml, text).unwrap();
        assert_refused(&score(&[]), words);
    }
    std::fs::write(&toml, "ap = \"voc-11\"").unwrap();
    for ap in ["all-point", "coco-101"] {
        assert_refused(&score(&["--ap", ap]), &["voc-11", "leave one of them out"]);
    }
    assert_refused(&score(&["--shard", "1/2"]), &["--settings", "--shard"]);
    assert!(!out.exists());
}
