//! Simulated faults of a table, an image or a file.

/// Simulated fault. Faults of one tag apply to a random one of the seen tags.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulatedFault {
    /// A card was shifted on the table, in any direction.
    MovedTag { mm: f64 },
    /// A card was turned about its normal.
    TwistedTag { deg: f64 },
    /// A tag was printed in a mirror.
    MirroredTag,
    /// A tag reads as another tag of the scene that is not seen.
    WrongId,
    /// A second tag has the id of one of the others.
    DuplicatedId,
    /// One corner is displaced, as when it is covered and the detector does not notice.
    WrongCorner { px: f64 },
    /// Each tag is hidden with this probability.
    Hidden { share: f64 },
    /// Only the left part of the image is visible: this share of its width.
    Cropped { share: f64 },
    /// The scene file's tag sizes are wrong by this factor.
    WrongTagSize { factor: f64 },
    /// The camera file's focal length is wrong by this factor.
    WrongFocal { factor: f64 },
    /// The camera file's principal point is off to the right.
    WrongPrincipalPoint { px: f64 },
    /// The camera file has no distortion.
    IgnoredDistortion,
    /// Every card is bent to a cylinder about an axis of any direction: depth of the middle relative to the middle of a side, for each 100 mm of the
    /// tag's side.
    BentPaper { mm: f64 },
}
