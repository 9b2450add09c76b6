//! What the terminal shows of a capture: a line for each thing that happens.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::time::{Duration, Instant};

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_capture::page::PairsSoFar;
use scaleproof_capture::{Advice, CameraSettings, FrameAnswer, Guidance};
use scaleproof_pose::scene::Bin;

/// What the pairs say so far, a line after each photo (`--until-decided`).
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct StandingLine {
    /// As a sentence.
    pairs: String,
    /// Whether the pairs have shown enough, which ends the capture.
    decided: bool,
    /// The view that tells most next.
    next: Option<Bin>,
}

/// The line of a photo that `--undo` or `--redo` took back.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct TakenBack {
    /// The photo's name.
    taken_back: String,
}

/// Tells the terminal.
pub(super) struct TerminalLog<'a> {
    json: bool,
    is_stream: bool,
    out: &'a mut dyn Write,
    said: SaidSoFar,
}

impl TerminalLog<'_> {
    pub(super) fn new(json: bool, is_stream: bool, out: &mut dyn Write) -> TerminalLog<'_> {
        TerminalLog {
            json,
            is_stream,
            out,
            said: SaidSoFar::default(),
        }
    }

    /// What became of a frame; `is_filmed` by a browser, many times a second.
    pub(super) fn seen(
        &mut self,
        frame: &str,
        answer: &FrameAnswer,
        guidance: &Guidance,
        is_filmed: bool,
    ) -> io::Result<()> {
        let is_stream = self.is_stream || is_filmed;
        for caution in answer.cautions.iter().filter(|caution| self.said.is_new(caution)) {
            say!("note: {caution}");
        }
        match self.json {
            true => writeln!(self.out, "{}", serde_json::to_string(&answer.line(frame, guidance))?)?,
            false if is_stream && !self.said.is_worth_saying(answer) => return Ok(()),
            false if is_stream => writeln!(self.out, "{}", answer.sentence(guidance))?,
            false => writeln!(self.out, "{frame}: {}", answer.sentence(guidance))?,
        }
        self.out.flush()
    }

    /// What the pairs say so far, and where to go next.
    pub(super) fn standing(&mut self, pairs: &PairsSoFar, guidance: &Guidance) -> io::Result<()> {
        let next = pairs.next.filter(|_| !pairs.is_decided);
        let next = next.map(|next| &guidance.targets()[next]);
        if self.json {
            let line = StandingLine {
                pairs: pairs.sentence.clone(),
                decided: pairs.is_decided,
                next: next.map(|target| target.bin),
            };
            writeln!(self.out, "{}", serde_json::to_value(&line)?)?;
        } else {
            let next = next.map_or_else(String::new, |target| format!("; tells most next: {target}"));
            writeln!(self.out, "  {}{next}", pairs.sentence)?;
        }
        self.out.flush()
    }

    /// What a camera is set to now.
    pub(super) fn set(&mut self, settings: &CameraSettings) {
        say!("note: {settings}");
    }

    pub(super) fn taken_back(&mut self, photo: &str) -> io::Result<()> {
        if self.json {
            let taken_back = photo.to_owned();
            writeln!(self.out, "{}", serde_json::to_value(TakenBack { taken_back })?)?
        } else {
            writeln!(self.out, "taken back: {photo}")?
        }
        self.out.flush()
    }
}

/// What was said already: twenty frames a second would not be read.
#[derive(Default)]
struct SaidSoFar {
    cautions: BTreeSet<String>,
    last: Option<(Advice, Instant)>,
}

/// Advice of the same kind is said again after this time.
const AGAIN: Duration = Duration::from_millis(700);

impl SaidSoFar {
    fn is_new(&mut self, caution: &str) -> bool {
        self.cautions.insert(caution.to_owned())
    }

    /// Photos always are, advice when it is of another kind than the last, or after a while another amount.
    fn is_worth_saying(&mut self, answer: &FrameAnswer) -> bool {
        let Err(advice) = &answer.verdict else {
            self.last = None;
            return true;
        };
        if let Some((last, when)) = &self.last
            && (last.to_string() == advice.to_string() || last.code() == advice.code() && when.elapsed() < AGAIN)
        {
            return false;
        }
        self.last = Some((advice.clone(), Instant::now()));
        true
    }
}
