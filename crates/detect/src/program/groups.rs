//! The groups of processes that run for this program, so that none is left behind when it is interrupted.

use std::collections::BTreeMap;
use std::process::{Child, Command};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// True where programs get groups of their own, which a terminal's Ctrl-C does not reach.
static ARE_APART: AtomicBool = AtomicBool::new(cfg!(unix));

/// Ids of the groups that run, each with its mark.
static RUNNING: Mutex<BTreeMap<u32, String>> = Mutex::new(BTreeMap::new());

/// The variable that a program and whatever it starts have in their environment, by which those are found that left its group (`setsid`).
const MARK: &str = "SCALEPROOF_PROGRAM";

/// Locks what no thread leaves half written, even if it panics.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps programs from now on in the process group of this one, whose interruption reaches them: for callers that cannot call
/// [`kill_programs`] when they are interrupted.
pub fn keep_programs_in_our_group() {
    ARE_APART.store(false, Ordering::Relaxed);
}

#[derive(Debug)]
pub(super) struct Group(u32);

impl Group {
    /// Starts a command, in a group of its own.
    pub(super) fn start(command: &mut Command) -> std::io::Result<(Child, Group)> {
        let is_apart = ARE_APART.load(Ordering::Relaxed);
        #[cfg(unix)]
        if is_apart {
            std::os::unix::process::CommandExt::process_group(command, 0);
        }
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let mark = format!("{}-{}", std::process::id(), STARTED.fetch_add(1, Ordering::Relaxed));
        let process = command.env(MARK, &mark).spawn()?;
        if is_apart {
            lock(&RUNNING).insert(process.id(), mark);
        }
        let group = Group(process.id());
        Ok((process, group))
    }

    pub(super) fn kill(&self) {
        // An id that is not listed any more may be another's.
        let mark = lock(&RUNNING).remove(&self.0);
        if let Some(mark) = mark {
            kill(self.0, &mark);
        }
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Ends every program that runs for this one.
pub fn kill_programs() {
    for (group, mark) in std::mem::take(&mut *lock(&RUNNING)) {
        kill(group, &mark);
    }
}

fn kill(group: u32, mark: &str) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(group).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        kill_marked(mark);
    }
    #[cfg(not(unix))]
    let _ = (group, mark);
}

/// Ends what left the group but kept the mark, where the system shows the environment of processes (`/proc`, as Linux does). A process that cleared its
/// environment is not found.
#[cfg(unix)]
fn kill_marked(mark: &str) {
    let mark = format!("{MARK}={mark}");
    let is_marked = |environment: Vec<u8>| environment.split(|byte| *byte == 0).any(|it| it == mark.as_bytes());
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    for process in processes {
        let id = process.file_name().to_str().and_then(|name| name.parse().ok());
        let Some(id) = id.and_then(rustix::process::Pid::from_raw) else {
            continue;
        };
        if std::fs::read(process.path().join("environ")).is_ok_and(is_marked) {
            let _ = rustix::process::kill_process(id, rustix::process::Signal::KILL);
        }
    }
}
