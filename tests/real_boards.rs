//! Boards as phones photograph them: 12 megapixels, autofocus that breathes, small squares; and cameras guessed from their EXIF data.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use image::RgbImage;
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use scaleproof_core::workers;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;
use scaleproof_rig::calibrate::{BoardPhoto, SeenCorner, calibrate};

use crate::common::{assert_refused, program, read_json, shared, stderr, stdout};

/// What the program said of photos of a board, and what it took.
struct Calibrated {
    answer: serde_json::Value,
    seconds: f64,
    /// Its most memory, MB; 0 where the system does not tell.
    peak_mb: f64,
}

/// Runs `calibrate` and watches its memory.
fn calibrated(board: &Path, photos: &[PathBuf]) -> Calibrated {
    let folder = tempfile::tempdir().unwrap();
    let (out, err) = (folder.path().join("out"), folder.path().join("err"));
    let mut command = program();
    command.args(["calibrate", "--json", "--board"]).arg(board).args(photos);
    command.stdout(std::fs::File::create(&out).unwrap());
    command.stderr(std::fs::File::create(&err).unwrap());
    let (start, mut peak_mb) = (Instant::now(), 0.0);
    let mut child = command.spawn().unwrap();
    let status = loop {
        peak_mb = memory_mb(child.id()).unwrap_or(peak_mb);
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None => std::thread::sleep(Duration::from_millis(10)),
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    assert!(status.success(), "{}", std::fs::read_to_string(&err).unwrap());
    let answer = read_json(&out);
    println!(
        "{} of {} photos, f {:.1} ± {:.1} px, {} by {seconds:.1} s and {peak_mb:.0} MB",
        answer["photos"].as_array().unwrap().len(),
        photos.len(),
        answer["fx_px"].as_f64().unwrap(),
        answer["fx_sigma_px"].as_f64().unwrap(),
        answer["model"],
    );
    Calibrated {
        answer,
        seconds,
        peak_mb,
    }
}

/// The most memory a process has had so far, by Linux.
fn memory_mb(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1e3)
}

impl Calibrated {
    fn number(&self, name: &str) -> f64 {
        self.answer[name].as_f64().unwrap()
    }

    fn photos(&self) -> usize {
        self.answer["photos"].as_array().unwrap().len()
    }

    /// At most 0.4 GB for each photo in work. Seconds of one core a photo are printed.
    fn assert_lean(&self, photos: usize) {
        let threads = workers::thread_count().min(photos);
        let took = self.seconds * threads as f64 / photos as f64;
        println!(
            "{took:.2} s of one core and {:.0} MB a photo",
            self.peak_mb / threads as f64
        );
        assert!(self.peak_mb < 400.0 * threads as f64, "{} MB", self.peak_mb);
    }
}

/// The photos of a folder, in the order of their names.
fn photos(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_photo = |path: &PathBuf| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("jpg"));
    let mut photos: Vec<PathBuf> = entries.filter(is_photo).collect();
    photos.sort();
    photos
}

// --- a rendered phone ------------------------------------------------------------------------------------------------------

const PHONE: [u32; 2] = [4032, 3024];
const FOCAL_PX: f64 = 3074.0;
const CENTRE_PX: [f64; 2] = [2010.3, 1498.6];

/// A chessboard of 8 × 10 squares of 20 mm, as the real one.
const BOARD: &str = "type = \"chessboard\"\nsquares = [8, 10]\ninner_corners = [7, 9]\nsquare_mm = 20.0\n";

/// The board's print, 0 or 1 at a place in mm: white around it, and where `shifted` says so, 1 mm beside where it belongs.
fn print_at(x: f64, y: f64, shifted: Option<[f64; 2]>) -> f64 {
    let is_shifted = shifted.is_some_and(|[a, b]| (x - a).hypot(y - b) < 5.0);
    let x = if is_shifted { x + 1.0 } else { x };
    let (column, row) = ((x / 20.0).floor(), (y / 20.0).floor());
    let is_inside = (0.0..8.0).contains(&column) && (0.0..10.0).contains(&row);
    f64::from(u8::from(!is_inside || (column + row).rem_euclid(2.0) == 1.0))
}

/// A photo of the board under uneven light, with noise. `pose`: `T_camera_board`.
fn photo(pose: &Isometry3<f64>, shifted: Option<[f64; 2]>) -> RgbImage {
    let k = Matrix3::new(FOCAL_PX, 0.0, CENTRE_PX[0], 0.0, FOCAL_PX, CENTRE_PX[1], 0.0, 0.0, 1.0);
    let r = pose.rotation.to_rotation_matrix().into_inner();
    let plane = k * Matrix3::from_columns(&[
        r.column(0).into_owned(),
        r.column(1).into_owned(),
        pose.translation.vector,
    ]);
    let back = plane.try_inverse().unwrap();
    RgbImage::from_fn(PHONE[0], PHONE[1], |u, v| {
        let parts = [(-0.4, -0.2), (0.2, -0.4), (0.4, 0.2), (-0.2, 0.4)];
        let white: f64 = parts
            .iter()
            .map(|(du, dv)| {
                let at = back * Vector3::new(f64::from(u) + du, f64::from(v) + dv, 1.0);
                print_at(at.x / at.z, at.y / at.z, shifted) / 4.0
            })
            .sum();
        let light = 0.45 + 0.5 * f64::from(u) / f64::from(PHONE[0]);
        // ± 4 grey levels, by a hash of the place.
        let hash = (u.wrapping_mul(73_856_093) ^ v.wrapping_mul(19_349_663)).wrapping_mul(2_654_435_761) >> 24;
        let noise = f64::from(hash) / 32.0 - 4.0;
        let grey = (light * (35.0 + 190.0 * white) + noise) as u8;
        image::Rgb([grey, grey, grey])
    })
}

fn posed(middle_mm: [f64; 3], tilt_deg: [f64; 2], turn_deg: f64) -> Isometry3<f64> {
    let about = |axis: Vector3<f64>, deg: f64| UnitQuaternion::new(axis * deg.to_radians());
    let turn = about(Vector3::x(), tilt_deg[0]) * about(Vector3::y(), tilt_deg[1]) * about(Vector3::z(), turn_deg);
    Translation3::from(middle_mm) * turn * Translation3::new(-80.0, -100.0, 0.0)
}

#[test]
fn chessboards_of_twelve_megapixels_are_found_in_bounded_memory_and_a_corner_printed_wrong_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let board = folder.path().join("board.toml");
    std::fs::write(&board, BOARD).unwrap();
    let views = [
        ([0.0, 0.0, 420.0], [35.0, 5.0], 90.0),
        ([-60.0, 20.0, 520.0], [-30.0, 10.0], 80.0),
        ([50.0, -30.0, 560.0], [5.0, 38.0], 2.0),
        ([80.0, 10.0, 600.0], [-4.0, -35.0], -6.0),
        ([-90.0, -40.0, 700.0], [25.0, 25.0], 12.0),
    ];
    let numbered: Vec<_> = views.into_iter().enumerate().collect();
    let files = workers::each(&numbered, |(i, (middle, tilt, turn))| {
        // The corner between the third and fourth columns and rows, in one photo.
        let shifted = (*i == 1).then_some([60.0, 60.0]);
        let path = folder.path().join(format!("{i}.jpg"));
        photo(&posed(*middle, *tilt, *turn), shifted).save(&path).unwrap();
        path
    });
    let found = calibrated(&board, &files);
    assert_eq!(found.photos(), views.len());
    let corners: u64 = found.answer["photos"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["corners"].as_u64().unwrap())
        .sum();
    assert_eq!(corners, 5 * 63 - 1, "one corner is 1 mm off");
    assert!((found.number("fx_px") / FOCAL_PX - 1.0).abs() < 1e-3);
    found.assert_lean(files.len());
}

/// The focal length of each photo is another one: the stated σ is that of their mean.
#[test]
fn the_stated_uncertainty_holds_for_a_lens_that_breathes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.toml");
    std::fs::write(&path, BOARD).unwrap();
    let board = Definition::open(&path).unwrap();
    let seeds: Vec<u32> = (0..30).collect();
    let scores = workers::each(&seeds, |seed| {
        let mut state = u64::from(*seed) * 7919 + 17;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31)
        };
        let photos = (0..12).map(|number| {
            let middle = [
                uniform() * 80.0 - 40.0,
                uniform() * 60.0 - 30.0,
                380.0 + 200.0 * uniform(),
            ];
            let pose = posed(
                middle,
                [uniform() * 80.0 - 40.0, uniform() * 80.0 - 40.0],
                40.0 * uniform(),
            );
            // ± 1 %, evenly spread.
            let focal_px = FOCAL_PX * (0.99 + 0.02 * uniform());
            let camera = Camera::pinhole(PHONE[0], PHONE[1], focal_px, focal_px, CENTRE_PX[0], CENTRE_PX[1]);
            let corner = |(id, [x, y]): (usize, [f64; 2])| SeenCorner {
                id,
                px: camera
                    .project(&(pose * Point3::new(x, y, 0.0)))
                    .unwrap()
                    .map(|at| at + uniform() - 0.5),
            };
            BoardPhoto {
                file: format!("{number}.jpg"),
                size: (PHONE[0], PHONE[1]),
                turned_deg: 0,
                corners: board.corners_mm().into_iter().enumerate().map(corner).collect(),
                edge_width_px: None,
            }
        });
        let found = calibrate(photos.collect(), Vec::new(), &board).unwrap();
        assert!(found.focal_raised > 1.0);
        ((found.camera.fx - FOCAL_PX) / found.sigmas[0]).powi(2)
    });
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    println!(
        "mean squared z-score of the focal length over {} cameras: {mean:.2}",
        scores.len()
    );
    // 99.9 % of χ²(30)/30 lie in [0.39, 1.99].
    assert!((0.39..1.99).contains(&mean), "{mean}");
}

// --- real boards -----------------------------------------------------------------------------------------------------------

/// Holds a calibration of a set's chessboards against focal lengths made elsewhere, each with its own σ.
fn assert_agrees(set: &str, others_px: &[(f64, f64)]) {
    let folder = shared(&format!("photos/real/{set}/calibration"));
    let photos = photos(&folder);
    let found = calibrated(&folder.join("board.toml"), &photos);
    assert_eq!(found.photos(), photos.len());
    let (focal, sigma) = (found.number("fx_px"), found.number("fx_sigma_px"));
    for (other, its_sigma) in others_px {
        let off = (focal - other).abs() / sigma.hypot(*its_sigma);
        println!("{set}: {focal:.1} ± {sigma:.1} px against {other:.1}: {off:.1} σ");
        assert!(off < 3.0);
    }
    found.assert_lean(photos.len());
}

/// OpenCV 5's `calibrateCameraExtended` of the same photos, and the published camera.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn real_chessboards_are_all_found_and_the_focal_length_is_opencvs_and_the_published_one() {
    assert_agrees("swatbotics", &[(769.4, 1.0), (765.0, 0.0)]);
    assert_agrees("veldrovive", &[(3114.0, 5.3), (3081.4, 0.0)]);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn squares_of_twenty_pixels_give_their_corners() {
    let folder = shared("cases/smallboard");
    let photos = photos(&folder);
    let found = calibrated(&folder.join("charuco8.toml"), &photos);
    assert_eq!(found.photos(), photos.len());
    let corners = found.answer["photos"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["corners"].as_u64().unwrap());
    // OpenCV 5 finds 572 of 588, at least 45 in a photo; the worst of ours here has markers unread.
    assert!(corners.clone().sum::<u64>() >= 560 && corners.min() >= Some(36));
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn real_charuco_boards_are_found() {
    let charuco = shared("photos/real/photonvision/charuco");
    let photos = photos(&charuco.join("2024-05-07_lifecam_480"));
    let found = calibrated(&charuco.join("pv.toml"), &photos);
    assert_eq!(found.photos(), photos.len());
}

/// OpenCV's outlines of such large tags leave their corners by up to 12 px.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn every_corner_of_a_real_april_grid_is_found() {
    let folder = shared("photos/real/aprilgrid");
    let found = calibrated(&folder.join("board.toml"), &photos(&folder));
    let corners = found.answer["photos"].as_array().unwrap().iter();
    assert!(
        corners.clone().count() == 4 && corners.clone().all(|p| p["corners"] == 144),
        "{}",
        found.answer
    );
}

/// Focal lengths measured with boards: a lens that breathes has one for each distance.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn cameras_guessed_from_real_photos_contain_the_measured_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("guess.yaml");
    let guess = |photo: &Path| {
        let mut command = program();
        command.args(["camera", "guess", "-o"]).arg(&file).arg(photo);
        command.output().unwrap()
    };
    let real = |set: &str| photos(&shared(&format!("photos/real/{set}")));
    let sets = [
        (real("swatbotics"), [765.0, 770.2]),
        (real("swatbotics/calibration"), [765.0, 770.2]),
        (real("veldrovive"), [3033.0, 3122.0]),
        (real("veldrovive/calibration"), [3033.0, 3122.0]),
        (vec![shared("cases/small_honest.jpg")], [217.0, 217.1]),
    ];
    for (photos, measured) in sets {
        assert!(!photos.is_empty());
        for photo in photos {
            let output = guess(&photo);
            assert!(output.status.success(), "{}", stderr(&output));
            let camera = Camera::open(&file).unwrap();
            let bound = camera.fx * camera.guess.unwrap().focal_percent / 100.0;
            assert!(
                measured.iter().all(|px| (px - camera.fx).abs() < bound),
                "{}",
                stdout(&output)
            );
        }
    }
    // Edited copies: of a compact camera's sensor 0.31 and 1.56 mm are left.
    for edited in ["cases/small_edited.jpg", "photos/cars/darknet_dog.jpg"] {
        assert_refused(&guess(&shared(edited)), &["no camera can be guessed", "an editor"]);
    }
}
