//! The formula from a texture and its maps to the image: per pixel and channel, so that values and derivatives are closed forms.

use serde::{Deserialize, Serialize};

/// Maps of one pixel and channel, in the order in which they are applied; NTR has only the last two.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Maps {
    /// s: the light that darkness swallows.
    pub subtract: f64,
    /// a
    pub add: f64,
    /// m
    pub multiply: f64,
    /// b: the light that does not come from the paint.
    pub bias: f64,
}

/// Formula between texture and image; η and x are sRGB, 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transformer {
    /// DTN's Expected Texture Transformer (CVPR 2022, fig. 4): `x = relu((relu(η − s) + a)·m + b)`; `TF[0:3]` is s, `[3:6]` a, `[6:9]` m and
    /// `[9:12]` b.
    #[default]
    Texture,
    /// ACTIVE's Neural Texture Renderer (ICCV 2023): `x = η·m + b`; `TF[0:3]` is m, `[3:6]` b.
    MultiplyAdd,
}

impl Transformer {
    pub const ALL: [Self; 2] = [Self::Texture, Self::MultiplyAdd];

    /// Returns the name, as in options.
    pub fn name(self) -> &'static str {
        ["texture", "multiply-add"][self as usize]
    }

    /// Counts the maps of the four that are not there, and 0.
    fn missing(self) -> usize {
        match self {
            Self::Texture => 0,
            Self::MultiplyAdd => 2,
        }
    }

    /// Counts the channels of TF.
    pub fn channels(self) -> usize {
        3 * (4 - self.missing())
    }

    /// Returns maps with which both ReLUs are open for every η from 0 to 1, and x = η·m for the m that is added to this one, 0.
    pub fn open(self) -> Maps {
        let open = if self.missing() == 0 { -0.05 } else { 0.0 };
        Maps {
            subtract: open,
            add: open,
            ..Maps::default()
        }
    }

    /// Returns the index of a channel's m in TF.
    pub fn multiplying(self, channel: usize) -> usize {
        3 * (2 - self.missing()) + channel
    }

    /// Returns the maps of a channel (0 to 2) of a pixel, whose values of TF `at` gives by their index.
    pub fn maps(self, channel: usize, at: impl Fn(usize) -> f64) -> Maps {
        let map = |i: usize| i.checked_sub(self.missing()).map_or(0.0, |i| at(3 * i + channel));
        Maps {
            subtract: map(0),
            add: map(1),
            multiply: map(2),
            bias: map(3),
        }
    }

    /// Inverts [`Transformer::maps`]: passes each map's index in TF and value to `put`.
    pub fn scatter(self, channel: usize, maps: Maps, mut put: impl FnMut(usize, f64)) {
        let values = [maps.subtract, maps.add, maps.multiply, maps.bias];
        for (i, value) in values.into_iter().skip(self.missing()).enumerate() {
            put(3 * i + channel, value);
        }
    }

    /// Returns x, which may lie above 1 (NTR's also below 0).
    pub fn value(self, maps: Maps, eta: f64) -> f64 {
        match self {
            Self::Texture => (((eta - maps.subtract).max(0.0) + maps.add) * maps.multiply + maps.bias).max(0.0),
            Self::MultiplyAdd => eta * maps.multiply + maps.bias,
        }
    }

    /// Returns dx/dη; 0 where a ReLU is shut.
    pub fn derivative(self, maps: Maps, eta: f64) -> f64 {
        match self {
            Self::Texture if eta <= maps.subtract || self.value(maps, eta) <= 0.0 => 0.0,
            _ => maps.multiply,
        }
    }

    /// Returns the gradient of the loss with respect to the maps, given that with respect to x (`cotangent`).
    ///
    /// Where a ReLU is shut the derivative is 0, and a pixel could never leave it. So a shut ReLU passes a cotangent that would open it, and no other:
    /// the formula that is learnt stays as it stands, only the steps of its training differ.
    pub fn vjp(self, maps: Maps, eta: f64, cotangent: f64) -> Maps {
        let Self::Texture = self else {
            return Maps {
                multiply: cotangent * eta,
                bias: cotangent,
                ..Maps::default()
            };
        };
        let inner = (eta - maps.subtract).max(0.0) + maps.add;
        if inner * maps.multiply + maps.bias <= 0.0 && cotangent >= 0.0 {
            return Maps::default();
        }
        let inner_cotangent = cotangent * maps.multiply;
        let passes = eta > maps.subtract || inner_cotangent < 0.0;
        Maps {
            subtract: if passes { -inner_cotangent } else { 0.0 },
            add: inner_cotangent,
            multiply: cotangent * inner,
            bias: cotangent,
        }
    }
}
