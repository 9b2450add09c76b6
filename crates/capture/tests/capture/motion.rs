//! The gate's promise: no frame is taken whose blur is above the limit in any direction, or cannot be measured.

use std::collections::BTreeMap;
use std::path::Path;

use image::{GrayImage, Luma};
use scaleproof_capture::{Advice, FrameJudgement, Guidance, Judge, MAX_BLUR_PX, Tolerance};
use scaleproof_photo::Photo;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::TagDetectorChoice;

/// What lens and pixel leave in these renders, px (`docs/lessons/capture.md`).
const OWN_PX: f64 = 0.5;

/// A photo of the stored session in luma.
fn photo(number: u32) -> GrayImage {
    let file = format!("../../captures/skyline/normal_{number:03}.jpg");
    let rgb = Photo::open(Path::new(env!("CARGO_MANIFEST_DIR")).join(file).as_path());
    image::imageops::grayscale(&rgb.unwrap().rgb(1).unwrap())
}

/// The picture of a camera that moves by `length` px at a steady pace while the shutter is open: the mean of its light (sRGB as a power of 2.2).
fn moved(image: &GrayImage, length: f64, direction_deg: f64) -> GrayImage {
    let (sin, cos) = direction_deg.to_radians().sin_cos();
    let samples = 64 * length.ceil() as i32;
    let mut taps: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for i in 0..samples {
        let way = length * ((f64::from(i) + 0.5) / f64::from(samples) - 0.5);
        *taps
            .entry(((way * sin).round() as i64, (way * cos).round() as i64))
            .or_default() += 1.0 / f64::from(samples);
    }
    let light: Vec<f32> = (0..=255).map(|v| (f64::from(v) / 255.0).powf(2.2) as f32).collect();
    let level: Vec<u8> = (0..=4095)
        .map(|v| (255.0 * (f64::from(v) / 4095.0).powf(1.0 / 2.2)).round() as u8)
        .collect();
    let (width, height) = (i64::from(image.width()), i64::from(image.height()));
    let before: Vec<f32> = image.iter().map(|v| light[usize::from(*v)]).collect();
    let mut after = vec![0f32; before.len()];
    for ((dy, dx), share) in taps {
        for (y, row) in (0..).zip(after.chunks_exact_mut(width as usize)) {
            let from = &before[((y + dy).clamp(0, height - 1) * width) as usize..][..width as usize];
            for (x, sum) in (0..).zip(row) {
                *sum += share as f32 * from[(x + dx).clamp(0, width - 1) as usize];
            }
        }
    }
    let levels = after
        .iter()
        .map(|sum| level[(4095.0 * sum).round().min(4095.0) as usize]);
    GrayImage::from_raw(image.width(), image.height(), levels.collect()).unwrap()
}

/// The standard deviation along the motion: a uniform motion of L px has variance L²/12.
fn blur_of(length: f64) -> f64 {
    (OWN_PX.powi(2) + length.powi(2) / 12.0).sqrt()
}

/// Judges frames of the stored session as photos taken one by one, every view being open.
struct Gate {
    judge: Judge,
    camera: Camera,
    guidance: Guidance,
}

impl Gate {
    fn open() -> Gate {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../captures/skyline");
        let scene = Scene::open(&folder.join("scene.toml")).unwrap();
        let (pitch, distance) = scene.bins.usual_view();
        let views = scene.bins.viewpoints(&[pitch], &[distance]);
        let tolerance = Tolerance::of_bins(&scene.bins, &[distance]);
        Gate {
            judge: Judge::new(&scene, TagDetectorChoice::default(), false).unwrap(),
            camera: Camera::open(&folder.join("camera.yaml")).unwrap(),
            guidance: Guidance::at(&views, tolerance, &scene.bins),
        }
    }

    fn judge(&mut self, frame: &GrayImage) -> FrameJudgement {
        self.judge.judge(frame, 0, &self.camera, &self.guidance)
    }
}

/// Motion of every direction, from a little above the limit to what hides the tags. Blur near the limit reads 0.95 to 1.23 of what it is: a normal
/// edge fitted to the ramp of a steady motion is wider.
#[test]
fn no_frame_is_taken_whose_motion_is_above_the_limit_or_cannot_be_measured() {
    let mut gate = Gate::open();
    let (mut measured, mut refused) = (0, 0);
    for number in 0..8 {
        let sharp = photo(number);
        assert!(gate.judge(&sharp).verdict.is_ok(), "photo {number} as it is");
        for step in 0..4 {
            let direction = 45.0 * f64::from(step) + 5.0 * f64::from(number);
            for length in [3.0, 6.0, 9.0, 15.0, 20.0] {
                let judgement = gate.judge(&moved(&sharp, length, direction));
                let what = format!(
                    "photo {number} moved by {length} px at {direction}°: {:?}",
                    judgement.measures
                );
                let truth = blur_of(length);
                match judgement.verdict {
                    Ok(_) => assert!(truth <= MAX_BLUR_PX && judgement.measures.blur_px.is_some(), "{what}"),
                    Err(advice) => {
                        assert!(length > 3.0, "{what}: {advice}");
                        refused += 1;
                    }
                }
                if let (Some(px), true) = (judgement.measures.blur_px, truth < 2.0) {
                    assert!((0.9..1.3).contains(&(px / truth)), "{what}, and it is {truth:.2}");
                    measured += 1;
                }
            }
        }
    }
    assert_eq!(refused, 8 * 4 * 4);
    assert!(measured >= 50, "{measured}");
}

/// One tag, seen from the front: its sides lie one way, and motion along its diagonal widens all of them alike.
#[test]
fn a_square_that_lies_straight_does_not_hide_motion_along_its_diagonal() {
    use scaleproof_pose::scene::TagFamily;
    use scaleproof_pose::tags::{Appearance, SeenTag};
    let inside = |v: u32| (40..120).contains(&v);
    let square = GrayImage::from_fn(160, 160, |x, y| Luma([if inside(x) && inside(y) { 30 } else { 220 }]));
    let corners_px = [[39.5, 39.5], [119.5, 39.5], [119.5, 119.5], [39.5, 119.5]];
    let tag = SeenTag {
        id: 0,
        family: TagFamily::Tag36h11,
        corners_px,
        is_whole: true,
        is_fitted: true,
        side_blurs_px: None,
    };
    for direction in [0.0, 45.0, 90.0, 135.0] {
        let px = Appearance::measure(&moved(&square, 6.0, direction), std::slice::from_ref(&tag)).blur_px;
        assert!(px.is_some_and(|px| px > MAX_BLUR_PX), "{direction}°: {px:?}");
    }
}

/// Dirt on the black border of each tag, amid two sides: the pose is there, and whether the photo is sharp is not known.
#[test]
fn a_frame_without_a_whole_tag_is_refused_for_that_reason() {
    let mut gate = Gate::open();
    let mut frame = photo(0);
    for tag in gate.judge(&frame).seen {
        let [a, b, c, d] = tag.corners_px;
        let at = |u: f64, v: f64| {
            [0, 1].map(|k| (1.0 - v) * ((1.0 - u) * a[k] + u * b[k]) + v * ((1.0 - u) * d[k] + u * c[k]))
        };
        // Half a cell inside the outline, which is eight cells wide.
        for (along, v) in (0..100).flat_map(|i| [(i, 1.0 / 16.0), (i, 15.0 / 16.0)]) {
            let [x, y] = at(0.3 + 0.004 * f64::from(along), v).map(|v| v.round().max(0.0) as u32);
            if x < frame.width() && y < frame.height() {
                frame.put_pixel(x, y, Luma([200]));
            }
        }
    }
    let judgement = gate.judge(&frame);
    assert!(
        judgement.located.is_some() && judgement.seen.iter().all(|tag| !tag.is_whole),
        "{:?}, {:?}",
        judgement.verdict,
        judgement.seen
    );
    assert_eq!(judgement.measures.blur_px, None);
    assert_eq!(judgement.verdict, Err(Advice::Unmeasured));
}
