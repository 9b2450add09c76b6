//! The pose solver on thousands of synthetic views, driven to where single tags become ambiguous: it must then say so.
//!
//! The views are made with OpenCV's projection, not with the program's own.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Point3, Vector3};
use opencv::core::{Mat, Point2d, Point3d, Vector};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof_core::geometry::{Rigid, angle::turn, rigid};
use scaleproof_core::statistics::normal;
use scaleproof_pose::camera::{Camera, Guess};
use scaleproof_pose::locate::{Abstention, Located, Solver, Warning, locate, locate_by};
use scaleproof_pose::scene::{Scene, Tag, Viewpoint};
use scaleproof_pose::simulate::{Noise, SimulatedFault, SimulatedView, Simulator};
use scaleproof_pose::tags::SeenTag;

pub(crate) fn skyline() -> (Scene, Camera) {
    let folder = crate::common::skyline();
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

fn any_view(simulator: &mut Simulator, fault: Option<SimulatedFault>) -> SimulatedView {
    let viewpoint = simulator.viewpoint(5.0..40.0, 600.0..1600.0);
    simulator.view(&viewpoint, fault)
}

/// The squared Mahalanobis distance of the true pose from the found one: 6 in the mean when the covariance is right.
pub(crate) fn squared_mahalanobis(located: &Located, truth: &Rigid) -> f64 {
    let step = rigid::step_between(&located.pose, truth);
    let inverse = located.uncertainty.covariance.cholesky();
    inverse.map_or(f64::INFINITY, |c| step.dot(&c.solve(&step)))
}

/// A camera as a file has it: each focal length is off by a tenth of a percent (one σ), which σ of a pose contains.
pub(crate) fn filed(camera: &Camera, rng: &mut Pcg64Mcg) -> Camera {
    let mut filed = camera.clone();
    filed.fx *= 1.0 + 1e-3 * normal::draw(rng);
    filed.fy *= 1.0 + 1e-3 * normal::draw(rng);
    filed
}

/// What became of many views.
#[derive(Default)]
struct Tally {
    views: usize,
    answered: usize,
    /// Answered with a wrong azimuth bin, the truth further than 1° from its edge.
    wrong: usize,
    warned: usize,
    /// Struck tags, how many were named, and how often another one was left out.
    struck: usize,
    named: usize,
    blamed: usize,
    azimuth_deg: Vec<f64>,
    /// Errors of azimuth over their σ.
    sigmas: Vec<f64>,
    /// More than 10° wrong, although the pose is not said to be open.
    far_off: usize,
    mahalanobis: Vec<f64>,
    refusals: BTreeMap<&'static str, usize>,
}

impl Tally {
    fn count(&mut self, view: &SimulatedView, answer: &Result<Located, Abstention>) {
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
        self.named += usize::from(located.ignored_tags.iter().any(|i| Some(i.id) == view.struck));
        self.blamed += usize::from(located.ignored_tags.iter().any(|i| Some(i.id) != view.struck));
        let off_deg = turn(located.viewpoint.azimuth_deg, truth.azimuth_deg).abs();
        self.azimuth_deg.push(off_deg);
        self.sigmas.push(off_deg / located.sigma.azimuth_deg);
        self.far_off += usize::from(off_deg > 10.0 && !located.warnings.contains(&Warning::OpenPose));
        self.mahalanobis.push(squared_mahalanobis(located, &view.pose));
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

/// 1,000 views from anywhere with a fault, that see so many tags or more.
fn sweep(scene: &Scene, camera: &Camera, seed: u64, fault: SimulatedFault, least_tags: usize) -> Tally {
    let mut simulator = Simulator::new(scene, camera, USUAL, seed);
    let mut tally = Tally::default();
    while tally.views < 1000 {
        let view = any_view(&mut simulator, Some(fault));
        if view.seen.len() >= least_tags {
            tally.count(&view, &locate(&view.seen, &view.scene, &view.camera));
        }
    }
    tally
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
fn with_several_tags_nearly_every_view_is_answered_right_and_with_the_error_it_states() {
    let (scene, camera) = skyline();
    let distorted = camera.clone().with_distortion(&[-0.25, 0.1, 0.001, -0.002, 0.01]);
    let settings = [
        ("0.3 px", &camera, USUAL),
        ("0.3 px, a tenth of the corners 1.2 px", &camera, TAILED),
        ("0.3 px, strong distortion", &distorted, USUAL),
        (
            "0.15 px",
            &camera,
            Noise {
                sigma_px: 0.15,
                ..USUAL
            },
        ),
        ("0.6 px", &camera, Noise { sigma_px: 0.6, ..USUAL }),
    ];
    for (seed, (name, camera, noise)) in settings.into_iter().enumerate() {
        let mut by_number = BTreeMap::<usize, Tally>::new();
        let mut simulator = Simulator::new(&scene, camera, noise, 2 + seed as u64);
        let (mut all, mut rng) = (Tally::default(), Pcg64Mcg::seed_from_u64(seed as u64));
        while all.views < 2000 {
            let view = any_view(&mut simulator, None);
            let answer = locate(&view.seen, &view.scene, &filed(&view.camera, &mut rng));
            by_number
                .entry(view.seen.len().min(6))
                .or_default()
                .count(&view, &answer);
            if view.seen.len() >= 2 {
                all.count(&view, &answer);
            }
        }
        all.print(name);
        for (number, tally) in by_number.iter().filter(|(number, _)| **number > 0) {
            tally.print(&format!(
                "  {number} tags{}",
                if *number == 6 { " or more" } else { "" }
            ));
        }
        assert!(1000 * all.wrong <= all.answered, "{name}: {} wrong bins", all.wrong);
        assert!(
            100 * all.answered >= 99 * all.views,
            "{name}: {} answered",
            all.answered
        );
        let mean = all.mean_mahalanobis();
        assert!(
            (4.0..=9.0).contains(&mean),
            "{name}: mean squared Mahalanobis error {mean:.2}"
        );
        assert!(all.azimuth_at(0.5) < 0.1 && all.azimuth_at(0.99) < 1.5, "{name}");
        // Honest tags are not blamed.
        let limit = if noise.tail_share > 0.0 { 10 } else { 1000 };
        assert!(
            limit * all.blamed <= all.views,
            "{name}: {} views with an honest tag left out",
            all.blamed
        );
    }
}

#[test]
fn a_single_tag_is_answered_only_when_its_rival_is_out() {
    let (scene, camera) = skyline();
    let mut tally = Tally::default();
    for round in 0.. {
        let lone = Scene {
            tags: vec![scene.tags[round % scene.tags.len()].clone()],
            ..scene.clone()
        };
        let mut simulator = Simulator::new(&lone, &camera, USUAL, 1000 + round as u64);
        for _ in 0..20 {
            let view = any_view(&mut simulator, None);
            if !view.seen.is_empty() {
                tally.count(&view, &locate(&view.seen, &lone, &camera));
            }
        }
        if tally.views >= 3000 {
            break;
        }
    }
    tally.print("single tags");
    println!("of sure poses, more than 10° wrong: {}", tally.far_off);
    let allowed = ["one_tag_ambiguous", "one_tag_frontal", "degenerate"];
    assert!(
        tally.refusals.keys().all(|code| allowed.contains(code)),
        "{:?}",
        tally.refusals
    );
    assert!(
        tally.views - tally.answered > 100,
        "the sweep must reach where the method fails"
    );
    assert!(tally.answered > 300, "a tilted, near tag is enough");
    assert!(1000 * tally.wrong <= tally.answered && 1000 * tally.far_off <= tally.answered);
    let within = |sigmas: f64| tally.sigmas.iter().filter(|off| **off <= sigmas).count();
    println!(
        "of {} errors of azimuth, within 1, 2, 3 σ: {:?}",
        tally.answered,
        [1.0, 2.0, 3.0].map(within)
    );
    assert!(100 * within(2.0) >= 95 * tally.answered && 1000 * within(3.0) >= 997 * tally.answered);
}

/// A tag seen straight on leaves its tilt open. It tells the bin where it faces the middle of one, and not where it faces an edge.
#[test]
fn a_frontal_tag_is_answered_where_its_bin_is_sure() {
    let in_the_middle = frontal_views(0.0);
    in_the_middle.print("a tag that faces a bin's middle");
    assert_eq!(in_the_middle.wrong, 0);
    assert!(5 * in_the_middle.answered > in_the_middle.views);
    let at_an_edge = frontal_views(18.0);
    at_an_edge.print("a tag that faces 4.5° from an edge");
    assert!(at_an_edge.answered == 0);
}

/// 500 views straight on a tag that faces an azimuth, up to 2° off.
fn frontal_views(azimuth_deg: f64) -> Tally {
    let (scene, camera) = skyline();
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    let tag = Tag {
        // Clear of the model, which would hide it.
        centre_mm: Point3::new(300.0 * cos, 300.0 * sin, 150.0),
        right: Vector3::new(-sin, cos, 0.0),
        up: Vector3::z(),
        ..scene.tags[8].clone()
    };
    let lone = Scene {
        tags: vec![tag.clone()],
        ..scene.clone()
    };
    let mut simulator = Simulator::new(&lone, &camera, USUAL, 4);
    let mut tally = Tally::default();
    for i in 0..500 {
        // Straight on, up to 2° off.
        let (far, aside) = (700.0 + f64::from(i), f64::from(i * 7 % 41 - 20));
        let centre = tag.centre_mm + tag.right.cross(&tag.up) * far + tag.right * aside;
        let z = (tag.centre_mm - centre).normalize();
        let x = (tag.right - z * tag.right.dot(&z)).normalize();
        let rotation = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
        let pose = rigid::from_matrix(rotation, -(rotation * centre.coords));
        let view = SimulatedView {
            viewpoint: Viewpoint::from_camera(centre, scene.model.target_mm()),
            pose,
            seen: simulator.seen(&pose),
            scene: lone.clone(),
            camera: camera.clone(),
            struck: None,
        };
        assert_eq!(view.seen.len(), 1);
        tally.count(&view, &locate(&view.seen, &lone, &camera));
    }
    tally
}

/// One bad tag among five or more: found and left out.
#[test]
fn a_bad_tag_is_named_and_left_out() {
    let (scene, camera) = skyline();
    let faults = [
        (SimulatedFault::MovedTag { mm: 2.0 }, 0.2),
        (SimulatedFault::MovedTag { mm: 5.0 }, 0.8),
        (SimulatedFault::MovedTag { mm: 15.0 }, 0.9),
        (SimulatedFault::MovedTag { mm: 50.0 }, 0.9),
        (SimulatedFault::TwistedTag { deg: 15.0 }, 0.9),
        (SimulatedFault::MirroredTag, 0.9),
        (SimulatedFault::WrongId, 0.9),
        (SimulatedFault::DuplicatedId, 0.95),
        (SimulatedFault::WrongCorner { px: 8.0 }, 0.9),
    ];
    for (seed, (fault, least)) in faults.into_iter().enumerate() {
        let tally = sweep(&scene, &camera, 50 + seed as u64, fault, 5);
        tally.print(&format!("{fault:?}"));
        assert!(
            1000 * tally.wrong <= tally.answered,
            "{fault:?}: {} wrong bins",
            tally.wrong
        );
        let named = tally.named as f64 / tally.struck as f64;
        assert!(named >= least, "{fault:?}: named in {named:.3}");
    }
}

/// What the camera file, the scene file or the image hides from the residuals must still leave the bin right.
#[test]
fn wrong_models_and_missing_tags_do_not_make_wrong_bins() {
    let (scene, camera) = skyline();
    let camera = camera.with_distortion(&[-0.2, 0.06]);
    let faults = [
        SimulatedFault::Hidden { share: 0.5 },
        SimulatedFault::Hidden { share: 0.8 },
        SimulatedFault::Cropped { share: 0.5 },
        SimulatedFault::WrongTagSize { factor: 1.02 },
        SimulatedFault::WrongFocal { factor: 1.05 },
        SimulatedFault::WrongPrincipalPoint { px: 30.0 },
        SimulatedFault::IgnoredDistortion,
    ];
    for (seed, fault) in faults.into_iter().enumerate() {
        let tally = sweep(&scene, &camera, 70 + seed as u64, fault, 2);
        tally.print(&format!("{fault:?}"));
        assert!(
            1000 * tally.wrong <= tally.answered,
            "{fault:?}: {} wrong bins",
            tally.wrong
        );
    }
}

/// With two tags nothing tells which is right, and with three no majority is left.
#[test]
fn two_tags_that_disagree_are_not_chosen_between() {
    let (scene, camera) = skyline();
    for number in [2, 3] {
        let mut simulator = Simulator::new(&scene, &camera, USUAL, 80);
        let mut tally = Tally::default();
        while tally.views < 300 {
            let mut view = any_view(&mut simulator, Some(SimulatedFault::MovedTag { mm: 60.0 }));
            let Some(at) = view.seen.iter().position(|tag| Some(tag.id) == view.struck) else {
                continue;
            };
            view.seen.rotate_left(at);
            if view.seen.len() < number {
                continue;
            }
            view.seen.truncate(number);
            tally.count(&view, &locate(&view.seen, &scene, &camera));
        }
        tally.print(&format!("one of {number} moved by 60 mm"));
        assert_eq!(tally.named, 0);
        // A move that two tags' pose can follow stays unseen: rare, but not never.
        assert!(100 * tally.wrong <= tally.views);
        assert!(
            10 * tally.answered <= tally.views,
            "{} of {} answered",
            tally.answered,
            tally.views
        );
    }
}

#[test]
fn near_the_edge_of_a_bin_the_answer_says_so() {
    let (scene, camera) = skyline();
    let mut simulator = Simulator::new(&scene, &camera, USUAL, 9);
    let (mut right, mut expected, mut views) = (0, 0.0, 0);
    for i in 0..400 {
        let azimuth_deg = 22.5 + 0.03 * (f64::from(i % 21) / 10.0 - 1.0);
        let viewpoint = Viewpoint {
            azimuth_deg,
            pitch_deg: 15.0,
            distance_mm: 900.0,
        };
        let view = simulator.view(&viewpoint, None);
        let located = locate(&view.seen, &scene, &camera).unwrap();
        assert_eq!(
            located.warnings.contains(&Warning::NearBinEdge),
            located.bin_probability < 0.95
        );
        views += 1;
        expected += located.bin_probability;
        right += usize::from(located.bin.azimuth_deg == scene.bins.bin_of(&viewpoint).azimuth_deg);
    }
    println!("{views} views within 0.03° of an edge: {right} in the right bin, {expected:.1} expected");
    assert!(
        (right as f64 - expected).abs() < 30.0,
        "{right} right, {expected:.1} expected"
    );
    assert!(expected < 390.0, "some of these are near the edge");
}

#[test]
fn every_rung_of_the_ladder_finds_the_bin() {
    let (scene, camera) = skyline();
    for solver in Solver::all() {
        let mut simulator = Simulator::new(&scene, &camera, USUAL, 11);
        let mut tally = Tally::default();
        for _ in 0..300 {
            let view = any_view(&mut simulator, None);
            if view.seen.len() >= 4 {
                tally.count(&view, &locate_by(solver, &view.seen, &scene, &camera));
            }
        }
        tally.print(solver.name());
        assert!(tally.answered > 50 && tally.wrong == 0, "{}", solver.name());
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
        is_fitted: true,
        side_blurs_px: None,
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

/// A lone card that was turned fits perfectly in a wrong place; what its pose would show besides gives it away.
#[test]
fn a_lone_tag_that_the_picture_contradicts_is_refused() {
    let (scene, camera) = skyline();
    for (seed, fault) in [
        SimulatedFault::TwistedTag { deg: 45.0 },
        SimulatedFault::TwistedTag { deg: 90.0 },
        SimulatedFault::WrongId,
    ]
    .into_iter()
    .enumerate()
    {
        let mut simulator = Simulator::new(&scene, &camera, USUAL, 120 + seed as u64);
        let (mut struck, mut honest) = (Tally::default(), Tally::default());
        while struck.views < 300 {
            let viewpoint = simulator.viewpoint(5.0..40.0, 550.0..700.0);
            let view = simulator.view(&viewpoint, Some(fault));
            if view.seen.len() == 1 && view.struck.is_some() {
                struck.count(&view, &locate(&view.seen, &scene, &camera));
            }
            let view = simulator.view(&viewpoint, None);
            if view.seen.len() == 1 {
                honest.count(&view, &locate(&view.seen, &scene, &camera));
            }
        }
        struck.print(&format!("lone tag, {fault:?}"));
        honest.print("  the same views without it");
        let contradicted = |tally: &Tally| tally.refusals.get("one_tag_contradicted").copied().unwrap_or(0);
        // Not all: from the wrong place too, the model may be in the image and no other tag.
        assert!(
            contradicted(&struck) > 30 && 5 * struck.wrong < struck.views,
            "{fault:?}"
        );
        assert!(contradicted(&honest) == 0 && honest.answered > 0);
    }
}

/// A camera file's own doubt of its focal length is doubt of the distance: by a calibration's σ, and by a guess's bounds.
#[test]
fn what_the_focal_length_is_known_to_is_part_of_sigma() {
    let (scene, camera) = skyline();
    let views = |believed: &Camera, share: f64| {
        let mut simulator = Simulator::new(&scene, &camera, USUAL, 77);
        let mut believed = believed.clone();
        believed.fx *= 1.0 + share;
        believed.fy *= 1.0 + share;
        let (mut answered, mut beyond) = (0, 0);
        for _ in 0..200 {
            let view = any_view(&mut simulator, None);
            if let Ok(located) = locate(&view.seen, &view.scene, &believed) {
                answered += 1;
                let off_mm = (located.viewpoint.distance_mm - view.viewpoint.distance_mm).abs();
                beyond += usize::from(off_mm > 3.0 * located.sigma.distance_mm);
            }
        }
        assert!(answered > 150, "{answered}");
        beyond as f64 / f64::from(answered)
    };
    let [mut calibrated, mut guessed] = [camera.clone(), camera.clone()];
    calibrated.sigma_px = Some([0.01 * camera.fx, 0.01 * camera.fy, 1.0, 1.0]);
    guessed.guess = Some(Guess { focal_percent: 3.0 });
    // A true error of 2 σ and, for the guess, of 2 of its 3 percent.
    for believed in [&calibrated, &guessed] {
        assert!(views(believed, 0.02) < 0.01, "{}", views(believed, 0.02));
        assert!(views(believed, 0.0) < 0.01);
    }
    // A file that says nothing of it is believed to a tenth of a percent.
    assert!(views(&camera, 0.02) > 0.5);
    assert!(views(&camera, 0.002) < 0.05);
}
