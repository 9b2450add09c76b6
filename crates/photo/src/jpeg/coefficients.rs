//! DCT coefficients of a JPEG: its Huffman-decoded data, from which pixels of any size and place are computed.

use super::error::JpegError;

/// Blocks of 8 × 8 coefficients of one component.
#[derive(Debug)]
pub(super) struct Component {
    /// Horizontal and vertical sampling factor, relative to the coarsest component.
    pub sampling: [u32; 2],
    /// Number of blocks across and down, including partial groups.
    pub blocks: [usize; 2],
    /// Number of samples across and down that the image covers.
    pub size: [usize; 2],
    /// Quantization steps, in zigzag order.
    pub steps: [u16; 64],
    store: Store,
}

#[derive(Debug)]
enum Store {
    /// Non-zero values: a tenth of all, in a photo. For images of one scan.
    Sparse {
        blocks: Vec<SparseBlock>,
        /// The first `used` are entries of blocks.
        values: Vec<u16>,
        used: usize,
    },
    /// All values, 64 per block in zigzag order, to be changed by later scans; and a buffer for a block's entries.
    Dense { all: Vec<i16>, entries: Box<Entries> },
}

/// Buffer for the entries of a block: at most two for each of 63 places.
type Entries = [u16; 128];

#[derive(Debug, Clone, Copy, Default)]
struct SparseBlock {
    start: u32,
    mean: i16,
    /// Number of its entries in `values`.
    count: u8,
}

/// Marker value in an entry of [`Store::Sparse`]: the place among the 64 is stored above a value of ten bits; this value says that the next entry has
/// the value.
const NEXT_HAS_IT: u16 = 0x200;

impl Component {
    /// Creates a component with room for this number of values; dense for `None`, if several scans change them.
    pub(super) fn new(sampling: [u32; 2], blocks: [usize; 2], size: [usize; 2], room: Option<usize>) -> Component {
        let count = blocks[0] * blocks[1];
        Component {
            sampling,
            blocks,
            size,
            steps: [0; 64],
            store: match room {
                Some(room) => Store::Sparse {
                    blocks: vec![SparseBlock::default(); count],
                    values: vec![0; room],
                    used: 0,
                },
                None => Store::Dense {
                    all: vec![0; 64 * count],
                    entries: Box::new([0; 128]),
                },
            },
        }
    }

    /// Returns the buffer for the next block's AC values. At most `most` entries are kept.
    #[inline(always)]
    pub(super) fn block_entries(&mut self, most: usize) -> Result<BlockEntries<'_>, JpegError> {
        let entries = match &mut self.store {
            Store::Dense { entries, .. } => &mut **entries,
            Store::Sparse { values, used, .. } => {
                if values.len() < *used + 128 {
                    more_room(values, *used, most)?;
                }
                values[*used..].first_chunk_mut().ok_or(JpegError::TooManyValues)?
            }
        };
        Ok(BlockEntries { entries, count: 0 })
    }

    /// Sets a whole block: its DC value, and the last `count` entries pushed.
    #[inline(always)]
    pub(super) fn set(&mut self, block: usize, mean: i16, count: usize) {
        match &mut self.store {
            Store::Dense { all, entries } => {
                let to = &mut all[64 * block..][..64];
                to[0] = mean;
                each_entry(&entries[..count.min(128)], 63, to);
            }
            Store::Sparse { blocks, used, .. } => {
                blocks[block] = SparseBlock {
                    start: *used as u32,
                    mean,
                    count: count as u8,
                };
                *used += count;
            }
        }
    }

    /// Returns the coefficients of a block for changing; empty if they are not stored densely.
    pub(super) fn dense(&mut self, block: usize) -> &mut [i16] {
        match &mut self.store {
            Store::Dense { all, .. } => &mut all[64 * block..][..64],
            Store::Sparse { .. } => &mut [],
        }
    }

    /// Returns the DC value of a block: eight times the mean of its samples, in quantization steps, without the offset of 128.
    #[inline(always)]
    pub(super) fn mean(&self, block: usize) -> i16 {
        match &self.store {
            Store::Sparse { blocks, .. } => blocks[block].mean,
            Store::Dense { all, .. } => all[64 * block],
        }
    }

    /// Passes every non-zero AC value with its place, up to the place `last`, to `to`; returns true if the block has any.
    #[inline(always)]
    pub(super) fn each_ac(&self, block: usize, last: usize, to: &mut impl CoefficientSink) -> bool {
        match &self.store {
            Store::Sparse { blocks, values, .. } => {
                let SparseBlock { start, count, .. } = blocks[block];
                each_entry(&values[start as usize..][..usize::from(count)], last, to);
                count > 0
            }
            Store::Dense { all, .. } => {
                let mut has_any = false;
                for (place, value) in (1..=last).zip(&all[64 * block + 1..]) {
                    if *value != 0 {
                        to.put(place, *value);
                        has_any = true;
                    }
                }
                has_any
            }
        }
    }
}

/// Receiver of a block's values. A trait instead of a closure, since only a function can be forced inline into its caller, whose vector instructions
/// it needs.
pub(super) trait CoefficientSink {
    fn put(&mut self, place: usize, value: i16);
}

impl CoefficientSink for [i16] {
    #[inline(always)]
    fn put(&mut self, place: usize, value: i16) {
        self[place] = value;
    }
}

/// Enlarges a buffer with `used` entries to twice its length, at most to `most` entries.
#[cold]
fn more_room(values: &mut Vec<u16>, used: usize, most: usize) -> Result<(), JpegError> {
    if used > most {
        return Err(JpegError::TooManyValues);
    }
    values.resize((2 * values.len()).min(most).max(used) + 128, 0);
    Ok(())
}

/// AC values of a block while they are read, directly in their final buffer.
pub(super) struct BlockEntries<'a> {
    entries: &'a mut Entries,
    /// Number of entries pushed.
    pub count: usize,
}

impl BlockEntries<'_> {
    /// Appends a value at a place, 1 to 63; each place at most once.
    #[inline(always)]
    pub(super) fn push(&mut self, place: usize, value: i16) {
        let high = (place as u16) << 10;
        if (-511..=511).contains(&value) {
            self.entries[self.count & 127] = high | (value as u16 & 0x3FF);
            self.count += 1;
        } else {
            self.entries[self.count & 127] = high | NEXT_HAS_IT;
            self.entries[(self.count + 1) & 127] = value as u16;
            self.count += 2;
        }
    }
}

#[inline(always)]
fn each_entry(entries: &[u16], last: usize, to: &mut (impl CoefficientSink + ?Sized)) {
    let mut entries = entries.iter();
    while let Some(entry) = entries.next() {
        let place = usize::from(entry >> 10);
        if place > last {
            return;
        }
        let value = match entry & 0x3FF {
            NEXT_HAS_IT => entries.next().map_or(0, |value| *value as i16),
            // Signed value of ten bits.
            _ => ((entry << 6) as i16) >> 6,
        };
        to.put(place, value);
    }
}
