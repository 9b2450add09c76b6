//! Verdicts on the ways of each step.

use super::held_out::MethodResult;
use super::method::{Method, Question};
use super::paired::{FEWEST_PHOTOS, MARGIN, PairedErrors, PoseShift};
use super::result::{CameraCheck, CameraVerdict, Choice, PoseAdvice, Verdict};
use scaleproof_core::message::{Message, message};
use scaleproof_core::spelling::count;

/// Judges every way by the answers of each photo.
pub(super) fn put_together(
    ways: &[Method],
    answers: &[&[MethodResult]],
    disagreeing: usize,
    camera_check: Option<CameraCheck>,
) -> Result<PoseAdvice, Message> {
    let of = |way: usize| -> Vec<&MethodResult> { answers.iter().map(|photo| &photo[way]).collect() };
    let usual = ways.iter().position(Method::is_usual).map(of).unwrap_or_default();
    let located = usual.iter().filter(|answer| answer.located.is_some()).count();
    if located == 0 {
        let also = match disagreeing {
            0 => String::new(),
            _ => format!(
                "; the tags disagree with scene and camera in {}",
                count(disagreeing, "photo")
            ),
        };
        return Err(message!(
            "no photo of the session is located, so that there is nothing to compare{also}"
        ));
    }
    let held_out_photos = usual.iter().filter(|answer| answer.held_out_deg.is_some()).count();
    let mut advice = PoseAdvice {
        photos: answers.len(),
        located,
        held_out_photos,
        disagreeing,
        choices: Vec::new(),
        abstention: match camera_check.as_ref().map(|check| check.verdict) {
            None | Some(CameraVerdict::Fits) => abstention(answers.len(), held_out_photos, disagreeing),
            _ => Some("the camera file does not fit the photos, and every way would be judged by its poses".to_owned()),
        },
        camera_check,
    };
    if advice.abstention.is_some() {
        return Ok(advice);
    }
    for question in Question::ALL {
        let own = ways.iter().enumerate().filter(|(_, way)| way.question == question);
        let own: Vec<(&Method, Vec<&MethodResult>)> = own.map(|(i, way)| (way, of(i))).collect();
        advice.choices.extend(judged(&own, &usual, held_out_photos));
    }
    Ok(advice)
}

/// Returns the reason why the session cannot tell, if so, and a remedy.
fn abstention(photos: usize, held_out_photos: usize, disagreeing: usize) -> Option<String> {
    let remedy = if disagreeing > 0 && held_out_photos + disagreeing >= FEWEST_PHOTOS {
        format!(
            "the tags disagree with scene and camera in {}: calibrate with the lens, zoom and focus of these photos, or check the scene's tags",
            count(disagreeing, "photo")
        )
    } else if photos < FEWEST_PHOTOS {
        "take more photos".to_owned()
    } else {
        "print more tags, or take photos that show three of them".to_owned()
    };
    (held_out_photos < FEWEST_PHOTOS).then(|| {
        format!(
            "a tag could be left out and predicted in {}, and at least {FEWEST_PHOTOS} are needed: {remedy}",
            count(held_out_photos, "photo")
        )
    })
}

/// Judges the answers to one question, and marks the smallest that nothing speaks against.
fn judged(own: &[(&Method, Vec<&MethodResult>)], usual: &[&MethodResult], held_out_photos: usize) -> Vec<Choice> {
    let lost = |answers: &[&MethodResult]| {
        let both = answers.iter().zip(usual);
        let lost = both.filter(|(own, usual)| own.located.is_none() && usual.located.is_some());
        lost.count()
    };
    let mean = |answers: &[&MethodResult]| {
        let errors: Vec<f64> = answers.iter().filter_map(|answer| answer.held_out_deg).collect();
        (errors.len() >= held_out_photos).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    };
    let whole = own.iter().filter(|(_, answers)| lost(answers) == 0);
    let best = whole
        .filter_map(|(way, answers)| Some((mean(answers)?, way, answers)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(usual, |(_, _, answers)| answers.as_slice());
    let choice = |(way, answers): &(&Method, Vec<&MethodResult>)| choice(way, answers, (usual, best), lost(answers));
    let mut choices: Vec<Choice> = own.iter().map(choice).collect();
    let costs = own
        .iter()
        .zip(&mut choices)
        .map(|((way, _), choice)| (way.cost(choice.ms), choice));
    let enough = costs.filter(|(_, choice)| choice.verdict == Verdict::Enough);
    if let Some((_, smallest)) = enough.min_by(|a, b| a.0.total_cmp(&b.0)) {
        smallest.verdict = Verdict::Advised;
    }
    choices
}

fn choice(
    way: &Method,
    answers: &[&MethodResult],
    (usual, best): (&[&MethodResult], &[&MethodResult]),
    lost: usize,
) -> Choice {
    let paired = PairedErrors::new(answers.iter().copied().zip(best.iter().copied()));
    let [own, of_best] = paired.means();
    let worse_by_95 = paired.difference_95();
    let moved = PoseShift::between(answers.iter().copied().zip(usual.iter().copied()));
    let both = answers.iter().zip(usual);
    let both = both.filter_map(|(own, usual)| own.located.as_ref().zip(usual.located.as_ref()));
    let other_bin = both.filter(|(own, usual)| own.bin != usual.bin).count();
    // Without an interval all resamples agree.
    let is_shown = worse_by_95.map_or(own > of_best, |interval| interval.low > 0.0) && paired.photos() >= FEWEST_PHOTOS;
    let less_certain_by = moved.less_certain_by.filter(|_| way.question == Question::Tags);
    let verdict = match () {
        () if lost > 0 => Verdict::LosesPhotos,
        () if other_bin > 0 => Verdict::OtherBins,
        () if moved.beyond_doubt > 0 => Verdict::OtherPoses,
        () if paired.photos() < FEWEST_PHOTOS => Verdict::CannotTell,
        () if is_shown && own > of_best => Verdict::Worse,
        () if own > (1.0 + MARGIN) * of_best => Verdict::Larger,
        () if less_certain_by.is_some_and(|share| share > MARGIN) => Verdict::LessCertain,
        () => Verdict::Enough,
    };
    Choice {
        question: way.question,
        name: way.name(),
        lens_terms: (way.question == Question::CameraModel && !way.is_usual()).then_some(way.lens_terms),
        is_usual: way.is_usual(),
        ms: answers.iter().map(|answer| answer.ms).sum::<f64>() / answers.len().max(1) as f64,
        located: answers.iter().filter(|answer| answer.located.is_some()).count(),
        lost,
        held_out_photos: answers.iter().filter(|answer| answer.held_out_deg.is_some()).count(),
        held_out_deg: (paired.photos() > 0).then_some(own),
        worse_by_deg: (paired.photos() > 0).then_some(own - of_best),
        worse_by_95,
        moved_deg: moved.deg,
        moved_mm: moved.mm,
        other_bin,
        other_pose: moved.beyond_doubt,
        less_certain_by,
        verdict,
        viewpoints: (answers.iter().map(|answer| Some(answer.located.as_ref()?.viewpoint))).collect(),
    }
}
