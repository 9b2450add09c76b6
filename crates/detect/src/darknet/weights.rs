//! Darknet's `.weights`: a header, then 32-bit floats, little-endian, layer by layer.

/// The numbers that are not taken yet.
pub(super) struct Weights<'a> {
    rest: &'a [u8],
    /// Count of numbers that were asked for and are not there.
    pub missing: usize,
}

impl<'a> Weights<'a> {
    /// Reads the header: version (three whole numbers of 32 bits), then the images seen in training, of 64 bits from version 0.2 on.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Weights<'a>, String> {
        let number = |i: usize| {
            bytes
                .get(4 * i..)
                .and_then(|b| b.first_chunk())
                .map(|b| u32::from_le_bytes(*b))
        };
        let (Some(major), Some(minor)) = (number(0), number(1)) else {
            return Err("it ends within its header: is it Darknet's .weights?".to_owned());
        };
        if major >= 1000 || minor >= 1000 {
            return Err(format!("its version is {major}.{minor}: is it Darknet's .weights?"));
        }
        let header = if 10 * major + minor >= 2 { 20 } else { 16 };
        let rest = bytes.get(header..).ok_or("it ends within its header")?;
        if rest.len() % 4 != 0 {
            return Err("it ends within a number: was it copied in full?".to_owned());
        }
        Ok(Weights { rest, missing: 0 })
    }

    /// The next numbers; `None` where the file has fewer, which are counted. Nothing is held because somebody asks for it.
    pub(super) fn take(&mut self, count: usize) -> Option<Vec<f32>> {
        let there = count.min(self.rest.len() / 4);
        let (taken, rest) = self.rest.split_at(4 * there);
        self.rest = rest;
        self.missing = self.missing.saturating_add(count - there);
        (self.missing == 0).then(|| taken.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect())
    }

    pub(super) fn left(&self) -> usize {
        self.rest.len() / 4
    }
}
