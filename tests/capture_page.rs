//! The page of a guided capture: over loopback as raw HTTP, among them ten thousand uploads that are none, and in headless Chromium.

use crate::common;

pub(super) mod browser;
pub(super) mod http;
pub(super) mod running;

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::net::{IpAddr, Shutdown, TcpStream, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use browser::Browser;
use common::{HANG, assert_refused, read_json, skyline};
use http::{Client, Request, post, upload};
use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, Luma, RgbImage};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use running::{Running, capture};
use serde_json::Value;

fn replay() -> String {
    format!("replay:{}", skyline().display())
}

pub(super) fn photo(number: u32) -> Vec<u8> {
    std::fs::read(skyline().join(format!("normal_{number:03}.jpg"))).unwrap()
}

pub(super) fn jpeg(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 95)
        .encode_image(picture)
        .unwrap();
    bytes
}

fn states(state: &Value) -> Vec<String> {
    let sectors = state["sectors"].as_array().unwrap();
    sectors
        .iter()
        .map(|sector| sector["state"].as_str().unwrap().to_owned())
        .collect()
}

/// The newest state once it is as wished.
fn wait_for(client: &mut Client, wished: impl Fn(&Value) -> bool) -> Value {
    let (end, mut seen) = (Instant::now() + HANG, 0);
    loop {
        let state = client.get(&format!("/state/{seen}")).json();
        if wished(&state) {
            return state;
        }
        assert!(Instant::now() < end, "waited too long; the state is {state}");
        seen = state["revision"].as_u64().unwrap();
    }
}

#[test]
fn the_dial_fills_while_a_replay_runs_and_views_are_taken_back_and_redone() {
    let mut running = Running::start(&replay(), &["--fps", "6"]);
    let mut client = running.client();
    let (mut filled, mut seen) = (Vec::new(), 0);
    let state = loop {
        let state = client.get(&format!("/state/{seen}")).json();
        seen = state["revision"].as_u64().unwrap();
        filled.push(state["filled"].as_u64().unwrap());
        let ok = states(&state).iter().filter(|state| *state == "ok").count() as u64;
        assert_eq!(ok, *filled.last().unwrap());
        if state["source_ended"] == true {
            break state;
        }
    };
    assert!(filled.is_sorted() && filled.last() == Some(&8), "{filled:?}");
    assert!(
        filled.iter().collect::<BTreeSet<_>>().len() >= 5,
        "seen while it ran: {filled:?}"
    );
    let frame = &state["frame"];
    assert_eq!(frame["advice"], "Taken; all views are there");
    // truth.json: 317.1°, and what a person would see in the image.
    assert!((frame["viewpoint"]["azimuth_deg"].as_f64().unwrap() - 317.1).abs() < 0.5);
    assert_eq!(
        (&frame["size_px"][0], &frame["size_px"][1]),
        (&1280.into(), &960.into())
    );
    assert!(frame["tags"].as_array().unwrap().len() >= 3);
    let meters = frame["meters"].as_array().unwrap();
    assert_eq!(
        [&meters[0]["is_good"], &meters[1]["is_good"], &meters[2]["is_good"]],
        [true.into(), true.into(), Value::Null].each_ref()
    );

    // The newest image, and no other; thumbnails of what was taken, and of nothing else.
    let number = frame["number"].as_u64().unwrap();
    let preview = client.get(&format!("/preview/{number}"));
    assert_eq!(image::load_from_memory(&preview.body).unwrap().width(), 960);
    assert_eq!(client.get(&format!("/preview/{}", number - 1)).status, 410);
    let thumbnail = client.get("/photo/normal_007.jpg");
    assert_eq!(image::load_from_memory(&thumbnail.body).unwrap().width(), 240);
    for name in [
        "scene.toml",
        "normal_008.jpg",
        "..%2Fsession%2Fnormal_000.jpg",
        "%2Fetc%2Fpasswd",
        "normal_000.jpg%00",
    ] {
        assert_eq!(client.get(&format!("/photo/{name}")).status, 404, "{name}");
    }

    assert_eq!(
        client.send(&post("/undo")).json()["sentence"],
        "Taken back: normal_007.jpg"
    );
    assert_eq!(
        client.send(&post("/redo/2")).json()["sentence"],
        "Taken back: normal_002.jpg"
    );
    assert_eq!(
        client.send(&post("/redo/2")).json()["sentence"],
        "There is no photo to take back"
    );
    assert_eq!(
        client.send(&post("/redo/99")).json()["sentence"],
        "There is no photo to take back"
    );
    let state = client.get("/state/0").json();
    assert_eq!(states(&state), ["ok", "ok", "redo", "ok", "ok", "ok", "ok", "redo"]);
    assert_eq!(state["next"], 7, "the view at 315°, where the camera was last");

    assert_eq!(client.send(&post("/finish")).status, 202);
    let (code, lines) = running.ended();
    assert_eq!(code, Some(2), "two views are open");
    assert_eq!(lines.iter().filter(|line| line["taken_back"].is_string()).count(), 2);
    assert_eq!(lines.last().unwrap()["filled"], 6);
}

#[test]
fn uploads_get_the_same_gates_and_the_same_advice() {
    let mut running = Running::start("upload", &[]);
    let mut client = running.client();
    let mut told = |bytes: &[u8]| {
        let answer = client.send(&upload("image/jpeg", bytes));
        (answer.status, answer.json())
    };
    let (status, taken) = told(&photo(0));
    assert_eq!(
        (status, &taken["code"], &taken["photo"]),
        (200, &"accepted".into(), &"normal_000.jpg".into())
    );
    // 2.8° is where the photo stands, 45° the next target.
    assert_eq!(taken["sentence"], "Taken; next: 42° to the right");
    let rgb = image::load_from_memory(&photo(1)).unwrap().to_rgb8();
    let dark = RgbImage::from_fn(rgb.width(), rgb.height(), |x, y| {
        rgb.get_pixel(x, y).0.map(|v| v / 5).into()
    });
    let blurred = jpeg(&image::imageops::blur(&rgb, 3.0));
    let cases = [
        (
            photo(0),
            "repeated",
            "This very photo is in the session already, as normal_000.jpg",
        ),
        (blurred.clone(), "blurred", "Hold still and let it focus"),
        (jpeg(&dark), "too_dark", "Too dark: more light"),
        (
            jpeg(&RgbImage::from_pixel(640, 480, [120, 120, 120].into())),
            "no_tags",
            "I see no tag",
        ),
        (
            photo(1)[..60_000].to_vec(),
            "unreadable",
            "Upload 6 ends in the middle of the image",
        ),
    ];
    for (bytes, code, sentence) in cases {
        let (status, told) = told(&bytes);
        assert_eq!(
            (status, &told["code"], &told["photo"]),
            (422, &code.into(), &Value::Null),
            "{told}"
        );
        assert!(told["sentence"].as_str().unwrap().starts_with(sentence), "{told}");
    }
    // By hand the blurred one is taken all the same, and its sidecar says so.
    let nothing = client.send(&post("/shoot"));
    assert_eq!((nothing.status, &nothing.json()["code"]), (422, &"unreadable".into()));
    assert_eq!(client.send(&upload("image/jpeg", &blurred)).status, 422);
    let shot = client.send(&post("/shoot"));
    assert_eq!((shot.status, &shot.json()["photo"]), (200, &"normal_001.jpg".into()));
    assert_eq!(
        read_json(&running.session().join("normal_001.capture.json"))["is_by_hand"],
        true
    );
    // The photo itself is kept byte for byte, under the store's name.
    assert_eq!(
        std::fs::read(running.session().join("normal_000.jpg")).unwrap(),
        photo(0)
    );
    let sidecar = read_json(&running.session().join("normal_000.capture.json"));
    assert_eq!(sidecar["source"], "upload 1");
    client.send(&post("/finish"));
    assert_eq!(running.ended().0, Some(2));
}

#[test]
fn the_viewpoints_of_another_session_are_shown_as_ghosts() {
    let stored = skyline();
    let running = Running::start("upload", &["--pair-with", stored.to_str().unwrap()]);
    let state = wait_for(&mut running.client(), |_| true);
    assert_eq!(state["about"]["is_paired"], true);
    let azimuths: Vec<f64> = state["views"]
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v["azimuth_deg"].as_f64().unwrap())
        .collect();
    let truth = [2.8, 45.2, 91.2, 132.0, 174.8, 227.7, 267.5, 317.1];
    assert!(
        azimuths.iter().zip(truth).all(|(a, b)| (a - b).abs() < 0.5),
        "{azimuths:?}"
    );
}

/// Everything below a folder, with the sizes of files.
fn tree(folder: &Path) -> BTreeSet<(PathBuf, u64)> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(tree(&path));
        } else {
            found.insert((path.clone(), std::fs::metadata(&path).unwrap().len()));
        }
    }
    found
}

/// A small image, as JPEG or PNG, without any tag.
fn small(format: image::ImageFormat) -> Vec<u8> {
    let picture = GrayImage::from_fn(64, 48, |x, y| Luma([(x * 3 + y) as u8]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn noise(rng: &mut Pcg64, most: usize) -> Vec<u8> {
    let mut bytes = vec![0; rng.random_range(0..most)];
    rng.fill_bytes(&mut bytes);
    bytes
}

/// The `number`th malformed upload.
fn malformed(number: usize, rng: &mut Pcg64) -> Request {
    let heads: [&[u8]; 4] = [
        b"\xFF\xD8\xFF\xE0\0\x10JFIF\0",
        b"\xFF\xD8\xFF\xDB",
        b"\x89PNG\r\n\x1A\n\0\0\0\rIHDR",
        b"GIF89a",
    ];
    let formats = [image::ImageFormat::Jpeg, image::ImageFormat::Png];
    match number % 10 {
        // A head, and then anything.
        0 | 1 => {
            let rest = noise(rng, 3000);
            upload("image/jpeg", &[heads.choose(rng).unwrap(), rest.as_slice()].concat())
        }
        // Some bytes of an image, its head more often, are others.
        2..=4 => {
            let mut bytes = small(formats[number % 2]);
            for _ in 0..rng.random_range(1..8) {
                let most = if rng.random_bool(0.7) { 60 } else { bytes.len() };
                let at = rng.random_range(0..most);
                bytes[at] = rng.random_range(0..=255);
            }
            upload("image/png", &bytes)
        }
        // An image that ends too early.
        5 => {
            let bytes = small(formats[number / 10 % 2]);
            upload("image/jpeg", &bytes[..rng.random_range(0..bytes.len() - 2)])
        }
        // 4 gigapixels in a few bytes, by PNG or by JPEG.
        6 => {
            let mut bytes = small(formats[number / 10 % 2]);
            match number / 10 % 2 {
                0 => {
                    let frame = bytes.windows(2).position(|pair| pair == [0xFF, 0xC0]).unwrap();
                    bytes[frame + 5..frame + 9].fill(0xFF);
                }
                _ => {
                    bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
                    let sum = crc32(&bytes[12..29]);
                    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
                }
            }
            upload("image/png", &bytes)
        }
        // Types that are no image's.
        7 => {
            let kinds = [
                "text/plain",
                "multipart/form-data; boundary=x",
                "application/x-www-form-urlencoded",
                "image/heic",
                "",
            ];
            let body =
                b"--x\r\nContent-Disposition: form-data; name=\"a\"; filename=\"../../evil.jpg\"\r\n\r\nx\r\n--x--";
            upload(kinds.choose(rng).unwrap(), body)
        }
        // Names that lead elsewhere, wherever a client may put one.
        8 => {
            let tricks = [
                "../../evil.jpg",
                "/tmp/evil.jpg",
                "..%2F..%2Fevil.jpg",
                "C:\\evil.jpg",
                "evil.jpg%00.png",
                "....//evil",
            ];
            let trick = tricks.choose(rng).unwrap();
            let mut request = upload("image/jpeg", &small(formats[0]));
            match rng.random_range(0..4) {
                0 => request.head += &format!("Content-Disposition: attachment; filename=\"{trick}\"\r\n"),
                1 => request.head += &format!("X-File-Name: {trick}\r\nSlug: {trick}\r\n"),
                2 => {
                    request.head = request
                        .head
                        .replace("/upload", &format!("/upload?name={}", trick.replace('\\', "/")))
                }
                _ => {
                    request.head = request
                        .head
                        .replace("/upload", &format!("/upload/{}", trick.replace('\\', "/")))
                }
            }
            request
        }
        // Lengths that are not true, or no HTTP at all.
        _ => {
            let mut request = upload("image/jpeg", &[]);
            let length = ["99999999999", "33554433", "-1", "18446744073709551616", "1, 2"]
                .choose(rng)
                .unwrap();
            request.head = request
                .head
                .replace("Content-Length: 0", &format!("Content-Length: {length}"));
            if rng.random_bool(0.3) {
                request.head = String::from_utf8_lossy(&noise(rng, 300)).replace(['\r', '\n'], "?");
                request.head += "\r\n";
            }
            request
        }
    }
}

/// CRC-32 as PNG uses it (RFC 2083, 15), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, b| {
        (0..8).fold(crc ^ u32::from(*b), |c, _| {
            if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 }
        })
    })
}

/// A body of which half comes and then nothing, a head that never ends, and a sender that leaves in the middle: how each ends.
fn slow(host: &str, cookie: &str, path: &str) -> [String; 3] {
    let upload = upload("image/jpeg", &photo(2)).to(path);
    let head = upload.head.replace("{host}", host) + cookie + "\r\n";
    let mut half = http::connect(host);
    half.get_mut()
        .write_all(&[head.as_bytes(), &upload.body[..50_000]].concat())
        .unwrap();
    let mut endless = http::connect(host);
    endless.get_mut().write_all(b"POST /upload HTTP/1.1\r\nX: ").unwrap();
    let mut left = http::connect(host);
    left.get_mut()
        .write_all(&[head.as_bytes(), &upload.body[..50_000]].concat())
        .unwrap();
    left.get_mut().shutdown(Shutdown::Write).unwrap();
    [&mut half, &mut endless, &mut left]
        .map(|stream| http::read(stream).map_or("closed".into(), |answer| answer.status.to_string()))
}

#[test]
fn two_thousand_malformed_uploads_are_refused_and_nothing_is_written() {
    let mut running = Running::start("upload", &[]);
    let before = tree(running.folder.path());
    let (host, cookie) = (running.host(), running.cookie().to_owned());
    let (done, closed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let start = Instant::now();
    let mut statuses = std::collections::BTreeMap::<u16, usize>::new();
    std::thread::scope(|scope| {
        // What is filmed gets what a photo gets; a small picture that can be read, though, is no fault (200), and never taken.
        let paths = ["/upload", "/film/1/whole/50", "/film/1/preview/50"];
        let slow = paths.map(|path| scope.spawn(|| slow(&host, &cookie, path)));
        let threads: Vec<_> = (0..8)
            .map(|thread| {
                let (host, cookie, done, closed) = (&host, &cookie, &done, &closed);
                scope.spawn(move || {
                    let mut rng = Pcg64::seed_from_u64(thread);
                    let mut client = Client::with_cookie(host, cookie);
                    let mut statuses = Vec::new();
                    for number in 0..250 {
                        let request = malformed(number, &mut rng).to(paths[thread as usize % 2]);
                        match client.try_to_send(&request) {
                            Some(answer) => statuses.push(answer.status),
                            None => drop(closed.fetch_add(1, Ordering::Relaxed)),
                        }
                        done.fetch_add(1, Ordering::Relaxed);
                    }
                    statuses
                })
            })
            .collect();
        for thread in threads {
            thread
                .join()
                .unwrap()
                .into_iter()
                .for_each(|status| *statuses.entry(status).or_default() += 1);
        }
        for slow in slow {
            let [half, endless, left] = slow.join().unwrap();
            assert_eq!((half.as_str(), left.as_str()), ("408", "400"));
            assert!(matches!(endless.as_str(), "408" | "closed"), "{endless}");
        }
    });
    println!(
        "{} malformed uploads in {:.1} s: answers {statuses:?}, {} connections closed without one",
        done.load(Ordering::Relaxed),
        start.elapsed().as_secs_f64(),
        closed.load(Ordering::Relaxed)
    );
    assert_eq!(done.load(Ordering::Relaxed), 2_000);
    assert!(
        statuses.keys().all(|status| (400..500).contains(status)),
        "{statuses:?}"
    );
    for expected in [400, 404, 413, 415, 422] {
        assert!(
            statuses.get(&expected).is_some_and(|count| *count > 10),
            "{expected} in {statuses:?}"
        );
    }
    assert_eq!(tree(running.folder.path()), before);
    // The server lives, and takes a photo that is one.
    let mut client = running.client();
    assert_eq!(
        client.send(&upload("image/jpeg", &photo(3))).json()["photo"],
        "normal_000.jpg"
    );
    client.send(&post("/finish"));
    let (code, lines) = running.ended();
    assert_eq!(
        (code, lines.iter().filter(|line| line["status"] == "accepted").count()),
        (Some(2), 1)
    );
}

#[test]
fn what_another_site_asks_is_refused() {
    let running = Running::start(&replay(), &[]);
    let mut client = running.client();
    wait_for(&mut client, |state| state["source_ended"] == true);
    let own = running.host();
    let cases = [
        ("GET /state/0", "evil.example", "", 421),
        ("GET /state/0", "{host}", "Sec-Fetch-Site: cross-site\r\n", 403),
        ("POST /undo", "{host}", "", 403),
        ("POST /undo", "{host}", "Origin: http://evil.example\r\n", 403),
        (
            "POST /undo",
            "{host}",
            "Origin: http://{host}\r\nSec-Fetch-Site: same-site\r\n",
            403,
        ),
        ("POST /finish", "evil.example", "Origin: http://evil.example\r\n", 421),
        ("GET /undo", "{host}", "", 405),
        ("GET /join/abc", "{host}", "", 303),
        ("GET /", "{host}", "Sec-Fetch-Site: none\r\n", 200),
    ];
    for (what, host, headers, status) in cases {
        let head = format!("{what} HTTP/1.1\r\nHost: {host}\r\n{headers}Content-Length: 0\r\n");
        let answer = client.send(&Request { head, body: Vec::new() });
        assert_eq!(answer.status, status, "{what} {host} {headers}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert!(
            answer
                .header("content-security-policy")
                .starts_with("default-src 'none'")
        );
        assert_eq!(answer.header("access-control-allow-origin"), "");
    }
    assert_eq!(client.get("/state/0").json()["filled"], 8, "nothing was taken back");
    // Only this machine can reach it.
    let port = own.rsplit_once(':').unwrap().1;
    if let Some(network) = in_network() {
        assert!(TcpStream::connect(format!("{network}:{port}")).is_err());
    }
}

/// The address of this machine in its network, if it is in one.
pub(super) fn in_network() -> Option<IpAddr> {
    let socket = UdpSocket::bind("0.0.0.0:0").unwrap();
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().unwrap().ip()).filter(|ip| !ip.is_loopback())
}

#[test]
fn in_the_network_nobody_gets_in_without_a_token_and_a_token_lets_one_browser_in() {
    let refused = |more: &[&str]| {
        capture("upload", &std::env::temp_dir().join("never made"), more)
            .output()
            .unwrap()
    };
    let Some(network) = in_network() else {
        assert_refused(&refused(&["--lan"]), &["in no network"]);
        return;
    };
    let mut running = Running::start("upload", &["--lan"]);
    let said = BufReader::new(running.child.stderr.take().unwrap()).lines();
    let said: Vec<String> = said
        .map(Result::unwrap)
        .take_while(|line| !line.starts_with("warning"))
        .collect();
    let [code @ .., phone, certificate] = &*said else {
        panic!("{said:?}");
    };
    let phone = phone.strip_prefix("phone: https://").unwrap();
    assert!(phone.starts_with(&format!("{network}:")), "{phone}");
    assert_eq!(
        code_read(code),
        format!("https://{phone}"),
        "the QR code says the address"
    );
    assert!(certificate.starts_with("certificate (SHA-256): ") && certificate.len() == 23 + 95);
    let (host, join) = phone.split_once('/').unwrap();
    // Unencrypted from this machine alone.
    assert_eq!(Client::new(host).get(&format!("/{join}")).status, 400);
    let mut client = running.client();
    for path in [
        "/",
        "/page.js",
        "/state/0",
        "/preview/1",
        "/photo/normal_000.jpg",
        "/nothing",
        "/join/00000000000000000000000000000000",
    ] {
        assert_eq!(client.get(path).status, 401, "{path}");
    }
    for request in [
        post("/undo"),
        post("/redo/0"),
        post("/finish"),
        upload("image/jpeg", &photo(0)),
        upload("image/jpeg", &photo(0)).to("/film/1/whole/50"),
    ] {
        assert_eq!(client.send(&request).status, 401, "{}", request.head);
    }
    let joined = client.get(&format!("/{join}"));
    assert_eq!((joined.status, joined.header("location")), (303, "/"));
    let cookie = joined.header("set-cookie").to_owned();
    assert!(cookie.ends_with("; Path=/; HttpOnly; SameSite=Strict"), "{cookie}");
    assert_eq!(client.get(&format!("/{join}")).status, 401, "a code is good once");
    let pair = cookie.split(';').next().unwrap();
    let mut request = upload("image/jpeg", &photo(0));
    request.head += &format!("Cookie: {pair}\r\n");
    assert_eq!(client.send(&request).json()["photo"], "normal_000.jpg");
    // The browser on this machine has a code of its own.
    let here = running.address.rsplit_once('/').unwrap().1.to_owned();
    assert_eq!(running.client().get(&format!("/join/{here}")).status, 303);
}

/// What a phone's camera reads in the code that the terminal shows.
fn code_read(lines: &[String]) -> String {
    const MODULE_PX: usize = 4;
    let lines: Vec<Vec<char>> = lines.iter().map(|line| line.chars().collect()).collect();
    let is_ink = |x: usize, y: usize| {
        let inks = if y.is_multiple_of(2) {
            ['▀', '█']
        } else {
            ['▄', '█']
        };
        inks.contains(&lines[y / 2][x])
    };
    let (width, height) = (lines[0].len() * MODULE_PX, lines.len() * 2 * MODULE_PX);
    let level = |x: usize, y: usize| -> u8 { if is_ink(x / MODULE_PX, y / MODULE_PX) { 0 } else { 255 } };
    let mut picture = rqrr::PreparedImage::prepare_from_greyscale(width, height, level);
    picture.detect_grids()[0].decode().unwrap().1
}

/// A person's way through the page: watch the dial fill, take one photo back, send one that is refused and one that is taken, finish.
#[test]
fn a_capture_is_followed_and_finished_in_a_browser() {
    let screenshots = common::variable("SCALEPROOF_SCREENSHOTS").map(PathBuf::from);
    let mut browser = Browser::start();
    browser.resize(1280, 800, false);
    let mut running = Running::start(&replay(), &["--fps", "2"]);
    browser.open(&running.address);
    let mut filled = Vec::new();
    while filled.last() != Some(&8) {
        filled.push(
            browser
                .value("document.querySelectorAll('#sectors .ok').length")
                .as_u64()
                .unwrap_or(0),
        );
        if let (Some(folder), Some(&5)) = (&screenshots, filled.last()) {
            browser.wait_for("document.querySelectorAll('#preview polygon').length > 0");
            std::thread::sleep(Duration::from_millis(300));
            browser.screenshot(&folder.join("laptop.png"));
        }
        assert!(filled.len() < 600, "{filled:?}");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(
        filled.is_sorted() && filled.iter().collect::<BTreeSet<_>>().len() >= 4,
        "{filled:?}"
    );
    // The view that is said to come next is the one that was outlined: what is on the dial and in the list is one thing.
    browser.wait_for("document.getElementById('advice').textContent === 'Taken; all views are there'");
    browser.wait_for("document.getElementById('spoken').textContent === 'Taken; all views are there'");
    browser.wait_for("document.querySelectorAll('#preview polygon.whole').length >= 3");
    browser.wait_for(
        "[...document.querySelectorAll('#list img')].filter(i => i.complete && i.naturalWidth > 0).length >= 4",
    );

    // By keyboard.
    browser.value("document.getElementById('undo').focus()");
    browser.press_enter();
    browser.wait_for("document.querySelectorAll('#sectors .redo').length === 1");
    browser.wait_for("document.getElementById('dial-title').textContent.includes('Open: 315°.')");
    browser.wait_for("document.querySelectorAll('#sectors .next').length === 1");

    let file = |name: &str, bytes: &[u8]| {
        let path = running.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let rgb = image::load_from_memory(&photo(7)).unwrap().to_rgb8();
    let blurred = file("blurred.jpg", &jpeg(&image::imageops::blur(&rgb, 3.0)));
    let sharp = file("sharp.jpg", &jpeg(&rgb));
    browser.choose_file("#file", &blurred);
    browser.wait_for("document.getElementById('advice').textContent.startsWith('Hold still and let it focus')");
    browser.wait_for("document.querySelector('.meter small').className === 'bad'");
    browser.wait_for("document.getElementById('send').textContent === 'Take a photo'");
    for (width, height, name) in [(390, 844, "phone.png"), (1280, 800, "laptop_refused.png")] {
        browser.resize(width, height, width < 500);
        let is_fitting = browser.value("document.documentElement.scrollWidth <= innerWidth");
        assert_eq!(is_fitting, true, "the page is wider than {width} px");
        let advice = browser
            .value("document.getElementById('advice').getBoundingClientRect().bottom")
            .as_f64()
            .unwrap();
        let button = browser
            .value("document.getElementById('send').getBoundingClientRect().bottom")
            .as_f64()
            .unwrap();
        assert!(
            advice < 260.0 && button < f64::from(height),
            "advice ends at {advice}, the button at {button} of {height} px"
        );
        if let Some(folder) = &screenshots {
            browser.screenshot(&folder.join(name));
        }
    }
    browser.choose_file("#file", &sharp);
    browser.wait_for("document.querySelectorAll('#sectors .ok').length === 8");
    // Whatever can be pressed has a name, and whatever says its state by colour says it in words too.
    let nameless = "[...document.querySelectorAll('button, label, input')].filter(e => !(e.textContent.trim() || e.labels?.length)).length";
    assert_eq!(browser.value(nameless), 0);
    browser.wait_for("[...document.querySelectorAll('#list li.ok b')].every(b => b.textContent.includes('taken'))");

    browser.value("document.getElementById('finish').click()");
    browser.wait_for("document.getElementById('advice').textContent.startsWith('8 of 8 views are there')");
    let (code, lines) = running.ended();
    assert_eq!((code, &lines.last().unwrap()["filled"]), (Some(0), &8.into()));
    let names: Vec<&str> = lines.iter().filter_map(|line| line["photo"].as_str()).collect();
    assert_eq!(
        names.last(),
        Some(&"normal_008.jpg"),
        "the name that was taken back is not given again"
    );
    // The browser itself logs the refusal of the blurred photo (422), and a small image it asked for while its photo was taken back.
    browser.complaints.retain(|complaint| {
        let is_taken_back = complaint.contains("404") && complaint.contains("/photo/");
        !complaint.contains("422") && !complaint.contains("410") && !is_taken_back
    });
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// Whoever opens the page when the source has ended sees the newest image, as those do who watched.
#[test]
fn a_page_opened_after_the_last_frame_shows_it() {
    let running = Running::start(&replay(), &[]);
    wait_for(&mut running.client(), |state| state["source_ended"] == true);
    let mut browser = Browser::start();
    let page = format!("http://{}/", running.host());
    let (name, value) = running.cookie()["Cookie: ".len()..].trim_end().split_once('=').unwrap();
    browser.command(
        "Network.setCookie",
        serde_json::json!({"name": name, "value": value, "url": page}),
    );
    browser.open(&page);
    let is_told = "document.getElementById('advice').textContent === 'Taken; all views are there'";
    let preview = "document.getElementById('preview').textContent";
    let shown = loop {
        let shown = browser.value(&format!("{is_told} ? {preview} : null"));
        if let Some(shown) = shown.as_str() {
            break shown.to_owned();
        }
    };
    assert!(!shown.contains("no "), "there is a photo, and the page says: {shown}");
    browser.wait_for("document.querySelectorAll('#preview polygon.whole').length >= 3");
}

/// Another account of this machine reaches the port, and is a stranger.
#[test]
fn on_this_machine_nobody_gets_in_without_the_code() {
    let mut running = Running::start("upload", &[]);
    let mut stranger = Client::new(&running.host());
    for path in ["/", "/state/0", "/photo/normal_000.jpg", "/page.js", "/join/0"] {
        assert_eq!(stranger.get(path).status, 401, "{path}");
    }
    for request in [post("/finish"), post("/undo"), upload("image/jpeg", &photo(0))] {
        assert_eq!(stranger.send(&request).status, 401, "{}", request.head);
    }
    let mut client = running.client();
    assert_eq!(
        client.send(&upload("image/jpeg", &photo(0))).json()["photo"],
        "normal_000.jpg"
    );
    let (_, join) = running.address.rsplit_once("/join/").unwrap();
    assert_eq!(
        stranger.get(&format!("/join/{join}")).status,
        401,
        "a code is good once"
    );
    client.send(&post("/finish"));
    assert_eq!(running.ended().0, Some(2));
}
