//! `scaleproof attack demo`: from stored frames to a pattern, its template and its score.

use std::io::Write;

use crate::cli::args::attack::demo::DemoArgs;
use crate::cli::args::attack::on_frames::{Looking, OnFrames};
use crate::cli::commands::attack::run::{METHOD, optimise};
use crate::cli::demo::{home, own_detector, print_template};
use crate::cli::detectors::Folder;
use crate::cli::results::Programs;
use crate::cli::{CommandResult, Outcome, Result};
use scaleproof_attack::result::PATTERN;
use scaleproof_attack::run::judge::judge;
use scaleproof_attack::run::view_set::TextureMapping;
use scaleproof_attack::run::{AttackConfig, Rgb, of_pattern, srgb};
use scaleproof_attack::setup::Setup;
use scaleproof_detect::Manifest;
use scaleproof_surface::pattern::Pattern;

const FRAMES: &str = "captures/skyline_attack";

const DETECTOR: &str = "yolox_nano";

const CELLS: u32 = 16;

const TILE_MM: f64 = 240.0;

pub fn run(args: &DemoArgs, out: &mut dyn Write) -> CommandResult {
    let detector = detector(&args.folder)?;
    let on = OnFrames {
        looking: Looking {
            frames: vec![home().join(FRAMES)],
            detector: vec![detector.clone()],
            folder: args.folder.clone(),
            programs: Programs::default(),
            class: "car".parse()?,
            tile_mm: Some(TILE_MM),
            mapping: TextureMapping::default(),
            json: false,
        },
        cells: Some(CELLS),
        seed: 1,
        output: args.output.clone(),
    };
    let setup = on.open(METHOD, true, &TextureMapping::World.usual_eot())?;
    let (views, held_out) = (setup.view_set.views.len(), setup.view_set.judged().len());
    writeln!(
        out,
        "1. {views} views of the model become a pattern against {detector}; {held_out} are held out"
    )?;
    let config = setup.named(AttackConfig {
        // The project's own detector is quick, and used to patterns.
        steps: if detector == DETECTOR { 60 } else { 240 },
        batch: 5,
        learning_rate: 0.05,
        floor: 0.001,
        hard: 0.0,
        ..on.config()
    });
    let (cells, entries) = optimise(&on, &setup, &config)?;
    on.write(&setup, (METHOD, &cells, entries), Some(&config), out)?;
    writeln!(out, "\n2. The pattern becomes a printable sheet")?;
    let png = args.output.join(PATTERN);
    let pdf = args.output.join("template.pdf");
    writeln!(
        out,
        "{}",
        print_template(&Pattern::load(&png)?, PATTERN, TILE_MM, &pdf)?
    )?;
    writeln!(out, "\n3. {detector} looks at the held-out views")?;
    table(&setup, &cells, out)?;
    writeln!(
        out,
        "\nThese are images as the surrogate renderer predicts them. What counts are new ones: `attack render --pattern {}` needs the model's mesh, \
         a camera needs the printed model.",
        png.display()
    )?;
    Ok(Outcome::Done)
}

/// YOLOX-Nano where its weights are here, else the project's own detector.
pub fn detector(folder: &Folder) -> Result<String> {
    let manifest = Manifest::named(DETECTOR)?;
    let is_here = folder.folders()?.find(&manifest).is_some();
    Ok(if is_here {
        DETECTOR.to_owned()
    } else {
        own_detector().display().to_string()
    })
}

/// The pattern beside a grey model and a random pattern.
fn table(setup: &Setup, cells: &[Rgb], out: &mut dyn Write) -> Result<()> {
    let grey = srgb(&vec![[128; 3]; cells.len()]);
    let random = of_pattern(&Pattern::random(CELLS, 1)?);
    writeln!(
        out,
        "{:<10} {:>7} {:>9} {:>16}",
        "pattern", "AP@0.5", "hit rate", "mean confidence"
    )?;
    for (name, cells) in [("grey", grey.as_slice()), ("random", &random), ("attack", cells)] {
        let judged = judge(&setup.view_set, &setup.detectors, cells)?;
        writeln!(
            out,
            "{name:<10} {:>7.2} {:>9.2} {:>16.2}",
            judged.ap50, judged.hit_rate, judged.mean_confidence
        )?;
    }
    Ok(())
}
