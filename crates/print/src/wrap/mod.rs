//! Pattern or texture as five panels of a model: left, right, roof, front and rear, each at true size, cut to the model's outline.
//!
//! A surface belongs to the side nearest to its normal and is printed only on that panel; the panel is its projection along that axis. So each point
//! has the colour of [`WorldAligned`](scaleproof_surface::pattern::world_aligned::WorldAligned), and [`scaleproof_surface::pattern::world_aligned`]
//! defines the pattern's orientation on each side. The errors of the projection are reported: sloping surfaces are longer than their paper
//! ([`Panel::largest_stretch`]), and layers behind each other share one print ([`Panel::hidden_mm2`]).

mod cover;
mod draw;
mod panel;
mod region;
mod seams;

pub use draw::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, cut_line, cutter_path, moved, wrap};
pub use panel::{Face, PRINTED, PaintedSurface, Panel};
pub use region::{Contour, Point, Region, corners};

use super::SheetError;
use super::media::Media;
use super::paper::Orientation;
use super::raster::RasterError;
use super::sheet::Sheet;
use super::template::{Front, LayoutRequest, SheetLayout, SheetPlan, TemplateError, TemplateRequest, layout};
use scaleproof_core::spelling::count;
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
    pub(super) fn spread(
        &self,
        side: Side,
        region: &Region,
        room_mm: f64,
    ) -> Result<(TemplateRequest, SheetLayout, Point), SheetError> {
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

#[derive(Debug, Clone)]
pub struct SpreadPanel {
    pub panel: Panel,
    pub layout: SheetLayout,
    /// (u, v) of the top-left corner of the layout's template, mm.
    pub corner: Point,
}

impl SpreadPanel {
    /// Returns the page position of (u, v) = (0, 0) on a sheet: the offset from the plane to the page.
    pub fn moved_by_mm(&self, plan: &SheetPlan) -> Point {
        moved_by_mm(plan, self.corner)
    }
}

/// Returns the page position of (u, v) = (0, 0) on a sheet whose template's top-left corner is at `corner` of the plane.
pub(super) fn moved_by_mm(plan: &SheetPlan, corner: Point) -> Point {
    [
        plan.printed.left_mm - plan.carried.left_mm - corner[0],
        plan.printed.top_mm + plan.carried.top_mm - corner[1],
    ]
}

#[derive(Debug, Clone)]
pub struct Wrap {
    pub pieces: Vec<SpreadPanel>,
    /// Area of the paint on the surface.
    pub surface_mm2: f64,
    /// Length of the seams between panels without room for a letter.
    pub unlettered_mm: f64,
    pub cell_mm: Option<f64>,
    /// The instructions, then the sheets of each piece, corrected for the printer.
    pub pages: Vec<Sheet>,
}

impl Wrap {
    /// Returns a name for each page, used if it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let mut names = vec!["assembly".to_owned()];
        for SpreadPanel { panel, layout, .. } in &self.pieces {
            let name = |plan: &SheetPlan| format!("{}-{}", panel.side.name(), plan.id());
            names.extend(layout.sheets.iter().map(name));
        }
        names
    }

    /// Returns the largest length on the surface for 1 mm on paper.
    pub fn largest_stretch(&self) -> f64 {
        self.pieces.iter().map(|p| p.panel.largest_stretch).fold(1.0, f64::max)
    }

    /// Returns the area of the surface over its area on paper, every layer counted.
    pub fn mean_stretch(&self) -> f64 {
        let sum = |of: fn(&Panel) -> f64| self.pieces.iter().map(|p| of(&p.panel)).sum::<f64>();
        sum(|p| p.surface_mm2) / sum(|p| p.projected_mm2)
    }

    /// Returns the area of the paint that faces down and is on no panel.
    pub fn unprinted_mm2(&self) -> f64 {
        let printed = self.pieces.iter().map(|p| p.panel.surface_mm2).sum::<f64>();
        (self.surface_mm2 - printed).max(0.0)
    }

    pub fn facts(&self) -> Vec<String> {
        let cm2 = |mm2: f64| format!("{:.1} cm²", mm2 / 100.0);
        let mut facts: Vec<String> = Vec::new();
        for SpreadPanel { panel, layout, .. } in &self.pieces {
            let sheets = count(layout.sheets.len(), "sheet");
            let hidden = match panel.hidden_mm2() {
                mm2 if mm2 < 1.0 => String::new(),
                mm2 => format!(", {mm2:.0} mm² lie behind it and are printed with it"),
            };
            facts.push(format!(
                "{}: {} on paper for {} of surface, stretch up to {:.2}{hidden}, {sheets}",
                panel.side.name(),
                cm2(panel.flat_mm2()),
                cm2(panel.surface_mm2),
                panel.largest_stretch,
            ));
        }
        facts.push(format!(
            "largest stretch {:.2}, mean {:.3} (mm on the surface for 1 mm on paper); {:.1} % of the paint ({}) looks down and is on no \
             panel",
            self.largest_stretch(),
            self.mean_stretch(),
            100.0 * self.unprinted_mm2() / self.surface_mm2,
            cm2(self.unprinted_mm2()),
        ));
        facts
    }
}
