//! A list of triangles by number, as the attacks that paint every triangle by itself give the paint (`exterior_face.txt`).

use std::path::Path;

use super::{MAX_TRIANGLES, Mesh, MeshError};
use scaleproof_core::files;

/// Size of the largest file: nine bytes a triangle, and room for comments of an editor.
const MOST_BYTES: u64 = 16 * MAX_TRIANGLES as u64;

#[derive(Debug, Clone, PartialEq)]
pub struct FaceList {
    /// Indices of triangles, each once, ascending.
    pub(super) indices: Vec<usize>,
    /// Entries of the file beyond the first of each triangle.
    pub repeated: usize,
}

impl FaceList {
    /// Reads whole numbers with white space between them: the indices of triangles from 0 on, in the order of the mesh's file, where a
    /// polygon of more corners counts as the triangles that it is cut into.
    pub fn load(path: &Path, mesh: &Mesh) -> Result<Self, MeshError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        Self::parse(&String::from_utf8_lossy(&bytes), mesh.triangles().len()).map_err(|reason| MeshError::FaceList {
            path: path.to_owned(),
            reason,
        })
    }

    /// Returns the triangles of some materials; none when no material is named.
    pub fn from_materials(mesh: &Mesh, materials: &[usize]) -> Self {
        let is_painted = |i: &usize| materials.contains(&mesh.triangles()[*i].material);
        Self {
            indices: (0..mesh.triangles().len()).filter(is_painted).collect(),
            repeated: 0,
        }
    }

    fn parse(text: &str, triangles: usize) -> Result<Self, String> {
        let mut indices = Vec::new();
        for (i, line) in text.lines().enumerate() {
            for word in line.split_whitespace() {
                let shown: String = word.chars().take(20).collect();
                let index: usize = word
                    .parse()
                    .map_err(|_| format!("line {} has '{shown}', which is no whole number", i + 1))?;
                if index >= triangles {
                    return Err(format!(
                        "line {} has triangle {index}, and the mesh has {triangles} of them",
                        i + 1
                    ));
                }
                indices.push(index);
            }
        }
        if indices.is_empty() {
            return Err("it is empty".into());
        }
        let entries = indices.len();
        indices.sort_unstable();
        indices.dedup();
        Ok(Self {
            repeated: entries - indices.len(),
            indices,
        })
    }
}
