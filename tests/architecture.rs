//! What Cargo does not hold: that ARCHITECTURE.md shows the crates as they are, that files of a crate do not use each other in circles, and
//! that some things are done in one place.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::common::home;

/// The crates that each crate depends on, by the manifests.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let folders = std::fs::read_dir(home().join("crates")).unwrap();
    let of_crate = |folder: PathBuf| {
        let text = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let manifest: toml::Table = text.parse().unwrap();
        let names = manifest["dependencies"].as_table().unwrap().keys();
        let used = names.filter_map(|name| name.strip_prefix("scaleproof-").map(str::to_owned));
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        (name, used.collect())
    };
    folders.map(|entry| of_crate(entry.unwrap().path())).collect()
}

/// The lines "`crate` → crates" of ARCHITECTURE.md, from top to bottom.
fn shown() -> Vec<(String, BTreeSet<String>)> {
    let text = std::fs::read_to_string(home().join("ARCHITECTURE.md")).unwrap();
    let diagram = text
        .split("<!-- crates -->")
        .nth(1)
        .expect("ARCHITECTURE.md has the crates between two remarks");
    let line = |line: &str| {
        let (name, used) = line.split_once('→')?;
        let used = used.split([',', ' ']).filter(|name| !name.is_empty() && *name != "–");
        Some((name.trim().to_owned(), used.map(str::to_owned).collect()))
    };
    diagram.lines().filter_map(line).collect()
}

#[test]
fn the_diagram_shows_the_crates_as_they_are_and_arrows_point_down() {
    let shown = shown();
    let by_name: BTreeMap<String, BTreeSet<String>> = shown.iter().cloned().collect();
    assert_eq!(by_name, dependencies());
    for (at, (name, used)) in shown.iter().enumerate() {
        let is_below = |used: &&String| shown[at + 1..].iter().any(|(below, _)| below == *used);
        let up = used.iter().find(|used| !is_below(used));
        assert_eq!(up, None, "`{name}` uses a crate that stands above it");
    }
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if !path.ends_with("tests") {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The folders `src` of the program and of every crate, each with the name of its crate.
fn crates() -> Vec<(String, PathBuf)> {
    let named = dependencies().into_keys().map(|name| {
        let folder = home().join("crates").join(&name).join("src");
        (name, folder)
    });
    named.chain([("program".to_owned(), home().join("src"))]).collect()
}

/// A module's path from its crate, as `["score", "report", "html"]`.
type Module = Vec<String>;
/// Each module's code, without its comments and its tests.
type Modules = BTreeMap<Module, String>;

fn modules() -> Modules {
    let mut modules = Modules::new();
    for (name, src) in crates() {
        let mut files = Vec::new();
        sources(&src, &mut files);
        for path in files {
            let below = path.strip_prefix(&src).unwrap().with_extension("");
            let parts = below.iter().map(|n| n.to_string_lossy().into_owned());
            let mut module: Module = std::iter::once(name.clone()).chain(parts).collect();
            module.pop_if(|last| ["mod", "lib"].contains(&last.as_str()));
            modules.insert(module, code_of(&std::fs::read_to_string(path).unwrap()));
        }
    }
    modules
}

fn code_of(source: &str) -> String {
    // What follows is tests: unit tests stand at the end of a file. Single items may be of the tests, too.
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let code = code.split("#[cfg(test)]\npub mod ").next().unwrap_or_default();
    let code = code.split("#[cfg(test)]\n#[path").next().unwrap_or_default();
    let lines = code.lines().map(|l| l.split("//").next().unwrap_or_default());
    let mut is_next_of_tests = false;
    let lines = lines.filter(|line| {
        let is_of_tests = std::mem::replace(&mut is_next_of_tests, line.trim() == "#[cfg(test)]");
        !(is_of_tests && line.contains("use "))
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The paths that a `use` tree brings in, as `a::b` and `a::c` for `a::{b, c}`.
fn expanded(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((front, group)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let (mut depth, mut members) = (0, vec![String::new()]);
    for c in group.rsplit_once('}').map_or(group, |(inside, _)| inside).chars() {
        match c {
            ',' if depth == 0 => members.push(String::new()),
            c => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                members.last_mut().unwrap().push(c);
            }
        }
    }
    let members = members
        .iter()
        .filter(|m| !m.trim().is_empty())
        .flat_map(|m| expanded(m));
    members.map(|member| format!("{front}{member}")).collect()
}

/// The paths that a module names, each with whether it exports it again.
fn paths_named(code: &str) -> Vec<(String, bool)> {
    let (mut named, mut body) = (Vec::new(), String::new());
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let words = line.trim_start();
        let is_use = words.starts_with("use ") || (words.starts_with("pub") && words.contains(" use "));
        if !is_use {
            body += line;
            body.push('\n');
            continue;
        }
        let mut tree = words.split_once("use ").unwrap().1.to_owned();
        while !tree.contains(';') {
            tree += lines.next().expect("a use line ends");
        }
        let is_exported = words.starts_with("pub");
        let paths = expanded(tree.trim_end().trim_end_matches(';'));
        named.extend(paths.into_iter().map(|path| (path, is_exported)));
    }
    let inline = body.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':');
    let inline = inline
        .map(|path| path.trim_end_matches(':'))
        .filter(|path| path.contains("::"));
    named.extend(inline.map(|path| (path.to_owned(), false)));
    named
}

/// A path from the root, given the module that names it; `None` for another crate's.
fn from_root(modules: &Modules, at: &Module, path: &str) -> Option<Module> {
    let mut base = at.clone();
    let mut names = path.split("::").map(str::to_owned).peekable();
    match names.peek()?.as_str() {
        "crate" => {
            base.truncate(1);
            names.next();
        }
        "self" => drop(names.next()),
        "super" => {
            while names.next_if_eq("super").is_some() {
                base.pop();
            }
        }
        child => {
            base.push(child.to_owned());
            modules.get(&base)?;
            base.pop();
        }
    }
    base.extend(names);
    Some(base)
}

/// The module that an item comes from, through every `pub use`.
fn home_of(modules: &Modules, exported: &BTreeMap<Module, Module>, item: &Module) -> Option<Module> {
    let depth = (1..=item.len()).rev().find(|n| modules.contains_key(&item[..*n]))?;
    let origin = item.get(..=depth).and_then(|name| exported.get(name));
    match origin {
        Some(origin) if *origin != item[..=depth] => {
            let item = origin.iter().chain(&item[depth + 1..]).cloned().collect();
            home_of(modules, exported, &item)
        }
        _ => Some(item[..depth].to_vec()),
    }
}

/// The files of its crate that each file uses: by its paths, and by what it exports again. A name counts for the file that defines it.
fn uses(modules: &Modules) -> BTreeMap<&Module, BTreeSet<Module>> {
    let mut named = Vec::new();
    for (module, code) in modules {
        for (path, is_exported) in paths_named(code) {
            if let Some(item) = from_root(modules, module, &path) {
                named.push((module, item, is_exported));
            }
        }
    }
    let exported = named
        .iter()
        .filter(|(.., is_exported)| *is_exported)
        .map(|(module, item, _)| {
            let name = item.last().cloned();
            (module.iter().cloned().chain(name).collect(), item.clone())
        });
    let exported: BTreeMap<Module, Module> = exported.collect();
    let mut uses: BTreeMap<&Module, BTreeSet<Module>> = BTreeMap::new();
    for (module, item, _) in &named {
        if let Some(used) = home_of(modules, &exported, item).filter(|used| used != *module) {
            uses.entry(module).or_default().insert(used);
        }
    }
    uses
}

/// The strongly connected components of more than one file: files of which each reaches all others through what it uses.
fn circles(modules: &Modules) -> Vec<String> {
    let uses = uses(modules);
    let reached = |from: &Module| -> BTreeSet<Module> {
        let (mut open, mut seen) = (vec![from.clone()], BTreeSet::new());
        while let Some(file) = open.pop() {
            let used = uses.get(&file).into_iter().flatten();
            open.extend(used.filter(|used| seen.insert((*used).clone())).cloned());
        }
        seen
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = modules.keys().map(|file| (file, reached(file))).collect();
    let circle = |file: &&Module| -> Vec<String> {
        let is_in = |other: &&Module| reached[file].contains(*other) && reached[*other].contains(*file);
        modules.keys().filter(is_in).map(|file| file.join("/")).collect()
    };
    let circles: BTreeSet<Vec<String>> = modules.keys().map(|file| circle(&file)).collect();
    circles
        .iter()
        .filter(|files| !files.is_empty())
        .map(|files| files.join(", "))
        .collect()
}

/// The command line (`program`) is left out: its groups of subcommands still know each other.
#[test]
fn no_files_of_a_crate_use_each_other_in_a_circle() {
    let of_crates = modules().into_iter().filter(|(file, _)| file[0] != "program");
    let circles = circles(&of_crates.collect());
    assert!(circles.is_empty(), "these use each other:\n{}", circles.join("\n"));
}

#[test]
fn circles_are_found_through_exports_and_through_files_that_export_and_define() {
    let of = |files: &[(&str, &str)]| -> Modules {
        let module = |(path, code): &(&str, &str)| (path.split('/').map(str::to_owned).collect(), code_of(code));
        files.iter().map(module).collect()
    };
    let three = of(&[
        ("k", ""),
        ("k/a", "use crate::b::B;"),
        ("k/b", "use crate::c;"),
        ("k/c", "fn f() { super::a::run() }"),
        ("k/d", "use crate::a;"),
    ]);
    assert_eq!(circles(&three), ["k/a, k/b, k/c"]);
    let facade = ("k/room", "mod a;\nmod b;\npub use a::{A, Other};\npub use b::B;");
    let through_export = of(&[
        facade,
        ("k/room/a", "use super::B;"),
        ("k/room/b", "use super::{\n    A,\n};"),
    ]);
    assert_eq!(circles(&through_export), ["k/room/a, k/room/b"]);
    let defines = ("k/room", "mod a;\npub use a::A;\npub struct C;");
    assert_eq!(
        circles(&of(&[defines, ("k/room/a", "use super::C;")])),
        ["k/room, k/room/a"]
    );
    let none = of(&[
        facade,
        ("k/room/a", "// super::b\n#[cfg(test)]\nuse super::b;"),
        ("k/room/b", "use super::A;"),
    ]);
    assert_eq!(circles(&none), [""; 0]);
}

/// What only one place may do, and the files that may.
const ONE_PLACE: [(&str, &[&str]); 7] = [
    // A variable that is set to nothing counts as unset.
    ("env::var", &["crates/core/src/files/environment.rs"]),
    // The library neither exits nor hooks panics; its program does.
    ("process::exit", &["src/cli/"]),
    ("set_hook(", &[]),
    // A QR code is drawn with the colours that phones need.
    ("eprintln!", &["src/cli/print/capture.rs"]),
    (" println!", &[]),
    // Every image is measured before it is decoded: those of a stream by their headers; this one the program has made itself.
    ("ImageReader", &["crates/capture/src/source/live/pixels.rs"]),
    ("load_from_memory", &["crates/study/src/chart/spoil.rs"]),
];

#[test]
fn what_belongs_in_one_place_is_in_no_other() {
    for (_, src) in crates() {
        let mut files = Vec::new();
        sources(&src, &mut files);
        for path in files {
            let code = code_of(&std::fs::read_to_string(&path).unwrap());
            let below = path.strip_prefix(home()).unwrap().to_string_lossy().into_owned();
            for (word, allowed) in ONE_PLACE {
                let may = allowed.iter().any(|place| below.starts_with(place));
                assert!(!code.contains(word) || may, "{below} uses {word}");
            }
        }
    }
}

/// What changes files, and where it may stand: below all that writes, and where a folder is new and nobody else's.
#[test]
fn files_are_changed_by_one_door() {
    const CHANGES: [&str; 13] = [
        "fs::write",
        "File::create",
        "File::options",
        "OpenOptions",
        "create_dir",
        "fs::rename",
        "fs::copy",
        "hard_link",
        "fs::symlink(",
        "remove_file",
        "remove_dir",
        "set_len",
        "set_permissions",
    ];
    let is_below = |module: &Module| module.starts_with(&["core".to_owned(), "files".to_owned()]);
    // HEIC photos are decoded by a program in a temporary folder.
    let is_new_folder = |module: &Module| module.join("/") == "photo/heif";
    for (module, code) in modules() {
        if is_below(&module) || is_new_folder(&module) {
            continue;
        }
        let found: Vec<&str> = CHANGES
            .into_iter()
            .filter(|change| {
                code.match_indices(change).any(|(at, _)| {
                    let next = code[at + change.len()..].chars().next();
                    *change != "set_len" || next == Some('(')
                })
            })
            .collect();
        assert!(
            found.is_empty(),
            "{}: {found:?}: use core's files and files::chosen",
            module.join("/")
        );
    }
}
