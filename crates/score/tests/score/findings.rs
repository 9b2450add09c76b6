//! What a comparison calls shown, of simulated photos: rarely anything where nothing differs, and what differs nearly always; and by hand.

use crate::common;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_detect::{Detection, Manifest};
use scaleproof_score::report;
use scaleproof_score::{
    ApDefinition, ClusteredBy, Compared, Comparison, Criteria, Effect, Options, ScoredPhoto, Scores, SequentialFinding,
    compare, evaluated_detectors, score, sequential,
};
use scaleproof_session::Session;

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

/// Photos of every texture at every place from every view, in which each detector finds the model with the confidence that is given by (detector, texture, place,
/// view); not at all with 0.
fn photographed(
    scores: Scores,
    views: &[ScoredPhoto],
    places: &[&str],
    textures: &[&str],
    mut confidence: impl FnMut(usize, &str, usize, usize) -> f64,
) -> Scores {
    let mut photos = Vec::new();
    for (at, place) in places.iter().enumerate() {
        for (v, view) in views.iter().enumerate() {
            for texture in textures {
                let mut photo = view.clone();
                (photo.id, photo.variant, photo.place) = (
                    photos.len() as u64 + 1,
                    (*texture).to_owned(),
                    Some((*place).to_owned()),
                );
                let detections = (0..scores.detectors.len()).map(|i| {
                    let confidence = confidence(i, texture, at, v);
                    let label = scores.detectors[i].counted[0];
                    let found = (confidence > 0.0).then(|| Detection::new(label, confidence, photo.truth).unwrap());
                    found.into_iter().collect()
                });
                photo.detections = detections.collect();
                photos.push(photo);
            }
        }
    }
    let mut scores = scores;
    scores.photos = photos;
    scores.judged_by(Criteria::default())
}

/// Confidence about 0.7, more or less by view as all detectors find it easy (0.15) and in each photo (0.12), with `less` where a texture works on a detector.
fn experiment(scores: Scores, views: &[ScoredPhoto], rng: &mut Pcg64Mcg, less: impl Fn(usize, &str) -> f64) -> Scores {
    let ease: Vec<f64> = (0..PLACES.len() * views.len()).map(|_| 0.15 * normal(rng)).collect();
    photographed(scores, views, &PLACES, &TEXTURES, |i, texture, place, view| {
        let confidence = 0.7 + ease[place * views.len() + view] - less(i, texture) + 0.12 * normal(rng);
        confidence.clamp(0.0, 1.0)
    })
}

/// Of standard deviation 1 (Box and Muller 1958).
fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let [u, v]: [f64; 2] = [rng.random_range(f64::MIN_POSITIVE..1.0), rng.random_range(0.0..1.0)];
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn compared(scores: &Scores) -> Comparison {
    compare(scores, "normal", ApDefinition::Coco101).unwrap()
}

fn result<'a>(comparison: &'a Comparison, detector: usize, texture: &str) -> &'a Compared {
    let mut own = comparison.results.iter().filter(|r| r.variant == texture);
    own.nth(detector).unwrap()
}

/// Plain and random photos of so many views of one place, with the confidence that is given by (detector, texture, view).
fn of_one_place(views: usize, confidence: impl Fn(usize, &str, usize) -> f64) -> Comparison {
    let scores = stored();
    let views = scores.photos[..views].to_vec();
    let textures = ["normal", "random"];
    compared(&photographed(
        scores,
        &views,
        &["lab"],
        &textures,
        |i, texture, _, view| confidence(i, texture, view),
    ))
}

/// Five detectors × two textures, 24 pairs each. All 5,000 experiments: `SCALEPROOF_EXPERIMENTS=5000`; the same by the thousand, without photos:
/// `cargo bench -p scaleproof-score --bench findings_power`.
#[test]
fn where_nothing_differs_hardly_anything_is_called_shown() {
    let experiments = common::number("SCALEPROOF_EXPERIMENTS").unwrap_or(60_u32);
    let mut rng = Pcg64Mcg::seed_from_u64(43);
    let (mut shown, mut alone, mut by_looks) = (0, 0, 0);
    let mut scores = stored();
    // One of each direction.
    let views = scores.photos[..8].to_vec();
    for _ in 0..experiments {
        scores = experiment(scores, &views, &mut rng, |_, _| 0.0);
        let comparison = compared(&scores);
        assert_eq!(comparison.results.len(), 10);
        shown += u32::from(comparison.results.iter().any(|r| r.effect().is_shown()));
        alone += u32::from(comparison.results.iter().any(|r| {
            let figures = [&r.mean_confidence, &r.hit_rate.rate, &r.ap50];
            figures
                .iter()
                .any(|d| d.interval_95.is_some_and(|i| i.low > 0.0 || i.high < 0.0))
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
        "{experiments} experiments without a difference, 5 detectors × 2 textures: anything called shown in {:.2} %, look by look in {:.2} %; by some interval in {:.1} %",
        100.0 * share(shown),
        100.0 * share(by_looks),
        100.0 * share(alone)
    );
    // Two and a half standard errors above the promise.
    let most = 0.05 + 2.5 * (0.05 * 0.95 / f64::from(experiments)).sqrt();
    assert!(share(shown) <= most && share(by_looks) <= most, "{shown} {by_looks}");
    assert!(share(alone) > 0.2, "the simulation cannot tell: {alone}");
}

/// A drop of 0.3 on one detector of five, of one texture of two.
#[test]
fn a_drop_on_one_detector_is_named_and_hardly_any_other() {
    let experiments = common::number("SCALEPROOF_EXPERIMENTS").unwrap_or(20_u32);
    let mut scores = stored();
    let views = scores.photos[..8].to_vec();
    let mut rng = Pcg64Mcg::seed_from_u64(44);
    let (mut named, mut wrong) = (0, 0);
    for _ in 0..experiments {
        scores = experiment(scores, &views, &mut rng, |i, texture| {
            if i == 1 && texture == "checker" { 0.3 } else { 0.0 }
        });
        let comparison = compared(&scores);
        named += u32::from(matches!(
            result(&comparison, 1, "checker").effect(),
            Effect::Weakens | Effect::Hides
        ));
        let shown = comparison.results.iter().filter(|r| r.effect().is_shown()).count();
        wrong += u32::from(shown > usize::from(result(&comparison, 1, "checker").effect().is_shown()));
    }
    println!("24 pairs, a drop of 0.3 on one detector: named in {named} of {experiments}, another in {wrong}");
    assert!(
        f64::from(named) >= 0.95 * f64::from(experiments),
        "{named} of {experiments}"
    );
    let most = 0.05 + 2.5 * (0.05 * 0.95 / f64::from(experiments)).sqrt();
    assert!(
        f64::from(wrong) <= most * f64::from(experiments),
        "{wrong} of {experiments}"
    );
}

/// Eight views of one place: the same drop of 0.3 in each is the rarest of 2⁸ patterns of signs, with its opposite: p = 2 / 256.
#[test]
fn eight_equal_drops_are_a_finding() {
    let comparison = of_one_place(8, |i, texture, _| if i == 0 && texture == "random" { 0.5 } else { 0.8 });
    let first = result(&comparison, 0, "random");
    let finding = first.finding.unwrap();
    assert_eq!((finding.effect, finding.confidence_p), (Effect::Weakens, 2.0 / 256.0));
    // Of the others all differences are 0: T is 0, which every pattern reaches, and no drop could have been shown less surely.
    for other in 1..5 {
        let finding = result(&comparison, other, "random").finding.unwrap();
        assert_eq!((finding.effect, finding.confidence_p), (Effect::NothingShown, 1.0));
        assert_eq!(finding.drop_shown_from, Some(0.01));
    }
    // Hits at 0.5 are still hits.
    assert_eq!(finding.hit_rate_p, 1.0);
}

/// Six drops of 0.3, one of 0.1 and a rise of 0.1: the patterns that reach their sum are counted by hand.
#[test]
fn ties_count_as_reached() {
    let comparison = of_one_place(8, |i, texture, view| match (i, texture) {
        (0, "random") => [0.7, 0.9, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5][view],
        (_, _) => 0.8,
    });
    // The sum is 0.1 − 0.1 + 6 × 0.3 = 1.8. Patterns of the two small ones beside six large ones of one sign give 1.8, 2.0, 1.6 and 1.8: three of them reach it,
    // and as many with all signs turned.
    let finding = result(&comparison, 0, "random").finding.unwrap();
    assert_eq!(finding.confidence_p, 6.0 / 256.0);
}

/// The first detector's differences are those of [`ties_count_as_reached`]; a second one's reach their T under flips that the first one's do not.
#[test]
fn a_detector_that_is_not_tested_is_in_no_family() {
    let last_is_tested = |is_tested: bool| {
        let mut scores = stored();
        scores.detectors[4].is_tested = is_tested;
        let views = scores.photos[..8].to_vec();
        let confidence = |i, texture: &str, _, view: usize| match (i, texture) {
            (0, "random") => [0.7, 0.9, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5][view],
            (4, "random") => [0.5, 0.5, 0.5, 0.5, 0.7, 0.95, 0.5, 0.5][view],
            (_, _) => 0.8,
        };
        compared(&photographed(
            scores,
            &views,
            &["lab"],
            &["normal", "random"],
            confidence,
        ))
    };
    let [with, without] = [true, false].map(last_is_tested);
    let p = |comparison: &Comparison| result(comparison, 0, "random").finding.unwrap().confidence_p;
    assert_eq!(p(&without), 6.0 / 256.0);
    assert!(p(&with) > p(&without), "{}", p(&with));
    let last = result(&without, 4, "random");
    assert!(last.finding.is_none());
    assert_eq!(
        last.mean_confidence,
        result(&with, 4, "random").mean_confidence,
        "its figures stay"
    );
}

#[test]
fn no_finding_without_evidence() {
    // A detector that does not see the plain model, and never counts, though its confidence falls everywhere.
    let blind = of_one_place(8, |_, texture, _| if texture == "normal" { 0.09 } else { 0.01 });
    assert!(blind.results.iter().all(|r| r.effect() == Effect::BaseUnseen));
    // One pair, five pairs: too few, and it is said how many more.
    for (pairs, missing) in [(1, 5), (5, 1)] {
        let few = of_one_place(pairs, |_, texture, _| if texture == "normal" { 0.9 } else { 0.1 });
        for r in few.results {
            let finding = r.finding.unwrap();
            assert_eq!(
                (finding.effect, finding.views_missing),
                (Effect::NothingShown, missing),
                "{pairs} pairs"
            );
        }
    }
}

/// A texture hides the model where hits fall, too, and at most one view in four is still hit.
#[test]
fn three_words_for_a_change() {
    let comparison = of_one_place(8, |i, texture, view| match (i, texture) {
        (_, "normal") => 0.7,
        // No hit; hits in two of eight; in three of eight; a rise.
        (0, _) => 0.2,
        (1, _) => {
            if view < 2 {
                0.6
            } else {
                0.2
            }
        }
        (2, _) => {
            if view < 3 {
                0.6
            } else {
                0.2
            }
        }
        (3, _) => 0.9,
        (_, _) => 0.7,
    });
    let words = [
        Effect::Hides,
        Effect::Hides,
        Effect::Weakens,
        Effect::Strengthens,
        Effect::NothingShown,
    ];
    for (i, word) in words.into_iter().enumerate() {
        assert_eq!(result(&comparison, i, "random").effect(), word, "detector {i}");
    }
}

/// Eight views of one place, with a second plain round, `again`: with and without it as the control. Confidences are 0.8 in the first.
fn with_and_without_control() -> [(Scores, Comparison); 2] {
    let confidence = |i: usize, texture: &str| match (i, texture) {
        // Both rounds fall alike: the light has changed.
        (0, "random" | "again") => 0.55,
        // The texture takes more than the light; the light took less, and the hits are lost in either.
        (1, "random") => 0.6,
        (1, "again") => 0.7,
        (2, "random") => 0.2,
        (2, "again") => 0.45,
        // The texture's round rises by less than the other falls.
        (3, "random") => 0.9,
        (3, "again") => 0.6,
        (4, "random") => 0.1,
        (_, _) => 0.8,
    };
    [Some("again"), None].map(|control| {
        let scores = stored();
        let views = scores.photos[..8].to_vec();
        let textures = ["normal", "random", "again"];
        let scores = photographed(scores, &views, &["lab"], &textures, |i, texture, _, _| {
            confidence(i, texture)
        });
        let scores = scores.controlled_by(control).unwrap();
        let comparison = compared(&scores);
        (scores, comparison)
    })
}

/// What moves a detector between two plain rounds is no texture's doing.
#[test]
fn a_control_holds_back_what_it_moves_by_as_much() {
    let [(scores, held), (_, free)] = with_and_without_control();
    let words = |comparison: &Comparison| {
        let effects = (0..5).map(|i| result(comparison, i, "random").effect());
        effects.collect::<Vec<_>>()
    };
    use Effect::{Hides, NothingShown, Strengthens, Weakens};
    assert_eq!(words(&free), [Weakens, Weakens, Hides, Strengthens, Hides]);
    assert_eq!(words(&held), [NothingShown, Weakens, Weakens, NothingShown, Hides]);
    let finding = |i: usize| result(&held, i, "random").finding.unwrap();
    let withheld = [Some(Weakens), None, Some(Hides), Some(Strengthens), None];
    assert_eq!([0, 1, 2, 3, 4].map(|i| finding(i).withheld_by_control), withheld);
    // It is no texture: it has no finding, and the one texture has the whole share.
    assert!(held.results.iter().all(|r| r.variant == "random"));
    assert_eq!(finding(1).confidence_level, 0.05);
    let control = held.control.as_ref().unwrap();
    assert_eq!((control.variant.as_str(), control.results.len()), ("again", 5));
    assert!(control.results.iter().all(|r| r.finding.is_none()));
    assert!((control.results[0].mean_confidence.drop - 0.25).abs() < 1e-12);
    // `score` says the same.
    assert_eq!(scaleproof_score::paired(&scores), held.results);
    let screen = report::comparison_table(&scores, &held);
    for (row, times) in [
        (" random   nothing shown (withheld) ", 2),
        (" random   weakens (hides: withheld) ", 1),
        (" again    the control ", 5),
        ("withheld: the control round moves the detector by as much", 1),
    ] {
        assert_eq!(screen.matches(row).count(), times, "{row}: {screen}");
    }
    let text = report::further_comparison(&scores, &held);
    assert!(
        text.contains("nothing shown, p = 0.008; withheld: the control round moves this detector by as much"),
        "{text}"
    );
    assert!(
        text.contains(
            "weakens, p = 0.008; “hides” is withheld: the control round moves the hits of this detector by as much"
        ),
        "{text}"
    );
    let csv = report::comparison_csv(&scores, &held).unwrap();
    assert_eq!(csv.lines().filter(|line| line.contains(",again,")).count(), 15, "{csv}");
    assert_eq!(csv.matches(",control,").count(), 15);
}

#[test]
fn only_another_variant_beside_a_texture_is_a_control() {
    let refused = |textures: &[&str], control| {
        let scores = stored();
        let views = scores.photos[..8].to_vec();
        let scores = photographed(scores, &views, &["lab"], textures, |_, _, _, _| 0.8);
        scores.controlled_by(Some(control)).unwrap_err().to_string()
    };
    let all = ["normal", "random", "again"];
    for (textures, control, words) in [
        (
            &all[..],
            "agian",
            "no photo has the variant `agian`, which is to be the control, only normal, again, random; did you mean again?",
        ),
        (
            &all,
            "normal",
            "the control is the base itself, `normal`: it has to be a second plain round, under another name",
        ),
        (
            &["normal", "again"],
            "again",
            "all photos have the variant `normal` or that of its control, `again`: add those of a texture",
        ),
    ] {
        assert_eq!(refused(textures, control), words);
    }
}

/// The same drop everywhere in three places of eight bins is shown of these places; for places like these three flips of signs are missing with one texture, and
/// four with two, which share the error rate.
#[test]
fn places_like_these_are_another_question() {
    let fallen = |texture: &str| if texture == "random" { 0.4 } else { 0.8 };
    for (textures, missing) in [(&["normal", "random"][..], 3), (&["normal", "random", "same"][..], 4)] {
        let scores = stored();
        let views = scores.photos[..8].to_vec();
        let scores = photographed(scores, &views, &PLACES, textures, |_, texture, _, _| fallen(texture));
        let comparison = compared(&scores);
        for detector in 0..5 {
            let finding = result(&comparison, detector, "random").finding.unwrap();
            assert!(finding.effect.is_shown());
            let like = finding.in_places_like_these.unwrap();
            assert_eq!(
                (like.effect, like.places_missing),
                (Effect::NothingShown, missing),
                "{textures:?}"
            );
        }
    }
    // Six places: 2 / 2⁶ is within 5 %.
    let scores = stored();
    let views = scores.photos[..8].to_vec();
    let six = ["a", "b", "c", "d", "e", "f"];
    let scores = photographed(scores, &views, &six, &["normal", "random"], |_, texture, _, _| {
        fallen(texture)
    });
    let like = result(&compared(&scores), 0, "random")
        .finding
        .unwrap()
        .in_places_like_these
        .unwrap();
    assert_eq!(
        (like.effect, like.places_missing, like.confidence_p),
        (Effect::Hides, 0, 2.0 / 64.0)
    );
}

/// What photos that show nothing would have shown is what such photos show.
#[test]
fn the_drop_that_would_have_been_shown_is_shown_as_often_as_said() {
    let mut scores = stored();
    let views = scores.photos[..8].to_vec();
    let mut rng = Pcg64Mcg::seed_from_u64(45);
    let mut said = Vec::new();
    for _ in 0..40 {
        scores = experiment(scores, &views, &mut rng, |_, _| 0.0);
        said.extend(
            result(&compared(&scores), 0, "checker")
                .finding
                .unwrap()
                .drop_shown_from,
        );
    }
    let drop = said.iter().sum::<f64>() / said.len() as f64;
    let experiments = 60;
    let mut shown = 0;
    for _ in 0..experiments {
        scores = experiment(scores, &views, &mut rng, |i, texture| {
            if i == 0 && texture == "checker" { drop } else { 0.0 }
        });
        shown += u32::from(result(&compared(&scores), 0, "checker").effect().is_shown());
    }
    let share = f64::from(shown) / f64::from(experiments);
    println!("a drop of {drop:.3} is said to be shown with a chance of 0.8: shown in {share:.2} of {experiments}");
    // 60 experiments know the share to ±0.13.
    assert!((0.65..=0.95).contains(&share), "{share}");
}
