//! `scene new --mesh`: axes, unit and paint are found once, or asked about, and every later command takes them from the scene. A new mesh is a new line
//! of a table.

use crate::common;

use std::fmt::Write;
use std::path::Path;
use std::process::Output;

use common::{assert_refused, program, shared, skyline, stderr, stdout};
use nalgebra::{Matrix3, Point3, Vector3};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::simulate::looking_at;
use scaleproof_session::envelope::EnvelopeShape;
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use tempfile::TempDir;

/// A saloon in metres, x to the front, y to the left, z up: material, and two opposite corners of each box.
const CAR: &[(&str, [f64; 3], [f64; 3])] = &[
    ("Lack", [-2.2, -0.9, 0.2], [0.7, 0.9, 0.85]),
    ("Lack", [0.7, -0.9, 0.2], [2.2, 0.9, 0.7]),
    ("Lack", [-1.6, -0.75, 1.3], [0.3, 0.75, 1.4]),
    ("Glas", [-1.7, -0.8, 0.85], [0.5, 0.8, 1.3]),
    ("Reifen", [1.05, -0.9, 0.0], [1.65, -0.7, 0.6]),
    ("Reifen", [1.05, 0.7, 0.0], [1.65, 0.9, 0.6]),
    ("Reifen", [-1.65, -0.9, 0.0], [-1.05, -0.7, 0.6]),
    ("Reifen", [-1.65, 0.7, 0.0], [-1.05, 0.9, 0.6]),
];

/// As the text of an OBJ file: where the model's front, left and top are in the file, and the file's unit in metres.
fn obj(boxes: &[(&str, [f64; 3], [f64; 3])], turn: Matrix3<f64>, unit_m: f64) -> String {
    let mut text = String::new();
    for (i, (material, low, high)) in boxes.iter().enumerate() {
        for corner in 0..8 {
            let side = |axis: usize| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] };
            let p = turn * Vector3::new(side(0), side(1), side(2)) / unit_m;
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        writeln!(text, "usemtl {material}").unwrap();
        for face in common::BOX_FACES {
            let [a, b, c, d] = face.map(|corner| corner + 1 + 8 * i);
            writeln!(text, "f {a} {b} {c} {d}").unwrap();
        }
    }
    text
}

fn axis(word: &str) -> Vector3<f64> {
    word.parse::<scaleproof_surface::mesh::SignedAxis>().unwrap().vector()
}

/// From the model frame into a file with the front and the top there.
fn turn(front: &str, up: &str) -> Matrix3<f64> {
    let (front, up) = (axis(front), axis(up));
    Matrix3::from_columns(&[front, up.cross(&front), up])
}

fn run(folder: &TempDir, command: &str) -> Output {
    let words = command.split(' ');
    program().current_dir(folder.path()).args(words).output().unwrap()
}

fn done(folder: &TempDir, command: &str) -> String {
    let output = run(folder, command);
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    stdout(&output)
}

fn write(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).unwrap();
}

/// Every one of the 24 ways a car may lie, in one of four units each.
#[test]
fn axes_unit_and_paint_of_a_car_are_found_however_it_lies() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["+x", "-x", "+y", "-y", "+z", "-z"];
    let all = words.iter().flat_map(|front| words.iter().map(move |up| (*front, *up)));
    let lying: Vec<_> = all.filter(|(front, up)| front[1..] != up[1..]).collect();
    assert_eq!(lying.len(), 24);
    let units = [
        (1.0, "metres of the real thing"),
        (0.01, "mm of the model"),
        (0.1, "cm of the model"),
        (10.0, "metres of the model"),
    ];
    for (i, (front, up)) in lying.into_iter().enumerate() {
        let (unit_m, unit) = units[i % units.len()];
        write(&folder, "car.obj", &obj(CAR, turn(front, up), unit_m));
        // The unit alone says the length where it makes a usual car of the mesh.
        let length = if i % 2 == 0 { " --length-mm 440" } else { "" };
        let said = done(&folder, &format!("scene new --mesh car.obj{length} -o {i}.toml"));
        let scene = Scene::open(&folder.path().join(format!("{i}.toml"))).unwrap();
        let axes = scene.model.mesh.axes.unwrap().map(|axis| axis.to_string());
        assert_eq!(axes, [front, up], "{said}");
        assert!(said.contains(unit) && said.contains("Lack"), "{said}");
        let size = scene.model.size_mm.map(|mm| (10.0 * mm).round() / 10.0);
        assert_eq!((scene.model.name.as_str(), size), ("car", [440.0, 180.0, 140.0]));
        assert!(folder.path().join(format!("{i}_mesh.png")).is_file());
    }
}

/// What the shape does not tell is asked, by the option that says it.
#[test]
fn what_has_two_equally_good_answers_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let body: &[_] = &[("Lack", [-2.2, -0.9, 0.2], [2.2, 0.9, 0.85])];
    let both_ends: Vec<_> = [body, &[("Lack", [-0.9, -0.8, 0.85], [0.9, 0.8, 1.4])], &CAR[4..]].concat();
    let askew = Matrix3::from(nalgebra::Rotation3::from_euler_angles(0.3, 0.2, 0.5));
    let upright = turn("+x", "+z");
    let two_paints: Vec<_> = CAR
        .iter()
        .enumerate()
        .map(|(i, part)| ([["A", "B"][i % 2], part.0][usize::from(i > 3)], part.1, part.2))
        .collect();
    let long = [("Lack", [-1.6, -0.7, 0.0], [1.6, 0.7, 1.2])];
    let rows: &[(&str, String, &str, &[&str])] = &[
        (
            "nose or tail",
            obj(&both_ends, upright, 1.0),
            "",
            &["its front is +x or -x (its top is +z)", "--mesh-front"],
        ),
        ("a box", obj(body, upright, 1.0), "", &["--mesh-front and --mesh-up"]),
        (
            "a cube",
            obj(&[("a", [-1.0; 3], [1.0; 3])], upright, 1.0),
            "",
            &["no side is clearly the longest", "--mesh-front"],
        ),
        ("askew", obj(CAR, askew, 1.0), "", &["no side mirrors the other"]),
        (
            "two paints",
            obj(&two_paints, upright, 1.0),
            "",
            &["'A' (", "'B' (", "--paint"],
        ),
        (
            "two lengths",
            obj(&long, upright, 0.01),
            " --scale 24 --mesh-front +x --mesh-up +z --class truck",
            &["--length-mm"],
        ),
        (
            "no known unit",
            obj(CAR, upright, 2.2),
            "",
            &["2 long in its own unit", "--length-mm"],
        ),
        (
            "no car",
            obj(CAR, upright, 1.0),
            " --class dog",
            &["known only of vehicles", "--mesh-front and --mesh-up"],
        ),
        (
            "no such material",
            obj(CAR, upright, 1.0),
            " --paint Pant",
            &["no material 'Pant'"],
        ),
        (
            "one axis twice",
            obj(CAR, upright, 1.0),
            " --mesh-front +x --mesh-up -x",
            &["same axis"],
        ),
    ];
    for (what, text, options, words) in rows {
        write(&folder, "car.obj", text);
        let length = if what.contains("length") || what.contains("unit") {
            ""
        } else {
            " --length-mm 440"
        };
        let output = run(&folder, &format!("scene new --mesh car.obj{length}{options} -o s.toml"));
        assert_refused(&output, words);
        assert!(
            !folder.path().join("s.toml").exists() && !folder.path().join("s_mesh.png").exists(),
            "{what}"
        );
    }
    // The answer is all that it takes.
    write(&folder, "car.obj", &obj(&both_ends, upright, 1.0));
    let said = done(
        &folder,
        "scene new --mesh car.obj --mesh-front -x --paint all -o s.toml",
    );
    assert!(
        said.contains("front  -x, as given") && said.contains("top    +z, it stands on its wheels"),
        "{said}"
    );
}

/// Commands that take the model; each is refused for a car on its side, and done by the scene alone.
const COMMANDS: &[&str] = &[
    "print wrap MODEL --pattern p.png --tile-mm 118 --paper a3 -o out.pdf",
    "print wrap --panels MODEL --pattern p.png --tile-mm 118 --paper a3 -o out.pdf",
    "print patch MODEL --patch p.png --panel left --at-mm 0,50 --size-mm 40 --paper a3 -o out.pdf",
    "texture show MODEL --pattern p.png --tile-mm 118 --size-px 64x48 -o out.png",
    "texture bake MODEL --pattern p.png --tile-mm 118 --size 256 -o out.png",
];

#[test]
fn every_command_takes_the_model_from_the_scene_and_none_takes_a_car_on_its_side() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("-x", "+y"), 1.0));
    done(&folder, "pattern random --cells 4 --seed 1 -o p.png");
    for command in COMMANDS {
        let output = run(&folder, &command.replace("MODEL", "--mesh car.obj --length-mm 440"));
        assert_refused(
            &output,
            &[
                "by its shape they are -x and +y",
                "--mesh-front -x --mesh-up +y",
                "scaleproof scene new --mesh car.obj",
            ],
        );
    }
    done(&folder, "scene new --mesh car.obj --length-mm 440 -o s.toml");
    for command in COMMANDS {
        let said = done(
            &folder,
            &format!("{} --json", command.replace("MODEL", "--scene s.toml")),
        );
        if command.starts_with("print wrap") {
            let size = &serde_json::from_str::<serde_json::Value>(&said).unwrap()["model_size_mm"];
            let size: Vec<f64> = size
                .as_array()
                .unwrap()
                .iter()
                .map(|mm| mm.as_f64().unwrap().round())
                .collect();
            assert_eq!(size, [440.0, 180.0, 140.0]);
        }
    }
    // Only what is painted: the roof and the body, without glass and tyres.
    let all = done(
        &folder,
        "print wrap --panels --scene s.toml --material Lack Glas Reifen --pattern p.png --tile-mm 118 --paper a3 -o all.pdf --json",
    );
    let own = done(
        &folder,
        "print wrap --panels --scene s.toml --pattern p.png --tile-mm 118 --paper a3 -o own.pdf --json",
    );
    let area = |text: &str| {
        serde_json::from_str::<serde_json::Value>(text).unwrap()["surface_mm2"]
            .as_f64()
            .unwrap()
    };
    assert!(area(&own) < 0.9 * area(&all));
    let shown = done(&folder, "scene show s.toml");
    for words in [
        "1:10, counts as car",
        "its front is to -x and its top to +y",
        "paint  Lack",
        "boxes around the model's outline",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
}

/// Axes that are not those of the shape are noted where they are given, and where an old scene says nothing of them.
#[test]
fn a_car_that_drives_backwards_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("+z", "+y"), 1.0));
    for (i, (given, is_noted)) in [("+z", false), ("-z", true)].into_iter().enumerate() {
        let output = run(
            &folder,
            &format!("scene new --mesh car.obj --length-mm 440 --mesh-front {given} -o {i}.toml"),
        );
        let said = stderr(&output);
        assert!(
            output.status.success()
                && said.contains("by its shape the front of the mesh is +z and its top +y") == is_noted,
            "{said}"
        );
    }
    let session = common::copy_of_skyline();
    let scene = std::fs::read_to_string(session.path().join("scene.toml")).unwrap();
    let scene = scene
        .replace("size_mm = [455.0, 185.7, 129.1]", "size_mm = [440.0, 180.0, 140.0]")
        .replace("envelope = \"box\"", "envelope = \"mesh\"\nmesh = \"car.obj\"");
    assert!(scene.contains("car.obj") && scene.contains("440.0"), "{scene}");
    write(&session, "scene.toml", &scene);
    for (front, is_noted) in [("+x", false), ("-x", true)] {
        write(&session, "car.obj", &obj(CAR, turn(front, "+z"), 0.01));
        for command in [
            "scene show scene.toml",
            "score . --recorded --detector fastestdet -o ../turned",
        ] {
            let output = run(
                &session,
                &command.replace("../turned", &format!("{}/out", folder.path().display())),
            );
            let said = stderr(&output);
            let words = "by its shape they are -x and +z, so that truth boxes may be of a model that is turned: write mesh_front = \"-x\"";
            assert!(
                output.status.success() && said.contains(words) == is_noted,
                "{command}: {said}"
            );
        }
    }
}

/// A name of paint that is none says what it was to be.
#[test]
fn paint_that_is_misnamed_says_what_was_meant() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("+x", "+z"), 1.0));
    for (paint, words) in [
        ("faces.txt", "there is no file faces.txt"),
        ("Lack,Glas", "several names stand with blanks between them"),
        ("lakc", "did you mean Lack?"),
    ] {
        let output = run(&folder, &format!("scene new --mesh car.obj --paint {paint} -o s.toml"));
        assert_refused(&output, &[words]);
    }
}

/// `attack evaluate` counts the labels that the scene does.
#[test]
#[cfg(unix)]
fn patterns_are_judged_by_the_class_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("+x", "+z"), 1.0));
    let hello = r#"{"scaleproof_detector": 1, "name": "cars", "version": "1", "labels": ["car"], "input": "path", "deterministic": true}"#;
    write(&folder, "cars.sh", &format!("echo '{hello}'\ncat > none"));
    done(&folder, "pattern random --cells 4 --seed 1 -o p.png");
    done(
        &folder,
        "scene new --mesh car.obj --length-mm 440 --class truck -o s.toml",
    );
    let mut evaluate: Vec<&str> = "attack evaluate --scene s.toml --normal 808080 --pattern p=p.png --tile-mm 118 --target cars -o out --detector".split(' ').collect();
    evaluate.push("exec:sh cars.sh");
    let output = program().current_dir(folder.path()).args(&evaluate).output().unwrap();
    assert_refused(&output, &["cars has no label `truck`"]);
}

/// The truth of a scene that the mesh step wrote is that of the same mesh in the model frame.
#[test]
fn truth_boxes_do_not_depend_on_how_the_mesh_lies() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("-z", "+y"), 0.01));
    write(&folder, "plain.obj", &obj(CAR, turn("+x", "+z"), 0.01));
    done(
        &folder,
        "scene new --mesh car.obj --length-mm 440 --radius-mm 400 -o s.toml",
    );
    let scene = Scene::open(&folder.path().join("s.toml")).unwrap();
    let found = EnvelopeShape::open(&scene.model, folder.path()).unwrap();
    let plain = Mesh::load(&folder.path().join("plain.obj"), &MeshPlacement::default()).unwrap();
    let plain = EnvelopeShape::surface(&plain, &scene.model);
    let camera = Camera::open(&skyline().join("camera.yaml")).unwrap();
    for azimuth_deg in [0.0, 50.0, 170.0, 290.0] {
        let viewpoint = Viewpoint {
            azimuth_deg,
            pitch_deg: 15.0,
            distance_mm: 900.0,
        };
        let pose = looking_at(&viewpoint, Point3::new(0.0, 0.0, 70.0));
        let [a, b] = [&found, &plain].map(|shape| shape.box_in_photo(&pose, &camera).unwrap());
        assert!(
            [a.x1 - b.x1, a.y1 - b.y1, a.x2 - b.x2, a.y2 - b.y2]
                .iter()
                .all(|d| d.abs() < 0.01),
            "{a:?} {b:?}"
        );
    }
}

/// A session's own folder has the scene, the mesh and the list of painted triangles.
#[test]
fn a_list_of_painted_triangles_goes_along_with_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "car.obj", &obj(CAR, turn("+x", "+y"), 1.0));
    write(&folder, "faces.txt", "0 1 2 3 4 5 6 7 8 9 10 11");
    done(
        &folder,
        "scene new --mesh car.obj --paint faces.txt --radius-mm 400 -o s.toml",
    );
    done(&folder, "pattern random --cells 4 --seed 1 -o p.png");
    std::fs::create_dir(folder.path().join("normal")).unwrap();
    std::fs::copy(skyline().join("normal_000.jpg"), folder.path().join("normal/a.jpg")).unwrap();
    let camera = skyline().join("camera.yaml");
    done(
        &folder,
        &format!(
            "session new one normal=normal --scene s.toml --camera {} --copy",
            camera.display()
        ),
    );
    for scene in ["s.toml", "one/scene.toml"] {
        let said = done(
            &folder,
            &format!(
                "print wrap --panels --scene {scene} --pattern p.png --tile-mm 118 --paper a3 -o {}.pdf --json",
                scene.len()
            ),
        );
        let area = serde_json::from_str::<serde_json::Value>(&said).unwrap()["surface_mm2"]
            .as_f64()
            .unwrap();
        // The rear of the body: four sides of 2.9 × 1.8 × 0.65 m at 1:10, and its top and bottom.
        assert!(
            (area - 100.0 * 100.0 * 2.0 * (2.9 * 1.8 + 2.9 * 0.65 + 1.8 * 0.65)).abs() < 50.0,
            "{area}"
        );
    }
}

/// The shared meshes: file, its front, its top, what is painted.
#[test]
#[ignore = "needs the shared meshes"]
fn the_shared_meshes_are_understood() {
    let rows = [
        ("meshes/skyline_r32_lowpoly_ccby4.glb", ["+z", "+y"], "Material.001"),
        ("meshes/rauca_etron/model_save.obj", ["+x", "+z"], "all of the mesh"),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (i, (mesh, axes, paint)) in rows.iter().enumerate() {
        let (mesh, scene) = (shared(mesh), folder.path().join(format!("{i}.toml")));
        let said = done(
            &folder,
            &format!(
                "scene new --mesh {} --length-mm 457 -o {}",
                mesh.display(),
                scene.display()
            ),
        );
        let found = Scene::open(Path::new(&scene)).unwrap().model.mesh.axes.unwrap();
        assert_eq!(found.map(|axis| axis.to_string()), *axes);
        assert!(said.contains(paint), "{said}");
    }
}
