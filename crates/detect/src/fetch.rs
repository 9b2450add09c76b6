//! Downloads weights: with progress, resumed where it stopped, and kept only when the hash is right.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::weights::check_hash;
use super::{Manifest, WeightsError};
use scaleproof_core::files;

/// Why a download did not end in a usable file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FetchError {
    #[error("the manifest of {name} has no weights.url to fetch from: put {file} beside the manifest")]
    NoUrl { name: String, file: String },
    #[error("cannot reach {host} to fetch {name} ({reason}): go online, or copy {file} into {folder}", folder = folder.display())]
    Unreachable {
        name: String,
        host: String,
        file: String,
        folder: PathBuf,
        reason: String,
    },
    #[error("{url} answered {status}: the file may have moved; see the manifest of {name} for its origin")]
    Refused { name: String, url: String, status: u16 },
    #[error(
        "the download of {name} broke off after {bytes} bytes ({reason}): run the command again to go on from there"
    )]
    BrokeOff { name: String, bytes: u64, reason: String },
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the file at {url} is not the one {name} was described with; it was not kept")]
    WrongFile { name: String, url: String },
    #[error(
        "the download of {name} has more than 2 GB, so it is not the file that the manifest describes; it was not kept"
    )]
    TooLarge { name: String },
    #[error("{path} is already there and is not the file {name} was described with: move it away", path = path.display())]
    Taken { name: String, path: PathBuf },
    #[error("{path} is a link or a folder, and the download would be collected in it: remove it", path = path.display())]
    NoPart { path: PathBuf },
}

/// Nothing this program fetches is near this size; a longer answer is not the file.
const MAX_BYTES: u64 = 2 << 30;

/// A download breaks off when no byte comes for this long.
const PATIENCE: Duration = Duration::from_secs(30);

/// So does one that is slower than this on the whole, once it had time to begin: the file would take a day.
const LEAST_BYTES_PER_S: f64 = 100.0;
const SLOW_START_S: f64 = 60.0;

/// Downloads a detector's weights into a folder. `progress` receives the bytes so far and, if known, in all.
///
/// The bytes are collected in `FILE.part`, which a later call goes on with, and renamed when complete and verified. The right file that is
/// there already stays, and another one is never replaced.
pub fn fetch(manifest: &Manifest, folder: &Path, progress: &dyn Fn(u64, Option<u64>)) -> Result<PathBuf, FetchError> {
    fetch_with(manifest, folder, progress, PATIENCE)
}

fn fetch_with(
    manifest: &Manifest,
    folder: &Path,
    progress: &dyn Fn(u64, Option<u64>),
    patience: Duration,
) -> Result<PathBuf, FetchError> {
    if manifest.weights.url.is_empty() {
        return Err(FetchError::NoUrl {
            name: manifest.name.clone(),
            file: manifest.weights.file.clone(),
        });
    }
    let target = folder.join(&manifest.weights.file);
    if std::fs::symlink_metadata(&target).is_ok() {
        return already_there(manifest, target);
    }
    let part = folder.join(format!("{}.part", manifest.weights.file));
    let failed = |e: std::io::Error| files::FileError::write(&part, &e);
    let have = part_bytes(&part)?;
    if let Some(response) = request(manifest, folder, have, patience)? {
        std::fs::create_dir_all(folder).map_err(failed)?;
        let resumed = response.status() == 206 && have > 0;
        let have = if resumed { have } else { 0 };
        let mut file = open_part(&part, resumed).map_err(failed)?;
        let received = receive(manifest, response, &mut file, have, progress, patience);
        if matches!(received, Err(FetchError::TooLarge { .. })) {
            files::remove(&part)?;
        }
        received?;
        file.sync_all().map_err(failed)?;
    }
    keep(manifest, &part, &target)
}

fn already_there(manifest: &Manifest, target: PathBuf) -> Result<PathBuf, FetchError> {
    match check_hash(manifest, &target) {
        Ok(()) => Ok(target),
        Err(WeightsError::File(e)) => Err(e.into()),
        Err(_) => Err(FetchError::Taken {
            name: manifest.name.clone(),
            path: target,
        }),
    }
}

/// How many bytes an earlier call has collected. A link is not followed: the download would be written to wherever it points.
fn part_bytes(part: &Path) -> Result<u64, FetchError> {
    match std::fs::symlink_metadata(part) {
        Ok(about) if about.is_file() => Ok(about.len()),
        Ok(_) => Err(FetchError::NoPart { path: part.to_owned() }),
        Err(_) => Ok(0),
    }
}

type Response = ureq::http::Response<ureq::Body>;

/// Asks for the file from byte `have` on. `None`: there is nothing after it, the part is already whole.
fn request(manifest: &Manifest, folder: &Path, have: u64, patience: Duration) -> Result<Option<Response>, FetchError> {
    let url = &manifest.weights.url;
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .timeout_connect(Some(Duration::from_secs(8)))
        .timeout_recv_response(Some(Duration::from_secs(30)))
        // Starts anew with every byte, unlike the time-out of the body, which a slow line and a large file would exceed.
        .timeout_per_read(Some(patience))
        .http_status_as_error(false)
        .build()
        .into();
    let mut request = agent.get(url);
    if have > 0 {
        request = request.header("Range", format!("bytes={have}-"));
    }
    let response = request.call().map_err(|e| FetchError::Unreachable {
        name: manifest.name.clone(),
        host: host(url),
        file: manifest.weights.file.clone(),
        folder: folder.to_owned(),
        reason: e.to_string().replace('\n', " "),
    })?;
    match response.status().as_u16() {
        200 | 206 => Ok(Some(response)),
        416 if have > 0 => Ok(None),
        status => Err(FetchError::Refused {
            name: manifest.name.clone(),
            url: url.clone(),
            status,
        }),
    }
}

fn open_part(part: &Path, resumed: bool) -> std::io::Result<File> {
    if resumed {
        return OpenOptions::new().append(true).open(part);
    }
    // A new file, so that nothing is written through a link that came in between.
    if std::fs::symlink_metadata(part).is_ok() {
        std::fs::remove_file(part)?;
    }
    OpenOptions::new().write(true).create_new(true).open(part)
}

fn receive(
    manifest: &Manifest,
    response: Response,
    file: &mut File,
    mut have: u64,
    progress: &dyn Fn(u64, Option<u64>),
    patience: Duration,
) -> Result<(), FetchError> {
    let total = response.body().content_length().map(|rest| have + rest);
    // A little more, so that the limit is found below.
    let limit = MAX_BYTES + (1 << 20);
    let mut body = response.into_body().into_with_config().limit(limit).reader();
    let mut buffer = vec![0; 1 << 16];
    let (begin, had) = (Instant::now(), have);
    loop {
        progress(have, total);
        if have > MAX_BYTES {
            return Err(FetchError::TooLarge {
                name: manifest.name.clone(),
            });
        }
        let (seconds, came) = (begin.elapsed().as_secs_f64(), (have - had) as f64);
        if seconds > SLOW_START_S && came < seconds * LEAST_BYTES_PER_S {
            return Err(FetchError::BrokeOff {
                name: manifest.name.clone(),
                bytes: have,
                reason: format!("fewer than {LEAST_BYTES_PER_S} bytes a second came"),
            });
        }
        let broke_off = |e: std::io::Error| FetchError::BrokeOff {
            name: manifest.name.clone(),
            bytes: have,
            reason: if is_late(&e) {
                format!("nothing came for {} s", patience.as_secs_f64())
            } else {
                files::plain(&e)
            },
        };
        match body.read(&mut buffer).map_err(broke_off)? {
            0 => return Ok(()),
            n => file.write_all(&buffer[..n]).map_err(broke_off)?,
        };
        have = file.metadata().map_err(broke_off)?.len();
    }
}

/// Only single reads have a time limit while a body comes.
fn is_late(e: &std::io::Error) -> bool {
    let cause = e.get_ref().and_then(|cause| cause.downcast_ref::<ureq::Error>());
    matches!(cause, Some(ureq::Error::Timeout(_)))
}

fn keep(manifest: &Manifest, part: &Path, target: &Path) -> Result<PathBuf, FetchError> {
    let failed = |e: std::io::Error| files::FileError::write(target, &e);
    match check_hash(manifest, part) {
        Ok(()) => {}
        Err(WeightsError::File(e)) => return Err(e.into()),
        Err(_) => {
            std::fs::remove_file(part).map_err(failed)?;
            return Err(FetchError::WrongFile {
                name: manifest.name.clone(),
                url: manifest.weights.url.clone(),
            });
        }
    }
    std::fs::rename(part, target).map_err(failed)?;
    Ok(target.to_owned())
}

fn host(url: &str) -> String {
    url.split('/').nth(2).unwrap_or(url).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead, BufReader};
    use std::net::TcpListener;

    /// A server on this machine that answers each request with the next of `answers`, and returns the Range headers it saw.
    fn serve(answers: Vec<Vec<u8>>) -> (String, std::thread::JoinHandle<Vec<Option<String>>>) {
        serve_and_stall(answers, Duration::ZERO)
    }

    /// A server like that of [`serve`], which says nothing more after each answer and closes the connection so much later.
    fn serve_and_stall(
        answers: Vec<Vec<u8>>,
        stall: Duration,
    ) -> (String, std::thread::JoinHandle<Vec<Option<String>>>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/model.onnx", listener.local_addr().unwrap());
        let server = std::thread::spawn(move || {
            answers
                .into_iter()
                .map(|answer| {
                    let (mut stream, _) = listener.accept().unwrap();
                    let lines = BufReader::new(stream.try_clone().unwrap()).lines();
                    let head: Vec<String> = lines.map(Result::unwrap).take_while(|l| !l.is_empty()).collect();
                    stream.write_all(&answer).unwrap();
                    std::thread::sleep(stall);
                    head.iter()
                        .find_map(|l| l.to_lowercase().strip_prefix("range: ").map(str::to_owned))
                })
                .collect()
        });
        (url, server)
    }

    fn answer(status: &str, length: usize, body: &[u8]) -> Vec<u8> {
        let mut bytes =
            format!("HTTP/1.1 {status}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n").into_bytes();
        bytes.extend_from_slice(body);
        bytes
    }

    fn manifest(url: String, content: &[u8]) -> Manifest {
        let mut m = Manifest::named("yolox_nano").unwrap();
        m.weights.url = url;
        m.weights.sha256 = files::sha256_hex(content);
        m
    }

    #[test]
    fn a_broken_download_goes_on_where_it_stopped() {
        let content: Vec<u8> = (0..200_000u32).map(|i| (i % 251) as u8).collect();
        let (url, server) = serve(vec![
            answer("200 OK", content.len(), &content[..70_000]),
            answer("206 Partial Content", content.len() - 70_000, &content[70_000..]),
        ]);
        let folder = tempfile::tempdir().unwrap();
        let m = manifest(url, &content);
        let error = fetch(&m, folder.path(), &|_, _| {}).unwrap_err().to_string();
        assert!(error.contains("broke off after 70000 bytes"), "{error}");
        assert!(!folder.path().join("yolox_nano.onnx").exists());
        let path = fetch(&m, folder.path(), &|_, _| {}).unwrap();
        assert_eq!(std::fs::read(path).unwrap(), content);
        assert_eq!(server.join().unwrap(), [None, Some("bytes=70000-".into())]);
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no part stays behind"
        );
    }

    #[test]
    fn a_download_that_stalls_breaks_off_and_can_go_on() {
        let content = vec![7; 100_000];
        let stalled = answer("200 OK", content.len(), &content[..70_000]);
        let (url, _) = serve_and_stall(vec![stalled], Duration::from_secs(20));
        let folder = tempfile::tempdir().unwrap();
        let patience = Duration::from_secs(1);
        let error = fetch_with(&manifest(url, &content), folder.path(), &|_, _| {}, patience).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("broke off after 70000 bytes (nothing came for 1 s)"),
            "{error}"
        );
        let rest = answer("206 Partial Content", 30_000, &content[70_000..]);
        let (url, server) = serve(vec![rest]);
        let path = fetch(&manifest(url, &content), folder.path(), &|_, _| {}).unwrap();
        assert_eq!(std::fs::read(path).unwrap(), content);
        assert_eq!(server.join().unwrap(), [Some("bytes=70000-".into())]);
    }

    #[test]
    fn a_file_that_is_there_is_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("yolox_nano.onnx");
        std::fs::write(&target, b"mine").unwrap();
        let (url, _) = serve(vec![answer("200 OK", 5, b"model")]);
        let error = fetch(&manifest(url.clone(), b"model"), folder.path(), &|_, _| {})
            .unwrap_err()
            .to_string();
        assert!(error.contains("yolox_nano.onnx is already there"), "{error}");
        assert_eq!(std::fs::read(&target).unwrap(), b"mine");
        // The right one needs no download.
        assert_eq!(
            fetch(&manifest(url, b"mine"), folder.path(), &|_, _| {}).unwrap(),
            target
        );
    }

    #[test]
    #[cfg(unix)]
    fn a_link_in_the_place_of_the_part_is_not_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let (mine, part) = (
            folder.path().join("mine.txt"),
            folder.path().join("yolox_nano.onnx.part"),
        );
        for content in ["", "mine"] {
            std::fs::write(&mine, content).unwrap();
            std::os::unix::fs::symlink(&mine, &part).unwrap();
            let (url, _) = serve(vec![answer("200 OK", 5, b"model")]);
            let error = fetch(&manifest(url, b"model"), folder.path(), &|_, _| {})
                .unwrap_err()
                .to_string();
            assert!(
                error.contains("yolox_nano.onnx.part is a link or a folder") && error.ends_with("remove it"),
                "{error}"
            );
            assert_eq!(std::fs::read_to_string(&mine).unwrap(), content);
            std::fs::remove_file(&part).unwrap();
        }
    }

    #[test]
    fn another_file_is_not_kept() {
        let (url, server) = serve(vec![answer("200 OK", 5, b"error")]);
        let folder = tempfile::tempdir().unwrap();
        let error = fetch(&manifest(url, b"model"), folder.path(), &|_, _| {})
            .unwrap_err()
            .to_string();
        assert!(error.contains("not the one yolox_nano was described with"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        server.join().unwrap();
    }

    #[test]
    fn a_missing_file_and_a_missing_network_are_sentences() {
        let (url, server) = serve(vec![answer("404 Not Found", 0, b"")]);
        let folder = tempfile::tempdir().unwrap();
        let error = fetch(&manifest(url, b""), folder.path(), &|_, _| {})
            .unwrap_err()
            .to_string();
        assert!(error.contains("answered 404"), "{error}");
        server.join().unwrap();
        let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let error = fetch(&manifest(format!("http://{closed}/x"), b""), folder.path(), &|_, _| {})
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(&format!("cannot reach {closed}")) && !error.contains('\n'),
            "{error}"
        );
    }
}
