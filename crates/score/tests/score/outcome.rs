use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;
use scaleproof_score::{PhotoOutcome, Thresholds, Verdict};

const CAR: usize = 2;
const TRUCK: usize = 7;
const LEAST: Thresholds = Thresholds {
    confidence: 0.5,
    iou: 0.5,
};

fn outcome(detections: &[(usize, f64, f64)]) -> PhotoOutcome {
    let detections: Vec<_> = detections
        .iter()
        .map(|(label, score, x)| Detection::new(*label, *score, BoxPx::new(*x, 0.0, x + 100.0, 50.0)).unwrap())
        .collect();
    PhotoOutcome::new(&detections, &BoxPx::new(0.0, 0.0, 100.0, 50.0), &[CAR], LEAST)
}

#[test]
fn the_paper_s_borders() {
    assert_eq!(outcome(&[(CAR, 0.8, 0.0)]).verdict, Verdict::Found);
    assert_eq!(
        outcome(&[(CAR, 0.8, 0.0), (TRUCK, 0.6, 5.0)]).verdict,
        Verdict::FoundWithOther
    );
    assert_eq!(outcome(&[(CAR, 0.8, 0.0), (TRUCK, 0.4, 5.0)]).verdict, Verdict::Found);
    assert_eq!(outcome(&[(TRUCK, 0.9, 0.0)]).verdict, Verdict::Missed);
    assert_eq!(
        outcome(&[(CAR, 0.8, 60.0)]).verdict,
        Verdict::Missed,
        "another car beside the model"
    );
    assert_eq!(outcome(&[]).confidence, 0.0);
}

#[test]
fn a_weak_find_keeps_its_confidence_but_is_a_miss() {
    let weak = outcome(&[(CAR, 0.3, 0.0), (CAR, 0.2, 1.0)]);
    assert_eq!((weak.confidence, weak.is_hit()), (0.3, false));
}

#[test]
fn a_photo_is_a_hit_or_misclassified_or_the_model_has_disappeared() {
    for (detections, fate) in [
        (vec![(CAR, 0.8, 0.0)], [true, false, false]),
        (vec![(CAR, 0.8, 0.0), (TRUCK, 0.9, 0.0)], [true, false, false]),
        (vec![(CAR, 0.4, 0.0), (TRUCK, 0.6, 5.0)], [false, true, false]),
        (vec![(CAR, 0.4, 0.0), (TRUCK, 0.4, 5.0)], [false, false, true]),
        (vec![(TRUCK, 0.9, 60.0)], [false, false, true]),
        (vec![], [false, false, true]),
    ] {
        let o = outcome(&detections);
        assert_eq!(
            [o.is_hit(), o.is_misclassified(), o.has_disappeared()],
            fate,
            "{detections:?}"
        );
    }
}

#[test]
fn boxes_of_the_class_elsewhere_are_hallucinations_and_doubles_are_not() {
    let o = outcome(&[
        (CAR, 0.9, 0.0),
        (CAR, 0.8, 3.0),  // a second box on the model
        (CAR, 0.7, 60.0), // IoU 0.25
        (CAR, 0.6, 500.0),
        (CAR, 0.4, 900.0),   // not confident enough
        (TRUCK, 0.9, 500.0), // perhaps a truck is there
    ]);
    assert_eq!((o.hallucinations, o.false_positives, o.is_hit()), (2, 3, true));
}
