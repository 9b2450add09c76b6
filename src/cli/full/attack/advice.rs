//! What a user of the command line does about an error of the attack's rooms.

use std::error::Error;

use super::networks;
use crate::cli::advice;
use scaleproof_attack::evaluate::EvaluateError;
use scaleproof_attack::run::RunError;
use scaleproof_frames::frames::render::RenderError;
use scaleproof_frames::surrogate::additive::AdditiveError;
use scaleproof_frames::surrogate::chart::SurrogateChartError;
use scaleproof_gradients::WhiteBoxError;
use scaleproof_gradients::device::DeviceError;

/// The option that helps.
pub(in crate::cli) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    let fixed = None
        .or_else(|| error.downcast_ref().and_then(of_rendering))
        .or_else(|| error.downcast_ref().and_then(of_evaluation))
        .or_else(|| error.downcast_ref().and_then(of_colours))
        .or_else(|| error.downcast_ref().and_then(of_chart))
        .or_else(|| error.downcast_ref().and_then(of_run))
        .or_else(|| networks::advice(error));
    fixed
        .map(str::to_owned)
        .or_else(|| error.downcast_ref().map(of_device))
        .or_else(|| error.downcast_ref().and_then(of_program))
}

fn of_device(error: &DeviceError) -> String {
    match error {
        DeviceError::NotBuilt(device) => {
            format!("build it with `cargo build --release --features {device}`, or leave --device out")
        }
        DeviceError::NotThere(_) => ", or leave --device out".to_owned(),
    }
}

fn of_rendering(error: &RenderError) -> Option<&'static str> {
    matches!(error, RenderError::CutOff { .. }).then_some(" (--field-of-view-deg)")
}

fn of_evaluation(error: &EvaluateError) -> Option<&'static str> {
    match error {
        EvaluateError::Render(error) => of_rendering(error),
        EvaluateError::OtherClasses { .. } => Some(" (--class)"),
        _ => None,
    }
}

pub(super) fn of_colours(error: &AdditiveError) -> Option<&'static str> {
    matches!(error, AdditiveError::TooFew { .. }).then_some(", as in --flat 000000 808080 ffffff")
}

fn of_chart(error: &SurrogateChartError) -> Option<&'static str> {
    match error {
        SurrogateChartError::NoReference { .. } | SurrogateChartError::OtherReference { .. } => Some(" (--reference)"),
        SurrogateChartError::NothingToPredict => Some(", as in --flat 000000 808080 ffffff c83214"),
        _ => None,
    }
}

fn of_program(error: &RunError) -> Option<String> {
    match error {
        RunError::ForwardPass { reason, .. } => match reason.as_ref() {
            WhiteBoxError::Program(error) => advice::on(error),
            WhiteBoxError::StrongestAlone { .. } => Some("leave --loss out".to_owned()),
            _ => None,
        },
        _ => None,
    }
}

fn of_run(error: &RunError) -> Option<&'static str> {
    matches!(error, RunError::NoPositions { .. }).then_some(" (--laying repeated)")
}
