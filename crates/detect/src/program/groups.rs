//! The groups of processes that run for this program, so that none is left behind when it is interrupted.

use std::collections::BTreeSet;
use std::process::{Child, Command};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Whether programs get groups of their own, which a terminal's Ctrl-C does not reach.
static ARE_APART: AtomicBool = AtomicBool::new(cfg!(unix));

/// Ids of the groups that run.
static RUNNING: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

/// Locks what no thread leaves half written, even if it panics.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on programs stay in the process group of this one, whose interruption reaches them: for callers that cannot call
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
        let process = command.spawn()?;
        if is_apart {
            lock(&RUNNING).insert(process.id());
        }
        let group = Group(process.id());
        Ok((process, group))
    }

    pub(super) fn kill(&self) {
        // An id that is not listed any more may be another's.
        if lock(&RUNNING).remove(&self.0) {
            kill(self.0);
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
    std::mem::take(&mut *lock(&RUNNING)).into_iter().for_each(kill);
}

fn kill(group: u32) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(group).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    #[cfg(not(unix))]
    let _ = group;
}
