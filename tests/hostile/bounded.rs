//! Runs the program until it ends or hangs, and measures its memory.

use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::HANG;

/// What became of a run.
pub struct Ended {
    pub output: Output,
    /// The highest resident memory that was seen, in bytes.
    pub memory: u64,
}

/// Runs a command; fails the test when it hangs, or ends by a signal.
pub fn run(command: &mut Command) -> Ended {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (begin, mut memory) = (Instant::now(), 0);
    let readers = (reader(child.stdout.take()), reader(child.stderr.take()));
    let status = loop {
        memory = memory.max(highest_memory(child.id()));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begin.elapsed() > HANG {
            let _ = child.kill();
            let _ = child.wait();
            panic!("{command:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let output = Output {
        status,
        stdout: readers.0.join().unwrap(),
        stderr: readers.1.join().unwrap(),
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(status.code().is_some(), "{command:?} ended by {status}: {said}");
    assert!(!said.contains("panicked"), "{command:?}: {said}");
    Ended { output, memory }
}

fn reader(stream: Option<impl std::io::Read + Send + 'static>) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        stream.unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    })
}

/// `VmHWM` of a running process, in bytes; 0 where the system does not say.
pub fn highest_memory(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    1024 * kilobytes.unwrap_or(0)
}
