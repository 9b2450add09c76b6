//! A running program: lines in, lines out, never longer than a limit and never waited for without end. It ends with its owner, whatever happens.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child as Process, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::{Duration, Instant};

use super::groups::Group;

/// No line of an answer is longer: ten thousand boxes have a megabyte.
const LONGEST_LINE: u64 = 8 << 20;
/// So much of a line on standard error is kept.
const LONGEST_WORDS: u64 = 2000;
/// What a program gets to end by itself when it is not needed any more.
const GRACE: Duration = Duration::from_secs(2);

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

/// What the thread that listens is to read.
enum Wanted {
    Line,
    /// So many bytes.
    Bytes(usize),
}

/// What it has read.
enum Heard {
    Whole(Vec<u8>),
    HugeLine,
}

/// A program that runs.
#[derive(Debug)]
pub(super) struct Child {
    process: Process,
    /// Dropped first: the end of its input tells a program to end.
    to: Option<SyncSender<Vec<u8>>>,
    wanted: SyncSender<Wanted>,
    from: Receiver<Heard>,
    words: Receiver<String>,
    group: Group,
}

impl Child {
    /// Starts a command in a folder.
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
        Group::prepare(&mut starting);
        let mut process = starting.spawn()?;
        let group = Group::of(&process);
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

    /// The next line, waited for.
    pub(super) fn line(&mut self, limit: Duration) -> Result<String, Silence> {
        String::from_utf8(self.read(Wanted::Line, limit)?).map_err(|_| Silence::NoText)
    }

    /// So many bytes behind a line, waited for.
    pub(super) fn bytes(&mut self, count: usize, limit: Duration) -> Result<Vec<u8>, Silence> {
        self.read(Wanted::Bytes(count), limit)
    }

    fn read(&mut self, wanted: Wanted, limit: Duration) -> Result<Vec<u8>, Silence> {
        let _ = self.wanted.send(wanted);
        match self.from.recv_timeout(limit) {
            Ok(Heard::Whole(bytes)) => Ok(bytes),
            Ok(Heard::HugeLine) => Err(Silence::HugeLine),
            Err(RecvTimeoutError::Timeout) => Err(Silence::TooLong),
            Err(RecvTimeoutError::Disconnected) => Err(Silence::Ended),
        }
    }

    /// Ends it at once, and returns how it ended and the last line of its standard error.
    pub(super) fn post_mortem(mut self) -> (Option<ExitStatus>, Option<String>) {
        // It may be about to end by itself, with a status that says more than our signal.
        let status = self.wait(GRACE / 4);
        self.group.kill();
        let status = status.or_else(|| self.process.kill().and_then(|()| self.process.wait()).ok());
        let words = self.words.recv_timeout(GRACE).ok();
        (status, words.filter(|words| !words.is_empty()))
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

/// Reads what is wanted and no more: whatever else the program writes waits in its pipe.
fn reader(stdout: impl Read + Send + 'static) -> (SyncSender<Wanted>, Receiver<Heard>) {
    let ((want, wanted), (tell, heard)) = (sync_channel(1), sync_channel(1));
    std::thread::spawn(move || {
        let mut stdout = BufReader::new(stdout);
        for wanted in wanted {
            let Ok(read) = heard_in(&mut stdout, &wanted) else {
                return;
            };
            if tell.send(read).is_err() {
                return;
            }
        }
    });
    (want, heard)
}

fn heard_in(stdout: &mut impl BufRead, wanted: &Wanted) -> std::io::Result<Heard> {
    let mut read = Vec::new();
    match wanted {
        Wanted::Bytes(count) => {
            read.resize(*count, 0);
            stdout.read_exact(&mut read)?;
        }
        Wanted::Line => match stdout.take(LONGEST_LINE + 1).read_until(b'\n', &mut read)? {
            0 => return Err(std::io::ErrorKind::UnexpectedEof.into()),
            count if count as u64 > LONGEST_LINE => return Ok(Heard::HugeLine),
            _ => {}
        },
    }
    Ok(Heard::Whole(read))
}

/// Reads standard error to its end, and then says its last line that is not empty.
fn listener(stderr: impl Read + Send + 'static) -> Receiver<String> {
    let (tell, words) = sync_channel(1);
    std::thread::spawn(move || {
        let mut stderr = BufReader::new(stderr);
        let mut last = String::new();
        loop {
            let mut line = Vec::new();
            // The rest of a longer line is one of its own.
            match (&mut stderr).take(LONGEST_WORDS).read_until(b'\n', &mut line) {
                Ok(0) | Err(_) => break,
                Ok(_) => {}
            }
            let line = String::from_utf8_lossy(&line).trim().to_owned();
            if !line.is_empty() {
                last = line;
            }
        }
        let _ = tell.send(last);
    });
    words
}
