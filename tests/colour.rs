//! The colour chart: rendered by poppler, printed and photographed by simulation, read back; and patterns checked with what was
//! read.

mod common;
#[path = "print_template/render.rs"]
mod render;
#[path = "colour/simulate.rs"]
mod simulate;

use std::path::{Path, PathBuf};

use common::{assert_refused, stdout};
use image::{Rgb, RgbImage};
use render::{done, pages, scaleproof};
use scaleproof::colour_chart::layout::{ChartKind, ChartLayout};
use scaleproof::colour_chart::read::{FAMILIES, read};
use scaleproof::pattern::colour::Lab;
use scaleproof::photo::Photo;
use scaleproof::print::printer::PrinterFile;
use scaleproof::tags::AprilTagC;
use simulate::{PLAIN_PAPER, Printer, VIEW, View, jpeg, photo, photo_with};

/// The chart's page as the printer is asked for it.
fn sheet(options: &str) -> RgbImage {
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("chart.pdf");
    done(&format!("print chart{options} -o {}", pdf.display()));
    let mut drawn = pages(&pdf, 1, 200.0);
    assert_eq!(drawn.len(), 1);
    drawn.remove(0)
}

fn stored(picture: &RgbImage, quality: u8, folder: &Path) -> PathBuf {
    let path = folder.join("photo.jpg");
    std::fs::write(&path, jpeg(picture, quality)).unwrap();
    path
}

fn five_views() -> [View; 5] {
    [
        VIEW,
        View {
            seed: 2,
            turn_deg: 180.0,
            gain: [0.85, 0.7, 0.45],
            slope: [-0.1, 0.15],
            ..VIEW
        },
        View {
            seed: 3,
            turn_deg: 8.0,
            fill: 0.75,
            askew: 0.09,
            blur_px: 1.5,
            noise: 4.0,
            ..VIEW
        },
        View {
            seed: 4,
            gain: [0.35, 0.4, 0.3],
            vignette: 0.25,
            jpeg_quality: 80,
            ..VIEW
        },
        View {
            seed: 5,
            width: 2000,
            height: 1500,
            turn_deg: 90.0,
            fill: 0.9,
            gain: [0.5, 0.75, 0.95],
            slope: [0.2, 0.1],
            ..VIEW
        },
    ]
}

/// The acceptance line: what was *printed* comes back, not what was asked for.
#[test]
fn the_printed_colours_are_read_back() {
    let (sheet, folder) = (sheet(""), tempfile::tempdir().unwrap());
    let layout = ChartLayout::new(ChartKind::Rgb6);
    for view in five_views() {
        let path = stored(&photo(&sheet, &PLAIN_PAPER, &view), view.jpeg_quality, folder.path());
        let reading = read(&Photo::open(&path).unwrap(), &mut AprilTagC::new(&FAMILIES).unwrap()).unwrap();
        assert_eq!(reading.kind, layout.kind);
        let (mut off, mut from_asked) = (Vec::new(), Vec::new());
        for (asked, light) in &reading.patches {
            let found = Lab::of_linear(*light);
            off.push(found.delta_e(PLAIN_PAPER.truth(*asked)));
            from_asked.push(found.delta_e(Lab::of(*asked)));
        }
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let worst = off.iter().copied().fold(0.0, f64::max);
        println!(
            "view {}: mean ΔE2000 {:.2}, worst {worst:.2}; from the asked colours {:.1}; {:?}",
            view.seed,
            mean(&off),
            mean(&from_asked),
            reading.quality
        );
        assert!(mean(&off) <= 2.0, "view {}: {}", view.seed, mean(&off));
        assert!(worst <= 6.0, "view {}: {worst}", view.seed);
        assert!(mean(&from_asked) > 5.0, "this printer is far from what it is asked for");
    }
}
