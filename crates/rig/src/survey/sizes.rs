//! Sizes of tags by id, as in `0-7:50,8-15:40`.

use std::ops::RangeInclusive;
use std::str::FromStr;

use scaleproof_core::message::{Message, bail, message};

/// Tag sizes in mm by id.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes(Vec<(RangeInclusive<u32>, f64)>);

impl Sizes {
    pub fn size_mm(&self, id: u32) -> Option<f64> {
        self.0.iter().find(|(ids, _)| ids.contains(&id)).map(|(_, size)| *size)
    }
}

impl FromStr for Sizes {
    type Err = Message;

    /// Parses one size in mm for every tag, or ids and ids from-to, each with a size.
    fn from_str(text: &str) -> Result<Sizes, Message> {
        if !text.contains(':') {
            return Ok(Sizes(vec![(0..=u32::MAX, size(text)?)]));
        }
        let mut sizes: Vec<(RangeInclusive<u32>, f64)> = Vec::new();
        for part in text.split(',') {
            let unclear = || message!("`{part}` is not ID:MM or FIRST-LAST:MM, as in 0-7:50,8-15:40");
            let (ids, mm) = part.split_once(':').ok_or_else(unclear)?;
            let (first, last) = ids.split_once('-').unwrap_or((ids, ids));
            let id = |text: &str| text.trim().parse::<u32>().map_err(|_| unclear());
            let ids = id(first)?..=id(last)?;
            if ids.is_empty() {
                bail!("`{part}` runs backwards; write the smaller id first");
            }
            let overlaps =
                |(other, _): &(RangeInclusive<u32>, f64)| other.start() <= ids.end() && ids.start() <= other.end();
            if sizes.iter().any(overlaps) {
                bail!("`{part}` gives a tag a second size; name each id once");
            }
            sizes.push((ids, size(mm)?));
        }
        Ok(Sizes(sizes))
    }
}

fn size(text: &str) -> Result<f64, Message> {
    match text.trim().parse::<f64>() {
        Ok(mm) if (1.0..=10_000.0).contains(&mm) => Ok(mm),
        _ => bail!("`{text}` is not a tag size; give mm from 1 to 10000, as in 50"),
    }
}
