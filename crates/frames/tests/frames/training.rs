use std::collections::BTreeMap;
use std::path::Path;

use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan};
use scaleproof_frames::surrogate::dtn::{Architecture, Encoder, Transformer, file};
use scaleproof_frames::{FrameSet, FramesError};
use serde::{Deserialize, Serialize};

fn plan(encoder: Encoder, depth: usize, transformer: Transformer) -> TrainingPlan {
    TrainingPlan {
        architecture: Architecture {
            encoder,
            depth,
            transformer,
        },
        references: vec![[128; 3]],
        seed: 1,
        data_sha256: String::new(),
    }
}

fn training_set() -> Result<TrainingSet, FramesError> {
    let frames = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../captures/skyline_frames");
    TrainingSet::read(&[FrameSet::open(&frames)?], None, 48, &[[128; 3]], || ())
}

/// The losses of six steps, and about a hundred of the weights after them.
#[derive(Debug, Serialize, Deserialize)]
struct Course {
    losses: Vec<f64>,
    weights: Vec<f32>,
}

fn course(plan: TrainingPlan) -> Result<Course, FramesError> {
    let set = training_set()?;
    let mut trainer = Trainer::new(plan);
    let losses = (0..6).map(|_| trainer.step(&set)).collect::<Result<_, _>>()?;
    let weights = trainer.weights.concat();
    let weights = weights.iter().step_by(weights.len() / 100).copied().collect();
    Ok(Course { losses, weights })
}

/// `data/courses.json` was written by this test when burn 0.22.1 computed forward and backward pass and
/// Adam's steps. Losses from sums of 32 bits agree to 1e-5 of themselves. Adam divides a derivative by its own size, so that a weight whose derivative is
/// hardly more than rounding may take any part of its first steps of 1e-3: such weights are few, and the others agree to a twentieth of a step.
#[test]
fn training_takes_the_steps_that_another_engine_took() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/courses.json");
    let plans = [
        plan(Encoder::ResNet, 2, Transformer::Texture),
        plan(Encoder::DenseNet, 2, Transformer::Texture),
        plan(Encoder::ConvNet, 2, Transformer::Texture),
        plan(Encoder::ResNet, 4, Transformer::MultiplyAdd),
    ];
    let named = |plan: TrainingPlan| Ok((plan.architecture.name(), course(plan)?));
    let found = plans
        .map(named)
        .into_iter()
        .collect::<Result<BTreeMap<_, _>, FramesError>>()?;
    let stored: BTreeMap<String, Course> = serde_json::from_slice(&std::fs::read(&path)?)?;
    assert!(found.keys().eq(stored.keys()) && stored.len() == 4);
    for ((name, found), stored) in found.iter().zip(stored.values()) {
        for (found, stored) in found.losses.iter().zip(&stored.losses) {
            assert!((found - stored).abs() < 1e-5 * stored, "{name}: {found} for {stored}");
        }
        assert_eq!(
            (found.losses.len(), found.weights.len()),
            (6, stored.weights.len()),
            "{name}"
        );
        let off = found.weights.iter().zip(&stored.weights).map(|(a, b)| (a - b).abs());
        let far = off.clone().filter(|off| *off > 5e-5).count();
        println!(
            "{name}: {far} of {} weights apart, {:e} at most",
            stored.weights.len(),
            off.fold(0.0, f32::max)
        );
        assert!(20 * far <= stored.weights.len(), "{name}: {far} weights are apart");
    }
    Ok(())
}

/// Nothing a user gives makes a number break down, so weights are broken here.
#[test]
fn what_is_no_number_is_neither_stepped_along_nor_saved() -> Result<(), FramesError> {
    let set = training_set()?;
    let plan = plan(Encoder::ConvNet, 1, Transformer::Texture);
    let mut trainer = Trainer::new(plan);
    trainer.step(&set)?;
    if let Some(last) = trainer.weights.last_mut() {
        last.fill(f32::NAN);
    }
    let refused = trainer.step(&set).map_err(|e| e.to_string());
    assert!(refused.is_err_and(|e| e.contains("step 1") && e.contains("no number")));
    let path = std::env::temp_dir().join("scaleproof-broken-down.dtn");
    assert!(matches!(
        file::save(&trainer, &path),
        Err(FramesError::NotFinite { .. })
    ));
    assert!(!path.exists());
    Ok(())
}
