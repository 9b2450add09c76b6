//! `scaleproof attack baseline`: the patterns an attack must beat, judged as it is.

use std::io::Write;

use crate::cli::answer::told;
use crate::cli::args::attack::baseline::{Method, PatchesArgs, SearchArgs};
use crate::cli::args::attack::on_frames::OnFrames;
use crate::cli::print::attack::on_frames::figures_in_words;
use crate::cli::resolve::attack::on_frames::cells_of;
use crate::cli::resolve::attack::render::hex;
use crate::cli::resolve::patch::{asked, placed};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::baseline::patches::{first_unseen, judge_patches};
use scaleproof_attack::baseline::{self, BlackBox, camou, genetic};
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::history::Entry;
use scaleproof_attack::run::judge::{HeldOutFigures, judge};
use scaleproof_attack::run::view_set::TextureMapping;
use scaleproof_attack::run::{Rgb, checkpoint, of_pattern, srgb};
use scaleproof_core::files;
use scaleproof_print::patch::check;
use scaleproof_surface::pattern::Pattern;

pub fn run(method: Method, out: &mut dyn Write) -> CommandResult {
    if method.on().mapping == TextureMapping::Sides {
        return Err(
            "--laying sides is for attack run and attack judge: a baseline is one pattern for all sides".into(),
        );
    }
    match &method {
        Method::Random { on } => {
            let pattern = Pattern::random(on.cells(), on.seed)?;
            finished("random", on, &of_pattern(&pattern), out)
        }
        Method::Flat { on, flat } => {
            let count = (on.cells() as usize).pow(2);
            finished("flat", on, &srgb(&vec![hex(flat)?; count]), out)
        }
        Method::Import { on, pattern: path } => {
            let pattern = cells_of(path)?;
            let columns = pattern.columns();
            // A finished pattern has the cells it has.
            if let Some(asked) = on.cells.filter(|asked| *asked != columns) {
                let path = path.display();
                return Err(
                    format!("--cells is {asked}, and {path} has {columns}×{columns} cells: leave --cells out").into(),
                );
            }
            let mut on = on.clone();
            on.cells = Some(columns);
            on.looking.tile_mm = on.own_tile_mm(path, &pattern)?;
            finished("import", &on, &of_pattern(&pattern), out)
        }
        Method::Er(args) => searched("er", args, out),
        Method::Camou(args) => searched("camou", args, out),
        Method::Patches(args) => patches(args, out),
    }
}

/// A pattern that needs no search.
pub fn finished(method: &str, on: &OnFrames, cells: &[Rgb], out: &mut dyn Write) -> CommandResult {
    refuse_other_results(on)?;
    let setup = on.open(method, false, &Eot::NONE)?;
    let judgement = judge(&setup.view_set, &setup.detectors, cells)?;
    on.write(&setup, (method, cells, vec![judged(judgement)]), None, out)
}

/// Refuses a folder with a checkpoint: methods without a search keep none, so that it belongs to another run.
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
        held_out: Some(judgement),
        ..Entry::default()
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
    let (first_round, cells, entries) = bar.during(|bar| -> Result<_> {
        let on_query = |asked: u64| bar.set_position(asked);
        let mut oracle = BlackBox::begin(&setup.view_set, &setup.detectors, &config, &on.output, &on_query)?;
        let (first_round, cells) = match method {
            "camou" => (camou::FIRST_ROUND, camou::search(&mut oracle, &config)?),
            _ => (genetic::FIRST_ROUND, genetic::search(&mut oracle, &config)?),
        };
        Ok((first_round, cells, oracle.finish()?))
    })?;
    let done = on.write(&setup, (method, &cells, entries), None, out)?;
    if args.queries < first_round {
        say!(
            "note: nothing was searched: the first round of {method} takes {first_round} images, and the pattern is one of the random ones it begins with"
        );
    }
    Ok(done)
}

/// Patches are no repeated pattern, so there is a history and no pattern.
pub fn patches(args: &PatchesArgs, out: &mut dyn Write) -> CommandResult {
    if args.on.cells.is_some() {
        return Err("patches have no cells: leave --cells out".into());
    }
    let base = hex(&args.flat)?;
    let asked = asked(&args.places)?;
    asked.iter().try_for_each(check)?;
    let patches = placed(&asked);
    refuse_other_results(&args.on)?;
    let setup = args.on.open("patches", false, &Eot::NONE)?;
    if let Some(unseen) = first_unseen(&setup, &patches)? {
        return Err(format!(
            "patch {} lies on no paint of the {} side that the views show: check --panel, --at-mm and --size-mm",
            unseen + 1,
            patches[unseen].side.name()
        )
        .into());
    }
    let judgement = judge_patches(&setup, &patches, base)?;
    let history = setup.history("patches", args.on.seed, vec![judged(judgement)]);
    let (path, content) = history.to_file(&args.on.output)?;
    files::replace_atomically(&args.on.output, &path, &content)?;
    let figures = figures_in_words(&setup, &history, &args.on.class);
    let words = format!("{}{figures}", path.display());
    told(args.on.json, args.on.made(&history, None), words, out)
}
