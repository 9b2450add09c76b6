//! The photo of a run that another program's name means: its path or the end of it, its name, or its name without the ending.

use std::collections::HashMap;
use std::path::{Component, Path};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhotoName {
    pub file: String,
    /// The parts of its whole path.
    parts: Vec<String>,
}

impl PhotoName {
    pub fn new(folder: &Path, file: &str) -> PhotoName {
        let mut parts: Vec<String> = Vec::new();
        for part in folder.join(file).components() {
            match part {
                Component::Normal(name) => parts.push(name.to_string_lossy().into_owned()),
                Component::ParentDir => drop(parts.pop()),
                _ => {}
            }
        }
        let file = file.to_owned();
        PhotoName { file, parts }
    }
}

/// A photo's path in one word, for folders that hold the photos of several.
pub fn flat_name(file: &str) -> String {
    let parts = Path::new(file).components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy()),
        _ => None,
    });
    parts.collect::<Vec<_>>().join("_")
}

/// A name without its ending.
pub(super) fn stem(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

/// The photos of a run by what other programs may call them.
pub struct PhotoNames<'a> {
    photos: &'a [PhotoName],
    by_name: HashMap<String, Vec<usize>>,
    by_stem: HashMap<String, Vec<usize>>,
}

impl PhotoNames<'_> {
    pub fn new(photos: &[PhotoName]) -> PhotoNames<'_> {
        let (mut by_name, mut by_stem) = (HashMap::new(), HashMap::new());
        for (index, photo) in photos.iter().enumerate() {
            let last = photo.parts.last().cloned().unwrap_or_default();
            let mut names = vec![last, flat_name(&photo.file)];
            names.dedup();
            for name in names {
                add(&mut by_stem, stem(&name), index);
                add(&mut by_name, &name, index);
            }
        }
        PhotoNames {
            photos,
            by_name,
            by_stem,
        }
    }

    /// The index of the photo that a name means, if there is one: of photos that are called alike, the one whose folders agree furthest.
    ///
    /// # Errors
    /// Why a name that means several photos is refused, which the sentence calls `called`.
    pub fn find(&self, name: &str, called: &str) -> Result<Option<usize>, String> {
        let parts: Vec<&str> = name.split(['/', '\\']).filter(|part| !part.is_empty()).collect();
        let Some((last, folders)) = parts.split_last() else {
            return Ok(None);
        };
        let found = self.by_name.get(*last).or_else(|| self.by_stem.get(*last));
        let agreeing = |index: &usize| {
            let own = self.photos.get(*index).and_then(|photo| photo.parts.split_last());
            let own = own.map_or(&[][..], |(_, folders)| folders);
            let pairs = own.iter().rev().zip(folders.iter().rev());
            pairs.take_while(|(own, other)| own == other).count()
        };
        let most = found.into_iter().flatten().map(agreeing).max();
        let mut best = found
            .into_iter()
            .flatten()
            .filter(|index| Some(agreeing(index)) == most);
        match (best.next(), best.next()) {
            (Some(a), Some(b)) => {
                let [a, b] = [a, b].map(|index| self.photos.get(*index).map_or("", |photo| &photo.file));
                Err(format!("{called} may be {a} or {b}: name it with its folder"))
            }
            (only, _) => Ok(only.copied()),
        }
    }
}

fn add(to: &mut HashMap<String, Vec<usize>>, name: &str, index: usize) {
    let found = to.entry(name.to_owned()).or_default();
    if found.last() != Some(&index) {
        found.push(index);
    }
}
