//! Question that a plan answers, and the number of directions of a place.

use std::path::Path;

use super::super::score::{Effort, score_with_progress};
use super::super::{Result, at_hand, criteria, detectors, sessions};
use super::Args;
use crate::cli::results::Results;
use scaleproof_pose::scene::{NoSuchBin, Scene, Viewpoint};
use scaleproof_score::{Observed, PlanError, Question, Spread};

/// Defaults of a plan: the drop, the number of detectors and that of directions of a place.
const DROP: f64 = 0.2;
const DETECTORS: usize = 5;
const DIRECTIONS: usize = 8;

/// Detectors and textures at most.
const MOST: usize = 100;

/// Detectors and textures that are decided together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Comparisons {
    detectors: usize,
    textures: usize,
}

/// `5x2`, or `5` for one texture.
pub(super) fn comparisons(text: &str) -> Result<Comparisons, String> {
    let (detectors, textures) = text.split_once(['x', '×']).unwrap_or((text, "1"));
    let number = |text: &str| text.parse().ok().filter(|number| (1..=MOST).contains(number));
    match (number(detectors), number(textures)) {
        (Some(detectors), Some(textures)) => Ok(Comparisons { detectors, textures }),
        _ => Err(format!(
            "give the number of detectors and that of textures besides the base, as in 5x2, each up to {MOST}"
        )),
    }
}

/// The question with what it rests on.
pub(super) struct Asked {
    pub question: Question,
    /// Views of one place.
    pub directions: usize,
    /// Views behind the spread; 0 where it is that of the stored photos.
    pub views_seen: usize,
}

impl Args {
    pub(super) fn asked(&self) -> Result<Asked> {
        let (observed, scene) = match &self.session {
            Some(session) => {
                let (observed, scene) = self.observed(session)?;
                (Some(observed), Some(scene))
            }
            None => (None, None),
        };
        let scene = self.scene.as_deref().map(Scene::open).transpose()?.or(scene);
        let directions = match &scene {
            Some(scene) => self.views(scene)?.len(),
            None => DIRECTIONS,
        };
        let usual = Comparisons {
            detectors: observed.map_or(DETECTORS, |o| o.detectors),
            textures: observed.map_or(1, |o| o.textures.max(1)),
        };
        Ok(Asked {
            question: self.question(self.comparisons.unwrap_or(usual), observed)?,
            directions: directions.max(1),
            views_seen: observed.map_or(0, |o| o.views),
        })
    }

    /// The question for so many detectors and textures whose names are known.
    pub(super) fn asked_of(&self, detectors: usize, textures: usize) -> Result<Question> {
        let observed = self.session.as_deref().map(|session| self.observed(session));
        let observed = observed.transpose()?.map(|(observed, _)| observed);
        self.question(Comparisons { detectors, textures }, observed)
    }

    fn question(&self, comparisons: Comparisons, observed: Option<Observed>) -> Result<Question> {
        let drop = self.drop.unwrap_or(DROP);
        let most = observed.map_or(1.0, |observed| observed.most_drop);
        if drop > most {
            return Err(PlanError::Drop { drop, most }.into());
        }
        Ok(Question {
            drop,
            power: self.power,
            detectors: comparisons.detectors,
            textures: comparisons.textures,
            spread: observed.map_or(Spread::STORED, |observed| observed.spread),
        })
    }

    /// Returns the properties of a session's stored detections that a plan needs, and the session's scene.
    fn observed(&self, session: &Path) -> Result<(Observed, Scene)> {
        let sessions = vec![sessions::session(session)?];
        let base = criteria::base_of(None, &sessions).to_owned();
        let (weights, outside) = (detectors::Folder { weights_folder: None }, Results::default());
        let detectors = at_hand::evaluated(&sessions, &self.sealing.detectors, true, &weights, &outside)?;
        let options = Effort::default().options(&detectors)?;
        let scores = score_with_progress(sessions, detectors, &options)?.against(&base);
        let observed = Observed::of(&scores)?;
        let scene = scores.sessions.into_iter().next().map(|session| session.scene);
        Ok((observed, scene.ok_or("the session is gone")?))
    }

    /// The views of one place.
    pub(super) fn views(&self, scene: &Scene) -> Result<Vec<Viewpoint>, NoSuchBin> {
        scene.bins.photographed(&self.pitch_deg, &self.distance_mm)
    }
}
