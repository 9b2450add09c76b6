//! Downloads weights: with progress, resumed where it stopped, and kept only when the hash is right.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::Manifest;
use super::onnx::external_files;
use super::weights::other_hash;
use scaleproof_core::files;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::spelling;

/// Why a download did not end in a usable file.
#[derive(Debug, thiserror::Error)]
pub enum FetchError {
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    File(#[from] files::FileError),
    /// Another file than the described one is there already.
    #[error(transparent)]
    Taken(Message),
}

/// Nothing this program fetches is near this size; a longer answer is not the file.
const MAX_BYTES: u64 = 2 << 30;

/// A download breaks off when no byte comes for this long.
const PATIENCE: Duration = Duration::from_secs(30);

/// So does one that is slower than this on the whole, once it had time to begin: the file would take a day.
const LEAST_BYTES_PER_S: f64 = 100.0;
const SLOW_START_S: f64 = 60.0;

type Response = ureq::http::Response<ureq::Body>;

/// Downloads a detector's weights into a folder. `progress` receives the bytes so far and, if known, in all.
///
/// The bytes are collected in `FILE.part`, which a later call goes on with, and renamed when complete and verified. The right file that is
/// there already stays, and another one is never replaced. Files that hold the network's tensors are fetched from beside it.
pub fn fetch(manifest: &Manifest, folder: &Path, progress: &dyn Fn(u64, Option<u64>)) -> Result<PathBuf, FetchError> {
    fetch_within(manifest, folder, progress, PATIENCE)
}

/// Like [`fetch`], breaking off when no byte comes for other than its 30 s.
pub fn fetch_within(
    manifest: &Manifest,
    folder: &Path,
    progress: &dyn Fn(u64, Option<u64>),
    patience: Duration,
) -> Result<PathBuf, FetchError> {
    let download = Download {
        manifest,
        folder,
        progress,
        patience,
    };
    download.run()
}

struct Download<'a> {
    manifest: &'a Manifest,
    folder: &'a Path,
    progress: &'a dyn Fn(u64, Option<u64>),
    patience: Duration,
}

impl Download<'_> {
    fn run(&self) -> Result<PathBuf, FetchError> {
        let Download { manifest, folder, .. } = self;
        let (name, file, url) = (&manifest.name, &manifest.weights.file, &manifest.weights.url);
        if url.is_empty() {
            bail!("the manifest of {name} has no weights.url to fetch from: put {file} beside the manifest");
        }
        let [target, part] = self.places(file);
        // Its hash is looked at before it takes its name.
        files::inputs::own(&part);
        let is_there = std::fs::symlink_metadata(&target).is_ok();
        let network = if is_there { &target } else { &part };
        if !is_there {
            self.collect(url, &part)?;
        }
        let fetched = self.fetch_tensors(network)?;
        if other_hash(manifest, network)?.is_some() {
            let remove = |file: &Path| files::chosen::remove(folder, file);
            fetched.iter().try_for_each(|file| remove(file))?;
            if is_there {
                let path = target.display();
                return Err(FetchError::Taken(message!(
                    "{path} is already there and is not the file {name} was described with: move it away"
                )));
            }
            remove(&part)?;
            bail!("the file at {url} is not the one {name} was described with; it was not kept");
        }
        if !is_there {
            files::chosen::rename(folder, &part, &target)?;
        }
        Ok(target)
    }

    /// Returns where a file comes to lie, and where it is collected.
    fn places(&self, file: &str) -> [PathBuf; 2] {
        [self.folder.join(file), self.folder.join(format!("{file}.part"))]
    }

    /// Downloads the files with a network's tensors that are not there yet, and returns those.
    fn fetch_tensors(&self, network: &Path) -> Result<Vec<PathBuf>, FetchError> {
        let bytes = files::read(network)?;
        let mut fetched = Vec::new();
        for file in external_files(&bytes) {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
            if file.starts_with('.') || !file.chars().all(is_plain) {
                bail!(
                    "the network of {} keeps tensors in {}, which is no file beside it that could be fetched: put both into a folder by hand",
                    self.manifest.name,
                    spelling::quoted(file)
                );
            }
            let [target, part] = self.places(file);
            if std::fs::symlink_metadata(&target).is_err() {
                self.collect(&beside(&self.manifest.weights.url, file), &part)?;
                files::chosen::rename(self.folder, &part, &target)?;
                files::inputs::own(&target);
                fetched.push(target);
            }
        }
        Ok(fetched)
    }

    /// Collects what is at an address in a file, from where an earlier call broke off.
    fn collect(&self, url: &str, part: &Path) -> Result<(), FetchError> {
        let folder = self.folder;
        // Through a link, the download would be written to wherever it points.
        let no_part = |_| {
            message!(
                "{} is a link or a folder, or has a second name, and the download would be collected in it: remove it",
                part.display()
            )
        };
        let have = files::chosen::begun(folder, part).map_err(no_part)?;
        let Some(response) = self.request(url, have)? else {
            return Ok(());
        };
        let failed = |e: std::io::Error| files::FileError::write(part, &e);
        files::make_named_folder(folder)?;
        let resumed = response.status() == 206 && have > 0;
        let have = if resumed { have } else { 0 };
        let open = if resumed {
            files::chosen::appended
        } else {
            files::chosen::new_file
        };
        let mut to = open(folder, part)?;
        if !self.receive(response, &mut to, have)? {
            files::chosen::remove(folder, part)?;
            bail!(
                "the download of {} has more than 2 GB, so it is not the file that the manifest describes; it was not kept",
                self.manifest.name
            );
        }
        Ok(to.sync_all().map_err(failed)?)
    }

    /// Asks for the file from byte `have` on. `None`: there is nothing after it, the part is already whole.
    fn request(&self, url: &str, have: u64) -> Result<Option<Response>, Message> {
        let agent: ureq::Agent = ureq::Agent::config_builder()
            .timeout_connect(Some(Duration::from_secs(8)))
            .timeout_recv_response(Some(Duration::from_secs(30)))
            // Counts from the last byte on, unlike the time-out of the body, which a slow line and a large file would exceed.
            .timeout_per_read(Some(self.patience))
            .http_status_as_error(false)
            .build()
            .into();
        let mut request = agent.get(url);
        if have > 0 {
            request = request.header("Range", format!("bytes={have}-"));
        }
        let name = &self.manifest.name;
        let response = request.call().map_err(|e| {
            let (host, reason) = (url.split('/').nth(2).unwrap_or(url), e.to_string().replace('\n', " "));
            message!(
                "cannot reach {host} to fetch {name} ({reason}): go online, or copy {} into {}",
                self.manifest.weights.file,
                self.folder.display()
            )
        })?;
        match response.status().as_u16() {
            200 | 206 => Ok(Some(response)),
            416 if have > 0 => Ok(None),
            status => {
                bail!("{url} answered {status}: the file may have moved; see the manifest of {name} for its origin")
            }
        }
    }

    /// Appends what comes to a file; false where it is too large.
    fn receive(&self, response: Response, file: &mut File, mut have: u64) -> Result<bool, Message> {
        let total = response.body().content_length().map(|rest| have + rest);
        // A little more, so that the limit is found below.
        let limit = MAX_BYTES + (1 << 20);
        let mut body = response.into_body().into_with_config().limit(limit).reader();
        let mut buffer = vec![0; 1 << 16];
        let (begin, had, name) = (Instant::now(), have, &self.manifest.name);
        loop {
            (self.progress)(have, total);
            if have > MAX_BYTES {
                return Ok(false);
            }
            let broke_off = |reason: String| {
                message!(
                    "the download of {name} broke off after {have} bytes ({reason}): run the command again to go on from there"
                )
            };
            let (seconds, came) = (begin.elapsed().as_secs_f64(), (have - had) as f64);
            if seconds > SLOW_START_S && came < seconds * LEAST_BYTES_PER_S {
                return Err(broke_off(format!("fewer than {LEAST_BYTES_PER_S} bytes a second came")));
            }
            let failed = |e: std::io::Error| {
                // Only single reads have a time limit while a body comes.
                let cause = e.get_ref().and_then(|cause| cause.downcast_ref::<ureq::Error>());
                broke_off(match cause {
                    Some(ureq::Error::Timeout(_)) => format!("nothing came for {} s", self.patience.as_secs_f64()),
                    _ => files::plain(&e),
                })
            };
            match body.read(&mut buffer).map_err(failed)? {
                0 => return Ok(true),
                n => file.write_all(&buffer[..n]).map_err(failed)?,
            }
            have = file.metadata().map_err(failed)?.len();
        }
    }
}

/// The address of a file beside another.
fn beside(url: &str, file: &str) -> String {
    let (place, query) = url.split_at(url.find(['?', '#']).unwrap_or(url.len()));
    let folder = place.rsplit_once('/').map_or(place, |(folder, _)| folder);
    format!("{folder}/{file}{query}")
}
