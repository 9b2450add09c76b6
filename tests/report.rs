//! The HTML report as a person meets it: rendered by Chromium, offline, at desktop and phone size; and its LaTeX tables.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{assert_refused, chromium, copy_of_skyline, program, read_json, skyline, stderr, stdout, stored, text};
use image::RgbImage;
use scaleproof_detect::{Manifest, Speed, Speeds};
use serde_json::Value;

fn run(subcommand: &str, out: &Path, more: &[&str]) -> std::process::Output {
    let mut command = program();
    command
        .arg(subcommand)
        .arg(skyline())
        .args(["--recorded", "--out"])
        .arg(out);
    command.args(more).output().unwrap()
}

fn speed_file() -> PathBuf {
    skyline().join("recorded/speed.json")
}

fn report(out: &Path) -> String {
    let speed = speed_file();
    let output = run("score", out, &["--speed", speed.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
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
    assert!(path.exists(), "no screenshot: {}", stderr(&output));
    image::open(path).unwrap().to_rgb8()
}

/// The page after its script ran.
fn dom(url: &str) -> String {
    String::from_utf8(chromium(&["--dump-dom".into(), url.to_owned()]).stdout).unwrap()
}

fn count(picture: &RgbImage, [r, g, b]: [u8; 3]) -> usize {
    let near = |a: u8, b: u8| a.abs_diff(b) <= 3;
    picture
        .pixels()
        .filter(|p| near(p.0[0], r) && near(p.0[1], g) && near(p.0[2], b))
        .count()
}

/// What the bars and the borders of photos give to misclassified and to disappeared models.
const MISSED: [[u8; 3]; 2] = [[0x8d, 0x6f, 0xc4], [0x6d, 0x1a, 0x24]];
const GREEN: [u8; 3] = [0x2e, 0x8b, 0x57];

#[test]
fn the_page_shows_tables_charts_and_bordered_photos() {
    let out = tempfile::tempdir().unwrap();
    let url = report(out.path());
    let picture = screenshot(&url, out.path(), 1280, 6400);
    // YOLOX-Nano, the detector that is chosen first: 10 photos found, 6 missed. A border is about 1000 pixels or more.
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    let unbordered = ["misclassified", "disappeared"]
        .iter()
        .fold(page.clone(), |page, class| {
            assert!(page.contains(&format!("class=\"photo {class}\"")));
            page.replace(&format!("class=\"photo {class}\""), "class=\"photo none\"")
        });
    std::fs::write(out.path().join("unbordered.html"), unbordered).unwrap();
    let unbordered = screenshot(&url.replace("report.html", "unbordered.html"), out.path(), 1280, 6400);
    // Bars have these colours too.
    let missed: Vec<usize> = MISSED
        .map(|colour| count(&picture, colour) - count(&unbordered, colour))
        .into();
    assert!(missed.iter().all(|pixels| *pixels > 1_500), "{missed:?}");
    let (missed, green) = (missed.iter().sum::<usize>(), count(&picture, GREEN));
    assert!(missed > 6_000 && green > 10_000, "{missed} and {green} green pixels");
    let ratio = green as f64 / missed as f64;
    assert!((1.2..2.2).contains(&ratio), "ten found to six missed, not {ratio:.2}");
    // The photos themselves are drawn: without them the page looks different where they stand, 16 times 180 × 135 pixels.
    std::fs::write(
        out.path().join("bare.html"),
        page.replace("data:image/jpeg;base64,", "data:,"),
    )
    .unwrap();
    let bare = screenshot(&url.replace("report.html", "bare.html"), out.path(), 1280, 6400);
    let changed = picture.pixels().zip(bare.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 250_000, "only {changed} pixels come from the embedded photos");
    // The polar charts: the dots of `random` in its colour, and the curves.
    assert!(count(&picture, [0x0f, 0x7f, 0x8c]) > 300);
}

/// Where the elements of a page end, in px from its top, on a screen 1280 px wide; and how many there are.
fn ends(page: &str, folder: &Path, selectors: &[&str]) -> Vec<(f64, usize)> {
    let tell = format!(
        "<script>addEventListener('load', () => document.title = {selectors:?}.map(s => [...document.querySelectorAll(s)])\
         .map(all => Math.max(0, ...all.map(e => e.getBoundingClientRect().bottom + scrollY)) + ' ' + all.length).join(','))</script></body>"
    );
    let path = folder.join("telling.html");
    std::fs::write(&path, page.replace("</body>", &tell)).unwrap();
    let arguments = ["--window-size=1280,1100", "--virtual-time-budget=8000", "--dump-dom"].map(String::from);
    let output = chromium(&[arguments.as_slice(), &[format!("file://{}", path.display())]].concat());
    let dom = String::from_utf8(output.stdout).unwrap();
    let title = dom.split("<title>").nth(1).unwrap().split("</title>").next().unwrap();
    let of = |pair: &str| {
        let (end, count) = pair.split_once(' ').unwrap();
        (end.parse().unwrap(), count.parse().unwrap())
    };
    title.split(',').map(of).collect()
}

/// Verdict, photos side by side and the chart of intervals are there before anyone scrolls, with two textures and six detectors; what is folded is in the page all the same.
#[test]
fn the_first_screen_holds_verdict_photos_and_chart() {
    let out = tempfile::tempdir().unwrap();
    let demo = program().arg("demo").arg("--out").arg(out.path()).output().unwrap();
    assert!(demo.status.success(), "{}", stderr(&demo));
    let mut compare = program();
    compare
        .arg("compare")
        .arg(stored())
        .args(["--recorded", "-o"])
        .arg(out.path());
    assert!(compare.output().unwrap().status.success());
    for (name, pairs) in [("report.html", 6), ("comparison.html", 6)] {
        let page = std::fs::read_to_string(out.path().join(name)).unwrap();
        let found = ends(
            &page,
            out.path(),
            &[".verdict", ".views figure", "svg.intervals", "#result table"],
        );
        let [verdict, views, chart, table] = found[..] else {
            panic!("{found:?}")
        };
        assert_eq!((verdict.1, views.1, chart.1, table.1), (2, pairs, 1, 1), "{name}");
        assert!(
            0.0 < verdict.0 && verdict.0 < views.0 && views.0 < chart.0 && chart.0 <= 1100.0 && chart.0 < table.0,
            "{name}: {found:?}"
        );
        // Each photo of the first screen is drawn from the page itself.
        let first = page.split("<nav>").next().unwrap();
        for part in first.split("href=\"#photo").skip(1) {
            let id = part.split('"').next().unwrap();
            assert!(page.contains(&format!("<image id=\"photo{id}\"")), "{name}: photo {id}");
        }
        assert!(page.contains("<details><summary>How this was decided, and what to write</summary>"));
        assert!(page.contains("Westfall and Young 1993") && page.contains("95 % CI"));
    }
}

/// How wide the page is laid out, and how wide it wants to be, in a frame of a phone's width; what is wider scrolls in itself.
fn widths_on_a_phone(page: &str, folder: &Path) -> String {
    let tell = "<script>addEventListener('load', () => parent.postMessage(\
        `${innerWidth} of ${document.documentElement.scrollWidth}`, '*'))</script></body>";
    std::fs::write(folder.join("telling.html"), page.replace("</body>", tell)).unwrap();
    let frame = "<iframe src='telling.html' style='width:390px;height:2000px'></iframe><p>nothing</p>\
        <script>addEventListener('message', e => document.querySelector('p').textContent = e.data)</script>";
    let path = folder.join("phone.html");
    std::fs::write(&path, frame).unwrap();
    let arguments = ["--virtual-time-budget=8000", "--dump-dom"].map(String::from);
    let output = chromium(&[arguments.as_slice(), &[format!("file://{}", path.display())]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    text.split("<p>")
        .nth(1)
        .unwrap_or_default()
        .split("</p>")
        .next()
        .unwrap_or_default()
        .to_owned()
}

#[test]
fn both_pages_fit_a_phone() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    assert!(run("compare", out.path(), &[]).status.success());
    for name in ["report.html", "comparison.html"] {
        let page = std::fs::read_to_string(out.path().join(name)).unwrap();
        assert_eq!(widths_on_a_phone(&page, out.path()), "390 of 390", "{name}");
    }
    // The measure itself: a page that is too wide is noticed.
    assert_eq!(
        widths_on_a_phone(
            "<meta name=viewport content='width=device-width'><body style='margin:0'><div style='width:500px'>wide</div></body>",
            out.path()
        ),
        "390 of 500"
    );
}

#[test]
fn the_rendered_numbers_are_those_of_the_summary() {
    let out = tempfile::tempdir().unwrap();
    let page = dom(&report(out.path()));
    let summary = read_json(&out.path().join("summary.json"));
    for r in results(&summary) {
        let overall = &r["overall"];
        let hits = format!("{}/{}", overall["hit_rate"]["count"], overall["photos"]);
        let ap = format!("{:.3}", overall["ap50"].as_f64().unwrap());
        let row = page
            .split("<tr")
            .find(|row| row.contains(&format!("<td>{ap}<")) && row.contains(&hits));
        assert!(row.is_some(), "no row with AP {ap} and {hits} hits");
    }
    assert!(page.contains("Recorded detections: no detector ran for this report."));
    for name in summary["definitions"].as_object().unwrap().keys() {
        assert!(
            page.contains(&format!("<dt>{name}</dt>")),
            "{name} is not defined on the page"
        );
    }
}

/// What a reader who has only the report must find in it.
#[test]
fn what_the_figures_rest_on_stands_beside_them() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    let compared = run("compare", out.path(), &["--all"]);
    assert!(compared.status.success(), "{}", stderr(&compared));
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).unwrap();
    let (report, comparison) = (read("report.html"), read("comparison.html"));
    // A model that was found weakly counts as disappeared: the legend says from when on it does not.
    for words in [
        "misclassified: only another class on the model at confidence ≥ 0.5",
        "disappeared: no detection of any class on the model at confidence ≥ 0.5",
    ] {
        assert!(report.contains(words), "{words}");
    }
    // Every one of eight confidences falls: 2 of 2⁸ patterns of signs. Six of eight hits are lost, and all eight of another detector.
    let terminal = stdout(&compared);
    for text in [
        &report,
        &comparison,
        &terminal,
        &read("table.tex"),
        &read("comparison.tex"),
    ] {
        assert!(
            text.contains("Decided by the mean confidence (5 detectors × 1 texture)"),
            "{text}"
        );
        assert!(text.contains("DEIMv2-Femto 416 0.008, 0.031"), "{text}");
    }
    // No hit of eight is no certain 1.00.
    let open = "no interval: all resamples agree; 0 of 8 hit, Wilson up to 0.32";
    for text in [
        &report,
        &comparison,
        &terminal,
        &read("table.tex"),
        &read("comparison.tex"),
    ] {
        assert!(text.contains(open), "{text}");
    }
    // Where and when: the session names its place and camera file, and no photo says when it was taken.
    assert!(report.contains("places: yard; photos taken: not stated; camera file: camera.yaml"));
    let summary = read_json(&out.path().join("summary.json"));
    let session = &summary["provenance"]["sessions"][0];
    assert_eq!(session["places"], serde_json::json!(["yard"]));
    assert!(session["taken"].is_null());
    // A table in a paper's folder keeps the page's cautions.
    for caution in summary["cautions"].as_array().unwrap() {
        for name in ["table.tex", "comparison.tex"] {
            let line = format!("% Note: {}.", caution.as_str().unwrap());
            assert!(read(name).lines().any(|l| l == line), "{name}: {line}");
        }
    }
}

#[test]
fn the_times_of_the_photos_are_a_range() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    for (i, photo) in file["photos"].as_array_mut().unwrap().iter_mut().enumerate() {
        photo["taken"] = format!("2026-05-{:02} 12:30:05", 20 - i).into();
    }
    std::fs::write(&path, file.to_string()).unwrap();
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command.arg("score").arg(session.path()).args(["--recorded", "--out"]);
    assert!(command.arg(out.path()).output().unwrap().status.success());
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("photos taken: 2026-05-05 12:30:05 to 2026-05-20 12:30:05"));
}

/// One rounding everywhere: 5 of 8 is 0.63 and 1 of 8 is 0.13, as a protocol's table has them.
#[test]
fn a_five_behind_the_last_digit_is_rounded_up_on_every_page() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    assert!(run("compare", out.path(), &[]).status.success());
    for (name, said) in [
        ("comparison.html", "0.63 → 0.25, 0.38"),
        ("comparison.tex", "& 0.63 & 0.25 & "),
        ("table.tex", "1/8 & 0.13 ["),
    ] {
        let text = std::fs::read_to_string(out.path().join(name)).unwrap();
        assert!(
            text.contains(said) && !text.contains("0.62 → ") && !text.contains("& 0.12 ["),
            "{name}"
        );
    }
}

/// Paper cannot be scrolled: the rightmost column of every table is on the sheet, of one with long names too.
#[test]
fn nothing_is_cut_off_when_printed() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    for (i, photo) in file["photos"].as_array_mut().unwrap().iter_mut().enumerate() {
        photo["conditions"] = serde_json::json!({"weather": format!("overcast sky after some rain, part {}", i % 8)});
    }
    std::fs::write(&path, file.to_string()).unwrap();
    let out = tempfile::tempdir().unwrap();
    for (command, more) in [("score", &["--group-by", "weather"][..]), ("compare", &[])] {
        let mut program = program();
        program
            .arg(command)
            .arg(session.path())
            .args(["--recorded", "--out"])
            .arg(out.path());
        let output = program.args(more).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    }
    for name in ["report", "comparison"] {
        let [html, pdf] = ["html", "pdf"].map(|ending| out.path().join(format!("{name}.{ending}")));
        chromium(&[
            format!("--print-to-pdf={}", pdf.display()),
            "--no-pdf-header-footer".to_owned(),
            format!("file://{}", html.display()),
        ]);
        let printed = Command::new("pdftotext")
            .args(["-bbox"])
            .arg(&pdf)
            .arg("-")
            .output()
            .unwrap();
        let text = String::from_utf8(printed.stdout).unwrap();
        let words: Vec<&str> = text.lines().filter(|l| l.contains("<word")).collect();
        let right = |line: &str| {
            line.split("xMax=\"")
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .parse::<f64>()
                .unwrap()
        };
        // A4 is 595 points wide, of which 40 are margin.
        let widest = words.iter().map(|line| right(line)).fold(0.0, f64::max);
        assert!(
            words.len() > 500 && widest < 557.0,
            "{name}: {widest} of {} words",
            words.len()
        );
    }
    // What is beyond the sheet is not in the file: every cell of the condition's table is, and the headline's last column.
    let text = Command::new("pdftotext")
        .arg(out.path().join("report.pdf"))
        .arg("-")
        .output()
        .unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    let printed = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    let is_number = |rest: &&str| rest.starts_with(|c: char| c.is_ascii_digit() || c == '−');
    let cells = [&printed, &page].map(|text| text.split("ASR ").skip(1).filter(is_number).count());
    assert!(cells[0] == cells[1] && cells[1] > 20, "{cells:?}");
}

fn results(summary: &Value) -> &Vec<Value> {
    summary["results"].as_array().unwrap()
}

/// What has a title with these words in it: the title, and the marks.
fn groups<'a>(page: &'a roxmltree::Document, words: &str) -> Vec<(String, Vec<roxmltree::Node<'a, 'a>>)> {
    let titled = page.descendants().filter_map(|node| {
        let title = node.children().find(|n| n.has_tag_name("title"))?.text()?;
        let marks = if node.has_tag_name("g") {
            node.children().collect()
        } else {
            vec![node]
        };
        Some((title.to_owned(), marks))
    });
    titled.filter(|(title, _)| title.contains(words)).collect()
}

/// All drawings of the page as one XML document.
fn drawings(page: &str) -> String {
    let parts = page
        .split("<svg")
        .skip(1)
        .filter_map(|rest| rest.split("</svg>").next());
    let drawn = parts.filter(|p| !p.contains("<use") && !p.contains("<image"));
    format!(
        "<all>{}</all>",
        drawn.map(|p| format!("<svg{p}</svg>")).collect::<String>()
    )
}

fn attribute(node: &roxmltree::Node, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

#[test]
fn every_mark_of_the_charts_is_where_its_number_is() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    let summary = read_json(&out.path().join("summary.json"));
    let text = drawings(&std::fs::read_to_string(out.path().join("report.html")).unwrap());
    let page = roxmltree::Document::parse(&text).unwrap();

    // Reliability: nine bins a detector; the dot's height is the share correct on a square of 180.
    let diagrams = summary["reliability"].as_array().unwrap();
    let bins = diagrams.iter().flat_map(|r| r["bins"].as_array().unwrap());
    let filled: Vec<&Value> = bins.filter(|b| b["detections"] != 0).collect();
    let marks = groups(&page, " correct (");
    assert!(marks.len() == filled.len() && filled.len() > 20, "{} bars", marks.len());
    for ((title, marks), bin) in marks.iter().zip(filled) {
        let dot = marks.iter().find(|n| n.has_tag_name("circle")).unwrap();
        let rate = bin["correct"]["rate"].as_f64().unwrap();
        let confidence = bin["mean_confidence"].as_f64().unwrap();
        assert!((attribute(dot, "cy") - (1.0 - rate) * 180.0).abs() < 0.06, "{title}");
        assert!((attribute(dot, "cx") - confidence * 180.0).abs() < 0.06, "{title}");
    }

    // Heat maps: a cell for every bin, its number and its shade.
    let cells = groups(&page, " mm: mean confidence ");
    assert_eq!(
        cells.len(),
        results(&summary)
            .iter()
            .map(|r| r["cells"].as_array().unwrap().len())
            .sum::<usize>()
    );
    let mut darkness = Vec::new();
    for ((title, marks), cell) in cells
        .iter()
        .zip(results(&summary).iter().flat_map(|r| r["cells"].as_array().unwrap()))
    {
        let confidence = cell["figures"]["mean_confidence"].as_f64().unwrap();
        let text = marks.iter().find(|n| n.has_tag_name("text")).unwrap().text().unwrap();
        assert_eq!(text, format!("{confidence:.2}"), "{title}");
        let fill = marks.iter().find_map(|n| n.attribute("fill")).unwrap();
        darkness.push((confidence, u8::from_str_radix(&fill[1..3], 16).unwrap()));
    }
    darkness.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(
        darkness.windows(2).all(|w| w[0].1 >= w[1].1),
        "darker is more: {darkness:?}"
    );

    // AP against time: two textures a detector, at the AP on a height of 250 and at one x for both.
    let marks = groups(&page, " ms");
    assert_eq!(marks.len(), 10);
    for r in results(&summary) {
        let head = format!(
            "{}, {}",
            r["detector"].as_str().unwrap(),
            r["variant"].as_str().unwrap()
        );
        let (_, marks) = marks.iter().find(|(title, _)| title.starts_with(&head)).unwrap();
        let ap = r["overall"]["ap50"].as_f64().unwrap();
        match marks.iter().find(|n| n.has_tag_name("circle")) {
            Some(dot) => assert!((attribute(dot, "cy") - (1.0 - ap) * 250.0).abs() < 0.06, "{head}"),
            None => assert_eq!(r["variant"], "random"),
        }
    }
}

/// (detector, texture, outcome, file) of the cards that are not hidden, in their order.
fn shown(page: &str) -> Vec<[String; 4]> {
    let cards = page.split("<figure class=\"photo ").skip(1);
    let visible = cards.filter(|card| !card.split('>').next().unwrap().contains(" hidden"));
    visible
        .map(|card| {
            let key = |name: &str| {
                card.split(&format!("data-{name}=\""))
                    .nth(1)
                    .unwrap()
                    .split('"')
                    .next()
                    .unwrap()
                    .to_owned()
            };
            let file = card
                .split("<small class=\"note\">")
                .nth(1)
                .unwrap()
                .split('<')
                .next()
                .unwrap();
            [key("detector"), key("variant"), key("outcome"), file.to_owned()]
        })
        .collect()
}

#[test]
fn the_photos_are_sorted_filtered_and_enlarged() {
    let out = tempfile::tempdir().unwrap();
    let url = report(out.path());
    // As written, and so without scripts: every photo of every detector.
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert_eq!(shown(&page).len(), 80);
    assert!(
        page.contains("<form id=\"filters\" hidden"),
        "controls that do nothing are not shown"
    );
    // With scripts: one detector, the missed before the found.
    let first = shown(&dom(&url));
    assert!(first.len() == 16 && first.iter().all(|[detector, ..]| detector == "yolox_nano"));
    let outcomes: Vec<bool> = first
        .iter()
        .map(|[_, _, outcome, _]| outcome.starts_with("found"))
        .collect();
    assert!(outcomes.is_sorted(), "worst first: {first:?}");
    // Filtered by texture and outcome, against the summary's counts.
    let summary = read_json(&out.path().join("summary.json"));
    let disappeared = |r: &&Value| r["variant"] == "random";
    let wanted: u64 = results(&summary)
        .iter()
        .filter(disappeared)
        .map(|r| r["overall"]["disappearance_rate"]["count"].as_u64().unwrap())
        .sum();
    let found = shown(&dom(&format!("{url}#variant=random&outcome=disappeared")));
    assert_eq!(found.len() as u64, wanted);
    assert!(
        found
            .iter()
            .all(|[_, variant, outcome, _]| variant == "random" && outcome == "disappeared")
    );
    // By azimuth and direction: normal beside random.
    let left = dom(&format!("{url}#detector=fastestdet&order=direction"));
    let files: Vec<String> = shown(&left).into_iter().map(|[.., file]| file).collect();
    assert_eq!(
        files[..4],
        ["normal_000.jpg", "random_008.jpg", "normal_001.jpg", "random_009.jpg"]
    );
    assert_eq!(
        shown(&dom(&format!("{url}#azimuth=90"))).len(),
        10,
        "two photos, five detectors"
    );
    // Enlarged, with truth, detections and tags.
    let enlarged = dom(&format!("{url}#detector=yolox_nano&enlarge=0"));
    let dialog = enlarged
        .split("<dialog")
        .nth(1)
        .unwrap()
        .split("</dialog>")
        .next()
        .unwrap();
    for part in [
        " open",
        "href=\"#photo1\"",
        "href=\"#tags1\"",
        ">truth</text>",
        ">bus 0.63</text>",
    ] {
        assert!(dialog.contains(part), "{part} is not in {dialog}");
    }
    let tags = page
        .split("<g id=\"tags1\">")
        .nth(1)
        .unwrap()
        .split("</g>")
        .next()
        .unwrap();
    assert!(
        tags.matches("<polygon").count() >= 5,
        "the tags of the first photo: {tags}"
    );
}

#[test]
fn of_many_photos_the_worst_are_shown_and_the_others_counted() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    // 404 found photos, then 6 that every detector that is asked missed; their own truth spares looking for tags, and without a camera nothing is held against it.
    let exact = read_json(&skyline().join("truth.json"));
    let entries = (0..410).map(|i| {
        let original = if i < 404 { "normal_003.jpg" } else { "random_008.jpg" };
        let name = format!("{i:03}_{original}");
        std::fs::hard_link(session.path().join(original), session.path().join(&name)).unwrap();
        let truths = exact["photos"].as_array().unwrap();
        let truth = truths.iter().find(|t| t["file"] == original).unwrap();
        serde_json::json!({"file": name, "variant": &original[..6], "box_xyxy_px": truth["box_xyxy_px"],
            "viewpoint": {"azimuth_deg": 0.8 * f64::from(i), "pitch_deg": 15.0, "distance_mm": 850.0}})
    });
    file["photos"] = entries.collect();
    file.as_object_mut().unwrap().remove("camera");
    std::fs::write(&path, file.to_string()).unwrap();
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command.arg("score").arg(session.path());
    command
        .args(["--recorded", "--detector", "yolox_nano,deimv2_atto", "--out"])
        .arg(out.path());
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Shown are the 400 of 410 photos that the most detectors missed; all are in photos.csv."));
    let cards = shown(&page);
    assert_eq!(cards.len(), 800);
    assert!(
        cards[..12].iter().all(|[_, variant, ..]| variant == "random"),
        "{:?}",
        &cards[..12]
    );
    println!("report.html of 410 photos: {} bytes", page.len());
    assert!(page.len() < 16_000_000, "{} bytes", page.len());
}

#[test]
fn the_page_needs_nothing_but_itself() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    for outside in [
        "http://",
        "https://",
        "<script src",
        "<link",
        "@import",
        "url(",
        "fetch(",
        "import(",
    ] {
        assert!(!page.contains(outside), "the page contains {outside}");
    }
    assert!(page.len() < 4_000_000, "{} bytes", page.len());
    println!("report.html of 16 photos: {} bytes", page.len());
}

#[test]
fn the_same_input_gives_the_same_pages_and_tables() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for out in [a.path(), b.path()] {
        report(out);
        assert!(run("compare", out, &[]).status.success());
    }
    let names: Vec<_> = std::fs::read_dir(a.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    for name in ["report.html", "figure_polar.pdf", "comparison.json", "figure_drops.svg"] {
        assert!(names.iter().any(|n| n == name), "{name}");
    }
    for name in &names {
        let bytes = |folder: &Path| std::fs::read(folder.join(name)).unwrap();
        assert!(bytes(a.path()) == bytes(b.path()), "{} differs", name.display());
    }
}

/// The cells of a table's rows, after checking that TeX will read it as meant: one tabular, as many cells in each row as columns.
fn rows(tex: &str) -> Vec<Vec<String>> {
    let body = tex.split("\\begin{tabular}{").nth(1).unwrap();
    let (columns, body) = body.split_once("}\n").unwrap();
    let body = body.strip_suffix("\\end{tabular}\n").unwrap();
    let rules = ["\\toprule", "\\midrule", "\\bottomrule"];
    let lines = body.lines().filter(|line| !rules.contains(line));
    lines
        .map(|line| {
            let row = line
                .strip_suffix(" \\\\")
                .unwrap_or_else(|| panic!("no end of row: {line}"));
            assert!(!row.starts_with(['[', '*']), "TeX takes this for an argument: {line}");
            let cells: Vec<String> = row
                .replace("\\&", "\u{1}")
                .split('&')
                .map(|c| c.trim().to_owned())
                .collect();
            assert_eq!(cells.len(), columns.len(), "{line}");
            cells
        })
        .collect()
}

/// Sets a table with pdflatex where that is installed, and returns the text of the page.
fn typeset(tex: &str, width: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let document = format!(
        "\\documentclass{{article}}\\usepackage{{booktabs}}\\usepackage[landscape,textwidth={width}]{{geometry}}\n\
         \\begin{{document}}\\footnotesize\\noindent\n{tex}\\end{{document}}\n"
    );
    std::fs::write(folder.path().join("t.tex"), document).unwrap();
    let arguments = ["-interaction=nonstopmode", "-halt-on-error", "t.tex"];
    let output = Command::new("pdflatex")
        .args(arguments)
        .current_dir(&folder)
        .output()
        .ok()?;
    let log = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && !log.contains("Overfull"), "{log}");
    let text = Command::new("pdftotext")
        .args(["-layout", "t.pdf", "-"])
        .current_dir(&folder)
        .output()
        .ok()?;
    Some(String::from_utf8(text.stdout).unwrap())
}

/// Widths of the characters 32 to 126 of Times Roman, thousandths of the size (Adobe's font metrics, as reportlab has them). Bold digits are as wide.
#[rustfmt::skip]
const TIMES: [u16; 95] = [
    250, 333, 408, 500, 500, 833, 778, 180, 333, 333, 500, 564, 250, 333, 250, 278, 500, 500, 500, 500, 500, 500, 500, 500, 500, 500, 278, 278, 564, 564, 564, 444,
    921, 722, 667, 667, 722, 611, 556, 722, 722, 333, 389, 722, 611, 889, 722, 722, 556, 722, 667, 556, 611, 722, 722, 944, 722, 722, 611, 333, 278, 333, 469, 500,
    333, 444, 500, 444, 500, 444, 333, 500, 500, 278, 278, 500, 278, 778, 500, 500, 500, 500, 333, 389, 278, 500, 500, 722, 500, 500, 444, 480, 200, 480, 541,
];

/// Width of a cell in points, set in Times of 8 pt, as a paper's `\\footnotesize` is, or of 7 pt (`\\scriptsize`).
fn times_pt(cell: &str) -> f64 {
    let size = if cell.contains("\\scriptsize") { 7.0 } else { 8.0 };
    let signs = [
        ("\\scriptsize ", ""),
        ("\\textbf", ""),
        ("\\emph", ""),
        ("\\Downarrow", "⇓"),
        ("\\downarrow", "↓"),
        ("\\uparrow", "↑"),
        ("\\times", "×"),
        ("$-", "−"),
        ("$<$", "−"),
        ("\\,", " "),
    ];
    let plain = signs
        .iter()
        .fold(cell.to_owned(), |text, (tex, sign)| text.replace(tex, sign));
    let width = |c: char| match c {
        '⇓' => 611,
        '↓' | '↑' => 500,
        '−' => 778,
        '×' => 1222,
        '$' | '{' | '}' | '\\' => 0,
        other => usize::from(TIMES[other as usize - 32]),
    };
    plain.chars().map(width).sum::<usize>() as f64 * size / 1000.0
}

/// The tables of `comparison.tex`: the sum of the widest cells and of the gaps of 4 pt, and the widest line across.
fn table_widths_pt(tex: &str) -> Vec<[f64; 2]> {
    let tables = tex.split("\\begin{tabular}{").skip(1);
    let of = |table: &str| {
        let (mut columns, mut across): (Vec<f64>, f64) = (Vec::new(), 0.0);
        for line in table.lines().filter_map(|line| line.strip_suffix(" \\\\")) {
            if let Some(text) = line.strip_prefix("\\multicolumn{") {
                across = across.max(times_pt(text.split_once("}{@{}l@{}}").unwrap().1));
                continue;
            }
            for (i, cell) in line.split('&').enumerate() {
                columns.resize(columns.len().max(i + 1), 0.0);
                columns[i] = columns[i].max(times_pt(cell.trim()));
            }
        }
        [columns.iter().sum::<f64>() + 4.0 * (columns.len() - 1) as f64, across]
    };
    tables.map(of).collect()
}

/// One column of CVPR's two is 237.13 pt wide; a detector of a user has a title of any length.
#[test]
fn the_tables_of_a_comparison_fit_one_column_of_a_paper_of_two() {
    let out = tempfile::tempdir().unwrap();
    let [report, compared] = ["report", "compared"].map(|name| out.path().join(name));
    let arguments = ["--recorded", "-o"];
    let scored = common::run(&[&["score", text(&skyline())][..], &arguments, &[text(&report)]].concat());
    assert!(scored.status.success(), "{}", stderr(&scored));
    let results = report.join("coco_results_deimv2_femto.json");
    let own = format!("a_detector_of_our_own_640_best={}", results.display());
    let images = report.join("coco_truth.json");
    let more = [
        "--results",
        &own,
        "--images",
        text(&images),
        "--recorded",
        "-o",
        text(&compared),
    ];
    let output = common::run(&[&["compare", text(&skyline())][..], &more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let tex = std::fs::read_to_string(compared.join("comparison.tex")).unwrap();
    assert!(
        tex.contains("{a\\_detector\\_of\\_our\\_own\\_640\\_best} \\\\\n & 0.72 & 0.23"),
        "{tex}"
    );
    // The widest figures that a row of the mean confidence may have: a rise that is shown.
    let widest =
        "DEIMv2-Femto 416 & 0.38 & 0.75 & \\textbf{$-0.38$} [$-0.55$, $-0.10$] & $<$0.001 & $\\Downarrow$ \\\\";
    let femto = tex.lines().find(|line| line.starts_with("DEIMv2-Femto")).unwrap();
    for tex in [&tex, &tex.replacen(femto, widest, 1)] {
        let widths = table_widths_pt(tex);
        assert_eq!(widths.len(), 3);
        assert!(
            widths.iter().flatten().all(|pt| (100.0..237.13).contains(pt)),
            "{widths:?}"
        );
    }
    typeset(&tex, "237.13pt");
}

#[test]
fn the_latex_tables_have_the_summary_s_numbers_and_typeset() {
    let out = tempfile::tempdir().unwrap();
    report(out.path());
    assert!(run("compare", out.path(), &[]).status.success());
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).unwrap();
    let summary = read_json(&out.path().join("summary.json"));
    let table = rows(&read("table.tex"));
    assert_eq!(table.len(), 11);
    for (row, r) in table[1..].iter().zip(results(&summary)) {
        let (f, rate) = (&r["overall"], &r["overall"]["hit_rate"]);
        let of = |v: &Value, name: &str| v[name].as_f64().unwrap();
        assert_eq!(row[3], format!("{:.3}", of(f, "ap50")));
        assert_eq!(row[5], format!("{}/{}", rate["count"], f["photos"]));
        assert_eq!(
            row[6],
            format!(
                "{:.2} [{:.2}, {:.2}]",
                of(rate, "rate") + 1e-9,
                of(rate, "low"),
                of(rate, "high")
            )
        );
        assert_eq!(row[4].is_empty(), r["variant"] == "normal");
    }
    // A table for each endpoint, with the rows of the JSON: its numbers, and p where there is one.
    let tex = read("comparison.tex");
    let tables: Vec<&str> = tex
        .split("% Mean confidence\n")
        .nth(1)
        .unwrap()
        .split("\\begin{tabular}")
        .skip(1)
        .collect();
    let json = read_json(&out.path().join("comparison.json"));
    // Two of five detectors are shown to lose confidence and hits; AP is not tested.
    let bold: Vec<usize> = tables.iter().map(|table| table.matches("textbf").count()).collect();
    assert_eq!(bold, [2, 2, 0]);
    for r in results(&json) {
        let two = |v: &Value| format!("{:.2}", v.as_f64().unwrap() + 1e-9);
        let three = |v: &Value| format!("{:.3}", v.as_f64().unwrap() + 1e-9);
        let (confidence, hit, ap) = (&r["mean_confidence"], &r["hit_rate"], &r["ap50"]);
        let has = |table: &str, words: String| assert!(table.contains(&words), "{table} lacks {words}");
        for (table, figure) in tables.iter().zip([confidence, hit, ap]) {
            has(
                table,
                format!("& {} & {} & {}", two(&figure["base"]), two(&figure["other"]), ""),
            );
        }
        let word = match r["finding"]["effect"].as_str() {
            Some("hides") => "$\\Downarrow$",
            _ => "--",
        };
        has(
            tables[0],
            format!("& {} & {word} \\\\", three(&r["finding"]["confidence_p"])),
        );
        has(tables[1], format!("& {} \\\\", three(&r["finding"]["hit_rate_p"])));
    }
    for (tex, width) in [(read("table.tex"), "280mm"), (read("comparison.tex"), "237.13pt")] {
        match typeset(&tex, width) {
            Some(text) => assert!(text.contains("DEIMv2-Femto 416") && text.contains("random"), "{text}"),
            None => println!("pdflatex is not here: the tables' structure was checked only"),
        }
    }
}

#[test]
fn a_texture_s_name_cannot_break_the_page_or_the_tables() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let name = r"[50 %] <b>_&#\\{$^~|";
    let text = std::fs::read_to_string(&path)
        .unwrap()
        .replace("\"random\"", &format!("\"{name}\""));
    std::fs::write(&path, text).unwrap();
    let out = tempfile::tempdir().unwrap();
    let arguments = ["--recorded", "--detector", "yolox_nano", "--out"];
    let output = program()
        .arg("score")
        .arg(session.path())
        .args(arguments)
        .arg(out.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let tex = std::fs::read_to_string(out.path().join("table.tex")).unwrap();
    assert_eq!(
        rows(&tex)[2][1].replace('\u{1}', "\\&"),
        r"{[}50 \%] \textless{}b\textgreater{}\_\&\#\textbackslash{}\{\$\textasciicircum{}\textasciitilde{}\textbar{}"
    );
    typeset(&tex, "280mm");
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(!page.contains("<b>_") && page.contains("&lt;b&gt;_&amp;"));
}

#[test]
fn times_of_other_weights_and_files_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("speed.json");
    let out = folder.path().join("out");
    let good: Speeds = serde_json::from_str(&std::fs::read_to_string(speed_file()).unwrap()).unwrap();
    let refused = |content: &str, words: &[&str]| {
        std::fs::write(&file, content).unwrap();
        assert_refused(&run("score", &out, &["--speed", file.to_str().unwrap()]), words);
        assert!(!out.exists(), "nothing is written");
    };
    let changed = |change: fn(&mut Speed)| {
        let mut speeds = good.clone();
        change(&mut speeds.detectors[0]);
        serde_json::to_string(&speeds).unwrap()
    };
    refused(
        &changed(|s| s.weights_sha256 = "00".repeat(32)),
        &["other weights of yolox_nano"],
    );
    refused(
        &changed(|s| s.ms_per_photo = -1.0),
        &["the milliseconds of yolox_nano are no times"],
    );
    refused(
        &changed(|s| s.detector = "nanodet_m".into()),
        &["nanodet_m is in it twice"],
    );
    refused(
        "{}",
        &["is not a file of `scaleproof detectors speed`", "missing field"],
    );
    // Times of a detector that is not scored do not matter.
    let stranger = changed(|s| s.detector = "stranger".into());
    std::fs::write(&file, stranger).unwrap();
    assert!(
        run("score", &out, &["--speed", file.to_str().unwrap()])
            .status
            .success()
    );
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Without times, and not in the chart: 1 detector."));
}

#[test]
fn the_shipped_times_are_of_the_shipped_detectors() {
    let speeds: Speeds = serde_json::from_str(&std::fs::read_to_string(speed_file()).unwrap()).unwrap();
    for manifest in Manifest::all().unwrap() {
        let speed = speeds.find(&manifest.name).unwrap();
        assert_eq!(speed.weights_sha256, manifest.weights.sha256, "{}", manifest.name);
    }
}
