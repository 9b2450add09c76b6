//! The check page measured, printer files made and refused, and a stretching printer corrected.

use crate::common;
use crate::print_template::measure;
use crate::print_template::render;

use std::path::Path;

use common::assert_refused;
use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use measure::{Printed, assert_cell_centres, assert_edges, assert_rulers, dark_lines_mm};
use render::{done, pages, pattern_file, scaleproof, usual_request};
use scaleproof_print::check;
use scaleproof_print::media::Media;
use scaleproof_print::paper::Paper;
use scaleproof_print::printer::Printer;
use scaleproof_print::template::{LayoutRequest, layout};
use scaleproof_surface::pattern::Pattern;

/// What a printer does that makes `x` and `y` mm of 100 mm, with the page's centre where it belongs.
fn stretched(page: &RgbImage, x: f64, y: f64) -> RgbImage {
    let (width, height) = page.dimensions();
    let new = |side: u32, measured: f64| (f64::from(side) * measured / 100.0).round() as u32;
    let (new_width, new_height) = (new(width, x), new(height, y));
    let picture = imageops::resize(page, new_width, new_height, FilterType::Triangle);
    let mut paper = RgbImage::from_pixel(width, height, Rgb([255; 3]));
    let offset = |side: u32, new: u32| (i64::from(side) - i64::from(new)) / 2;
    imageops::replace(
        &mut paper,
        &picture,
        offset(width, new_width),
        offset(height, new_height),
    );
    paper
}

fn printer_file(x_mm: f64, y_mm: f64, folder: &Path) -> String {
    let file = folder.join("printer.toml").display().to_string();
    done(&format!("print verify --x-mm {x_mm} --y-mm {y_mm} -o {file}"));
    file
}

/// Portrait and landscape: the printer's x is the paper's short side either way.
#[test]
fn a_corrected_template_comes_out_true_on_its_printer() {
    for (size_mm, turned, (x_mm, y_mm)) in [
        ((170.0, 220.0), false, (97.5, 101.2)),
        ((250.0, 150.0), true, (99.3, 98.1)),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let printer = printer_file(x_mm, y_mm, folder.path());
        let pattern = Pattern::random(16, 1).unwrap();
        let (png, pdf) = (pattern_file(&pattern, folder.path()), folder.path().join("t.pdf"));
        done(&format!(
            "print template --pattern {} --tile-mm 118 --size-mm {}x{} --printer {printer} -o {}",
            png.display(),
            size_mm.0,
            size_mm.1,
            pdf.display()
        ));
        let request = LayoutRequest {
            size_mm,
            media: Media {
                printer: Printer::measured(x_mm, y_mm).unwrap(),
                ..Media::new(Paper::A4)
            },
            ..usual_request()
        };
        let layout = layout(&request).unwrap();
        assert_eq!((layout.sheets.len(), layout.frame.setup.turned), (1, turned));
        let drawn = pages(&pdf, 2, 600.0);
        let (along_x, along_y) = if turned { (y_mm, x_mm) } else { (x_mm, y_mm) };
        let printed = Printed {
            cell_mm: 7.375,
            size_mm,
            dpi: 600.0,
            tolerance_mm: 0.1,
            pages: drawn.iter().map(|page| stretched(page, along_x, along_y)).collect(),
            pattern,
            layout,
        };
        assert_edges(&printed, 300);
        assert_rulers(&printed);
        assert_cell_centres(&printed);
        let pdf = lopdf::Document::load(&pdf).unwrap();
        assert!(pdf.extract_text(&[2]).unwrap().contains("printer correction x"));
    }
}

#[test]
fn the_check_page_measures_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("c.pdf");
    for (option, x_mm, y_mm) in [("", 100.0, 100.0), (" --printer ", 96.5, 102.5)] {
        let file = if option.is_empty() {
            String::new()
        } else {
            printer_file(x_mm, y_mm, folder.path())
        };
        done(&format!("print check{option}{file} -o {}", pdf.display()));
        let plan = check::plan(&Media {
            printer: Printer::measured(x_mm, y_mm).unwrap(),
            ..Media::new(Paper::A4)
        });
        let plan = plan.unwrap();
        let drawn = pages(&pdf, 1, 600.0);
        assert_eq!(drawn.len(), 1);
        let page = stretched(&drawn[0], x_mm, y_mm);
        let top = plan.frame.page.height_mm;
        let (square, long_box) = (plan.square, plan.long_box);
        for area in [square, long_box] {
            // Off the middle, where the diagonals cross each other.
            let (x, y) = (area.left_mm + 30.0, top - area.bottom_mm - 20.0);
            let across = dark_lines_mm(&page, 600.0, false, y, &[area.left_mm, area.right_mm]);
            let down = dark_lines_mm(&page, 600.0, true, x, &[top - area.top_mm, top - area.bottom_mm]);
            println!("{:?} {:?}", across[1] - across[0], down[1] - down[0]);
            assert!((across[1] - across[0] - area.width_mm()).abs() < 0.05);
            assert!((down[1] - down[0] - area.height_mm()).abs() < 0.05);
        }
        let quarter = square.left_mm + 25.0;
        let diagonals = [top - square.top_mm + 25.0, top - square.top_mm + 75.0];
        let seen = dark_lines_mm(&page, 600.0, true, quarter, &diagonals);
        assert!(
            seen.iter().zip(diagonals).all(|(a, b)| (a - b).abs() < 0.06),
            "{seen:?} {diagonals:?}"
        );
    }
}

#[test]
fn what_no_printer_does_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let verify = |lengths: &str| scaleproof(&format!("print verify {lengths} -o {}", path("p.toml")));
    assert_refused(
        &verify("--x-mm 94 --y-mm 100"),
        &["94 mm along x", "100 % (no fit to page)"],
    );
    assert_refused(&verify("--x-mm 100 --y-mm nan"), &["NaN mm along y"]);
    assert_refused(&verify("--x-mm 9.93 --y-mm 9.98"), &["in mm"]);
    assert_refused(&verify("--x-mm 99"), &["--y-mm"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    done(&format!("print verify --x-mm 99.3 --y-mm 99.8 -o {}", path("p.toml")));
    let good = std::fs::read_to_string(path("p.toml")).unwrap();
    for (from, to, word) in [
        ("99.3", "94.3", "5 %"),
        ("1.007049", "1.2", "correction factors"),
        ("nominal_mm = 100.0", "nominal_mm = 200.0", "nominal_mm"),
        ("measured_x_mm", "x_mm", "unknown field"),
    ] {
        assert!(good.contains(from), "{good}");
        std::fs::write(path("bad.toml"), good.replace(from, to)).unwrap();
        let run = scaleproof(&format!(
            "print check --printer {} -o {}",
            path("bad.toml"),
            path("c.pdf")
        ));
        assert_refused(&run, &["bad.toml", word, "print verify"]);
    }
    for (options, word) in [
        ("--paper 150x200", "too small"),
        ("--margin-mm -1", "margin"),
        ("--date today", "no date"),
    ] {
        let run = scaleproof(&format!("print check {options} -o {}", path("c.pdf")));
        assert_refused(&run, &[word]);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// The page was printed with a correction and is still a little off: both corrections go into the new file.
#[test]
fn a_second_measurement_builds_on_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let first = printer_file(99.0, 100.0, folder.path());
    let second = folder.path().join("second.toml");
    done(&format!(
        "print verify --x-mm 100.5 --y-mm 99.9 --printer {first} -o {}",
        second.display()
    ));
    let expected = Printer::measured(99.495, 99.9).unwrap();
    assert_eq!(Printer::load(&second).unwrap(), expected);
}
