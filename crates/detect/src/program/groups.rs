//! The groups of processes that run for this program, so that none is left behind when it is interrupted.

use std::collections::BTreeSet;
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard};

/// Ids of the groups that run.
static RUNNING: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

fn running() -> MutexGuard<'static, BTreeSet<u32>> {
    RUNNING.lock().unwrap_or_else(|e| e.into_inner())
}

/// A program and whatever it starts.
#[derive(Debug)]
pub(super) struct Group(u32);

impl Group {
    /// Lets a command that is about to start have a group of its own.
    #[cfg(all(unix, feature = "full"))]
    pub(super) fn prepare(command: &mut Command) {
        std::os::unix::process::CommandExt::process_group(command, 0);
    }

    /// A terminal's Ctrl-C ends it in this one's.
    #[cfg(not(all(unix, feature = "full")))]
    pub(super) fn prepare(_: &mut Command) {}

    pub(super) fn of(process: &Child) -> Group {
        running().insert(process.id());
        Group(process.id())
    }

    /// Ends all of it.
    pub(super) fn kill(&self) {
        // An id that is not listed any more may be another's.
        if running().remove(&self.0) {
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
    std::mem::take(&mut *running()).into_iter().for_each(kill);
}

#[cfg(all(unix, feature = "full"))]
fn kill(group: u32) {
    use rustix::process::{Pid, Signal, kill_process_group};
    if let Some(group) = i32::try_from(group).ok().and_then(Pid::from_raw) {
        let _ = kill_process_group(group, Signal::KILL);
    }
}

#[cfg(not(all(unix, feature = "full")))]
fn kill(_: u32) {}
