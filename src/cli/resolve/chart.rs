//! Photos and output files of `chart`, resolved from its arguments.

use std::io::Write;

use serde::Serialize;

use crate::cli::answer::{told, written};
use crate::cli::args::chart::{ChartFiles, ChartInput};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_session::Session;
use scaleproof_study::chart::locate::PhotoSample;

impl ChartFiles {
    pub fn write(
        &self,
        name: &str,
        numbers: &impl Serialize,
        drawn: &[(&str, String)],
        table: &str,
        out: &mut dyn Write,
    ) -> CommandResult {
        let mut new = vec![(self.output.join(name), serde_json::to_vec_pretty(numbers)?)];
        let svg = |(name, svg): &(&str, String)| (self.output.join(name), svg.clone().into_bytes());
        new.extend(drawn.iter().map(svg));
        files::replace_all_atomically(&self.output, &new)?;
        let paths = new.iter().map(|(path, _)| format!("\n{}", path.display()));
        let words = table.to_owned() + &paths.collect::<String>();
        told(self.json, written(&new, numbers), words, out)
    }
}

impl ChartInput {
    pub fn samples(&self) -> Result<(Session, Vec<PhotoSample>)> {
        let session = Session::open(&self.session)?;
        let samples = progress::photos("reading", session.photos.len())
            .during(|bar| PhotoSample::of_session(&session, &self.truth, || bar.inc(1)))?;
        Ok((session, samples))
    }
}
