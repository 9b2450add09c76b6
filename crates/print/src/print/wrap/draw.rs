//! The panels on their sheets: pattern or texture, outline, edges, seam letters.

use std::sync::Arc;

use super::lines::{EDGE_DASH_MM, EDGE_LINE_MM, cut_line, cutter_path, moved, place};
use super::panel::Face;
use super::region::Region;
use super::seams::{CLEAR_MM, SeamMark, seams};
use super::{BLEED_MM, PaintedSurface, Panel, Point, SpreadPanel, Wrap, WrapError, WrapRequest, cover};
use crate::print::raster::{self, FlatPaint, FlatTriangle, PixelGrid, Pose};
use crate::print::sheet::{BLACK, Mark, PointMm, Sheet};
use crate::print::template::{Captions, PatternStamp, SheetPlan, TemplateRequest, cell_mm, check_scale, furniture};
use crate::print::{SheetError, printer};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::world_aligned::Side;
use scaleproof_surface::texture::Texture;

const LETTER_MM: f64 = 4.0;
const LEADER_MM: f64 = 0.15;
/// Around a panel on its sheets, for bleed and letters.
const ROOM_MM: f64 = BLEED_MM + 2.0 * CLEAR_MM;

/// `panels` are those of `paint`.
pub fn wrap(
    mesh: &Mesh,
    paint: &PaintedSurface,
    panels: Vec<Panel>,
    texture: &Texture,
    request: &WrapRequest,
) -> Result<Wrap, WrapError> {
    let grown: Vec<Region> = panels.iter().map(|panel| panel.region.grown(BLEED_MM)).collect();
    let seams = seams(paint, &panels, &grown);
    let spread = |panel: Panel| {
        let (_, layout, corner) = request.spread(panel.side, &panel.region, ROOM_MM)?;
        Ok(SpreadPanel { panel, layout, corner })
    };
    let pieces: Vec<_> = panels.into_iter().map(spread).collect::<Result<_, SheetError>>()?;
    let ink = Ink::new((mesh, paint), &pieces, texture, request)?;
    let mut made = Wrap {
        pieces,
        surface_mm2: paint.surface_mm2(),
        unlettered_mm: seams.unlettered_mm,
        cell_mm: ink.cell_mm(),
        pages: Vec::new(),
    };
    let Some(first) = made.pieces.first() else {
        return Err(WrapError::NothingToPrint);
    };
    let captions = ink.captions(&request.template(Side::Front, (100.0, 100.0)), request);
    let mut pages = vec![cover::cover(&made, &seams, first.layout.cover, &captions)];
    for (i, (piece, grown)) in made.pieces.iter().zip(&grown).enumerate() {
        let side = piece.panel.side;
        let template = request.template(side, piece.layout.size_mm());
        let drawing = Drawing {
            piece,
            grown,
            letters: seams.marks.get(&side).map_or(&[], Vec::as_slice),
            captions: ink.captions(&template, request).of_panel(side.name()),
        };
        let inks = ink.on_sheets(i, piece, request.dpi);
        let sheets = piece
            .layout
            .sheets
            .iter()
            .zip(inks)
            .map(|(plan, ink)| drawing.sheet(plan, ink))
            .collect();
        pages.extend(printer::corrected(sheets, piece.layout.frame.setup.stretch()));
    }
    made.pages = pages;
    Ok(made)
}

/// What fills the panels: the cells of a pattern, which stay sharp at any size, or pixels.
enum Ink<'a> {
    Cells {
        pattern: &'a Pattern,
        cell_mm: f64,
        tile_mm: f64,
        stamp: PatternStamp,
    },
    Pixels {
        mesh: &'a Mesh,
        texture: &'a Texture,
        /// Of each panel.
        triangles: Vec<Vec<FlatTriangle>>,
    },
}

impl<'a> Ink<'a> {
    fn new(
        (mesh, paint): (&'a Mesh, &PaintedSurface),
        pieces: &[SpreadPanel],
        texture: &'a Texture,
        request: &WrapRequest,
    ) -> Result<Self, WrapError> {
        let Texture::Tile(tile) = texture else {
            check_scale(request.scale)?;
            let sizes = pieces.iter().map(|p| p.layout.size_mm());
            raster::check(request.dpi, sizes.map(|(w, h)| w * h).sum())?;
            let of_side = |side: Side| paint.faces.iter().filter(move |face| face.side == side);
            let triangles = |p: &SpreadPanel| of_side(p.panel.side).map(flat_triangle).collect();
            return Ok(Self::Pixels {
                mesh,
                texture,
                triangles: pieces.iter().map(triangles).collect(),
            });
        };
        let largest = pieces.iter().fold((0.0f64, 0.0f64), |most, piece| {
            let size = piece.layout.size_mm();
            (most.0.max(size.0), most.1.max(size.1))
        });
        let tile_mm = tile.tile_mm();
        let cell_mm = cell_mm(&tile.pattern, &request.template(Side::Front, largest).tiled(tile_mm))?;
        let stamp = PatternStamp::new(&tile.pattern, cell_mm, largest);
        stamp.check_placements(pieces.iter().flat_map(|piece| &piece.layout.sheets))?;
        Ok(Self::Cells {
            pattern: &tile.pattern,
            cell_mm,
            tile_mm,
            stamp,
        })
    }

    fn cell_mm(&self) -> Option<f64> {
        match self {
            Self::Cells { cell_mm, .. } => Some(*cell_mm),
            Self::Pixels { .. } => None,
        }
    }

    fn captions(&self, template: &TemplateRequest, request: &WrapRequest) -> Captions {
        match self {
            Self::Cells {
                pattern,
                cell_mm,
                tile_mm,
                ..
            } => Captions::new(pattern, &template.clone().tiled(*tile_mm), *cell_mm),
            Self::Pixels { .. } => Captions::of_image(template, &request.facts),
        }
    }

    /// What fills each sheet of a panel.
    fn on_sheets(&self, i: usize, piece: &SpreadPanel, dpi: f64) -> Vec<Vec<Mark>> {
        let sheets = piece.layout.sheets.iter();
        let [left, top] = piece.corner;
        match self {
            Self::Cells { stamp, .. } => sheets.map(|plan| vec![stamp.on(plan, (-left, top))]).collect(),
            Self::Pixels {
                mesh,
                texture,
                triangles,
            } => {
                let paint = FlatPaint::new(mesh, texture, &triangles[i], &piece.panel.region, BLEED_MM);
                let grid = PixelGrid::new(piece.layout.frame.page.height_mm, dpi);
                let on_sheet = |plan: &SheetPlan| {
                    let pose = Pose::moved(piece.moved_by_mm(plan));
                    let image = paint.image(&pose, grid, BLEED_MM, plan.printed);
                    let mark = image.map(|(image, area)| {
                        let image = Arc::new(image);
                        Mark::clipped(plan.printed, vec![Mark::Image { image, area }])
                    });
                    mark.into_iter().collect()
                };
                sheets.map(on_sheet).collect()
            }
        }
    }
}

/// A face as its panel shows it.
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
    fn sheet(&self, plan: &SheetPlan, ink: Vec<Mark>) -> Sheet {
        let layout = &self.piece.layout;
        let by = self.piece.moved_by_mm(plan);
        let panel = &self.piece.panel;
        let mut lines = cut_line(&panel.region, by);
        lines.extend(panel.edges.iter().map(|[from, to]| Mark::Line {
            from: place(*from, by),
            to: place(*to, by),
            width_mm: EDGE_LINE_MM,
            dash_mm: Some(EDGE_DASH_MM),
            colour: BLACK,
        }));
        let mut marks = vec![
            Mark::Clipped {
                to: moved(self.grown.contours(), by),
                marks: ink,
            },
            Mark::clipped(plan.printed, lines),
            cutter_path(&panel.region, by, plan),
        ];
        marks.extend(self.letters.iter().flat_map(|mark| letter(mark, by, plan)));
        marks.extend(furniture::all(layout, plan, &self.captions));
        layout.frame.sheet(plan.trim, plan.printed, marks)
    }
}

/// A seam's letter and the line from it to the seam, on the sheet that shows the letter once all are glued.
fn letter(mark: &SeamMark, by: Point, plan: &SheetPlan) -> Vec<Mark> {
    let (at, trim) = (place(mark.at, by), plan.trim);
    let is_here = (trim.left_mm..trim.right_mm).contains(&at.x_mm) && (trim.bottom_mm..trim.top_mm).contains(&at.y_mm);
    if !is_here {
        return Vec::new();
    }
    let seam = place(mark.seam, by);
    let (dx, dy) = (at.x_mm - seam.x_mm, at.y_mm - seam.y_mm);
    let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let along = |mm: f64| PointMm::new(seam.x_mm + mm / length * dx, seam.y_mm + mm / length * dy);
    let leader = Mark::line(along(BLEED_MM + 0.2), along(length - 2.0), LEADER_MM);
    let size = (LETTER_MM, f64::INFINITY);
    let text = Mark::centred((at.x_mm, at.y_mm), size, mark.letter.as_str());
    if length - 2.0 > BLEED_MM + 0.5 {
        vec![leader, text]
    } else {
        vec![text]
    }
}
