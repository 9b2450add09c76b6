//! Printing of finished patch textures for the panels of a model: their places, and each as a piece to cut out, at true size.

use std::sync::Arc;

use super::sheet::{Fill, Mark, RectMm, Sheet, Stamp};
use super::template::{TemplateError, check_scale, furniture};
use super::wrap::{Panel, Region, WrapRequest, cut_line, cutter_path, moved, moved_by_mm};
use super::{SheetError, printer};
use scaleproof_core::geometry::Point2;
use scaleproof_core::geometry::length::{self, BadLength, shown};
use scaleproof_plot::lettering::number;
use scaleproof_surface::pattern::picture::{Picture, PictureError};
use scaleproof_surface::pattern::world_aligned::Side;

/// Maximum number of pixels per side up to which every pixel is drawn as a rectangle; larger images are embedded.
const MAX_RECTANGLES: u32 = 128;
/// Room around a piece on its sheets for the cutting line.
const ROOM_MM: f64 = 3.0;
const EDGE_LINE_MM: f64 = 0.1;
/// Share of a patch off its panel below which it is rounding.
const LEAST_SHARE: f64 = 1e-6;

/// Reason why no patches were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PatchError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Scale(#[from] TemplateError),
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error("the patch {path} cannot be used ({reason})", path = .0.path.display(), reason = .0.reason)]
    BadImage(#[from] PictureError),
    #[error("patch {what} cannot be {}; give a width and height of 1 to 10000 mm", shown(*value))]
    Size { what: &'static str, value: f64 },
    #[error("the paint has no {side} panel; choose another panel or other materials")]
    NoPanel { side: &'static str },
    #[error(
        "the patch lies wholly beside the {side} panel, which reaches from {low_mm} to {high_mm} mm (right, up); give a place on it"
    )]
    OffPanel {
        side: &'static str,
        low_mm: String,
        high_mm: String,
    },
}

#[derive(Debug, Clone)]
pub struct PanelPatch {
    /// Name in the captions: its file name.
    pub name: String,
    /// Image, printed unchanged.
    pub image: Picture,
    pub side: Side,
    /// Centre in the panel's plane: (u, v), see [`Side`].
    pub at_mm: Point2,
    pub size_mm: (f64, f64),
}

impl PanelPatch {
    fn mark(&self, stamp: Option<&Arc<Stamp>>, area: RectMm) -> Mark {
        match stamp {
            Some(stamp) => Mark::Stamped {
                stamp: Arc::clone(stamp),
                at: vec![[area.left_mm, area.top_mm]],
                clip: area,
            },
            None => Mark::Image {
                image: Arc::clone(&self.image.pixels),
                area,
            },
        }
    }

    /// Returns a stamp with every pixel as a rectangle, if they are few. Frame: origin at the top-left corner, y up.
    fn stamp(&self) -> Option<Arc<Stamp>> {
        let (columns, rows) = self.image.pixels.dimensions();
        if columns > MAX_RECTANGLES || rows > MAX_RECTANGLES {
            return None;
        }
        let (width_mm, height_mm) = self.size_mm;
        let (wide, high) = (width_mm / f64::from(columns), height_mm / f64::from(rows));
        // Each extends under its right and its lower neighbour, which cover it: no white hairlines.
        let fill = |(column, row, pixel): (u32, u32, &image::Rgb<u8>)| {
            let (left, top) = (f64::from(column) * wide, -f64::from(row) * high);
            Fill {
                area: RectMm::new(left, top - 1.25 * high, left + 1.25 * wide, top),
                colour: pixel.0,
            }
        };
        Some(Arc::new(Stamp {
            bounds: RectMm::new(0.0, -height_mm - 0.25 * high, width_mm + 0.25 * wide, 0.0),
            fills: self.image.pixels.enumerate_pixels().map(fill).collect(),
        }))
    }

    fn area(&self) -> RectMm {
        let ([u, v], (width, height)) = (self.at_mm, self.size_mm);
        RectMm::new(u - 0.5 * width, v - 0.5 * height, u + 0.5 * width, v + 0.5 * height)
    }

    /// Returns size, place and hash, for the caption.
    fn fact(&self) -> String {
        let [width, height, u, v] = [self.size_mm.0, self.size_mm.1, self.at_mm[0], self.at_mm[1]].map(number);
        format!(
            "{width} × {height} mm on the {} panel at {u}, {v} mm, sha256 {}",
            self.side.name(),
            self.image.sha256.get(..12).unwrap_or_default()
        )
    }

    fn region(&self) -> Region {
        Region::union(vec![self.area().outline()])
    }
}

#[derive(Debug, Clone, Default)]
pub struct Patches {
    /// Sheets for each patch: with it in its place on its panel's outline, unless an earlier patch has shown that panel, then the patch as a piece.
    /// Corrected for the printer.
    pub pages: Vec<Sheet>,
    pub page_names: Vec<String>,
    /// Share of each patch's area that lies beyond its panel's outline.
    pub off_panel: Vec<f64>,
}

/// Draws patches on the panels of a model.
pub fn patches(panels: &[Panel], patches: &[PanelPatch], request: &WrapRequest) -> Result<Patches, PatchError> {
    check_scale(request.scale)?;
    // All are checked before the first is drawn: a panel's sheets show every patch on it.
    patches.iter().try_for_each(check)?;
    let mut made = Patches::default();
    let mut shown = Vec::new();
    for (i, patch) in patches.iter().enumerate() {
        let side = patch.side.name();
        let panel = panels.iter().find(|panel| panel.side == patch.side);
        let panel = panel.ok_or(PatchError::NoPanel { side })?;
        let whole = patch.region();
        let cut = whole.and(&panel.region);
        let off = 1.0 - cut.area_mm2() / whole.area_mm2();
        if cut.is_empty() || off > 1.0 - LEAST_SHARE {
            let (low, high) = panel.region.bounds().unwrap_or_default();
            return Err(PatchError::OffPanel {
                side,
                low_mm: format!("{:.0},{:.0}", low[0], low[1]),
                high_mm: format!("{:.0},{:.0}", high[0], high[1]),
            });
        }
        made.off_panel.push(if off < LEAST_SHARE { 0.0 } else { off });
        if !shown.contains(&patch.side) {
            shown.push(patch.side);
            let here: Vec<&PanelPatch> = patches.iter().filter(|p| p.side == patch.side).collect();
            made.draw(side, &panel.region, &panel.edges, &here, request)?;
        }
        made.draw(&format!("patch{}", i + 1), &cut, &[], &[patch], request)?;
    }
    Ok(made)
}

/// Returns an error for a patch with an impossible place or size.
pub fn check(patch: &PanelPatch) -> Result<(), PatchError> {
    for (what, value) in [("width", patch.size_mm.0), ("height", patch.size_mm.1)] {
        if !(1.0..=10_000.0).contains(&value) {
            return Err(PatchError::Size { what, value });
        }
    }
    for at in patch.at_mm {
        length::place_mm("patch place", at)?;
    }
    Ok(())
}

impl Patches {
    /// Draws a region with the patches on it, over as many sheets as needed.
    fn draw(
        &mut self,
        name: &str,
        region: &Region,
        edges: &[[Point2; 2]],
        on_it: &[&PanelPatch],
        request: &WrapRequest,
    ) -> Result<(), SheetError> {
        let named = WrapRequest {
            name: on_it.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", "),
            ..request.clone()
        };
        let (template, layout, corner) = named.spread(on_it[0].side, region, ROOM_MM)?;
        let facts = on_it.iter().map(|p| p.fact()).collect::<Vec<_>>().join(" · ");
        let captions = furniture::Captions::of_image(&template, &facts).of_piece(name);
        let stamps: Vec<_> = on_it.iter().map(|p| p.stamp()).collect();
        let mut sheets = Vec::new();
        for plan in &layout.sheets {
            let by = moved_by_mm(plan, corner);
            let images = on_it.iter().zip(&stamps);
            let images = images.map(|(patch, stamp)| patch.mark(stamp.as_ref(), patch.area().moved(by)));
            let at = |p: &Point2| [p[0] + by[0], p[1] + by[1]];
            let mut content = vec![Mark::Clipped {
                to: moved(region.contours(), by),
                marks: images.collect(),
            }];
            content.extend(edges.iter().map(|[a, b]| Mark::line(at(a), at(b), EDGE_LINE_MM)));
            content.extend(cut_line(region, by));
            let mut marks = vec![Mark::clipped(plan.printed, content)];
            marks.push(cutter_path(region, by, plan));
            marks.extend(furniture::all(&layout, plan, &captions));
            sheets.push(layout.frame.sheet(plan.trim, plan.printed, marks));
            self.page_names.push(format!("{name}-{}", plan.id()));
        }
        self.pages
            .extend(printer::corrected(sheets, layout.frame.setup.stretch()));
        Ok(())
    }
}
