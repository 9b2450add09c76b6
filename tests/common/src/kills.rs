//! Programs that are ended at a place, and not after a time: at their Nth renaming, by which a file of theirs takes its name.

use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::Instant;

use crate::HANG;

/// A library that sends the program a signal (`SIGNAL`, a number) before its Nth renaming (`SIGNAL_AT`), when it is loaded before the system's.
fn library(folder: &Path) -> PathBuf {
    let (source, library) = (folder.join("signal.c"), folder.join("signal.so"));
    let text = r#"
        #define _GNU_SOURCE
        #include <dlfcn.h>
        #include <signal.h>
        #include <stdlib.h>
        #include <string.h>
        #include <unistd.h>
        static int count;
        int rename(const char *from, const char *to) {
            if (strstr(to, "journal") == 0 && __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) == atoi(getenv("SIGNAL_AT")))
                kill(getpid(), atoi(getenv("SIGNAL")));
            return ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
        }
    "#;
    std::fs::write(&source, text).unwrap();
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(&source)
        .arg("-ldl")
        .status();
    assert!(built.unwrap().success());
    library
}

fn with_signal<'a>(command: &'a mut Command, folder: &Path, signal: &str, at: usize) -> &'a mut Command {
    command
        .env("LD_PRELOAD", library(folder))
        .env("SIGNAL", signal)
        .env("SIGNAL_AT", at.to_string())
}

/// Has a command killed before its Nth renaming; the library for it lies in a folder.
pub fn kill_at<'a>(command: &'a mut Command, folder: &Path, renaming: usize) -> &'a mut Command {
    with_signal(command, folder, "9", renaming)
}

/// Starts a command and waits until it has stopped before its Nth renaming; it goes on at `SIGCONT`.
///
/// # Panics
/// Where it ends before.
pub fn stop_at(command: &mut Command, folder: &Path, renaming: usize) -> Child {
    let mut child = with_signal(command, folder, "19", renaming).spawn().unwrap();
    let (begin, stat) = (Instant::now(), format!("/proc/{}/stat", child.id()));
    // Its state stands behind its name.
    while !std::fs::read_to_string(&stat).unwrap_or_default().contains(") T ") {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended before its renaming {renaming}"
        );
        assert!(begin.elapsed() < HANG, "it never came to its renaming {renaming}");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child
}

/// Whether a process has a handler for a signal of this number by now.
pub fn is_caught(signal: u32, child: &Child) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    caught.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Sends signals to a process, one after another.
pub fn send(signals: &[&str], child: &Child) {
    for signal in signals {
        let sent = Command::new("kill").args([*signal, &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
    }
}
