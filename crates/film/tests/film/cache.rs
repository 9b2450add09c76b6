//! Frames that are held while a film is looked at.

use scaleproof_film::cache::FrameCache;
use scaleproof_film::tracking::FrameResult;
use scaleproof_video::{Picture, Pixels, Planes};

use super::{bins, criteria, frame};

fn planes() -> Planes {
    let size = [8, 8];
    let picture = Picture::from_bytes(size, vec![128; Picture::length(size)]).unwrap();
    picture.planes().unwrap().clone()
}

#[test]
fn the_best_frames_of_a_long_film_are_held_and_no_more_than_fit() {
    let bins = bins();
    let criteria = criteria(&bins, 2);
    // Three rounds; the sharpness goes up and down otherwise in each.
    let looks: Vec<FrameResult> = (0..1080)
        .map(|n| frame(n, (n % 360) as f64, 0.5 + (n as f64 * 0.37).sin().abs() * 2.0))
        .collect();
    let most_bytes = 60 * planes().length();
    let mut held = FrameCache::up_to(most_bytes);
    for looked in 1..=looks.len() {
        held.add(planes(), &looks[..looked], &criteria, |looks| criteria.best(looks));
        assert!(held.bytes() <= most_bytes);
    }
    let chosen = criteria.best(&looks);
    assert_eq!(chosen.len(), 16);
    assert!(chosen.iter().all(|one| held.frame(looks[one.at].number).is_some()));
}

#[test]
fn frames_too_large_to_hold_many_are_not_held() {
    let bins = bins();
    let criteria = criteria(&bins, 1);
    let mut held = FrameCache::up_to(10 * planes().length());
    held.add(planes(), &[frame(0, 0.0, 0.5)], &criteria, |looks| criteria.best(looks));
    assert_eq!(held.bytes(), 0);
}
