//! Huffman codes (ITU-T T.81, annex C and F.2.2.3).

use super::bits::Bits;

/// Number of bits of the lookup table: codes, and coefficients whose code and value together are not longer, are found in one step.
const LOOKED_UP: u32 = 11;

/// Decoded content of the next bits.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    /// Length of the code, plus the value if it is known; 0 if the code is longer than the lookup.
    length: u8,
    symbol: u8,
    /// Coefficient, never 0; 0 if its bits are still to be read.
    value: i16,
}

#[derive(Clone)]
pub(super) struct HuffmanTable {
    entries: Box<[Entry; 1 << LOOKED_UP]>,
    /// By code length: one more than its last code, left-aligned in 16 bits.
    limits: [u32; 17],
    /// By code length: offset from a code to the index of its symbol.
    offsets: [i32; 17],
    symbols: [u8; 256],
}

/// Coefficient of a block in zigzag order, or the reason why there is none.
pub(super) enum Coefficient {
    /// Value after a number of zeros.
    Value { zeros: u32, value: i32 },
    /// No value; holds the upper half of the symbol.
    None(u32),
    /// The bits are no code.
    Unknown,
}

impl HuffmanTable {
    /// Builds the table from the number of codes of each length, and their symbols; `None` if there are more codes than bits allow.
    pub(super) fn new(counts: &[u8; 16], symbols: &[u8]) -> Option<HuffmanTable> {
        let mut table = HuffmanTable {
            entries: Box::new([Entry::default(); 1 << LOOKED_UP]),
            limits: [0; 17],
            offsets: [0; 17],
            symbols: [0; 256],
        };
        table.symbols.get_mut(..symbols.len())?.copy_from_slice(symbols);
        let (mut code, mut place) = (0_u32, 0_usize);
        for length in 1..=16_u32 {
            table.offsets[length as usize] = place as i32 - code as i32;
            for _ in 0..counts[length as usize - 1] {
                table.enter(code, length, *symbols.get(place)?)?;
                code += 1;
                place += 1;
            }
            table.limits[length as usize] = code << (16 - length);
            code <<= 1;
        }
        Some(table)
    }

    fn enter(&mut self, code: u32, length: u32, symbol: u8) -> Option<()> {
        if code >> length != 0 {
            return None;
        }
        let Some(free) = LOOKED_UP.checked_sub(length) else {
            return Some(());
        };
        let size = u32::from(symbol & 15);
        for behind in 0..1_u32 << free {
            let is_whole = size > 0 && size <= free;
            let bits = (behind >> free.saturating_sub(size)) as i32;
            let is_negative = bits >> size.saturating_sub(1) == 0;
            let value = bits - if is_negative { (1 << size) - 1 } else { 0 };
            self.entries[(code << free | behind) as usize] = Entry {
                length: (length + if is_whole { size } else { 0 }) as u8,
                symbol,
                value: if is_whole { value as i16 } else { 0 },
            };
        }
        Some(())
    }

    #[inline(always)]
    fn entry(&self, bits: &mut Bits) -> Entry {
        bits.load();
        self.entries[bits.peek(LOOKED_UP) as usize & ((1 << LOOKED_UP) - 1)]
    }

    /// Returns the symbol of an entry and consumes its code, but not its value. `None` for bits that are no code.
    #[inline(always)]
    fn symbol_of(&self, entry: Entry, bits: &mut Bits) -> Option<u8> {
        if entry.length == 0 {
            let (symbol, length) = self.long_symbol(bits.peek(16))?;
            bits.skip(length);
            return Some(symbol);
        }
        let is_whole = entry.value != 0;
        let size = if is_whole { u32::from(entry.symbol & 15) } else { 0 };
        bits.skip(u32::from(entry.length) - size);
        Some(entry.symbol)
    }

    /// Reads the next symbol; `None` for bits that are no code.
    #[inline(always)]
    pub(super) fn symbol(&self, bits: &mut Bits) -> Option<u8> {
        let entry = self.entry(bits);
        self.symbol_of(entry, bits)
    }

    /// Reads the next coefficient of a block whose symbols are run lengths of zeros and sizes.
    #[inline(always)]
    pub(super) fn coefficient(&self, bits: &mut Bits) -> Coefficient {
        let entry = self.entry(bits);
        if entry.value != 0 {
            bits.skip(entry.length.into());
            return Coefficient::Value {
                zeros: u32::from(entry.symbol >> 4),
                value: entry.value.into(),
            };
        }
        let Some(symbol) = self.symbol_of(entry, bits) else {
            return Coefficient::Unknown;
        };
        let (zeros, size) = (u32::from(symbol >> 4), u32::from(symbol & 15));
        match size {
            0 => Coefficient::None(zeros),
            1..=LARGEST_SIZE => Coefficient::Value {
                zeros,
                value: bits.value(size),
            },
            _ => Coefficient::Unknown,
        }
    }

    /// Returns the symbol whose code begins the next 16 bits, and the code's length.
    #[cold]
    fn long_symbol(&self, next: u32) -> Option<(u8, u32)> {
        let length = (LOOKED_UP + 1..=16).find(|length| next < self.limits[*length as usize])?;
        let place = (next >> (16 - length)) as i32 + self.offsets[length as usize];
        Some((*self.symbols.get(usize::try_from(place).ok()?)?, length))
    }
}

/// Largest size in bits of DC differences and AC coefficients, for 8-bit samples (T.81, tables F.1 and F.2; the second ends at 10, and some encoders
/// exceed it).
pub(super) const LARGEST_SIZE: u32 = 11;
