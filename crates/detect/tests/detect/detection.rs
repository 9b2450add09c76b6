//! Detections as files keep them.

use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;

use proptest::prelude::*;

proptest! {
    /// A detection written as COCO writes it and read again is the same detection, bit for bit.
    #[test]
    fn detections_survive_a_file(x in -50.0..4000.0_f64, y in -50.0..3000.0_f64, w in 0.1..4000.0_f64, h in 0.1..3000.0_f64, s in 0.0..1.0_f64) {
        let d = Detection::new(2, s, BoxPx::new(x, y, x + w, y + h)).unwrap();
        let [x, y, w, h] = d.to_xywh();
        prop_assert_eq!(Detection::new(2, d.score, BoxPx::new(x, y, x + w, y + h)).unwrap(), d);
    }
}
