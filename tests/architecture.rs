//! Reads the `use` lines of `src/` and holds them against the table of rooms in ARCHITECTURE.md.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Table = BTreeMap<String, BTreeSet<String>>;

/// What stands in the third column of the room above all others.
const ALL: &str = "every other room";

/// Room → rooms it may use, from the lines "| `room` | what it holds | may use |" of ARCHITECTURE.md.
fn table(markdown: &str) -> Table {
    let mut table = Table::new();
    let rows = || markdown.lines().filter(|l| l.starts_with("| `"));
    let rooms: BTreeSet<String> = rows()
        .skip(1)
        .filter_map(|l| Some(l.split('`').nth(1)?.to_owned()))
        .collect();
    for line in rows() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, room, _, may_use, _] = cells[..] else { continue };
        let used = may_use.split('`').skip(1).step_by(2).map(str::to_owned);
        let used: BTreeSet<String> = match may_use {
            ALL => rooms.clone(),
            _ => used.collect(),
        };
        table.insert(room.trim_matches('`').to_owned(), used);
    }
    table
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The rooms that a source names after `crate::`, in `use` lines, groups and paths inside the code.
fn rooms_named(source: &str) -> BTreeSet<String> {
    let mut rooms = BTreeSet::new();
    let code: String = source
        .lines()
        .map(|l| l.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n");
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        match rest.strip_prefix('{') {
            None => rooms.insert(rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()),
            Some(group) => {
                rooms.extend(first_names(group));
                true
            }
        };
    }
    rooms.retain(|r| !r.is_empty());
    rooms
}

/// The first name of each member of a `use` group, given what follows its opening brace.
fn first_names(group: &str) -> Vec<String> {
    let (mut depth, mut top) = (0, String::new());
    for c in group.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            c if depth == 0 => top.push(c),
            _ => {}
        }
    }
    top.split(',')
        .map(|member| member.trim().split("::").next().unwrap_or_default().to_owned())
        .collect()
}

/// The room of a file: the folder or file directly below `src`.
fn room_of(path: &Path, src: &Path) -> String {
    let first = path.strip_prefix(src).unwrap().components().next().unwrap();
    first.as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned()
}

fn project() -> (Table, Vec<(String, PathBuf, String)>) {
    let home = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (src, mut files) = (home.join("src"), Vec::new());
    sources(&src, &mut files);
    let files = files
        .into_iter()
        .map(|f| (room_of(&f, &src), f.clone(), std::fs::read_to_string(f).unwrap()));
    (
        table(&std::fs::read_to_string(home.join("ARCHITECTURE.md")).unwrap()),
        files.collect(),
    )
}

#[test]
fn no_arrow_points_up_or_sideways() {
    let (table, files) = project();
    let mut wrong = Vec::new();
    for (room, path, source) in &files {
        if matches!(room.as_str(), "lib" | "main") {
            continue;
        }
        let allowed = table
            .get(room)
            .unwrap_or_else(|| panic!("ARCHITECTURE.md has no row for the room `{room}`"));
        for used in rooms_named(source)
            .iter()
            .filter(|used| *used != room && !allowed.contains(*used))
        {
            wrong.push(format!("{} uses `{used}`, which `{room}` may not", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_has_no_cycle_and_no_room_that_is_not_there() {
    let (table, files) = project();
    let rooms: BTreeSet<&String> = files.iter().map(|(room, ..)| room).collect();
    for room in table.keys() {
        assert!(
            rooms.contains(room),
            "ARCHITECTURE.md lists `{room}`, which src/ does not have"
        );
    }
    // Arrows point down: every room may use only rooms listed below it.
    let markdown = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/ARCHITECTURE.md")).unwrap();
    let line = |room: &String| {
        markdown
            .find(&format!("\n| `{room}` |"))
            .unwrap_or_else(|| panic!("no row for `{room}`"))
    };
    for (room, used) in &table {
        for used in used {
            assert!(
                line(used) > line(room),
                "`{room}` may use `{used}`, which stands above it"
            );
        }
    }
}

/// A module's path below `src`, as `["score", "run"]`.
type Module = Vec<String>;
/// Each module's code, without its comments and its tests.
type Modules = BTreeMap<Module, String>;

fn modules() -> Modules {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let module = |(_, path, source): (String, PathBuf, String)| {
        let below = path.strip_prefix(&src).unwrap().with_extension("");
        let mut names: Module = below.iter().map(|n| n.to_string_lossy().into_owned()).collect();
        names.pop_if(|last| last == "mod");
        (names, code_of(&source))
    };
    project().1.into_iter().map(module).collect()
}

fn code_of(source: &str) -> String {
    // What follows is tests: unit tests stand at the end of a file. Single items may be of the tests, too.
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let code = code.split("#[cfg(test)]\npub mod ").next().unwrap_or_default();
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
            base.clear();
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

/// Pairs of modules of one room that use each other. A `mod.rs` and its children may.
fn two_file_circles(modules: &Modules) -> Vec<String> {
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
    let uses: BTreeSet<(&Module, Module)> = named
        .iter()
        .filter_map(|(module, item, _)| Some((*module, home_of(modules, &exported, item)?)))
        .collect();
    let circle =
        |(a, b): &&(&Module, Module)| *a < b && a[0] == b[0] && !b.starts_with(a) && uses.contains(&(b, (*a).clone()));
    let circles = uses.iter().filter(circle);
    circles
        .map(|(a, b)| format!("{} and {}", a.join("/"), b.join("/")))
        .collect()
}

#[test]
fn no_two_files_of_a_room_use_each_other() {
    let circles = two_file_circles(&modules());
    assert!(circles.is_empty(), "these use each other:\n{}", circles.join("\n"));
}

#[test]
fn a_circle_is_found_through_exports_and_a_parent_with_its_children_is_none() {
    let of = |files: &[(&str, &str)]| -> Modules {
        let module = |(path, code): &(&str, &str)| (path.split('/').map(str::to_owned).collect(), code_of(code));
        files.iter().map(module).collect()
    };
    let parent = ("room", "mod a;\nmod b;\npub use a::{A, Other};\nfn f() { b::run() }");
    let through_export = of(&[
        parent,
        ("room/a", "use super::b::B;"),
        ("room/b", "use super::{\n    A,\n    C,\n};"),
    ]);
    assert_eq!(two_file_circles(&through_export), ["room/a and room/b"]);
    let inline = of(&[
        parent,
        ("room/a", "fn f() { super::b::run() }"),
        ("room/b", "use crate::room::a;"),
    ]);
    assert_eq!(two_file_circles(&inline), ["room/a and room/b"]);
    let none = of(&[
        parent,
        ("room/a", "use super::C; // super::b\n#[cfg(test)]\nuse super::b;"),
        ("room/b", "use super::{A, C};"),
    ]);
    assert_eq!(two_file_circles(&none), [""; 0]);
}

#[test]
fn the_reader_of_use_lines_sees_every_form() {
    let source = "use crate::scene::{Bin, Scene};\nuse crate::{files, geometry::{BoxPx, rigid}, locate};\n\
        // use crate::report;\nlet x = crate::tags::find();";
    let rooms: Vec<_> = rooms_named(source).into_iter().collect();
    assert_eq!(rooms, ["files", "geometry", "locate", "scene", "tags"]);
}

/// What only one place may do, and the files that may.
const ONE_PLACE: [(&str, &[&str]); 7] = [
    // A variable that is set to nothing counts as unset.
    ("env::var", &["files/environment.rs"]),
    // The library neither exits nor hooks panics; its program does.
    ("process::exit", &["cli/"]),
    ("set_hook(", &["cli/mod.rs"]),
    // A QR code is drawn with the colours that phones need.
    ("eprintln!", &["cli/capture/page.rs"]),
    (" println!", &[]),
    // Every image is measured before it is decoded; this one the program has made itself.
    ("ImageReader", &[]),
    ("load_from_memory", &["chart/spoil.rs"]),
];

#[test]
fn what_belongs_in_one_place_is_in_no_other() {
    let (_, files) = project();
    for (_, path, source) in &files {
        let code = code_of(source);
        let path = path.to_string_lossy();
        for (word, allowed) in ONE_PLACE {
            let is_used = code.contains(word);
            let may = allowed.iter().any(|place| path.contains(&format!("src/{place}")));
            assert!(!is_used || may, "{path} uses {word}");
        }
    }
}
