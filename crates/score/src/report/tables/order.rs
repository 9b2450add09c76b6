//! Table of the order of the textures here against that in other sessions.

use crate::figures::{Ranking, RankingFinding, RankingRow, Scores};
use crate::report::table::{Cell, Column, Table};
use scaleproof_core::spelling::digits;

/// Returns a row for each detector, and for each value of a condition that photos were grouped by.
pub(crate) fn order(scores: &Scores, ranking: &Ranking) -> Table {
    let mut table = Table::new(
        &format!("Order of the textures by AP@0.5, against {}", ranking.others.join(", ")),
        vec![
            Column::words("detector"),
            Column::words("photos"),
            Column::numbers("τ").called("kendall_tau_b").in_unit("95 %"),
            Column::words("finding"),
            Column::words("order here, AP@0.5 (there)").called("order"),
        ],
    );
    table
        .blocks
        .push(ranking.rows.iter().map(|row| cells(scores, row)).collect());
    table.notes.push(
        "τ: Kendall's τ-b of the two orders, from 1 (alike) to −1 (upside down), over the places and bins that have photos of all of these textures; its interval over 2,000 resamples \
         of the clusters of both, none with fewer than six clusters, or when all resamples agree. The order holds when the interval lies above 0"
            .to_owned(),
    );
    table.notes.extend(ranking.cautions.iter().cloned());
    table
}

fn cells(scores: &Scores, row: &RankingRow) -> Vec<Cell> {
    let tau = match row.tau {
        Some(tau) => Cell::number(tau, 2).with_interval(row.interval_95),
        None => Cell::default().with_remark(Some("all tied".to_owned())),
    };
    let order = row.variants.iter().map(|own| {
        let [here, there] = [own.ap50, own.other_ap50].map(|ap| digits(ap, 2));
        format!("{} {here} ({there})", own.variant)
    });
    vec![
        Cell::text(scores.title(&row.detector)),
        Cell::text(&row.photos),
        tau,
        Cell::text(finding_words(row)),
        Cell::text(order.collect::<Vec<_>>().join(", ")),
    ]
}

fn finding_words(row: &RankingRow) -> &'static str {
    match row.finding {
        RankingFinding::Holds => "the order holds",
        RankingFinding::Reversed => "the order is another",
        RankingFinding::TooFewPhotosToTell => "too few photos to tell",
    }
}
