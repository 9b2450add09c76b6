//! The colour chart: rendered by poppler, printed and photographed by simulation, read back; and patterns checked with what was
//! read.

use crate::common;
use crate::print_template::render;
mod simulate;

use std::path::{Path, PathBuf};

use common::{assert_refused, skyline, stdout};
use image::{Rgb, RgbImage};
use render::{done, pages, scaleproof};
use scaleproof_photo::Photo;
use scaleproof_pose::tags::AprilTagC;
use scaleproof_print::chart::chart;
use scaleproof_print::colour_chart::ColourChartError;
use scaleproof_print::colour_chart::layout::{CELL_MM, ChartKind, ChartLayout};
use scaleproof_print::colour_chart::read::{ChartReading, FAMILIES, read};
use scaleproof_print::media::Media;
use scaleproof_print::paper::{Paper, Stock};
use scaleproof_print::printer::{Printer as Correction, PrinterFile};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::colour::Lab;
use simulate::{PLAIN_PAPER, Picture, Printer, VIEW, View, jpeg, photo, photo_with};

const DPI: f64 = 150.0;

/// The chart's page as the printer is asked for it.
fn sheet(options: &str) -> RgbImage {
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("chart.pdf");
    done(&format!("print chart{options} -o {}", pdf.display()));
    let mut drawn = pages(&pdf, 1, DPI);
    assert_eq!(drawn.len(), 1);
    drawn.remove(0)
}

fn stored(picture: &RgbImage, quality: u8, folder: &Path) -> PathBuf {
    let path = folder.join("photo.jpg");
    std::fs::write(&path, jpeg(picture, quality)).unwrap();
    path
}

fn read_file(path: &Path) -> Result<ChartReading, ColourChartError> {
    read(&Photo::open(path).unwrap(), &mut AprilTagC::new(&FAMILIES).unwrap()).unwrap()
}

fn taken(sheet: &RgbImage, printer: &Printer, view: &View) -> Result<ChartReading, ColourChartError> {
    let folder = tempfile::tempdir().unwrap();
    read_file(&stored(&photo(sheet, printer, view), view.jpeg_quality, folder.path()))
}

/// Mean and worst ΔE2000 of what was read from what was printed, and the mean from what was asked for.
fn off(reading: &ChartReading, printer: &Printer) -> (f64, f64, f64) {
    let (mut sum, mut worst, mut from_asked) = (0.0, 0.0_f64, 0.0);
    for (asked, light) in &reading.patches {
        let found = Lab::from_linear(*light);
        let off = found.delta_e(printer.truth(*asked));
        sum += off;
        worst = worst.max(off);
        from_asked += found.delta_e(Lab::from_rgb(*asked));
    }
    let n = reading.patches.len() as f64;
    (sum / n, worst, from_asked / n)
}

fn views() -> [View; 6] {
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
            width: 1600,
            height: 1200,
            turn_deg: 90.0,
            gain: [0.4, 0.6, 0.8],
            slope: [0.2, 0.1],
            ..VIEW
        },
        View {
            seed: 6,
            turn_deg: -5.0,
            barrel: 0.015,
            ..VIEW
        },
    ]
}

/// The acceptance line: what was *printed* comes back, not what was asked for.
#[test]
fn the_printed_colours_are_read_back() {
    let sheet = sheet("");
    for view in views() {
        let reading = taken(&sheet, &PLAIN_PAPER, &view).unwrap();
        assert_eq!(reading.kind, ChartKind::Rgb6);
        let (mean, worst, from_asked) = off(&reading, &PLAIN_PAPER);
        println!(
            "view {}: mean ΔE2000 {mean:.2}, worst {worst:.2}; from the asked colours {from_asked:.1}; {:?}",
            view.seed, reading.quality
        );
        assert!(mean <= 2.0 && worst <= 6.0, "view {}: {mean} {worst}", view.seed);
        assert!(from_asked > 5.0, "this printer is far from what it is asked for");
    }
}

/// Each disturbance is turned up until the photo must be refused: what is answered before is right.
#[test]
fn a_photo_is_read_rightly_or_refused() {
    let sheet = sheet("");
    let small = View {
        width: 900,
        height: 1200,
        ..VIEW
    };
    let mut cases: Vec<(String, View)> = Vec::new();
    let mut sweep = |name: &str, values: &[f64], set: fn(&mut View, f64)| {
        for value in values {
            let mut view = small;
            set(&mut view, *value);
            cases.push((format!("{name} {value}"), view));
        }
    };
    sweep("blur", &[2.0, 3.0, 4.0, 8.0], |v, x| v.blur_px = x);
    sweep("noise", &[6.0, 12.0, 30.0], |v, x| (v.noise, v.gain) = (x, [0.45; 3]));
    sweep("exposure", &[0.05, 0.1, 0.2, 0.4, 1.0, 1.6], |v, x| v.gain = [x; 3]);
    sweep("blue", &[0.1, 0.3, 1.1], |v, x| v.gain[2] = x);
    sweep("slope", &[0.3, 0.5, 0.7], |v, x| v.slope = [x, 0.0]);
    sweep("vignette", &[0.4, 0.95], |v, x| v.vignette = x);
    sweep("bend", &[4.0, 8.0, 16.0, 32.0], |v, x| v.bend_px = x);
    sweep("barrel", &[0.03, 0.06, 0.12], |v, x| v.barrel = x);
    sweep("fill", &[0.6, 0.45, 0.2], |v, x| v.fill = x);
    sweep("jpeg", &[60.0, 40.0, 10.0], |v, x| v.jpeg_quality = x as u8);
    let (mut answered, mut refused) = (0, 0);
    for (name, view) in cases {
        match taken(&sheet, &PLAIN_PAPER, &view) {
            Ok(reading) => {
                let (mean, worst, _) = off(&reading, &PLAIN_PAPER);
                println!("{name}: mean {mean:.2}, worst {worst:.2}; {:?}", reading.quality);
                answered += 1;
                assert!(mean <= 2.0, "{name}: {mean}");
            }
            Err(reason) => {
                println!("{name}: {reason}");
                refused += 1;
            }
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered >= 12 && refused >= 14);
}

/// The place of the chart's upper left corner on the page and an image's pixels per mm.
fn corner_px() -> ([f64; 2], f64) {
    let area = chart(Media::new(Paper::A4)).unwrap().area;
    let px_per_mm = DPI / 25.4;
    ([area.left_mm * px_per_mm, (297.0 - area.top_mm) * px_per_mm], px_per_mm)
}

/// Paints over a rectangle of the print: millimetres from the chart's upper left.
fn painted(print: &mut Picture, [left, top, right, bottom]: [f64; 4], paint: impl Fn([f32; 3]) -> [f32; 3]) {
    let ([x0, y0], scale) = corner_px();
    let at = |zero: f64, mm: f64| (zero + mm * scale) as u32;
    for y in at(y0, top)..at(y0, bottom) {
        for x in at(x0, left)..at(x0, right) {
            let pixel = print.get_pixel_mut(x, y);
            pixel.0 = paint(pixel.0);
        }
    }
}

#[test]
fn what_spoils_a_photo_is_named() {
    let (sheet, folder) = (sheet(""), tempfile::tempdir().unwrap());
    let output = folder.path().join("p.toml");
    let refused = |photo: &RgbImage, words: &[&str]| {
        let path = stored(photo, 90, folder.path());
        let run = scaleproof(&format!("colour read {} -o {}", path.display(), output.display()));
        assert_refused(&run, words);
        assert!(!output.exists());
    };
    let touched = |touch: &dyn Fn(&mut Picture)| photo_with(&sheet, &PLAIN_PAPER, &VIEW, touch);
    let taken = |view: View| photo(&sheet, &PLAIN_PAPER, &view);
    let white = |_: [f32; 3]| [0.9_f32; 3];
    refused(
        &touched(&|print| painted(print, [-5.0, -5.0, 22.0, 22.0], white)),
        &["photo.jpg", "582", "cannot be read"],
    );
    refused(
        &touched(&|print| painted(print, [150.0, 0.0, 158.0, 8.0], white)),
        &["583", "covered"],
    );
    // A reflection over two dark patches, one over the edge of a patch, a shadow over a corner.
    let dark = |row: usize, column: usize| {
        [column as f64, row as f64, column as f64 + 1.0, row as f64 + 1.0].map(|i| i * CELL_MM)
    };
    refused(
        &touched(&|print| painted(print, dark(5, 5), |p| p.map(|v| v + 1.0))),
        &["row 6, column 6", "reflection"],
    );
    let [left, top, right, bottom] = dark(5, 5);
    refused(
        &touched(&|print| painted(print, [left, top, right - 5.0, bottom], |p| p.map(|v| v * 0.3))),
        &["row 6, column 6", "not of one colour"],
    );
    refused(
        &touched(&|print| painted(print, [60.0, 150.0, 176.0, 198.0], |p| p.map(|v| v * 0.6))),
        &["uneven"],
    );
    refused(&taken(View { gain: [1.3; 3], ..VIEW }), &["overexposed", "row 1"]);
    refused(
        &taken(View {
            gain: [0.05; 3],
            ..VIEW
        }),
        &["too dark"],
    );
    refused(&taken(View { blur_px: 5.0, ..VIEW }), &["photo.jpg"]);
    refused(&taken(View { bend_px: 30.0, ..VIEW }), &["lay the paper flat"]);
    refused(&taken(View { fill: 0.3, ..VIEW }), &["go nearer"]);
    let one = taken(View {
        width: 900,
        height: 1200,
        ..VIEW
    });
    let mut two = RgbImage::new(1800, 1200);
    image::imageops::replace(&mut two, &one, 0, 0);
    image::imageops::replace(&mut two, &one, 900, 0);
    refused(&two, &["two colour charts"]);
    refused(&RgbImage::from_pixel(800, 600, Rgb([90; 3])), &["no colour chart"]);
    let mirrored = image::imageops::flip_horizontal(&one);
    refused(&mirrored, &["no colour chart"]);

    let other = skyline().join("normal_000.jpg");
    let text = folder.path().join("list.jpg");
    std::fs::write(&text, "milk, bread").unwrap();
    for (path, word) in [
        (&other, "no colour chart"),
        (&text, "not a JPEG"),
        (&output, "cannot read"),
    ] {
        let run = scaleproof(&format!("colour read {} -o {}", path.display(), output.display()));
        assert_refused(&run, &[word]);
        assert!(!output.exists());
    }
}

/// Photos of different prints, and of different charts, are not averaged; of one print they are.
#[test]
fn only_photos_of_one_print_are_averaged() {
    let (large, small) = (sheet(""), sheet(" --paper 148x210"));
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, sheet: &RgbImage, printer: &Printer, seed: u64| {
        let path = folder.path().join(name);
        std::fs::write(&path, jpeg(&photo(sheet, printer, &View { seed, ..VIEW }), 90)).unwrap();
        path.display().to_string()
    };
    let other_printer = Printer {
        black: 0.15,
        ..PLAIN_PAPER
    };
    let [a, b] = [1, 2].map(|seed| file(&format!("{seed}.jpg"), &large, &PLAIN_PAPER, seed));
    let c = file("c.jpg", &large, &other_printer, 3);
    let d = file("d.jpg", &small, &PLAIN_PAPER, 4);
    assert_refused(&scaleproof(&format!("colour read {a} {c}")), &["disagree"]);
    assert_refused(&scaleproof(&format!("colour read {a} {d}")), &["rgb6", "rgb4"]);
    let run = scaleproof(&format!("colour read {a} {b} --json"));
    let answer: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(answer["photos"].as_array().unwrap().len(), 2);
    assert!(answer["photos"][1]["delta_e_from_mean"].as_f64().unwrap() < 0.5);
    // A greyscale photo tells nothing of colours.
    let grey = folder.path().join("grey.png");
    image::open(&a).unwrap().to_luma8().save(&grey).unwrap();
    let grey = format!(
        "colour read {} -o {}",
        grey.display(),
        folder.path().join("grey.toml").display()
    );
    assert_refused(&scaleproof(&grey), &["greyscale", "in colour"]);
    assert!(!folder.path().join("grey.toml").exists());
    let small = scaleproof(&format!("colour read {d}"));
    assert!(stdout(&small).contains("chart rgb4"), "{}", stdout(&small));
}

#[test]
fn the_chart_has_what_the_paper_has_room_for() {
    let on = |paper: &str| {
        chart(Media {
            printer: Correction::measured(99.0, 99.0).unwrap(),
            ..Media::new(paper.parse::<Stock>().unwrap())
        })
    };
    for (paper, kind) in [
        ("a4", ChartKind::Rgb6),
        ("letter", ChartKind::Rgb6),
        ("a3", ChartKind::Rgb6),
        ("176x250", ChartKind::Rgb5),
        ("148x210", ChartKind::Rgb4),
    ] {
        assert_eq!(on(paper).unwrap().layout, ChartLayout::new(kind), "{paper}");
    }
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("c.pdf");
    for (paper, word) in [
        ("148x148", "110 × 110 mm"),
        ("100x100", "too small"),
        ("roll610", "on sheets"),
    ] {
        let run = scaleproof(&format!("print chart --paper {paper} -o {}", output.display()));
        assert_refused(&run, &[word]);
    }
    assert!(!output.exists());
}

#[test]
fn the_exported_chart_is_what_its_command_makes() {
    let folder = tempfile::tempdir().unwrap();
    let ours = folder.path().join("chart_a4.pdf");
    done(&format!("print chart -o {}", ours.display()));
    let shipped = common::home().join("print_templates/chart_a4.pdf");
    assert!(
        std::fs::read(ours).unwrap() == std::fs::read(shipped).unwrap(),
        "print_templates/chart_a4.pdf is out of date: its README says how to make it again"
    );
}

/// A pattern whose cells this printer can make, and cells it cannot: (cells, is printable).
fn mixed_pattern() -> Vec<([u8; 3], bool)> {
    // What comes out for colours well inside the cube is printable by definition.
    let makes = |asked: [u8; 3]| (PLAIN_PAPER.truth(asked).rgb(), true);
    let mut cells: Vec<_> = [
        [60, 90, 200],
        [200, 60, 90],
        [90, 200, 60],
        [128, 128, 128],
        [230, 200, 40],
    ]
    .map(makes)
    .to_vec();
    cells.push(([255, 255, 255], true));
    cells.extend(
        [
            [255, 0, 0],
            [0, 255, 0],
            [0, 0, 255],
            [0, 255, 255],
            [255, 0, 255],
            [0, 0, 0],
        ]
        .map(|rgb| (rgb, false)),
    );
    cells
}

/// From the photo to the checked pattern, by the commands of the README.
#[test]
fn a_pattern_is_checked_with_what_the_printer_makes() {
    let (sheet, folder) = (sheet(""), tempfile::tempdir().unwrap());
    let name = |file: &str| folder.path().join(file).display().to_string();
    let photo = stored(&photo(&sheet, &PLAIN_PAPER, &VIEW), 90, folder.path());
    let before = std::fs::read(&photo).unwrap();
    done(&format!(
        "print verify --x-mm 99.3 --y-mm 99.8 -o {}",
        name("printer.toml")
    ));
    let cells = mixed_pattern();
    let grid = RgbImage::from_fn(4, 3, |x, y| Rgb(cells[(y * 4 + x) as usize].0));
    grid.save(name("p.png")).unwrap();

    let check = format!(
        "pattern check {} --printer {} --json",
        name("p.png"),
        name("printer.toml")
    );
    assert_refused(&scaleproof(&check), &["not its colours", "colour read"]);
    done(&format!("colour read {} -o {}", photo.display(), name("printer.toml")));
    assert_eq!(std::fs::read(&photo).unwrap(), before, "the photo is as it was");
    let shipped = common::home().join("print_templates/printer_plain_paper.toml");
    assert_eq!(
        std::fs::read_to_string(shipped).unwrap(),
        std::fs::read_to_string(name("printer.toml")).unwrap(),
        "print_templates/printer_plain_paper.toml is not what is read of this printer"
    );
    let file = PrinterFile::load(Path::new(&name("printer.toml"))).unwrap();
    assert_eq!(file.printer, Correction::measured(99.3, 99.8).unwrap());
    let colours = file.colours.unwrap();
    assert_eq!(colours.photos_sha256, [scaleproof_core::files::sha256_hex(&before)]);
    println!(
        "gamut {} ({} of sRGB), mean ΔE2000 {}, interpolation {}",
        colours.gamut_volume_lab, colours.gamut_share_of_srgb, colours.delta_e_mean, colours.interpolation_delta_e_mean
    );
    assert!((0.2..0.7).contains(&colours.gamut_share_of_srgb) && colours.interpolation_delta_e_mean < 2.0);

    let run = scaleproof(&format!("{check} -o {}", name("preview.png")));
    let answer: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    let print = &answer["print"];
    assert_eq!(answer["cells"], 12);
    let fates = print["colours"].as_array().unwrap();
    assert_eq!(fates.len(), 12);
    for fate in fates {
        let wanted: [u8; 3] = serde_json::from_value(fate["wanted_rgb"].clone()).unwrap();
        let printable = cells.iter().find(|(rgb, _)| *rgb == wanted).unwrap().1;
        assert_eq!(fate["is_printable"], printable, "{fate}");
        // What is advised comes out of this printer as promised.
        let ask: [u8; 3] = serde_json::from_value(fate["best_ask_rgb"].clone()).unwrap();
        let got = PLAIN_PAPER.truth(ask);
        let promised = fate["best_delta_e"].as_f64().unwrap();
        assert!(
            (got.delta_e(Lab::from_rgb(wanted)) - promised).abs() < 2.0,
            "{fate} gives {got:?}"
        );
    }
    assert_eq!(print["out_of_gamut_share"], 0.5);
    let preview = Pattern::load(Path::new(&name("preview.png"))).unwrap();
    let wrong = grid.pixels().zip(preview.cells().pixels());
    let wrong = wrong.map(|(asked, shown)| Lab::from_rgb(shown.0).delta_e(PLAIN_PAPER.truth(asked.0)));
    let worst = wrong.fold(0.0, f64::max);
    println!("preview: worst ΔE2000 {worst:.2} from the simulated print");
    assert!(worst < 3.0);
    // The report says how far the print is off, as the simulated printer knows.
    let skyline = common::skyline().display().to_string();
    let (named, printer) = (format!("random={}", name("p.png")), name("printer.toml"));
    done(&format!(
        "score {skyline} --recorded --detector yolox_nano --pattern {named} --printer {printer} -o {}",
        name("report")
    ));
    let off: f64 = grid
        .pixels()
        .map(|cell| Lab::from_rgb(cell.0).delta_e(PLAIN_PAPER.truth(cell.0)))
        .sum::<f64>()
        / 12.0;
    let summary = common::read_json(&folder.path().join("report/summary.json"));
    let said = summary["provenance"]["patterns"][0]["print_delta_e"].as_f64().unwrap();
    println!("print off by ΔE2000 {said:.2}, in truth {off:.2}");
    assert!((said - off).abs() < 1.0);
    let nps = nps_by_hand(&name("printer.toml"), &grid);
    assert!((print["nps"].as_f64().unwrap() - nps).abs() < 1e-12, "{nps}");

    printer_files_with_colours(&name, &check);
    let plain = scaleproof(&format!("pattern check {}", name("p.png")));
    let text = stdout(&plain);
    assert!(
        text.contains("12 cells in 12 colours") && text.contains("nothing is said about printing"),
        "{text}"
    );
    assert_refused(
        &scaleproof(&format!("{check} -o {}", name("p.png"))),
        &["p.png is an input"],
    );
    let over_photo = scaleproof(&format!("colour read {} -o {}", photo.display(), photo.display()));
    assert_refused(&over_photo, &["photo.jpg", "cannot be used"]);
    assert_eq!(std::fs::read(&photo).unwrap(), before);
}

/// Mean over cells of the distance to the nearest measured colour, read from the file without the program's own types.
fn nps_by_hand(printer: &str, grid: &RgbImage) -> f64 {
    let file: toml::Table = std::fs::read_to_string(printer).unwrap().parse().unwrap();
    let patches = file["colour"]["patches"].as_array().unwrap();
    let mut sum = 0.0;
    for cell in grid.pixels() {
        let mut least = f64::MAX;
        for patch in patches {
            let rgb = patch["measured_rgb"].as_array().unwrap();
            let mut square = 0.0;
            for (channel, measured) in rgb.iter().enumerate() {
                let off = f64::from(cell.0[channel]) / 255.0 - measured.as_integer().unwrap() as f64 / 255.0;
                square += off * off;
            }
            least = least.min(square.sqrt());
        }
        sum += least;
    }
    sum / f64::from(grid.width() * grid.height())
}

/// Measured lengths and colours live in one file: neither loses the other, and a tampered one is refused.
fn printer_files_with_colours(name: &dyn Fn(&str) -> String, check: &str) {
    let path = name("printer.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    done(&format!(
        "print verify --x-mm 100.1 --y-mm 100 --printer {path} -o {path}"
    ));
    let again = PrinterFile::load(Path::new(&path)).unwrap();
    assert_eq!(again.printer, Correction::measured(99.3993, 99.8).unwrap());
    assert!(again.colours.is_some());
    let only_colours = text[text.find("[colour]").unwrap()..].to_owned();
    std::fs::write(&path, &only_colours).unwrap();
    // Lengths join colours without a word, as no page was printed with a correction.
    done(&format!("print verify --x-mm 99.3 --y-mm 99.8 -o {path}"));
    let joined = PrinterFile::load(Path::new(&path)).unwrap();
    assert!(joined.printer == Correction::measured(99.3, 99.8).unwrap() && joined.colours == again.colours);
    std::fs::write(&path, &only_colours).unwrap();
    done(&format!("print check --printer {path} -o {}", name("c.pdf")));
    done(check);
    let first = only_colours.lines().find(|line| line.contains("asked_rgb")).unwrap();
    for (from, to, word) in [
        ("delta_e_mean = ", "delta_e_mean = 1", "figures"),
        ("levels = [0, ", "levels = [", "ascend"),
        (first, "", "no patch for 0, 0, 0"),
        ("chart = ", "chert = ", "unknown field"),
    ] {
        assert!(only_colours.contains(from));
        std::fs::write(&path, only_colours.replacen(from, to, 1)).unwrap();
        assert_refused(&scaleproof(check), &["printer.toml", word]);
    }
    std::fs::write(&path, text).unwrap();
}
