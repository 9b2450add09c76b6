//! Whether two images are copies of one photo: a perceptual hash, which another encoding, size or exposure hardly changes.

use image::RgbImage;

use super::resize::boxed;

/// The hash's gradients: so many across and down.
const SIDE: u32 = 16;

/// 256 bits; those of copies are nearly the same.
pub type PerceptualHash = [u64; 4];

/// The difference hash of an image (dHash; Krawetz, "Kind of Like That", hackerfactor.com, 2013): reduced to 17 × 16 pixels, one bit for each pixel that is darker than its
/// right neighbour.
pub fn perceptual_hash(image: &RgbImage) -> PerceptualHash {
    let small = boxed(image, [SIDE + 1, SIDE]);
    // Rec. 601 luma, in thousandths.
    let luma = |x, y| {
        let [r, g, b] = small
            .get_pixel_checked(x, y)
            .map_or([0; 3], |pixel| pixel.0.map(u32::from));
        299 * r + 587 * g + 114 * b
    };
    let mut bits = PerceptualHash::default();
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        bits[i as usize / 64] |= u64::from(luma(x, y) < luma(x + 1, y)) << (i % 64);
    }
    bits
}

/// How many bits of two hashes differ: 0 for copies, about half of all for images that have nothing in common.
pub fn bits_apart(a: &PerceptualHash, b: &PerceptualHash) -> u32 {
    a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
}
