//! Perceptual hash for finding copies of a photo; another encoding, size or exposure hardly changes it.

use image::RgbImage;

use super::resize::boxed;

/// Number of gradients across and down.
const SIDE: u32 = 16;

/// Hash of 256 bits; those of copies are nearly the same.
pub type PerceptualHash = [u64; 4];

/// Computes the difference hash of an image (dHash; Krawetz, "Kind of Like That", hackerfactor.com, 2013): reduced to 17 × 16 pixels, one bit for
/// each pixel that is darker than its right neighbour.
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

/// Returns the number of bits that differ between two hashes: 0 for copies, about half of all for unrelated images.
pub fn bits_apart(a: &PerceptualHash, b: &PerceptualHash) -> u32 {
    a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
}
