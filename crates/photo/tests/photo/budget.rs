//! What decoding may cost.

use scaleproof_photo::{Budget, DecodeCost};

#[test]
fn photos_of_real_cameras_are_within_and_bombs_are_not() {
    let jpeg = |megapixels: u32, scans: u64| {
        // A camera's file has some 0.3 bytes a pixel.
        DecodeCost::of_jpeg(
            [megapixels * 1000, 1000],
            3,
            scans,
            scans > 1,
            300_000 * megapixels as usize,
        )
    };
    for (budget, cost, is_within) in [
        (Budget::FILE, jpeg(200, 1), true),
        (Budget::FILE, jpeg(108, 10), true),
        (Budget::FILE, jpeg(251, 1), false),
        (Budget::FILE, jpeg(12, 65), false),
        (Budget::FILE, jpeg(200, 20), false),
        (Budget::FILE, DecodeCost::of_png([13_000, 12_000], 8, false), false),
        (Budget::UPLOAD, jpeg(50, 10), true),
        (Budget::UPLOAD, jpeg(108, 1), true),
        (Budget::UPLOAD, jpeg(121, 1), false),
        (Budget::UPLOAD, jpeg(108, 10), false),
        (Budget::UPLOAD, DecodeCost::of_png([8000, 8000], 8, false), false),
    ] {
        assert_eq!(budget.check(&cost).is_ok(), is_within, "{budget:?} {cost:?}");
    }
}
