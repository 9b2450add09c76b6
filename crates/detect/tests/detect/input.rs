//! From photos to input tensors, and boxes back.

use image::RgbImage;

use crate::common::home;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Channels, Input, InputPlacement, Kernel, Layout, Manifest, Pad, Resize, Values, tensor};
use scaleproof_photo::{opencv_linear, shrunk};

use proptest::prelude::*;

fn input(resize: Resize) -> Input {
    Input {
        size_px: [416, 320],
        layout: Layout::Nchw,
        values: Values::F32,
        resize,
        kernel: Kernel::OpencvLinear,
        pad: Pad::Grey(114),
        channels: Channels::Bgr,
        mean: [0.0; 3],
        std: [1.0; 3],
    }
}

#[test]
fn a_letterboxed_photo_is_padded_and_bgr() {
    let photo = RgbImage::from_pixel(208, 80, image::Rgb([10, 20, 30]));
    let input = input(Resize::LetterboxCentre);
    let placement = InputPlacement::new(&input, 208, 80);
    let tensor = tensor(&photo, &input, &placement);
    let at = |channel: usize, x: usize, y: usize| tensor[channel * 416 * 320 + y * 416 + x];
    assert_eq!((at(0, 0, 0), at(0, 415, 319)), (114.0, 114.0));
    assert_eq!((at(0, 0, 80), at(1, 415, 239), at(2, 200, 160)), (30.0, 20.0, 10.0));
}

#[test]
fn channels_last_is_the_same_image() {
    let photo = RgbImage::from_fn(97, 61, |x, y| image::Rgb([x as u8, y as u8, 7]));
    let planar = input(Resize::LetterboxCentreRounded);
    let last = Input {
        layout: Layout::Nhwc,
        ..planar.clone()
    };
    let placement = InputPlacement::new(&planar, 97, 61);
    let [planar, last] = [planar, last].map(|input| tensor(&photo, &input, &placement));
    let plane = 416 * 320;
    assert!((0..3 * plane).all(|i| planar[i] == last[i % plane * 3 + i / plane]));
}

#[test]
fn a_given_short_side_ends_in_zeros_at_a_multiple_of_32() {
    let photo = RgbImage::from_pixel(301, 203, image::Rgb([10, 20, 30]));
    let input = Input {
        size_px: [96, 96],
        mean: [1.0; 3],
        ..input(Resize::ShortSide)
    };
    let placement = InputPlacement::new(&input, 301, 203);
    // 301 · 96 / 203 = 142.3
    assert_eq!((placement.size, placement.canvas), ([142, 96], [160, 96]));
    let tensor = tensor(&photo, &input, &placement);
    assert_eq!((tensor[141], tensor[142]), (29.0, 0.0));
}

#[test]
fn the_antialiased_kernel_averages_what_linear_skips() {
    // Every fourth column white: reduced by four, the mean is a quarter of white.
    let photo = RgbImage::from_fn(256, 64, |x, _| image::Rgb([if x % 4 == 0 { 255 } else { 0 }; 3]));
    let mean =
        |image: RgbImage| image.as_raw().iter().map(|b| f64::from(*b)).sum::<f64>() / image.as_raw().len() as f64;
    assert!((mean(shrunk(&photo, [64, 16])) - 63.75).abs() < 2.0);
    assert!(mean(opencv_linear(&photo, [64, 16])) < 40.0);
}

/// OpenCV's linear kernel takes four pixels for one: of a reduced photo it would take others.
#[test]
fn only_a_kernel_that_averages_may_see_a_reduced_photo() {
    let photo = scaleproof_photo::Photo::open(&home().join("captures/skyline/normal_000.jpg")).unwrap();
    for resize in [
        Resize::Stretch,
        Resize::LetterboxTopLeft,
        Resize::LetterboxCentreRounded,
    ] {
        let mut manifest = Manifest::named("yolox_nano").unwrap();
        manifest.input = Input {
            size_px: [160, 160],
            ..input(resize)
        };
        let least = |manifest: &Manifest| manifest.least_px(photo.width, photo.height);
        assert_eq!(photo.reduction(least(&manifest)), 1, "{resize:?}");
        manifest.input.kernel = Kernel::Antialiased;
        assert!(photo.reduction(least(&manifest)) > 1, "{resize:?}");
    }
}

/// effdet's colour, for red, green and blue.
#[test]
fn a_border_may_have_a_colour() {
    let photo = RgbImage::from_pixel(416, 100, image::Rgb([1, 2, 3]));
    let input = Input {
        pad: Pad::Colour([124, 116, 104]),
        channels: Channels::Rgb,
        ..input(Resize::LetterboxTopLeft)
    };
    let tensor = tensor(&photo, &input, &InputPlacement::new(&input, 416, 100));
    let last = |channel: usize| tensor[(channel + 1) * 416 * 320 - 1];
    assert_eq!([last(0), last(1), last(2), tensor[0]], [124.0, 116.0, 104.0, 1.0]);
}

proptest! {
    /// Boxes placed into the input and read back land where they were, on odd photo sizes too.
    #[test]
    fn boxes_come_back(
        width in 33u32..3000, height in 33u32..3000, resize in prop::sample::select(vec![
            Resize::Stretch, Resize::LetterboxTopLeft, Resize::LetterboxCentre, Resize::LetterboxCentreRounded]),
        x in 0.0..0.5_f64, y in 0.0..0.5_f64,
    ) {
        let p = InputPlacement::new(&input(resize), width, height);
        let (w, h) = (f64::from(width), f64::from(height));
        let wanted = BoxPx::new(x * w, y * h, (x + 0.4) * w, (y + 0.4) * h);
        let placed = BoxPx::new(
            wanted.x1 * p.scale[0] + p.offset[0], wanted.y1 * p.scale[1] + p.offset[1],
            wanted.x2 * p.scale[0] + p.offset[0], wanted.y2 * p.scale[1] + p.offset[1]);
        let back = p.to_photo(placed);
        prop_assert!((back.x1 - wanted.x1).abs() < 1e-6 && (back.y2 - wanted.y2).abs() < 1e-6);
        prop_assert!(placed.x2 <= 416.0 + 1e-6 && placed.y2 <= 320.0 + 1e-6);
    }
}
