//! The default: several finders one after the other, the fastest first, until nothing is missing.
//!
//! The caller says what the tags found so far leave open: whether they make a pose, and where that pose expects tags that were not found. The
//! cascade looks for those in their places before the next finder starts. Dark images are stretched first, and noisy or dull ones searched at half the size.

use std::borrow::Cow;

use image::GrayImage;

use super::apriltag_c::AprilTagC;
use super::expected::{self, StillMissing};
use super::fit::{TagFit, fitted};
use super::legibility::Legibility;
use super::merge::MergedTags;
use super::search::{Found, Search, Strength, reduced_by};
use super::{SeenTag, StartError, TagDetector, rivals};
use crate::scene::TagFamily;
use scaleproof_photo::photo::{Luma, REDUCTIONS};

/// Images of at most this long side are searched as they are, larger ones reduced to it at most.
const SEARCHED_PX: u32 = 1600;

/// The first finder is shown the larger ones still smaller, at least this long: tags that it misses are looked for where the pose expects them.
const SMALL_PX: u32 = 800;

/// No image is searched at half the size where that leaves less, px of its long side: tags in small images have few pixels.
const LEAST_HALF_PX: u32 = 600;

/// Live images are reduced to at most this long side, px: the answer must come soon, and the next image brings another chance.
const SEARCHED_LIVE_PX: u32 = 640;

/// Tags that are found in their places make a better pose, which tells more places; so often at most.
const MOST_LOOKS: usize = 3;

/// With so many whole tags where the last image's pose expects them, a live image's pose is as good as one that a search makes.
const ENOUGH_LIVE_TAGS: usize = 4;

/// With so many whole tags a pose is likely beyond doubt, and small ones that a reduced image hides are not missed: where nobody says what is missing.
const ENOUGH_TAGS: usize = 2;

/// Finders in turn. Holds C memory, so each thread makes its own.
pub struct Cascade {
    stages: Vec<Stage>,
    first: View,
    /// A pose by so many whole tags is enough, whatever else is expected; `None` where all is looked for.
    enough_tags: Option<usize>,
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
        Ok(Cascade {
            first: stage.view,
            stages: vec![stage],
            enough_tags: Some(ENOUGH_LIVE_TAGS),
        })
    }
}

impl Stage {
    /// `None` where it would be shown what others have been shown.
    fn search(&mut self, shown: &Shown) -> Option<Vec<Found>> {
        let factor = shown.factor(self.view)?;
        Some(reduced_by(shown, factor, |small| self.search.search(small)))
    }
}

/// An image as the finders are shown it.
struct Shown<'a> {
    luma: &'a dyn Luma,
    legibility: Legibility,
    /// What was measured, and its factor: the first finder is mostly shown the same.
    measured: (u32, &'a GrayImage),
}

impl Shown<'_> {
    /// Measures an image as the first finder is shown it, stretches it where it is dark, and hands it on.
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
    /// By how much an image is reduced for it, as far as is known how legible it is. `None` where this view shows no more than others do.
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
    /// Without a scene it is not known what is missing: all finders run, the slow ones only where almost nothing is found.
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
            // A lone tag of another size than the scene's fits as well, and then expects the others elsewhere.
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
