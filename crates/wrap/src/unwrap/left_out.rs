//! Paint that is on no piece.

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftOutReason {
    /// The paint is not visible from outside.
    Hidden,
    /// The paint has no area, or is duplicated.
    NoArea,
    /// The paint is on the smallest pieces, beyond the allowed number.
    TooSmall,
}

/// Paint that is on no piece.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Triangles of the mesh, each once, ascending. A subdivided triangle may have other parts in pieces.
    pub triangles: Vec<usize>,
    pub surface_mm2: f64,
    pub reason: LeftOutReason,
}
