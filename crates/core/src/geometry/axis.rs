//! The six directions along the axes of a file.

use std::fmt;
use std::str::FromStr;

use nalgebra::Vector3;

use crate::message::{Message, message};

/// A direction along one axis of a file: `+x`, `-x`, `+y`, `-y`, `+z` or `-z`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SignedAxis {
    index: usize,
    is_negative: bool,
}

/// A text that names no direction.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{text}' is no direction; write one of +x, -x, +y, -y, +z, -z")]
pub struct NoDirection {
    text: String,
}

impl From<NoDirection> for Message {
    fn from(error: NoDirection) -> Message {
        message!("{error}")
    }
}

impl SignedAxis {
    /// Returns the direction along the axis with this index (x, y, z), which is taken modulo 3.
    pub fn new(index: usize, is_negative: bool) -> Self {
        let index = index % 3;
        Self { index, is_negative }
    }

    /// 0 for x, 1 for y, 2 for z.
    pub fn index(self) -> usize {
        self.index
    }

    /// 1 or -1.
    pub fn sign(self) -> f64 {
        if self.is_negative { -1.0 } else { 1.0 }
    }

    /// Returns the other direction along this axis.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self::new(self.index, !self.is_negative)
    }

    pub fn vector(self) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        vector[self.index] = self.sign();
        vector
    }
}

impl fmt::Display for SignedAxis {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let sign = if self.is_negative { '-' } else { '+' };
        write!(f, "{sign}{}", ["x", "y", "z"][self.index])
    }
}

impl FromStr for SignedAxis {
    type Err = NoDirection;

    /// A sign and a letter, as in `+x`; the plus may be left out.
    fn from_str(text: &str) -> Result<Self, NoDirection> {
        let (is_negative, letter) = match text.strip_prefix('-') {
            Some(letter) => (true, letter),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let index = ["x", "y", "z"]
            .iter()
            .position(|known| letter.eq_ignore_ascii_case(known));
        let no_direction = || NoDirection { text: text.to_owned() };
        Ok(Self::new(index.ok_or_else(no_direction)?, is_negative))
    }
}
