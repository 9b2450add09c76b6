//! The viewpoints of photos of another texture at the same place, which frames are to be pairs of.

use std::collections::BTreeSet;

use scaleproof_capture::pair::{NORMAL, viewpoint};
use scaleproof_core::workers;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::tags::{StartError, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, Session};

/// Photos of one texture with their viewpoints.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// The texture; empty where there is nothing to pair with.
    pub variant: String,
    /// Names in the session.
    pub files: Vec<String>,
    /// In the order of the names.
    pub viewpoints: Vec<Viewpoint>,
    /// Photos without a viewpoint, as sentences.
    pub faults: Vec<String>,
}

impl Wanted {
    /// Those of a session's `normal` photos at a place, or of the only other texture there; none for the texture itself, and where several others
    /// leave it open.
    ///
    /// # Errors
    /// The tag detector does not start.
    pub fn of(
        session: &Session,
        variant: &str,
        place: &str,
        detector: TagDetectorChoice,
    ) -> Result<Wanted, StartError> {
        let is_other = |photo: &&PhotoEntry| photo.variant != variant && photo.place.as_deref() == Some(place);
        let others: Vec<&PhotoEntry> = session.photos.iter().filter(is_other).collect();
        let variants: BTreeSet<&str> = others.iter().map(|photo| photo.variant.as_str()).collect();
        let only = variants.first().filter(|_| variants.len() == 1);
        let Some(paired) = variants.get(NORMAL).or(only) else {
            return Ok(Wanted::default());
        };
        let photos: Vec<&PhotoEntry> = others.into_iter().filter(|photo| photo.variant == *paired).collect();
        let found = workers::map(
            &photos,
            || detector.open(&session.scene.families()),
            |tags, photo| Ok::<_, StartError>(viewpoint(session, photo, tags)),
            || {},
        )?;
        let mut wanted = Wanted {
            variant: (*paired).to_owned(),
            ..Wanted::default()
        };
        for (photo, found) in photos.iter().zip(found) {
            match found {
                Ok(viewpoint) => {
                    wanted.files.push(photo.file.clone());
                    wanted.viewpoints.push(viewpoint);
                }
                Err(reason) => wanted.faults.push(format!("{}: {reason}", photo.file)),
            }
        }
        Ok(wanted)
    }
}
