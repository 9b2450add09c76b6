//! Planned numbers of views: what they promise, in experiments of another make, and what is known by hand.

use crate::common;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof_core::statistics::{shares, sign_flip_p};
use scaleproof_detect::Manifest;
use scaleproof_pose::simulate::normal;
use scaleproof_score::{
    Aim, Endpoint, Observed, Options, PlanError, Question, Scores, Spread, SpreadFrom, evaluated_detectors, score,
    sequential_plan,
};
use scaleproof_session::Session;

const USUAL: Question = Question {
    drop: 0.2,
    power: 0.8,
    detectors: 5,
    textures: 1,
    spread: Spread::STORED,
};

fn views(question: Question) -> usize {
    question.views_needed().unwrap().views
}

/// Photos of plain and textured models whose differences scatter as planned: how often the drop of the first detector and texture is shown, with the shares of the textures
/// passed on.
fn shown_of_photos(question: &Question, views: usize, experiments: usize) -> f64 {
    let Spread {
        deviation, correlation, ..
    } = question.spread;
    let (common, own) = (correlation.sqrt(), (1.0 - correlation).sqrt());
    let mut rng = Pcg64Mcg::seed_from_u64(97);
    let mut texture = |dropped: bool| -> Vec<Vec<f64>> {
        let of_view: Vec<f64> = (0..views).map(|_| normal(&mut rng)).collect();
        let mut detector = |drop: f64| {
            let view = |common_to_all: &f64| {
                let plain = 0.7;
                let textured = plain - drop - deviation * (common * common_to_all + own * normal(&mut rng));
                plain - textured
            };
            of_view.iter().map(view).collect()
        };
        let drops = (0..question.detectors).map(|k| if dropped && k == 0 { question.drop } else { 0.0 });
        drops.map(&mut detector).collect()
    };
    let mut shows = || {
        let differences: Vec<Vec<Vec<f64>>> = (0..question.textures).map(|t| texture(t == 0)).collect();
        let p: Vec<Vec<f64>> = differences.iter().map(|d| sign_flip_p(d)).collect();
        p[0][0] <= shares(&p, 0.05)[0] && differences[0][0].iter().sum::<f64>() > 0.0
    };
    (0..experiments).filter(|_| shows()).count() as f64 / experiments as f64
}

/// With few views, of which all patterns of signs are tried, and with many. The printed figures are of `SCALEPROOF_EXPERIMENTS=5000`.
#[test]
fn as_many_views_as_planned_show_the_drop_as_often_as_planned() {
    let experiments = common::number("SCALEPROOF_EXPERIMENTS").unwrap_or(600_u32) as usize;
    let hard = Question {
        textures: 2,
        drop: 0.15,
        power: 0.9,
        ..USUAL
    };
    for question in [Question { drop: 0.3, ..USUAL }, USUAL, hard] {
        let planned = question.views_needed().unwrap();
        let shown = shown_of_photos(&question, planned.views, experiments);
        println!("{question:?}: {planned:?}, shown {shown:.3}");
        // Both are simulated.
        let deviation = (planned.chance * (1.0 - planned.chance) / experiments as f64).sqrt();
        let error = deviation.hypot(planned.chance_error / 1.96);
        assert!((shown - planned.chance).abs() < 2.5 * error, "{shown} {planned:?}");
        assert!(planned.chance >= question.power, "{planned:?}");
        // A fifth fewer do not.
        let fewer = shown_of_photos(&question, planned.views * 4 / 5, experiments);
        assert!(fewer < question.power, "{fewer} {planned:?}");
    }
}

/// A drop that nothing hides takes as many views as any finding does: 2 · 2⁻ⁿ ≤ 0.05 ÷ textures.
#[test]
fn the_largest_drop_takes_the_fewest_views_that_can_show_anything() {
    let sure = |textures| Question {
        drop: 0.9,
        textures,
        spread: Spread {
            deviation: 0.01,
            ..Spread::STORED
        },
        ..USUAL
    };
    // 2/64 = 0.031, 2/128 = 0.016, 2/256 = 0.008
    for (textures, fewest) in [(1, 6), (2, 7), (3, 7), (4, 8), (6, 8), (7, 9)] {
        assert_eq!(
            (views(sure(textures)), sure(textures).fewest()),
            (fewest, fewest),
            "{textures} textures"
        );
        assert_eq!(sure(textures).chance(fewest - 1), 0.0);
    }
}

#[test]
fn a_harder_question_never_takes_fewer_views() {
    let rises = |values: &[f64], set: fn(&mut Question, f64)| {
        let needed = values.iter().map(|value| {
            let mut question = USUAL;
            set(&mut question, *value);
            views(question)
        });
        let needed: Vec<usize> = needed.collect();
        assert!(
            needed.is_sorted() && needed[0] < needed[needed.len() - 1],
            "{values:?}: {needed:?}"
        );
    };
    rises(&[0.6, 0.4, 0.3, 0.25, 0.2, 0.1, 0.05], |q, drop| q.drop = drop);
    rises(&[0.5, 0.7, 0.8, 0.9, 0.99], |q, power| q.power = power);
    rises(&[1.0, 2.0, 5.0, 12.0], |q, detectors| q.detectors = detectors as usize);
    rises(&[1.0, 2.0, 3.0, 5.0], |q, textures| q.textures = textures as usize);
    rises(&[0.05, 0.1, 0.2, 0.3, 0.4], |q, deviation| {
        q.spread.deviation = deviation
    });
}

/// Looked at after each view it takes more views at most, and stops earlier the larger the drop is.
#[test]
fn looking_after_each_view_takes_more_at_most_and_fewer_where_the_drop_is_large() {
    let plan = sequential_plan(&USUAL, Some(0.2), 8, || {}).unwrap();
    println!(
        "looked at once {} views, else at most {}",
        views(USUAL),
        plan.most_views
    );
    plan.table.iter().for_each(|row| println!("{row:?}"));
    assert!(plan.most_views > views(USUAL), "{plan:?}");
    let of = |real: f64| plan.table.iter().find(|row| row.real_drop == real).unwrap();
    assert!((of(0.2).drop_shown - 0.8).abs() < 0.03, "{plan:?}");
    // One of five detectors: without a drop, a hundredth of experiments at most.
    let wrong = of(0.0).drop_shown + of(0.0).rise_shown;
    assert!(wrong <= 0.015 && of(0.0).less_than_least_shown > 0.3, "{plan:?}");
    assert!(of(0.4).mean_views < 0.7 * of(0.2).mean_views, "{plan:?}");
    for row in &plan.table {
        let all = row.drop_shown + row.rise_shown + row.less_than_least_shown + row.undecided;
        assert!((all - 1.0).abs() < 1e-9, "{row:?}");
    }
    let two = Question { textures: 2, ..USUAL };
    assert!(sequential_plan(&two, Some(0.2), 8, || {}).unwrap().most_views > plan.most_views);
}

#[test]
fn what_cannot_be_planned_says_why() {
    let refused = |question: Question| question.views_needed().unwrap_err();
    assert_eq!(
        refused(Question { drop: 0.0, ..USUAL }),
        PlanError::Drop { drop: 0.0, most: 1.0 }
    );
    assert_eq!(refused(Question { power: 1.0, ..USUAL }), PlanError::Power(1.0));
    assert_eq!(refused(Question { drop: 0.001, ..USUAL }), PlanError::TooMany);
    let least = sequential_plan(&USUAL, Some(0.5), 8, || {});
    assert_eq!(least.unwrap_err(), PlanError::Least { least: 0.5, drop: 0.2 });
}

/// The stored session by its five detectors, as far as these photos of it go.
fn stored(are_kept: impl Fn(usize, &str) -> bool) -> Scores {
    let mut session = Session::open(&common::skyline()).unwrap();
    let mut at = 0;
    session.photos.retain(|photo| {
        at += 1;
        are_kept(at - 1, &photo.variant)
    });
    let recorded = common::skyline().join("recorded");
    let manifests = Manifest::all().unwrap().into_iter();
    let manifests = manifests.filter(|m| recorded.join(format!("{}.json", m.name)).exists());
    let sessions = vec![session];
    let detectors = evaluated_detectors(&sessions, manifests.collect(), None).unwrap();
    score(sessions, detectors, &Options::default(), || {}).unwrap()
}

/// The standard deviations, computed from the confidences in `photos.csv` by Python's `statistics`: differences of 0.283, 0.121, 0.250, 0.220 and 0.145, correlated by 0.37 on
/// average; plain confidences of 0.286, 0.173, 0.083, 0.257 and 0.144.
#[test]
fn the_spread_of_stored_photos_is_that_of_their_differences_or_of_the_plain_ones() {
    let both = Observed::of(&stored(|_, _| true)).unwrap();
    assert_eq!(
        (both.views, both.detectors, both.textures, both.spread.from),
        (8, 5, 1, SpreadFrom::PairedPhotos)
    );
    assert!(
        (both.spread.deviation - 0.213).abs() < 0.001 && (both.spread.correlation - 0.37).abs() < 0.006,
        "{both:?}"
    );
    let plain = Observed::of(&stored(|_, variant| variant == "normal")).unwrap();
    assert_eq!(
        (plain.views, plain.textures, plain.spread.from),
        (8, 0, SpreadFrom::PlainPhotos)
    );
    assert!((plain.spread.deviation - 0.203).abs() < 0.001, "{plain:?}");
    assert_eq!(plain.spread.correlation, Spread::STORED.correlation);
    assert!((plain.most_drop - 0.82).abs() < 0.006, "{plain:?}");
    // Two pairs and eight plain photos: the plain ones tell.
    let few = Observed::of(&stored(|at, _| at < 10)).unwrap();
    assert_eq!(few.spread, plain.spread);
    let refused = Observed::of(&stored(|at, _| at < 5)).unwrap_err().to_string();
    assert!(
        refused.contains("6 views of `normal`") && refused.contains("there are 5"),
        "{refused}"
    );
}

/// An aim of a version that knew the hit rate alone, as it was sealed: the seal is of these bytes.
#[test]
fn the_aim_of_an_older_plan_is_written_as_it_was_read() {
    let old =
        r#"{"primary_endpoint":"hit_rate","drop":0.3,"base_rate":0.9,"power":0.8,"comparisons":2,"places_needed":9}"#;
    let aim: Aim = serde_json::from_str(old).unwrap();
    assert_eq!(aim.primary_endpoint, Endpoint::HitRate);
    assert_eq!(serde_json::to_string(&aim).unwrap(), old);
}
