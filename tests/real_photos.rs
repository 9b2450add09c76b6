//! Real photos with independent truth: what is answered, how far off, and whether the stated σ holds.

use std::path::PathBuf;

use scaleproof_core::geometry::angle::turn;
use scaleproof_photo::Photo;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Located, LocatedPhoto, locate, locate_photo};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::tags::TagDetectorChoice;

use crate::common::{read_json, shared};

/// A photo, what is seen on it, and from where it was taken.
struct RealPhoto {
    name: String,
    truth: Viewpoint,
    found: LocatedPhoto,
    scene: Scene,
}

/// Wrong by a misread truth (see the NOTES.md of its set).
const WITHOUT_TRUTH: &str = "IMG_1415.JPG";

/// The photos of a set that are there.
fn photos(set: &str) -> Vec<RealPhoto> {
    let folder = shared(&format!("photos/real/{set}"));
    let camera = Camera::open(&folder.join("camera.yaml")).unwrap();
    let truth = read_json(&folder.join("truth.json"));
    let mut photos = Vec::new();
    for (file, truth) in truth.as_object().unwrap() {
        let path: PathBuf = folder.join(file);
        let Some(view) = truth["view"]
            .as_array()
            .filter(|_| path.exists() && file != WITHOUT_TRUTH)
        else {
            continue;
        };
        let scene = match truth["wall"].as_str() {
            Some(wall) => folder.join(format!("scene_{wall}.toml")),
            None => folder.join("scene.toml"),
        };
        let scene = Scene::open(&scene).unwrap();
        let [azimuth_deg, pitch_deg, distance_mm] = [0, 1, 2].map(|i| view[i].as_f64().unwrap());
        let mut tags = TagDetectorChoice::default().open(&scene.families()).unwrap();
        let photo = Photo::open(&path).unwrap();
        photos.push(RealPhoto {
            name: file.clone(),
            truth: Viewpoint {
                azimuth_deg,
                pitch_deg,
                distance_mm,
            },
            found: locate_photo(&photo, &scene, &camera, tags.as_mut()).unwrap(),
            scene,
        });
    }
    assert!(!photos.is_empty());
    photos
}

/// How far an answer's azimuth and pitch are off, in degrees and in its σ; the truth itself is good to 0.3°.
fn off(located: &Located, truth: &Viewpoint) -> [(f64, f64); 2] {
    let (v, sigma) = (&located.viewpoint, &located.sigma);
    let azimuth = turn(v.azimuth_deg, truth.azimuth_deg).abs();
    let pitch = (v.pitch_deg - truth.pitch_deg).abs();
    [(azimuth, sigma.azimuth_deg), (pitch, sigma.pitch_deg)].map(|(off, sigma)| (off, off / sigma.hypot(0.15)))
}

fn answered(photos: &[RealPhoto]) -> usize {
    for photo in photos {
        let name = &photo.name;
        match &photo.found.result {
            Ok(located) => {
                let off = off(located, &photo.truth);
                println!("{name}: {} tags, off {off:.2?} (°, σ)", located.tags.len());
                assert!(off.iter().all(|(deg, sigmas)| *deg < 3.0 || *sigmas < 3.0), "{name}");
            }
            Err(why) => println!("{name}: {}", why.code()),
        }
    }
    photos.iter().filter(|photo| photo.found.result.is_ok()).count()
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn a_room_of_tags_on_paper_is_answered() {
    assert!(answered(&photos("swatbotics")) >= 31);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn loose_paper_on_stairs_is_answered_and_every_whole_tag_is_used() {
    let photos = photos("veldrovive");
    assert_eq!(answered(&photos), photos.len());
    let cut = photos
        .iter()
        .flat_map(|photo| &photo.found.seen)
        .filter(|tag| !tag.is_whole);
    // One tag of IMG_2031 touches the edge of the photo.
    assert_eq!(cut.map(|tag| tag.id).collect::<Vec<_>>(), [12]);
}

/// Each tag of each photo alone: errors within one, two and three of the stated σ, of how many numbers.
fn alone(photos: &[RealPhoto]) -> ([f64; 3], u32, u32) {
    let (mut within, mut numbers, mut tags) = ([0u32; 3], 0u32, 0u32);
    let mut wrong_bins = 0;
    for photo in photos {
        let camera = &photo.found.fitted.as_ref().unwrap().camera;
        for tag in &photo.found.seen {
            tags += 1;
            let Ok(located) = locate(std::slice::from_ref(tag), &photo.scene, camera) else {
                continue;
            };
            let is_wrong = photo.scene.bins.bin_of(&photo.truth) != located.bin;
            wrong_bins += usize::from(is_wrong && located.bin_probability >= 0.99);
            for (deg, sigmas) in off(&located, &photo.truth) {
                numbers += 1;
                for (limit, within) in [1.0, 2.0, 3.0].iter().zip(&mut within) {
                    *within += u32::from(sigmas <= *limit);
                }
                if sigmas > 2.0 {
                    println!("{} tag {}: {deg:.2}°, {sigmas:.1} σ", photo.name, tag.id);
                }
            }
        }
    }
    assert_eq!(wrong_bins, 0);
    (within.map(|n| f64::from(n) / f64::from(numbers)), numbers, tags)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_sigma_of_a_lone_tag_holds_on_paper() {
    for set in ["swatbotics", "veldrovive"] {
        let (within, numbers, tags) = alone(&photos(set));
        println!("{set}: {numbers} errors of {tags} tags, within 1, 2, 3 σ: {within:.3?}");
        assert!(within[1] >= 0.90 && within[2] >= 0.947, "{set}: {within:?}");
    }
}
