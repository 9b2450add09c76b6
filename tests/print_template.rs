//! Prints templates, renders the PDF with poppler at 300 dpi, and measures the picture.

#[path = "print_template/measure.rs"]
mod measure;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::{Rgb, RgbImage};
use lopdf::{Document, Object};
use measure::{Printed, assert_cell_centres, assert_edges, assert_pieces_make_the_whole, assert_rulers};
use proptest::prelude::*;
use scaleproof::pattern::Pattern;
use scaleproof::print::paper::{Orientation, Paper};
use scaleproof::print::template::{LayoutRequest, Region, layout};

fn scaleproof(args: &[&str]) -> Output {
    Command::new(assert_cmd::cargo::cargo_bin!("scaleproof"))
        .args(args)
        .output()
        .unwrap()
}

fn print(pattern: Pattern, tile_mm: f64, request: LayoutRequest, paper: &str) -> Printed {
    let folder = tempfile::tempdir().unwrap();
    let [png, pdf] = ["p.png", "t.pdf"].map(|name| folder.path().join(name));
    std::fs::write(&png, pattern.to_png().unwrap()).unwrap();
    let LayoutRequest {
        size_mm: (width, height),
        overlap_mm,
        margin_mm,
        ..
    } = request;
    let (from, to) = (png.display(), pdf.display());
    let command = format!(
        "print template --pattern {from} --tile-mm {tile_mm} --size-mm {width}x{height} --paper {paper} \
         --overlap-mm {overlap_mm} --margin-mm {margin_mm} -o {to}"
    );
    let output = scaleproof(&command.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Printed {
        cell_mm: tile_mm / f64::from(pattern.columns()),
        size_mm: request.size_mm,
        layout: layout(&request).unwrap(),
        pdf: std::fs::read(&pdf).unwrap(),
        pages: render(&pdf, folder.path()),
        pattern,
    }
}

/// The template of the issue: 600×300 mm of a 16×16 pattern on A4.
fn on_a4() -> Printed {
    print(Pattern::random(16, 1).unwrap(), 118.0, on_a4_request(), "a4")
}

/// One A3 page of a pattern that is not square.
fn on_a3() -> Printed {
    let request = LayoutRequest {
        size_mm: (260.0, 370.0),
        paper: Paper::A3,
        ..on_a4_request()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    let wide = Pattern::random(9, 4).unwrap();
    image::imageops::crop_imm(wide.cells(), 0, 0, 9, 5)
        .to_image()
        .save(&path)
        .unwrap();
    print(Pattern::load(&path).unwrap(), 61.7, request, "a3")
}

fn on_a4_request() -> LayoutRequest {
    let size_mm = (600.0, 300.0);
    LayoutRequest {
        size_mm,
        paper: Paper::A4,
        orientation: Orientation::Auto,
        overlap_mm: 8.0,
        margin_mm: 5.0,
    }
}

fn render(pdf: &Path, folder: &Path) -> Vec<RgbImage> {
    render_at("300", pdf, folder)
}

fn render_at(dpi: &str, pdf: &Path, folder: &Path) -> Vec<RgbImage> {
    let stem = folder.join("page");
    let run = Command::new("pdftoppm")
        .args(["-r", dpi, "-png"])
        .arg(pdf)
        .arg(&stem)
        .status();
    let status = run.expect("this test renders the PDF with pdftoppm: install poppler-utils");
    assert!(status.success(), "pdftoppm failed on {}", pdf.display());
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.retain(|path| path.file_name().unwrap().to_string_lossy().starts_with("page-"));
    files.sort();
    files.iter().map(|path| image::open(path).unwrap().to_rgb8()).collect()
}

#[test]
fn the_a4_template_measures_what_it_says() {
    let printed = on_a4();
    assert_eq!(printed.pages.len(), 6);
    for page in &printed.pages {
        assert_eq!(page.dimensions(), (3508, 2481), "A4 landscape at 300 dpi");
    }
    assert_edges(&printed, 300);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
    assert_pieces_make_the_whole(&printed);
}

#[test]
fn a_whole_a3_page_measures_what_it_says() {
    let printed = on_a3();
    assert_eq!(printed.pages.len(), 1);
    assert_eq!(printed.pages[0].dimensions(), (3508, 4961), "A3 portrait at 300 dpi");
    assert_edges(&printed, 1000);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
    assert!(printed.pdf.len() < 300_000);
    println!("A3: {} bytes", printed.pdf.len());
}

/// A plain pattern shows any hairline between cells, blocks or repeats, at a resolution that fits no cell.
#[test]
fn there_are_no_seams_between_cells() {
    let folder = tempfile::tempdir().unwrap();
    let [png, pdf] = ["plain.png", "t.pdf"].map(|name| folder.path().join(name));
    RgbImage::from_pixel(7, 7, Rgb([0, 40, 80])).save(&png).unwrap();
    for tile_mm in ["2.9", "31.3"] {
        let args = [
            "print",
            "template",
            "--size-mm",
            "150x200",
            "--tile-mm",
            tile_mm,
            "--pattern",
        ];
        let paths = [png.to_str().unwrap(), "-o", pdf.to_str().unwrap()];
        assert!(scaleproof(&[&args[..], &paths].concat()).status.success());
        let page = &render_at("61", &pdf, folder.path())[0];
        let printed = layout(&LayoutRequest {
            size_mm: (150.0, 200.0),
            ..on_a4_request()
        })
        .unwrap()
        .sheets[0]
            .printed;
        let px = |mm: f64| (mm / 25.4 * 61.0) as u32;
        for y in px(297.0 - printed.top_mm) + 2..px(297.0 - printed.bottom_mm) - 1 {
            for x in px(printed.left_mm) + 2..px(printed.right_mm) - 1 {
                assert_eq!(
                    page.get_pixel(x, y).0,
                    [0, 40, 80],
                    "tile {tile_mm} mm, pixel ({x}, {y})"
                );
            }
        }
    }
}

#[test]
fn the_file_tells_viewers_not_to_scale_it_and_has_its_trim() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.pdf");
    export_example(&path);
    let document = Document::load(&path).unwrap();
    let preferences = document
        .catalog()
        .unwrap()
        .get(b"ViewerPreferences")
        .unwrap()
        .as_dict()
        .unwrap();
    assert_eq!(preferences.get(b"PrintScaling").unwrap().as_name().unwrap(), b"None");
    assert!(preferences.get(b"PickTrayByPDFSize").unwrap().as_bool().unwrap());
    let plans = layout(&on_a4_request()).unwrap().sheets;
    for (page, plan) in document.page_iter().zip(&plans) {
        let page = document.get_object(page).unwrap().as_dict().unwrap();
        let corners = |key: &[u8]| -> Vec<f64> {
            let mm = |o: &Object| f64::from(o.as_float().unwrap()) * 25.4 / 72.0;
            page.get(key).unwrap().as_array().unwrap().iter().map(mm).collect()
        };
        let t = plan.trim;
        let close = |a: Vec<f64>, b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.001);
        assert!(close(corners(b"MediaBox"), [0.0, 0.0, 297.0, 210.0]));
        assert!(close(
            corners(b"TrimBox"),
            [t.left_mm, t.bottom_mm, t.right_mm, t.top_mm]
        ));
    }
}

/// Makes the example that ships, by the commands of its README.
fn export_example(pdf: &Path) {
    let pattern = pdf.with_file_name("random16.png");
    let [pattern, pdf] = [&pattern, pdf].map(|path| path.to_str().unwrap());
    let commands = [
        format!("pattern random --cells 16 --seed 1 -o {pattern}"),
        format!("print template --pattern {pattern} --tile-mm 118 --size-mm 600x300 --paper a4 -o {pdf}"),
    ];
    for command in commands {
        let output = scaleproof(&command.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn the_same_input_gives_the_same_bytes_as_the_shipped_example() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("random16_118mm_a4.pdf");
    export_example(&made);
    let first = std::fs::read(&made).unwrap();
    export_example(&made);
    assert!(first == std::fs::read(&made).unwrap(), "two runs differ");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("print_templates");
    for name in ["random16.png", "random16_118mm_a4.pdf"] {
        let (ours, theirs) = (folder.path().join(name), shipped.join(name));
        assert!(
            std::fs::read(ours).unwrap() == std::fs::read(&theirs).unwrap(),
            "{} is out of date: its README says how to make it again",
            theirs.display()
        );
    }
}

/// Every impossible request: what is changed in a good one, and a word of the answer.
const REFUSALS: &[(&str, &str, &str)] = &[
    ("--tile-mm", "0", "tile width cannot be 0"),
    ("--tile-mm", "-118", "tile width cannot be -118"),
    ("--tile-mm", "nan", "tile width cannot be NaN"),
    ("--tile-mm", "inf", "tile width cannot be inf"),
    ("--tile-mm", "3", "smaller than the 0.2 mm"),
    ("--size-mm", "0x300", "template width cannot be 0"),
    ("--size-mm", "600x-1", "template height cannot be -1"),
    ("--size-mm", "wide", "as in 600x300"),
    ("--size-mm", "90000x90000", "more than 400"),
    ("--size-mm", "1e300x1e300", "more than 400"),
    ("--paper", "100x100", "too small"),
    ("--paper", "b7", "is not known"),
    ("--margin-mm", "60", "too small"),
    ("--margin-mm", "-1", "margin cannot be -1"),
    ("--overlap-mm", "190", "leaves nothing"),
    ("--overlap-mm", "nan", "overlap cannot be NaN"),
    ("--scale", "0", "scale cannot be 0"),
    ("--pattern", "absent.png", "no such file"),
    ("--pattern", "text.png", "is not a PNG"),
    ("--pattern", "glass.png", "see-through"),
    ("--pattern", "photo.png", "at most 512×512"),
];

#[test]
fn impossible_requests_are_refused_in_one_sentence_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("good.png"), Pattern::random(16, 1).unwrap().to_png().unwrap()).unwrap();
    std::fs::write(path("text.png"), "not a picture").unwrap();
    image::RgbaImage::new(4, 4).save(path("glass.png")).unwrap();
    RgbImage::new(640, 480).save(path("photo.png")).unwrap();
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    for (option, value, word) in REFUSALS {
        let value = if *option == "--pattern" {
            path(value)
        } else {
            (*value).to_owned()
        };
        let good = [
            ("--pattern", path("good.png")),
            ("--tile-mm", "118".into()),
            ("--size-mm", "600x300".into()),
        ];
        let mut args = vec![
            "print".to_owned(),
            "template".to_owned(),
            "-o".to_owned(),
            path("out/t.pdf"),
        ];
        let kept = good.into_iter().filter(|(name, _)| name != option);
        args.extend(
            kept.chain([(*option, value)])
                .flat_map(|(name, value)| [name.to_owned(), value]),
        );
        let output = scaleproof(&args.iter().map(String::as_str).collect::<Vec<_>>());
        let said = String::from_utf8(output.stderr).unwrap();
        println!("{}", said.trim_end());
        assert_eq!(output.status.code(), Some(2), "{option}: {said}");
        assert!(
            said.starts_with("error: ") && said.lines().count() == 1 && said.contains(word),
            "{option}: {said}"
        );
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            before,
            "{option} left a file"
        );
    }
}

proptest! {
    #[test]
    fn own_regions_tile_the_template_and_everything_is_printable(
        size_mm in (1.0..1500.0f64, 1.0..1500.0f64),
        paper in prop::sample::select(vec![Paper::A4, Paper::A3, Paper::LETTER, Paper::TABLOID]),
        orientation in prop::sample::select(vec![Orientation::Auto, Orientation::Portrait, Orientation::Landscape]),
        overlap_mm in 0.0..40.0f64,
        margin_mm in 0.0..12.0f64,
    ) {
        let request = LayoutRequest { size_mm, paper, orientation, overlap_mm, margin_mm };
        let made = layout(&request).unwrap();
        prop_assert_eq!(made.sheets.len(), made.rows * made.columns);
        for (i, sheet) in made.sheets.iter().enumerate() {
            prop_assert_eq!((sheet.row, sheet.column), (i / made.columns, i % made.columns));
            let Region { left_mm, top_mm, right_mm, bottom_mm } = sheet.own;
            prop_assert!(left_mm < right_mm && top_mm < bottom_mm);
            // Bit-equal edges with the neighbours and the template: no gap, no double cover.
            let right = if sheet.column + 1 < made.columns { made.sheets[i + 1].own.left_mm } else { size_mm.0 };
            let bottom = if sheet.row + 1 < made.rows { made.sheets[i + made.columns].own.top_mm } else { size_mm.1 };
            prop_assert_eq!((right_mm, bottom_mm), (right, bottom));
            prop_assert!(sheet.column > 0 || left_mm == 0.0);
            prop_assert!(sheet.row > 0 || top_mm == 0.0);
            let strip = (sheet.carried.right_mm - right_mm, sheet.carried.bottom_mm - bottom_mm);
            let expected = |more: bool| if more { overlap_mm } else { 0.0 };
            prop_assert!((strip.0 - expected(sheet.column + 1 < made.columns)).abs() < 1e-6);
            prop_assert!((strip.1 - expected(sheet.row + 1 < made.rows)).abs() < 1e-6);
            let (printed, usable, printable) = (sheet.printed, made.usable, made.printable);
            prop_assert!(printed.left_mm >= usable.left_mm - 1e-6 && printed.right_mm <= usable.right_mm + 1e-6);
            prop_assert!(printed.bottom_mm >= usable.bottom_mm - 1e-6 && printed.top_mm <= usable.top_mm + 1e-6);
            prop_assert!(usable.left_mm > printable.left_mm && usable.right_mm < printable.right_mm);
            prop_assert!((sheet.trim.width_mm() - (right_mm - left_mm)).abs() < 1e-9);
        }
    }
}
