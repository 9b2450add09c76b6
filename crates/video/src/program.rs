//! The programs `ffmpeg` and `ffprobe`: their places, their features, and running ones.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use scaleproof_core::files::environment;
use scaleproof_core::message::message;

use crate::VideoError;

const LOOK_AGAIN: Duration = Duration::from_millis(10);
/// Time in which a program must report its version; some builds take a second to load.
const SAYS_WITHIN: Duration = Duration::from_secs(20);
/// A pipe whose program has ended is at its end in less than this.
pub(crate) const LEFT_BEHIND: Duration = Duration::from_secs(10);
/// More than the longest list of filters.
const MOST_SAID: u64 = 1 << 20;

/// Ids of the programs that run and were not waited for.
static RUNNING: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

fn running() -> MutexGuard<'static, BTreeSet<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends every decoder at once: to be called before this program ends while threads that are left behind wait for some. One that reads from a server
/// which sends without end would read on.
pub fn end_decoders() {
    running().iter().for_each(|id| kill(*id));
}

fn kill(id: u32) {
    #[cfg(unix)]
    if let Some(pid) = i32::try_from(id).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process(pid, rustix::process::Signal::KILL);
    }
    #[cfg(not(unix))]
    let _ = id;
}

/// Creates a command that reads nothing from the terminal; `name` is the video's.
pub(crate) fn command(program: &'static str, name: &str) -> Result<Command, VideoError> {
    let missing = || {
        message!(
            "{name} is read with the programs ffmpeg and ffprobe, and this system has no {program}: install them (Debian: apt install ffmpeg)"
        )
    };
    let mut command = Command::new(environment::program(program).ok_or_else(missing)?);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    // Ctrl-C is for this program, which ends the decoder when it is done with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    Ok(command)
}

/// A process that is killed when dropped.
#[derive(Debug)]
pub(crate) struct Running(pub Child);

impl Running {
    /// Starts a command.
    pub fn start(mut command: Command, program: &'static str, name: &str) -> Result<Running, VideoError> {
        let failed = |e: std::io::Error| VideoError::not_started(name, program, &scaleproof_core::files::plain(&e));
        let started = command.spawn().map_err(failed)?;
        running().insert(started.id());
        Ok(Running(started))
    }

    /// Bounds its memory, where the system can.
    pub fn bounded(self, most_bytes: Option<u64>) -> Running {
        #[cfg(target_os = "linux")]
        if let (Some(bytes), Some(pid)) = (most_bytes, i32::try_from(self.0.id()).ok()) {
            use rustix::process::{Pid, Resource, Rlimit, prlimit};
            let limit = Rlimit {
                current: Some(bytes),
                maximum: Some(bytes),
            };
            let _ = Pid::from_raw(pid).map(|pid| prlimit(Some(pid), Resource::As, limit));
        }
        #[cfg(not(target_os = "linux"))]
        let _ = most_bytes;
        self
    }

    /// Returns true if it ended well; `None` when it did not end in time.
    pub fn ended_well(&mut self, within: Duration) -> Option<bool> {
        let began = Instant::now();
        loop {
            match self.0.try_wait() {
                Ok(Some(status)) => {
                    // Its id may be another's from now on.
                    running().remove(&self.0.id());
                    return Some(status.success());
                }
                Ok(None) if began.elapsed() < within => std::thread::sleep(LOOK_AGAIN),
                _ => return None,
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        running().remove(&self.0.id());
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Content of a pipe until its end.
pub(crate) struct PipeContent(Receiver<Vec<u8>>);

impl PipeContent {
    /// Returns the whole content when the writing program has ended; `None` if a process that it left behind holds the pipe open.
    pub fn whole(self) -> Option<Vec<u8>> {
        self.0.recv_timeout(LEFT_BEHIND).ok()
    }
}

/// Reads a pipe up to a limit in a thread of its own: a full pipe would stop the program that writes.
pub(crate) fn drain(from: Option<impl Read + Send + 'static>, most: u64) -> PipeContent {
    let (give, drained) = sync_channel(1);
    std::thread::spawn(move || {
        let mut read = Vec::new();
        if let Some(mut from) = from {
            let _ = (&mut from).take(most).read_to_end(&mut read);
            let _ = std::io::copy(&mut from, &mut std::io::sink());
        }
        // Nobody may wait for it.
        let _ = give.send(read);
    });
    PipeContent(drained)
}

/// Returns ffmpeg's output for an argument; empty if it does not start.
fn said(argument: &str) -> String {
    let answer = || {
        let mut command = command("ffmpeg", "").ok()?;
        command.args([OsStr::new("-hide_banner"), OsStr::new(argument)]);
        let mut running = Running::start(command, "ffmpeg", "").ok()?;
        let words = drain(running.0.stdout.take(), MOST_SAID);
        running.ended_well(SAYS_WITHIN)?;
        drop(running);
        words.whole()
    };
    String::from_utf8_lossy(&answer().unwrap_or_default()).into_owned()
}

/// Returns ffmpeg's version, such as `7.1.5-0+deb13u1`; empty if it does not start.
pub(crate) fn version() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| {
        let said = said("-version");
        let version = said.strip_prefix("ffmpeg version ").unwrap_or_default();
        version.split(' ').next().unwrap_or_default().to_owned()
    })
}

/// Returns the option that keeps every frame with its own time: `-fps_mode` since ffmpeg 5.1, `-vsync` before.
pub(crate) fn every_frame_option() -> &'static str {
    // Builds from the repository are called otherwise, and are newer.
    let mut parts = version()
        .split(['.', '-'])
        .map(|part| part.trim_start_matches('n').parse::<u32>().ok());
    match (parts.next().flatten(), parts.next().flatten()) {
        (Some(major), minor) if (major, minor.unwrap_or(0)) < (5, 1) => "-vsync",
        _ => "-fps_mode",
    }
}

/// Returns true if ffmpeg has the filter zscale, which converts HDR.
pub(crate) fn has_zscale() -> bool {
    static HAS: OnceLock<bool> = OnceLock::new();
    *HAS.get_or_init(|| said("-filters").contains(" zscale "))
}
