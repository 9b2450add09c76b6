//! `scaleproof attack run`: a pattern against detectors.

use std::io::Write;
use std::path::PathBuf;

use clap::builder::StringValueParser;

use super::on_frames::{OnFrames, pattern_of};
use crate::cli::choice::{completing, one_of};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::history::Entry;
use scaleproof_attack::run::printer::PrinterMap;
use scaleproof_attack::run::weights::Against;
use scaleproof_attack::run::{Attack, AttackConfig, CellColours, Near, Rgb, of_image};
use scaleproof_attack::setup::Setup;
use scaleproof_core::files;
use scaleproof_gradients::Boxes;
use scaleproof_photo::defence::Defence;
use scaleproof_print::printer::PrinterFile;
use scaleproof_surface::pattern::palette::{MAX_PAINTS, Palette, PaletteError};

/// Make a pattern that detectors do not see a model in (DTA), from frames in flat colours
#[derive(clap::Args)]
pub(in crate::cli) struct RunArgs {
    #[command(flatten)]
    on: OnFrames,
    /// Steps of Adam
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// Views a step
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    batch: u32,
    /// Step size of Adam, in sRGB of 0 to 1
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    rate: f64,
    /// Confidence below which the loss stops penalising a box: 0.5 is DTA's own loss, which stops at a miss; AP counts boxes down to 0.001
    #[arg(
        long,
        value_name = "CONFIDENCE",
        default_value_t = 0.0003,
        allow_negative_numbers = true
    )]
    floor: f64,
    /// Which boxes on the model count: the most confident one (DTA), all by the sum of their odds, or all weighted with their overlap
    #[arg(long, default_value = "strongest", value_parser = one_of(Boxes::ALL.map(|boxes| (boxes, boxes.name()))))]
    loss: Boxes,
    /// Of several detectors: what is made small, their mean loss or that of the one that still sees the model best
    #[arg(long, default_value = "mean", value_parser = one_of(Against::ALL.map(|against| (against, against.name()))))]
    against: Against,
    /// Share of a step's views that are drawn for how well the model is still seen in them
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, allow_negative_numbers = true)]
    hard: f64,
    /// What happens to images at random besides the usual (a little brightness, contrast, size, place and noise): several as in blur,shift, or one of the
    /// defences of `score --defence` as in median=3; `none` for nothing at all
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = completing(StringValueParser::new(), augmentations()))]
    augment: Vec<String>,
    /// Weight of the differences between neighbouring cells
    #[arg(long, value_name = "WEIGHT", default_value_t = 0.0, allow_negative_numbers = true)]
    smooth: f64,
    /// Optimise the pattern as this printer prints it: the file that `colour read` put the printer's colours in
    #[arg(long, value_name = "TOML", conflicts_with = "palette")]
    printer: Option<PathBuf>,
    /// Keep the pattern near this one: a PNG file of as many cells, or of a half, a third, …: a coarse pattern to be refined
    #[arg(long, value_name = "PNG", requires = "near_weight")]
    near: Option<PathBuf>,
    /// How strongly: the weight of the mean squared distance
    #[arg(long, value_name = "WEIGHT", requires = "near", allow_negative_numbers = true)]
    near_weight: Option<f64>,
    /// The pattern has the colours of this palette alone: a TOML file of [[paint]] tables
    #[arg(long, value_name = "TOML")]
    palette: Option<PathBuf>,
    /// The pattern has at most so many colours of its own choice, 2 to 24
    #[arg(long, value_name = "N", conflicts_with_all = ["palette", "printer"], allow_negative_numbers = true)]
    paints: Option<i64>,
    /// Darkest and lightest value of a cell, 8-bit sRGB
    #[arg(long, num_args = 2, value_names = ["DARKEST", "LIGHTEST"], default_values = ["0", "255"])]
    range: Vec<u8>,
}

/// What histories and cards call the attack.
pub(super) const METHOD: &str = "dta";

pub(super) fn run(args: &RunArgs, out: &mut dyn Write) -> CommandResult {
    let config = args.config()?;
    let setup = args.on.open(METHOD, true, &config.eot)?;
    let config = setup.named(config);
    let (cells, entries) = optimise(&args.on, &setup, &config)?;
    args.on.write(&setup, (METHOD, &cells, entries), Some(&config), out)
}

/// Runs the attack with a bar that shows where it stands.
pub(super) fn optimise(on: &OnFrames, setup: &Setup, config: &AttackConfig) -> Result<(Vec<Rgb>, Vec<Entry>)> {
    let finished = progress::steps("attacking", config.steps as usize).during(|bar| {
        let attack = Attack::begin(&setup.view_set, &setup.detectors, config, &on.output)?;
        attack.run(&on.output, |done, entry| {
            bar.set_position(u64::from(done));
            if let Some(confidence) = entry.confidence {
                bar.set_message(format!("confidence {confidence:.2}"));
            }
        })
    });
    Ok(finished?)
}

impl RunArgs {
    /// What the options say; [`Setup::named`] adds the frames and detectors.
    fn config(&self) -> Result<AttackConfig> {
        for (option, given, range, what) in [
            ("rate", self.rate, 1e-6..=1.0, "number"),
            ("floor", self.floor, 1e-6..=0.5, "confidence"),
            ("smooth", self.smooth, 0.0..=1e6, "weight"),
            ("near-weight", self.near_weight.unwrap_or(0.0), 0.0..=1e6, "weight"),
        ] {
            if !range.contains(&given) {
                let (low, high) = range.into_inner();
                return Err(format!("--{option} is {given:e}: give a {what} from {low} to {high}").into());
            }
        }
        if !(0.0..=1.0).contains(&self.hard) {
            return Err(format!("--hard is {}: give a share from 0 to 1", self.hard).into());
        }
        let range = match self.range[..] {
            [low, high] if low < high => [low, high],
            _ => return Err("--range must be a darkest value and a lighter one, as in 20 240".into()),
        };
        if self.palette.is_some() && range != [0, 255] {
            return Err("--range goes with colours of the pattern's own choice: leave it out, or take the paints that are not wanted out of --palette".into());
        }
        Ok(AttackConfig {
            steps: self.steps,
            batch: self.batch,
            learning_rate: self.rate,
            boxes: self.loss,
            floor: self.floor,
            against: self.against,
            hard: self.hard,
            eot: self.eot()?,
            smooth: self.smooth,
            near: self.near()?,
            printer: self.printer()?,
            colours: self.colours()?,
            range,
            ..self.on.config()
        })
    }

    fn eot(&self) -> Result<Eot> {
        let mut eot = self.on.mapping.usual_eot();
        if self.augment.iter().any(|name| name == "none") {
            return match self.augment.len() {
                1 => Ok(Eot::NONE),
                _ => Err("--augment none goes with no other: leave the others out".into()),
            };
        }
        for asked in &self.augment {
            match Eot::KINDS.iter().find(|(name, _)| name == asked) {
                Some((_, add)) => add(&mut eot),
                None if eot.defence.is_some() => {
                    return Err(format!("--augment {asked} is a second defence: name one").into());
                }
                None => eot.defence = Some(Defence::named(asked).map_err(|fault| no_augmentation(asked, fault))?),
            }
        }
        Ok(eot)
    }

    fn near(&self) -> Result<Option<Near>> {
        let (Some(path), Some(weight)) = (&self.near, self.near_weight) else {
            return Ok(None);
        };
        let pattern = pattern_of(path)?;
        let grid = self.on.mapping.grid(self.on.cells());
        let cells = pattern.divided(grid).ok_or_else(|| {
            format!(
                "{} has {}×{} cells, and here are {}×{}: give one of as many, or of a half, a third, … across and down alike",
                path.display(),
                pattern.columns(),
                pattern.rows(),
                grid[0],
                grid[1]
            )
        })?;
        Ok(Some(Near {
            weight,
            cells: of_image(&cells),
        }))
    }

    fn printer(&self) -> Result<Option<PrinterMap>> {
        let Some(path) = &self.printer else {
            return Ok(None);
        };
        let Some(colours) = PrinterFile::load(path)?.colours else {
            return Err(format!(
                "{} has no colours: add them with `scaleproof colour read`",
                path.display()
            )
            .into());
        };
        let sha256 = files::sha256_hex(&files::read(path)?);
        Ok(Some(PrinterMap::new(colours.gamut(), sha256)))
    }

    fn colours(&self) -> Result<CellColours> {
        match (&self.palette, self.paints) {
            (Some(path), _) => {
                let palette = Palette::load(path)?;
                let paints = palette.paints().iter().map(|paint| paint.rgb);
                Ok(CellColours::Palette(paints.collect()))
            }
            (None, Some(asked)) => match usize::try_from(asked) {
                Ok(count) if (2..=MAX_PAINTS).contains(&count) => Ok(CellColours::Own(count)),
                _ => Err(PaletteError::BadCount { asked }.into()),
            },
            (None, None) => Ok(CellColours::Free),
        }
    }
}

/// What `--augment` takes, without the amounts of defences.
fn augmentations() -> Vec<&'static str> {
    let kinds = Eot::KINDS.iter().map(|(name, _)| *name);
    let mut names: Vec<&str> = kinds.chain(["none"]).collect();
    // The kind `jpeg` is of any quality; the defence is written with its own.
    names.extend(Defence::NAMES.iter().filter(|name| **name != "jpeg"));
    names
}

/// Why something is no augmentation; `fault`: why it is no defence.
fn no_augmentation(asked: &str, fault: String) -> String {
    let name = asked.split('=').next().unwrap_or_default();
    if asked.starts_with("exec:") {
        return format!(
            "--augment {asked}: a program gives no derivative, so only the defences with a name can be attacked through: take one of {}",
            Defence::NAMES.join(", ")
        );
    }
    if Defence::NAMES.contains(&name) {
        return fault;
    }
    format!(
        "there is no augmentation “{asked}”: take some of {}",
        augmentations().join(", ")
    )
}
