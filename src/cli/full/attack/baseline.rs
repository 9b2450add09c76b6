//! `scaleproof attack baseline`: the patterns an attack must beat, judged as it is.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;

use super::networks;
use super::on_frames::{OnFrames, cells_of};
use super::render::hex;
use crate::cli::print::patch::{self, PlaceArgs};
use crate::cli::{CommandResult, Outcome, progress};
use scaleproof_attack::baseline::patches::{PlacedPatch, is_seen, paint};
use scaleproof_attack::baseline::{self, BlackBox, genetic};
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::history::Entry;
use scaleproof_attack::run::judge::{HeldOutFigures, judge, judge_images};
use scaleproof_attack::run::view_set::{TextureMapping, ViewSet};
use scaleproof_attack::run::{Rgb, RunError, checkpoint, of_pattern, srgb};
use scaleproof_attack::setup::Setup;
use scaleproof_core::files;
use scaleproof_frames::frames::FrameSet;
use scaleproof_surface::pattern::Pattern;

/// Make the patterns an attack must beat, and judge them by the same views
#[derive(clap::Args)]
pub(super) struct BaselineArgs {
    #[command(subcommand)]
    method: Method,
}

#[derive(Subcommand)]
enum Method {
    /// Uniformly random cells
    Random(PlainArgs),
    /// One colour
    Flat(FlatArgs),
    /// ER: a genetic search that asks the detector, without looking into it
    Er(SearchArgs),
    /// CAMOU: a network that imitates renderer and detector, and is looked into in their place
    Camou(SearchArgs),
    /// A finished pattern: a PNG with one pixel per cell
    Import(ImportArgs),
    /// Finished patches on the hood, doors, roof or rear of a model of one colour (UPC, DAS)
    Patches(PatchesArgs),
}

#[derive(clap::Args)]
struct PlainArgs {
    #[command(flatten)]
    on: OnFrames,
}

#[derive(clap::Args)]
struct FlatArgs {
    #[command(flatten)]
    on: OnFrames,
    /// Hex sRGB, as in 808080
    #[arg(long, value_name = "HEX")]
    flat: String,
}

#[derive(clap::Args)]
struct SearchArgs {
    #[command(flatten)]
    on: OnFrames,
    /// Images it may look at
    #[arg(long, default_value_t = 2400, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    queries: u64,
}

#[derive(clap::Args)]
struct ImportArgs {
    #[command(flatten)]
    on: OnFrames,
    /// As many rows as columns, one pixel per cell
    #[arg(long, value_name = "PNG")]
    pattern: PathBuf,
}

#[derive(clap::Args)]
struct PatchesArgs {
    #[command(flatten)]
    on: OnFrames,
    #[command(flatten)]
    places: PlaceArgs,
    /// The model's colour beside the patches, as hex sRGB
    #[arg(long, value_name = "HEX", default_value = "808080")]
    flat: String,
}

impl Method {
    fn on(&self) -> &OnFrames {
        match self {
            Self::Random(args) => &args.on,
            Self::Flat(args) => &args.on,
            Self::Er(args) | Self::Camou(args) => &args.on,
            Self::Import(args) => &args.on,
            Self::Patches(args) => &args.on,
        }
    }
}

pub(super) fn run(args: &BaselineArgs, out: &mut dyn Write) -> CommandResult {
    if args.method.on().mapping == TextureMapping::Sides {
        return Err(
            "--laying sides is for attack run and attack judge: a baseline is one pattern for all sides".into(),
        );
    }
    match &args.method {
        Method::Random(args) => {
            let pattern = Pattern::random(args.on.cells(), args.on.seed)?;
            finished("random", &args.on, &of_pattern(&pattern), out)
        }
        Method::Flat(args) => {
            let count = (args.on.cells() as usize).pow(2);
            finished("flat", &args.on, &srgb(&vec![hex(&args.flat)?; count]), out)
        }
        Method::Import(args) => {
            let pattern = cells_of(&args.pattern)?;
            refuse_other_cells(&args.on, &args.pattern, &pattern)?;
            let mut on = args.on.clone();
            on.cells = Some(pattern.columns());
            on.looking.tile_mm = Some(on.tile_mm_of(&[(&args.pattern, &pattern)])?);
            finished("import", &on, &of_pattern(&pattern), out)
        }
        Method::Er(args) => searched("er", args, out),
        Method::Camou(args) => searched("camou", args, out),
        Method::Patches(args) => patches(args, out),
    }
}

/// A finished pattern has the cells it has.
fn refuse_other_cells(on: &OnFrames, path: &Path, pattern: &Pattern) -> Result<(), String> {
    match on.cells {
        Some(asked) if asked != pattern.columns() => Err(format!(
            "--cells is {asked}, and {} has {1}×{1} cells: leave --cells out",
            path.display(),
            pattern.columns()
        )),
        _ => Ok(()),
    }
}

/// A pattern that needs no search.
fn finished(method: &str, on: &OnFrames, cells: &[Rgb], out: &mut dyn Write) -> CommandResult {
    refuse_other_results(on)?;
    let setup = on.open(method, false, &Eot::NONE)?;
    let judgement = judge(&setup.view_set, &setup.detectors, cells)?;
    on.write(&setup, (method, cells, vec![judged(judgement)]), None, out)?;
    Ok(Outcome::Done)
}

/// What is found without a search keeps no checkpoint, so one in the folder is another result's.
fn refuse_other_results(on: &OnFrames) -> Result<(), String> {
    let path = on.output.join(checkpoint::FILE);
    if path.exists() {
        Err(format!("{} is of another run: give another folder", path.display()))
    } else {
        Ok(())
    }
}

fn judged(judgement: HeldOutFigures) -> Entry {
    Entry {
        step: 0,
        queries: 0,
        wall_s: 0.0,
        loss: None,
        confidence: None,
        held_out: Some(judgement),
    }
}

fn searched(method: &'static str, args: &SearchArgs, out: &mut dyn Write) -> CommandResult {
    let on = &args.on;
    // The clone's convolutions take four cells off.
    if method == "camou" && on.cells() < 6 {
        return Err(format!("--cells is {}: the network of CAMOU needs 6 or more", on.cells()).into());
    }
    let eot = on.mapping.usual_eot();
    let setup = on.open(method, false, &eot)?;
    let config = baseline::SearchConfig {
        method,
        cells: on.cells(),
        tile_mm: on.tile_mm(),
        queries: args.queries,
        seed: on.seed,
        mapping: on.mapping,
        eot,
        frames_sha256: setup.frames_sha256.clone(),
        detectors: setup.detector_names.clone(),
        classes: setup.classes.clone(),
    };
    let bar = progress::frames(method, usize::try_from(args.queries).unwrap_or(usize::MAX));
    let on_query = |asked: u64| bar.set_position(asked);
    let mut oracle = BlackBox::begin(&setup.view_set, &setup.detectors, &config, &on.output, &on_query)?;
    let (first_round, cells): (u64, Result<Vec<Rgb>, Box<dyn Error>>) = match method {
        "camou" => networks::camou(on.device.device, &mut oracle, &config),
        _ => (
            genetic::FIRST_ROUND,
            genetic::search(&mut oracle, &config).map_err(Box::from),
        ),
    };
    bar.finish_and_clear();
    let cells = cells?;
    let entries = oracle.finish()?;
    on.write(&setup, (method, &cells, entries), None, out)?;
    if args.queries < first_round {
        say!(
            "note: nothing was searched: the first round of {method} takes {first_round} images, and the pattern is one of the random ones it begins with"
        );
    }
    Ok(Outcome::Done)
}

/// Patches are no repeated pattern, so there is a history and no pattern.
fn patches(args: &PatchesArgs, out: &mut dyn Write) -> CommandResult {
    if args.on.cells.is_some() {
        return Err("patches have no cells: leave --cells out".into());
    }
    let base = hex(&args.flat)?;
    let patches = placed(&args.places)?;
    refuse_other_results(&args.on)?;
    let setup = args.on.open("patches", false, &Eot::NONE)?;
    check_seen(&setup, &patches)?;
    let on = (&setup.view_set, setup.frames.as_slice());
    let image = |view: usize| painted(on, view, &patches, base);
    let judgement = judge_images(&setup.view_set, &setup.detectors, image)?;
    let history = setup.history("patches", args.on.seed, vec![judged(judgement)]);
    let (path, content) = history.to_file(&args.on.output)?;
    files::write_atomically(&path, &content)?;
    if args.on.json {
        args.on.write_json(&history, None, out)?;
        return Ok(Outcome::Done);
    }
    writeln!(out, "{}", path.display())?;
    super::on_frames::say_figures(&setup, &history, &args.on.class, out)?;
    Ok(Outcome::Done)
}

/// A patch that no view shows would be judged as the plain model.
fn check_seen(setup: &Setup, patches: &[PlacedPatch]) -> Result<(), Box<dyn Error>> {
    for (i, patch) in patches.iter().enumerate() {
        let mut is_shown = false;
        for view in setup.view_set.judged() {
            is_shown |= is_seen(
                &setup.frames[setup.view_set.set_of(view)],
                &setup.view_set.views[view].frame,
                patch,
            )? != Some(false);
        }
        if !is_shown {
            return Err(format!(
                "patch {} lies on no paint of the {} side that the views show: check --panel, --at-mm and --size-mm",
                i + 1,
                patch.side.name()
            )
            .into());
        }
    }
    Ok(())
}

fn painted(
    (view_set, frames): (&ViewSet, &[FrameSet]),
    view: usize,
    patches: &[PlacedPatch],
    base: [u8; 3],
) -> Result<Vec<Rgb>, RunError> {
    let frame = &view_set.views[view].frame;
    let paint = paint(&frames[view_set.set_of(view)], frame, patches, base)?;
    let paint = paint.ok_or_else(|| RunError::NoPositions {
        view: frame.name.clone(),
    })?;
    Ok(view_set.painted(view, &paint))
}

fn placed(places: &PlaceArgs) -> Result<Vec<PlacedPatch>, Box<dyn Error>> {
    let asked = patch::asked(places)?;
    asked.iter().try_for_each(scaleproof_print::print::patch::check)?;
    let of = |patch: scaleproof_print::print::patch::PanelPatch| PlacedPatch {
        image: patch.image.pixels().clone(),
        side: patch.side,
        at_mm: patch.at_mm,
        size_mm: patch.size_mm.into(),
    };
    Ok(asked.into_iter().map(of).collect())
}
