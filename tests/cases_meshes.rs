//! Others' files through the program: what is refused, with which words, and that no input changes. A new file is a new line of a table.

use crate::common;

use std::process::Output;

use common::{assert_refused, contents, home, program, skyline, stderr, stdout};
use tempfile::TempDir;

/// A folder with the stored cases, a pattern with its card, a scene, a camera and a printer's file.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(home().join("tests/data/cases")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    for name in ["scene.toml", "camera.yaml"] {
        std::fs::copy(skyline().join(name), folder.path().join(name)).unwrap();
    }
    done(&folder, "pattern random --cells 4 --seed 1 -o p.png");
    done(&folder, "pattern random --cells 4 --seed 2 -o q.png");
    done(&folder, "print verify --x-mm 99.5 --y-mm 100.5 -o printer.toml");
    folder
}

fn run(folder: &TempDir, command: &str) -> Output {
    let words = command.split(' ');
    program().current_dir(folder.path()).args(words).output().unwrap()
}

fn done(folder: &TempDir, command: &str) -> Output {
    let output = run(folder, command);
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    output
}

/// Commands whose output lies where something lies that they read, or that a file names which they read.
const OVER_AN_INPUT: &[(&str, &str)] = &[
    // An image of the mesh; its material library, beside the image that is asked for; the mesh itself.
    ("texture bake --texture car.obj --size 64 -o ok.png", "ok.png"),
    ("texture bake --texture car.obj --size 64 -o paint.png", "paint.mtl"),
    ("texture bake --texture car.obj --size 64 -o car.png", "car.obj"),
    ("texture show --texture car.obj -o ok.png", "ok.png"),
    // An image that the mesh names is its own, even where it is not looked at.
    (
        "texture bake --mesh car.obj --pattern p.png --tile-mm 40 --size 64 -o ok.png",
        "ok.png",
    ),
    (
        "print wrap --panels --mesh car.obj --pattern p.png --tile-mm 40 --format pdf -o paint.mtl",
        "paint.mtl",
    ),
    (
        "print wrap --panels --mesh car.obj --length-mm 440 --pattern p.png --tile-mm 40 --format pdf -o car.obj",
        "car.obj",
    ),
    (
        "print wrap --panels --mesh h_buf1diff.glb --length-mm 440 --pattern p.png --tile-mm 40 --format pdf -o geo.bin",
        "geo.bin",
    ),
    (
        "print template --pattern p.png --tile-mm 40 --size-mm 100x100 --format pdf -o p.png",
        "p.png",
    ),
    (
        "print template --pattern p.png --tile-mm 40 --size-mm 100x100 --printer printer.toml --format pdf -o printer.toml",
        "printer.toml",
    ),
    ("print tags --scene scene.toml --format pdf -o scene.toml", "scene.toml"),
    (
        "print check --printer printer.toml --format pdf -o ./printer.toml",
        "printer.toml",
    ),
    ("pattern import p.png --cells 2 -o p.png", "p.png"),
    ("camera convert camera.yaml --format ros -o camera.yaml", "camera.yaml"),
];

#[test]
fn no_output_takes_the_place_of_an_input() {
    let folder = folder();
    let before = contents(folder.path());
    for (command, input) in OVER_AN_INPUT {
        let output = run(&folder, command);
        let words = format!("{input} is an input, which would be overwritten; give another output file");
        assert_refused(&output, &[&words]);
        assert!(contents(folder.path()) == before, "{command}");
    }
    // Its own file of before is no input: it is measured again.
    done(
        &folder,
        "print verify --x-mm 99.5 --y-mm 100.5 --printer printer.toml -o printer.toml",
    );
    done(&folder, "texture bake --texture car.obj --size 64 -o out.png");
    done(&folder, "texture bake --texture car.obj --size 64 -o out.png");
}

#[cfg(unix)]
#[test]
fn an_input_is_known_by_any_of_its_names() {
    let folder = folder();
    std::os::unix::fs::symlink("p.png", folder.path().join("link.png")).unwrap();
    std::os::unix::fs::symlink(".", folder.path().join("here")).unwrap();
    let before = contents(folder.path().canonicalize().unwrap().as_path()).len();
    for (input, output) in [
        ("link.png", "p.png"),
        ("p.png", "link.png"),
        ("here/p.png", "p.png"),
        ("p.png", "here/p.png"),
    ] {
        let command = format!("pattern import {input} --cells 2 -o {output}");
        assert_refused(&run(&folder, &command), &["is an input"]);
    }
    assert_eq!(contents(folder.path().canonicalize().unwrap().as_path()).len(), before);
}

/// Files that are refused, and with which words.
const REFUSED: &[(&str, &str, &str)] = &[
    (
        "bow.obj",
        "v 0 0 0\nv 400 80 0\nv 400 0 0\nv 0 80 0\nv 0 0 50\nf 1 2 3 4\nf 1 2 5\n",
        "the face on line 6 crosses itself",
    ),
    (
        "zero.obj",
        "v 0 0 0\nv 400 80 0\nv 400 0 90\nf 0 1 2\n",
        "names corner 0, and corners count from 1 to 3",
    ),
    (
        "cut.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 0 0\nvertex 0 100 9\nendloop\nendfacet\n",
        "ends before its last solid",
    ),
];

#[test]
fn what_is_wrong_with_a_mesh_is_said() {
    let folder = folder();
    for (name, text, words) in REFUSED {
        std::fs::write(folder.path().join(name), text).unwrap();
        let command =
            format!("print wrap --panels --mesh {name} --length-mm 440 --pattern p.png --tile-mm 40 -o out.pdf");
        assert_refused(&run(&folder, &command), &[words]);
    }
    std::fs::remove_file(folder.path().join("geo.bin")).unwrap();
    let command = "print wrap --panels --mesh h_buf1diff.glb --length-mm 440 --pattern p.png --tile-mm 40 -o out.pdf";
    assert_refused(&run(&folder, command), &["its data are in another file", "geo.bin"]);
    let command = "texture bake --texture h_imgbuf1.glb --length-mm 440 --size 64 -o out.png";
    assert_refused(&run(&folder, command), &["not named within the mesh's folder"]);
}

/// Meshes, their length in mm, and their size in mm by trimesh and their left panel in cm² by shapely.
const MESHES: &[(&str, f64, [f64; 3], Option<f64>)] = &[
    ("arch_ngon.obj", 455.0, [455.0, 186.0, 128.0], Some(425.4)),
    ("arch_tri.obj", 455.0, [455.0, 186.0, 128.0], Some(425.4)),
    ("box_q.glb", 455.0, [455.0, 186.0, 128.0], Some(582.4)),
    ("box_webp_optional.glb", 455.0, [455.0, 186.0, 128.0], Some(582.4)),
];

#[test]
fn panels_have_the_size_of_the_meshs_faces() {
    let folder = folder();
    for (name, length, size_mm, left_cm2) in MESHES {
        let command = format!(
            "print wrap --panels --mesh {name} --length-mm {length} --pattern p.png --tile-mm 40 --json -o out.pdf"
        );
        let json: serde_json::Value = serde_json::from_str(&stdout(&done(&folder, &command))).unwrap();
        let size = json["model_size_mm"].as_array().unwrap();
        for (found, expected) in size.iter().zip(size_mm) {
            assert!((found.as_f64().unwrap() - expected).abs() < 0.05, "{name}: {size:?}");
        }
        let pieces = json["panels"].as_array().unwrap();
        let left = pieces.iter().find(|piece| piece["panel"] == "left").unwrap();
        if let Some(expected) = left_cm2 {
            let found = left["surface_mm2"].as_f64().unwrap() / 100.0;
            assert!((found - expected).abs() < 0.2, "{name}: {found}");
        }
    }
}

#[test]
fn advice_never_writes_over_what_is_there() {
    let folder = folder();
    std::fs::write(
        folder.path().join("it's.heic"),
        std::fs::read(folder.path().join("heic.jpg")).unwrap(),
    )
    .unwrap();
    std::fs::write(folder.path().join("it's.jpg"), "mine").unwrap();
    for (photo, advised) in [
        ("heic.jpg", "heif-dec heic.jpg heic_2.jpg"),
        ("it's.heic", r"heif-dec 'it'\''s.heic' 'it'\''s_2.jpg'"),
    ] {
        let mut command = program();
        // Without a decoder.
        command.current_dir(folder.path()).env("PATH", "");
        let output = command
            .args(["locate", photo, "--scene", "scene.toml", "--camera", "camera.yaml"])
            .output();
        assert_refused(&output.unwrap(), &[&format!("`{advised}`")]);
    }
    std::fs::copy(folder.path().join("p.png"), folder.path().join("pattern.png")).unwrap();
    let sheets = "print template --texture q.png --tile-mm 40 --size-mm 100x100 --paints 2 -o out.pdf";
    assert_refused(
        &run(&folder, sheets),
        &["scaleproof pattern import q.png --cells 24 -o pattern_2.png"],
    );
}

#[test]
fn lengths_may_be_in_inches() {
    let folder = folder();
    let sheet = |size: &str, tile: &str, paper: &str| {
        let command = format!(
            "print template --pattern p.png --tile-mm {tile} --size-mm {size} --paper {paper} --json -o out.pdf"
        );
        let json: serde_json::Value = serde_json::from_str(&stdout(&done(&folder, &command))).unwrap();
        let thousandths = |mm: &serde_json::Value| (1000.0 * mm.as_f64().unwrap()).round();
        let page = &json["page_mm"];
        (
            json["sheets"].as_u64(),
            [&page[0], &page[1], &json["cell_mm"]].map(thousandths),
        )
    };
    assert_eq!(
        sheet("20x12in", "2in", "ledger"),
        sheet("508x304.8", "50.8", "279.4x431.8")
    );
    assert_eq!(
        sheet("508x304.8", "5.08cm", "legal"),
        sheet("508x304.8", "50.8", "8.5x14in")
    );
    assert_refused(
        &run(
            &folder,
            "print template --pattern p.png --tile-mm 5furlong --size-mm 9x9 -o out.pdf",
        ),
        &["5furlong"],
    );
}
