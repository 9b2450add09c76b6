//! `scaleproof print patch`: finished patch textures on the panels of a model.

use std::io::Write;

use crate::cli::answer::{told, written};
use crate::cli::args::patch::{PatchArgs, PlaceArgs};
use crate::cli::print::patch::{Answer, PatchAnswer};
use crate::cli::{CommandResult, Result, enlarged};
use scaleproof_core::geometry::length::parse_mm;
use scaleproof_core::spelling::count;
use scaleproof_print::patch::{PanelPatch, PatchError, patches};
use scaleproof_print::{paper, wrap};
use scaleproof_surface::texture::PlacedPatch;

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

/// The patches as they were requested: the options belong together in order.
pub fn asked(args: &PlaceArgs) -> Result<Vec<PanelPatch>> {
    let count = args.patch.len();
    if count == 0 {
        return Err("give --patch, with its --panel, --at-mm and --size-mm".into());
    }
    if [args.panel.len(), args.at_mm.len(), args.size_mm.len()] != [count; 3] {
        return Err("every --patch needs its own --panel, --at-mm and --size-mm; repeat all four for each".into());
    }
    let one = |i: usize| -> Result<PanelPatch> {
        let image = enlarged::picture(&args.patch[i]).map_err(PatchError::from)?;
        let size = args.size_mm[i].trim();
        let size_mm = match parse_mm(size) {
            Ok(width) => (width, image.height_for(width)),
            Err(_) => paper::size_mm(size)?,
        };
        let name = args.patch[i].file_name().map(|n| n.to_string_lossy().into_owned());
        Ok(PanelPatch {
            name: name.unwrap_or_default(),
            image,
            side: args.panel[i],
            at_mm: place(&args.at_mm[i])?,
            size_mm,
        })
    };
    (0..count).map(one).collect()
}

pub fn placed(patches: &[PanelPatch]) -> Vec<PlacedPatch> {
    let patches = patches.iter().map(|patch| PlacedPatch {
        image: patch.image.pixels.clone(),
        side: patch.side,
        at_mm: patch.at_mm,
        size_mm: patch.size_mm,
    });
    patches.collect()
}

fn place(text: &str) -> Result<[f64; 2]> {
    let numbers = text
        .split_once(',')
        .and_then(|(x, y)| Some([parse_mm(x).ok()?, parse_mm(y).ok()?]));
    numbers.ok_or_else(|| format!("place '{text}' is not understood; write X,Y in mm, as in -40,65").into())
}
