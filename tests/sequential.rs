//! `compare --sequential` and sealed plans: error rates by simulation, wealth by hand, and every tampering found.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common;

use common::{assert_refused, copy_of_skyline, home, program, read_json, skyline, stderr, stdout};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_core::statistics::{Sequence, Shown, mcnemar_p};
use serde_json::Value;

/// Experiments behind each error rate.
const EXPERIMENTS: usize = 5000;
/// Looks of each: 25 rounds of eight directions.
const LOOKS: usize = 200;

fn after(numbers: &[f64], least: Option<f64>) -> Sequence {
    let mut sequence = Sequence::new(1, least);
    numbers.iter().for_each(|number| sequence.see(0, *number));
    sequence
}

/// The wealth spread evenly over all rates λ, after `n` ones, is ∫ (1 + λ)ⁿ dλ from 0 to 1 = (2ⁿ⁺¹ − 1) / (n + 1): 31.9 after seven, 56.8 after eight, and 40 is enough.
#[test]
fn eight_ones_in_a_row_are_enough_and_seven_are_not() {
    for (n, wealth) in [(1, 1.5), (7, 255.0 / 8.0), (8, 511.0 / 9.0), (10, 2047.0 / 11.0)] {
        let found = 10_f64.powf(after(&vec![1.0; n], None).log10_for_above());
        assert!(
            (found / wealth - 1.0).abs() < 0.005,
            "{n} ones: {found}, by hand {wealth}"
        );
    }
    assert_eq!(after(&[1.0; 7], None).shown(), None);
    assert_eq!(after(&[1.0; 12], None).shown(), Some((Shown::Above, 8)));
    assert_eq!(after(&[-1.0; 12], None).shown(), Some((Shown::Below, 8)));
    // Pairs that are alike tell nothing: ∫ (1 + λ)² (1 − λ)² dλ = 8/15.
    let mixed = [0.0, 1.0, -1.0, 0.0, 1.0, -1.0];
    let found = 10_f64.powf(after(&mixed, None).log10_for_above());
    assert!((found - 8.0 / 15.0).abs() < 1e-3, "{found}");
    // p is the bound of Markov's inequality, on two sides.
    assert!((after(&[1.0; 8], None).p() - 2.0 * 9.0 / 511.0).abs() < 1e-3);
    assert_eq!(after(&mixed[..1], None).p(), 1.0);
}

/// After n ones the interval ends where ((1 + g)ⁿ⁺¹ − 1) / ((n + 1) g) = 40, with g = (1 − m) / (1 + m).
#[test]
fn the_interval_is_where_the_wealth_is_40() {
    for n in [8, 20, 60] {
        let (mut low, mut high) = (1e-9_f64, 1e3);
        for _ in 0..200 {
            let g = (low * high).sqrt();
            let n = f64::from(n);
            let wealth = ((1.0 + g).powf(n + 1.0) - 1.0) / ((n + 1.0) * g);
            (low, high) = if wealth < 40.0 { (g, high) } else { (low, g) };
        }
        let wanted = (1.0 - low) / (1.0 + low);
        let found = after(&vec![1.0; n as usize], None).interval_95().unwrap();
        assert!((found.low - wanted).abs() < 0.01, "{n}: {found:?}, by hand {wanted}");
        assert!(found.high > 0.999, "{found:?}");
    }
    // Without any difference, bets on one side: a drop of 0.2 is excluded where both of its sides are.
    let excluded = (1..)
        .find(|n| after(&vec![0.0; *n], Some(0.2)).shown().is_some())
        .unwrap();
    let interval = |n: usize| after(&vec![0.0; n], None).interval_95().unwrap();
    assert!(
        interval(excluded).high < 0.2 && interval(excluded - 1).high >= 0.2,
        "{excluded}"
    );
}

/// Hits of both textures in directions that are easy and hard; `drops` is what the texture takes from each.
struct Model<'a> {
    base: [f64; 8],
    drops: &'a [f64; 8],
}

impl Model<'_> {
    fn pair(&self, direction: usize, rng: &mut Pcg64Mcg) -> f64 {
        let base = self.base[direction];
        let [a, b] = [base, base - self.drops[direction]].map(|rate| f64::from(u8::from(rng.random_bool(rate))));
        a - b
    }
}

const EASY_AND_HARD: [f64; 8] = [0.95, 0.9, 0.8, 0.6, 0.5, 0.6, 0.8, 0.9];

/// Directions of a round: shuffled, or first those in which something was seen before, as a guide would who looks for the next telling view.
fn order(rng: &mut Pcg64Mcg, seen: &[f64; 8], is_guided: bool) -> Vec<usize> {
    let mut order: Vec<usize> = (0..8).collect();
    order.shuffle(rng);
    if is_guided {
        order.sort_by(|a, b| seen[*b].total_cmp(&seen[*a]));
    }
    order
}

/// Whoever looks after every pair is wrong no more often than stated, in any order; McNemar's test, looked at as often, is wrong far more often.
#[test]
fn looking_after_every_pair_does_no_harm() {
    let model = Model {
        base: EASY_AND_HARD,
        drops: &[0.0; 8],
    };
    for is_guided in [false, true] {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let (mut wrong, mut naive) = (0, 0);
        for _ in 0..EXPERIMENTS {
            let mut sequence = Sequence::new(8, None);
            let (mut seen, mut differences, mut is_naively_wrong) = ([0.0; 8], Vec::new(), false);
            for _ in 0..LOOKS / 8 {
                for direction in order(&mut rng, &seen, is_guided) {
                    let difference = model.pair(direction, &mut rng);
                    seen[direction] += difference;
                    sequence.see(direction, difference);
                    differences.push(difference as i64);
                    is_naively_wrong |=
                        !is_naively_wrong && differences.len() % 8 == 0 && mcnemar_p(&differences) < 0.05;
                }
            }
            wrong += usize::from(sequence.shown().is_some());
            naive += usize::from(is_naively_wrong);
        }
        let [wrong, naive] = [wrong, naive].map(|n| n as f64 / EXPERIMENTS as f64);
        println!("guided {is_guided}: wrong {wrong:.4}, McNemar looked at once a round {naive:.4}");
        assert!(wrong <= 0.05, "{wrong}");
        assert!(naive > 0.1, "the simulation cannot tell: {naive}");
    }
}

/// The interval holds the mean over directions after all rounds at once, though the texture works in some directions only; and a drop of that size is
/// not excluded more often than stated.
#[test]
fn the_interval_holds_whenever_one_stops() {
    let drops = [0.5, 0.0, 0.0, 0.1, 0.0, 0.3, 0.0, 0.1];
    let truth = drops.iter().sum::<f64>() / 8.0;
    let model = Model {
        base: EASY_AND_HARD,
        drops: &drops,
    };
    for is_guided in [false, true] {
        let mut rng = Pcg64Mcg::seed_from_u64(6);
        let runs = 1000;
        let (mut missed, mut width, mut excluded) = (0, 0.0, 0);
        for _ in 0..runs {
            let mut sequence = Sequence::new(8, Some(truth));
            let mut seen = [0.0; 8];
            for _ in 0..20 {
                for direction in order(&mut rng, &seen, is_guided) {
                    let difference = model.pair(direction, &mut rng);
                    seen[direction] += difference;
                    sequence.see(direction, difference);
                }
            }
            // What all intervals after the rounds have in common: outside it, one of them was.
            let interval = sequence.interval_95();
            missed += usize::from(!interval.is_some_and(|i| (i.low..=i.high).contains(&truth)));
            width += interval.map_or(0.0, |i| i.high - i.low) / f64::from(runs);
            excluded += usize::from(sequence.shown().is_some_and(|(shown, _)| shown == Shown::LessThanLeast));
        }
        println!("guided {is_guided}: missed {missed} of {runs}, mean width {width:.3}, excluded {excluded}");
        assert!(missed <= 50 && excluded <= 50, "{missed} {excluded}");
        assert!(width < 0.5, "an interval that says nothing: {width}");
    }
}

/// The trap: an order that depends on what the base's own photo showed makes a drop out of nothing, since a hit that was picked falls back.
#[test]
fn views_must_not_be_picked_by_the_base_s_own_photos() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let runs = 500;
    let wrong = (0..runs).filter(|_| {
        let mut sequence = Sequence::new(1, None);
        let mut base: Vec<bool> = (0..60).map(|_| rng.random_bool(0.6)).collect();
        base.sort_by_key(|hit| !hit);
        for hit in base {
            sequence.see(0, f64::from(u8::from(hit)) - f64::from(u8::from(rng.random_bool(0.6))));
        }
        sequence.shown().is_some_and(|(shown, _)| shown == Shown::Above)
    });
    let wrong = wrong.count();
    println!("picked by the base's hits: {wrong} of {runs} show a drop that is not there");
    assert!(wrong > runs * 9 / 10, "{wrong}");
}

fn compare(sessions: &[&Path], out: &Path, more: &[&str]) -> Output {
    let mut command = program();
    command
        .arg("compare")
        .args(sessions)
        .args(["--recorded", "--out"])
        .arg(out);
    command.args(more).output().unwrap()
}

/// The stored session as if it had been taken at another place.
fn at(place: &str) -> tempfile::TempDir {
    let session = copy_of_skyline();
    edit(session.path(), |file| {
        for photo in file["photos"].as_array_mut().unwrap() {
            photo["place"] = place.into();
        }
    });
    session
}

fn edit(session: &Path, change: impl FnOnce(&mut Value)) {
    let path = session.join("session.json");
    let mut file = read_json(&path);
    change(&mut file);
    std::fs::write(&path, file.to_string()).unwrap();
}

fn course<'a>(page: &'a Value, detector: &str) -> &'a Value {
    let results = page["sequential"]["results"].as_array().unwrap();
    results.iter().find(|course| course["detector"] == detector).unwrap()
}

/// All eight confidences of deimv2_femto fall: decided in the second place.
#[test]
fn a_comparison_says_when_it_was_decided() {
    let (a, b) = (at("meadow"), at("garage"));
    let out = tempfile::tempdir().unwrap();
    let one = compare(&[a.path()], out.path(), &["--sequential", "--detector", "deimv2_femto"]);
    assert!(one.status.success(), "{}", stderr(&one));
    let page = read_json(&out.path().join("comparison.json"));
    let decision = &course(&page, "deimv2_femto")["mean_confidence"];
    assert_eq!(
        (&decision["finding"], &decision["decided_after"]),
        (&"undecided".into(), &Value::Null)
    );
    assert_eq!(decision["rounds"], 1);

    let out = tempfile::tempdir().unwrap();
    let output = compare(
        &[a.path(), b.path()],
        out.path(),
        &["--sequential", "--least", "0.1", "--detector", "deimv2_femto"],
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    let [confidence, hits] = ["mean_confidence", "hit_rate"].map(|name| &course(&page, "deimv2_femto")[name]);
    assert_eq!(
        (&confidence["finding"], &hits["finding"]),
        (&"drop".into(), &"drop".into())
    );
    assert_eq!(course(&page, "deimv2_femto")["effect"], "hides");
    // By the other command's table: a pair is there when its photo of the patterned model is.
    let score = tempfile::tempdir().unwrap();
    let scored = program()
        .arg("score")
        .arg(a.path())
        .args(["--recorded", "--detector", "deimv2_femto", "-o"])
        .arg(score.path())
        .output()
        .unwrap();
    assert!(scored.status.success(), "{}", stderr(&scored));
    let drops = drops_of_confidence(&std::fs::read_to_string(score.path().join("photos.csv")).unwrap());
    let mut sequence = Sequence::new(8, Some(0.1));
    let twice = (0..16).map(|look| (look % 8, drops[look % 8]));
    let decided = twice.enumerate().find_map(|(look, (bin, drop))| {
        sequence.see(bin, drop);
        (sequence.p() < 0.05).then_some(look + 1)
    });
    let decided = decided.unwrap();
    assert_eq!(confidence["decided_after"], decided);
    // All six hits are lost by the end of the second place, and not said before the confidence.
    assert!(hits["decided_after"].as_u64().unwrap() >= decided as u64);
    assert_eq!(hits["log10_evidence"].as_array().unwrap().len(), 16);
    assert_eq!(
        (&hits["rounds"], &course(&page, "deimv2_femto")["looks"]),
        (&2.into(), &16.into())
    );
    assert!((hits["p_always_valid"].as_f64().unwrap() - 2.0 * 13.0 / 8191.0).abs() < 1e-4);
    let text = stdout(&output);
    assert!(
        text.contains(&format!("a drop, shown after {decided} of 16 pairs")),
        "{text}"
    );
    assert!(text.contains("DEIMv2-Femto 416  random   hides "), "{text}");
    let html = std::fs::read_to_string(out.path().join("comparison.html")).unwrap();
    assert!(html.contains("However often one looks") && html.contains(&format!("shown after {decided} of 16 pairs")));

    // Two places are two looks, which decide nothing.
    let out = tempfile::tempdir().unwrap();
    let output = compare(&[a.path(), b.path()], out.path(), &["--sequential=places"]);
    assert!(
        stdout(&output).contains("undecided after 2 places"),
        "{}{}",
        stdout(&output),
        stderr(&output)
    );
    // One of five detectors decides later, or not, and its own p stays what it was.
    let out = tempfile::tempdir().unwrap();
    let output = compare(&[a.path(), b.path()], out.path(), &["--sequential"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    let of_five = &course(&page, "deimv2_femto")["mean_confidence"];
    assert_eq!(of_five["p_always_valid"], confidence["p_always_valid"]);
    assert!(
        of_five["decided_after"]
            .as_u64()
            .is_none_or(|after| after > decided as u64)
    );
    assert!(of_five["p_corrected"].as_f64() > confidence["p_corrected"].as_f64());
}

/// Of each patterned photo, in their order: by how much less confidently it is found than the plain one of its direction.
fn drops_of_confidence(csv: &str) -> Vec<f64> {
    let mut rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let [variant, azimuth, confidence] = ["variant", "bin_azimuth_deg", "confidence"].map(column);
    let rows: Vec<_> = rows.collect();
    let found = |row: &Vec<&str>| row[confidence].parse().unwrap_or(0.0);
    let plain = |at: &str| {
        rows.iter()
            .find(|row| row[variant] == "normal" && row[azimuth] == at)
            .unwrap()
    };
    let patterned = rows.iter().filter(|row| row[variant] == "random");
    patterned.map(|row| found(plain(row[azimuth])) - found(row)).collect()
}

fn sealed(folder: &Path, more: &[&str]) -> (PathBuf, String) {
    let plan = folder.join("plan.json");
    let output = program()
        .args(["plan", "--seal", plan.to_str().unwrap(), "--scene"])
        .arg(skyline().join("scene.toml"))
        .args([
            "--texture",
            "normal",
            &format!("random={}", random16()),
            "--detector",
            "yolox_nano,deimv2_femto",
            "--drop",
            "0.5",
        ])
        .args(more)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let seal = stdout(&output)
        .lines()
        .find_map(|line| line.strip_prefix("seal: ").map(str::to_owned));
    (plan, seal.unwrap())
}

fn random16() -> String {
    format!("{}/print_templates/random16.png", home().display())
}

const DETECTORS: [&str; 2] = ["--detector", "yolox_nano,deimv2_femto"];

/// Holds the stored session, or another, against a plan: the deviations in the file, which are those on the page and in the text.
fn deviations(session: &Path, plan: &Path, more: &[&str]) -> Vec<String> {
    let out = tempfile::tempdir().unwrap();
    let shown = format!("random={}", random16());
    let usual: &[&str] = if more.contains(&"--pattern") {
        &[]
    } else {
        &["--pattern", &shown]
    };
    let arguments = [&["--plan", plan.to_str().unwrap()], usual, more].concat();
    let output = compare(&[session], out.path(), &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    let all: Vec<String> = serde_json::from_value(page["plan"]["deviations"].clone()).unwrap();
    let text = stdout(&output);
    let html = std::fs::read_to_string(out.path().join("comparison.html")).unwrap();
    let (first, drops) = (
        html.find("Held against the plan").unwrap(),
        html.find("<h3>Drop of the hit rate</h3>").unwrap(),
    );
    assert!(first < drops && html.matches("Deviation: ").count() == all.len());
    assert!(
        text.starts_with(&format!("plan {}", page["plan"]["seal"].as_str().unwrap())),
        "{text}"
    );
    assert!(all.iter().all(|deviation| text.contains(deviation)), "{text}");
    all
}

#[test]
fn a_plan_that_was_kept_has_no_deviation() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, seal) = sealed(folder.path(), &[]);
    assert_eq!(deviations(&skyline(), &plan, &DETECTORS), Vec::<String>::new());
    let out = tempfile::tempdir().unwrap();
    let output = compare(
        &[&skyline()],
        out.path(),
        &[&DETECTORS[..], &["--plan", plan.to_str().unwrap()]].concat(),
    );
    assert!(
        stdout(&output).starts_with(&format!("plan {seal}")),
        "{}",
        stdout(&output)
    );
}

/// Each way to bend a plan, one by one, is one deviation that names it.
#[test]
fn every_tampering_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, _) = sealed(folder.path(), &[]);
    let one = |session: &Path, plan: &Path, more: &[&str], words: &[&str]| {
        let all = deviations(session, plan, more);
        assert!(
            all.len() == 1 && words.iter().all(|word| all[0].contains(word)),
            "{all:?} should be {words:?}"
        );
    };
    let with = |more: &[&'static str]| [&DETECTORS[..], more].concat();
    one(
        &skyline(),
        &plan,
        &with(&["--confidence", "0.3"]),
        &["confidence of a hit: 0.5 in the plan, 0.3 here"],
    );
    one(
        &skyline(),
        &plan,
        &with(&["--ap", "voc-11"]),
        &["definition of AP", "voc-11 here"],
    );
    one(
        &skyline(),
        &plan,
        &with(&["--sequential"]),
        &["stopping: when every view is there in the plan"],
    );
    one(
        &skyline(),
        &plan,
        &["--detector", "yolox_nano"],
        &["deimv2_femto of the plan is missing"],
    );
    let more = ["--detector", "yolox_nano,deimv2_femto,nanodet_m"];
    one(&skyline(), &plan, &more, &["detector nanodet_m is not in the plan"]);

    let dropped = copy_of_skyline();
    edit(dropped.path(), |file| {
        file["photos"]
            .as_array_mut()
            .unwrap()
            .retain(|photo| photo["file"] != "random_011.jpg");
    });
    one(
        dropped.path(),
        &plan,
        &DETECTORS,
        &["1 view of the plan without a photo of random"],
    );
    let copied = copy_of_skyline();
    std::fs::copy(
        copied.path().join("normal_000.jpg"),
        copied.path().join("random_008.jpg"),
    )
    .unwrap();
    one(
        copied.path(),
        &plan,
        &DETECTORS,
        &["1 photo with the same content as another"],
    );
    let renamed = copy_of_skyline();
    edit(renamed.path(), |file| {
        file["photos"][3]["place"] = "garage".into();
    });
    let all = deviations(renamed.path(), &plan, &DETECTORS);
    assert!(all.iter().any(|d| d == "1 place in the plan, 2 places here"), "{all:?}");

    let other_scene = copy_of_skyline();
    let scene = other_scene.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&scene, format!("{text}\n# another\n")).unwrap();
    one(
        other_scene.path(),
        &plan,
        &DETECTORS,
        &["the scene of", "is not the one in the plan"],
    );

    let other = folder.path().join("other.png");
    let made = program()
        .args([
            "pattern",
            "random",
            "--cells",
            "16",
            "--seed",
            "9",
            "-o",
            other.to_str().unwrap(),
        ])
        .output();
    assert!(made.unwrap().status.success());
    let other = format!("random={}", other.display());
    let shown = [&DETECTORS[..], &["--pattern", &other]].concat();
    one(&skyline(), &plan, &shown, &["the pattern of random is not the one"]);

    // Weights are exchanged, thresholds changed, in the plan itself: its own seal says so, and what it is held against differs.
    let edited = |from: &str, to: &str| {
        let text = std::fs::read_to_string(&plan).unwrap();
        assert!(text.contains(from), "{text}");
        let path = folder.path().join("edited.json");
        std::fs::write(&path, text.replace(from, to)).unwrap();
        path
    };
    let changed = "the plan was changed after it was sealed";
    let all = deviations(
        &skyline(),
        &edited("\"hit_confidence\": 0.5", "\"hit_confidence\": 0.6"),
        &DETECTORS,
    );
    assert!(all.len() == 2 && all[0].starts_with(changed), "{all:?}");
    let weights = read_json(&plan)["plan"]["detectors"]["yolox_nano"]["weights_sha256"]
        .as_str()
        .unwrap()
        .to_owned();
    let all = deviations(&skyline(), &edited(&weights, &"0".repeat(64)), &DETECTORS);
    assert!(
        all[0].starts_with(changed) && all[1] == "the weights of yolox_nano are not those of the plan",
        "{all:?}"
    );
    // What is written otherwise and says the same is the same plan.
    let spaced = edited("\"places\": 1", "\"places\":   1");
    assert_eq!(deviations(&skyline(), &spaced, &DETECTORS), Vec::<String>::new());
}

/// The stored photos at two places in one session, plain ones first, with the files copied.
fn two_places() -> tempfile::TempDir {
    let folder = copy_of_skyline();
    edit(folder.path(), |file| {
        let stored = file["photos"].as_array().unwrap().clone();
        let mut photos = Vec::new();
        for variant in ["normal", "random"] {
            for place in ["meadow", "garage"] {
                for photo in stored.iter().filter(|photo| photo["variant"] == variant) {
                    let name = photo["file"].as_str().unwrap();
                    let copy = format!("{place}_{name}");
                    std::fs::copy(folder.path().join(name), folder.path().join(&copy)).unwrap();
                    photos.push(serde_json::json!({"file": copy, "variant": variant, "place": place}));
                }
            }
        }
        file["photos"] = photos.into();
    });
    folder
}

/// Views may be missing behind the pair that decided, and nowhere else; nobody may change the order.
#[test]
fn a_plan_that_stops_is_not_bent_by_leaving_photos_out() {
    let folder = tempfile::tempdir().unwrap();
    let only_femto = ["--detector", "deimv2_femto"];
    let plan = folder.path().join("two.json");
    let output = program()
        .args([
            "plan",
            "--seal",
            plan.to_str().unwrap(),
            "--places",
            "2",
            "--sequential",
            "--drop",
            "0.5",
            "--scene",
        ])
        .arg(skyline().join("scene.toml"))
        .args(["--texture", "normal", "random"])
        .args(only_femto)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let kept = |change: &dyn Fn(&mut Vec<Value>)| {
        let session = two_places();
        edit(session.path(), |file| change(file["photos"].as_array_mut().unwrap()));
        let mut all = deviations(session.path(), &plan, &only_femto);
        // The second place is a copy of the first here, which is found, and is not what this is about.
        let before = all.len();
        all.retain(|deviation| !deviation.ends_with("with the same content as another, or nearly"));
        assert_eq!(all.len() + 1, before);
        all
    };
    let none: Vec<String> = Vec::new();
    assert_eq!(kept(&|_| {}), none);
    // Which pair decides, by the whole session.
    let out = tempfile::tempdir().unwrap();
    let whole = two_places();
    assert!(
        compare(
            &[whole.path()],
            out.path(),
            &[&only_femto[..], &["--sequential"]].concat()
        )
        .status
        .success()
    );
    let page = read_json(&out.path().join("comparison.json"));
    let decided = course(&page, "deimv2_femto")["mean_confidence"]["decided_after"]
        .as_u64()
        .unwrap() as usize;
    assert!((9..15).contains(&decided), "the case has changed: {decided}");
    // It ended there: the six views behind it were not taken.
    assert_eq!(kept(&|photos| photos.truncate(16 + decided)), none);
    // One more was taken, so that the others are missing for another reason.
    let more = kept(&|photos| photos.truncate(16 + decided + 1));
    assert!(
        more.len() == 1 && more[0].contains("without a photo of random"),
        "{more:?}"
    );
    // One of the first place was left out.
    let gap = kept(&|photos| drop(photos.remove(18)));
    assert!(
        gap.len() == 1 && gap[0].starts_with("1 view of the plan without a photo of random"),
        "{gap:?}"
    );
    // Photos with times that were put into another order.
    let timed = |photos: &mut Vec<Value>| {
        for (i, photo) in photos.iter_mut().enumerate() {
            photo["taken"] = format!("2026-11-23T10:{i:02}:00Z").into();
        }
    };
    assert_eq!(kept(&|photos| timed(photos)), none);
    let moved = kept(&|photos| {
        timed(photos);
        let first = photos.remove(16);
        photos.push(first);
    });
    assert!(
        moved
            .iter()
            .any(|d| d.contains("not listed in the order of their times")),
        "{moved:?}"
    );
}

/// What truth boxes are made of is fixed, too.
#[test]
fn another_mesh_camera_or_truth_is_found() {
    let session = copy_of_skyline();
    let scene = session.path().join("scene.toml");
    // Of the scene's size, with one corner here or there.
    let mesh = |x: f64| {
        let at = |x: f64, y: f64, z: f64| format!("vertex {x} {y} {z}");
        let corners = [
            at(-227.5, -93.0, 0.0),
            at(227.5, -93.0, 0.0),
            at(x, 93.0, 0.0),
            at(0.0, 0.0, 128.0),
        ];
        let facet = |[a, b, c]: [usize; 3]| {
            format!(
                "facet normal 0 0 0\nouter loop\n{}\n{}\n{}\nendloop\nendfacet\n",
                corners[a], corners[b], corners[c]
            )
        };
        let facets: String = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(facet).concat();
        std::fs::write(
            session.path().join("model.stl"),
            format!("solid m\n{facets}endsolid m\n"),
        )
        .unwrap();
    };
    mesh(0.0);
    let text = std::fs::read_to_string(&scene).unwrap();
    let [before, after] = ["envelope = \"box\"", "envelope = \"mesh\"\nmesh = \"model.stl\""];
    let text = if text.contains(before) {
        text.replace(before, after)
    } else {
        text.replacen("[model]\n", &format!("[model]\n{after}\n"), 1)
    };
    std::fs::write(&scene, text).unwrap();
    let plan = session.path().join("plan.json");
    let camera = session.path().join("camera.yaml");
    let output = program()
        .args([
            "plan",
            "--seal",
            plan.to_str().unwrap(),
            "--texture",
            "normal",
            "random",
            "--detector",
            "yolox_nano",
            "--drop",
            "0.5",
        ])
        .arg("--scene")
        .arg(&scene)
        .arg("--camera")
        .arg(&camera)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let own = || deviations(session.path(), &plan, &["--detector", "yolox_nano"]);
    assert_eq!(own(), Vec::<String>::new());
    mesh(60.0);
    assert!(own().len() == 1 && own()[0].starts_with("the mesh of "), "{:?}", own());
    mesh(0.0);
    let stored = std::fs::read_to_string(&camera).unwrap();
    std::fs::write(&camera, format!("{stored}\n# another\n")).unwrap();
    assert!(
        own().len() == 1 && own()[0].starts_with("the camera of "),
        "{:?}",
        own()
    );
    std::fs::write(&camera, stored).unwrap();
    let exact = read_json(&skyline().join("truth.json"));
    edit(session.path(), |file| {
        file["photos"][9]["box_xyxy_px"] = exact["photos"][9]["box_xyxy_px"].clone()
    });
    assert!(
        own().len() == 1 && own()[0].contains("truth box that the session gives"),
        "{:?}",
        own()
    );
}

#[test]
fn a_plan_may_say_when_to_stop() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, _) = sealed(folder.path(), &["--sequential", "--least", "0.2"]);
    assert_eq!(deviations(&skyline(), &plan, &DETECTORS), Vec::<String>::new());
    let stated = read_json(&plan);
    assert_eq!(stated["plan"]["stopping"]["decided"]["least"], 0.2);
    // Nothing is decided with eight pairs, so that a view that is missing is a deviation here too.
    let dropped = copy_of_skyline();
    edit(dropped.path(), |file| {
        file["photos"]
            .as_array_mut()
            .unwrap()
            .retain(|photo| photo["file"] != "random_011.jpg");
    });
    let all = deviations(dropped.path(), &plan, &DETECTORS);
    assert!(
        all.len() == 1 && all[0].contains("without a photo of random"),
        "{all:?}"
    );
}

#[test]
fn what_cannot_be_sealed_or_looked_at_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, _) = sealed(folder.path(), &[]);
    let scene = skyline().join("scene.toml");
    let seal = |path: &str, more: &[&str]| {
        program()
            .args(["plan", "--drop", "0.5", "--seal", path, "--scene"])
            .arg(&scene)
            .args(more)
            .output()
            .unwrap()
    };
    let usual = ["--texture", "normal", "random", "--detector", "yolox_nano"];
    assert_refused(
        &seal(plan.to_str().unwrap(), &usual),
        &["is there already", "name another file"],
    );
    let new = folder.path().join("new.json");
    let new = new.to_str().unwrap();
    for (more, words) in [
        (
            &["--texture", "random", "--detector", "yolox_nano"][..],
            &["base", "--texture normal"][..],
        ),
        (
            &["--texture", "normal", "--detector", "yolox_nano"],
            &["at least one texture"],
        ),
        (
            &["--texture", "normal", "random", "random", "--detector", "yolox_nano"],
            &["random", "twice"],
        ),
        (&["--texture", "normal", "random", "--detector", "nobody"], &["nobody"]),
        (
            &["--texture", "normal", "random=missing.png", "--detector", "yolox_nano"],
            &["missing.png"],
        ),
        (&["--texture", "normal", "random"], &["--detector"]),
    ] {
        assert_refused(&seal(new, more), words);
        assert!(!Path::new(new).exists());
    }
    assert_refused(
        &seal(new, &[&usual[..], &["--pitch-deg", "17"]].concat()),
        &["17", "no bin of the scene"],
    );
    let out = folder.path().join("out");
    let held = |plan: &Path| compare(&[&skyline()], &out, &["--plan", plan.to_str().unwrap()]);
    let broken = folder.path().join("broken.json");
    for text in ["", "{}", "[1, 2]", "{\"seal\": \"x\", \"plan\": {}}"] {
        std::fs::write(&broken, text).unwrap();
        assert_refused(&held(&broken), &["broken.json", "no sealed plan"]);
    }
    assert_refused(&held(Path::new("nowhere.json")), &["nowhere.json"]);
    for least in ["0", "1", "-0.1", "nan", "much"] {
        assert_refused(
            &compare(&[&skyline()], &out, &["--sequential", "--least", least]),
            &["above 0 and below 1"],
        );
    }
    assert_refused(&compare(&[&skyline()], &out, &["--least", "0.1"]), &["--sequential"]);
    assert_refused(&compare(&[&skyline()], &out, &["--sequential=days"]), &["days"]);
    assert!(!out.join("comparison.json").exists());
}
