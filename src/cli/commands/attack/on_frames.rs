//! Results of attacks and their baselines: written, and told with what random cells do.

use std::io::Write;
use std::path::Path;

use crate::cli::answer::told;
use crate::cli::args::attack::on_frames::OnFrames;
use crate::cli::print::attack::on_frames::{Made, beside, figures_in_words, undefended};
use crate::cli::{CommandResult, Result};
use scaleproof_attack::result;
use scaleproof_attack::run::history::{Entry, History};
use scaleproof_attack::run::judge::{HeldOutFigures, judge};
use scaleproof_attack::run::view_set::TextureMapping;
use scaleproof_attack::run::{AttackConfig, Rgb, of_pattern};
use scaleproof_attack::setup::Setup;
use scaleproof_core::spelling::quoted;
use scaleproof_surface::pattern::Pattern;

impl OnFrames {
    pub fn write(
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

    /// Evaluates a pattern of random cells on the held-out views: the effect of any print of such colours.
    pub fn random(&self, setup: &Setup) -> Result<HeldOutFigures> {
        let cells = of_pattern(&Pattern::random_grid(self.mapping.grid(self.cells()), self.seed)?);
        Ok(judge(&setup.view_set, &setup.detectors, &cells)?)
    }

    /// Returns the line that names the next command for a new pattern: `attack judge` on every view, then printing.
    pub fn next_command(&self, pattern: &Path) -> String {
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
    pub fn made<'a>(&'a self, history: &'a History, pattern: Option<&'a Path>) -> Made<'a> {
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
