//! Sweeps that drive every method from harmless to hopeless: how far off, how often answered, how often *silently wrong*.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::locate::{PhotoSample, is_silently_wrong};
use super::spoil::{Spoil, TagCorners};
use scaleproof_core::geometry::angle;
use scaleproof_core::statistics::upper_median;
use scaleproof_core::workers;
use scaleproof_plot::{PlotAxis, PlotLine, PlotPanel, Scale, distinct, panels};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{self, Located, Solver, locate_luma};
use scaleproof_pose::scene::{Scene, Tag, Viewpoint};
use scaleproof_pose::simulate::{Noise, SimulatedFault, SimulatedView, Simulator};
use scaleproof_pose::tags::{CornersBy, StartError, TagDetectorChoice};

/// Corner noise of the simulated detector: what the photos show, with tails.
const NOISE: Noise = Noise {
    sigma_px: 0.3,
    tail_share: 0.02,
};

/// Each line a condition: a stable name, what the amounts are, and the amounts, from harmless to hopeless.
const OF_VIEWS: &str = include_str!("sweeps_of_views.txt");
const OF_PHOTOS: &str = include_str!("sweeps_of_photos.txt");

/// A condition and one of its amounts: name, unit, amount.
type SweepAmount = (&'static str, &'static str, f64);

fn amounts(sweeps: &'static str) -> impl Iterator<Item = SweepAmount> {
    sweeps.lines().flat_map(|line| {
        let mut parts = line.split(" | ");
        let [name, unit, amounts] = [(); 3].map(|()| parts.next().unwrap_or_default());
        let amounts = amounts.split(' ').filter_map(|amount| amount.parse().ok());
        amounts.map(move |amount| (name, unit, amount))
    })
}

#[derive(Debug, Clone, Copy)]
enum SweepKind {
    /// Corner noise of the detector, px.
    CornerNoise,
    /// The side of a tag of 50 mm seen from straight before it, px: the camera moves away.
    TagSize,
    /// One tag alone, seen under this angle to its normal, degrees.
    Tilt,
    /// The lens has this many times the stated camera's distortion, and the camera file none.
    IgnoredDistortion,
    Fault(fn(f64) -> Option<SimulatedFault>),
}

impl SweepKind {
    fn named(name: &str) -> Option<Self> {
        use SimulatedFault as F;
        Some(match name {
            "corner_noise" => Self::CornerNoise,
            "tag_size" => Self::TagSize,
            "tilt_of_a_single_tag" => Self::Tilt,
            "hidden_tags" => Self::Fault(|share| Some(F::Hidden { share })),
            "cropped_view" => Self::Fault(|share| Some(F::Cropped { share })),
            "wrong_focal" => Self::Fault(|factor| Some(F::WrongFocal { factor })),
            "wrong_principal_point" => Self::Fault(|px| Some(F::WrongPrincipalPoint { px })),
            "wrong_tag_size" => Self::Fault(|factor| Some(F::WrongTagSize { factor })),
            "moved_tag" => Self::Fault(|mm| Some(F::MovedTag { mm })),
            "twisted_tag" => Self::Fault(|deg| Some(F::TwistedTag { deg })),
            "wrong_corner" => Self::Fault(|px| Some(F::WrongCorner { px })),
            "duplicated_id" => Self::Fault(|there| (there > 0.0).then_some(F::DuplicatedId)),
            "wrong_id" => Self::Fault(|there| (there > 0.0).then_some(F::WrongId)),
            "ignored_distortion" => Self::IgnoredDistortion,
            _ => return None,
        })
    }
}

/// What one method did at one amount of one condition.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SweepStep {
    pub sweep: &'static str,
    pub unit: &'static str,
    pub amount: f64,
    /// The solver, on simulated views; the tag detector, on photos.
    pub method: &'static str,
    /// Views with at least one tag, or photos.
    pub views: usize,
    /// Share of them that got a pose.
    pub answered: f64,
    /// Of the answered ones.
    pub azimuth_error_median_deg: Option<f64>,
    pub distance_error_median_percent: Option<f64>,
    /// Share of the views answered with another azimuth bin than the true one, the truth being more than 1° inside its bin.
    pub silently_wrong: f64,
}

/// Answers gathered for one step.
#[derive(Default)]
struct Tally {
    views: usize,
    azimuth_deg: Vec<f64>,
    distance_percent: Vec<f64>,
    wrong: usize,
}

impl Tally {
    fn count(&mut self, answer: Option<Located>, truth: &Viewpoint, scene: &Scene) {
        self.views += 1;
        let Some(located) = answer else { return };
        let view = &located.viewpoint;
        self.azimuth_deg
            .push(angle::turn(view.azimuth_deg, truth.azimuth_deg).abs());
        self.distance_percent
            .push(100.0 * (view.distance_mm / truth.distance_mm - 1.0).abs());
        self.wrong += usize::from(is_silently_wrong(view, truth, scene));
    }

    fn step(self, (sweep, unit, amount): SweepAmount, method: &'static str) -> SweepStep {
        let share = |n: usize| n as f64 / self.views.max(1) as f64;
        SweepStep {
            sweep,
            unit,
            amount,
            method,
            views: self.views,
            answered: share(self.azimuth_deg.len()),
            silently_wrong: share(self.wrong),
            azimuth_error_median_deg: upper_median(&self.azimuth_deg),
            distance_error_median_percent: upper_median(&self.distance_percent),
        }
    }
}

/// Every sweep over simulated views of a scene, `views` at each amount, every solver on the same ones. The same seed gives the
/// same steps. `on_done` is called after each amount.
pub fn on_views(scene: &Scene, camera: &Camera, views: usize, seed: u64, on_done: impl Fn() + Sync) -> Vec<SweepStep> {
    let jobs: Vec<(u64, SweepAmount)> = (seed..).zip(amounts(OF_VIEWS)).collect();
    let steps = workers::map(
        &jobs,
        || Ok::<_, std::convert::Infallible>(()),
        |(), (seed, at)| Ok(sweep_step(*at, scene, camera, views, *seed)),
        on_done,
    );
    match steps {
        Ok(steps) => steps.into_iter().flatten().collect(),
        Err(never) => match never {},
    }
}

/// How many amounts [`on_views`] goes through.
pub fn view_steps() -> usize {
    amounts(OF_VIEWS).count()
}

fn sweep_step(at: SweepAmount, scene: &Scene, camera: &Camera, views: usize, seed: u64) -> Vec<SweepStep> {
    let Some(kind) = SweepKind::named(at.0) else {
        return Vec::new();
    };
    let mut tallies: Vec<Tally> = Solver::all().iter().map(|_| Tally::default()).collect();
    let mut maker = Maker::new(kind, at.2, scene, camera, seed);
    for _ in 0..views {
        let Some(view) = maker.view() else { continue };
        for (solver, tally) in Solver::all().into_iter().zip(&mut tallies) {
            let answer = locate::locate_by(solver, &view.seen, &view.scene, &view.camera);
            tally.count(answer.ok(), &view.viewpoint, scene);
        }
    }
    Solver::all()
        .iter()
        .zip(tallies)
        .map(|(solver, tally)| tally.step(at, solver.name()))
        .collect()
}

/// Makes the views of one step.
struct Maker<'a> {
    kind: SweepKind,
    amount: f64,
    scene: &'a Scene,
    /// As it truly is.
    camera: Camera,
    stated: &'a Camera,
    seed: u64,
    made: u64,
}

impl<'a> Maker<'a> {
    fn new(kind: SweepKind, amount: f64, scene: &'a Scene, stated: &'a Camera, seed: u64) -> Self {
        let camera = match kind {
            SweepKind::IgnoredDistortion => {
                let stronger = stated.distortion().map(|k| amount * k);
                stated.clone().with_distortion(&stronger)
            }
            _ => stated.clone(),
        };
        Self {
            kind,
            amount,
            scene,
            camera,
            stated,
            seed: seed << 32,
            made: 0,
        }
    }

    /// The next view, if any tag is seen on it.
    fn view(&mut self) -> Option<SimulatedView> {
        self.made += 1;
        let seed = self.seed + self.made;
        let sigma_px = match self.kind {
            SweepKind::CornerNoise => self.amount,
            _ => NOISE.sigma_px,
        };
        let noise = Noise { sigma_px, ..NOISE };
        let view = match self.kind {
            SweepKind::Tilt => self.lone_tag(noise, seed)?,
            _ => self.ring(noise, seed),
        };
        (!view.seen.is_empty()).then_some(view)
    }

    fn ring(&self, noise: Noise, seed: u64) -> SimulatedView {
        let mut simulator = Simulator::new(self.scene, &self.camera, noise, seed);
        let distance_mm = match self.kind {
            SweepKind::TagSize => {
                let away = self.stated.fx * 50.0 / self.amount;
                away..1.001 * away
            }
            _ => 600.0..1600.0,
        };
        let viewpoint = simulator.viewpoint(5.0..40.0, distance_mm);
        let fault = match self.kind {
            SweepKind::Fault(fault) => fault(self.amount),
            SweepKind::IgnoredDistortion => Some(SimulatedFault::IgnoredDistortion),
            SweepKind::CornerNoise | SweepKind::TagSize | SweepKind::Tilt => None,
        };
        simulator.view(&viewpoint, fault)
    }

    /// A view of one of the scene's tags alone, from a direction that makes the required angle with the tag's normal; the model is in
    /// the image too.
    fn lone_tag(&self, noise: Noise, seed: u64) -> Option<SimulatedView> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let tag = &self.scene.tags[rng.random_range(0..self.scene.tags.len())];
        let alone = Scene {
            tags: vec![tag.clone()],
            ..self.scene.clone()
        };
        let target = self.scene.model.target_mm();
        let mut attempts = (0..LONE_TAG_ATTEMPTS).map(|_| {
            let away = rng.random_range(600.0..1200.0);
            let around: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            let centre = tag.centre_mm + away * tilted(tag, self.amount, around);
            // The camera looks at the tag; the view's own viewpoint is from the model's target.
            let pose =
                scaleproof_pose::simulate::looking_at(&Viewpoint::from_camera(centre, tag.centre_mm), tag.centre_mm);
            (pose, Viewpoint::from_camera(centre, target))
        });
        let (pose, viewpoint) = attempts.find(|(pose, _)| shows(&self.camera, &(pose * target)))?;
        let seen = Simulator::new(&alone, &self.camera, noise, seed).seen(&pose);
        (!seen.is_empty()).then(|| SimulatedView {
            viewpoint,
            pose,
            seen,
            scene: alone.clone(),
            camera: self.camera.clone(),
            struck: None,
        })
    }
}

/// From so many places a view is tried that shows a tag and the model.
const LONE_TAG_ATTEMPTS: usize = 50;

/// Whether a point of the camera frame is in the image.
fn shows(camera: &Camera, point: &nalgebra::Point3<f64>) -> bool {
    let within = |v: f64, size: u32| (0.0..f64::from(size)).contains(&v);
    camera
        .project(point)
        .is_some_and(|[x, y]| within(x, camera.width) && within(y, camera.height))
}

/// The unit direction `tilt_deg` off a tag's normal, towards `around` (radians) in its plane.
fn tilted(tag: &Tag, tilt_deg: f64, around: f64) -> nalgebra::Vector3<f64> {
    let normal = tag.right.cross(&tag.up);
    let aside = around.cos() * tag.right + around.sin() * tag.up;
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    cos * normal + sin * aside
}

/// Every way to spoil the photos, with some tag detectors and the default solver. `on_done` is called after each spoiled photo.
///
/// # Errors
/// A detector that does not start.
pub fn on_photos(
    samples: &[PhotoSample],
    scene: &Scene,
    camera: &Camera,
    detectors: &[TagDetectorChoice],
    seed: u64,
    on_done: impl Fn() + Sync,
) -> Result<Vec<SweepStep>, StartError> {
    let families = scene.families();
    let places = tags_of(samples, scene)?;
    let spoiled = |at: SweepAmount| Some((Spoil::named(at.0)?, at));
    let jobs: Vec<(Spoil, SweepAmount)> = amounts(OF_PHOTOS).filter_map(spoiled).collect();
    let open = || {
        detectors
            .iter()
            .map(|choice| choice.open(&families))
            .collect::<Result<Vec<_>, _>>()
    };
    let steps = workers::map(
        &jobs,
        open,
        |open, (spoil, at)| {
            let mut tallies: Vec<Tally> = detectors.iter().map(|_| Tally::default()).collect();
            for (i, (sample, tags)) in samples.iter().zip(&places).enumerate() {
                let mut rng = Pcg64Mcg::seed_from_u64(seed + i as u64);
                // A cut photo comes as one of another size, and the camera file cannot know.
                let photo = spoil.apply(&sample.luma, at.2, tags, &mut rng);
                for (detector, tally) in open.iter_mut().zip(&mut tallies) {
                    let answer = locate_luma(&photo, sample.turned_deg, scene, camera, detector.as_mut());
                    tally.count(answer.result.ok(), &sample.truth, scene);
                }
                on_done();
            }
            let steps = detectors.iter().zip(tallies);
            Ok(steps
                .map(|(choice, tally)| tally.step(*at, choice.name()))
                .collect::<Vec<_>>())
        },
        || {},
    )?;
    Ok(steps.into_iter().flatten().collect())
}

/// How many spoiled photos [`on_photos`] looks at.
pub fn photo_steps(photos: usize) -> usize {
    photos * amounts(OF_PHOTOS).count()
}

/// Copies of the photos, each spoiled in one way by one amount, both at random, from harmless to hopeless. None is cut: a camera file fits no cut
/// photo.
///
/// # Errors
/// A detector that does not start.
pub fn spoiled(samples: &[PhotoSample], scene: &Scene, copies: u32, seed: u64) -> Result<Vec<PhotoSample>, StartError> {
    let ways: Vec<(Spoil, f64)> = amounts(OF_PHOTOS)
        .filter_map(|(name, _, amount)| Some((Spoil::named(name)?, amount)))
        .filter(|(spoil, _)| *spoil != Spoil::Crop)
        .collect();
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let copies_of = |(sample, tags): (&PhotoSample, &Vec<TagCorners>)| {
        let copy = || {
            let (spoil, amount) = ways[rng.random_range(0..ways.len())];
            PhotoSample {
                luma: spoil.apply(&sample.luma, amount, tags, &mut rng),
                ..sample.clone()
            }
        };
        std::iter::repeat_with(copy).take(copies as usize).collect::<Vec<_>>()
    };
    let places = tags_of(samples, scene)?;
    Ok(samples.iter().zip(&places).flat_map(copies_of).collect())
}

/// Where the tags are in the photos as they were taken.
fn tags_of(samples: &[PhotoSample], scene: &Scene) -> Result<Vec<Vec<TagCorners>>, StartError> {
    workers::map(
        samples,
        || TagDetectorChoice::default().open(&scene.families()),
        |detector, sample| {
            Ok(detector
                .find(&sample.luma)
                .into_iter()
                .map(|tag| tag.corners_px)
                .collect())
        },
        || {},
    )
}

/// A page of panels: for each sweep the shares (answered solid, silently wrong dashed), and beside them the median azimuth
/// error of the answered.
pub fn draw(title: &str, steps: &[SweepStep]) -> String {
    let methods = distinct(steps.iter().map(|step| step.method));
    let sweeps = distinct(steps.iter().map(|step| step.sweep));
    let most = steps.iter().map(|step| step.views).max().unwrap_or(0);
    let total: usize = steps.iter().map(|step| step.views).sum::<usize>() / methods.len().max(1);
    let notes = [
        format!(
            "{total} views in all, up to {most} at each amount. Shares of views: answered (solid), silently wrong (dashed)."
        ),
        "Silently wrong: another azimuth bin than the true one, the truth being more than 1° inside its bin."
            .to_owned(),
    ];
    let all: Vec<PlotPanel> = sweeps
        .iter()
        .flat_map(|sweep| {
            let of_sweep: Vec<&SweepStep> = steps.iter().filter(|step| step.sweep == *sweep).collect();
            [shares(&of_sweep, &methods), errors(&of_sweep, &methods)]
        })
        .collect();
    let names: Vec<String> = methods.iter().map(|m| (*m).to_owned()).collect();
    panels(title, &notes, &names, 4, &all)
}

fn shares(steps: &[&SweepStep], methods: &[&str]) -> PlotPanel {
    let line = |series: usize, is_dashed: bool, value: fn(&SweepStep) -> f64| PlotLine {
        series,
        values: of_method(steps, methods[series])
            .map(|step| Some(value(step)))
            .collect(),
        is_dashed,
    };
    let numbers = 0..methods.len();
    let answered = numbers.clone().map(|i| line(i, false, |step| step.answered));
    let wrong = numbers.map(|i| line(i, true, |step| step.silently_wrong));
    PlotPanel {
        title: steps.first().map_or("", |step| step.unit).to_owned(),
        steps: step_labels(steps, methods),
        y: PlotAxis {
            title: "share of views".to_owned(),
            scale: Scale::Linear,
            low: 0.0,
            high: 1.0,
        },
        lines: answered.chain(wrong).collect(),
    }
}

fn errors(steps: &[&SweepStep], methods: &[&str]) -> PlotPanel {
    let line = |series: usize| PlotLine {
        series,
        values: of_method(steps, methods[series])
            .map(|step| step.azimuth_error_median_deg)
            .collect(),
        is_dashed: false,
    };
    let lines: Vec<PlotLine> = (0..methods.len()).map(line).collect();
    let values = lines.iter().flat_map(|line| line.values.iter().flatten().copied());
    PlotPanel {
        title: String::new(),
        steps: step_labels(steps, methods),
        y: PlotAxis::around("median azimuth error, °", Scale::Log, values.collect::<Vec<_>>()),
        lines,
    }
}

fn of_method<'a>(steps: &'a [&SweepStep], method: &'a str) -> impl Iterator<Item = &'a SweepStep> {
    steps.iter().copied().filter(move |step| step.method == method)
}

fn step_labels(steps: &[&SweepStep], methods: &[&str]) -> Vec<String> {
    let first = methods.first().copied().unwrap_or_default();
    of_method(steps, first).map(|step| format!("{}", step.amount)).collect()
}

/// The detectors that photos are spoiled for: the default, the library it rests on as it comes, and the fastest rival; those of them that
/// read the scene's tags.
pub fn detectors(scene: &Scene) -> Vec<TagDetectorChoice> {
    let reads_all = |choice: &TagDetectorChoice| scene.families().iter().all(|family| choice.reads(*family));
    let compared = [
        TagDetectorChoice::default(),
        TagDetectorChoice::AprilTagC(CornersBy::Library),
        TagDetectorChoice::Locus(CornersBy::Fit),
    ];
    compared.into_iter().filter(reads_all).collect()
}

/// A line a sweep and method: up to which amount nearly all is answered, and how often it was silently wrong at worst.
pub fn summary(steps: &[SweepStep]) -> String {
    let mut text = format!(
        "{:<22} {:<16} {:>7} {:>22} {:>26}\n",
        "condition", "method", "views", "90 % answered up to", "silently wrong, at worst"
    );
    for (sweep, method) in distinct(steps.iter().map(|step| (step.sweep, step.method))) {
        let of = steps.iter().filter(|s| (s.sweep, s.method) == (sweep, method));
        let of: Vec<&SweepStep> = of.collect();
        let views: usize = of.iter().map(|s| s.views).sum();
        let good = of.iter().take_while(|s| s.answered >= 0.9).last();
        let good = good.map_or("–".to_owned(), |s| s.amount.to_string());
        let worst = of.iter().max_by(|a, b| a.silently_wrong.total_cmp(&b.silently_wrong));
        let worst = worst.map_or(String::new(), |s| match s.silently_wrong {
            0.0 => "never".to_owned(),
            share => format!("{:.2} % at {}", 100.0 * share, s.amount),
        });
        text += &format!("{sweep:<22} {method:<16} {views:>7} {good:>22} {worst:>26}\n");
    }
    text
}
