//! Table of the drop of the hit rate in each direction.

use crate::report::Findings;
use crate::report::table::{Cell, Column, Table};

/// Returns a row for each detector and texture, a column for each azimuth.
pub(crate) fn by_azimuth(findings: Findings) -> Table {
    let scores = findings.scores;
    let azimuths = scores.sessions[0].scene.bins.azimuth_centres();
    let names = [
        Column::words("detector"),
        Column::words("texture"),
        Column::numbers("pairs"),
    ];
    let columns = names
        .into_iter()
        .chain(azimuths.iter().map(|azimuth| Column::numbers(&format!("{azimuth}°"))));
    let mut table = Table::new("Drop of the hit rate by azimuth", columns.collect());
    for own in scores.detectors.iter() {
        let own = findings.results.iter().filter(|r| r.detector == own.manifest.name);
        table.add_block(own.map(|r| {
            let cells = azimuths.iter().map(|azimuth| {
                let bin = r
                    .azimuth_bins
                    .iter()
                    .find(|bin| (bin.azimuth_deg - azimuth).abs() < 1e-6);
                bin.map_or_else(Cell::default, |bin| {
                    Cell::number(bin.hits.rate.drop, 2).with_interval(bin.hits.rate.interval_95)
                })
            });
            let names = [
                Cell::text(scores.title(&r.detector)),
                Cell::text(&r.variant),
                Cell::count(r.pairs),
            ];
            names.into_iter().chain(cells).collect()
        }));
    }
    table
        .notes
        .push("A 95 % interval where a bin has six places or more; nothing is tested. –: no pair".to_owned());
    table
}
