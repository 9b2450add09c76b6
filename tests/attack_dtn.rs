//! Trained surrogate renderers (DTN, NTR): the formula against a second writing of it and finite differences; training, going on with it, and
//! what must be refused.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Stdio;

use common::{assert_refused, home, program, read_json, stdout};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_frames::FrameSet;
use scaleproof_frames::light;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::run::{TrainingBudget, train};
use scaleproof_frames::surrogate::dtn::trained::DtnView;
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan};
use scaleproof_frames::surrogate::dtn::transformer::Maps;
use scaleproof_frames::surrogate::dtn::{Architecture, Encoder, Transformer, file};
use scaleproof_frames::surrogate::renderer::Renderer;
use scaleproof_frames::views;

const GREY: [u8; 3] = [128; 3];

fn frames() -> PathBuf {
    home().join("captures/skyline_frames")
}

fn stored() -> FrameSet {
    FrameSet::open(&frames()).unwrap()
}

/// The stored frames, by half or whole.
fn training_set(width_px: u32) -> TrainingSet {
    TrainingSet::read(&[stored()], None, width_px, &[GREY], || ()).unwrap()
}

fn plan(encoder: Encoder, depth: usize, transformer: Transformer) -> TrainingPlan {
    TrainingPlan {
        architecture: Architecture {
            encoder,
            depth,
            transformer,
        },
        references: vec![GREY],
        seed: 5,
        data_sha256: String::new(),
    }
}

/// The network's model of the first stored view.
fn first_view(trainer: &Trainer) -> DtnView {
    let set = stored();
    let all = views(&set.list.frames);
    let grey = all[0].iter().find(|f| f.flat_rgb() == Some(GREY)).unwrap();
    let mask = set.paint_mask(grey).unwrap();
    trainer.network().view(&set.rgb(grey).unwrap(), &mask)
}

fn random_maps(rng: &mut Pcg32) -> Maps {
    Maps {
        subtract: rng.random_range(-0.3..0.6),
        add: rng.random_range(-0.5..0.5),
        multiply: rng.random_range(-1.0..1.5),
        bias: rng.random_range(-0.4..0.4),
    }
}

/// The Expected Texture Transformer, one line of the notes after the other: `t = relu(η − TF[0:3]); t = t + TF[3:6]; t = t × TF[6:9];
/// x = relu(t + TF[9:12])`.
fn by_hand(tf: &[f64; 12], eta: [f64; 3]) -> [f64; 3] {
    let relu = |v: f64| if v > 0.0 { v } else { 0.0 };
    let mut t = [0.0; 3];
    for c in 0..3 {
        t[c] = relu(eta[c] - tf[c]);
    }
    for c in 0..3 {
        t[c] += tf[3 + c];
    }
    for c in 0..3 {
        t[c] *= tf[6 + c];
    }
    [0, 1, 2].map(|c| relu(t[c] + tf[9 + c]))
}

#[test]
fn the_formula_is_that_of_the_paper() {
    let mut rng = Pcg32::seed_from_u64(1);
    let mut shut = 0;
    for _ in 0..2000 {
        let tf: [f64; 12] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let eta: [f64; 3] = std::array::from_fn(|_| rng.random());
        let wanted = by_hand(&tf, eta);
        shut += wanted.iter().filter(|v| **v == 0.0).count();
        for c in 0..3 {
            let maps = Transformer::Texture.maps(c, |i| tf[i]);
            assert_eq!(Transformer::Texture.value(maps, eta[c]), wanted[c]);
            // NTR: multiply, then add.
            let maps = Transformer::MultiplyAdd.maps(c, |i| tf[i]);
            assert_eq!(Transformer::MultiplyAdd.value(maps, eta[c]), tf[c] * eta[c] + tf[3 + c]);
        }
    }
    assert!((1000..5000).contains(&shut), "both sides of the ReLUs: {shut}");
}

#[test]
fn slopes_are_finite_differences() {
    let mut rng = Pcg32::seed_from_u64(2);
    let (step, pull) = (1e-6, 0.7);
    let mut open = 0;
    for _ in 0..2000 {
        let (maps, eta): (Maps, f64) = (random_maps(&mut rng), rng.random());
        for kind in Transformer::ALL {
            let inner = (eta - maps.subtract).abs();
            if inner < 1e-4 || kind.value(maps, eta).abs() < 1e-4 && kind.value(maps, eta) != 0.0 {
                continue;
            }
            let by = |f: &dyn Fn(f64) -> f64| (f(step) - f(-step)) / (2.0 * step);
            let found = kind.derivative(maps, eta);
            let wanted = by(&|d| kind.value(maps, eta + d));
            assert!((found - wanted).abs() < 1e-6, "{maps:?} {eta}: {found} for {wanted}");
            // Where both ReLUs are open, what reaches the maps is the derivative; NTR has none.
            let is_open = kind == Transformer::MultiplyAdd || eta > maps.subtract && kind.value(maps, eta) > 0.0;
            if !is_open {
                continue;
            }
            open += 1;
            let gradients = kind.vjp(maps, eta, pull);
            let moved = |change: fn(&mut Maps, f64)| {
                by(&|d| {
                    let mut maps = maps;
                    change(&mut maps, d);
                    pull * kind.value(maps, eta)
                })
            };
            for (found, wanted) in [
                (gradients.subtract, moved(|m, d| m.subtract += d)),
                (gradients.add, moved(|m, d| m.add += d)),
                (gradients.multiply, moved(|m, d| m.multiply += d)),
                (gradients.bias, moved(|m, d| m.bias += d)),
            ] {
                assert!((found - wanted).abs() < 1e-6, "{kind:?} {maps:?}: {found} for {wanted}");
            }
        }
    }
    assert!(open > 2000, "{open}");
}

/// A ReLU that is shut would never learn: a pull that opens it passes, one that shuts it further does not.
#[test]
fn a_shut_relu_can_be_opened_again() {
    let shut = Maps {
        subtract: 0.0,
        add: 0.0,
        multiply: 1.0,
        bias: -2.0,
    };
    let kind = Transformer::Texture;
    assert_eq!(kind.value(shut, 0.5), 0.0);
    assert!(
        kind.vjp(shut, 0.5, -1.0).bias < 0.0,
        "the step against the gradient raises the bias"
    );
    assert_eq!(kind.vjp(shut, 0.5, 1.0).bias, 0.0);
    let dark = Maps {
        subtract: 0.8,
        bias: 0.2,
        ..shut
    };
    assert!(kind.vjp(dark, 0.5, -1.0).subtract > 0.0);
    assert_eq!(kind.vjp(dark, 0.5, 1.0).subtract, 0.0);
}

/// Every architecture starts about as the reference image where the texture is the reference, scaled elsewhere (shut, it would be off by its
/// brightness, 0.4), and every one takes steps.
#[test]
fn every_architecture_starts_alive_and_learns() {
    let set = training_set(48);
    let stored = stored();
    let grey = stored.list.frames.iter().find(|f| f.flat_rgb() == Some(GREY)).unwrap();
    let (picture, mask) = (stored.rgb(grey).unwrap(), stored.paint_mask(grey).unwrap());
    let mut names = std::collections::BTreeSet::new();
    for encoder in Encoder::ALL {
        for depth in 2..=4 {
            for transformer in Transformer::ALL {
                let mut trainer = Trainer::new(plan(encoder, depth, transformer));
                names.insert(trainer.network().architecture.name());
                let view = first_view(&trainer);
                for share in [0.5, 1.0] {
                    let eta = 128.0 / 255.0 * share;
                    let predicted = view.predict(&vec![[light::decode(eta); 3]; mask.len()]);
                    let pixels = predicted.iter().zip(picture.pixels()).zip(mask.pixels());
                    let painted = pixels.filter(|(_, covered)| covered.0[0] >= 128);
                    let off: Vec<f64> = painted
                        .flat_map(|((x, seen), _)| (0..3).map(|c| (x[c] - f64::from(seen.0[c]) / 255.0 * share).abs()))
                        .collect();
                    // The other features begin at random.
                    let mean = off.iter().sum::<f64>() / off.len() as f64;
                    assert!(mean < 0.2, "{encoder:?} {depth}, {share}: {mean} off in the mean");
                }
                let first = trainer.step(&set).unwrap();
                let later = (0..8).map(|_| trainer.step(&set).unwrap()).last().unwrap();
                assert!(
                    later < first + 0.2,
                    "{encoder:?} {depth} {transformer:?}: {later} after {first}"
                );
            }
        }
    }
    assert_eq!(names.len(), 18, "{names:?}");
}

#[test]
fn training_lowers_the_error_on_an_unseen_view() {
    let folder = tempfile::tempdir().unwrap();
    let set = training_set(96);
    assert_eq!((set.training.len(), set.validation.len()), (1, 1), "{}", set.split);
    for transformer in Transformer::ALL {
        let mut trainer = Trainer::new(plan(Encoder::ResNet, 2, transformer));
        let start = trainer.validate(&set).validation_mse.unwrap();
        train(
            &mut trainer,
            &set,
            TrainingBudget::Epochs(200),
            &folder.path().join("n.dtn"),
            |_, _| (),
        )
        .unwrap();
        let end = trainer.history.last().unwrap().validation_mse.unwrap();
        println!(
            "{transformer:?}: validation MSE {start:.5} before, {end:.5} after {} steps",
            trainer.steps
        );
        assert!(end < 0.5 * start, "{transformer:?}: {end} after {start}");
    }
}

#[test]
fn the_view_slope_is_a_finite_difference() {
    let set = training_set(96);
    for transformer in Transformer::ALL {
        let mut trainer = Trainer::new(plan(Encoder::DenseNet, 3, transformer));
        for _ in 0..30 {
            trainer.step(&set).unwrap();
        }
        let view = first_view(&trainer);
        let mut rng = Pcg32::seed_from_u64(4);
        let paint: Vec<[f64; 3]> = (0..96 * 64)
            .map(|_| std::array::from_fn(|_| rng.random_range(0.02..0.98)))
            .collect();
        let step = 1e-6;
        let moved = |by: f64| view.predict(&paint.iter().map(|p| p.map(|v| v + by)).collect::<Vec<_>>());
        let (low, high, derivatives) = (moved(-step), moved(step), view.derivative(&paint));
        let mut steep = 0;
        for ((low, high), derivative) in low.iter().zip(&high).zip(&derivatives) {
            for c in 0..3 {
                // A kink between the two is neither side's derivative.
                let wanted = (high[c] - low[c]) / (2.0 * step);
                let is_kink = low[c] <= 0.0 || high[c] >= 1.0;
                assert!(
                    is_kink || (wanted - derivative[c]).abs() < 1e-3 * (1.0 + wanted.abs()),
                    "{} for {wanted}",
                    derivative[c]
                );
                steep += usize::from(derivative[c] > 0.1);
            }
        }
        assert!(steep > 1000, "{steep}");
    }
}

#[test]
fn going_on_is_as_if_it_had_not_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("network.dtn");
    let set = training_set(96);
    let plan = plan(Encoder::ResNet, 3, Transformer::Texture);
    let mut whole = Trainer::new(plan.clone());
    train(&mut whole, &set, TrainingBudget::Epochs(12), &path, |_, _| ()).unwrap();
    let mut first = Trainer::new(plan);
    train(&mut first, &set, TrainingBudget::Epochs(7), &path, |_, _| ()).unwrap();
    let mut second = file::load(&path).unwrap();
    assert_eq!(second.steps, 7);
    train(&mut second, &set, TrainingBudget::Epochs(12), &path, |_, _| ()).unwrap();
    let paint = vec![[0.3, 0.1, 0.7]; 96 * 64];
    assert_eq!(first_view(&whole).predict(&paint), first_view(&second).predict(&paint));
    assert_ne!(first_view(&whole).predict(&paint), first_view(&first).predict(&paint));
    let mse = |t: &Trainer| t.history.last().unwrap().validation_mse;
    assert_eq!(mse(&whole), mse(&second));
}

fn command(arguments: &[&str], output: &Path) -> std::process::Output {
    let mut command = program();
    command
        .args(["attack", "train-dtn"])
        .args(arguments)
        .arg("-o")
        .arg(output);
    command.output().unwrap()
}

#[test]
fn trained_by_the_program_and_charted_beside_the_closed_forms() {
    let folder = tempfile::tempdir().unwrap();
    let (one, many) = (folder.path().join("one.dtn"), folder.path().join("many.dtn"));
    let frames = frames();
    let frames = frames.to_str().unwrap();
    let small = ["--encoder", "convnet", "--depth", "2", "--epochs"];
    let trained = command(&[&[frames][..], &small, &["60"]].concat(), &one);
    let text = stdout(&trained);
    assert!(
        text.contains("convnet k=2: 1 view to learn from, 1 to validate on (unseen azimuths"),
        "{text}"
    );
    // Trained already: only what is known of it.
    let again = command(&[&[frames][..], &small, &["60", "--json"]].concat(), &one);
    let about: serde_json::Value = serde_json::from_str(&stdout(&again)).unwrap();
    assert_eq!(
        (&about["network"], &about["training_views"], &about["validation_views"]),
        (&"convnet k=2".into(), &1.into(), &1.into())
    );
    assert_eq!(about["file"], one.to_str().unwrap());
    assert_eq!(about["history"].as_array().unwrap().last().unwrap()["step"], 60);
    // Who reads the table may have gone: the network is there all the same.
    let unread = folder.path().join("unread.dtn");
    let mut training = program();
    training
        .args(["attack", "train-dtn", frames])
        .args(small)
        .arg("1")
        .arg("-o")
        .arg(&unread);
    let mut training = training.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop((training.stdout.take(), training.stderr.take()));
    assert!(training.wait().unwrap().success());
    assert!(unread.exists());
    let references = ["8", "--transformer", "multiply-add", "--reference", "808080", "ffffff"];
    assert!(
        command(&[&[frames][..], &small, &references].concat(), &many)
            .status
            .success()
    );

    let charts = folder.path().join("charts");
    let mut chart = program();
    chart.args(["attack", "chart", frames, "--network"]).args([&one, &many]);
    let output = chart.arg("-o").arg(&charts).output().unwrap();
    assert!(output.status.success(), "{}", common::stderr(&output));
    assert!(stdout(&output).contains("1 of 2"), "{}", stdout(&output));
    let numbers = read_json(&charts.join("renderers.json"));
    let rows = numbers["rows"].as_array().unwrap();
    let row = |name: &str| rows.iter().find(|r| r["model"] == name).unwrap();
    assert!(row("convnet k=2")["training_seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(row("convnet k=2 ntr")["trained_references"], 2);
    assert!(row("quadratic-curve")["training_seconds"].is_null());
    // Patterns come with the frames: a network predicts them as every model does.
    assert!(row("convnet k=2")["mse_pattern_world"].as_f64().unwrap() < 0.2);
    for name in ["renderers.svg", "training.svg"] {
        let svg = std::fs::read_to_string(charts.join(name)).unwrap();
        assert!(
            svg.contains("convnet") && svg.contains("k=2") && roxmltree::Document::parse(&svg).is_ok(),
            "{name}"
        );
    }
    let mut without = program();
    without.args([
        "attack",
        "chart",
        frames,
        "--reference",
        "000000",
        "ffffff",
        "--network",
    ]);
    let output = without.arg(&one).arg("-o").arg(&charts).output().unwrap();
    assert_refused(&output, &["convnet k=2", "808080", "--reference"]);
}

/// Frames of another engine have no linear light: then the colours are those that are there, and some are kept back.
#[test]
fn frames_without_linear_light_are_learnt_from() {
    let copy = copy_of_frames(|list| {
        for frame in list["frames"].as_array_mut().unwrap() {
            frame.as_object_mut().unwrap().remove("linear");
        }
    });
    let output = command(
        &[
            copy.path().to_str().unwrap(),
            "--depth",
            "2",
            "--epochs",
            "3",
            "--encoder",
            "convnet",
        ],
        &copy.path().join("n.dtn"),
    );
    assert!(output.status.success(), "{}", common::stderr(&output));
    let last = stdout(&output).lines().rev().nth(1).unwrap().to_owned();
    let mse: f64 = last.split_whitespace().last().unwrap().parse().unwrap();
    assert!(mse > 0.0 && mse < 0.2, "{last}");
}

/// The stored frames with another list.
fn copy_of_frames(change: impl FnOnce(&mut serde_json::Value)) -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    for part in ["rgb", "views", "linear", "patterns"] {
        std::fs::create_dir(copy.path().join(part)).unwrap();
        for entry in std::fs::read_dir(frames().join(part)).unwrap() {
            let path = entry.unwrap().path();
            std::fs::copy(&path, copy.path().join(part).join(path.file_name().unwrap())).unwrap();
        }
    }
    let mut list = read_json(&frames().join("frames.json"));
    change(&mut list);
    std::fs::write(copy.path().join("frames.json"), list.to_string()).unwrap();
    copy
}

#[test]
fn what_cannot_be_trained_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let network = folder.path().join("network.dtn");
    let frames = frames();
    let frames = frames.to_str().unwrap();
    let small = ["--depth", "2", "--epochs", "1"];
    let with = |more: &[&str]| command(&[&[frames][..], &small, more].concat(), &network);

    assert_refused(
        &with(&["--width-px", "40"]),
        &["96×64", "40", "96, 48, 24", "--width-px"],
    );
    // A third of 96, but 64 has none.
    assert_refused(&with(&["--width-px", "32"]), &["96×64", "both sides"]);
    assert_refused(
        &with(&["--validation", frames]),
        &["are the same frames", "name them once"],
    );
    assert_refused(&with(&["--reference", "80808"]), &["80808"]);
    assert!(!network.exists(), "nothing half-written");
    // What cannot be written is said before anything is read.
    let no_place = folder.path().join("file/below");
    std::fs::write(folder.path().join("file"), "").unwrap();
    assert_refused(&command(&["missing"], &no_place), &["cannot write", "file is a file"]);
    let mut chart = program();
    chart.args(["attack", "chart", "missing", "-o"]).arg(&no_place);
    assert_refused(&chart.output().unwrap(), &["file/below", "is a file"]);
    let patterns_only = copy_of_frames(|list| {
        let all = list["frames"].as_array_mut().unwrap();
        all.retain(|f| f["paint"].get("pattern").is_some());
    });
    let path = patterns_only.path().to_str().unwrap().to_owned();
    assert_refused(
        &command(&[&path, "--epochs", "1"], &network),
        &[&path, "808080", "flat"],
    );
    // An image in that colour is not there, and without linear light it cannot be made.
    let no_linear = copy_of_frames(|list| {
        for frame in list["frames"].as_array_mut().unwrap() {
            frame.as_object_mut().unwrap().remove("linear");
        }
    });
    let path = no_linear.path().to_str().unwrap().to_owned();
    assert_refused(
        &command(&[&path, "--epochs", "1", "--reference", "010203"], &network),
        &["010203"],
    );

    assert!(with(&[]).status.success());
    assert_refused(
        &with(&["--encoder", "densenet"]),
        &["network.dtn", "resnet k=2", "densenet k=2", "another file"],
    );
    assert_refused(&with(&["--seed", "2"]), &["seed 1", "seed 2"]);
    assert_refused(&with(&["--reference", "ffffff"]), &["808080", "ffffff"]);

    let whole = std::fs::read(&network).unwrap();
    let mut damaged = whole.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    for (bytes, word) in [
        (damaged, "damaged"),
        (whole[..200].to_vec(), "damaged"),
        (b"hello".to_vec(), "no network"),
    ] {
        std::fs::write(&network, bytes).unwrap();
        assert_refused(&with(&[]), &["network.dtn", word]);
        let charts = folder.path().join("charts");
        let mut chart = program();
        chart
            .args(["attack", "chart", frames, "--network"])
            .arg(&network)
            .arg("-o")
            .arg(&charts);
        assert_refused(&chart.output().unwrap(), &["network.dtn", word]);
        assert!(!charts.exists());
    }
}
