//! One cause for many bad photos: named when it is the cause, by simulated photos of random scenes and by the stored ones; and never
//! another one.

use crate::common;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Output;

use common::{program, read_json, skyline, stderr, stdout};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::diagnosis::{self, OtherLooks, is_bad};
use scaleproof_pose::locate::{CardFault, Diagnosis, LocatedPhoto, locate};
use scaleproof_pose::scene::{Bins, Envelope, ScaleModel, Scene, TagFamily, TagRing};
use scaleproof_pose::simulate::{Noise, SimulatedFault, Simulator};
use scaleproof_pose::tags::SeenTag;

const NOISE: Noise = Noise {
    sigma_px: 0.3,
    tail_share: 0.05,
};

/// What is wrong with a whole set of photos.
#[derive(Debug, Clone, Copy)]
enum Wrong {
    Nothing,
    In(SimulatedFault),
    /// Each photo has one of these.
    Mixed,
    /// So many cards stand elsewhere in all photos.
    Cards {
        count: usize,
        mm: f64,
    },
    /// The ids are dealt out anew: the same cards on another plan.
    Shuffled,
    /// The tags and where they stand, by one factor: nothing that a photo could tell.
    Everything {
        factor: f64,
    },
    Distortion {
        k1: f64,
    },
    /// The ids of the photos are higher by this.
    Ids {
        by: u32,
    },
    /// Every card was printed turned by quarters, clockwise.
    Turned {
        quarters: usize,
    },
}

/// A random ring of cards round a model.
fn any_scene(rng: &mut Pcg64Mcg) -> Scene {
    loop {
        let ring = TagRing {
            model: ScaleModel {
                name: "model".into(),
                scale: 10.0,
                class: "car".parse().unwrap(),
                size_mm: [
                    rng.random_range(250.0..500.0),
                    rng.random_range(120.0..200.0),
                    rng.random_range(80.0..150.0),
                ],
                envelope: Envelope::Box,
                mesh: Default::default(),
            },
            bins: Bins {
                azimuth_deg: 45.0,
                pitch_deg: vec![15.0],
                distance_mm: vec![850.0],
            },
            radius_mm: rng.random_range(250.0..500.0),
            count: rng.random_range(4..10),
            tag_mm: rng.random_range(30.0..70.0),
            family: TagFamily::Tag36h11,
            tilt_deg: rng.random_range(35.0..70.0),
        };
        if let Ok(mut scene) = ring.scene() {
            // Some have flat tags only, as a mat has.
            if rng.random::<f64>() < 0.3 {
                scene.tags.retain(|tag| tag.id < ring.count);
            }
            return scene;
        }
    }
}

fn any_camera(rng: &mut Pcg64Mcg) -> Camera {
    let width = [1280.0, 1920.0, 4032.0][rng.random_range(0..3)];
    let (height, focal) = (width * 0.75, width * rng.random_range(0.65..1.6));
    let camera = Camera::pinhole(
        width as u32,
        height as u32,
        focal,
        focal,
        width / 2.0 + 5.0,
        height / 2.0 - 7.0,
    );
    camera.with_distortion(&[rng.random_range(-0.12..0.05), rng.random_range(-0.02..0.04)])
}

/// Photos of a scene, as somebody looks at them whose files are wrong in one way; and the scene of the file.
fn photos(count: usize, wrong: Wrong, seed: u64) -> (Vec<LocatedPhoto>, Scene) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let (scene, camera) = (any_scene(&mut rng), any_camera(&mut rng));
    let believed = believed(&scene, wrong, &mut rng);
    let mut simulator = Simulator::new(&scene, &camera, NOISE, seed);
    let photos = (0..count).map(|i| {
        let distance = 1.2 * f64::from(camera.width) / camera.fx;
        let viewpoint = simulator.viewpoint(8.0..40.0, 700.0 / distance..1300.0 / distance);
        let mixture = [
            SimulatedFault::Hidden { share: 0.9 },
            SimulatedFault::MovedTag { mm: 60.0 },
            SimulatedFault::Cropped { share: 0.2 },
            SimulatedFault::WrongFocal { factor: 1.2 },
            SimulatedFault::WrongTagSize { factor: 0.8 },
        ];
        let fault = match wrong {
            Wrong::In(fault) => Some(fault),
            Wrong::Mixed if i % 2 == 0 => Some(mixture[i / 2 % 5]),
            _ => None,
        };
        let mut view = simulator.view(&viewpoint, fault);
        if let Wrong::Ids { by } = wrong {
            view.seen.iter_mut().for_each(|tag| tag.id += by);
        }
        if let Wrong::Turned { quarters } = wrong {
            // The tag's own first corner is where its card has the one to the right of it.
            let turn = |tag: &mut SeenTag| tag.corners_px.rotate_left(quarters);
            view.seen.iter_mut().for_each(turn);
        }
        let of_view = match wrong {
            Wrong::In(_) | Wrong::Mixed => &view.scene,
            _ => &believed,
        };
        let used = match wrong {
            Wrong::Distortion { k1 } => view.camera.clone().with_distortion(&[k1]),
            _ => view.camera.clone(),
        };
        let examined = LocatedPhoto {
            result: locate(&view.seen, of_view, &used),
            fitted: used.for_photo(used.width, used.height, 0),
            seen: view.seen,
        };
        (examined, view.scene)
    });
    let photos: Vec<(LocatedPhoto, Scene)> = photos.collect();
    let scene = match wrong {
        Wrong::In(_) => photos[0].1.clone(),
        _ => believed,
    };
    (photos.into_iter().map(|(photo, _)| photo).collect(), scene)
}

fn believed(scene: &Scene, wrong: Wrong, rng: &mut Pcg64Mcg) -> Scene {
    let mut believed = scene.clone();
    match wrong {
        Wrong::Cards { count, mm } => {
            for tag in believed.tags.iter_mut().take(count) {
                let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
                tag.centre_mm += mm * Vector3::new(angle.cos(), angle.sin(), 0.0);
            }
        }
        Wrong::Shuffled => {
            let last = believed.tags.len() - 1;
            for i in 0..last {
                let (a, b) = (believed.tags[i].id, rng.random_range(i..=last));
                (believed.tags[i].id, believed.tags[b].id) = (believed.tags[b].id, a);
            }
        }
        Wrong::Everything { factor } => {
            for tag in &mut believed.tags {
                tag.size_mm *= factor;
                tag.centre_mm.coords *= factor;
            }
        }
        _ => {}
    }
    believed
}

/// What was named, in a word, for many sets of photos.
fn named(sets: u64, photos_each: usize, wrong: Wrong) -> BTreeMap<&'static str, usize> {
    let mut named = BTreeMap::new();
    for seed in 0..sets {
        let (photos, scene) = photos(photos_each, wrong, seed);
        let word = match diagnosis::diagnose(&photos.iter().collect::<Vec<_>>(), &OtherLooks::default(), &scene) {
            None if diagnosis_asked(&photos) => "not named",
            None => "fine",
            Some(Diagnosis::TagSize(_)) => "size",
            Some(Diagnosis::Focal(_)) => "focal",
            Some(Diagnosis::OtherIds { .. }) => "ids",
            Some(Diagnosis::Cards(found)) => match (found.cards, wrong) {
                (CardFault::Ids { higher_by }, Wrong::Ids { by }) if higher_by == i64::from(by) => "ids",
                (CardFault::Turned { deg }, Wrong::Turned { quarters }) if deg as usize == 90 * quarters => "turned",
                _ => "another",
            },
            Some(_) => "another",
        };
        *named.entry(word).or_default() += 1;
    }
    named
}

fn diagnosis_asked(photos: &[LocatedPhoto]) -> bool {
    photos.iter().filter(|p| is_bad(p)).count() * 10 >= photos.len() * 8
}

/// Random scenes, cameras and viewpoints: the cause is named, and where there is none that is known, none is.
#[test]
fn the_cause_is_named_and_no_other() {
    let causes = [
        (Wrong::In(SimulatedFault::WrongTagSize { factor: 0.8 }), Some("size")),
        (Wrong::In(SimulatedFault::WrongTagSize { factor: 1.1 }), Some("size")),
        (Wrong::In(SimulatedFault::WrongFocal { factor: 0.8 }), Some("focal")),
        (Wrong::In(SimulatedFault::WrongFocal { factor: 1.2 }), Some("focal")),
        (Wrong::Turned { quarters: 1 }, Some("turned")),
        (Wrong::Turned { quarters: 2 }, Some("turned")),
        (Wrong::Turned { quarters: 3 }, Some("turned")),
        (Wrong::Nothing, None),
        (Wrong::Mixed, None),
        (Wrong::Shuffled, None),
        (Wrong::Cards { count: 30, mm: 20.0 }, None),
        (Wrong::Everything { factor: 1.2 }, None),
        (Wrong::Distortion { k1: -0.4 }, None),
        (Wrong::In(SimulatedFault::WrongPrincipalPoint { px: 200.0 }), None),
    ];
    for (wrong, cause) in causes {
        let mut named = named(2, 12, wrong);
        println!("{wrong:?}: {named:?}");
        // Where nobody asks, because most photos are located well in spite of it.
        let fine = named.remove("fine").unwrap_or(0);
        match cause {
            None => drop(named.remove("not named")),
            Some(_) => assert!(fine <= 1, "{wrong:?}"),
        }
        let expected = cause.map(|cause| (cause, 2 - fine));
        assert_eq!(named, expected.into_iter().collect(), "{wrong:?}");
    }
}

/// A set of photos each, or as many as `SCALEPROOF_SETS` says, for `docs/lessons/poses.md`.
#[test]
fn no_other_cause_is_named_however_large_the_fault() {
    let sets = common::number("SCALEPROOF_SETS").unwrap_or(1);
    let mut wrongs: Vec<(Wrong, Option<&str>)> = Vec::new();
    for factor in [0.6, 0.8, 0.9, 0.95, 0.97, 1.03, 1.05, 1.1, 1.2, 1.5] {
        wrongs.push((Wrong::In(SimulatedFault::WrongTagSize { factor }), Some("size")));
        wrongs.push((Wrong::In(SimulatedFault::WrongFocal { factor }), Some("focal")));
    }
    wrongs.extend([20, 4].map(|by| (Wrong::Ids { by }, Some("ids"))));
    let mut unknown: Vec<Wrong> = vec![Wrong::Nothing, Wrong::Mixed, Wrong::Shuffled];
    unknown.extend([1, 2, 4, 30].map(|count| Wrong::Cards { count, mm: 20.0 }));
    unknown.extend([2, 30].map(|count| Wrong::Cards { count, mm: 5.0 }));
    unknown.extend([0.9, 1.2].map(|factor| Wrong::Everything { factor }));
    unknown.extend([-0.4, -0.2, 0.1, 0.3].map(|k1| Wrong::Distortion { k1 }));
    unknown.extend([50.0, 200.0].map(|px| Wrong::In(SimulatedFault::WrongPrincipalPoint { px })));
    unknown.push(Wrong::In(SimulatedFault::IgnoredDistortion));
    unknown.push(Wrong::In(SimulatedFault::Hidden { share: 0.8 }));
    wrongs.extend(unknown.into_iter().map(|wrong| (wrong, None)));
    for (wrong, cause) in wrongs {
        let named = named(sets, 12, wrong);
        println!("{wrong:?}: {named:?}");
        let is_other = |word: &&str| !["fine", "not named"].contains(word) && Some(*word) != cause;
        assert_eq!(named.keys().find(|word| is_other(word)), None, "{wrong:?}: {named:?}");
    }
}

/// The stored photos with a scene and a camera file that were changed.
struct Changed {
    folder: tempfile::TempDir,
    photos: Vec<PathBuf>,
}

impl Changed {
    fn new(scene: impl Fn(String) -> String, camera: impl Fn(String) -> String) -> Changed {
        let folder = tempfile::tempdir().unwrap();
        let read = |name: &str| std::fs::read_to_string(skyline().join(name)).unwrap();
        std::fs::write(folder.path().join("scene.toml"), scene(read("scene.toml"))).unwrap();
        std::fs::write(folder.path().join("camera.yaml"), camera(read("camera.yaml"))).unwrap();
        let photos = read_json(&skyline().join("session.json"))["photos"]
            .as_array()
            .unwrap()
            .clone();
        let photos = photos
            .iter()
            .map(|photo| skyline().join(photo["file"].as_str().unwrap()));
        Changed {
            folder,
            photos: photos.collect(),
        }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn locate(&self, more: &[&str]) -> Output {
        self.locate_where(more, "")
    }

    /// On a system whose programs lie in `path`.
    fn locate_where(&self, more: &[&str], path: &str) -> Output {
        let mut command = program();
        command.env("PATH", path);
        command
            .arg("locate")
            .args(&self.photos)
            .arg("--scene")
            .arg(self.file("scene.toml"));
        command
            .arg("--camera")
            .arg(self.file("camera.yaml"))
            .args(more)
            .output()
            .unwrap()
    }
}

fn as_it_is(text: String) -> String {
    text
}

fn with_focal(text: String, factor: f64) -> String {
    text.replace("1180.0", &(1180.0 * factor).to_string())
}

/// Lines on standard error that begin as notes do.
fn notes(output: &Output) -> Vec<String> {
    stderr(output)
        .lines()
        .filter(|line| line.starts_with("note: "))
        .map(str::to_owned)
        .collect()
}

/// The only note has these words, and no photo is listed.
fn assert_cause(output: &Output, words: &[&str]) {
    let notes = notes(output);
    assert_eq!(notes.len(), 1, "{}", stderr(output));
    words
        .iter()
        .for_each(|word| assert!(notes[0].contains(word), "`{word}` is not in {}", notes[0]));
    let listed = stderr(output)
        .lines()
        .filter(|line| line.starts_with("no pose for "))
        .count();
    assert_eq!(listed, 1, "{}", stderr(output));
}

#[test]
fn tags_of_another_size_are_told_with_their_size() {
    let changed = Changed::new(|scene| scene.replace("size_mm = 50.0", "size_mm = 40.0"), as_it_is);
    let output = changed.locate(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert_cause(
        &output,
        &[
            "the tags seem to be 50.0 mm wide, not 40 mm as",
            "scene.toml says",
            "Measure the black square",
        ],
    );
    assert!(
        stdout(&output).contains("all 16 photos: no pose ("),
        "{}",
        stdout(&output)
    );
    assert!(
        stderr(&output).contains("no pose for all 16 photos; "),
        "{}",
        stderr(&output)
    );
    // Programs get a line for each photo still.
    let json = changed.locate(&["--json"]);
    let lines: Vec<serde_json::Value> = stdout(&json)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 16);
    assert!(
        lines.iter().all(|line| line["camera_scale"] == 1.0),
        "{}",
        stdout(&json)
    );
    assert_cause(&json, &["50.0 mm wide, not 40 mm"]);
}

#[test]
fn a_wrong_focal_length_is_told_with_how_far_it_is_off() {
    for (factor, words) in [
        (1.15, "15 % too long (some 1180 px, not 1357)"),
        (0.85, "15 % too short (some 1180 px, not 1003)"),
    ] {
        let changed = Changed::new(as_it_is, |camera| with_focal(camera, factor));
        assert_cause(
            &changed.locate(&[]),
            &[
                "the focal length in",
                "camera.yaml seems",
                words,
                "scaleproof calibrate",
            ],
        );
    }
}

#[test]
fn other_cards_and_another_picture_size_are_told_once() {
    let ids = Changed::new(|scene| scene.replace("\nid = ", "\nid = 2"), as_it_is);
    assert_cause(
        &ids.locate(&[]),
        &[
            "these photos show tag36h11 ids 0 to ",
            "are these another scene's cards?",
        ],
    );
    let family = Changed::new(
        |scene| scene.replace("\nid = ", "\nfamily = \"tag25h9\"\nid = "),
        as_it_is,
    );
    assert_cause(
        &family.locate(&[]),
        &[
            "these photos show tag36h11 ids ",
            "has tag25h9 only",
            "is `family` wrong there?",
        ],
    );
    let size = Changed::new(as_it_is, |camera| {
        camera.replace("image_height: 960", "image_height: 720")
    });
    let words = ["camera.yaml is for photos of 1280×720, and these are 1280×960, another aspect ratio"];
    assert_cause(&size.locate(&[]), &words);
}

#[test]
fn photos_without_any_tag_are_told_once_with_what_was_tried() {
    let mut changed = Changed::new(as_it_is, as_it_is);
    changed.photos = (0..5).map(|i| changed.file(&format!("plain_{i}.png"))).collect();
    let grey = |x: u32, y: u32| image::Luma([(40 + (x / 9 + y / 7) % 150) as u8]);
    for photo in &changed.photos {
        image::GrayImage::from_fn(1280, 960, grey).save(photo).unwrap();
    }
    assert_cause(
        &changed.locate(&[]),
        &[
            "none of the photos shows a tag: no tag36h11 of",
            "no other family in the 4 that were searched for all",
        ],
    );
}

#[test]
fn good_photos_and_mixtures_have_no_single_cause() {
    let mut changed = Changed::new(as_it_is, as_it_is);
    assert_eq!(notes(&changed.locate(&[])), Vec::<String>::new());
    for (i, photo) in changed.photos.clone().iter().enumerate().filter(|(i, _)| i % 2 == 0) {
        let covered = changed.file(&format!("covered_{i}.png"));
        let mut picture = image::open(photo).unwrap().into_rgb8();
        // One half of an image, or all of it.
        let covered_from = if i % 4 == 0 { 0 } else { 640 };
        picture
            .enumerate_pixels_mut()
            .filter(|(x, _, _)| *x >= covered_from)
            .for_each(|(_, _, p)| p.0 = [90; 3]);
        picture.save(&covered).unwrap();
        changed.photos[i] = covered;
    }
    let output = changed.locate(&[]);
    assert_eq!(notes(&output), Vec::<String>::new(), "{}", stderr(&output));
    assert!(
        stderr(&output)
            .lines()
            .filter(|line| line.starts_with("no pose for "))
            .count()
            >= 4
    );
}

#[test]
fn pictures_of_iphones_are_refused_with_what_to_do() {
    let mut changed = Changed::new(as_it_is, as_it_is);
    changed.photos = (0..6).map(|i| changed.file(&format!("IMG_{i}.HEIC"))).collect();
    for photo in &changed.photos {
        std::fs::write(photo, b"\0\0\0\x1cftypheic\0\0\0\0mif1heicmiaf and its pixels").unwrap();
    }
    let output = changed.locate(&[]);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    let [from, to] = ["IMG_0.HEIC", "IMG_0.jpg"].map(|name| changed.file(name).display().to_string());
    let advised = format!("convert it with `heif-dec {from} {to}`");
    for words in [
        "IMG_0.HEIC is a HEIC image, for which this system has no decoder: set the iPhone to Settings › Camera › Formats › Most Compatible",
        &advised,
        "error: 5 more photos cannot be read for the same reason",
    ] {
        assert!(text.contains(words), "`{words}` is not in {text}");
    }
    assert_eq!(text.lines().count(), 2, "{text}");
}

/// What stands in for libheif's program: it takes one file and writes another, here a stored photo with an orientation that is not its own.
#[cfg(unix)]
#[test]
fn pictures_of_iphones_are_read_by_the_decoder_of_the_system() {
    use std::os::unix::fs::PermissionsExt;

    let mut changed = Changed::new(as_it_is, as_it_is);
    let whole = changed.locate(&["--json"]);
    let shown = image::open(skyline().join("normal_000.jpg")).unwrap().into_rgb8();
    // The program says EXIF orientation 6 of pixels that are upright already, as Debian's heif-convert does.
    let mut png = Vec::new();
    let mut encoder = image::codecs::png::PngEncoder::new(&mut png);
    let turned = [
        b"II*\0\x08\0\0\0\x01\0".as_slice(),
        b"\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
    ]
    .concat();
    image::ImageEncoder::set_exif_metadata(&mut encoder, turned).unwrap();
    let [width, height] = [shown.width(), shown.height()];
    image::ImageEncoder::write_image(encoder, &shown, width, height, image::ExtendedColorType::Rgb8).unwrap();
    std::fs::write(changed.file("decoded.png"), png).unwrap();
    let decoder = changed.file("bin/heif-dec");
    std::fs::create_dir(changed.file("bin")).unwrap();
    let script = format!(
        "#!/bin/sh\nexec /bin/cp '{}' \"$2\"\n",
        changed.file("decoded.png").display()
    );
    std::fs::write(&decoder, script).unwrap();
    std::fs::set_permissions(&decoder, PermissionsExt::from_mode(0o755)).unwrap();
    let heic = b"\0\0\0\x1cftypheic\0\0\0\0mif1heicmiaf and its pixels";
    changed.photos = vec![changed.file("IMG_0.HEIC")];
    std::fs::write(&changed.photos[0], heic).unwrap();
    let path = changed.file("bin").display().to_string();
    let output = changed.locate_where(&["--json"], &path);
    assert!(output.status.success(), "{}", stderr(&output));
    let line = |output: &Output| -> serde_json::Value {
        serde_json::from_str(common::stdout(output).lines().next().unwrap()).unwrap()
    };
    // The PNG is of the photo's colours, whose brightness is rounded once more than the JPEG's own.
    for key in ["azimuth_deg", "pitch_deg", "distance_mm"] {
        let (is, was) = (
            line(&output)[key].as_f64().unwrap(),
            line(&whole)[key].as_f64().unwrap(),
        );
        assert!((is - was).abs() < 1e-3 * was.abs().max(30.0), "{key}: {is}, {was}");
    }
    assert_eq!(
        std::fs::read(&changed.photos[0]).unwrap(),
        heic,
        "photos are never changed"
    );

    // A decoder that fails is named.
    std::fs::write(&decoder, "#!/bin/sh\nexit 1\n").unwrap();
    let output = changed.locate_where(&[], &path);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("heif-dec could not decode it"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_scored_session_whose_photos_fail_alike_says_why() {
    let session = common::copy_of_skyline();
    let scene = session.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let score = |size_mm: u32| {
        std::fs::write(
            &scene,
            text.replace("size_mm = 50.0", &format!("size_mm = {size_mm}.0")),
        )
        .unwrap();
        let [cache, out] = ["cache", "report"].map(|name| session.path().join(name));
        let mut command = program();
        let command = command.arg("score").arg(session.path()).arg("--recorded");
        command
            .arg("--cache")
            .arg(cache)
            .arg("--out")
            .arg(out)
            .output()
            .unwrap()
    };
    // The cause that was kept is said again, and not of another scene.
    for size_mm in [40, 40, 45] {
        let is_told = format!("the tags seem to be 50.0 mm wide, not {size_mm} mm as scene.toml says");
        common::assert_refused(
            &score(size_mm),
            &["none of the 16 photos could be scored", is_told.as_str()],
        );
    }
}

#[test]
fn overlays_show_what_was_found_and_replace_only_overlays() {
    let changed = Changed::new(as_it_is, as_it_is);
    let folder = changed.file("pictures");
    let output = changed.locate(&["--overlay", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("note: 16 images of what was found in "),
        "{}",
        stderr(&output)
    );
    let picture = image::open(folder.join("normal_000.overlay.jpg")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (1280, 960));
    // The box around the model's corners, by the stored truth, is drawn in one colour.
    let truth = read_json(&skyline().join("truth.json"));
    let rows = &truth["photos"][0]["T_camera_model_mm"];
    let number = |row: usize, column: usize| rows[row][column].as_f64().unwrap();
    let camera = Camera::open(&skyline().join("camera.yaml")).unwrap();
    let scene = Scene::open(&skyline().join("scene.toml")).unwrap();
    let pixels = scene.model.box_corners_mm().map(|p| {
        let at = |row| number(row, 0) * p.x + number(row, 1) * p.y + number(row, 2) * p.z + number(row, 3);
        camera.project(&nalgebra::Point3::new(at(0), at(1), at(2))).unwrap()
    });
    let least = |axis: usize| pixels.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| pixels.iter().map(|p| p[axis]).fold(0.0, f64::max);
    let b = [least(0), least(1), most(0), most(1)];
    let is_drawn = |x: f64, y: f64, colour: [i32; 3]| {
        let near = (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (dx, dy)));
        near.filter_map(|(dx, dy)| picture.get_pixel_checked((x as i32 + dx) as u32, (y as i32 + dy) as u32))
            .any(|p| (0..3).all(|i| (i32::from(p.0[i]) - colour[i]).abs() < 70))
    };
    let magenta = [255, 60, 200];
    assert!(is_drawn(b[0], 0.8 * b[1] + 0.2 * b[3], magenta) && is_drawn(0.3 * b[0] + 0.7 * b[2], b[3], magenta));
    assert!(!is_drawn(b[0] - 12.0, 0.8 * b[1] + 0.2 * b[3], magenta));
    // Again: overlays are replaced, and the same.
    let before = std::fs::read(folder.join("normal_000.overlay.jpg")).unwrap();
    assert_eq!(
        changed.locate(&["--overlay", folder.to_str().unwrap()]).status.code(),
        Some(0)
    );
    assert_eq!(std::fs::read(folder.join("normal_000.overlay.jpg")).unwrap(), before);
    // A file of somebody else is not.
    std::fs::write(folder.join("normal_001.overlay.jpg"), b"my own picture").unwrap();
    common::assert_refused(
        &changed.locate(&["--overlay", folder.to_str().unwrap()]),
        &[
            "normal_001.overlay.jpg is in the way: no earlier run has drawn it",
            "hint: name another folder by --overlay",
        ],
    );
    assert_eq!(
        std::fs::read(folder.join("normal_001.overlay.jpg")).unwrap(),
        b"my own picture"
    );
    common::assert_refused(
        &changed.locate(&["--overlay", skyline().to_str().unwrap()]),
        &["holds the photo", "hint: name another folder by --overlay"],
    );
}

/// Two photos of one name have two overlays; one without a pose says so on its image.
#[test]
fn photos_of_one_name_have_overlays_of_two() {
    let mut changed = Changed::new(as_it_is, as_it_is);
    let twin = changed.file("normal_000.png");
    image::RgbImage::from_pixel(320, 240, image::Rgb([120; 3]))
        .save(&twin)
        .unwrap();
    changed.photos = vec![changed.photos[0].clone(), twin];
    let folder = changed.file("pictures");
    assert_eq!(
        changed.locate(&["--overlay", folder.to_str().unwrap()]).status.code(),
        Some(0)
    );
    let picture = image::open(folder.join("normal_000-2.overlay.jpg"))
        .unwrap()
        .into_rgb8();
    assert_eq!(picture.dimensions(), (320, 240));
    let red = picture
        .pixels()
        .filter(|p| p.0[0] > 110 && p.0[1] < 70 && p.0[2] < 70)
        .count();
    assert!(red > 500, "the reason stands on red: {red}");
}
