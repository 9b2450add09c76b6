//! Effect of the definition of AP and of the envelope behind the truth boxes on the findings of a session.

use serde::Serialize;

use scaleproof_core::statistics::Interval;
use scaleproof_score::{ApDefinition, CompareError, Effect, Scores, compare, moved_drops};

/// The drop of AP of one detector and texture, by one definition and envelope.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FigureRow {
    pub detector: String,
    pub variant: String,
    /// Definition of average precision: `coco-101`, `all-point`, `voc-11` or `yolov5-ramp`.
    pub definition: &'static str,
    /// Envelope that truth boxes are drawn around: `box`, `hull` or `mesh`.
    pub envelope: &'static str,
    /// AP@0.5 of the base; `ap50` is that of the variant, `drop` base minus variant.
    pub base_ap50: f64,
    pub ap50: f64,
    pub drop: f64,
    /// 95 % interval of the drop; `null` with too few clusters, and when all clusters differ alike.
    pub drop_95: Option<Interval>,
    /// Effect on the mean confidence, on which the definition of AP has no bearing.
    pub effect: Effect,
    /// The drop minus that of the usual way, on the same photos, and in `moved_by_95` its 95 % interval; `null` for the usual way.
    pub moved_by: Option<f64>,
    pub moved_by_95: Option<Interval>,
}

impl FigureRow {
    /// Returns the side of 0 on which the interval of the drop lies; 0 where it holds 0, or there is none.
    fn side(&self) -> i8 {
        match self.drop_95 {
            Some(interval) if interval.low > 0.0 => 1,
            Some(interval) if interval.high < 0.0 => -1,
            _ => 0,
        }
    }
}

/// Dependence of the drops of AP, and of the findings, on the definition of AP and on the truth boxes.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FigureAdvice {
    /// One for each detector, texture, definition of AP and truth box; those of the usual way first.
    pub rows: Vec<FigureRow>,
    /// Definitions that leave every interval of a drop on the same side of 0, the usual one among them.
    pub same_findings: Vec<&'static str>,
    /// The largest difference of a drop from that by the usual definition.
    pub definition_moves: f64,
    /// The largest move of a drop when the box of the model's size replaces the outline; `null` where the box is the outline.
    pub box_moves: Option<f64>,
    /// True if the box changes no effect, takes no interval to another side of 0, and moves no drop by more than 0.01; `null` where the box is the
    /// outline.
    pub box_is_enough: Option<bool>,
}

/// Largest move of a drop of AP at which the box is enough.
pub(super) const BOX_MARGIN: f64 = 0.01;

/// Compares the textures by every definition of AP, and by the box instead of the model's outline. `by_box`: the same photos scored by the box, where that is another envelope.
pub fn advise_figures(scores: &Scores, by_box: Option<&Scores>, base: &str) -> Result<FigureAdvice, CompareError> {
    let envelope = scores.sessions[0].scene.model.envelope.name();
    let usual_way = (scores, scores.criteria.ap);
    let usual = rows_of(usual_way, None, base, envelope)?;
    let same = |own: &[FigureRow]| {
        own.iter()
            .zip(&usual)
            .all(|(a, b)| a.effect == b.effect && a.side() == b.side())
    };
    let moves = |own: &[FigureRow]| {
        let moved = own.iter().filter_map(|row| row.moved_by);
        moved.map(f64::abs).fold(0.0, f64::max)
    };
    let (mut same_findings, mut definition_moves, mut others) = (Vec::new(), 0.0_f64, Vec::new());
    for definition in ApDefinition::ALL {
        let own = if definition == scores.criteria.ap {
            Vec::new()
        } else {
            rows_of((scores, definition), Some(usual_way), base, envelope)?
        };
        if same(&own) {
            same_findings.push(definition.name());
        }
        definition_moves = definition_moves.max(moves(&own));
        others.extend(own);
    }
    let by_box = by_box.map(|scores| rows_of((scores, scores.criteria.ap), Some(usual_way), base, "box"));
    let by_box = by_box.transpose()?;
    let of_box = by_box.as_ref().map(|own| (moves(own), same(own)));
    let rows = usual.into_iter().chain(others).chain(by_box.into_iter().flatten());
    Ok(FigureAdvice {
        same_findings,
        definition_moves,
        box_moves: of_box.map(|(moves, _)| moves),
        box_is_enough: of_box.map(|(moves, same)| same && moves <= BOX_MARGIN),
        rows: rows.collect(),
    })
}

/// Returns the rows of one way to measure: of these scores, by a definition of AP. `usual`: the way they are compared with.
fn rows_of(
    (scores, definition): (&Scores, ApDefinition),
    usual: Option<(&Scores, ApDefinition)>,
    base: &str,
    envelope: &'static str,
) -> Result<Vec<FigureRow>, CompareError> {
    let compared = compare(scores, base, definition)?.results.into_iter();
    let rows = compared.map(|r| FigureRow {
        effect: r.effect(),
        detector: r.detector,
        variant: r.variant,
        definition: definition.name(),
        envelope,
        base_ap50: r.ap50.base,
        ap50: r.ap50.other,
        drop: r.ap50.drop,
        drop_95: r.ap50.interval_95,
        moved_by: None,
        moved_by_95: None,
    });
    let mut rows: Vec<FigureRow> = rows.collect();
    // The detectors of one variant after the other, as they were compared.
    for of_variant in rows.chunk_by_mut(|a, b| a.variant == b.variant) {
        let variant = of_variant[0].variant.clone();
        let moved = usual.map(|(usual, by)| moved_drops(usual, by, scores, definition, base, &variant));
        for (row, moved) in of_variant.iter_mut().zip(moved.into_iter().flatten()) {
            (row.moved_by, row.moved_by_95) = (Some(moved.by), moved.interval_95);
        }
    }
    Ok(rows)
}
