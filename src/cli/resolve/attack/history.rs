//! Results and evaluation of `attack history`, resolved from its arguments.

use std::collections::HashMap;
use std::path::Path;

use crate::cli::Result;
use crate::cli::args::attack::history::HistoryArgs;
use crate::cli::print::card_fault;
use scaleproof_attack::evaluate::finished::figures_of;
use scaleproof_attack::evaluate::time_chart::RenderedRun;
use scaleproof_attack::result;
use scaleproof_attack::run::history::History;
use scaleproof_core::files;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::{self, CardError};

impl HistoryArgs {
    /// Returns each run with the figures of its pattern in the evaluation; none without an evaluation.
    pub fn rendered(&self, histories: &[History]) -> Result<Vec<RenderedRun>> {
        let Some(evaluation) = &self.evaluation else {
            return Ok(Vec::new());
        };
        let runs = self.results.iter().zip(histories);
        runs.map(|(folder, history)| {
            let pattern = folder.join(result::PATTERN);
            check_own(&pattern)?;
            let figures = figures_of(evaluation, &pattern, history.tile_mm, history.classes.as_ref())?;
            Ok(RenderedRun::new(history, figures))
        })
        .collect()
    }

    pub fn refuse_twice(&self) -> Result<()> {
        let mut known = HashMap::new();
        for folder in &self.results {
            if let Some(first) = known.insert(files::whole_path(folder)?, folder) {
                let (first, again) = (first.display(), folder.display());
                return Err(format!("{first} and {again} are the same result: name it once").into());
            }
        }
        Ok(())
    }
}

/// The pattern of a result is the one that its card was written for, and no texture.
pub fn check_own(path: &Path) -> Result<(), String> {
    let pattern = Pattern::load(path).map_err(|e| e.to_string())?;
    match card::card(path, &pattern) {
        Ok(card) if card.sides => Err(format!(
            "{} has cells for each side, which evaluations hold as a texture: --evaluation shows repeated patterns alone",
            path.display()
        )),
        Ok(_) | Err(CardError::None { .. }) => Ok(()),
        Err(e) => Err(card_fault(&e)),
    }
}
