//! `--defence`: what is done with photos before the detectors look at them, by name, or a program of the user's own.

use std::collections::BTreeSet;
use std::sync::Arc;

use clap::builder::StringValueParser;

use super::Result;
use super::choice::completing;
use super::results::Programs;
use scaleproof_detect::ProgramSpec;
use scaleproof_photo::defence::Defence;
use scaleproof_score::{Defending, UNDEFENDED};

#[derive(clap::Args)]
pub(super) struct Defences {
    /// Look at the photos again, changed as papers do it to take a pattern's effect away, and tell what is left of each drop: jpeg, bit-depth, median, resize-pad,
    /// crops; with an amount as in `jpeg=50`; a program of your own is `exec:PROGRAM` or `'exec:PROGRAM ARGUMENT …'`.
    #[arg(id = "defence", long = "defence", value_name = "NAME,…", value_delimiter = ',', value_parser = completing(StringValueParser::new(), Defence::NAMES))]
    names: Vec<String>,
}

impl Defences {
    pub(super) fn are_given(&self) -> bool {
        !self.names.is_empty()
    }

    /// Reads the names, and starts the programs.
    pub(super) fn opened(&self, programs: &Programs) -> Result<Vec<Defending>> {
        let mut opened = Vec::new();
        for name in self.names.iter().map(|name| name.trim()) {
            opened.push(match ProgramSpec::named(name)? {
                Some(program) => Defending::Program(Arc::new(programs.started_as_defence(program)?)),
                None => Defending::Published(Defence::named(name)?),
            });
        }
        let mut seen = BTreeSet::from([UNDEFENDED.to_owned()]);
        match opened
            .iter()
            .map(Defending::name)
            .find(|name| !seen.insert(name.clone()))
        {
            Some(name) => Err(format!("two defences are called {name}: leave one out, or give it another name").into()),
            None => Ok(opened),
        }
    }
}
