use proptest::prelude::*;
use scaleproof_core::geometry::BoxPx;
use scaleproof_score::robustness::corrupt::cut_off;

proptest! {
    /// Whatever the box, and however small the image: something of the image and of the model is left, and no more than was there.
    #[test]
    fn a_crop_leaves_a_part_of_the_model(
        (width, height) in (1u32..300, 1u32..300),
        corners in prop::array::uniform4(0.0..1.0f64),
        severity in 1u8..=5,
        seed in any::<u64>(),
    ) {
        let [a, b, c, d] = corners;
        let (w, h) = (f64::from(width), f64::from(height));
        let truth = BoxPx::new(w * a.min(b), h * c.min(d), w * a.max(b), h * c.max(d));
        prop_assume!(truth.is_solid());
        let [x1, y1, x2, y2] = cut_off(&truth, [width, height], severity, seed);
        prop_assert!(x1 < x2 && x2 <= width && y1 < y2 && y2 <= height);
        let left = BoxPx {
            x1: truth.x1.max(x1.into()),
            y1: truth.y1.max(y1.into()),
            x2: truth.x2.min(x2.into()),
            y2: truth.y2.min(y2.into()),
        };
        prop_assert!(left.is_solid(), "{truth:?} {:?}", [x1, y1, x2, y2]);
    }
}
