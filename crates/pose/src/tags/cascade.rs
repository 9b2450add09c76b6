//! The default: several finders one after the other, the fastest first, until nothing is missing.
//!
//! The caller says what the tags found so far leave open: whether they make a pose, and where that pose expects tags that were not found. The
//! cascade looks for those in their places before the next finder starts.

use super::apriltag_c::AprilTagC;
use super::expected::{self, StillMissing};
use super::fit::{TagFit, fitted};
use super::merge::MergedTags;
use super::search::{Found, Search, Strength, reduced_by};
use super::{SeenTag, StartError, TagDetector, rivals};
use crate::scene::TagFamily;
use scaleproof_photo::photo::{Luma, REDUCTIONS};

/// Images of at most this long side are searched as they are, larger ones reduced to it at most.
const SEARCHED_PX: u32 = 1600;

/// The first finder is shown the larger ones still smaller, at least this long: tags that it misses are looked for where the pose expects them.
const SMALL_PX: u32 = 800;

/// Live images are reduced to at most this long side, px: the answer must come soon, and the next image brings another chance.
const SEARCHED_LIVE_PX: u32 = 640;

/// Tags that are found in their places make a better pose, which tells more places; so often at most.
const MOST_LOOKS: usize = 3;

/// With so many whole tags a pose is likely beyond doubt, and small ones that a reduced image hides are not missed: where nobody says what is missing.
const ENOUGH_TAGS: usize = 2;

/// Finders in turn. Holds C memory, so each thread makes its own.
pub struct Cascade {
    stages: Vec<Stage>,
}

/// One finder and when it runs.
struct Stage {
    search: Box<dyn Search>,
    view: View,
    need: Need,
}

/// What a finder is shown.
#[derive(Clone, Copy, PartialEq)]
enum View {
    /// The image reduced to about this long side, px.
    Reduced(u32),
    /// A large image reduced further.
    Small,
    /// All of an image that is reduced for others.
    Whole,
}

/// When a finder runs.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    /// While tags are missing.
    MissingTags,
    /// While there is no pose: it takes long, or sees little where tags are clear.
    NoPose,
}

impl Cascade {
    /// A detector for some families.
    pub fn new(families: &[TagFamily]) -> Result<Cascade, StartError> {
        let reduced = View::Reduced(SEARCHED_PX);
        let c = || -> Result<Box<dyn Search>, StartError> { Ok(Box::new(AprilTagC::new(families)?)) };
        let mut stages = Vec::new();
        let mut add = |searches: Vec<Box<dyn Search>>, view, need| {
            stages.extend(searches.into_iter().map(|search| Stage { search, view, need }));
        };
        let mut fast = rivals::finders(Strength::Speed, families)?;
        let others = fast.split_off(fast.len().min(1));
        add(fast, View::Small, Need::MissingTags);
        add(others, reduced, Need::MissingTags);
        add(rivals::finders(Strength::Noise, families)?, reduced, Need::NoPose);
        add(vec![c()?], reduced, Need::MissingTags);
        add(rivals::finders(Strength::SmallTags, families)?, reduced, Need::NoPose);
        add(vec![c()?], View::Whole, Need::NoPose);
        Ok(Cascade { stages })
    }

    /// A faster one, which misses small tags: the fastest finder alone, on a small image.
    pub fn live(families: &[TagFamily]) -> Result<Cascade, StartError> {
        let stage = Stage {
            search: match rivals::finders(Strength::Speed, families)?.into_iter().next() {
                Some(fastest) => fastest,
                None => Box::new(AprilTagC::new(families)?),
            },
            view: View::Reduced(SEARCHED_LIVE_PX),
            need: Need::MissingTags,
        };
        Ok(Cascade { stages: vec![stage] })
    }
}

impl Stage {
    /// `None` where it would be shown what others have been shown.
    fn search(&mut self, luma: &dyn Luma) -> Option<Vec<Found>> {
        let [width, height] = luma.size();
        let longest = width.max(height);
        let factor = match self.view {
            View::Reduced(to_px) => longest.div_ceil(to_px).max(1),
            View::Small if longest <= SEARCHED_PX => 1,
            View::Small => REDUCTIONS.into_iter().find(|f| longest / f >= SMALL_PX).unwrap_or(1),
            View::Whole if longest <= SEARCHED_PX => return None,
            View::Whole => 1,
        };
        Some(reduced_by(luma, factor, |small| self.search.search(small)))
    }
}

impl TagDetector for Cascade {
    /// Without a scene it is not known what is missing: all finders run, the slow ones only where almost nothing is found.
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let mut tags = MergedTags::default();
        for need in [Need::MissingTags, Need::NoPose] {
            for stage in self.stages.iter_mut().filter(|stage| stage.need == need) {
                tags.add(stage.search(luma).unwrap_or_default(), luma);
            }
            if tags.seen().iter().filter(|tag| tag.is_whole).count() >= ENOUGH_TAGS {
                break;
            }
        }
        tags.seen()
    }

    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        let mut tags = MergedTags::default();
        let (mut seen, mut left) = looked(&mut tags, luma, missing);
        for stage in &mut self.stages {
            // A lone tag of another size than the scene's fits as well, and then expects the others elsewhere.
            let is_lone = seen.iter().filter(|tag| tag.is_whole).count() < 2;
            if left.has_pose && !is_lone && !left.expected.iter().any(|tag| tag.is_in_plain_view) {
                break;
            }
            if stage.need == Need::NoPose && left.has_pose {
                continue;
            }
            if let Some(found) = stage.search(luma) {
                tags.add(found, luma);
                (seen, left) = looked(&mut tags, luma, missing);
            }
        }
        seen
    }
}

/// Looks for what is missing in its places, until nothing more is found there.
fn looked(
    tags: &mut MergedTags,
    luma: &dyn Luma,
    missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing,
) -> (Vec<SeenTag>, StillMissing) {
    let (mut seen, mut left) = asked(tags, missing);
    for _ in 0..MOST_LOOKS {
        let expected = left.expected.iter();
        let found: Vec<TagFit> = expected.filter_map(|tag| expected::look(luma, tag)).collect();
        if found.is_empty() {
            break;
        }
        found.into_iter().for_each(|tag| tags.add_fit(tag));
        (seen, left) = asked(tags, missing);
    }
    (seen, left)
}

/// What all tags leave open; where they make no pose, and those with fitted corners alone do, what these leave. One of them alone would be chosen
/// against the others, which may be right.
fn asked(tags: &MergedTags, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> (Vec<SeenTag>, StillMissing) {
    let seen = tags.seen();
    let left = missing(&seen);
    let fitted = tags.fitted();
    let whole = fitted.iter().filter(|tag| tag.is_whole).count();
    if !left.has_pose && whole > 1 && fitted.len() < seen.len() {
        let left_by_fitted = missing(&fitted);
        if left_by_fitted.has_pose {
            return (fitted, left_by_fitted);
        }
    }
    (seen, left)
}

/// C AprilTag on a reduced image, and our own corners. Holds C memory, so each thread makes its own.
pub struct CoarseToFine {
    search: AprilTagC,
    searched_px: u32,
    /// With fewer whole tags the image is searched again at full size.
    enough_tags: usize,
}

impl CoarseToFine {
    /// A detector for some families.
    pub fn new(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            search: AprilTagC::new(families)?,
            searched_px: SEARCHED_PX,
            enough_tags: ENOUGH_TAGS,
        })
    }

    /// A faster one, which misses small tags: it searches a smaller image, and never twice.
    pub fn live(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            searched_px: SEARCHED_LIVE_PX,
            enough_tags: 0,
            ..CoarseToFine::new(families)?
        })
    }

    fn find_reduced(&mut self, luma: &dyn Luma, factor: u32) -> Vec<SeenTag> {
        fitted(reduced_by(luma, factor, |small| self.search.search(small)), luma)
    }
}

impl TagDetector for CoarseToFine {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let [width, height] = luma.size();
        let factor = width.max(height).div_ceil(self.searched_px).max(1);
        let tags = self.find_reduced(luma, factor);
        if factor > 1 && tags.iter().filter(|tag| tag.is_whole).count() < self.enough_tags {
            return self.find_reduced(luma, 1);
        }
        tags
    }
}
