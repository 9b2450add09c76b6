//! The Python package: its own tests, run by pytest with the module that cargo has just built.

use std::ffi::OsStr;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

// Named, so that cargo builds the module for these tests.
use scaleproof_python as _;

fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap()
}

/// A folder with the package, its module in it.
fn package() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("scaleproof");
    std::fs::create_dir(&inside).unwrap();
    for entry in std::fs::read_dir(home().join("python/scaleproof")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, inside.join(path.file_name().unwrap())).unwrap();
        }
    }
    let built = std::env::current_exe()
        .unwrap()
        .with_file_name("libscaleproof_python.so");
    std::os::unix::fs::symlink(built, inside.join("_native.abi3.so")).unwrap();
    folder
}

/// What `./run test` has installed for the tests of the package.
fn installed() -> PathBuf {
    let installed = home().join(".cache/python-tests");
    assert!(
        installed.is_dir(),
        "{} has no packages: start this test by ./run test",
        installed.display()
    );
    installed
}

/// Runs a Python with the package, and with another folder of packages.
fn python(program: &str, (package, others): (&Path, &Path), arguments: &[&str]) {
    let output = Command::new(program)
        .args(arguments)
        .env(
            "PYTHONPATH",
            [package.as_os_str(), others.as_os_str()].join(OsStr::new(":")),
        )
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("MYPYPATH", package)
        .current_dir(package)
        .output()
        .unwrap();
    let [out, error] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{out}\n{error}");
}

#[test]
fn the_package_does_what_the_program_does() {
    let (package, tests) = (package(), home().join("python/tests"));
    let options = ["-m", "pytest", "-q", "-p", "no:cacheprovider"];
    let arguments = [&options[..], &[tests.to_str().unwrap()]].concat();
    python("python3", (package.path(), &installed()), &arguments);
}

#[test]
fn the_renderer_in_pytorch_is_the_attack_s() {
    let (package, test) = (package(), home().join("python/tests/in_torch.py"));
    let out = tempfile::tempdir().unwrap();
    let arguments = [test.to_str().unwrap(), out.path().to_str().unwrap()];
    // Debian's PyTorch needs no graphics card, and is built for Debian's Python. The folder has `scaleproof_detector`.
    python("/usr/bin/python3", (package.path(), &home().join("python")), &arguments);
}

/// Against the packages that `./run test` has installed and PyTorch's types beside them, whatever else this machine's Python has: `-S` hides it, from mypy
/// and from the Python that it asks for its packages.
#[test]
fn types_are_whole() {
    let (package, example) = (package(), home().join("python/examples/score_a_function.py"));
    let [cache, alone] = ["mypy", "python_alone"].map(|name| package.path().join(name));
    std::fs::write(&alone, "#!/bin/sh\nexec python3 -S \"$@\"\n").unwrap();
    std::fs::set_permissions(&alone, std::fs::Permissions::from_mode(0o755)).unwrap();
    let [cache, alone] = [&cache, &alone].map(|path| path.to_str().unwrap());
    let options = [
        "-m",
        "mypy",
        "--strict",
        "--ignore-missing-imports",
        "--cache-dir",
        cache,
        "--python-executable",
        alone,
    ];
    let arguments = [&options[..], &[example.to_str().unwrap(), "scaleproof"]].concat();
    let others = std::env::join_paths([installed(), installed().join("types")]).unwrap();
    python(alone, (package.path(), Path::new(&others)), &arguments);
}
