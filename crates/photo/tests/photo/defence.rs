//! Where a defence's image lies in the photo, and which names there are.

use image::{Rgb, RgbImage};
use proptest::prelude::*;
use scaleproof_photo::defence::Defence;

const WHITE: Rgb<u8> = Rgb([255; 3]);

/// A white block on grey, and the pixels of its box: left, top, right, bottom.
fn block(size: [u32; 2], b: [u32; 4]) -> RgbImage {
    RgbImage::from_fn(size[0], size[1], |x, y| {
        let is_in = (b[0]..b[2]).contains(&x) && (b[1]..b[3]).contains(&y);
        if is_in { WHITE } else { Rgb([90; 3]) }
    })
}

/// The box around all white pixels.
fn found(image: &RgbImage) -> Option<[f64; 4]> {
    let white = || image.enumerate_pixels().filter(|(.., pixel)| **pixel == WHITE);
    let least = |of: fn(u32, u32) -> u32| white().map(|(x, y, _)| of(x, y)).min().map(f64::from);
    let most = |of: fn(u32, u32) -> u32| white().map(|(x, y, _)| of(x, y)).max().map(|v| f64::from(v + 1));
    Some([least(|x, _| x)?, least(|_, y| y)?, most(|x, _| x)?, most(|_, y| y)?])
}

proptest! {
    /// What is found in the image lies where it was in the photo, to a pixel; nothing but the photo and black is in the image.
    #[test]
    fn an_object_is_found_where_it_was(
        (width, height) in (40u32..200, 40u32..200),
        (left, top) in (0.3f64..0.5, 0.3f64..0.5),
        seed in any::<u64>(),
        is_crops in any::<bool>(),
    ) {
        let size = [width, height];
        let (x, y) = ((left * f64::from(width)) as u32, (top * f64::from(height)) as u32);
        let truth = [x, y, x + width / 5, y + height / 5];
        let picture = block(size, truth);
        let defence = if is_crops { Defence::Crops(4) } else { Defence::ResizePad };
        let frames = defence.frames(size, seed);
        prop_assert_eq!(frames.len(), if is_crops { 4 } else { 1 });
        for frame in frames {
            let image = defence.image(&picture, &frame).unwrap();
            let ratio = f64::from(image.width()) / f64::from(width);
            prop_assert!((ratio - if is_crops { 0.8 } else { 331.0 / 299.0 }).abs() < 1.5 / f64::from(width), "{}", ratio);
            prop_assert!(image.pixels().all(|p| *p == WHITE || p.0 == [90; 3] || p.0 == [0; 3]));
            let (b, window) = (found(&image).unwrap(), frame.window());
            let across = window.width() / f64::from(image.width());
            let down = window.height() / f64::from(image.height());
            let back = [window.x1 + across * b[0], window.y1 + down * b[1], window.x1 + across * b[2], window.y1 + down * b[3]];
            for (back, truth) in back.iter().zip(truth) {
                prop_assert!((back - f64::from(truth)).abs() <= 1.0, "{:?} {:?}", back, truth);
            }
        }
    }
}

#[test]
fn names_have_their_amounts_and_others_are_refused() {
    for (text, name) in [
        ("jpeg", "jpeg=75"),
        ("jpeg=50", "jpeg=50"),
        ("bit-depth", "bit-depth=3"),
        ("median=5", "median=5"),
        ("resize-pad", "resize-pad"),
        ("crops", "crops=30"),
    ] {
        let defence = Defence::named(text).unwrap();
        assert_eq!(defence.name(), name);
        assert_eq!(Defence::named(name), Ok(defence));
    }
    for (text, words) in [
        ("quilting", "jpeg, bit-depth, median, resize-pad, crops"),
        ("jpeg=0", "from 1 to 100"),
        ("median=1", "from 2 to 15"),
        ("bit-depth=x", "from 1 to 7"),
        ("resize-pad=3", "write resize-pad alone"),
    ] {
        let fault = Defence::named(text).unwrap_err();
        assert!(fault.contains(words), "{text}: {fault}");
    }
}
