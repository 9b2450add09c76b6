//! Cameras that stream, through the program: motion JPEG over HTTP, served on loopback by a thread of the test. A photographer walks on in front
//! of it when the session has another photo. RTSP stands in the tests of the crate `capture`.

use crate::common;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use common::kills::send;
use common::served::{MULTIPART, part, serve, taken};
use common::{HANG, assert_refused, program, skyline, stderr, stdout};

/// A photo of the stored session.
fn photo(number: usize) -> Vec<u8> {
    std::fs::read(skyline().join(format!("normal_{number:03}.jpg"))).unwrap()
}

/// A capture from a source, into a session of the stored scene.
fn captures(source: &str, session: &Path) -> Command {
    let mut program = program();
    program.args(["capture", "--source", source, "--variant", "normal", "--place", "yard"]);
    for (option, name) in [("--scene", "scene.toml"), ("--camera", "camera.yaml")] {
        program.arg(option).arg(skyline().join(name));
    }
    program.arg("-o").arg(session);
    program
}

fn capture(source: &str, session: &Path) -> Output {
    captures(source, session).output().unwrap()
}

/// The photos are those that the camera made, byte for byte: whatever is computed of them is what it is for the stored session.
#[test]
fn a_motion_jpeg_camera_fills_the_eight_views_with_its_own_files_and_its_password_is_nowhere() {
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let place = session.clone();
    let port = serve(move |_, head, connection| {
        // Of `admin:s3cret`, by RFC 7617. ffmpeg asks without it first.
        if !head.contains("Authorization: Basic YWRtaW46czNjcmV0") {
            let denied =
                "HTTP/1.1 401 Unauthorized\r\nWWW-Authenticate: Basic realm=\"camera\"\r\nContent-Length: 0\r\n\r\n";
            return connection.write_all(denied.as_bytes());
        }
        assert!(head.starts_with("GET /video?key=s3cret "), "{head}");
        connection.write_all(MULTIPART.as_bytes())?;
        loop {
            part(connection, &photo(taken(&place).min(7)))?;
        }
    });
    let output = capture(
        &format!("http://admin:s3cret@127.0.0.1:{port}/video?key=s3cret"),
        &session,
    );
    let told = format!("{}{}", stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(0), "{told}");
    for number in 0..8 {
        let kept = std::fs::read(session.join(format!("normal_{number:03}.jpg"))).unwrap();
        assert!(kept == photo(number), "photo {number}");
    }
    let settings = format!(
        "note: http://127.0.0.1:{port}/video?…, motion JPEG 1280 × 960: exposure, focus, white balance cannot be held"
    );
    assert!(told.contains(&settings), "{told}");
    let mut written = told.into_bytes();
    for entry in std::fs::read_dir(&session).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            written.extend(std::fs::read(path).unwrap());
        }
    }
    assert!(!written.windows(6).any(|word| word == b"s3cret"));
}

#[test]
fn what_is_no_camera_is_refused_in_a_sentence_and_nothing_is_left() {
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let port = serve(|_, head, connection| {
        let path = head.split(' ').nth(1).unwrap_or_default();
        let answer = match path {
            "/silent" => {
                // Until the client has left.
                let _ = connection.read(&mut [0; 16]);
                return Ok(());
            }
            "/page" => "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 9\r\n\r\n<p>no</p>",
            // A playlist and a redirection that name a file of this machine.
            "/list" => {
                "HTTP/1.1 200 OK\r\nContent-Type: application/vnd.apple.mpegurl\r\n\r\n#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n"
            }
            "/away" => "HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\nContent-Length: 0\r\n\r\n",
            _ => "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n",
        };
        connection.write_all(answer.as_bytes())
    });
    let closed = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let refused = [
        (
            format!("http://u:s3cret@127.0.0.1:{port}/page"),
            "it sent no motion JPEG",
        ),
        (
            format!("http://u:s3cret@127.0.0.1:{port}/list"),
            "it sent no motion JPEG",
        ),
        (
            format!("http://u:s3cret@127.0.0.1:{port}/away"),
            "/away cannot be used (",
        ),
        (format!("http://u:s3cret@127.0.0.1:{port}/x?s3cret"), "404"),
        (
            format!("http://u:s3cret@127.0.0.1:{port}/silent"),
            "/silent cannot be used (",
        ),
        (format!("http://u:s3cret@127.0.0.1:{closed}/"), "Connection refused"),
        (format!("rtsp://u:s3cret@127.0.0.1:{closed}/"), "onnection refused"),
        (
            "file:///etc/passwd".into(),
            "give an address that begins with http:// or rtsp://",
        ),
        ("http://u:s3cret@".into(), "it names no host"),
    ];
    for (source, sentence) in refused {
        let output = capture(&source, &session);
        assert_refused(&output, &[sentence]);
        let told = stderr(&output);
        assert!(!told.contains("s3cret") && !told.contains("root:"), "{told}");
        assert!(!session.exists());
    }
}

/// A camera that sends without end and never an image: Ctrl-C ends the program, and the one that reads for it.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_what_reads_from_a_camera_that_sends_no_image() {
    let (sent, sends) = std::sync::mpsc::channel();
    let port = serve(move |_, _, connection| {
        connection.write_all(MULTIPART.as_bytes())?;
        let _ = sent.send(());
        loop {
            connection.write_all(&[0; 65_536])?;
        }
    });
    let out = tempfile::tempdir().unwrap();
    let address = format!("http://127.0.0.1:{port}/");
    let session = out.path().join("session");
    let mut running = captures(&address, &session).spawn().unwrap();
    sends.recv_timeout(HANG).unwrap();
    send(&["-INT"], &running);
    assert_eq!(running.wait().unwrap().code(), Some(130));
    let reads = |process: &Path| {
        let words = std::fs::read(process.join("cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&words).contains(&address)
    };
    let left = std::fs::read_dir("/proc")
        .unwrap()
        .flatten()
        .filter(|process| reads(&process.path()));
    assert_eq!(left.count(), 0, "ffmpeg still reads");
    assert!(!session.exists());
}

/// An RTSP server (RFC 2326) that announces a description of 2 GB and sends it, and one that sends on to another.
#[test]
fn what_an_rtsp_server_announces_takes_no_memory_and_it_sends_nobody_on() {
    let sent = Arc::new(AtomicU64::new(0));
    let counted = sent.clone();
    let answers = move |_: usize, head: &str, connection: &mut TcpStream| {
        let cseq = |head: &str| {
            head.lines()
                .find(|line| line.starts_with("CSeq"))
                .unwrap_or_default()
                .to_owned()
        };
        let ok = format!("RTSP/1.0 200 OK\r\n{}\r\nPublic: OPTIONS, DESCRIBE\r\n\r\n", cseq(head));
        connection.write_all(ok.as_bytes())?;
        let mut second = String::new();
        let mut reader = BufReader::new(connection.try_clone()?);
        while !second.ends_with("\r\n\r\n") && reader.read_line(&mut second)? > 0 {}
        let cseq = cseq(&second);
        if second.contains("/away") {
            let away = format!("RTSP/1.0 302 Found\r\n{cseq}\r\nLocation: rtsp://127.0.0.1:1/other\r\n\r\n");
            return connection.write_all(away.as_bytes());
        }
        let head =
            format!("RTSP/1.0 200 OK\r\n{cseq}\r\nContent-Type: application/sdp\r\nContent-Length: 2000000000\r\n\r\n");
        connection.write_all(head.as_bytes())?;
        loop {
            connection.write_all(&[b'v'; 65_536])?;
            counted.fetch_add(65_536, Ordering::Relaxed);
        }
    };
    let port = serve(answers);
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let output = capture(&format!("rtsp://127.0.0.1:{port}/large"), &session);
    assert_refused(&output, &["cannot be used ("]);
    let sent = sent.load(Ordering::Relaxed);
    assert!(sent < 200 << 20, "{} MB were taken", sent >> 20);
    let output = capture(&format!("rtsp://127.0.0.1:{port}/away"), &session);
    assert_refused(&output, &["it sends on to another address"]);
    assert!(!session.exists());
}

/// A camera's page that sends on is not followed to another host.
#[test]
fn a_redirection_is_not_followed() {
    let asked = Arc::new(AtomicU64::new(0));
    let counted = asked.clone();
    let other = serve(move |_, _, connection| {
        counted.fetch_add(1, Ordering::Relaxed);
        connection.write_all(MULTIPART.as_bytes())?;
        loop {
            part(connection, &photo(0))?;
        }
    });
    let port = serve(move |_, _, connection| {
        let away = format!("HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1:{other}/\r\nContent-Length: 0\r\n\r\n");
        connection.write_all(away.as_bytes())
    });
    let out = tempfile::tempdir().unwrap();
    let output = capture(&format!("http://127.0.0.1:{port}/"), &out.path().join("session"));
    assert_refused(&output, &["cannot be used ("]);
    assert_eq!(asked.load(Ordering::Relaxed), 0);
}
