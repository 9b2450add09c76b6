//! YOLO's text files: one for each photo, a line `class cx cy width height confidence` for each box, in shares of the photo's sides.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::boxes::{PhotoBoxes, RawBox, ReadResults};
use super::categories::Categories;
use super::error::OutsideError;
use super::photo_names::{PhotoNames, stem};
use super::request::ResultsRequest;
use scaleproof_core::files::{self, FileError};

/// No box of a photo has a share beyond this, however it is rounded.
const LARGEST_SHARE: f64 = 1.5;
/// Folders below the named one that are looked into.
const DEEPEST: usize = 8;

pub(super) fn read(
    request: &ResultsRequest,
    categories: &Categories,
    names: &PhotoNames,
) -> Result<ReadResults, OutsideError> {
    let folder = request.path;
    let mut found = Vec::new();
    text_files(folder, Path::new(""), DEEPEST, &mut found)?;
    found.sort();
    let mut by_photo: Vec<PhotoBoxes> = request.photos.iter().map(|_| PhotoBoxes::default()).collect();
    let (mut unknown, mut hashes) = (Vec::new(), String::new());
    let mut files_of: BTreeMap<usize, &String> = BTreeMap::new();
    for name in &found {
        let path = folder.join(name);
        // A list of names may lie among the results.
        let is_same = |list: &Path| files::whole_path(list).ok() == files::whole_path(&path).ok();
        if request.categories.is_some_and(is_same) {
            continue;
        }
        let refuse = |message: String| FileError::content(folder, message);
        let Some(index) = names.find(stem(name), name).map_err(refuse)? else {
            unknown.push(name.clone());
            continue;
        };
        if let Some(other) = files_of.insert(index, name) {
            let photo = request.photos.get(index).map_or("", |photo| photo.file.as_str());
            return Err(refuse(format!("{other} and {name} may both be of the photo {photo}")).into());
        }
        let text = files::read_text(&path)?;
        hashes.push_str(&format!("{} {name}\n", files::sha256_hex(text.as_bytes())));
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let boxes = lines
            .map(|(at, line)| raw_box(line, categories).map_err(|message| FileError::syntax(&path, at + 1, message)));
        if let Some(photo) = by_photo.get_mut(index) {
            photo.boxes = boxes.collect::<Result<_, _>>()?;
            photo.is_listed = true;
        }
    }
    if files_of.is_empty() {
        let what = match unknown.first() {
            None => "it has no text files (.txt)".to_owned(),
            Some(first) => format!("none of its text files is called as a photo of this run (the first: {first})"),
        };
        return Err(FileError::content(folder, what).into());
    }
    Ok(ReadResults {
        by_photo,
        unknown,
        files: vec![(files::name_of(folder), files::sha256_hex(hashes.as_bytes()))],
    })
}

/// The text files in and below a folder, by their path from it; hidden ones are passed over.
fn text_files(folder: &Path, below: &Path, deeper: usize, found: &mut Vec<String>) -> Result<(), FileError> {
    let place: PathBuf = folder.join(below);
    let failed = |e: std::io::Error| FileError::read(&place, &e);
    for entry in std::fs::read_dir(&place).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let Some(name) = entry.file_name().to_str().map(|name| below.join(name)) else {
            continue;
        };
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        let kind = entry.file_type().map_err(failed)?;
        if kind.is_dir() && deeper > 0 {
            text_files(folder, &name, deeper - 1, found)?;
        } else if !kind.is_dir() && name.extension().is_some_and(|ending| ending == "txt") {
            found.push(name.display().to_string());
        }
    }
    Ok(())
}

fn raw_box(line: &str, categories: &Categories) -> Result<RawBox, String> {
    let mut words = line.split_whitespace();
    let class = words.next().unwrap_or_default();
    let numbers: Vec<Option<f64>> = words.take(7).map(|word| word.parse().ok()).collect();
    let [cx, cy, w, h, score] = match numbers[..] {
        [Some(cx), Some(cy), Some(w), Some(h), Some(score)] => [cx, cy, w, h, score],
        [_, _, _, _] => {
            return Err(
                "it has no confidence: let the other program write it as the last number (Ultralytics: save_conf=True)"
                    .into(),
            );
        }
        _ => return Err("give class, centre x, centre y, width, height and confidence, and nothing else".into()),
    };
    // NumPy's savetxt writes 5 as 5.000000000000000000e+00.
    let index = class
        .parse()
        .ok()
        .filter(|class: &f64| class.fract() == 0.0 && *class >= 0.0);
    let index = index.ok_or_else(|| format!("the class {class:?} is no whole number"))? as u64;
    let label = categories.of_class(index)?;
    let shares = [cx, cy, w, h];
    if w < 0.0 || h < 0.0 || !shares.iter().all(|v| v.is_finite()) {
        return Err(format!(
            "the box {shares:?} has no size: give centre x, centre y, width and height"
        ));
    }
    if shares.iter().any(|v| v.abs() > LARGEST_SHARE) {
        return Err(format!(
            "the box {shares:?} has numbers above 1: give shares of the photo's width and height, not pixels"
        ));
    }
    Ok(RawBox {
        label,
        score,
        xywh: [cx - w / 2.0, cy - h / 2.0, w, h],
    })
}
