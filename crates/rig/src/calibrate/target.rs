//! Target of a calibration: a board, or the tags of a scene whose places are known.

use nalgebra::Point3;

use super::board_photo::SeenCorner;
use super::model::LensModel;
use scaleproof_pose::board::Definition;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::SeenTag;

/// Target that is photographed for a calibration.
#[derive(Debug, Clone, Copy)]
pub enum Target<'a> {
    Board(&'a Definition),
    Scene(&'a Scene),
}

/// Least number of tags of a frame: fewer say too little beside the six numbers of its pose.
pub(super) const LEAST_TAGS: usize = 3;

impl Target<'_> {
    /// Returns the corners, mm; a [`SeenCorner::id`] is the place in this list. Of a scene four a tag, in its order, in the model's frame.
    pub(super) fn corners_mm(&self) -> Vec<Point3<f64>> {
        match self {
            Target::Board(board) => {
                let corners = board.corners_mm().into_iter();
                corners.map(|[x, y]| Point3::new(x, y, 0.0)).collect()
            }
            Target::Scene(scene) => scene.tags.iter().flat_map(|tag| tag.corners_mm()).collect(),
        }
    }

    /// Returns the point whose distance is stated, mm: the board's middle, or the target point of the scene's viewpoints.
    pub(super) fn middle_mm(&self) -> Point3<f64> {
        match self {
            Target::Board(board) => {
                let (width, height) = board.size_mm();
                Point3::new(width / 2.0, height / 2.0, 0.0)
            }
            Target::Scene(scene) => scene.model.target_mm(),
        }
    }

    /// Returns the models that are tried. A walk round a few tags leaves the corners of the image empty, and the effect of a rolling shutter would
    /// pass for the larger ones.
    pub(super) fn models(&self) -> &'static [LensModel] {
        match self {
            Target::Board(_) => &LensModel::LADDER,
            Target::Scene(_) => &LensModel::LADDER[..4],
        }
    }

    /// Returns the target in words, for a message that no photo shows it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Target::Board(_) => "the board",
            Target::Scene(_) => "three whole tags of the scene",
        }
    }

    /// Returns advice for a focal length that is left open.
    pub(super) fn focal_advice(&self) -> &'static str {
        match self {
            Target::Board(_) => "tilt the board by 30° to 45° to several sides, and fill the photo with it",
            Target::Scene(_) => {
                "film from the side, not from above, from near and far, with tags near and far in each frame and some on cards that stand up"
            }
        }
    }

    /// Returns the question to ask where the corners do not fit.
    pub(super) fn misfit_question(&self) -> &'static str {
        match self {
            Target::Board(_) => "is this the board of the file, flat and stiff, and one camera at one zoom?",
            Target::Scene(_) => {
                "do the tags stand as in the scene, and is this one camera at one zoom, with stabilisation switched off?"
            }
        }
    }
}

/// Returns the corners of the whole tags that the scene has, each tag only where it is seen once.
pub(super) fn corners_of(seen: &[SeenTag], scene: &Scene) -> Vec<SeenCorner> {
    let key = |tag: &SeenTag| (tag.family, tag.id);
    let is_sure = |tag: &&SeenTag| tag.is_whole && seen.iter().filter(|other| key(other) == key(tag)).count() == 1;
    let corners = seen.iter().filter(is_sure).filter_map(|tag| {
        let place = scene.tags.iter().position(|t| (t.family, t.id) == key(tag))?;
        let corner = move |(i, px): (usize, [f64; 2])| SeenCorner { id: 4 * place + i, px };
        Some(tag.corners_px.into_iter().enumerate().map(corner))
    });
    corners.flatten().collect()
}
