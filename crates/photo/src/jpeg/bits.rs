//! Bit reader of entropy-coded data, most significant bit first (ITU-T T.81, F.2.2.5). Zeros follow the end; the reader counts them.

pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    /// Index of the next byte to load; it may be beyond the end.
    next: usize,
    /// Loaded bits, left-aligned.
    loaded: u64,
    /// Number of loaded bits not read yet.
    count: u32,
}

/// Minimum number of bits after [`Bits::load`].
const LOADED: u32 = 32;

impl<'a> Bits<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Bits<'a> {
        Bits {
            bytes,
            next: 0,
            loaded: 0,
            count: 0,
        }
    }

    /// Loads bits; afterwards at least 32 can be read: more than a code of 16 and its value of 15.
    #[inline(always)]
    pub(super) fn load(&mut self) {
        if self.count >= LOADED {
            return;
        }
        let word = match self.bytes.get(self.next..).and_then(|rest| rest.first_chunk::<8>()) {
            Some(word) => u64::from_be_bytes(*word),
            None => last_word(self.bytes, self.next),
        };
        self.loaded |= word >> self.count;
        let bytes = (63 - self.count) / 8;
        self.next += bytes as usize;
        self.count += 8 * bytes;
    }

    /// Returns the next `n` bits, 1 to 16, without consuming them.
    #[inline(always)]
    pub(super) fn peek(&self, n: u32) -> u32 {
        (self.loaded >> (64 - n)) as u32
    }

    #[inline(always)]
    pub(super) fn skip(&mut self, n: u32) {
        self.loaded <<= n;
        self.count -= n;
    }

    /// Reads the next `n` bits, 0 to 16, which must be loaded.
    #[inline(always)]
    pub(super) fn take(&mut self, n: u32) -> u32 {
        let bits = (self.loaded >> 1 >> (63 - n)) as u32;
        self.skip(n);
        bits
    }

    /// Reads the value of `n` bits by F.2.2.1's EXTEND: those below half of the range are negative.
    #[inline(always)]
    pub(super) fn value(&mut self, n: u32) -> i32 {
        let bits = self.take(n) as i32;
        if n > 0 && bits < 1 << (n - 1) {
            bits - (1 << n) + 1
        } else {
            bits
        }
    }

    #[inline(always)]
    pub(super) fn bit(&mut self) -> bool {
        self.load();
        self.take(1) == 1
    }

    /// Returns the number of whole bytes left; negative if bits beyond the end were read.
    pub(super) fn bytes_left(&self) -> i64 {
        (8 * (self.bytes.len() as i64 - self.next as i64) + i64::from(self.count)).div_euclid(8)
    }
}

/// Returns the last bytes, fewer than eight, followed by zeros.
#[cold]
fn last_word(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    let rest = bytes.get(at..).unwrap_or_default();
    word.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
    u64::from_be_bytes(word)
}
