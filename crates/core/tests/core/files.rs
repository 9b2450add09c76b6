//! Whole files or none.

use scaleproof_core::files::{free_place, inputs, read, sha256_hex, write_all_atomically, write_atomically};

#[test]
fn the_hash_is_sha256() {
    // FIPS 180-2, appendix B.1.
    assert_eq!(
        sha256_hex(b"abc"),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
}

/// No other test of this program reads what it has not written.
#[test]
fn what_a_guarded_run_has_read_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let named = ["read", "named", "own", "free"];
    named.iter().for_each(|name| std::fs::write(at(name), b"a").unwrap());
    read(&at("free")).unwrap();
    inputs::guard();
    read(&at("read")).unwrap();
    inputs::note(&at("named"));
    inputs::own(&at("own"));
    read(&at("own")).unwrap();
    for (name, is_input) in [
        ("read", true),
        ("named", true),
        ("own", false),
        ("free", false),
        ("new", false),
    ] {
        for place in [at(name), at(".").join(name)] {
            let said = write_atomically(&place, b"b").map_err(|e| e.to_string());
            assert_eq!(said.is_err_and(|e| e.contains("is an input")), is_input, "{name}");
        }
        assert_eq!(std::fs::read(at(name)).unwrap(), if is_input { b"a" } else { b"b" });
    }
    // What was read stays an input, and what was written is read and written again.
    inputs::own(&at("read"));
    assert!(write_atomically(&at("read"), b"b").is_err());
    read(&at("new")).unwrap();
    write_atomically(&at("new"), b"c").unwrap();
    let twice = write_all_atomically(&[(at("x"), b"a"), (at("./x"), b"b")])
        .unwrap_err()
        .to_string();
    assert!(
        twice.contains("two files would be written as") && !at("x").exists(),
        "{twice}"
    );
    assert_eq!(
        [at("y.jpg"), at("new"), at("x.jpg")].map(|path| free_place(&path)),
        [at("y.jpg"), at("new_2"), at("x.jpg")]
    );
}

#[test]
fn a_failed_write_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("report");
    std::fs::create_dir(&target).unwrap();
    let error = write_atomically(&target, b"x").unwrap_err().to_string();
    assert!(error.starts_with("cannot write"), "{error}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "only the folder that was there before");
}

#[test]
fn files_written_together_appear_together_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let contents = ["a", "b"].map(|name| (folder.path().join(name), name.as_bytes().to_vec()));
    std::fs::create_dir(folder.path().join("b")).unwrap();
    assert!(write_all_atomically(&contents).is_err());
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        1,
        "neither `a` nor a temporary file"
    );
    std::fs::remove_dir(folder.path().join("b")).unwrap();
    write_all_atomically(&contents).unwrap();
    assert_eq!(std::fs::read(folder.path().join("b")).unwrap(), b"b");
}
