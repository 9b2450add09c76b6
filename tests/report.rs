//! The HTML report as a person meets it: rendered by Chromium, offline, at desktop and phone size.

mod common;

use std::path::Path;

use common::{chromium, program, read_json, skyline};
use image::RgbImage;

fn report(out: &Path) -> String {
    let output = program()
        .arg("score")
        .arg(skyline())
        .args(["--recorded", "--out"])
        .arg(out)
        .output()
        .unwrap();
    assert!(output.status.success());
    format!("file://{}", out.join("report.html").display())
}

fn screenshot(url: &str, folder: &Path, width: u32, height: u32) -> RgbImage {
    let path = folder.join(format!("{width}.png"));
    let arguments = [
        format!("--screenshot={}", path.display()),
        format!("--window-size={width},{height}"),
        url.to_owned(),
    ];
    let output = chromium(&arguments);
    assert!(path.exists(), "no screenshot: {}", common::stderr(&output));
    image::open(path).unwrap().to_rgb8()
}

fn count(picture: &RgbImage, [r, g, b]: [u8; 3]) -> usize {
    let near = |a: u8, b: u8| a.abs_diff(b) <= 3;
    picture
        .pixels()
        .filter(|p| near(p.0[0], r) && near(p.0[1], g) && near(p.0[2], b))
        .count()
}

const RED: [u8; 3] = [0xc6, 0x2f, 0x3b];
const GREEN: [u8; 3] = [0x2e, 0x8b, 0x57];

#[test]
fn the_page_shows_tables_charts_and_bordered_photos() {
    let out = tempfile::tempdir().unwrap();
    let url = report(out.path());
    let picture = screenshot(&url, out.path(), 1280, 3000);
    // YOLOX-Nano, the sheet that is open: 10 photos found, 6 missed. A border is about 1000 pixels or more.
    let (red, green) = (count(&picture, RED), count(&picture, GREEN));
    assert!(red > 6_000 && green > 10_000, "{red} red and {green} green pixels");
    let ratio = green as f64 / red as f64;
    assert!((1.2..2.2).contains(&ratio), "ten found to six missed, not {ratio:.2}");
    // The photos themselves are drawn: without them the page looks different where they stand, 16 times 180 × 135 pixels.
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    std::fs::write(
        out.path().join("bare.html"),
        page.replace("data:image/jpeg;base64,", "data:,"),
    )
    .unwrap();
    let bare = screenshot(&url.replace("report.html", "bare.html"), out.path(), 1280, 3000);
    let changed = picture.pixels().zip(bare.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 250_000, "only {changed} pixels come from the embedded photos");
    // The polar charts: the line of `random` in its colour.
    assert!(count(&picture, [0xd1, 0x49, 0x5b]) > 300);
}

#[test]
fn the_page_fits_a_phone() {
    let out = tempfile::tempdir().unwrap();
    let url = report(out.path());
    let picture = screenshot(&url, out.path(), 500, 5000);
    let column = |x: u32| {
        (0..picture.height())
            .filter(|y| picture.get_pixel(x, *y).0 != [255; 3])
            .count()
    };
    // Chromium paints what does not fit up to the window's edge; a page that fits leaves its margin free.
    assert!((494..500).all(|x| column(x) == 0), "something runs over the right edge");
    assert!(count(&picture, GREEN) > 10_000);
}

#[test]
fn the_rendered_numbers_are_those_of_the_summary() {
    let out = tempfile::tempdir().unwrap();
    let url = report(out.path());
    let page = String::from_utf8(chromium(&["--dump-dom".into(), url]).stdout).unwrap();
    let summary = read_json(&out.path().join("summary.json"));
    for r in summary["results"].as_array().unwrap() {
        let overall = &r["overall"];
        let hits = format!("{}/{}", overall["hit_rate"]["count"], overall["photos"]);
        let ap = format!("{:.3}", overall["ap50"].as_f64().unwrap());
        let row = page
            .split("<tr")
            .find(|row| row.contains(&format!("<td>{ap}")) && row.contains(&hits));
        assert!(row.is_some(), "no row with AP {ap} and {hits} hits");
    }
    assert!(page.contains("Recorded detections: no detector ran for this report."));
    for (name, _) in scaleproof::score::Criteria::default().definitions() {
        assert!(
            page.contains(&format!("<dt>{name}</dt>")),
            "{name} is not defined on the page"
        );
    }
}

#[test]
fn the_page_needs_nothing_but_itself() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    for outside in ["http://", "https://", "<script", "<link", "@import", "url("] {
        assert!(!page.contains(outside), "the page contains {outside}");
    }
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
}
