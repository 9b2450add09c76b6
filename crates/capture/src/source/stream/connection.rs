//! One connection to a camera that streams, by ffmpeg.

use std::ffi::OsString;
use std::process::{ChildStdout, Command};
use std::sync::OnceLock;
use std::time::Duration;

use image::RgbImage;

use super::address::{StreamAddress, StreamScheme};
use crate::source::live::{Jpegs, PixelFormat, RawImage, jpeg_size};
use crate::source::programs::{RunningProgram, is_there};
use scaleproof_video::{Frames, Input, Selection, Video, VideoError};

/// Time without data after which a camera counts as gone.
const SILENCE: Duration = Duration::from_secs(5);

/// ffmpeg takes 0.3 GB of addresses, of which most is its own code. Of an image that says that it is larger it would hold as much as is sent.
const MOST_MEMORY: u64 = 1 << 30;

/// One connection to a camera that streams.
pub trait Connection {
    /// Waits for the next image.
    ///
    /// # Errors
    /// A clause: why there will be no more.
    fn image(&mut self) -> Result<RawImage, String>;

    /// Returns the name of its codec, such as `motion JPEG` or `h264`.
    fn described(&self) -> String;
}

/// Connects by a scheme.
///
/// # Errors
/// A clause: why not.
pub(super) fn connect(address: &StreamAddress, scheme: StreamScheme) -> Result<Box<dyn Connection>, String> {
    match scheme {
        StreamScheme::Http => Ok(Box::new(MotionJpeg::connect(address)?)),
        StreamScheme::Rtsp => Ok(Box::new(Rtsp::connect(address)?)),
    }
}

/// Motion JPEG over HTTP, unpacked and not decoded.
struct MotionJpeg {
    address: StreamAddress,
    jpegs: Jpegs<ChildStdout>,
    program: RunningProgram,
}

impl MotionJpeg {
    fn connect(address: &StreamAddress) -> Result<MotionJpeg, String> {
        if !is_there("ffmpeg") {
            return Err(
                "streams are read with ffmpeg, and this system has none: install it (Debian: apt install ffmpeg)"
                    .into(),
            );
        }
        let silence = SILENCE.as_micros().to_string();
        let mut command = Command::new("ffmpeg");
        command
            .args(["-nostdin", "-hide_banner", "-loglevel", "error"])
            .args(["-protocol_whitelist", "http,tcp", "-rw_timeout", &silence])
            // Only the address that was given is asked.
            .args(["-max_redirects", "0"])
            // Without this it would wait for some images to find out how many come a second.
            .args(["-analyzeduration", "0", "-fflags", "nobuffer", "-f", "mpjpeg", "-i"])
            .arg(address.secret())
            .args([
                "-map",
                "0:v:0",
                "-c",
                "copy",
                "-flush_packets",
                "1",
                "-f",
                "mjpeg",
                "pipe:1",
            ]);
        let started = RunningProgram::start(&mut command);
        let (program, stdout) = started.map_err(|e| format!("ffmpeg could not be started: {e}"))?;
        program.bound_memory(MOST_MEMORY);
        Ok(MotionJpeg {
            address: address.clone(),
            jpegs: Jpegs::new(stdout),
            program,
        })
    }

    /// Returns the reason why it has ended, from ffmpeg's messages.
    fn reason(&mut self) -> String {
        self.program.ended_within(Duration::from_secs(1));
        let said = self.address.without_secrets(&self.program.said());
        let last = said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default();
        // Its versions differ in what they say before the reason.
        match last.rsplit(": ").next().unwrap_or(last).trim() {
            "" => "the camera closed it".into(),
            // What ffmpeg says at its end depends on where the memory was missing.
            _ if said.contains("Cannot allocate memory") => "it sends an image of more than 32 MB".into(),
            "Invalid data found when processing input" | "End of file" => "it sent no motion JPEG".into(),
            last => last.to_owned(),
        }
    }
}

impl Connection for MotionJpeg {
    fn image(&mut self) -> Result<RawImage, String> {
        let bytes = match self.jpegs.next_jpeg() {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return Err(self.reason()),
            Err(e) => return Err(e.to_string()),
        };
        let [width, height] = jpeg_size(&bytes).ok_or("one of its images is damaged")?;
        Ok(RawImage {
            format: PixelFormat::Mjpeg,
            width,
            height,
            bytes,
        })
    }

    fn described(&self) -> String {
        "motion JPEG".into()
    }
}

/// RTSP, over TCP: lost packets of UDP would leave smeared images, which look like photos.
struct Rtsp {
    address: StreamAddress,
    codec: String,
    frames: Frames<RgbImage>,
}

impl Rtsp {
    fn connect(address: &StreamAddress) -> Result<Rtsp, String> {
        let silence = SILENCE.as_micros().to_string();
        let arguments = [
            "-protocol_whitelist",
            "rtsp,tcp",
            "-rtsp_transport",
            "tcp",
            silence_option(),
            &silence,
            "-allowed_media_types",
            "video",
            "-fflags",
            "+nobuffer+discardcorrupt",
            // Enough for the size; the default looks for other streams for five seconds.
            "-analyzeduration",
            "500000",
            "-f",
            "rtsp",
            "-i",
            address.secret(),
        ];
        let input = Input::other(address.to_string(), arguments.map(OsString::from).into());
        let told = |e: VideoError| address.without_secrets(&reason(&e));
        let video = Video::of(input).map_err(told)?;
        let selection = Selection {
            patience: SILENCE,
            is_whole: false,
            ..Selection::default()
        };
        Ok(Rtsp {
            address: address.clone(),
            frames: video.rgb(&selection).map_err(told)?,
            codec: video.codec,
        })
    }
}

impl Connection for Rtsp {
    fn image(&mut self) -> Result<RawImage, String> {
        let image = match self.frames.next() {
            Some(Ok(frame)) => frame.image,
            Some(Err(e)) => return Err(self.address.without_secrets(&reason(&e))),
            None => return Err("the camera closed it".into()),
        };
        Ok(RawImage {
            format: PixelFormat::Rgb,
            width: image.width(),
            height: image.height(),
            bytes: image.into_raw(),
        })
    }

    fn described(&self) -> String {
        self.codec.clone()
    }
}

/// Returns the reason of an error as a clause, in words about a stream instead of a file.
fn reason(e: &VideoError) -> String {
    match e {
        VideoError::NotAVideo { reason, .. } | VideoError::Damaged { reason, .. } => reason.clone(),
        VideoError::NoFrames { .. } => "it has no image that can be shown".into(),
        VideoError::NoPicture { .. } => "it has sound and no picture".into(),
        VideoError::Silent { waited_s, .. } => format!("none came for {waited_s:.0} s"),
        e => e.to_string(),
    }
}

/// Returns the option of ffmpeg's RTSP reader after how many microseconds of silence it gives up: `-timeout` since ffmpeg 5, `-stimeout` before, when
/// `-timeout` let it wait for a camera that calls.
fn silence_option() -> &'static str {
    static OPTION: OnceLock<&str> = OnceLock::new();
    OPTION.get_or_init(|| {
        let help = Command::new("ffmpeg")
            .args(["-hide_banner", "-h", "demuxer=rtsp"])
            .output();
        let is_old = help.is_ok_and(|help| String::from_utf8_lossy(&help.stdout).contains("-stimeout"));
        if is_old { "-stimeout" } else { "-timeout" }
    })
}
