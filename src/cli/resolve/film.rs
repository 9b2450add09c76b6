//! `session from-video`: its files are those that are named, else the session's.

use super::names::check_names;
use crate::cli::Result;
use crate::cli::args::film::FilmArgs;
use crate::cli::sessions::{self, FolderFiles};
use scaleproof_core::files;
use scaleproof_film::session::FilmRequest;

impl FilmArgs {
    /// Resolves the arguments, with the session that is gone on with.
    pub fn request(&self) -> Result<FilmRequest> {
        check_names(&self.variant, &self.place)?;
        if self.to.is_some_and(|to| to <= self.from) {
            return Err("--to must be later than --from".into());
        }
        let mut files = FolderFiles::new(self.scene.clone(), self.camera.clone(), self.place.clone());
        let list = self.output.join("session.json");
        let session = list.exists().then(|| {
            files::inputs::own(&list);
            sessions::session(&self.output)
        });
        let session = session.transpose()?;
        if let Some(session) = &session {
            files.or_those_of(session)?;
        }
        Ok(FilmRequest {
            video: self.video.clone(),
            scene: files.scene()?.to_owned(),
            camera: files.camera()?.to_owned(),
            variant: self.variant.clone(),
            place: self.place.clone(),
            folder: self.output.clone(),
            session,
            per_bin: self.per_bin.into(),
            apart_s: self.apart,
            from_s: self.from,
            to_s: self.to,
            every: self.every,
            png: self.png,
        })
    }
}
