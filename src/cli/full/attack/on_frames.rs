//! What `attack run`, `attack baseline` and `attack demo` share: frames, detectors, and the files of a result.

use std::io::Write;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::WhiteBoxes;
use crate::cli::answer::told;
use crate::cli::choice::one_of;
use crate::cli::detectors::{self, Folder};
use crate::cli::enlarged::note_enlarged;
use crate::cli::print::card_fault;
use crate::cli::results::Programs;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::result;
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::history::{self, Entry, History, TILES_MM};
use scaleproof_attack::run::judge::{HeldOutFigures, judge};
use scaleproof_attack::run::view_set::{ENOUGH_HELD_OUT, TextureMapping};
use scaleproof_attack::run::{AttackConfig, Rgb, of_pattern};
use scaleproof_attack::setup::Setup;
use scaleproof_core::files;
use scaleproof_core::spelling::{count, quoted};
use scaleproof_detect::{Manifest, ProgramDetector};
use scaleproof_frames::FrameSet;
use scaleproof_gradients::WhiteBox;
use scaleproof_gradients::detector::OnnxDetector;
use scaleproof_gradients::program::ProgramWhiteBox;
use scaleproof_photo::defence::Defence;
use scaleproof_pose::scene::Classes;
use scaleproof_surface::pattern::card::{self, CardError};
use scaleproof_surface::pattern::{MAX_CELLS, Pattern, PatternError};

/// Random cells that leave less AP@0.5 hide the model by themselves.
const LITTLE_AP: f64 = 0.1;

/// Width of one repeat where nothing says another, mm: patterns of this width leave least (docs/lessons/attack.md).
const TILE_MM: f64 = 118.0;
/// Cells along each side where nothing says another number: the fewest that are not shown to leave more than others do
/// (docs/guide/reference/measured.md).
const CELLS: u32 = 24;

/// What looks at what.
#[derive(Debug, Clone, clap::Args)]
pub(in crate::cli) struct Looking {
    /// Folders of frames, each view in three flat colours or more; several to see several models at once
    #[arg(value_name = "FRAMES", required = true)]
    pub frames: Vec<PathBuf>,
    /// The detectors to be misled; several at once as in yolox_nano,nanodet_m; a program as in 'exec:python3 mine.py'
    #[arg(
        long = "detector",
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "yolox_nano"
    )]
    pub detector: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    #[command(flatten)]
    pub programs: Programs,
    /// The label that counts as the model, or several, as in car,truck
    #[arg(long, value_name = "LABEL,…", default_value = "car")]
    pub class: Classes,
    /// Width of one repeat on the model, in mm [default: as the card of a pattern says that is there already; else 118]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub tile_mm: Option<f64>,
    /// How the pattern lies on the model: as the printed panels do, or repeated over a plane that faces the camera
    /// (DTA)
    #[arg(long = "laying", default_value = "world", value_parser = one_of(TextureMapping::ALL.map(|mapping| (mapping, mapping.name()))))]
    pub mapping: TextureMapping,
    /// One JSON object instead of the text
    #[arg(long)]
    pub json: bool,
}

/// What looks at what, and the pattern to be made: its cells, its seed and its folder.
#[derive(Debug, Clone, clap::Args)]
pub(in crate::cli) struct OnFrames {
    #[command(flatten)]
    pub looking: Looking,
    /// Cells along each side [default: 24; of a pattern that is there already, its own]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_CELLS)))]
    pub cells: Option<u32>,
    /// Seed of what is random; one seed gives one pattern
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the pattern, its card and its history; an interrupted run there is gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

impl Deref for OnFrames {
    type Target = Looking;

    fn deref(&self) -> &Looking {
        &self.looking
    }
}

impl Looking {
    pub(super) fn tile_mm(&self) -> f64 {
        self.tile_mm.unwrap_or(TILE_MM)
    }

    /// Width of one repeat of a pattern that is there already, mm: as asked for, else as its card says, if it has one.
    ///
    /// # Errors
    /// A damaged card, or one of another pattern.
    pub(super) fn own_tile_mm(&self, path: &Path, pattern: &Pattern) -> Result<Option<f64>, String> {
        match (self.tile_mm, card::card(path, pattern)) {
            (Some(given), _) => Ok(Some(given)),
            (None, Ok(card)) => Ok(Some(card.tile_mm)),
            (None, Err(CardError::None { .. })) => Ok(None),
            (None, Err(e)) => Err(card_fault(&e)),
        }
    }

    /// `cells`: along each side of the pattern. `differentiates`: the detectors must give gradients. `eot`: what images will be augmented with.
    pub(super) fn open(&self, cells: u32, differentiates: bool, eot: &Eot) -> Result<Setup> {
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
    fn white_boxes(&self, names: &[String]) -> Result<WhiteBoxes> {
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
    pub(super) fn cells(&self) -> u32 {
        self.cells.unwrap_or(CELLS)
    }

    /// The usual attack on these frames, without their names and those of the detectors.
    pub(super) fn config(&self) -> AttackConfig {
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
    pub(super) fn open(&self, method: &str, differentiates: bool, eot: &Eot) -> Result<Setup> {
        self.check_cells()?;
        self.refuse_other_methods(method)?;
        files::check_file_writable(&self.output.join(result::PATTERN))?;
        self.looking.open(self.cells(), differentiates, eot)
    }

    /// Refuses a folder with what another method found, or with a pattern of unknown origin; what this method made may be made again.
    fn refuse_other_methods(&self, method: &str) -> Result<(), String> {
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
    fn check_cells(&self) -> Result<(), String> {
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

    pub(super) fn write(
        &self,
        setup: &Setup,
        (method, cells, entries): (&str, &[Rgb], Vec<Entry>),
        config: Option<&AttackConfig>,
        out: &mut dyn Write,
    ) -> CommandResult {
        let history = setup.history(method, self.seed, entries);
        let path = result::write(&self.output, (cells, self.cells(), self.mapping), &history, config)?;
        let ([columns, rows], tile_mm) = (self.mapping.grid(self.cells()), self.tile_mm());
        let figures = figures_in_words(setup, &history, &self.class);
        let random = config.is_some().then(|| self.random(setup)).transpose()?;
        let (beside, next) = random.map_or(Default::default(), |figures| {
            (beside(&figures), self.next_command(&path))
        });
        let defended = config
            .and_then(|config| config.eot.defence)
            .map_or_else(String::new, undefended);
        let words = format!(
            "{}: {columns} × {rows} cells, tile {tile_mm} mm{figures}{beside}{defended}{next}",
            path.display()
        );
        let made = Made {
            random,
            ..self.made(&history, Some(&path))
        };
        told(self.json, made, words, out)
    }

    /// What the detectors make of random cells on the views held out: what any print of such colours does.
    fn random(&self, setup: &Setup) -> Result<HeldOutFigures> {
        let cells = of_pattern(&Pattern::random_grid(self.mapping.grid(self.cells()), self.seed)?);
        Ok(judge(&setup.view_set, &setup.detectors, &cells)?)
    }

    /// What to do with a new pattern: a look at every view, also of other frames and by other detectors.
    fn next_command(&self, pattern: &Path) -> String {
        let frames: Vec<String> = self
            .frames
            .iter()
            .map(|path| quoted(&path.display().to_string()))
            .collect();
        let print = match self.mapping {
            TextureMapping::Sides => "`print wrap --texture`, as each side of the model has its own cells",
            _ => "`print wrap` for a mesh, `print template` for flat sheets",
        };
        format!(
            "\nnext: `scaleproof attack judge {} --detector {} --class {} --laying {} --pattern {}`, then print it ({print})",
            frames.join(" "),
            quoted(&self.detector.join(",")),
            quoted(&self.class.labels().join(",")),
            self.mapping.name(),
            quoted(&format!("attack={}", pattern.display()))
        )
    }

    /// The result for programs: what `history.json` ends with, and where the pattern is.
    pub(super) fn made<'a>(&'a self, history: &'a History, pattern: Option<&'a Path>) -> Made<'a> {
        Made {
            method: &history.method,
            seed: history.seed,
            tile_mm: history.tile_mm,
            cells: self.cells(),
            classes: &self.class,
            detectors: &history.detectors,
            pattern,
            queries: history.queries(),
            predicted: history.last_judged().map(|(_, figures)| figures),
            random: None,
        }
    }
}

/// `attack run --json` and `attack baseline … --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Made<'a> {
    /// As in `history.json`, like the others without a remark.
    method: &'a str,
    seed: u64,
    tile_mm: f64,
    /// Along each side.
    cells: u32,
    /// The labels that count as the model.
    classes: &'a Classes,
    detectors: &'a [String],
    /// The path of the PNG; `null` for patches.
    pattern: Option<&'a Path>,
    queries: u64,
    /// On held-out views, predicted and not rendered.
    predicted: Option<HeldOutFigures>,
    /// Those of random cells on these views; of `attack run` alone, else `null`.
    random: Option<HeldOutFigures>,
}

/// What random cells do, as a line after a line break; and that little is left to learn where they hide the model.
fn beside(random: &HeldOutFigures) -> String {
    let hidden = if random.ap50 < LITTLE_AP {
        "; they hide the model here already: frames in which it is smaller, or in other lights, teach more"
    } else {
        ""
    };
    format!(
        "\nrandom cells on these views: AP@0.5 {:.2}, hit rate {:.2}, mean confidence {:.2}{hidden}",
        random.ap50, random.hit_rate, random.mean_confidence
    )
}

/// That the figures of a pattern that knows a defence are not under it, as a line after a line break.
fn undefended(defence: Defence) -> String {
    let name = defence.name();
    format!(
        "\nboth without the defence {name}: `scaleproof score --defence {name}` judges photos of the print under it"
    )
}

/// What the held-out views say, and that they are predictions: lines, each after a line break.
pub(super) fn figures_in_words(setup: &Setup, history: &History, class: &Classes) -> String {
    let mut text = String::new();
    if let Some((entry, figures)) = history.last_judged() {
        let which = if setup.view_set.holds_out() {
            if setup.view_set.judged().len() < ENOUGH_HELD_OUT {
                "it was not made with (few: give 24 views or more, so that 12 are held out)"
            } else {
                "it was not made with"
            }
        } else {
            "it was made with (too few to hold any out)"
        };
        text += &format!(
            "\npredicted, not rendered: AP@0.5 {:.2}, hit rate {:.2}, mean confidence {:.2} on {} {which}; {} looked at in {:.0} s; \
             counts as the model: {class}",
            figures.ap50,
            figures.hit_rate,
            figures.mean_confidence,
            count(figures.views, "view"),
            count(entry.queries as usize, "image"),
            entry.wall_s
        );
    }
    if setup.view_set.unseen > 0 {
        let views = count(setup.view_set.unseen, "view");
        text += &format!("\nleft out, as the model's paint is not seen: {views}");
    }
    text
}

/// The pattern of a file, with a note where it is another one, enlarged.
pub(super) fn pattern_of(path: &Path) -> Result<Pattern, PatternError> {
    let pattern = Pattern::load(path)?;
    note_enlarged(path, &pattern);
    Ok(pattern)
}

pub(super) fn cells_of(path: &Path) -> Result<Pattern> {
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
