//! Frames, detectors and pattern of `attack run` and `attack baseline`, resolved from their arguments.

use super::frames::WhiteBoxes;
use std::path::Path;

use crate::cli::args::attack::on_frames::{Looking, OnFrames};
use crate::cli::detectors;
use crate::cli::enlarged::note_enlarged;
use crate::cli::print::card_fault;
use crate::cli::{Result, progress};
use scaleproof_attack::result;
use scaleproof_attack::run::AttackConfig;
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::history::{self, History, TILES_MM};
use scaleproof_attack::setup::Setup;
use scaleproof_core::files;
use scaleproof_detect::{Manifest, ProgramDetector};
use scaleproof_frames::FrameSet;
use scaleproof_gradients::WhiteBox;
use scaleproof_gradients::detector::OnnxDetector;
use scaleproof_gradients::program::ProgramWhiteBox;
use scaleproof_pose::scene::Classes;
use scaleproof_surface::pattern::card::{self, CardError};
use scaleproof_surface::pattern::{MAX_CELLS, Pattern, PatternError};

/// Width of one repeat where nothing says another, mm: patterns of this width leave least (docs/lessons/attack.md).
const TILE_MM: f64 = 118.0;

/// Cells along each side where nothing says another number: the fewest that are not shown to leave more than others do
/// (docs/guide/reference/measured.md).
const CELLS: u32 = 24;

impl Looking {
    pub fn tile_mm(&self) -> f64 {
        self.tile_mm.unwrap_or(TILE_MM)
    }

    /// Width of one repeat of a pattern that is there already, mm: as asked for, else as its card says, if it has one.
    ///
    /// # Errors
    /// A damaged card, or one of another pattern.
    pub fn own_tile_mm(&self, path: &Path, pattern: &Pattern) -> Result<Option<f64>, String> {
        match (self.tile_mm, card::card(path, pattern)) {
            (Some(given), _) => Ok(Some(given)),
            (None, Ok(card)) => Ok(Some(card.tile_mm)),
            (None, Err(CardError::None { .. })) => Ok(None),
            (None, Err(e)) => Err(card_fault(&e)),
        }
    }

    /// `cells`: along each side of the pattern. `differentiates`: the detectors must give gradients. `eot`: what images will be augmented with.
    pub fn open(&self, cells: u32, differentiates: bool, eot: &Eot) -> Result<Setup> {
        let tile_mm = self.tile_mm();
        if !TILES_MM.contains(&tile_mm) {
            let (least, most) = (TILES_MM.start(), TILES_MM.end());
            return Err(format!(
                "--tile-mm is {tile_mm}: give the width of one repeat on the model, {least} to {most} mm"
            )
            .into());
        }
        let (networks, programs) = self.programs.among(&self.detector)?;
        let (mut detectors, mut names) = match (networks.is_empty(), programs.is_empty()) {
            (true, false) => WhiteBoxes::default(),
            _ => self.white_boxes(&networks)?,
        };
        for program in self.programs.started(programs)? {
            let (name, detector) = program_box(program, &self.class, differentiates)?;
            detectors.push(detector);
            names.push(name);
        }
        let frames = FrameSet::open_all(&self.frames)?;
        let texture = (cells, tile_mm, self.mapping);
        let bar = progress::frames("reading views", frames.iter().map(FrameSet::view_count).sum());
        let detectors = (detectors, names, self.class.clone());
        Ok(bar.during(|bar| Setup::open(frames, texture, eot, detectors, || bar.inc(1)))?)
    }

    /// The detectors that are networks, and the name and hash of each.
    pub fn white_boxes(&self, names: &[String]) -> Result<WhiteBoxes> {
        let folders = self.folder.folders()?;
        let (mut all, mut named): WhiteBoxes = Default::default();
        for manifest in detectors::chosen(names)? {
            let labels = manifest.counted(self.class.labels())?;
            let path = folders.checked(&manifest)?;
            named.push(format!("{} {:.12}", manifest.name, manifest.weights.sha256));
            all.push(Box::new(OnnxDetector::<f32>::open(&manifest, &path, &labels)?));
        }
        Ok((all, named))
    }
}

impl OnFrames {
    pub fn cells(&self) -> u32 {
        self.cells.unwrap_or(CELLS)
    }

    /// The usual attack on these frames, without their names and those of the detectors.
    pub fn config(&self) -> AttackConfig {
        AttackConfig {
            cells: self.cells(),
            tile_mm: self.tile_mm(),
            seed: self.seed,
            mapping: self.mapping,
            eot: self.mapping.usual_eot(),
            ..AttackConfig::usual(self.class.clone())
        }
    }

    /// As [`Looking::open`], with a folder for what the method makes.
    pub fn open(&self, method: &str, differentiates: bool, eot: &Eot) -> Result<Setup> {
        self.check_cells()?;
        self.refuse_other_methods(method)?;
        files::check_file_writable(&self.output.join(result::PATTERN))?;
        self.looking.open(self.cells(), differentiates, eot)
    }

    /// Refuses a folder with what another method found, or with a pattern of unknown origin; what this method made may be made again.
    pub fn refuse_other_methods(&self, method: &str) -> Result<(), String> {
        files::inputs::own(&self.output.join(history::FILE));
        match History::load(&self.output) {
            Ok(held) if held.method != method => Err(format!(
                "{} holds what {} made: give another folder for {method}",
                self.output.display(),
                held.method
            )),
            Err(_) if self.output.join(result::PATTERN).exists() => Err(format!(
                "{} holds a pattern without its history, which would be written over: give another folder",
                self.output.display()
            )),
            _ => Ok(()),
        }
    }

    /// The sides' patterns lie below each other in one file.
    pub fn check_cells(&self) -> Result<(), String> {
        let (cells, laying) = (self.cells(), self.mapping.name());
        let [_, rows] = self.mapping.grid(cells);
        if rows <= MAX_CELLS {
            return Ok(());
        }
        let most = MAX_CELLS * cells / rows;
        Err(format!(
            "--cells is {cells}, which makes {rows} rows with --laying {laying}, and a pattern has {MAX_CELLS} at most: give up to {most}"
        ))
    }
}

/// The pattern of a file, with a note where it is another one, enlarged.
pub fn pattern_of(path: &Path) -> Result<Pattern, PatternError> {
    let pattern = Pattern::load(path)?;
    note_enlarged(path, &pattern);
    Ok(pattern)
}

pub fn cells_of(path: &Path) -> Result<Pattern> {
    let pattern = pattern_of(path)?;
    if pattern.columns() == pattern.rows() {
        Ok(pattern)
    } else {
        Err(format!(
            "{} has {}×{} cells; the attack's baselines are square",
            path.display(),
            pattern.columns(),
            pattern.rows()
        )
        .into())
    }
}

fn program_box(program: ProgramDetector, class: &Classes, differentiates: bool) -> Result<(String, Box<dyn WhiteBox>)> {
    let manifest = Manifest::of_foreign(program.card());
    if let Some(fault) = manifest.class_map_fault() {
        return Err(format!("the manifest of {} is not valid: {fault}", manifest.name).into());
    }
    let labels = manifest.counted(class.labels())?;
    let name = format!("{} {:.12}", manifest.name, manifest.weights.sha256);
    let detector = ProgramWhiteBox::open(program, manifest, labels, differentiates)?;
    Ok((name, Box::new(detector)))
}
