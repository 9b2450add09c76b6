//! Source of a material's image, and its wrapping. Nothing is read or decoded here: most commands need no image.

use std::ops::Range;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use scaleproof_core::files;

/// Look of a material by the mesh's file.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// Image; without one the factor is the colour.
    pub image: Option<ImageSource>,
    /// Wrapping to the right and up.
    pub wrap: [Wrap; 2],
    /// Factor of the image's colours, in linear light.
    pub factor: [f64; 3],
    /// Factor of the image's alpha; `None`: the alpha is ignored.
    pub alpha: Option<f64>,
}

impl Look {
    /// Makes the look of a material that shows an image without changes.
    pub(super) fn plain(image: ImageSource) -> Self {
        Self {
            image: Some(image),
            wrap: [Wrap::Repeat; 2],
            factor: [1.0; 3],
            alpha: Some(1.0),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum ImageSource {
    File(PathBuf),
    /// Within the mesh's file: some of its bytes. Many materials share them.
    Inside(Arc<[u8]>, Range<usize>),
    /// Reason why there is none, as a clause.
    Refused(String),
}

impl ImageSource {
    /// Returns the image that a mesh's file names. Files come from strangers: they name only what lies in their own folder or below.
    pub(super) fn beside(folder: &Path, name: &str) -> Self {
        // Programs for Windows write folders with backslashes.
        let name = name.replace('\\', "/");
        let has_drive = name.as_bytes().get(1) == Some(&b':');
        let is_below = Path::new(&name)
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if name.is_empty() || has_drive || !is_below {
            return Self::Refused(format!(
                "its image '{name}' is not named within the mesh's folder; put the image beside the mesh and name it there"
            ));
        }
        let path = folder.join(&name);
        if leads_out(folder, &path) {
            return Self::Refused(format!(
                "its image '{name}' is a link to a place outside the mesh's folder; put the image itself beside the mesh"
            ));
        }
        files::inputs::note(&path);
        Self::File(path)
    }
}

/// Returns true if links lead a path that is there out of the folder.
fn leads_out(folder: &Path, path: &Path) -> bool {
    let folder = files::folder_of(&folder.join("-")).canonicalize();
    matches!((folder, path.canonicalize()), (Ok(folder), Ok(path)) if !path.starts_with(&folder))
}

/// Continuation of an image beyond its borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    Repeat,
    MirroredRepeat,
    ClampToEdge,
}

impl Wrap {
    /// Returns the place within the image, from 0 to 1.
    pub fn within(self, coordinate: f64) -> f64 {
        match self {
            Self::Repeat => coordinate - coordinate.floor(),
            Self::MirroredRepeat => 1.0 - (coordinate.rem_euclid(2.0) - 1.0).abs(),
            Self::ClampToEdge => coordinate.clamp(0.0, 1.0),
        }
    }
}
