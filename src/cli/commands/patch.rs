//! `scaleproof print patch`: finished patch textures on the panels of a model.

use std::io::Write;

use crate::cli::CommandResult;
use crate::cli::answer::{told, written};
use crate::cli::args::patch::PatchArgs;
use crate::cli::print::patch::{Answer, PatchAnswer};
use crate::cli::resolve::patch::asked;
use scaleproof_core::spelling::count;
use scaleproof_print::patch::patches;
use scaleproof_print::wrap;

/// Runs `scaleproof print patch`.
pub fn run(args: &PatchArgs, out: &mut dyn Write) -> CommandResult {
    let wanted = asked(&args.places)?;
    let model = args.model.load()?;
    let panels = wrap::PaintedSurface::of_materials(&model.mesh, &model.materials).panels();
    let sheets = &args.sheets;
    let request = sheets.request(model.scale)?;
    let made = patches(&panels, &wanted, &request)?;
    let title = format!("Patches of {}", wanted[0].name);
    let files = sheets.paper.output()?.files(&title, &made.page_names, &made.pages)?;
    sheets.paper.output()?.write(&files)?;
    for (patch, off) in wanted.iter().zip(&made.off_panel).filter(|(_, off)| **off > 0.0) {
        say!(
            "note: {:.1} % of {} lie beyond the outline of the {} panel and are cut off",
            100.0 * off,
            patch.name,
            patch.side.name()
        );
    }
    let patches = wanted.iter().zip(&made.off_panel).map(|(patch, off)| PatchAnswer {
        name: patch.name.clone(),
        panel: patch.side.name(),
        at_mm: patch.at_mm,
        size_mm: patch.size_mm.into(),
        off_panel_share: *off,
    });
    let patches = patches.collect();
    let (path, pages) = (files[0].0.display(), count(made.pages.len(), "page"));
    let words = format!("{path}: {pages} of panels and patches; print at 100 %");
    told(args.json, written(&files, Answer { patches }), words, out)
}
