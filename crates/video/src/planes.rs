//! Pictures as the decoder leaves them: their luma, and the planes from which colours can be computed later without decoding the video again.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::io::Write;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use image::{GrayImage, ImageBuffer, RgbImage};

use crate::frames::{Filter, images, widen};
use crate::program::{Running, command, drain, every_frame_option};
use crate::{Frame, Frames, Pixels, Selection, Video, VideoError};
use scaleproof_core::message::message;
use scaleproof_photo::{Luma, mean_squares};

/// A conversion takes some 50 ms a frame.
const CONVERTED_WITHIN: Duration = Duration::from_secs(60);
/// More than ffmpeg says of a conversion.
const MOST_SAID: u64 = 1 << 16;

/// A decoded picture, luma and colours. Copies share their memory.
#[derive(Debug, Clone)]
pub struct Planes(Arc<Vec<u8>>);

impl Planes {
    /// Returns the number of bytes of the picture.
    pub fn length(&self) -> usize {
        self.0.len()
    }
}

/// A picture to look at. Its luma, from black (0) to white (255), is made where somebody looks.
#[derive(Debug)]
pub struct Picture {
    size: [u32; 2],
    planes: Option<Planes>,
    whole: OnceCell<GrayImage>,
}

/// Every so-manieth row is compared.
const COMPARED: usize = 4;

impl Picture {
    /// Returns the planes from which its colours are computed; `None` where only decoding again gives them.
    pub fn planes(&self) -> Option<&Planes> {
        self.planes.as_ref()
    }

    /// Returns the mean absolute difference to the luma of another one, levels; `None` for one of another size.
    pub fn difference(&self, other: &Picture) -> Option<f64> {
        let width = self.size[0] as usize;
        let [one, its] = [self.levels(), other.levels()];
        if self.size != other.size || one.len() != its.len() || one.is_empty() {
            return None;
        }
        let rows = one.chunks_exact(width).zip(its.chunks_exact(width)).step_by(COMPARED);
        let (mut sum, mut count) = (0, 0);
        for (a, b) in rows {
            sum += u64::from(a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>());
            count += width;
        }
        let level = if self.planes.is_some() { 255.0 / 219.0 } else { 1.0 };
        Some(level * sum as f64 / count as f64)
    }

    /// Levels as they are stored: those of planes go from 16 to 235.
    fn levels(&self) -> &[u8] {
        match (&self.planes, self.whole.get()) {
            (Some(planes), _) => planes.0.get(..GrayImage::length(self.size)).unwrap_or_default(),
            (None, luma) => luma.map(|luma| luma.as_raw().as_slice()).unwrap_or_default(),
        }
    }

    fn of_luma(luma: GrayImage) -> Picture {
        Picture {
            size: luma.dimensions().into(),
            planes: None,
            whole: OnceCell::from(luma),
        }
    }
}

impl Luma for Picture {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn whole(&self) -> &GrayImage {
        self.whole.get_or_init(|| self.part([0, 0], self.size))
    }

    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage> {
        let [width, height] = self.size;
        match (self.whole.get(), ImageBuffer::from_raw(width, height, self.levels())) {
            (None, Some(levels)) if factor > 1 => {
                let mut reduced = mean_squares(&levels, factor);
                widen(&mut reduced);
                Cow::Owned(reduced)
            }
            _ => self.whole().reduced(factor),
        }
    }

    fn part(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> GrayImage {
        if let Some(whole) = self.whole.get() {
            return whole.part([x, y], [width, height]);
        }
        let [from, to] = [x, x + width].map(|v| v as usize);
        let rows = self.levels().chunks_exact((self.size[0] as usize).max(1));
        let mut part = Vec::with_capacity(width as usize * height as usize);
        for row in rows.skip(y as usize).take(height as usize) {
            part.extend_from_slice(&row[from..to]);
        }
        widen(&mut part);
        GrayImage::from_raw(width, height, part).unwrap_or_default()
    }
}

impl Pixels for Picture {
    const FORMAT: &'static str = "yuv420p";
    fn length([width, height]: [u32; 2]) -> usize {
        GrayImage::length([width, height]) + 2 * GrayImage::length([width.div_ceil(2), height.div_ceil(2)])
    }
    fn from_bytes(size: [u32; 2], bytes: Vec<u8>) -> Option<Picture> {
        (bytes.len() == Picture::length(size)).then(|| Picture {
            size,
            planes: Some(Planes(Arc::new(bytes))),
            whole: OnceCell::new(),
        })
    }
}

/// Pictures of a video, one after another.
pub enum Pictures {
    /// Pictures with the planes of their colours.
    Whole(Frames<Picture>),
    /// Without.
    Luma(Frames<GrayImage>),
}

impl Iterator for Pictures {
    type Item = Result<Frame<Picture>, VideoError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Pictures::Whole(frames) => frames.next(),
            Pictures::Luma(frames) => Some(frames.next()?.map(|frame| Frame {
                number: frame.number,
                time_s: frame.time_s,
                key: frame.key,
                image: Picture::of_luma(frame.image),
            })),
        }
    }
}

impl Video {
    /// Pictures at full size: their luma as [`Video::luma`] gives it, and what [`Video::colours`] needs where the video stores its pictures in the usual way (8 bits, 4:2:0).
    ///
    /// # Errors
    /// As [`Video::luma`].
    pub fn pictures(&self, selection: &Selection) -> Result<Pictures, VideoError> {
        if !self.has_planes || selection.height.is_some() {
            return Ok(Pictures::Luma(self.luma(selection)?));
        }
        let as_decoded = Filter {
            frames: None,
            is_limited: false,
        };
        Ok(Pictures::Whole(Frames::start(self, selection, as_decoded)?))
    }

    /// Converts such pictures to colours, in their order: the same as [`Video::rgb`] gives.
    ///
    /// # Errors
    /// No ffmpeg.
    pub fn colours(&self, pictures: Vec<Planes>) -> Result<Colours, VideoError> {
        let name = self.input.name.clone();
        let mut command = command("ffmpeg", &name)?;
        command
            .args(["-nostdin", "-hide_banner", "-nostats", "-loglevel", "error"])
            .args(["-f", "rawvideo", "-pixel_format", Picture::FORMAT, "-video_size"])
            .arg(format!("{}x{}", self.width, self.height))
            .args(["-i", "pipe:0", "-vf", &self.scaled(&Selection::default())])
            .args([every_frame_option(), "passthrough", "-pix_fmt", RgbImage::FORMAT])
            .args(["-f", "rawvideo", "pipe:1"])
            .stdin(Stdio::piped());
        let mut running = Running::start(command, "ffmpeg", &name)?;
        let left = pictures.len();
        let pipes = running.0.stdin.take().zip(running.0.stdout.take());
        let Some((mut stdin, stdout)) = pipes else {
            return Err(VideoError::not_started(&name, "ffmpeg", "it has no input or output"));
        };
        drain(running.0.stderr.take(), MOST_SAID);
        // Ends when all are written, or when ffmpeg is ended.
        std::thread::spawn(move || pictures.iter().try_for_each(|picture| stdin.write_all(&picture.0)));
        Ok(Colours {
            images: images(stdout, [self.width, self.height], false),
            running,
            name,
            left,
        })
    }
}

/// Colours as ffmpeg converts them. It is ended when this is dropped.
pub struct Colours {
    images: Receiver<RgbImage>,
    #[expect(dead_code, reason = "ends ffmpeg when it is dropped")]
    running: Running,
    name: String,
    left: usize,
}

impl Iterator for Colours {
    type Item = Result<RgbImage, VideoError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let image = self.images.recv_timeout(CONVERTED_WITHIN);
        if image.is_err() {
            self.left = 0;
        }
        let name = &self.name;
        Some(image.map_err(|_| message!("ffmpeg gave no colours of frames of {name}: call this again").into()))
    }
}
