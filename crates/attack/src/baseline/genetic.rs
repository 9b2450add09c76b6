//! ER: a genetic search over a small mosaic that is enlarged and repeated over the model (Wu et al. 2020,
//! arXiv:2007.16118).
//!
//! The paper leaves its search open in detail. Here: tournaments of three, uniform crossover cell by cell, cells replaced
//! by random ones, and the best handed on unchanged. All patterns of a generation are looked at in the same views.

use rand::{Rng, RngExt};

use super::{BlackBox, SearchConfig};
use crate::AttackError;
use crate::run::{Rgb, drawn_by};

const POPULATION: usize = 16;
const ELITE: usize = 3;
const TOURNAMENT: usize = 3;
/// Share of a child's cells that are replaced by random ones.
const MUTATED: f64 = 0.03;
const VIEWS: u32 = 6;
/// Queries of the first generation: with fewer nothing is searched.
pub const FIRST_ROUND: u64 = POPULATION as u64 * VIEWS as u64;
/// Generations between two judgements.
const NOTED_EVERY: u32 = 4;

/// Searches until the query budget is exhausted.
pub fn search(oracle: &mut BlackBox, config: &SearchConfig) -> Result<Vec<Rgb>, AttackError> {
    let mut rng = drawn_by(config.seed, u32::MAX);
    let count = oracle.view_set.grid.cells();
    let mut random = |_| (0..count).map(|_| cell(&mut rng)).collect();
    let mut population: Vec<Vec<Rgb>> = (0..POPULATION).map(&mut random).collect();
    for generation in 0.. {
        let mut rng = drawn_by(config.seed, generation);
        let views = oracle.draws(VIEWS, generation, &mut rng);
        let mut ranked: Vec<(f64, Vec<Rgb>)> = Vec::new();
        for cells in &population {
            let Some(score) = oracle.mean_score(&views, cells)? else {
                // Those of the generation before are in their order: the first is its best.
                break;
            };
            ranked.push((score, cells.clone()));
        }
        if ranked.len() < population.len() {
            break;
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        if generation % NOTED_EVERY == 0 {
            oracle.note(&ranked[0].1, Some(ranked[0].0))?;
        }
        let mut next: Vec<Vec<Rgb>> = ranked.iter().take(ELITE).map(|(_, cells)| cells.clone()).collect();
        while next.len() < POPULATION {
            let (a, b) = (tournament(&ranked, &mut rng), tournament(&ranked, &mut rng));
            next.push(child(a, b, &mut rng));
        }
        population = next;
    }
    let best = population.swap_remove(0);
    oracle.note(&best, None)?;
    Ok(best)
}

/// Draws some with replacement and returns the best.
fn tournament<'a>(ranked: &'a [(f64, Vec<Rgb>)], rng: &mut impl Rng) -> &'a [Rgb] {
    let drawn = (0..TOURNAMENT).map(|_| rng.random_range(0..ranked.len())).min();
    &ranked[drawn.unwrap_or(0)].1
}

fn child(a: &[Rgb], b: &[Rgb], rng: &mut impl Rng) -> Vec<Rgb> {
    let mix = |(a, b): (&Rgb, &Rgb)| {
        if rng.random::<f64>() < MUTATED {
            cell(rng)
        } else if rng.random() {
            *a
        } else {
            *b
        }
    };
    a.iter().zip(b).map(mix).collect()
}

fn cell(rng: &mut impl Rng) -> Rgb {
    std::array::from_fn(|_| rng.random())
}
