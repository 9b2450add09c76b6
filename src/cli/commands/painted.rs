//! The paint mode of `scaleproof print wrap`: stencils of every piece, and pieces to paint by number.

use std::io::Write;

use crate::cli::answer::{told, written};
use crate::cli::print::paint::{Paints, table};
use crate::cli::print::painted::facts;
use crate::cli::{CommandResult, progress};
use scaleproof_core::spelling::count;
use scaleproof_print::output::SheetOutput;
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::Texture;
use scaleproof_wrap::pieces::PiecesRequest;
use scaleproof_wrap::pieces::painted::{PaintedRequest, flattened, painted_pieces};

pub fn run(
    (model, texture, paints): (&Model, &Texture, &Paints),
    request: PiecesRequest,
    output: &SheetOutput,
    (as_json, out): (bool, &mut dyn Write),
) -> CommandResult {
    let Texture::Tile(tile) = texture else {
        return Err(
            "stencils and sheets to paint by number are made of cells, and a texture has none; give --pattern instead of --texture, as \
             scaleproof pattern import IMAGE --cells 24 makes one"
                .into(),
        );
    };
    let painted = paints.painted(&tile.pattern)?;
    let request = PaintedRequest {
        pieces: request,
        min_feature_mm: paints.min_feature_mm,
        mirror: paints.mirror,
    };
    let busy = progress::steps("unwrapping and cutting stencils", 100);
    let surface = (&model.mesh, &*model.materials);
    let flat = flattened(surface, tile, &request, &mut |share| {
        busy.set_position((60.0 * share) as u64)
    })?;
    let made = painted_pieces(&model.mesh, &flat, (tile, &painted), &request)?;
    let files = output.files(&request.title(), &made.names, &made.pages)?;
    output.write(&files)?;
    busy.set_position(100);
    busy.finish_and_clear();
    let paints = count(made.painted.paints.len(), "paint");
    let words = [
        vec![format!(
            "{}: {paints} on {}; print at 100 %",
            files[0].0.display(),
            model.in_words()
        )],
        made.facts(),
        vec![table(&made.painted, &made.areas, "all pieces")],
        vec!["paint 1 is the base coat: it is sprayed on everything first, without a stencil".to_owned()],
    ];
    let words = words.concat().join("\n");
    told(as_json, written(&files, facts(model, &made)), words, out)
}
