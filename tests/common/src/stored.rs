//! The stored session: whole, as the demo takes it, and the sixteen photos of two textures that tests count on.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use scaleproof_core::files::sha256_hex;
use serde_json::Value;

use crate::{contents, home, kept, read_json};

/// The texture of the stored session that tests leave out, so that their figures are of the plain model and the random pattern.
const THIRD: &str = "two_targets";

/// The whole stored session.
pub fn stored() -> PathBuf {
    home().join("captures/skyline")
}

/// The stored session without its third texture: eight photos of the plain model and eight of the random pattern, with what was recorded of them.
pub fn skyline() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(without_third).clone()
}

fn without_third() -> PathBuf {
    let (stored, folder) = (stored(), kept("two_textures/skyline"));
    for (path, bytes) in contents(&stored) {
        let name = path.strip_prefix(&stored).unwrap();
        let text = name.to_str().unwrap();
        let bytes = match text {
            _ if text.starts_with(THIRD) => continue,
            "session.json" | "truth.json" => listed(&path),
            _ if text.ends_with(".provenance.json") => provenance(&path),
            _ if provenance_of(&path).exists() => results(&path),
            _ => bytes,
        };
        keep(&folder.join(name), &bytes);
    }
    folder
}

/// Writes a file that is not there as it should be, in one step: other test programs may read it meanwhile.
fn keep(path: &Path, bytes: &[u8]) {
    if std::fs::read(path).is_ok_and(|there| there == bytes) {
        return;
    }
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut new = tempfile::NamedTempFile::new_in(kept("two_textures")).unwrap();
    std::io::Write::write_all(&mut new, bytes).unwrap();
    new.persist(path).unwrap();
}

fn is_kept(photo: &Value) -> bool {
    !photo["file"].as_str().unwrap().starts_with(THIRD)
}

/// A list of photos.
fn listed(path: &Path) -> Vec<u8> {
    let mut list = read_json(path);
    list["photos"].as_array_mut().unwrap().retain(is_kept);
    serde_json::to_vec_pretty(&list).unwrap()
}

fn provenance_of(results: &Path) -> PathBuf {
    results.with_extension("provenance.json")
}

/// What was recorded, a detection a line.
fn results(path: &Path) -> Vec<u8> {
    let photos = read_json(&provenance_of(path));
    let photos = photos["photos"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|photo| is_kept(photo));
    let ids: Vec<&Value> = photos.map(|photo| &photo["id"]).collect();
    let text = std::fs::read_to_string(path).unwrap();
    let detections = text.lines().map(|line| line.trim_end_matches(','));
    let is_of = |line: &&str| {
        let detection: Option<Value> = serde_json::from_str(line).ok();
        detection.is_some_and(|detection| ids.contains(&&detection["image_id"]))
    };
    let own: Vec<&str> = detections.filter(is_of).collect();
    format!("[\n{}\n]\n", own.join(",\n")).into_bytes()
}

/// By what the detections were recorded.
fn provenance(path: &Path) -> Vec<u8> {
    let mut provenance = read_json(path);
    provenance["photos"].as_array_mut().unwrap().retain(is_kept);
    let name = path.to_str().unwrap().replace(".provenance.json", ".json");
    provenance["results_sha256"] = sha256_hex(&results(Path::new(&name))).into();
    serde_json::to_vec_pretty(&provenance).unwrap()
}
