//! Progress on standard error: a bar in a terminal; elsewhere, as in a log, a plain line every few seconds. Nothing with `--quiet`.

use std::fmt::Write;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::{is_quiet, say};

/// Between two lines.
const EVERY: Duration = Duration::from_secs(5);

/// How far some work has come. Dropped before [`Progress::finish_and_clear`], it just goes.
pub struct Progress {
    bar: ProgressBar,
    work: Work,
    say: Say,
    printer: Mutex<Option<Printer>>,
}

type Say = Arc<dyn Fn(&str) + Send + Sync>;

/// The thread that says a line from time to time, so that also work whose steps are long is heard of.
struct Printer {
    /// Dropped, it stops the thread.
    stop: Sender<()>,
    /// Whether a line was said.
    thread: JoinHandle<bool>,
}

impl Progress {
    /// Without `every`, no line is said.
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

    /// Does the work that this shows, and finishes when it is done; after an error it just goes.
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

    /// How well it goes.
    pub fn set_message(&self, message: String) {
        self.bar.set_message(message);
    }

    /// The work is done; what took long enough for a line gets a last one.
    pub fn finish_and_clear(&self) {
        if self.stop() {
            (self.say)(&self.work.last_line(&self.bar));
        }
        self.bar.finish_and_clear();
    }

    /// Whether a line was said before, the first time it is asked.
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

/// A bar that counts frames, one whole image after the other.
pub fn frames(what: &str, count: usize) -> Progress {
    counting(what, count, "frames")
}

/// A bar that counts the steps of a search.
pub fn steps(what: &str, count: usize) -> Progress {
    counting(what, count, "steps")
}

fn counting(what: &str, count: usize, unit: &'static str) -> Progress {
    let template = format!("{{msg:<18}} {{bar:30}} {{pos}}/{{len}} {unit}{{left}}");
    shown(ProgressBar::new(count as u64), what, Unit::Counted(unit), &template)
}

/// A bar that counts the seconds or the steps of a training; its message is how well it goes.
pub fn training(is_time: bool, length: u64) -> Progress {
    let unit = if is_time { "s" } else { "steps" };
    let template = format!("training {{bar:30}} {{pos}}/{{len}} {unit}, {{msg}}");
    shown(ProgressBar::new(length), "training", Unit::Counted(unit), &template)
}

/// A bar that counts the bytes of a download, whose length may become known later.
pub fn bytes(what: &str) -> Progress {
    let template = "{msg:<18} {bar:30} {bytes} of {total_bytes}{left}";
    shown(ProgressBar::no_length(), what, Unit::Bytes, template)
}

/// Work whose steps nobody counts.
pub fn busy(what: &str) -> Progress {
    let spinner = ProgressBar::new_spinner();
    let progress = shown(spinner, what, Unit::None, "{spinner} {msg}, {elapsed}");
    if !progress.bar.is_hidden() {
        progress.bar.enable_steady_tick(Duration::from_millis(200));
    }
    progress
}

/// Says what is being done, where no step can be counted.
pub fn announce(sentence: &str) {
    if !is_quiet() {
        say!("{sentence}");
    }
}

fn shown(bar: ProgressBar, what: &str, unit: Unit, template: &str) -> Progress {
    // A template that does not parse would only cost the looks.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("left", |state: &ProgressState, out: &mut dyn Write| {
        let _ = out.write_str(&left(state.pos(), state.len(), state.elapsed()));
    });
    let bar = bar.with_style(style).with_message(what.to_owned());
    if is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    // A bar is hidden where there is no terminal, or one that cannot move its cursor (TERM=dumb).
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
    /// As in `scoring 120/300 photos, 40 s left`.
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

/// As in `, 40 s left`, by the mean speed until now; nothing during the first twentieth, which says little of the rest, and when all is done.
///
/// A speed of the last seconds, as indicatif takes it, promises days where one step takes longer than those before.
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

/// `40 s`, `12 min` or `3 h 5 min`.
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
