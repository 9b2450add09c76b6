//! The colour scale of the heat maps: from white to dark blue, ever darker, so that a grey print keeps the order.

/// The colour of a share from 0 to 1; values beyond take the ends.
pub fn shade(share: f64) -> String {
    const WHITE: [f64; 3] = [247.0, 251.0, 255.0];
    const BLUE: [f64; 3] = [8.0, 48.0, 107.0];
    let share = share.clamp(0.0, 1.0);
    let [r, g, b] = [0, 1, 2].map(|i| (WHITE[i] + share * (BLUE[i] - WHITE[i])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colour of text on it: whichever contrasts more.
pub fn ink(share: f64) -> &'static str {
    if share > 0.645 { "#ffffff" } else { "#000000" }
}
