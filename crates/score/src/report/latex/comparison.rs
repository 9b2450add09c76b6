//! `comparison.tex`: the drops with their intervals, a `tabular` for each endpoint.

use crate::figures::{Compared, Comparison, Difference, Effect, Scores};
use crate::report::Findings;
use crate::report::latex::comments::{below, commented};
use crate::report::latex::markup::{escaped, number, row, tabular};
use crate::report::table::Cell;
use crate::report::words::{certainty, p_value, paired};

/// Returns the drops of a comparison: a comment that explains the numbers, and a `tabular` for each endpoint, which fits one column of a paper of
/// two.
pub fn comparison(scores: &Scores, comparison: &Comparison) -> String {
    let protocol = scores.criteria.protocol.map(|p| format!(", protocol {}", p.name()));
    let comment = format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}. Base: {}; figures on pairs by place and bin.\n\
         % Drop with its cluster bootstrap interval ({} draws, seed {}), uncorrected; p: signs of the views flipped,\n\
         % joint over the detectors. Bold: shown. ASR: 1 - texture / {}. Hit: {}{}. Counts as the model: {}.{}",
        env!("CARGO_PKG_VERSION"),
        comparison.ap_definition,
        comparison.base,
        comparison.bootstrap_draws,
        comparison.bootstrap_seed,
        comparison.base,
        scores.criteria.hit().replace('≥', ">="),
        protocol.unwrap_or_default(),
        commented(scores),
        below(Findings::of_comparison(scores, comparison))
    );
    let p = |p: Option<f64>| {
        let p = p.map(|p| p_value(p).replace("= ", "").replace("< ", "$<$").replace("> ", "$>$"));
        p.unwrap_or_else(|| "--".to_owned())
    };
    let tables = [
        endpoint(scores, comparison, ("Mean confidence", ["$p$ & ", "rl"]), |r| {
            let cell = drop_cell(&r.mean_confidence, paired::is_confidence_shown(r));
            let shown = effect_cell(r.effect());
            (
                &r.mean_confidence,
                cell,
                format!("{} & {shown}", p(r.finding.map(|f| f.confidence_p))),
            )
        }),
        endpoint(scores, comparison, ("Hit rate", ["$p$", "r"]), |r| {
            let cell = drop_cell(&r.hit_rate.rate, paired::is_hit_rate_shown(r));
            (&r.hit_rate.rate, cell, p(r.finding.map(|f| f.hit_rate_p)))
        }),
        endpoint(scores, comparison, ("AP@0.5", ["ASR", "r"]), |r| {
            (&r.ap50, drop_cell(&r.ap50, false), asr_cell(&r.ap50))
        }),
    ];
    format!("{comment}\n{}", tables.join("\n"))
}

fn asr_cell(d: &Difference) -> String {
    d.asr.map_or("--".to_owned(), |asr| number(asr, 2))
}

/// Returns the symbol of an effect for a narrow column; a note below the table explains it.
fn effect_cell(effect: Effect) -> &'static str {
    match effect {
        Effect::Hides => "$\\Downarrow$",
        Effect::Weakens => "$\\downarrow$",
        Effect::Strengthens => "$\\uparrow$",
        Effect::NothingShown => "--",
        Effect::BaseUnseen => "?",
    }
}

const EFFECTS: &str =
    "$\\Downarrow$ hides, $\\downarrow$ weakens, $\\uparrow$ strengthens, -- nothing shown, ? cannot tell";

/// Largest number of letters of a detector's title that leaves room for the widest figures beside it; a longer one stands on a line of its own.
const LONGEST_TITLE: usize = 16;

/// Returns the table of one endpoint, given its name, and heading and alignment of its last columns; a group of rows for each texture. Small letters
/// and narrow gaps fit a column of 237 pt (CVPR).
fn endpoint<'a>(
    scores: &Scores,
    comparison: &'a Comparison,
    (name, [last, aligned]): (&str, [&str; 2]),
    cells: impl Fn(&'a Compared) -> (&'a Difference, String, String),
) -> String {
    let columns = format!("lrrl{aligned}");
    let across = |text: String| format!("\\multicolumn{{{}}}{{@{{}}l@{{}}}}{{{text}}} \\\\\n", columns.len());
    let head = row([name, "base", "text.", "Drop, 95\\,\\%", last]);
    let textures = comparison.results.chunk_by(|a, b| a.variant == b.variant);
    let blocks = textures.map(|own| {
        let pairs = scaleproof_core::spelling::count(own[0].pairs, "pair");
        let title = across(format!("\\emph{{{}}}, {pairs}", escaped(&own[0].variant)));
        let rows = own.iter().map(|r| {
            let (d, drop, last) = cells(r);
            let [base, other] = [d.base, d.other].map(|v| number(v, 2));
            let (title, cells) = (scores.title(&r.detector), [base, other, drop, last]);
            let name = escaped(title);
            if title.chars().count() > LONGEST_TITLE {
                across(name) + &row([String::new()].into_iter().chain(cells))
            } else {
                row([name].into_iter().chain(cells))
            }
        });
        std::iter::once(title).chain(rows).collect()
    });
    let decided = if comparison.sequential.is_some() {
        "bets, however often one looks"
    } else {
        "joint sign flips"
    };
    let family = certainty::family(&comparison.results).replace('×', "$\\times$");
    let bold = format!("Bold: shown; {family}, {decided}.");
    let notes = match name {
        "Mean confidence" => vec![EFFECTS.to_owned(), bold],
        "Hit rate" => vec![bold],
        _ => vec!["By intervals alone.".to_owned()],
    };
    let notes = notes
        .into_iter()
        .map(|note| across(format!("\\scriptsize {note}")))
        .collect();
    let table = tabular(
        &format!("@{{}}{columns}@{{}}"),
        std::iter::once(vec![head]).chain(blocks).chain([notes]),
    );
    format!("% {name}\n{{\\footnotesize\\setlength{{\\tabcolsep}}{{2pt}}%\n{table}}}\n")
}

fn drop_cell(d: &Difference, is_shown: bool) -> String {
    Cell::number(d.drop, 2)
        .with_interval(d.interval_95)
        .strong(is_shown)
        .tex()
}
