//! Tests of `cli/units.rs`.

use super::*;

/// `README.md`, `calibration/`, `captures/skyline/scene.toml`, and what is as usual.
#[test]
fn usual_lengths_raise_no_doubt() {
    for (size, tile, scale) in [
        ((600.0, 300.0), 118.0, 10.0),
        ((600.0, 300.0), 240.0, 10.0),
        ((118.0, 118.0), 118.0, 10.0),
        ((455.0, 128.0), 118.0, 10.0),
        ((2000.0, 600.0), 118.0, 10.0),
        ((80.0, 80.0), 40.0, 24.0),
        ((4600.0, 1300.0), 1180.0, 1.0),
    ] {
        assert_eq!(template(size, tile, scale), None);
    }
    for (class, size, scale) in [
        ("car", [455.0, 186.0, 128.0], 10.0),
        ("car", [269.0, 166.0, 155.0], 10.0),
        ("car", [4545.0, 1755.0, 1340.0], 1.0),
        ("car", [190.0, 78.0, 53.0], 24.0),
        ("bus", [1800.0, 255.0, 300.0], 10.0),
        ("person", [30.0, 50.0, 175.0], 10.0),
        ("stop sign", [5.0, 75.0, 75.0], 10.0),
        ("cup", [80.0, 80.0, 100.0], 1.0),
    ] {
        assert_eq!(model_of(class, size, scale), None);
    }
    let scene = scaleproof_pose::scene::Scene::open(
        &std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("captures/skyline/scene.toml"),
    );
    let stored = scene.unwrap().model;
    assert_eq!(model(stored.class.labels(), stored.size_mm, stored.scale), None);
}

#[test]
fn lengths_in_another_unit_are_noticed() {
    let said = |doubt: Option<String>| doubt.unwrap_or_default();
    assert_eq!(
        said(template((4.6, 1.3), 118.0, 10.0)),
        "the template is 4.6 × 1.3 mm: were these metres? At 1:10 that is --size-mm 460x130"
    );
    assert_eq!(
        said(template((60.0, 30.0), 118.0, 10.0)),
        "the template of 60 × 30 mm is smaller than one repeat of the pattern (118 mm): was it in cm? That is --size-mm 600x300"
    );
    assert_eq!(
        said(template((4600.0, 1300.0), 118.0, 10.0)),
        "the template of 4600 × 1300 mm covers 46 m of the real thing: is that its full size? At 1:10 it is --size-mm 460x130"
    );
    let models = [
        (
            [46.0, 20.0, 13.0],
            "0.46 m long in reality: were these cm? That is --model-size-mm 460x200x130",
        ),
        (
            [4.6, 1.9, 1.3],
            "0.05 m long in reality: were these metres of the real thing? That is --model-size-mm 460x190x130",
        ),
        (
            [4600.0, 1900.0, 1300.0],
            "46 m long in reality: were these mm of the real thing? That is --model-size-mm 460x190x130",
        ),
        (
            [0.46, 0.19, 0.13],
            "0 m long in reality: were these metres? That is --model-size-mm 460x190x130",
        ),
        (
            [1.0, 1.0, 1.0],
            "0.01 m long in reality: are --model-size-mm and --scale right?",
        ),
    ];
    for (size, end) in models {
        let said = said(model_of("car", size, 10.0));
        assert!(said.starts_with("the car of ") && said.ends_with(end), "{said}");
    }
    assert_eq!(
        said(model_of("car", [186.0, 455.0, 128.0], 10.0)),
        "the car is 186 mm long and 455 mm wide: the order is length x width x height"
    );
    assert_eq!(
        said(model_of("truck", [255.0, 1200.0, 380.0], 10.0)),
        "the truck is 255 mm long and 1200 mm wide: the order is length x width x height"
    );
}
