//! Deviations of a comparison from its plan.

use std::collections::BTreeSet;
use std::path::Path;

use crate::figures::{Comparison, Criteria, Protocol, ScoredPhoto, Scores};
use crate::plan::sealed::SealError;
use crate::plan::{SealedDetector, SealedPlan, Stopping, planned_views};
use scaleproof_core::files;

impl SealedPlan {
    pub fn deviations(&self, scores: &Scores, comparison: &Comparison) -> Result<Vec<String>, SealError> {
        let mut all = self.of_criteria(&scores.criteria, &comparison.base);
        all.extend(self.of_scenes(scores)?);
        all.extend(self.of_detectors(scores)?);
        all.extend(self.of_textures(scores));
        all.extend(planned_views::deviations(self, scores, comparison));
        all.extend(self.of_order(scores));
        all.extend(self.of_stopping(comparison));
        Ok(all)
    }

    fn of_criteria(&self, criteria: &Criteria, base: &str) -> Vec<String> {
        let said = |protocol: Option<&str>| protocol.unwrap_or("none").to_owned();
        let protocol = criteria.protocol.map(Protocol::name);
        let [hit, overlap] = [criteria.hit_confidence, criteria.match_iou()].map(|v| v.to_string());
        let both = [
            ("base", self.base.clone(), base.to_owned()),
            ("definition of AP", self.ap.clone(), criteria.ap.name().to_owned()),
            ("confidence of a hit", self.hit_confidence.to_string(), hit),
            ("IoU of a hit", self.match_iou.to_string(), overlap),
            ("protocol", said(self.protocol.as_deref()), said(protocol)),
        ];
        let differing = both.into_iter().filter(|(_, planned, here)| planned != here);
        differing
            .map(|(what, planned, here)| format!("{what}: {planned} in the plan, {here} here"))
            .collect()
    }

    fn of_scenes(&self, scores: &Scores) -> Result<Vec<String>, SealError> {
        let mut all = Vec::new();
        for session in &scores.sessions {
            let hash = |path: &Path| Ok::<_, SealError>(files::sha256_hex(&files::read(path)?));
            let camera = session.camera_path.as_deref().map(hash).transpose()?;
            let changed = [
                ("scene", hash(&session.scene_path)? != self.scene_sha256),
                (
                    "mesh",
                    session.mesh_path.as_deref().map(hash).transpose()? != self.mesh_sha256,
                ),
                ("camera", self.camera_sha256.is_some() && camera != self.camera_sha256),
            ];
            let changed = changed.into_iter().filter(|(_, is_changed)| *is_changed);
            all.extend(changed.map(|(what, _)| format!("the {what} of {} is not the one in the plan", session.name)));
            let here = &session.scene.model.class;
            if *here != self.classes {
                let [planned, here] = [&self.classes, here].map(|classes| classes.labels().join(", "));
                all.push(format!(
                    "what counts as the model in {}: {planned} in the plan, {here} here",
                    session.name
                ));
            }
        }
        Ok(all)
    }

    fn of_detectors(&self, scores: &Scores) -> Result<Vec<String>, SealError> {
        let mut all = Vec::new();
        let mut here = BTreeSet::new();
        for detector in &scores.detectors {
            let name = &detector.manifest.name;
            here.insert(name);
            let Some(planned) = self.detectors.get(name) else {
                all.push(format!("the detector {name} is not in the plan"));
                continue;
            };
            if detector.foreign().is_some() {
                all.push(format!(
                    "the detector {name} is another program's here, and a network in the plan"
                ));
                continue;
            }
            let own = SealedDetector::of(&detector.manifest)?;
            if own.weights_sha256 != planned.weights_sha256 {
                all.push(format!("the weights of {name} are not those of the plan"));
            } else if own != *planned {
                all.push(format!("the manifest of {name} is not that of the plan"));
            }
        }
        let missing = self.detectors.keys().filter(|name| !here.contains(name));
        all.extend(missing.map(|name| format!("the detector {name} of the plan is missing")));
        Ok(all)
    }

    fn of_textures(&self, scores: &Scores) -> Vec<String> {
        let mut all = Vec::new();
        let here: BTreeSet<&String> = scores.photos.iter().map(|photo| &photo.variant).collect();
        let others = here.iter().filter(|texture| !self.textures.contains_key(**texture));
        all.extend(others.map(|texture| format!("the texture {texture} is not in the plan")));
        for (texture, planned) in &self.textures {
            let shown = scores.patterns.iter().find(|pattern| pattern.variant == *texture);
            match (planned, shown) {
                (Some(planned), Some(shown)) if shown.sha256 != *planned => {
                    all.push(format!("the pattern of {texture} is not the one in the plan"));
                }
                (Some(_), None) if here.contains(texture) => {
                    all.push(format!(
                        "the pattern of {texture} was not shown, so that nobody knows whether it is the one in the plan"
                    ));
                }
                _ => {}
            }
        }
        all
    }

    /// Returns a deviation where photos are not listed in the order of their times: nobody may choose the order afterwards.
    fn of_order(&self, scores: &Scores) -> Option<String> {
        let is_later = |pair: &[ScoredPhoto]| {
            let (a, b) = (pair[0].taken.as_ref(), pair[1].taken.as_ref());
            let same_session = pair[0].session == pair[1].session;
            // Times of one form only: EXIF and RFC 3339 differ in theirs.
            same_session && a.zip(b).is_some_and(|(a, b)| a.len() == b.len() && a > b)
        };
        let first = scores.photos.windows(2).find(|pair| is_later(pair))?;
        (self.stopping != Stopping::EveryView).then(|| {
            format!(
                "photos are not listed in the order of their times: {} before {}",
                first[0].file, first[1].file
            )
        })
    }

    fn of_stopping(&self, comparison: &Comparison) -> Option<String> {
        let here = comparison.sequential.as_ref().map(|sequential| Stopping::Decided {
            look_after_each: sequential.look_after_each,
            least: sequential.least,
        });
        let here = here.unwrap_or(Stopping::EveryView);
        (here != self.stopping).then(|| {
            let [planned, here] = [self.stopping, here].map(Stopping::in_words);
            format!("stopping: {planned} in the plan, {here} here")
        })
    }
}
