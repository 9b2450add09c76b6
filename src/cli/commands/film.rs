//! `scaleproof session from-video`: the best frames of a walk round the model become photos of a session.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cli::CommandResult;
use crate::cli::answer::told;
use crate::cli::args::film::FilmArgs;
use crate::cli::commands::interrupt::on_interrupt;
use crate::cli::print::film::{Answer, in_words};
use scaleproof_film::session::{FilmError, FilmStep};
use scaleproof_terminal::progress::{self, Progress};

pub fn run(args: &FilmArgs, out: &mut dyn Write) -> CommandResult {
    let film = args.request()?.open()?;
    let stopped = Arc::new(AtomicBool::new(false));
    let heard = stopped.clone();
    on_interrupt(move || heard.store(true, Ordering::Relaxed));
    let mut bar: Option<(FilmStep, Progress)> = None;
    let mut progress = |step, done: usize, all| {
        if bar.as_ref().is_none_or(|(shown, _)| *shown != step) {
            finish(bar.take());
            let words = match step {
                FilmStep::Looking => "looking at",
                FilmStep::Keeping => "keeping",
            };
            bar = Some((step, progress::frames(words, all)));
        }
        if let Some((_, bar)) = &bar {
            bar.set_position(done as u64);
        }
        !stopped.load(Ordering::Relaxed)
    };
    let filmed = film.to_session(&mut progress);
    match filmed {
        Ok(filmed) => {
            finish(bar);
            let answer = Answer::of(&film, &filmed);
            let words = in_words(&answer, &filmed);
            told(args.json, answer, words, out)
        }
        Err(e @ FilmError::Interrupted) => {
            drop(bar);
            say!("{e}");
            std::process::exit(130)
        }
        Err(e) => Err(e.into()),
    }
}

fn finish(bar: Option<(FilmStep, Progress)>) {
    if let Some((_, bar)) = bar {
        bar.finish_and_clear();
    }
}
