//! Photos that fail alike: the cause, said once, instead of a line for each.

use std::path::{Path, PathBuf};

use scaleproof_photo::photo::Photo;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Diagnosis, LocatedPhoto, diagnosis, locate_photo, spread};
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_pose::tags::{SeenTag, TagDetector, TagDetectorChoice};
use scaleproof_score::score::{NotScored, ScoreError, Scores};
use scaleproof_session::session::Session;

/// Fewer are listed one by one: that is read as fast.
pub(super) const MOST_LISTED: usize = 3;

/// So many photos, spread evenly, are looked at again to find the cause, where nobody kept what was seen in them.
const LOOKED_AT: usize = 12;

/// So many photos are searched for tags of all families.
const SEARCHED_FOR_ALL: usize = 4;

/// What photos were located with, and the files it comes from.
pub(super) struct LocateFiles {
    pub scene: Scene,
    pub scene_file: PathBuf,
    pub camera: Camera,
    pub camera_file: PathBuf,
}

impl LocateFiles {
    /// The one cause for photos that were examined, as a sentence, if there is one.
    pub(super) fn cause(&self, photos: &[(&Path, &LocatedPhoto)]) -> Option<String> {
        let examined: Vec<&LocatedPhoto> = photos.iter().map(|(_, examined)| *examined).collect();
        let others = if diagnosis::is_without_tags(&examined) {
            self.with_every_family(&photos.iter().map(|(path, _)| *path).collect::<Vec<_>>())
        } else {
            Vec::new()
        };
        let found = diagnosis::diagnose(&examined, &others, &self.scene)?;
        Some(self.sentence(&found))
    }

    fn sentence(&self, found: &Diagnosis) -> String {
        found.sentence(&self.scene, &self.scene_file, &self.camera, &self.camera_file)
    }

    /// The one cause for photos that were not kept after they were examined, as a sentence, if there is one: some of them are located again.
    pub(super) fn cause_in_files(&self, photos: &[PathBuf]) -> Option<String> {
        let paths: Vec<&Path> = photos.iter().map(PathBuf::as_path).collect();
        let mut tags = TagDetectorChoice::default().open(&self.scene.families()).ok()?;
        let mut examine = |path: &Path| {
            let photo = Photo::open(path).ok()?;
            locate_photo(&photo, &self.scene, &self.camera, &mut tags).ok()
        };
        let paths = spread(&paths, LOOKED_AT);
        let examined: Vec<(&Path, LocatedPhoto)> =
            paths.iter().filter_map(|path| Some((*path, examine(path)?))).collect();
        let examined: Vec<(&Path, &LocatedPhoto)> = examined.iter().map(|(path, examined)| (*path, examined)).collect();
        self.cause(&examined)
    }

    /// What some photos show of the families that the scene does not have.
    fn with_every_family(&self, photos: &[&Path]) -> Vec<Vec<SeenTag>> {
        let own = self.scene.families();
        let others = TagFamily::ALL
            .into_iter()
            .map(|(family, _)| family)
            .filter(|f| !own.contains(f));
        let others: Vec<TagFamily> = others.collect();
        let Ok(mut tags) = TagDetectorChoice::default().open(&others) else {
            return Vec::new();
        };
        let luma = |path: &&Path| Photo::open(path).ok()?.luma().ok();
        let some = spread(photos, SEARCHED_FOR_ALL);
        some.iter().filter_map(luma).map(|luma| tags.find(&luma)).collect()
    }
}

/// What a session's photos are located with, and some of them; kept while the session itself is scored.
pub(super) struct SessionFiles {
    files: LocateFiles,
    photos: Vec<PathBuf>,
}

impl SessionFiles {
    /// `None` for a session whose photos carry their truth: they are not located.
    pub(super) fn of(session: &Session) -> Option<SessionFiles> {
        let needs_tags = session
            .photos
            .iter()
            .filter(|p| p.box_xyxy_px.is_none() || p.viewpoint.is_none());
        let photos: Vec<PathBuf> = needs_tags.map(|p| session.photo_path(p)).collect();
        Some(SessionFiles {
            files: LocateFiles {
                scene: session.scene.clone(),
                scene_file: name_of(&session.scene_path),
                camera: session.camera.clone()?,
                camera_file: name_of(session.camera_path.as_deref()?),
            },
            photos,
        })
        .filter(|set| set.photos.len() > MOST_LISTED)
    }

    fn cause(&self) -> Option<String> {
        self.files.cause_in_files(&self.photos)
    }
}

fn name_of(path: &Path) -> PathBuf {
    path.file_name().map_or_else(|| path.to_owned(), PathBuf::from)
}

/// What a run gives, with the cause that photos share which were left out: in its error when nothing was scored, else among the cautions, so that
/// it stands beside the figures too.
pub(super) fn explained(scores: Result<Scores, ScoreError>, sets: &[SessionFiles]) -> Result<Scores, ScoreError> {
    match scores {
        Ok(scores) => {
            let causes = scores.sessions.iter().filter_map(|s| cause_in(&scores, s)).collect();
            Ok(scores.with_causes(causes))
        }
        Err(ScoreError::NothingScored { photos, file, reason }) => {
            let causes = sets.iter().filter_map(SessionFiles::cause);
            let reason = std::iter::once(reason).chain(causes).collect::<Vec<_>>().join("; ");
            Err(ScoreError::NothingScored { photos, file, reason })
        }
        Err(e) => Err(e),
    }
}

/// Why most photos of a session were left out, if there is one cause; it begins with the session's name.
fn cause_in(scores: &Scores, session: &Session) -> Option<String> {
    let cause = is_alike(scores, session)
        .then(|| SessionFiles::of(session)?.cause())
        .flatten()?;
    Some(format!("{}: {cause}", session.name))
}

/// Whether a session's cause was found.
fn is_explained(scores: &Scores, session: &Session) -> bool {
    let name = format!("{}: ", session.name);
    is_alike(scores, session) && scores.causes.iter().any(|cause| cause.starts_with(&name))
}

/// Whether most photos of a session were left out. Sessions of one name cannot be told apart here: theirs are listed.
fn is_alike(scores: &Scores, session: &Session) -> bool {
    let same_name = scores.sessions.iter().filter(|s| s.name == session.name);
    let left_out = left_out(scores, session).count();
    let scored = session.photos.len().saturating_sub(left_out);
    same_name.count() == 1 && left_out > MOST_LISTED && left_out >= 4 * scored
}

fn left_out<'a>(scores: &'a Scores, session: &Session) -> impl Iterator<Item = &'a NotScored> {
    let name = session.name.clone();
    scores.not_scored.iter().filter(move |photo| photo.session == name)
}

/// Says on standard error which photos were left out: one by one, or only how many of a session where the cautions have the cause.
pub(super) fn say_not_scored(scores: &Scores) {
    let is_grouped = |name: &str| {
        scores
            .sessions
            .iter()
            .any(|s| s.name == name && is_explained(scores, s))
    };
    for session in scores.sessions.iter().filter(|s| is_explained(scores, s)) {
        let (count, all, name) = (left_out(scores, session).count(), session.photos.len(), &session.name);
        let first = left_out(scores, session)
            .next()
            .map_or("", |photo| photo.reason.as_str());
        say!("not scored: {count} of {all} photos of {name}; the first: {first}");
    }
    for photo in scores.not_scored.iter().filter(|photo| !is_grouped(&photo.session)) {
        say!("not scored: {}/{}: {}", photo.session, photo.file, photo.reason);
    }
}
