//! Weights that are nowhere.

use scaleproof_detect::{Manifest, WeightFolders};

#[test]
fn what_cannot_be_fetched_is_not_said_to_be() {
    let nowhere = WeightFolders {
        named: None,
        folders: Vec::new(),
    };
    let sentence = |manifest: &Manifest| nowhere.checked(manifest).unwrap_err().to_string();
    let mut manifest = Manifest::named("yolox_nano").unwrap();
    assert!(sentence(&manifest).contains("scaleproof detectors fetch yolox_nano"));
    manifest.weights.url.clear();
    assert!(sentence(&manifest).contains("put yolox_nano.onnx beside its manifest"));
}
