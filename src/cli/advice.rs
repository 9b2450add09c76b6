//! What to do about an error: the library says what is wrong, and the commands know their options.

use std::error::Error;

/// Advice on one error: what follows its sentence after a colon, or at once if it begins with a comma or a space. `None` where the sentence
/// says all.
pub(super) type Advise = fn(&(dyn Error + 'static)) -> Option<String>;

/// An error's sentence with the advice of the commands on it, or on what it wraps.
pub(super) fn sentence(error: &(dyn Error + 'static)) -> String {
    let mut wrapped = std::iter::successors(Some(error), |e| (*e).source());
    match wrapped.find_map(|e| super::ADVICE.iter().find_map(|advise| advise(e))) {
        Some(advice) if advice.starts_with([',', ' ', ';']) => format!("{error}{advice}"),
        Some(advice) => format!("{error}: {advice}"),
        None => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scaleproof_detect::WeightsError;
    use scaleproof_score::score::{EvaluatedDetectorError, ScoreError};

    #[test]
    fn what_the_library_leaves_out_the_commands_add() {
        let missing = WeightsError::Missing {
            name: "a".into(),
            file: "a.onnx".into(),
            remedy: "fetch them".into(),
        };
        let wrapped = EvaluatedDetectorError::from(missing);
        assert_eq!(
            sentence(&wrapped),
            "no weights for a: fetch them, or name a folder with a.onnx by --detectors"
        );
        let (file, detector) = ("1.jpg".into(), "a".into());
        let recorded = ScoreError::NotRecorded { file, detector };
        assert!(sentence(&recorded).ends_with("of a: run without --recorded, or record them again with --record"));
        assert_eq!(sentence(&ScoreError::NoSession), "no session to score");
    }
}
