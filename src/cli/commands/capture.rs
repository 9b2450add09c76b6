//! `scaleproof capture`: walk round the model once and have every view.

use std::cell::RefCell;
use std::error::Error;
use std::io::Write;

use super::decided::Question;
use crate::cli::answer::told;
use crate::cli::args::capture::{Args, Command, DecidedArgs, GuidedArgs, ListArgs};
use crate::cli::commands::interrupt::{Opening, on_interrupt};
use crate::cli::print::capture::{Cameras, NamedCamera, TerminalLog, begin, enough, finish, introduce};
use crate::cli::{CommandResult, Result};
use scaleproof_capture::page::{AskPairs, CaptureNotice, PageError};
use scaleproof_capture::{
    BinName, Capture, Guidance, GuidedCapture, GuidedError, GuidedRequest, Target, interrupt_programs,
    live::list_cameras,
};

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match (args.command, args.guided) {
        (Some(Command::ListCameras(args)), _) => list(&args, out),
        (None, Some(guided)) => {
            let request = guided.request(&args.wanted, &args.browser)?;
            guide(&guided, request, &args.decided, out)
        }
        (None, None) => Err("say where photos come from with --source (see --help)".into()),
    }
}

fn list(args: &ListArgs, out: &mut dyn Write) -> CommandResult {
    let cameras = list_cameras().map_err(|reason| format!("the cameras cannot be listed: {reason}"))?;
    let cameras = cameras.into_iter();
    let cameras = cameras.map(|camera| NamedCamera::new(camera.number, camera.name, camera.description));
    let cameras = Cameras {
        cameras: cameras.collect(),
    };
    let words = cameras.in_words();
    told(args.json, cameras, words, out)
}

fn guide(args: &GuidedArgs, request: GuidedRequest, decided: &DecidedArgs, out: &mut dyn Write) -> CommandResult {
    // However this ends: the threads that own them are left behind.
    let _programs = Interrupting;
    let opening = Opening::new();
    let at_once = || {
        interrupt_programs();
        std::process::exit(130)
    };
    let opened = request
        .open(&mut |note| say!("note: {note}"), at_once)
        .map_err(unwrapped)?;
    drop(opening);
    let question = decided.question(args.output.clone(), &args.variant, &args.place)?;
    let mut guided = opened.begin()?;
    take_back(args, &mut guided, out)?;
    begin(args, guided.capture.guidance(), out)?;
    if let Some(page) = &guided.page {
        introduce(page, args.json, out)?;
    }
    let terminal = RefCell::new(TerminalLog::new(args.json, guided.info.is_stream, out));
    let asking = question.as_ref().map(|question: &Question| {
        |guidance: &Guidance| {
            let pairs = question.ask(guidance)?;
            terminal.borrow_mut().standing(&pairs, guidance)?;
            Ok(pairs)
        }
    });
    let ask: Option<AskPairs> = asking.as_ref().map(|ask| ask as AskPairs);
    let mut notify = |news: CaptureNotice<'_>| terminal.borrow_mut().tell(news);
    let end = guided
        .follow(ask, &mut notify, &|first| on_interrupt(first))
        .map_err(|e| unwrapped(e.into()))?;
    if end.was_interrupted {
        say!("stopped; the same command with -o {} goes on", args.output.display());
    }
    if end.is_decided {
        enough(&guided.capture, args.json, out)
    } else {
        finish(&guided.capture, args.json, out)
    }
}

/// Asks the programs that read for a source to end, when it is dropped.
struct Interrupting;

impl Drop for Interrupting {
    fn drop(&mut self) {
        interrupt_programs();
    }
}

/// Unwraps what the page only passes on: a closed output is the system's.
fn unwrapped(e: GuidedError) -> Box<dyn Error> {
    match e {
        GuidedError::Page(PageError::Output(e)) => e.into(),
        GuidedError::Page(PageError::Pairs(e)) => e,
        e => e.into(),
    }
}

fn take_back(args: &GuidedArgs, guided: &mut GuidedCapture, out: &mut dyn Write) -> Result<()> {
    let capture = &mut guided.capture;
    let photos = match (&args.redo, args.undo) {
        (Some(meant), _) => capture.redo(&guided.scene, |bin| meant.names(bin))?,
        (None, true) => capture.undo()?.into_iter().collect(),
        (None, false) => return Ok(()),
    };
    if photos.is_empty() {
        if let Some(meant) = &args.redo {
            check_planned(meant, capture)?;
        }
        say!("note: there is no photo of {} to take back", args.variant);
    }
    let mut terminal = TerminalLog::new(args.json, false, out);
    photos.iter().try_for_each(|photo| terminal.taken_back(photo))?;
    Ok(())
}

/// A bin that no view falls into is mistyped.
fn check_planned(meant: &BinName, capture: &Capture) -> Result<()> {
    let targets = capture.guidance().targets();
    if targets.iter().any(|target| meant.names(&target.bin)) {
        return Ok(());
    }
    let name = |target: &Target| {
        format!(
            "{}/{}/{}",
            target.bin.azimuth_deg, target.bin.pitch_deg, target.bin.distance_mm
        )
    };
    let mut bins: Vec<String> = targets.iter().map(name).collect();
    bins.dedup();
    Err(format!(
        "no view is of the bin that --redo names: the bins of the views are {}",
        bins.join(", ")
    )
    .into())
}
