//! The crate's tests: which frames are chosen. The stored walk is tested through the program.

#[path = "film/cache.rs"]
mod cache;
#[path = "film/motion.rs"]
mod motion;
#[path = "film/tracking.rs"]
mod tracking;

use proptest::prelude::*;

use scaleproof_film::choose::{Refusal, SelectionCriteria, apart_deg, count_refusals};
use scaleproof_film::tracking::{FrameResult, NoPose, View};
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::{Bins, Viewpoint};

fn bins() -> Bins {
    Bins {
        azimuth_deg: 45.0,
        pitch_deg: vec![15.0],
        distance_mm: vec![850.0],
    }
}

fn criteria(bins: &Bins, per_bin: usize) -> SelectionCriteria<'_> {
    SelectionCriteria {
        bins,
        most_blur_px: 3.0,
        per_bin,
        apart_s: 0.3,
    }
}

/// A frame that could be chosen, but for what a test changes.
fn frame(number: u64, azimuth_deg: f64, blur_px: f64) -> FrameResult {
    FrameResult {
        number,
        time_s: number as f64 / 10.0,
        key: 0,
        shows: Ok(View {
            viewpoint: Viewpoint {
                azimuth_deg,
                pitch_deg: 15.0,
                distance_mm: 850.0,
            },
            moved: Some(Sigma {
                azimuth_deg: 0.0,
                pitch_deg: 0.0,
                distance_mm: 0.0,
            }),
            blur_px: Some(blur_px),
            is_model_whole: true,
            bin_probability: 1.0,
        }),
    }
}

fn with(look: FrameResult, change: impl Fn(&mut View)) -> FrameResult {
    let mut view = look.shows.unwrap();
    change(&mut view);
    FrameResult {
        shows: Ok(view),
        ..look
    }
}

fn moving(look: FrameResult, azimuth_deg: f64) -> FrameResult {
    with(look, |view| {
        view.moved = view.moved.map(|moved| Sigma { azimuth_deg, ..moved })
    })
}

#[test]
fn each_fault_is_named() {
    let bins = bins();
    let good = frame(0, 10.0, 0.6);
    let cases = [
        (
            FrameResult {
                shows: Err(NoPose::NoTags),
                ..good
            },
            Refusal::NoTags,
        ),
        (
            FrameResult {
                shows: Err(NoPose::Unsure),
                ..good
            },
            Refusal::Unsure,
        ),
        (
            FrameResult {
                shows: Err(NoPose::Blurred),
                ..good
            },
            Refusal::Blurred,
        ),
        (with(good, |v| v.is_model_whole = false), Refusal::ModelCut),
        (with(good, |v| v.blur_px = Some(3.1)), Refusal::Blurred),
        (with(good, |v| v.blur_px = None), Refusal::BlurUnknown),
        (with(good, |v| v.moved = None), Refusal::MotionUnknown),
        (with(good, |v| v.viewpoint.pitch_deg = 22.0), Refusal::Pitch),
        (with(good, |v| v.viewpoint.distance_mm = 700.0), Refusal::Distance),
        (with(good, |v| v.bin_probability = 0.9), Refusal::BinEdge),
    ];
    assert_eq!(criteria(&bins, 1).refusal(&good), None);
    for (look, expected) in cases {
        assert_eq!(criteria(&bins, 1).refusal(&look), Some(expected));
    }
    let looks: Vec<FrameResult> = cases.iter().map(|(look, _)| *look).chain([good]).collect();
    assert_eq!(
        count_refusals(&criteria(&bins, 1), &looks).values().sum::<usize>(),
        cases.len()
    );
}

#[test]
fn the_sharpest_of_each_bin_are_chosen_apart_in_time() {
    let bins = bins();
    // Of equally sharp frames (1, 2) the one that moves less; frame 3 is too soon after it for a second one.
    let looks = [
        moving(frame(0, 350.0, 0.71), 0.3),
        moving(frame(1, 356.0, 0.61), 0.2),
        moving(frame(2, 1.0, 0.62), 0.1),
        moving(frame(3, 4.0, 0.7), 0.2),
        moving(frame(6, 10.0, 0.7), 0.2),
        frame(9, 60.0, 1.4),
    ];
    let numbers = |per_bin| -> Vec<u64> {
        criteria(&bins, per_bin)
            .best(&looks)
            .iter()
            .map(|one| looks[one.at].number)
            .collect()
    };
    assert_eq!(numbers(1), [2, 9]);
    assert_eq!(numbers(2), [2, 6, 9]);
}

#[test]
fn pairs_are_the_nearest_and_no_frame_serves_two() {
    let bins = bins();
    let looks = [frame(0, 1.0, 0.6), frame(1, 3.0, 0.6), frame(2, 50.0, 0.6)];
    let at = |azimuth_deg| Viewpoint {
        azimuth_deg,
        pitch_deg: 15.0,
        distance_mm: 850.0,
    };
    // The first two want frame 0; the nearer one gets it. The last is 9° from any frame.
    let wanted = [at(0.0), at(1.2), at(59.0)];
    let chosen = criteria(&bins, 1).nearest(&looks, &wanted);
    let pairs: Vec<(usize, usize)> = chosen.iter().map(|one| (one.at, one.pair.unwrap().0)).collect();
    assert_eq!(pairs, [(0, 1), (1, 0)]);
}

#[test]
fn viewpoints_are_apart_by_the_way_between_them() {
    let at = |azimuth_deg, pitch_deg, distance_mm| Viewpoint {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    };
    // A chord of 2 sin(½·1°) for a turn of 1° on the ground; 1 % nearer is 0.573°.
    assert!((apart_deg(&at(359.5, 0.0, 850.0), &at(0.5, 0.0, 850.0)) - 1.0).abs() < 1e-4);
    assert!((apart_deg(&at(40.0, 10.0, 1000.0), &at(40.0, 10.0, 990.0)) - 0.573).abs() < 1e-3);
}

#[test]
fn a_bin_has_blurred_frames_only_where_it_has_no_sharp_one() {
    let bins = bins();
    let looks = [
        frame(0, 350.0, 2.4),
        frame(10, 0.0, 1.0),
        frame(20, 10.0, 0.9),
        frame(30, 80.0, 2.6),
        frame(40, 90.0, 2.0),
        frame(50, 100.0, 2.9),
    ];
    let chosen: Vec<usize> = criteria(&bins, 3).best(&looks).iter().map(|one| one.at).collect();
    assert_eq!(chosen, [1, 2, 4]);
}

proptest! {
    /// The issue's own rule, counted here for any walk.
    #[test]
    fn no_frame_blurred_above_one_and_a_half_px_is_chosen_where_a_sharper_one_is_within_5_degrees(
        walk in proptest::collection::vec((0.0..360.0f64, 0.4..2.9f64), 1..60), per_bin in 1usize..4,
    ) {
        let bins = bins();
        let look = |(n, (azimuth, blur)): (u64, &(f64, f64))| frame(10 * n, *azimuth, *blur);
        let looks: Vec<FrameResult> = (0..).zip(&walk).map(look).collect();
        for one in criteria(&bins, per_bin).best(&looks) {
            let (azimuth, blur) = walk[one.at];
            let is_beside = |other: &(f64, f64)| {
                let turn = (other.0 - azimuth).abs();
                other.1 < blur && turn.min(360.0 - turn) <= 5.0
            };
            prop_assert!(blur <= 1.5 || !walk.iter().any(is_beside));
        }
    }
}
