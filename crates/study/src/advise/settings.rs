//! The advice as a file that `score --settings` takes.

use super::result::Advice;
use super::way::Question;

/// The whole file: what is absent is as usual.
pub fn settings(advice: &Advice) -> String {
    let mut lines = vec![format!(
        "# What `scaleproof advise` found to be enough for {:?}.",
        advice.session
    )];
    let advised = |question| advice.poses.advised(question);
    match advised(Question::TagDetector) {
        Some(choice) => lines.push(format!("tag_detector = {:?}", choice.name)),
        None => lines.push("# tag_detector: the session cannot tell".to_owned()),
    }
    match advised(Question::CameraModel) {
        Some(choice) if choice.is_usual => lines.push("# lens_terms: as calibrated".to_owned()),
        Some(choice) => lines.extend(
            choice
                .lens_terms
                .map(|terms| format!("lens_terms = {terms}  # {}", choice.name)),
        ),
        None => lines.push("# lens_terms: the session cannot tell".to_owned()),
    }
    let box_is_enough = advice.figures.as_ref().and_then(|figures| figures.box_is_enough);
    lines.extend(box_is_enough.map(|enough| {
        if enough {
            "envelope = \"box\"".to_owned()
        } else {
            "# envelope: the scene's outline is needed".to_owned()
        }
    }));
    let ap = advice.figures.as_ref().and_then(|figures| figures.rows.first());
    lines.extend(ap.map(|row| format!("ap = {:?}", row.definition)));
    lines.join("\n") + "\n"
}
