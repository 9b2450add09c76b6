//! Sequential comparison, with a look after every pair, or every place: the first finding, its look, and its p value.

use std::collections::BTreeMap;

use crate::compare::textures::others;
use crate::compare::{Cell, CompareError, LEVEL, MOST_HIT, Pair, pair, some_pairs};
use crate::figures::{
    ClusteredBy, Compared, Comparison, Course, Decision, DetectorView, Effect, ScoredPhoto, Scores, Sequential,
    SequentialFinding, variants,
};
use scaleproof_core::geometry::angle::turn;
use scaleproof_core::statistics::{Sequence, holm};
use scaleproof_pose::scene::Bin;

/// One look: the pairs that it adds, and its stratum.
struct Look<'a> {
    pairs: Vec<Pair<'a>>,
    /// Bin of the first pair.
    bin: Bin,
    stratum: usize,
}

/// Compares every variant with `base` look by look, in the order in which the sessions list the photos, the first pair of each place and bin. `least`
/// must lie in (0, 1).
pub fn sequential(
    scores: &Scores,
    base: &str,
    by: ClusteredBy,
    least: Option<f64>,
) -> Result<Sequential, CompareError> {
    let mut results = Vec::new();
    let all = variants(&scores.photos, base);
    let others = others(scores, &all, base)?;
    let tests = others.len() * scores.detectors.len();
    for variant in &others {
        let (cells, _) = some_pairs(scores.set(), base, variant)?;
        let looks = looks(&cells, by);
        let sides: Vec<(DetectorView, _)> = DetectorView::each(&scores.detectors).collect();
        let confidences = |side: DetectorView| {
            let confidence = |photo: &ScoredPhoto| side.outcome(photo).confidence;
            test_figure(&looks, least, tests, |(base, other)| {
                confidence(base) - confidence(other)
            })
        };
        let confidences: Vec<FigureTest> = sides.iter().map(|(side, _)| confidences(*side)).collect();
        for (i, (side, detector)) in sides.iter().enumerate() {
            let hits = test_figure(&looks, least, tests, |(base, other)| side.hit(base) - side.hit(other));
            let (mean_confidence, changed_after) = primary(&confidences, i, others.len());
            let hit_rate = secondary(&hits, changed_after);
            let left = mean(&looks, |(_, other)| side.hit(other));
            results.push(Course {
                effect: effect(&mean_confidence, &hit_rate, left),
                detector: detector.manifest.name.clone(),
                variant: (*variant).to_owned(),
                looks: looks.len(),
                repeats: cells.iter().map(|cell| cell.pairs.len() - 1).sum(),
                mean_confidence,
                hit_rate,
            });
        }
    }
    Ok(Sequential {
        look_after_each: by,
        least,
        results,
    })
}

/// Replaces the findings of `comparison` by those of the looks, with their p, and without findings for places like these. A detector that does not
/// see the base still cannot tell.
pub fn decide_by_looks(comparison: &mut Comparison, sequential: Sequential) {
    for course in &sequential.results {
        let own = |r: &&mut Compared| r.detector == course.detector && r.variant == course.variant;
        let Some(finding) = comparison.results.iter_mut().find(own).and_then(|r| r.finding.as_mut()) else {
            continue;
        };
        let confidence = &course.mean_confidence;
        if finding.effect != Effect::BaseUnseen {
            finding.effect = course.effect;
        }
        finding.confidence_p = confidence.p_corrected.unwrap_or(confidence.p_always_valid);
        finding.confidence_level = LEVEL;
        finding.hit_rate_p = course.hit_rate.p_always_valid;
        finding.hit_rate_level = LEVEL;
        finding.views_missing = 0;
        finding.drop_shown_from = None;
        finding.in_places_like_these = None;
    }
    comparison.sequential = Some(sequential);
}

/// Returns the index of that bin of `open`, not photographed yet in the second of two variants at a place, that would tell most: the one whose
/// direction differed most in earlier pairs. A direction without earlier pairs counts as one that differs by half, and of equals the farthest from
/// what was photographed is taken. `None` where the first variant has no photo in any of them.
///
/// The outcome of the first variant's own photo in the bin is *not* used: a view picked because its base photo was a hit falls back by chance alone,
/// and a drop would be found where there is none (`tests/sequential.rs`).
pub fn most_telling(scores: &Scores, [base, variant]: [&str; 2], place: &str, open: &[Bin]) -> Option<usize> {
    let (cells, _) = pair(scores.set(), base, variant);
    let at = |photo: &ScoredPhoto| photo.place.as_deref().unwrap_or_default() == place;
    let is_base = |photo: &ScoredPhoto, bin| photo.variant == base && photo.bin == Some(bin) && at(photo);
    let has_base = |bin: &Bin| scores.photos.iter().any(|photo| is_base(photo, *bin));
    let step_deg = scores.sessions[0].scene.bins.azimuth_deg;
    let looks = looks(&cells, ClusteredBy::PlaceAndBin);
    let seen = looks
        .iter()
        .map(|look| (look.bin, mean_difference(scores, look.pairs[0])));
    let seen: Vec<(Bin, f64)> = seen.collect();
    let away_deg = |a: &Bin, b: &Bin| turn(a.azimuth_deg, b.azimuth_deg).abs();
    let expected = |bin: &Bin| {
        let near = seen.iter().filter(|(other, _)| away_deg(other, bin) <= step_deg + 1e-6);
        let weighted = near.map(|(other, difference)| (1.0 - 0.5 * away_deg(other, bin) / step_deg, difference));
        let (sum, weight) = weighted.fold((0.5, 1.0), |(sum, weight), (w, difference)| {
            (sum + w * difference, weight + w)
        });
        sum / weight
    };
    let at_place = cells.iter().filter(|cell| cell.place == place);
    let taken: Vec<Bin> = at_place.map(|cell| cell.bin).collect();
    let farthest = |bin: &Bin| {
        let away = taken.iter().map(|other| away_deg(other, bin));
        away.fold(f64::INFINITY, f64::min)
    };
    let telling = (0..open.len()).filter(|i| has_base(&open[*i]));
    // Of equals `max_by` takes the last, which is the first of the walk here.
    telling.rev().max_by(|a, b| {
        let [a, b] = [&open[*a], &open[*b]];
        let by_difference = expected(a).total_cmp(&expected(b));
        by_difference.then(farthest(a).total_cmp(&farthest(b)))
    })
}

/// Returns the difference of the confidences of a pair, the mean over all detectors.
fn mean_difference(scores: &Scores, (base, other): Pair) -> f64 {
    let sum = |photo: &ScoredPhoto| photo.outcomes.iter().map(|outcome| outcome.confidence).sum::<f64>();
    (sum(base) - sum(other)) / scores.detectors.len().max(1) as f64
}

/// Returns the looks in the order of time: a pair is there when the later of its photos is. Repeats of a place and bin are left out.
fn looks<'a>(cells: &[Cell<'a>], by: ClusteredBy) -> Vec<Look<'a>> {
    let mut strata: BTreeMap<Bin, usize> = BTreeMap::new();
    let mut looks: Vec<(&str, Look)> = Vec::new();
    for cell in cells {
        let Some(first) = cell.pairs.first() else { continue };
        let same = |(place, _): &&mut (&str, Look)| by == ClusteredBy::Place && *place == cell.place;
        if let Some((_, look)) = looks.iter_mut().find(same) {
            look.pairs.push(*first);
            continue;
        }
        let next = strata.len();
        let stratum = match by {
            ClusteredBy::Place => 0,
            ClusteredBy::PlaceAndBin => *strata.entry(cell.bin).or_insert(next),
        };
        let look = Look {
            pairs: vec![*first],
            bin: cell.bin,
            stratum,
        };
        looks.push((cell.place, look));
    }
    let mut looks: Vec<Look> = looks.into_iter().map(|(_, look)| look).collect();
    looks.sort_by_key(|look| look.pairs.iter().map(|(base, other)| base.id.max(other.id)).max());
    looks
}

/// A figure's differences, look by look.
struct FigureTest {
    sequence: Sequence,
    /// Mean of the differences.
    drop: f64,
    /// p after each look, for this test alone.
    p: Vec<f64>,
    log10_evidence: Vec<f64>,
}

/// Returns the mean over the looks of a figure of a pair.
fn mean(looks: &[Look], of: impl Fn(&Pair) -> f64) -> f64 {
    let each = looks
        .iter()
        .map(|look| look.pairs.iter().map(&of).sum::<f64>() / look.pairs.len() as f64);
    each.sum::<f64>() / looks.len() as f64
}

/// Returns the effect that the decisions show, where the share `left` of the texture's photos is still hit.
fn effect(confidence: &Decision, hit_rate: &Decision, left: f64) -> Effect {
    let fall = |decision: &Decision| decision.finding == SequentialFinding::Drop;
    match confidence.finding {
        SequentialFinding::Drop if fall(hit_rate) && left <= MOST_HIT => Effect::Hides,
        SequentialFinding::Drop => Effect::Weakens,
        SequentialFinding::Rise => Effect::Strengthens,
        SequentialFinding::LessThanLeast | SequentialFinding::Undecided => Effect::NothingShown,
    }
}

/// Tests a figure's differences look by look; `tests` is the number of tests that are decided together.
fn test_figure(looks: &[Look], least: Option<f64>, tests: usize, difference: impl Fn(&Pair) -> f64) -> FigureTest {
    let strata = looks.iter().map(|look| look.stratum + 1).max().unwrap_or(1);
    let mut sequence = Sequence::new(strata, least).among(tests);
    let (mut sum, mut p, mut log10_evidence) = (0.0, Vec::new(), Vec::new());
    for look in looks {
        let mean = look.pairs.iter().map(&difference).sum::<f64>() / look.pairs.len() as f64;
        sequence.see(look.stratum, mean);
        p.push(sequence.p());
        log10_evidence.push(sequence.log10_for_above());
        sum += mean;
    }
    let drop = sum / looks.len() as f64;
    FigureTest {
        sequence,
        drop,
        p,
        log10_evidence,
    }
}

/// Returns the decision on the mean confidence of detector `own`, and the look after which its change was shown. The p of all detectors are corrected
/// at each look (Holm 1979), and for the number of textures (Bonferroni): each is a p whenever one stops, so that these are, too.
fn primary(all: &[FigureTest], own: usize, textures: usize) -> (Decision, Option<usize>) {
    let at = |look: usize| {
        holm(
            &all.iter()
                .map(|f| (textures as f64 * f.p[look]).min(1.0))
                .collect::<Vec<_>>(),
        )[own]
    };
    let looks = all[own].p.len();
    let changed_after = (0..looks).find(|look| at(*look) < LEVEL).map(|look| look + 1);
    let p_corrected = looks.checked_sub(1).map(at);
    (decision(&all[own], changed_after, p_corrected), changed_after)
}

/// Returns the decision on another figure: its change is shown by its own p, and not before that of the mean confidence.
fn secondary(own: &FigureTest, gate: Option<usize>) -> Decision {
    let alone = own.p.iter().position(|p| *p < LEVEL).map(|look| look + 1);
    decision(own, alone.zip(gate).map(|(alone, gate)| alone.max(gate)), None)
}

/// Returns the decision by what was shown first: a change, or a drop smaller than the least that matters.
fn decision(own: &FigureTest, changed_after: Option<usize>, p_corrected: Option<f64>) -> Decision {
    let (sequence, none) = (&own.sequence, usize::MAX);
    let less_after = sequence.less_after();
    let finding = match (changed_after, less_after) {
        (None, None) => SequentialFinding::Undecided,
        (changed, less) if less.unwrap_or(none) < changed.unwrap_or(none) => SequentialFinding::LessThanLeast,
        _ if sequence.is_above() => SequentialFinding::Drop,
        _ => SequentialFinding::Rise,
    };
    Decision {
        drop: own.drop,
        finding,
        decided_after: changed_after.into_iter().chain(less_after).min(),
        p_always_valid: sequence.p(),
        p_corrected,
        rounds: sequence.rounds(),
        interval_95: sequence.interval_95(),
        log10_evidence: own.log10_evidence.clone(),
    }
}
