//! The frames of a video, one after another.

use std::io::{Read, Write};
use std::process::{ChildStdout, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use image::{GrayImage, RgbImage};

use crate::log::{ELSEWHERE, FrameLog, LogEvent, listen, plain};
use crate::probe::{MOST_MEGAPIXELS, Range};
use crate::program::{Running, command, drain, every_frame_option, version};
use crate::{Video, VideoError};
use scaleproof_core::message::message;

/// Number of frames that wait to be taken, besides those that ffmpeg holds itself.
const AHEAD: usize = 1;
/// A header's length and the last frame's time differ by less than this, s, in a whole video: a second, and a fiftieth of the length.
const SHORT_S: f64 = 1.0;
const SHORT_SHARE: f64 = 0.02;

/// Time by which ffmpeg seeks before the first frame, s: containers round times to a millisecond.
const BEFORE_S: f64 = 0.001;

/// A picture of 64 × 64 px takes some 0.1 s.
const TRIED_WITHIN: Duration = Duration::from_secs(20);

/// Selection of frames of a video, and their size.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The first time, s since the start.
    pub from_s: f64,
    /// The last time, s since the start; `None` for the end.
    pub to_s: Option<f64>,
    /// Every so-manieth frame, counted from the first of the video.
    pub every: u64,
    /// Number of frames in a row at each step.
    pub in_a_row: u64,
    /// Only frames of these numbers, where given.
    pub numbers: Option<Vec<u64>>,
    /// Number and time, s, of a frame before all of `numbers`. Decoding begins there, or at the last frame before from which it can, instead of at the
    /// first frame of the video.
    pub begin: Option<(u64, f64)>,
    /// Reduced to this height, px; `None` for the full size.
    pub height: Option<u32>,
    /// Time to wait for a frame before giving up.
    pub patience: Duration,
    /// True if damage is an error: something that cannot be decoded, a video that breaks off. A stream loses packets, and ends when it ends.
    pub is_whole: bool,
}

impl Default for Selection {
    fn default() -> Selection {
        Selection {
            from_s: 0.0,
            to_s: None,
            every: 1,
            in_a_row: 1,
            numbers: None,
            begin: None,
            height: None,
            patience: Duration::from_secs(60),
            is_whole: true,
        }
    }
}

impl Selection {
    /// Returns the frame that decoding begins with. Times are those of the whole video, which ffmpeg's filter does not know then.
    fn beginning(&self) -> Option<(u64, f64)> {
        let is_by_number = self.numbers.is_some() && self.every <= 1 && self.from_s <= 0.0 && self.to_s.is_none();
        self.begin.filter(|_| is_by_number)
    }

    /// Returns true if a frame is selected.
    fn has(&self, number: u64, time_s: f64) -> bool {
        let is_named = self.numbers.as_ref().is_none_or(|numbers| numbers.contains(&number));
        is_named && number % self.every.max(1) < self.in_a_row && time_s >= self.from_s && !self.is_past(number, time_s)
    }

    /// Returns true if neither this frame nor a later one is selected.
    fn is_past(&self, number: u64, time_s: f64) -> bool {
        let last = self
            .numbers
            .as_ref()
            .map(|numbers| numbers.iter().max().copied().unwrap_or(0));
        self.to_s.is_some_and(|to| time_s > to) || last.is_some_and(|last| number > last)
    }

    /// Returns the size of a frame of these, px.
    fn size(&self, video: &Video) -> [u32; 2] {
        let full = [video.width, video.height];
        let reduced = self.height.filter(|height| (1..video.height).contains(height));
        reduced.map_or(full, |height| {
            let width = f64::from(video.width) * f64::from(height) / f64::from(video.height);
            [(width.round() as u32).max(1), height]
        })
    }

    /// Returns the choice as an expression of ffmpeg's filter `select`, by the same numbers as [`Selection::has`]; `None` for all frames.
    fn expression(&self) -> Option<String> {
        let mut terms = Vec::new();
        let first = self.beginning().map_or(0, |(number, _)| number);
        if self.every > 1 {
            terms.push(format!("lt(mod(n\\,{})\\,{})", self.every, self.in_a_row));
        }
        if self.from_s > 0.0 {
            terms.push(format!("gte(t\\,{})", self.from_s));
        }
        terms.extend(self.to_s.map(|to| format!("lte(t\\,{to})")));
        terms.extend(self.numbers.as_ref().map(|numbers| {
            let equal: Vec<String> = numbers
                .iter()
                .map(|number| format!("eq(n+{first}\\,{number})"))
                .collect();
            format!(
                "({})",
                if equal.is_empty() {
                    "0".to_owned()
                } else {
                    equal.join("+")
                }
            )
        }));
        (!terms.is_empty()).then(|| terms.join("*"))
    }
}

/// One frame of a video.
#[derive(Debug, Clone)]
pub struct Frame<P> {
    /// Number in the video in the order of presentation; the first is 0.
    pub number: u64,
    /// Time at which it is shown, s since the start of the video.
    pub time_s: f64,
    /// The number of the last frame up to this one that decoding can begin with; 0 where none is known.
    pub key: u64,
    pub image: P,
}

/// Pixel format in which ffmpeg writes frames.
pub trait Pixels: Sized + Send + 'static {
    /// ffmpeg's name of the format.
    const FORMAT: &'static str;
    /// Returns the number of bytes of an image of a width and height.
    fn length(size: [u32; 2]) -> usize;
    /// Returns the image of a width and height; `None` when the bytes are not as many.
    fn from_bytes(size: [u32; 2], bytes: Vec<u8>) -> Option<Self>;
}

impl Pixels for GrayImage {
    const FORMAT: &'static str = "gray";
    fn length([width, height]: [u32; 2]) -> usize {
        width as usize * height as usize
    }
    fn from_bytes([width, height]: [u32; 2], bytes: Vec<u8>) -> Option<GrayImage> {
        GrayImage::from_raw(width, height, bytes)
    }
}

impl Pixels for RgbImage {
    const FORMAT: &'static str = "rgb24";
    fn length(size: [u32; 2]) -> usize {
        3 * GrayImage::length(size)
    }
    fn from_bytes([width, height]: [u32; 2], bytes: Vec<u8>) -> Option<RgbImage> {
        RgbImage::from_raw(width, height, bytes)
    }
}

/// Frames as ffmpeg decodes them. ffmpeg is ended when this is dropped; a few frames are held at a time, however long the video is.
pub struct Frames<P> {
    video: Video,
    name: String,
    filter: Filter,
    selection: Selection,
    /// Length of what is to come by the header, s.
    expected_s: Option<f64>,
    said: Receiver<LogEvent>,
    images: Receiver<P>,
    running: Running,
    /// The number of ffmpeg's first frame, and what its times lack, s; `None` until it came.
    origin: Option<(u64, f64)>,
    key: u64,
    last_s: Option<f64>,
    /// Width and height of the frames before they are scaled.
    decoded: Option<[u32; 2]>,
    given: u64,
    complaint: Option<String>,
    is_over: bool,
}

impl Video {
    /// Decodes the frames' luma, from black (0) to white (255). That of an HDR video is its signal as it is.
    ///
    /// # Errors
    /// No ffmpeg. What is wrong with the video shows while it is decoded.
    pub fn luma(&self, selection: &Selection) -> Result<Frames<GrayImage>, VideoError> {
        let filter = Filter {
            frames: Some(if self.is_limited {
                self.stored_luma(selection)
            } else {
                self.scaled(selection)
            }),
            is_limited: self.is_limited,
        };
        Frames::start(self, selection, filter)
    }

    /// Decodes the frames' colours in sRGB. Those of an HDR video are converted: white paper (203 cd/m², ITU-R BT.2408) becomes white, and what is
    /// brighter is white, too.
    ///
    /// # Errors
    /// No ffmpeg; an HDR video that it cannot convert. What is wrong with the video shows while it is decoded.
    pub fn rgb(&self, selection: &Selection) -> Result<Frames<RgbImage>, VideoError> {
        self.check_colours()?;
        let scaled = self.scaled(selection);
        let filter = match self.range {
            Range::Standard => scaled,
            // Exact curves, and no desaturation, which some versions leave out.
            Range::Hlg | Range::Pq => format!(
                "zscale=t=linear:npl=203:agamma=0,format=gbrpf32le,zscale=p=bt709:agamma=0,tonemap=clip:desat=0,zscale=t=bt709:m=bt709:r=pc:agamma=0,format=gbrp,{scaled}"
            ),
        };
        let filter = Filter {
            frames: Some(filter),
            is_limited: false,
        };
        Frames::start(self, selection, filter)
    }

    /// Returns the filter for luma as it is stored, in 8 bits. What ffmpeg makes of grey's range depends on its version, and a conversion takes it a fifth as
    /// long as decoding.
    fn stored_luma(&self, selection: &Selection) -> String {
        let is_as_stored = selection.height.is_none() && self.bits == 8;
        let converted = (!is_as_stored).then(|| format!("{},format=yuv420p,", self.scaled(selection)));
        format!("{}extractplanes=y", converted.unwrap_or_default())
    }

    /// Returns the filter for size and colours.
    pub(crate) fn scaled(&self, selection: &Selection) -> String {
        let [width, height] = selection.size(self);
        let (matrix, way) = match self.range {
            Range::Standard => (
                format!(":in_color_matrix={}", self.matrix),
                if selection.height.is_some() { "area" } else { "bicubic" },
            ),
            _ => (String::new(), "bicubic"),
        };
        format!("scale={width}:{height}{matrix}:flags={way}+accurate_rnd+full_chroma_int")
    }
}

impl<P: Pixels> Frames<P> {
    /// Starts ffmpeg; `filter` gives frames their size and colours.
    pub(crate) fn start(video: &Video, selection: &Selection, filter: Filter) -> Result<Frames<P>, VideoError> {
        let (name, frame_log) = (video.input.name.clone(), FrameLog::default());
        let mut command = command("ffmpeg", &name)?;
        video.input.feed(&mut command)?;
        command
            .args(input_options())
            .args(
                selection
                    .beginning()
                    .into_iter()
                    .flat_map(|(_, time_s)| ["-ss".to_owned(), format!("{:.6}", (time_s - BEFORE_S).max(0.0))]),
            )
            .args(&video.input.arguments)
            .args(["-map", &format!("0:{}", video.stream)])
            .args(output_arguments::<P>(selection, &filter, &frame_log));
        let mut running = Running::start(command, "ffmpeg", &name)?.bounded(video.input.most_memory);
        let (Some(stdout), Some(stderr)) = (running.0.stdout.take(), running.0.stderr.take()) else {
            return Err(VideoError::not_started(&name, "ffmpeg", "it has no output"));
        };
        let end_s = selection.to_s.into_iter().chain(video.duration_s).reduce(f64::min);
        Ok(Frames {
            expected_s: end_s
                .filter(|_| selection.is_whole && selection.numbers.is_none() && video.duration_s.is_some()),
            said: listen(stderr, &frame_log),
            images: images(stdout, selection.size(video), filter.is_limited),
            running,
            video: video.clone(),
            name,
            filter,
            origin: None,
            key: selection.begin.map_or(0, |(number, _)| number),
            selection: selection.clone(),
            last_s: None,
            decoded: None,
            given: 0,
            complaint: None,
            is_over: false,
        })
    }

    fn following(&mut self) -> Result<Option<Frame<P>>, VideoError> {
        loop {
            match self.said.recv_timeout(self.selection.patience) {
                Ok(LogEvent::Error(line)) => {
                    let line = plain(&line, &self.name);
                    let is_elsewhere = line == ELSEWHERE;
                    self.complaint.get_or_insert(line);
                    // ffmpeg conceals what it cannot decode, and goes on.
                    if self.selection.is_whole || is_elsewhere {
                        return Err(self.damaged());
                    }
                }
                // ffmpeg would stretch them to the size of the first, and no camera file would fit.
                Ok(LogEvent::Frame { size: Some(size), .. }) if *self.decoded.get_or_insert(size) != size => {
                    self.complaint = Some("its frames change their size".to_owned());
                    return Err(self.damaged());
                }
                Ok(LogEvent::Frame {
                    number, time_s, is_key, ..
                }) => {
                    let Some((first, offset_s)) = self.origin(time_s) else {
                        self.begin_anew()?;
                        continue;
                    };
                    let (number, time_s) = (first + number, offset_s + time_s);
                    if self.selection.is_past(number, time_s) {
                        return Ok(None);
                    }
                    self.last_s = Some(time_s);
                    if is_key {
                        self.key = number;
                    }
                    if !self.selection.has(number, time_s) {
                        continue;
                    }
                    match self.images.recv_timeout(self.selection.patience) {
                        Ok(image) => {
                            self.given += 1;
                            let key = self.key;
                            return Ok(Some(Frame {
                                number,
                                time_s,
                                key,
                                image,
                            }));
                        }
                        Err(RecvTimeoutError::Timeout) => return Err(self.silent()),
                        Err(RecvTimeoutError::Disconnected) => return Err(self.damaged()),
                    }
                }
                Err(RecvTimeoutError::Timeout) => return Err(self.silent()),
                Err(RecvTimeoutError::Disconnected)
                    if self.origin.is_none() && self.selection.beginning().is_some() =>
                {
                    self.begin_anew()?
                }
                Err(RecvTimeoutError::Disconnected) => return self.end().map(|()| None),
            }
        }
    }

    /// Returns the number of ffmpeg's first frame and what its times lack, s, when a frame came; `None` where that is not the frame to begin with.
    fn origin(&mut self, time_s: f64) -> Option<(u64, f64)> {
        if self.origin.is_none() {
            self.origin = match self.selection.beginning() {
                None => Some((0, 0.0)),
                Some((number, begin_s)) => {
                    let is_it = (time_s - begin_s.min(BEFORE_S)).abs() <= BEFORE_S;
                    is_it.then_some((number, begin_s - time_s))
                }
            };
        }
        self.origin
    }

    /// Begins with the first frame: not every container leads to a frame by its time.
    fn begin_anew(&mut self) -> Result<(), VideoError> {
        let selection = Selection {
            begin: None,
            ..self.selection.clone()
        };
        *self = Frames::start(&self.video, &selection, self.filter.clone())?;
        Ok(())
    }

    /// Interprets the end of ffmpeg's messages.
    fn end(&mut self) -> Result<(), VideoError> {
        let is_well = self.running.ended_well(self.selection.patience) == Some(true);
        let Some(last_s) = self.last_s else {
            let name = self.name.clone();
            return Err(match &self.complaint {
                Some(_) => self.damaged(),
                None => VideoError::NoFrames { name },
            });
        };
        let is_short = |expected: f64| last_s + SHORT_S.max(SHORT_SHARE * expected) < expected;
        if is_well && !self.expected_s.is_some_and(is_short) {
            return Ok(());
        }
        self.complaint
            .get_or_insert("its header says that more follows".to_owned());
        Err(self.damaged())
    }

    /// Returns the error behind a message of ffmpeg's: the video's damage, unless ffmpeg fails with any picture.
    fn damaged(&self) -> VideoError {
        let name = self.name.clone();
        if let Err(reason) = takes::<P>(&self.selection, &self.filter, self.video.range) {
            let version = version();
            return message!(
                "{name} was not decoded: ffmpeg {version} does not take what this program tells it ({reason}): install another (5.1 to 9.0 were \
                 tried)"
            )
            .into();
        }
        VideoError::Damaged {
            name,
            after_s: self.last_s.unwrap_or(0.0),
            reason: self.complaint.clone().unwrap_or("ffmpeg ended early".to_owned()),
        }
    }

    fn silent(&self) -> VideoError {
        VideoError::Silent {
            name: self.name.clone(),
            waited_s: self.selection.patience.as_secs_f64(),
        }
    }
}

impl<P: Pixels> Iterator for Frames<P> {
    type Item = Result<Frame<P>, VideoError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.is_over {
            return None;
        }
        let following = self.following();
        self.is_over = !matches!(following, Ok(Some(_)));
        following.transpose()
    }
}

/// Returns ffmpeg's options before its input.
fn input_options() -> [String; 7] {
    let most_pixels = (MOST_MEGAPIXELS * 1_000_000).to_string();
    [
        "-nostdin",
        "-hide_banner",
        "-nostats",
        "-loglevel",
        "level+info",
        "-max_pixels",
        &most_pixels,
    ]
    .map(str::to_owned)
}

/// Returns ffmpeg's arguments for its output: every chosen frame, with its own time, as raw bytes.
fn output_arguments<P: Pixels>(selection: &Selection, filter: &Filter, frame_log: &FrameLog) -> Vec<String> {
    let choice = selection.expression().map(|e| format!("select={e}"));
    let filters = [Some(frame_log.filter()), choice, filter.frames.clone()];
    let filters: Vec<String> = filters.into_iter().flatten().collect();
    let mut arguments: Vec<String> = ["-an", "-sn", "-dn", "-map_metadata", "-1", "-map_chapters", "-1"]
        .map(str::to_owned)
        .into();
    arguments.extend(["-vf", &filters.join(",")].map(str::to_owned));
    arguments.extend([every_frame_option(), "passthrough"].map(str::to_owned));
    // A clock of microseconds: on that of their mean rate two frames of a variable rate would fall together.
    arguments.extend(["-enc_time_base", "1/1000000"].map(str::to_owned));
    arguments.extend(["-pix_fmt", P::FORMAT, "-f", "rawvideo"].map(str::to_owned));
    // With more threads, frames wait for those after them: the last ones of a part for the end of the film.
    arguments.extend(["-threads", "1"].map(str::to_owned));
    // Where no frame is written nothing makes ffmpeg wait: it would decode all that follows while the frames are looked at.
    if let Some(numbers) = &selection.numbers {
        arguments.extend(["-frames:v".to_owned(), numbers.len().max(1).to_string()]);
    }
    arguments.push("pipe:1".to_owned());
    arguments
}

/// Checks that ffmpeg accepts the arguments of the output, with a grey picture of a range of light.
///
/// # Errors
/// Its message.
fn takes<P: Pixels>(selection: &Selection, filter: &Filter, range: Range) -> Result<(), String> {
    const PICTURE: [usize; 2] = [64, 64];
    let (not_started, frame_log) = (|e: VideoError| e.to_string(), FrameLog::default());
    let mut command = command("ffmpeg", "").map_err(not_started)?;
    command
        .args(input_options())
        .args(["-f", "rawvideo", "-pixel_format", "yuv420p", "-video_size"])
        .arg(format!("{}x{}", PICTURE[0], PICTURE[1]))
        .args(range.options())
        .args(["-i", "pipe:0"])
        .args(output_arguments::<P>(selection, filter, &frame_log))
        .stdin(Stdio::piped());
    let mut running = Running::start(command, "ffmpeg", "").map_err(not_started)?;
    if let Some(mut stdin) = running.0.stdin.take() {
        // It reads nothing where it does not take an option.
        let _ = stdin.write_all(&vec![128; PICTURE[0] * PICTURE[1] * 3 / 2]);
    }
    drain(running.0.stdout.take(), 0);
    let said = running.0.stderr.take().map(|log| listen(log, &frame_log));
    let mut said = std::iter::from_fn(|| said.as_ref()?.recv_timeout(TRIED_WITHIN).ok());
    let complaint = said.find_map(|said| match said {
        LogEvent::Error(line) => Some(plain(&line, "")),
        LogEvent::Frame { .. } => None,
    });
    match (complaint, running.ended_well(TRIED_WITHIN)) {
        (Some(complaint), _) => Err(complaint),
        (None, Some(false)) => Err("it gives no reason".to_owned()),
        (None, _) => Ok(()),
    }
}

/// Filter from a decoded frame to the required size and colours.
#[derive(Debug, Clone)]
pub(crate) struct Filter {
    /// ffmpeg's; `None` to leave frames as they are.
    pub frames: Option<String>,
    /// The luma that ffmpeg gives goes from 16 to 235.
    pub is_limited: bool,
}

/// Stretches luma from 16 to 235 to 0 to 255.
pub(crate) fn widen(levels: &mut [u8]) {
    for level in levels {
        // Of 16 bits, so that many levels take one instruction.
        let above = u16::from(level.saturating_sub(16));
        *level = ((above * 255 + 109) / 219).min(255) as u8;
    }
}

/// Reads frames of a size until the pipe ends; it is full while nobody takes them, which makes ffmpeg wait.
pub(crate) fn images<P: Pixels>(mut stdout: ChildStdout, size: [u32; 2], is_limited: bool) -> Receiver<P> {
    let (give, images) = sync_channel(AHEAD);
    std::thread::spawn(move || {
        let length = P::length(size);
        loop {
            let mut bytes = vec![0; length];
            if stdout.read_exact(&mut bytes).is_err() {
                return;
            }
            if is_limited {
                widen(&mut bytes);
            }
            let Some(image) = P::from_bytes(size, bytes) else {
                return;
            };
            if give.send(image).is_err() {
                return;
            }
        }
    });
    images
}
