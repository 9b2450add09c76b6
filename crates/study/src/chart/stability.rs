//! Sweeps that drive every method from harmless to hopeless: its errors, the share answered, the share *silently wrong*.

use std::convert::Infallible;
use std::ops::Range;

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
use scaleproof_pose::simulate::{Noise, SimulatedFault, SimulatedView, Simulator, looking_at};
use scaleproof_pose::tags::{CornersBy, StartError, TagDetectorChoice};

/// Corner noise of the simulated detector, as in photos, with tails.
const NOISE: Noise = Noise {
    sigma_px: 0.3,
    tail_share: 0.02,
};

/// Sweeps, one condition a line: a stable name, the unit of the amounts, and the amounts, from harmless to hopeless.
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

/// Conditions of the views of one step.
struct Conditions {
    noise: Noise,
    distances_mm: Range<f64>,
    /// Angle to the normal of a tag that is seen alone; `None` where all are seen.
    tilt_deg: Option<f64>,
    fault: Option<SimulatedFault>,
    camera: Camera,
}

impl Conditions {
    /// Returns the conditions of a sweep of views at one amount; `None` for an unknown sweep.
    fn new((name, _, amount): SweepAmount, stated: &Camera) -> Option<Self> {
        use SimulatedFault as F;
        let mut all = Self {
            noise: NOISE,
            distances_mm: 600.0..1600.0,
            tilt_deg: None,
            fault: None,
            camera: stated.clone(),
        };
        match name {
            "corner_noise" => all.noise.sigma_px = amount,
            // The amount is the side of a tag of 50 mm seen from straight before it, px: the camera moves away.
            "tag_size" => {
                let away = stated.fx * 50.0 / amount;
                all.distances_mm = away..1.001 * away;
            }
            "tilt_of_a_single_tag" => all.tilt_deg = Some(amount),
            // The lens has `amount` times the stated camera's distortion, and the camera file none.
            "ignored_distortion" => {
                let stronger: Vec<f64> = stated.distortion().iter().map(|k| amount * k).collect();
                all.camera = stated.clone().with_distortion(&stronger);
                all.fault = Some(F::IgnoredDistortion);
            }
            "hidden_tags" => all.fault = Some(F::Hidden { share: amount }),
            "cropped_view" => all.fault = Some(F::Cropped { share: amount }),
            "wrong_focal" => all.fault = Some(F::WrongFocal { factor: amount }),
            "wrong_principal_point" => all.fault = Some(F::WrongPrincipalPoint { px: amount }),
            "wrong_tag_size" => all.fault = Some(F::WrongTagSize { factor: amount }),
            "moved_tag" => all.fault = Some(F::MovedTag { mm: amount }),
            "bent_paper" => all.fault = Some(F::BentPaper { mm: amount }),
            "twisted_tag" => all.fault = Some(F::TwistedTag { deg: amount }),
            "wrong_corner" => all.fault = Some(F::WrongCorner { px: amount }),
            "duplicated_id" => all.fault = (amount > 0.0).then_some(F::DuplicatedId),
            "wrong_id" => all.fault = (amount > 0.0).then_some(F::WrongId),
            _ => return None,
        }
        Some(all)
    }

    fn view(&self, scene: &Scene, seed: u64) -> Option<SimulatedView> {
        if let Some(tilt_deg) = self.tilt_deg {
            return self.lone_tag(scene, tilt_deg, seed);
        }
        let mut simulator = Simulator::new(scene, &self.camera, self.noise, seed);
        let viewpoint = simulator.viewpoint(5.0..40.0, self.distances_mm.clone());
        let view = simulator.view(&viewpoint, self.fault);
        (!view.seen.is_empty()).then_some(view)
    }

    /// Simulates a view of one of the scene's tags alone, from a direction that makes the required angle with the tag's normal; the model is in
    /// the image too.
    fn lone_tag(&self, scene: &Scene, tilt_deg: f64, seed: u64) -> Option<SimulatedView> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let tag = &scene.tags[rng.random_range(0..scene.tags.len())];
        let alone = Scene {
            tags: vec![tag.clone()],
            ..scene.clone()
        };
        let target = scene.model.target_mm();
        let mut attempts = (0..LONE_TAG_ATTEMPTS).map(|_| {
            let away = rng.random_range(600.0..1200.0);
            let around: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            let centre = tag.centre_mm + away * tilted(tag, tilt_deg, around);
            // The camera looks at the tag; the view's own viewpoint is from the model's target.
            let pose = looking_at(&Viewpoint::from_camera(centre, tag.centre_mm), tag.centre_mm);
            (pose, Viewpoint::from_camera(centre, target))
        });
        let (pose, viewpoint) = attempts.find(|(pose, _)| shows(&self.camera, &(pose * target)))?;
        let seen = Simulator::new(&alone, &self.camera, self.noise, seed).seen(&pose);
        (!seen.is_empty()).then(|| SimulatedView {
            viewpoint,
            pose,
            seen,
            scene: alone,
            camera: self.camera.clone(),
            struck: None,
        })
    }
}

/// Number of places from which a view that shows a tag and the model is tried.
const LONE_TAG_ATTEMPTS: usize = 50;

/// Returns true if a point of the camera frame is in the image.
fn shows(camera: &Camera, point: &nalgebra::Point3<f64>) -> bool {
    let within = |v: f64, size: u32| (0.0..f64::from(size)).contains(&v);
    let at = camera.project(point);
    at.is_some_and(|[x, y]| within(x, camera.width) && within(y, camera.height))
}

/// Returns the unit direction `tilt_deg` off a tag's normal, towards `around` (radians) in its plane.
fn tilted(tag: &Tag, tilt_deg: f64, around: f64) -> nalgebra::Vector3<f64> {
    let normal = tag.right.cross(&tag.up);
    let aside = around.cos() * tag.right + around.sin() * tag.up;
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    cos * normal + sin * aside
}

/// Result of one method at one amount of one condition.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SweepStep {
    /// The condition that is made harder; how strong it is stands in `amount`, in this `unit`.
    pub sweep: &'static str,
    pub unit: &'static str,
    pub amount: f64,
    /// The solver, on simulated views; the tag detector, on photos.
    pub method: &'static str,
    /// Views with at least one tag, or photos.
    pub views: usize,
    /// Share of the views (or photos) that got a pose.
    pub answered: f64,
    /// Median error of the answered views, also in the next, which is in per cent; `null` where none is answered.
    pub azimuth_error_median_deg: Option<f64>,
    pub distance_error_median_percent: Option<f64>,
    /// Share of the views answered with another azimuth bin than the true one, the truth being more than 1° inside its bin.
    pub silently_wrong: f64,
}

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

/// Runs every sweep over simulated views of a scene, `views` at each amount, each of the solvers on the same ones. The same seed gives the
/// same steps. `on_done` is called after each amount.
pub fn on_views(
    scene: &Scene,
    camera: &Camera,
    solvers: &[Solver],
    (views, seed): (usize, u64),
    on_done: impl Fn() + Sync,
) -> Vec<SweepStep> {
    let jobs: Vec<(u64, SweepAmount)> = (seed..).zip(amounts(OF_VIEWS)).collect();
    let Ok(steps) = workers::map(
        &jobs,
        || Ok::<_, Infallible>(()),
        |(), (seed, at)| Ok(sweep_step(*at, scene, camera, solvers, views as u64, seed << 32)),
        on_done,
    );
    steps.into_iter().flatten().collect()
}

/// Returns the number of amounts that [`on_views`] goes through.
pub fn view_steps() -> usize {
    amounts(OF_VIEWS).count()
}

fn sweep_step(
    at: SweepAmount,
    scene: &Scene,
    camera: &Camera,
    solvers: &[Solver],
    views: u64,
    seed: u64,
) -> Vec<SweepStep> {
    let Some(conditions) = Conditions::new(at, camera) else {
        return Vec::new();
    };
    let mut tallies: Vec<(Solver, Tally)> = solvers.iter().map(|s| (*s, Tally::default())).collect();
    for view in (1..=views).filter_map(|number| conditions.view(scene, seed + number)) {
        for (solver, tally) in &mut tallies {
            let answer = locate::locate_by(*solver, &view.seen, &view.scene, &view.camera);
            tally.count(answer.ok(), &view.viewpoint, scene);
        }
    }
    let steps = tallies.into_iter().map(|(solver, tally)| tally.step(at, solver.name()));
    steps.collect()
}

/// Runs every degradation of the photos, with some tag detectors and the default solver. `on_done` is called after each spoiled photo.
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
    let open = || -> Result<Vec<_>, StartError> { detectors.iter().map(|choice| choice.open(&families)).collect() };
    let steps = workers::map(
        &spoils().collect::<Vec<_>>(),
        open,
        |open, (spoil, at)| {
            let mut tallies: Vec<Tally> = detectors.iter().map(|_| Tally::default()).collect();
            for (i, (sample, tags)) in samples.iter().zip(&places).enumerate() {
                let mut rng = Pcg64Mcg::seed_from_u64(seed + i as u64);
                // A cut photo comes as one of another size, and the camera file cannot know.
                let photo = spoil.apply(&sample.luma, at.2, tags, &mut rng);
                for (detector, tally) in open.iter_mut().zip(&mut tallies) {
                    let answer = locate_luma(&photo, sample.turned_deg, None, scene, camera, detector.as_mut());
                    tally.count(answer.result.ok(), &sample.truth, scene);
                }
                on_done();
            }
            let steps = detectors.iter().zip(tallies);
            let steps = steps.map(|(choice, tally)| tally.step(*at, choice.name()));
            Ok(steps.collect::<Vec<_>>())
        },
        || {},
    )?;
    Ok(steps.into_iter().flatten().collect())
}

fn spoils() -> impl Iterator<Item = (Spoil, SweepAmount)> {
    amounts(OF_PHOTOS).filter_map(|at| Some((Spoil::named(at.0)?, at)))
}

/// Returns the number of spoiled photos that [`on_photos`] locates.
pub fn photo_steps(photos: usize) -> usize {
    photos * amounts(OF_PHOTOS).count()
}

/// Returns copies of the photos, each spoiled in one way by one amount, both at random, from harmless to hopeless. None is cut: a camera file fits no
/// cut photo.
pub fn spoiled(samples: &[PhotoSample], scene: &Scene, copies: u32, seed: u64) -> Result<Vec<PhotoSample>, StartError> {
    let ways: Vec<(Spoil, SweepAmount)> = spoils().filter(|(spoil, _)| *spoil != Spoil::Crop).collect();
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let copies_of = |(sample, tags): (&PhotoSample, &Vec<TagCorners>)| {
        let copy = || {
            let (spoil, (_, _, amount)) = ways[rng.random_range(0..ways.len())];
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

fn tags_of(samples: &[PhotoSample], scene: &Scene) -> Result<Vec<Vec<TagCorners>>, StartError> {
    workers::map(
        samples,
        || TagDetectorChoice::default().open(&scene.families()),
        |detector, sample| {
            let tags = detector.find(&sample.luma).into_iter();
            Ok(tags.map(|tag| tag.corners_px).collect())
        },
        || {},
    )
}

/// Draws a page of panels: for each sweep the shares (answered solid, silently wrong dashed), and beside them the median azimuth
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
    let panel = |sweep: &&str| {
        let of_sweep: Vec<&SweepStep> = steps.iter().filter(|step| step.sweep == *sweep).collect();
        [shares(&of_sweep, &methods), errors(&of_sweep, &methods)]
    };
    let all: Vec<PlotPanel> = sweeps.iter().flat_map(panel).collect();
    let names: Vec<String> = methods.iter().map(|m| (*m).to_owned()).collect();
    panels(title, &notes, &names, 4, &all).svg()
}

fn shares(steps: &[&SweepStep], methods: &[&str]) -> PlotPanel {
    let answered = lines(steps, methods, false, |step| Some(step.answered));
    let wrong = lines(steps, methods, true, |step| Some(step.silently_wrong));
    PlotPanel {
        title: steps.first().map_or("", |step| step.unit).to_owned(),
        steps: step_labels(steps, methods),
        y: PlotAxis {
            title: "share of views".to_owned(),
            scale: Scale::Linear,
            low: 0.0,
            high: 1.0,
        },
        lines: [answered, wrong].concat(),
    }
}

fn errors(steps: &[&SweepStep], methods: &[&str]) -> PlotPanel {
    let lines = lines(steps, methods, false, |step| step.azimuth_error_median_deg);
    let values = lines.iter().flat_map(|line| line.values.iter().flatten().copied());
    PlotPanel {
        title: String::new(),
        steps: step_labels(steps, methods),
        y: PlotAxis::around("median azimuth error, °", Scale::Log, values),
        lines,
    }
}

/// Returns one line a method.
fn lines(
    steps: &[&SweepStep],
    methods: &[&str],
    is_dashed: bool,
    value: fn(&SweepStep) -> Option<f64>,
) -> Vec<PlotLine> {
    let line = |(series, method): (usize, &&str)| PlotLine {
        series,
        values: of_method(steps, method).map(value).collect(),
        is_dashed,
    };
    methods.iter().enumerate().map(line).collect()
}

fn of_method<'a>(steps: &'a [&SweepStep], method: &'a str) -> impl Iterator<Item = &'a SweepStep> {
    steps.iter().copied().filter(move |step| step.method == method)
}

fn step_labels(steps: &[&SweepStep], methods: &[&str]) -> Vec<String> {
    let first = methods.first().copied().unwrap_or_default();
    of_method(steps, first).map(|step| format!("{}", step.amount)).collect()
}

/// Returns the detectors that photos are spoiled for: the default, the library it rests on as it comes, and the fastest rival; those of them that
/// read the scene's tags.
pub fn detectors(scene: &Scene) -> Vec<TagDetectorChoice> {
    let reads_all = |choice: &TagDetectorChoice| scene.families().iter().all(|family| choice.reads(*family));
    let compared = [
        TagDetectorChoice::default(),
        TagDetectorChoice::AprilTagC(CornersBy::Library),
        TagDetectorChoice::Locus,
    ];
    compared.into_iter().filter(reads_all).collect()
}

/// Writes a line a sweep and method: the amount up to which nearly all is answered, and the largest share that was silently wrong.
pub fn summary(steps: &[SweepStep]) -> String {
    let mut text =
        "condition              method             views    90 % answered up to   silently wrong, at worst\n"
            .to_owned();
    for (sweep, method) in distinct(steps.iter().map(|step| (step.sweep, step.method))) {
        let of = || steps.iter().filter(|s| (s.sweep, s.method) == (sweep, method));
        let views: usize = of().map(|s| s.views).sum();
        let good = of().take_while(|s| s.answered >= 0.9).last();
        let good = good.map_or("–".to_owned(), |s| s.amount.to_string());
        let worst = of().max_by(|a, b| a.silently_wrong.total_cmp(&b.silently_wrong));
        let worst = worst.map_or(String::new(), |s| match s.silently_wrong {
            0.0 => "never".to_owned(),
            share => format!("{:.2} % at {}", 100.0 * share, s.amount),
        });
        text += &format!("{sweep:<22} {method:<16} {views:>7} {good:>22} {worst:>26}\n");
    }
    text
}
