//! `scaleproof print wrap` without `--panels`: the model in pieces.

use std::io::Write;

use crate::cli::answer::{told, written};
use crate::cli::print::pieces::facts;
use crate::cli::resolve::texture::NamedTexture;
use crate::cli::{CommandResult, progress};
use scaleproof_plot::lettering;
use scaleproof_print::output::SheetOutput;
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::Texture;
use scaleproof_wrap::pieces::{PiecesRequest, flattened, pieces};

pub fn run(
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

pub fn captioned(painted: &NamedTexture) -> String {
    let hash = format!("sha256 {}", painted.sha256.get(..12).unwrap_or_default());
    match &painted.texture {
        Texture::Tile(tile) => {
            format!("{hash} · tile {} mm", lettering::number(tile.tile_mm()))
        }
        _ => hash,
    }
}
