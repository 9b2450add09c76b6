//! Table of the figures that papers compare beside AP@0.5.

use crate::figures::{Compared, Difference, Summary};
use crate::report::Findings;
use crate::report::table::{Cell, Column, Table};
use crate::report::tables::by_detector::by_detector;
use crate::report::words::certainty;

/// Returns AP@[.5:.95], recalls, false positives and attack success rates.
pub(crate) fn papers(findings: Findings) -> Table {
    let mut table = Table::new(
        "Figures that papers compare",
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::numbers("AP@[.5:.95]").called("ap50_95"),
            Column::numbers("mAR").called("mar"),
            Column::numbers("mAR 50").called("mar50"),
            Column::numbers("FPPI").called("false_positives_per_image"),
            Column::numbers("ASR of AP@0.5").called("asr_ap50").in_unit("95 %"),
            Column::numbers("ASR of hits").called("asr_hit_rate").in_unit("95 %"),
        ],
    );
    by_detector(findings.scores, |s| cells(findings, s)).for_each(|rows| table.add_block(rows));
    table.notes = vec![
        format!(
            "mAR: mean of the largest recalls; FPPI: false positives per image; ASR: attack success rate, 1 − this texture ÷ {}, on paired photos where there are pairs",
            findings.base
        ),
        "A rate without an interval is not certain: where no photo was hit, Wilson's interval says up to which hit rate these photos leave open"
            .to_owned(),
    ];
    table
}

fn cells(findings: Findings, s: &Summary) -> Vec<Cell> {
    let f = &s.overall;
    let rates = match (findings.compared(&s.detector, &s.variant), s.asr) {
        (Some(r), _) => [asr(r, &r.ap50), asr(r, &r.hit_rate.rate)],
        (None, Some(asr)) => [asr.ap50, asr.hit_rate].map(|asr| Cell::maybe(asr, 2)),
        (None, None) => [(); 2].map(|()| Cell::text("")),
    };
    let averages = [f.ap50_95, f.mar, f.mar50].map(|average| Cell::number(average, 3));
    let mut cells = averages.to_vec();
    cells.push(Cell::number(f.false_positives_per_image, 2));
    cells.extend(rates);
    cells
}

/// Returns the attack success rate with its interval, or the reason why it has none.
fn asr(r: &Compared, d: &Difference) -> Cell {
    let why = (d.asr.is_some() && d.asr_interval_95.is_none()).then(|| certainty::without_interval(r, d));
    Cell::maybe(d.asr, 2).with_interval(d.asr_interval_95).with_remark(why)
}
