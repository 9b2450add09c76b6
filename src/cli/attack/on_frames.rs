//! What `attack run`, `attack baseline` and `attack demo` share: frames, detectors, and the files of a result.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;

use super::device::OnDevice;
use super::progress;
use crate::attack::run::eot::Eot;
use crate::attack::run::history::{self, Entry, History};
use crate::attack::run::stage::Stage;
use crate::attack::run::{Rgb, stage, to_picture};
#[cfg(feature = "attack")]
use crate::cli::detectors;
use crate::cli::detectors::Folder;
use crate::files;
use crate::frames::{FrameSet, LIST};
use crate::pattern::card::Card;
use crate::pattern::{MAX_CELLS, Pattern};
use crate::print::lettering::counted;
use crate::scene::Classes;
use crate::surrogate::projection::Grid;
use crate::whitebox::WhiteBox;
#[cfg(feature = "attack")]
use crate::whitebox::detector::OnnxDetector;
use crate::whitebox::device::DeviceKind;

/// The name of the pattern in the folder of a result.
pub const PATTERN: &str = "pattern.png";

#[derive(Debug, Clone, clap::Args)]
pub struct OnFrames {
    /// A folder of frames, each view in three flat colours or more
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// The detectors to be misled; several at once as in yolox_nano,nanodet_m
    #[arg(
        long = "detector",
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "yolox_nano"
    )]
    pub detector: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    /// The label that counts as the model, or several, as in car,truck
    #[arg(long, value_name = "LABEL,…", default_value = "car")]
    pub class: Classes,
    /// Cells along each side
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_CELLS)))]
    pub cells: u32,
    /// Width of one repeat on the model, in mm
    #[arg(long, value_name = "MM", default_value_t = 240.0, allow_negative_numbers = true)]
    pub tile_mm: f64,
    /// How the pattern lies on the model: as the printed panels do, or repeated over a plane that faces the camera
    /// (DTA)
    #[arg(long, value_enum, default_value_t = Laying::World)]
    pub laying: Laying,
    #[command(flatten)]
    pub device: OnDevice,
    /// One JSON object instead of the text
    #[arg(long)]
    pub json: bool,
    /// The same seed gives the same pattern
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the pattern, its card and its history; an interrupted run there is gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Laying {
    World,
    Repeated,
}

impl From<Laying> for stage::Laying {
    fn from(laying: Laying) -> Self {
        match laying {
            Laying::World => Self::World,
            Laying::Repeated => Self::Repeated,
        }
    }
}

/// Frames and detectors, opened.
pub struct Opened {
    pub set: FrameSet,
    pub stage: Stage,
    pub detectors: Vec<Box<dyn WhiteBox>>,
    /// Names, with the beginning of the weights' hashes.
    pub named: Vec<String>,
    pub frames_sha256: String,
}

impl OnFrames {
    pub fn open(&self) -> Result<Opened, Box<dyn Error>> {
        check_tile(self.tile_mm)?;
        let (detectors, named) = white_boxes(&self.detector, &self.folder, &self.class, self.device.device)?;
        let set = FrameSet::open(&self.frames)?;
        files::check_writable(&self.output)?;
        let grid = Grid {
            columns: self.cells,
            rows: self.cells,
            cell_mm: self.tile_mm / f64::from(self.cells),
        };
        let views = crate::frames::views(&set.list.frames).len();
        let bar = progress::frames("reading views", views);
        let stage = Stage::open(&set, grid, self.laying.into(), || bar.inc(1));
        bar.finish_and_clear();
        Ok(Opened {
            stage: stage?,
            frames_sha256: files::sha256_hex(&files::read(&self.frames.join(LIST))?),
            set,
            detectors,
            named,
        })
    }

    /// The usual transformations; those of the pattern's phase and size where the laying leaves them open.
    pub fn eot(&self) -> Eot {
        match self.laying {
            Laying::World => Eot::USUAL,
            Laying::Repeated => Eot {
                shift_tiles: 0.5,
                tile_scale: 0.25,
                ..Eot::USUAL
            },
        }
    }

    /// Writes the pattern, its card and its history together, and says what they are.
    pub fn write(
        &self,
        opened: &Opened,
        (method, cells, entries): (&str, &[Rgb], Vec<Entry>),
        out: &mut dyn Write,
    ) -> Result<(), Box<dyn Error>> {
        let history = self.history(opened, method, entries);
        let png = png(&to_picture(cells, self.cells))?;
        let path = self.output.join(PATTERN);
        let card = self.card(opened, &history, &png)?.to_file(&path)?;
        files::replace_all_atomically(&[(path.clone(), png), card, self.history_file(&history)?])?;
        if self.json {
            return self.write_json(&history, Some(&path), out);
        }
        writeln!(
            out,
            "{}: {} × {} cells, tile {} mm",
            path.display(),
            self.cells,
            self.cells,
            self.tile_mm
        )?;
        say_judgement(opened, &history, &self.class, out)
    }

    /// The result for programs: what `history.json` ends with, and where the pattern is.
    pub fn write_json(
        &self,
        history: &History,
        pattern: Option<&Path>,
        out: &mut dyn Write,
    ) -> Result<(), Box<dyn Error>> {
        let predicted = history.last_judged().map(|(_, judgement)| judgement);
        let queries = history.entries.last().map_or(0, |e| e.queries);
        let line = json!({
            "method": history.method, "seed": history.seed, "tile_mm": history.tile_mm, "cells": self.cells, "classes": self.class,
            "detectors": history.detectors, "pattern": pattern, "queries": queries, "predicted": predicted,
        });
        Ok(writeln!(out, "{line}")?)
    }

    pub fn history(&self, opened: &Opened, method: &str, entries: Vec<Entry>) -> History {
        History {
            scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
            method: method.to_owned(),
            seed: self.seed,
            tile_mm: self.tile_mm,
            frames_sha256: opened.frames_sha256.clone(),
            detectors: opened.named.clone(),
            entries,
        }
    }

    pub fn history_file(&self, history: &History) -> Result<(PathBuf, Vec<u8>), Box<dyn Error>> {
        let text = serde_json::to_string_pretty(history)?;
        Ok((self.output.join(history::FILE), text.into_bytes()))
    }

    fn card(&self, opened: &Opened, history: &History, png: &[u8]) -> Result<Card, Box<dyn Error>> {
        let queries = history.entries.last().map_or(0, |e| e.queries);
        let judged = history.last_judged().map(|(_, judgement)| judgement);
        let about = json!({
            "made_by": format!("scaleproof {} attack, method {}", env!("CARGO_PKG_VERSION"), history.method),
            "cells": [self.cells, self.cells],
            "seed": self.seed,
            "detectors": opened.named,
            "frames_sha256": opened.frames_sha256,
            "queries": queries,
            "held_out_by_renderer_model": judged,
        });
        let serde_json::Value::Object(about) = about else {
            return Err("the card could not be written".into());
        };
        Ok(Card {
            pattern_sha256: files::sha256_hex(png),
            tile_mm: self.tile_mm,
            about,
        })
    }
}

/// What the held-out views say, and that they are predictions.
pub fn say_judgement(
    opened: &Opened,
    history: &History,
    class: &Classes,
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    if let Some((entry, judgement)) = history.last_judged() {
        let which = if opened.stage.holds_out() {
            "it was not made with"
        } else {
            "it was made with (too few to hold any out)"
        };
        writeln!(
            out,
            "predicted, not rendered: AP@0.5 {:.2}, hit rate {:.2}, mean confidence {:.2} on {} {which}; {} looked at in {:.0} s; \
             counts as the model: {class}",
            judgement.ap50,
            judgement.hit_rate,
            judgement.mean_confidence,
            counted(judgement.views, "view"),
            counted(entry.queries as usize, "picture"),
            entry.wall_s
        )?;
    }
    if opened.stage.unseen > 0 {
        writeln!(
            out,
            "left out, as the model's paint is not seen: {}",
            counted(opened.stage.unseen, "view")
        )?;
    }
    Ok(())
}

fn check_tile(tile_mm: f64) -> Result<(), String> {
    match (0.1..=100_000.0).contains(&tile_mm) {
        true => Ok(()),
        false => Err(format!(
            "--tile-mm is {tile_mm}: give the width of one repeat on the model, 0.1 to 100000 mm"
        )),
    }
}

fn png(picture: &image::RgbImage) -> Result<Vec<u8>, Box<dyn Error>> {
    Ok(crate::frames::encode_rgb(picture)?)
}

/// The cells of a pattern file, which must be square and of so many cells.
pub fn cells_of(path: &Path) -> Result<Pattern, Box<dyn Error>> {
    let pattern = Pattern::load(path)?;
    match pattern.columns() == pattern.rows() {
        true => Ok(pattern),
        false => Err(format!(
            "{} has {}×{} cells; the attack's baselines are square",
            path.display(),
            pattern.columns(),
            pattern.rows()
        )
        .into()),
    }
}

type WhiteBoxes = (Vec<Box<dyn WhiteBox>>, Vec<String>);

/// The detectors as networks that can be followed back, with their names and hashes.
#[cfg(feature = "attack")]
pub fn white_boxes(
    names: &[String],
    folder: &Folder,
    class: &Classes,
    device: DeviceKind,
) -> Result<WhiteBoxes, Box<dyn Error>> {
    let device = device.open()?;
    let folders = folder.folders()?;
    let (mut all, mut named): WhiteBoxes = Default::default();
    for manifest in detectors::chosen(names)? {
        let labels = manifest.counted(class.labels())?;
        let path = folders.checked(&manifest)?;
        let sha256 = manifest.weights.sha256.chars().take(12).collect::<String>();
        named.push(format!("{} {sha256}", manifest.name));
        all.push(Box::new(OnnxDetector::open(&manifest, &path, &labels, &device)?));
    }
    Ok((all, named))
}

#[cfg(not(feature = "attack"))]
pub fn white_boxes(_: &[String], _: &Folder, _: &Classes, _: DeviceKind) -> Result<WhiteBoxes, Box<dyn Error>> {
    Err("this program was built without the attack's networks: use ./run attack …, or build with `cargo build --release --features attack`".into())
}
