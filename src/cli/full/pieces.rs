//! `scaleproof print wrap` without `--panels`: the model in pieces.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::CommandResult;
use crate::cli::answer::{told, written};
use crate::cli::full::texture::NamedTexture;
use crate::cli::progress;
use scaleproof_plot::lettering;
use scaleproof_print::output::SheetOutput;
use scaleproof_print::wrap::WrapRequest;
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::Texture;
use scaleproof_wrap::pieces::{Piece, PiecesRequest, Place, PrintedPieces, flattened, pieces, reason};
use scaleproof_wrap::unwrap::{LeftOut, UnwrapRequest};

/// How the model is cut into pieces, and what is printed of them.
#[derive(clap::Args)]
pub(crate) struct PiecesArgs {
    /// Print five panels instead: the model's sides as they are seen straight on, which is exact for a box
    #[arg(long, conflicts_with_all = ["pieces", "max_stretch", "mean_stretch", "tabs", "paint"])]
    pub(super) panels: bool,
    /// At most so many pieces; up to 3 % of the paint, the smallest parts, may be left out for it
    #[arg(long, value_name = "N", default_value_t = 24)]
    pieces: usize,
    /// The stretch (mm on the surface for 1 mm on paper, or the inverse) that 99 % of the paint stay below
    #[arg(long, value_name = "RATIO", default_value_t = 1.2, allow_negative_numbers = true)]
    max_stretch: f64,
    /// The mean stretch
    #[arg(long, value_name = "RATIO", default_value_t = 1.03, allow_negative_numbers = true)]
    mean_stretch: f64,
    /// Glue tabs on one side of each seam, this wide in mm
    #[arg(long, value_name = "MM", num_args = 0..=1, default_missing_value = "6", allow_negative_numbers = true, conflicts_with = "paint")]
    tabs: Option<f64>,
    /// Pixels per inch of the printed texture
    #[arg(
        long,
        value_name = "DPI",
        default_value_t = 300.0,
        allow_negative_numbers = true,
        conflicts_with = "paint"
    )]
    pub(super) dpi: f64,
}

impl PiecesArgs {
    /// What is printed of a painted model.
    pub(super) fn request(&self, sheets: WrapRequest) -> PiecesRequest {
        let unwrap = UnwrapRequest {
            most_pieces: Some(self.pieces),
            mean_stretch: self.mean_stretch,
            stretch_99: self.max_stretch,
            ..UnwrapRequest::default()
        };
        PiecesRequest {
            unwrap,
            tabs_mm: self.tabs,
            sheets,
        }
    }
}

pub(super) fn run(
    (model, painted): (&Model, &NamedTexture),
    request: &PiecesRequest,
    output: &SheetOutput,
    (as_json, out): (bool, &mut dyn Write),
) -> CommandResult {
    let busy = progress::steps("unwrapping", 100);
    let surface = (&model.mesh, &*model.materials);
    // Drawing takes a little, too.
    let flat = flattened(surface, request, &mut |share| busy.set_position((95.0 * share) as u64))?;
    let made = pieces(&model.mesh, &flat, &painted.texture, request)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    output.write(&files)?;
    busy.set_position(100);
    busy.finish_and_clear();
    if made.unlettered_mm > 0.0 {
        let length_mm = made.unlettered_mm;
        say!("note: {length_mm:.0} mm of seams have no letter on one of their pieces, as there is no room beside it");
    }
    let head = format!(
        "{}: instructions and pieces of {}; print at 100 %",
        files[0].0.display(),
        model.in_words()
    );
    let words = [vec![head], made.facts()].concat().join("\n");
    told(as_json, written(&files, facts(model, &made)), words, out)
}

pub(super) fn captioned(painted: &NamedTexture) -> String {
    let hash = format!("sha256 {}", painted.sha256.get(..12).unwrap_or_default());
    match &painted.texture {
        Texture::Tile(tile) => {
            format!("{hash} · tile {} mm", lettering::number(tile.tile_mm()))
        }
        _ => hash,
    }
}

/// `print wrap --json`. Lengths over others are mm on the surface for 1 mm on paper, or the inverse.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct PiecesAnswer {
    /// Length, width, height.
    model_size_mm: [f64; 3],
    pieces: Vec<PieceAnswer>,
    /// Sheets that carry pieces.
    sheets: usize,
    /// Width and height of a page.
    page_mm: [f64; 2],
    seams: usize,
    /// Length of the seams without a letter on one of their pieces.
    unlettered_mm: f64,
    /// Length of all that is cut.
    cut_mm: f64,
    /// Of all pieces.
    surface_mm2: f64,
    /// Paint that can be seen from outside.
    visible_mm2: f64,
    left_out: Vec<LeftOutPaint>,
    /// Mean by area.
    mean_stretch: f64,
    /// 99th percentile.
    stretch_99: f64,
    largest_stretch: f64,
}

/// A piece of the model's surface.
#[derive(Serialize, JsonSchema)]
pub(super) struct PieceAnswer {
    /// Its number, from 1.
    piece: usize,
    /// The sheet it is on, from 1.
    sheet: usize,
    /// Area of the surface.
    surface_mm2: f64,
    /// Area on paper.
    flat_mm2: f64,
}

/// Paint on no piece.
#[derive(Serialize, JsonSchema)]
pub(super) struct LeftOutPaint {
    surface_mm2: f64,
    triangles: usize,
    reason: &'static str,
}

fn facts(model: &Model, made: &PrintedPieces) -> PiecesAnswer {
    PiecesAnswer {
        model_size_mm: model.mesh.size_mm(),
        pieces: each(&made.pieces, &made.places).collect(),
        sheets: made.sheets(),
        page_mm: [made.frame.page.width_mm, made.frame.page.height_mm],
        seams: made.seams.len(),
        unlettered_mm: made.unlettered_mm,
        cut_mm: made.cut_mm(),
        surface_mm2: made.flat.surface_mm2(),
        visible_mm2: made.flat.visible_mm2,
        left_out: left_out(&made.flat.left_out),
        mean_stretch: made.flat.mean_stretch,
        stretch_99: made.flat.stretch_99,
        largest_stretch: made.flat.largest_stretch,
    }
}

pub(super) fn each(pieces: &[Piece], places: &[Place]) -> impl Iterator<Item = PieceAnswer> {
    let placed = pieces.iter().zip(places).enumerate();
    placed.map(|(i, (piece, place))| PieceAnswer {
        piece: i + 1,
        sheet: place.page + 1,
        surface_mm2: piece.surface_mm2,
        flat_mm2: piece.region.area_mm2(),
    })
}

/// Paint that is on no piece, and why.
pub(super) fn left_out(parts: &[LeftOut]) -> Vec<LeftOutPaint> {
    let part = |part: &LeftOut| LeftOutPaint {
        surface_mm2: part.surface_mm2,
        triangles: part.triangles.len(),
        reason: reason(part.reason),
    };
    parts.iter().map(part).collect()
}
