//! Four ways to read one number off a curve of precision over recall. On small sets they differ by more than most effects.

/// Definition by which the curve becomes the average precision.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ApDefinition {
    /// Mean of the best precision at each of 101 recalls or beyond (pycocotools, `cocoeval.py`).
    #[default]
    Coco101,
    /// Area under the curve of the best precision at a recall or beyond (PASCAL VOC development kit, from 2010 on).
    AllPoint,
    /// Mean of the best precision at the 11 recalls 0, 0.1, …, 1 or beyond (Everingham et al. 2010, equations 1 and 2).
    Voc11,
    /// YOLOv5's `compute_ap`: joins the last point of the curve to (recall 1, precision 0) by a straight ramp, and so rewards
    /// truths that were never found. Half of eight cars found give 0.75. Only for comparison with that code's figures.
    Yolov5Ramp,
}

/// A name that no definition has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no AP definition `{0}`: choose one of {names}", names = ApDefinition::ALL.map(ApDefinition::name).join(", "))]
pub struct UnknownDefinition(String);

impl ApDefinition {
    /// All four, the default first.
    pub const ALL: [ApDefinition; 4] = [
        ApDefinition::Coco101,
        ApDefinition::AllPoint,
        ApDefinition::Voc11,
        ApDefinition::Yolov5Ramp,
    ];

    /// Returns the name that stands beside the number.
    pub fn name(self) -> &'static str {
        match self {
            ApDefinition::Coco101 => "coco-101",
            ApDefinition::AllPoint => "all-point",
            ApDefinition::Voc11 => "voc-11",
            ApDefinition::Yolov5Ramp => "yolov5-ramp",
        }
    }

    /// Returns its meaning in a few words.
    pub fn meaning(self) -> &'static str {
        match self {
            ApDefinition::Coco101 => "mean of the best precision at each of 101 recalls or beyond",
            ApDefinition::AllPoint => "area under the best precision at a recall or beyond",
            ApDefinition::Voc11 => "mean of the best precision at each of 11 recalls or beyond",
            ApDefinition::Yolov5Ramp => {
                "area that also counts a ramp from the last recall reached down to recall 1: not comparable with the other definitions"
            }
        }
    }

    /// Returns the definition of that name; the error lists the names.
    pub fn from_name(name: &str) -> Result<ApDefinition, UnknownDefinition> {
        let named = ApDefinition::ALL.into_iter().find(|d| d.name() == name);
        named.ok_or_else(|| UnknownDefinition(name.to_owned()))
    }

    /// Returns the average precision of a curve: (precision, recall) after each detection, the most confident first.
    pub fn of_curve(self, curve: &[(f64, f64)]) -> f64 {
        let best = best_from(curve);
        // As numpy's linspace makes them: i times the step, which is not always the double nearest to i / 100.
        let recall = |i: u32| if i == 100 { 1.0 } else { f64::from(i) * 0.01 };
        match self {
            ApDefinition::Coco101 => (0..=100).map(|i| at(curve, &best, recall(i))).sum::<f64>() / 101.0,
            ApDefinition::Voc11 => (0..=10).map(|i| at(curve, &best, f64::from(i) / 10.0)).sum::<f64>() / 11.0,
            ApDefinition::AllPoint => area(curve, &best),
            ApDefinition::Yolov5Ramp => ramp(curve, &best),
        }
    }
}

/// Returns for each point of the curve the best precision there or further on.
fn best_from(curve: &[(f64, f64)]) -> Vec<f64> {
    let mut precision: Vec<f64> = curve.iter().map(|(p, _)| *p).collect();
    for i in (1..precision.len()).rev() {
        precision[i - 1] = precision[i - 1].max(precision[i]);
    }
    precision
}

/// Returns the best precision at a recall or beyond; 0 beyond the recall that was reached.
fn at(curve: &[(f64, f64)], best: &[f64], recall: f64) -> f64 {
    let first = curve.partition_point(|(_, r)| *r < recall);
    best.get(first).copied().unwrap_or(0.0)
}

fn area(curve: &[(f64, f64)], best: &[f64]) -> f64 {
    let mut before = 0.0;
    let steps = curve.iter().zip(best).map(|((_, recall), precision)| {
        let width = recall - before;
        before = *recall;
        width * precision
    });
    steps.sum()
}

/// Trapezoids between 101 recalls on the curve from (recall 0, precision 1) to (1, 0), joined by straight lines.
fn ramp(curve: &[(f64, f64)], best: &[f64]) -> f64 {
    let start = best.first().map_or(0.0, |_| 1.0);
    let inner = curve
        .iter()
        .zip(best)
        .map(|((_, recall), precision)| (*recall, *precision));
    let points: Vec<(f64, f64)> = [(0.0, start)].into_iter().chain(inner).chain([(1.0, 0.0)]).collect();
    let height = |recall: f64| {
        // The last point at or before the recall, as numpy's `interp` takes it.
        let next = points.partition_point(|(r, _)| *r <= recall);
        match (points.get(next.wrapping_sub(1)), points.get(next)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) / (b.0 - a.0) * (recall - a.0),
            (Some(last), None) => last.1,
            _ => 0.0,
        }
    };
    let heights: Vec<f64> = (0..=100).map(|i| height(f64::from(i) / 100.0)).collect();
    heights.windows(2).map(|pair| (pair[0] + pair[1]) / 200.0).sum()
}
