//! What a session needs: each step from a photo to a figure, done in smaller and larger ways on its own photos, and the smallest that is not shown worse.
//!
//! No truth is needed: a pose is judged by how well it predicts the corners of a tag that it was not made of (`held_out.rs`).

mod figures;
mod held_out;
mod page;
mod settings;
mod table;
mod way;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::camera::{Camera, SizeError};
use crate::locate::{Located, locate_luma};
use crate::scene::{Scene, Viewpoint};
use crate::statistics::{FEWEST_CLUSTERS, Interval, intervals_95, upper_median};
use crate::tags::{ArucoRefiner, CornersBy, SeenTag, StartError, TagDetector, TagDetectorChoice};
use crate::workers;

pub(crate) use figures::{FigureAdvice, advise_figures};
pub(crate) use held_out::Sample;
use held_out::{Answer, answer, find};
pub(crate) use page::page;
pub(crate) use settings::settings;
pub(crate) use table::table;
pub(crate) use way::Question;
use way::Way;

/// One way of a step, and what it does on the session.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Choice {
    pub question: Question,
    pub name: String,
    /// Coefficients of the lens model that it keeps; of camera models.
    pub lens_terms: Option<usize>,
    pub is_usual: bool,
    /// Of a photo, measured here on one core.
    pub ms: f64,
    /// Photos that get a pose.
    pub located: usize,
    /// Photos that the usual way locates and this one does not.
    pub lost: usize,
    /// Photos in which a left-out tag could be predicted.
    pub held_out_photos: usize,
    /// Mean held-out error over the photos that both this way and the most accurate one predict.
    pub held_out_deg: Option<f64>,
    /// This way's held-out error minus that of the most accurate one, on the same photos.
    pub worse_by_deg: Option<f64>,
    pub worse_by_95: Option<Interval>,
    /// How far the viewpoints are from the usual ones, middle photo: direction and distance.
    pub moved_deg: Option<f64>,
    pub moved_mm: Option<f64>,
    /// Photos that are in another bin than by the usual way.
    pub other_bin: usize,
    pub verdict: Verdict,
    /// Of each photo, where it was located.
    #[serde(skip)]
    pub viewpoints: Vec<Option<Viewpoint>>,
}

/// What speaks against a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// The smallest of those that nothing speaks against.
    Advised,
    /// Nothing does, but a smaller one is enough.
    Enough,
    /// It loses photos.
    LosesPhotos,
    /// It moves photos into other bins.
    OtherBins,
    /// Its held-out error is larger than that of the most accurate, at the level of 5 %.
    Worse,
    /// That is not shown, and it is larger by more than a twentieth.
    Larger,
    /// Too few photos can tell.
    CannotTell,
}

/// Everything that is advised about a session.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Advice {
    /// Name of its folder.
    pub session: String,
    pub poses: PoseAdvice,
    /// Absent where no detector looked.
    pub figures: Option<FigureAdvice>,
}

/// What a session says about the ways to locate its photos.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct PoseAdvice {
    pub photos: usize,
    /// Photos that the usual way locates, and in which it can predict a left-out tag.
    pub located: usize,
    pub held_out_photos: usize,
    pub choices: Vec<Choice>,
    /// Why some questions have no answer, and what photo or print would give one.
    pub abstentions: Vec<String>,
}

impl PoseAdvice {
    /// The answers to a question.
    pub(crate) fn of(&self, question: Question) -> impl Iterator<Item = &Choice> {
        self.choices.iter().filter(move |choice| choice.question == question)
    }

    /// The one that is advised; none where the session cannot tell.
    pub(crate) fn advised(&self, question: Question) -> Option<&Choice> {
        self.of(question).find(|choice| choice.verdict == Verdict::Advised)
    }
}

/// A held-out error may be larger than the smallest by this share of it.
const MARGIN: f64 = 0.05;

/// Photos of which all ways must be able to predict a tag before any is judged.
const FEWEST_PHOTOS: usize = FEWEST_CLUSTERS;

/// Finders of tags whose corners are then fitted alike: the libraries' own corners are never better.
const FINDERS: [TagDetectorChoice; 5] = [
    TagDetectorChoice::Cascade,
    TagDetectorChoice::CoarseToFine,
    TagDetectorChoice::AprilTagC(CornersBy::Fit),
    TagDetectorChoice::Aruco(ArucoRefiner::None, CornersBy::Fit),
    TagDetectorChoice::Locus(CornersBy::Fit),
];

/// Why nothing can be advised.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum AdviseError {
    #[error("the session has no photo")]
    NoPhoto,
    #[error("no photo of the session is located, so that there is nothing to compare")]
    NothingLocated,
    #[error(transparent)]
    Start(#[from] StartError),
    #[error("{file}: {fault}")]
    Size { file: String, fault: SizeError },
}

/// Measures every way of every step on the photos of a session. `on_photo` is called after each photo.
///
/// # Errors
/// No photos, none that is located; a camera of another shape; a tag detector that does not start.
pub(crate) fn advise_poses(
    samples: &[Sample],
    scene: &Scene,
    camera: &Camera,
    on_photo: impl Fn() + Sync,
) -> Result<PoseAdvice, AdviseError> {
    if samples.is_empty() {
        return Err(AdviseError::NoPhoto);
    }
    let families = scene.families();
    let reads = |choice: &TagDetectorChoice| families.iter().all(|family| choice.reads(*family));
    let detectors: Vec<TagDetectorChoice> = FINDERS.into_iter().filter(reads).collect();
    let ways: Vec<Way> = Question::ALL
        .into_iter()
        .flat_map(|question| Way::answers(question, &detectors, camera))
        .collect();
    let answers: Vec<Vec<Answer>> = workers::map(
        samples,
        || {
            detectors
                .iter()
                .map(|choice| Ok((*choice, choice.open(&families)?)))
                .collect::<Result<BTreeMap<_, _>, AdviseError>>()
        },
        |opened, sample| {
            camera
                .for_photo(sample.luma.width(), sample.luma.height(), sample.turned_deg)
                .map_err(|fault| AdviseError::Size {
                    file: sample.file.clone(),
                    fault,
                })?;
            let mut seen = BTreeMap::new();
            let mut all = Vec::new();
            let usual = TagDetectorChoice::default();
            let reference: Vec<SeenTag> = match opened.get_mut(&usual) {
                Some(tags) => reference(sample, scene, camera, tags.as_mut()),
                None => Vec::new(),
            };
            for way in &ways {
                let key = (way.detector, way.reduced_by);
                if !seen.contains_key(&key)
                    && let Some(tags) = opened.get_mut(&way.detector)
                {
                    seen.insert(key, find(sample, key, (scene, camera), tags.as_mut()));
                }
                if let Some(seen) = seen.get(&key) {
                    all.push(answer(way, sample, seen, &reference, (scene, camera)));
                }
            }
            Ok(all)
        },
        &on_photo,
    )?;
    put_together(samples.len(), &ways, &answers)
}

/// The tags that the usual pose rests on: these are left out one by one.
fn reference(sample: &Sample, scene: &Scene, camera: &Camera, tags: &mut dyn TagDetector) -> Vec<SeenTag> {
    let found = locate_luma(&sample.luma, sample.turned_deg, scene, camera, tags);
    let used = found.result.map(|located| located.tags).unwrap_or_default();
    let is_used = |tag: &SeenTag| tag.is_whole && used.contains(&tag.id) && scene.tag(tag.family, tag.id).is_some();
    found.seen.into_iter().filter(is_used).collect()
}

fn put_together(photos: usize, ways: &[Way], answers: &[Vec<Answer>]) -> Result<PoseAdvice, AdviseError> {
    let of = |way: usize| -> Vec<&Answer> { answers.iter().map(|photo| &photo[way]).collect() };
    let usual = ways.iter().position(Way::is_usual).map(of).unwrap_or_default();
    let located = usual.iter().filter(|answer| answer.located.is_some()).count();
    if located == 0 {
        return Err(AdviseError::NothingLocated);
    }
    let held_out_photos = usual.iter().filter(|answer| answer.held_out_deg.is_some()).count();
    let (mut choices, mut abstentions) = (Vec::new(), Vec::new());
    for question in Question::ALL {
        let own: Vec<(usize, &Way)> = ways
            .iter()
            .enumerate()
            .filter(|(_, way)| way.question == question)
            .collect();
        let own: Vec<(&Way, Vec<&Answer>)> = own.into_iter().map(|(i, way)| (way, of(i))).collect();
        let (of_question, abstention) = judged(&own, &usual, held_out_photos);
        choices.extend(of_question);
        abstentions.extend(abstention.map(|why| format!("{}: {why}", question.title())));
    }
    Ok(PoseAdvice {
        photos,
        located,
        held_out_photos,
        choices,
        abstentions,
    })
}

/// The answers to one question, the smallest that nothing speaks against marked; or why there is none.
fn judged(own: &[(&Way, Vec<&Answer>)], usual: &[&Answer], held_out_photos: usize) -> (Vec<Choice>, Option<String>) {
    let can_tell = held_out_photos >= FEWEST_PHOTOS;
    let lost = |answers: &[&Answer]| {
        let both = answers.iter().zip(usual);
        both.filter(|(own, usual)| own.located.is_none() && usual.located.is_some())
            .count()
    };
    let mean = |answers: &[&Answer]| {
        let errors: Vec<f64> = answers.iter().filter_map(|answer| answer.held_out_deg).collect();
        (errors.len() >= held_out_photos && can_tell).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    };
    let whole = own.iter().filter(|(_, answers)| lost(answers) == 0);
    let best = whole
        .filter_map(|(way, answers)| Some((mean(answers)?, way, answers)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(usual, |(_, _, answers)| answers.as_slice());
    let mut choices: Vec<(f64, Choice)> = own
        .iter()
        .map(|(way, answers)| {
            let choice = choice(way, answers, (usual, best), lost(answers), can_tell);
            (way.cost(choice.ms), choice)
        })
        .collect();
    let smallest = choices
        .iter()
        .enumerate()
        .filter(|(_, (_, choice))| choice.verdict == Verdict::Enough)
        .min_by(|a, b| a.1.0.total_cmp(&b.1.0))
        .map(|(i, _)| i);
    if let Some(smallest) = smallest {
        choices[smallest].1.verdict = Verdict::Advised;
    }
    let remedy = match usual.len() < FEWEST_PHOTOS {
        true => "take more photos",
        false => "print more tags, or take photos that show three of them",
    };
    let abstention = (!can_tell).then(|| {
        format!(
            "a tag could be left out and predicted in {held_out_photos} photos, and at least {FEWEST_PHOTOS} are needed: {remedy}"
        )
    });
    (choices.into_iter().map(|(_, choice)| choice).collect(), abstention)
}

fn choice(
    way: &Way,
    answers: &[&Answer],
    (usual, best): (&[&Answer], &[&Answer]),
    lost: usize,
    can_tell: bool,
) -> Choice {
    let mut paired: Vec<(f64, f64)> = Vec::new();
    for (own, best) in answers.iter().zip(best) {
        paired.extend(own.held_out_deg.zip(best.held_out_deg));
    }
    let count = paired.len() as f64;
    let means = |times: &[u32]| {
        let total: f64 = times.iter().map(|t| f64::from(*t)).sum();
        let sum = |of: fn(&(f64, f64)) -> f64| {
            paired
                .iter()
                .zip(times)
                .map(|(p, t)| f64::from(*t) * of(p))
                .sum::<f64>()
        };
        (sum(|p| p.0) / total, sum(|p| p.1) / total)
    };
    let (own, of_best) = means(&vec![1; paired.len()]);
    let [worse_by_95] = intervals_95(paired.len(), |times| {
        let (own, best) = means(times);
        [own - best]
    });
    let both = || {
        answers
            .iter()
            .zip(usual)
            .filter_map(|(own, usual)| own.located.as_ref().zip(usual.located.as_ref()))
    };
    let moved: Vec<f64> = both().map(|(own, usual)| direction_deg(own, usual)).collect();
    let moved_mm: Vec<f64> = both()
        .map(|(own, usual)| (own.viewpoint.distance_mm - usual.viewpoint.distance_mm).abs())
        .collect();
    let other_bin = both().filter(|(own, usual)| own.bin != usual.bin).count();
    // Without an interval every resampling says the same.
    let is_shown = worse_by_95.map_or(own > of_best, |interval| interval.low > 0.0) && paired.len() >= FEWEST_PHOTOS;
    let verdict = match () {
        () if lost > 0 => Verdict::LosesPhotos,
        () if other_bin > 0 => Verdict::OtherBins,
        () if !can_tell || paired.len() < FEWEST_PHOTOS => Verdict::CannotTell,
        () if is_shown && own > of_best => Verdict::Worse,
        () if own > (1.0 + MARGIN) * of_best => Verdict::Larger,
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
        held_out_deg: (count > 0.0).then_some(own),
        worse_by_deg: (count > 0.0).then_some(own - of_best),
        worse_by_95,
        moved_deg: upper_median(&moved),
        moved_mm: upper_median(&moved_mm),
        other_bin,
        verdict,
        viewpoints: answers
            .iter()
            .map(|answer| answer.located.as_ref().map(|located| located.viewpoint))
            .collect(),
    }
}

/// Between the directions in which two viewpoints lie.
fn direction_deg(a: &Located, b: &Located) -> f64 {
    let direction = |located: &Located| {
        let (azimuth, pitch) = (
            located.viewpoint.azimuth_deg.to_radians(),
            located.viewpoint.pitch_deg.to_radians(),
        );
        nalgebra::Vector3::new(azimuth.cos() * pitch.cos(), azimuth.sin() * pitch.cos(), pitch.sin())
    };
    direction(a).angle(&direction(b)).to_degrees()
}
