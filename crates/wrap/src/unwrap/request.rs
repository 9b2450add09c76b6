//! Bounds on the pieces of a mesh.

/// Range of stretch that can be requested. No surface is flat to the last digit.
pub const STRETCH: std::ops::RangeInclusive<f64> = 1.001..=2.0;

/// Bounds on the pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct UnwrapRequest {
    /// Maximum number of pieces, for which up to 3 % of the paint may be left out. `None`: no bound, and no paint is left out.
    pub most_pieces: Option<usize>,
    /// Maximum mean stretch over all pieces, by area.
    pub mean_stretch: f64,
    /// Maximum 99th percentile of the stretch over all pieces, by area.
    pub stretch_99: f64,
    /// Size of the rectangle that each piece must fit in any rotation, mm; `None`: any size.
    pub fits_mm: Option<[f64; 2]>,
    /// True to flatten paint that is not visible from outside, too; otherwise it is left out.
    pub hidden_too: bool,
}

impl Default for UnwrapRequest {
    fn default() -> Self {
        Self {
            most_pieces: None,
            mean_stretch: 1.03,
            stretch_99: 1.2,
            fits_mm: None,
            hidden_too: false,
        }
    }
}
