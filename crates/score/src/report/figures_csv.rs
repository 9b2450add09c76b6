//! `figures.csv`: one line per detector, variant and group of photos: all of them, an azimuth, a cell, a place, a value of a condition.

use serde_json::{Value, json};

use super::{ReportError, Row, csv_of};
use crate::score::{Asr, Drop, Figures, Protocol, Rate, Scores, Summary};

pub(super) fn render(scores: &Scores) -> Result<String, ReportError> {
    csv_of(scores.summaries.iter().flat_map(|s| rows(scores, s)))
}

/// A group of photos: its kind, the columns that name it, and what is known of it. The kind is `all`, `azimuth`, `cell` (azimuth × pitch × distance),
/// `place` or `condition`.
type Group<'a> = (
    &'static str,
    Vec<(&'static str, Value)>,
    Option<&'a Figures>,
    Option<Drop>,
    Option<Asr>,
);

fn rows<'a>(scores: &Scores, s: &'a Summary) -> Vec<Row<'a>> {
    let all = ("all", Vec::new(), Some(&s.overall), s.drop, s.asr);
    let azimuths = s.azimuth_bins.iter().map(|b| -> Group {
        let about = vec![("bin_azimuth_deg", json!(b.azimuth_deg))];
        ("azimuth", about, b.figures.as_ref(), b.drop, None)
    });
    let cells = s.cells.iter().map(|c| -> Group {
        let about = vec![
            ("bin_azimuth_deg", json!(c.bin.azimuth_deg)),
            ("bin_pitch_deg", json!(c.bin.pitch_deg)),
            ("bin_distance_mm", json!(c.bin.distance_mm)),
        ];
        ("cell", about, Some(&c.figures), c.drop, None)
    });
    let places = s.places.iter().map(|p| -> Group {
        let about = vec![("place", json!(p.place))];
        ("place", about, Some(&p.figures), p.drop, None)
    });
    let conditions = s.conditions.iter().map(|c| -> Group {
        let about = vec![("condition", json!(c.condition)), ("value", json!(c.value))];
        ("condition", about, Some(&c.figures), c.drop, c.asr)
    });
    let groups = azimuths.chain(cells).chain(places).chain(conditions);
    [all].into_iter().chain(groups).map(|g| row(scores, s, g)).collect()
}

/// The columns that name a group; those of other kinds are empty.
const ABOUT: [&str; 6] = [
    "bin_azimuth_deg",
    "bin_pitch_deg",
    "bin_distance_mm",
    "place",
    "condition",
    "value",
];

/// The line of a group; one without photos has no figures but its zero.
fn row<'a>(scores: &Scores, s: &Summary, (kind, about, figures, drop, asr): Group) -> Row<'a> {
    let criteria = &scores.criteria;
    let figure = |of: fn(&Figures) -> f64| json!(figures.map(of));
    let drop = |of: fn(&Drop) -> f64| json!(drop.as_ref().map(of));
    let named = |column| {
        about
            .iter()
            .find(|(name, _)| *name == column)
            .map(|(_, value)| value.clone())
    };
    let mut row = vec![
        ("detector", json!(s.detector)),
        ("variant", json!(s.variant)),
        ("group", json!(kind)),
    ];
    row.extend(ABOUT.map(|column| (column, named(column).unwrap_or_default())));
    row.extend([
        ("photos", json!(figures.map_or(0, |f| f.photos))),
        ("protocol", json!(criteria.protocol.map(Protocol::name))),
        ("ap_definition", json!(criteria.ap.name())),
        ("ap50", figure(|f| f.ap50)),
        ("ap50_95", figure(|f| f.ap50_95)),
        ("mar50", figure(|f| f.mar50)),
        ("mar", figure(|f| f.mar)),
        ("hit_confidence", json!(criteria.hit_confidence)),
    ]);
    let hit = ["hits", "hit_rate", "hit_rate_low", "hit_rate_high"];
    let misclassified = [
        "misclassified",
        "misclassification_rate",
        "misclassification_rate_low",
        "misclassification_rate_high",
    ];
    let disappeared = [
        "disappeared",
        "disappearance_rate",
        "disappearance_rate_low",
        "disappearance_rate_high",
    ];
    row.extend(rate(hit, figures.map(|f| f.hit_rate)));
    row.extend(rate(misclassified, figures.map(|f| f.misclassification_rate)));
    row.extend(rate(disappeared, figures.map(|f| f.disappearance_rate)));
    row.extend([
        ("hallucinations_per_image", figure(|f| f.hallucinations_per_image)),
        ("false_positives_per_image", figure(|f| f.false_positives_per_image)),
        ("mean_confidence", figure(|f| f.mean_confidence)),
        ("median_confidence", figure(|f| f.median_confidence)),
        ("drop_ap50", drop(|d| d.ap50)),
        ("drop_hit_rate", drop(|d| d.hit_rate)),
        ("drop_mean_confidence", drop(|d| d.mean_confidence)),
        ("drop_median_confidence", drop(|d| d.median_confidence)),
        ("asr_ap50", json!(asr.and_then(|a| a.ap50))),
        ("asr_mar50", json!(asr.and_then(|a| a.mar50))),
        ("asr_hit_rate", json!(asr.and_then(|a| a.hit_rate))),
    ]);
    row
}

/// The columns of a rate: its count, itself and the ends of its interval.
fn rate(names: [&str; 4], rate: Option<Rate>) -> [(&str, Value); 4] {
    let [count, share, low, high] = names;
    [
        (count, json!(rate.map(|r| r.count))),
        (share, json!(rate.map(|r| r.rate))),
        (low, json!(rate.map(|r| r.low))),
        (high, json!(rate.map(|r| r.high))),
    ]
}
