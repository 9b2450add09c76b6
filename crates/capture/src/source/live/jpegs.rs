//! JPEG files one behind the other in a stream of bytes, as ffmpeg's `mjpeg` writes them.

use std::io::{self, Read};

/// No image of a network camera has more bytes.
const MOST_BYTES: usize = 32 << 20;
const READ: usize = 64 << 10;

const START: u8 = 0xD8;
const END: u8 = 0xD9;
const SCAN: u8 = 0xDA;

/// Iterator over the JPEG files of a stream, byte for byte (ITU-T T.81, annex B). Bytes between them, and a file that is broken off, are left
/// out. It holds one image and what was read behind it.
pub struct Jpegs<R> {
    from: R,
    held: Vec<u8>,
}

/// Continuation of a JPEG at a place.
enum Step {
    /// The next marker is at that place.
    To(usize),
    /// It ends before that place.
    End(usize),
    /// No JPEG goes on here, or the stream ends.
    Broken,
}

impl<R: Read> Jpegs<R> {
    pub fn new(from: R) -> Jpegs<R> {
        Jpegs { from, held: Vec::new() }
    }

    /// Waits for the next whole image; `None` at the end of the stream.
    ///
    /// # Errors
    /// The stream cannot be read, or has no JPEG within 32 MB.
    pub fn next_jpeg(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut left_out = 0;
        while left_out < MOST_BYTES {
            match self.start()? {
                None => return Ok(None),
                Some(skipped) => left_out += skipped,
            }
            let mut at = 2;
            loop {
                match self.step(at)? {
                    Step::To(next) => at = next,
                    Step::End(end) => {
                        let behind = self.held.split_off(end);
                        return Ok(Some(std::mem::replace(&mut self.held, behind)));
                    }
                    Step::Broken => break,
                }
            }
            // Another may begin within what was taken for this one.
            self.held.drain(..2);
            left_out += at;
        }
        Err(io::Error::other("what it sends is no JPEG"))
    }

    /// Moves the next image to the beginning of the buffer; returns the number of bytes before it. `None` at the end of the stream.
    fn start(&mut self) -> io::Result<Option<usize>> {
        let mut skipped = 0;
        loop {
            if let Some(at) = self.held.windows(3).position(|bytes| bytes == [0xFF, START, 0xFF]) {
                self.held.drain(..at);
                return Ok(Some(skipped + at));
            }
            let useless = self.held.len().saturating_sub(2);
            self.held.drain(..useless);
            skipped += useless;
            if skipped > MOST_BYTES {
                return Err(io::Error::other("what it sends is no JPEG"));
            }
            if !self.more()? {
                return Ok(None);
            }
        }
    }

    /// Steps from a marker to the next.
    fn step(&mut self, at: usize) -> io::Result<Step> {
        if at > MOST_BYTES {
            return Ok(Step::Broken);
        }
        if !self.has(at + 2)? {
            return Ok(Step::Broken);
        }
        match [self.held[at], self.held[at + 1]] {
            [0xFF, END] => Ok(Step::End(at + 2)),
            // A marker may have any number of these before it.
            [0xFF, 0xFF] => Ok(Step::To(at + 1)),
            // Nothing else may stand alone before the pixels; 0xD0 to 0xD7 stand within them.
            [0xFF, 0xC0..=0xFE] if self.held[at + 1] != START && !matches!(self.held[at + 1], 0xD0..=0xD7) => {
                if !self.has(at + 4)? {
                    return Ok(Step::Broken);
                }
                let length = usize::from(u16::from_be_bytes([self.held[at + 2], self.held[at + 3]]));
                match (self.held[at + 1], length) {
                    (_, 0 | 1) => Ok(Step::Broken),
                    (SCAN, _) => self.pixels(at + 2 + length),
                    _ => Ok(Step::To(at + 2 + length)),
                }
            }
            _ => Ok(Step::Broken),
        }
    }

    /// Steps from the data of a scan to the marker behind it: in the data 0xFF is followed by 0 or a restart marker.
    fn pixels(&mut self, mut at: usize) -> io::Result<Step> {
        while at <= MOST_BYTES {
            let seen = self.held.get(at..).unwrap_or_default();
            let marker = seen
                .windows(2)
                .position(|pair| pair[0] == 0xFF && !matches!(pair[1], 0 | 0xD0..=0xD7 | 0xFF));
            if let Some(behind) = marker {
                return Ok(Step::To(at + behind));
            }
            at += seen.len().saturating_sub(1);
            if !self.more()? {
                return Ok(Step::Broken);
            }
        }
        Ok(Step::Broken)
    }

    fn has(&mut self, length: usize) -> io::Result<bool> {
        while self.held.len() < length {
            if !self.more()? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Reads on; returns false at the end of the stream.
    fn more(&mut self) -> io::Result<bool> {
        let before = self.held.len();
        self.held.resize(before + READ, 0);
        let count = loop {
            match self.from.read(&mut self.held[before..]) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        self.held.truncate(before + count.as_ref().copied().unwrap_or(0));
        Ok(count? > 0)
    }
}
