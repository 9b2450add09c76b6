//! What ffmpeg says while it decodes: the time of each frame, by its filter `showinfo`, and errors.

use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, channel};

/// No line of ffmpeg's is longer; the rest of one is a line of its own.
const LONGEST_LINE: u64 = 4096;

/// A line that somebody waits for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Said {
    /// A decoded frame, in the order of presentation.
    Frame {
        number: u64,
        time_s: f64,
        /// Decoding can begin with it.
        is_key: bool,
        /// Before it is scaled, px.
        size: Option<[u32; 2]>,
    },
    /// Of the level error or worse.
    Error(String),
}

/// Reads a log to its end and sends what matters. The channel is as long as the frames that ffmpeg decodes ahead of the pipe, and a line has a
/// few bytes.
pub(crate) fn listen(log: impl Read + Send + 'static) -> Receiver<Said> {
    let (tell, said) = channel();
    std::thread::spawn(move || {
        let mut log = BufReader::new(log);
        let mut line = Vec::new();
        let mut time_base = None;
        while (&mut log)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)
            .is_ok_and(|count| count > 0)
        {
            let text = String::from_utf8_lossy(&line).into_owned();
            line.clear();
            time_base = time_base_of(&text).or(time_base);
            if let Some(said) = understood(&text, time_base)
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

/// Of `… config in time_base: 1/15360, frame_rate: 30/1`, s: showinfo's own `pts_time` has six digits, which is too coarse after a quarter of an
/// hour.
fn time_base_of(line: &str) -> Option<f64> {
    let (_, rest) = line.split_once("config in time_base: ")?;
    let (over, rest) = rest.split_once('/')?;
    let (under, _) = rest.split_once(',')?;
    let [over, under] = [over, under].map(|text| text.trim().parse::<f64>().ok());
    over.zip(under).map(|(over, under)| over / under)
}

/// A line, if it matters. Since `-loglevel level+info`, each has its level in brackets.
fn understood(line: &str, time_base: Option<f64>) -> Option<Said> {
    if line.contains("_showinfo_") {
        let number = field(line, " n:")?.parse().ok()?;
        let pts: f64 = field(line, " pts:")?.parse().ok()?;
        let time_s = pts * time_base?;
        let size = field(line, " s:").and_then(|size| size.split_once('x'));
        let size = size.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        let is_key = field(line, " iskey:") == Some("1");
        return time_s.is_finite().then_some(Said::Frame {
            number,
            time_s,
            is_key,
            size,
        });
    }
    // What ffmpeg makes up where data is damaged is only a warning to it, or less.
    let is_made_up = |line: &&str| line.contains("corrupt decoded frame") || line.contains(" concealing ");
    let worded = |level: &&str| Some(line.split_once(*level)?.1);
    let error = ["[error] ", "[fatal] ", "[panic] "].iter().find_map(worded);
    let made_up = Some(line)
        .filter(is_made_up)
        .map(|line| line.rsplit("] ").next().unwrap_or(line));
    Some(Said::Error(error.or(made_up)?.trim().to_owned()))
}

/// The word behind a name.
fn field<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    line.split_once(name)?.1.split_whitespace().next()
}

/// The last line of a complaint, without the input's name and the addresses of ffmpeg's parts.
pub(crate) fn last_words(complaint: &str, name: &str) -> String {
    let last = complaint
        .lines()
        .rfind(|line| !line.trim().is_empty())
        .unwrap_or("no reason given");
    plain(last, name)
}

/// A line without the input's name and the addresses of ffmpeg's parts.
pub(crate) fn plain(line: &str, name: &str) -> String {
    let line = line.rsplit("] ").next().unwrap_or(line).trim();
    let line = line.strip_prefix("file:").unwrap_or(line);
    let line = line
        .strip_prefix(name)
        .map_or(line, |rest| rest.trim_start_matches(':').trim());
    let mut letters = line.chars();
    let first = letters
        .next()
        .map(|first| first.to_lowercase().to_string())
        .unwrap_or_default();
    format!("{first}{}", letters.as_str())
}
