//! What the terminal shows of a capture: a line for each thing that happens.

use schemars::JsonSchema;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::decided::Standing;
use super::name;
use scaleproof_capture::capture::{Advice, CameraSettings, FrameAnswer, Guidance, Measures};
use scaleproof_pose::scene::{Bin, Viewpoint};

/// One line of `--json` for a frame.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct FrameLine<'a> {
    /// What the source calls the frame.
    frame: &'a str,
    /// `accepted` or `refused`.
    status: &'static str,
    /// The photo's name in the session.
    photo: Option<&'a str>,
    /// The view that the photo was taken for; `null` when refused.
    bin: Option<Bin>,
    /// What keeps the frame from being taken, as a word for programs (explained in codes.md); `null` when accepted.
    code: Option<&'static str>,
    /// What keeps the frame from being taken, as a sentence; `null` when accepted.
    advice: Option<String>,
    /// From where the frame was taken; `null` without a pose.
    viewpoint: Option<Viewpoint>,
    gates: Measures,
}

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

    pub(super) fn seen(&mut self, frame: &str, answer: &FrameAnswer, guidance: &Guidance) -> io::Result<()> {
        for caution in answer.cautions.iter().filter(|caution| self.said.is_new(caution)) {
            say!("note: {caution}");
        }
        match self.json {
            true => writeln!(self.out, "{}", serde_json::to_string(&line(frame, answer, guidance))?)?,
            false if self.is_stream && !self.said.is_worth_saying(answer) => return Ok(()),
            false if self.is_stream => writeln!(self.out, "{}", sentence(answer, guidance))?,
            false => writeln!(self.out, "{frame}: {}", sentence(answer, guidance))?,
        }
        self.out.flush()
    }

    /// What the pairs say so far, and where to go next.
    pub(super) fn standing(&mut self, standing: &Standing) -> io::Result<()> {
        let next = standing.next.as_ref().filter(|_| !standing.is_decided);
        if self.json {
            let line = StandingLine {
                pairs: standing.sentence.clone(),
                decided: standing.is_decided,
                next: next.map(|target| target.bin),
            };
            writeln!(self.out, "{}", serde_json::to_value(&line)?)?;
        } else {
            let next = next.map_or_else(String::new, |target| format!("; tells most next: {}", name(target)));
            writeln!(self.out, "  {}{next}", standing.sentence)?;
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

fn line<'a>(frame: &'a str, answer: &'a FrameAnswer, guidance: &Guidance) -> FrameLine<'a> {
    let (accepted, advice) = (answer.verdict.as_ref().ok(), answer.verdict.as_ref().err());
    FrameLine {
        frame,
        status: if accepted.is_some() { "accepted" } else { "refused" },
        photo: accepted.map(|(photo, _)| photo.as_str()),
        bin: accepted.map(|(_, target)| guidance.targets()[*target].bin),
        code: advice.map(|advice| advice.code()),
        advice: advice.map(|advice| advice.to_string()),
        viewpoint: answer.viewpoint,
        gates: answer.measures,
    }
}

fn sentence(answer: &FrameAnswer, guidance: &Guidance) -> String {
    match &answer.verdict {
        Ok((photo, target)) => {
            let targets = guidance.targets();
            let filled = targets.len() - guidance.open().count();
            format!(
                "taken as {photo}, {} ({filled} of {})",
                name(&targets[*target]),
                targets.len()
            )
        }
        Err(advice) => advice.to_string(),
    }
}
