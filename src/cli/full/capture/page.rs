//! `scaleproof capture --page`: the same capture in a browser.

use std::cell::RefCell;
use std::error::Error;
use std::io::{IsTerminal, Write};

use schemars::JsonSchema;
use serde::Serialize;

use super::decided::Question;
use super::terminal::TerminalLog;
use crate::cli::Result;
use crate::cli::answer::answer;
use scaleproof_capture::page::{AskPairs, CaptureInfo, CaptureNotice, Lan, Page, PageError};
use scaleproof_capture::{Capture, FrameSource, Guidance};
use scaleproof_pose::scene::Scene;

/// The page in a browser.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Show the capture as a page in a browser, which can also take back, send photos, and finish
    #[arg(long, conflicts_with = "headless")]
    pub page: bool,
    /// Serve the page at this port; 0 is any free one
    #[arg(long, value_name = "N", default_value_t = 8710, requires = "page")]
    pub port: u16,
    /// Let phones in the local network join by the QR code that is shown, instead of only browsers on this machine
    #[arg(long, requires = "page")]
    pub lan: bool,
}

/// The first line of `capture --page --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Address {
    /// The address of the page.
    page: String,
}

/// Says where the page is: the address for answers, what concerns people beside it.
pub(super) fn introduce(page: &Page, json: bool, out: &mut dyn Write) -> Result<()> {
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

/// Shows the page until somebody finishes, and tells the terminal the same. Whether the question is decided.
pub(super) fn follow(
    page: Page,
    (capture, scene): (&mut Capture, &Scene),
    source: Option<Box<dyn FrameSource + Send>>,
    about: &CaptureInfo,
    question: Option<&Question>,
    terminal: TerminalLog,
) -> Result<bool> {
    let terminal = RefCell::new(terminal);
    let asked = |question: &Question, guidance: &Guidance| question.ask(guidance, &mut terminal.borrow_mut());
    let asking = question.map(|question| move |guidance: &Guidance| asked(question, guidance));
    let ask: Option<AskPairs> = asking.as_ref().map(|ask| ask as AskPairs);
    let followed = page.follow(capture, scene, source, about, ask, &mut |news| match news {
        CaptureNotice::Seen {
            frame,
            answer,
            guidance,
            is_filmed,
        } => terminal.borrow_mut().seen(frame, answer, guidance, is_filmed),
        CaptureNotice::TakenBack { photo } => terminal.borrow_mut().taken_back(photo),
        CaptureNotice::Set(settings) => {
            terminal.borrow_mut().set(settings);
            Ok(())
        }
    });
    followed.map_err(advised)
}

/// An error of the page; a closed output is the system's.
pub(super) fn advised(e: PageError) -> Box<dyn Error> {
    match e {
        PageError::Output(e) => e.into(),
        e => e.into(),
    }
}
