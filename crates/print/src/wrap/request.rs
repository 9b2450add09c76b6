//! Request for the panels of a model.

use super::region::Region;
use crate::SheetError;
use crate::media::Media;
use crate::paper::Orientation;
use crate::raster::RasterError;
use crate::template::{Front, LayoutRequest, SheetLayout, TemplateError, TemplateRequest, layout};
use scaleproof_core::geometry::Point2;
use scaleproof_surface::pattern::world_aligned::Side;

/// Extension of the pattern beyond a panel's outline.
pub const BLEED_MM: f64 = 2.0;

/// Reason why no panels were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WrapError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Template(#[from] TemplateError),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error(
        "the paint has no surface on any of the five sides; name other materials, or check which way up the mesh is"
    )]
    NothingToPrint,
}

/// A request for the panels of a model. All lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct WrapRequest {
    /// Scale of the model, 1:`scale`; only for the captions.
    pub scale: f64,
    /// Name of the pattern or texture in the captions: its file name.
    pub name: String,
    /// Description of a texture without cells, for the captions.
    pub facts: String,
    /// Pixels per inch of such a texture.
    pub dpi: f64,
    /// Width of the strip that neighbouring sheets of a panel share.
    pub overlap_mm: f64,
    pub media: Media,
}

impl WrapRequest {
    pub fn title(&self) -> String {
        format!("Panels of {}", self.name)
    }

    /// Lays out a region of a side, with some room around it, on sheets: returns its template, their layout, and (u, v) of the template's top-left
    /// corner.
    pub(crate) fn spread(
        &self,
        side: Side,
        region: &Region,
        room_mm: f64,
    ) -> Result<(TemplateRequest, SheetLayout, Point2), SheetError> {
        let (low, high) = region.bounds().unwrap_or_default();
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * room_mm);
        let template = self.template(side, (width, height));
        let layout = layout(&template.layout)?;
        Ok((template, layout, [low[0] - room_mm, high[1] + room_mm]))
    }

    pub fn template(&self, side: Side, size_mm: (f64, f64)) -> TemplateRequest {
        let front = match side {
            Side::Left => Front::Left,
            Side::Right => Front::Right,
            Side::Roof => Front::Up,
            Side::Front | Side::Rear | Side::Bottom => Front::None,
        };
        TemplateRequest {
            // A placeholder: patterns with cells replace it by their own ([`TemplateRequest::tiled`]).
            tile_mm: 1.0,
            scale: self.scale,
            pattern_name: self.name.clone(),
            front,
            layout: LayoutRequest {
                size_mm,
                media: self.media,
                orientation: Orientation::Auto,
                overlap_mm: self.overlap_mm,
                // The pattern extends beyond the panel's outline, not beyond the sheets'.
                bleed_mm: 0.0,
            },
        }
    }
}
