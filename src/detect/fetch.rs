//! Downloads weights: with progress, resumed where it stopped, and kept only when the hash is right.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::weights::check_hash;
use super::{Manifest, WeightsError};
use crate::files;

/// Why a download did not end in a usable file.
#[derive(Debug, thiserror::Error)]
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
}

/// Nothing this program fetches is near this size; a longer answer is not the file.
const MAX_BYTES: u64 = 2 << 30;

/// Downloads a detector's weights into a folder. `progress` is told the bytes so far and, if known, in all.
///
/// The bytes are collected in `FILE.part`, which a later call goes on with, and renamed when complete and verified.
pub fn fetch(manifest: &Manifest, folder: &Path, progress: &dyn Fn(u64, Option<u64>)) -> Result<PathBuf, FetchError> {
    if manifest.weights.url.is_empty() {
        return Err(FetchError::NoUrl {
            name: manifest.name.clone(),
            file: manifest.weights.file.clone(),
        });
    }
    let target = folder.join(&manifest.weights.file);
    let part = folder.join(format!("{}.part", manifest.weights.file));
    let failed = |e: std::io::Error| files::FileError::Write {
        path: part.clone(),
        reason: files::plain(&e),
    };
    let have = std::fs::metadata(&part).map_or(0, |m| m.len());
    if let Some(response) = request(manifest, folder, have)? {
        std::fs::create_dir_all(folder).map_err(failed)?;
        let resumed = response.status() == 206;
        let have = if resumed { have } else { 0 };
        let mut file = open_part(&part, resumed).map_err(failed)?;
        receive(manifest, response, &mut file, have, progress)?;
        file.sync_all().map_err(failed)?;
    }
    keep(manifest, &part, &target)
}

type Response = ureq::http::Response<ureq::Body>;

/// Asks for the file from byte `have` on. `None`: there is nothing after it, the part is already whole.
fn request(manifest: &Manifest, folder: &Path, have: u64) -> Result<Option<Response>, FetchError> {
    let url = &manifest.weights.url;
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .timeout_connect(Some(Duration::from_secs(8)))
        .timeout_recv_response(Some(Duration::from_secs(30)))
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
    match resumed {
        true => OpenOptions::new().append(true).open(part),
        false => File::create(part),
    }
}

fn receive(
    manifest: &Manifest,
    response: Response,
    file: &mut File,
    mut have: u64,
    progress: &dyn Fn(u64, Option<u64>),
) -> Result<(), FetchError> {
    let total = response.body().content_length().map(|rest| have + rest);
    let mut body = response.into_body().into_with_config().limit(MAX_BYTES).reader();
    let mut buffer = vec![0; 1 << 16];
    loop {
        progress(have, total);
        let broke_off = |e: std::io::Error| FetchError::BrokeOff {
            name: manifest.name.clone(),
            bytes: have,
            reason: files::plain(&e),
        };
        match body.read(&mut buffer).map_err(broke_off)? {
            0 => return Ok(()),
            n => file.write_all(&buffer[..n]).map_err(broke_off)?,
        };
        have = file.metadata().map_err(broke_off)?.len();
    }
}

fn keep(manifest: &Manifest, part: &Path, target: &Path) -> Result<PathBuf, FetchError> {
    let failed = |e: std::io::Error| files::FileError::Write {
        path: target.to_owned(),
        reason: files::plain(&e),
    };
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
