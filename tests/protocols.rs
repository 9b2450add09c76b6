//! Numbers that compare with papers: attack success rates with intervals, AP over IoUs, protocols, and groups by conditions of imported photos.

use crate::common;

use std::path::Path;
use std::process::Output;

use common::{assert_refused, program, read_json, skyline, stderr, stdout};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::statistics::intervals_95;
use scaleproof_detect::Detection;
use scaleproof_score::{Protocol, Thresholds, apricot_ap, rates_as_armory};
use serde_json::Value;

fn run(command: &str, session: &Path, out: &Path, more: &[&str]) -> Output {
    let mut program = program();
    program.arg(command).arg(session).args(["--recorded", "--out"]).arg(out);
    program.args(more).output().unwrap()
}

fn scored(session: &Path, more: &[&str]) -> (tempfile::TempDir, Value, Output) {
    let out = tempfile::tempdir().unwrap();
    let output = run("score", session, out.path(), more);
    assert!(output.status.success(), "{}", stderr(&output));
    let summary = read_json(&out.path().join("summary.json"));
    (out, summary, output)
}

fn result<'a>(summary: &'a Value, detector: &str, variant: &str) -> &'a Value {
    let results = summary["results"].as_array().unwrap();
    results
        .iter()
        .find(|r| r["detector"] == detector && r["variant"] == variant)
        .unwrap()
}

/// Share of simulated comparisons whose interval of the attack success rate holds the true one. The photos of one cluster share how hard it is, and
/// there are two on each side.
fn coverage(rng: &mut Pcg64Mcg, clusters: usize, as_hits: bool, runs: usize) -> f64 {
    let mut simulated = |clusters: usize| -> Vec<[f64; 2]> {
        let mut cluster = || {
            let (ease, loss) = (rng.random_range(0.5..1.0), rng.random_range(0.2..1.0));
            [ease, ease * loss].map(|p: f64| {
                let mut photo = || {
                    let u: f64 = rng.random_range(0.0..1.0);
                    if as_hits {
                        f64::from(u8::from(u < p))
                    } else {
                        p + (u - 0.5) * 0.2
                    }
                };
                photo() + photo()
            })
        };
        (0..clusters).map(|_| cluster()).collect()
    };
    let asr = |data: &[[f64; 2]], times: &dyn Fn(usize) -> f64| {
        let sum = |side: usize| -> f64 { data.iter().enumerate().map(|(i, c)| times(i) * c[side]).sum() };
        1.0 - sum(1) / sum(0)
    };
    let truth = asr(&simulated(300_000), &|_| 1.0);
    let held = (0..runs).filter(|_| {
        let data = simulated(clusters);
        let [interval] = intervals_95(clusters, |drawn| [asr(&data, &|i| f64::from(drawn[i]))]);
        interval.is_some_and(|i| (i.low..=i.high).contains(&truth))
    });
    held.count() as f64 / runs as f64
}

#[test]
fn intervals_of_the_attack_success_rate_cover_what_they_claim() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for (clusters, as_hits) in [(16, true), (16, false), (40, false), (96, true)] {
        // 2,000 runs know the share to ±1 %.
        let share = coverage(&mut rng, clusters, as_hits, 2000);
        let what = if as_hits { "hits" } else { "confidence" };
        println!(
            "ASR of {what}, {clusters} clusters: the 95 % interval covers {:.1} %",
            100.0 * share
        );
        assert!((0.94..=0.96).contains(&share), "{clusters} clusters, {what}: {share}");
    }
}

#[test]
fn an_undefined_ratio_widens_its_interval_or_takes_it_away() {
    // A base that is hit in one of six clusters is not drawn at all in a third of the draws.
    let ratio = |hit: &'static [usize]| {
        move |drawn: &[u32]| {
            let base: u32 = hit.iter().map(|i| drawn[*i]).sum();
            [1.0 - 0.5 * f64::from(drawn[0].min(base)) / f64::from(base)]
        }
    };
    assert_eq!(intervals_95(6, ratio(&[0])), [None]);
    let [interval] = intervals_95(6, ratio(&[0, 1, 2, 3, 4]));
    assert!(interval.is_some_and(|i| i.low < 0.9 && i.high == 1.0), "{interval:?}");
}

/// AP@[.5:.95] and average recall (at most 100 detections) that pycocotools 2.0.11 gives for the files of the recorded session, with the
/// variant's photos as `imgIds`: of normal, then of random.
const BY_PYCOCOTOOLS: [(&str, [f64; 4]); 5] = [
    ("yolox_nano", [0.4752475247524752, 0.525, 0.37394114411441143, 0.4625]),
    ("nanodet_m", [0.5212721272127213, 0.55, 0.514018258968754, 0.6]),
    ("fastestdet", [0.5215346534653466, 0.55, 0.42644601603017446, 0.5]),
    ("deimv2_femto", [0.4883168316831683, 0.575, 0.3214586505090138, 0.5375]),
    ("deimv2_atto", [0.5632013201320131, 0.6, 0.4305074257425743, 0.5625]),
];

#[test]
fn averages_over_ious_are_those_of_pycocotools() {
    let (_, summary, _) = scored(&skyline(), &[]);
    for (detector, wanted) in BY_PYCOCOTOOLS {
        let found = ["normal", "random"].map(|variant| {
            let overall = &result(&summary, detector, variant)["overall"];
            ["ap50_95", "mar"].map(|key| overall[key].as_f64().unwrap())
        });
        for (found, wanted) in found.as_flattened().iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-9,
                "{detector}: {found}, pycocotools says {wanted}"
            );
        }
    }
}

/// Hits of yolox_nano are 6 of 8 and 4 of 8: ASR 1 − 4/6. AP is pycocotools'.
#[test]
fn attack_success_rates_by_hand() {
    let (out, summary, output) = scored(&skyline(), &["--all"]);
    let asr = &result(&summary, "yolox_nano", "random")["asr"];
    let near =
        |value: &Value, wanted: f64| assert!((value.as_f64().unwrap() - wanted).abs() < 1e-9, "{value} {wanted}");
    near(&asr["hit_rate"], 1.0 / 3.0);
    near(&asr["ap50"], 1.0 - 0.7158965896589657 / 0.8712871287128713);
    assert!(result(&summary, "yolox_nano", "normal")["asr"].is_null());
    assert!(stdout(&output).contains("  0.25 [0.00, 0.75]  "), "{}", stdout(&output));
    // The same on pairs, with the interval of compare.
    let compared = tempfile::tempdir().unwrap();
    assert!(run("compare", &skyline(), compared.path(), &[]).status.success());
    let page = read_json(&compared.path().join("comparison.json"));
    assert_eq!(page["results"], summary["paired"]);
    let own = |r: &&Value| r["detector"] == "yolox_nano";
    let r = page["results"].as_array().unwrap().iter().find(own).unwrap();
    near(&r["hit_rate"]["asr"], 1.0 / 3.0);
    let (low, high) = (
        &r["hit_rate"]["asr_interval_95"]["low"],
        &r["hit_rate"]["asr_interval_95"]["high"],
    );
    assert!(low.as_f64().unwrap() < 1.0 / 3.0 && high.as_f64().unwrap() > 1.0 / 3.0);
    let csv = std::fs::read_to_string(out.path().join("figures.csv")).unwrap();
    assert!(csv.lines().next().unwrap().ends_with("asr_ap50,asr_mar50,asr_hit_rate"));
}

fn boxes(of: &[(usize, f64, [f64; 4])]) -> Vec<Detection> {
    // Ten thousand pixels to Armory's unit, so that rounding to hundredths of a pixel changes nothing.
    let scaled = |b: &[f64; 4]| BoxPx::new(b[0] * 1e4, b[1] * 1e4, b[2] * 1e4, b[3] * 1e4);
    let detection = |(label, score, b): &(usize, f64, [f64; 4])| Detection::new(*label, *score, scaled(b)).unwrap();
    of.iter().map(detection).collect()
}

/// The published case of Armory's unit tests (`ObjectDetectionRates`): an image with three truths, and the rates that are expected at several
/// thresholds: (IoU, confidence, true positive, misclassification, disappearance, hallucinations).
#[test]
fn armory_s_published_case() {
    let truths = boxes(&[
        (2, 1.0, [0.1, 0.1, 0.7, 0.7]),
        (7, 1.0, [0.3, 0.3, 0.4, 0.4]),
        (6, 1.0, [0.05, 0.05, 0.15, 0.15]),
    ]);
    let detections = boxes(&[
        (2, 0.8, [0.12, 0.09, 0.68, 0.7]),
        (9, 0.6, [0.5, 0.4, 0.9, 0.9]),
        (3, 0.7, [0.05, 0.05, 0.15, 0.15]),
    ]);
    let labels: Vec<Vec<usize>> = truths.iter().map(|t| vec![t.label]).collect();
    let truths: Vec<(&[usize], BoxPx)> = truths
        .iter()
        .zip(&labels)
        .map(|(t, own)| (own.as_slice(), t.box_px))
        .collect();
    let third = 1.0 / 3.0;
    for (iou, confidence, wanted, hallucinations) in [
        (0.5, 0.5, [third, third, third], 1),
        (0.1, 0.5, [third, 2.0 * third, 0.0], 0),
        (0.95, 0.5, [0.0, third, 2.0 * third], 2),
        (0.5, 0.65, [third, third, third], 0),
        (0.5, 0.75, [third, 0.0, 2.0 * third], 0),
        (0.5, 0.85, [0.0, 0.0, 1.0], 0),
    ] {
        let found = rates_as_armory(&truths, &detections, Thresholds { confidence, iou });
        let rates = [found.true_positive, found.misclassification, found.disappearance];
        for (found, wanted) in rates.iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-12,
                "IoU {iou}, confidence {confidence}: {rates:?}"
            );
        }
        assert_eq!(
            found.hallucinations, hallucinations,
            "IoU {iou}, confidence {confidence}"
        );
    }
}

/// Four patches; the target label is found on two of them, twice on one, and elsewhere on a third: recall 1/2 at precision 1, so that six of
/// eleven recalls have precision 1.
#[test]
fn apricot_s_targeted_ap_by_hand() {
    let patch = BoxPx::new(0.0, 0.0, 100.0, 100.0);
    let at = |label, score, x: f64| Detection::new(label, score, BoxPx::new(x, 0.0, x + 100.0, 100.0)).unwrap();
    // An offset of 80 of 100 gives IoU 20/180 > 0.1, one of 85 gives 15/185 < 0.1.
    let images = [
        vec![at(5, 0.9, 0.0), at(5, 0.8, 80.0)],
        vec![at(5, 0.3, 80.0), at(6, 0.9, 0.0)],
        vec![at(5, 0.9, 85.0)],
        vec![],
    ];
    let images: Vec<(BoxPx, &[Detection])> = images.iter().map(|found| (patch, found.as_slice())).collect();
    assert!((apricot_ap(&images, 5, 0.1) - 6.0 / 11.0).abs() < 1e-12);
    assert!((apricot_ap(&images, 6, 0.1) - 3.0 / 11.0).abs() < 1e-12);
    assert_eq!(apricot_ap(&images, 7, 0.1), 0.0);
}

fn table(summary: &Value) -> Vec<Vec<String>> {
    let texts = |row: &Value| {
        row.as_array()
            .unwrap()
            .iter()
            .map(|c| c.as_str().unwrap().to_owned())
            .collect()
    };
    summary["protocol"]["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(texts)
        .collect()
}

/// What a person fills in from `coco_truth.json` and `coco_results_*.json` of the session (pycocotools' AP, hits and labels counted there).
#[test]
fn the_protocols_tables_of_the_stored_session() {
    let texts = |row: &[&str]| row.iter().map(|c| (*c).to_owned()).collect::<Vec<String>>();
    let of = |name: &str| {
        let (out, summary, output) = scored(
            &skyline(),
            &["--protocol", name, "--detector", "yolox_nano,deimv2_femto"],
        );
        (table(&summary), summary, out, output)
    };
    let (dta, ..) = of("dta");
    assert_eq!(dta[0], texts(&["normal", "0.87", "0.58", "0.95", "0.72"]));
    assert_eq!(dta[1], texts(&["random", "0.72", "0.37", "0.64", "0.23"]));
    let (active, ..) = of("active");
    assert_eq!(active[0], texts(&["normal", "87.1", "75.0", "95.0", "75.0"]));
    assert_eq!(active[1], texts(&["random", "71.6", "50.0", "64.4", "0.00"]));
    let (bench, ..) = of("padetbench");
    assert_eq!(
        bench[0],
        texts(&["clean", "entire", "yolox_nano", "0.871", "0.875", ""])
    );
    assert_eq!(
        bench[1],
        texts(&["random", "entire", "yolox_nano", "0.716", "0.875", "0.000"])
    );
    let (armory, ..) = of("armory");
    assert_eq!(armory[1][2..], texts(&["8", "0.70", "0.25", "0.25", "0.25", "0.50"]));
    let (apricot, ..) = of("apricot");
    // Seven of eight photos show a bus where the car is.
    assert_eq!((apricot[3][3].as_str(), apricot[3][5].as_str()), ("bus", "7/8"));
}

#[test]
fn a_protocol_is_named_in_every_output() {
    for protocol in Protocol::ALL {
        let name = protocol.name();
        let (out, summary, output) = scored(&skyline(), &["--protocol", name, "--detector", "yolox_nano"]);
        let read = |file: &str| std::fs::read_to_string(out.path().join(file)).unwrap();
        assert!(stdout(&output).contains(&format!("\nProtocol {name}: ")));
        assert_eq!(
            (&summary["protocol"]["name"], &summary["provenance"]["protocol"]),
            (&name.into(), &name.into())
        );
        assert!(
            summary["definitions"]["protocol"]
                .as_str()
                .unwrap()
                .contains(protocol.source())
        );
        assert!(read("report.html").contains(&format!("<h3>Protocol {name}: ")));
        assert!(read("table.tex").contains(&format!("Protocol: {name}.")));
        assert!(read("protocol.tex").contains(&format!("% Protocol {name}: ")));
        for text in [&stdout(&output), &read("report.html"), &read("protocol.tex")] {
            assert!(text.contains("photos: 8 normal, 8 random"), "{text}");
        }
        assert!(!read("protocol.csv").is_empty());
        for file in ["figures.csv", "photos.csv"] {
            let text = read(file);
            let mut rows = csv::Reader::from_reader(text.as_bytes());
            let at = rows.headers().unwrap().iter().position(|h| h == "protocol").unwrap();
            assert!(rows.records().all(|row| &row.unwrap()[at] == name), "{file}");
        }
        let compared = tempfile::tempdir().unwrap();
        let output = run(
            "compare",
            &skyline(),
            compared.path(),
            &["--protocol", name, "--detector", "yolox_nano", "--all"],
        );
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains(&format!("protocol {name}: {}", protocol.source())));
        for file in ["comparison.html", "comparison.tex", "comparison.json"] {
            let text = std::fs::read_to_string(compared.path().join(file)).unwrap();
            assert!(text.contains(name), "{file} does not name {name}");
        }
        // A later run without a protocol leaves no table of one.
        assert!(
            run("score", &skyline(), out.path(), &["--detector", "yolox_nano"])
                .status
                .success()
        );
        assert!(!out.path().join("protocol.csv").exists() && !out.path().join("protocol.tex").exists());
    }
}

/// The photos of the session with the truth of its report, as a table with conditions: the first half of each texture in rain at 300 lx, the others in
/// the sun.
fn session_with_conditions() -> tempfile::TempDir {
    let (out, _, _) = scored(&skyline(), &[]);
    let truth = read_json(&out.path().join("coco_truth.json"));
    let folder = tempfile::tempdir().unwrap();
    let mut csv = "file,variant,place,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm,weather,lux,benchmark\n".to_owned();
    for (i, (image, box_)) in truth["images"]
        .as_array()
        .unwrap()
        .iter()
        .zip(truth["annotations"].as_array().unwrap())
        .enumerate()
    {
        let file = image["file_name"].as_str().unwrap();
        std::fs::copy(skyline().join(file), folder.path().join(file)).unwrap();
        let b: Vec<f64> = box_["bbox"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect();
        let rain = i % 8 < 4;
        csv += &format!(
            "{file},{},yard,{},{},{},{},{},{},{},{},{},{}\n",
            image["variant"].as_str().unwrap(),
            b[0],
            b[1],
            b[0] + b[2],
            b[1] + b[3],
            image["azimuth_deg"],
            image["pitch_deg"],
            image["distance_mm"],
            if rain { "rain" } else { "sun" },
            if rain { 300 } else { 12000 + i },
            if rain { "weather" } else { "" },
        );
    }
    std::fs::write(folder.path().join("truth.csv"), csv).unwrap();
    std::fs::copy(skyline().join("scene.toml"), folder.path().join("scene.toml")).unwrap();
    let recorded = folder.path().join("recorded");
    std::fs::create_dir(&recorded).unwrap();
    for entry in std::fs::read_dir(skyline().join("recorded")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, recorded.join(path.file_name().unwrap())).unwrap();
    }
    let truth = folder.path().join("truth.csv");
    let output = program()
        .args(["session", "import"])
        .arg(truth)
        .arg("--photos")
        .arg(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("benchmark, lux, weather"),
        "{}",
        stdout(&output)
    );
    folder
}

#[test]
fn conditions_of_imported_photos_are_groups_and_fill_padetbench_s_columns() {
    let folder = session_with_conditions();
    let (out, summary, _) = scored(
        folder.path(),
        &[
            "--group-by",
            "weather,lux:10000,theta",
            "--protocol",
            "padetbench",
            "--detector",
            "yolox_nano",
        ],
    );
    // Hits counted from the lines of photos.csv, which know nothing of groups.
    let text = std::fs::read_to_string(out.path().join("photos.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headers = reader.headers().unwrap().clone();
    let at = |name: &str| headers.iter().position(|h| h == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let hits = |variant: &str, weather: &str| {
        let own = |row: &&csv::StringRecord| {
            &row[at("variant")] == variant && row[at("conditions")].contains(&format!("weather={weather}"))
        };
        let own: Vec<_> = rows.iter().filter(own).collect();
        (
            own.iter().filter(|row| &row[at("verdict")] != "missed").count(),
            own.len(),
        )
    };
    for variant in ["normal", "random"] {
        let groups = result(&summary, "yolox_nano", variant)["conditions"]
            .as_array()
            .unwrap();
        let named: Vec<(&str, &str)> = groups
            .iter()
            .map(|g| (g["condition"].as_str().unwrap(), g["value"].as_str().unwrap()))
            .collect();
        assert_eq!(
            named,
            [
                ("weather", "rain"),
                ("weather", "sun"),
                ("lux", "0 to 10000"),
                ("lux", "10000 to 20000"),
                ("theta", "75")
            ]
        );
        for (group, weather) in groups.iter().zip(["rain", "sun"]) {
            let figures = &group["figures"];
            let found = (
                figures["hit_rate"]["count"].as_u64().unwrap(),
                figures["photos"].as_u64().unwrap(),
            );
            let (count, photos) = hits(variant, weather);
            assert_eq!(found, (count as u64, photos as u64), "{variant} {weather}");
        }
    }
    let (random, normal) = (hits("random", "rain"), hits("normal", "rain"));
    let asr = &result(&summary, "yolox_nano", "random")["conditions"][0]["asr"]["hit_rate"];
    assert!((asr.as_f64().unwrap() - (1.0 - random.0 as f64 / normal.0 as f64)).abs() < 1e-12);
    let parts: Vec<String> = table(&summary).iter().map(|row| row[1].clone()).collect();
    assert_eq!(
        parts[..7],
        [
            "entire",
            "weather",
            "weather=rain",
            "weather=sun",
            "lux=0 to 10000",
            "lux=10000 to 20000",
            "theta=75"
        ]
    );
    // The part `weather` holds the photos in rain.
    let rows = table(&summary);
    assert_eq!(rows[1][3..], rows[2][3..]);
    // The report's truth file carries the conditions on.
    let truth = read_json(&out.path().join("coco_truth.json"));
    assert_eq!(
        (&truth["images"][0]["weather"], &truth["images"][0]["lux"]),
        (&"rain".into(), &"300".into())
    );
}

#[test]
fn what_cannot_be_grouped_or_followed_is_one_sentence() {
    let out = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (
            vec!["--protocol", "coco"],
            vec!["no protocol `coco`", "dta, active, padetbench"],
        ),
        (vec!["--protocol", "dta", "--ap", "voc-11"], vec!["--ap"]),
        (
            vec!["--group-by", "weather"],
            vec!["no photo has the condition `weather`", "azimuth, distance"],
        ),
        (vec!["--group-by", "azimut"], vec!["did you mean azimuth?"]),
        (
            vec!["--group-by", "place:3"],
            vec!["is no number", "`place` has no steps"],
        ),
        (vec!["--group-by", "theta:0"], vec!["`theta:0` names no group"]),
        (vec!["--base", "plain"], vec!["`plain`", "normal, random", "--base"]),
    ] {
        assert_refused(&run("score", &skyline(), out.path(), &arguments), &words);
        assert!(!out.path().join("summary.json").exists());
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(skyline().join("scene.toml"), folder.path().join("scene.toml")).unwrap();
    let file = folder.path().join("truth.csv");
    std::fs::write(&file, "file,x1,y1,x2,y2,azimut_deg\na.jpg,1,1,9,9,0\n").unwrap();
    let import = program()
        .args(["session", "import"])
        .arg(&file)
        .arg("--photos")
        .arg(folder.path())
        .output()
        .unwrap();
    assert_refused(&import, &["line 1", "`azimut_deg` is no column this program reads"]);
}
