//! Painting of a model: for every piece a stencil of each paint except the one sprayed first, and its cells to paint by number.
//!
//! All stencils of a piece are at one place of their sheets and are cut from one [`material`], so that its registration holes coincide. The
//! [`regions`] of the paints are exact: the pattern's cells, clipped to each triangle and flattened with it.

mod cover;
mod material;
mod printed;
mod regions;
mod request;
mod sheets;

pub use printed::{PaintedPieces, PieceStencil};

pub use request::{PaintedError, PaintedRequest};

pub use material::Material;
pub use regions::PaintedPiece;

use std::collections::BTreeSet;

use super::flat::Piece;
use super::labels::{self, Signs};
use super::pages;
use super::seams::{self, Seam};
use crate::unwrap::Unwrapped;
use scaleproof_core::workers;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::paint::plane::{Area, PlaneOutline};
use scaleproof_print::paint::{
    Legend, MOST_CELLS, NoStencil, PaintArea, PaintError, Slant, check_features, check_pages, hole_mm, legend_sheets,
    openings_and_bridges,
};
use scaleproof_print::sheet::RectMm;
use scaleproof_print::template::{Captions, cell_mm, check_scale};
use scaleproof_print::wrap::Region;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::palette::Painted;
use scaleproof_surface::texture::Tile;

/// Area below which patches are rounding, mm².
const NOTHING_MM2: f64 = 0.01;

/// Cuts the paint of some materials of a mesh into pieces that fit on the paper with the rims of their stencils, as [`super::flattened`] does.
pub fn flattened(
    surface: (&Mesh, &[usize]),
    tile: &Tile,
    request: &PaintedRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, PaintedError> {
    check_scale(request.pieces.sheets.scale).map_err(PaintError::from)?;
    let template = request.pieces.template().tiled(tile.tile_mm());
    cell_mm(&tile.pattern, &template).map_err(PaintError::from)?;
    check_features(tile.cell_mm, tile.pattern.columns(), request.min_feature_mm)?;
    let fits_mm = pages::fits_mm(&request.pieces, request.around_mm())?;
    Ok(request.pieces.unwrapped(surface, fits_mm, progress)?)
}

/// Draws the stencils of flattened pieces, and the pieces to paint by number.
pub fn painted_pieces(
    mesh: &Mesh,
    flat: &Unwrapped,
    (tile, painted): (&Tile, &Painted),
    request: &PaintedRequest,
) -> Result<PaintedPieces, PaintedError> {
    let pieces = Piece::all(flat);
    let cells = (flat.surface_mm2() / tile.cell_mm.powi(2)).ceil() as usize;
    if cells > MOST_CELLS {
        return Err(PaintError::TooManyCells { cells }.into());
    }
    let seams = seams::seams(&pieces);
    let regions = workers::each(&pieces, |piece| regions::painted_piece((mesh, tile), painted, piece));
    let (painted, regions) = in_order(painted, regions);
    let all: Vec<usize> = (0..pieces.len()).collect();
    let made = workers::each(&all, |i| cut((*i, &pieces), &seams, &regions[*i], request));
    let made: Result<Vec<_>, _> = made.into_iter().collect();
    let (sheets, cuts): (Vec<Area>, Vec<Vec<PieceStencil>>) = made.map_err(PaintError::from)?.into_iter().unzip();
    let inks: Vec<Region> = pieces.iter().map(|piece| piece.region.clone()).collect();
    let (signs, _) = labels::signs(&pieces, &seams, &inks, &vec![None; seams.len()], request.around_mm());
    let (mut materials, mut shapes) = (Vec::new(), Vec::new());
    for (i, sheet) in sheets.into_iter().enumerate() {
        let upright = &regions[i].upright;
        shapes.push(pages::shape(&sheets::flat(&sheet, upright).grown(0.3), &signs[i]));
        materials.push(Material::new(
            sheet,
            &pieces[i],
            &signs[i],
            upright,
            request.min_feature_mm,
        ));
    }
    let taken = |frame: &PageFrame| taken(frame, request.mirror);
    let (frame, places) = pages::nested(&shapes, &pages::frames(&request.pieces)?, taken)?;
    let frames = pages::sheet_frames(&frame, &shapes, &places, &request.pieces)?;
    check_pages(painted.paints.len() - 1, frames.len())?;
    let mut made = PaintedPieces {
        areas: areas(&regions, &cuts, painted.paints.len()),
        narrow: narrow(&regions, &cuts),
        stencils: cuts.into_iter().flatten().filter(|s| !s.openings.is_empty()).collect(),
        flat: flat.clone(),
        min_feature_mm: request.min_feature_mm,
        pages: Vec::new(),
        names: Vec::new(),
        pieces,
        places,
        frame,
        painted,
        regions,
        materials,
    };
    made.stencils.sort_by_key(|stencil| stencil.paint);
    draw(&mut made, (mesh, tile), &frames, &signs, request)?;
    Ok(made)
}

/// Sorts the paints by area, the largest first, with their areas of the pieces in the same order.
fn in_order(painted: &Painted, mut regions: Vec<PaintedPiece>) -> (Painted, Vec<PaintedPiece>) {
    let doubled = |paint: usize| regions.iter().map(|r| r.areas[paint].doubled_area()).sum::<i128>();
    let sums: Vec<i128> = (0..painted.paints.len()).map(doubled).collect();
    let mut order: Vec<usize> = (0..sums.len()).collect();
    order.sort_by_key(|paint| std::cmp::Reverse(sums[*paint]));
    for PaintedPiece { areas, .. } in &mut regions {
        *areas = order.iter().map(|paint| std::mem::take(&mut areas[*paint])).collect();
    }
    (painted.in_order(&order), regions)
}

/// Returns the material of a piece, and the stencils cut from it for each paint except the first.
fn cut(
    (piece, pieces): (usize, &[Piece]),
    seams: &[Seam],
    region: &PaintedPiece,
    request: &PaintedRequest,
) -> Result<(Area, Vec<PieceStencil>), NoStencil> {
    let feature_mm = request.min_feature_mm;
    let all_from = |sheet: &Area| {
        let paints = region.areas.iter().enumerate().skip(1);
        let one = |(paint, asked): (usize, &Area)| {
            let (openings, bridges) = openings_and_bridges(asked, sheet, feature_mm, Slant::of_curved(feature_mm))?;
            Ok(PieceStencil {
                piece,
                paint,
                openings,
                bridges,
            })
        };
        paints.map(one).collect::<Result<Vec<_>, NoStencil>>()
    };
    let slit = material::sheet((piece, pieces), seams, &region.upright, feature_mm, true);
    let made = all_from(&slit);
    let whole = material::sheet((piece, pieces), seams, &region.upright, feature_mm, false);
    if slit == whole {
        return Ok((slit, made?));
    }
    // A slit sheet can fall apart when openings are cut; then the rim stays whole.
    let is_one = |stencil: &PieceStencil| slit.without(&stencil.openings).pieces.len() == slit.pieces.len();
    if let Ok(made) = made
        && made.iter().all(is_one)
    {
        return Ok((slit, made));
    }
    all_from(&whole).map(|made| (whole, made))
}

/// Returns the areas of a page taken by rulers and captions; on both sides if stencils are mirrored.
fn taken(frame: &PageFrame, mirror: bool) -> Vec<RectMm> {
    let mut taken = pages::furniture(frame);
    if mirror {
        let over = |x: f64| frame.printable.left_mm + frame.printable.right_mm - x;
        let mirrored = |r: &RectMm| RectMm::new(over(r.right_mm), r.bottom_mm, over(r.left_mm), r.top_mm);
        taken.extend(taken.iter().map(mirrored).collect::<Vec<_>>());
    }
    taken
}

fn areas(regions: &[PaintedPiece], cuts: &[Vec<PieceStencil>], paints: usize) -> Vec<PaintArea> {
    let mut areas = vec![PaintArea::default(); paints];
    for region in regions {
        for (sum, area) in areas.iter_mut().zip(&region.areas) {
            sum.cells_mm2 += area.mm2();
        }
    }
    for stencil in cuts.iter().flatten() {
        areas[stencil.paint].openings_mm2 += stencil.openings.mm2();
        areas[stencil.paint].bridges_mm2 += stencil.bridges.mm2();
    }
    areas
}

/// Returns number and area of the parts of a paint's area from which nothing is cut.
fn narrow(regions: &[PaintedPiece], cuts: &[Vec<PieceStencil>]) -> (usize, f64) {
    let key = |part: &Vec<PlaneOutline>| {
        let part = Area::from_piece(part);
        let bounds = part.bounds().map(|b| [b.left, b.bottom, b.right, b.top]);
        (bounds, part.doubled_area())
    };
    let mut sum = (0, 0.0);
    for stencil in cuts.iter().flatten() {
        let bridged: BTreeSet<_> = stencil.bridges.pieces.iter().map(key).collect();
        for part in &regions[stencil.piece].areas[stencil.paint].pieces {
            let mm2 = Area::from_piece(part).mm2();
            if mm2 > NOTHING_MM2 && bridged.contains(&key(part)) {
                sum = (sum.0 + 1, sum.1 + mm2);
            }
        }
    }
    sum
}

fn draw(
    made: &mut PaintedPieces,
    (mesh, tile): (&Mesh, &Tile),
    frames: &[PageFrame],
    signs: &[Signs],
    request: &PaintedRequest,
) -> Result<(), PaintedError> {
    let captions = Captions::of_image(&request.pieces.template(), &request.pieces.sheets.facts);
    let first = pages::cover_frame(&made.frame, &request.pieces)?;
    let cover = cover::cover(made, (mesh, tile), (&first, &captions), request);
    made.add("paint".to_owned(), cover);
    let legend = Legend {
        painted: &made.painted,
        areas: &made.areas,
        whole: "all pieces",
        notes: &[
            "dE: CIEDE2000 of the paint against the pattern's colours. Paint 1 is sprayed on everything first, without a stencil.",
            "Of the others, stencil and touch up make up the area. All areas are on paper.",
        ],
    };
    for (i, sheet) in legend_sheets(&first, &legend, &captions).into_iter().enumerate() {
        made.add(format!("legend{}", i + 1), sheet);
    }
    let drawing = sheets::Drawing {
        made,
        signs,
        captions: &captions,
        mirror: request.mirror,
        hole_mm: hole_mm(request.min_feature_mm),
    };
    for (name, sheet) in drawing.all(frames) {
        made.add(name, sheet);
    }
    Ok(())
}
