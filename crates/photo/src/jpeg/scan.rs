//! Decoding of a scan's entropy-coded data into coefficients (ITU-T T.81, annexes F and G, Huffman codes).
//!
//! Invalid data is refused: codes that are in no table, data that ends early or continues after the last block, restart markers out of order, DC
//! values that no picture has.

use super::bits::Bits;
use super::coefficients::Component;
use super::error::JpegError;
use super::huffman::{Coefficient, HuffmanTable, LARGEST_SIZE};
use super::segments::Intervals;

/// Header of a scan, with the tables defined before it.
pub(super) struct Scan<'a> {
    pub components: Vec<ScanComponent<'a>>,
    /// Number of groups between restart markers; 0 without.
    pub restart_interval: usize,
    /// Number of groups across and down if the scan has several components.
    pub groups: [usize; 2],
    pub part: Part,
    /// Maximum number of entries of a component.
    pub most_values: usize,
}

/// Index of the frame's component, with the Huffman tables of its DC and AC coefficients.
pub(super) type ScanComponent<'a> = (usize, Option<&'a HuffmanTable>, Option<&'a HuffmanTable>);

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// Complete coefficients.
    Whole,
    /// Part of a progressive frame: the places from `first` to `last` without their `low` lowest bits; or one more bit of values from earlier scans.
    Progressive {
        first: usize,
        last: usize,
        low: u32,
        refines: bool,
    },
}

impl Part {
    /// Returns the places of a block that the scan provides, and the number of lowest bits left for later scans.
    pub(super) fn places(self) -> (std::ops::RangeInclusive<usize>, u32) {
        match self {
            Part::Whole => (0..=63, 0),
            Part::Progressive { first, last, low, .. } => (first..=last, low),
        }
    }
}

/// Maximum number of bytes after the last code; some cameras leave as many.
const PADDING: i64 = 8;

const NO_CODE: JpegError = JpegError::Damaged("its data has a code that is in no table");
const NO_TABLE: JpegError = JpegError::Damaged("a table for its data is missing");
const ENDS_EARLY: JpegError = JpegError::Damaged("its data ends before the picture does");
const GOES_ON: JpegError = JpegError::Damaged("its data goes on behind the picture");
const OUT_OF_ORDER: JpegError = JpegError::Damaged("its restart markers are out of order");
const NO_PICTURE: JpegError = JpegError::Damaged("its data is of no picture");

pub(super) fn decode(scan: &Scan, data: &[u8], components: &mut [Component]) -> Result<(), JpegError> {
    let mut intervals = Intervals::new(data);
    let mut bytes = Vec::new();
    let [across, down] = match scan.components[..] {
        // A scan of one component has groups of one block, and none outside the image.
        [(component, ..)] => components[component].size.map(|side| side.div_ceil(8)),
        _ => scan.groups,
    };
    let groups = across * down;
    let interval = match scan.restart_interval {
        0 => groups,
        interval => interval,
    };
    let mut first = 0;
    while first < groups {
        let is_last = first + interval >= groups;
        if !intervals.read(&mut bytes) {
            return Err(OUT_OF_ORDER);
        }
        let mut state = State {
            bits: Bits::new(&bytes),
            last_dc: [0; 4],
            empty_blocks: 0,
        };
        for group in first..(first + interval).min(groups) {
            let place = [group % across, group / across];
            state.group(scan, place, components)?;
            if state.bits.bytes_left() < 0 {
                return Err(ENDS_EARLY);
            }
        }
        if state.bits.bytes_left() > PADDING || (is_last && !intervals.is_over()) {
            return Err(GOES_ON);
        }
        first += interval;
    }
    Ok(())
}

/// Decoder state carried from block to block within a restart interval.
struct State<'a> {
    bits: Bits<'a>,
    last_dc: [i32; 4],
    /// Number of following blocks without new values.
    empty_blocks: u32,
}

impl State<'_> {
    /// Decodes a group: the blocks of all components that cover the same pixels.
    fn group(&mut self, scan: &Scan, [x, y]: [usize; 2], components: &mut [Component]) -> Result<(), JpegError> {
        let is_one = scan.components.len() == 1;
        for (nth, (index, dc_table, table)) in scan.components.iter().enumerate() {
            let component = &mut components[*index];
            let [across, down] = component.sampling.map(|s| if is_one { 1 } else { s as usize });
            for row in 0..down {
                for column in 0..across {
                    let block = (y * down + row) * component.blocks[0] + x * across + column;
                    match scan.part {
                        Part::Whole => {
                            let (dc_table, table) = (dc_table.ok_or(NO_TABLE)?, table.ok_or(NO_TABLE)?);
                            self.decode_block(nth, dc_table, table, component, block, scan.most_values)?;
                        }
                        Part::Progressive {
                            first: 0, low, refines, ..
                        } => {
                            let value = &mut component.dense(block)[0];
                            if refines {
                                *value |= i16::from(self.bits.bit()) << low
                            } else {
                                *value = self.dc(nth, dc_table.ok_or(NO_TABLE)?)? << low
                            }
                        }
                        Part::Progressive {
                            first,
                            last,
                            low,
                            refines,
                        } => {
                            let table = table.ok_or(NO_TABLE)?;
                            let values = &mut component.dense(block)[..=last];
                            if refines {
                                self.refine(first, low, table, values)?
                            } else {
                                self.first(first, low, table, values)?
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Decodes the DC coefficient of the next block, a difference from the one before (F.2.2.1).
    #[inline(always)]
    fn dc(&mut self, nth: usize, table: &HuffmanTable) -> Result<i16, JpegError> {
        match table.coefficient(&mut self.bits) {
            Coefficient::Value { zeros: 0, value } => self.last_dc[nth] += value,
            Coefficient::None(0) => {}
            _ => return Err(NO_CODE),
        }
        // Samples of 8 bits have DC coefficients up to 1024; far larger ones come from damage.
        match self.last_dc[nth] {
            mean @ -2048..=2047 => Ok(mean as i16),
            _ => Err(NO_PICTURE),
        }
    }

    /// Decodes a block of a sequential frame (F.2.2.2).
    #[inline(always)]
    fn decode_block(
        &mut self,
        nth: usize,
        dc_table: &HuffmanTable,
        table: &HuffmanTable,
        component: &mut Component,
        block: usize,
        most: usize,
    ) -> Result<(), JpegError> {
        let mean = self.dc(nth, dc_table)?;
        let mut others = component.block_entries(most)?;
        let mut place = 1;
        while place < 64 {
            match table.coefficient(&mut self.bits) {
                Coefficient::Value { zeros, value } => {
                    place += zeros as usize;
                    if place > 63 {
                        return Err(NO_CODE);
                    }
                    others.push(place, value as i16);
                    place += 1;
                }
                Coefficient::None(0) => break,
                Coefficient::None(15) => place += 16,
                _ => return Err(NO_CODE),
            }
        }
        let count = others.count;
        component.set(block, mean, count);
        Ok(())
    }

    /// Decodes the first scan of some places of a block (G.1.2.2).
    fn first(&mut self, first: usize, low: u32, table: &HuffmanTable, values: &mut [i16]) -> Result<(), JpegError> {
        if self.empty_blocks > 0 {
            self.empty_blocks -= 1;
            return Ok(());
        }
        let mut place = first;
        while place < values.len() {
            match table.coefficient(&mut self.bits) {
                Coefficient::Value { zeros, value } => {
                    place += zeros as usize;
                    *values.get_mut(place).ok_or(NO_CODE)? = (value << low) as i16;
                    place += 1;
                }
                Coefficient::None(15) => place += 16,
                Coefficient::None(size) => {
                    self.empty_blocks = end_of_blocks(size, &mut self.bits) - 1;
                    break;
                }
                Coefficient::Unknown => return Err(NO_CODE),
            }
        }
        Ok(())
    }

    /// Decodes one more bit of some places of a block (G.1.2.3).
    fn refine(&mut self, first: usize, low: u32, table: &HuffmanTable, values: &mut [i16]) -> Result<(), JpegError> {
        let (bits, mut place) = (&mut self.bits, first);
        while self.empty_blocks == 0 && place < values.len() {
            let symbol = table.symbol(bits).ok_or(NO_CODE)?;
            let (mut zeros, size) = (u32::from(symbol >> 4), u32::from(symbol & 15));
            let new = match (size, zeros) {
                (0, 15) => 0,
                (0, _) => {
                    self.empty_blocks = end_of_blocks(zeros, bits);
                    break;
                }
                (1, _) if bits.bit() => 1 << low,
                (1, _) => -1 << low,
                _ => return Err(NO_CODE),
            };
            // Non-zero values get their bit when passed, and do not count as zeros.
            while let Some(value) = values.get_mut(place) {
                place += 1;
                if *value != 0 {
                    refine(value, low, bits);
                } else if zeros > 0 {
                    zeros -= 1;
                } else {
                    *value = new;
                    break;
                }
            }
        }
        if self.empty_blocks > 0 {
            self.empty_blocks -= 1;
            for value in values.get_mut(place..).unwrap_or_default() {
                if *value != 0 {
                    refine(value, low, bits);
                }
            }
        }
        Ok(())
    }
}

/// Reads the number of blocks, this one included, without further new values.
fn end_of_blocks(size: u32, bits: &mut Bits) -> u32 {
    bits.load();
    (1 << size) + bits.take(size)
}

/// Reads the next bit of a value's magnitude.
fn refine(value: &mut i16, low: u32, bits: &mut Bits) {
    if bits.bit() {
        *value = value.saturating_add(value.signum() << low);
    }
}

const _: () = assert!(LARGEST_SIZE <= 16, "16 bits are loaded behind a code");
