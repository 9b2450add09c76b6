//! Reading `scene.toml`.

use nalgebra::Point3;
use proptest::prelude::*;
use scaleproof_pose::scene::{Envelope, Scene, TagFamily};
use std::path::Path;

const GOOD: &str = r#"
[model]
name = "car"
scale = 10
class = "car"
size_mm = [455.0, 186.0, 128.0]
[bins]
azimuth_deg = 45
pitch_deg = [15]
distance_mm = [850]
[[tag]]
id = 0
size_mm = 50.0
centre_mm = [396.1, 0.0, 24.7]
right = [0.0, 1.0, 0.0]
up = [-0.5, 0.0, 0.866]
"#;

fn refusal(text: &str) -> String {
    Scene::parse(text, Path::new("scene.toml")).unwrap_err().to_string()
}

#[test]
fn the_design_example_reads() {
    let scene = Scene::parse(GOOD, Path::new("scene.toml")).unwrap();
    assert_eq!(scene.tags[0].family, TagFamily::Tag36h11);
    assert_eq!(scene.model.target_mm(), Point3::new(0.0, 0.0, 64.0));
}

#[test]
fn an_unknown_key_is_named_with_its_line() {
    let text = refusal(&GOOD.replace("scale = 10", "scale = 10\ncolour = \"red\""));
    assert!(text.starts_with("scene.toml, line 5: unknown field `colour`"), "{text}");
}

#[test]
fn an_envelope_and_its_mesh_are_read() {
    let text = GOOD.replace("[bins]", "envelope = \"hull\"\nmesh = \"car.stl\"\n[bins]");
    let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
    assert_eq!(scene.model.envelope, Envelope::Hull("car.stl".into()));
}

#[test]
fn a_duplicate_tag_id_is_refused() {
    let tag = &GOOD[GOOD.find("[[tag]]").unwrap()..];
    assert!(refusal(&format!("{GOOD}{tag}")).contains("tag id 0 appears twice"));
}

#[test]
fn impossible_scenes_are_refused() {
    for (from, to, reason) in [
        ("scale = 10", "scale = 0", "model.scale is 0"),
        ("azimuth_deg = 45", "azimuth_deg = 50", "does not divide 360"),
        ("pitch_deg = [15]", "pitch_deg = []", "at least one centre"),
        ("class = \"car\"", "class = []", "line 5: the class is an empty list"),
        ("class = \"car\"", "class = \"\"", "\"\" is no label"),
        ("class = \"car\"", "class = [\"car\", \"car\"]", "lists `car` twice"),
        ("class = \"car\"", "class = 3", "or a list of labels"),
        (
            "up = [-0.5, 0.0, 0.866]",
            "up = [0.0, 0.5, 0.866]",
            "not at a right angle",
        ),
        ("right = [0.0, 1.0, 0.0]", "right = [0.0, 2.0, 0.0]", "unit vector"),
        ("id = 0", "id = 587", "does not exist in its family"),
        ("[bins]", "envelope = \"ball\"\n[bins]", "unknown variant `ball`"),
        ("[bins]", "envelope = \"hull\"\n[bins]", "name the model's mesh"),
        ("[bins]", "mesh = \"a.stl\"\n[bins]", "the envelope is the box"),
        (
            "[bins]",
            "envelope = \"mesh\"\nmesh = \"\"\n[bins]",
            "model.mesh is empty",
        ),
        ("size_mm = 50.0", "size_mm = nan", "size_mm of tag 0 cannot be NaN"),
        (
            "size_mm = 50.0",
            "size_mm = 1e200",
            "size_mm of tag 0 cannot be 1e200 mm",
        ),
        ("396.1, 0.0", "396.1, 1e6", "centre_mm of tag 0 cannot be 1000000 mm"),
        ("[455.0, 186.0", "[455.0, 1e-300", "model.size_mm cannot be 1e-300 mm"),
        ("scale = 10", "scale = 1e9", "model.scale is 1e9"),
        ("azimuth_deg = 45", "azimuth_deg = 1e-9", "1e-9 does not divide 360"),
        ("azimuth_deg = 45", "azimuth_deg = nan", "NaN does not divide 360"),
        ("pitch_deg = [15]", "pitch_deg = [nan]", "bins.pitch_deg has NaN"),
        (
            "distance_mm = [850]",
            "distance_mm = [1e200]",
            "bins.distance_mm has 1e200",
        ),
        ("id = 0", "id = 0\nsigma_mm = 0.1", "sigma_mm and sigma_deg of tag 0"),
        ("id = 0", "id = 0\nsigma_mm = -1\nsigma_deg = 1", "0 or more"),
    ] {
        let text = refusal(&GOOD.replace(from, to));
        assert!(text.contains(reason), "{to}: {text}");
        assert!(!text.contains('\n'), "one sentence: {text}");
    }
}

proptest! {
    /// Any text: a scene or a sentence, never a panic.
    #[test]
    fn parsing_never_panics(text in "\\PC*", cut in 0usize..400) {
        let _ = Scene::parse(&text, Path::new("s"));
        let _ = Scene::parse(GOOD.get(..cut.min(GOOD.len())).unwrap_or(GOOD), Path::new("s"));
    }
}
