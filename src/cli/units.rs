//! Lengths that were probably meant in another unit, or in another order: a note, never a refusal.

use scaleproof_plot::lettering::number;

/// The longest vehicle on a road, an articulated bus, is 25 m long.
const LONGEST_VEHICLE_MM: f64 = 25_000.0;
/// No template is smaller than a stamp.
const STAMP_MM: f64 = 10.0;
/// Boards below this are smaller than a matchbox.
const SMALLEST_BOARD_MM: f64 = 50.0;

/// Says it as a note.
pub(crate) fn note(doubt: Option<String>) {
    if let Some(doubt) = doubt {
        say!("note: {doubt}");
    }
}

/// About the size of a template of a model 1:`scale`.
pub(crate) fn template(size_mm: (f64, f64), tile_mm: f64, scale: f64) -> Option<String> {
    let (width, height) = size_mm;
    let longest = width.max(height);
    let size = sides(&[width, height], " × ");
    let times = |factor: f64| format!("--size-mm {}", sides(&[width * factor, height * factor], "x"));
    if longest < STAMP_MM {
        let meant = times(1000.0 / scale);
        return Some(format!(
            "the template is {size} mm: were these metres? At 1:{} that is {meant}",
            number(scale)
        ));
    }
    if longest < tile_mm && 10.0 * longest >= tile_mm {
        let (tile, meant) = (number(tile_mm), times(10.0));
        return Some(format!(
            "the template of {size} mm is smaller than one repeat of the pattern ({tile} mm): was it in cm? That is {meant}"
        ));
    }
    (scale > 1.0 && longest * scale > LONGEST_VEHICLE_MM).then(|| {
        let (metres, meant) = (metres(longest * scale), times(1.0 / scale));
        format!(
            "the template of {size} mm covers {metres} of the real thing: is that its full size? At 1:{} it is {meant}",
            number(scale)
        )
    })
}

/// About the size of a model, 1:`scale` (length, width, height), whichever of the labels it is.
pub(crate) fn model(labels: &[String], size_mm: [f64; 3], scale: f64) -> Option<String> {
    let doubts = labels.iter().map(|label| model_of(label, size_mm, scale));
    doubts.collect::<Option<Vec<String>>>()?.into_iter().next()
}

fn model_of(class: &str, size_mm: [f64; 3], scale: f64) -> Option<String> {
    let is_vehicle = ["car", "truck", "bus"].contains(&class);
    let [length, width, _] = size_mm;
    if is_vehicle && width > length {
        return Some(format!(
            "the {class} is {} mm long and {} mm wide: the order is length x width x height",
            number(length),
            number(width)
        ));
    }
    let real_mm = size_mm.into_iter().fold(0.0, f64::max) * scale;
    let (least, most) = usual_mm(class);
    let is_usual = |mm: f64| (least..=most).contains(&mm);
    if is_usual(real_mm) {
        return None;
    }
    let units = [
        ("cm", 10.0),
        ("metres of the real thing", 1000.0 / scale),
        ("mm of the real thing", 1.0 / scale),
        ("metres", 1000.0),
    ];
    let begin = format!(
        "the {class} of {} mm at 1:{} would be {} long in reality",
        sides(&size_mm, " × "),
        number(scale),
        metres(real_mm)
    );
    let meant = units.into_iter().find(|(_, factor)| is_usual(real_mm * factor));
    Some(match meant {
        Some((unit, factor)) => {
            let size = sides(&size_mm.map(|mm| mm * factor), "x");
            format!("{begin}: were these {unit}? That is --model-size-mm {size}")
        }
        None => format!("{begin}: are --model-size-mm and --scale right?"),
    })
}

/// How long real ones are.
fn usual_mm(class: &str) -> (f64, f64) {
    match class {
        "car" => (2_000.0, 8_000.0),
        "truck" | "bus" => (3_000.0, LONGEST_VEHICLE_MM),
        // From a cup to a train.
        _ => (50.0, 500_000.0),
    }
}

/// About a mesh that was turned by `--mesh-front`, or was not.
pub(crate) fn turned([length, width, _]: [f64; 3]) -> Option<String> {
    (width > length).then(|| format!("the model is {length:.0} mm long and {width:.0} mm wide: is --mesh-front right?"))
}

/// About the squares of a calibration board.
pub(crate) fn board(squares: (u32, u32), square_mm: f64) -> Option<String> {
    let [width, height] = [squares.0, squares.1].map(|count| f64::from(count) * square_mm);
    (width.max(height) < SMALLEST_BOARD_MM).then(|| {
        let (size, meant) = (sides(&[width, height], " × "), number(square_mm * 10.0));
        format!("the board is {size} mm: were the squares in cm? That is --square-mm {meant}")
    })
}

fn sides(sides: &[f64], between: &str) -> String {
    let sides: Vec<_> = sides.iter().map(|mm| number((mm * 100.0).round() / 100.0)).collect();
    sides.join(between)
}

fn metres(mm: f64) -> String {
    format!("{} m", number((mm / 10.0).round() / 100.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `README.md`, `calibration/`, `captures/skyline/scene.toml`, and what is as usual.
    #[test]
    fn usual_lengths_raise_no_doubt() {
        for (size, tile, scale) in [
            ((600.0, 300.0), 118.0, 10.0),
            ((600.0, 300.0), 240.0, 10.0),
            ((118.0, 118.0), 118.0, 10.0),
            ((455.0, 128.0), 118.0, 10.0),
            ((2000.0, 600.0), 118.0, 10.0),
            ((80.0, 80.0), 40.0, 24.0),
            ((4600.0, 1300.0), 1180.0, 1.0),
        ] {
            assert_eq!(template(size, tile, scale), None);
        }
        for (class, size, scale) in [
            ("car", [455.0, 186.0, 128.0], 10.0),
            ("car", [269.0, 166.0, 155.0], 10.0),
            ("car", [4545.0, 1755.0, 1340.0], 1.0),
            ("car", [190.0, 78.0, 53.0], 24.0),
            ("bus", [1800.0, 255.0, 300.0], 10.0),
            ("person", [30.0, 50.0, 175.0], 10.0),
            ("stop sign", [5.0, 75.0, 75.0], 10.0),
            ("cup", [80.0, 80.0, 100.0], 1.0),
        ] {
            assert_eq!(model_of(class, size, scale), None);
        }
        let scene = scaleproof_pose::scene::Scene::open(
            &std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline/scene.toml"),
        );
        let stored = scene.unwrap().model;
        assert_eq!(model(stored.class.labels(), stored.size_mm, stored.scale), None);
        assert_eq!(turned(stored.size_mm), None);
        assert_eq!(turned([100.0; 3]), None);
        for (squares, square) in [((9, 7), 22.0), ((10, 7), 20.0), ((6, 5), 26.0), ((5, 4), 10.0)] {
            assert_eq!(board(squares, square), None);
        }
    }

    #[test]
    fn lengths_in_another_unit_are_noticed() {
        let said = |doubt: Option<String>| doubt.unwrap_or_default();
        assert_eq!(
            said(template((4.6, 1.3), 118.0, 10.0)),
            "the template is 4.6 × 1.3 mm: were these metres? At 1:10 that is --size-mm 460x130"
        );
        assert_eq!(
            said(template((60.0, 30.0), 118.0, 10.0)),
            "the template of 60 × 30 mm is smaller than one repeat of the pattern (118 mm): was it in cm? That is --size-mm 600x300"
        );
        assert_eq!(
            said(template((4600.0, 1300.0), 118.0, 10.0)),
            "the template of 4600 × 1300 mm covers 46 m of the real thing: is that its full size? At 1:10 it is --size-mm 460x130"
        );
        let models = [
            (
                [46.0, 20.0, 13.0],
                "0.46 m long in reality: were these cm? That is --model-size-mm 460x200x130",
            ),
            (
                [4.6, 1.9, 1.3],
                "0.05 m long in reality: were these metres of the real thing? That is --model-size-mm 460x190x130",
            ),
            (
                [4600.0, 1900.0, 1300.0],
                "46 m long in reality: were these mm of the real thing? That is --model-size-mm 460x190x130",
            ),
            (
                [0.46, 0.19, 0.13],
                "0 m long in reality: were these metres? That is --model-size-mm 460x190x130",
            ),
            (
                [1.0, 1.0, 1.0],
                "0.01 m long in reality: are --model-size-mm and --scale right?",
            ),
        ];
        for (size, end) in models {
            let said = said(model_of("car", size, 10.0));
            assert!(said.starts_with("the car of ") && said.ends_with(end), "{said}");
        }
        assert_eq!(
            said(model_of("car", [186.0, 455.0, 128.0], 10.0)),
            "the car is 186 mm long and 455 mm wide: the order is length x width x height"
        );
        assert_eq!(
            said(turned([186.0, 455.0, 128.0])),
            "the model is 186 mm long and 455 mm wide: is --mesh-front right?"
        );
        assert_eq!(
            said(board((9, 7), 2.2)),
            "the board is 19.8 × 15.4 mm: were the squares in cm? That is --square-mm 22"
        );
    }
}
