//! What a user of the command line does about an error of the attack's rooms.

use std::error::Error;

use crate::cli::advice;
use scaleproof_attack::evaluate::EvaluateError;
use scaleproof_attack::run::RunError;
use scaleproof_frames::render::RenderError;
use scaleproof_frames::surrogate::additive::AdditiveError;
use scaleproof_frames::surrogate::chart::SurrogateChartError;
use scaleproof_frames::surrogate::dtn::DtnError;
use scaleproof_gradients::WhiteBoxError;

/// The option that helps.
pub fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        RenderError::CutOff { .. } => " (--field-of-view-deg)",
        EvaluateError::Render(error) => advice(error)?,
        EvaluateError::OtherClasses { .. } => " (--class)",
        AdditiveError::TooFew { .. } => ", as in --flat 000000 808080 ffffff",
        SurrogateChartError::NoReference { .. } | SurrogateChartError::OtherReference { .. } => " (--reference)",
        SurrogateChartError::NothingToPredict => ", as in --flat 000000 808080 ffffff c83214",
        RunError::NoPositions { .. } => " (--laying repeated)",
        RunError::ForwardPass { reason, .. } => match reason.as_ref() {
            WhiteBoxError::Program(error) => advice::on(error)?,
            WhiteBoxError::StrongestAlone { .. } => "leave --loss out".to_owned(),
            _ => return None,
        },
        DtnError::Additive(error) => advice(error)?,
        DtnError::NoViews { .. } => " (attack render --flat, --reference)",
        DtnError::Width { .. } => " (--width-px)",
        DtnError::NotFinite { .. } => " (--seed)",
    }
}
