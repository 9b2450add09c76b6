//! Photos that a command is about: those of stored sessions, or of folders with one texture each.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{Result, photos};
use scaleproof_core::files;
use scaleproof_core::spelling::quoted;
use scaleproof_session::folders::{self, Gathered, Listing, PhotoFolder};
use scaleproof_session::{Session, SessionError};

/// Name of the place of photos where none is given.
const PLACE: &str = "here";

/// Sessions, or folders of photos.
#[derive(clap::Args)]
pub(super) struct Photos {
    /// Session folders (each with a session.json), or folders of photos with the texture each shows, as in normal=monday
    /// checker=tuesday, or with its place, as in normal@lab=monday normal@yard=sunday; with --scene and --camera.
    #[arg(value_name = "SESSION|VARIANT[@PLACE]=DIR")]
    given: Vec<PathBuf>,
    #[command(flatten)]
    about: FolderFiles,
}

/// What a session says of its photos, and folders of photos do not.
#[derive(clap::Args)]
pub(super) struct FolderFiles {
    /// With VARIANT=DIR: what stood on the table, scene.toml.
    #[arg(long, value_name = "TOML")]
    scene: Option<PathBuf>,
    /// With VARIANT=DIR: the camera file of the photos.
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// With VARIANT=DIR: where the photos were taken of which VARIANT@PLACE=DIR does not say it. Photos are compared with those of the same place and viewpoint bin.
    #[arg(long, value_name = "NAME", default_value = PLACE)]
    pub(super) place: String,
}

pub(super) struct OpenedPhotos {
    pub sessions: Vec<Session>,
    /// Whole paths of the folders, when the photos came from folders.
    folders: Vec<PathBuf>,
}

impl Photos {
    /// Opens all of them, and notes what is passed over.
    pub(super) fn open(&self) -> Result<OpenedPhotos> {
        let pairs = self.given.iter().map(|given| pair(given)).collect::<Result<Vec<_>>>()?;
        let count = pairs.iter().flatten().count();
        if pairs.is_empty() {
            return Err(
                "no photos are named: name session folders, or VARIANT=FOLDER for each texture with --scene and --camera"
                    .into(),
            );
        }
        if count == 0 {
            let sessions = self.given.iter().map(|place| session(place)).collect::<Result<_>>()?;
            self.about.refuse_for_sessions()?;
            let folders = Vec::new();
            return Ok(OpenedPhotos { sessions, folders });
        }
        if let Some((place, _)) = self.given.iter().zip(&pairs).find(|(_, pair)| pair.is_none()) {
            return Err(format!(
                "{} is no VARIANT=FOLDER as the others are: name sessions only, or make one of the folders with `scaleproof session new`",
                place.display()
            )
            .into());
        }
        let gathered = self.about.gather(&pairs.into_iter().flatten().collect::<Vec<_>>())?;
        Ok(OpenedPhotos {
            folders: gathered.folders.into_iter().map(|found| found.real).collect(),
            sessions: vec![gathered.session],
        })
    }
}

impl FolderFiles {
    /// Of photos that are no folder's yet.
    #[cfg_attr(not(feature = "full"), expect(dead_code))]
    pub(super) fn new(scene: Option<PathBuf>, camera: Option<PathBuf>, place: String) -> FolderFiles {
        FolderFiles { scene, camera, place }
    }

    /// Makes a session of folders in memory, and notes the images that are passed over.
    pub(super) fn gather(&self, folders: &[PhotoFolder]) -> Result<Gathered> {
        let gathered = folders::gather(folders, self.scene()?, self.camera()?, &self.place)?;
        for found in &gathered.folders {
            photos::note_passed_over(&found.listing, &found.given.folder);
        }
        Ok(gathered)
    }

    /// The files of a session that photos are added to, where none are named.
    pub(super) fn or_those_of(&mut self, session: &Session) -> Result<()> {
        let both = [
            ("--scene", &mut self.scene, Some(&session.scene_path)),
            ("--camera", &mut self.camera, session.camera_path.as_ref()),
        ];
        for (option, named, own) in both {
            let Some(own) = own else { continue };
            let named = named.get_or_insert_with(|| own.clone());
            if named != own && files::read(named)? != files::read(own)? {
                let (named, session) = (named.display(), session.folder.display());
                return Err(format!(
                    "{session} has another {} than {named}: leave {option} out, or name a new folder for the session",
                    option.trim_start_matches('-')
                )
                .into());
            }
        }
        Ok(())
    }

    pub(super) fn scene(&self) -> Result<&Path> {
        let missing =
            "photos in folders need --scene scene.toml: the model, its tags and the bins (see `scaleproof scene`)";
        Ok(self.scene.as_deref().ok_or(missing)?)
    }

    pub(super) fn camera(&self) -> Result<&Path> {
        let missing = "photos in folders need --camera camera.yaml: make it with `scaleproof calibrate`, or `scaleproof camera guess PHOTO`";
        Ok(self.camera.as_deref().ok_or(missing)?)
    }

    fn refuse_for_sessions(&self) -> Result<(), String> {
        let given = [
            ("--scene", self.scene.is_some()),
            ("--camera", self.camera.is_some()),
            ("--place", self.place != PLACE),
        ];
        given
            .iter()
            .filter(|(_, is_given)| *is_given)
            .try_for_each(|(option, _)| {
                Err(format!(
                    "{option} is for VARIANT=FOLDER only: a session says this itself, in its session.json"
                ))
            })
    }
}

impl OpenedPhotos {
    /// Refuses what only stored sessions can do: `option` needs files in them.
    pub(super) fn refuse_for_folders(&self, option: &str, is_given: bool) -> Result<(), String> {
        if !is_given || self.folders.is_empty() {
            return Ok(());
        }
        let once = if option == "--recorded" {
            " (once with --record)"
        } else {
            ""
        };
        Err(format!(
            "{option} needs a session, and folders of photos get no files: make one with `scaleproof session new NAME` and the same \
             folders, --scene and --camera, and name that instead{once}"
        ))
    }

    /// Nothing is written among the user's photos.
    pub(super) fn check_output(&self, output: &Path) -> Result<(), String> {
        let is_among = output.canonicalize().is_ok_and(|real| {
            let is_it = |folder: &PathBuf| folder.canonicalize().is_ok_and(|folder| folder == real);
            match &self.folders[..] {
                [] => self
                    .sessions
                    .iter()
                    .any(|session| folders_of(session).iter().any(is_it)),
                folders => folders.contains(&real),
            }
        });
        if is_among {
            Err(among_photos("report", output))
        } else {
            Ok(())
        }
    }
}

/// Why something is not written into this folder.
pub(super) fn among_photos(what: &str, folder: &Path) -> String {
    format!(
        "the {what} would be written among the photos in {}: name another folder with -o",
        folder.display()
    )
}

/// A session's own folder, and those that its photos lie in.
fn folders_of(session: &Session) -> BTreeSet<PathBuf> {
    let photos = session.photos.iter().map(|photo| session.photo_path(photo));
    let theirs = photos.filter_map(|path| path.parent().map(Path::to_owned));
    theirs.chain([session.folder.clone()]).collect()
}

/// `VARIANT=DIR` or `VARIANT@PLACE=DIR`; none for what names a session, which may have an equal sign in its name.
pub(super) fn pair(given: &Path) -> Result<Option<PhotoFolder>> {
    if given.is_file() || given.join("session.json").exists() {
        return Ok(None);
    }
    let Some(text) = given.to_str() else {
        return Ok(None);
    };
    match text.split_once('=') {
        None => Ok(None),
        Some(("", _)) => Err(format!("{text} names no texture: write VARIANT=FOLDER, as in normal=monday").into()),
        Some((_, "")) => Err(format!("{text} names no folder: write VARIANT=FOLDER, as in {text}monday").into()),
        // A folder that is there, and what stands behind its equal sign is not.
        Some((_, folder)) if given.is_dir() && !Path::new(folder).exists() => Ok(None),
        Some((name, folder)) => {
            let (variant, place) = name
                .rsplit_once('@')
                .map_or((name, None), |(variant, place)| (variant, Some(place)));
            if variant.is_empty() || place.is_some_and(str::is_empty) {
                let how = "write VARIANT@PLACE=FOLDER, as in normal@lab=monday";
                return Err(format!("{text} lacks its texture or its place: {how}").into());
            }
            Ok(Some(PhotoFolder {
                variant: variant.to_owned(),
                place: place.map(str::to_owned),
                folder: in_home(folder),
            }))
        }
    }
}

/// `~/photos` as it is meant: shells leave it as it is behind an equal sign.
fn in_home(folder: &str) -> PathBuf {
    let below = folder.strip_prefix("~/").filter(|_| !Path::new(folder).exists());
    let whole = below.and_then(|below| Some(dirs::home_dir()?.join(below)));
    whole.unwrap_or_else(|| folder.into())
}

/// Opens sessions; none where none is named.
pub(super) fn opened(places: &[PathBuf]) -> Result<Option<Vec<Session>>> {
    let all: Vec<Session> = places.iter().map(|place| session(place)).collect::<Result<_>>()?;
    Ok(Some(all).filter(|all| !all.is_empty()))
}

/// Opens a session.
pub(super) fn session(place: &Path) -> Result<Session> {
    if place.is_dir() && !place.join("session.json").exists() {
        return Err(no_session(place)?.into());
    }
    if place.is_file() && Listing::is_photo(place) {
        let (photo, pair) = (place.display(), pair_of("normal", files::folder_of(place)));
        let meant = format!("name its folder and the texture it shows, as in {pair}, with --scene and --camera");
        return Err(format!("{photo} is a photo: {meant}").into());
    }
    Session::open(place).map_err(|e: SessionError| e.into())
}

/// Returns the sentence on a folder that is no session, with what to give instead.
fn no_session(folder: &Path) -> Result<String> {
    let (name, listing) = (folder.display(), Listing::of(folder)?);
    let photos = |inner: &String| Listing::of(&folder.join(inner)).is_ok_and(|found| !found.photos.is_empty());
    let textures: Vec<&String> = listing.folders.iter().filter(|inner| photos(inner)).collect();
    let stored = |inner: &&String| folder.join(inner).join("session.json").exists();
    if let Some(inner) = listing.folders.iter().find(stored) {
        return Ok(format!(
            "{name} has no session.json, but {} has one: name that",
            folder.join(inner).display()
        ));
    }
    let (what, pairs) = match (listing.photos.len(), textures.as_slice()) {
        (0, []) => {
            return Ok(format!(
                "{name} has no session.json and no photos: name session folders, or VARIANT=FOLDER for each texture with --scene and --camera"
            ));
        }
        (0, textures) => {
            let pairs = textures.iter().take(3).map(|inner| pair_of(inner, &folder.join(inner)));
            let more = if textures.len() > 3 { " …" } else { "" };
            let pairs = pairs.collect::<Vec<_>>().join(" ") + more;
            ("for the photos in its folders".to_owned(), pairs)
        }
        (1, _) => ("for its photo".to_owned(), pair_of("normal", folder)),
        (count, _) => (
            format!("for its {count} photos of one texture"),
            pair_of("normal", folder),
        ),
    };
    Ok(format!(
        "{name} has no session.json: {what} give {pairs} with --scene scene.toml and --camera camera.yaml; or make a session: `scaleproof \
         session new NAME {pairs} --scene scene.toml --camera camera.yaml`"
    ))
}

/// `VARIANT=FOLDER` as a shell takes it.
fn pair_of(variant: &str, folder: &Path) -> String {
    quoted(&format!("{variant}={}", folder.display()))
}
