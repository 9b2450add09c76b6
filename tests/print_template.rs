//! Prints templates, renders the PDF with poppler at 600 dpi, and measures the image.

use crate::common;
pub(super) mod measure;
pub(super) mod render;

use std::path::Path;
use std::process::Command;

use common::{assert_refused, program};
use image::{Rgb, RgbImage};
use lopdf::{Document, Object};
use measure::{Printed, assert_cell_centres, assert_edges, assert_pieces_make_the_whole, assert_rulers};
use proptest::prelude::*;
use render::{done, oblong_pattern, pages, pattern_file, scaleproof, text_of, usual_request};
use scaleproof_core::files;
use scaleproof_print::media::Media;
use scaleproof_print::paper::{Orientation, Paper, Stock};
use scaleproof_print::printer::Printer;
use scaleproof_print::template::{LayoutRequest, TemplateRect, layout};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::Card;

fn print(pattern: Pattern, tile_mm: f64, request: LayoutRequest, paper: &str) -> Printed {
    let folder = tempfile::tempdir().unwrap();
    let (png, pdf) = (pattern_file(&pattern, folder.path()), folder.path().join("t.pdf"));
    let LayoutRequest {
        size_mm: (width, height),
        overlap_mm,
        bleed_mm,
        media,
        ..
    } = request;
    let margin_mm = media.margin_mm;
    let (from, to) = (png.display(), pdf.display());
    done(&format!(
        "print template --pattern {from} --tile-mm {tile_mm} --size-mm {width}x{height} --paper {paper} \
         --overlap-mm {overlap_mm} --bleed-mm {bleed_mm} --margin-mm {margin_mm} -o {to}"
    ));
    println!("{} bytes", std::fs::metadata(&pdf).unwrap().len());
    assert!(std::fs::metadata(&pdf).unwrap().len() < 300_000);
    Printed {
        cell_mm: tile_mm / f64::from(pattern.columns()),
        size_mm: request.size_mm,
        layout: layout(&request).unwrap(),
        dpi: 600.0,
        tolerance_mm: 0.05,
        pages: pages(&pdf, 2, 600.0),
        pattern,
    }
}

/// 600×300 mm of a 16×16 pattern on A4.
#[test]
fn the_a4_template_measures_what_it_says() {
    let printed = print(Pattern::random(16, 1).unwrap(), 118.0, usual_request(), "a4");
    assert_eq!(printed.pages.len(), 6);
    for page in &printed.pages {
        assert_eq!(page.dimensions(), (7016, 4961), "A4 landscape at 600 dpi");
    }
    assert_edges(&printed, 300);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
    assert_pieces_make_the_whole(&printed);
}

/// One A3 page of a pattern that is not square.
#[test]
fn a_whole_a3_page_measures_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let request = LayoutRequest {
        size_mm: (260.0, 370.0),
        media: Media::new(Paper::A3),
        ..usual_request()
    };
    let printed = print(oblong_pattern(folder.path()), 61.7, request, "a3");
    assert_eq!(printed.pages.len(), 1);
    assert_eq!(printed.pages[0].dimensions(), (7016, 9922), "A3 portrait at 600 dpi");
    assert_edges(&printed, 1000);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
}

/// A large bleed and overlap, and cells that are cut everywhere.
#[test]
fn a_roll_measures_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let request = LayoutRequest {
        size_mm: (300.0, 250.0),
        media: Media::new(Stock::Roll { width_mm: 210.0 }),
        overlap_mm: 12.5,
        bleed_mm: 4.0,
        ..usual_request()
    };
    let printed = print(oblong_pattern(folder.path()), 61.7, request, "roll210");
    assert_eq!((printed.layout.rows, printed.layout.columns), (1, 2));
    assert_eq!(printed.layout.frame.page.height_mm, 301.0);
    assert_edges(&printed, 100);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
    assert_pieces_make_the_whole(&printed);
}

/// Cells are printed, not paper, wherever a sheet is cut: a millimetre beyond every edge of every trim.
#[test]
fn beyond_every_cut_the_pattern_goes_on() {
    let request = LayoutRequest {
        bleed_mm: 3.0,
        ..usual_request()
    };
    for sheet in &layout(&request).unwrap().sheets {
        let last = |i: usize, n: usize| i + 1 == n;
        let (trim, printed) = (sheet.trim, sheet.printed);
        let beyond = [
            (sheet.column == 0, trim.left_mm - printed.left_mm),
            (sheet.row == 0, printed.top_mm - trim.top_mm),
            (last(sheet.column, 3), printed.right_mm - trim.right_mm),
            (last(sheet.row, 2), trim.bottom_mm - printed.bottom_mm),
        ];
        for (outer, mm) in beyond {
            assert!(!outer || (mm - 3.0).abs() < 1e-9, "sheet {}: {mm} mm", sheet.id());
        }
    }
}

/// A plain pattern shows any hairline between cells, blocks or repeats, at a resolution that fits no cell.
#[test]
fn there_are_no_seams_between_cells() {
    let folder = tempfile::tempdir().unwrap();
    let [png, pdf] = ["plain.png", "t.pdf"].map(|name| folder.path().join(name));
    RgbImage::from_pixel(7, 7, Rgb([0, 40, 80])).save(&png).unwrap();
    for tile_mm in ["2.9", "31.3"] {
        let (from, to) = (png.display(), pdf.display());
        done(&format!(
            "print template --size-mm 150x200 --tile-mm {tile_mm} --pattern {from} -o {to}"
        ));
        let page = &pages(&pdf, 2, 61.0)[0];
        let request = LayoutRequest {
            size_mm: (150.0, 200.0),
            ..usual_request()
        };
        let printed = layout(&request).unwrap().sheets[0].printed;
        let px = |mm: f64| (mm / 25.4 * 61.0) as u32;
        for y in px(297.0 - printed.top_mm) + 2..px(297.0 - printed.bottom_mm) - 1 {
            for x in px(printed.left_mm) + 2..px(printed.right_mm) - 1 {
                let seen = page.get_pixel(x, y).0;
                assert_eq!(seen, [0, 40, 80], "tile {tile_mm} mm, pixel ({x}, {y})");
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
    let plans = layout(&usual_request()).unwrap().sheets;
    assert_eq!(document.page_iter().count(), 1 + plans.len(), "instructions first");
    for (page, plan) in document.page_iter().skip(1).zip(&plans) {
        let page = document.get_object(page).unwrap().as_dict().unwrap();
        let corners = |key: &[u8]| -> Vec<f64> {
            let mm = |o: &Object| f64::from(o.as_float().unwrap()) * 25.4 / 72.0;
            page.get(key).unwrap().as_array().unwrap().iter().map(mm).collect()
        };
        let edges = |r: scaleproof_print::sheet::RectMm| [r.left_mm, r.bottom_mm, r.right_mm, r.top_mm];
        let close = |a: Vec<f64>, b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.001);
        assert!(close(corners(b"MediaBox"), [0.0, 0.0, 297.0, 210.0]));
        assert!(close(corners(b"TrimBox"), edges(plan.trim)));
        assert!(close(corners(b"BleedBox"), edges(plan.printed)));
    }
}

/// Fonts are part of the file, and other programs find the file in order.
#[test]
fn fonts_are_embedded_and_the_file_is_valid() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.pdf");
    export_example(&path);
    let run = Command::new("pdffonts").arg(&path).output();
    let table = String::from_utf8(run.expect("install poppler-utils").stdout).unwrap();
    let fonts: Vec<&str> = table.lines().skip(2).collect();
    assert_eq!(fonts.len(), 1, "{table}");
    assert!(fonts[0].starts_with("LATINA+DejaVuSans"), "{table}");
    let columns: Vec<&str> = fonts[0].split_whitespace().collect();
    assert_eq!(columns[1..5], ["TrueType", "WinAnsi", "yes", "yes"], "{table}");
    match Command::new("qpdf").arg("--check").arg(&path).output() {
        Ok(check) => assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout)),
        Err(_) => println!("qpdf is not installed: not checked with it"),
    }
}

/// What a person reads is in the file as text: letters on both sides of every seam, the blanks, the arrows, the date.
#[test]
fn the_text_says_how_to_assemble() {
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("t.pdf");
    let png = pattern_file(&Pattern::random(16, 1).unwrap(), folder.path());
    let (from, to) = (png.display(), pdf.display());
    let usual = format!("print template --pattern {from} --tile-mm 118 --size-mm 600x300 -o {to}");
    let text = |page: usize| text_of(&pdf, page);
    done(&usual);
    for words in [
        "How to assemble",
        "x measured",
        "y measured",
        "--x-mm",
        "B3",
        "no printer correction",
    ] {
        assert!(text(1).contains(words), "{words} is not in: {}", text(1));
    }
    // Sheets A1, A2, A3, B1, B2, B3 on pages 2 to 7.
    for (page, seams) in [
        (2, "A C"),
        (3, "A B D"),
        (4, "B E"),
        (5, "C F"),
        (6, "D F G"),
        (7, "E G"),
    ] {
        let words = text(page);
        let mut letters: Vec<&str> = words
            .lines()
            .map(str::trim)
            .filter(|l| l.len() == 1 && *l >= "A")
            .collect();
        letters.sort_unstable();
        assert_eq!(letters.join(" "), seams, "page {page}: {words}");
        assert!(words.contains("UP") && words.contains("FRONT"), "{words}");
    }
    done(&format!("{usual} --date 2026-11-21 --front none"));
    assert!(
        text(2).contains("2026-11-21") && !text(2).contains("FRONT"),
        "{}",
        text(2)
    );
}

#[test]
fn a_hundred_sheets_are_one_document() {
    let folder = tempfile::tempdir().unwrap();
    let png = pattern_file(&Pattern::random(16, 1).unwrap(), folder.path());
    let (from, to) = (png.display(), folder.path().join("t.pdf"));
    done(&format!(
        "print template --pattern {from} --tile-mm 118 --size-mm 2590x1590 --orientation landscape -o {}",
        to.display()
    ));
    assert_eq!(Document::load(&to).unwrap().page_iter().count(), 101);
}

/// Makes the example that ships, by the commands of its README.
fn export_example(pdf: &Path) {
    let pattern = pdf.with_file_name("random16.png");
    let (pattern, pdf) = (pattern.display(), pdf.display());
    done(&format!("pattern random --cells 16 --seed 1 -o {pattern}"));
    done(&format!(
        "print template --pattern {pattern} --tile-mm 118 --size-mm 600x300 --paper a4 -o {pdf}"
    ));
}

#[test]
fn the_same_input_gives_the_same_bytes_as_the_shipped_examples() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("random16_118mm_a4.pdf");
    export_example(&made);
    let first = std::fs::read(&made).unwrap();
    export_example(&made);
    assert!(first == std::fs::read(&made).unwrap(), "two runs differ");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (pattern, svg, printer) = (path("random16.png"), path("random16_118mm.svg"), path("printer.toml"));
    done(&format!(
        "print template --pattern {pattern} --tile-mm 118 --size-mm 180x120 -o {svg}"
    ));
    done(&format!("print check -o {}", path("check_a4.pdf")));
    done(&format!("print verify --x-mm 99.3 --y-mm 99.8 -o {printer}"));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("print_templates");
    for name in [
        "random16.png",
        "random16_118mm_a4.pdf",
        "random16_118mm-assembly.svg",
        "random16_118mm-A1.svg",
        "check_a4.pdf",
        "printer.toml",
    ] {
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
    ("--size-mm", "90000x90000", "more than 2000"),
    ("--size-mm", "1e300x1e300", "more than 2000"),
    ("--paper", "100x100", "too small"),
    ("--paper", "b7", "is not known"),
    ("--margin-mm", "60", "too small"),
    ("--margin-mm", "-1", "margin cannot be -1"),
    ("--overlap-mm", "190", "leave nothing"),
    ("--overlap-mm", "nan", "overlap cannot be NaN"),
    ("--bleed-mm", "-1", "bleed cannot be -1"),
    ("--bleed-mm", "90", "a bleed of 90 mm leave nothing"),
    ("--paper", "roll90", "too small"),
    ("--paper", "roll", "is not known"),
    ("--date", "2026-02-30", "is no date"),
    ("--printer", "absent.toml", "cannot be used"),
    ("--printer", "good.png", "cannot be used"),
    ("--scale", "0", "scale cannot be 0"),
    ("--scale", "1e308", "from 0.01 to 10000"),
    ("--pattern", "absent.png", "no such file"),
    ("--pattern", "text.png", "is not a PNG"),
    ("--pattern", "glass.png", "see-through"),
    ("--pattern", "photo.png", "at most 512×512"),
];

#[test]
fn the_card_beside_a_pattern_says_how_large_a_repeat_is() {
    let folder = tempfile::tempdir().unwrap();
    let pattern = folder.path().join("dta.png");
    let made = program()
        .args(["pattern", "random", "--cells", "8", "--seed", "3", "-o"])
        .arg(&pattern)
        .output();
    assert!(made.unwrap().status.success());
    let printed = |name: &str, tile_mm: Option<&str>| {
        let out = folder.path().join(name);
        let mut command = program();
        command
            .args(["print", "template", "--size-mm", "200x100", "--pattern"])
            .arg(&pattern)
            .arg("-o")
            .arg(&out);
        tile_mm.map(|mm| command.args(["--tile-mm", mm]));
        (command.output().unwrap(), std::fs::read(out).ok())
    };
    assert_refused(&printed("none.pdf", None).0, &["no card", "--tile-mm"]);
    let write = |tile_mm: f64, bytes: &[u8]| {
        let card = Card {
            pattern_sha256: files::sha256_hex(bytes),
            tile_mm,
            sides: false,
            about: serde_json::Map::new(),
        };
        let (path, text) = card.to_file(&pattern).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let bytes = std::fs::read(&pattern).unwrap();
    write(61.5, &bytes);
    let (by_card, given, other) = (
        printed("card.pdf", None).1,
        printed("a.pdf", Some("61.5")).1,
        printed("b.pdf", Some("80")).1,
    );
    assert!(by_card.is_some() && by_card == given && by_card != other);
    write(61.5, b"another pattern");
    assert_refused(&printed("other.pdf", None).0, &["dta.json", "another pattern"]);
    write(-1.0, &bytes);
    assert_refused(&printed("wrong.pdf", None).0, &["dta.json", "tile_mm"]);
}

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
        let value = if ["--pattern", "--printer"].contains(option) {
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
        let output = scaleproof(&args.join(" "));
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
        bleed_mm in 0.0..15.0f64,
        stretch in (96.0..104.0f64, 96.0..104.0f64),
        margin_mm in 0.0..12.0f64,
    ) {
        let printer = Printer::measured(stretch.0, stretch.1).unwrap();
        let media = Media { margin_mm, printer, ..Media::new(paper) };
        let request = LayoutRequest { size_mm, media, orientation, overlap_mm, bleed_mm };
        let made = layout(&request).unwrap();
        prop_assert_eq!(made.sheets.len(), made.rows * made.columns);
        for (i, sheet) in made.sheets.iter().enumerate() {
            prop_assert_eq!((sheet.row, sheet.column), (i / made.columns, i % made.columns));
            let TemplateRect { left_mm, top_mm, right_mm, bottom_mm } = sheet.own;
            prop_assert!(left_mm < right_mm && top_mm < bottom_mm);
            // Bit-equal edges with the neighbours and the template: no gap, no double cover.
            let right = if sheet.column + 1 < made.columns { made.sheets[i + 1].own.left_mm } else { size_mm.0 };
            let bottom = if sheet.row + 1 < made.rows { made.sheets[i + made.columns].own.top_mm } else { size_mm.1 };
            prop_assert_eq!((right_mm, bottom_mm), (right, bottom));
            prop_assert!(sheet.column > 0 || left_mm == 0.0);
            prop_assert!(sheet.row > 0 || top_mm == 0.0);
            let strip = (sheet.carried.right_mm - right_mm, sheet.carried.bottom_mm - bottom_mm);
            let expected = |more: bool| if more { overlap_mm } else { bleed_mm };
            prop_assert!((strip.0 - expected(sheet.column + 1 < made.columns)).abs() < 1e-6);
            prop_assert!((strip.1 - expected(sheet.row + 1 < made.rows)).abs() < 1e-6);
            let (printed, usable, printable) = (sheet.printed, made.frame.usable, made.frame.printable);
            prop_assert!(printed.left_mm >= usable.left_mm - 1e-6 && printed.right_mm <= usable.right_mm + 1e-6);
            prop_assert!(printed.bottom_mm >= usable.bottom_mm - 1e-6 && printed.top_mm <= usable.top_mm + 1e-6);
            prop_assert!(usable.left_mm > printable.left_mm && usable.right_mm < printable.right_mm);
            prop_assert!((sheet.trim.width_mm() - (right_mm - left_mm)).abs() < 1e-9);
        }
    }
}

#[test]
fn one_row_is_called_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("t.pdf");
    let mut command = common::program();
    command.args([
        "print",
        "template",
        "--tile-mm",
        "118",
        "--size-mm",
        "350x150",
        "--pattern",
    ]);
    command
        .arg(common::home().join("print_templates/random16.png"))
        .arg("-o")
        .arg(&pdf);
    let said = common::stdout(&command.output().unwrap());
    assert!(said.contains("2 sheets (1 row of 2)"), "{said}");
}
