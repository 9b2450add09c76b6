//! Default tag detector: several finders in turn, the fastest first, until nothing is missing.
//!
//! The caller reports what is still missing: whether the tags found so far determine a pose, and where that pose predicts further tags. The cascade
//! searches those places before the next finder starts. Dark images are stretched first, and noisy or dull ones searched at half the size.

use std::borrow::Cow;

use image::GrayImage;

use super::apriltag_c::AprilTagC;
use super::expected;
use super::fit::{TagFit, fitted};
use super::legibility::Legibility;
use super::merge::MergedTags;
use super::missing::StillMissing;
use super::search::{Found, Search, Strength, reduced_by};
use super::{SeenTag, StartError, TagDetector, rivals};
use crate::scene::TagFamily;
use scaleproof_photo::{Luma, REDUCTIONS};

/// Maximum long side of searched images, px; larger ones are reduced to it.
const SEARCHED_PX: u32 = 1600;

/// Minimum long side, px, of the smaller image for the first finder: tags that it misses are searched at their predicted positions.
const SMALL_PX: u32 = 800;

/// Minimum long side, px, of an image at half the size: tags in small images have few pixels.
const LEAST_HALF_PX: u32 = 600;

/// Maximum long side of live images, px: the answer must come soon, and the next image brings another chance.
const SEARCHED_LIVE_PX: u32 = 640;

/// Maximum rounds of searches at predicted positions: the tags found improve the pose, which predicts more.
const MOST_LOOKS: usize = 3;

/// Number of whole tags at the positions predicted by the last image's pose that makes a search of a live image unnecessary.
const ENOUGH_LIVE_TAGS: usize = 4;

/// Number of whole tags that likely determine a pose, so that small ones lost in a reduced image are not needed; used if the caller reports nothing
/// missing.
const ENOUGH_TAGS: usize = 2;

/// Detector that runs finders in turn. Holds C memory, so each thread makes its own.
pub struct Cascade {
    stages: Vec<Stage>,
    first: View,
    /// Number of whole tags after which a pose suffices, even if more are predicted; `None` to search for all.
    enough_tags: Option<usize>,
}

/// Finder with the condition under which it runs.
struct Stage {
    search: Box<dyn Search>,
    view: View,
    need: Need,
}

/// Version of the image given to a finder.
#[derive(Clone, Copy, PartialEq)]
enum View {
    /// The image reduced to about this long side, px.
    Reduced(u32),
    /// A large image reduced further.
    Small,
    /// Image at full size, if it is reduced for other finders.
    Whole,
}

/// Condition under which a finder runs.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    /// While tags are missing.
    MissingTags,
    /// While there is no pose: for finders that are slow, or find little among clear tags.
    NoPose,
}

impl Cascade {
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
        Ok(Cascade {
            stages,
            first: View::Small,
            enough_tags: None,
        })
    }

    /// Creates a faster detector, which misses small tags: the fastest finder alone, on a small image.
    pub fn live(families: &[TagFamily]) -> Result<Cascade, StartError> {
        let stage = Stage {
            search: match rivals::finders(Strength::Speed, families)?.into_iter().next() {
                Some(fastest) => fastest,
                None => Box::new(AprilTagC::new(families)?),
            },
            view: View::Reduced(SEARCHED_LIVE_PX),
            need: Need::MissingTags,
        };
        Ok(Cascade {
            first: stage.view,
            stages: vec![stage],
            enough_tags: Some(ENOUGH_LIVE_TAGS),
        })
    }
}

impl Stage {
    /// Searches the stage's view of an image; `None` if another stage has searched the same.
    fn search(&mut self, shown: &Shown) -> Option<Vec<Found>> {
        let factor = shown.factor(self.view)?;
        Some(reduced_by(shown, factor, |small| self.search.search(small)))
    }
}

/// Image as prepared for the finders.
struct Shown<'a> {
    luma: &'a dyn Luma,
    legibility: Legibility,
    /// Reduction factor and pixels of the measured image, reused for the first finder, which mostly searches the same.
    measured: (u32, &'a GrayImage),
}

impl Shown<'_> {
    /// Measures an image as the first finder gets it, stretches it if it is dark, and passes it to `then`.
    fn with<T>(luma: &dyn Luma, first: View, then: impl FnOnce(&Shown) -> T) -> T {
        let [width, height] = luma.size();
        let factor = first.factor(width.max(height), None).unwrap_or(1);
        let measured = luma.reduced(factor);
        let legibility = Legibility::new(&measured);
        let stretched = legibility.is_dark().then(|| legibility.stretched(luma.whole()));
        let (luma, measured) = match &stretched {
            Some(stretched) => (stretched as &dyn Luma, stretched.reduced(factor)),
            None => (luma, measured),
        };
        then(&Shown {
            luma,
            legibility,
            measured: (factor, &measured),
        })
    }

    fn factor(&self, view: View) -> Option<u32> {
        let [width, height] = self.size();
        view.factor(width.max(height), Some(&self.legibility))
    }
}

impl Luma for Shown<'_> {
    fn size(&self) -> [u32; 2] {
        self.luma.size()
    }

    fn whole(&self) -> &GrayImage {
        self.luma.whole()
    }

    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage> {
        let (measured, image) = self.measured;
        if factor == measured {
            Cow::Borrowed(image)
        } else {
            self.luma.reduced(factor)
        }
    }

    fn part(&self, start: [u32; 2], size: [u32; 2]) -> GrayImage {
        self.luma.part(start, size)
    }
}

impl View {
    /// Returns the factor by which an image is reduced for this view, given its legibility if known. `None` if this view shows no more than others
    /// do.
    fn factor(self, longest: u32, known: Option<&Legibility>) -> Option<u32> {
        let reduced = |to_px: u32| {
            let factor = longest.div_ceil(to_px).max(1);
            let is_halved = known.is_some_and(Legibility::is_better_halved) && longest / factor >= 2 * LEAST_HALF_PX;
            if is_halved { 2 * factor } else { factor }
        };
        let small = || REDUCTIONS.into_iter().find(|f| longest / f >= SMALL_PX).unwrap_or(1);
        match self {
            View::Reduced(to_px) => Some(reduced(to_px)),
            View::Small if longest <= SEARCHED_PX => Some(reduced(SEARCHED_PX)),
            View::Small => Some(small().max(reduced(SEARCHED_PX))),
            View::Whole if reduced(SEARCHED_PX) == 1 => None,
            View::Whole if longest <= SEARCHED_PX && known.is_some_and(Legibility::is_dull) => None,
            View::Whole => Some(1),
        }
    }
}

impl TagDetector for Cascade {
    /// Finds tags without knowing which are missing: all finders run, the slow ones only if almost nothing is found.
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        Shown::with(luma, self.first, |shown| {
            let mut tags = MergedTags::default();
            for need in [Need::MissingTags, Need::NoPose] {
                for stage in self.stages.iter_mut().filter(|stage| stage.need == need) {
                    tags.add(stage.search(shown).unwrap_or_default(), shown);
                }
                if tags.seen().iter().filter(|tag| tag.is_whole).count() >= ENOUGH_TAGS {
                    break;
                }
            }
            tags.seen()
        })
    }

    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        let mut tags = MergedTags::default();
        let (mut seen, mut left) = looked(&mut tags, luma, missing);
        let enough_tags = self.enough_tags;
        let is_done = |seen: &[SeenTag], left: &StillMissing| {
            let whole = seen.iter().filter(|tag| tag.is_whole).count();
            // A lone tag of another size than the scene's fits as well, and then predicts the others in wrong places.
            let is_lone = whole < 2;
            let is_enough = enough_tags.is_some_and(|enough| whole >= enough);
            left.has_pose && !is_lone && (is_enough || !left.expected.iter().any(|tag| tag.is_in_plain_view))
        };
        if is_done(&seen, &left) {
            return seen;
        }
        Shown::with(luma, self.first, |shown| {
            for stage in &mut self.stages {
                if is_done(&seen, &left) {
                    break;
                }
                if stage.need == Need::NoPose && left.has_pose {
                    continue;
                }
                if let Some(found) = stage.search(shown) {
                    tags.add(found, shown);
                    (seen, left) = looked(&mut tags, shown, missing);
                }
            }
            seen
        })
    }
}

/// Searches for missing tags at their predicted positions, until nothing more is found.
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

/// Returns the tags to rely on and what they leave missing: all tags, or only those with fitted corners if these determine a pose and all together do
/// not. A single fitted tag is never preferred to the others, which may be right.
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

/// Detector by C AprilTag on a reduced image, with fitted corners. Holds C memory, so each thread makes its own.
pub struct CoarseToFine {
    search: AprilTagC,
    searched_px: u32,
    /// Number of whole tags below which the image is searched again at full size.
    enough_tags: usize,
}

impl CoarseToFine {
    pub fn new(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            search: AprilTagC::new(families)?,
            searched_px: SEARCHED_PX,
            enough_tags: ENOUGH_TAGS,
        })
    }

    /// Creates a faster detector, which misses small tags: it searches a smaller image, and never twice.
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
