//! `survey` on real photos of a room: tags on paper in a long chain, against an independent adjustment.

use std::path::PathBuf;

use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_rig::survey::{Sizes, SurveyInput, detect_tags, shift, survey};

use crate::common::shared;

const FAMILY: TagFamily = TagFamily::Tag36h11;

/// The truth is a bundle adjustment by scipy of the corners that C AprilTag found in all 72 photos of the set, which go round the room; the 33
/// that are here do not (see the NOTES.md of the set). The one fixed tag is the same.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_tags_of_a_room_are_placed_and_none_is_called_moved() {
    let folder = shared("photos/real/swatbotics");
    let camera = Camera::open(&folder.join("camera.yaml")).unwrap();
    let truth = Scene::open(&folder.join("scene_north.toml")).unwrap();
    let scene = Scene {
        tags: truth.tag(FAMILY, 0).into_iter().cloned().collect(),
        ..truth.clone()
    };
    let files = std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path());
    let mut files: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|e| e == "JPG"))
        .collect();
    files.sort();
    let photos = detect_tags(&files, &scene, FAMILY, &camera, || ()).unwrap().photos;
    let sizes: Sizes = "127".parse().unwrap();
    let given = SurveyInput {
        scene: &scene,
        fixed: &[(FAMILY, 0)],
        sizes: Some(&sizes),
        family: FAMILY,
    };
    let found = survey(&photos, &given, &camera).unwrap();
    let mut shown: Vec<u32> = photos.iter().flat_map(|p| &p.seen).map(|s| s.id).collect();
    shown.sort_unstable();
    shown.dedup();
    println!(
        "{} tags of {} shown, {} photos: {:?}",
        found.scene.tags.len(),
        shown.len(),
        files.len(),
        found.left_out
    );
    let mut worst = 0.0_f64;
    for tag in found.scene.tags.iter().filter(|tag| tag.sigma.is_some()) {
        let sigma = tag.sigma.unwrap();
        let (mm, deg) = shift(&tag.pose(), &truth.tag(FAMILY, tag.id).unwrap().pose());
        println!(
            "tag {}: {mm:.0} mm of σ {:.0}, {deg:.2}° of σ {:.2}",
            tag.id, sigma.mm, sigma.deg
        );
        worst = worst.max(mm / sigma.mm).max(deg / sigma.deg);
    }
    println!("worst {worst:.1} σ; the lens is off by {:?} px", found.lens_px);
    assert!(found.left_out.is_empty() && found.scene.tags.len() == shown.len());
    assert!(worst <= 3.0);
}
