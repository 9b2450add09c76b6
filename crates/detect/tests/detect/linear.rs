//! Resizing as OpenCV does, held against OpenCV.

use image::RgbImage;
use scaleproof_photo::{opencv_cubic, opencv_linear};

use opencv::core::{Mat, Size};
use opencv::imgproc;
use opencv::prelude::*;
use proptest::prelude::*;

fn by_opencv(photo: &RgbImage, [width, height]: [u32; 2], kernel: i32) -> Vec<u8> {
    let flat = Mat::from_slice(photo.as_raw().as_slice()).unwrap();
    let source = flat.reshape(3, photo.height() as i32).unwrap();
    let (size, mut resized) = (Size::new(width as i32, height as i32), Mat::default());
    imgproc::resize(&source, &mut resized, size, 0.0, 0.0, kernel).unwrap();
    resized.data_bytes().unwrap().to_vec()
}

fn noise(width: u32, height: u32, seed: u32) -> RgbImage {
    let mut state = seed | 1;
    RgbImage::from_fn(width, height, |_, _| {
        image::Rgb([0; 3].map(|_: u8| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        }))
    })
}

/// Two pixels to a column: a case that failed once.
#[test]
fn a_row_that_becomes_a_column_is_opencvs() {
    let photo = noise(2, 1, 490_256_226);
    assert_eq!(
        opencv_linear(&photo, [1, 2]).into_raw(),
        by_opencv(&photo, [1, 2], imgproc::INTER_LINEAR)
    );
}

proptest! {
    /// Smaller, larger, halved, one side only: noise shows every rounding.
    #[test]
    fn every_byte_is_opencvs(
        from in prop::array::uniform2(1..150_u32), to in prop::array::uniform2(1..150_u32), kind in 0..4_u8, seed in any::<u32>(),
    ) {
        let from = match kind {
            0 => to.map(|side| 2 * side),
            1 => [2 * to[0], from[1]],
            2 => [from[0], to[1]],
            _ => from,
        };
        let photo = noise(from[0], from[1], seed);
        prop_assert_eq!(opencv_linear(&photo, to).into_raw(), by_opencv(&photo, to, imgproc::INTER_LINEAR), "{:?} to {:?}", from, to);
        // Debian's OpenCV rounds weights to 1/2048.
        let (ours, theirs) = (opencv_cubic(&photo, to).into_raw(), by_opencv(&photo, to, imgproc::INTER_CUBIC));
        let worst = ours.iter().zip(&theirs).map(|(a, b)| a.abs_diff(*b)).max();
        prop_assert!(ours.len() == theirs.len() && worst <= Some(1), "{:?} to {:?}: {:?}", from, to, worst);
    }
}
