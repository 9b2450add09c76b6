//! Reasons why there is no mesh.

use std::path::PathBuf;

use scaleproof_core::files::FileError;
use scaleproof_core::geometry::NoDirection;
use scaleproof_core::geometry::length::shown;

/// Reason why there is no mesh. Each variant says what to change.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} is no mesh this program reads; give a .glb, .obj, .stl or .ply file", path = path.display())]
    UnknownFormat { path: PathBuf },
    #[error("{path} cannot be read as a mesh ({reason}); export it again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
    #[error("{path} has no faces; export the model's surface as triangles", path = path.display())]
    NoFaces { path: PathBuf },
    #[error("{path} is too large ({what}); simplify the mesh", path = path.display())]
    TooLarge { path: PathBuf, what: String },
    #[error("the mesh has no material '{name}'; it has {known}{hint}")]
    NoSuchMaterial { name: String, known: String, hint: String },
    #[error("the list of faces {path} cannot be used ({reason}); it holds the numbers of triangles, counted from 0 in the mesh file's order", path = path.display())]
    FaceList { path: PathBuf, reason: String },
    #[error(transparent)]
    Direction(#[from] NoDirection),
    #[error("front and up of the mesh lie along the same axis; give two different ones")]
    FrontIsUp,
    #[error(
        "the mesh's length cannot be set to {} mm; give the model's length from front to rear in mm, as in 455",
        shown(*value)
    )]
    BadLength { value: f64 },
    #[error(
        "the model would be {} × {} × {} mm (length × width × height), and its longest side must be 10 to 5000 mm; correct \
         size_mm of the scene, or give the model's length", size_mm[0], size_mm[1], size_mm[2]
    )]
    NoModel { size_mm: [f64; 3] },
    #[error(
        "the mesh is {} × {} × {} mm by its file, rather a thing itself than its scale model; give the model's \
         length, as in {at_scale} (1:{scale}) or, if the file is right, {}", size_mm[0], size_mm[1], size_mm[2], size_mm[0]
    )]
    LifeSize {
        size_mm: [f64; 3],
        at_scale: f64,
        scale: f64,
    },
    #[error("the mesh has no length along its front, so it cannot be scaled; check which way its front is")]
    NoLength,
}
