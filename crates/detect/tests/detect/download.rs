//! Downloads from a server on this machine.

use std::io::Write;
use std::time::Duration;

use scaleproof_core::files;
use scaleproof_detect::Manifest;
use scaleproof_detect::download::{fetch, fetch_within};

use std::io::{BufRead, BufReader};
use std::net::TcpListener;

/// A server on this machine that answers each request with the next of `answers`, and returns the Range headers it saw.
fn serve(answers: Vec<Vec<u8>>) -> (String, std::thread::JoinHandle<Vec<Option<String>>>) {
    serve_and_stall(answers, Duration::ZERO)
}

/// A server like that of [`serve`], which says nothing more after each answer and closes the connection so much later.
fn serve_and_stall(answers: Vec<Vec<u8>>, stall: Duration) -> (String, std::thread::JoinHandle<Vec<Option<String>>>) {
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
    let mut bytes = format!("HTTP/1.1 {status}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n").into_bytes();
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
    let error = fetch_within(&manifest(url, &content), folder.path(), &|_, _| {}, patience).unwrap_err();
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

/// The hash is that of both, one behind the other.
#[test]
fn files_with_a_networks_tensors_are_fetched_from_beside_it() {
    let [network, data] = ["detr.onnx", "detr.onnx.data"].map(|name| {
        let path = crate::common::home().join("tests/data/exported").join(name);
        std::fs::read(path).unwrap()
    });
    let both = [network.as_slice(), &data].concat();
    let ok = |body: &[u8]| answer("200 OK", body.len(), body);
    let names = |folder: &std::path::Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    let folder = tempfile::tempdir().unwrap();
    // Broken off in the second, another file there, and whole.
    let (url, _) = serve(vec![ok(&network), answer("200 OK", data.len(), &data[..900])]);
    let error = fetch(&manifest(url, &both), folder.path(), &|_, _| {}).unwrap_err();
    assert!(error.to_string().contains("broke off after 900 bytes"), "{error}");
    let rest = || answer("206 Partial Content", data.len() - 900, &data[900..]);
    let nothing_more = || answer("416 Range Not Satisfiable", 0, b"");
    let (url, server) = serve(vec![nothing_more(), rest()]);
    let path = fetch(&manifest(url, &both), folder.path(), &|_, _| {}).unwrap();
    assert_eq!(names(folder.path()), ["detr.onnx.data", "yolox_nano.onnx"]);
    assert_eq!(std::fs::read(path).unwrap(), network);
    assert_eq!(
        server.join().unwrap(),
        [Some(format!("bytes={}-", network.len())), Some("bytes=900-".into())]
    );
    let folder = tempfile::tempdir().unwrap();
    let (url, _) = serve(vec![ok(&network), ok(b"other")]);
    let error = fetch(&manifest(url, &both), folder.path(), &|_, _| {}).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("is not the one yolox_nano was described with"),
        "{error}"
    );
    assert!(names(folder.path()).is_empty());
}
