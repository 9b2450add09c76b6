//! Weights that are nowhere, and weights in two files.

use crate::exported::{LABELS, labelled, stored};
use proptest::prelude::*;
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

proptest! {
    /// Whatever a file called `.onnx` holds, it is looked through for files beside it.
    #[test]
    fn a_file_of_any_bytes_is_another_file(bytes in prop::collection::vec(any::<u8>(), 0..200), around in 0..4000_usize) {
        // Graphs within attributes within nodes, thousands deep: fields 7, 1, 5, 6, 1, 5, 6, …
        let nested = (0..around).rev().fold(bytes, |inner, depth| {
            let field = if depth == 0 { 7 } else { [6_u8, 1, 5][depth % 3] };
            let length = inner.len();
            [vec![field << 3 | 2, (length & 0x7F) as u8 | 0x80, (length >> 7) as u8 | 0x80, (length >> 14) as u8], inner].concat()
        });
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("yolox_nano.onnx"), nested).unwrap();
        let folders = WeightFolders { named: None, folders: vec![folder.path().to_owned()] };
        prop_assert!(folders.checked(&Manifest::named("yolox_nano").unwrap()).is_err());
    }
}
