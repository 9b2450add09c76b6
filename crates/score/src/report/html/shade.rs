//! The colour scale of the heat maps: from white to dark blue, ever darker, so that a grey print keeps the order.

/// The colour of a share from 0 to 1; values beyond take the ends.
pub(super) fn shade(share: f64) -> String {
    const WHITE: [f64; 3] = [247.0, 251.0, 255.0];
    const BLUE: [f64; 3] = [8.0, 48.0, 107.0];
    let share = share.clamp(0.0, 1.0);
    let [r, g, b] = [0, 1, 2].map(|i| (WHITE[i] + share * (BLUE[i] - WHITE[i])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colour of text on it: whichever contrasts more.
pub(super) fn ink(share: f64) -> &'static str {
    if share > 0.645 { "#ffffff" } else { "#000000" }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2.1, relative luminance.
    fn luminance(colour: &str) -> f64 {
        let part = |i: usize| f64::from(u8::from_str_radix(&colour[i..i + 2], 16).unwrap()) / 255.0;
        let linear = |c: f64| {
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * linear(part(1)) + 0.7152 * linear(part(3)) + 0.0722 * linear(part(5))
    }

    #[test]
    fn darker_is_more_and_the_numbers_can_be_read() {
        for step in 0..=100 {
            let share = f64::from(step) / 100.0;
            let ground = luminance(&shade(share));
            assert!(step == 0 || ground < luminance(&shade(share - 0.01)));
            let text = luminance(ink(share));
            let contrast = (ground.max(text) + 0.05) / (ground.min(text) + 0.05);
            assert!(contrast >= 4.5, "contrast {contrast:.1} at {share}");
        }
        assert_eq!((shade(-1.0), shade(2.0)), (shade(0.0), shade(1.0)));
    }
}
