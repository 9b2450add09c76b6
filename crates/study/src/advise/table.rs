//! The advice as text, and as a file that `score --settings` takes.

use super::figures::{BOX_MARGIN, FigureAdvice};
use super::method::Question;
use super::result::{Advice, CameraCheck, CameraVerdict, Choice, Verdict};
use scaleproof_core::spelling::{count, digits};
use scaleproof_core::statistics::Interval;
use scaleproof_score::ApDefinition;

/// Returns a table for each question, the answers from small to large as they were measured.
pub fn table(all: &Advice) -> String {
    let advice = &all.poses;
    let mut lines = vec![format!(
        "{}{}, {} of them located; a tag could be left out and predicted in {}",
        unreadable(all),
        count(advice.photos, "photo"),
        advice.located,
        advice.held_out_photos
    )];
    let asked = Question::ALL.into_iter().filter(|_| !advice.choices.is_empty());
    for question in asked {
        let title = question.title();
        lines.push(format!(
            "\n{title:<18}       ms  located held out °       more than the best °   moved °  moved mm  "
        ));
        lines.extend(advice.choices_for(question).map(line));
    }
    lines.extend(advice.camera_check.iter().map(|check| format!("\n{}", camera(check))));
    let findings = all.figures.iter().flat_map(findings);
    lines.extend(findings.map(|line| format!("\n{line}")));
    let abstention = advice.abstention.iter();
    lines.extend(abstention.map(|why| format!("\nno advice on poses: {why}")));
    lines.join("\n")
}

/// Returns the part of a sentence on photos that could not be read; empty without any.
pub(super) fn unreadable(all: &Advice) -> String {
    match all.unreadable {
        0 => String::new(),
        unreadable => format!("without {} that could not be read: ", count(unreadable, "photo")),
    }
}

pub(super) fn number(value: Option<f64>, places: usize, unit: &str) -> String {
    value.map_or("–".to_owned(), |value| digits(value, places) + unit)
}

/// Formats ` [0.0010, 0.0123]`; empty without an interval.
pub(super) fn interval(interval: Option<Interval>, places: usize) -> String {
    interval.map_or(String::new(), |i| {
        format!(" [{}, {}]", digits(i.low, places), digits(i.high, places))
    })
}

fn line(choice: &Choice) -> String {
    let worse = number(choice.worse_by_deg, 4, "") + &interval(choice.worse_by_95, 4);
    let usual = if choice.is_usual { " (usual)" } else { "" };
    let arrow = if choice.verdict == Verdict::Advised { "← " } else { "" };
    let (name, ms, located) = (&choice.name, digits(choice.ms, 2), choice.located);
    let held_out = number(choice.held_out_deg, 4, "");
    let (deg, mm) = (number(choice.moved_deg, 4, ""), number(choice.moved_mm, 2, ""));
    let verdict = in_words(choice);
    format!("{name:<18} {ms:>8} {located:>8} {held_out:>10} {worse:>26} {deg:>9} {mm:>9}  {arrow}{verdict}{usual}")
}

/// Returns the verdict on a way in words.
pub(super) fn in_words(choice: &Choice) -> String {
    match choice.verdict {
        Verdict::Advised => "advised".to_owned(),
        Verdict::Enough => "enough".to_owned(),
        Verdict::LosesPhotos => format!("loses {}", count(choice.lost, "photo")),
        Verdict::OtherBins => format!("other bin in {}", count(choice.other_bin, "photo")),
        Verdict::OtherPoses => format!("another pose in {}", count(choice.other_pose, "photo")),
        Verdict::Worse => "worse".to_owned(),
        Verdict::Larger => "over a twentieth worse, not shown".to_owned(),
        Verdict::LessCertain => format!(
            "{} % less certain",
            digits(100.0 * choice.less_certain_by.unwrap_or(0.0), 0)
        ),
        Verdict::CannotTell => "cannot tell".to_owned(),
    }
}

/// Returns a sentence on whether the camera file is that of the photos.
pub(super) fn camera(check: &CameraCheck) -> String {
    let errors = format!(
        "{}° by the file, {}° by cameras refitted to the other half of the photos",
        digits(check.held_out_deg, 4),
        digits(check.refitted_deg, 4)
    );
    let by = check.better_by_95.map_or(String::new(), |i| {
        format!(
            "; difference {}{}",
            digits(check.better_by_deg, 4),
            interval(Some(i), 4)
        )
    });
    match check.verdict {
        CameraVerdict::Fits => format!("camera file: it fits the photos ({errors}{by})"),
        CameraVerdict::OtherCamera => format!(
            "camera file: it does not fit the photos ({errors}{by}). Refitted: {}; viewpoints move by {}° and {} mm. Calibrate again with the lens, zoom and focus of these photos, or check the \
             scene's tag sizes",
            refitted(check),
            digits(check.moved_deg, 3),
            digits(check.moved_mm, 1)
        ),
        CameraVerdict::NoCameraFits => format!(
            "camera file: cannot tell ({errors}{by}). In a quarter of the photos or more tags disagree with it, and fit four times worse than in the others; no other camera is shown better: were all photos taken with one lens, zoom, \
             focus and orientation, and was no card moved?"
        ),
    }
}

fn refitted(check: &CameraCheck) -> String {
    let two = |values: [f64; 2], places: usize| {
        let [a, b] = values.map(|value| digits(value, places));
        format!("{a} and {b}")
    };
    format!(
        "a focal length of {} px (file: {}), a centre {} px off, a k1 of {} (file: {})",
        two(check.refitted_focal_px, 0),
        digits(check.focal_px, 0),
        two(check.centre_moved_px, 1),
        two(check.refitted_k1, 3),
        digits(check.k1, 3)
    )
}

/// Returns sentences on the choices that the findings depend on.
pub(super) fn findings(figures: &FigureAdvice) -> Vec<String> {
    let usual = figures.rows.first().map_or("", |row| row.definition);
    let same = figures.same_findings.len();
    let definitions = if same == ApDefinition::ALL.len() {
        format!("definition of AP: {usual}; the findings are the same by all {same}")
    } else {
        format!(
            "definition of AP: {usual}; the findings are the same by {} alone",
            figures.same_findings.join(", ")
        )
    };
    let moves = digits(figures.definition_moves, 3);
    let of_box = match (figures.box_moves, figures.box_is_enough) {
        (Some(moves), Some(true)) => format!("truth boxes: the model's size is enough for AP@0.5; it moves its drops by {} at most, and no finding", digits(moves, 3)),
        (Some(moves), _) => format!(
            "truth boxes: the model's outline is needed; its size moves drops of AP@0.5 by up to {} (at most {BOX_MARGIN} is allowed), or a finding",
            digits(moves, 3)
        ),
        _ => "no advice on truth boxes: the scene has the model's size alone; name its mesh or hull in the scene, and whether the size is enough can be told".to_owned(),
    };
    vec![format!("{definitions}, and the drops move by up to {moves}"), of_box]
}

/// Returns the file for `score --settings`: what is absent is as usual.
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
