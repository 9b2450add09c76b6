//! Frames of a simulated walk with a hand's shake and a rolling shutter: the video tells the read-out, and the poses at the middle row are as near to the truth as σ says.

use std::path::Path;

use nalgebra::{Point3, Vector2, Vector6};

use scaleproof_core::geometry::Rigid;
use scaleproof_core::geometry::rigid::{stepped, to_rotation_vector};
use scaleproof_film::exposure;
use scaleproof_film::look::{Look, Motion, View};
use scaleproof_film::motion::{self, ReadOut, Track, at_middle_row};
use scaleproof_film::side::Side;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{ShutterResponse, locate};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::simulate::{Noise, Simulator, looking_at};
use scaleproof_pose::tags::{EdgeBlur, SeenTag};

const FRAMES_PER_S: f64 = 30.0;
const FRAMES: u64 = 360;
/// Each so-manieth is looked at.
const EVERY: u64 = 2;

struct Walk {
    scene: Scene,
    camera: Camera,
    read_out_s: f64,
    exposure_s: f64,
    turned_deg: u32,
}

impl Walk {
    fn new(read_out_s: f64, turned_deg: u32) -> Walk {
        let walk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../captures/walk");
        Walk {
            scene: Scene::open(&walk.join("scene.toml")).unwrap(),
            camera: Camera::open(&walk.join("camera.yaml")).unwrap(),
            read_out_s,
            exposure_s: 0.01,
            turned_deg,
        }
    }

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

    /// The tags of a frame whose middle row is read at a time.
    fn seen(&self, t: f64, simulator: &mut Simulator) -> Vec<SeenTag> {
        let still = self.pose(t);
        let mut seen = simulator.seen(&still);
        for tag in &mut seen {
            let corners = self
                .scene
                .tags
                .iter()
                .find(|one| one.id == tag.id)
                .unwrap()
                .corners_mm();
            for (px, corner) in tag.corners_px.iter_mut().zip(&corners) {
                let moved = self
                    .camera
                    .project(&(self.pose(t + self.late_s(*px)) * corner))
                    .unwrap();
                let unmoved = self.camera.project(&(still * corner)).unwrap();
                *px = [0, 1].map(|axis| px[axis] + moved[axis] - unmoved[axis]);
            }
        }
        seen
    }

    /// How far a point moves in the image during the exposure, px.
    fn moved(&self, t: f64, point: &Point3<f64>) -> Vector2<f64> {
        let at = |t: f64| Vector2::from(self.camera.project(&(self.pose(t) * point)).unwrap());
        at(t + self.exposure_s / 2.0) - at(t - self.exposure_s / 2.0)
    }

    /// The blur of each side: what the lens leaves, and the uniform line that motion draws across it.
    fn blurs(&self, t: f64, seen: &[SeenTag]) -> Vec<EdgeBlur> {
        let blur = |(tag, side): (usize, usize)| {
            let [from, to] = [side, (side + 1) % 4];
            let corners = self
                .scene
                .tags
                .iter()
                .find(|one| one.id == seen[tag].id)
                .unwrap()
                .corners_mm();
            let [a, b] = [from, to].map(|corner| Vector2::from(seen[tag].corners_px[corner]));
            let normal = Vector2::new(a.y - b.y, b.x - a.x).normalize();
            let late_s = self.late_s(((a + b) / 2.0).into());
            let across = self
                .moved(t + late_s, &nalgebra::center(&corners[from], &corners[to]))
                .dot(&normal);
            // A shadow lies on each ninth.
            let shadow = if (tag + side).is_multiple_of(9) { 2.0 } else { 0.0 };
            let px = (0.5_f64.powi(2) + across.powi(2) / 12.0 + shadow).sqrt();
            EdgeBlur {
                tag,
                side,
                normal: normal.into(),
                px,
            }
        };
        (0..seen.len())
            .flat_map(|tag| (0..4).map(move |side| (tag, side)))
            .map(blur)
            .collect()
    }

    /// The sensor's first row is on top of an image that was not turned, and on the right of one that was turned clockwise by 90°.
    fn late_s(&self, [x, y]: [f64; 2]) -> f64 {
        let [width, height] = [self.camera.width, self.camera.height].map(f64::from);
        let share = match self.turned_deg {
            90 => (width / 2.0 - x) / width,
            180 => (height / 2.0 - y) / height,
            270 => (x - width / 2.0) / width,
            _ => (y - height / 2.0) / height,
        };
        self.read_out_s * share
    }

    /// All frames located, as looks.
    fn frames(&self) -> Vec<Look> {
        let noise = Noise {
            sigma_px: 0.05,
            tail_share: 0.02,
        };
        let mut simulator = Simulator::new(&self.scene, &self.camera, noise, 7);
        let look = |number: u64| {
            let time_s = number as f64 / FRAMES_PER_S;
            let seen = self.seen(time_s, &mut simulator);
            let located = locate(&seen, &self.scene, &self.camera).unwrap();
            let view = View {
                viewpoint: located.viewpoint,
                pose: to_rotation_vector(&located.pose).into(),
                response: ShutterResponse::new(&located, &seen, &self.scene, &self.camera, self.turned_deg),
                motion: None,
                blur_px: Some(0.6),
                sides: Side::some(
                    number,
                    &self.blurs(time_s, &seen),
                    &seen,
                    &located,
                    &self.scene,
                    &self.camera,
                ),
                smear_px: None,
                is_model_whole: true,
                bin_probability: 1.0,
            };
            Look {
                number,
                time_s,
                key: 0,
                shows: Ok(view),
            }
        };
        (0..FRAMES).map(look).collect()
    }
}

fn view(look: &Look) -> &View {
    look.shows.as_ref().unwrap()
}

fn turn(from: f64, to: f64) -> f64 {
    (to - from + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn a_video_tells_its_read_out_and_poses_are_those_of_the_middle_row() {
    for (read_out_s, turned_deg) in [(0.0, 0), (0.01, 180), (0.02, 90), (0.03, 270), (0.02, 0)] {
        let walk = Walk::new(read_out_s, turned_deg);
        let frames = walk.frames();
        let mut looks: Vec<Look> = frames.iter().step_by(EVERY as usize).copied().collect();
        motion::set(&mut looks);
        let ReadOut { seconds, sigma_s } = motion::read_out(&looks);
        assert!(
            (seconds - read_out_s).abs() < 3.0 * sigma_s && sigma_s < 0.0015,
            "{read_out_s} s, turned by {turned_deg}: {seconds} ± {sigma_s}"
        );
        // Every frame with those beside it, as frames that are kept.
        let track = Track::new(&frames);
        let moved: Vec<(&Look, Motion)> = frames
            .iter()
            .filter_map(|look| Some((look, track.motion(look.number)?)))
            .collect();
        assert!(moved.len() as u64 >= FRAMES - 2);
        let usual: Vec<Vector6<f64>> = moved.iter().step_by(20).map(|(_, motion)| motion.doubt).collect();
        let (mut errors, mut uncorrected) = (Vec::new(), 0.0_f64);
        for (look, motion) in moved {
            let target = walk.scene.model.target_mm();
            let of = |pose: Rigid| Viewpoint::from_camera(pose.inverse() * Point3::origin(), target).azimuth_deg;
            let truth = of(walk.pose(look.time_s));
            let response = view(look).response.unwrap();
            let (pose, sigma) = at_middle_row(
                &view(look).pose(),
                &response,
                &motion,
                ReadOut { seconds, sigma_s },
                &usual,
                &walk.scene,
            );
            errors.push((turn(truth, of(pose)), sigma.azimuth_deg));
            uncorrected = uncorrected.max(turn(truth, view(look).viewpoint.azimuth_deg).abs());
        }
        let worst = errors.iter().map(|(off, _)| off.abs()).fold(0.0, f64::max);
        assert!(worst < 0.1, "{read_out_s} s, turned by {turned_deg}: {worst}°");
        assert!(
            read_out_s < 0.015 || uncorrected > 2.0 * worst,
            "{uncorrected}° uncorrected, {worst}° corrected"
        );
        // What the corners' noise adds, by the still camera's errors: 0.01°.
        let within = |k: f64| {
            errors
                .iter()
                .filter(|(off, sigma)| off.abs() < k * sigma.hypot(0.01))
                .count() as f64
                / errors.len() as f64
        };
        assert!(within(1.0) > 0.6 && within(2.0) > 0.93 && within(3.0) > 0.985);
    }
}

#[test]
fn a_video_tells_its_exposure_and_how_far_each_frame_is_smeared() {
    for exposure_s in [0.004, 0.01, 0.03] {
        let walk = Walk {
            exposure_s,
            ..Walk::new(0.02, 0)
        };
        let mut looks = walk.frames();
        motion::set(&mut looks);
        let found = exposure::exposure_s(&looks);
        assert!((found / exposure_s - 1.0).abs() < 0.1, "{found} s, not {exposure_s}");
        let mut off = Vec::new();
        for look in looks.iter().filter(|look| look.smear_px().is_some()) {
            let square = |corner: &Point3<f64>| walk.moved(look.time_s, corner).norm_squared();
            let corners = walk.scene.model.box_corners_mm();
            let truth = (corners.iter().map(square).sum::<f64>() / corners.len() as f64).sqrt();
            off.push((look.smear_px().unwrap() - truth).abs() / truth.max(0.5));
        }
        off.sort_by(f64::total_cmp);
        assert!(
            off.len() as u64 >= FRAMES - 2 && off[off.len() * 9 / 10] < 0.2,
            "{exposure_s} s: {}",
            off[off.len() * 9 / 10]
        );
    }
}

#[test]
fn a_hand_that_turns_back_is_seen_from_both_sides_and_a_gap_leaves_the_motion_open() {
    let walk = Walk::new(0.0, 0);
    let pose = |t: f64| {
        stepped(
            &walk.pose(0.0),
            &Vector6::from_fn(|k, _| if k == 3 { 40.0 * t - 300.0 * t * t } else { 0.0 }),
        )
    };
    let mut track = Track::default();
    for number in [0, 1, 2, 3, 4, 5, 6, 60, 62] {
        let t = number as f64 / FRAMES_PER_S;
        track.add(number, t, pose(t));
    }
    // At 2/30 s the camera stands still, and the frame before says 10 mm/s.
    let still = track.motion(2).unwrap();
    assert!(still.per_s.norm() < 1e-6, "{}", still.per_s);
    assert!(still.doubt.norm() < 1e-6);
    // One neighbour on each side: what they differ by is doubted.
    let few = track.motion(1).unwrap();
    assert!((few.per_s - Vector6::new(0.0, 0.0, 0.0, 20.0, 0.0, 0.0)).norm() < 1e-6);
    assert!(few.doubt.norm() >= 10.0);
    assert_eq!(track.motion(0), None);
    assert_eq!(track.motion(6), None);
    assert_eq!(track.motion(60), None);
}
