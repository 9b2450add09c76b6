//! The default: tags are found on a reduced picture, their corners fitted at full size.

use image::GrayImage;

use super::apriltag_c::{AprilTagC, Found};
use super::refine::{self, Outline};
use super::{SeenTag, StartError, TagDetector, TagImage, cells_across, inset};
use crate::scene::TagFamily;

/// The long side of the picture that is searched. Below it nothing is reduced.
const SEARCHED_PX: u32 = 1600;

/// With so many whole tags a pose is beyond doubt, and the small ones that a reduced picture hides are not missed.
const ENOUGH_TAGS: usize = 2;

/// C AprilTag on a reduced picture, and our own corners. Holds C memory, so each thread makes its own.
pub struct CoarseToFine {
    search: AprilTagC,
}

impl CoarseToFine {
    /// A detector for some families.
    pub fn new(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            search: AprilTagC::new(families)?,
        })
    }

    fn find_reduced(&mut self, grey: &GrayImage, factor: u32) -> Vec<SeenTag> {
        let found = match factor {
            1 => self.search.search(grey),
            _ => self.search.search(&reduced(grey, factor)),
        };
        refined(found, factor, grey)
    }
}

impl TagDetector for CoarseToFine {
    fn find(&mut self, grey: &GrayImage) -> Vec<SeenTag> {
        let factor = grey.width().max(grey.height()).div_ceil(SEARCHED_PX);
        let tags = self.find_reduced(grey, factor);
        if factor > 1 && tags.iter().filter(|tag| tag.is_whole).count() < ENOUGH_TAGS {
            return self.find_reduced(grey, 1);
        }
        tags
    }
}

/// The tags of the reduced picture with their corners fitted at full size.
fn refined(found: Vec<Found>, factor: u32, grey: &GrayImage) -> Vec<SeenTag> {
    let fits: Vec<Fit> = found.into_iter().map(|found| Fit::new(found, factor, grey)).collect();
    // Blur is much the same all over a photo, so small tags are told what the larger ones show.
    let usual = median(fits.iter().filter_map(|fit| fit.inset_px).collect()).unwrap_or(0.0);
    fits.into_iter().map(|fit| fit.seen(usual, grey)).collect()
}

/// A tag and the lines along its sides.
struct Fit {
    found: Found,
    /// `None` where some side cannot be seen well enough.
    outline: Option<Outline>,
    /// How far the lines lie inside the true outline; `None` where the tag is too small to tell.
    inset_px: Option<f64>,
}

impl Fit {
    fn new(mut found: Found, factor: u32, grey: &GrayImage) -> Fit {
        let f = f64::from(factor);
        // Pixel 0 of the reduced picture covers pixels 0 to factor − 1.
        found.corners_px = found.corners_px.map(|corner| corner.map(|v| (v + 0.5) * f - 0.5));
        let outline = refine::outline(grey, &found.corners_px, cells_across(found.family));
        let inset = |outline: &Outline| {
            let tag = TagImage::new(found.family, found.id)?;
            inset::inset_px(grey, &outline.corners(0.0)?, &tag)
        };
        Fit {
            inset_px: outline.as_ref().and_then(inset),
            outline,
            found,
        }
    }

    /// The search's own corners stay where the sides could not be fitted.
    fn seen(&self, usual_inset_px: f64, grey: &GrayImage) -> SeenTag {
        let inset = self.inset_px.unwrap_or(usual_inset_px);
        let corners = self.outline.as_ref().and_then(|outline| outline.corners(inset));
        SeenTag::new(
            self.found.family,
            self.found.id,
            corners.unwrap_or(self.found.corners_px),
            grey,
        )
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Means over squares of `factor` × `factor` pixels; a rest at the right and at the bottom is left out.
fn reduced(grey: &GrayImage, factor: u32) -> GrayImage {
    let (width, height) = (grey.width() / factor, grey.height() / factor);
    let (f, w) = (factor as usize, width as usize);
    let stride = grey.width() as usize;
    let mut bytes = Vec::with_capacity(w * height as usize);
    let mut sums = vec![0u32; w];
    for rows in grey.as_raw().chunks_exact(stride * f) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, pixels) in sums.iter_mut().zip(row.chunks_exact(f)) {
                *sum += pixels.iter().map(|p| u32::from(*p)).sum::<u32>();
            }
        }
        let area = factor * factor;
        bytes.extend(sums.iter().map(|sum| ((sum + area / 2) / area) as u8));
    }
    GrayImage::from_raw(width, height, bytes).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reducing_takes_means_and_leaves_the_rest_out() {
        let picture = GrayImage::from_fn(7, 5, |x, y| image::Luma([(10 * x + y) as u8]));
        let small = reduced(&picture, 2);
        assert_eq!(small.dimensions(), (3, 2));
        assert_eq!(small.as_raw(), &[6, 26, 46, 8, 28, 48]); // 5.5 and so on, rounded up
    }
}
