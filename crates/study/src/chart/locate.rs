//! Every tag detector × solver × camera model on the same photos: error against milliseconds against share answered.

use std::path::Path;

use image::GrayImage;
use serde::Serialize;

use super::{MeasureError, milliseconds, timed_tags, true_views};
use scaleproof_core::geometry::angle;
use scaleproof_core::statistics::upper_median;
use scaleproof_core::workers::fastest;
use scaleproof_photo::{Filter, Photo, grey_resized};
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, distinct, scatter};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{self, Solver};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_pose::tags::{SeenTag, TagDetectorChoice};
use scaleproof_session::Session;

/// Number of the camera file's distortion coefficients that are used: none (`pinhole`), the first alone (`k1`) or all (`full`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LensTerms {
    Pinhole,
    K1,
    Full,
}

impl LensTerms {
    pub const ALL: [Self; 3] = [Self::Full, Self::K1, Self::Pinhole];

    fn title(self) -> &'static str {
        ["no distortion", "k1 only", "camera file as it is"][self as usize]
    }

    /// Returns the camera with only these coefficients left.
    fn applied_to(self, camera: &Camera) -> Camera {
        let kept = [0, 1, 8][self as usize];
        let all = camera.distortion();
        camera.clone().with_distortion(&all[..all.len().min(kept)])
    }
}

/// A photo to measure on, and its true viewpoint.
#[derive(Debug, Clone)]
pub struct PhotoSample {
    /// Luma of the upright photo.
    pub luma: GrayImage,
    /// Degrees by which EXIF turned the photo clockwise.
    pub turned_deg: u32,
    /// Exact viewpoint.
    pub truth: Viewpoint,
}

impl PhotoSample {
    /// Decodes the photos of a session, with the truth about each. `on_photo` is called after each.
    pub fn of_session(session: &Session, truth: &Path, on_photo: impl Fn()) -> Result<Vec<Self>, MeasureError> {
        let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
        let samples = session.photos.iter().zip(true_views(truth, &names)?);
        let sample = |(entry, truth)| {
            let photo = Photo::open(&session.photo_path(entry))?;
            on_photo();
            let (luma, turned_deg) = (photo.luma()?, photo.turned_deg);
            Ok(Self {
                luma,
                turned_deg,
                truth,
            })
        };
        samples.map(sample).collect()
    }

    /// Returns the photo resized by `factor` along each side, as if a camera of more pixels had taken it.
    #[must_use]
    pub fn enlarged(self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        let side = |pixels: u32| (f64::from(pixels) * factor).round() as u32;
        let size = <[u32; 2]>::from(self.luma.dimensions()).map(side);
        Self {
            luma: grey_resized(&self.luma, size, Filter::Bicubic),
            ..self
        }
    }
}

/// One combination and what it measured.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LocateRow {
    pub tag_detector: &'static str,
    /// Pose solver: `ippe_best_tag`, `sqpnp`, `sqpnp_lm` or `every_branch_lm`.
    pub solver: &'static str,
    pub camera_model: LensTerms,
    /// Photos measured on.
    pub photos: usize,
    /// Share of the photos that got a pose.
    pub answered: f64,
    /// Mean time a photo takes for finding tags (`find_ms`) and for the pose (`solve_ms`), decoding left out.
    pub find_ms: f64,
    pub solve_ms: f64,
    /// Error of the located photos against the truth, also in the next five; `null` where none is located.
    pub azimuth_error_median_deg: Option<f64>,
    pub azimuth_error_max_deg: Option<f64>,
    pub pitch_error_median_deg: Option<f64>,
    pub pitch_error_max_deg: Option<f64>,
    pub distance_error_median_mm: Option<f64>,
    pub distance_error_max_mm: Option<f64>,
    /// Share of the photos answered with another azimuth bin than the true one, the truth being more than 1° inside its bin.
    pub silently_wrong: f64,
    /// No other combination of this camera model is as good in time, median azimuth error and share answered, and better in one.
    pub is_on_front: bool,
    /// True if it is what the program uses.
    pub is_default: bool,
}

impl LocateRow {
    pub fn ms(&self) -> f64 {
        self.find_ms + self.solve_ms
    }
}

/// Returns the tag detectors that are compared, libraries with their own corners last: those that read the scene's families.
pub fn detectors(scene: &Scene) -> Vec<TagDetectorChoice> {
    let reads_all = |choice: &TagDetectorChoice| scene.families().iter().all(|family| choice.reads(*family));
    let all = TagDetectorChoice::ALL.into_iter().chain(TagDetectorChoice::PEERS);
    all.filter(reads_all).collect()
}

/// Measures every combination, one photo after the other on one thread. `on_done` is called after each photo of each
/// tag detector.
pub fn measure(
    samples: &[PhotoSample],
    scene: &Scene,
    camera: &Camera,
    on_done: impl Fn(),
) -> Result<Vec<LocateRow>, MeasureError> {
    let fitted = |sample: &PhotoSample| -> Result<Camera, MeasureError> {
        let (width, height) = sample.luma.dimensions();
        Ok(camera.for_photo(width, height, sample.turned_deg)?.camera)
    };
    let fitted = samples.iter().map(fitted).collect::<Result<Vec<_>, _>>()?;
    // Times are of one core: OpenCV gets one thread.
    let _ = opencv::core::set_num_threads(1);
    let families = scene.families();
    let mut rows = Vec::new();
    for choice in detectors(scene) {
        let mut detector = choice.open(&families)?;
        let mut found = Vec::new();
        for sample in samples {
            let photo = (&sample.luma, sample.turned_deg);
            found.push(timed_tags(choice, detector.as_mut(), photo, scene, camera));
            on_done();
        }
        for model in LensTerms::ALL {
            let cameras: Vec<Camera> = fitted.iter().map(|camera| model.applied_to(camera)).collect();
            for solver in Solver::all() {
                rows.push(row((choice, solver, model), samples, &found, scene, &cameras));
            }
        }
    }
    mark_fronts(&mut rows);
    Ok(rows)
}

fn row(
    (choice, solver, camera_model): (TagDetectorChoice, Solver, LensTerms),
    samples: &[PhotoSample],
    found: &[(Vec<SeenTag>, f64)],
    scene: &Scene,
    cameras: &[Camera],
) -> LocateRow {
    let (mut azimuth, mut pitch, mut distance) = (Vec::new(), Vec::new(), Vec::new());
    let (mut solve_ms, mut wrong) = (0.0, 0);
    for ((sample, (seen, _)), camera) in samples.iter().zip(found).zip(cameras) {
        let (answer, ms) = fastest(|| locate::locate_by(solver, seen, scene, camera));
        solve_ms += ms;
        let Ok(located) = answer else { continue };
        let (view, truth) = (&located.viewpoint, &sample.truth);
        azimuth.push(angle::turn(view.azimuth_deg, truth.azimuth_deg).abs());
        pitch.push((view.pitch_deg - truth.pitch_deg).abs());
        distance.push((view.distance_mm - truth.distance_mm).abs());
        wrong += usize::from(is_silently_wrong(view, truth, scene));
    }
    let photos = samples.len();
    let mean = |sum: f64| sum / photos.max(1) as f64;
    let max = |values: &[f64]| values.iter().copied().max_by(f64::total_cmp);
    LocateRow {
        tag_detector: choice.name(),
        solver: solver.name(),
        camera_model,
        photos,
        answered: mean(azimuth.len() as f64),
        find_ms: mean(found.iter().map(|(_, ms)| ms).sum()),
        solve_ms: mean(solve_ms),
        azimuth_error_median_deg: upper_median(&azimuth),
        azimuth_error_max_deg: max(&azimuth),
        pitch_error_median_deg: upper_median(&pitch),
        pitch_error_max_deg: max(&pitch),
        distance_error_median_mm: upper_median(&distance),
        distance_error_max_mm: max(&distance),
        silently_wrong: mean(wrong as f64),
        is_on_front: false,
        is_default: choice == TagDetectorChoice::default()
            && solver == Solver::default()
            && camera_model == LensTerms::Full,
    }
}

/// Returns true if an answer puts a photo into another azimuth bin than the true one. Truth within 1° of a bin's edge counts for both.
pub fn is_silently_wrong(view: &Viewpoint, truth: &Viewpoint, scene: &Scene) -> bool {
    let is_inside = scene.bins.azimuth_to_edge_deg(truth.azimuth_deg) > 1.0;
    is_inside && scene.bins.bin_of(view).azimuth_deg != scene.bins.bin_of(truth).azimuth_deg
}

/// Marks, within each camera model, the combinations that no other beats in time, error and share answered at once.
fn mark_fronts(rows: &mut [LocateRow]) {
    let figures = |row: &LocateRow| {
        let error = row.azimuth_error_median_deg.unwrap_or(f64::INFINITY);
        [row.ms(), error, -row.answered]
    };
    let all: Vec<_> = rows.iter().map(|row| (row.camera_model, figures(row))).collect();
    for (row, (model, own)) in rows.iter_mut().zip(&all) {
        let beats = |other: &[f64; 3]| (0..3).all(|i| other[i] <= own[i]) && other != own;
        row.is_on_front =
            row.azimuth_error_median_deg.is_some() && !all.iter().any(|(m, other)| m == model && beats(other));
    }
}

/// Draws the chart: one plot a camera model, colours for tag detectors, shapes for solvers, filling for the share answered.
pub fn draw(rows: &[LocateRow]) -> String {
    let names = |name: fn(&LocateRow) -> &'static str| distinct(rows.iter().map(|row| name(row).to_owned()));
    let (colours, shapes) = (names(|row| row.tag_detector), names(|row| row.solver));
    let index = |names: &[String], name: &str| names.iter().position(|known| known == name).unwrap_or(0);
    let dot = |row: &LocateRow| {
        Some(Dot {
            x: row.ms(),
            y: row.azimuth_error_median_deg?,
            share: row.answered,
            series: index(&colours, row.tag_detector),
            shape: index(&shapes, row.solver),
            name: row.is_default.then(|| format!("{}, {}", row.tag_detector, row.solver)),
            is_ringed: row.is_default,
        })
    };
    let group = |model: LensTerms| {
        let of_model = rows.iter().filter(|row| row.camera_model == model);
        (model.title().to_owned(), of_model.filter_map(dot).collect())
    };
    let photos = rows.first().map_or(0, |row| row.photos);
    scatter(&Cloud {
        title: "Pose: error against time".to_owned(),
        note: format!(
            "{photos} photos; filled share of a mark: share of the photos that got a pose; lower left is better"
        ),
        x: milliseconds(rows.iter().map(LocateRow::ms)),
        y: PlotAxis::around(
            "median azimuth error, °",
            Scale::Log,
            rows.iter().filter_map(|row| row.azimuth_error_median_deg),
        ),
        colours: colours.clone(),
        shapes: shapes.clone(),
        ringed: "the default".to_owned(),
        groups: LensTerms::ALL.into_iter().map(group).collect(),
    })
    .svg()
}

/// Writes the rows as lines of text, one camera model after the other, the fastest first.
pub fn table(rows: &[LocateRow]) -> String {
    let mut sorted: Vec<&LocateRow> = rows.iter().collect();
    sorted.sort_by(|a, b| {
        let by_model = (b.camera_model as u8).cmp(&(a.camera_model as u8));
        by_model.then(a.ms().total_cmp(&b.ms()))
    });
    let mut text =
        "tags               solver           camera      find ms  solve ms  answered   wrong  azimuth med / max    pitch med / max      distance mm\n".to_owned();
    for row in sorted {
        let pair = |a: Option<f64>, b: Option<f64>, digits: usize| match (a, b) {
            (Some(a), Some(b)) => format!("{a:.digits$} / {b:.digits$}"),
            _ => "–".to_owned(),
        };
        let camera = ["pinhole", "k1", "full"][row.camera_model as usize];
        let mark = match (row.is_default, row.is_on_front) {
            (true, _) => " ← default",
            (_, true) => " *",
            _ => "",
        };
        let azimuth = pair(row.azimuth_error_median_deg, row.azimuth_error_max_deg, 4);
        let pitch = pair(row.pitch_error_median_deg, row.pitch_error_max_deg, 4);
        let distance = pair(row.distance_error_median_mm, row.distance_error_max_mm, 2);
        let (answered, wrong) = (100.0 * row.answered, 100.0 * row.silently_wrong);
        let (tags, solver, find_ms, solve_ms) = (row.tag_detector, row.solver, row.find_ms, row.solve_ms);
        text += &format!(
            "{tags:<18} {solver:<16} {camera:<9} {find_ms:>9.2} {solve_ms:>9.3} {answered:>8.0}% {wrong:>6.1}% {azimuth:>18} {pitch:>18} {distance:>16}{mark}\n"
        );
    }
    text
}
