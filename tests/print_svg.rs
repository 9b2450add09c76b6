//! Prints templates as SVG, reads the files, renders them with Chromium, and measures the image.

use crate::common;
use crate::print_template::measure;
use crate::print_template::render;

use std::path::Path;

use common::chromium;
use image::RgbImage;
use measure::{Printed, assert_cell_centres, assert_edges, assert_pieces_make_the_whole, assert_rulers};
use render::{done, pattern_file, usual_request};
use roxmltree::{Document, Node};
use scaleproof_print::template::layout;
use scaleproof_surface::pattern::Pattern;

const COMMAND: &str = "print template --tile-mm 118 --size-mm 600x300 --format svg";

/// At 300 dpi: 96 CSS pixels to the inch, times the device's scale.
fn picture(svg: &Path, folder: &Path) -> RgbImage {
    let png = folder.join("page.png");
    let arguments = [
        format!("--screenshot={}", png.display()),
        "--window-size=1124,795".to_owned(),
        "--force-device-scale-factor=3.125".to_owned(),
        format!("file://{}", svg.display()),
    ];
    let output = chromium(&arguments);
    assert!(png.exists(), "no screenshot: {}", common::stderr(&output));
    let picture = image::open(&png).unwrap().to_rgb8();
    std::fs::remove_file(png).unwrap();
    picture
}

#[test]
fn the_svg_sheets_measure_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let pattern = Pattern::random(16, 1).unwrap();
    let png = pattern_file(&pattern, folder.path());
    let output = folder.path().join("t.svg");
    done(&format!(
        "{COMMAND} --pattern {} -o {}",
        png.display(),
        output.display()
    ));
    let layout = layout(&usual_request()).unwrap();
    let svg = |id: String| folder.path().join(format!("t-{id}.svg"));
    let pages = layout
        .sheets
        .iter()
        .map(|sheet| picture(&svg(sheet.id()), folder.path()));
    let printed = Printed {
        cell_mm: 7.375,
        size_mm: (600.0, 300.0),
        dpi: 300.0,
        tolerance_mm: 0.05,
        pages: pages.collect(),
        pattern,
        layout,
    };
    assert_edges(&printed, 300);
    assert_rulers(&printed);
    assert_cell_centres(&printed);
    assert_pieces_make_the_whole(&printed);
}

#[test]
fn a_sheet_is_in_millimetres_with_its_cells_defined_once() {
    let folder = tempfile::tempdir().unwrap();
    let png = pattern_file(&Pattern::random(16, 1).unwrap(), folder.path());
    let output = folder.path().join("t.svg");
    done(&format!(
        "{COMMAND} --pattern {} -o {}",
        png.display(),
        output.display()
    ));
    let mut names: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".svg"))
        .collect();
    names.sort();
    let expected = ["A1", "A2", "A3", "B1", "B2", "B3", "assembly"].map(|page| format!("t-{page}.svg"));
    assert_eq!(names, expected);
    let text = std::fs::read_to_string(folder.path().join("t-B2.svg")).unwrap();
    let document = Document::parse(&text).unwrap();
    let svg = document.root_element();
    assert_eq!(
        [
            svg.attribute("width"),
            svg.attribute("height"),
            svg.attribute("viewBox")
        ],
        [Some("297mm"), Some("210mm"), Some("0 0 297 210")]
    );
    let all = |tag: &'static str| {
        document
            .descendants()
            .filter(move |node| node.has_tag_name(("http://www.w3.org/2000/svg", tag)))
    };
    let stamp = by_id(&document, "stamp0");
    assert_eq!(stamp.children().filter(Node::is_element).count(), 256);
    assert_eq!(all("clipPath").count(), 1);
    assert!(all("use").count() >= 1);
    for placed in all("use") {
        assert_eq!(
            placed.attribute(("http://www.w3.org/1999/xlink", "href")),
            Some("#stamp0")
        );
        assert_eq!(placed.parent().unwrap().attribute("clip-path"), Some("url(#clip0)"));
    }
    // The outline of the piece, for a cutter: hidden, and exactly the trim.
    let cut = by_id(&document, "cut");
    assert_eq!(cut.attribute("style"), Some("display:none"));
    let outline = cut.children().find(Node::is_element).unwrap();
    let number = |name| outline.attribute(name).unwrap().parse::<f64>().unwrap();
    let plan = &layout(&usual_request()).unwrap().sheets[4];
    assert!((number("width") - plan.trim.width_mm()).abs() < 1e-3);
    assert!((number("x") - plan.trim.left_mm).abs() < 1e-3 && (number("y") - (210.0 - plan.trim.top_mm)).abs() < 1e-3);
}

fn by_id<'a>(document: &'a Document, id: &str) -> Node<'a, 'a> {
    document
        .descendants()
        .find(|node| node.attribute("id") == Some(id))
        .unwrap()
}

/// A folder in the way of the last sheet: none of the others is left.
#[test]
fn a_write_that_fails_leaves_no_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let png = pattern_file(&Pattern::random(16, 1).unwrap(), folder.path());
    std::fs::create_dir(folder.path().join("t-B3.svg")).unwrap();
    let output = folder.path().join("t.svg");
    let run = render::scaleproof(&format!(
        "{COMMAND} --pattern {} -o {}",
        png.display(),
        output.display()
    ));
    common::assert_refused(&run, &["t-B3.svg", "folder"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}
