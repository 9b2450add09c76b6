//! Weight files: the folders that may hold them, and their hashes.

use std::path::{Path, PathBuf};

use super::Manifest;
use super::onnx::external_files;
use scaleproof_core::files;
use scaleproof_core::message::{Message, message};

/// Why a detector's weights cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    #[error(transparent)]
    Missing(Message),
    #[error("{message}")]
    WrongHash {
        /// The path, and which files beside it hold its tensors.
        files: String,
        message: Message,
    },
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// The folders weights are looked up in, in order.
#[derive(Debug, Clone)]
pub struct WeightFolders {
    /// The folder that a user named, which downloads go into.
    pub named: Option<PathBuf>,
    /// All of them, the named one included.
    pub folders: Vec<PathBuf>,
}

impl WeightFolders {
    /// The named folder, `$SCALEPROOF_DETECTORS`, `$SCALEPROOF_SHARED/detectors`, then the user's cache.
    pub fn new(named: Option<PathBuf>) -> WeightFolders {
        let from_env = |name: &str| files::environment::variable(name).map(PathBuf::from);
        let folders = [
            named.clone(),
            from_env("SCALEPROOF_DETECTORS"),
            from_env("SCALEPROOF_SHARED").map(|shared| shared.join("detectors")),
            user_cache(),
        ];
        WeightFolders {
            named,
            folders: folders.into_iter().flatten().collect(),
        }
    }

    /// The folder that `fetch` downloads into: the named one, else the user's cache.
    pub fn download_folder(&self) -> Result<PathBuf, WeightsError> {
        let folder = self.named.clone().or_else(user_cache);
        folder.ok_or_else(|| {
            let fault = message!("no folder for downloads: set HOME or XDG_CACHE_HOME");
            fault.hint("name a folder by ‹detectors›").into()
        })
    }

    /// Returns where a detector's weights lie, if anywhere; not yet checked.
    pub fn find(&self, manifest: &Manifest) -> Option<PathBuf> {
        let beside = manifest.folder.iter();
        beside
            .chain(&self.folders)
            .map(|folder| folder.join(&manifest.weights.file))
            .find(|path| path.is_file())
    }

    /// The detector's weights, present and with the right hash.
    pub fn checked(&self, manifest: &Manifest) -> Result<PathBuf, WeightsError> {
        let (name, file) = (&manifest.name, &manifest.weights.file);
        let fetch = format!("`scaleproof detectors fetch {name}`");
        let has_url = !manifest.weights.url.is_empty();
        let remedy = |by_hand: String, with: &str| if has_url { format!("{with} {fetch}") } else { by_hand };
        let Some(path) = self.find(manifest) else {
            let remedy = remedy(format!("put {file} beside its manifest"), "get them with");
            let fault = message!("no weights for {name}: {remedy}");
            let hint = format!("a folder that has {file} is named by ‹detectors›");
            return Err(WeightsError::Missing(fault.hint(hint)));
        };
        let Some(found) = other_hash(manifest, &path)? else {
            return Ok(path);
        };
        let bytes = files::read(&path)?;
        let names: Vec<&str> = external_files(&bytes).into_iter().collect();
        let files = if names.is_empty() {
            path.display().to_string()
        } else {
            format!("{} with {} beside it", path.display(), names.join(", "))
        };
        let by_hand = "put the right file there, or describe this one with `scaleproof detectors add`";
        let remedy = remedy(by_hand.to_owned(), "remove it and run");
        let message = message!(
            "{files} is not the file {name} was described with (SHA-256 {found:.12}…, expected {:.12}…): {remedy}",
            manifest.weights.sha256
        );
        Err(WeightsError::WrongHash { files, message })
    }
}

/// The SHA-256 of a file that is not the one that a manifest describes.
pub(super) fn other_hash(manifest: &Manifest, path: &Path) -> Result<Option<String>, files::FileError> {
    let found = network_sha256(path, files::read(path)?)?;
    Ok((found != manifest.weights.sha256).then_some(found))
}

/// The SHA-256 of a network: of its file's bytes and then of those of the files beside it that hold its tensors, in the order of their names.
/// `cat network.onnx network.onnx.data | sha256sum` prints it, too.
pub(super) fn network_sha256(path: &Path, mut bytes: Vec<u8>) -> Result<String, files::FileError> {
    let own_names = |name: &str| files::folder_of(path).join(name);
    let beside: Vec<PathBuf> = external_files(&bytes).into_iter().map(own_names).collect();
    for file in beside {
        bytes.extend(files::read(&file)?);
    }
    Ok(files::sha256_hex(&bytes))
}

fn user_cache() -> Option<PathBuf> {
    Some(dirs::cache_dir()?.join("scaleproof").join("detectors"))
}
