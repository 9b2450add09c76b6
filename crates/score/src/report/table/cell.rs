//! Content of a cell.

use crate::report::words::numbers::bracketed;
use scaleproof_core::spelling::digits;
use scaleproof_core::statistics::Interval;

/// A value with its interval, its remark and its style.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cell {
    pub value: Value,
    /// The 95 % interval of a number, in its digits.
    pub interval: Option<Interval>,
    /// A word beside the value.
    pub remark: Option<String>,
    /// True if a change is shown.
    pub is_strong: bool,
    /// Darkness of the cell on a page, from 0 to 1.
    pub shade: Option<f64>,
    /// True if the row above has the same text.
    pub(crate) is_repeated: bool,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub enum Value {
    /// No value: nothing is known.
    #[default]
    None,
    Text(String),
    Count(usize),
    Number {
        value: f64,
        digits: usize,
    },
    /// A count out of a total.
    Share {
        count: usize,
        of: usize,
    },
    /// A number of the base and that of the variant.
    Change {
        from: f64,
        to: f64,
        digits: usize,
    },
    /// A count of the base and that of the variant, out of the same total.
    ShareChange {
        from: usize,
        to: usize,
        of: usize,
    },
}

impl Cell {
    pub fn text(text: impl Into<String>) -> Cell {
        Cell::of(Value::Text(text.into()))
    }

    pub fn count(count: usize) -> Cell {
        Cell::of(Value::Count(count))
    }

    pub fn number(value: f64, digits: usize) -> Cell {
        Cell::of(Value::Number { value, digits })
    }

    /// Makes a cell of a number, or an empty one.
    pub fn maybe(value: Option<f64>, digits: usize) -> Cell {
        value.map_or_else(Cell::default, |value| Cell::number(value, digits))
    }

    pub fn share(count: usize, of: usize) -> Cell {
        Cell::of(Value::Share { count, of })
    }

    pub fn change(from: f64, to: f64, digits: usize) -> Cell {
        Cell::of(Value::Change { from, to, digits })
    }

    pub fn of(value: Value) -> Cell {
        Cell {
            value,
            ..Cell::default()
        }
    }

    pub fn with_interval(self, interval: Option<Interval>) -> Cell {
        Cell { interval, ..self }
    }

    pub fn with_remark(self, remark: Option<String>) -> Cell {
        Cell { remark, ..self }
    }

    pub fn strong(self, is_strong: bool) -> Cell {
        Cell { is_strong, ..self }
    }

    pub fn shaded(self, share: f64) -> Cell {
        let shade = Some(share);
        Cell { shade, ..self }
    }

    /// Returns the value in words, its numbers written by `number` (value, digits behind the point).
    pub(crate) fn words(&self, number: impl Fn(f64, usize) -> String) -> String {
        match &self.value {
            Value::None => "–".to_owned(),
            Value::Text(text) => text.clone(),
            Value::Count(count) => count.to_string(),
            Value::Number { value, digits } => number(*value, *digits),
            Value::Share { count, of } => format!("{count}/{of}"),
            Value::Change { from, to, digits } => format!("{} → {}", number(*from, *digits), number(*to, *digits)),
            Value::ShareChange { from, to, of } => format!("{from} → {to} of {of}"),
        }
    }

    /// Returns the interval as `[0.38, 1.00]`, its numbers written by `number`.
    pub(crate) fn interval_words(&self, number: impl Fn(f64, usize) -> String) -> Option<String> {
        let behind = match &self.value {
            Value::Number { digits, .. } | Value::Change { digits, .. } => *digits,
            _ => 2,
        };
        Some(bracketed(self.interval?, |end| number(end, behind)))
    }

    /// Returns the value, its interval and its remark in one line of plain text; a number that is shown to change has a star.
    pub(crate) fn line(&self) -> String {
        if self.is_repeated {
            return String::new();
        }
        let star = if self.is_strong && !matches!(self.value, Value::Text(_)) {
            "*"
        } else {
            ""
        };
        let value = self.words(digits) + star;
        let remark = self.remark.as_ref().map(|remark| format!("({remark})"));
        let parts = [Some(value), self.interval_words(digits), remark];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }
}
