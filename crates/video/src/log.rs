//! Messages of ffmpeg while it decodes: the time of each frame, by its filter `showinfo`, and errors.
//!
//! Much of it comes from the video: its title and comments, its name, what a demuxer quotes. So a line counts by how it begins alone: `[PART @ ADDRESS] [LEVEL] `
//! are ffmpeg's, and the filter has a name that no video knows.

use std::hash::{BuildHasher, RandomState};
use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, sync_channel};

/// Maximum length of a line; the rest is left out.
const LONGEST_LINE: u64 = 4096;
/// Number of lines that wait to be taken; ffmpeg waits beyond it. It decodes some thirty frames ahead of the pipe with their pictures.
const MOST_WAITING: usize = 4096;

/// Reason why a camera that sends ffmpeg to another address is not followed; ffmpeg itself would.
pub(crate) const ELSEWHERE: &str = "it sends on to another address: give that one";

/// Event in ffmpeg's log.
#[derive(Debug, Clone, PartialEq)]
pub enum LogEvent {
    /// A decoded frame, in the order of presentation.
    Frame {
        number: u64,
        time_s: f64,
        /// Decoding can begin with it.
        is_key: bool,
        /// Before it is scaled, px.
        size: Option<[u32; 2]>,
    },
    /// Message of the level error or worse.
    Error(String),
}

/// ffmpeg's filter that logs each frame.
#[derive(Debug, Clone)]
pub struct FrameLog(String);

impl Default for FrameLog {
    /// Creates one whose name is another in every run.
    fn default() -> FrameLog {
        FrameLog::named(&format!("{:016x}", RandomState::new().hash_one(())))
    }
}

impl FrameLog {
    /// Creates one of a name of letters and digits.
    pub fn named(name: &str) -> FrameLog {
        FrameLog(format!("showinfo@{name}"))
    }

    /// Returns the filter's argument.
    pub(crate) fn filter(&self) -> String {
        format!("{}=checksum=0", self.0)
    }

    /// Returns a parser of the log, line by line.
    pub fn parser(&self) -> LogParser {
        LogParser {
            frame_log: self.0.clone(),
            time_base: None,
        }
    }
}

/// Parser of a log, with its state so far.
#[derive(Debug)]
pub struct LogParser {
    frame_log: String,
    /// Length of a tick of the video's clock, s.
    time_base: Option<f64>,
}

impl LogParser {
    /// Parses a line; `None` if it does not matter.
    pub fn parse(&mut self, line: &str) -> Option<LogEvent> {
        let log = LogLine::of(line)?;
        if log.by == Some(&self.frame_log) {
            if let Some(time_base) = time_base_of(log.words) {
                return match self.time_base.replace(time_base) {
                    // Another size of the frames begins the filter anew.
                    Some(before) if before.to_bits() != time_base.to_bits() => {
                        Some(LogEvent::Error("its clock changes".to_owned()))
                    }
                    _ => None,
                };
            }
            return self.frame(log.words);
        }
        if log.is_sent_on() {
            return Some(LogEvent::Error(ELSEWHERE.to_owned()));
        }
        // What ffmpeg makes up where data is damaged is only a warning to it, or less.
        let is_made_up = || {
            let is_corrupt = || {
                log.words.starts_with("corrupt decoded frame")
                    || log.words.contains(": corrupt decoded frame in stream ")
            };
            log.by.is_some() && log.words.starts_with("concealing ") || log.level == "warning" && is_corrupt()
        };
        (log.is_error() || is_made_up()).then(|| LogEvent::Error(log.words.trim().to_owned()))
    }

    fn frame(&self, words: &str) -> Option<LogEvent> {
        let words = words.strip_prefix("n:").map(|_| words)?;
        let number = field(words, "n:")?.parse().ok()?;
        let pts: f64 = field(words, " pts:")?.parse().ok()?;
        let time_s = pts * self.time_base?;
        let size = field(words, " s:").and_then(|size| size.split_once('x'));
        let size = size.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        let is_key = field(words, " iskey:") == Some("1");
        time_s.is_finite().then_some(LogEvent::Frame {
            number,
            time_s,
            is_key,
            size,
        })
    }
}

/// Line of the log by ffmpeg's own parts, as `-loglevel level+info` makes it.
struct LogLine<'a> {
    /// Innermost part of ffmpeg that logs it.
    by: Option<&'a str>,
    level: &'a str,
    words: &'a str,
}

impl LogLine<'_> {
    fn of(line: &str) -> Option<LogLine<'_>> {
        let (by, rest) = without_parts(line);
        let (level, words) = rest.strip_prefix('[')?.split_once("] ")?;
        let is_level = ["panic", "fatal", "error", "warning", "info"].contains(&level);
        is_level.then_some(LogLine { by, level, words })
    }

    /// Returns true if an RTSP server has sent ffmpeg to another one.
    fn is_sent_on(&self) -> bool {
        self.by == Some("rtsp") && self.words.contains(": Redirecting to ")
    }

    fn is_error(&self) -> bool {
        ["error", "fatal", "panic"].contains(&self.level)
    }
}

/// Returns the last of `[PART @ ADDRESS] ` that a line begins with, and what follows.
fn without_parts(line: &str) -> (Option<&str>, &str) {
    let (mut by, mut rest) = (None, line);
    while let Some((part, after)) = rest.strip_prefix('[').and_then(|rest| rest.split_once("] ")) {
        let named = part.rsplit_once(" @ ").filter(|(_, address)| {
            let digits = address.strip_prefix("0x").unwrap_or(address);
            !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
        });
        let Some((name, _)) = named else { break };
        (by, rest) = (Some(name), after);
    }
    (by, rest)
}

/// Reads a log to its end and sends what matters.
pub(crate) fn listen(log: impl Read + Send + 'static, frame_log: &FrameLog) -> Receiver<LogEvent> {
    let (tell, said) = sync_channel(MOST_WAITING);
    let mut lines = frame_log.parser();
    std::thread::spawn(move || {
        let mut log = BufReader::new(log);
        while let Some(line) = next_line(&mut log) {
            if let Some(said) = lines.parse(&line)
                && tell.send(said).is_err()
            {
                // Nobody listens any more; a full pipe must not stop ffmpeg before it is ended.
                let _ = std::io::copy(&mut log, &mut std::io::sink());
                return;
            }
        }
    });
    said
}

/// Returns the next line, without what is too long of it; `None` at the end.
fn next_line(log: &mut impl BufRead) -> Option<String> {
    let mut line = Vec::new();
    let count = log.take(LONGEST_LINE).read_until(b'\n', &mut line).ok()?;
    if count == 0 {
        return None;
    }
    while line.last() != Some(&b'\n') {
        let buffer = log.fill_buf().ok()?;
        let end = memchr::memchr(b'\n', buffer);
        let length = end.map_or(buffer.len(), |end| end + 1);
        log.consume(length);
        if end.is_some() || length == 0 {
            break;
        }
    }
    Some(String::from_utf8_lossy(&line).into_owned())
}

/// Reads the time base, s, of `config in time_base: 1/15360, frame_rate: 30/1`: showinfo's own `pts_time` has six digits, which is too coarse after a quarter of an
/// hour.
fn time_base_of(words: &str) -> Option<f64> {
    let rest = words.strip_prefix("config in time_base: ")?;
    let (over, rest) = rest.split_once('/')?;
    let (under, _) = rest.split_once(',')?;
    let [over, under] = [over, under].map(|text| text.trim().parse::<f64>().ok());
    over.zip(under).map(|(over, under)| over / under)
}

/// Returns the word behind a name.
fn field<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    line.split_once(name)?.1.split_whitespace().next()
}

/// Returns the last complaint among what was said, without the input's name and the addresses of ffmpeg's parts.
pub(crate) fn last_words(said: &str, name: &str) -> String {
    let words = |line| LogLine::of(line).filter(LogLine::is_error).map(|log| log.words);
    let mut complaints = said.lines().rev().filter_map(words);
    let last = complaints.find(|words| !words.trim().is_empty());
    plain(last.unwrap_or("no reason given"), name)
}

/// Returns true if an RTSP server has sent ffmpeg to another one.
pub(crate) fn sends_elsewhere(said: &str) -> bool {
    said.lines().filter_map(LogLine::of).any(|log| log.is_sent_on())
}

/// Returns a message of ffmpeg's without the input's name.
pub(crate) fn plain(words: &str, name: &str) -> String {
    let words = words.trim();
    let words = words.strip_prefix("file:").unwrap_or(words);
    let named = [crate::input::SHOWN, name]
        .into_iter()
        .find_map(|name| words.strip_prefix(name).filter(|_| !name.is_empty()));
    let words = named.map_or(words, |rest| rest.trim_start_matches(':').trim());
    let mut letters = words.chars();
    let first = letters
        .next()
        .map(|first| first.to_lowercase().to_string())
        .unwrap_or_default();
    format!("{first}{}", letters.as_str())
}
