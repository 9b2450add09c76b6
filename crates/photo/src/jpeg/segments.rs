//! The segments of a JPEG file (ITU-T T.81, annex B), without its pixels.

use super::error::JpegError;

/// Marker with its content.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment<'a> {
    pub marker: u8,
    /// Content after the length.
    pub content: &'a [u8],
    /// Entropy-coded data after the header of a scan, restart markers included; empty for other segments.
    pub data: &'a [u8],
}

pub(super) const START_OF_SCAN: u8 = 0xDA;
const END_OF_IMAGE: u8 = 0xD9;
const RESTARTS: std::ops::RangeInclusive<u8> = 0xD0..=0xD7;
/// TEM, which has no content either.
const TEMPORARY: u8 = 0x01;

/// Iterator over the segments up to the end-of-image marker, or to the end of the bytes after a scan's data; an error if they end in a header.
///
/// Segments are skipped by their length, so the thumbnail inside the EXIF segment cannot be mistaken for the end; bytes after the end (motion photos,
/// depth maps) are ignored.
pub(super) struct Segments<'a> {
    bytes: &'a [u8],
    at: usize,
    /// True if the data of a scan reaches the end of the bytes without an end-of-image marker.
    pub lacks_end: bool,
}

impl<'a> Segments<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Segments<'a> {
        // After the start-of-image marker.
        Segments {
            bytes,
            at: 2,
            lacks_end: false,
        }
    }

    /// Returns the next segment; `Some(None)` at the end of the image, `None` at the end of the bytes.
    fn step(&mut self) -> Option<Option<Segment<'a>>> {
        if self.lacks_end {
            return Some(None);
        }
        loop {
            // 0xFF followed by neither a stuffed zero nor another fill byte.
            let marker_at = find_pair(self.bytes, self.at, |second| !matches!(second, 0x00 | 0xFF))?;
            let marker = self.bytes[marker_at + 1];
            self.at = marker_at + 2;
            match marker {
                END_OF_IMAGE => return Some(None),
                TEMPORARY => continue,
                _ if RESTARTS.contains(&marker) => continue,
                _ => {}
            }
            let length = u16::from_be_bytes(*self.bytes.get(self.at..)?.first_chunk()?);
            let end = self.at + usize::from(length).max(2);
            let content = self.bytes.get(self.at + 2..end)?;
            self.at = end;
            let mut data: &[u8] = &[];
            if marker == START_OF_SCAN {
                // The data ends at the next marker other than a restart marker.
                let ends = |second: u8| !matches!(second, 0x00 | 0xFF) && !RESTARTS.contains(&second);
                let marker_at = find_pair(self.bytes, end, ends);
                self.lacks_end = marker_at.is_none();
                self.at = marker_at.unwrap_or(self.bytes.len());
                data = &self.bytes[end..self.at];
            }
            return Some(Some(Segment { marker, content, data }));
        }
    }
}

impl<'a> Iterator for Segments<'a> {
    type Item = Result<Segment<'a>, JpegError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.step().ok_or(JpegError::Truncated).transpose()
    }
}

/// Returns the index of the next 0xFF whose successor satisfies `is_second`.
fn find_pair(bytes: &[u8], from: usize, is_second: impl Fn(u8) -> bool) -> Option<usize> {
    let mut at = from;
    loop {
        at += memchr::memchr(0xFF, bytes.get(at..)?)?;
        if is_second(*bytes.get(at + 1)?) {
            return Some(at);
        }
        at += 1;
    }
}

/// Iterator over the intervals of entropy-coded data between restart markers, without stuffed zeros.
pub(super) struct Intervals<'a> {
    rest: &'a [u8],
    /// Number of the next restart marker, 0 to 7.
    next: u8,
}

impl<'a> Intervals<'a> {
    pub(super) fn new(data: &'a [u8]) -> Intervals<'a> {
        Intervals { rest: data, next: 0 }
    }

    /// Returns true if no interval follows.
    pub(super) fn is_over(&self) -> bool {
        self.rest.is_empty()
    }

    /// Fills `interval` with the bytes up to the next restart marker; returns false if that marker is out of order.
    pub(super) fn read(&mut self, interval: &mut Vec<u8>) -> bool {
        interval.clear();
        loop {
            let Some(at) = memchr::memchr(0xFF, self.rest) else {
                interval.extend_from_slice(self.rest);
                self.rest = &[];
                return true;
            };
            let (before, from) = self.rest.split_at(at);
            interval.extend_from_slice(before);
            match from.get(1) {
                Some(0x00) => {
                    interval.push(0xFF);
                    self.rest = &from[2..];
                }
                Some(marker) if RESTARTS.contains(marker) => {
                    let is_next = *marker == RESTARTS.start() + self.next;
                    self.next = (self.next + 1) % 8;
                    self.rest = &from[2..];
                    return is_next;
                }
                // A fill byte.
                _ => self.rest = &from[1..],
            }
        }
    }
}
