//! Tests of `cli/advice.rs`.

use super::*;
use scaleproof_core::message::Message;
use scaleproof_detect::WeightsError;
use scaleproof_score::{EvaluatedDetectorError, ScoreError};

#[test]
fn what_the_library_leaves_out_the_commands_add() {
    let missing = Message::new("no weights for a: fetch them").hint("a folder that has a.onnx is named by ‹detectors›");
    let missing = WeightsError::Missing(missing);
    let wrapped = EvaluatedDetectorError::from(missing);
    assert_eq!(
        sentence(&wrapped),
        "no weights for a: fetch them; a folder that has a.onnx is named by --detectors"
    );
    let (file, detector) = ("1.jpg".into(), "a".into());
    let recorded = ScoreError::NotRecorded { file, detector };
    assert!(sentence(&recorded).ends_with("of a: run without --recorded, or record them again with --record"));
    assert_eq!(sentence(&ScoreError::NoSession), "no session to score");
}
