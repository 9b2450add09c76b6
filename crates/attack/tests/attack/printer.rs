use scaleproof_attack::run::Rgb;
use scaleproof_attack::run::printer::PrinterMap;
use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::gamut::Gamut;

/// A printer that mixes the channels and darkens, measured at six levels.
fn gamut() -> Gamut {
    let levels = [0, 51, 102, 153, 204, 255];
    let comes_out = |rgb: [u8; 3]| {
        let [r, g, b] = rgb.map(|v| f64::from(v) / 255.0);
        Lab::from_linear([
            0.05 + 0.6 * r * r + 0.1 * g,
            0.04 + 0.5 * g,
            0.06 + 0.4 * b + 0.1 * r * g,
        ])
    };
    Gamut::new(&levels, comes_out)
}

#[test]
fn the_derivative_is_that_of_the_map() {
    let printer = PrinterMap::new(gamut(), String::new());
    let cells = vec![[0.31, 0.52, 0.77], [0.93, 0.12, 0.48], [0.0, 1.0, 0.5]];
    let gradient = vec![[1.0, -2.0, 0.5], [0.3, 0.7, -1.0], [1.0, 1.0, 1.0]];
    let found = printer.vjp(&cells, &gradient);
    let value = |cells: &[Rgb]| -> f64 {
        let printed = printer.printed(cells);
        printed
            .iter()
            .flatten()
            .zip(gradient.iter().flatten())
            .map(|(p, g)| p * g)
            .sum()
    };
    for cell in 0..3 {
        for channel in 0..3 {
            // Inwards at the ends of the range.
            let by = if cells[cell][channel] == 1.0 { -1e-4 } else { 1e-4 };
            let mut moved = cells.clone();
            moved[cell][channel] += by;
            let difference = (value(&moved) - value(&cells)) / by;
            let derivative = found[cell][channel];
            assert!(
                (difference - derivative).abs() < 0.02 * (1.0 + derivative.abs()),
                "{difference} {derivative}"
            );
        }
    }
}

#[test]
fn cells_of_eight_bits_come_out_as_pattern_check_says() {
    let printer = PrinterMap::new(gamut(), String::new());
    for cell in [[0, 51, 102], [12, 200, 255], [255, 255, 255]] {
        let [printed] = printer.printed(&[cell.map(|v| f64::from(v) / 255.0)])[..] else {
            unreachable!()
        };
        let expected = gamut().printed(cell).rgb();
        assert_eq!(printed.map(|v| (255.0 * v).round() as u8), expected);
    }
}
