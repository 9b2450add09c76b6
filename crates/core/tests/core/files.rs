//! Whole files or none.

use scaleproof_core::files::{FileState, free_place, inputs, read, sha256_hex, write_all_atomically, write_atomically};
#[cfg(unix)]
use scaleproof_core::files::{replace_all_atomically, replace_atomically};

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

/// What lies in the place of a name that the program chose, or of a folder on the way to it.
#[test]
#[cfg(unix)]
fn nothing_is_written_through_a_link_below_the_folder_that_was_named() {
    use scaleproof_core::files::chosen;
    use std::os::unix::fs::symlink;
    let all = tempfile::tempdir().unwrap();
    let (home, elsewhere) = (all.path().join("home"), all.path().join("elsewhere"));
    std::fs::create_dir_all(home.join("real")).unwrap();
    std::fs::create_dir(&elsewhere).unwrap();
    std::fs::write(elsewhere.join("x"), b"mine").unwrap();
    symlink(&elsewhere, home.join("linked")).unwrap();
    symlink(elsewhere.join("x"), home.join("link")).unwrap();
    symlink(elsewhere.join("absent"), home.join("dangling")).unwrap();
    std::fs::hard_link(elsewhere.join("x"), home.join("second")).unwrap();
    let through = home.join("linked/x");
    assert!(replace_atomically(&home, &through, b"theirs").is_err());
    assert!(replace_all_atomically(&home, &[(home.join("linked/new"), b"theirs")]).is_err());
    assert!(chosen::remove(&home, &through).is_err());
    assert!(chosen::remove_folder(&home, &home.join("linked")).is_err());
    assert!(chosen::folder(&home, &home.join("linked/deep")).is_err());
    assert!(chosen::rename(&home, &home.join("link"), &home.join("linked/y")).is_err());
    assert!(chosen::mark(&home, &home.join("link")).is_err() && chosen::mark(&home, &home.join("dangling")).is_err());
    assert!(
        chosen::appended(&home, &home.join("second")).is_err(),
        "it would be in both"
    );
    assert!(chosen::kept(&home, &home.join("link"), 99).is_none());
    for outside in ["../elsewhere/x", "real/../../elsewhere/x", "."] {
        assert!(
            replace_atomically(&home, &home.join(outside), b"theirs").is_err(),
            "{outside}"
        );
    }
    assert!(replace_atomically(&home, &elsewhere.join("x"), b"theirs").is_err());
    // What takes the place of a link or of a second name leaves the other as it is.
    for name in ["link", "dangling", "second", "real/new"] {
        replace_atomically(&home, &home.join(name), b"ours").unwrap();
        assert!(!home.join(name).is_symlink());
        assert_eq!(std::fs::read(home.join(name)).unwrap(), b"ours", "{name}");
    }
    // The folder that a user named may be a link.
    symlink(&home, all.path().join("named")).unwrap();
    replace_atomically(&all.path().join("named"), &all.path().join("named/real/x"), b"ours").unwrap();
    let left: Vec<_> = std::fs::read_dir(&elsewhere).unwrap().collect();
    assert_eq!(
        (left.len(), std::fs::read(elsewhere.join("x")).unwrap()),
        (1, b"mine".to_vec())
    );
}

#[test]
fn a_file_that_changed_is_told_from_one_that_did_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film");
    std::fs::write(&path, b"one").unwrap();
    let state = FileState::of(&path).unwrap();
    state.check().unwrap();
    std::fs::write(folder.path().join("other"), b"two").unwrap();
    std::fs::rename(folder.path().join("other"), &path).unwrap();
    let said = state.check().unwrap_err().to_string();
    assert!(said.contains("changed while it was read"), "{said}");
}
