//! Target viewpoints: those of another texture's photos at the same place, of which frames are to be pairs.

use std::collections::BTreeSet;

use scaleproof_capture::pair::{NORMAL, viewpoint};
use scaleproof_core::workers;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::tags::{StartError, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, Session};

/// Photos of one texture with their viewpoints, as targets.
#[derive(Debug, Clone, Default)]
pub struct TargetViews {
    /// The texture; empty where there is nothing to pair with.
    pub variant: String,
    /// Names in the session.
    pub files: Vec<String>,
    /// In the order of the names.
    pub viewpoints: Vec<Viewpoint>,
    /// Photos without a viewpoint, as sentences.
    pub faults: Vec<String>,
}

impl TargetViews {
    /// Returns the viewpoints of a session's `normal` photos at a place, or of the only other texture there; none for the texture itself, and if there
    /// are several others.
    ///
    /// # Errors
    /// The tag detector does not start.
    pub fn of(
        session: &Session,
        variant: &str,
        place: &str,
        detector: TagDetectorChoice,
    ) -> Result<TargetViews, StartError> {
        let is_other = |photo: &&PhotoEntry| photo.variant != variant && photo.place.as_deref() == Some(place);
        let others: Vec<&PhotoEntry> = session.photos.iter().filter(is_other).collect();
        let variants: BTreeSet<&str> = others.iter().map(|photo| photo.variant.as_str()).collect();
        let only = variants.first().filter(|_| variants.len() == 1);
        let Some(paired) = variants.get(NORMAL).or(only) else {
            return Ok(TargetViews::default());
        };
        let photos: Vec<&PhotoEntry> = others.into_iter().filter(|photo| photo.variant == *paired).collect();
        let found = workers::map(
            &photos,
            || detector.open(&session.scene.families()),
            |tags, photo| Ok::<_, StartError>(viewpoint(session, photo, tags)),
            || {},
        )?;
        let mut targets = TargetViews {
            variant: (*paired).to_owned(),
            ..TargetViews::default()
        };
        for (photo, found) in photos.iter().zip(found) {
            match found {
                Ok(viewpoint) => {
                    targets.files.push(photo.file.clone());
                    targets.viewpoints.push(viewpoint);
                }
                Err(reason) => targets.faults.push(format!("{}: {reason}", photo.file)),
            }
        }
        Ok(targets)
    }
}
