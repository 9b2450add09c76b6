//! Description of a video before a frame of it is decoded: `ffprobe`'s, checked.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;
use std::time::Duration;

use serde::Deserialize;

use crate::log::{ELSEWHERE, last_words, sends_elsewhere};
use crate::program::{LEFT_BEHIND, Running, command, drain, every_frame_option, has_zscale};
use crate::{Input, VideoError};
use scaleproof_core::message::bail;
use scaleproof_photo::{Budget, DecodeCost};

/// ffprobe reads a few megabytes; a file on a slow disk takes seconds.
const PROBED_WITHIN: Duration = Duration::from_secs(60);
/// A description of one stream has a few kilobytes.
const MOST_SAID: u64 = 1 << 20;
/// An MP4 file has some ten boxes at its top, or one for each fragment; and an index of some megabytes an hour.
const MOST_BOXES: usize = 1000;
const MOST_INDEX: u64 = 64 << 20;
/// Larger than 8K (8192 × 4320): ffmpeg holds some twenty frames.
pub(crate) const MOST_MEGAPIXELS: u64 = 36;
const FRAME: Budget = Budget {
    megapixels: MOST_MEGAPIXELS,
    memory: 256 << 20,
    ..Budget::FILE
};

/// The range of light that a video stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Standard range, as of photos.
    Standard,
    /// HDR: hybrid log-gamma (ARIB STD-B67).
    Hlg,
    /// HDR: perceptual quantiser (SMPTE ST 2084), as HDR10 and Dolby Vision.
    Pq,
}

impl Range {
    /// Returns its usual name.
    pub fn name(self) -> &'static str {
        match self {
            Range::Standard => "SDR",
            Range::Hlg => "HLG",
            Range::Pq => "PQ",
        }
    }

    /// Returns ffmpeg's options that state the range of raw pictures.
    pub(crate) fn options(self) -> Vec<&'static str> {
        let transfer = match self {
            Range::Standard => return Vec::new(),
            Range::Hlg => "arib-std-b67",
            Range::Pq => "smpte2084",
        };
        let wide = [
            "-color_primaries",
            "bt2020",
            "-colorspace",
            "bt2020nc",
            "-color_range",
            "tv",
        ];
        [&wide[..], &["-color_trc", transfer]].concat()
    }
}

/// A video that can be decoded, as its header says.
#[derive(Debug, Clone, PartialEq)]
pub struct Video {
    pub input: Input,
    /// Width of an upright frame, px.
    pub width: u32,
    /// Height of an upright frame, px.
    pub height: u32,
    /// Clockwise turn by the container that makes frames upright: 0, 90, 180 or 270.
    pub turned_deg: u32,
    /// The codec, as ffmpeg calls it: `h264`, `hevc`, `vp9`, `av1`.
    pub codec: String,
    /// Length by the header, s; `None` where it does not say, as of streams. It may lie.
    pub duration_s: Option<f64>,
    /// Number of frames by the header; `None` where it does not say. It may lie.
    pub frames: Option<u64>,
    /// Mean frames per second by the header; `None` where it does not say.
    pub frames_per_s: Option<f64>,
    /// Bits of a sample: 8, 10 or 12.
    pub bits: u32,
    pub range: Range,
    /// True if its luma goes from 16 to 235 of 255, as that of most videos does.
    pub(crate) is_limited: bool,
    /// Moreover it is no HDR, has 8 bits, and one value of either chroma for 2 × 2 pixels (4:2:0).
    pub(crate) has_planes: bool,
    /// Index of the stream in the input.
    pub(crate) stream: u32,
    /// The matrix from luma and chroma to colours, as ffmpeg's filter `scale` calls it.
    pub(crate) matrix: &'static str,
}

#[derive(Deserialize)]
struct Description {
    #[serde(default)]
    streams: Vec<Stream>,
    #[serde(default)]
    format: Format,
}

#[derive(Deserialize, Default)]
struct Format {
    duration: Option<String>,
    start_time: Option<String>,
}

#[derive(Deserialize)]
struct Stream {
    index: u32,
    codec_type: Option<String>,
    codec_name: Option<String>,
    codec_tag_string: Option<String>,
    width: Option<u32>,
    height: Option<u32>,
    pix_fmt: Option<String>,
    bits_per_raw_sample: Option<String>,
    color_transfer: Option<String>,
    color_range: Option<String>,
    color_space: Option<String>,
    sample_aspect_ratio: Option<String>,
    avg_frame_rate: Option<String>,
    duration: Option<String>,
    nb_frames: Option<String>,
    #[serde(default)]
    disposition: Disposition,
    #[serde(default)]
    side_data_list: Vec<SideData>,
}

#[derive(Deserialize, Default)]
struct Disposition {
    #[serde(default)]
    attached_pic: u8,
}

#[derive(Deserialize)]
struct SideData {
    side_data_type: Option<String>,
    rotation: Option<f64>,
}

impl Video {
    /// Describes a file.
    ///
    /// # Errors
    /// No ffprobe; a file that is no video, or none that can be decoded within bounds.
    pub fn open(path: &Path) -> Result<Video, VideoError> {
        use scaleproof_core::files::FileError;
        let about = std::fs::metadata(path).map_err(|e| FileError::read(path, &e))?;
        if !about.is_file() {
            return Err(FileError::cannot_read(path, "it is not a file").into());
        }
        let input = Input::file(path);
        if about.len() == 0 {
            bail!("{} is empty: copy it from the camera again", input.name);
        }
        if is_encrypted_mp4(path) {
            return Err(VideoError::encrypted(&input.name));
        }
        Video::of(input)
    }

    /// Describes any input.
    ///
    /// # Errors
    /// As [`Video::open`].
    pub fn of(input: Input) -> Result<Video, VideoError> {
        // ffmpeg takes as long to say its version as ffprobe what the video is.
        let _ = std::thread::Builder::new().spawn(every_frame_option);
        let description = described(&input)?;
        Video::checked(input, description)
    }

    /// Describes an input by what ffprobe has answered, as JSON.
    ///
    /// # Errors
    /// As [`Video::of`].
    pub fn by_answer(input: Input, answer: &[u8]) -> Result<Video, VideoError> {
        let description = serde_json::from_slice(answer).map_err(|e| VideoError::NotAVideo {
            reason: e.to_string(),
            name: input.name.clone(),
        })?;
        Video::checked(input, description)
    }

    fn checked(input: Input, description: Description) -> Result<Video, VideoError> {
        let name = || input.name.clone();
        let is_picture = |s: &&Stream| s.codec_type.as_deref() == Some("video") && s.disposition.attached_pic == 0;
        let Some(stream) = description.streams.iter().find(is_picture) else {
            return Err(match description.streams.is_empty() {
                true => VideoError::NotAVideo {
                    name: name(),
                    reason: "it has no stream".to_owned(),
                },
                false => VideoError::NoPicture { name: name() },
            });
        };
        if stream.is_encrypted() {
            return Err(VideoError::encrypted(&input.name));
        }
        let (Some(width @ 1..), Some(height @ 1..), Some(codec)) = (stream.width, stream.height, &stream.codec_name)
        else {
            return Err(VideoError::NoFrames { name: name() });
        };
        if stream.nb_frames.as_deref() == Some("0") {
            return Err(VideoError::NoFrames { name: name() });
        }
        let turned_deg = stream.turned_deg();
        let cost = DecodeCost::of_png([width, height], 3, turned_deg != 0);
        if FRAME.check(&cost).is_err() {
            bail!(
                "{} has frames of {width} × {height} px, more than the {MOST_MEGAPIXELS} megapixels that are read: scale it down with \
                 `ffmpeg -i IN -vf scale=3840:-2 OUT`",
                input.name
            );
        }
        if let Some(ratio) = stream
            .sample_aspect_ratio
            .as_ref()
            .filter(|r| !["1:1", "0:1", "N/A"].contains(&r.as_str()))
        {
            let name = &input.name;
            bail!(
                "{name} has pixels that are not square ({ratio}), which no camera file describes: film without an anamorphic mode"
            );
        }
        let [width, height] = if turned_deg % 180 == 0 {
            [width, height]
        } else {
            [height, width]
        };
        Ok(Video {
            width,
            height,
            turned_deg,
            codec: codec.clone(),
            duration_s: number(&stream.duration).or_else(|| description.format.length_s()),
            frames: stream.nb_frames.as_ref().and_then(|text| text.parse().ok()),
            frames_per_s: stream.frames_per_s(),
            bits: stream.bits(),
            range: stream.range(),
            is_limited: stream.is_limited(),
            has_planes: stream.is_limited()
                && stream.range() == Range::Standard
                && stream.pix_fmt.as_deref() == Some("yuv420p"),
            stream: stream.index,
            matrix: stream.matrix(height.min(width)),
            input,
        })
    }

    /// Returns a caution on its colours, as a sentence.
    pub fn colour_note(&self) -> Option<String> {
        let name = &self.input.name;
        match self.range {
            Range::Standard if self.bits > 8 => {
                Some(format!("{name} has {} bits a sample, of which 8 are kept", self.bits))
            }
            Range::Standard => None,
            hdr => Some(format!(
                "{name} is an HDR video ({}), whose colours are converted to SDR: what is brighter than white paper (203 cd/m²) becomes white; film with HDR switched off where colours matter",
                hdr.name()
            )),
        }
    }

    /// Refuses HDR whose colours nothing here can convert.
    pub(crate) fn check_colours(&self) -> Result<(), VideoError> {
        if self.range == Range::Standard || has_zscale() {
            return Ok(());
        }
        bail!(
            "{} is an HDR video ({}), whose colours this system's ffmpeg cannot convert, as it lacks the filter zscale: install an ffmpeg built \
             with libzimg, or film with HDR switched off",
            self.input.name,
            self.range.name()
        )
    }
}

/// Reads a time, s; `None` if it is 0.
fn number(text: &Option<String>) -> Option<f64> {
    text.as_ref()?.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0)
}

impl Format {
    /// Returns the duration, s. Matroska's is the time of the end, wherever the first frame stands.
    fn length_s(&self) -> Option<f64> {
        let end_s = number(&self.duration)?;
        Some(end_s - number(&self.start_time).unwrap_or(0.0)).filter(|s| *s > 0.0)
    }
}

impl Stream {
    /// Returns true if it is encrypted, by the sample entry `encv` (ISO 14496-12) or by the data that a player needs for decryption.
    fn is_encrypted(&self) -> bool {
        let is_key_data = |data: &SideData| {
            data.side_data_type
                .as_ref()
                .is_some_and(|kind| kind.contains("ncryption"))
        };
        self.codec_tag_string.as_deref() == Some("encv") || self.side_data_list.iter().any(is_key_data)
    }

    /// Returns the clockwise turn; ffprobe counts counter-clockwise.
    fn turned_deg(&self) -> u32 {
        let rotation = self.side_data_list.iter().find_map(|data| data.rotation).unwrap_or(0.0);
        ((-rotation / 90.0).round() as i64).rem_euclid(4) as u32 * 90
    }

    fn frames_per_s(&self) -> Option<f64> {
        let (over, under) = self.avg_frame_rate.as_ref()?.split_once('/')?;
        let rate = over.parse::<f64>().ok()? / under.parse::<f64>().ok()?;
        (rate.is_finite() && rate > 0.0).then_some(rate)
    }

    fn bits(&self) -> u32 {
        let said = self.bits_per_raw_sample.as_ref().and_then(|bits| bits.parse().ok());
        let format = self.pix_fmt.as_deref().unwrap_or_default();
        let of_format = [("p16", 16), ("p12", 12), ("p10", 10), ("p010", 10)];
        let named = of_format
            .iter()
            .find(|(part, _)| format.contains(part))
            .map(|(_, bits)| *bits);
        named.or(said).unwrap_or(8)
    }

    fn range(&self) -> Range {
        match self.color_transfer.as_deref() {
            Some("smpte2084") => Range::Pq,
            Some("arib-std-b67") => Range::Hlg,
            _ => Range::Standard,
        }
    }

    /// Returns true for the limited range. A stream that does not state it is limited if it is YUV; RGB never is, nor are the formats of old JPEGs (`yuvj…`).
    fn is_limited(&self) -> bool {
        let format = self.pix_fmt.as_deref().unwrap_or_default();
        let is_yuv = ["yuv4", "nv12", "p010", "p012", "p016"]
            .iter()
            .any(|name| format.starts_with(name));
        is_yuv && self.color_range.as_deref() != Some("pc")
    }

    /// Returns the colour matrix. A video that does not state it is BT.709 from 720 lines on, and BT.601 below, as players take it.
    fn matrix(&self, lines: u32) -> &'static str {
        match self.color_space.as_deref() {
            Some("bt709") => "bt709",
            Some("bt470bg" | "smpte170m") => "bt601",
            Some("bt2020nc" | "bt2020c") => "bt2020",
            Some("smpte240m") => "smpte240m",
            _ if lines >= 720 => "bt709",
            _ => "bt601",
        }
    }
}

/// Returns true if the index of an MP4 file has the sample entry `encv` (ISO 14496-12, 8.12), under which ffprobe shows the codec as if nothing were encrypted.
fn is_encrypted_mp4(path: &Path) -> bool {
    index_of_mp4(path).is_ok_and(|index| memchr::memmem::find(&index, b"encv").is_some())
}

/// Returns the content of an MP4 file's box `moov`, up to a length; nothing of another file.
fn index_of_mp4(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    for _ in 0..MOST_BOXES {
        let mut head = [0; 8];
        file.read_exact(&mut head)?;
        let (length, kind) = head.split_at(4);
        let length = length.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
        if kind == b"moov" {
            let mut index = Vec::new();
            file.take(length.min(MOST_INDEX)).read_to_end(&mut index)?;
            return Ok(index);
        }
        let rest = match length {
            1 => {
                let mut long = [0; 8];
                file.read_exact(&mut long)?;
                u64::from_be_bytes(long).saturating_sub(16)
            }
            _ => length.saturating_sub(8),
        };
        // Length 0 reaches to the end of the file.
        if length == 0 {
            break;
        }
        file.seek_relative(i64::try_from(rest).unwrap_or(i64::MAX))?;
    }
    Ok(Vec::new())
}

/// Asks ffprobe for a description.
fn described(input: &Input) -> Result<Description, VideoError> {
    let mut command = command("ffprobe", &input.name)?;
    input.feed(&mut command)?;
    command
        .args([
            "-hide_banner",
            "-v",
            "level+info",
            "-of",
            "json",
            "-show_streams",
            "-show_format",
        ])
        .args(&input.arguments);
    let mut running = Running::start(command, "ffprobe", &input.name)?.bounded(input.most_memory.map(|most| most / 4));
    let answer = drain(running.0.stdout.take(), MOST_SAID);
    let complaint = drain(running.0.stderr.take(), MOST_SAID);
    let name = input.name.clone();
    let Some(is_done) = running.ended_well(PROBED_WITHIN) else {
        let waited_s = PROBED_WITHIN.as_secs_f64();
        return Err(VideoError::Silent { name, waited_s });
    };
    let (Some(answer), Some(complaint)) = (answer.whole(), complaint.whole()) else {
        let waited_s = LEFT_BEHIND.as_secs_f64();
        return Err(VideoError::Silent { name, waited_s });
    };
    let complaint = String::from_utf8_lossy(&complaint);
    // A file names no other address.
    if input.file.is_none() && sends_elsewhere(&complaint) {
        let reason = ELSEWHERE.to_owned();
        return Err(VideoError::NotAVideo { reason, name });
    }
    let reason = || last_words(&complaint, &name);
    match serde_json::from_slice(&answer) {
        Ok(description) if is_done => Ok(description),
        _ => Err(VideoError::NotAVideo { reason: reason(), name }),
    }
}
