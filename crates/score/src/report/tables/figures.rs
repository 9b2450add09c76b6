//! Tables of the figures of every detector and texture, in the layout of the field's papers.

use crate::figures::{Compared, Difference, Drop, Scores, Summary};
use crate::report::Findings;
use crate::report::table::{Cell, Column, Table};
use crate::report::tables::by_detector::by_detector;
use crate::report::words::paired;
use scaleproof_core::statistics::Interval;

/// Returns AP, hit rate and confidence with their drops from the base.
pub(crate) fn figures(findings: Findings) -> Table {
    let drop = |key: &str| Column::numbers("drop").called(key).in_unit("95 %");
    let mut table = Table::new(
        "AP@0.5, hit rate and confidence",
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::numbers("photos"),
            Column::numbers("AP@0.5").called("ap50"),
            drop("drop_ap50"),
            Column::numbers("hits"),
            Column::numbers("hit rate").in_unit("95 %"),
            drop("drop_hit_rate"),
            Column::numbers("confidence").called("mean_confidence"),
            drop("drop_mean_confidence"),
        ],
    );
    by_detector(findings.scores, |s| cells(findings, s)).for_each(|rows| table.add_block(rows));
    table
}

fn cells(findings: Findings, s: &Summary) -> Vec<Cell> {
    let (f, rate) = (&s.overall, &s.overall.hit_rate);
    let wilson = Interval {
        low: rate.low,
        high: rate.high,
    };
    let shown = paired::is_confidence_shown;
    vec![
        Cell::count(f.photos),
        Cell::number(f.ap50, 3),
        drop(findings, s, |d| d.ap50, |r| &r.ap50, |_| false),
        Cell::share(rate.count, f.photos),
        Cell::number(rate.rate, 2).with_interval(Some(wilson)),
        drop(
            findings,
            s,
            |d| d.hit_rate,
            |r| &r.hit_rate.rate,
            paired::is_hit_rate_shown,
        ),
        Cell::number(f.mean_confidence, 2),
        drop(findings, s, |d| d.mean_confidence, |r| &r.mean_confidence, shown),
    ]
}

/// Returns the drop on paired photos with its interval, or over all photos where none pair.
fn drop(
    findings: Findings,
    s: &Summary,
    overall: fn(&Drop) -> f64,
    of: fn(&Compared) -> &Difference,
    is_shown: fn(&Compared) -> bool,
) -> Cell {
    match (findings.compared(&s.detector, &s.variant), s.drop) {
        (Some(r), _) => Cell::number(of(r).drop, 2)
            .with_interval(of(r).interval_95)
            .strong(is_shown(r)),
        (None, Some(drop)) => Cell::number(overall(&drop), 2).with_remark(Some("not paired".to_owned())),
        (None, None) => Cell::text(""),
    }
}

/// Returns the figures that a screen has room for where nothing is compared.
pub(crate) fn figures_of_screen(scores: &Scores) -> Table {
    let mut table = Table::new(
        "Hits, confidence and AP@0.5",
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::numbers("hits"),
            Column::numbers("confidence").called("mean_confidence"),
            Column::numbers("AP@0.5").called("ap50"),
        ],
    );
    let cells = |s: &Summary| {
        let f = &s.overall;
        vec![
            Cell::share(f.hit_rate.count, f.photos),
            Cell::number(f.mean_confidence, 2),
            Cell::number(f.ap50, 2),
        ]
    };
    by_detector(scores, cells).for_each(|rows| table.add_block(rows));
    table
}
