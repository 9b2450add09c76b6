//! Faults of a scene's numbers, from files and presets alike.

use scaleproof_core::geometry::NoDirection;
use scaleproof_core::geometry::length::{BadLength, LONGEST_MM, SCALES, shown};

/// Maximum number of tags; more were written by a program, and take minutes to pair up on cards.
pub(super) const MOST_TAGS: u64 = 2000;
/// Maximum number of bins.
pub(super) const MOST_BINS: usize = 100_000;

/// Fault of a scene, as a sentence that says what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneFault {
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error("model.scale is {}: give 10 for a 1:10 model, from {} to {}", shown(*.0), SCALES.start(), SCALES.end())]
    Scale(f64),
    #[error("{0} tags are too many: a scene has at most {most}", most = MOST_TAGS)]
    TooManyTags(u64),
    #[error("tag id {0} appears twice: give every [[tag]] its own id")]
    TagTwice(u32),
    #[error("tag id {id} does not exist in its family: ids end at {last}")]
    NoSuchTag { id: u32, last: u32 },
    #[error("cards.turned_deg is {0}: give 0, 90, 180 or 270")]
    CardsTurned(u32),
    #[error("cards.ids_higher_by is {by}, and tag {id} has no such id in its family: ids go from 0 to {last}")]
    CardsIds { id: u32, by: i64, last: u32 },
    #[error("right and up of tag {0} are not at a right angle: check the two vectors")]
    NoRightAngle(u32),
    #[error("{what} of tag {id} has length {length:.4}: give a unit vector")]
    NotUnit { what: &'static str, id: u32, length: f64 },
    #[error(
        "sigma_mm and sigma_deg of tag {0} go together and are 0 or more, up to {LONGEST_MM} mm and 360°: give both or neither"
    )]
    Sigma(u32),
    #[error("model.mesh is empty: name a file, or leave it out")]
    EmptyMesh,
    #[error("model.envelope is {0}: name the model's mesh, e.g. mesh = \"model.stl\"")]
    NoMesh(&'static str),
    #[error("model.mesh is named but the envelope is the box: write envelope = \"mesh\" or \"hull\"")]
    MeshOfBox,
    #[error(
        "model.mesh_front and model.mesh_up go together and lie along different axes, as in mesh_front = \"+x\" and mesh_up = \"+y\": give both or neither"
    )]
    OneAxis,
    #[error(transparent)]
    Direction(#[from] NoDirection),
    #[error(
        "model.mesh_front, model.mesh_up and model.paint are about a mesh: write envelope = \"mesh\" and mesh = \"car.obj\", or leave them out"
    )]
    FactsOfNoMesh,
    #[error("bins.azimuth_deg = {} does not divide 360° into 1 to 360 bins: use 45, 30, …", shown(*.0))]
    AzimuthStep(f64),
    #[error("bins make {0} bins, more than {most}: give fewer centres or a larger azimuth_deg", most = MOST_BINS)]
    TooManyBins(usize),
    #[error("{what} is empty: give at least one centre, e.g. [{example}]")]
    NoCentre { what: &'static str, example: f64 },
    #[error("{what} has {}: give numbers from {least} to {most}", shown(*.value))]
    Centre {
        what: &'static str,
        value: f64,
        least: f64,
        most: f64,
    },
}
