//! Renderer models against each other on the same frames: error in colours none of them has seen, against milliseconds.

use std::time::Instant;

use image::RgbImage;
use serde::Serialize;

use super::additive::views;
use super::frames::{Coverage, Frame, FrameSet, FramesError};
use super::light;
use super::projection::{Grid, Projection, Sampling, repeated, world};
use super::renderer::{FitError, Kind, PerPixel, Renderer, Shot};
use crate::plot::{Axis, Cloud, Dot, Scale, scatter};

/// Why there is no chart.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(
        "the view of {frame} has no frame in the reference colour {colour}; render it, or give other colours with --reference"
    )]
    NoReference { frame: String, colour: String },
    #[error("no view has a flat colour besides the references; without one there is nothing to predict")]
    NothingToPredict,
}

/// One model with so many reference colours, over all views.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub model: Kind,
    pub references: usize,
    pub views: usize,
    /// Frames predicted: flat colours the model has not seen.
    pub frames: usize,
    /// Mean squared error in sRGB, 0 to 1, over the pixels that the paint covers by half or more, and over the whole picture.
    pub mse_paint: f64,
    pub mse_picture: f64,
    /// The largest mean squared error over the paint of one frame.
    pub mse_paint_worst: f64,
    /// Mean exponent of the fitted tone curve.
    pub tone_power: Option<f64>,
    /// The mean over the paint of frames with a pattern, world-aligned, and by Repeated Texture Projection.
    pub mse_pattern_world: Option<f64>,
    pub mse_pattern_repeated: Option<f64>,
    /// One thread, per view and per frame.
    pub fit_ms: f64,
    pub predict_ms: f64,
}

/// Sums of squared errors on their way to means.
#[derive(Default)]
struct Sums {
    paint: Mean,
    picture: Mean,
    worst: f64,
    world: Mean,
    repeated: Mean,
    power: Mean,
    fit_ms: Mean,
    predict_ms: Mean,
    views: usize,
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn get(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// What of a view every model is measured on.
struct View {
    mask: Coverage,
    shots: Vec<Shot>,
    /// Unseen flat colours.
    tests: Vec<Shot>,
    patterns: Vec<PatternTest>,
}

struct PatternTest {
    picture: RgbImage,
    world: Option<Vec<[f64; 3]>>,
    repeated: Vec<[f64; 3]>,
}

/// Measures every model with the first two, three, … of the reference colours. `on_view` is called after each view.
///
/// # Errors
/// A view without a reference colour, nothing to predict, pictures that cannot be read.
pub fn measure(set: &FrameSet, references: &[[u8; 3]], on_view: impl Fn()) -> Result<Vec<Row>, ChartError> {
    let methods: Vec<(Kind, usize)> = Kind::ALL
        .into_iter()
        .flat_map(|kind| (kind.least_shots()..=references.len()).map(move |count| (kind, count)))
        .collect();
    let mut sums: Vec<Sums> = methods.iter().map(|_| Sums::default()).collect();
    for frames in views(&set.list.frames) {
        let view = load(set, &frames, references)?;
        for ((kind, count), sums) in methods.iter().zip(&mut sums) {
            add(*kind, &view, *count, sums)?;
        }
        on_view();
    }
    let rows = methods.into_iter().zip(sums).map(|((model, references), s)| {
        Some(Row {
            model,
            references,
            views: s.views,
            frames: s.paint.count,
            mse_paint: s.paint.get()?,
            mse_picture: s.picture.get()?,
            mse_paint_worst: s.worst,
            tone_power: s.power.get(),
            mse_pattern_world: s.world.get(),
            mse_pattern_repeated: s.repeated.get(),
            fit_ms: s.fit_ms.get()?,
            predict_ms: s.predict_ms.get()?,
        })
    });
    rows.collect::<Option<Vec<_>>>().ok_or(ChartError::NothingToPredict)
}

fn load(set: &FrameSet, frames: &[&Frame], references: &[[u8; 3]]) -> Result<View, ChartError> {
    let first = frames[0];
    let mask = set.paint_mask(first)?;
    let shot = |frame: &Frame, flat_rgb: [u8; 3]| -> Result<Shot, FramesError> {
        Ok(Shot {
            flat_rgb,
            picture: set.rgb(frame)?,
        })
    };
    let mut shots = Vec::new();
    for colour in references {
        let found = frames.iter().find(|f| f.flat_rgb() == Some(*colour));
        let frame = found.ok_or_else(|| ChartError::NoReference {
            frame: first.name.clone(),
            colour: light::to_hex(*colour),
        })?;
        shots.push(shot(frame, *colour)?);
    }
    let (mut tests, mut patterns) = (Vec::new(), Vec::new());
    for frame in frames {
        if let Some(rgb) = frame.flat_rgb().filter(|rgb| !references.contains(rgb)) {
            tests.push(shot(frame, rgb)?);
        }
        if let Some((pattern, tile_mm)) = set.pattern(frame)? {
            let grid = Grid::of(&pattern, tile_mm);
            let cells: Vec<[f64; 3]> = pattern.cells().pixels().map(|p| light::linear_of(p.0)).collect();
            let laid = |projection: Projection| projection.forward(&cells);
            let calibrated = &repeated::Jitter::NONE;
            patterns.push(PatternTest {
                picture: set.rgb(frame)?,
                world: world::project(set, frame, &grid, Sampling::Nearest)?.map(laid),
                repeated: laid(repeated::project(
                    &set.list,
                    frame,
                    &mask,
                    &grid,
                    Sampling::Nearest,
                    calibrated,
                )),
            });
        }
    }
    Ok(View {
        mask,
        shots,
        tests,
        patterns,
    })
}

fn add(kind: Kind, view: &View, count: usize, sums: &mut Sums) -> Result<(), ChartError> {
    let (model, ms) = fastest(|| PerPixel::fit(kind, &view.shots[..count]));
    let model = model?;
    sums.fit_ms.add(ms);
    sums.views += 1;
    if let Some(tone) = model.tone() {
        sums.power.add(tone.power);
    }
    for test in &view.tests {
        let paint = vec![light::linear_of(test.flat_rgb); view.mask.len()];
        let (predicted, ms) = fastest(|| model.predict(&paint));
        sums.predict_ms.add(ms);
        let (on_paint, all) = mse(&predicted, &test.picture, &view.mask);
        sums.picture.add(all);
        if let Some(on_paint) = on_paint {
            sums.paint.add(on_paint);
            sums.worst = sums.worst.max(on_paint);
        }
    }
    for test in &view.patterns {
        let on_paint = |paint: &Vec<[f64; 3]>| mse(&model.predict(paint), &test.picture, &view.mask).0;
        if let Some(error) = test.world.as_ref().and_then(on_paint) {
            sums.world.add(error);
        }
        if let Some(error) = on_paint(&test.repeated) {
            sums.repeated.add(error);
        }
    }
    Ok(())
}

/// The result of some work, and the milliseconds the fastest of three runs took: what else the machine does only ever adds.
fn fastest<R>(work: impl Fn() -> R) -> (R, f64) {
    let run = || {
        let start = Instant::now();
        let result = work();
        (result, start.elapsed().as_secs_f64() * 1e3)
    };
    let (result, first) = run();
    (result, first.min(run().1).min(run().1))
}

/// Mean squared error over the pixels the paint covers by half or more (`None` without such pixels), and over all.
pub fn mse(predicted: &[[f64; 3]], picture: &RgbImage, mask: &Coverage) -> (Option<f64>, f64) {
    let (mut paint, mut all) = (Mean::default(), Mean::default());
    for ((p, truth), covered) in predicted.iter().zip(picture.pixels()).zip(mask.pixels()) {
        // A prediction becomes a picture of 8 bits, too, but what is measured is the model.
        for (value, level) in p.iter().zip(truth.0) {
            let error = (value - f64::from(level) / 255.0).powi(2);
            all.add(error);
            if covered.0[0] >= 128 {
                paint.add(error);
            }
        }
    }
    (paint.get(), all.get().unwrap_or(0.0))
}

/// Lines of text, the most accurate first.
pub fn table(rows: &[Row]) -> String {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| a.mse_paint.total_cmp(&b.mse_paint));
    let mut text = format!(
        "{:<16} {:>7} {:>10} {:>10} {:>10} {:>6} {:>10} {:>10} {:>8} {:>8}\n",
        "model", "colours", "MSE paint", "worst", "picture", "power", "world", "repeated", "fit ms", "ms"
    );
    let or_dash = |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
    for row in sorted {
        text += &format!(
            "{:<16} {:>7} {:>10.6} {:>10.6} {:>10.6} {:>6} {:>10} {:>10} {:>8.1} {:>8.2}\n",
            row.model.name(),
            row.references,
            row.mse_paint,
            row.mse_paint_worst,
            row.mse_picture,
            or_dash(row.tone_power, 2),
            or_dash(row.mse_pattern_world, 5),
            or_dash(row.mse_pattern_repeated, 5),
            row.fit_ms,
            row.predict_ms,
        );
    }
    text
}

/// The chart: colours for models, shapes for the number of reference colours.
pub fn draw(rows: &[Row]) -> String {
    let counts: Vec<usize> = {
        let mut counts: Vec<usize> = rows.iter().map(|r| r.references).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    };
    let dot = |row: &Row| Dot {
        x: row.predict_ms,
        y: row.mse_paint,
        share: 1.0,
        series: Kind::ALL.iter().position(|k| *k == row.model).unwrap_or(0),
        shape: counts.iter().position(|n| *n == row.references).unwrap_or(0),
        name: None,
        is_default: row.model == Kind::default() && Some(&row.references) == counts.last(),
    };
    let frames = rows.first().map_or(0, |row| row.frames);
    scatter(&Cloud {
        title: "Renderer models: error in unseen colours against time".to_owned(),
        note: format!("{frames} frames; mean squared error over the paint, sRGB 0 to 1; lower left is better"),
        x: Axis::around(
            "milliseconds a frame, one core",
            Scale::Log,
            rows.iter().map(|r| r.predict_ms),
        ),
        y: Axis::around("MSE", Scale::Log, rows.iter().map(|r| r.mse_paint)),
        colours: Kind::ALL.map(|k| k.name().to_owned()).to_vec(),
        shapes: counts.iter().map(|n| format!("{n} colours")).collect(),
        groups: vec![(String::new(), rows.iter().map(dot).collect())],
    })
}
