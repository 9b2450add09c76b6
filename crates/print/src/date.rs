//! Date in the captions, as the user gives it.

use std::fmt;
use std::str::FromStr;

use super::SheetError;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    year: u16,
    month: u16,
    day: u16,
}

impl FromStr for Date {
    type Err = SheetError;

    /// Parses `YYYY-MM-DD` (ISO 8601).
    fn from_str(text: &str) -> Result<Self, SheetError> {
        parse(text).ok_or_else(|| SheetError::BadDate { text: text.to_owned() })
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

fn parse(text: &str) -> Option<Date> {
    let digits = |part: &str, count: usize| {
        let plain = part.len() == count && part.bytes().all(|b| b.is_ascii_digit());
        plain.then(|| part.parse::<u16>().ok()).flatten()
    };
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else {
        return None;
    };
    let (year, month, day) = (digits(year, 4)?, digits(month, 2)?, digits(day, 2)?);
    let exists = (1..=days(year, month)?).contains(&day);
    exists.then_some(Date { year, month, day })
}

fn days(year: u16, month: u16) -> Option<u16> {
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => Some(31),
        4 | 6 | 9 | 11 => Some(30),
        2 => Some(if leap { 29 } else { 28 }),
        _ => None,
    }
}
