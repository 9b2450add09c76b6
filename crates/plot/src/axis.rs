//! Axis of a chart: mapping of values to pixels, and positions of ticks.

use scaleproof_core::geometry::extent;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    Linear,
    /// Logarithmic; values of 0 or below are drawn at the axis's low end.
    Log,
}

/// Axis from `low` to `high`, drawn from one pixel to another.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotAxis {
    pub title: String,
    pub scale: Scale,
    pub low: f64,
    pub high: f64,
}

impl PlotAxis {
    /// Creates an axis for all values. A log axis ends at 1, 2 or 5 times a power of ten; a linear one starts at 0 or below.
    pub fn around(title: &str, scale: Scale, values: impl IntoIterator<Item = f64>) -> Self {
        let usable = |v: &f64| v.is_finite() && (scale == Scale::Linear || *v > 0.0);
        let (mut low, mut high) = extent(values.into_iter().filter(usable));
        if low > high {
            (low, high) = (0.1, 1.0);
        }
        let (low, high) = match scale {
            Scale::Linear if high <= low.min(0.0) => (low.min(0.0), low.min(0.0) + 1.0),
            Scale::Linear => (low.min(0.0), high),
            Scale::Log => (step_below(low * 0.9), step_above(high * 1.1)),
        };
        Self {
            title: title.to_owned(),
            scale,
            low,
            high,
        }
    }

    /// Returns the position of a value between the ends: 0 at `low`, 1 at `high`; values beyond are clamped.
    pub fn share(&self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value <= 0.0 => 0.0,
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
    }

    /// Returns the values with a line and a label.
    pub fn ticks(&self) -> Vec<f64> {
        if self.scale == Scale::Log {
            return self.log_ticks();
        }
        let step = step_above((self.high - self.low) / 5.0);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|n| n as f64 * step).collect()
    }

    /// Returns 1, 2, 5 of each decade, or only the decades if that would be too many.
    fn log_ticks(&self) -> Vec<f64> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let steps: &[f64] = if last - first > 3 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = (first..=last).flat_map(|decade| steps.iter().map(move |s| s * 10f64.powi(decade)));
        all.filter(|v| *v >= self.low * 0.999 && *v <= self.high * 1.001)
            .collect()
    }
}

pub fn tick_label(value: f64) -> String {
    // The logarithm of 0 is minus infinity, so it has no digits.
    let digits = if value == 0.0 {
        0
    } else {
        1 - value.abs().log10().floor() as i32
    };
    let digits = digits.max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Returns the largest of 1, 2, 5 times a power of ten that is not above a positive value.
fn step_below(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let step = [5.0, 2.0].into_iter().find(|s| s * decade <= value * 1.000_001);
    step.unwrap_or(1.0) * decade
}

/// Returns the smallest of 1, 2, 5 times a power of ten that is not below a positive value.
fn step_above(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|s| s * decade >= value * 0.999_999);
    step.unwrap_or(10.0) * decade
}
