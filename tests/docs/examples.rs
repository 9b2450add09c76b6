//! Examples of file formats in the reference, given to the program's own readers; and the keys of files that commands wrote, held against
//! the tables that list them.

use std::collections::BTreeSet;
use std::path::Path;

use scaleproof_capture::Sidecar;
use scaleproof_detect::{Manifest, ProgramSpec, Recording, Speeds};
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_print::printer::PrinterFile;
use scaleproof_session::{Session, import};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card;
use scaleproof_surface::pattern::palette::Palette;

use super::markdown::{Block, Page};
use crate::common;

type Read = Result<(), String>;

/// Reads an example as what the remark above it says, `read as: KIND`.
///
/// # Errors
/// The sentence of the program.
pub fn read(kind: &str, block: &Block) -> Read {
    let folder = tempfile::tempdir().unwrap();
    let (text, at) = (block.text.as_str(), folder.path());
    let file = at.join("example");
    std::fs::write(&file, text).unwrap();
    match kind {
        "scene" => said(Scene::parse(text, &file)),
        "camera" => said(Camera::parse(text, &file)),
        "manifest" => said(Manifest::parse(text, "example")),
        "program" => said(ProgramSpec::parse(text, &file)),
        "board" => said(Definition::open(&file)),
        "printer" => said(PrinterFile::load(&file)),
        "paints" => said(Palette::load(&file)),
        "speed" => said(Speeds::open(&file, &[])),
        "sidecar" => said(serde_json::from_str::<Sidecar>(text)),
        "recording" => said(serde_json::from_str::<Recording>(text)),
        "coco" => said(import::coco::parse(text, &"car".parse().unwrap()).map_err(|fault| fault.message)),
        "table" => said(import::csv::parse(text, &"car".parse().unwrap()).map_err(|fault| fault.message)),
        "card" => card(text, at),
        "session" => session(text, at),
        "frames" => frames(text, at),
        "import" => frames_of_another_engine(text, at),
        "history" => history(text, at),
        "json" => said(serde_json::from_str::<serde_json::Value>(text)),
        other => Err(format!("nothing is read as `{other}`")),
    }
}

fn said<T, E: ToString>(result: Result<T, E>) -> Read {
    result.map(|_| ()).map_err(|e| e.to_string())
}

/// The card of a pattern that is in the project.
fn card(text: &str, at: &Path) -> Read {
    let path = at.join("pattern.png");
    std::fs::copy(common::home().join("print_templates/patterns/yolox_nano_er.png"), &path).unwrap();
    std::fs::write(at.join("pattern.json"), text).unwrap();
    said(card::tile_mm(None, &path, &Pattern::load(&path).unwrap()))
}

fn session(text: &str, at: &Path) -> Read {
    for name in ["scene.toml", "camera.yaml"] {
        std::fs::copy(common::skyline().join(name), at.join(name)).unwrap();
    }
    std::fs::write(at.join("session.json"), text).unwrap();
    said(Session::open(at))
}

/// The list alone: what it names needs only to be there.
fn frames(text: &str, at: &Path) -> Read {
    std::fs::write(at.join("frames.json"), text).unwrap();
    let list: serde_json::Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let mut open = vec![&list];
    while let Some(value) = open.pop() {
        match value {
            serde_json::Value::String(name) if name.ends_with(".png") => {
                let path = at.join(name);
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                std::fs::write(path, "").unwrap();
            }
            serde_json::Value::Array(inner) => open.extend(inner),
            serde_json::Value::Object(inner) => open.extend(inner.values()),
            _ => {}
        }
    }
    said(scaleproof_frames::FrameSet::open(at))
}

/// `import.json` and `poses.csv` in one example, with a blank line between; the images are made here.
fn frames_of_another_engine(text: &str, at: &Path) -> Read {
    let (about, poses) = text
        .split_once("\n\n")
        .ok_or("give import.json, a blank line, and poses.csv")?;
    std::fs::write(at.join("import.json"), about).unwrap();
    std::fs::write(at.join("poses.csv"), poses).unwrap();
    let told: serde_json::Value = serde_json::from_str(about).map_err(|e| e.to_string())?;
    let colour = |key: &str| {
        let of = told[key][0].as_array().map(|c| c.iter().filter_map(|v| v.as_u64()));
        of.map(|channels| channels.map(|v| v as u8).collect::<Vec<u8>>())
    };
    let object = colour("paint_rgb")
        .or_else(|| colour("object_rgb"))
        .ok_or("no object_rgb")?;
    let object = image::Rgb([object[0], object[1], object[2]]);
    for line in poses.lines().skip(1) {
        let name = line.split(',').next().unwrap_or_default();
        for (place, rgb) in [("rgb", image::Rgb([90, 90, 90])), ("mask", object)] {
            std::fs::create_dir_all(at.join(place)).unwrap();
            let picture = image::RgbImage::from_pixel(8, 6, rgb);
            picture.save(at.join(format!("{place}/{name}.png"))).unwrap();
        }
    }
    run(&["attack", "import"], at, &at.join("frames"))
}

fn history(text: &str, at: &Path) -> Read {
    std::fs::write(at.join("history.json"), text).unwrap();
    run(&["attack", "history"], at, &at.join("chart"))
}

fn run(command: &[&str], input: &Path, output: &Path) -> Read {
    let ran = common::program()
        .args(command)
        .arg(input)
        .arg("-o")
        .arg(output)
        .output()
        .unwrap();
    if ran.status.success() {
        Ok(())
    } else {
        Err(common::stderr(&ran))
    }
}

/// Files that a page's commands have written in `folder`, held against the schemas that it names: `written as NAME: FILE`, or, of files that only
/// commands with weights write, `with weights written as NAME: FILE`.
pub fn faults_of_schemas(page: &Page, folder: &Path, has_weights: bool) -> Vec<String> {
    let mut faults = Vec::new();
    for (line, text) in &page.prose {
        let Some(remark) = text
            .trim()
            .strip_prefix("<!-- ")
            .and_then(|rest| rest.strip_suffix(" -->"))
        else {
            continue;
        };
        let always = remark.strip_prefix("written as ");
        let with_weights = || remark.strip_prefix("with weights written as ").filter(|_| has_weights);
        let Some((name, file)) = always.or_else(with_weights).and_then(|rest| rest.split_once(": ")) else {
            continue;
        };
        let schema = common::home().join(format!("docs/schema/{name}.json"));
        let found = super::schema::faults(&folder.join(file), &schema);
        faults.extend(
            found
                .iter()
                .map(|fault| format!("{}, line {line}, {file}: {fault}", page.name)),
        );
    }
    faults
}

/// What a page says of the keys of a file that its commands have written in `folder`: the faults.
pub fn faults_of_keys(page: &Page, folder: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    for (i, (line, text)) in page.prose.iter().enumerate() {
        let Some(names) = files_with_keys(text) else {
            continue;
        };
        let written: BTreeSet<String> = names
            .split_whitespace()
            .flat_map(|name| keys(&folder.join(name)))
            .collect();
        let rows = rows(&page.prose[i + 1..]);
        let listed: BTreeSet<&String> = rows.iter().flat_map(|row| &row.names).collect();
        let missing: Vec<&String> = written.iter().filter(|key| !listed.contains(key)).collect();
        let always = rows.iter().filter(|row| !row.is_optional).flat_map(|row| &row.keys);
        let stale: Vec<&String> = always.filter(|key| !written.contains(*key)).collect();
        if !missing.is_empty() {
            faults.push(format!(
                "{}, line {line}: {names} has keys that are not listed: {missing:?}",
                page.name
            ));
        }
        if !stale.is_empty() {
            faults.push(format!(
                "{}, line {line}: {names} lacks listed keys: {stale:?}",
                page.name
            ));
        }
    }
    faults
}

/// The files that a line names as those whose keys follow.
fn files_with_keys(line: &str) -> Option<&str> {
    line.trim().strip_prefix("<!-- keys of:")?.strip_suffix("-->")
}

/// A line of a table.
struct Row {
    /// The names in its first column, of `a.b[].c` the last: what is written whenever the line is not optional.
    keys: Vec<String>,
    /// Every name in it, those that lead to the keys and those that explain them.
    names: Vec<String>,
    is_optional: bool,
}

/// The tables up to the next heading or the next `keys of`.
fn rows(lines: &[(usize, String)]) -> Vec<Row> {
    let own = lines.iter().map(|(_, text)| text.trim());
    let own = own.take_while(|text| !text.starts_with('#') && files_with_keys(text).is_none());
    own.filter_map(row).collect()
}

fn row(text: &str) -> Option<Row> {
    let (first, rest) = text.strip_prefix('|')?.split_once('|')?;
    let spans = |text: &str| {
        text.split('`')
            .skip(1)
            .step_by(2)
            .map(|key| key.replace("[]", ""))
            .collect::<Vec<_>>()
    };
    let keys = spans(first);
    let names = keys.iter().cloned().chain(spans(rest));
    Some(Row {
        names: names
            .flat_map(|name| name.split('.').map(str::to_owned).collect::<Vec<_>>())
            .collect(),
        keys: keys
            .iter()
            .filter_map(|key| Some(key.rsplit('.').next()?.to_owned()))
            .collect(),
        is_optional: rest.contains("optional"),
    })
}

/// Every key in a JSON file (or one of a JSON object a line), or the header of a CSV file. Names of files, places and figures, which are keys
/// of some objects, are none: they have other characters than a key.
fn keys(path: &Path) -> BTreeSet<String> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    if path.extension().is_some_and(|e| e == "csv") {
        let header = text.lines().next().unwrap_or_default();
        return header.split(',').map(str::to_owned).collect();
    }
    let mut keys = BTreeSet::new();
    let mut open: Vec<serde_json::Value> = match serde_json::from_str(&text) {
        Ok(whole) => vec![whole],
        Err(_) => text.lines().map(|line| serde_json::from_str(line).unwrap()).collect(),
    };
    assert!(!open.is_empty(), "{} is empty", path.display());
    while let Some(value) = open.pop() {
        match value {
            serde_json::Value::Array(inner) => open.extend(inner),
            serde_json::Value::Object(inner) => {
                let is_key = |key: &String| key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                keys.extend(inner.keys().filter(|key| is_key(key)).cloned());
                open.extend(inner.into_iter().map(|(_, value)| value));
            }
            _ => {}
        }
    }
    keys
}
