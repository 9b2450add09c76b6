//! Reading of a file's bytes into coefficients.

use super::coefficients::Component;
use super::error::JpegError;
use super::frame::{Colours, Frame};
use super::huffman::HuffmanTable;
use super::scan::{self, Part, Scan, ScanComponent};
use super::segments::{START_OF_SCAN, Segment, Segments};
use super::standard;

#[derive(Debug)]
pub(crate) struct Coefficients {
    pub(super) size: [u32; 2],
    /// Largest sampling factors, horizontal and vertical.
    pub(super) most_sampling: [u32; 2],
    pub(super) colours: Colours,
    pub(super) components: Vec<Component>,
}

const QUANTIZATION: u8 = 0xDB;
const HUFFMAN: u8 = 0xC4;
const RESTART_INTERVAL: u8 = 0xDD;

const SHORT: JpegError = JpegError::Damaged("a segment is too short");
const WRONG_TABLE: JpegError = JpegError::Damaged("invalid Huffman or quantisation table");
const WRONG_SCAN: JpegError = JpegError::Damaged("a scan's header cannot be");
const NO_DATA: JpegError = JpegError::Damaged("it has no data for one of its colours");

#[derive(Default)]
struct Tables {
    quantisation: [Option<[u16; 64]>; 4],
    dc: [Option<HuffmanTable>; 4],
    ac: [Option<HuffmanTable>; 4],
    /// True if any Huffman table was read.
    has_codes: bool,
    restart_interval: usize,
}

impl Coefficients {
    /// Reads the data of a file whose header was read before; `most_bytes` may be used in addition to the memory implied by its size.
    pub(crate) fn read(bytes: &[u8], frame: &Frame, most_bytes: u64) -> Result<Coefficients, JpegError> {
        let most_sampling = frame.most_sampling();
        // A scan's header names the components behind their number.
        let is_sparse = !frame.is_progressive && frame.scans == 1;
        let mut all = Coefficients {
            size: frame.size,
            most_sampling,
            colours: frame.colours,
            components: components(frame, is_sparse.then_some(bytes.len())),
        };
        // Per component: two bytes per value, and twice as many while the buffer grows.
        let most_values = usize::try_from(most_bytes / 6 / frame.components.len().max(1) as u64)
            .unwrap_or(usize::MAX)
            .min(u32::MAX as usize / 2);
        let mut tables = Tables::default();
        let mut is_read = vec![false; frame.components.len()];
        // Per component and place: the number of its lowest bits that no scan has provided yet.
        let mut missing_bits = vec![[u32::MAX; 64]; frame.components.len()];
        for segment in Segments::new(bytes) {
            let Segment { marker, content, data } = segment?;
            match marker {
                QUANTIZATION => tables.read_quantisation(content)?,
                HUFFMAN => tables.read_codes(content)?,
                RESTART_INTERVAL => {
                    tables.restart_interval = u16::from_be_bytes(*content.first_chunk().ok_or(SHORT)?).into();
                }
                START_OF_SCAN => {
                    if !frame.is_progressive && !tables.has_codes {
                        // Motion JPEG omits the tables common to all of its images.
                        standard::tables()
                            .iter()
                            .try_for_each(|content| tables.read_codes(content))?;
                    }
                    let scan = tables.scan(content, frame, most_values)?;
                    for (index, ..) in &scan.components {
                        let table = usize::from(frame.components[*index].table);
                        if !std::mem::replace(&mut is_read[*index], true) {
                            all.components[*index].steps = tables.quantisation[table].ok_or(WRONG_TABLE)?;
                        }
                        let (places, low) = scan.part.places();
                        missing_bits[*index][places].fill(low);
                    }
                    scan::decode(&scan, data, &mut all.components)?;
                }
                _ => {}
            }
        }
        let is_whole = || missing_bits.iter().flatten().all(|bits| *bits == 0);
        if !is_read.iter().all(|is_read| *is_read) {
            Err(NO_DATA)
        } else if frame.lacks_end && !is_whole() {
            Err(JpegError::Truncated)
        } else {
            Ok(all)
        }
    }
}

/// Returns empty components with room estimated from the file's bytes, divided by their number of samples: a value of two bytes mostly takes four
/// bits or more of data.
fn components(frame: &Frame, bytes: Option<usize>) -> Vec<Component> {
    let most = frame.most_sampling();
    let groups = groups(frame);
    let all: u32 = frame.components.iter().map(|c| c.sampling[0] * c.sampling[1]).sum();
    let made = frame.components.iter().map(|c| {
        let size = [0, 1].map(|i| (frame.size[i] * c.sampling[i]).div_ceil(most[i]) as usize);
        let blocks = [0, 1].map(|i| groups[i] * c.sampling[i] as usize);
        let room = bytes.map(|bytes| 2 * bytes * (c.sampling[0] * c.sampling[1]) as usize / all.max(1) as usize);
        Component::new(c.sampling, blocks, size, room)
    });
    made.collect()
}

fn groups(frame: &Frame) -> [usize; 2] {
    let most = frame.most_sampling();
    [0, 1].map(|i| frame.size[i].div_ceil(8 * most[i]) as usize)
}

impl Tables {
    /// Reads quantization tables: DQT (B.2.4.1).
    fn read_quantisation(&mut self, mut content: &[u8]) -> Result<(), JpegError> {
        while let Some((head, rest)) = content.split_first() {
            let bytes = if head >> 4 == 0 { 64 } else { 128 };
            let (steps, rest) = rest.split_at_checked(bytes).ok_or(SHORT)?;
            let to = self.quantisation.get_mut(usize::from(head & 15)).ok_or(WRONG_TABLE)?;
            *to = Some(std::array::from_fn(|i| match bytes {
                64 => steps[i].into(),
                _ => u16::from_be_bytes([steps[2 * i], steps[2 * i + 1]]),
            }));
            content = rest;
        }
        Ok(())
    }

    /// Reads Huffman tables: DHT (B.2.4.2).
    fn read_codes(&mut self, mut content: &[u8]) -> Result<(), JpegError> {
        while let Some((head, rest)) = content.split_first() {
            let counts: &[u8; 16] = rest.first_chunk().ok_or(SHORT)?;
            let count = counts.iter().map(|n| usize::from(*n)).sum();
            let (symbols, rest) = rest[16..].split_at_checked(count).ok_or(SHORT)?;
            let kind = if head >> 4 == 0 { &mut self.dc } else { &mut self.ac };
            let to = kind.get_mut(usize::from(head & 15)).ok_or(WRONG_TABLE)?;
            *to = Some(HuffmanTable::new(counts, symbols).ok_or(WRONG_TABLE)?);
            self.has_codes = true;
            content = rest;
        }
        Ok(())
    }

    /// Reads a scan's header: SOS (B.2.3).
    fn scan(&self, content: &[u8], frame: &Frame, most_values: usize) -> Result<Scan<'_>, JpegError> {
        let count = usize::from(*content.first().ok_or(SHORT)?);
        let listed = content.get(1..1 + 2 * count).ok_or(SHORT)?;
        let mut components: Vec<ScanComponent> = Vec::with_capacity(count);
        for [id, tables] in listed.as_chunks::<2>().0 {
            let index = frame.components.iter().position(|c| c.id == *id).ok_or(WRONG_SCAN)?;
            if components.iter().any(|(other, ..)| *other == index) {
                return Err(WRONG_SCAN);
            }
            let dc = self.dc.get(usize::from(tables >> 4)).and_then(Option::as_ref);
            let ac = self.ac.get(usize::from(tables & 15)).and_then(Option::as_ref);
            components.push((index, dc, ac));
        }
        let &[first, last, bits] = content
            .get(1 + 2 * count..)
            .and_then(|rest| rest.first_chunk())
            .ok_or(SHORT)?;
        let (first, last, low) = (usize::from(first), usize::from(last), u32::from(bits & 15));
        let is_several = (1..=4).contains(&count);
        let (part, is_sound) = if frame.is_progressive {
            let is_dc = first == 0 && is_several && last == 0;
            let is_ac = first > 0 && count == 1 && (first..64).contains(&last);
            let refines = bits >> 4 != 0;
            let part = Part::Progressive {
                first,
                last,
                low,
                refines,
            };
            (part, (is_dc || is_ac) && low <= 13)
        } else {
            (
                Part::Whole,
                is_several && (frame.scans > 1 || count == frame.components.len()),
            )
        };
        if !is_sound {
            return Err(WRONG_SCAN);
        }
        Ok(Scan {
            components,
            restart_interval: self.restart_interval,
            groups: groups(frame),
            part,
            most_values,
        })
    }
}
