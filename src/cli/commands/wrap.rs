//! `scaleproof print wrap`: a pattern on a model, in pieces or as panels.

use std::error::Error;
use std::io::Write;

use crate::cli::answer::{told, written};
use crate::cli::args::wrap::WrapArgs;
use crate::cli::commands::{painted, pieces};
use crate::cli::print::wrap::facts;
use crate::cli::resolve::model::simplify;
use crate::cli::resolve::texture::NamedTexture;
use crate::cli::{CommandResult, Result, advice, progress};
use scaleproof_plot::lettering;
use scaleproof_print::wrap::{WrapRequest, wrap};
use scaleproof_surface::model::Model;
use scaleproof_wrap::pieces::painted::PaintedError;
use scaleproof_wrap::pieces::{PiecesError, UnwrapError};

pub fn run(args: &WrapArgs, out: &mut dyn Write) -> CommandResult {
    let mut model = args.model.load_or(args.texture.mesh())?;
    if !args.pieces.panels && !args.texture.is_of_triangles(&model) {
        simplify(&mut model, args.texture.texture.is_some());
    }
    let painted = args.texture.load(&model)?;
    let request = || -> Result<WrapRequest> {
        Ok(WrapRequest {
            name: painted.name.clone(),
            facts: pieces::captioned(&painted),
            dpi: args.pieces.dpi,
            ..args.sheets.request(model.scale)?
        })
    };
    if args.pieces.panels {
        panels(args, (&model, &painted), request()?, out)
    } else if args.sheets.overlap_mm.is_some() {
        Err("no piece is spread over sheets, so nothing overlaps; leave out --overlap-mm, or give --panels".into())
    } else if let Some(paints) = args.paint.paints()? {
        let request = args.pieces.request(request()?);
        let output = args.sheets.paper.output()?;
        painted::run((&model, &painted.texture, &paints), request, &output, (args.json, out))
    } else {
        let output = args.sheets.paper.output()?;
        let request = args.pieces.request(request()?);
        pieces::run((&model, &painted), &request, &output, (args.json, out))
    }
}

/// `--panels`.
pub fn panels(
    args: &WrapArgs,
    (model, painted): (&Model, &NamedTexture),
    request: WrapRequest,
    out: &mut dyn Write,
) -> CommandResult {
    let output = args.sheets.paper.output()?;
    let busy = progress::busy("wrapping");
    let made = wrap(&model.mesh, &model.materials, &painted.texture, &request)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    output.write(&files)?;
    busy.finish_and_clear();
    if made.unlettered_mm > 0.0 {
        let length_mm = made.unlettered_mm;
        say!("note: {length_mm:.0} mm of seams have no letter, as one of their panels has no room beside them");
    }
    let cells = made
        .cell_mm
        .map(|mm| format!(", cells of {} mm", lettering::number(mm)));
    let head = format!(
        "{}: instructions and {} panels of {}{}; print at 100 %",
        files[0].0.display(),
        made.pieces.len(),
        model.in_words(),
        cells.unwrap_or_default()
    );
    let words = [vec![head], made.facts()].concat().join("\n");
    told(args.json, written(&files, facts(model, &made)), words, out)
}

pub fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        PaintedError::Pieces(e) => advice(e)?,
        PaintedError::Paint(e) => advice::on(e)?,
        PiecesError::Unwrap(UnwrapError::TooFewPieces { .. }) =>
            " (--pieces, --max-stretch, --mean-stretch, --paper; --material, --faces or the scene's paint leave out what is not painted)",
        PiecesError::Unwrap(UnwrapError::BadStretch { .. }) => " (--max-stretch, --mean-stretch)",
        PiecesError::Raster(_) => " (--dpi)",
    }
}
