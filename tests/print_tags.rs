//! Prints the tags of scenes, renders the PDF with poppler, finds the tags again with the detector, folds the cards, and lays
//! the mat together.

use crate::common;
mod fold;
pub(super) mod paper;

use std::path::Path;

use common::{assert_refused, home, program, stderr, stdout};
use image::GrayImage;
use paper::{A4, Page, distance, render};
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_print::media::Media;
use scaleproof_print::paper::{Paper, Stock};
use scaleproof_print::sheet::{Mark, Sheet};
use scaleproof_print::tags::{TagRequest, TagSheets, arrange, tag_sheets};

/// Runs the program; it must succeed.
fn run(folder: &Path, command: &str) -> String {
    let output = program().current_dir(folder).args(command.split(' ')).output().unwrap();
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    stdout(&output)
}

fn scene(path: &Path) -> Scene {
    Scene::open(path).unwrap()
}

const RING: &str =
    "scene new --preset ring --radius-mm 330 --tags 6 --tag-mm 40 --model-size-mm 455x186x128 -o ring.toml";

/// Every family, tags of several sizes, at places and angles that make no tent and no mat.
const ALL_FAMILIES: &str = "[model]\nname = \"m\"\nscale = 10\nclass = \"car\"\nsize_mm = [455, 186, 128]\n\
    [bins]\nazimuth_deg = 45\npitch_deg = [0]\ndistance_mm = [900]\n";

fn all_families() -> String {
    let mut text = ALL_FAMILIES.to_owned();
    for (family, name) in TagFamily::ALL {
        for (n, size_mm) in [(0, 30.0), (7, 41.3), (family.count() - 1, 55.0)] {
            text += &format!(
                "[[tag]]\nid = {n}\nfamily = \"{name}\"\nsize_mm = {size_mm}\ncentre_mm = [0, 300, 90]\n\
                 right = [1, 0, 0]\nup = [0, 0, 1]\n"
            );
        }
    }
    text
}

#[test]
fn plain_cards_carry_the_right_tags_at_true_size() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), all_families()).unwrap();
    run(folder.path(), "print tags --scene s.toml -o tags.pdf");
    let scene = scene(&folder.path().join("s.toml"));
    let (pages, families) = (render(&folder.path().join("tags.pdf"), 300, A4), scene.families());
    let (mut found, mut worst) = (Vec::new(), 0.0_f64);
    for page in pages {
        for (family, id, corners) in page.tags(&families) {
            let Some(tag) = scene.tag(family, id) else { continue };
            found.push((family, id));
            assert!(
                corners[0][0] < corners[1][0] && corners[3][1] < corners[0][1],
                "tag {id} is not upright"
            );
            for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
                let error = (distance(corners[a], corners[b]) - tag.size_mm).abs();
                assert!(error < 0.1, "tag {id} of {family:?}: a side is {error:.3} mm off");
                worst = worst.max(error);
            }
        }
    }
    found.sort();
    let mut wanted: Vec<_> = scene.tags.iter().map(|tag| (tag.family, tag.id)).collect();
    wanted.sort();
    assert_eq!(found, wanted, "each tag once");
    println!(
        "{} tags of 5 families, sides within {worst:.3} mm at 300 dpi",
        found.len()
    );
}

/// Detects the printed tags, folds the sheet along its printed lines, stands it on its outline on the mat, and compares with
/// the scene.
fn assert_cards_fold_to_the_scene(folder: &Path, file: &Path) {
    let scene = scene(file);
    let pdf = folder.join("folded.pdf");
    run(
        folder,
        &format!("print tags --scene {} -o {}", file.display(), pdf.display()),
    );
    let request = TagRequest {
        media: Media::new(Paper::A4),
        plain: false,
        whole_mat: false,
    };
    let (made, tents) = (tag_sheets(&scene, &request).unwrap(), arrange(&scene).tents);
    let pages = render(&pdf, 300, A4);
    assert_eq!(pages.len(), made.sheets.len());
    let mut worst = (0.0_f64, 0.0_f64);
    let mut cards = 0;
    for (page, sheet) in pages.iter().zip(&made.sheets) {
        for card in fold::Card::on(sheet) {
            let tags = page.tags(&scene.families());
            let on_card: Vec<_> = tags.iter().filter(|(_, _, corners)| card.holds(corners)).collect();
            assert_eq!(on_card.len(), 2, "a card has two tags");
            let tent = tents
                .iter()
                .find(|tent| tent.tags.iter().any(|tag| tag.id == on_card[0].1))
                .unwrap();
            for (family, id, corners) in on_card {
                let tag = scene.tag(*family, *id).unwrap();
                let (mm, deg) = fold::off(&card.folded(corners, &tent.foot_mm()), tag);
                assert!(mm < 0.2 && deg < 0.2, "tag {id} is {mm:.3} mm and {deg:.3}° off");
                worst = (worst.0.max(mm), worst.1.max(deg));
            }
            cards += 1;
        }
    }
    assert_eq!(cards, tents.len());
    println!(
        "{}: {cards} cards folded, tags within {:.3} mm and {:.3}° of the scene",
        file.file_name().unwrap().to_string_lossy(),
        worst.0,
        worst.1
    );
}

#[test]
fn folded_tent_cards_put_every_tag_where_the_stored_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    let file = home().join("captures/skyline/scene.toml");
    let scene = scene(&file);
    let arrangement = arrange(&scene);
    assert_eq!(
        (arrangement.flat.len(), arrangement.tents.len(), arrangement.cards.len()),
        (8, 8, 0)
    );
    assert_cards_fold_to_the_scene(folder.path(), &file);
}

#[test]
fn folded_tent_cards_put_every_tag_where_a_new_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    run(
        folder.path(),
        &RING
            .replace("ring.toml", "steep.toml --tilt-deg 73 --family tagstandard41h12")
            .replace("40", "24"),
    );
    for name in ["ring.toml", "steep.toml"] {
        assert_cards_fold_to_the_scene(folder.path(), &folder.path().join(name));
    }
}

/// The mat on one huge sheet: every flat tag and the model's outline at their places.
#[test]
fn the_mat_has_everything_where_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    run(folder.path(), "print tags --scene ring.toml --paper 900x900 -o mat.pdf");
    let scene = scene(&folder.path().join("ring.toml"));
    let pages = render(&folder.path().join("mat.pdf"), 150, (900.0, 900.0));
    let mat = pages.last().unwrap();
    let worst = worst_on_mat(mat, &scene, 0.1);
    println!("flat tags on one sheet: corners within {worst:.3} mm of the scene at 150 dpi");
}

/// The corners' largest distance from the scene, with the mat's place on the page taken from the tags' mean; checks that the
/// model's outline and the outlines of the tents are drawn there too.
fn worst_on_mat(mat: &Page, scene: &Scene, allowed_mm: f64) -> f64 {
    let tags = mat.tags(&scene.families());
    let flat = arrange(scene).flat.len();
    let pairs: Vec<_> = tags
        .iter()
        .flat_map(|(family, id, corners)| {
            let tag = scene.tag(*family, *id).unwrap();
            corners.iter().copied().zip(tag.corners_mm())
        })
        .collect();
    assert_eq!(pairs.len(), 4 * flat, "every flat tag once");
    let mean = |axis: usize| pairs.iter().map(|(seen, told)| seen[axis] - told[axis]).sum::<f64>() / pairs.len() as f64;
    let origin = [mean(0), mean(1)];
    let off =
        |(seen, told): &([f64; 2], nalgebra::Point3<f64>)| distance(*seen, [origin[0] + told.x, origin[1] + told.y]);
    let worst = pairs.iter().map(off).fold(0.0, f64::max);
    assert!(worst < allowed_mm, "a corner is {worst:.3} mm off");
    let [length, width, _] = scene.model.size_mm;
    let mut marked = vec![
        [length / 2.0, -width / 4.0],
        [-length / 2.0, width / 3.0],
        [length / 5.0, width / 2.0],
    ];
    for tent in arrange(scene).tents {
        let [a, b, ..] = tent.foot_mm();
        marked.push([0.7 * a.x + 0.3 * b.x, 0.7 * a.y + 0.3 * b.y]);
    }
    for [x, y] in marked {
        let grey = mat.is_black([origin[0] + x, origin[1] + y]);
        assert!(grey, "no outline at ({x:.1}, {y:.1})");
        for (dx, dy) in [(-1.0, -1.0), (1.0, 1.0)] {
            assert!(
                !mat.is_black([origin[0] + x + dx, origin[1] + y + dy]),
                "a blot at ({x:.1}, {y:.1})"
            );
        }
    }
    worst
}

fn made(scene: &Scene, paper: &str, whole_mat: bool) -> TagSheets {
    let media = Media::new(paper.parse::<Stock>().unwrap());
    let request = TagRequest {
        media,
        plain: false,
        whole_mat,
    };
    tag_sheets(scene, &request).unwrap()
}

/// The mat cut at the crop marks and laid together: on A4, and from a roll.
#[test]
fn the_sheets_of_the_mat_make_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    let scene = scene(&folder.path().join("ring.toml"));
    for (paper, option) in [("a4", " --whole-mat"), ("roll610", "")] {
        run(
            folder.path(),
            &format!("print tags --scene ring.toml --paper {paper}{option} -o mat.pdf"),
        );
        let made = made(&scene, paper, paper == "a4");
        let first = made
            .names
            .iter()
            .rposition(|name| name == "map" || name.contains(' '))
            .unwrap()
            + 1;
        let sheets = &made.sheets[first..];
        let pages = pictured(&folder.path().join("mat.pdf"), 200, &made.sheets);
        let whole = laid_together(&pages[first..], sheets);
        let worst = worst_on_mat(&whole, &scene, 0.3);
        println!(
            "{paper}: flat tags over {} glued sheets: corners within {worst:.3} mm of the scene",
            sheets.len()
        );
    }
}

/// Rendered pages of any sizes.
fn pictured(pdf: &Path, dpi: u32, sheets: &[Sheet]) -> Vec<Page> {
    let mut pages = render(pdf, dpi, A4);
    assert_eq!(pages.len(), sheets.len());
    for (page, sheet) in pages.iter_mut().zip(sheets) {
        page.height_mm = sheet.height_mm;
    }
    pages
}

const DEFAULT_RING: &str =
    "scene new --preset ring --radius-mm 400 --tags 8 --tag-mm 50 --model-size-mm 455x186x128 -o scene.toml";

/// No more than a dozen sheets, and every flat tag is found whole on one trimmed sheet of the mat, its white ring too.
#[test]
fn the_default_ring_takes_twelve_sheets_and_no_seam_cuts_a_tag() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), DEFAULT_RING);
    let said = run(folder.path(), "print tags --scene scene.toml -o tags.pdf");
    assert!(said.contains("12 sheets: a map, "), "{said}");
    let scene = scene(&folder.path().join("scene.toml"));
    let made = made(&scene, "a4", false);
    assert!(made.sheets.len() <= 12, "{} sheets", made.sheets.len());
    let pages = pictured(&folder.path().join("tags.pdf"), 300, &made.sheets);
    let mut found = Vec::new();
    for (page, (name, sheet)) in pages.iter().zip(made.names.iter().zip(&made.sheets)) {
        if name.contains(' ') || name == "map" {
            continue;
        }
        for (_, id, corners) in page.tags(&scene.families()) {
            for [x, y] in corners {
                let white_mm = 50.0 / 8.0 - 0.1;
                assert!(
                    x > sheet.trim.left_mm + white_mm && x < sheet.trim.right_mm - white_mm,
                    "tag {id} is cut"
                );
                assert!(
                    y > sheet.trim.bottom_mm + white_mm && y < sheet.trim.top_mm - white_mm,
                    "tag {id} is cut"
                );
            }
            found.push(id);
        }
    }
    found.sort_unstable();
    assert_eq!(
        found,
        [0, 1, 2, 3, 4, 5, 6, 7],
        "each tag of the mat once, on one sheet"
    );
}

/// A strip whose root covers its outline on the mat shows the foot of its card where the scene puts it.
#[test]
fn place_strips_put_cards_where_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), DEFAULT_RING);
    run(folder.path(), "print tags --scene scene.toml -o tags.pdf");
    let scene = scene(&folder.path().join("scene.toml"));
    let made = made(&scene, "a4", false);
    let pages = pictured(&folder.path().join("tags.pdf"), 200, &made.sheets);
    let ground = made.ground.as_ref().unwrap();
    let tents = arrange(&scene).tents;
    assert_eq!(ground.strips.len(), 8);
    for strip in &ground.strips {
        let name = format!("strip T{}", strip.tent + 1);
        let cut = made.cut_out.iter().find(|cut| cut.name == name).unwrap();
        assert!((cut.area.width_mm() - strip.length_mm).abs() < 1e-9);
        // From the strip's own frame, its middle as origin, to the ground.
        let [c, s] = strip.place.right;
        let centre = strip.place.centre;
        let on_ground = |x: f64, y: f64| [centre[0] + c * x - s * y, centre[1] + s * x + c * y];
        let on_page = |x: f64, y: f64| {
            [
                (cut.area.left_mm + cut.area.right_mm) / 2.0 + x,
                (cut.area.bottom_mm + cut.area.top_mm) / 2.0 + y,
            ]
        };
        // Along a line beside the middle, the foot of the card is the first line after the root.
        let page = &pages[cut.sheet];
        let from = strip.root_mm - strip.length_mm / 2.0 + 1.0;
        let steps = (0..)
            .map(|k| from + 0.05 * f64::from(k))
            .take_while(|x| *x < strip.length_mm / 2.0 - 1.0);
        let y = 14.0;
        let dark: Vec<f64> = steps.filter(|x| page.is_black(on_page(*x, y))).collect();
        assert!(!dark.is_empty(), "{name} shows no foot");
        let foot = dark.iter().sum::<f64>() / dark.len() as f64;
        let [x, y] = on_ground(foot, y);
        let feet = tents[strip.tent].foot_mm();
        let off = [(feet[0], feet[1]), (feet[2], feet[3])]
            .map(|(a, b)| ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)).abs() / (b - a).norm());
        assert!(off[0].min(off[1]) < 0.15, "{name}: the foot is {off:?} mm off");
        // The root lies on the mat's paper, and not on a tag.
        for p in strip.root() {
            let paper = ground.paper;
            assert!(p[0] >= paper.left_mm && p[0] <= paper.right_mm && p[1] >= paper.bottom_mm && p[1] <= paper.top_mm);
        }
        assert!(strip.root_mm >= 30.0);
    }
}

fn texts(sheet: &Sheet) -> Vec<&str> {
    fn of(mark: &Mark) -> Option<&str> {
        match mark {
            Mark::Text(line) => Some(&line.text),
            _ => None,
        }
    }
    sheet.marks.iter().filter_map(of).collect()
}

#[test]
fn the_map_names_every_sheet_once() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), DEFAULT_RING);
    std::fs::write(folder.path().join("all.toml"), all_families()).unwrap();
    for file in ["scene.toml", "all.toml"] {
        let made = made(&scene(&folder.path().join(file)), "a4", false);
        let on_map = texts(&made.sheets[0]);
        assert!(
            on_map
                .iter()
                .any(|text| text.contains(&format!("all {} sheets at 100 %", made.sheets.len()))),
            "{on_map:?}"
        );
        assert!(
            on_map.iter().any(|text| text.contains("print verify")),
            "the scale check"
        );
        for name in &made.names[1..] {
            let count = on_map.iter().filter(|text| *text == name).count();
            assert_eq!(count, 1, "{name} of {file} is on the map {count} times");
        }
    }
}

/// The floor plan's rows against the numbers in the scene file.
#[test]
fn the_floor_plan_says_what_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), DEFAULT_RING);
    run(folder.path(), "print tags --scene scene.toml --plain -o tags.pdf");
    let text = std::process::Command::new("pdftotext")
        .args(["-layout", "tags.pdf", "-"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    let scene = scene(&folder.path().join("scene.toml"));
    for tag in &scene.tags {
        let c = tag.centre_mm;
        let tenth = |v: f64| format!("{:.1}", (v * 10.0).round() / 10.0 + 0.0);
        let numbers = [c.x, c.y, c.z, 227.5 - c.x, 93.0 - c.y, c.x.hypot(c.y)].map(tenth);
        let row = text.lines().find(|line| {
            let words: Vec<_> = line.split_whitespace().collect();
            words.contains(&tag.id.to_string().as_str())
                && numbers.iter().all(|number| words.contains(&number.as_str()))
        });
        assert!(row.is_some(), "tag {}: no row with {numbers:?}", tag.id);
    }
    // T1 before the front: its outer tag faces the front at 60° to the ground, the inner one the model; flat tags lie.
    for words in ["faces 0.0°", "faces 180.0°", "top to 90.0°", "60.0°"] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn json_says_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), DEFAULT_RING);
    let said = run(folder.path(), "print tags --scene scene.toml --json -o tags.pdf");
    let told: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(told["files"], serde_json::json!(["tags.pdf"]));
    assert_eq!(told["sheets"].as_array().unwrap().len(), 12);
    assert_eq!(told["sheets"][0]["name"], "map");
    assert_eq!(
        told["mat"]["sheets"],
        serde_json::json!(["A1", "A2", "B1", "B2", "C1", "C2"])
    );
    assert_eq!(told["mat"]["cut_tags"], serde_json::json!([]));
    assert_eq!(told["cards"].as_array().unwrap().len(), 16);
    assert!(
        told["notes"][0]
            .as_str()
            .unwrap()
            .starts_with("place strips save sheets")
    );
}

/// A row of tags without room for a seam between them.
#[test]
fn tags_that_no_shift_saves_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let row: String = (0..40)
        .map(|i| {
            let x = -800 + 40 * i;
            format!("[[tag]]\nid = {i}\nsize_mm = 30\ncentre_mm = [{x}, 300, 0]\nright = [0, -1, 0]\nup = [1, 0, 0]\n")
        })
        .collect();
    // Wider than their distance: no seam fits between them.
    std::fs::write(
        folder.path().join("s.toml"),
        format!("{ALL_FAMILIES}{}", row.replace("size_mm = 30", "size_mm = 33")),
    )
    .unwrap();
    let output = program()
        .current_dir(folder.path())
        .args("print tags --scene s.toml -o t.pdf".split(' '))
        .output()
        .unwrap();
    let said = stderr(&output);
    assert!(said.contains("note: seams of the mat run through tags "), "{said}");
    assert!(said.contains("lay plain cards over them (--plain)"), "{said}");
}

/// The trimmed sheets edge to edge, row by row.
fn laid_together(pages: &[Page], sheets: &[Sheet]) -> Page {
    let dpi = pages[0].dpi;
    let px = |mm: f64| (mm / 25.4 * dpi).round() as i64;
    let area: f64 = sheets.iter().map(|s| s.trim.width_mm() * s.trim.height_mm()).sum();
    let side = 2.0 * area.sqrt();
    let mut whole = GrayImage::from_pixel(px(side) as u32, px(side) as u32, image::Luma([255]));
    // Where the rows and columns before a sheet end; sheets that carry nothing may be missing.
    let before = |index: usize, of: fn((usize, usize)) -> usize, side: fn(&Sheet) -> f64| -> f64 {
        let one = |i: usize| sheets.iter().find(|sheet| of(place(sheet)) == i).map(side);
        (0..index)
            .map(|i| one(i).expect("every row and column has a sheet"))
            .sum()
    };
    for (page, sheet) in pages.iter().zip(sheets) {
        let (trim, (row, column)) = (sheet.trim, place(sheet));
        let (left, top) = (px(trim.left_mm), px(page.height_mm - trim.top_mm));
        let (wide, high) = (px(trim.width_mm()), px(trim.height_mm()));
        let cut = image::imageops::crop_imm(&page.picture, left as u32, top as u32, wide as u32, high as u32);
        let x = before(column, |place| place.1, |sheet| sheet.trim.width_mm());
        let y = before(row, |place| place.0, |sheet| sheet.trim.height_mm());
        image::imageops::replace(&mut whole, &cut.to_image(), px(x), px(y));
    }
    Page {
        height_mm: f64::from(whole.height()) / dpi * 25.4,
        picture: whole,
        dpi,
    }
}

/// Row and column of a sheet of the mat, from 0, as the label in its corner says: `mat B3`.
fn place(sheet: &Sheet) -> (usize, usize) {
    let label = label(sheet);
    let id = label.strip_prefix("mat ").unwrap();
    let row = id.bytes().next().unwrap() - b'A';
    (usize::from(row), id[1..].parse::<usize>().unwrap() - 1)
}

fn label(sheet: &Sheet) -> String {
    match sheet.marks.last() {
        Some(Mark::Text(line)) => line.text.clone(),
        other => panic!("the last mark is the label, not {other:?}"),
    }
}

#[test]
fn the_same_input_gives_the_shipped_examples() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        "scene new --preset ring --radius-mm 300 --tags 4 --tag-mm 50 --model-size-mm 300x140x100 --name example -o ring4.toml",
        "print tags --scene ring4.toml --paper a3 -o ring4_tags_a3.pdf",
        "print board --type charuco --squares 9x7 --square-mm 22 --marker-mm 16 -o charuco_9x7_22mm.pdf",
        "print board --type chessboard --squares 10x7 --square-mm 20 -o chessboard_10x7_20mm.pdf",
        "print board --type aprilgrid --squares 6x5 --square-mm 26 -o aprilgrid_6x5_20mm.pdf",
    ] {
        run(folder.path(), command);
    }
    for (shipped, name) in [
        ("print_templates", "ring4.toml"),
        ("print_templates", "ring4_tags_a3.pdf"),
        ("print_templates", "charuco_9x7_22mm.pdf"),
        ("calibration", "charuco_9x7_22mm.toml"),
        ("calibration", "chessboard_10x7_20mm.toml"),
        ("calibration", "aprilgrid_6x5_20mm.toml"),
    ] {
        let theirs = home().join(shipped).join(name);
        assert!(
            std::fs::read(folder.path().join(name)).unwrap() == std::fs::read(&theirs).unwrap(),
            "{} is out of date: the README beside it says how to make it again",
            theirs.display()
        );
    }
}

/// What is asked, and a word of the answer. `ring.toml` is there; `out.pdf` and `new.toml` must not be made.
const REFUSALS: &[(&str, &str)] = &[
    ("print tags --scene absent.toml -o out.pdf", "no such file"),
    (
        "print tags --scene ring.toml -o ring.toml --format pdf",
        "would be overwritten",
    ),
    ("print tags --scene empty.toml -o out.pdf", "the scene has no tags"),
    ("print tags --scene tiny.toml -o out.pdf", "modules of 0.125 mm"),
    ("print tags --scene huge.toml -o out.pdf", "the card of tag 3"),
    (
        "print tags --scene ring.toml --paper 150x150 -o out.pdf",
        "tent card T1 (tags 6 and 7)",
    ),
    ("print tags --scene ring.toml --paper 90x90 -o out.pdf", "too small"),
    ("print tags --scene ring.toml --paper b7 -o out.pdf", "is not known"),
    (
        "scene new --preset ring --radius-mm 0 --model-size-mm 455x186x128 -o new.toml",
        "radius cannot be 0",
    ),
    (
        "scene new --preset ring --radius-mm nan --model-size-mm 455x186x128 -o new.toml",
        "radius cannot be NaN",
    ),
    (
        "scene new --preset ring --radius-mm 280 --model-size-mm 455x186x128 -o new.toml",
        "the model and the cards",
    ),
    (
        "scene new --preset ring --radius-mm 330 --tags 12 --model-size-mm 455x186x128 -o new.toml",
        "so many cards",
    ),
    (
        "scene new --preset ring --radius-mm 900 --tags 2 --model-size-mm 455x186x128 -o new.toml",
        "give 3 to 195",
    ),
    (
        "scene new --preset ring --radius-mm 900 --tags 11 --family tag16h5 --model-size-mm 455x186x128 -o new.toml",
        "has 30",
    ),
    (
        "scene new --preset ring --radius-mm 400 --tag-mm -5 --model-size-mm 455x186x128 -o new.toml",
        "tag size cannot be -5",
    ),
    (
        "scene new --preset ring --radius-mm 400 --tilt-deg 85 --model-size-mm 455x186x128 -o new.toml",
        "30 to 75",
    ),
    (
        "scene new --preset ring --radius-mm 400 --scale 0 --model-size-mm 455x186x128 -o new.toml",
        "model.scale is 0",
    ),
    (
        "scene new --preset ring --radius-mm 400 --bins-azimuth-deg 50 --model-size-mm 455x186x128 -o new.toml",
        "divide 360",
    ),
    (
        "scene new --preset ring --radius-mm 400 --model-size-mm 455x186 -o new.toml",
        "as in 455x186x128",
    ),
    (
        "scene new --preset ring --radius-mm 400 --model-size-mm 455x0x128 -o new.toml",
        "model width cannot be 0",
    ),
    (
        "scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o ring.toml",
        "is there already",
    ),
];

#[test]
fn impossible_requests_are_refused_in_one_sentence_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    let tag = |size_mm: f64| {
        format!(
            "{ALL_FAMILIES}[[tag]]\nid = 3\nsize_mm = {size_mm}\ncentre_mm = [0, 300, 90]\nright = [1, 0, 0]\nup = [0, 0, 1]\n"
        )
    };
    for (name, text) in [
        ("empty.toml", ALL_FAMILIES.to_owned()),
        ("tiny.toml", tag(1.0)),
        ("huge.toml", tag(190.0)),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    let before = files();
    for (command, word) in REFUSALS {
        let output = program()
            .current_dir(folder.path())
            .args(command.split(' '))
            .output()
            .unwrap();
        println!("{}", stderr(&output).trim_end());
        assert_refused(&output, &[word]);
        assert_eq!(files(), before, "{command} left a file");
    }
}

#[test]
fn corrected_tags_come_out_of_the_printer_in_true_size() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), all_families()).unwrap();
    run(folder.path(), "print verify --x-mm 98 --y-mm 99 -o printer.toml");
    run(
        folder.path(),
        "print tags --scene s.toml --printer printer.toml -o tags.pdf",
    );
    let scene = scene(&folder.path().join("s.toml"));
    let families = scene.families();
    let mut count = 0;
    for page in render(&folder.path().join("tags.pdf"), 300, A4) {
        // What this printer makes of the page: 98 % along the paper's short side, 99 % along the long one.
        let upright = page.height_mm > 250.0;
        let (x, y) = if upright { (0.98, 0.99) } else { (0.99, 0.98) };
        for (family, id, corners) in page.tags(&families) {
            let Some(tag) = scene.tag(family, id) else { continue };
            count += 1;
            let printed = corners.map(|[cx, cy]| [cx * x, cy * y]);
            for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
                let error = (distance(printed[a], printed[b]) - tag.size_mm).abs();
                assert!(error < 0.1, "tag {id} of {family:?}: a side is {error:.3} mm off");
            }
        }
    }
    assert_eq!(count, scene.tags.len());
}

#[test]
fn a_correction_is_not_lost_by_measuring_a_corrected_page() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "print verify --x-mm 99.3 --y-mm 99.8 -o printer.toml");
    let before = std::fs::read(folder.path().join("printer.toml")).unwrap();
    let again = "print verify --x-mm 100 --y-mm 100 -o printer.toml";
    let output = program()
        .current_dir(folder.path())
        .args(again.split(' '))
        .output()
        .unwrap();
    common::assert_refused(&output, &["printer.toml is there already", "--printer printer.toml"]);
    assert_eq!(std::fs::read(folder.path().join("printer.toml")).unwrap(), before);
    // The corrected page names the command that builds on the correction, and it keeps it.
    let said = run(folder.path(), "print check --printer printer.toml -o check.pdf");
    assert!(said.contains("--printer printer.toml -o printer.toml"), "{said}");
    run(
        folder.path(),
        "print verify --x-mm 100 --y-mm 100 --printer printer.toml -o printer.toml",
    );
    let after = std::fs::read_to_string(folder.path().join("printer.toml")).unwrap();
    assert!(after.contains("measured_x_mm = 99.3"), "{after}");
}

#[test]
fn the_order_of_the_scene_does_not_change_what_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    let text = std::fs::read_to_string(folder.path().join("ring.toml")).unwrap();
    let (head, tags) = text.split_at(text.find("[[tag]]").unwrap());
    let mut tags: Vec<&str> = tags.split_inclusive("[[tag]]").collect();
    // Outer faces first, then inner ones: a partner across the ring comes before the right one.
    let last = tags.pop().unwrap();
    let blocks: Vec<String> = tags
        .iter()
        .skip(1)
        .chain([&last])
        .map(|b| format!("[[tag]]{}", b.trim_end_matches("[[tag]]")))
        .collect();
    let (even, odd): (Vec<_>, Vec<_>) = blocks.iter().enumerate().partition(|(i, _)| i % 2 == 0);
    let mixed: String = even
        .into_iter()
        .chain(odd)
        .map(|(_, block)| format!("{}\n", block.trim_end()))
        .collect();
    std::fs::write(folder.path().join("mixed.toml"), format!("{head}{mixed}")).unwrap();
    let (a, b) = (
        scene(&folder.path().join("ring.toml")),
        scene(&folder.path().join("mixed.toml")),
    );
    assert_eq!(a.tags.len(), b.tags.len());
    assert_ne!(a.tags, b.tags);
    let pairs = |scene: &Scene| -> std::collections::BTreeSet<[u32; 2]> {
        let ids = |ids: [u32; 2]| [ids[0].min(ids[1]), ids[0].max(ids[1])];
        arrange(scene)
            .tents
            .iter()
            .map(|tent| ids([tent.tags[0].id, tent.tags[1].id]))
            .collect()
    };
    assert_eq!(pairs(&a), pairs(&b));
    assert_eq!(pairs(&a).len(), 6);
}

#[test]
fn things_that_stand_on_each_other_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let flat = |id: u32, x: f64| {
        format!("[[tag]]\nid = {id}\nsize_mm = 50\ncentre_mm = [{x}, 0, 0]\nright = [0, -1, 0]\nup = [1, 0, 0]\n")
    };
    let noted = |tags: &[String]| {
        std::fs::write(folder.path().join("s.toml"), format!("{ALL_FAMILIES}{}", tags.concat())).unwrap();
        let command = "print tags --scene s.toml -o tags.pdf";
        stderr(
            &program()
                .current_dir(folder.path())
                .args(command.split(' '))
                .output()
                .unwrap(),
        )
    };
    assert!(noted(&[flat(0, 400.0), flat(1, 420.0)]).contains("note: tag 0 and tag 1 overlap on the mat"));
    assert!(noted(&[flat(0, 200.0)]).contains("note: the model and tag 0 overlap"));
    assert!(!noted(&[flat(0, 400.0), flat(1, 470.0)]).contains("note:"));
}

#[test]
fn tags_come_as_svg_too() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), RING);
    run(folder.path(), "print tags --scene ring.toml -o tags.svg");
    for name in ["map", "cards-1", "A1"] {
        assert!(folder.path().join(format!("tags-{name}.svg")).exists(), "{name}");
    }
    let first = std::fs::read_to_string(folder.path().join("tags-cards-1.svg")).unwrap();
    assert!(first.contains("<path d=\"M") && first.contains("width=\"210mm\"") || first.contains("width=\"297mm\""));
    assert!(!folder.path().join("tags.svg").exists());
}
