//! Corner fit of tags from any finder: sides fitted at full size, corrected for the shift of edges by blur and ink.

use super::part::Part;
use super::refine::{self, TagSides};
use super::search::{Found, Search};
use super::{SeenTag, TagDetector, TagImage, inset};
use scaleproof_core::statistics::upper_median;
use scaleproof_photo::Luma;

/// Detector of a library's search, followed by the common fit: detectors then differ in what they find, not in corner positions.
pub(super) struct WithFittedCorners<S>(pub S);

impl<S: Search> TagDetector for WithFittedCorners<S> {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        fitted(self.0.search(luma.whole()), luma)
    }
}

pub(super) fn fitted(found: Vec<Found>, luma: &dyn Luma) -> Vec<SeenTag> {
    let fits: Vec<TagFit> = found.into_iter().map(|found| TagFit::new(found, luma)).collect();
    seen(fits.iter())
}

/// Returns the tags with their fitted corners.
pub(super) fn seen<'a>(fits: impl Iterator<Item = &'a TagFit> + Clone) -> Vec<SeenTag> {
    // Blur varies little over a photo, so small tags use the inset of the larger ones.
    let insets: Vec<f64> = fits.clone().filter_map(|fit| fit.inset_px).collect();
    let usual = upper_median(&insets).unwrap_or(0.0);
    fits.map(|fit| fit.seen(usual)).collect()
}

pub(super) struct TagFit {
    pub found: Found,
    part: Part,
    /// Fitted sides, in the pixels of `part`; `None` if a side is not visible well enough.
    outline: Option<TagSides>,
    /// Distance of the lines inside the true outline; `None` if the tag is too small to tell.
    inset_px: Option<f64>,
    /// The tag with final corners, if they do not depend on other tags' insets.
    settled: Option<SeenTag>,
}

impl TagFit {
    pub(super) fn new(found: Found, luma: &dyn Luma) -> TagFit {
        let cells = found.family.cells_across();
        let part = Part::around(luma, &found.corners_px, cells, refine::REACH);
        let outline = refine::outline(&part.pixels, &part.inside(&found.corners_px), cells);
        TagFit::with(found, part, outline)
    }

    /// Creates the fit of a tag whose sides were fitted already, in a part of the image.
    pub(super) fn with(found: Found, part: Part, outline: Option<TagSides>) -> TagFit {
        let inset = |outline: &TagSides| {
            let tag = TagImage::new(found.family, found.id)?;
            inset::inset_px(&part.pixels, &outline.corners(0.0)?, &tag)
        };
        let mut fit = TagFit {
            inset_px: outline.as_ref().and_then(inset),
            outline,
            part,
            found,
            settled: None,
        };
        if fit.outline.is_none() || fit.inset_px.is_some() {
            fit.settled = Some(fit.moved(fit.inset_px.unwrap_or_default()));
        }
        fit
    }

    /// Returns true if all its sides could be fitted.
    pub(super) fn is_fitted(&self) -> bool {
        self.outline.is_some()
    }

    fn seen(&self, usual_inset_px: f64) -> SeenTag {
        self.settled.clone().unwrap_or_else(|| self.moved(usual_inset_px))
    }

    /// Returns the tag with its sides moved outwards; with the search's own corners if the sides could not be fitted.
    fn moved(&self, outwards_px: f64) -> SeenTag {
        let fitted = self.outline.as_ref().and_then(|outline| outline.corners(outwards_px));
        let corners_px = fitted.unwrap_or_else(|| self.part.inside(&self.found.corners_px));
        let in_part = SeenTag::new(self.found.family, self.found.id, corners_px, &self.part.pixels);
        SeenTag {
            corners_px: self.part.in_image(&corners_px),
            is_fitted: fitted.is_some(),
            side_blurs_px: self.outline.as_ref().map(TagSides::blurs_px),
            ..in_part
        }
    }
}
