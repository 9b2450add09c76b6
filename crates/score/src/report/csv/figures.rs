//! `figures.csv`: one line per detector, variant and group of photos: all of them, an azimuth, a cell, a place, a value of a condition.

use serde_json::{Value, json};

use crate::figures::{Asr, Drop, Figures, Protocol, Rate, Scores, Summary};
use crate::report::ReportError;
use crate::report::csv::rows::{Row, csv_of};
use crate::report::words::counted;
use scaleproof_pose::scene::Bin;

pub fn render(scores: &Scores) -> Result<String, ReportError> {
    csv_of(scores.summaries.iter().flat_map(|s| rows(scores, s)))
}

#[derive(Default)]
struct Group<'a> {
    /// `all`, `azimuth`, `cell` (azimuth × elevation × distance), `place` or `condition`.
    kind: &'static str,
    azimuth_deg: Option<f64>,
    cell: Option<Bin>,
    place: Option<&'a str>,
    condition: Option<[&'a str; 2]>,
    figures: Option<&'a Figures>,
    drop: Option<Drop>,
    asr: Option<Asr>,
}

fn rows<'a>(scores: &Scores, s: &'a Summary) -> Vec<Row<'a>> {
    let group = |kind, figures, drop| Group {
        kind,
        figures,
        drop,
        ..Group::default()
    };
    let all = Group {
        asr: s.asr,
        ..group("all", Some(&s.overall), s.drop)
    };
    let azimuths = s.azimuth_bins.iter().map(|b| Group {
        azimuth_deg: Some(b.azimuth_deg),
        ..group("azimuth", b.figures.as_ref(), b.drop)
    });
    let cells = s.cells.iter().map(|c| Group {
        azimuth_deg: Some(c.bin.azimuth_deg),
        cell: Some(c.bin),
        ..group("cell", Some(&c.figures), c.drop)
    });
    let places = s.places.iter().map(|p| Group {
        place: p.place.as_deref(),
        ..group("place", Some(&p.figures), p.drop)
    });
    let conditions = s.conditions.iter().map(|c| Group {
        condition: Some([&c.condition, &c.value]),
        asr: c.asr,
        ..group("condition", Some(&c.figures), c.drop)
    });
    let groups = azimuths.chain(cells).chain(places).chain(conditions);
    [all].into_iter().chain(groups).map(|g| row(scores, s, &g)).collect()
}

/// Returns the line of a group; a group without photos has 0 photos and no other figures.
fn row<'a>(scores: &Scores, s: &Summary, g: &Group) -> Row<'a> {
    let criteria = &scores.criteria;
    let figure = |of: fn(&Figures) -> f64| json!(g.figures.map(of));
    // A single photo has no ranking, and so no AP.
    let several = g.figures.filter(|f| f.photos > 1 || g.kind == "all");
    let average = |of: fn(&Figures) -> f64| json!(several.map(of));
    let drop = |of: fn(&Drop) -> f64| json!(g.drop.as_ref().map(of));
    let mut row = vec![
        ("detector", json!(s.detector)),
        ("variant", json!(s.variant)),
        ("group", json!(g.kind)),
        ("bin_azimuth_deg", json!(g.azimuth_deg)),
        ("bin_pitch_deg", json!(g.cell.map(|bin| bin.pitch_deg))),
        ("bin_distance_mm", json!(g.cell.map(|bin| bin.distance_mm))),
        ("place", json!(g.place)),
        ("condition", json!(g.condition.map(|[name, _]| name))),
        ("value", json!(g.condition.map(|[_, value]| value))),
        ("photos", json!(g.figures.map_or(0, |f| f.photos))),
        ("protocol", json!(criteria.protocol.map(Protocol::name))),
        ("ap_definition", json!(criteria.ap.name())),
        ("box_labels", json!(counted::box_labels_of(scores, &s.detector))),
        ("ap50", average(|f| f.ap50)),
        ("ap50_95", average(|f| f.ap50_95)),
        ("mar50", figure(|f| f.mar50)),
        ("mar", figure(|f| f.mar)),
        ("hit_confidence", json!(criteria.hit_confidence)),
    ];
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
    row.extend(rate(hit, g.figures.map(|f| f.hit_rate)));
    row.extend(rate(misclassified, g.figures.map(|f| f.misclassification_rate)));
    row.extend(rate(disappeared, g.figures.map(|f| f.disappearance_rate)));
    row.extend([
        ("hallucinations_per_image", figure(|f| f.hallucinations_per_image)),
        ("false_positives_per_image", figure(|f| f.false_positives_per_image)),
        ("mean_confidence", figure(|f| f.mean_confidence)),
        ("median_confidence", figure(|f| f.median_confidence)),
        ("drop_ap50", json!(several.and(g.drop.as_ref()).map(|d| d.ap50))),
        ("drop_hit_rate", drop(|d| d.hit_rate)),
        ("drop_mean_confidence", drop(|d| d.mean_confidence)),
        ("drop_median_confidence", drop(|d| d.median_confidence)),
        ("asr_ap50", json!(several.and(g.asr).and_then(|a| a.ap50))),
        ("asr_mar50", json!(g.asr.and_then(|a| a.mar50))),
        ("asr_hit_rate", json!(g.asr.and_then(|a| a.hit_rate))),
    ]);
    row
}

/// Returns the columns of a rate: its count, the rate itself and the ends of its interval.
fn rate(names: [&str; 4], rate: Option<Rate>) -> [(&str, Value); 4] {
    let [count, share, low, high] = names;
    [
        (count, json!(rate.map(|r| r.count))),
        (share, json!(rate.map(|r| r.rate))),
        (low, json!(rate.map(|r| r.low))),
        (high, json!(rate.map(|r| r.high))),
    ]
}
