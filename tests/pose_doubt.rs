//! The pose solver on thousands of synthetic views, driven to where single tags become ambiguous: it must then say so.
//!
//! The views are made with OpenCV's projection, not with the program's own.

use std::path::Path;

use nalgebra::{Matrix3, Point3, Vector3};
use opencv::core::{Mat, Point2d, Point3d, Vector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof::camera::Camera;
use scaleproof::geometry::{Rigid, angle::turn, rigid};
use scaleproof::locate::{Abstention, locate};
use scaleproof::photo::Photo;
use scaleproof::scene::{Scene, Tag, Viewpoint};
use scaleproof::tags::{AprilTagC, SeenTag, TagDetector};

fn skyline() -> (Scene, Camera) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline");
    (
        Scene::open(&folder.join("scene.toml")).unwrap(),
        Camera::open(&folder.join("camera.yaml")).unwrap(),
    )
}

/// OpenCV's pixels of some model points.
fn opencv_pixels(points: &[Point3<f64>], pose: &Rigid, c: &Camera) -> Vec<[f64; 2]> {
    let points: Vector<Point3d> = points.iter().map(|p| Point3d::new(p.x, p.y, p.z)).collect();
    let (r, t) = rigid::to_rotation_vector(pose);
    let k = Mat::from_slice_2d(&[[c.fx, 0.0, c.cx], [0.0, c.fy, c.cy], [0.0, 0.0, 1.0]]).unwrap();
    let d: Vector<f64> = c.distortion().iter().copied().collect();
    let mut pixels = Vector::<Point2d>::new();
    let (r, t): (Vector<f64>, Vector<f64>) = (r.iter().copied().collect(), t.iter().copied().collect());
    opencv::calib3d::project_points_def(&points, &r, &t, &k, &d, &mut pixels).unwrap();
    pixels.iter().map(|p| [p.x, p.y]).collect()
}

/// A camera at a viewpoint, looking at the target.
fn looking_at(v: &Viewpoint, target: Point3<f64>) -> Rigid {
    let centre = v.camera_centre_mm(target);
    let z = (target - centre).normalize();
    let x = z.cross(&Vector3::z()).normalize();
    let rotation = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
    rigid::from_matrix(rotation, -(rotation * centre.coords))
}

/// Normal noise of σ = 1 (Box–Muller).
fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let (a, b): (f64, f64) = (rng.random::<f64>().max(1e-12), rng.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

fn view(rng: &mut Pcg64Mcg) -> Viewpoint {
    Viewpoint {
        azimuth_deg: rng.random_range(0.0..360.0),
        pitch_deg: rng.random_range(5.0..40.0),
        distance_mm: rng.random_range(600.0..1600.0),
    }
}

/// The tags as a detector with some corner noise would see them: those that face the camera and are in the picture.
fn see<'a>(
    tags: impl Iterator<Item = &'a Tag>,
    pose: &Rigid,
    c: &Camera,
    sigma: f64,
    rng: &mut Pcg64Mcg,
) -> Vec<SeenTag> {
    let centre = pose.inverse() * Point3::origin();
    let mut seen = Vec::new();
    for tag in tags {
        let to_camera = (centre - tag.centre_mm).normalize();
        let inside = |[x, y]: [f64; 2]| x > 0.0 && y > 0.0 && x < f64::from(c.width) && y < f64::from(c.height);
        let in_front = tag.corners_mm().iter().all(|p| (pose * p).z > 100.0);
        if !in_front || tag.right.cross(&tag.up).dot(&to_camera) < 0.2 {
            continue;
        }
        let pixels = opencv_pixels(&tag.corners_mm(), pose, c);
        if pixels.iter().all(|p| inside(*p)) {
            let corners_px = std::array::from_fn(|i| pixels[i].map(|v| v + sigma * normal(rng)));
            seen.push(SeenTag {
                id: tag.id,
                family: tag.family,
                corners_px,
                is_whole: true,
            });
        }
    }
    seen
}

#[test]
fn the_projection_is_opencv_s() {
    let (scene, camera) = skyline();
    let camera = camera.with_distortion(&[-0.2, 0.06, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001]);
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for _ in 0..500 {
        let pose = looking_at(&view(&mut rng), scene.model.target_mm());
        let points = scene.model.box_corners_mm();
        for (point, wanted) in points.iter().zip(opencv_pixels(&points, &pose, &camera)) {
            let [x, y] = camera.project(&(pose * point)).unwrap();
            assert!((x - wanted[0]).abs() < 1e-6 && (y - wanted[1]).abs() < 1e-6);
        }
    }
}

#[test]
fn with_several_tags_nearly_every_view_is_answered_and_right() {
    let (scene, camera) = skyline();
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let (mut views, mut answered, mut offs) = (0, 0, Vec::new());
    for _ in 0..2000 {
        let v = view(&mut rng);
        let pose = looking_at(&v, scene.model.target_mm());
        let seen = see(scene.tags.iter(), &pose, &camera, 0.3, &mut rng);
        if seen.len() < 2 {
            continue;
        }
        views += 1;
        if let Ok(located) = locate(&seen, &scene, &camera) {
            answered += 1;
            let off = turn(located.viewpoint.azimuth_deg, v.azimuth_deg).abs();
            let is_wrong_bin = located.bin.azimuth_deg != scene.bins.bin_of(&v).azimuth_deg;
            let wrong = is_wrong_bin && scene.bins.azimuth_to_edge_deg(v.azimuth_deg) > 1.0;
            assert!(
                !wrong,
                "wrong bin, azimuth off by {off:.2}° at {v:?} with {} tags",
                seen.len()
            );
            offs.push(off);
        }
    }
    offs.sort_by(f64::total_cmp);
    let [median, p99] = [0.5, 0.99].map(|q| offs[(q * offs.len() as f64) as usize]);
    println!("{views} views, {answered} answered; azimuth error: median {median:.3}°, 99 % {p99:.3}°");
    assert!(
        median < 0.1 && p99 < 1.5,
        "azimuth error: median {median:.3}°, 99 % {p99:.3}°"
    );
    assert!(views > 1500, "{views} views with two tags or more");
    assert!(answered as f64 >= 0.99 * views as f64, "{answered} of {views} answered");
}

#[test]
fn a_single_tag_is_answered_only_when_its_rival_is_out() {
    let (scene, camera) = skyline();
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let (mut views, mut answered, mut ambiguous, mut wrong) = (0, 0, 0, 0);
    while views < 3000 {
        let v = view(&mut rng);
        let pose = looking_at(&v, scene.model.target_mm());
        let tag = &scene.tags[rng.random_range(0..scene.tags.len())];
        let seen = see(std::iter::once(tag), &pose, &camera, 0.3, &mut rng);
        if seen.is_empty() {
            continue;
        }
        views += 1;
        match locate(&seen, &scene, &camera) {
            Ok(located) => {
                answered += 1;
                let off = turn(located.viewpoint.azimuth_deg, v.azimuth_deg).abs();
                wrong += usize::from(off > 10.0);
            }
            Err(Abstention::OneTagAmbiguous { id, .. } | Abstention::OneTagFrontal { id, .. }) => {
                ambiguous += 1;
                assert_eq!(id, tag.id);
            }
            Err(other) => panic!("{other:?} at {v:?}"),
        }
    }
    println!("{views} single-tag views: {answered} answered, {ambiguous} ambiguous, {wrong} more than 10° wrong");
    assert!(ambiguous > 100, "the sweep must reach where the method fails");
    assert!(answered > 300, "a tilted, near tag is enough");
    assert!(
        wrong as f64 <= 0.005 * answered as f64,
        "{wrong} of {answered} silently wrong"
    );
}

#[test]
fn a_frontal_tag_is_never_answered() {
    let (scene, camera) = skyline();
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for _ in 0..500 {
        let tag = &scene.tags[8];
        // Straight on, up to 2° off.
        let normal_mm = tag.right.cross(&tag.up);
        let centre =
            tag.centre_mm + normal_mm * rng.random_range(700.0..1200.0) + tag.right * rng.random_range(-20.0..20.0);
        let z = (tag.centre_mm - centre).normalize();
        let x = tag.right - z * tag.right.dot(&z);
        let x = x.normalize();
        let rotation = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
        let pose = rigid::from_matrix(rotation, -(rotation * centre.coords));
        let seen = see(std::iter::once(tag), &pose, &camera, 0.3, &mut rng);
        assert_eq!(seen.len(), 1);
        let answer = locate(&seen, &scene, &camera);
        let unsure = matches!(
            answer,
            Err(Abstention::OneTagAmbiguous { .. } | Abstention::OneTagFrontal { .. })
        );
        assert!(unsure, "{answer:?}");
    }
}

#[test]
fn strange_tags_never_make_a_pose() {
    let (scene, camera) = skyline();
    let ghost = |id: u32, at: f64| SeenTag {
        id,
        family: Default::default(),
        corners_px: [[at, at], [at + 40.0, at], [at + 40.0, at + 40.0], [at, at + 40.0]],
        is_whole: true,
    };
    assert_eq!(locate(&[], &scene, &camera), Err(Abstention::NoTags));
    assert_eq!(
        locate(&[ghost(500, 50.0)], &scene, &camera),
        Err(Abstention::NoKnownTag { ids: vec![500] })
    );
    // The same id twice: one is a copy, nothing tells which.
    let twice = [ghost(3, 50.0), ghost(3, 400.0)];
    assert_eq!(
        locate(&twice, &scene, &camera),
        Err(Abstention::NoKnownTag { ids: vec![3] })
    );
    // A corner set with no area, and numbers that are not finite.
    let flat = SeenTag {
        corners_px: [[100.0, 100.0]; 4],
        ..ghost(3, 0.0)
    };
    assert!(locate(&[flat], &scene, &camera).is_err());
    let nan = SeenTag {
        corners_px: [[f64::NAN, 1.0]; 4],
        ..ghost(3, 0.0)
    };
    assert!(locate(&[nan], &scene, &camera).is_err());
}

/// Every tag of the stored photos alone: real corner errors, among them tags that a card half covers.
#[test]
fn each_tag_alone_on_the_photos_is_right_or_refused() {
    let (scene, camera) = skyline();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline");
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    let mut detector = AprilTagC::new(&scene.families()).unwrap();
    let (mut seen, mut answered, mut covered, mut worst) = (0, 0, 0, 0.0_f64);
    for photo in truth["photos"].as_array().unwrap() {
        let picture = Photo::open(&folder.join(photo["file"].as_str().unwrap())).unwrap();
        for tag in detector.find(&picture.grey()) {
            seen += 1;
            match locate(std::slice::from_ref(&tag), &scene, &camera) {
                Ok(located) => {
                    answered += 1;
                    worst =
                        worst.max(turn(located.viewpoint.azimuth_deg, photo["azimuth_deg"].as_f64().unwrap()).abs());
                }
                Err(Abstention::OneTagCovered { .. }) => covered += 1,
                Err(_) => {}
            }
        }
    }
    println!("{seen} tags alone: {answered} answered, worst azimuth {worst:.2}°; {covered} refused as covered");
    assert!(answered > 80 && worst < 2.0, "{answered} answered, worst {worst}°");
    assert!(covered >= 4, "the covered and cut tags of these photos are noticed");
}
