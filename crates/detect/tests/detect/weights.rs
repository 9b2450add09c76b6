//! Weights that are nowhere, and weights in two files.

use crate::exported::{LABELS, labelled, stored};
use scaleproof_core::files::sha256_hex;
use scaleproof_detect::{Manifest, Runtime, WeightFolders, propose};

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

/// Transformers and PyTorch write `network.onnx` and `network.onnx.data`.
#[test]
fn weights_beside_the_graph_count() {
    let folder = tempfile::tempdir().unwrap();
    let [network, data] = ["detr.onnx", "detr.onnx.data"].map(|name| {
        let copy = folder.path().join(name);
        std::fs::copy(stored(name), &copy).unwrap();
        copy
    });
    let mut manifest = propose(
        Runtime::load().unwrap(),
        &network,
        "detr.onnx",
        "own",
        labelled(&LABELS),
    )
    .unwrap()
    .manifest;
    let [graph, tensors] = [&network, &data].map(|path| std::fs::read(path).unwrap());
    assert_eq!(manifest.weights.sha256, sha256_hex(&[graph, tensors.clone()].concat()));
    manifest.folder = Some(folder.path().to_owned());
    let folders = WeightFolders {
        named: None,
        folders: Vec::new(),
    };
    assert_eq!(folders.checked(&manifest).unwrap(), network);
    let mut other = tensors;
    other[40_000] ^= 1;
    std::fs::write(&data, other).unwrap();
    let error = folders.checked(&manifest).unwrap_err().to_string();
    assert!(
        error.contains("detr.onnx with detr.onnx.data beside it is not the file own was described with"),
        "{error}"
    );
    std::fs::remove_file(&data).unwrap();
    let error = folders.checked(&manifest).unwrap_err().to_string();
    assert!(error.contains("detr.onnx.data"), "{error}");
}
