//! Notes of runs that were killed, by whoever wrote them: the next run finishes its own alone.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, SystemTime};

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
        Just("\n1234567 1795980000.123456789 .photo.1_2.partial\n".to_owned()),
        Just("../.victim.1_2.partial\n".to_owned()),
    ];
    let lines = proptest::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat().into_bytes());
    prop_oneof![4 => lines, 1 => proptest::collection::vec(any::<u8>(), 0..200)]
}

proptest! {
    #[test]
    fn a_note_that_this_program_did_not_write_moves_nothing(note in note()) {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("out");
        std::fs::create_dir_all(folder.join("folder")).unwrap();
        for name in ["victim", ".victim.1_2.partial"] {
            std::fs::write(above.path().join(name), name).unwrap();
        }
        for name in ["photo", "kept", ".photo.1_2.partial", ".new.3_4.partial", ".folder.1_2.partial"] {
            std::fs::write(folder.join(name), name).unwrap();
        }
        // Newer than whatever it could replace, by its own word.
        let forged = std::fs::File::options().append(true).open(folder.join(".photo.1_2.partial")).unwrap();
        forged.set_modified(SystemTime::now() + Duration::from_secs(1 << 30)).unwrap();
        std::fs::write(folder.join(".1_0.scaleproof-journal"), &note).unwrap();
        let before = contents(above.path());
        write_atomically(&folder.join("result"), b"result").unwrap();
        prop_assert_eq!(contents(above.path()), before);
        prop_assert!(folder.join("folder").is_dir());
        for name in ["photo", "kept"] {
            prop_assert_eq!(std::fs::read(folder.join(name)).unwrap(), name.as_bytes());
        }
        prop_assert!(!folder.join("new").exists());
    }
}
