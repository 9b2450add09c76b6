//! Truth boxes: box, hull and mesh against images drawn here, against the exact truth of the stored session, and bad input.

use crate::common;

use common::{assert_refused, copy_of_skyline, program, read_json, shared, skyline, stderr, stdout};
use nalgebra::{Point3, Rotation3, Vector3};
use opencv::calib3d;
use opencv::core::{Mat, Point2d, Point3d, Vector, no_array};
use proptest::prelude::*;
use scaleproof_core::geometry::{BoxPx, Rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Envelope, ScaleModel};
use scaleproof_session::envelope::{EnvelopeShape, NoTruth};
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use std::path::Path;

/// Length, width and height of the car below, mm: those of the stored session's model.
const SIZE_MM: [f64; 3] = [455.0, 185.7, 129.1];

/// A car of three boxes, as triangles in the model frame: two axles with a hollow between them, and a cabin above. From the side its
/// hull is larger than itself.
fn car() -> Vec<[[f64; 3]; 3]> {
    let [l, w, h] = SIZE_MM.map(|mm| mm / 2.0);
    let boxes = [
        ([-l, -w, 0.0], [-l + 120.0, w, 40.0]),
        ([l - 120.0, -w, 0.0], [l, w, 40.0]),
        ([-l, -w, 40.0], [l, w, 75.0]),
        ([-90.0, -w + 20.0, 75.0], [60.0, w - 20.0, 2.0 * h]),
    ];
    boxes.iter().flat_map(|(low, high)| cuboid(*low, *high)).collect()
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let corner = |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 1 { high[axis] } else { low[axis] });
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    halves.map(|t| t.map(corner)).collect()
}

fn obj(triangles: &[[[f64; 3]; 3]]) -> String {
    let vertices: String = triangles
        .iter()
        .flatten()
        .map(|[x, y, z]| format!("v {x} {y} {z}\n"))
        .collect();
    let faces = (0..triangles.len()).map(|i| format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3));
    vertices + &faces.collect::<String>()
}

fn model() -> ScaleModel {
    ScaleModel {
        name: "car".into(),
        scale: 10.0,
        class: "car".parse().unwrap(),
        size_mm: SIZE_MM,
        envelope: Envelope::Box,
        mesh: Default::default(),
    }
}

fn outlines() -> [EnvelopeShape; 3] {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("car.obj");
    std::fs::write(&path, obj(&car())).unwrap();
    let mesh = Mesh::load(&path, &MeshPlacement::default()).unwrap();
    let model = model();
    [
        EnvelopeShape::of_box(&model),
        EnvelopeShape::hull(&mesh, &model),
        EnvelopeShape::surface(&mesh, &model),
    ]
}

/// A camera at an azimuth, pitch and distance that looks at a point beside the model, turned about its axis.
fn pose(azimuth_deg: f64, pitch_deg: f64, distance_mm: f64, aside_mm: [f64; 2], roll_deg: f64) -> Rigid {
    let (a, p) = (azimuth_deg.to_radians(), pitch_deg.to_radians());
    let forward = -Vector3::new(p.cos() * a.cos(), p.cos() * a.sin(), p.sin());
    let right = forward.cross(&Vector3::z()).normalize();
    let down = forward.cross(&right);
    let centre = Point3::new(0.0, 0.0, 60.0) - forward * distance_mm + right * aside_mm[0] + down * aside_mm[1];
    let turn = Rotation3::from_basis_unchecked(&[right, down, forward]).inverse();
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), roll_deg.to_radians()) * turn;
    Rigid::from_parts((turn * -centre.coords).into(), turn.into())
}

const LENS: [f64; 5] = [-0.14, 0.06, 0.002, -0.003, 0.0];

fn camera() -> Camera {
    Camera::pinhole(1280, 960, 1180.0, 1175.0, 640.0, 470.0).with_distortion(&LENS)
}

/// Where OpenCV puts some points of the camera frame, from the image's corner: its pixels count from the middle of the first.
fn by_opencv(points: &[Point3<f64>]) -> Vec<[f64; 2]> {
    let points: Vector<Point3d> = points.iter().map(|p| Point3d::new(p.x, p.y, p.z)).collect();
    let k = Mat::from_slice_2d(&[[1180.0, 0.0, 640.0], [0.0, 1175.0, 470.0], [0.0, 0.0, 1.0]]).unwrap();
    let lens: Vector<f64> = LENS.into_iter().collect();
    let zero: Vector<f64> = [0.0; 3].into_iter().collect();
    let mut pixels = Vector::<Point2d>::new();
    calib3d::project_points(&points, &zero, &zero, &k, &lens, &mut pixels, &mut no_array(), 0.0).unwrap();
    pixels.iter().map(|p| [p.x + 0.5, p.y + 0.5]).collect()
}

/// The box around the points of the car that OpenCV puts into the image: each triangle strewn with points 4 mm apart, its sides with
/// points `step_mm` apart.
fn strewn(pose: &Rigid, step_mm: f64) -> Option<BoxPx> {
    let mut points = Vec::new();
    for [a, b, c] in car().iter().map(|t| t.map(|p| pose * Point3::from(p))) {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let steps = ((q - p).norm() / step_mm).ceil() as usize;
            points.extend((0..=steps).map(|i| p + (q - p) * (i as f64 / steps as f64)));
        }
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let steps = (longest / 4.0).ceil() as usize;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                points.push(a + (b - a) * u + (c - a) * v);
            }
        }
    }
    // What is far off the axis is out of this image, and the lens formula means nothing there.
    points.retain(|p| p.z > 1.0 && p.x.hypot(p.y) < 0.9 * p.z);
    let inside = |[x, y]: &[f64; 2]| (0.0..=1280.0).contains(x) && (0.0..=960.0).contains(y);
    BoxPx::around(by_opencv(&points).into_iter().filter(inside))
}

fn gap(a: &BoxPx, b: &BoxPx) -> f64 {
    let sides = [a.x1 - b.x1, a.y1 - b.y1, a.x2 - b.x2, a.y2 - b.y2];
    sides.into_iter().fold(0.0, |worst, side| worst.max(side.abs()))
}

/// True when a box reaches two borders of the image that meet.
fn covers_a_corner(b: &BoxPx) -> bool {
    (b.x1 < 0.1 || b.x2 > 1279.9) && (b.y1 < 0.1 || b.y2 > 959.9)
}

/// True when `outer` holds `inner`.
fn holds(outer: &BoxPx, inner: &BoxPx) -> bool {
    // Bent edges are drawn by chords that leave them by 0.01 px at most.
    let slack = 0.02;
    outer.x1 <= inner.x1 + slack
        && outer.y1 <= inner.y1 + slack
        && outer.x2 >= inner.x2 - slack
        && outer.y2 >= inner.y2 - slack
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// From far away to so near that every border cuts the car: the mesh's box is that of the points OpenCV sees.
    #[test]
    fn the_mesh_s_box_is_what_opencv_sees_of_it(
        azimuth in 0.0..360.0_f64, pitch in 2.0..70.0_f64, distance in 420.0..1500.0_f64,
        aside in prop::array::uniform2(-250.0..250.0_f64), roll in -30.0..30.0_f64,
    ) {
        let (pose, camera) = (pose(azimuth, pitch, distance, aside, roll), camera());
        let [of_box, hull, mesh] = outlines().map(|o| o.box_in_photo(&pose, &camera));
        let Some(seen) = strewn(&pose, 0.5) else {
            prop_assert!(mesh.is_err() || mesh.unwrap().area() < 50.0);
            return Ok(());
        };
        let mesh = mesh.unwrap();
        prop_assert!(holds(&mesh, &seen), "{mesh:?} cuts {seen:?}");
        // So far apart are the strewn points at the car's near end; only where it covers a corner of the image do those within a
        // triangle matter.
        let px_per_mm = 1200.0 / (distance - 250.0);
        let apart_mm = if covers_a_corner(&mesh) { 6.0 } else { 0.7 };
        prop_assert!(gap(&mesh, &seen) < apart_mm * px_per_mm, "{mesh:?} is more than {seen:?}");
        // Each envelope holds the next.
        let (of_box, hull) = (of_box.unwrap(), hull.unwrap());
        prop_assert!(holds(&of_box, &hull) && holds(&hull, &mesh), "{of_box:?} {hull:?} {mesh:?}");
        let picture = BoxPx::new(0.5, 0.5, 1279.5, 959.5);
        if holds(&picture, &mesh) {
            // Only the lens, which bends the hull's long edges, can tell them apart.
            prop_assert!(gap(&hull, &mesh) < 1.5, "{hull:?} {mesh:?}");
        }
    }
}

/// At the border the hull's box holds the hollow between the axles, the mesh's does not.
#[test]
fn a_cut_model_is_where_hull_and_mesh_differ() {
    // So near to the left side that both axles are out of the image there.
    let pose = pose(90.0, 0.0, 243.0, [0.0; 2], 0.0);
    let [_, hull, mesh] = outlines().map(|o| o.box_in_photo(&pose, &camera()).unwrap());
    let seen = strewn(&pose, 0.2).unwrap();
    println!("hull {hull:?}\nmesh {mesh:?}\nseen {seen:?}");
    assert!(gap(&mesh, &seen) < 2.0);
    assert!(hull.y2 > mesh.y2 + 50.0);
}

/// What hides in front of the lens is refused, not answered.
#[test]
fn a_camera_in_the_model_has_no_truth() {
    for outline in outlines() {
        let inside = pose(10.0, 10.0, 40.0, [0.0; 2], 0.0);
        assert_eq!(outline.box_in_photo(&inside, &camera()), Err(NoTruth::InsideModel));
    }
}

fn chart(mesh: Option<&Path>, out: &Path) -> std::process::Output {
    let mut command = program();
    command.args(["chart", "envelope", "--session"]).arg(skyline());
    command
        .arg("--truth")
        .arg(skyline().join("truth.json"))
        .arg("-o")
        .arg(out);
    if let Some(mesh) = mesh {
        command.arg("--mesh").arg(mesh);
    }
    command.output().unwrap()
}

/// The acceptance line: the mesh's truth boxes fit the exact ones in every photo.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_skyline_mesh_fits_the_exact_boxes() {
    let mesh = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let out = tempfile::tempdir().unwrap();
    let output = chart(Some(&mesh), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    println!("{}", stdout(&output));
    let numbers = read_json(&out.path().join("envelope.json"));
    let rows = numbers["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["envelope"].as_str().unwrap()).collect();
    assert_eq!(names, ["box", "hull", "mesh"]);
    let figure = |row: usize, key: &str| rows[row][key].as_f64().unwrap();
    for row in [1, 2] {
        assert!(figure(row, "iou_min") >= 0.99 && figure(row, "answered") == 1.0);
    }
    assert_eq!(rows[2]["boxes"].as_array().unwrap().len(), 16);
    assert!(
        figure(0, "iou_median") < figure(2, "iou_median"),
        "the mesh must buy something"
    );
    let svg = std::fs::read_to_string(out.path().join("envelope.svg")).unwrap();
    let drawn = roxmltree::Document::parse(&svg).unwrap();
    for name in names {
        assert!(drawn.descendants().any(|n| n.text() == Some(name)), "{name} is named");
    }
}

/// Without the shared mesh: the box has its figure, and a mesh that is the box itself has the same.
#[test]
fn a_mesh_of_the_box_charts_as_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    let [l, w, h] = SIZE_MM;
    let triangles = cuboid([-l / 2.0, -w / 2.0, 0.0], [l / 2.0, w / 2.0, h]);
    std::fs::write(&path, obj(&triangles)).unwrap();
    let output = chart(Some(&path), folder.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let numbers = read_json(&folder.path().join("envelope.json"));
    let figures = |i: usize| {
        let row = &numbers["rows"][i];
        [&row["iou_median"], &row["iou_min"]].map(|v| v.as_f64().unwrap())
    };
    println!("box: median and worst IoU {:?}", figures(0));
    assert!(figures(0)[0] > 0.7 && figures(0)[1] > 0.6);
    for i in [1, 2] {
        assert!((figures(i)[0] - figures(0)[0]).abs() < 1e-4 && (figures(i)[1] - figures(0)[1]).abs() < 1e-4);
    }
    assert_eq!(numbers["rows"][0]["is_default"], true);
    // A truth file without boxes is refused.
    std::fs::write(
        folder.path().join("t.json"),
        r#"{"photos":[{"file":"normal_000.jpg"}]}"#,
    )
    .unwrap();
    let mut command = program();
    command
        .args(["chart", "envelope", "--session"])
        .arg(skyline())
        .arg("--truth");
    let output = command
        .arg(folder.path().join("t.json"))
        .arg("-o")
        .arg(folder.path())
        .output()
        .unwrap();
    assert_refused(&output, &["t.json is no truth file", "box_xyxy_px"]);
}

/// A copy of the session whose scene names an envelope and a mesh.
fn session_with(envelope: &str, mesh: &str, content: &str) -> tempfile::TempDir {
    let copy = copy_of_skyline();
    let scene = std::fs::read_to_string(copy.path().join("scene.toml")).unwrap();
    let scene = scene.replace(
        "envelope = \"box\"",
        &format!("envelope = \"{envelope}\"\nmesh = \"{mesh}\""),
    );
    std::fs::write(copy.path().join("scene.toml"), scene).unwrap();
    std::fs::write(copy.path().join("car.obj"), content).unwrap();
    copy
}

fn score(session: &Path, out: &Path) -> std::process::Output {
    let mut command = program();
    command
        .arg("score")
        .arg(session)
        .args(["--recorded", "--detector", "fastestdet", "--all", "--out"]);
    command.arg(out).output().unwrap()
}

/// The report, its JSON and the terminal say what was projected.
#[test]
fn a_scene_s_mesh_makes_the_truth_boxes_and_is_named() {
    let out = tempfile::tempdir().unwrap();
    for envelope in ["hull", "mesh"] {
        let session = session_with(envelope, "car.obj", &obj(&car()));
        let output = score(session.path(), out.path());
        assert!(output.status.success(), "{}", stderr(&output));
        let said = format!("envelope {envelope}");
        assert!(stdout(&output).contains("truth boxes: 16 through the pose") && stdout(&output).contains(&said));
        let summary = read_json(&out.path().join("summary.json"));
        let told = &summary["provenance"]["sessions"][0];
        assert_eq!(
            (&told["truth_envelope"], &told["truth_mesh"]),
            (&envelope.into(), &"car.obj".into())
        );
        assert_eq!(told["files"]["car.obj"].as_str().unwrap().len(), 64);
        let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
        assert!(page.contains(&said), "the report names the envelope");
    }
    // The boxes are those of the mesh: smaller than the box's in every photo.
    let by_mesh = read_json(&out.path().join("coco_truth.json"));
    assert!(score(&skyline(), out.path()).status.success());
    let by_box = read_json(&out.path().join("coco_truth.json"));
    for i in 0..16 {
        let area = |truth: &serde_json::Value| truth["annotations"][i]["area"].as_f64().unwrap();
        assert!(area(&by_mesh) < 0.99 * area(&by_box));
    }
}

#[test]
fn a_mesh_that_is_not_the_model_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let moved: Vec<_> = car().iter().map(|t| t.map(|[x, y, z]| [x + 30.0, y, z])).collect();
    let in_metres: Vec<_> = car().iter().map(|t| t.map(|p| p.map(|mm| mm / 1000.0))).collect();
    for (mesh, content, words) in [
        (
            "car.obj",
            obj(&moved),
            ["car.obj reaches from -197.5 to 257.5 mm", "length (x)"],
        ),
        (
            "car.obj",
            obj(&in_metres),
            ["car.obj reaches from -0.2 to 0.2 mm", "export the mesh in mm"],
        ),
        ("gone.stl", String::new(), ["cannot read", "gone.stl"]),
        ("scene.toml", String::new(), ["scene.toml is no mesh", ".glb"]),
    ] {
        let session = session_with("mesh", mesh, &content);
        assert_refused(&score(session.path(), out.path()), &words);
        assert_eq!(std::fs::read_dir(out.path()).unwrap().count(), 0, "nothing is written");
    }
}

/// A surveyed scene written elsewhere still finds its mesh.
#[test]
fn a_surveyed_scene_keeps_its_mesh() {
    let session = session_with("mesh", "car.obj", &obj(&car()));
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command
        .arg("survey")
        .args((0..8).map(|i| session.path().join(format!("normal_00{i}.jpg"))));
    command.arg("--camera").arg(session.path().join("camera.yaml"));
    command.arg("--scene").arg(session.path().join("scene.toml"));
    command
        .args(["--fixed", "0,1,2,3,4,5,6,7", "-o"])
        .arg(out.path().join("scene.toml"));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let scene = scaleproof_pose::scene::Scene::open(&out.path().join("scene.toml")).unwrap();
    assert!(EnvelopeShape::open(&scene.model, out.path()).is_ok());
}
