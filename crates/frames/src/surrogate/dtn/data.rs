//! Training data of a network: views of frames, cropped to their paint.

use std::collections::BTreeSet;

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::Architecture;
use crate::surrogate::additive::Additive;
use crate::{Coverage, Frame, FrameSet, FramesError, light, reduced, views};
use scaleproof_core::files;
use scaleproof_core::message::bail;

/// Least width of a reduced image.
pub const LEAST_WIDTH_PX: u32 = 16;
/// Between the paint and the window's edge, where the convolutions see the padding.
const MARGIN_PX: usize = 4;
/// Largest change of a random light's brightness and of each channel, as powers of two.
const EXPOSURE: f64 = 0.7;
const TINT: f64 = 0.2;
/// Every fourth of the views' azimuths, and of the flat colours of frames without linear light, is kept for validation.
const EVERY: usize = 4;
const VALIDATION_COLOURS: usize = 8;

/// Pixels that the paint covers by half or more, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PaintPixels {
    pub at: Vec<[u32; 2]>,
    low: [u32; 2],
    /// Width and height of the box around them.
    size: [usize; 2],
}

impl PaintPixels {
    /// Finds the pixels in a mask.
    pub fn covered(mask: &Coverage) -> Self {
        let covered = mask.enumerate_pixels().filter(|(_, _, p)| p.0[0] >= 128);
        let at: Vec<[u32; 2]> = covered.map(|(x, y, _)| [x, y]).collect();
        let range = |axis: usize| {
            let along = || at.iter().map(|p| p[axis]);
            let low = along().min().unwrap_or(0);
            (low, (along().max().unwrap_or(0) - low) as usize + 1)
        };
        let ((x, width), (y, height)) = (range(0), range(1));
        Self {
            at,
            low: [x, y],
            size: [width, height],
        }
    }
}

/// Input size of the network: of a part of the image, or of more than it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PaintWindow {
    pub width: usize,
    pub height: usize,
}

/// Position of the corner of the paint's box in a window.
#[derive(Debug, Clone, Copy)]
pub(super) struct CropPlacement {
    x: usize,
    y: usize,
    mirrored: bool,
}

impl PaintWindow {
    /// Returns the window that holds any of these with a margin.
    pub(super) fn around(all: &[&PaintPixels]) -> Self {
        let side = |axis: usize| {
            let most = all.iter().map(|p| p.size[axis]).max().unwrap_or(1);
            (most + 2 * MARGIN_PX).next_multiple_of(Architecture::ALIGN_PX)
        };
        Self {
            width: side(0),
            height: side(1),
        }
    }

    /// Returns rows and columns.
    pub(super) fn size(self) -> [usize; 2] {
        [self.height, self.width]
    }

    pub(super) fn pixels(self) -> usize {
        self.width * self.height
    }

    pub(super) fn middle(self, paint: &PaintPixels) -> CropPlacement {
        CropPlacement {
            x: (self.width - paint.size[0]) / 2,
            y: (self.height - paint.size[1]) / 2,
            mirrored: false,
        }
    }

    pub(super) fn anywhere(self, paint: &PaintPixels, rng: &mut impl Rng) -> CropPlacement {
        let mut place = |space: usize| rng.random_range(MARGIN_PX..=space - MARGIN_PX);
        CropPlacement {
            x: place(self.width - paint.size[0]),
            y: place(self.height - paint.size[1]),
            mirrored: rng.random(),
        }
    }

    /// Returns the index of each paint pixel in the window, which is stored row by row.
    pub(super) fn places(self, paint: &PaintPixels, placement: CropPlacement) -> impl Iterator<Item = usize> {
        let low = paint.low;
        paint.at.iter().map(move |[x, y]| {
            let x = (x - low[0]) as usize + placement.x;
            let x = if placement.mirrored { self.width - 1 - x } else { x };
            ((y - low[1]) as usize + placement.y) * self.width + x
        })
    }

    /// Writes the paint's values into an image of the window, channel by channel.
    pub(super) fn fill(self, image: &mut [f32], paint: &PaintPixels, placement: CropPlacement, values: &[[f32; 3]]) {
        for (place, value) in self.places(paint, placement).zip(values) {
            for (channel, v) in value.iter().enumerate() {
                image[channel * self.pixels() + place] = *v;
            }
        }
    }
}

/// View of training data.
#[derive(Debug, Clone)]
pub struct TrainingView {
    place: String,
    azimuth_deg: f64,
    pub paint: PaintPixels,
    light: Option<Additive>,
    /// Of a view without linear light: sRGB 0 to 1 of the paint's pixels in these colours and no other.
    images: Vec<([u8; 3], Vec<[f32; 3]>)>,
}

/// Factor of each channel of all light.
type Exposure = [f64; 3];

fn exposure(rng: &mut impl Rng) -> Exposure {
    let all = rng.random_range(-EXPOSURE..EXPOSURE);
    std::array::from_fn(|_| (all + rng.random_range(-TINT..TINT)).exp2())
}

/// Random light: the view's own, brighter or darker and tinted, and now and then another's of the same pose added to it.
pub(super) struct NewLight<'a> {
    own: Exposure,
    added: Option<(&'a Additive, Exposure)>,
}

impl<'a> NewLight<'a> {
    /// The view's own light, unchanged.
    pub(super) const NONE: Self = Self {
        own: [1.0; 3],
        added: None,
    };

    pub(super) fn random(set: &'a TrainingSet, view: &TrainingView, rng: &mut impl Rng) -> Self {
        let own = exposure(rng);
        let fellows = set.training.iter().filter(|other| view.is_same_pose(other));
        let fellows: Vec<&Additive> = fellows.filter_map(|other| other.light.as_ref()).collect();
        // Drawn in any case, so that a step's later numbers do not depend on the frames.
        let (share, which): (f64, f64) = (rng.random_range(-1.0..1.0), rng.random());
        let other = exposure(rng);
        if fellows.is_empty() || share < 0.0 {
            return Self { own, added: None };
        }
        let fellow = fellows[((which * fellows.len() as f64) as usize).min(fellows.len() - 1)];
        Self {
            own: own.map(|v| v * (1.0 - share)),
            added: Some((fellow, other.map(|v| v * share))),
        }
    }
}

impl TrainingView {
    /// Computes sRGB 0 to 1 of the paint's pixels; `None` for a colour that the view has not. Images without linear light keep their exposure.
    pub(super) fn image(&self, rgb: [u8; 3], new: &NewLight) -> Option<Vec<[f32; 3]>> {
        let Some(additive) = &self.light else {
            let image = self.images.iter().find(|(colour, _)| *colour == rgb);
            return image.map(|(_, pixels)| pixels.clone());
        };
        let mut light = exposed(additive, rgb, new.own);
        if let Some((other, exposure)) = new.added {
            for (sum, more) in light.iter_mut().zip(exposed(other, rgb, exposure)) {
                (0..3).for_each(|c| sum[c] += more[c]);
            }
        }
        Some(light.iter().map(|p| p.map(|v| light::encode(v) as f32)).collect())
    }

    /// Returns true for another image of the same pose, whose light can be added to this one's.
    fn is_same_pose(&self, other: &Self) -> bool {
        let is_of_light = self.light.is_some() && other.light.is_some();
        is_of_light && !std::ptr::eq(self, other) && self.paint == other.paint
    }

    fn colours(&self) -> impl Iterator<Item = [u8; 3]> {
        self.images.iter().map(|(colour, _)| *colour)
    }

    /// Draws a colour to learn from.
    pub(super) fn colour(&self, set: &TrainingSet, rng: &mut impl Rng) -> [u8; 3] {
        if let Some(light) = &self.light {
            return light.between(std::array::from_fn(|_| rng.random()));
        }
        let seen: Vec<[u8; 3]> = self.colours().filter(|c| !set.unseen.contains(c)).collect();
        match seen.len() {
            0 => self.images[0].0,
            count => seen[rng.random_range(0..count)],
        }
    }

    /// Lists the colours to validate in.
    pub(super) fn validation_colours(&self, set: &TrainingSet) -> Vec<[u8; 3]> {
        let Some(light) = &self.light else {
            return self.colours().filter(|c| set.unseen.contains(c)).collect();
        };
        let mut rng = Pcg32::seed_from_u64(77);
        let colour = |_| light.between(std::array::from_fn(|_| rng.random()));
        (0..VALIDATION_COLOURS).map(colour).collect()
    }
}

/// Computes linear light in a colour.
fn exposed(additive: &Additive, rgb: [u8; 3], exposure: Exposure) -> Vec<[f64; 3]> {
    let pixel = |p: &[f32; 3]| std::array::from_fn(|c| f64::from(p[c]) * exposure[c]);
    additive.light(rgb).iter().map(pixel).collect()
}

/// Training and validation views.
#[derive(Debug, Clone)]
pub struct TrainingSet {
    pub training: Vec<TrainingView>,
    pub validation: Vec<TrainingView>,
    /// Difference of the two, in words.
    pub split: String,
    /// Colours of frames without linear light that no step uses.
    unseen: BTreeSet<[u8; 3]>,
    /// SHA-256 of the lists of frames and of how they are used.
    pub sha256: String,
}

impl TrainingSet {
    /// Reads frames, reduced to a width. With `validation`, all views of `folders` are learnt from and those of `validation` are not; without,
    /// the views are divided: validation has the last place and every fourth azimuth, training neither.
    pub fn read(
        folders: &[FrameSet],
        validation: Option<&FrameSet>,
        width_px: u32,
        references: &[[u8; 3]],
        on_view: impl Fn(),
    ) -> Result<Self, FramesError> {
        let sets = folders.iter().chain(validation);
        let mut known: String = sets.map(|set| set.sha256.as_str()).collect();
        let mut all = Vec::new();
        for set in folders {
            all.extend(read(set, width_px, references, &on_view)?);
        }
        known += &format!("{width_px} {references:?} {}", validation.is_some());
        let (training, validation, split) = match validation {
            Some(set) => {
                let other = read(set, width_px, references, &on_view)?;
                (all, other, "frames of their own".to_owned())
            }
            None => divide(all),
        };
        let unseen = unseen(&training, &validation, references);
        Ok(Self {
            training,
            validation,
            split,
            unseen,
            sha256: files::sha256_hex(known.as_bytes()),
        })
    }
}

fn read(
    set: &FrameSet,
    width_px: u32,
    references: &[[u8; 3]],
    on_view: impl Fn(),
) -> Result<Vec<TrainingView>, FramesError> {
    let found = set.list.size_px;
    let factor = found[0].checked_div(width_px).unwrap_or(0);
    if factor == 0 || factor * width_px != found[0] || !found[1].is_multiple_of(factor) {
        let (folder, [width, height]) = (set.folder.display(), found);
        bail!(
            "{folder}: images of {width}×{height} pixels cannot be reduced to a width of {width_px} by a whole factor of both sides; widths that can be \
             had: {}", widths(found);
            hint: "‹width_px› takes one of them"
        );
    }
    let mut all = Vec::new();
    for view in views(&set.list.frames) {
        all.extend(training_view(set, &view, factor, references)?);
        on_view();
    }
    if all.is_empty() {
        let colour = references.first().map(|rgb| light::to_hex(*rgb)).unwrap_or_default();
        bail!(
            "{}: no view has paint, the reference colour {colour} and another flat colour; render flat colours, or name another reference",
            set.folder.display();
            hint: "flat colours are ‹flat› of attack render, the reference is ‹reference›"
        );
    }
    Ok(all)
}

/// Lists the widths that images of a size can be reduced to, for a sentence.
fn widths([width, height]: [u32; 2]) -> String {
    let factors = (1..=width / LEAST_WIDTH_PX).filter(|f| width.is_multiple_of(*f) && height.is_multiple_of(*f));
    let widths: Vec<String> = factors.map(|factor| (width / factor).to_string()).collect();
    widths.join(", ")
}

/// Reads a view; `None` for one without paint or without its colours.
fn training_view(
    set: &FrameSet,
    view: &[&Frame],
    factor: u32,
    references: &[[u8; 3]],
) -> Result<Option<TrainingView>, FramesError> {
    let [width, height] = set.list.size_px;
    let mask = set.paint_mask(view[0])?;
    let levels = mask.pixels().map(|p| [f32::from(p.0[0]); 3]);
    let levels = reduced(levels, width as usize, factor as usize);
    let levels = levels.iter().map(|p| p[0].round() as u8).collect();
    let mask = Coverage::from_raw(width / factor, height / factor, levels).unwrap_or_default();
    let paint = PaintPixels::covered(&mask);
    let of_paint = |linear: &[[f32; 3]]| -> Vec<[f32; 3]> {
        let image = reduced(linear.iter().copied(), width as usize, factor as usize);
        let pixel = |[x, y]: &[u32; 2]| image[(y * (width / factor) + x) as usize];
        paint.at.iter().map(pixel).collect()
    };
    let linear = view.iter().filter(|f| f.linear.is_some() && f.flat_rgb().is_some());
    let has_light = linear.count() >= 3;
    let light = has_light.then(|| Additive::of_view(set, view).ok()).flatten();
    let mut images = Vec::new();
    if light.is_none() {
        for frame in view {
            let Some(rgb) = frame.flat_rgb() else { continue };
            let image = set.rgb(frame)?;
            let linear = image.pixels().map(|p| light::linear_of(p.0).map(|v| v as f32));
            let linear: Vec<_> = linear.collect();
            let srgb = |p: &[f32; 3]| p.map(|v| light::encode(f64::from(v)) as f32);
            images.push((rgb, of_paint(&linear).iter().map(srgb).collect()));
        }
        let has = |rgb: &[u8; 3]| images.iter().any(|(colour, _)| colour == rgb);
        if images.len() < 2 || !references.iter().all(has) {
            return Ok(None);
        }
    }
    let light = light.map(|additive| additive.mapped(of_paint));
    Ok((!paint.at.is_empty()).then(|| TrainingView {
        place: view[0].place.clone(),
        azimuth_deg: set.list.viewpoint(view[0]).azimuth_deg,
        light,
        images,
        paint,
    }))
}

/// Divides views into training and validation; the text says how the two differ.
fn divide(all: Vec<TrainingView>) -> (Vec<TrainingView>, Vec<TrainingView>, String) {
    let places: BTreeSet<String> = all.iter().map(|v| v.place.clone()).collect();
    let azimuths: BTreeSet<i64> = all.iter().map(azimuth_key).collect();
    let place = if places.len() > 1 { places.last().cloned() } else { None };
    // A single azimuth is learnt from.
    let kept: BTreeSet<i64> = azimuths.into_iter().skip(1).step_by(EVERY).collect();
    let split = match (&place, kept.is_empty()) {
        (Some(place), false) => format!("unseen place {place} at unseen azimuths"),
        (Some(place), true) => format!("unseen place {place}"),
        (None, false) => "unseen azimuths, of the only place".to_owned(),
        (None, true) => {
            let split = "the views it learns from, in unseen colours: there is only one place and one azimuth";
            return (all.clone(), all, split.to_owned());
        }
    };
    let (mut training, mut validation) = (Vec::new(), Vec::new());
    for view in all {
        let of_place = place.as_ref().map(|place| view.place == *place);
        let of_azimuth = (!kept.is_empty()).then(|| kept.contains(&azimuth_key(&view)));
        let mut is_kept = of_place.into_iter().chain(of_azimuth);
        if is_kept.clone().all(|kept| kept) {
            validation.push(view);
        } else if !is_kept.any(|kept| kept) {
            training.push(view);
        }
        // Half unseen is neither.
    }
    (training, validation, split)
}

fn azimuth_key(view: &TrainingView) -> i64 {
    (view.azimuth_deg * 100.0).round() as i64
}

/// Chooses the colours kept for validation: every fourth of those that cannot be computed from linear light.
fn unseen(training: &[TrainingView], validation: &[TrainingView], references: &[[u8; 3]]) -> BTreeSet<[u8; 3]> {
    let views = training.iter().chain(validation);
    let colours: BTreeSet<[u8; 3]> = views.flat_map(TrainingView::colours).collect();
    let colours = colours.into_iter().filter(|c| !references.contains(c));
    // A single colour must be learnt from.
    colours.skip(1).step_by(EVERY).collect()
}
