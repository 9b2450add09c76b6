//! The choice of closed forms.

/// Closed form of a surrogate renderer. The default is the most accurate of `attack chart`; where only two colours are at hand, `affine-curve` is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedForm {
    Affine,
    Quadratic,
    AffineCurve,
    #[default]
    QuadraticCurve,
}

impl ClosedForm {
    pub const ALL: [Self; 4] = [Self::Affine, Self::Quadratic, Self::AffineCurve, Self::QuadraticCurve];

    /// Returns the name, as in options.
    pub fn name(self) -> &'static str {
        ["affine", "quadratic", "affine-curve", "quadratic-curve"][self as usize]
    }

    /// Returns the least number of colours, different in all three channels.
    pub fn least_colours(self) -> usize {
        match self {
            Self::Affine | Self::AffineCurve => 2,
            Self::Quadratic | Self::QuadraticCurve => 3,
        }
    }
}
