//! σ of frames whose rows are read one after the other while a hand shakes, against the simulated truth.

use std::path::Path;

use nalgebra::Vector6;

use scaleproof_core::geometry::Rigid;
use scaleproof_core::geometry::angle::turn;
use scaleproof_core::geometry::rigid::stepped;
use scaleproof_film::motion;
use scaleproof_film::tracking::{FrameResult, NoPose};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Located, locate};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::simulate::{Noise, Simulator, looking_at};
use scaleproof_pose::tags::SeenTag;

use super::{frame, with};

const FRAMES_PER_S: f64 = 30.0;

struct Walk {
    scene: Scene,
    camera: Camera,
    read_out_s: f64,
}

impl Walk {
    /// `T_camera_model` at a time, s: once round in 12 s, with a hand that shakes at 0.7 to 9 Hz.
    fn pose(&self, t: f64) -> Rigid {
        let quiet = Viewpoint {
            azimuth_deg: 30.0 * t + 10.0,
            pitch_deg: 15.0,
            distance_mm: 850.0,
        };
        let wave = |k: usize| -> f64 {
            let hertz = [0.7, 1.3, 2.1, 3.4, 5.3, 9.0];
            let sum = hertz
                .iter()
                .map(|hz| (std::f64::consts::TAU * hz * t + (7.0 * k as f64 + 3.0) * hz).sin() / hz);
            sum.sum()
        };
        let shake = Vector6::from_fn(|k, _| if k < 3 { 0.004 } else { 2.0 } * wave(k));
        stepped(&looking_at(&quiet, self.scene.model.target_mm()), &shake)
    }

    fn viewpoint(&self, t: f64) -> Viewpoint {
        let centre = self.pose(t).inverse() * nalgebra::Point3::origin();
        Viewpoint::from_camera(centre, self.scene.model.target_mm())
    }

    /// The tags of a frame whose middle row is read at a time.
    fn seen(&self, t: f64, simulator: &mut Simulator) -> Vec<SeenTag> {
        let still = self.pose(t);
        let mut seen = simulator.seen(&still);
        for tag in &mut seen {
            let known = self.scene.tags.iter().find(|one| one.id == tag.id).unwrap();
            for (px, corner) in tag.corners_px.iter_mut().zip(&known.corners_mm()) {
                let late_s = self.read_out_s * (px[1] / f64::from(self.camera.height) - 0.5);
                let [moved, unmoved] =
                    [self.pose(t + late_s), still].map(|pose| self.camera.project(&(pose * corner)).unwrap());
                *px = [0, 1].map(|axis| px[axis] + moved[axis] - unmoved[axis]);
            }
        }
        seen
    }
}

#[test]
fn frames_are_as_far_off_as_they_say_however_long_the_rows_are_read() {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../captures/walk");
    for read_out_s in [0.0, 0.01, 0.02, 0.03] {
        let walk = Walk {
            scene: Scene::open(&stored.join("scene.toml")).unwrap(),
            camera: Camera::open(&stored.join("camera.yaml")).unwrap(),
            read_out_s,
        };
        let noise = Noise {
            sigma_px: 0.05,
            tail_share: 0.02,
        };
        let mut simulator = Simulator::new(&walk.scene, &walk.camera, noise, 7);
        let (mut looks, mut located): (Vec<FrameResult>, Vec<Located>) = (Vec::new(), Vec::new());
        for number in 0..360 {
            let time_s = number as f64 / FRAMES_PER_S;
            let found = locate(&walk.seen(time_s, &mut simulator), &walk.scene, &walk.camera).unwrap();
            let look = with(frame(number, 0.0, 0.6), |view| {
                (view.viewpoint, view.moved) = (found.viewpoint, None)
            });
            looks.push(FrameResult { time_s, ..look });
            motion::set_motion(&mut looks);
            located.push(found);
        }
        let moved = |look: &FrameResult| look.shows.unwrap().moved;
        let errors: Vec<(f64, f64)> = (looks.iter().zip(&located))
            .filter_map(|(look, found)| {
                let off = turn(walk.viewpoint(look.time_s).azimuth_deg, found.viewpoint.azimuth_deg);
                Some((off.abs(), found.sigma.and(&moved(look)?).azimuth_deg))
            })
            .collect();
        assert_eq!(errors.len(), 358);
        let within = |k: f64| errors.iter().filter(|(off, sigma)| *off < k * sigma).count() as f64 / 358.0;
        let worst = errors.iter().map(|(off, _)| *off).fold(0.0, f64::max);
        println!(
            "{read_out_s} s: {worst:.3}° at most, {:.3} {:.3} {:.3}",
            within(1.0),
            within(2.0),
            within(3.0)
        );
        assert!(within(1.0) > 0.68 && within(2.0) > 0.95 && within(3.0) > 0.99);
    }
}

#[test]
fn a_hand_that_turns_back_moves_and_a_gap_leaves_the_motion_open() {
    let at = |number: u64, time_s: f64, azimuth_deg: f64| FrameResult {
        time_s,
        ..with(frame(number, azimuth_deg, 0.6), |view| view.moved = None)
    };
    let repeated = FrameResult {
        shows: Err(NoPose::Repeated),
        ..at(3, 0.3, 0.0)
    };
    let film = [
        at(0, 0.0, 359.0),
        at(1, 0.1, 0.0),
        at(2, 0.2, 359.0),
        repeated,
        at(4, 0.4, 1.0),
        at(5, 1.0, 1.0),
        at(6, 1.1, 1.0),
    ];
    let mut looks = Vec::new();
    for look in film {
        looks.push(look);
        motion::set_motion(&mut looks);
    }
    let moved = |at: usize| looks[at].shows.ok().and_then(|view| Some(view.moved?.azimuth_deg));
    // 10° a second to both sides, for half of 30 ms; then 10° a second on both sides of a picture that is shown twice.
    let turned = 10.0 * 0.03 / 2.0;
    for number in [1, 2] {
        assert!((moved(number).unwrap() - turned).abs() < 1e-9, "{:?}", moved(number));
    }
    assert_eq!([0, 3, 4, 5, 6].map(moved), [None; 5]);
}
