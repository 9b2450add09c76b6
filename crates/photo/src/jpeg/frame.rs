//! Headers of a JPEG (ITU-T T.81, annex B; JFIF 1.02; Adobe technical note 5116), and the subset this reader supports.

use super::error::JpegError;
use super::segments::{START_OF_SCAN, Segment, Segments};

/// Header of a file's first image.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    pub size: [u32; 2],
    pub is_progressive: bool,
    pub components: Vec<FrameComponent>,
    /// Number of start-of-scan markers.
    pub scans: u64,
    pub colours: Colours,
    /// True if no end-of-image marker follows the data, which may be truncated or complete.
    pub lacks_end: bool,
    /// EXIF data after the identifier "Exif".
    pub exif: Option<Vec<u8>>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct FrameComponent {
    pub id: u8,
    /// Horizontal and vertical sampling factor, relative to the coarsest component, 1 to 4.
    pub sampling: [u32; 2],
    pub table: u8,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Colours {
    Grey,
    /// Luma and two differences (ITU-T T.871).
    YCbCr,
    Rgb,
    /// CMYK, inverted, as Adobe's programs store it.
    Cmyk,
    /// Inverted CMYK, as Adobe's programs store it, with C, M, Y as YCbCr.
    Ycck,
}

const EXIF: u8 = 0xE1;
const ADOBE: u8 = 0xEE;
const JFIF: u8 = 0xE0;

/// Start-of-frame markers, and those of DHT, JPG and DAC within their range.
const FRAMES: std::ops::RangeInclusive<u8> = 0xC0..=0xCF;
const NO_FRAMES: [u8; 3] = [0xC4, 0xC8, 0xCC];

impl Frame {
    /// Reads the headers up to the end of the image, without its data.
    pub(crate) fn read(bytes: &[u8]) -> Result<Frame, JpegError> {
        let (mut frame, mut scans, mut exif) = (None, 0, None);
        let (mut adobe, mut is_jfif) = (None, false);
        let mut segments = Segments::new(bytes);
        for segment in &mut segments {
            let Segment { marker, content, .. } = segment?;
            match marker {
                START_OF_SCAN => scans += 1,
                EXIF if exif.is_none() => exif = content.strip_prefix(b"Exif\0\0").map(<[u8]>::to_vec),
                JFIF => is_jfif |= content.starts_with(b"JFIF\0"),
                ADOBE if content.starts_with(b"Adobe") => adobe = content.get(11).copied().or(adobe),
                _ if !FRAMES.contains(&marker) || NO_FRAMES.contains(&marker) => {}
                _ if frame.is_none() => frame = Some(header(marker, content)?),
                _ => return Err(JpegError::Damaged("it has two headers")),
            }
        }
        let (size, is_progressive, components) = frame.ok_or(JpegError::Damaged("it has no header"))?;
        let colours = colours(&components, adobe, is_jfif)?;
        Ok(Frame {
            size,
            is_progressive,
            components,
            scans,
            colours,
            lacks_end: segments.lacks_end,
            exif,
        })
    }

    pub(super) fn most_sampling(&self) -> [u32; 2] {
        most_sampling(&self.components)
    }
}

/// Size, whether it is progressive, and the components.
type FrameHeader = ([u32; 2], bool, Vec<FrameComponent>);

fn header(marker: u8, content: &[u8]) -> Result<FrameHeader, JpegError> {
    let other = match marker {
        0xC0..=0xC2 => None,
        0xC9..=0xCB | 0xCD..=0xCF => Some("it is arithmetic-coded, which no camera writes"),
        _ => Some("it is lossless or of layers, which no camera writes"),
    };
    if let Some(other) = other {
        return Err(JpegError::Damaged(other));
    }
    let [precision, h1, h0, w1, w0, count] = *content.first_chunk().ok_or(SHORT)?;
    if precision != 8 {
        return Err(JpegError::Damaged("its samples have other than 8 bits"));
    }
    let size = [[w1, w0], [h1, h0]].map(|side| u32::from(u16::from_be_bytes(side)));
    if size.contains(&0) {
        return Err(JpegError::Damaged("it has no size"));
    }
    let listed = content.get(6..6 + 3 * usize::from(count)).ok_or(SHORT)?;
    let component = |[id, sampling, table]: &[u8; 3]| FrameComponent {
        id: *id,
        sampling: [u32::from(sampling >> 4), u32::from(sampling & 15)],
        table: *table,
    };
    let components: Vec<FrameComponent> = listed.as_chunks().0.iter().map(component).collect();
    let is_sound = |c: &FrameComponent| c.sampling.iter().all(|s| (1..=4).contains(s)) && c.table < 4;
    if !components.iter().all(is_sound) {
        return Err(JpegError::Damaged("its header contradicts itself"));
    }
    let most = most_sampling(&components);
    let is_whole = |c: &FrameComponent| (0..2).all(|i| most[i].is_multiple_of(c.sampling[i]));
    if !components.iter().all(is_whole) {
        // T.81 allows it, and neither libjpeg nor any camera does.
        return Err(JpegError::Damaged(
            "its components are sampled at fractions of each other",
        ));
    }
    Ok((size, marker == 0xC2, components))
}

/// Returns the largest sampling factors, horizontal and vertical.
fn most_sampling(components: &[FrameComponent]) -> [u32; 2] {
    [0, 1].map(|i| components.iter().map(|c| c.sampling[i]).max().unwrap_or(1))
}

const SHORT: JpegError = JpegError::Damaged("a segment is too short");

fn colours(components: &[FrameComponent], adobe: Option<u8>, is_jfif: bool) -> Result<Colours, JpegError> {
    let ids: Vec<u8> = components.iter().map(|c| c.id).collect();
    Ok(match (components.len(), adobe) {
        (1, _) => Colours::Grey,
        (3, Some(0)) => Colours::Rgb,
        (3, None) if ids == *b"RGB" && !is_jfif => Colours::Rgb,
        (3, _) => Colours::YCbCr,
        (4, Some(2)) => Colours::Ycck,
        (4, _) => Colours::Cmyk,
        _ => return Err(JpegError::Damaged("it has neither one nor three nor four components")),
    })
}
