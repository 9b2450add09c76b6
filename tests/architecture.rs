//! Reads the `use` lines of `src/` and holds them against the table of rooms in ARCHITECTURE.md.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Table = BTreeMap<String, BTreeSet<String>>;

/// Room → rooms it may use, from the lines "| `room` | what it holds | may use |" of ARCHITECTURE.md.
fn table(markdown: &str) -> Table {
    let mut table = Table::new();
    for line in markdown.lines().filter(|l| l.starts_with("| `")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, room, _, may_use, _] = cells[..] else { continue };
        let used = may_use.split('`').skip(1).step_by(2).map(str::to_owned);
        table.insert(room.trim_matches('`').to_owned(), used.collect());
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

#[test]
fn the_reader_of_use_lines_sees_every_form() {
    let source = "use crate::scene::{Bin, Scene};\nuse crate::{files, geometry::{BoxPx, rigid}, locate};\n\
        // use crate::report;\nlet x = crate::tags::find();";
    let rooms: Vec<_> = rooms_named(source).into_iter().collect();
    assert_eq!(rooms, ["files", "geometry", "locate", "scene", "tags"]);
}

/// What only one place may do, and the files that may.
const ONE_PLACE: [(&str, &[&str]); 6] = [
    // The library neither exits nor hooks panics; its program does.
    ("process::exit", &["cli/"]),
    ("set_hook(", &["cli/mod.rs"]),
    // A QR code is drawn with the colours that phones need.
    ("eprintln!", &["cli/capture/page.rs"]),
    (" println!", &[]),
    // Every picture is measured before it is decoded; this one the program has made itself.
    ("ImageReader", &[]),
    ("load_from_memory", &["chart/spoil.rs"]),
];

#[test]
fn what_belongs_in_one_place_is_in_no_other() {
    let (_, files) = project();
    for (_, path, source) in &files {
        let code = source.split("#[cfg(test)]").next().unwrap_or_default();
        let path = path.to_string_lossy();
        for (word, allowed) in ONE_PLACE {
            let is_used = code
                .lines()
                .any(|line| !line.trim_start().starts_with("//") && line.contains(word));
            let may = allowed.iter().any(|place| path.contains(&format!("src/{place}")));
            assert!(!is_used || may, "{path} uses {word}");
        }
    }
}
