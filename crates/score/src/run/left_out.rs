//! Photos that were left out of a run: their reasons, and the one cause that most of them share.

use std::path::{Path, PathBuf};

use crate::error::ScoreError;
use crate::figures::{NotScored, ScoredPhoto, Scores};
use crate::observe::{Cache, Key};
use scaleproof_core::files;
use scaleproof_pose::locate::{LocateFiles, MOST_LISTED, is_poor_fit};
use scaleproof_session::{PhotoEntry, Session};

/// Scene, camera and photos that a session's location needs; kept while the session itself is scored.
pub struct SessionFiles {
    files: LocateFiles,
    photos: Vec<PathBuf>,
}

impl SessionFiles {
    /// Returns `None` for a session whose photos carry their truth, so that they are not located, and for one of a few photos or without a camera.
    pub fn new(session: &Session) -> Option<SessionFiles> {
        let has_truth = |p: &PhotoEntry| p.box_xyxy_px.is_some() && p.viewpoint.is_some();
        let located = session.photos.iter().filter(|photo| !has_truth(photo));
        let photos: Vec<PathBuf> = located.map(|photo| session.photo_path(photo)).collect();
        let name = |path: &Path| path.file_name().map_or_else(|| path.to_owned(), PathBuf::from);
        let files = LocateFiles {
            scene: session.scene.clone(),
            scene_file: name(&session.scene_path),
            camera: session.camera.clone()?,
            camera_file: name(session.camera_path.as_deref()?),
        };
        (photos.len() > MOST_LISTED).then_some(SessionFiles { files, photos })
    }

    /// Returns the cause, found by searching photos for tags of every family. The search takes seconds: its result is cached like those on photos.
    fn cause(&self, cache: Option<&Cache>) -> Option<String> {
        let sought = || self.files.cause_in_files(&self.photos);
        let Some((cache, key)) = cache.and_then(|cache| Some((cache, self.key(cache)?))) else {
            return sought();
        };
        cache.get(&key).unwrap_or_else(|| {
            let cause = sought();
            cache.put(&key, &cause);
            cause
        })
    }

    /// Returns the key of all that the cause depends on; `None` where a photo cannot be read any more.
    fn key(&self, cache: &Cache) -> Option<Key> {
        let LocateFiles {
            scene,
            scene_file,
            camera,
            camera_file,
        } = &self.files;
        let located = format!("{scene:?} {scene_file:?} {camera:?} {camera_file:?}");
        let content = |path: &PathBuf| Some(format!("{path:?} {}", files::sha256_of_file(path).ok()?));
        let photos: Vec<String> = self.photos.iter().map(content).collect::<Option<_>>()?;
        Some(cache.key(&["cause", &located, &photos.join(" ")]))
    }
}

/// Adds the cause that the left-out photos of a run share: to its error when nothing was scored, else to the cautions, so that it stands beside the
/// figures too.
pub fn explained(
    scores: Result<Scores, ScoreError>,
    sets: &[SessionFiles],
    cache: Option<&Cache>,
) -> Result<Scores, ScoreError> {
    match scores {
        Ok(scores) => {
            let sessions = scores.sessions.iter().enumerate();
            let alike = sessions.filter(|(index, session)| is_alike(&scores, session) || fit_poorly(&scores, *index));
            let cause =
                |(_, s): (usize, &Session)| Some(format!("{}: {}", s.name, SessionFiles::new(s)?.cause(cache)?));
            let causes = alike.filter_map(cause).collect();
            Ok(scores.with_causes(causes))
        }
        Err(ScoreError::NothingScored { photos, file, reason }) => {
            let causes = sets.iter().filter_map(|set| set.cause(cache));
            let reason = std::iter::once(reason).chain(causes).collect::<Vec<_>>().join("; ");
            Err(ScoreError::NothingScored { photos, file, reason })
        }
        Err(e) => Err(e),
    }
}

/// Returns true if the tags of half of a session's located photos fit the scene badly.
fn fit_poorly(scores: &Scores, session: usize) -> bool {
    let Some(camera) = scores.sessions.get(session).and_then(|s| s.camera.as_ref()) else {
        return false;
    };
    let placed = scores
        .photos
        .iter()
        .filter(|photo| photo.session == session && photo.rms_px.is_some());
    let is_poor = |photo: &&ScoredPhoto| {
        let scale = f64::from(camera.width.max(camera.height)) / f64::from(photo.width.max(photo.height));
        photo.rms_px.is_some_and(|rms_px| is_poor_fit(scale * rms_px, camera))
    };
    let poor = placed.clone().filter(is_poor).count();
    poor >= MOST_LISTED && 2 * poor >= placed.count()
}

/// Returns lines on the photos that were left out, but for near-copies: one by one, or only their number for a session whose cause is among the
/// cautions.
pub fn not_scored(scores: &Scores) -> Vec<String> {
    let grouped: Vec<&Session> = scores.sessions.iter().filter(|s| is_explained(scores, s)).collect();
    let groups = grouped.iter().map(|session| {
        let first = left_out(scores, session).next().map_or("", |photo| &*photo.reason);
        let (count, all) = (left_out(scores, session).count(), session.photos.len());
        format!("{count} of {all} photos of {}; the first: {first}", session.name)
    });
    let is_grouped = |photo: &&NotScored| grouped.iter().any(|session| session.name == photo.session);
    let others = scores
        .not_scored
        .iter()
        .filter(|photo| photo.near_copy_of.is_none() && !is_grouped(photo));
    let others = others.map(|photo| format!("{}/{}: {}", photo.session, photo.file, photo.reason));
    groups.chain(others).collect()
}

/// Returns true if a session's cause was found.
fn is_explained(scores: &Scores, session: &Session) -> bool {
    let name = format!("{}: ", session.name);
    is_alike(scores, session) && scores.causes.iter().any(|cause| cause.starts_with(&name))
}

/// Returns true if most photos of a session were left out. Sessions of one name cannot be told apart here: theirs are listed.
fn is_alike(scores: &Scores, session: &Session) -> bool {
    let same_name = scores.sessions.iter().filter(|s| s.name == session.name);
    let left_out = left_out(scores, session).count();
    let copies = scores
        .not_scored
        .iter()
        .filter(|p| p.near_copy_of.is_some() && p.session == session.name);
    let scored = session.photos.len().saturating_sub(left_out + copies.count());
    same_name.count() == 1 && left_out > MOST_LISTED && left_out >= 4 * scored
}

fn left_out<'a>(scores: &'a Scores, session: &Session) -> impl Iterator<Item = &'a NotScored> {
    let name = session.name.clone();
    let not_scored = scores.not_scored.iter().filter(|photo| photo.near_copy_of.is_none());
    not_scored.filter(move |photo| photo.session == name)
}
