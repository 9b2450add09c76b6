//! Manifests.

use scaleproof_detect::{Manifest, ManifestError};

#[test]
fn every_manifest_of_the_folder_ships_and_reads() {
    let shipped: Vec<_> = Manifest::all().unwrap();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/manifests");
    let files = std::fs::read_dir(folder)
        .unwrap()
        .filter(|f| f.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml"));
    assert_eq!(shipped.len(), files.count());
    for m in &shipped {
        assert_eq!(m.weights.sha256.len(), 64, "{}", m.name);
        assert!(m.weights.url.starts_with("https://"), "{}", m.name);
        // A download by a shortened commit may fail, or find another file one day.
        let is_commit = |part: &str| part.len() == 40 && part.bytes().all(|b| b.is_ascii_hexdigit());
        assert!(m.weights.url.split('/').any(is_commit), "{}", m.weights.url);
    }
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let text = Manifest::named("yolo99").unwrap_err().to_string();
    assert!(
        text.contains("yolo99") && text.contains("yolox_nano, nanodet_m"),
        "{text}"
    );
}

/// A manifest without an address to fetch from, whose weights have this name.
fn with_file(file: &str) -> Result<Manifest, ManifestError> {
    let mut manifest = Manifest::named("yolox_nano").unwrap();
    manifest.weights.url.clear();
    manifest.weights.file = file.into();
    Manifest::parse(&manifest.to_toml()?, "x.toml")
}

#[test]
fn a_whole_path_may_be_read_and_never_fetched_to() {
    for file in ["/home/me/my car.onnx", "my car.onnx", "CAR.ONNX", "car.ort"] {
        assert_eq!(with_file(file).unwrap().weights.file, file);
    }
    for file in [
        "/home/../etc/car.onnx",
        "cars/car.onnx",
        "./car.onnx",
        "",
        ".onnx",
        "/",
        "car.onnx/",
    ] {
        assert!(with_file(file).is_err(), "{file:?}");
    }
}

#[test]
fn an_unknown_key_is_refused() {
    let text = format!("colour = 1\n{}", include_str!("../../src/manifests/yolox_nano.toml"));
    assert!(
        Manifest::parse(&text, "x.toml")
            .unwrap_err()
            .to_string()
            .contains("unknown field `colour`")
    );
}
