//! Settings of `attack run`, resolved from its arguments.

use crate::cli::Result;
use crate::cli::args::attack::run::{RunArgs, no_augmentation};
use crate::cli::resolve::attack::on_frames::pattern_of;
use scaleproof_attack::run::augmentation::Eot;
use scaleproof_attack::run::printer::PrinterMap;
use scaleproof_attack::run::{AttackConfig, CellColours, Near, of_image};
use scaleproof_core::files;
use scaleproof_photo::defence::Defence;
use scaleproof_print::printer::PrinterFile;
use scaleproof_surface::pattern::palette::{MAX_PAINTS, Palette, PaletteError};

impl RunArgs {
    /// Returns the settings that the options give; [`Setup::named`] adds the frames and detectors.
    pub fn config(&self) -> Result<AttackConfig> {
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

    pub fn eot(&self) -> Result<Eot> {
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

    pub fn near(&self) -> Result<Option<Near>> {
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

    pub fn printer(&self) -> Result<Option<PrinterMap>> {
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

    pub fn colours(&self) -> Result<CellColours> {
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
