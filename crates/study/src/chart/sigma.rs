//! Reliability of the stated σ of poses: the share of errors within so many σ, beside that of normal errors, by the number of tags that a pose rests
//! on.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::locate::PhotoSample;
use super::spoil::Spoil;
use super::{MeasureError, truth};
use scaleproof_core::geometry::angle;
use scaleproof_core::statistics::{Interval, normal, wilson_95};
use scaleproof_core::workers;
use scaleproof_plot::{PlotAxis, PlotLine, PlotPanel, Scale, distinct, panels};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{FOCAL_SHARE, Located, SPREAD, Sigma, area_px, locate, locate_luma};
use scaleproof_pose::scene::{Scene, Tag, Viewpoint};
use scaleproof_pose::simulate::{Noise, SimulatedFault, Simulator};
use scaleproof_pose::tags::{SeenTag, TagDetectorChoice};
use scaleproof_session::Session;

/// Multiples of σ within which the shares of errors are compared.
const SIGMAS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0];

/// Numbers of tags that a pose rests on; the last stands for all larger numbers.
const TAGS: [usize; 4] = [1, 2, 3, 4];

/// Stated probability from which a bin is called sure.
const SURE: f64 = 0.99;

/// Errors of simulated views besides corner noise of 0.3 px (2 % of the corners 1.2 px): name, bow of the cards in mm in 100 (see
/// [`SimulatedFault::BentPaper`]), and corner noise as a share of the tag's side; with it, all noise of a view is larger or smaller at random, as it
/// differs between real photos.
const SIMULATED: [(&str, f64, f64); 3] = [
    ("simulated: corner noise", 0.0, 0.0),
    ("simulated: bent paper", 1.5, 0.0),
    ("simulated: noise as on paper", 0.0, 0.009),
];

/// Light at the dark end of each tag of a photo lit unevenly, as a share of that at its bright end.
const LAMP: f64 = 0.4;

/// Tags that were seen together, and the true viewpoint. The scene has no other tags.
#[derive(Debug, Clone)]
pub struct SigmaView {
    pub seen: Vec<SeenTag>,
    pub scene: Scene,
    pub camera: Camera,
    pub truth: Viewpoint,
    /// Standard deviations of the truth itself; 0 where it is exact.
    pub truth_sigma: Sigma,
}

#[derive(Debug, Clone, Default)]
pub struct SigmaErrors {
    pub views: usize,
    /// Errors of azimuth, elevation and distance of each answered view, in σ.
    pub in_sigmas: Vec<[f64; 3]>,
    /// Bins stated with 99 % or more, and how many of them were wrong.
    pub sure_bins: usize,
    pub wrong_sure_bins: usize,
}

/// Share of errors within a number of σ.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SigmaCoverage {
    pub sigmas: f64,
    /// Share of normal errors whose σ is true.
    pub expected: f64,
    /// Share of the measured errors.
    pub met: f64,
    /// 95 % interval of `met` (Wilson), as if the errors were independent.
    pub met_95: Interval,
}

/// Poses by some number of tags, on photos of a session or on simulated views.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SigmaRow {
    /// Name of the sessions, or what was simulated.
    pub material: String,
    /// Tags that were seen: 1, 2, 3, or 4 for four and more.
    pub tags: usize,
    /// Number of times that so many tags were seen together, and of those that gave a pose.
    pub views: usize,
    pub answered: usize,
    /// Poses whose bin is stated with a probability of at least 99 %, and how many of these bins are wrong.
    pub sure_bins: usize,
    pub wrong_sure_bins: usize,
    /// Errors of the three numbers of the viewpoint; empty where nothing was answered.
    pub azimuth: Vec<SigmaCoverage>,
    pub pitch: Vec<SigmaCoverage>,
    pub distance: Vec<SigmaCoverage>,
}

/// Returns views of a session's photos: its tags one by one, by random twos and threes, and by random fours and more. `is_lit`: of copies of the
/// photos lit unevenly. `on_photo` is called after each photo.
pub fn of_photos(
    session: &Session,
    truth: &Path,
    is_lit: bool,
    seed: u64,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<SigmaView>, MeasureError> {
    let (scene, camera) = (&session.scene, session.known_camera()?);
    let samples = PhotoSample::of_session(session, truth, || ())?;
    let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let jobs: Vec<_> = (seed..).zip(samples).zip(truth::true_sigmas(truth, &names)?).collect();
    let views = workers::map(
        &jobs,
        || Ok::<_, MeasureError>(TagDetectorChoice::default().open(&scene.families())?),
        |detector, ((seed, sample), truth_sigma)| {
            let mut rng = Pcg64Mcg::seed_from_u64(*seed);
            let mut luma = sample.luma.clone();
            if is_lit {
                let tags: Vec<_> = detector.find(&luma).iter().map(|tag| tag.corners_px).collect();
                luma = Spoil::Lamp.apply(&luma, LAMP, &tags, &mut rng);
            }
            let found = locate_luma(&luma, sample.turned_deg, None, scene, camera, detector.as_mut());
            let camera = found.fitted?.camera;
            on_photo();
            let view = |seen: Vec<SeenTag>| SigmaView {
                scene: of_tags(scene, &seen),
                seen,
                camera: camera.clone(),
                truth: sample.truth,
                truth_sigma: *truth_sigma,
            };
            let chosen = TAGS
                .iter()
                .flat_map(|tags| subsets(&found.seen, scene, *tags, &mut rng));
            Ok(chosen.map(view).collect::<Vec<_>>())
        },
        || {},
    )?;
    Ok(views.into_iter().flatten().collect())
}

/// Returns different random subsets of so many of the tags that the scene has (the last of [`TAGS`]: or more): for each tag one that it is in.
fn subsets(seen: &[SeenTag], scene: &Scene, tags: usize, rng: &mut Pcg64Mcg) -> Vec<Vec<SeenTag>> {
    let usable: Vec<&SeenTag> = seen.iter().filter(|tag| known(scene, tag).is_some()).collect();
    let all = usable.len();
    if all < tags {
        return Vec::new();
    }
    let draw = |i: usize| {
        let number = rng.random_range(tags..=if tags == TAGS[3] { all } else { tags });
        let mut drawn: Vec<usize> = (0..all).collect();
        drawn.swap(0, i);
        (1..number).for_each(|k| drawn.swap(k, rng.random_range(k..all)));
        drawn.truncate(number);
        drawn.sort_unstable();
        drawn
    };
    let different: BTreeSet<Vec<usize>> = (0..all).map(draw).collect();
    let of = |indices: Vec<usize>| indices.into_iter().map(|i| usable[i].clone()).collect();
    different.into_iter().map(of).collect()
}

fn known<'a>(scene: &'a Scene, seen: &SeenTag) -> Option<&'a Tag> {
    scene.tag(seen.family, seen.id)
}

/// Returns the scene with the seen tags alone, so that no other tag is missing.
fn of_tags(scene: &Scene, seen: &[SeenTag]) -> Scene {
    Scene {
        tags: seen.iter().filter_map(|tag| known(scene, tag).cloned()).collect(),
        ..scene.clone()
    }
}

/// Simulates `views` views of a scene for each number of tags, under each of the conditions simulated. The same seed gives the same views.
pub fn simulated(scene: &Scene, camera: &Camera, views: usize, seed: u64) -> Vec<(String, Vec<SigmaView>)> {
    let of = |faults, tags| {
        let seeds = (0..views as u64).map(move |view| (seed << 32) + view);
        seeds.filter_map(move |seed| one_view(scene, camera, faults, tags, seed))
    };
    let material = |(name, bow_mm, share): (&str, f64, f64)| {
        let views = TAGS.into_iter().flat_map(|tags| of((bow_mm, share), tags));
        (name.to_owned(), views.collect())
    };
    SIMULATED.into_iter().map(material).collect()
}

/// Simulates a view of `tags` tags; `None` where fewer are seen.
fn one_view(scene: &Scene, camera: &Camera, (bow_mm, share): (f64, f64), tags: usize, seed: u64) -> Option<SigmaView> {
    let mut rng = Pcg64Mcg::seed_from_u64(!seed);
    let times = if share > 0.0 {
        (SPREAD.sqrt() / 2.0 * normal::draw(&mut rng)).exp()
    } else {
        1.0
    };
    let noise = Noise {
        sigma_px: 0.3 * times,
        tail_share: 0.02,
    };
    let mut simulator = Simulator::new(scene, camera, noise, seed);
    let viewpoint = simulator.viewpoint(5.0..40.0, 600.0..1600.0);
    let fault = (bow_mm > 0.0).then_some(SimulatedFault::BentPaper { mm: bow_mm });
    let mut view = simulator.view(&viewpoint, fault);
    for tag in &mut view.seen {
        let paper_px = times * share * area_px(&tag.corners_px).sqrt();
        tag.corners_px = tag
            .corners_px
            .map(|px| px.map(|v| v + paper_px * normal::draw(&mut rng)));
    }
    let mut all = subsets(&view.seen, scene, tags, &mut rng);
    let seen = (!all.is_empty()).then(|| all.swap_remove(rng.random_range(0..all.len())))?;
    // The camera file is as far off as σ assumes.
    let mut camera = camera.clone();
    camera.fx *= 1.0 + FOCAL_SHARE * normal::draw(&mut rng);
    camera.fy *= 1.0 + FOCAL_SHARE * normal::draw(&mut rng);
    Some(SigmaView {
        scene: of_tags(scene, &seen),
        seen,
        camera,
        truth: viewpoint,
        truth_sigma: truth::EXACT,
    })
}

/// Locates the views, and returns the errors by number of tags.
pub fn errors(views: &[SigmaView]) -> [SigmaErrors; 4] {
    let answers = workers::each(views, |view| locate(&view.seen, &view.scene, &view.camera).ok());
    let mut all: [SigmaErrors; 4] = Default::default();
    for (view, answer) in views.iter().zip(answers) {
        all[view.seen.len().clamp(1, 4) - 1].count(view, answer);
    }
    all
}

impl SigmaErrors {
    fn count(&mut self, view: &SigmaView, answer: Option<Located>) {
        self.views += 1;
        let Some(located) = answer else { return };
        let (v, truth) = (&located.viewpoint, &view.truth);
        let off = [
            angle::turn(v.azimuth_deg, truth.azimuth_deg),
            v.pitch_deg - truth.pitch_deg,
            v.distance_mm - truth.distance_mm,
        ];
        let (stated, of_truth) = (numbers(&located.sigma), numbers(&view.truth_sigma));
        self.in_sigmas
            .push(std::array::from_fn(|i| off[i].abs() / stated[i].hypot(of_truth[i])));
        if located.bin_probability >= SURE {
            self.sure_bins += 1;
            self.wrong_sure_bins += usize::from(located.bin != view.scene.bins.bin_of(truth));
        }
    }

    pub fn row(&self, material: &str, tags: usize) -> SigmaRow {
        let [azimuth, pitch, distance] = std::array::from_fn(|i| self.coverages(i));
        SigmaRow {
            material: material.to_owned(),
            tags,
            views: self.views,
            answered: self.in_sigmas.len(),
            sure_bins: self.sure_bins,
            wrong_sure_bins: self.wrong_sure_bins,
            azimuth,
            pitch,
            distance,
        }
    }

    fn coverages(&self, number: usize) -> Vec<SigmaCoverage> {
        let all = self.in_sigmas.len();
        let coverage = |sigmas: f64| {
            let within = self.in_sigmas.iter().filter(|off| off[number] <= sigmas).count();
            let (low, high) = wilson_95(within, all)?;
            Some(SigmaCoverage {
                sigmas,
                expected: normal::between(-sigmas, sigmas, 0.0, 1.0),
                met: within as f64 / all as f64,
                met_95: Interval { low, high },
            })
        };
        SIGMAS.into_iter().filter_map(coverage).collect()
    }
}

fn numbers(sigma: &Sigma) -> [f64; 3] {
    [sigma.azimuth_deg, sigma.pitch_deg, sigma.distance_mm]
}

/// Returns rows of sessions, those of one name together, and of views simulated on the first of them, with copies of its photos lit unevenly; without
/// views, of the photos alone. `on_photo` is called after each photo of [`photos`].
pub fn measure(
    sessions: &[(Session, PathBuf)],
    views: usize,
    seed: u64,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<SigmaRow>, MeasureError> {
    let mut materials = Vec::new();
    for (session, truth) in sessions {
        let photos = of_photos(session, truth, false, seed, &on_photo)?;
        materials.push((session.name.clone(), photos));
    }
    if let Some((session, truth)) = sessions.first().filter(|_| views > 0) {
        let lit = of_photos(session, truth, true, seed, &on_photo)?;
        materials.push((format!("{}: uneven light", session.name), lit));
        materials.extend(simulated(&session.scene, session.known_camera()?, views, seed));
    }
    let names = distinct(materials.iter().map(|(name, _)| name.clone()));
    let rows = names.iter().flat_map(|name| {
        let same = materials.iter().filter(|(other, _)| other == name);
        let views: Vec<SigmaView> = same.flat_map(|(_, views)| views.iter().cloned()).collect();
        let errors = errors(&views)
            .into_iter()
            .zip(TAGS)
            .filter(|(errors, _)| errors.views > 0);
        errors.map(|(errors, tags)| errors.row(name, tags)).collect::<Vec<_>>()
    });
    Ok(rows.collect())
}

/// Returns the number of photos that [`measure`] locates.
pub fn photos(sessions: &[(Session, PathBuf)], views: usize) -> usize {
    let of = |(session, _): &(Session, PathBuf)| session.photos.len();
    sessions.iter().map(of).sum::<usize>() + sessions.first().filter(|_| views > 0).map_or(0, of)
}

const QUANTITIES: [&str; 4] = ["azimuth", "pitch", "distance", "normal errors"];

/// Draws a page of panels, a row a material and a column a number of tags: the share of errors within so many σ, dashed where normal.
pub fn draw(rows: &[SigmaRow]) -> String {
    let notes = [
        "Share of errors within so many of the stated σ. Dashed: of normal errors whose σ is true. Lines below it: σ is too small; above: too large."
            .to_owned(),
    ];
    let of = |material: String| {
        TAGS.map(|tags| {
            let row = rows.iter().find(|row| row.material == material && row.tags == tags);
            panel(row, &material, tags)
        })
    };
    let all: Vec<PlotPanel> = distinct(rows.iter().map(|row| row.material.clone()))
        .into_iter()
        .flat_map(of)
        .collect();
    panels(
        "Reliability of σ",
        &notes,
        &QUANTITIES.map(str::to_owned),
        TAGS.len(),
        &all,
    )
    .svg()
}

fn panel(row: Option<&SigmaRow>, material: &str, tags: usize) -> PlotPanel {
    let line = |(series, coverages): (usize, &[SigmaCoverage])| PlotLine {
        series,
        values: coverages.iter().map(|coverage| Some(coverage.met)).collect(),
        is_dashed: false,
    };
    let measured = row.map(|row| [&row.azimuth[..], &row.pitch, &row.distance]);
    let normal = SIGMAS.map(|sigmas| Some(normal::between(-sigmas, sigmas, 0.0, 1.0)));
    let lines = measured.into_iter().flatten().enumerate().map(line);
    let answered = row.map_or(0, |row| row.answered);
    PlotPanel {
        title: if tags == 1 { material.to_owned() } else { String::new() },
        steps: SIGMAS.map(|sigmas| format!("{sigmas} σ")).to_vec(),
        y: PlotAxis {
            title: format!("{}, {answered} poses", in_words(tags)),
            scale: Scale::Linear,
            low: 0.0,
            high: 1.0,
        },
        lines: lines
            .chain([PlotLine {
                series: 3,
                values: normal.to_vec(),
                is_dashed: true,
            }])
            .collect(),
    }
}

fn in_words(tags: usize) -> &'static str {
    ["one tag", "two tags", "three tags", "four tags or more"][tags.clamp(1, 4) - 1]
}

/// Writes the rows as lines of text: shares within 1, 2 and 3 σ of azimuth, elevation and distance.
pub fn table(rows: &[SigmaRow]) -> String {
    let mut text = "material                      tags  views  answered   azimuth 1 2 3 σ, %     pitch 1 2 3 σ, %   distance 1 2 3 σ, %  sure bins wrong\n".to_owned();
    for row in rows {
        let shares = |coverages: &[SigmaCoverage]| {
            let at = [1, 3, 5].map(|i| {
                coverages
                    .get(i)
                    .map_or("–".to_owned(), |c| format!("{:.1}", 100.0 * c.met))
            });
            at.join(" / ")
        };
        let more = if row.tags == TAGS[3] { "+" } else { " " };
        let (material, tags, views, answered) = (&row.material, row.tags, row.views, row.answered);
        let [azimuth, pitch, distance] = [&row.azimuth, &row.pitch, &row.distance].map(|c| shares(c));
        let sure = format!("{} of {}", row.wrong_sure_bins, row.sure_bins);
        text += &format!(
            "{material:<30}{tags:>3}{more} {views:>6} {answered:>9}  {azimuth:>20} {pitch:>20} {distance:>21}  {sure:>15}\n"
        );
    }
    text + &format!("{:<51}  {:>20}\n", "normal errors", "68.3 / 95.4 / 99.7")
}
