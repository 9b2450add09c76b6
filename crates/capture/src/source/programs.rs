//! Programs that run for a source and write images: ended by SIGTERM, then killed.

use std::collections::BTreeSet;
use std::io::Read;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use scaleproof_core::files;

/// Time in which a program may end by itself, closing its connection.
const GRACE: Duration = Duration::from_secs(3);
/// Time after its end in which its standard error is read to the end; what it started itself may hold it open.
const HEARD_WITHIN: Duration = Duration::from_secs(1);
const LOOK_AGAIN: Duration = Duration::from_millis(10);

/// Maximum length of standard error that is kept, bytes; what follows is read and dropped.
const MOST_SAID: u64 = 16 << 10;

/// Ids of the programs that run.
static RUNNING: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

/// Ends every program that runs for a source, by asking at first, and every decoder: to be called before this program ends, as their owners are
/// threads that are left behind.
pub fn interrupt_programs() {
    scaleproof_video::end_decoders();
    let running: Vec<u32> = locked(&RUNNING).iter().copied().collect();
    running.iter().for_each(|id| send(*id, Ending::Asked));
    let began = Instant::now();
    // One that was waited for is not ours any more.
    let is_there = |id: &&u32| locked(&RUNNING).contains(id) && !has_ended(**id);
    while began.elapsed() < GRACE && running.iter().any(|id| is_there(&id)) {
        std::thread::sleep(LOOK_AGAIN);
    }
    running.iter().filter(is_there).for_each(|id| send(*id, Ending::Killed));
}

/// A running program, which ends when this is dropped.
pub(super) struct RunningProgram {
    child: Child,
    said: Arc<Mutex<Vec<u8>>>,
    listening: std::thread::JoinHandle<()>,
}

impl RunningProgram {
    /// Starts a command with nothing on its standard input. It speaks English, by which its complaints are understood.
    pub(super) fn start(command: &mut Command) -> std::io::Result<(RunningProgram, ChildStdout)> {
        command.env("LC_ALL", "C").stdin(Stdio::null());
        // Ctrl-C is for this program, which ends the others: otherwise they would seem to have failed.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        locked(&RUNNING).insert(child.id());
        let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&said);
        let program = RunningProgram {
            child,
            said,
            listening: std::thread::spawn(move || stderr.into_iter().for_each(|stderr| listen(stderr, &heard))),
        };
        let stdout = stdout.ok_or(std::io::ErrorKind::BrokenPipe)?;
        Ok((program, stdout))
    }

    /// Returns the exit status, if it has ended.
    fn ended(&mut self) -> Option<ExitStatus> {
        let status = self.child.try_wait().ok().flatten();
        if status.is_some() {
            locked(&RUNNING).remove(&self.child.id());
        }
        status
    }

    /// Waits for the end; returns the exit status.
    pub(super) fn ended_within(&mut self, limit: Duration) -> Option<ExitStatus> {
        let began = Instant::now();
        loop {
            match self.ended() {
                None if began.elapsed() < limit => std::thread::sleep(LOOK_AGAIN),
                ended => return ended,
            }
        }
    }

    /// Bounds its memory, where the system can: what comes over a network may announce anything.
    pub(super) fn bound_memory(&self, bytes: u64) {
        #[cfg(target_os = "linux")]
        if let Some(pid) = pid(self.child.id()) {
            use rustix::process::{Resource, Rlimit, prlimit};
            let limit = Rlimit {
                current: Some(bytes),
                maximum: Some(bytes),
            };
            let _ = prlimit(Some(pid), Resource::As, limit);
        }
        #[cfg(not(target_os = "linux"))]
        let _ = bytes;
    }

    /// Returns its standard error so far; once it has ended, all of it.
    pub(super) fn said(&mut self) -> String {
        let began = Instant::now();
        while self.ended().is_some() && !self.listening.is_finished() && began.elapsed() < HEARD_WITHIN {
            std::thread::sleep(LOOK_AGAIN);
        }
        String::from_utf8_lossy(&locked(&self.said)).into_owned()
    }
}

impl Drop for RunningProgram {
    fn drop(&mut self) {
        let id = self.child.id();
        // The id of one that was waited for may be another's.
        if !locked(&RUNNING).remove(&id) {
            return;
        }
        send(id, Ending::Asked);
        let began = Instant::now();
        while began.elapsed() < GRACE && matches!(self.child.try_wait(), Ok(None)) {
            std::thread::sleep(LOOK_AGAIN);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[derive(Clone, Copy)]
enum Ending {
    Asked,
    Killed,
}

#[cfg(unix)]
fn pid(id: u32) -> Option<rustix::process::Pid> {
    i32::try_from(id).ok().and_then(rustix::process::Pid::from_raw)
}

#[cfg(unix)]
fn send(id: u32, ending: Ending) {
    use rustix::process::{Signal, kill_process};
    let signal = match ending {
        Ending::Asked => Signal::TERM,
        Ending::Killed => Signal::KILL,
    };
    let _ = pid(id).map(|pid| kill_process(pid, signal));
}

#[cfg(not(unix))]
fn send(_: u32, _: Ending) {}

/// Returns true if a child has ended; its status stays for its owner.
#[cfg(unix)]
fn has_ended(id: u32) -> bool {
    use rustix::process::{WaitId, WaitIdOptions, waitid};
    let look = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    pid(id).is_none_or(|pid| !matches!(waitid(WaitId::Pid(pid), look), Ok(None)))
}

#[cfg(not(unix))]
fn has_ended(_: u32) -> bool {
    true
}

fn listen(mut stderr: impl Read, said: &Mutex<Vec<u8>>) {
    let mut some = [0; 1024];
    while let Ok(count @ 1..) = stderr.read(&mut some) {
        let mut said = locked(said);
        let room = (MOST_SAID as usize).saturating_sub(said.len());
        said.extend_from_slice(&some[..count.min(room)]);
    }
}

/// Returns true if the system has a program of this name.
pub(super) fn is_there(name: &str) -> bool {
    files::environment::program(name).is_some()
}

/// Locks what no thread leaves half written, even if it panics.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
