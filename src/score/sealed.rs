//! A plan that was fixed before the photos, and in what a comparison differs from it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{ClusteredBy, Comparison, Course, Criteria, PlanCheck, Protocol, ScoredPhoto, Scores};
use crate::detect::{Manifest, ManifestError};
use crate::files::{self, FileError};
use crate::scene::{Bin, Classes};
use crate::spelling::count;

/// What an experiment fixes before its photos are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SealedPlan {
    /// Version that sealed it.
    pub scaleproof: String,
    /// The texture that drops are measured from.
    pub base: String,
    /// SHA-256 of each texture's pattern; none of a texture without one.
    pub textures: BTreeMap<String, Option<String>>,
    /// Labels that count as the model.
    pub classes: Classes,
    /// The definition of average precision.
    pub ap: String,
    pub hit_confidence: f64,
    pub match_iou: f64,
    pub protocol: Option<String>,
    /// By name.
    pub detectors: BTreeMap<String, SealedDetector>,
    /// Of the scene's file.
    pub scene_sha256: String,
    /// Of the mesh that it names, if any.
    pub mesh_sha256: Option<String>,
    /// Of the camera's file, where it is fixed.
    pub camera_sha256: Option<String>,
    /// Azimuth, pitch and distance of the bins that are photographed in every texture at every place.
    pub views: Vec<[f64; 3]>,
    pub places: u16,
    pub stopping: Stopping,
}

/// What a detector is known by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SealedDetector {
    pub weights_sha256: String,
    /// Of the manifest: how photos are fed, and how answers are read.
    pub manifest_sha256: String,
}

/// When the photos are enough.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Stopping {
    /// When every view is there; looked at once.
    EveryView,
    /// When it is decided.
    Decided {
        look_after_each: ClusteredBy,
        least: Option<f64>,
    },
}

/// The file: the plan, and the SHA-256 of the plan as it was.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SealedFile {
    seal: String,
    plan: SealedPlan,
}

/// Why a plan cannot be sealed or read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SealError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} is no sealed plan: {reason}")]
    Syntax { path: String, reason: String },
    #[error("{0} is there already, and a sealed plan is not changed: name another file")]
    Exists(String),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error("the plan cannot be written: {0}")]
    Unwritable(#[from] serde_json::Error),
}

/// The largest plan that is read.
const MOST_BYTES: u64 = 4 << 20;

/// Views that are named in one deviation.
const MOST_NAMED: usize = 4;

impl SealedDetector {
    pub(crate) fn of(manifest: &Manifest) -> Result<SealedDetector, ManifestError> {
        Ok(SealedDetector {
            weights_sha256: manifest.weights.sha256.clone(),
            manifest_sha256: files::sha256_hex(manifest.to_toml()?.as_bytes()),
        })
    }
}

impl SealedPlan {
    /// How many photos it asks for.
    pub(crate) fn photos(&self) -> usize {
        self.textures.len() * self.views.len() * usize::from(self.places)
    }

    fn seal(&self) -> Result<String, SealError> {
        Ok(files::sha256_hex(serde_json::to_string(self)?.as_bytes()))
    }

    /// Writes a new file, and returns its seal.
    ///
    /// # Errors
    /// The file is there.
    pub(crate) fn write(self, path: &Path) -> Result<String, SealError> {
        if path.exists() {
            return Err(SealError::Exists(path.display().to_string()));
        }
        let seal = self.seal()?;
        let file = SealedFile {
            seal: seal.clone(),
            plan: self,
        };
        let text = serde_json::to_string_pretty(&file)? + "\n";
        files::write_atomically(path, text.as_bytes())?;
        Ok(seal)
    }

    /// Reads a plan; the seal is that of its content, and a sentence says when the file states another.
    pub(crate) fn read(path: &Path) -> Result<(SealedPlan, PlanCheck), SealError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        let file: SealedFile = serde_json::from_slice(&bytes).map_err(|e| SealError::Syntax {
            path: path.display().to_string(),
            reason: format!("line {}, column {}, does not read as one", e.line(), e.column()),
        })?;
        if file.plan.views.iter().flatten().any(|number| number.abs() > 1e6) {
            return Err(SealError::Syntax {
                path: path.display().to_string(),
                reason: "a view of it lies beyond any bin".into(),
            });
        }
        let seal = file.plan.seal()?;
        let deviations = match file.seal == seal {
            true => Vec::new(),
            false => {
                vec!["the plan was changed after it was sealed: the seal in its file is not that of its content".into()]
            }
        };
        Ok((file.plan, PlanCheck { seal, deviations }))
    }

    /// In what a comparison differs from the plan, as sentences.
    pub(crate) fn deviations(&self, scores: &Scores, comparison: &Comparison) -> Result<Vec<String>, SealError> {
        let mut all = self.of_criteria(&scores.criteria, &comparison.base);
        all.extend(self.of_scenes(scores)?);
        all.extend(self.of_detectors(scores)?);
        all.extend(self.of_textures(scores));
        all.extend(self.of_views(scores, comparison));
        all.extend(self.of_order(scores));
        all.extend(self.of_stopping(comparison));
        Ok(all)
    }

    fn of_criteria(&self, criteria: &Criteria, base: &str) -> Vec<String> {
        let (hit, ap) = (criteria.hit_confidence, criteria.ap.name());
        let protocol = criteria.protocol.map(Protocol::name);
        let said = |protocol: Option<&str>| protocol.unwrap_or("none").to_owned();
        let differing = [
            (self.base != base, "base", self.base.clone(), base.to_owned()),
            (self.ap != ap, "definition of AP", self.ap.clone(), ap.to_owned()),
            (
                self.hit_confidence != hit,
                "confidence of a hit",
                self.hit_confidence.to_string(),
                hit.to_string(),
            ),
            (
                self.match_iou != criteria.match_iou(),
                "IoU of a hit",
                self.match_iou.to_string(),
                criteria.match_iou().to_string(),
            ),
            (
                self.protocol.as_deref() != protocol,
                "protocol",
                said(self.protocol.as_deref()),
                said(protocol),
            ),
        ];
        let differing = differing.into_iter().filter(|(differs, ..)| *differs);
        differing
            .map(|(_, what, planned, here)| format!("{what}: {planned} in the plan, {here} here"))
            .collect()
    }

    fn of_scenes(&self, scores: &Scores) -> Result<Vec<String>, SealError> {
        let mut all = Vec::new();
        for session in &scores.sessions {
            if files::sha256_hex(&files::read(&session.scene_path)?) != self.scene_sha256 {
                all.push(format!("the scene of {} is not the one in the plan", session.name));
            }
            let hash = |path: &Path| Ok::<_, SealError>(files::sha256_hex(&files::read(path)?));
            if session.mesh_path.as_deref().map(hash).transpose()? != self.mesh_sha256 {
                all.push(format!("the mesh of {} is not the one in the plan", session.name));
            }
            let camera = session.camera_path.as_deref().map(hash).transpose()?;
            if self.camera_sha256.is_some() && camera != self.camera_sha256 {
                all.push(format!("the camera of {} is not the one in the plan", session.name));
            }
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
        for texture in &here {
            if !self.textures.contains_key(*texture) {
                all.push(format!("the texture {texture} is not in the plan"));
            }
        }
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

    fn of_views(&self, scores: &Scores, comparison: &Comparison) -> Vec<String> {
        let mut photos: BTreeMap<(&str, &str, Bin), usize> = BTreeMap::new();
        let places: BTreeSet<&str> = scores
            .photos
            .iter()
            .map(|p| p.place.as_deref().unwrap_or_default())
            .collect();
        let planned: Vec<Bin> = self.views.iter().map(|view| bin(*view)).collect();
        let mut elsewhere = 0;
        for photo in &scores.photos {
            match photo.bin.filter(|bin| planned.contains(bin)) {
                Some(bin) => {
                    let place = photo.place.as_deref().unwrap_or_default();
                    *photos.entry((&photo.variant, place, bin)).or_default() += 1;
                }
                None => elsewhere += 1,
            }
        }
        let mut all = Vec::new();
        let planned_places = usize::from(self.places);
        let is_ended = self.textures.keys().any(|texture| ends_decided(comparison, texture));
        if places.len() > planned_places || places.len() < planned_places && !is_ended {
            let [planned, here] = [planned_places, places.len()].map(|n| count(n, "place"));
            all.push(format!("{planned} in the plan, {here} here"));
        }
        for texture in self.textures.keys() {
            let missing: Vec<(&str, Bin)> = places
                .iter()
                .flat_map(|place| planned.iter().map(move |bin| (*place, *bin)))
                .filter(|(place, bin)| !photos.contains_key(&(texture.as_str(), *place, *bin)))
                .collect();
            let begun = places_in_order(scores, texture);
            let is_excused = ends_decided(comparison, texture);
            let may_be_missing = |place: &str| is_excused && (begun.last() == Some(&place) || !begun.contains(&place));
            let missing: Vec<String> = missing
                .into_iter()
                .filter(|(place, _)| !may_be_missing(place))
                .map(|(place, bin)| named(place, bin))
                .collect();
            if !missing.is_empty() {
                let some = missing.iter().take(MOST_NAMED).cloned().collect::<Vec<_>>().join("; ");
                let more = if missing.len() > MOST_NAMED { "; …" } else { "" };
                all.push(format!(
                    "{} of the plan without a photo of {texture}: {some}{more}",
                    count(missing.len(), "view")
                ));
            }
        }
        let repeated = photos.values().filter(|photos| **photos > 1).count();
        if repeated > 0 {
            all.push(format!(
                "{} with more photos than the one that was planned",
                count(repeated, "view")
            ));
        }
        if elsewhere > 0 {
            all.push(format!(
                "{} of views that are not in the plan",
                count(elsewhere, "photo")
            ));
        }
        let given = scores.photos.iter().filter(|photo| photo.truth_given).count();
        if given > 0 {
            all.push(format!(
                "{} with a truth box that the session gives, not the pose",
                count(given, "photo")
            ));
        }
        let left_out = scores.not_scored.len();
        if left_out > 0 {
            all.push(format!("{} left out, with reasons", count(left_out, "photo")));
        }
        all
    }

    /// In whichever order photos are looked at, nobody may choose it afterwards.
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

impl Stopping {
    /// After what one looks, and the least drop that matters; none where one looks once.
    pub(crate) fn looks(self) -> Option<(ClusteredBy, Option<f64>)> {
        match self {
            Stopping::EveryView => None,
            Stopping::Decided { look_after_each, least } => Some((look_after_each, least)),
        }
    }

    fn in_words(self) -> String {
        match self {
            Stopping::EveryView => "when every view is there".into(),
            Stopping::Decided { look_after_each, least } => {
                let unit = match look_after_each {
                    ClusteredBy::Place => "place",
                    ClusteredBy::PlaceAndBin => "pair",
                };
                let least = least.map_or_else(String::new, |least| format!(" or a drop of {least} is excluded"));
                format!("when it is decided after a {unit}{least}")
            }
        }
    }
}

/// Whether the photos of a texture end with the pair that decided: then views of the last place may be missing.
fn ends_decided(comparison: &Comparison, texture: &str) -> bool {
    let Some(sequential) = &comparison.sequential else {
        return false;
    };
    let own: Vec<&Course> = sequential
        .results
        .iter()
        .filter(|course| course.variant == texture)
        .collect();
    let last = own
        .iter()
        .map(|course| course.hit_rate.decided_after)
        .collect::<Option<Vec<_>>>();
    last.is_some_and(|last| last.into_iter().max() == own.first().map(|course| course.looks))
}

/// Where photos of a texture were taken, in the order of their list.
fn places_in_order<'a>(scores: &'a Scores, texture: &str) -> Vec<&'a str> {
    let own = scores.photos.iter().filter(|photo| photo.variant == texture);
    own.map(|photo| photo.place.as_deref().unwrap_or_default())
        .fold(Vec::new(), |mut places, place| {
            if !places.contains(&place) {
                places.push(place);
            }
            places
        })
}

fn bin([azimuth_deg, pitch_deg, distance_mm]: [f64; 3]) -> Bin {
    Bin {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    }
}

fn named(place: &str, bin: Bin) -> String {
    let at = if place.is_empty() {
        String::new()
    } else {
        format!(" at {place}")
    };
    format!("{}°/{}°/{} mm{at}", bin.azimuth_deg, bin.pitch_deg, bin.distance_mm)
}
