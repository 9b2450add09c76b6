//! `cargo bench --bench findings_power`: how often findings are right and wrong in simulated experiments, by flipped signs of confidences and hits, and by
//! McNemar's test of hits with Holm's correction, on the same draws.
//!
//! Five detectors look at so many views of the plain model and of two textures. A confidence is the detector's mean, plus what is hard about the view, plus
//! what is hard about it for the detector, plus noise of each photo, cut to 0 … 1; a hit is one of 0.5 or more.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use scaleproof_core::statistics::{holm, mcnemar_p, shares, sign_flip_p};
use scaleproof_pose::simulate::normal;

const EXPERIMENTS: usize = 5000;
const DETECTORS: usize = 5;
const LEVEL: f64 = 0.05;

/// Mean confidence of the plain model, and what it varies by.
#[derive(Clone, Copy)]
struct Spread {
    mean: f64,
    /// Standard deviation from view to view, of which half the variance is common to all detectors.
    view: f64,
    /// Standard deviation in each photo.
    photo: f64,
}

const USUAL: Spread = Spread {
    mean: 0.7,
    view: 0.15,
    photo: 0.12,
};
const TWICE: Spread = Spread {
    mean: 0.7,
    view: 0.3,
    photo: 0.24,
};

/// Falls of confidence: of each texture, for each detector.
type Drops = Vec<[f64; DETECTORS]>;

/// Differences of a texture to plain, texture minus plain: for each detector, by view.
struct Differences {
    confidence: Vec<Vec<f64>>,
    hits: Vec<Vec<f64>>,
}

fn experiment(rng: &mut Pcg64Mcg, views: usize, spread: Spread, drops: &Drops) -> Vec<Differences> {
    let empty = || vec![vec![0.0; views]; DETECTORS];
    let mut textures: Vec<Differences> = drops
        .iter()
        .map(|_| Differences {
            confidence: empty(),
            hits: empty(),
        })
        .collect();
    for view in 0..views {
        let common = normal(rng);
        for detector in 0..DETECTORS {
            let hard = spread.view * (common + normal(rng)) / 2.0_f64.sqrt();
            let mut seen = |drop: f64| (spread.mean - drop + hard + spread.photo * normal(rng)).clamp(0.0, 1.0);
            let plain = seen(0.0);
            for (texture, drops) in textures.iter_mut().zip(drops) {
                let textured = seen(drops[detector]);
                let hit = |confidence: f64| f64::from(u8::from(confidence >= 0.5));
                texture.confidence[detector][view] = textured - plain;
                texture.hits[detector][view] = hit(textured) - hit(plain);
            }
        }
    }
    textures
}

/// Which falls are shown, by texture and detector; and which rises.
type Shown = Vec<Vec<(bool, bool)>>;

fn by_flips(differences: &[&Vec<Vec<f64>>]) -> Shown {
    let p: Vec<Vec<f64>> = differences.iter().map(|d| sign_flip_p(d)).collect();
    let shares = shares(&p, LEVEL);
    let shown = |(texture, share): (usize, &f64)| {
        let signs = differences[texture].iter().map(|d| d.iter().sum::<f64>());
        let ps = p[texture].iter().map(|p| p <= share);
        ps.zip(signs)
            .map(|(is_shown, sum)| (is_shown && sum < 0.0, is_shown && sum > 0.0))
            .collect()
    };
    shares.iter().enumerate().map(shown).collect()
}

fn by_mcnemar(textures: &[Differences]) -> Shown {
    let rows: Vec<&Vec<f64>> = textures.iter().flat_map(|t| &t.hits).collect();
    let p: Vec<f64> = rows
        .iter()
        .map(|hits| mcnemar_p(&hits.iter().map(|d| *d as i64).collect::<Vec<_>>()))
        .collect();
    let shown = holm(&p).into_iter().zip(&rows).map(|(p, hits)| {
        let sum: f64 = hits.iter().sum();
        (p < LEVEL && sum < 0.0, p < LEVEL && sum > 0.0)
    });
    shown.collect::<Vec<_>>().chunks(DETECTORS).map(<[_]>::to_vec).collect()
}

/// Shares of experiments: a wrong finding somewhere, and the fall of an affected detector found.
#[derive(Default)]
struct Rates {
    wrong: usize,
    found: usize,
    affected: usize,
}

impl Rates {
    fn add(&mut self, shown: &Shown, drops: &Drops) {
        let pairs = || shown.iter().flatten().zip(drops.iter().flatten());
        let is_wrong = |((falls, rises), drop): (&(bool, bool), &f64)| *rises || (*falls && *drop == 0.0);
        self.wrong += usize::from(pairs().any(is_wrong));
        self.found += pairs().filter(|((falls, _), drop)| *falls && **drop > 0.0).count();
        self.affected += pairs().filter(|(_, drop)| **drop > 0.0).count();
    }

    fn in_words(&self) -> String {
        let wrong = 100.0 * self.wrong as f64 / EXPERIMENTS as f64;
        let found = 100.0 * self.found as f64 / self.affected as f64;
        format!(
            "{wrong:5.1} {}",
            if self.affected == 0 {
                "    –".to_owned()
            } else {
                format!("{found:5.1}")
            }
        )
    }
}

fn main() {
    let none = [0.0; DETECTORS];
    let one = |drop: f64| [drop, 0.0, 0.0, 0.0, 0.0];
    let cases: [(&str, Drops); 7] = [
        ("no difference, two textures", vec![none, none]),
        ("drop .3, one texture, all detectors", vec![[0.3; DETECTORS]]),
        ("drop .3, one texture, one detector", vec![one(0.3)]),
        ("drop .2, one texture, all detectors", vec![[0.2; DETECTORS]]),
        (
            "drop .3, all detectors, beside a texture without",
            vec![[0.3; DETECTORS], none],
        ),
        ("drop .3, one detector, beside a texture without", vec![one(0.3), none]),
        (
            "drop .3, one detector in each of two textures",
            vec![one(0.3), [0.0, 0.3, 0.0, 0.0, 0.0]],
        ),
    ];
    println!(
        "{EXPERIMENTS} experiments each. % of experiments with a wrong finding somewhere, and % of falls that are found:"
    );
    println!(
        "{:<52} {:>5} {:>13} {:>13} {:>13}",
        "", "views", "confidence", "hits", "McNemar, Holm"
    );
    for (words, spread) in [("", USUAL), (", twice the spread", TWICE)] {
        for (name, drops) in &cases {
            for views in [8, 16, 24] {
                let mut rng = Pcg64Mcg::seed_from_u64(7);
                let [mut confidence, mut hits, mut old] = [(); 3].map(|()| Rates::default());
                for _ in 0..EXPERIMENTS {
                    let textures = experiment(&mut rng, views, spread, drops);
                    confidence.add(
                        &by_flips(&textures.iter().map(|t| &t.confidence).collect::<Vec<_>>()),
                        drops,
                    );
                    hits.add(&by_flips(&textures.iter().map(|t| &t.hits).collect::<Vec<_>>()), drops);
                    old.add(&by_mcnemar(&textures), drops);
                }
                let [confidence, hits, old] = [confidence, hits, old].map(|rates| rates.in_words());
                println!(
                    "{:<52} {views:>5} {confidence:>13} {hits:>13} {old:>13}",
                    format!("{name}{words}")
                );
            }
        }
    }
}
