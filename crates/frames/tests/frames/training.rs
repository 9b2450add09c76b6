use burn::tensor::Device;
use scaleproof_frames::frames::FrameSet;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan};
use scaleproof_frames::surrogate::dtn::{Architecture, DtnError, Encoder, Transformer};

/// Nothing a user gives makes a number break down, so weights are broken here.
#[test]
fn what_is_no_number_is_neither_stepped_along_nor_saved() -> Result<(), DtnError> {
    let frames = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../captures/skyline_frames");
    let references = vec![[128; 3]];
    let set = TrainingSet::read(&[FrameSet::open(&frames)?], None, 48, &references, || ())?;
    let architecture = Architecture {
        encoder: Encoder::ConvNet,
        depth: 1,
        transformer: Transformer::Texture,
    };
    let plan = TrainingPlan {
        architecture,
        references,
        seed: 1,
        data_sha256: String::new(),
    };
    let mut trainer = Trainer::new(plan, Device::flex())?;
    trainer.step(&set)?;
    let mut state = trainer.state()?;
    if let Some(last) = state.weights.last_mut() {
        last.fill(f32::NAN);
    }
    let mut trainer = Trainer::go_on(state, Device::flex())?;
    let refused = trainer.step(&set).map_err(|e| e.to_string());
    assert!(refused.is_err_and(|e| e.contains("step 1") && e.contains("no number")));
    assert!(matches!(trainer.state(), Err(DtnError::NotFinite { .. })));
    Ok(())
}
