//! Gamuts.

use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::gamut::Gamut;

const LEVELS: [u8; 4] = [0, 85, 170, 255];

/// A printer that keeps `share` of the distance from a middle grey, in CIELAB.
fn dull(share: f64) -> Gamut {
    Gamut::new(&LEVELS, |asked| {
        let Lab { l, a, b } = Lab::from_rgb(asked);
        Lab {
            l: 50.0 + share * (l - 50.0),
            a: share * a,
            b: share * b,
        }
    })
}

#[test]
fn nodes_are_met_and_edges_are_straight() {
    let gamut = Gamut::srgb(&LEVELS);
    for asked in [[0, 0, 0], [255, 255, 255], [85, 170, 0], [255, 0, 85]] {
        assert!(gamut.printed(asked).delta_e(Lab::from_rgb(asked)) < 1e-9);
    }
    // A third of the way along an edge of the grid.
    let (low, high) = (Lab::from_rgb([0, 85, 170]), Lab::from_rgb([255, 85, 170]));
    let on_edge = Gamut::new(&[0, 255], |[r, ..]| if r == 0 { low } else { high }).printed([85, 7, 99]);
    assert!((on_edge.l - (2.0 * low.l + high.l) / 3.0).abs() < 1e-9);
}

#[test]
fn a_gamut_shrunk_by_half_has_an_eighth_of_the_volume() {
    let (whole, half) = (Gamut::srgb(&LEVELS).volume(), dull(0.5).volume());
    assert!((half / whole - 0.125).abs() < 1e-9, "{half} {whole}");
    // The volume of sRGB in CIELAB is 8.2e5 to 8.3e5 cubic units; four levels a channel miss little of it.
    assert!((whole / 8.25e5 - 1.0).abs() < 0.1, "{whole}");
}

/// Against every third colour of the cube.
#[test]
fn the_best_colour_is_the_best_of_all() {
    let gamut = dull(0.7);
    for wanted in [
        [255, 0, 0],
        [0, 0, 255],
        [10, 240, 30],
        [120, 90, 200],
        [255, 255, 0],
        [3, 3, 3],
    ] {
        let (wanted, mut least) = (Lab::from_rgb(wanted), f64::INFINITY);
        for i in 0..86_u32.pow(3) {
            let asked = [i / 7396, i / 86 % 86, i % 86].map(|v| (3 * v) as u8);
            least = least.min(gamut.printed(asked).delta_e(wanted));
        }
        let best = gamut.best(wanted);
        assert!(best.delta_e <= least + 0.02, "{wanted:?}: {best:?}, {least}");
    }
}
