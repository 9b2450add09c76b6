//! The corners of found tags, whoever found them: sides fitted at full size, moved by what blur and ink do to every edge.

use super::part::Part;
use super::refine::{self, TagSides};
use super::search::{Found, Search};
use super::{SeenTag, TagDetector, TagImage, inset};
use scaleproof_core::statistics::upper_median;
use scaleproof_photo::photo::Luma;

/// A library's search, followed by the fit: detectors then differ in what they find, not in where its corners are.
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

/// The tags with the corners of their fits.
pub(super) fn seen<'a>(fits: impl Iterator<Item = &'a TagFit> + Clone) -> Vec<SeenTag> {
    // Blur is much the same all over a photo, so small tags take what the larger ones show.
    let insets: Vec<f64> = fits.clone().filter_map(|fit| fit.inset_px).collect();
    let usual = upper_median(&insets).unwrap_or(0.0);
    fits.map(|fit| fit.seen(usual)).collect()
}

pub(super) struct TagFit {
    pub found: Found,
    part: Part,
    /// In the part; `None` where some side cannot be seen well enough.
    outline: Option<TagSides>,
    /// How far the lines lie inside the true outline; `None` where the tag is too small to tell.
    inset_px: Option<f64>,
    /// The tag, where no other one's inset moves its corners.
    settled: Option<SeenTag>,
}

impl TagFit {
    pub(super) fn new(found: Found, luma: &dyn Luma) -> TagFit {
        let cells = found.family.cells_across();
        let part = Part::around(luma, &found.corners_px, cells, refine::REACH);
        let outline = refine::outline(&part.pixels, &part.inside(&found.corners_px), cells);
        TagFit::with(found, part, outline)
    }

    /// Of a tag whose sides were fitted already, in a part of the image.
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

    /// Whether all its sides were seen well enough.
    pub(super) fn is_fitted(&self) -> bool {
        self.outline.is_some()
    }

    fn seen(&self, usual_inset_px: f64) -> SeenTag {
        self.settled.clone().unwrap_or_else(|| self.moved(usual_inset_px))
    }

    /// The tag with its sides moved outwards. The search's own corners stay where the sides could not be fitted.
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
