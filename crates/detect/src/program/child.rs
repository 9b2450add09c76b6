//! A running program: lines in, lines out, never longer than a limit and never waited for without end. It ends with its owner, whatever happens.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child as Process, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::groups::{Group, lock};

/// No line of an answer is longer: ten thousand boxes have a megabyte.
const LONGEST_LINE: u64 = 8 << 20;
/// Longest part of a line on standard error that is kept, in bytes.
const LONGEST_WORDS: u64 = 2000;
/// Time for a program to end by itself when it is not needed any more.
const GRACE: Duration = Duration::from_secs(2);
/// Interval of the checks whether a silent program still runs: one that it started may hold its output open after its end.
const LOOK: Duration = Duration::from_millis(100);

/// Why a program gave no line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Silence {
    TooLong,
    Ended,
    HugeLine,
    NoText,
    /// It has not read what it was asked before, and yet answered.
    Unread,
}

#[derive(Debug)]
pub(super) struct Child {
    process: Process,
    /// Dropped first: the end of its input tells a program to end.
    to: Option<SyncSender<Vec<u8>>>,
    /// Asks for so many bytes, or for a line, which `from` gives.
    wanted: SyncSender<Option<usize>>,
    from: Receiver<Result<Vec<u8>, Silence>>,
    words: Words,
    group: Group,
}

impl Child {
    pub(super) fn start(command: &[String], folder: Option<&Path>) -> std::io::Result<Child> {
        let (program, arguments) = command.split_first().ok_or(std::io::ErrorKind::InvalidInput)?;
        let mut starting = Command::new(program);
        starting
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        if let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) {
            starting.current_dir(folder);
        }
        let (mut process, group) = Group::start(&mut starting)?;
        let (to, (wanted, from), words) = match (process.stdin.take(), process.stdout.take(), process.stderr.take()) {
            (Some(stdin), Some(stdout), Some(stderr)) => (writer(stdin), reader(stdout), listener(stderr)),
            _ => return Err(std::io::ErrorKind::BrokenPipe.into()),
        };
        Ok(Child {
            process,
            to: Some(to),
            wanted,
            from,
            words,
            group,
        })
    }

    /// Hands a message over and never waits; a program that has ended shows when its answer is awaited.
    ///
    /// There is room for one message behind the one being written, so that a program which reads each before it answers never meets a full channel.
    pub(super) fn send(&mut self, message: Vec<u8>) -> Result<(), Silence> {
        match self.to.as_ref().map(|to| to.try_send(message)) {
            Some(Err(TrySendError::Full(_))) => Err(Silence::Unread),
            _ => Ok(()),
        }
    }

    pub(super) fn line(&mut self, limit: Duration) -> Result<String, Silence> {
        String::from_utf8(self.read(None, limit)?).map_err(|_| Silence::NoText)
    }

    /// Waits for so many bytes behind a line, or for the next line.
    pub(super) fn read(&mut self, count: Option<usize>, limit: Duration) -> Result<Vec<u8>, Silence> {
        let _ = self.wanted.send(count);
        let (start, mut has_ended) = (Instant::now(), false);
        loop {
            let left = limit.saturating_sub(start.elapsed());
            match self.from.recv_timeout(left.min(LOOK)) {
                Ok(heard) => return heard,
                Err(RecvTimeoutError::Disconnected) => return Err(Silence::Ended),
                // What it wrote before its end has had a whole turn to arrive.
                Err(RecvTimeoutError::Timeout) if has_ended => return Err(Silence::Ended),
                Err(RecvTimeoutError::Timeout) if left <= LOOK => return Err(Silence::TooLong),
                Err(RecvTimeoutError::Timeout) => has_ended = matches!(self.process.try_wait(), Ok(Some(_))),
            }
        }
    }

    /// Ends the program at once, and returns how it ended and the last line of its standard error.
    pub(super) fn post_mortem(mut self) -> (Option<ExitStatus>, Option<String>) {
        // It may be about to end by itself, with a status that says more than our signal.
        let status = self.wait(GRACE / 4);
        self.group.kill();
        let status = status.or_else(|| self.process.kill().and_then(|()| self.process.wait()).ok());
        (status, self.words.last(GRACE / 4))
    }

    fn wait(&mut self, at_most: Duration) -> Option<ExitStatus> {
        let start = Instant::now();
        loop {
            match self.process.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if start.elapsed() < at_most => std::thread::sleep(Duration::from_millis(5)),
                _ => return None,
            }
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.to = None;
        let _ = self.wait(GRACE);
        self.group.kill();
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A program that does not read blocks this thread and no other; it ends when the program does.
fn writer(mut stdin: ChildStdin) -> SyncSender<Vec<u8>> {
    let (to, messages) = sync_channel::<Vec<u8>>(1);
    std::thread::spawn(move || {
        for message in messages {
            if stdin.write_all(&message).and_then(|()| stdin.flush()).is_err() {
                break;
            }
        }
    });
    to
}

/// The channel that asks for bytes or a line, and the one that they arrive in.
type Reading = (SyncSender<Option<usize>>, Receiver<Result<Vec<u8>, Silence>>);

/// Reads only the answer: whatever else the program writes waits in its pipe.
fn reader(stdout: impl Read + Send + 'static) -> Reading {
    let ((want, wanted), (tell, heard)) = (sync_channel::<Option<usize>>(1), sync_channel(1));
    std::thread::spawn(move || {
        let mut stdout = BufReader::new(stdout);
        for wanted in wanted {
            let mut read = vec![0; wanted.unwrap_or(0)];
            let count = match wanted {
                Some(count) => stdout.read_exact(&mut read).map(|()| count),
                None => (&mut stdout).take(LONGEST_LINE + 1).read_until(b'\n', &mut read),
            };
            let heard = match (wanted, count) {
                (_, Err(_)) => return,
                (None, Ok(count)) if count as u64 > LONGEST_LINE => Err(Silence::HugeLine),
                // It ended in the middle of a line, or before one.
                (None, Ok(_)) if read.last() != Some(&b'\n') => return,
                _ => Ok(read),
            };
            if tell.send(heard).is_err() {
                return;
            }
        }
    });
    (want, heard)
}

/// The standard error of a program.
#[derive(Debug)]
struct Words {
    /// The last line that is not empty.
    last: Arc<Mutex<String>>,
    end: Receiver<()>,
}

impl Words {
    /// The last line once all is read; what has come so far where something else holds standard error open for longer.
    fn last(&self, at_most: Duration) -> Option<String> {
        let _ = self.end.recv_timeout(at_most);
        Some(lock(&self.last).clone()).filter(|words| !words.is_empty())
    }
}

/// Reads standard error to its end.
fn listener(stderr: impl Read + Send + 'static) -> Words {
    let ((at_end, end), last) = (sync_channel(1), Arc::default());
    let words = Words {
        last: Arc::clone(&last),
        end,
    };
    std::thread::spawn(move || {
        let mut stderr = BufReader::new(stderr);
        let mut line = Vec::new();
        // The rest of a longer line is one of its own.
        while (&mut stderr)
            .take(LONGEST_WORDS)
            .read_until(b'\n', &mut line)
            .is_ok_and(|count| count > 0)
        {
            let line = String::from_utf8_lossy(&std::mem::take(&mut line)).trim().to_owned();
            if !line.is_empty() {
                *lock(&last) = line;
            }
        }
        let _ = at_end.send(());
    });
    words
}
