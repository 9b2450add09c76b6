//! What a browser films: by raw requests, and in headless Chromium whose camera plays the stored session.

use crate::capture_page::browser::Browser;
use crate::capture_page::http::{Client, post, upload};
use crate::capture_page::running::Running;
use crate::capture_page::{in_network, jpeg, photo};
use crate::common::{self, HANG, read_json, shared, skyline, stderr};

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use image::RgbImage;
use image::imageops::FilterType;
use serde_json::Value;

fn rgb(bytes: &[u8]) -> RgbImage {
    image::load_from_memory(bytes).unwrap().to_rgb8()
}

/// Sends one picture of a film; status, code, photo, and whether the next should be whole.
fn filmed(client: &mut Client, path: &str, picture: &[u8]) -> (u16, String, Option<String>, bool) {
    let answer = client.send(&upload("image/jpeg", picture).to(path));
    let told = answer.json();
    let text = |key: &str| told[key].as_str().map(str::to_owned);
    let code = text("code").unwrap_or_else(|| text("sentence").unwrap());
    (answer.status, code, text("photo"), told["wants_whole"] == true)
}

#[test]
fn small_pictures_are_judged_as_a_stream_and_only_a_whole_one_of_the_cameras_size_is_taken() {
    let mut running = Running::start("upload", &[]);
    let mut client = running.client();
    let small = jpeg(&image::imageops::resize(
        &rgb(&photo(0)),
        640,
        480,
        FilterType::Triangle,
    ));
    let told: Vec<_> = (0..6)
        .map(|_| filmed(&mut client, "/film/1/preview/100", &small))
        .collect();
    let codes: Vec<&str> = told.iter().map(|(_, code, ..)| code.as_str()).collect();
    assert_eq!(
        codes,
        ["moving", "hold", "hold", "hold", "hold", "hold"],
        "the first has nothing to be compared with"
    );
    let wishes: Vec<bool> = told.iter().map(|(.., wants_whole)| *wants_whole).collect();
    assert_eq!(
        wishes,
        [false, false, false, true, true, true],
        "the fourth that holds is taken"
    );
    assert!(
        told.iter()
            .all(|(status, _, photo, _)| *status == 200 && photo.is_none()),
        "{told:?}"
    );
    assert_eq!(client.send(&post("/shoot")).status, 409, "not by hand either");
    assert_eq!(
        filmed(&mut client, "/film/2/preview/100", &small).0,
        409,
        "one device films at a time"
    );

    // The small ones are compared with the whole one in its pixels.
    let (status, code, name, _) = filmed(&mut client, "/film/1/whole/50", &photo(0));
    assert_eq!(
        (status, code.as_str(), name.as_deref()),
        (200, "accepted", Some("normal_000.jpg"))
    );
    let session = running.session();
    assert_eq!(
        std::fs::read(session.join("normal_000.jpg")).unwrap(),
        photo(0),
        "byte for byte"
    );
    let gates = &read_json(&session.join("normal_000.capture.json"))["gates"];
    assert!(
        gates["moved_px"].as_f64().unwrap() < 0.5 && gates["blur_px"].as_f64().unwrap() < 1.0,
        "{gates}"
    );

    // The first inner and the last outer corner of the views at 0°, 90° and 180°, as OpenCV's projectPoints has them by the pose of truth.json.
    let ground = client.get("/state/0").json()["frame"]["film"]["ground_px"].clone();
    let expected = [
        (0, [454.56, 666.29], [334.17, 761.49]),
        (2, [968.32, 564.34], [1143.58, 582.74]),
        (4, [734.26, 444.75], [768.84, 417.31]),
    ];
    for (sector, inner, outer) in expected {
        let outline = ground[sector].as_array().unwrap();
        for (found, expected) in [(&outline[0], inner), (outline.last().unwrap(), outer)] {
            let [x, y] = [0, 1].map(|i| found[i].as_f64().unwrap() - expected[i]);
            assert!(x.hypot(y) < 0.5, "{sector}: {found}, not {expected:?}");
        }
    }

    // Another view, of another size than the camera file's: nothing may come of it.
    let other = jpeg(&image::imageops::resize(
        &rgb(&photo(1)),
        960,
        720,
        FilterType::Triangle,
    ));
    for _ in 0..6 {
        let answer = client.send(&upload("image/jpeg", &other).to("/film/1/whole/50"));
        let sentence = answer.json()["sentence"].as_str().unwrap().to_owned();
        assert!(
            answer.status == 422 && sentence.contains("960×720") && sentence.contains("1280×960"),
            "{sentence}"
        );
    }
    // A film that moves is not taken, however good each of its frames is.
    for shift in [0, 8, 16, 24, 32] {
        let moved = rgb(&photo(1));
        let moved = RgbImage::from_fn(1280, 960, |x, y| *moved.get_pixel((x + shift).min(1279), y));
        assert_eq!(
            filmed(&mut client, "/film/1/whole/50", &jpeg(&moved)).1,
            "moving",
            "{shift}"
        );
    }
    assert_eq!(
        client
            .send(&upload("image/jpeg", &photo(1)).to("/film/1/sideways/50"))
            .status,
        400
    );
    client.send(&post("/finish"));
    let (_, lines) = running.ended();
    assert_eq!(lines.iter().filter(|line| line["status"] == "accepted").count(), 1);
}

/// The eight plain photos of the stored session one after the other, for 1.6 s each, as Chromium's camera plays them. It takes the levels of a JPEG for
/// those of video, 16 to 235 (ITU-R BT.601), so they are written so.
fn film_of_the_session(file: &Path) {
    let mut film = Vec::new();
    for number in 0..8 {
        let mut frame = rgb(&photo(number));
        frame
            .iter_mut()
            .for_each(|v| *v = (16.0 + f64::from(*v) * 219.0 / 255.0).round() as u8);
        film.extend(jpeg(&frame).repeat(48));
    }
    std::fs::write(file, film).unwrap();
}

/// Lets the page film the stored session until it has every view; the folder of what it made.
fn filmed_session() -> (Running, Vec<Value>) {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("film.mjpeg");
    film_of_the_session(&film);
    // In the network encrypted, as for a phone.
    let is_lan = in_network().is_some();
    let options: &[&str] = if is_lan { &["--lan"] } else { &[] };
    let mut running = Running::start("upload", options);
    let address = if is_lan {
        let said = BufReader::new(running.child.stderr.take().unwrap()).lines();
        let phone = said
            .map(Result::unwrap)
            .find_map(|line| line.strip_prefix("phone: ").map(str::to_owned));
        phone.unwrap()
    } else {
        running.address.clone()
    };
    let mut browser = Browser::start_with(&[
        "--ignore-certificate-errors".to_owned(),
        "--use-fake-ui-for-media-stream".to_owned(),
        "--use-fake-device-for-media-stream".to_owned(),
        format!("--use-file-for-fake-video-capture={}", film.display()),
    ]);
    browser.resize(390, 844, true);
    browser.open(&address);
    browser.wait_for("document.readyState === 'complete' && !document.getElementById('film').hidden");
    browser.value("document.getElementById('film').click()");
    // Over the live picture: every view on the ground, the next one marked, and the tags.
    browser.wait_for(
        "document.querySelectorAll('#preview .ground').length === 8 && document.querySelectorAll('#preview .ground.next').length === 1 \
         && document.querySelectorAll('#preview polygon.whole').length >= 3 && document.getElementById('video').videoWidth === 1280",
    );
    let end = Instant::now() + HANG;
    let screenshots = common::variable("SCALEPROOF_SCREENSHOTS").map(PathBuf::from);
    while browser.value("document.querySelectorAll('#sectors .ok').length") != 8 {
        assert!(Instant::now() < end, "{}", browser.value("document.body.innerText"));
        if let Some(folder) = &screenshots {
            browser.screenshot(&folder.join("film.png"));
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    assert_eq!(
        browser.value("document.documentElement.scrollWidth <= innerWidth"),
        true
    );
    browser.value("document.getElementById('finish').click()");
    browser.wait_for("document.getElementById('advice').textContent.startsWith('8 of 8 views are there')");
    assert_eq!(
        browser.value("document.getElementById('video').srcObject"),
        Value::Null,
        "the camera is off"
    );
    // A preview of a frame that another has replaced.
    browser.complaints.retain(|complaint| !complaint.contains("410"));
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
    let (code, lines) = running.ended();
    assert_eq!(code, Some(0));
    (running, lines)
}

/// What decides a score: the pixels and where the camera stood. Each level is rounded four times on its way (the film's JPEG, video, canvas, the page's
/// JPEG), and colours are halved in resolution: 1.2 to 1.6 levels RMS.
#[test]
fn the_page_films_the_eight_views_by_itself_and_they_are_those_of_the_stored_session() {
    let (running, _) = filmed_session();
    let stored: Vec<(f64, RgbImage)> = read_json(&skyline().join("truth.json"))["photos"].as_array().unwrap()[..8]
        .iter()
        .zip(0..)
        .map(|(truth, number)| (truth["azimuth_deg"].as_f64().unwrap(), rgb(&photo(number))))
        .collect();
    let mut found = Vec::new();
    for number in 0..8 {
        let session = running.session();
        let picture = rgb(&std::fs::read(session.join(format!("normal_{number:03}.jpg"))).unwrap());
        let sidecar = read_json(&session.join(format!("normal_{number:03}.capture.json")));
        let azimuth = sidecar["viewpoint"]["azimuth_deg"].as_f64().unwrap();
        let at = stored.iter().position(|(truth, _)| (truth - azimuth).abs() < 0.1);
        let at = at.unwrap_or_else(|| panic!("filmed at {azimuth}°"));
        let pairs = picture.iter().zip(stored[at].1.iter());
        let squares = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
        let rms = (squares.sum::<f64>() / picture.as_raw().len() as f64).sqrt();
        assert!(rms < 3.0, "{azimuth}°: {rms} levels");
        found.push(at);
    }
    found.sort_unstable();
    assert_eq!(found, [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn a_filmed_session_scores_as_the_stored_one() {
    let weights = shared("detectors").display().to_string();
    let (running, _) = filmed_session();
    // Results, and by detector and azimuth bin whether the plain photo there is hit, and its confidence.
    let scored = |session: &Path, out: &str| {
        let out = running.folder.path().join(out);
        let mut command = common::program();
        command
            .arg("score")
            .arg(session)
            .args(["--detectors", &weights])
            .arg("--out")
            .arg(&out);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let mut looked = BTreeMap::new();
        for row in csv::Reader::from_path(out.join("photos.csv")).unwrap().deserialize() {
            let row: BTreeMap<String, String> = row.unwrap();
            if row["variant"] == "normal" {
                let seen = (
                    row["verdict"].starts_with("found"),
                    row["confidence"].parse().unwrap_or(0.0),
                );
                looked.insert([row["detector"].clone(), row["bin_azimuth_deg"].clone()], seen);
            }
        }
        let results = read_json(&out.join("summary.json"))["results"]
            .as_array()
            .unwrap()
            .clone();
        (results, looked)
    };
    let ((film, filmed), (stored, photographed)) = (scored(&running.session(), "film"), scored(&skyline(), "stored"));
    assert!(film.len() >= 4);
    for result in &film {
        let is_same = |other: &&Value| other["detector"] == result["detector"] && other["variant"] == "normal";
        let other = stored.iter().find(is_same).unwrap();
        let figure = |of: &Value, name: &str| of["overall"][name].as_f64().unwrap();
        let by = figure(result, "mean_confidence") - figure(other, "mean_confidence");
        println!("{}: mean confidence differs by {by:.4}", result["detector"]);
        assert!(by.abs() < 0.02, "{}: {by}", result["detector"]);
    }
    assert!(filmed.keys().eq(photographed.keys()));
    for (place, (is_hit, confidence)) in &photographed {
        let confidence: f64 = *confidence;
        // Within so much of the confidence of a hit, a photo is as good as its film on either side.
        let is_open = (confidence - 0.5).abs() < 0.02;
        assert!(
            is_open || filmed[place].0 == *is_hit,
            "{place:?}: {confidence}, {:?}",
            filmed[place]
        );
    }
}

#[test]
fn without_a_camera_or_a_secure_page_photos_are_sent_instead() {
    let running = Running::start("upload", &[]);
    let mut browser = Browser::start();
    browser.open(&running.address);
    let ready = "document.readyState === 'complete' && !document.getElementById('film').hidden";
    let says = |sentence: &str| format!("document.getElementById('advice').textContent.startsWith('{sentence}')");
    let is_offered = "document.getElementById('advice').textContent.endsWith('. Photos can be sent all the same') \
        && document.getElementById('film').textContent.startsWith('Film') && document.getElementById('video').hidden";
    browser.wait_for(ready);
    browser.value("document.getElementById('film').click()");
    browser.wait_for(is_offered);
    // As on a page that came by http from another machine.
    browser.value("Object.defineProperty(navigator, 'mediaDevices', { value: undefined })");
    browser.value("document.getElementById('film').click()");
    browser.wait_for(&says("Browsers film only on a page with https://"));
    browser.wait_for(is_offered);
    let file = running.folder.path().join("photo.jpg");
    std::fs::write(&file, photo(0)).unwrap();
    browser.choose_file("#file", &file);
    browser.wait_for(&says("Taken; next:"));
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}
