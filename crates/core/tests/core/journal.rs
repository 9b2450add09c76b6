//! Notes of runs that were killed, by whoever wrote them: what the next run does with one stays in its folder.

use std::collections::BTreeMap;
use std::path::Path;

use proptest::prelude::*;
use scaleproof_core::files::write_atomically;

/// The files below a folder, each with its content.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.is_file());
    files
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read(&path).unwrap())
        })
        .collect()
}

/// A note of names as they are, and as somebody who means harm would write them.
fn note() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        "[ -~]{0,6}",
        Just("../".to_owned()),
        Just("/".to_owned()),
        Just("\n".to_owned()),
        Just(".".to_owned()),
        Just(".photo.1_2.partial".to_owned()),
        Just(".victim.1_2.partial".to_owned()),
        Just(".folder.1_2.partial".to_owned()),
        Just(".new.3_4.partial".to_owned()),
        Just("../.victim.1_2.partial\n".to_owned()),
    ];
    let lines = proptest::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat().into_bytes());
    prop_oneof![4 => lines, 1 => proptest::collection::vec(any::<u8>(), 0..200)]
}

proptest! {
    #[test]
    fn a_note_moves_only_the_temporary_files_that_it_names_to_their_own_names(note in note()) {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("out");
        std::fs::create_dir_all(folder.join("folder")).unwrap();
        for name in ["victim", ".victim.1_2.partial"] {
            std::fs::write(above.path().join(name), name).unwrap();
        }
        for name in ["photo", "kept", ".photo.1_2.partial", ".new.3_4.partial", ".folder.1_2.partial"] {
            std::fs::write(folder.join(name), name).unwrap();
        }
        std::fs::write(folder.join(".1_0.scaleproof-journal"), &note).unwrap();
        let before = contents(above.path());
        write_atomically(&folder.join("result"), b"result").unwrap();
        prop_assert_eq!(contents(above.path()), before);
        prop_assert!(folder.join("folder").is_dir());
        for (name, content) in contents(&folder) {
            let own = [name.clone(), format!(".{name}.1_2.partial"), format!(".{name}.3_4.partial")];
            prop_assert!(own.iter().any(|own| own.as_bytes() == content), "{name} holds {content:?}");
        }
        prop_assert_eq!(std::fs::read(folder.join("kept")).unwrap(), b"kept");
    }
}
