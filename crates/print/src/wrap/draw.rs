//! Drawing of the panels on their sheets: pattern or texture, outline, edges, seam letters.

use std::sync::Arc;

use super::panel::Face;
use super::region::{Contour, Region};
use super::seams::{CLEAR_MM, SeamMark, seams};
use super::{BLEED_MM, PaintedSurface, Panel, SpreadPanel, Wrap, WrapError, WrapRequest, cover};
use crate::raster::{self, FlatPaint, FlatTriangle, PixelGrid, Pose};
use crate::sheet::{BLACK, Mark, Sheet};
use crate::template::{Captions, PatternStamp, SheetPlan, cell_mm, check_scale, furniture};
use crate::{SheetError, printer};
use scaleproof_core::geometry::Point2;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::world_aligned::Side;
use scaleproof_surface::texture::{Texture, Tile};

/// Gap between a panel's edge and its cutting line, so that none of the line stays on the piece.
const CUT_GAP_MM: f64 = 0.1;
const CUT_LINE_MM: f64 = 0.15;
/// Free paper for the cutting line around a region, with some spare.
pub const CUT_ROOM_MM: f64 = 1.0;
/// Width of the lines along edges within a panel: light, since they lie on the pattern.
pub const EDGE_LINE_MM: f64 = 0.06;
pub const EDGE_DASH_MM: (f64, f64) = (1.0, 6.0);
const LETTER_MM: f64 = 4.0;
const LEADER_MM: f64 = 0.15;
/// Room around a panel on its sheets, for bleed and letters.
const ROOM_MM: f64 = BLEED_MM + 2.0 * CLEAR_MM;

/// Draws the panels of the materials (by index; all if there are none) of a mesh in the model frame.
pub fn wrap(mesh: &Mesh, materials: &[usize], texture: &Texture, request: &WrapRequest) -> Result<Wrap, WrapError> {
    let paint = PaintedSurface::of_materials(mesh, materials);
    let panels = paint.panels();
    if panels.is_empty() {
        return Err(WrapError::NothingToPrint);
    }
    let grown: Vec<Region> = panels.iter().map(|panel| panel.region.grown(BLEED_MM)).collect();
    let seams = seams(&paint, &panels, &grown);
    let spread = |panel: Panel| {
        let (_, layout, corner) = request.spread(panel.side, &panel.region, ROOM_MM)?;
        Ok(SpreadPanel { panel, layout, corner })
    };
    let pieces: Vec<_> = panels.into_iter().map(spread).collect::<Result<_, SheetError>>()?;
    let cells = Cells::new(texture, &pieces, request)?;
    let captions = |side: Side, size_mm: (f64, f64)| {
        let template = request.template(side, size_mm);
        match &cells {
            Some(Cells { tile, cell_mm, .. }) => {
                Captions::new(&tile.pattern, &template.tiled(tile.tile_mm()), *cell_mm)
            }
            None => Captions::of_image(&template, &request.facts),
        }
    };
    let mut made = Wrap {
        pieces,
        surface_mm2: paint.surface_mm2(),
        unlettered_mm: seams.unlettered_mm,
        cell_mm: cells.as_ref().map(|cells| cells.cell_mm),
        pages: Vec::new(),
    };
    let overview = captions(Side::Front, (100.0, 100.0));
    let mut pages = vec![cover::cover(&made, &seams, made.pieces[0].layout.cover, &overview)];
    for (piece, grown) in made.pieces.iter().zip(&grown) {
        let SpreadPanel { panel, layout, corner } = piece;
        let drawing = Drawing {
            piece,
            grown,
            letters: seams.marks.get(&panel.side).map_or(&[], Vec::as_slice),
            captions: captions(panel.side, layout.size_mm()).of_panel(panel.side.name()),
        };
        let faces = paint
            .faces
            .iter()
            .filter(|face| cells.is_none() && face.side == panel.side);
        let triangles: Vec<FlatTriangle> = faces.map(flat_triangle).collect();
        let pixels = FlatPaint::new(mesh, texture, &triangles, &panel.region, BLEED_MM);
        let grid = PixelGrid::new(layout.frame.page.height_mm, request.dpi);
        let ink = |plan: &SheetPlan| match &cells {
            Some(cells) => Some(cells.stamp.on(plan, [-corner[0], corner[1]])),
            None => {
                let pose = Pose::moved(piece.moved_by_mm(plan));
                let (image, area) = pixels.image(&pose, grid, BLEED_MM, plan.printed)?;
                let image = Arc::new(image);
                Some(Mark::clipped(plan.printed, vec![Mark::Image { image, area }]))
            }
        };
        let sheets = layout.sheets.iter().map(|plan| drawing.sheet(plan, ink(plan)));
        pages.extend(printer::corrected(sheets.collect(), layout.frame.setup.stretch()));
    }
    made.pages = pages;
    Ok(made)
}

/// Cells of a pattern on the panels, which stay sharp at any size; other textures become pixels.
struct Cells<'a> {
    tile: &'a Tile,
    cell_mm: f64,
    stamp: PatternStamp,
}

impl<'a> Cells<'a> {
    /// Prepares the cells; `None` for a texture without cells. Checks that the texture can be printed in either case.
    fn new(texture: &'a Texture, pieces: &[SpreadPanel], request: &WrapRequest) -> Result<Option<Self>, WrapError> {
        let sizes = pieces.iter().map(|piece| piece.layout.size_mm());
        let Texture::Tile(tile) = texture else {
            check_scale(request.scale)?;
            raster::check(request.dpi, sizes.map(|(w, h)| w * h).sum())?;
            return Ok(None);
        };
        let largest = sizes.fold((0.0f64, 0.0f64), |most, size| (most.0.max(size.0), most.1.max(size.1)));
        let template = request.template(Side::Front, largest).tiled(tile.tile_mm());
        let cell_mm = cell_mm(&tile.pattern, &template)?;
        let stamp = PatternStamp::new(&tile.pattern, cell_mm, largest);
        stamp.check_placements(pieces.iter().flat_map(|piece| &piece.layout.sheets))?;
        Ok(Some(Self { tile, cell_mm, stamp }))
    }
}

fn flat_triangle(face: &Face) -> FlatTriangle {
    let side = face.side;
    FlatTriangle {
        flat_mm: face.corners.map(|p| side.project(&p)),
        height_mm: face.corners.map(|p| side.outward().dot(&p.coords)),
        triangle: face.index,
        weights: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }
}

struct Drawing<'a> {
    piece: &'a SpreadPanel,
    grown: &'a Region,
    letters: &'a [SeamMark],
    captions: Captions,
}

impl Drawing<'_> {
    fn sheet(&self, plan: &SheetPlan, ink: Option<Mark>) -> Sheet {
        let layout = &self.piece.layout;
        let by = self.piece.moved_by_mm(plan);
        let panel = &self.piece.panel;
        let mut lines = cut_line(&panel.region, by);
        let edges = panel.edges.iter().map(|ends| ends.map(|p| place(p, by)));
        lines.extend(edges.map(|ends| Mark::stroke(ends, EDGE_LINE_MM, Some(EDGE_DASH_MM), BLACK)));
        let mut marks = vec![
            Mark::Clipped {
                to: moved(self.grown.contours(), by),
                marks: ink.into_iter().collect(),
            },
            Mark::clipped(plan.printed, lines),
            cutter_path(&panel.region, by, plan),
        ];
        marks.extend(self.letters.iter().flat_map(|mark| letter(mark, by, plan)));
        marks.extend(furniture::all(layout, plan, &self.captions));
        layout.frame.sheet(plan.trim, plan.printed, marks)
    }
}

/// Returns the cutter path on a sheet: the part of the region's border that the sheet shows.
pub fn cutter_path(region: &Region, by: Point2, plan: &SheetPlan) -> Mark {
    let sheet = plan.printed.outline();
    let sheet = Region::union(vec![
        sheet.iter().map(|p| [0, 1].map(|axis| p[axis] - by[axis])).collect(),
    ]);
    Mark::Cut {
        outlines: moved(region.and(&sheet).contours(), by),
        is_piece: true,
    }
}

/// Draws the line around a region, outside of it.
pub fn cut_line(region: &Region, by: Point2) -> Vec<Mark> {
    let around = moved(region.grown(CUT_GAP_MM + 0.5 * CUT_LINE_MM).contours(), by);
    let lines = around
        .iter()
        .flat_map(|outline| Mark::outline(outline, CUT_LINE_MM, BLACK));
    lines.collect()
}

/// Converts a point of a plane to the page.
fn place(p: Point2, by: Point2) -> Point2 {
    [p[0] + by[0], p[1] + by[1]]
}

/// Converts outlines of a plane to the page.
pub fn moved<'a>(outlines: impl Iterator<Item = &'a Contour>, by: Point2) -> Vec<Vec<Point2>> {
    outlines
        .map(|outline| outline.iter().map(|p| place(*p, by)).collect())
        .collect()
}

/// Draws a seam's letter and the line from it to the seam, on the sheet that shows the letter once all are glued.
fn letter(mark: &SeamMark, by: Point2, plan: &SheetPlan) -> Vec<Mark> {
    let (at, trim) = (place(mark.at, by), plan.trim);
    let is_here = (trim.left_mm..trim.right_mm).contains(&at[0]) && (trim.bottom_mm..trim.top_mm).contains(&at[1]);
    if !is_here {
        return Vec::new();
    }
    let seam = place(mark.seam, by);
    let (dx, dy) = (at[0] - seam[0], at[1] - seam[1]);
    let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let along = |mm: f64| [seam[0] + mm / length * dx, seam[1] + mm / length * dy];
    let leader = Mark::line(along(BLEED_MM + 0.2), along(length - 2.0), LEADER_MM);
    let size = (LETTER_MM, f64::INFINITY);
    let text = Mark::centred(at, size, mark.letter.as_str());
    if length - 2.0 > BLEED_MM + 0.5 {
        vec![leader, text]
    } else {
        vec![text]
    }
}
