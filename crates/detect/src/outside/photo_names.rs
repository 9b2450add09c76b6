//! Which photo of a run a name means that another program wrote: its path or the end of it, its name, or its name without the ending.

use std::collections::HashMap;
use std::path::{Component, Path};

/// A photo of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhotoName {
    /// As its session names it.
    pub file: String,
    /// The parts of its whole path.
    parts: Vec<String>,
}

impl PhotoName {
    /// A photo that a session in a folder names so.
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

    fn last(&self) -> &str {
        self.parts.last().map_or("", String::as_str)
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

/// What a name means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    /// The photo with this index.
    Photo(usize),
    Nothing,
    /// These and perhaps others.
    Several(usize, usize),
}

/// The photos of a run by what other programs may call them.
pub(super) struct PhotoNames<'a> {
    photos: &'a [PhotoName],
    by_name: HashMap<String, Vec<usize>>,
    by_stem: HashMap<String, Vec<usize>>,
}

impl PhotoNames<'_> {
    pub(super) fn of(photos: &[PhotoName]) -> PhotoNames<'_> {
        let (mut by_name, mut by_stem) = (HashMap::new(), HashMap::new());
        for (index, photo) in photos.iter().enumerate() {
            let mut names = vec![photo.last().to_owned(), flat_name(&photo.file)];
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

    /// The photo of a name. Of photos that are called alike, the one whose folders agree furthest.
    pub(super) fn find(&self, name: &str) -> Found {
        let parts: Vec<&str> = name.split(['/', '\\']).filter(|part| !part.is_empty()).collect();
        let Some((last, folders)) = parts.split_last() else {
            return Found::Nothing;
        };
        let found = self.by_name.get(*last).or_else(|| self.by_stem.get(*last));
        let Some(found) = found else {
            return Found::Nothing;
        };
        let agreeing = |index: &&usize| {
            let own = self.photos.get(**index).map_or(&[][..], |photo| &photo.parts);
            let own = own.split_last().map_or(&[][..], |(_, folders)| folders);
            let pairs = own.iter().rev().zip(folders.iter().rev());
            pairs.take_while(|(own, other)| own == other).count()
        };
        let most = found.iter().map(|index| agreeing(&index)).max().unwrap_or(0);
        let mut best = found.iter().filter(|index| agreeing(index) == most);
        match (best.next(), best.next()) {
            (Some(only), None) => Found::Photo(*only),
            (Some(a), Some(b)) => Found::Several(*a, *b),
            _ => Found::Nothing,
        }
    }

    /// Why a name that means several photos is refused.
    pub(super) fn several(&self, name: &str, a: usize, b: usize) -> String {
        let file = |index: usize| self.photos.get(index).map_or("", |photo| photo.file.as_str());
        format!("{name} may be {} or {}: name it with its folder", file(a), file(b))
    }
}

fn add(to: &mut HashMap<String, Vec<usize>>, name: &str, index: usize) {
    let found = to.entry(name.to_owned()).or_default();
    if found.last() != Some(&index) {
        found.push(index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_means_the_photo_whose_folders_agree_furthest() {
        let photo = |folder: &str, file: &str| PhotoName::new(Path::new(folder), file);
        let photos = [
            photo("/s/one", "a.jpg"),
            photo("/s/two", "a.jpg"),
            photo("/s/two", "../x/b.jpg"),
            photo("/s/two", "c/d.jpg"),
        ];
        let names = PhotoNames::of(&photos);
        for (name, found) in [
            ("two/a.jpg", Found::Photo(1)),
            ("/elsewhere/one/a.jpg", Found::Photo(0)),
            ("one\\a", Found::Photo(0)),
            ("a.jpg", Found::Several(0, 1)),
            ("b", Found::Photo(2)),
            ("x_b.jpg", Found::Photo(2)),
            ("c_d", Found::Photo(3)),
            ("e.jpg", Found::Nothing),
            ("", Found::Nothing),
            ("/", Found::Nothing),
        ] {
            assert_eq!(names.find(name), found, "{name}");
        }
    }
}
