use scaleproof_plot::Colour;
use scaleproof_score::report::charts::shade::{ink, shade};

/// WCAG 2.1, relative luminance.
fn luminance(colour: Colour) -> f64 {
    let colour = colour.to_string();
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
        let ground = luminance(shade(share));
        assert!(step == 0 || ground < luminance(shade(share - 0.01)));
        let text = luminance(ink(share));
        let contrast = (ground.max(text) + 0.05) / (ground.min(text) + 0.05);
        assert!(contrast >= 4.5, "contrast {contrast:.1} at {share}");
    }
    assert_eq!((shade(-1.0), shade(2.0)), (shade(0.0), shade(1.0)));
}
