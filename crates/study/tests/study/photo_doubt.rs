//! The stored photos, whole, tag by tag and spoiled: how far from their exact truth they are, and how far they say.

use image::GrayImage;
use nalgebra::{Matrix3, Point3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof_core::geometry::{Rigid, angle::turn, rigid};
use scaleproof_core::workers;
use scaleproof_photo::Photo;
use scaleproof_pose::locate::{Abstention, locate, locate_luma};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::tags::{TagDetector, TagDetectorChoice};
use scaleproof_study::chart::Spoil;

use crate::pose_doubt::{filed, skyline, squared_mahalanobis};

/// A stored photo and its exact pose.
struct Taken {
    file: String,
    grey: GrayImage,
    pose: Rigid,
    azimuth_deg: f64,
}

fn taken() -> Vec<Taken> {
    let folder = crate::common::skyline();
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    let of = |photo: &serde_json::Value| {
        let file = photo["file"].as_str().unwrap().to_owned();
        let of = |row: usize, column: usize| photo["T_camera_model_mm"][row][column].as_f64().unwrap();
        Taken {
            grey: Photo::open(&folder.join(&file)).unwrap().luma().unwrap(),
            file,
            pose: rigid::from_matrix(Matrix3::from_fn(of), Vector3::from_fn(|row, _| of(row, 3))),
            azimuth_deg: photo["azimuth_deg"].as_f64().unwrap(),
        }
    };
    truth["photos"].as_array().unwrap().iter().map(of).collect()
}

fn default_detector(scene: &Scene) -> Box<dyn TagDetector> {
    TagDetectorChoice::default().open(&scene.families()).unwrap()
}

/// Every tag of the stored photos alone, in a scene without the other tags seen: real corner errors, among them tags that a card
/// half covers. The tags that the photo does not show stay in the scene, and do not contradict a right pose.
#[test]
fn each_tag_alone_on_the_photos_is_right_or_refused() {
    let (scene, camera) = skyline();
    let mut detector = default_detector(&scene);
    let (mut seen, mut answered, mut covered, mut worst) = (0, 0, 0, 0.0_f64);
    for photo in taken() {
        let all = detector.find(&photo.grey);
        for tag in &all {
            seen += 1;
            let mut lone = scene.clone();
            lone.tags
                .retain(|t| t.id == tag.id || all.iter().all(|other| other.id != t.id));
            match locate(std::slice::from_ref(tag), &lone, &camera) {
                Ok(located) => {
                    answered += 1;
                    worst = worst.max(turn(located.viewpoint.azimuth_deg, photo.azimuth_deg).abs());
                }
                Err(Abstention::OneTagCovered { .. }) => covered += 1,
                Err(refused) => assert_ne!(refused.code(), "one_tag_contradicted", "{}: {refused}", photo.file),
            }
        }
    }
    println!("{seen} tags alone: {answered} answered, worst azimuth {worst:.2}°; {covered} refused as covered");
    assert!(answered > 80 && worst < 2.0, "{answered} answered, worst {worst}°");
    assert!(covered >= 4, "the covered and cut tags of these photos are noticed");
}

/// The stated uncertainty against the exact truth, with the default detector's own corner errors, on the photos as they are and
/// spoiled.
#[test]
fn the_photos_are_as_far_from_the_truth_as_they_say() {
    let (scene, camera) = skyline();
    let photos = taken();
    let spoils: [(Spoil, &[f64]); 6] = [
        (Spoil::Jpeg, &[100.0, 80.0, 50.0, 20.0]),
        (Spoil::Blur, &[1.0, 2.0]),
        (Spoil::Motion, &[4.0]),
        (Spoil::Noise, &[5.0, 10.0, 20.0]),
        (Spoil::Exposure, &[-4.0, 1.0, 2.0]),
        (Spoil::Cover, &[0.03]),
    ];
    let as_taken = (Spoil::Blur, 0.0);
    let amounts = spoils
        .iter()
        .flat_map(|(spoil, amounts)| amounts.iter().map(|a| (*spoil, *a)));
    let jobs: Vec<(Spoil, f64)> = std::iter::once(as_taken).chain(amounts).collect();
    let measure = |detector: &mut Box<dyn TagDetector>, (spoil, amount): &(Spoil, f64)| {
        let mut squares = Vec::new();
        // Of each way to spoil them, every second photo.
        let step = if (*spoil, *amount) == as_taken { 1 } else { 2 };
        for (i, photo) in photos.iter().enumerate().step_by(step) {
            let places: Vec<_> = detector.find(&photo.grey).iter().map(|tag| tag.corners_px).collect();
            let mut rng = Pcg64Mcg::seed_from_u64(3 + i as u64);
            let spoiled = spoil.apply(&photo.grey, *amount, &places, &mut rng);
            let Ok(located) = locate(&detector.find(&spoiled), &scene, &filed(&camera, &mut rng)) else {
                continue;
            };
            squares.push(squared_mahalanobis(&located, &photo.pose));
            if (*spoil, *amount) == as_taken {
                println!(
                    "{}: {} tags, Mahalanobis² {:.2}, noise {:.2} px, σ azimuth {:.4}°, off {:.4}°, ignored {:?}",
                    photo.file,
                    located.tags.len(),
                    squares[squares.len() - 1],
                    located.uncertainty.noise_px,
                    located.sigma.azimuth_deg,
                    turn(photo.azimuth_deg, located.viewpoint.azimuth_deg),
                    located.ignored_tags
                );
                // One tag of these photos has a corner 0.3 px off, and is named for it.
                assert!(located.ignored_tags.iter().filter(|tag| tag.why.is_outlier()).count() <= 1);
            }
        }
        Ok::<_, String>(squares)
    };
    let open = || Ok(default_detector(&scene));
    let found = workers::map(&jobs, open, measure, || {}).unwrap();
    let mean = |squares: &[f64]| squares.iter().sum::<f64>() / squares.len() as f64;
    for ((spoil, amount), squares) in jobs.iter().zip(&found) {
        println!(
            "{spoil:?} {amount:>6}: {:>2} answered, mean squared Mahalanobis error {:.2}",
            squares.len(),
            mean(squares)
        );
    }
    let stored = mean(&found[0]);
    let random: Vec<f64> = jobs
        .iter()
        .zip(&found)
        .filter(|((spoil, _), _)| *spoil != Spoil::Cover)
        .flat_map(|(_, squares)| squares.iter().copied())
        .collect();
    println!(
        "as taken {stored:.2}; all {} but the covered ones {:.2}",
        random.len(),
        mean(&random)
    );
    // On renders σ is rather too wide: they have a quarter of the noise that real paper leads to expect, and motion blur and fits that fail shift all
    // edges alike, which hardly moves the pose.
    assert!((2.0..=9.0).contains(&stored), "{stored:.2}");
    assert!((2.0..=9.0).contains(&mean(&random)), "{:.2}", mean(&random));
}

/// A photo that was left with a dozen grey levels: libraries take differences of 5 to 7 levels for none.
#[test]
fn photos_with_a_dozen_grey_levels_are_located_within_three_sigma() {
    let (scene, camera) = skyline();
    let mut detector = default_detector(&scene);
    let (mut answered, all) = (0, taken());
    for photo in &all {
        let mut dark = photo.grey.clone();
        dark.iter_mut().for_each(|v| *v = (f64::from(*v) * 0.06).round() as u8);
        let found = locate_luma(&dark, 0, None, &scene, &camera, &mut *detector);
        let Ok(located) = found.result else { continue };
        answered += 1;
        let off = turn(located.viewpoint.azimuth_deg, photo.azimuth_deg).abs();
        assert!(off < 3.0 * located.sigma.azimuth_deg, "{}: off by {off}°", photo.file);
    }
    assert!(
        answered + 1 >= all.len(),
        "{answered} of {} dark photos are located",
        all.len()
    );
}

/// Where blur or noise hides the sides of tags, all of them look too small alike, which their residuals do not show.
#[test]
fn blurred_and_noisy_copies_are_as_far_off_as_they_say() {
    let (scene, camera) = skyline();
    let ways = [
        (Spoil::Blur, 4.0),
        (Spoil::Blur, 5.0),
        (Spoil::Blur, 5.7),
        (Spoil::Noise, 30.0),
        (Spoil::Noise, 45.0),
        (Spoil::Noise, 60.0),
    ];
    let photos = taken();
    let copies: Vec<_> = photos.iter().flat_map(|photo| ways.map(|way| (photo, way))).collect();
    let worst = workers::each(&copies, |(photo, (spoil, amount))| {
        let grey = spoil.apply(&photo.grey, *amount, &[], &mut Pcg64Mcg::seed_from_u64(41));
        let mut detector = default_detector(&scene);
        let found = locate_luma(&grey, 0, None, &scene, &camera, &mut *detector);
        let located = found.result.ok()?;
        let truth = Viewpoint::from_camera(photo.pose.inverse() * Point3::origin(), scene.model.target_mm());
        let (v, sigma) = (&located.viewpoint, &located.sigma);
        let off = [
            turn(v.azimuth_deg, truth.azimuth_deg) / sigma.azimuth_deg,
            (v.pitch_deg - truth.pitch_deg) / sigma.pitch_deg,
            (v.distance_mm - truth.distance_mm) / sigma.distance_mm,
        ];
        Some(off.map(f64::abs).into_iter().fold(0.0, f64::max))
    });
    let answered: Vec<_> = copies
        .iter()
        .zip(&worst)
        .filter_map(|(copy, worst)| Some((copy, (*worst)?)))
        .collect();
    println!("{} of {} copies answered", answered.len(), copies.len());
    assert!(3 * answered.len() > 2 * copies.len());
    let beyond = answered.iter().filter(|(_, worst)| *worst > 3.0).count();
    // Of normal errors 1 in 120 views is off by more than 3 σ in one of three numbers.
    assert!(40 * beyond <= answered.len(), "{beyond} beyond 3 σ");
    for ((photo, way), worst) in answered {
        assert!(worst < 4.0, "{}, {way:?}: {worst:.1} σ off", photo.file);
    }
}
