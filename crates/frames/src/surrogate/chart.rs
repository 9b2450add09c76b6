//! Surrogate renderers compared on the same frames: error in colours none of them has seen, against milliseconds.

use image::RgbImage;
use serde::Serialize;

use crate::surrogate::dtn::trained::DtnNetwork;
use crate::surrogate::projection::{Grid, Projection, repeated, world};
use crate::surrogate::renderer::{ClosedForm, FlatImage, PerPixel, Renderer};
use crate::{Coverage, Frame, FrameSet, FramesError, light, views};
use scaleproof_core::message::{Message, message};
use scaleproof_core::workers::fastest;
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, distinct, scatter};

/// One model with so many reference colours, over all views.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SurrogateFigures {
    /// The name of a closed form or of a network.
    pub model: String,
    /// Training time of a network, s; `null` for closed forms.
    pub training_seconds: Option<f64>,
    /// Images of the view it is given.
    pub references: usize,
    /// Colours a network was trained to start from, any one of which it is given; `null` for closed forms.
    pub trained_references: Option<usize>,
    /// Views that were predicted.
    pub views: usize,
    /// Frames predicted: flat colours the model has not seen.
    pub frames: usize,
    /// Mean squared error in sRGB, 0 to 1, over the pixels that the paint covers by half or more.
    pub mse_paint: f64,
    /// Mean squared error in sRGB, 0 to 1, over the whole image.
    #[serde(rename = "mse_picture")]
    pub mse_image: f64,
    /// The largest mean squared error over the paint of one frame.
    pub mse_paint_worst: f64,
    /// Mean exponent of the fitted tone curve; `null` where none is fitted.
    pub tone_power: Option<f64>,
    /// Mean squared error over the paint of frames with a pattern, by the world-aligned projection; `null` without them.
    pub mse_pattern_world: Option<f64>,
    /// Mean squared error over the paint of frames with a pattern, by Repeated Texture Projection; `null` without them.
    pub mse_pattern_repeated: Option<f64>,
    /// Time per view; closed forms use one thread. A network's fit is its forward pass through the view.
    pub fit_ms: f64,
    /// Time per frame.
    pub predict_ms: f64,
}

/// Measurements of a method, view by view and frame by frame.
#[derive(Default)]
struct Measured {
    paint: Vec<f64>,
    image: Vec<f64>,
    world: Vec<f64>,
    repeated: Vec<f64>,
    power: Vec<f64>,
    fit_ms: Vec<f64>,
    predict_ms: Vec<f64>,
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Images of a view that every model is measured on.
struct View {
    mask: Coverage,
    flats: Vec<FlatImage>,
    /// Images in unseen flat colours.
    tests: Vec<FlatImage>,
    patterns: Vec<PatternTest>,
}

struct PatternTest {
    image: RgbImage,
    world: Option<Vec<[f64; 3]>>,
    repeated: Vec<[f64; 3]>,
}

/// Fitted model, its tone curve's exponent, and the time of the fit, ms.
type Fitted = Result<(Box<dyn Renderer>, Option<f64>, f64), FramesError>;

/// A model and the images that it is given.
enum Method<'a> {
    /// A closed form, and the number of references, from the first on.
    ClosedForm(ClosedForm, usize),
    /// A network, and the index of its reference.
    Network(&'a DtnNetwork, usize),
}

impl<'a> Method<'a> {
    /// Gives a network the first of these references that it was trained to start from.
    fn trained(network: &'a DtnNetwork, references: &[[u8; 3]]) -> Result<Self, Message> {
        let wanted = &network.references;
        let found = wanted.iter().find_map(|rgb| references.iter().position(|r| r == rgb));
        let reference = found.ok_or_else(|| {
            let wanted = Vec::from_iter(wanted.iter().map(|rgb| light::to_hex(*rgb))).join(" or ");
            let network = network.architecture.name();
            message!("the network {network} starts from {wanted}, which is not among the references; add it")
                .hint("the references are ‹reference›")
        })?;
        Ok(Self::Network(network, reference))
    }

    fn fit(&self, view: &View) -> Fitted {
        match *self {
            Self::ClosedForm(kind, references) => {
                let (model, ms) = fastest(|| PerPixel::fit(kind, &view.flats[..references]));
                let model = model?;
                let power = model.tone().map(|tone| tone.power);
                Ok((Box::new(model), power, ms))
            }
            Self::Network(network, reference) => {
                let (model, ms) = fastest(|| network.view(&view.flats[reference].image, &view.mask));
                Ok((Box::new(model), None, ms))
            }
        }
    }
}

/// Measures every closed form with the first two, three, … of the reference colours, and the networks with one of them. `on_view` is called
/// after each view.
pub fn measure(
    set: &FrameSet,
    references: &[[u8; 3]],
    networks: &[DtnNetwork],
    on_view: impl Fn(),
) -> Result<Vec<SurrogateFigures>, FramesError> {
    let closed = ClosedForm::ALL.into_iter().flat_map(|kind| {
        let counts = kind.least_colours()..=references.len();
        counts.map(move |count| Ok(Method::ClosedForm(kind, count)))
    });
    let trained = networks.iter().map(|network| Method::trained(network, references));
    let methods = closed.chain(trained).collect::<Result<Vec<_>, _>>()?;
    let mut measured: Vec<Measured> = methods.iter().map(|_| Measured::default()).collect();
    for frames in views(&set.list.frames) {
        let view = load(set, &frames, references)?;
        for (method, measured) in methods.iter().zip(&mut measured) {
            add(method, &view, measured)?;
        }
        on_view();
    }
    let rows = methods.into_iter().zip(measured).map(|(method, m)| {
        let (model, references, network) = match method {
            Method::ClosedForm(kind, references) => (kind.name().to_owned(), references, None),
            Method::Network(network, _) => (network.architecture.name(), 1, Some(network)),
        };
        Some(SurrogateFigures {
            model,
            training_seconds: network.map(|n| n.training_seconds),
            references,
            trained_references: network.map(|n| n.references.len()),
            views: m.fit_ms.len(),
            frames: m.paint.len(),
            mse_paint: mean(&m.paint)?,
            mse_image: mean(&m.image)?,
            mse_paint_worst: m.paint.iter().copied().fold(0.0, f64::max),
            tone_power: mean(&m.power),
            mse_pattern_world: mean(&m.world),
            mse_pattern_repeated: mean(&m.repeated),
            fit_ms: mean(&m.fit_ms)?,
            predict_ms: mean(&m.predict_ms)?,
        })
    });
    let all = rows.collect::<Option<Vec<_>>>();
    let none = || {
        message!("no view has a flat colour besides the references, so there is nothing to predict: render one more")
            .hint("‹flat› 000000 808080 ffffff c83214 renders four colours")
    };
    Ok(all.ok_or_else(none)?)
}

fn load(set: &FrameSet, frames: &[&Frame], references: &[[u8; 3]]) -> Result<View, FramesError> {
    let first = frames[0];
    let mask = set.paint_mask(first)?;
    let mut flats = Vec::new();
    for colour in references {
        let found = frames.iter().find(|f| f.flat_rgb() == Some(*colour));
        let frame = found.ok_or_else(|| {
            let (frame, colour) = (&first.name, light::to_hex(*colour));
            message!(
                "the view of {frame} has no frame in the reference colour {colour}; render it, or give other colours"
            )
            .hint("the references are ‹reference›")
        })?;
        flats.extend(FlatImage::read(set, frame)?);
    }
    let (mut tests, mut patterns) = (Vec::new(), Vec::new());
    for frame in frames {
        if frame.flat_rgb().is_some_and(|rgb| !references.contains(&rgb)) {
            tests.extend(FlatImage::read(set, frame)?);
        }
        if let Some((pattern, tile_mm)) = set.pattern(frame)? {
            let grid = Grid::new([pattern.columns(), pattern.rows()], tile_mm);
            let cells: Vec<[f64; 3]> = pattern.cells().pixels().map(|p| light::linear_of(p.0)).collect();
            let textured = |projection: Projection| projection.forward(&cells);
            let calibrated = &repeated::Jitter::NONE;
            let of_world = world::project(set, frame, &grid, false, &[world::Misplacement::NONE])?;
            patterns.push(PatternTest {
                image: set.rgb(frame)?,
                world: of_world.and_then(|all| all.into_iter().next()).map(textured),
                repeated: textured(repeated::project(&set.list, frame, &mask, &grid, calibrated)),
            });
        }
    }
    Ok(View {
        mask,
        flats,
        tests,
        patterns,
    })
}

fn add(method: &Method, view: &View, measured: &mut Measured) -> Result<(), FramesError> {
    let (model, power, ms) = method.fit(view)?;
    measured.fit_ms.push(ms);
    measured.power.extend(power);
    for test in &view.tests {
        let paint = vec![light::linear_of(test.flat_rgb); view.mask.len()];
        let (predicted, ms) = fastest(|| model.predict(&paint));
        measured.predict_ms.push(ms);
        let (on_paint, all) = mse(&predicted, &test.image, &view.mask);
        measured.image.push(all);
        measured.paint.extend(on_paint);
    }
    for test in &view.patterns {
        let on_paint = |paint: &Vec<[f64; 3]>| mse(&model.predict(paint), &test.image, &view.mask).0;
        measured.world.extend(test.world.as_ref().and_then(on_paint));
        measured.repeated.extend(on_paint(&test.repeated));
    }
    Ok(())
}

/// Returns the mean squared error over the pixels that the paint covers by half or more (`None` without such pixels), and over all.
pub fn mse(predicted: &[[f64; 3]], image: &RgbImage, mask: &Coverage) -> (Option<f64>, f64) {
    let (mut paint, mut all) = ((0.0, 0_usize), 0.0);
    for ((p, truth), covered) in predicted.iter().zip(image.pixels()).zip(mask.pixels()) {
        // A prediction becomes an image of 8 bits, too, but what is measured is the model.
        for (value, level) in p.iter().zip(truth.0) {
            let error = (value - f64::from(level) / 255.0).powi(2);
            all += error;
            if covered.0[0] >= 128 {
                paint = (paint.0 + error, paint.1 + 1);
            }
        }
    }
    let (sum, count) = paint;
    let values = 3 * predicted.len().min(mask.len());
    ((count > 0).then(|| sum / count as f64), all / values.max(1) as f64)
}

/// `renderers.json`: errors and times of surrogate renderers on the same frames.
#[derive(Serialize, schemars::JsonSchema)]
pub struct Numbers<'a> {
    /// Version of the program.
    scaleproof: &'static str,
    /// SHA-256 of `frames.json`, and in `made_by` what made it.
    frames_sha256: &'a str,
    made_by: &'a str,
    /// The colours that models were fitted to, as hex (`--reference`).
    references: &'a [String],
    /// One row for each model and number of reference images.
    rows: &'a [SurrogateFigures],
}

/// Encodes the figures as JSON, with the frames that they were measured on.
pub fn numbers(set: &FrameSet, references: &[String], rows: &[SurrogateFigures]) -> Result<String, FramesError> {
    let numbers = Numbers {
        scaleproof: env!("CARGO_PKG_VERSION"),
        frames_sha256: &set.sha256,
        made_by: &set.list.made_by,
        references,
        rows,
    };
    serde_json::to_string_pretty(&numbers).map_err(FramesError::encode)
}

/// Formats the figures as lines of text, the most accurate first.
pub fn table(rows: &[SurrogateFigures]) -> String {
    let mut sorted: Vec<&SurrogateFigures> = rows.iter().collect();
    sorted.sort_by(|a, b| a.mse_paint.total_cmp(&b.mse_paint));
    let mut text = format!(
        "{:<20} {:>7} {:>10} {:>10} {:>10} {:>6} {:>10} {:>10} {:>8} {:>8} {:>9}\n",
        "model", "colours", "MSE paint", "worst", "image", "power", "world", "repeated", "fit ms", "ms", "trained s"
    );
    let or_dash = |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
    for row in sorted {
        text += &format!(
            "{:<20} {:>7} {:>10.6} {:>10.6} {:>10.6} {:>6} {:>10} {:>10} {:>8.1} {:>8.2} {:>9}\n",
            row.model,
            given(row),
            row.mse_paint,
            row.mse_paint_worst,
            row.mse_image,
            or_dash(row.tone_power, 2),
            or_dash(row.mse_pattern_world, 5),
            or_dash(row.mse_pattern_repeated, 5),
            row.fit_ms,
            row.predict_ms,
            or_dash(row.training_seconds, 0),
        );
    }
    text
}

/// Formats the number of colours that a model is given: `1`, or `1 of 3` for a network that takes any of three.
fn given(row: &SurrogateFigures) -> String {
    match row.trained_references {
        Some(count) if count > 1 => format!("{} of {count}", row.references),
        _ => row.references.to_string(),
    }
}

/// Splits a network's name into encoder and depth; a closed form has its name and the number of its colours.
fn series_and_shape(row: &SurrogateFigures) -> (String, String) {
    let Some((encoder, rest)) = row.model.split_once(" k=") else {
        return (row.model.clone(), format!("{} colours", row.references));
    };
    let (depth, formula) = rest.split_once(' ').unwrap_or((rest, ""));
    let many = if given(row) == "1" { "" } else { " any reference" };
    let series = format!("{encoder} {formula}{many}");
    (series.trim_end().to_owned(), format!("k={depth}"))
}

/// Draws the chart: colours for models and encoders, shapes for reference colours and depths.
pub fn draw(rows: &[SurrogateFigures]) -> String {
    let frames = rows.first().map_or(0, |row| row.frames);
    let note = format!("{frames} frames; mean squared error over the paint, sRGB 0 to 1; lower left is better");
    let title = "Surrogate renderers: error in unseen colours against time";
    cloud(title, note, "milliseconds a frame", rows, |row| row.predict_ms)
}

/// Draws the networks' chart: error against the time of their training. `None` without a network.
pub fn draw_training(rows: &[SurrogateFigures]) -> Option<String> {
    let trained: Vec<SurrogateFigures> = rows.iter().filter(|r| r.training_seconds.is_some()).cloned().collect();
    let closed = rows.iter().filter(|r| r.training_seconds.is_none());
    let best = closed.min_by(|a, b| a.mse_paint.total_cmp(&b.mse_paint))?;
    let note = format!(
        "{} frames, MSE over the paint; {}, without training: {:.5}",
        best.frames, best.model, best.mse_paint
    );
    let title = "Networks: error in unseen colours against training";
    (!trained.is_empty()).then(|| {
        cloud(title, note, "seconds of training", &trained, |row| {
            row.training_seconds.unwrap_or(0.0)
        })
    })
}

fn cloud(
    title: &str,
    note: String,
    x: &str,
    rows: &[SurrogateFigures],
    value: impl Fn(&SurrogateFigures) -> f64,
) -> String {
    let (names, forms): (Vec<String>, Vec<String>) = rows.iter().map(series_and_shape).unzip();
    let (colours, shapes) = (distinct(names.iter().cloned()), distinct(forms.iter().cloned()));
    let index = |list: &[String], name: &String| list.iter().position(|known| known == name).unwrap_or(0);
    let most = rows.iter().map(|r| r.references).max();
    let dot = |(i, row): (usize, &SurrogateFigures)| Dot {
        x: value(row),
        y: row.mse_paint,
        share: 1.0,
        series: index(&colours, &names[i]),
        shape: index(&shapes, &forms[i]),
        name: None,
        is_ringed: row.model == ClosedForm::default().name() && Some(row.references) == most,
    };
    let dots = rows.iter().enumerate().map(dot).collect();
    scatter(&Cloud {
        title: title.to_owned(),
        note,
        x: PlotAxis::around(x, Scale::Log, rows.iter().map(&value)),
        y: PlotAxis::around("MSE", Scale::Log, rows.iter().map(|r| r.mse_paint)),
        colours,
        shapes,
        ringed: "the default".to_owned(),
        groups: vec![(String::new(), dots)],
    })
    .svg()
}
