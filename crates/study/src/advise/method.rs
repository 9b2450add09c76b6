//! A way from a photo to its pose, one step of which differs from the usual one.

use serde::Serialize;

use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Solver;
use scaleproof_pose::tags::TagDetectorChoice;

/// Step whose ways are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    TagDetector,
    Solver,
    CameraModel,
    /// Number of tags of a photo that are used.
    Tags,
    /// Resolution of the photo in which tags are searched.
    Resolution,
}

impl Question {
    pub const ALL: [Question; 5] = [
        Question::TagDetector,
        Question::Solver,
        Question::CameraModel,
        Question::Tags,
        Question::Resolution,
    ];

    pub fn title(self) -> &'static str {
        [
            "tag detector",
            "pose solver",
            "camera model",
            "tags a photo",
            "photo resolution",
        ][self as usize]
    }
}

/// A way from a photo to its pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Method {
    pub question: Question,
    pub detector: TagDetectorChoice,
    pub solver: Solver,
    /// Coefficients of the lens model that are kept, from the first.
    pub lens_terms: usize,
    /// Number of the largest tags that are used; `None` for all.
    pub most_tags: Option<usize>,
    /// Number of pixels of the photo along a side that become one.
    pub reduced_by: u32,
}

/// Returns the way in which the program locates photos.
pub(super) fn usual(question: Question) -> Method {
    Method {
        question,
        detector: TagDetectorChoice::default(),
        solver: Solver::default(),
        lens_terms: ALL_TERMS,
        most_tags: None,
        reduced_by: 1,
    }
}

/// Number of OpenCV's coefficients k1, k2, p1, p2, k3 … k6; a fisheye has fewer.
const ALL_TERMS: usize = 8;

/// Largest number of tags that is tried; more in one photo are all of them.
const MOST_TAGS: usize = 6;

impl Method {
    /// Returns the ways that answer a question, the usual one among them. `detectors` read the scene's tags.
    pub(super) fn answers(question: Question, detectors: &[TagDetectorChoice], camera: &Camera) -> Vec<Method> {
        let usual = usual(question);
        match question {
            Question::TagDetector => detectors.iter().map(|&detector| Method { detector, ..usual }).collect(),
            Question::Solver => Solver::all().map(|solver| Method { solver, ..usual }).to_vec(),
            Question::CameraModel => {
                let last = camera.distortion().iter().rposition(|k| *k != 0.0);
                let needed = last.map_or(0, |last| last + 1);
                let kept = [0, 1, 2, 4].into_iter().filter(|kept| *kept < needed);
                let smaller = kept.map(|lens_terms| Method { lens_terms, ..usual });
                smaller.chain([usual]).collect()
            }
            Question::Tags => {
                let some = (1..=MOST_TAGS).map(Some).chain([None]);
                some.map(|most_tags| Method { most_tags, ..usual }).collect()
            }
            Question::Resolution => [8, 4, 2, 1].map(|reduced_by| Method { reduced_by, ..usual }).to_vec(),
        }
    }

    pub(super) fn is_usual(&self) -> bool {
        *self == usual(self.question)
    }

    /// Returns true if both do the same, whichever question they answer.
    pub(super) fn is_same(&self, other: &Method) -> bool {
        let question = self.question;
        *self == Method { question, ..*other }
    }

    /// Returns the name in tables and settings.
    pub(super) fn name(&self) -> String {
        match self.question {
            Question::TagDetector => self.detector.name().to_owned(),
            Question::Solver => self.solver.name().to_owned(),
            Question::CameraModel => match self.lens_terms {
                0 => "no distortion",
                1 => "k1",
                2 => "k1, k2",
                4 => "k1, k2, p1, p2",
                _ => "as calibrated",
            }
            .to_owned(),
            Question::Tags => self.most_tags.map_or("all".to_owned(), |most| most.to_string()),
            Question::Resolution if self.reduced_by == 1 => "full".to_owned(),
            Question::Resolution => format!("1/{}", self.reduced_by),
        }
    }

    /// Returns the camera with the terms that are kept.
    pub(super) fn camera(&self, camera: &Camera) -> Camera {
        let all = camera.distortion();
        camera.clone().with_distortion(&all[..self.lens_terms.min(all.len())])
    }

    /// Returns the cost, by which ways are ordered: milliseconds where time is what differs, else their own size. Solvers take little beside the
    /// search for tags, so that the usual one stays where it is enough.
    pub(super) fn cost(&self, ms: f64) -> f64 {
        match self.question {
            Question::Solver if self.is_usual() => 0.0,
            Question::TagDetector | Question::Solver => ms,
            Question::CameraModel => self.lens_terms as f64,
            Question::Tags => self.most_tags.unwrap_or(usize::MAX) as f64,
            Question::Resolution => 1.0 / f64::from(self.reduced_by),
        }
    }
}
