//! What a comparison calls shown, of simulated photos: rarely anything where nothing differs, and what differs as often as before, nearly.

use crate::common;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_detect::{Detection, Manifest};
use scaleproof_score::score::{
    ApDefinition, ClusteredBy, Comparison, Criteria, Finding, Options, ScoredPhoto, Scores, SequentialFinding, compare,
    evaluated_detectors, score, sequential,
};
use scaleproof_session::session::Session;

/// Each with one photo of each of eight directions and texture: 24 clusters.
const PLACES: [&str; 3] = ["a", "b", "c"];
const TEXTURES: [&str; 3] = ["normal", "checker", "random"];

/// The stored session by its five stored detectors.
fn stored() -> Scores {
    let session = Session::open(&common::skyline()).unwrap();
    let manifests = Manifest::all().unwrap();
    let stored = manifests.into_iter().filter(|m| {
        common::skyline()
            .join("recorded")
            .join(format!("{}.json", m.name))
            .exists()
            || common::skyline().join("recorded").join(&m.name).exists()
    });
    let sessions = vec![session];
    let detectors = evaluated_detectors(&sessions, stored.collect(), None).unwrap();
    assert_eq!(detectors.len(), 5);
    score(sessions, detectors, &Options::default(), || {}).unwrap()
}

/// The model is hit with `rate`, more or less by view as all detectors find it easy, with `less` where a texture works on a detector.
fn experiment(
    scores: Scores,
    views: &[ScoredPhoto],
    rng: &mut Pcg64Mcg,
    rate: f64,
    less: impl Fn(usize, &str) -> f64,
) -> Scores {
    let mut photos = Vec::new();
    for (place, view) in PLACES
        .iter()
        .flat_map(|place| views.iter().map(move |view| (place, view)))
    {
        let ease: f64 = rng.random_range(-0.15..0.15);
        for texture in TEXTURES {
            let mut photo = view.clone();
            (photo.id, photo.variant, photo.place) =
                (photos.len() as u64 + 1, texture.to_owned(), Some((*place).to_owned()));
            photo.detections = (0..scores.detectors.len())
                .map(|i| {
                    let is_hit = rng.random_bool((rate + ease - less(i, texture)).clamp(0.0, 1.0));
                    let confidence = rng.random_range(0.5..1.0);
                    let label = scores.detectors[i].counted[0];
                    is_hit
                        .then(|| Detection::new(label, confidence, photo.truth).unwrap())
                        .into_iter()
                        .collect()
                })
                .collect();
            photos.push(photo);
        }
    }
    let mut scores = scores;
    scores.photos = photos;
    scores.judged_by(Criteria::default())
}

/// Whether anything is called shown, in any figure or direction.
fn is_any_shown(comparison: &Comparison) -> bool {
    let figures = comparison.results.iter().flat_map(|r| {
        let own = [r.hit_rate.rate.finding, r.mean_confidence.finding, r.ap50.finding];
        own.into_iter()
            .chain(r.azimuth_bins.iter().map(|bin| bin.hits.rate.finding))
    });
    figures.into_iter().any(Finding::is_shown)
}

/// Five detectors × two textures, 24 pairs each. All 5,000 experiments: `SCALEPROOF_EXPERIMENTS=5000`.
#[test]
fn where_nothing_differs_hardly_anything_is_called_shown() {
    let experiments = common::number("SCALEPROOF_EXPERIMENTS").unwrap_or(60_u32);
    let mut rng = Pcg64Mcg::seed_from_u64(43);
    let (mut shown, mut alone, mut by_looks) = (0, 0, 0);
    let mut scores = stored();
    // One of each direction.
    let views = scores.photos[..8].to_vec();
    for _ in 0..experiments {
        scores = experiment(scores, &views, &mut rng, 0.7, |_, _| 0.0);
        let comparison = compare(&scores, "normal", ApDefinition::Coco101).unwrap();
        assert_eq!((comparison.results.len(), comparison.results[0].tests), (10, 10));
        shown += u32::from(is_any_shown(&comparison));
        alone += u32::from(comparison.results.iter().any(|r| {
            let is_away =
                |d: &scaleproof_score::score::Difference| d.interval_95.is_some_and(|i| i.low > 0.0 || i.high < 0.0);
            r.hit_rate.mcnemar_p < 0.05 || is_away(&r.mean_confidence) || is_away(&r.ap50)
        }));
        let looks = sequential(&scores, "normal", ClusteredBy::PlaceAndBin, None).unwrap();
        let changed = |finding| finding != SequentialFinding::Undecided;
        by_looks += u32::from(
            looks
                .results
                .iter()
                .any(|c| changed(c.hit_rate.finding) || changed(c.mean_confidence.finding)),
        );
    }
    let share = |count: u32| f64::from(count) / f64::from(experiments);
    println!(
        "{experiments} experiments without a difference, 5 detectors × 2 textures: anything called shown in {:.2} %, look by look in {:.2} %; uncorrected in {:.1} %",
        100.0 * share(shown),
        100.0 * share(by_looks),
        100.0 * share(alone)
    );
    // Two standard errors above the promise.
    let most = 0.05 + 2.0 * (0.05 * 0.95 / f64::from(experiments)).sqrt();
    assert!(share(shown) <= most && share(by_looks) <= most, "{shown} {by_looks}");
    assert!(share(alone) > 0.2, "the simulation cannot tell: {alone}");
}

/// How often a real drop of the hit rate is shown, by itself and after correction for ten tests.
#[test]
fn what_differs_is_shown_a_little_less_often() {
    let experiments = common::number("SCALEPROOF_EXPERIMENTS").unwrap_or(20_u32);
    let mut scores = stored();
    // One of each direction.
    let views = scores.photos[..8].to_vec();
    let mut rng = Pcg64Mcg::seed_from_u64(44);
    for (what, is_all) in [
        ("of one detector on one texture", false),
        ("of every detector on both", true),
    ] {
        for drop in [0.3, 0.5, 0.7] {
            let (mut corrected, mut alone) = (0, 0);
            for _ in 0..experiments {
                let less = |i: usize, texture: &str| {
                    let is_one = i == 0 && texture == "checker";
                    if texture != "normal" && (is_all || is_one) {
                        drop
                    } else {
                        0.0
                    }
                };
                scores = experiment(scores, &views, &mut rng, 0.8, less);
                let comparison = compare(&scores, "normal", ApDefinition::Coco101).unwrap();
                let one = comparison.results.iter().find(|r| r.variant == "checker").unwrap();
                corrected += u32::from(one.hit_rate.rate.finding == Finding::Drop);
                alone += u32::from(one.hit_rate.mcnemar_p < 0.05 && one.hit_rate.rate.drop > 0.0);
            }
            let share = |count: u32| f64::from(count) / f64::from(experiments);
            println!(
                "a drop of {drop} from 0.8 {what}, 24 pairs: shown in {:.3}, uncorrected in {:.3}",
                share(corrected),
                share(alone)
            );
            assert!(corrected <= alone);
            assert!(
                drop < 0.7 || share(corrected) > 0.8,
                "{what}: {corrected} of {experiments}"
            );
        }
    }
}
