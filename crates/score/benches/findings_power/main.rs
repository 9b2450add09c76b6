//! `cargo bench -p scaleproof-score --bench findings_power`: how often findings are right and wrong in simulated experiments of five detectors, by flipped
//! signs of confidences and hits and, on the same draws, by McNemar's test of hits with Holm's correction. It fails where more is wrong than promised, or less
//! is found than it should be.
//!
//! Behind `--`, folders of sessions with recorded detections: what is estimated of these is printed, and nothing else.

mod decide;
mod simulate;
mod spread;

use std::path::Path;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof_core::workers;
use statrs::distribution::{ContinuousCDF, Normal};

use decide::{Shown, by_flips, by_mcnemar};
use simulate::{Differences, Effect, Round, experiment};
use spread::Spread;

const EXPERIMENTS: u64 = 5000;
const DETECTORS: usize = 5;
const SEED: u64 = 7;

/// The films of `captures/walk`, as `session from-video` makes photos of them (`tests/findings.rs` has the commands), by the five shared networks:
/// `score SESSION --record`, then `cargo bench -p scaleproof-score --bench findings_power -- SESSION`.
const FILMS: Spread = Spread {
    mean: 0.38,
    view: 0.138,
    photo: 0.142,
    view_shared: 0.53,
    photo_shared: 0.14,
};

const NOTHING: [Effect; DETECTORS] = [Effect::Nothing; DETECTORS];
const ALL_FALL: [Effect; DETECTORS] = [Effect::Falls(0.3); DETECTORS];
const FIRST_FALLS: [Effect; DETECTORS] = first(Effect::Falls(0.3));
const FALL_BESIDE_HITS: [Effect; DETECTORS] = [Effect::FallsBesideHits; DETECTORS];

const fn first(effect: Effect) -> [Effect; DETECTORS] {
    let mut effects = NOTHING;
    effects[0] = effect;
    effects
}

/// Experiments of one kind.
struct Case {
    name: &'static str,
    /// What each texture does.
    textures: &'static [[Effect; DETECTORS]],
    /// The share of plain photos that are hits; as the spread's mean has it where none is named.
    plain_hits: Option<f64>,
    /// The share of falls that shall be found with eight views at the usual spread.
    least_found: f64,
}

const fn case(name: &'static str, textures: &'static [[Effect; DETECTORS]], least_found: f64) -> Case {
    Case {
        name,
        textures,
        plain_hits: None,
        least_found,
    }
}

const fn beside_hits(name: &'static str, plain_hits: f64) -> Case {
    Case {
        plain_hits: Some(plain_hits),
        ..case(name, &[FALL_BESIDE_HITS, FALL_BESIDE_HITS], 0.0)
    }
}

const WRONG: [Case; 6] = [
    case("no difference", &[NOTHING, NOTHING], 0.0),
    case(
        "drop .3, one detector, one texture of two",
        &[FIRST_FALLS, NOTHING],
        0.0,
    ),
    case(
        "drop .3, one detector in each of two textures",
        &[
            FIRST_FALLS,
            [
                Effect::Nothing,
                Effect::Falls(0.3),
                Effect::Nothing,
                Effect::Nothing,
                Effect::Nothing,
            ],
        ],
        0.0,
    ),
    beside_hits("confidence falls, hits do not, plain hit rate .3", 0.3),
    beside_hits("confidence falls, hits do not, plain hit rate .5", 0.5),
    beside_hits("confidence falls, hits do not, plain hit rate .9", 0.9),
];

const POWER: [Case; 4] = [
    case("drop .3, all detectors, one texture", &[ALL_FALL], 0.95),
    case("drop .3, one detector, one texture", &[FIRST_FALLS], 0.85),
    case(
        "drop .3, all detectors, beside a texture without",
        &[ALL_FALL, NOTHING],
        0.86,
    ),
    case(
        "drop .3, one detector, beside a texture without",
        &[FIRST_FALLS, NOTHING],
        0.72,
    ),
];
/// The share of falls that shall be found with sixteen views at the usual spread.
const LEAST_FOUND_IN_16: f64 = 0.99;

fn main() {
    let folders: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    for folder in &folders {
        println!("{folder}: {}", Spread::of_session(Path::new(folder)).in_words());
    }
    if !folders.is_empty() {
        return;
    }
    let home = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let session = Spread::of_session(&home.join("captures/skyline"));
    let usual = Spread {
        mean: 0.7,
        view: 0.15,
        photo: 0.12,
        view_shared: (session.view_shared + FILMS.view_shared) / 2.0,
        photo_shared: (session.photo_shared + FILMS.photo_shared) / 2.0,
    };
    let twice = Spread {
        view: 2.0 * usual.view,
        photo: 2.0 * usual.photo,
        ..usual
    };
    println!("{EXPERIMENTS} experiments each, {DETECTORS} detectors, seed {SEED}. Confidences:");
    for (name, spread) in [
        ("session", session),
        ("films", FILMS),
        ("usual", usual),
        ("twice", twice),
    ] {
        println!("  {name:<8} {}", spread.in_words());
    }
    let mut failed = Vec::new();
    println!("\n% of experiments with something wrong somewhere, and % of falls that are found");
    print_heads();
    for (name, spread) in [("session", session), ("films", FILMS)] {
        for case in &WRONG {
            for views in [8, 16, 24] {
                failed.extend(print_case(case, views, (name, &spread), false));
            }
        }
    }
    println!("\nof experiments in which something differs");
    print_heads();
    for (name, spread) in [
        ("usual", usual),
        ("twice", twice),
        ("session", session),
        ("films", FILMS),
    ] {
        for case in &POWER {
            for views in [8, 16] {
                failed.extend(print_case(case, views, (name, &spread), name == "usual"));
            }
        }
    }
    print_clouds(&usual);
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

fn print_heads() {
    println!(
        "{:<8} {:<50} {:>5}  {:>15}  {:>15}  {:>15}",
        "", "", "", "confidence", "hit rate", "McNemar, Holm"
    );
    let pair = format!("{:>8} {:>6}", "wrong", "found");
    println!("{:<8} {:<50} {:>5}  {pair}  {pair}  {pair}", "spread", "", "views");
}

/// Prints a line; in what it falls short.
fn print_case(case: &Case, views: usize, (name, spread): (&str, &Spread), is_power_promised: bool) -> Vec<String> {
    let spread = match case.plain_hits {
        Some(rate) => with_hits(spread, rate),
        None => *spread,
    };
    let rounds: Vec<Round> = case
        .textures
        .iter()
        .map(|effects| Round {
            effects: *effects,
            cloud: 0.0,
        })
        .collect();
    let [confidence, hits, old] = rates(views, &spread, &rounds, |textures| {
        let (new, old) = (by_flips(textures, None), by_mcnemar(textures));
        [
            Counted::of(case.textures, &new, CONFIDENCE),
            Counted::of(case.textures, &new, HITS),
            Counted::of(case.textures, &old, OLD),
        ]
    });
    println!(
        "{name:<8} {:<50} {views:>5}  {}  {}  {}",
        case.name,
        confidence.in_words(),
        hits.in_words(),
        old.in_words()
    );
    let least = if views == 8 {
        case.least_found
    } else {
        LEAST_FOUND_IN_16
    };
    let short = [
        (confidence.wrong() > most_wrong(), "the confidence is wrong too often"),
        (hits.wrong() > most_wrong(), "falls of the hit rate are wrong too often"),
        (
            is_power_promised && confidence.found() < least,
            "too few falls are found",
        ),
    ];
    let short = short.iter().filter(|(is_short, _)| *is_short);
    short
        .map(|(_, what)| format!("{name}, {}, {views} views: {what}", case.name))
        .collect()
}

/// Two and a half standard errors above the promise.
fn most_wrong() -> f64 {
    0.05 + 2.5 * (0.05 * 0.95 / EXPERIMENTS as f64).sqrt()
}

/// With such a mean that so many plain photos are hits.
fn with_hits(spread: &Spread, rate: f64) -> Spread {
    let above = Normal::standard().inverse_cdf(rate);
    Spread {
        mean: 0.5 + above * spread.view.hypot(spread.photo),
        ..*spread
    }
}

/// A round in worse light than the plain one: how often something is wrong in a texture that does nothing, and how many falls of .3 are found, without a
/// control, with one that was photographed in the texture's light, and with one in the light of the plain round.
fn print_clouds(spread: &Spread) {
    println!("\nAll confidences of the other round are lower by the shift of its light. One texture, usual spread");
    let three = |words: [&str; 3]| words.map(|word| format!("{word:>16}")).join("");
    println!(
        "{:<5} {:>5}   {:<48}  of falls of .3 in all detectors, found %",
        "", "", "without effect, something found %"
    );
    let controls = three(["no control", "in its light", "in plain light"]);
    println!("{:<5} {:>5}{controls}{controls}", "shift", "views");
    for cloud in [0.0, 0.02, 0.05, 0.1] {
        for views in [8, 24] {
            let of = |effects: [Effect; DETECTORS]| {
                let other = |effects, cloud| Round { effects, cloud };
                let rounds = [other(effects, cloud), other(NOTHING, cloud), other(NOTHING, 0.0)];
                rates(views, spread, &rounds, |all| {
                    let controls = [None, Some(&all[1]), Some(&all[2])];
                    controls.map(|control| Counted::of(&[effects], &by_flips(&all[..1], control), CONFIDENCE))
                })
            };
            let without = of(NOTHING).map(|rates| format!("{:>16.1}", 100.0 * rates.wrong()));
            let found = of(ALL_FALL).map(|rates| format!("{:>16.1}", 100.0 * rates.found()));
            println!("{cloud:<5} {views:>5}{}{}", without.join(""), found.join(""));
        }
    }
}

/// What counts as a fall that is there, and what as shown.
type Reading = (fn(Effect) -> bool, fn(&Shown) -> bool, fn(&Shown) -> bool);

/// Any fall of the confidence is there to be found; a rise is wrong.
const CONFIDENCE: Reading = (|effect| effect != Effect::Nothing, |s| s.falls, |s| s.rises);
/// Hits fall where the confidence does by an amount.
const HITS: Reading = (|effect| matches!(effect, Effect::Falls(_)), |s| s.hits_fall, |_| false);
const OLD: Reading = (|effect| matches!(effect, Effect::Falls(_)), |s| s.falls, |s| s.rises);

/// What was right and wrong in experiments.
#[derive(Clone, Copy, Default)]
struct Counted {
    experiments: u64,
    /// With something wrong somewhere.
    wrong: u64,
    /// Falls that are there.
    there: u64,
    found: u64,
}

impl Counted {
    fn of(textures: &[[Effect; DETECTORS]], shown: &[Vec<Shown>], (is_there, falls, rises): Reading) -> Counted {
        let pairs = || textures.iter().flatten().zip(shown.iter().flatten());
        let count =
            |which: &dyn Fn(Effect, &Shown) -> bool| pairs().filter(|(effect, s)| which(**effect, s)).count() as u64;
        let wrong = count(&|effect, s| rises(s) || falls(s) && !is_there(effect));
        Counted {
            experiments: 1,
            wrong: wrong.min(1),
            there: count(&|effect, _| is_there(effect)),
            found: count(&|effect, s| is_there(effect) && falls(s)),
        }
    }

    fn and(self, more: Counted) -> Counted {
        Counted {
            experiments: self.experiments + more.experiments,
            wrong: self.wrong + more.wrong,
            there: self.there + more.there,
            found: self.found + more.found,
        }
    }

    fn wrong(&self) -> f64 {
        self.wrong as f64 / self.experiments as f64
    }

    fn found(&self) -> f64 {
        self.found as f64 / self.there as f64
    }

    fn in_words(&self) -> String {
        let found = (self.there > 0).then(|| format!("{:.1}", 100.0 * self.found()));
        format!("{:>8.1} {:>6}", 100.0 * self.wrong(), found.as_deref().unwrap_or("–"))
    }
}

/// Counts all experiments, each of which has random numbers of its own, the same in every case.
fn rates<const N: usize>(
    views: usize,
    spread: &Spread,
    rounds: &[Round],
    counted: impl Fn(&[Differences]) -> [Counted; N] + Sync,
) -> [Counted; N] {
    let numbers: Vec<u64> = (0..EXPERIMENTS).collect();
    let all = workers::each(&numbers, |number| {
        let mut rng = Pcg64Mcg::seed_from_u64(SEED * EXPERIMENTS + number);
        counted(&experiment(&mut rng, views, spread, rounds))
    });
    all.into_iter().fold([Counted::default(); N], |sum, own| {
        std::array::from_fn(|i| sum[i].and(own[i]))
    })
}
