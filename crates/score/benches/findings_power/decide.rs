//! What two rules call shown: flipped signs of confidences, as `compare` decides, and McNemar's test of hits, which it decided by before.

use scaleproof_core::statistics::{holm, mcnemar_p, shares, sign_flip_p};

use crate::DETECTORS;
use crate::simulate::Differences;

const LEVEL: f64 = 0.05;

/// What is shown of one detector and texture.
#[derive(Clone, Copy, Default)]
pub struct Shown {
    pub falls: bool,
    pub rises: bool,
    /// The hit rate falls. `compare` says so only where the confidence falls, too, and at most one view in four is still hit; here it counts without.
    pub hits_fall: bool,
}

/// By flipped signs: for each texture, its detectors. A control holds back what it moves by as much.
pub fn by_flips(textures: &[Differences], control: Option<&Differences>) -> Vec<Vec<Shown>> {
    let mut all = changes(textures, |t| &t.confidence);
    let hits = changes(textures, |t| &t.hits);
    let both = all.iter_mut().flatten().zip(hits.iter().flatten());
    both.for_each(|(shown, hits)| shown.hits_fall = hits.falls);
    if let Some(control) = control {
        for (texture, shown) in textures.iter().zip(&mut all) {
            hold_back(texture, control, shown);
        }
    }
    all
}

fn changes(textures: &[Differences], figure: impl Fn(&Differences) -> &Vec<Vec<f64>>) -> Vec<Vec<Shown>> {
    let p: Vec<Vec<f64>> = textures.iter().map(|texture| sign_flip_p(figure(texture))).collect();
    let shares = shares(&p, LEVEL);
    let of_texture = |t: usize| {
        let signs = figure(&textures[t]).iter().map(|d| sum(d));
        let shown = p[t].iter().map(|p| *p <= shares[t]);
        shown.zip(signs).map(|(is_shown, sum)| change(is_shown, sum)).collect()
    };
    (0..textures.len()).map(of_texture).collect()
}

fn hold_back(texture: &Differences, control: &Differences, shown: &mut [Shown]) {
    for (k, shown) in shown.iter_mut().enumerate() {
        let is_larger =
            |of: fn(&Differences) -> &Vec<Vec<f64>>| sum(&of(texture)[k]).abs() > sum(&of(control)[k]).abs();
        if !is_larger(|d| &d.confidence) {
            *shown = Shown::default();
        }
        shown.hits_fall &= is_larger(|d| &d.hits);
    }
}

/// By McNemar's exact test of the hits, corrected by Holm over all detectors and textures.
pub fn by_mcnemar(textures: &[Differences]) -> Vec<Vec<Shown>> {
    let rows: Vec<&Vec<f64>> = textures.iter().flat_map(|t| &t.hits).collect();
    let p = rows
        .iter()
        .map(|hits| mcnemar_p(&hits.iter().map(|d| *d as i64).collect::<Vec<_>>()));
    let corrected = holm(&p.collect::<Vec<_>>()).into_iter();
    let shown = corrected.zip(&rows).map(|(p, hits)| change(p < LEVEL, sum(hits)));
    let shown: Vec<Shown> = shown.collect();
    shown.chunks(DETECTORS).map(<[Shown]>::to_vec).collect()
}

fn change(is_shown: bool, sum: f64) -> Shown {
    Shown {
        falls: is_shown && sum < 0.0,
        rises: is_shown && sum > 0.0,
        hits_fall: false,
    }
}

fn sum(differences: &[f64]) -> f64 {
    differences.iter().sum()
}
