//! Progress on standard error: a bar in a terminal; elsewhere, as in a log, a plain line every few seconds. Nothing with `--quiet`.

use std::fmt::Write;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::{is_quiet, say};

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(5);

/// Progress of some work. If dropped before [`Progress::finish_and_clear`], it just disappears.
pub struct Progress {
    bar: ProgressBar,
    work: Work,
    say: Say,
    printer: Mutex<Option<Printer>>,
}

type Say = Arc<dyn Fn(&str) + Send + Sync>;

/// Thread that prints a line from time to time, so that work with long steps is reported, too.
struct Printer {
    /// Sender whose drop stops the thread.
    stop: Sender<()>,
    /// Thread that returns true if it printed a line.
    thread: JoinHandle<bool>,
}

impl Progress {
    /// Starts the progress; without `every`, no lines are printed.
    fn start(work: Work, bar: ProgressBar, every: Option<Duration>, say: Say) -> Self {
        let printer = every.map(|every| {
            let (stop, stopped) = mpsc::channel();
            let (work, bar, say) = (work.clone(), bar.clone(), say.clone());
            let thread = std::thread::spawn(move || {
                let mut has_said = false;
                while stopped.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                    say(&work.line(&bar));
                    has_said = true;
                }
                has_said
            });
            Printer { stop, thread }
        });
        let printer = Mutex::new(printer);
        Self {
            bar,
            work,
            say,
            printer,
        }
    }

    /// Runs the work that this shows, and finishes when it is done; after an error the progress just disappears.
    pub fn during<T, E>(self, work: impl FnOnce(&Self) -> Result<T, E>) -> Result<T, E> {
        let done = work(&self)?;
        self.finish_and_clear();
        Ok(done)
    }

    pub fn inc(&self, steps: u64) {
        self.bar.inc(steps);
    }

    pub fn set_position(&self, position: u64) {
        self.bar.set_position(position);
    }

    pub fn set_length(&self, length: u64) {
        self.bar.set_length(length);
    }

    /// Sets the message beside the bar.
    pub fn set_message(&self, message: String) {
        self.bar.set_message(message);
    }

    /// Marks the work as done; if lines were printed, prints a last one.
    pub fn finish_and_clear(&self) {
        if self.stop() {
            (self.say)(&self.work.last_line(&self.bar));
        }
        self.bar.finish_and_clear();
    }

    /// Stops the thread; returns true if it printed a line (only at the first call).
    fn stop(&self) -> bool {
        let printer = self.printer.lock().ok().and_then(|mut printer| printer.take());
        printer.is_some_and(|Printer { stop, thread }| {
            drop(stop);
            thread.join().unwrap_or(false)
        })
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.stop();
    }
}

pub fn photos(what: &str, count: usize) -> Progress {
    counting(what, count, "photos")
}

/// Creates a bar that counts frames, one whole image after the other.
pub fn frames(what: &str, count: usize) -> Progress {
    counting(what, count, "frames")
}

/// Creates a bar that counts the steps of a search.
pub fn steps(what: &str, count: usize) -> Progress {
    counting(what, count, "steps")
}

fn counting(what: &str, count: usize, unit: &'static str) -> Progress {
    let template = format!("{{msg:<18}} {{bar:30}} {{pos}}/{{len}} {unit}{{left}}");
    shown(ProgressBar::new(count as u64), what, Unit::Counted(unit), &template)
}

/// Creates a bar that counts the seconds or the steps of a training; its message shows the training's progress.
pub fn training(is_time: bool, length: u64) -> Progress {
    let unit = if is_time { "s" } else { "steps" };
    let template = format!("training {{bar:30}} {{pos}}/{{len}} {unit}, {{msg}}");
    shown(ProgressBar::new(length), "training", Unit::Counted(unit), &template)
}

/// Creates a bar that counts the bytes of a download, whose length may become known later.
pub fn bytes(what: &str) -> Progress {
    let template = "{msg:<18} {bar:30} {bytes} of {total_bytes}{left}";
    shown(ProgressBar::no_length(), what, Unit::Bytes, template)
}

/// Creates a spinner for work without countable steps.
pub fn busy(what: &str) -> Progress {
    let spinner = ProgressBar::new_spinner();
    let progress = shown(spinner, what, Unit::None, "{spinner} {msg}, {elapsed}");
    if !progress.bar.is_hidden() {
        progress.bar.enable_steady_tick(Duration::from_millis(200));
    }
    progress
}

/// Prints a sentence about current work without countable steps.
pub fn announce(sentence: &str) {
    if !is_quiet() {
        say!("{sentence}");
    }
}

fn shown(bar: ProgressBar, what: &str, unit: Unit, template: &str) -> Progress {
    // An invalid template only affects the appearance.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("left", |state: &ProgressState, out: &mut dyn Write| {
        let _ = out.write_str(&left(state.pos(), state.len(), state.elapsed()));
    });
    let bar = bar.with_style(style).with_message(what.to_owned());
    if is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    // A bar is hidden if there is no terminal, or one that cannot move its cursor (TERM=dumb).
    let every = (!is_quiet() && bar.is_hidden()).then_some(EVERY);
    let what = what.to_owned();
    Progress::start(Work { what, unit }, bar, every, Arc::new(|line: &str| say!("{line}")))
}

#[derive(Debug, Clone, Copy)]
enum Unit {
    Counted(&'static str),
    Bytes,
    None,
}

#[derive(Debug, Clone)]
struct Work {
    what: String,
    unit: Unit,
}

impl Work {
    /// Returns a line as in `scoring 120/300 photos, 40 s left`.
    fn line(&self, bar: &ProgressBar) -> String {
        match self.unit {
            Unit::None => format!("{}, {} so far", self.what, duration(bar.elapsed())),
            _ => self.far(bar) + &left(bar.position(), bar.length(), bar.elapsed()),
        }
    }

    fn last_line(&self, bar: &ProgressBar) -> String {
        format!("{}, done in {}", self.far(bar), duration(bar.elapsed()))
    }

    fn far(&self, bar: &ProgressBar) -> String {
        let (at, length) = (bar.position(), bar.length().filter(|length| *length > 0));
        let far = match (self.unit, length) {
            (Unit::Counted(unit), Some(length)) => format!("{} {at}/{length} {unit}", self.what),
            (Unit::Bytes, Some(length)) => format!("{} {} of {}", self.what, megabytes(at), megabytes(length)),
            (Unit::Bytes, None) => format!("{} {}", self.what, megabytes(at)),
            _ => self.what.clone(),
        };
        let message = bar.message();
        if message == self.what {
            far
        } else {
            format!("{far}, {message}")
        }
    }
}

/// Returns the remaining time as in `, 40 s left`, by the mean speed so far; empty during the first twentieth, which is a poor basis, and when all is
/// done.
///
/// indicatif's estimate, by the speed of the last seconds, predicts days if one step takes longer than those before.
fn left(done: u64, all: Option<u64>, elapsed: Duration) -> String {
    match all {
        Some(all) if done > 0 && done < all && 20 * done >= all => {
            let left = elapsed.mul_f64((all - done) as f64 / done as f64);
            format!(", {} left", duration(left))
        }
        _ => String::new(),
    }
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

/// Formats a duration as `40 s`, `12 min` or `3 h 5 min`.
fn duration(time: Duration) -> String {
    match (time.as_secs_f64().round() as u64, time.as_secs() / 60) {
        (seconds, _) if seconds < 120 => format!("{seconds} s"),
        (_, minutes) if minutes < 120 => format!("{minutes} min"),
        (_, minutes) => format!("{} h {} min", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
#[path = "tests/progress.rs"]
mod tests;
