//! Lengths, angles, scales and counts that no sheet, scene or board has: each is refused in one sentence, and leaves no file.
//!
//! A new case is a line: of `REQUESTS` for an argument, of `FILES` for a number in a file.

use std::collections::BTreeSet;
use std::path::Path;

use image::RgbImage;
use scaleproof_core::files::sha256_hex;
use scaleproof_surface::pattern::{Pattern, card::Card};

use crate::common::{assert_refused, program, stderr};

const SCENE: &str = "[model]\nname = \"m\"\nscale = 10\nclass = \"car\"\nsize_mm = [455, 186, 128]\n\
    [bins]\nazimuth_deg = 45\npitch_deg = [0]\ndistance_mm = [900]\n\
    [[tag]]\nid = 3\nsize_mm = 50\ncentre_mm = [0, 300, 90]\nright = [1, 0, 0]\nup = [0, 0, 1]\n";
const CHESSBOARD: &str = "type = \"chessboard\"\nsquares = [9, 7]\ninner_corners = [8, 6]\nsquare_mm = 20.0\n";
const APRILGRID: &str = "type = \"aprilgrid\"\ntags = [6, 5]\ntag_mm = 20.0\ntag_spacing = 0.3\nfamily = \"tag36h11\"\nborder_modules = 2\n";
const PRINTER: &str =
    "nominal_mm = 100.0\nmeasured_x_mm = 100.0\nmeasured_y_mm = 100.0\ncorrection_x = 1.0\ncorrection_y = 1.0\n";
/// A corner of a cube, whose cut face slopes to all three axes.
const CORNER: &str = "v 0 0 0\nv 300 0 0\nv 0 300 0\nv 0 0 300\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Requests that are fulfilled, by the name that `REQUESTS` calls them.
const GOOD: &[(&str, &str)] = &[
    (
        "patch",
        "print patch --scene scene.toml --patch patch.png --panel left --at-mm 0,60 --size-mm 60 -o out.pdf",
    ),
    (
        "two patches",
        "print patch --scene scene.toml --patch patch.png --panel left --at-mm -99,60 --size-mm 60 --patch patch.png --panel left \
         --at-mm 99,60 --size-mm 60x60 -o out.pdf",
    ),
    (
        "template",
        "print template --pattern pattern.png --tile-mm 40 --size-mm 100x100 -o out.pdf",
    ),
    (
        "wrap",
        "print wrap --panels --scene scene.toml --pattern pattern.png --tile-mm 40 -o out.pdf",
    ),
    (
        "mesh",
        "print wrap --panels --mesh corner.obj --pattern pattern.png --tile-mm 40 -o out.pdf",
    ),
    (
        "pieces",
        "print wrap --mesh corner.obj --pattern pattern.png --tile-mm 40 -o out.pdf",
    ),
    (
        "board",
        "print board --type chessboard --squares 9x7 --square-mm 20 -o out.pdf",
    ),
    (
        "charuco",
        "print board --type charuco --squares 9x7 --square-mm 20 --marker-mm 15 -o out.pdf",
    ),
    ("check", "print check -o out.pdf"),
    ("chart", "print chart -o out.pdf"),
    ("tags", "print tags --scene scene.toml -o out.pdf"),
    ("verify", "print verify --x-mm 100 --y-mm 100 -o measured.toml"),
    (
        "scene",
        "scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o new.toml",
    ),
];

/// A good request, what is changed in it, and what the sentence must say.
const REQUESTS: &[(&str, &str, &[&str])] = &[
    ("patch", "--at-mm 1e200,50", &["patch place cannot be 1e200 mm"]),
    ("patch", "--at-mm 0,-inf", &["patch place cannot be -inf mm"]),
    ("patch", "--at-mm nan,50", &["patch place cannot be NaN"]),
    ("patch", "--at-mm 1e9,50", &["patch place cannot be 1e9 mm"]),
    ("patch", "--size-mm 1e200", &["patch width cannot be 1e200"]),
    ("patch", "--size-mm 60x1e-300", &["patch height cannot be 1e-300"]),
    ("patch", "--margin-mm 1e200", &["margin cannot be 1e200 mm"]),
    ("patch", "--overlap-mm nan", &["overlap cannot be NaN"]),
    ("patch", "--scale 1e200", &["scale cannot be 1e200"]),
    ("two patches", "--at-mm 1e200,50", &["patch place cannot be 1e200 mm"]),
    ("two patches", "--size-mm nan", &["patch width cannot be NaN"]),
    ("template", "--tile-mm 1e200", &["tile width cannot be 1e200"]),
    ("template", "--tile-mm -0", &["tile width cannot be -0"]),
    ("template", "--tile-mm 1e-9", &["smaller than the 0.2 mm"]),
    ("template", "--size-mm 1e200x100", &["more than 2000 sheets"]),
    ("template", "--size-mm 100xinf", &["template height cannot be inf"]),
    (
        "template",
        "--size-mm 1e-300x100",
        &["template width cannot be 1e-300 mm"],
    ),
    (
        "template",
        "--size-mm 150000x10 --paper 5000x5000",
        &["template width cannot be 150000 mm", "100000 mm"],
    ),
    ("template", "--margin-mm inf", &["margin cannot be inf"]),
    ("template", "--overlap-mm 1e200", &["overlap cannot be 1e200 mm"]),
    ("template", "--bleed-mm 1e200", &["bleed cannot be 1e200 mm"]),
    ("template", "--paper 1e9x210", &["is not known"]),
    ("template", "--paper nanx297", &["is not known"]),
    ("template", "--paper 1e-300x1e-300", &["too small"]),
    ("template", "--paper roll1e200", &["is not known"]),
    ("template", "--scale 1e-300", &["scale cannot be 1e-300"]),
    (
        "template",
        "--pattern dot.png --tile-mm 0.2 --size-mm 0.2x0.2 --bleed-mm 2400 --paper 5000x5000",
        &["times, more than 1000000"],
    ),
    ("template", "--paints 99999999999", &["2 to 24"]),
    (
        "template",
        "--paints 2 --min-feature-mm 1e200",
        &["minimum feature width cannot be 1e200"],
    ),
    (
        "template",
        "--paints 2 --min-feature-mm 0.2 --tile-mm 2.8 --size-mm 1000x1000 --paper 5000x5000",
        &["cells, more than 250000"],
    ),
    ("wrap", "--tile-mm nan", &["tile width cannot be NaN"]),
    ("wrap", "--margin-mm nan", &["margin cannot be NaN"]),
    ("mesh", "--length-mm 1e9", &["cannot be set to 1e9"]),
    ("mesh", "--length-mm nan", &["cannot be set to NaN"]),
    ("mesh", "--scale nan", &["scale cannot be NaN"]),
    ("pieces", "--dpi 1e6", &["dpi"]),
    ("pieces", "--max-stretch nan", &["stretch"]),
    ("pieces", "--pieces 0", &["pieces"]),
    ("pieces", "--tabs=1e200", &["glue tab cannot be 1e200 mm"]),
    ("board", "--square-mm 1e200", &["square cannot be 1e200 mm"]),
    ("board", "--square-mm 1e-300", &["square cannot be 1e-300 mm"]),
    ("board", "--squares 100000x100000", &["give 3 to 100"]),
    ("board", "--squares 4000000000x4000000000", &["give 3 to 100"]),
    ("charuco", "--marker-mm 1e-300", &["marker cannot be 1e-300 mm"]),
    ("charuco", "--marker-mm inf", &["marker cannot be inf"]),
    ("check", "--margin-mm 1e200", &["margin cannot be 1e200 mm"]),
    ("check", "--paper roll1e9", &["is not known"]),
    ("chart", "--paper infxinf", &["is not known"]),
    ("tags", "--paper 1e-9x1e-9", &["too small"]),
    ("verify", "--x-mm 1e200", &["1e200 mm along x"]),
    ("verify", "--y-mm nan", &["NaN mm along y"]),
    ("scene", "--radius-mm 1e200", &["radius cannot be 1e200 mm"]),
    ("scene", "--radius-mm 1e-300", &["radius cannot be 1e-300 mm"]),
    ("scene", "--tag-mm inf", &["tag size cannot be inf"]),
    ("scene", "--tags 4000000000", &["the family has 587"]),
    (
        "scene",
        "--tags 10000 --family tagstandard52h13 --radius-mm 100000",
        &["30000 tags are too many"],
    ),
    ("scene", "--tilt-deg nan", &["NaN°", "30 to 75"]),
    (
        "scene",
        "--model-size-mm 1e200x186x128",
        &["model length cannot be 1e200 mm"],
    ),
    (
        "scene",
        "--model-size-mm 455x186x1e-300",
        &["model height cannot be 1e-300 mm"],
    ),
    ("scene", "--scale nan", &["model.scale is NaN"]),
    ("scene", "--scale 1e20", &["model.scale is 1e20"]),
    ("scene", "--bins-azimuth-deg 1e-9", &["1e-9 does not divide 360"]),
    ("scene", "--bins-azimuth-deg nan", &["NaN does not divide 360"]),
    ("scene", "--bins-pitch-deg 0,nan", &["bins.pitch_deg has NaN"]),
    ("scene", "--bins-distance-mm 1e200", &["bins.distance_mm has 1e200"]),
];

/// A file, a part of it, what that becomes, and what the sentence must say.
const FILES: &[(&str, &str, &str, &str)] = &[
    (
        "scene.toml",
        "[455, 186,",
        "[1e200, 186,",
        "model.size_mm cannot be 1e200 mm",
    ),
    ("scene.toml", "[455, 186,", "[455, 0,", "model.size_mm cannot be 0 mm"),
    ("scene.toml", "scale = 10", "scale = 1e200", "model.scale is 1e200"),
    ("scene.toml", "scale = 10", "scale = -0.0", "model.scale is -0"),
    (
        "scene.toml",
        "azimuth_deg = 45",
        "azimuth_deg = 1e-9",
        "1e-9 does not divide 360",
    ),
    (
        "scene.toml",
        "pitch_deg = [0]",
        "pitch_deg = [nan]",
        "bins.pitch_deg has NaN",
    ),
    ("scene.toml", "[900]", "[1e-9]", "bins.distance_mm has 1e-9"),
    (
        "scene.toml",
        "[0, 300,",
        "[0, 1e200,",
        "centre_mm of tag 3 cannot be 1e200 mm",
    ),
    (
        "scene.toml",
        "size_mm = 50",
        "size_mm = 1e9",
        "size_mm of tag 3 cannot be 1e9 mm",
    ),
    (
        "scene.toml",
        "size_mm = 50",
        "size_mm = 1e-300",
        "size_mm of tag 3 cannot be 1e-300 mm",
    ),
    (
        "scene.toml",
        "id = 3",
        "id = 3\nsigma_mm = inf\nsigma_deg = 1",
        "of tag 3 go together",
    ),
    ("chessboard.toml", "20.0", "1e200", "square_mm cannot be 1e200 mm"),
    ("chessboard.toml", "20.0", "nan", "square_mm cannot be NaN"),
    (
        "chessboard.toml",
        "[9, 7]\ninner_corners = [8, 6]",
        "[100000, 9]\ninner_corners = [99999, 8]",
        "3 to 100 columns",
    ),
    (
        "aprilgrid.toml",
        "0.3",
        "1e200",
        "tag_mm times tag_spacing cannot be 1.99",
    ),
    ("aprilgrid.toml", "0.3", "-0.0", "tag_spacing cannot be -0 mm"),
    (
        "aprilgrid.toml",
        "border_modules = 2",
        "border_modules = 4000000000",
        "border_modules must be 1 to 4",
    ),
    (
        "printer.toml",
        "measured_x_mm = 100.0",
        "measured_x_mm = 1e200",
        "1e200 mm along x",
    ),
    (
        "printer.toml",
        "correction_y = 1.0",
        "correction_y = nan",
        "correction factors",
    ),
    (
        "carded.json",
        "\"tile_mm\": 40.0",
        "\"tile_mm\": 1e200",
        "its tile_mm is 1e200",
    ),
    (
        "carded.json",
        "\"tile_mm\": 40.0",
        "\"tile_mm\": -1e-300",
        "its tile_mm is -1e-300",
    ),
];

/// The command that reads a file of `FILES`.
fn reading(file: &str) -> String {
    match file {
        "scene.toml" => "print tags --scene scene.toml -o out.pdf".to_owned(),
        "printer.toml" => "print check --printer printer.toml -o out.pdf".to_owned(),
        "carded.json" => "print template --pattern carded.png --size-mm 100x100 -o out.pdf".to_owned(),
        board => format!("calibrate patch.png --board {board} -o camera.yaml"),
    }
}

/// A folder with every input that a good request names.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let pattern = Pattern::random(4, 1).unwrap().to_png().unwrap();
    write("pattern.png", &pattern);
    write("carded.png", &pattern);
    let card = Card {
        pattern_sha256: sha256_hex(&pattern),
        tile_mm: 40.0,
        sides: false,
        about: serde_json::Map::new(),
    };
    write("carded.json", &card.to_file(Path::new("carded.png")).unwrap().1);
    RgbImage::new(4, 4).save(folder.path().join("patch.png")).unwrap();
    RgbImage::new(1, 1).save(folder.path().join("dot.png")).unwrap();
    for (name, text) in [
        ("scene.toml", SCENE),
        ("chessboard.toml", CHESSBOARD),
        ("aprilgrid.toml", APRILGRID),
        ("printer.toml", PRINTER),
        ("corner.obj", CORNER),
    ] {
        write(name, text.as_bytes());
    }
    folder
}

fn files_in(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect()
}

fn good(name: &str) -> &'static str {
    let found = GOOD.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("no good request is called {name}")).1
}

/// A request with other values of some options, or with options that it did not have. Of an option that is repeated, the last
/// changes.
fn changed(request: &str, change: &str) -> Vec<String> {
    let mut arguments: Vec<String> = request.split(' ').map(str::to_owned).collect();
    let words: Vec<&str> = change.split(' ').collect();
    for (i, option) in words.iter().enumerate().filter(|(_, word)| word.starts_with("--")) {
        let value = words.get(i + 1).filter(|word| !word.starts_with("--"));
        match (arguments.iter().rposition(|a| a == option), value) {
            (Some(at), Some(value)) => arguments[at + 1] = (*value).to_owned(),
            _ => arguments.extend(
                [Some(option), value]
                    .into_iter()
                    .flatten()
                    .map(|word| (*word).to_owned()),
            ),
        }
    }
    arguments
}

/// Runs a request that is bad: one short sentence, and the folder stays as it is.
fn assert_nothing_made(folder: &Path, arguments: &[String], words: &[&str]) {
    let before = files_in(folder);
    let output = program().current_dir(folder).args(arguments).output().unwrap();
    let asked = arguments.join(" ");
    println!("{asked}\n    {}", stderr(&output).trim_end());
    assert_refused(&output, words);
    assert!(stderr(&output).len() < 400, "{asked}: a sentence, not a page");
    assert_eq!(files_in(folder), before, "{asked} left a file");
}

#[test]
fn the_requests_are_good_but_for_what_is_changed() {
    let folder = workplace();
    let inputs = files_in(folder.path());
    for (name, request) in GOOD {
        let output = program()
            .current_dir(folder.path())
            .args(request.split(' '))
            .output()
            .unwrap();
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        for made in files_in(folder.path()).difference(&inputs) {
            std::fs::remove_file(folder.path().join(made)).unwrap();
        }
    }
}

#[test]
fn arguments_that_are_no_lengths_are_refused() {
    let folder = workplace();
    for (name, change, words) in REQUESTS {
        assert_nothing_made(folder.path(), &changed(good(name), change), words);
    }
}

#[test]
fn files_with_numbers_that_are_no_lengths_are_refused() {
    let folder = workplace();
    for &(file, from, to, words) in FILES {
        refuse_file(folder.path(), file, (from, to), words);
    }
}

/// Counts that would take memory or hours, though each number is one.
#[test]
fn files_with_too_much_of_everything_are_refused() {
    let folder = workplace();
    let pitches: Vec<String> = (0..300).map(|i| format!("{:.1}", f64::from(i) * 0.1)).collect();
    let bins = format!("azimuth_deg = 1\npitch_deg = [{}]", pitches.join(", "));
    refuse_file(
        folder.path(),
        "scene.toml",
        ("azimuth_deg = 45\npitch_deg = [0]", bins.as_str()),
        "108000 bins, more than 100000",
    );
    let tag = |id: u32| {
        format!(
            "[[tag]]\nid = {id}\nfamily = \"tagstandard52h13\"\nsize_mm = 50\ncentre_mm = [0, 300, 90]\nright = [1, 0, 0]\n\
             up = [0, 0, 1]\n"
        )
    };
    let tags: String = (0..2000).map(tag).collect();
    let tags = format!("{tags}[[tag]]\nid = 3\n");
    refuse_file(
        folder.path(),
        "scene.toml",
        ("[[tag]]\nid = 3\n", tags.as_str()),
        "2001 tags are too many",
    );
}

/// Changes a part of a file of the workplace, has it read, and puts it back.
fn refuse_file(folder: &Path, file: &str, (from, to): (&str, &str), words: &str) {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{file} has no `{from}`");
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
    let arguments: Vec<String> = reading(file).split(' ').map(str::to_owned).collect();
    assert_nothing_made(folder, &arguments, &[words]);
    std::fs::write(&path, text).unwrap();
}
