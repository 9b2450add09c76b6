//! Requests and connections that are no browser's, against the page of a capture.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::capture_page::http::{Request, connect, upload};
use crate::capture_page::running::Running;
use crate::common::{HANG, skyline};
use crate::hostile::bounded::highest_memory;

/// Heads, and the status of the answer; `None` where the connection may also end without one. `{host}` is the server's.
const REQUESTS: [(&str, Option<u16>); 16] = [
    ("GET / HTTP/1.1\r\n", Some(421)),
    ("GET / HTTP/1.1\r\nHost: evil.example\r\n", Some(421)),
    ("GET http://{host}/ HTTP/1.1\r\nHost: {host}\r\n", None),
    ("GET / HTTP/9.9\r\nHost: {host}\r\n", None),
    ("NONSENSE\r\n", None),
    (
        "GET /photo/..%2f..%2fetc%2fpasswd HTTP/1.1\r\nHost: {host}\r\n",
        Some(404),
    ),
    ("GET /photo/scene.toml HTTP/1.1\r\nHost: {host}\r\n", Some(404)),
    (
        "GET /state/99999999999999999999999 HTTP/1.1\r\nHost: {host}\r\n",
        Some(400),
    ),
    ("GET /state/-1 HTTP/1.1\r\nHost: {host}\r\n", Some(400)),
    ("GET /preview/nan HTTP/1.1\r\nHost: {host}\r\n", Some(400)),
    (
        "POST /redo/99999 HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n",
        Some(200),
    ),
    (
        "POST /redo/x HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n",
        Some(400),
    ),
    (
        "POST /upload HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Type: image/jpeg\r\nContent-Length: 99999999999\r\n",
        Some(413),
    ),
    (
        "POST /upload HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Type: image/jpeg\r\nContent-Length: -5\r\n",
        None,
    ),
    (
        "DELETE / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n",
        Some(405),
    ),
    ("GET /join/0 HTTP/1.1\r\nHost: {host}\r\n", None),
];

#[test]
fn every_route_answers_every_request_and_goes_on() {
    let running = Running::start("upload", &[]);
    for (head, status) in REQUESTS {
        let answer = running.client().try_to_send(&Request {
            head: head.into(),
            body: Vec::new(),
        });
        if let Some(status) = status {
            let answer = answer.unwrap();
            assert_eq!(answer.status, status, "{head}");
            // Not the words of the framework below.
            assert!(
                status != 400 || answer.body == b"this page has no such address",
                "{head}"
            );
        }
        assert_eq!(running.client().get("/page.css").status, 200, "after {head}");
    }
    // A head that does not end, and one of a megabyte.
    let long = format!("GET / HTTP/1.1\r\nHost: {{host}}\r\nX: {}\r\n", "x".repeat(1 << 20));
    let answer = running.client().try_to_send(&Request {
        head: long,
        body: Vec::new(),
    });
    assert!(answer.is_none_or(|answer| answer.status == 431));
    assert_eq!(running.client().get("/page.css").status, 200);
}

#[test]
fn connections_that_ask_and_read_nothing_keep_nobody_out() {
    let running = Running::start("upload", &[]);
    let host = running.host();
    let questions = format!("GET /page.js HTTP/1.1\r\nHost: {host}\r\n{}\r\n", running.cookie()).repeat(500);
    let deaf: Vec<TcpStream> = (0..300)
        .map(|_| {
            let mut stream = TcpStream::connect(&host).unwrap();
            stream.set_write_timeout(Some(Duration::from_millis(20))).unwrap();
            let _ = stream.write_all(questions.as_bytes()); // as much as the server takes
            stream
        })
        .collect();
    // They stay until it is answered.
    assert_eq!(running.client().get("/state/0").status, 200);
    drop(deaf);
}

#[test]
fn a_deaf_connection_is_closed() {
    let running = Running::start("upload", &[]);
    let mut deaf = connect(&running.host());
    let (host, cookie) = (running.host(), running.cookie());
    let questions = format!("GET /page.js HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n").repeat(2000);
    deaf.get_mut().set_write_timeout(Some(HANG)).unwrap();
    let (begin, mut sent) = (Instant::now(), Ok(()));
    while sent.is_ok() && begin.elapsed() < HANG {
        sent = deaf.get_mut().write_all(questions.as_bytes());
    }
    // Reset or closed by the other side, and not by our own limit.
    let kind = sent.unwrap_err().kind();
    assert!(
        matches!(
            kind,
            std::io::ErrorKind::ConnectionReset | std::io::ErrorKind::BrokenPipe
        ),
        "{kind:?} after {:?}",
        begin.elapsed()
    );
}

/// Four uploads hold all places: they send a byte a second, or half of the photo and then nothing.
#[test]
fn slow_uploads_give_their_places_to_a_good_one() {
    let photo = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    for (first, drips) in [(1, true), (photo.len() / 2, false)] {
        let running = Running::start("upload", &[]);
        let slow: Vec<TcpStream> = (0..4)
            .map(|_| {
                let mut stream = TcpStream::connect(running.host()).unwrap();
                let head = upload("image/jpeg", &photo).head.replace("{host}", &running.host());
                stream
                    .write_all(format!("{head}{}\r\n", running.cookie()).as_bytes())
                    .unwrap();
                stream.write_all(&photo[..first]).unwrap();
                stream
            })
            .collect();
        std::thread::sleep(Duration::from_millis(300));
        let is_answered = AtomicBool::new(false);
        std::thread::scope(|scope| {
            // They go on until the good one is answered.
            scope.spawn(|| {
                while !is_answered.load(Ordering::SeqCst) {
                    std::thread::sleep(Duration::from_secs(1));
                    if drips {
                        slow.iter().for_each(|mut stream| drop(stream.write_all(&[0])));
                    }
                }
            });
            let begin = Instant::now();
            let answer = running.client().try_to_send(&upload("image/jpeg", &photo));
            is_answered.store(true, Ordering::SeqCst);
            println!("after {first} bytes: a good upload waited {:.1?}", begin.elapsed());
            assert_eq!(answer.unwrap().json()["photo"], "normal_000.jpg");
        });
    }
}

#[test]
fn previews_that_nobody_waits_for_are_made_one_at_a_time() {
    let running = Running::start("upload", &[]);
    let mut client = running.client();
    // What takes too much to be shown small is not decoded for it.
    client.send(&upload("image/png", &deep(7000, 4000)));
    let number = client.get("/state/0").json()["frame"]["number"].as_u64().unwrap();
    assert_eq!(client.get(&format!("/preview/{number}")).status, 404);
    client.send(&upload("image/png", &noise(6000, 4000)));
    let number = client.get("/state/0").json()["frame"]["number"].as_u64().unwrap();
    for _ in 0..12 {
        let mut leaves = TcpStream::connect(running.host()).unwrap();
        let (host, cookie) = (running.host(), running.cookie());
        let head = format!("GET /preview/{number} HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n");
        leaves.write_all(head.as_bytes()).unwrap();
        std::thread::sleep(Duration::from_millis(30));
    }
    // Its turn comes after those that have begun.
    assert_eq!(client.get(&format!("/preview/{number}")).status, 200);
    let memory = highest_memory(running.child.id());
    println!("{} MB", memory >> 20);
    assert!(memory < 700 << 20, "{} MB", memory >> 20);
}

/// A PNG of noise in squares of 8 px.
fn noise(width: u32, height: u32) -> Vec<u8> {
    let mut random = Pcg64::seed_from_u64(4);
    let mut row = vec![0; 3 * width as usize];
    let mut pixels = Vec::new();
    for y in 0..height {
        if y.is_multiple_of(8) {
            row.chunks_mut(24)
                .for_each(|square| square.fill(random.next_u32() as u8));
        }
        pixels.extend_from_slice(&row);
    }
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&pixels, width, height, ExtendedColorType::Rgb8)
        .unwrap();
    bytes
}

/// A PNG of 16-bit RGBA, all of one colour.
fn deep(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(
            &vec![0x40; 8 * (width * height) as usize],
            width,
            height,
            ExtendedColorType::Rgba16,
        )
        .unwrap();
    bytes
}

/// A browser sends the cookies of a machine to each of its ports.
#[test]
fn two_captures_on_one_machine_leave_each_other_signed_in() {
    if std::net::UdpSocket::bind("0.0.0.0:0")
        .unwrap()
        .connect("192.0.2.1:9")
        .is_err()
    {
        return; // in no network --lan is refused, which tests/capture_page.rs checks
    }
    let captures = [
        Running::start("upload", &["--lan"]),
        Running::start("upload", &["--lan"]),
    ];
    let mut jar: Vec<(String, String)> = Vec::new();
    for capture in &captures {
        let join = capture.address.rsplit_once("/join/").unwrap().1.to_owned();
        let joined = capture.client().get(&format!("/join/{join}"));
        let pair = joined.header("set-cookie").split(';').next().unwrap();
        let (name, value) = pair.split_once('=').unwrap();
        jar.retain(|(known, _)| known != name);
        jar.push((name.into(), value.into()));
    }
    let cookies: Vec<String> = jar.iter().map(|(name, value)| format!("{name}={value}")).collect();
    for capture in &captures {
        let answer = capture.client().send(&Request {
            head: format!(
                "GET /state/0 HTTP/1.1\r\nHost: {{host}}\r\nCookie: {}\r\n",
                cookies.join("; ")
            ),
            body: Vec::new(),
        });
        assert_eq!(answer.status, 200, "{}", capture.address);
    }
}

/// Nobody unknown keeps a connection: the answer is its last.
#[test]
fn a_connection_ends_with_the_answer_to_a_stranger() {
    let running = Running::start("upload", &[]);
    let mut stream = TcpStream::connect(running.host()).unwrap();
    stream.set_read_timeout(Some(HANG)).unwrap();
    let question = "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n".repeat(3);
    stream.write_all(question.as_bytes()).unwrap();
    let mut said = Vec::new();
    let _ = stream.read_to_end(&mut said); // a reset ends it, too
    let answers = String::from_utf8_lossy(&said).matches("HTTP/1.1").count();
    assert_eq!(answers, 1);
}
