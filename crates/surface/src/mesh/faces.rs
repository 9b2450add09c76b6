//! A list of triangles by number, as the attacks that paint every triangle by itself give the paint (`exterior_face.txt`).

use std::path::Path;

use super::error::MeshError;
use super::soup::MAX_TRIANGLES;
use super::triangles::Mesh;
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

impl Mesh {
    /// Gives some triangles materials of their own, one for each material that they were of, and returns these.
    #[must_use]
    pub fn with_paint(mut self, faces: &FaceList) -> (Self, Vec<usize>) {
        let count = self.materials.len();
        let mut of_old = vec![None; count];
        self.looks.resize(count, None);
        for face in &faces.indices {
            let Some(triangle) = self.triangles.get_mut(*face) else {
                continue;
            };
            let old = triangle.material;
            // The face was listed before, and has its own material.
            let Some(of_old) = of_old.get_mut(old) else { continue };
            triangle.material = *of_old.get_or_insert_with(|| {
                self.materials.push(format!("{} (paint)", self.materials[old]));
                self.looks.push(self.looks[old].clone());
                self.materials.len() - 1
            });
        }
        let paint = (count..self.materials.len()).collect();
        (self, paint)
    }
}
