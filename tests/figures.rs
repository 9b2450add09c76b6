//! What a reader takes out of the report: charts as SVG and PDF files that show what the page shows, and the patterns that were on the model.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, chromium, home, pictured, program, read_json, skyline, stderr};
use image::{GrayImage, imageops};
use serde_json::Value;

fn run(command: &str, out: &Path, more: &[&str]) -> Output {
    let mut program = program();
    program
        .arg(command)
        .arg(skyline())
        .args(["--recorded", "--detector", "yolox_nano,deimv2_femto", "--out"])
        .arg(out);
    program.args(more).output().unwrap()
}

fn done(command: &str, out: &Path, more: &[&str]) {
    let output = run(command, out, more);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Where the marks of some kind are and what they say, in the order of the file.
fn marks(svg: &roxmltree::Document, kind: &str, attributes: &[&str]) -> Vec<String> {
    let of_kind = svg.descendants().filter(|n| n.has_tag_name(kind));
    let told = |n: roxmltree::Node| {
        let values: Vec<&str> = attributes
            .iter()
            .filter_map(|a| n.attribute(*a))
            .chain(n.text())
            .collect();
        values.join(" ")
    };
    of_kind.map(told).collect()
}

/// The charts of a section of a page, each as a document of its own.
fn inline(page: &str, label: &str) -> Vec<String> {
    let charts = page
        .split("<svg ")
        .skip(1)
        .filter_map(|rest| rest.split("</svg>").next());
    let own = charts.filter(|chart| chart.contains(&format!("aria-label=\"{label}")));
    own.map(|chart| format!("<svg {chart}</svg>")).collect()
}

/// A chart in shades of grey as the browser shows its SVG and as poppler shows its PDF, at one pixel a CSS pixel.
fn both(folder: &Path, name: &str) -> [GrayImage; 2] {
    let svg = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
    let svg = roxmltree::Document::parse(&svg).unwrap();
    let side = |which: &str| {
        svg.root_element()
            .attribute(which)
            .unwrap()
            .parse::<f64>()
            .unwrap()
            .ceil() as u32
    };
    let (width, height) = (side("width"), side("height"));
    let shot = folder.join("shot.png");
    chromium(&[
        format!("--screenshot={}", shot.display()),
        format!("--window-size={width},{height}"),
        format!("file://{}", folder.join(format!("{name}.svg")).display()),
    ]);
    let browser = image::open(&shot).unwrap().to_luma8();
    std::fs::remove_file(shot).unwrap();
    let pdf = folder.join(format!("{name}.pdf"));
    let pages = pictured(&pdf, &["-png", "-r", "96"], |bytes| {
        image::load_from_memory(bytes).unwrap().to_luma8()
    });
    assert_eq!(pages.len(), 1);
    // Lines fall on other pixels, letters have other hints: what is compared is what a reader sees from a step away.
    [&browser, &pages[0]].map(|image| imageops::resize(image, width / 6, height / 6, imageops::FilterType::Triangle))
}

/// The mean difference in shades of grey, over as many pixels as have ink.
fn off(a: &GrayImage, b: &GrayImage) -> f64 {
    let ink = a.pixels().filter(|p| p.0[0] < 250).count();
    let off = a
        .pixels()
        .zip(b.pixels())
        .map(|(a, b)| f64::from(a.0[0].abs_diff(b.0[0])));
    off.sum::<f64>() / ink as f64
}

#[test]
fn the_charts_are_files_that_look_like_the_page() {
    let out = tempfile::tempdir().unwrap();
    let speed = skyline().join("recorded/speed.json");
    done("score", out.path(), &["--speed", speed.to_str().unwrap()]);
    done("compare", out.path(), &[]);
    let report = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    let comparison = std::fs::read_to_string(out.path().join("comparison.html")).unwrap();
    for (name, page, label, kind, attributes) in [
        (
            "polar",
            &report,
            "Mean confidence by azimuth,",
            "circle",
            &["cx", "cy", "r", "fill"][..],
        ),
        (
            "found_by_confidence",
            &report,
            "Share of photos found",
            "polyline",
            &["points", "stroke"],
        ),
        (
            "precision_recall",
            &report,
            "Precision over recall",
            "polyline",
            &["points", "stroke"],
        ),
        ("reliability", &report, "Share correct", "polyline", &["points"]),
        ("heat_maps", &report, "Mean confidence by azimuth, pitch", "title", &[]),
        ("ap_against_time", &report, "AP at IoU 0.5", "circle", &["cx", "cy"]),
        ("drops", &comparison, "Drop of ", "circle", &["cx", "cy", "fill"]),
    ] {
        let file = format!("figure_{name}");
        let text = std::fs::read_to_string(out.path().join(format!("{file}.svg"))).unwrap();
        let svg = roxmltree::Document::parse(&text).unwrap();
        let shown = inline(page, label);
        let shown = shown.iter().flat_map(|chart| {
            let chart = roxmltree::Document::parse(chart).unwrap();
            marks(&chart, kind, attributes)
        });
        let shown: Vec<String> = shown.collect();
        assert!(!shown.is_empty(), "{name}");
        assert_eq!(marks(&svg, kind, attributes), shown, "{name}");

        let [browser, poppler] = both(out.path(), &file);
        assert_eq!(browser.dimensions(), poppler.dimensions());
        let (alike, upside_down) = (
            off(&browser, &poppler),
            off(&browser, &imageops::flip_vertical(&poppler)),
        );
        println!("{name}: off by {alike:.2} shades of grey, by {upside_down:.2} upside down");
        assert!(
            alike < 10.0 && upside_down > 2.0 * alike,
            "{name}: {alike} and {upside_down}"
        );
        let pdf = lopdf::Document::load(out.path().join(format!("{file}.pdf"))).unwrap();
        let is_font_file = |o: &lopdf::Object| o.as_dict().is_ok_and(|d| d.has(b"FontFile2"));
        assert!(pdf.objects.values().any(is_font_file), "{name} has no font");
    }
    // A figure without its page says what its panels and marks are.
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).unwrap();
    let drops = read("figure_drops.svg");
    for words in [
        "Drop of the hit rate<",
        "Drop of AP@0.5<",
        "Filled: an effect is shown",
        "sign flips by view, joint over the detectors",
    ] {
        assert!(drops.contains(words), "{words}");
    }
    let polar = read("figure_polar.svg");
    for words in ["Distance from the middle: mean confidence", "hollow: not every one"] {
        assert!(polar.contains(words), "{words}");
    }
    // Without times there is no chart of them, and none stays that an earlier run drew.
    done("score", out.path(), &[]);
    assert!(out.path().join("figure_polar.pdf").exists());
    for ending in ["svg", "pdf"] {
        assert!(!out.path().join(format!("figure_ap_against_time.{ending}")).exists());
    }
}

fn random16() -> PathBuf {
    home().join("print_templates/random16.png")
}

#[test]
fn the_report_shows_the_pattern_and_says_what_is_not_known() {
    let out = tempfile::tempdir().unwrap();
    let named = format!("random={}", random16().display());
    done("score", out.path(), &["--pattern", &named, "--tile-mm", "240"]);
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    let bytes = std::fs::read(random16()).unwrap();
    let hash = scaleproof_core::files::sha256_hex(&bytes);
    for words in [
        "random16.png: 16 × 16 cells",
        "a repeat 240 mm wide on the model",
        "print not measured",
        &hash,
    ] {
        assert!(page.contains(words), "{words}");
    }
    // The image on the page is the pattern, cell for cell.
    let start = page.find("alt=\"The pattern of random\"").unwrap();
    let source = page[start..]
        .split("base64,")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    let shown = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, source).unwrap();
    let [shown, file] = [shown, bytes].map(|bytes| image::load_from_memory(&bytes).unwrap().to_rgb8());
    assert!(shown == file);
    let provenance: Value = read_json(&out.path().join("summary.json"))["provenance"]["patterns"].clone();
    assert_eq!(
        (
            &provenance[0]["sha256"],
            &provenance[0]["tile_mm"],
            &provenance[0]["print_delta_e"]
        ),
        (&hash.as_str().into(), &240.0.into(), &Value::Null)
    );

    // No width is given and the pattern has no card; then no pattern is given.
    done("score", out.path(), &["--pattern", &named]);
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("a repeat of unknown width"));
    done("score", out.path(), &[]);
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Not given: the pattern of random.") && !page.contains("The pattern of random\""));

    let other = format!("radnom={}", random16().display());
    let printer = home().join("print_templates/printer.toml");
    for (arguments, words) in [
        (vec!["--pattern", &other], vec!["`radnom`", "normal, random"]),
        (vec!["--pattern", &named, &named], vec!["named twice"]),
        (vec!["--pattern", "random.png"], vec!["has no name", "NAME=FILE"]),
        (vec!["--pattern", "random=none.png"], vec!["none.png"]),
        (
            vec!["--pattern", &named, "--printer", printer.to_str().unwrap()],
            vec!["printer.toml has the printer's lengths but not its colours"],
        ),
    ] {
        assert_refused(&run("score", out.path(), &arguments), &words);
    }
}
