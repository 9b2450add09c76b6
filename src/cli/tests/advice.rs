//! Tests of `cli/advice.rs`.

use super::*;
use scaleproof_core::message::message;
use scaleproof_detect::WeightsError;
use scaleproof_score::{EvaluatedDetectorError, ScoreError};

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
    let recorded = message!("1.jpg has none of a").hint("run without ‹recorded›, or record them again with ‹record›");
    assert!(
        sentence(&ScoreError::from(recorded))
            .ends_with("of a; run without --recorded, or record them again with --record")
    );
    assert_eq!(
        sentence(&ScoreError::from(message!("no session to score"))),
        "no session to score"
    );
}
