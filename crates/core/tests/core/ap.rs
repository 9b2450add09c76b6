//! Average precision.

use scaleproof_core::ap::{ApDefinition, ImageBoxes, average_precision, average_precision_as};
use scaleproof_core::geometry::BoxPx;

/// `k` of eight photos found, no false positive: what each definition makes of it.
#[test]
fn half_and_five_eighths_found() {
    let unit = BoxPx::new(0.0, 0.0, 10.0, 10.0);
    let found = |k: usize| {
        let image = |i: usize| ImageBoxes {
            truths: vec![unit],
            detections: if i < k { vec![(0.9, unit)] } else { Vec::new() },
            ..ImageBoxes::default()
        };
        (0..8).map(image).collect::<Vec<_>>()
    };
    let ap = |k, definition| average_precision_as(definition, &found(k), 0.5).unwrap().ap;
    let wanted = [
        [51.0 / 101.0, 0.5, 6.0 / 11.0, 0.75],
        [63.0 / 101.0, 0.625, 7.0 / 11.0, 0.8125],
    ];
    for (k, wanted) in [4, 5].into_iter().zip(wanted) {
        for (definition, wanted) in ApDefinition::ALL.into_iter().zip(wanted) {
            // The ramp's bend lies between two of its 101 recalls.
            let allowed = if definition == ApDefinition::Yolov5Ramp {
                5e-5
            } else {
                1e-12
            };
            assert!(
                (ap(k, definition) - wanted).abs() < allowed,
                "{k} {definition:?}: {}",
                ap(k, definition)
            );
        }
    }
    for definition in ApDefinition::ALL {
        // Even a perfect curve falls to 0 at recall 1 in YOLOv5's: its best AP is 0.995.
        let best = if definition == ApDefinition::Yolov5Ramp {
            0.995
        } else {
            1.0
        };
        assert!((ap(8, definition) - best).abs() < 1e-12, "{definition:?}");
        assert_eq!(ap(0, definition), 0.0, "{definition:?}");
    }
}

#[test]
fn no_truth_is_no_number() {
    assert_eq!(average_precision(&[ImageBoxes::default()], 0.5), None);
}
