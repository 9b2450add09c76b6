//! The pose solver on thousands of synthetic views, driven to where single tags become ambiguous: it must then say so.
//!
//! The views are made with OpenCV's projection, not with the program's own.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Matrix3, Point3};
use opencv::core::{Mat, Point2d, Point3d, Vector};
use scaleproof::camera::Camera;
use scaleproof::geometry::{Rigid, angle::turn, rigid};
use scaleproof::locate::{Abstention, Located, locate};
use scaleproof::photo::Photo;
use scaleproof::scene::Scene;
use scaleproof::simulate::{Fault, Noise, Simulator, View, looking_at};
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

const USUAL: Noise = Noise {
    sigma_px: 0.3,
    tail_share: 0.0,
};
const TAILED: Noise = Noise {
    sigma_px: 0.3,
    tail_share: 0.1,
};

fn any_view(simulator: &mut Simulator, fault: Option<Fault>) -> View {
    let viewpoint = simulator.viewpoint(5.0..40.0, 600.0..1600.0);
    simulator.view(&viewpoint, fault)
}

/// What became of many views.
#[derive(Default)]
struct Tally {
    views: usize,
    answered: usize,
    /// Answered with a wrong azimuth bin, the truth further than 1° from its edge.
    wrong: usize,
    warned: usize,
    warned_wrong: usize,
    /// Struck tags, how many were named, and how often another one was left out.
    struck: usize,
    named: usize,
    blamed: usize,
    azimuth_deg: Vec<f64>,
    mahalanobis: Vec<f64>,
    refusals: BTreeMap<&'static str, usize>,
}

impl Tally {
    fn count(&mut self, view: &View, answer: &Result<Located, Abstention>) {
        self.views += 1;
        self.struck += usize::from(view.struck.is_some());
        let located = match answer {
            Ok(located) => located,
            Err(abstention) => {
                *self.refusals.entry(abstention.code()).or_default() += 1;
                return;
            }
        };
        self.answered += 1;
        let (truth, bins) = (&view.viewpoint, &view.scene.bins);
        let is_wrong = located.bin.azimuth_deg != bins.bin_of(truth).azimuth_deg;
        self.wrong += usize::from(is_wrong && bins.azimuth_to_edge_deg(truth.azimuth_deg) > 1.0);
        self.warned += usize::from(!located.warnings.is_empty());
        self.warned_wrong += usize::from(is_wrong && !located.warnings.is_empty());
        self.named += usize::from(located.ignored_tags.iter().any(|i| Some(i.id) == view.struck));
        self.blamed += usize::from(located.ignored_tags.iter().any(|i| Some(i.id) != view.struck));
        self.azimuth_deg
            .push(turn(located.viewpoint.azimuth_deg, truth.azimuth_deg).abs());
        self.mahalanobis
            .push(located.uncertainty.squared_mahalanobis(&located.pose, &view.pose));
    }

    fn mean_mahalanobis(&self) -> f64 {
        self.mahalanobis.iter().sum::<f64>() / self.mahalanobis.len().max(1) as f64
    }

    /// Azimuth error at a quantile, degrees.
    fn azimuth_at(&self, quantile: f64) -> f64 {
        let mut errors = self.azimuth_deg.clone();
        errors.sort_by(f64::total_cmp);
        errors
            .get((quantile * errors.len() as f64) as usize)
            .copied()
            .unwrap_or(f64::NAN)
    }

    fn print(&self, what: &str) {
        println!(
            "{what:<34} {:>5} views, {:>5} answered, {:>2} wrong; azimuth median {:.3}°, 99 % {:.3}°; Mahalanobis² {:.2}; {} near an \
             edge; struck {}, named {}, others blamed {}; refused {:?}",
            self.views,
            self.answered,
            self.wrong,
            self.azimuth_at(0.5),
            self.azimuth_at(0.99),
            self.mean_mahalanobis(),
            self.warned,
            self.struck,
            self.named,
            self.blamed,
            self.refusals
        );
    }
}

#[test]
fn explore() {
    let (scene, camera) = skyline();
    for (name, noise, k) in [("0.3", USUAL, 1.0), ("0.3 tails", TAILED, 1.0), ("0.1", USUAL, 0.33), ("0.6", USUAL, 2.0), ("1.0", USUAL, 3.3)] {
        let noise = Noise { sigma_px: noise.sigma_px * k, ..noise };
        let mut simulator = Simulator::new(&scene, &camera, noise, 5);
        let mut by: BTreeMap<usize, Tally> = BTreeMap::new();
        let started = std::time::Instant::now();
        for _ in 0..2000 {
            let view = any_view(&mut simulator, None);
            let answer = locate(&view.seen, &view.scene, &view.camera);
            by.entry(view.seen.len()).or_default().count(&view, &answer);
        }
        println!("{name} {:?}", started.elapsed());
        for (n, t) in &by { t.print(&format!("{n} tags")); }
    }
    for fault in [2.0, 3.0, 5.0, 10.0, 20.0, 50.0].map(|mm| Fault::MovedTag { mm }).into_iter().chain([Fault::TwistedTag{deg: 5.0}, Fault::TwistedTag{deg:20.0}, Fault::MirroredTag, Fault::WrongId, Fault::DuplicatedId, Fault::WrongCorner{px:6.0}, Fault::Hidden{share:0.5}, Fault::Hidden{share:0.8}, Fault::Cropped{share:0.5}, Fault::WrongTagSize{factor:1.02}, Fault::WrongFocal{factor:1.05}, Fault::WrongPrincipalPoint{px:30.0}, Fault::IgnoredDistortion]) {
        let mut simulator = Simulator::new(&scene, &camera, USUAL, 6);
        let mut by: BTreeMap<usize, Tally> = BTreeMap::new();
        let started = std::time::Instant::now();
        for _ in 0..1500 {
            let view = any_view(&mut simulator, Some(fault));
            let answer = locate(&view.seen, &view.scene, &view.camera);
            by.entry(view.seen.len().min(5)).or_default().count(&view, &answer);
        }
        println!("{fault:?} {:?}", started.elapsed());
        for (n, t) in &by { t.print(&format!("{n} tags")); }
    }
    for pass in 0..2 {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline");
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    let mut detector = AprilTagC::new(&scene.families()).unwrap();
    for photo in truth["photos"].as_array().unwrap() {
        let picture = Photo::open(&folder.join(photo["file"].as_str().unwrap())).unwrap();
        let mut seen = detector.find(&picture.grey());
        if pass == 1 { seen.retain(|t| t.is_whole); seen.truncate(3); }
        let t = &photo["T_camera_model_mm"];
        let f = |r: usize, c: usize| t[r][c].as_f64().unwrap();
        let pose = rigid::from_matrix(nalgebra::Matrix3::from_fn(f), nalgebra::Vector3::from_fn(|r, _| f(r, 3)));
        match locate(&seen, &scene, &camera) {
            Ok(l) => println!("{} {} tags d2 {:.2} noise {:.3} rms {:.2} sigma {:?} p {:.3} err {:.4} {:.4} {:.3} ignored {:?}", photo["file"], l.tags.len(), l.uncertainty.squared_mahalanobis(&l.pose, &pose), l.uncertainty.noise_px, l.rms_px, l.sigma, l.bin_probability,
              turn(photo["azimuth_deg"].as_f64().unwrap(), l.viewpoint.azimuth_deg), l.viewpoint.pitch_deg - photo["pitch_deg"].as_f64().unwrap(), l.viewpoint.distance_mm - photo["distance_mm"].as_f64().unwrap(), l.ignored_tags),
            Err(e) => println!("{} {e}", photo["file"]),
        }
    }
    }
}

#[test]
fn the_projection_is_opencv_s() {
    let (scene, camera) = skyline();
    let camera = camera.with_distortion(&[-0.2, 0.06, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001]);
    let mut simulator = Simulator::new(&scene, &camera, USUAL, 1);
    for _ in 0..500 {
        let pose = any_view(&mut simulator, None).pose;
        let points = scene.model.box_corners_mm();
        for (point, wanted) in points.iter().zip(opencv_pixels(&points, &pose, &camera)) {
            let [x, y] = camera.project(&(pose * point)).unwrap();
            assert!((x - wanted[0]).abs() < 1e-6 && (y - wanted[1]).abs() < 1e-6);
        }
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
