//! Viewpoints of another session's photos, as targets: pairs then differ in the texture alone.

use std::collections::BTreeSet;
use std::path::Path;

use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::workers;
use scaleproof_photo::Photo;
use scaleproof_pose::locate::locate_photo;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::tags::{StartError, TagDetector, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, Session, SessionError};

/// The variant that is paired with where a session has several.
pub const NORMAL: &str = "normal";

/// Reason why a session gives no targets.
#[derive(Debug, thiserror::Error)]
pub enum PairError {
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Returns the viewpoints of a session's `normal` photos, or of the only variant it has; and the faults of photos that have none.
///
/// # Errors
/// A session that cannot be opened, that leaves the variant open, or of which no photo has a viewpoint.
pub fn viewpoints(session: &Path, tags: TagDetectorChoice) -> Result<(Vec<Viewpoint>, Vec<String>), PairError> {
    let session = Session::open(session)?;
    let variants: BTreeSet<&str> = session.photos.iter().map(|photo| photo.variant.as_str()).collect();
    let only = variants.first().filter(|_| variants.len() == 1);
    let variant = *only.or(variants.get(NORMAL)).ok_or_else(|| {
        let (name, variants) = (&session.name, Vec::from_iter(variants.iter().copied()).join(", "));
        message!(
            "the session {name} has the variants {variants} and none is `normal`: pair with a session of one variant"
        )
    })?;
    let photos: Vec<&PhotoEntry> = session.photos.iter().filter(|photo| photo.variant == variant).collect();
    let found = workers::map(
        &photos,
        || tags.open(&session.scene.families()),
        |tags, photo| Ok::<_, StartError>(viewpoint(&session, photo, tags)),
        || {},
    )?;
    let (mut viewpoints, mut faults) = (Vec::new(), Vec::new());
    for (photo, found) in photos.iter().zip(found) {
        match found {
            Ok(viewpoint) => viewpoints.push(viewpoint),
            Err(reason) => faults.push(format!("{}: {reason}", photo.file)),
        }
    }
    match faults.first() {
        Some(reason) if viewpoints.is_empty() => {
            let name = session.name;
            bail!("no photo of the session {name} has a viewpoint ({reason}): pair with another")
        }
        _ => Ok((viewpoints, faults)),
    }
}

/// Returns the viewpoint of a session's photo: the one it names, or by its tags.
///
/// # Errors
/// Reason why it has none, as a sentence.
pub fn viewpoint(session: &Session, photo: &PhotoEntry, tags: &mut dyn TagDetector) -> Result<Viewpoint, String> {
    if let Some(known) = photo.viewpoint {
        return Ok(known);
    }
    let camera = session.known_camera().map_err(|e| e.to_string())?;
    let photo = Photo::open(&session.photo_path(photo)).map_err(|e| e.to_string())?;
    let located = locate_photo(&photo, &session.scene, camera, tags).map_err(|e| e.to_string())?;
    Ok(located.result.map_err(|e| e.to_string())?.viewpoint)
}
