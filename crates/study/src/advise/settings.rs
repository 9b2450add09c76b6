//! The advice as a file that `score --settings` takes.

use super::result::Advice;
use super::way::Question;

/// The whole file: what is absent is as usual.
pub fn settings(advice: &Advice) -> String {
    let of_session = format!(
        "# What `scaleproof advise` found to be enough for {:?}.",
        advice.session
    );
    let mut lines = vec![of_session];
    let advised = |question| advice.poses.advised(question);
    lines.push(match advised(Question::TagDetector) {
        Some(choice) => format!("tag_detector = {:?}", choice.name),
        None => "# tag_detector: the session cannot tell".to_owned(),
    });
    lines.extend(match advised(Question::CameraModel) {
        Some(choice) if choice.is_usual => Some("# lens_terms: as calibrated".to_owned()),
        Some(choice) => (choice.lens_terms).map(|terms| format!("lens_terms = {terms}  # {}", choice.name)),
        None => Some("# lens_terms: the session cannot tell".to_owned()),
    });
    let box_is_enough = advice.figures.as_ref().and_then(|figures| figures.box_is_enough);
    lines.extend(box_is_enough.map(|is_enough| {
        let line = if is_enough {
            "envelope = \"box\""
        } else {
            "# envelope: the scene's outline is needed"
        };
        line.to_owned()
    }));
    let ap = advice.figures.as_ref().and_then(|figures| figures.rows.first());
    lines.extend(ap.map(|row| format!("ap = {:?}", row.definition)));
    lines.join("\n") + "\n"
}
