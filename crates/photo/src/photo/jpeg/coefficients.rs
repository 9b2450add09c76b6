//! The coefficients of a JPEG: its data with the codes undone, from which pixels of any size and place follow.

use super::JpegError;

/// One component's blocks of 8 × 8 coefficients.
#[derive(Debug)]
pub(super) struct Component {
    /// Samples across and down for each unit of the coarsest component.
    pub sampling: [u32; 2],
    /// Blocks across and down, whole groups.
    pub blocks: [usize; 2],
    /// Samples across and down that the image covers.
    pub size: [usize; 2],
    /// Steps of quantization, in the order of frequencies.
    pub steps: [u16; 64],
    store: Store,
}

#[derive(Debug)]
enum Store {
    /// What is not zero: a tenth of all, in a photo. For images of one scan.
    Sparse {
        blocks: Vec<SparseBlock>,
        /// The first `used` are entries of blocks.
        values: Vec<u16>,
        used: usize,
    },
    /// All, 64 a block in the order of frequencies, which scans after the first change; and where a block's entries are made.
    Dense { all: Vec<i16>, entries: Box<Entries> },
}

/// Room for the entries of a block: two for each of 63 places at most.
type Entries = [u16; 128];

#[derive(Debug, Clone, Copy, Default)]
struct SparseBlock {
    start: u32,
    mean: i16,
    /// Entries of `values`.
    count: u8,
}

/// An entry of [`Store::Sparse`]: the place among the 64 above the value in ten bits; this value says that the next entry has the value.
const NEXT_HAS_IT: u16 = 0x200;

impl Component {
    /// With room for so many values; dense where several scans change them.
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

    /// Where the next block's values but for its mean are to be pushed. At most `most` entries are kept.
    #[inline(always)]
    pub(super) fn others(&mut self, most: usize) -> Result<Others<'_>, JpegError> {
        let entries = match &mut self.store {
            Store::Dense { entries, .. } => &mut **entries,
            Store::Sparse { values, used, .. } => {
                if values.len() < *used + 128 {
                    more_room(values, *used, most)?;
                }
                values[*used..].first_chunk_mut().ok_or(JpegError::TooManyValues)?
            }
        };
        Ok(Others { entries, count: 0 })
    }

    /// Sets a whole block: its mean, and the so many entries that were pushed last.
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

    /// The coefficients of a block, to be changed; empty where they are not kept densely.
    pub(super) fn dense(&mut self, block: usize) -> &mut [i16] {
        match &mut self.store {
            Store::Dense { all, .. } => &mut all[64 * block..][..64],
            Store::Sparse { .. } => &mut [],
        }
    }

    /// The mean of a block: eight times that of its samples, in steps of quantization, without the 128.
    #[inline(always)]
    pub(super) fn mean(&self, block: usize) -> i16 {
        match &self.store {
            Store::Sparse { blocks, .. } => blocks[block].mean,
            Store::Dense { all, .. } => all[64 * block],
        }
    }

    /// Gives every other value that is not zero and its place, up to the place `last`; says whether the block has any.
    #[inline(always)]
    pub(super) fn each_other(&self, block: usize, last: usize, to: &mut impl Take) -> bool {
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
                        to.take(place, *value);
                        has_any = true;
                    }
                }
                has_any
            }
        }
    }
}

/// What takes the values of a block. A trait instead of a closure, since only a function can be told to become part of its caller, whose instructions
/// for the processor's vectors it needs.
pub(super) trait Take {
    fn take(&mut self, place: usize, value: i16);
}

impl Take for [i16] {
    #[inline(always)]
    fn take(&mut self, place: usize, value: i16) {
        self[place] = value;
    }
}

/// Twice the room, for `most` entries at most.
#[cold]
fn more_room(values: &mut Vec<u16>, used: usize, most: usize) -> Result<(), JpegError> {
    if used > most {
        return Err(JpegError::TooManyValues);
    }
    values.resize((2 * values.len()).min(most).max(used) + 128, 0);
    Ok(())
}

/// The values of a block but for its mean, while they are read: right where they are kept.
pub(super) struct Others<'a> {
    entries: &'a mut Entries,
    /// Entries that were pushed.
    pub count: usize,
}

impl Others<'_> {
    /// Each place, 1 to 63, once.
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
fn each_entry(entries: &[u16], last: usize, to: &mut (impl Take + ?Sized)) {
    let mut entries = entries.iter();
    while let Some(entry) = entries.next() {
        let place = usize::from(entry >> 10);
        if place > last {
            return;
        }
        let value = match entry & 0x3FF {
            NEXT_HAS_IT => entries.next().map_or(0, |value| *value as i16),
            // Ten bits with a sign.
            _ => ((entry << 6) as i16) >> 6,
        };
        to.take(place, value);
    }
}
