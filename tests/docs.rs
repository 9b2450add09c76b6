//! The documentation, held against the project: links lead somewhere, commands run, options exist, examples are read, keys are those that
//! are written.

use crate::common;
mod examples;
pub mod help;
mod markdown;
mod schema;
mod scratch;
mod shell;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use common::home;
use help::Commands;
use markdown::Page;
use scratch::Scratch;

/// Options of other programs that the documentation shows.
const FOREIGN_OPTIONS: [&str; 24] = [
    "--capture-tethered",
    "--filename",
    "--keep",
    "--all-targets",
    "--array",
    "--bench",
    "--bin",
    "--check",
    "--features",
    "--group-directories-first",
    "--lib",
    "--locked",
    "--no-default-features",
    "--no-deps",
    "--nocapture",
    "--path",
    "--release",
    "--shared",
    "--test",
    "--test-threads",
    "--version",
    "--wrap",
    "--help",
    "--ignored",
];

fn pages() -> Vec<Page> {
    markdown::all(home())
}

/// Pages of the guide and the README: those whose commands are run.
fn is_guide(page: &Page) -> bool {
    page.name == "README.md" || page.name.starts_with("docs/guide/")
}

/// What is said of the program as it is: the change log also says what it was, and the fonts were made by other programs.
fn is_current(page: &Page) -> bool {
    page.name != "CHANGELOG.md" && !page.name.starts_with("crates/core/fonts/")
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_link_leads_somewhere() {
    let mut faults = Vec::new();
    let pages = pages();
    for page in &pages {
        for link in page.links() {
            if let Some(fault) = fault_of_link(page, &link.target, &pages) {
                faults.push(format!("{}, line {}: {}: {fault}", page.name, link.line, link.target));
            }
        }
    }
    assert!(pages.iter().any(|p| p.name == "README.md"));
    assert_none(&faults);
}

fn fault_of_link(page: &Page, target: &str, pages: &[Page]) -> Option<String> {
    if target.starts_with("mailto:") {
        return None;
    }
    if let Some((scheme, rest)) = target.split_once("://") {
        let host = rest.split(['/', '?', '#']).next().unwrap_or_default();
        let is_good =
            ["http", "https"].contains(&scheme) && host.contains('.') && !target.contains(char::is_whitespace);
        return (!is_good).then(|| "it is no address".into());
    }
    let (file, anchor) = target
        .split_once('#')
        .map_or((target, None), |(file, anchor)| (file, Some(anchor)));
    let path = match file {
        "" => page.path.clone(),
        file => page
            .path
            .parent()
            .unwrap_or(Path::new(""))
            .join(file.replace("%20", " ")),
    };
    let Ok(path) = path.canonicalize() else {
        return Some("the file is not there".into());
    };
    if !path.starts_with(home().canonicalize().unwrap()) {
        return Some("it leads out of the project".into());
    }
    let anchor = anchor?;
    let is = |p: &&Page| p.path.canonicalize().is_ok_and(|p| p == path);
    match pages.iter().find(is) {
        Some(page) if page.anchors().iter().any(|known| known == anchor) => None,
        Some(_) => Some("no heading has this anchor".into()),
        None => Some("anchors are checked in pages of the project only".into()),
    }
}

#[test]
fn the_summary_of_the_guide_lists_every_page() {
    let summary = Page::open(home(), &home().join("docs/guide/SUMMARY.md"));
    let folder = summary.path.parent().unwrap().canonicalize().unwrap();
    let listed = summary.links().into_iter().filter(|link| link.target.ends_with(".md"));
    let listed: BTreeSet<PathBuf> = listed
        .filter_map(|link| folder.join(link.target).canonicalize().ok())
        .collect();
    let is_page = |page: &&Page| page.name.starts_with("docs/guide/") && page.name != summary.name;
    let there: BTreeSet<PathBuf> = pages()
        .iter()
        .filter(is_page)
        .map(|page| page.path.canonicalize().unwrap())
        .collect();
    let missing: Vec<_> = there.difference(&listed).collect();
    assert!(missing.is_empty(), "not in SUMMARY.md: {missing:?}");
    let elsewhere: Vec<_> = listed.difference(&there).collect();
    assert!(
        elsewhere.is_empty(),
        "in SUMMARY.md and no page of the guide: {elsewhere:?}"
    );
}

/// Every `./run …` and `scaleproof …` in a block of shell, and every code span that begins with a command.
#[test]
fn commands_have_the_options_that_the_documentation_shows() {
    let (commands, mut faults) = (Commands::of_program(), Vec::new());
    for page in pages().iter().filter(|page| is_current(page)) {
        for block in &page.blocks {
            let fault = shell::kind(block).err();
            faults.extend(fault.map(|fault| format!("{}, line {}: {fault}", page.name, block.line)));
            // A block without a kind may hold commands too; one of JSON may hold words that look like one.
            let text = if shell::holds_commands(block) {
                block.text.as_str()
            } else {
                ""
            };
            for (offset, command) in shell::commands(text) {
                let found = shell::calls(&command)
                    .into_iter()
                    .filter_map(|call| commands.fault(&call));
                faults.extend(found.map(|fault| {
                    format!(
                        "{}, line {}: {fault}: {}",
                        page.name,
                        block.line + offset,
                        command.trim()
                    )
                }));
            }
        }
        for (line, span) in page.code_spans() {
            let words: Vec<String> = span.split_whitespace().map(str::to_owned).collect();
            let calls = match words.first() {
                Some(first) if ["./run", "scaleproof"].contains(&first.as_str()) => shell::calls(&span),
                Some(first) if commands.is_command(std::slice::from_ref(first)) && words.len() > 1 => vec![words],
                _ => continue,
            };
            let found = calls.iter().filter_map(|call| commands.fault(call));
            faults.extend(found.map(|fault| format!("{}, line {line}: {fault}: `{span}`", page.name)));
        }
    }
    assert_none(&faults);
}

#[test]
fn no_option_is_mentioned_that_no_command_has() {
    let (commands, mut faults) = (Commands::of_program(), Vec::new());
    let known = commands.options();
    let is_known = |option: &str| known.contains(option) || FOREIGN_OPTIONS.contains(&option);
    for page in pages().iter().filter(|page| is_current(page)) {
        let blocks = page.blocks.iter().map(|block| (block.line, block.text.clone()));
        for (line, code) in page.code_spans().into_iter().chain(blocks) {
            let unknown = options_in(&code).into_iter().filter(|option| !is_known(option));
            faults.extend(unknown.map(|option| format!("{}, line {line}: {option}", page.name)));
        }
    }
    assert_none(&faults);
}

/// Words such as `--name` in code.
fn options_in(code: &str) -> Vec<String> {
    let words = code.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '_'));
    let long = words.filter(|word| {
        word.strip_prefix("--")
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()))
    });
    long.map(str::to_owned).collect()
}

#[test]
fn every_command_is_in_the_guide() {
    let guide: Vec<Page> = pages()
        .into_iter()
        .filter(|page| page.name.starts_with("docs/guide/"))
        .collect();
    let mut text = String::new();
    for page in &guide {
        page.code_spans()
            .into_iter()
            .for_each(|(_, span)| text.push_str(&format!("`{span}`\n")));
        page.blocks.iter().for_each(|block| text.push_str(&block.text));
    }
    let is_shown = |command: &str| {
        let starts = ["scaleproof ", "./run ", "`"].map(|start| format!("{start}{command}"));
        // A longer name does not count for a shorter one.
        let ends_there = |at: usize, length: usize| {
            !text[at + length..].starts_with(|c: char| c.is_ascii_alphanumeric() || c == '-')
        };
        starts.iter().any(|start| {
            text.match_indices(start.as_str())
                .any(|(at, _)| ends_there(at, start.len()))
        })
    };
    let missing: Vec<String> = Commands::of_program()
        .leaves()
        .into_iter()
        .filter(|command| !is_shown(command))
        .collect();
    assert!(missing.is_empty(), "no page of the guide shows {missing:?}");
}

/// The words for programs in the source: `Variant … => "word"` in the functions called `code`.
#[test]
fn every_code_is_in_the_reference() {
    let page = std::fs::read_to_string(home().join("docs/guide/reference/codes.md")).unwrap();
    for file in [
        "pose/src/locate/abstention.rs",
        "capture/src/advice.rs",
        "rig/src/survey/problem.rs",
    ] {
        let source = std::fs::read_to_string(home().join("crates").join(file)).unwrap();
        let (_, body) = source.split_once("fn code(&self)").unwrap();
        let body = body.split("\n    }\n").next().unwrap();
        let codes: Vec<&str> = body.split('"').skip(1).step_by(2).collect();
        assert!(codes.len() > 5, "{file}: {codes:?}");
        let missing: Vec<&&str> = codes
            .iter()
            .filter(|code| !page.contains(&format!("`{code}`")))
            .collect();
        assert!(missing.is_empty(), "codes.md lacks {missing:?} of crates/{file}");
    }
}

#[test]
fn examples_of_the_reference_are_read_by_the_program() {
    let (mut faults, mut count) = (Vec::new(), 0);
    for page in pages()
        .iter()
        .filter(|page| page.name.starts_with("docs/guide/reference/"))
    {
        for block in page
            .blocks
            .iter()
            .filter(|b| ["toml", "json", "yaml", "csv", "text"].contains(&b.info.as_str()))
        {
            let kind = block
                .remark
                .as_deref()
                .and_then(|remark| remark.strip_prefix("read as:"));
            let read = match kind {
                Some(kind) => examples::read(kind.trim(), block),
                None if block.info == "text" => continue,
                None => Err("say above it what it is, as in <!-- read as: scene -->".into()),
            };
            count += 1;
            faults.extend(
                read.err()
                    .map(|fault| format!("{}, line {}: {fault}", page.name, block.line)),
            );
        }
    }
    assert!(count > 15, "{count} examples");
    assert_none(&faults);
}

/// In order within a page, each page in its own copy of the project's files; then the keys of what they wrote.
#[test]
fn commands_of_the_guide_run() {
    let is_run = |kind: &shell::Kind| *kind == shell::Kind::Run;
    assert_run(&pages_with(is_run), None);
}

/// `docs/schema` is what the types say.
#[test]
fn the_schemas_are_those_of_the_types() {
    let folder = tempfile::tempdir().unwrap();
    let ran = common::program()
        .arg("schemas")
        .arg("-o")
        .arg(folder.path())
        .output()
        .unwrap();
    assert!(ran.status.success(), "{}", common::stderr(&ran));
    let read = |folder: &Path| -> std::collections::BTreeMap<String, String> {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let named = |path: PathBuf| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).unwrap())
        };
        files.map(named).collect()
    };
    let (stored, now) = (read(&home().join("docs/schema")), read(folder.path()));
    let differing = |name: &&String| stored.get(*name) != now.get(*name);
    let stale: Vec<&String> = stored.keys().chain(now.keys()).filter(differing).collect();
    assert!(
        stale.is_empty(),
        "write them again by `scaleproof schemas -o docs/schema`: {stale:?}"
    );
}

/// Pages of which some commands need the weights of detectors, whole, since these commands go on with what others wrote.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn commands_of_the_guide_with_weights_run() {
    let needs_weights = |kind: &shell::Kind| *kind == shell::Kind::RunWithWeights;
    assert_run(&pages_with(needs_weights), Some(&common::shared("detectors")));
}

/// Pages of the guide with a block of this kind.
fn pages_with(is_meant: impl Fn(&shell::Kind) -> bool) -> Vec<Page> {
    let has = |page: &Page| {
        let mut kinds = page.blocks.iter().filter_map(|block| shell::kind(block).ok().flatten());
        kinds.any(|kind| is_meant(&kind))
    };
    let pages: Vec<Page> = pages().into_iter().filter(|page| is_guide(page) && has(page)).collect();
    assert!(pages.len() > 3, "{} pages", pages.len());
    pages
}

/// Two pages at a time.
fn assert_run(pages: &[Page], weights: Option<&Path>) {
    let (faults, times) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
    let (waiting, cache) = (Mutex::new(pages.iter()), tempfile::tempdir().unwrap());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let next = waiting.lock().unwrap().next();
                    let Some(page) = next else { break };
                    let scratch = Scratch::new(cache.path(), weights);
                    let ran = scratch.run(page);
                    let mut found: Vec<String> = ran.iter().filter_map(|block| block.fault.clone()).collect();
                    if found.is_empty() {
                        found = examples::faults_of_keys(page, scratch.path());
                        found.extend(examples::faults_of_schemas(page, scratch.path(), weights.is_some()));
                    }
                    faults.lock().unwrap().extend(found);
                    times
                        .lock()
                        .unwrap()
                        .extend(ran.iter().map(|block| block.timed(&page.name)));
                }
            });
        }
    });
    let mut times = times.into_inner().unwrap();
    times.sort();
    times.iter().rev().take(10).for_each(|time| println!("{time}"));
    assert_none(&faults.into_inner().unwrap());
}
