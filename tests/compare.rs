//! `compare`: intervals that cover what they claim, exact tests against hand-computed cases, and pairing.

use crate::common;

use common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr, stdout};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::statistics::{holm, interval_95, mcnemar_p};
use scaleproof_score::{ImageBoxes, average_precision};
use serde_json::Value;

/// Photos of each side in a simulated cluster.
const REPEATS: usize = 2;

/// For each cluster the summed confidence, or the hits, on both sides: photos of one cluster share how hard it is.
fn simulated(rng: &mut Pcg64Mcg, clusters: usize, as_hits: bool) -> Vec<[f64; 2]> {
    let mut cluster = || {
        let ease: f64 = rng.random_range(0.5..1.0);
        let loss: f64 = rng.random_range(0.2..1.0);
        [ease, ease * loss].map(|p| {
            let photo = |_| {
                let u: f64 = rng.random_range(0.0..1.0);
                if as_hits {
                    f64::from(u8::from(u < p))
                } else {
                    (p + (u - 0.5) * 0.2).clamp(0.0, 1.0)
                }
            };
            (0..REPEATS).map(photo).sum()
        })
    };
    (0..clusters).map(|_| cluster()).collect()
}

/// The mean difference a photo, with each cluster counted `times` over.
fn mean_drop(clusters: &[[f64; 2]], times: &[u32]) -> f64 {
    let photos = REPEATS as f64 * f64::from(times.iter().sum::<u32>());
    let sum: f64 = clusters
        .iter()
        .zip(times)
        .map(|(c, t)| f64::from(*t) * (c[0] - c[1]))
        .sum();
    sum / photos
}

/// Share of 1,500 simulated comparisons whose interval holds the true drop.
fn coverage(clusters: usize, as_hits: bool, counted: impl Fn(u32) -> u32) -> f64 {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let big = 300_000;
    let truth = mean_drop(&simulated(&mut rng, big, as_hits), &vec![1; big]);
    let runs = 1500;
    let held = (0..runs).filter(|_| {
        let data = simulated(&mut rng, clusters, as_hits);
        let drop = |times: &[u32]| mean_drop(&data, &times.iter().map(|t| counted(*t)).collect::<Vec<_>>());
        interval_95(clusters, drop).is_some_and(|i| (i.low..=i.high).contains(&truth))
    });
    held.count() as f64 / runs as f64
}

#[test]
fn intervals_cover_what_they_claim() {
    for clusters in [16, 40, 96] {
        for (what, as_hits) in [("hit rate", true), ("mean confidence", false)] {
            let share = coverage(clusters, as_hits, |times| times);
            println!(
                "{clusters} clusters of {REPEATS} pairs, {what}: the 95 % interval covers {:.1} %",
                100.0 * share
            );
            assert!((0.93..=0.97).contains(&share), "{clusters} clusters, {what}: {share}");
        }
    }
    let without_duplicates = coverage(96, false, |times| times.min(1));
    println!(
        "a bootstrap that drops duplicates covers {:.1} %",
        100.0 * without_duplicates
    );
    assert!(
        without_duplicates < 0.90,
        "the simulation cannot tell: {without_duplicates}"
    );
}

/// A photo with its car, found with some confidence, and perhaps a false find.
fn photo(rng: &mut Pcg64Mcg, quality: f64) -> ImageBoxes {
    let car = BoxPx::new(0.0, 0.0, 10.0, 10.0);
    let mut score = |low: f64, high: f64| rng.random_range(low..high);
    let mut detections = Vec::new();
    if score(0.0, 1.0) < quality {
        detections.push((score(0.2, 1.0), car));
    }
    if score(0.0, 1.0) < 0.3 {
        detections.push((score(0.001, 0.8), BoxPx::new(50.0, 0.0, 60.0, 10.0)));
    }
    ImageBoxes {
        truths: vec![car],
        detections,
        ..ImageBoxes::default()
    }
}

#[test]
fn intervals_of_the_ap_difference_cover_too() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let mut sides = |clusters: usize| -> [Vec<ImageBoxes>; 2] {
        let eases: Vec<f64> = (0..clusters).map(|_| rng.random_range(0.6..1.0)).collect();
        [1.0, 0.6].map(|keep| eases.iter().map(|ease| photo(&mut rng, ease * keep)).collect())
    };
    let ap = |images: &[ImageBoxes]| average_precision(images, 0.5).unwrap().ap;
    let drawn = |images: &[ImageBoxes], times: &[u32]| -> Vec<ImageBoxes> {
        images
            .iter()
            .zip(times)
            .flat_map(|(image, t)| vec![image.clone(); *t as usize])
            .collect()
    };
    let big = sides(100_000);
    let truth = ap(&big[0]) - ap(&big[1]);
    let runs = 400;
    let held = (0..runs).filter(|_| {
        let [base, other] = sides(40);
        let interval = interval_95(40, |times| ap(&drawn(&base, times)) - ap(&drawn(&other, times))).unwrap();
        (interval.low..=interval.high).contains(&truth)
    });
    let share = held.count() as f64 / f64::from(runs);
    println!("40 clusters, AP@0.5: the 95 % interval covers {:.1} %", 100.0 * share);
    // 400 runs know the share to ±2.1 %.
    assert!((0.92..=0.98).contains(&share), "{share}");
}

#[test]
fn an_interval_is_not_made_up() {
    let data = |n: usize| move |times: &[u32]| times.iter().take(n / 2).sum::<u32>().into();
    assert_eq!(interval_95(5, data(5)), None, "five clusters are too few");
    assert!(interval_95(6, data(6)).is_some());
    assert_eq!(interval_95(20, |_| 0.25), None, "no spread, no interval");
    assert_eq!(interval_95(40, data(40)), interval_95(40, data(40)));
}

#[test]
fn mcnemar_is_the_binomial_of_the_discordant_pairs() {
    // (hit on the base side alone, on the other alone, two-sided p by hand: 2 · Σ C(n, k) / 2ⁿ)
    let cases = [
        (5, 0, 2.0 / 32.0),
        (6, 0, 2.0 / 64.0),
        (7, 1, 2.0 * (1.0 + 8.0) / 256.0),
        (2, 8, 2.0 * (1.0 + 10.0 + 45.0) / 1024.0),
        (3, 3, 1.0),
        (0, 0, 1.0),
    ];
    for (base, other, wanted) in cases {
        let differences: Vec<i64> = [vec![1; base], vec![-1; other], vec![0; 9]].concat();
        let p = mcnemar_p(&differences);
        assert!(
            (p - wanted).abs() < 1e-12,
            "{base} against {other}: {p}, by hand {wanted}"
        );
    }
    // Three clusters of 2, 2 and 1 hits lost: of 8 sign patterns only ±5 are as far: 2 / 8, where pairs by themselves would give 2 / 32.
    assert!((mcnemar_p(&[2, 2, 1]) - 0.25).abs() < 1e-12);
}

#[test]
fn holm_by_hand() {
    // Sorted 0.01 · 4, 0.015 · 3 = 0.045, 0.03 · 2 = 0.06, then 0.04 · 1, which may not fall below 0.06.
    let found = holm(&[0.03, 0.01, 0.04, 0.015]);
    for (found, wanted) in found.iter().zip([0.06, 0.04, 0.06, 0.045]) {
        assert!((found - wanted).abs() < 1e-12, "{found} is not {wanted}");
    }
    assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
}

fn compare(session: &std::path::Path, out: &std::path::Path, more: &[&str]) -> std::process::Output {
    program()
        .arg("compare")
        .arg(session)
        .args(["--recorded", "--out"])
        .arg(out)
        .args(more)
        .output()
        .unwrap()
}

fn result<'a>(page: &'a Value, detector: &str) -> &'a Value {
    page["results"]
        .as_array()
        .unwrap()
        .iter()
        .find(|r| r["detector"] == detector)
        .unwrap()
}

#[test]
fn the_stored_session_compared() {
    let out = tempfile::tempdir().unwrap();
    let output = compare(&skyline(), out.path(), &["--base", "normal", "--all"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    // 6/8 against 0/8: six discordant pairs, all one way.
    let femto = result(&page, "deimv2_femto");
    assert_eq!((&femto["pairs"], &femto["clusters"]), (&8.into(), &8.into()));
    assert_eq!(femto["hit_rate"]["base_alone"], 6);
    // All eight confidences fall: two of 2⁸ patterns of signs, for whichever detector.
    let finding = &femto["finding"];
    assert_eq!(
        (&finding["effect"], &finding["confidence_p"]),
        (&"hides".into(), &(2.0 / 256.0).into())
    );
    assert_eq!(finding["in_places_like_these"]["places_missing"], 5);
    // One that falls from 0.58 to 0.37 shows nothing with these eight photos, and says how much would have been.
    let open = &result(&page, "yolox_nano")["finding"];
    assert_eq!(
        (&open["effect"], &open["in_places_like_these"]),
        (&"nothing_shown".into(), &Value::Null)
    );
    let from = open["drop_shown_from"].as_f64().unwrap();
    assert!(
        stdout(&output).contains(&format!(
            "a drop of {from:.2} would have been shown with a chance of 0.8"
        )),
        "{}",
        stdout(&output)
    );
    assert_eq!(page["ap_definition"], "coco-101");
    assert_eq!(
        (&page["box_labels"]["nanodet_m"], &page["box_labels"]["yolox_nano"]),
        (&"all".into(), &"best".into())
    );
    assert!(stdout(&output).contains("all (nanodet_m)"), "{}", stdout(&output));
    // The same figures as `score`, since every photo has its partner.
    assert!(
        (result(&page, "yolox_nano")["ap50"]["drop"].as_f64().unwrap() - (0.8712871287128713 - 0.7158965896589657))
            .abs()
            < 1e-9
    );
    // One photo a bin has no interval in the bin.
    for bin in femto["azimuth_bins"].as_array().unwrap() {
        assert_eq!((&bin["pairs"], &bin["hits"]["interval_95"]), (&1.into(), &Value::Null));
    }
    let again = tempfile::tempdir().unwrap();
    let printed = compare(&skyline(), again.path(), &["--json"]);
    let bytes = |folder: &tempfile::TempDir| std::fs::read(folder.path().join("comparison.json")).unwrap();
    assert!(
        bytes(&out) == bytes(&again) && printed.stdout == bytes(&out),
        "not the same bytes"
    );
}

#[test]
fn photos_without_a_partner_are_listed_and_in_no_difference() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    let photos = file["photos"].as_array_mut().unwrap();
    photos.retain(|p| p["file"] != "random_008.jpg");
    photos[3]["place"] = "garage".into();
    std::fs::write(&path, file.to_string()).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = compare(session.path(), out.path(), &["--ap", "yolov5-ramp"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    let unpaired: Vec<&str> = page["unpaired"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["file"].as_str().unwrap())
        .collect();
    assert_eq!(unpaired.len(), 3, "{unpaired:?}");
    assert!(
        unpaired.contains(&"normal_000.jpg") && unpaired.contains(&"normal_003.jpg"),
        "{unpaired:?}"
    );
    assert_eq!(
        (&page["results"][0]["pairs"], &page["ap_definition"]),
        (&6.into(), &"yolov5-ramp".into())
    );
    assert!(stderr(&output).contains("not compared: "), "{}", stderr(&output));
}

#[test]
fn a_comparison_speaks_of_the_base_that_was_named() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("\"normal\"", "\"plain\"")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = compare(session.path(), out.path(), &["--base", "plain"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!stderr(&output).contains("normal"), "{}", stderr(&output));
    for name in ["comparison.html", "comparison.json", "comparison.tex"] {
        let text = std::fs::read_to_string(out.path().join(name)).unwrap();
        assert!(!text.contains("“normal”"), "{name}");
    }
}

#[test]
fn what_cannot_be_compared_or_planned_is_one_sentence() {
    let out = tempfile::tempdir().unwrap();
    assert_refused(
        &compare(&skyline(), out.path(), &["--base", "plain"]),
        &["`plain`", "normal, random"],
    );
    assert_refused(
        &compare(&skyline(), out.path(), &["--ap", "map"]),
        &["`map`", "coco-101"],
    );
    assert!(!out.path().join("comparison.json").exists());
}
