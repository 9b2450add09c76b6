//! The views an attack works on: each with its renderer model, and where the pattern lies in it.

use std::borrow::Cow;

use serde::Serialize;

use super::eot::{Draw, Taken, rolled};
use super::{Rgb, RunError};
use crate::frames::light;
use crate::frames::views;
use crate::frames::{Coverage, Frame, FrameList, FrameSet, outline};
use crate::geometry::BoxPx;
use crate::surrogate::projection::{Grid, Projection, Sampling, repeated, world};
use crate::surrogate::renderer::{Kind, PerPixel, Renderer, Shot};
use crate::workers;

/// Every so many views one is held out, beginning with [`FIRST_HELD_OUT`]; fewer views than that are all trained on.
const HELD_OUT_EVERY: usize = 6;
const FIRST_HELD_OUT: usize = 3;

/// How the pattern is laid on the model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Laying {
    /// As the printed panels are.
    #[default]
    World,
    /// DTA's Repeated Texture Projection.
    Repeated,
}

/// One pose in one light.
#[derive(Debug)]
pub struct View {
    /// Of its first frame.
    pub frame: Frame,
    /// Around the object's mask, corner to corner of the picture's pixels.
    pub outline: BoxPx,
    model: PerPixel,
    place: Place,
}

#[derive(Debug)]
enum Place {
    World(Projection),
    Repeated(Coverage),
}

/// All views, and which are held out.
#[derive(Debug)]
pub struct Stage {
    pub list: FrameList,
    pub grid: Grid,
    pub views: Vec<View>,
    /// Views in which the model or its paint is not seen.
    pub unseen: usize,
}

/// A view with the pattern on, after everything, and the way back to the cells.
pub struct Laid<'a> {
    view: &'a View,
    projection: Cow<'a, Projection>,
    columns: usize,
    shift_tiles: [f64; 2],
    paint: Vec<Rgb>,
    pub taken: Taken,
    /// Where the model is in the taken picture.
    pub outline: BoxPx,
}

impl Stage {
    /// Fits the default renderer model to the flat colours of every view. `on_view` is called after each, from any
    /// thread.
    ///
    /// # Errors
    /// Too few flat colours, no positions for the world-aligned laying, pictures that cannot be read, no view with the
    /// model in it.
    pub fn open(set: &FrameSet, grid: Grid, laying: Laying, on_view: impl Fn() + Sync) -> Result<Self, RunError> {
        let all = views(&set.list.frames);
        let load = |(): &mut (), frames: &Vec<&Frame>| load(set, frames, &grid, laying);
        let loaded = workers::map(&all, || Ok(()), load, on_view)?;
        let count = loaded.len();
        let views: Vec<View> = loaded.into_iter().flatten().collect();
        if views.is_empty() {
            return Err(RunError::NothingSeen);
        }
        Ok(Self {
            list: set.list.clone(),
            grid,
            unseen: count - views.len(),
            views,
        })
    }

    /// Views to train on.
    pub fn trained(&self) -> Vec<usize> {
        (0..self.views.len()).filter(|i| !self.is_held_out(*i)).collect()
    }

    /// Views to judge by: those held out, or all where they are too few to hold any out.
    pub fn judged(&self) -> Vec<usize> {
        match self.holds_out() {
            true => (0..self.views.len()).filter(|i| self.is_held_out(*i)).collect(),
            false => (0..self.views.len()).collect(),
        }
    }

    pub fn holds_out(&self) -> bool {
        self.views.len() >= HELD_OUT_EVERY
    }

    fn is_held_out(&self, view: usize) -> bool {
        self.holds_out() && view % HELD_OUT_EVERY == FIRST_HELD_OUT
    }

    /// A view with a pattern on. `cells`: sRGB, 0 to 1, row by row from the top.
    pub fn lay(&self, view: usize, cells: &[Rgb], draw: &Draw) -> Laid<'_> {
        let view = &self.views[view];
        let columns = self.grid.columns as usize;
        let light: Vec<Rgb> = cells.iter().map(|cell| cell.map(light::decode)).collect();
        let (projection, shift_tiles) = match &view.place {
            Place::World(projection) => (Cow::Borrowed(projection), draw.jitter.shift_tiles),
            // The shift is the projection's own there.
            Place::Repeated(mask) => {
                let (list, frame, nearest) = (&self.list, &view.frame, Sampling::Nearest);
                let laid = repeated::project(list, frame, mask, &self.grid, nearest, &draw.jitter);
                (Cow::Owned(laid), [0.0, 0.0])
            }
        };
        let paint = projection.forward(&rolled(&light, columns, shift_tiles));
        let taken = draw.apply(&view.model.predict(&paint), self.list.size_px);
        Laid {
            outline: draw.moved(&view.outline, self.list.size_px),
            view,
            projection,
            columns,
            shift_tiles,
            paint,
            taken,
        }
    }

    /// A view in any paint (linear reflectance of each pixel), as it is.
    pub fn painted(&self, view: usize, paint: &[Rgb]) -> Vec<Rgb> {
        self.views[view].model.predict(paint)
    }
}

impl Laid<'_> {
    /// From the derivative with respect to the taken picture to that with respect to the cells it was laid with.
    pub fn back(&self, gradient: Vec<Rgb>, cells: &[Rgb]) -> Vec<Rgb> {
        let mut gradient = self.taken.back(gradient);
        for (g, slope) in gradient.iter_mut().zip(self.view.model.slope(&self.paint)) {
            *g = std::array::from_fn(|c| g[c] * slope[c]);
        }
        let gradient = self.projection.transposed(&gradient);
        let mut gradient = rolled(&gradient, self.columns, self.shift_tiles.map(|shift| -shift));
        for (g, cell) in gradient.iter_mut().zip(cells) {
            *g = std::array::from_fn(|c| g[c] * light::decode_slope(cell[c]));
        }
        gradient
    }
}

/// `None` for a view in which the model or its paint is not seen.
fn load(set: &FrameSet, frames: &[&Frame], grid: &Grid, laying: Laying) -> Result<Option<View>, RunError> {
    let frame = frames[0];
    let mask = set.paint_mask(frame)?;
    let Some(seen) = outline(&set.object_mask(frame)?) else {
        return Ok(None);
    };
    if !mask.pixels().any(|p| p.0[0] >= 128) {
        return Ok(None);
    }
    let mut shots = Vec::new();
    for frame in frames {
        if let Some(flat_rgb) = frame.flat_rgb() {
            let picture = set.rgb(frame)?;
            shots.push(Shot { flat_rgb, picture });
        }
    }
    let name = || frame.name.clone();
    let fitted = PerPixel::fit(Kind::default(), &shots);
    let model = fitted.map_err(|reason| RunError::Fit { view: name(), reason })?;
    let place = match laying {
        Laying::Repeated => Place::Repeated(mask),
        Laying::World => {
            let projection = world::project(set, frame, grid, Sampling::Nearest)?;
            Place::World(projection.ok_or_else(|| RunError::NoPositions { view: name() })?)
        }
    };
    // The outline counts from the middle of the first pixel.
    let outline = BoxPx::new(seen.x1 + 0.5, seen.y1 + 0.5, seen.x2 + 0.5, seen.y2 + 0.5);
    Ok(Some(View {
        frame: frame.clone(),
        outline,
        model,
        place,
    }))
}
