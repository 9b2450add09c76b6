//! Settings of a file by which photos are located and AP is computed; `advise` writes such files.

use std::path::Path;

use serde::{Deserialize, Serialize};

use scaleproof_core::ap::ApDefinition;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::spelling;
use scaleproof_pose::scene::Envelope;
use scaleproof_pose::tags::{StartError, TagDetectorChoice};
use scaleproof_session::Session;
use scaleproof_session::envelope::EnvelopeShape;

/// Choices of a session; what is absent is as usual.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Name of a tag detector.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tag_detector: Option<String>,
    /// Coefficients of the camera's lens model that are kept, from the first: k1, k2, p1, p2, k3 ….
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens_terms: Option<usize>,
    /// Name of a definition of AP.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ap: Option<String>,
    /// `box`: truth boxes are those of the model's size, whichever outline the scene names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub envelope: Option<String>,
}

/// Settings that a run was made with.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct AppliedSettings {
    /// Name of the settings file.
    pub file: String,
    /// SHA-256 of the settings file.
    pub sha256: String,
    #[serde(flatten)]
    pub settings: Settings,
}

impl AppliedSettings {
    /// Returns cautions on the settings: none where poses and truth boxes are by the files of the session.
    pub(crate) fn cautions(&self) -> Vec<String> {
        let camera = self.settings.lens_terms.map(|terms| {
            let kept = match terms {
                0 => "without its lens model".to_owned(),
                terms => format!("with {} of its lens model", spelling::count(terms, "term")),
            };
            format!("poses and truth boxes are by the camera {kept}, as {} says", self.file)
        });
        let by_size = |_| format!("truth boxes are by the model's size, as {} says", self.file);
        let envelope = self.settings.envelope.as_ref().map(by_size);
        camera.into_iter().chain(envelope).collect()
    }
}

/// Size of the largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;

impl Settings {
    /// Reads a file, and checks that its names are known.
    pub fn open(path: &Path) -> Result<AppliedSettings, FileError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        let sha256 = files::sha256_hex(&bytes);
        let refused = |reason: String| FileError::content(path, reason);
        let text = String::from_utf8(bytes).map_err(|_| refused("it is not UTF-8 text".into()))?;
        let settings: Settings = toml::from_str(&text).map_err(|e| refused(e.message().to_owned()))?;
        settings.tags().map_err(|fault| refused(fault.to_string()))?;
        settings.ap().map_err(refused)?;
        if let Some(terms) = settings.lens_terms.filter(|terms| *terms > 8) {
            return Err(refused(format!("`lens_terms` is {terms}: a lens model has 0 to 8")));
        }
        let envelope = settings.envelope.as_deref();
        if let Some(other) = envelope.filter(|name| *name != Envelope::Box.name()) {
            return Err(refused(format!(
                "`envelope` is {other:?}: leave it out to take the scene's, or write \"box\""
            )));
        }
        let file = files::name_of(path);
        Ok(AppliedSettings { file, sha256, settings })
    }

    pub fn tags(&self) -> Result<TagDetectorChoice, StartError> {
        self.tag_detector
            .as_deref()
            .map_or_else(|| Ok(TagDetectorChoice::default()), str::parse)
    }

    pub fn ap(&self) -> Result<Option<ApDefinition>, String> {
        let named = self.ap.as_deref().map(ApDefinition::from_name).transpose();
        named.map_err(|e| e.to_string())
    }

    /// Returns the session with the camera model and the truth boxes that are named.
    pub fn applied(&self, mut session: Session) -> Session {
        if let Some(terms) = self.lens_terms {
            session.camera = session.camera.map(|camera| {
                let kept = camera.distortion().iter().take(terms).copied().collect::<Vec<_>>();
                camera.with_distortion(&kept)
            });
        }
        if self.envelope.is_some() {
            session.scene.model.envelope = Envelope::Box;
            session.outline = EnvelopeShape::of_box(&session.scene.model);
        }
        session
    }
}
