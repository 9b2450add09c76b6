//! The views an attack works on, each with its surrogate renderer and its texture projection.

use std::borrow::Cow;

use rand::SeedableRng;
use rand_pcg::Pcg32;
use serde::Serialize;

use super::augmentation::{Augmentation, AugmentedImage, Eot, rolled};
use super::cells::Rgb;
use crate::AttackError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, message};
use scaleproof_core::workers;
use scaleproof_frames::surrogate::projection::world::{self, Misplacement};
use scaleproof_frames::surrogate::projection::{Grid, Projection, repeated};
use scaleproof_frames::surrogate::renderer::{ClosedForm, FlatImage, PerPixel, Renderer};
use scaleproof_frames::{Coverage, Frame, FrameList, FrameSet, light, outline, views};
use scaleproof_gradients::{WhiteBox, WhiteBoxError};
use scaleproof_surface::pattern::world_aligned::Side;

/// Every Nth view is held out, beginning with [`FIRST_HELD_OUT`], and of 24 views or more at least [`ENOUGH_HELD_OUT`]; fewer views than N are all
/// trained on.
const HELD_OUT_EVERY: usize = 6;
const FIRST_HELD_OUT: usize = 3;
/// The figures of fewer held-out views say little.
pub const ENOUGH_HELD_OUT: usize = 12;

/// Mapping of the pattern onto the model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TextureMapping {
    /// World-aligned, as on the printed panels.
    #[default]
    World,
    /// World-aligned, as on the printed panels, with a pattern of its own for each side of the model.
    Sides,
    /// DTA's Repeated Texture Projection.
    Repeated,
}

impl TextureMapping {
    /// All mappings, the default first.
    pub const ALL: [Self; 3] = [Self::World, Self::Sides, Self::Repeated];

    /// Returns the name in files and options.
    pub fn name(self) -> &'static str {
        ["world", "sides", "repeated"][self as usize]
    }

    /// Returns columns and rows of a pattern with `cells` along a side: the sides' patterns lie below each other, in the order left, right, roof, front,
    /// rear, bottom.
    pub fn grid(self, cells: u32) -> [u32; 2] {
        match self {
            Self::Sides => [cells, Side::ALL.len() as u32 * cells],
            Self::World | Self::Repeated => [cells, cells],
        }
    }

    /// Returns the usual augmentation, with the shift and size of the texture where this mapping leaves them open.
    pub fn usual_eot(self) -> Eot {
        match self {
            Self::World | Self::Sides => Eot::USUAL,
            Self::Repeated => Eot {
                shift_tiles: 0.5,
                tile_scale: 0.25,
                ..Eot::USUAL
            },
        }
    }
}

/// One pose in one light.
#[derive(Debug)]
pub struct SurrogateView {
    /// The first frame of the view: its pose, light and masks.
    pub frame: Frame,
    /// Index of its frame list.
    list: usize,
    /// Around the object's mask, corner to corner of the image's pixels.
    pub outline: BoxPx,
    /// Share of each pixel that the object covers, 0 to 1.
    object: Vec<f32>,
    /// The fitted renderers, the default form first.
    renderers: Vec<PerPixel>,
    place: Place,
}

#[derive(Debug)]
enum Place {
    /// The true one, and others that are misplaced.
    World(Vec<Projection>),
    Repeated(Coverage),
}

/// Misplaced patterns of a view besides the true one, where the augmentation misplaces patterns.
const MISPLACED: usize = 3;

/// Picks one of a choice, by a share (0 to 1) of it.
fn picked<T>(choice: &[T], share: f64) -> &T {
    &choice[((share * choice.len() as f64) as usize).min(choice.len() - 1)]
}

/// Views of an attack, some of them held out.
#[derive(Debug)]
pub struct ViewSet {
    /// The frames that the views are of: a list for each car or render.
    lists: Vec<FrameList>,
    /// Cells of the pattern.
    pub grid: Grid,
    /// The views, with their surrogates fitted.
    pub views: Vec<SurrogateView>,
    /// Views in which the model or its paint is not seen.
    pub unseen: usize,
}

/// Augmented image of a view with the pattern on the model, and its vector–Jacobian product.
pub struct TexturedView<'a> {
    view: &'a SurrogateView,
    renderer: &'a PerPixel,
    projection: Cow<'a, Projection>,
    columns: usize,
    shift_tiles: [f64; 2],
    paint: Vec<Rgb>,
    /// True when the background is of another view.
    has_other_background: bool,
    pub augmented: AugmentedImage,
    /// Box of the model in the augmented image.
    pub outline: BoxPx,
}

impl ViewSet {
    /// Fits the default surrogate renderer to the flat colours of every view, and prepares what `eot` will draw from: the other closed forms, and
    /// misplaced patterns. Views without the model are left out. `on_view` is called after each, from any thread.
    pub fn open(
        sets: &[FrameSet],
        grid: Grid,
        mapping: TextureMapping,
        eot: &Eot,
        on_view: impl Fn() + Sync,
    ) -> Result<Self, AttackError> {
        let of_set = |list: usize| {
            let views = views(&sets[list].list.frames).into_iter();
            views.map(move |frames| (list, frames))
        };
        let all: Vec<_> = (0..sets.len()).flat_map(of_set).enumerate().collect();
        let load = |(): &mut (), (view, (list, frames)): &(usize, (usize, Vec<&Frame>))| {
            load(*list, &sets[*list], *view, frames, &grid, mapping, eot)
        };
        let loaded = workers::map(&all, || Ok(()), load, on_view)?;
        let count = loaded.len();
        let views: Vec<SurrogateView> = loaded.into_iter().flatten().collect();
        if views.is_empty() {
            return Err(AttackError::NothingSeen);
        }
        Ok(Self {
            lists: sets.iter().map(|set| set.list.clone()).collect(),
            grid,
            unseen: count - views.len(),
            views,
        })
    }

    /// Lists the views to train on.
    pub fn trained(&self) -> Vec<usize> {
        (0..self.views.len()).filter(|i| !self.is_held_out(*i)).collect()
    }

    /// Lists the views to judge by: those held out, or all where they are too few to hold any out.
    pub fn judged(&self) -> Vec<usize> {
        let is_judged = |i: &usize| !self.holds_out() || self.is_held_out(*i);
        (0..self.views.len()).filter(is_judged).collect()
    }

    /// Returns true when some views are held out of the optimisation.
    pub fn holds_out(&self) -> bool {
        self.views.len() >= HELD_OUT_EVERY
    }

    fn is_held_out(&self, view: usize) -> bool {
        let every = match self.views.len() / ENOUGH_HELD_OUT {
            0 | 1 => HELD_OUT_EVERY,
            every => every.min(HELD_OUT_EVERY),
        };
        self.holds_out() && view % every == FIRST_HELD_OUT % every
    }

    /// Returns the index of a view's frame set.
    pub fn set_of(&self, view: usize) -> usize {
        self.views[view].list
    }

    /// Returns width and height of a view's image, px.
    pub fn size_px(&self, view: usize) -> [u32; 2] {
        self.lists[self.views[view].list].size_px
    }

    /// Predicts a view with a pattern on the model, augmented. `cells`: sRGB, 0 to 1, row by row from the top.
    pub fn textured(&self, view: usize, cells: &[Rgb], draw: &Augmentation) -> TexturedView<'_> {
        let size_px = self.size_px(view);
        let view = &self.views[view];
        let columns = self.grid.columns as usize;
        let light: Vec<Rgb> = cells.iter().map(|cell| cell.map(light::decode)).collect();
        let (projection, shift_tiles) = match &view.place {
            Place::World(choice) => (Cow::Borrowed(picked(choice, draw.laid)), draw.jitter.shift_tiles),
            // The shift is the projection's own there.
            Place::Repeated(mask) => {
                let list = &self.lists[view.list];
                let textured = repeated::project(list, &view.frame, mask, &self.grid, &draw.jitter);
                (Cow::Owned(textured), [0.0, 0.0])
            }
        };
        let paint = projection.forward(&rolled(&light, columns, shift_tiles));
        let renderer = picked(&view.renderers, draw.renderer);
        let mut image = renderer.predict(&paint);
        let mut exchange = |background| self.exchange(&mut image, view, background);
        let has_other_background = draw.background.is_some_and(&mut exchange);
        let augmented = draw.apply(&image, size_px);
        TexturedView {
            outline: draw.moved(&view.outline, size_px),
            view,
            renderer,
            projection,
            columns,
            shift_tiles,
            paint,
            has_other_background,
            augmented,
        }
    }

    /// Puts the surroundings of another view behind the object: its image turned by half its width, so that the object there is cut in two and
    /// out of the way. `which`: a share of all views. False for one of another size, which changes nothing.
    fn exchange(&self, image: &mut [Rgb], view: &SurrogateView, which: f64) -> bool {
        let other = &self.views[(which * self.views.len() as f64) as usize % self.views.len()];
        let [size, size_of_other] = [view, other].map(|view| self.lists[view.list].size_px);
        if size_of_other != size {
            return false;
        }
        let width = size[0] as usize;
        let behind = other.renderers[0].predict(&vec![[0.2; 3]; other.object.len()]);
        for (i, (pixel, object)) in image.iter_mut().zip(&view.object).enumerate() {
            let (row, column) = (i / width, i % width);
            let behind = behind[row * width + (column + width / 2) % width];
            let object = f64::from(*object);
            *pixel = std::array::from_fn(|c| object * pixel[c] + (1.0 - object) * behind[c]);
        }
        true
    }

    /// Creates the error of a detector that could not look at a view.
    pub(super) fn forward_pass_failed(
        &self,
        view: usize,
        detector: &dyn WhiteBox,
        reason: WhiteBoxError,
    ) -> AttackError {
        let (detector, view) = (detector.name(), &self.views[view].frame.name);
        message!("{detector} cannot look at the view of {view}: {reason}")
            .caused_by(reason)
            .into()
    }

    /// Creates the error of a detector's answer that is not a number.
    pub(super) fn not_a_number(&self, view: usize, detector: &dyn WhiteBox, step: u32) -> AttackError {
        AttackError::NotANumber {
            detector: detector.name().to_owned(),
            view: self.views[view].frame.name.clone(),
            step,
        }
    }

    /// Predicts a view in any paint (linear reflectance of each pixel), without augmentation.
    pub fn painted(&self, view: usize, paint: &[Rgb]) -> Vec<Rgb> {
        self.views[view].renderers[0].predict(paint)
    }
}

impl TexturedView<'_> {
    /// Converts the gradient with respect to the augmented image to that with respect to the cells of its texture.
    pub fn vjp(&self, gradient: Vec<Rgb>, cells: &[Rgb]) -> Vec<Rgb> {
        let mut gradient = self.augmented.vjp(gradient);
        if self.has_other_background {
            for (g, object) in gradient.iter_mut().zip(&self.view.object) {
                *g = g.map(|v| v * f64::from(*object));
            }
        }
        for (g, derivative) in gradient.iter_mut().zip(self.renderer.derivative(&self.paint)) {
            *g = std::array::from_fn(|c| g[c] * derivative[c]);
        }
        let gradient = self.projection.transposed(&gradient);
        let mut gradient = rolled(&gradient, self.columns, self.shift_tiles.map(|shift| -shift));
        for (g, cell) in gradient.iter_mut().zip(cells) {
            *g = std::array::from_fn(|c| g[c] * light::decode_derivative(cell[c]));
        }
        gradient
    }
}

/// Creates the error of a frame without positions.
pub(crate) fn no_positions(frame: &Frame) -> Message {
    message!(
        "{} does not say where its paint is on the model: make the frames with attack render, or repeat the pattern over a plane that faces the camera",
        frame.name
    )
    .hint("‹laying› repeated repeats it so")
}

/// Reads a view; `None` for one in which the model or its paint is not seen.
fn load(
    list: usize,
    set: &FrameSet,
    view: usize,
    frames: &[&Frame],
    grid: &Grid,
    mapping: TextureMapping,
    eot: &Eot,
) -> Result<Option<SurrogateView>, AttackError> {
    let frame = frames[0];
    let mask = set.paint_mask(frame)?;
    let object = set.object_mask(frame)?;
    let Some(seen) = outline(&object) else {
        return Ok(None);
    };
    if !mask.pixels().any(|p| p.0[0] >= 128) {
        return Ok(None);
    }
    let flats = frames.iter().map(|frame| FlatImage::read(set, frame));
    let flats: Vec<FlatImage> = flats.filter_map(Result::transpose).collect::<Result<_, _>>()?;
    let default = ClosedForm::default();
    let failed = |reason| message!("the view of {}: {reason}", frame.name).caused_by(reason);
    let mut renderers = vec![PerPixel::fit(default, &flats).map_err(failed)?];
    if eot.any_renderer {
        let others = ClosedForm::ALL.into_iter().filter(|form| *form != default);
        renderers.extend(others.filter_map(|form| PerPixel::fit(form, &flats).ok()));
    }
    let place = match mapping {
        TextureMapping::Repeated => Place::Repeated(mask),
        TextureMapping::World | TextureMapping::Sides => {
            let of_sides = mapping == TextureMapping::Sides;
            // The true place, and others for the view of this number, the same in every run.
            let mut rng = Pcg32::seed_from_u64(view as u64);
            let mut places = vec![Misplacement::NONE];
            if eot.misplaces() {
                places.extend((0..MISPLACED).map(|_| eot.misplaced(&mut rng)));
            }
            let projections = world::project(set, frame, grid, of_sides, &places)?;
            Place::World(projections.ok_or_else(|| no_positions(frame))?)
        }
    };
    // The outline counts from the middle of the first pixel.
    let outline = BoxPx::new(seen.x1 + 0.5, seen.y1 + 0.5, seen.x2 + 0.5, seen.y2 + 0.5);
    Ok(Some(SurrogateView {
        frame: frame.clone(),
        list,
        object: object.pixels().map(|p| f32::from(p.0[0]) / 255.0).collect(),
        outline,
        renderers,
        place,
    }))
}
