//! Whole files or none.

use scaleproof_core::files::{sha256_hex, write_all_atomically, write_atomically};

#[test]
fn the_hash_is_sha256() {
    // FIPS 180-2, appendix B.1.
    assert_eq!(
        sha256_hex(b"abc"),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
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
