//! An evaluation of patterns: the paper's tables (DTA, tables 1 and 2) and the paired differences behind them.

use super::table::line as aligned;
use super::{counted, paired};
use crate::score::{BASE_VARIANT, Compared, Comparison, EvaluatedDetector, Figures, Scores};
use scaleproof_core::spelling::{self, digits};

pub struct Evaluation<'a> {
    pub scores: &'a Scores,
    /// The variants as the tables list them, the base first.
    pub patterns: Vec<String>,
    /// Names of the detectors that the patterns were made against; table 1 has them, table 2 the others. All are in table 1 when empty.
    pub targets: Vec<String>,
    /// Each variant against those listed after it, the base's first.
    pub comparisons: Vec<Comparison>,
}

impl<'a> Evaluation<'a> {
    pub fn targets(&self) -> Vec<&'a EvaluatedDetector> {
        self.detectors(|name| self.targets.is_empty() || self.targets.iter().any(|t| t == name))
    }

    pub fn others(&self) -> Vec<&'a EvaluatedDetector> {
        let targets = self.targets();
        self.detectors(|name| targets.iter().all(|t| t.manifest.name != name))
    }

    fn detectors(&self, keep: impl Fn(&str) -> bool) -> Vec<&'a EvaluatedDetector> {
        let all = self.scores.detectors.iter();
        all.filter(|c| keep(&c.manifest.name)).collect()
    }

    pub(super) fn figures(&self, pattern: &str, detector: &EvaluatedDetector) -> Option<&'a Figures> {
        let own = self.scores.summary(&detector.manifest.name, pattern);
        own.map(|s| &s.overall)
    }

    /// `pattern` against `base` on pairs; `base` is listed before `pattern`.
    pub(super) fn compared(&self, base: &str, pattern: &str, detector: &EvaluatedDetector) -> Option<&Compared> {
        let comparison = self.comparisons.iter().find(|c| c.base == base)?;
        let of = |r: &&Compared| r.variant == pattern && r.detector == detector.manifest.name;
        comparison.results.iter().find(of)
    }
}

/// What the intervals do and do not say.
pub(super) const SCOPE: &str = "95 % intervals: bootstrap over viewpoint and light, the photos paired by both; they hold for this model, these lights \
                                and renders, not for others";

/// Widths of the first column and of the others.
const WIDTHS: (usize, usize) = (16, 16);

/// The paper's tables, and the differences of AP@0.5 with their intervals.
pub fn evaluation_tables(evaluation: &Evaluation) -> String {
    let (targets, others) = (evaluation.targets(), evaluation.others());
    let photos = evaluation.scores.photos.len() / evaluation.patterns.len().max(1);
    let ap = evaluation.scores.criteria.ap.name();
    let mut lines = vec![format!(
        "Table 1. AP@0.5 ({ap}) / mean confidence, {} a pattern",
        spelling::count(photos, "photo")
    )];
    lines.extend(table(evaluation, &targets, |f| {
        format!("{} / {}", digits(f.ap50, 2), digits(f.mean_confidence, 2))
    }));
    if !others.is_empty() {
        lines.push(String::new());
        lines.push("Table 2. Transfer to other detectors, AP@0.5".to_owned());
        lines.extend(table(evaluation, &others, |f| digits(f.ap50, 2)));
    }
    lines.push(String::new());
    lines.push("Difference of AP@0.5, paired, [95 % interval]; against the plain model also what is shown of the mean confidence".to_owned());
    let patterns = evaluation.patterns.iter().filter(|p| *p != BASE_VARIANT);
    let from_base = patterns.flat_map(|p| targets.iter().chain(&others).map(move |c| (BASE_VARIANT, p, c)));
    let others = evaluation.comparisons.iter().filter(|c| c.base != BASE_VARIANT);
    let from_others = others.flat_map(|comparison| {
        comparison.results.iter().filter_map(|r| {
            let c = targets.iter().find(|c| c.manifest.name == r.detector)?;
            Some((comparison.base.as_str(), &r.variant, c))
        })
    });
    let differences = from_base.chain(from_others);
    lines.extend(differences.filter_map(|(base, p, c)| Some(line(base, p, c, evaluation.compared(base, p, c)?))));
    lines.push(format!("({SCOPE})"));
    lines.push(format!("counts as the model: {}", counted(evaluation.scores)));
    lines.join("\n")
}

fn table(evaluation: &Evaluation, detectors: &[&EvaluatedDetector], cell: fn(&Figures) -> String) -> Vec<String> {
    let names = detectors.iter().map(|c| c.manifest.name.clone());
    let mut lines = vec![aligned("pattern", names, WIDTHS)];
    lines.extend(evaluation.patterns.iter().map(|pattern| {
        let own = detectors.iter().map(|c| evaluation.figures(pattern, c));
        aligned(pattern, own.map(|f| f.map_or("–".to_owned(), cell)), WIDTHS)
    }));
    lines
}

fn line(base: &str, pattern: &str, detector: &EvaluatedDetector, r: &Compared) -> String {
    let pair = format!("{base} − {pattern}");
    format!("{:<14} {pair:<32} {}", detector.manifest.name, drop_in_words(r))
}

/// The difference of AP with its interval, and the effect where one was asked for.
fn drop_in_words(r: &Compared) -> String {
    let range = paired::interval(&r.ap50, |v| digits(v, 2)).map(|ends| format!(" {ends}"));
    let effect = r
        .finding
        .map(|finding| format!(", {}", paired::briefly(finding.effect)));
    format!(
        "{}{}{}",
        digits(r.ap50.drop, 2),
        range.unwrap_or_default(),
        effect.unwrap_or_default()
    )
}
