//! Advice as a person hears it.

use scaleproof_capture::NextMove;

#[test]
fn steps_are_said_as_to_a_person() {
    let said = [
        NextMove::Azimuth(-12.3),
        NextMove::Azimuth(0.2),
        NextMove::Distance(-204.0),
        NextMove::Distance(58.0),
        NextMove::Height(70.0),
        NextMove::Height(-1.0),
    ]
    .map(|step| step.to_string());
    assert_eq!(
        said,
        [
            "12° to the left",
            "1° to the right",
            "20 cm closer",
            "6 cm back",
            "7 cm higher",
            "1 cm lower"
        ]
    );
}
