//! `capture` line by line: as JSON and in words.

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::{answer, told};
use crate::cli::args::capture::GuidedArgs;
use crate::cli::{CommandResult, Outcome, Result};
use scaleproof_capture::page::{CaptureNotice, Lan, Page, PairsSoFar};
use scaleproof_capture::{Advice, Capture, FrameAnswer, FrameLine, Guidance, SourceName, Target};
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::{Bin, Viewpoint};

/// The first line of `capture --page --json`.
#[derive(Serialize, JsonSchema)]
pub struct Address {
    /// The address of the page.
    page: String,
}

/// Says where the page is: the address for answers, what concerns people beside it.
pub fn introduce(page: &Page, json: bool, out: &mut dyn Write) -> Result<()> {
    if json {
        let page = page.address.clone();
        answer(&Address { page }, out)?
    } else {
        writeln!(out, "page: {}", page.address)?
    }
    out.flush()?;
    if let Some(lan) = &page.lan {
        invite(lan);
    }
    Ok(())
}

fn invite(lan: &Lan) {
    // Dark on light whatever the terminal's colours are: not every phone reads a code that is light on dark.
    let is_terminal = std::io::stderr().is_terminal();
    for line in lan.code.lines() {
        if is_terminal {
            eprintln!("\x1b[30;107m{line}\x1b[0m")
        } else {
            eprintln!("{line}")
        }
    }
    say!("phone: {}", lan.address);
    say!("certificate (SHA-256): {}", lan.fingerprint);
    say!(
        "warning: --lan opens this port to every machine in the network. The phone's browser warns of a certificate that nobody vouches for: \
         go on when the one it shows has this fingerprint. Each of the two addresses lets one browser in, once"
    );
}

/// What the pairs say so far, a line after each photo (`--until-decided`).
#[derive(Serialize, JsonSchema)]
pub struct StandingLine {
    /// As a sentence.
    pairs: String,
    /// Whether the pairs have shown enough, which ends the capture.
    decided: bool,
    /// The view that tells most next.
    next: Option<Bin>,
}

/// The line of a photo that `--undo` or `--redo` took back.
#[derive(Serialize, JsonSchema)]
pub struct TakenBack {
    /// The photo's name.
    taken_back: String,
}

/// Tells the terminal.
pub struct TerminalLog<'a> {
    json: bool,
    is_stream: bool,
    out: &'a mut dyn Write,
    said: SaidSoFar,
}

impl TerminalLog<'_> {
    pub fn new(json: bool, is_stream: bool, out: &mut dyn Write) -> TerminalLog<'_> {
        TerminalLog {
            json,
            is_stream,
            out,
            said: SaidSoFar::default(),
        }
    }

    /// Tells what happened.
    pub fn tell(&mut self, news: CaptureNotice) -> io::Result<()> {
        match news {
            CaptureNotice::Seen {
                frame,
                answer,
                guidance,
                is_filmed,
            } => self.seen(frame, answer, guidance, is_filmed),
            CaptureNotice::TakenBack { photo } => self.taken_back(photo),
            CaptureNotice::Set(settings) => {
                say!("note: {settings}");
                Ok(())
            }
        }
    }

    /// Prints what became of a frame; `is_filmed` by a browser, many times a second.
    fn seen(&mut self, frame: &str, answer: &FrameAnswer, guidance: &Guidance, is_filmed: bool) -> io::Result<()> {
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

    /// Prints the interim result of the pairs, and the view to take next.
    pub fn standing(&mut self, pairs: &PairsSoFar, guidance: &Guidance) -> io::Result<()> {
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

    pub fn taken_back(&mut self, photo: &str) -> io::Result<()> {
        if self.json {
            let taken_back = photo.to_owned();
            writeln!(self.out, "{}", serde_json::to_value(TakenBack { taken_back })?)?
        } else {
            writeln!(self.out, "taken back: {photo}")?
        }
        self.out.flush()
    }
}

/// Cautions and advice that were printed already: nobody could read twenty lines a second.
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

/// The last line of `--json`.
#[derive(Serialize, JsonSchema)]
pub struct CaptureSummary {
    /// How many views are required.
    targets: usize,
    /// How many of them are there.
    filled: usize,
    /// The views that are still open.
    open: Vec<Viewpoint>,
}

/// The last line of `--json` of a capture that the answer ended (`--until-decided`).
#[derive(Serialize, JsonSchema)]
pub struct Decided {
    /// How many views are required.
    targets: usize,
    /// How many of them are there.
    filled: usize,
    /// Always true.
    decided: bool,
}

/// `capture list-cameras --json`.
#[derive(Serialize, JsonSchema)]
pub struct Cameras {
    pub cameras: Vec<NamedCamera>,
}

#[derive(Serialize, JsonSchema)]
pub struct NamedCamera {
    /// What `--source` takes, such as `camera:0`.
    source: String,
    /// As the camera calls itself.
    name: String,
    description: String,
}

impl NamedCamera {
    pub fn new(number: u32, name: String, description: String) -> NamedCamera {
        NamedCamera {
            source: format!("camera:{number}"),
            name,
            description,
        }
    }
}

impl Cameras {
    pub fn in_words(&self) -> String {
        if self.cameras.is_empty() {
            return "no camera is there: plug one in, or watch the folder of a phone (--source watch:DIR)".to_owned();
        }
        let lines = self.cameras.iter();
        let lines = lines.map(|c| format!("{}  {}  ({})", c.source, c.name, c.description));
        lines.collect::<Vec<_>>().join("\n")
    }
}

/// Says what the capture waits for, before anything happens; programs read it in the summary.
pub fn begin(args: &GuidedArgs, guidance: &Guidance, out: &mut dyn Write) -> io::Result<()> {
    let (Some(first), Some(source), false) = (guidance.open().next(), &args.source, args.json) else {
        return Ok(());
    };
    let ((filled, all), place) = (guidance.filled_of_all(), first.in_words());
    let (open, views) = (all - filled, count(all, "view"));
    let views = if filled == 0 {
        format!("{views} to take; start {place}")
    } else {
        format!("{open} of {views} still open; go on {place}")
    };
    let how = match source {
        SourceName::Watch(folder) if args.headless => format!("looking at the photos in {}", folder.display()),
        SourceName::Watch(folder) => format!("copy photos into {}; Ctrl-C ends", folder.display()),
        SourceName::Replay(folder) => format!("replaying the photos of {}", folder.display()),
        SourceName::Camera(_) | SourceName::Stream(_) => "walk round the model with the camera; Ctrl-C ends".to_owned(),
        SourceName::Upload => "send photos to the page".to_owned(),
    };
    writeln!(out, "{views}; {how}")?;
    out.flush()
}

/// The end of a capture whose question is decided: open views are not needed.
pub fn enough(capture: &Capture, json: bool, out: &mut dyn Write) -> CommandResult {
    let (filled, all) = capture.guidance().filled_of_all();
    let words = format!("decided; {} of {} not needed", all - filled, count(all, "view"));
    let decided = Decided {
        targets: all,
        filled,
        decided: true,
    };
    told(json, decided, words, out)
}

pub fn finish(capture: &Capture, json: bool, out: &mut dyn Write) -> CommandResult {
    let guidance = capture.guidance();
    let open: Vec<&Target> = guidance.open().collect();
    let (filled, all) = guidance.filled_of_all();
    if json {
        let summary = CaptureSummary {
            targets: all,
            filled,
            open: open.iter().map(|target| target.viewpoint).collect(),
        };
        writeln!(out, "{}", serde_json::to_string(&summary)?)?;
    } else if open.is_empty() {
        writeln!(out, "all {all} views are there")?;
    } else {
        let names: Vec<String> = open.iter().map(ToString::to_string).collect();
        writeln!(out, "{filled} of {all} views are there; open: {}", names.join(", "))?;
    }
    Ok(if open.is_empty() {
        Outcome::Done
    } else {
        Outcome::SomeInputBad
    })
}

/// `capture --json`: one object a line for each frame, for what else happens, and one at the end.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "each line is printed as its own type")]
pub enum Line<'a> {
    Page(Address),
    Frame(FrameLine<'a>),
    TakenBack(TakenBack),
    Standing(StandingLine),
    Decided(Decided),
    End(CaptureSummary),
}
