//! Request for paint sheets, and the areas of a paint.

use crate::template::TemplateRequest;
use scaleproof_plot::lettering::number;

#[derive(Debug, Clone, PartialEq)]
pub struct PaintRequest {
    /// Size, paper and pattern as for a template. Overlap and bleed are ignored: the sheets have rims and are laid edge to edge.
    pub template: TemplateRequest,
    /// Minimum width of bridges and openings.
    pub min_feature_mm: f64,
    /// True to mirror the stencils, for cutting from the back side of a film.
    pub mirror: bool,
}

impl PaintRequest {
    pub fn title(&self) -> String {
        let TemplateRequest {
            pattern_name, tile_mm, ..
        } = &self.template;
        format!("Paint sheets of {pattern_name}, tile {} mm", number(*tile_mm))
    }
}

/// Areas of a paint, mm². `openings_mm2` and `bridges_mm2` add up to `cells_mm2`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PaintArea {
    pub cells_mm2: f64,
    pub openings_mm2: f64,
    /// Area to be touched up with a brush.
    pub bridges_mm2: f64,
}

impl PaintArea {
    pub fn sum(areas: &[Self]) -> Self {
        areas.iter().fold(Self::default(), |sum, area| Self {
            cells_mm2: sum.cells_mm2 + area.cells_mm2,
            openings_mm2: sum.openings_mm2 + area.openings_mm2,
            bridges_mm2: sum.bridges_mm2 + area.bridges_mm2,
        })
    }
}
