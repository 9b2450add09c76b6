//! The colour scale of the heat maps: from white to dark blue, ever darker, so that a grey print keeps the order.

use scaleproof_plot::{BLACK, Colour, WHITE};

/// Returns the colour of a share from 0 to 1; values beyond take the ends.
pub fn shade(share: f64) -> Colour {
    const PALE: [f64; 3] = [247.0, 251.0, 255.0];
    const BLUE: [f64; 3] = [8.0, 48.0, 107.0];
    let share = share.clamp(0.0, 1.0);
    let [r, g, b] = [0, 1, 2].map(|i| (PALE[i] + share * (BLUE[i] - PALE[i])).round() as u32);
    Colour(r << 16 | g << 8 | b)
}

/// Returns the colour of text on the shade of a share: black or white, whichever contrasts more.
pub fn ink(share: f64) -> Colour {
    if share > 0.645 { WHITE } else { BLACK }
}
