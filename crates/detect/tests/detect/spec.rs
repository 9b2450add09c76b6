//! How programs are named.

use scaleproof_detect::ProgramSpec;

#[test]
fn command_lines_and_manifests_name_programs() {
    let command = |name: &str| {
        ProgramSpec::named(name)
            .map(|spec| spec.map(|s| s.command))
            .map_err(|e| e.to_string())
    };
    let wanted = |words: &[&str]| Ok(Some(words.iter().map(|w| (*w).to_owned()).collect()));
    assert_eq!(
        command("exec:python3  'my car.py' \"\""),
        wanted(&["python3", "my car.py", ""])
    );
    assert_eq!(command("yolox_nano"), Ok(None));
    assert!(command("exec: ").unwrap_err().contains("no program is named"));
    assert!(command("exec:'a").unwrap_err().contains("has no second"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, "command = ['./run', 'x']\nname = 'mine'\n").unwrap();
    let spec = ProgramSpec::named(path.to_str().unwrap()).unwrap().unwrap();
    assert_eq!(
        (spec.in_words().as_str(), spec.folder.as_deref()),
        ("./run x", path.parent())
    );
    for (text, words) in [
        ("command = []", "command is empty"),
        ("command = ['a']\nlabels = 3", "unknown field `labels`"),
        ("command = ['a']\nname = 'a b'", "for the name"),
    ] {
        std::fs::write(&path, text).unwrap();
        let error = command(path.to_str().unwrap()).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
}
