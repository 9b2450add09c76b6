//! The wire format of Protocol Buffers, as far as ONNX files need it. Source: protobuf.dev, "Encoding".

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field<'a> {
    Int(u64),
    Bytes(&'a [u8]),
    /// A float, or another number of that size.
    Four([u8; 4]),
    /// A double, or another number of that size.
    Eight([u8; 8]),
}

/// The fields of a message, in their order; they end where the bytes are no message.
pub(super) struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(byte & 0x7F) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn take(&mut self, count: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    /// All of them; none where the bytes are no message.
    pub(super) fn all(self) -> Option<Vec<(u64, Field<'a>)>> {
        self.read_all(Fields::next)
    }

    /// The bytes as numbers one after the other; none where they are not that.
    pub(super) fn varints(self) -> Option<Vec<u64>> {
        self.read_all(Fields::varint)
    }

    fn read_all<T>(mut self, read: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let mut found = Vec::new();
        while !self.0.is_empty() {
            found.push(read(&mut self)?);
        }
        Some(found)
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = (u64, Field<'a>);

    fn next(&mut self) -> Option<(u64, Field<'a>)> {
        let key = self.varint()?;
        let field = match key & 7 {
            0 => Field::Int(self.varint()?),
            1 => Field::Eight(self.take(8)?.try_into().ok()?),
            2 => {
                let count = self.varint()?;
                Field::Bytes(self.take(count)?)
            }
            5 => Field::Four(self.take(4)?.try_into().ok()?),
            _ => return None,
        };
        Some((key >> 3, field))
    }
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut written = Vec::new();
    while value >= 0x80 {
        written.push(value as u8 | 0x80);
        value >>= 7;
    }
    written.push(value as u8);
    written
}

pub(super) fn int(field: u64, value: u64) -> Vec<u8> {
    [varint(field << 3), varint(value)].concat()
}

/// A field with a float of 32 bits.
pub(super) fn single(field: u64, value: f32) -> Vec<u8> {
    [varint(field << 3 | 5), value.to_le_bytes().to_vec()].concat()
}

/// A field with bytes, a text or a message.
pub(super) fn bytes(field: u64, value: &[u8]) -> Vec<u8> {
    [varint(field << 3 | 2), varint(value.len() as u64), value.to_vec()].concat()
}
