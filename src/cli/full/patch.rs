//! `scaleproof print patch`: finished patch textures on the panels of a model.

use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::wrap::SheetArgs;
use crate::cli::CommandResult;
use crate::cli::answer::{told, written};
use crate::cli::args::model::ModelArgs;
use crate::cli::print::value_names;
use crate::cli::{Result, enlarged};
use scaleproof_core::geometry::length::parse_mm;
use scaleproof_core::spelling::count;
use scaleproof_print::patch::{PanelPatch, PatchError, patches};
use scaleproof_print::{paper, wrap};
use scaleproof_surface::pattern::world_aligned::Side;
use scaleproof_surface::texture::PlacedPatch;

#[derive(clap::Args)]
pub(crate) struct PatchArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    places: PlaceArgs,
    #[command(flatten)]
    sheets: SheetArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Patches in their places.
#[derive(clap::Args)]
pub(crate) struct PlaceArgs {
    /// A finished texture, PNG or JPEG; for several patches repeat this and the next three options
    #[arg(long, value_name = "FILE")]
    pub(crate) patch: Vec<PathBuf>,
    /// The panel it goes on
    #[arg(long, value_parser = side(), requires = "patch")]
    panel: Vec<Side>,
    /// The patch's middle as the panel is seen from outside: to the right of the model's middle and above the ground (on the
    /// roof: before the middle), in mm, as in -40,65
    #[arg(long, value_name = "X,Y", requires = "patch", allow_hyphen_values = true)]
    at_mm: Vec<String>,
    /// Its width, or width and height, in mm, as in 60 or 60x40
    #[arg(long, value_name = "W[xH]", requires = "patch", allow_hyphen_values = true)]
    size_mm: Vec<String>,
}

value_names!(side -> Side: Left "left", Right "right", Roof "roof", Front "front", Rear "rear");

/// Runs `scaleproof print patch`.
pub(crate) fn run(args: &PatchArgs, out: &mut dyn Write) -> CommandResult {
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

/// `print patch --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    patches: Vec<PatchAnswer>,
}

#[derive(Serialize, JsonSchema)]
struct PatchAnswer {
    name: String,
    /// The side of the model.
    panel: &'static str,
    /// Right of the model's middle, and up from the ground.
    at_mm: [f64; 2],
    /// Width and height.
    size_mm: [f64; 2],
    /// Share of the patch beside its panel.
    off_panel_share: f64,
}

/// The patches as they were requested: the options belong together in order.
pub(crate) fn asked(args: &PlaceArgs) -> Result<Vec<PanelPatch>> {
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

pub(crate) fn placed(patches: &[PanelPatch]) -> Vec<PlacedPatch> {
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
