//! The order of the textures against that in other sessions, in words.

use super::paired::ends;
use crate::score::{Ranking, RankingFinding, RankingRow, Scores};
use scaleproof_core::spelling::digits;

/// A line for each order; none where it was not asked for.
pub(super) fn lines(scores: &Scores) -> Vec<String> {
    let Some(ranking) = &scores.ranking else {
        return Vec::new();
    };
    let head = format!(
        "\norder of the textures by AP@0.5, against {}:",
        ranking.others.join(", ")
    );
    let none = ranking.cautions.iter().map(|caution| format!("  {caution}"));
    let rows = ranking.rows.iter().map(|row| {
        let photos = if row.photos == "all" {
            String::new()
        } else {
            format!(", {}", row.photos)
        };
        format!("  {}{photos}: τ {}: {}", row.detector, tau(row), found(row))
    });
    std::iter::once(head).chain(rows).chain(none).collect()
}

/// `0.67 [0.33, 1.00]`
pub(super) fn tau(row: &RankingRow) -> String {
    let interval = row.interval_95.map(|i| format!(" {}", ends(i, |v| digits(v, 2))));
    match row.tau {
        Some(tau) => digits(tau, 2) + &interval.unwrap_or_default(),
        None => "– (all tied)".to_owned(),
    }
}

pub(super) fn found(row: &RankingRow) -> &'static str {
    match row.finding {
        RankingFinding::Holds => "the order holds",
        RankingFinding::Reversed => "the order is another",
        RankingFinding::TooFewPhotosToTell => "too few photos to tell",
    }
}

pub(super) fn note(ranking: &Ranking) -> String {
    format!(
        "Against {}. Textures are ordered by AP@0.5 in the places and bins that have photos of all of them. τ: Kendall's τ-b of the two orders, from 1 (alike) to −1 (upside down), with a 95 % interval over \
         2,000 resamples of the clusters of both; none with fewer than six clusters, or when all resamples agree. The order holds when the interval lies above 0.",
        ranking.others.join(", ")
    )
}
