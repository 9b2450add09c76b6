//! What `advise` advises without the truth, held against the best choice with it; and whether it knows another camera's file.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::common;

use common::{rendered, skyline};
use image::{GrayImage, imageops};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_photo::Photo;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bins, Envelope, ScaleModel, Scene, TagFamily, TagRing, Viewpoint};
use scaleproof_session::Session;
use scaleproof_study::advise::{CameraVerdict, Choice, PoseAdvice, Question, Sample, advise_poses};
use scaleproof_study::chart::{Spoil, locate::is_silently_wrong, true_views};

/// A session whose truth is known.
#[derive(Clone)]
struct Known {
    name: &'static str,
    samples: Vec<Sample>,
    truths: Vec<Viewpoint>,
    scene: Scene,
    camera: Camera,
}

/// Photos of each session: enough to tell.
const PHOTOS: usize = 10;

/// The first of the stored photos.
fn stored() -> Known {
    let session = Session::open(&skyline()).unwrap();
    let files: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_views(&skyline().join("truth.json"), &files).unwrap();
    let sample = |file: &&str| {
        let photo = Photo::open(&skyline().join(file)).unwrap();
        Sample {
            file: (*file).to_owned(),
            luma: photo.luma().unwrap(),
            turned_deg: 0,
        }
    };
    Known {
        name: "as stored",
        samples: files.iter().take(PHOTOS).map(sample).collect(),
        truths: truths[..PHOTOS].to_vec(),
        scene: session.scene.clone(),
        camera: session.camera.clone().unwrap(),
    }
}

impl Known {
    fn with(&self, name: &'static str, change: impl Fn(&GrayImage) -> GrayImage) -> Known {
        let samples = self.samples.iter().map(|sample| Sample {
            luma: change(&sample.luma),
            ..sample.clone()
        });
        Known {
            name,
            samples: samples.collect(),
            truths: self.truths.clone(),
            scene: self.scene.clone(),
            camera: self.camera.clone(),
        }
    }

    fn spoiled(&self, name: &'static str, by: &[(Spoil, f64)]) -> Known {
        self.with(name, |luma| {
            let mut rng = Pcg64Mcg::seed_from_u64(4);
            by.iter().fold(luma.clone(), |luma, (spoil, amount)| {
                spoil.apply(&luma, *amount, &[], &mut rng)
            })
        })
    }
}

/// The angle between the true direction and that of a choice, for each photo that it locates.
fn true_errors_deg(choice: &Choice, truths: &[Viewpoint]) -> Vec<Option<f64>> {
    let direction = |v: &Viewpoint| {
        let (azimuth, pitch) = (v.azimuth_deg.to_radians(), v.pitch_deg.to_radians());
        nalgebra::Vector3::new(azimuth.cos() * pitch.cos(), azimuth.sin() * pitch.cos(), pitch.sin())
    };
    let views = choice.viewpoints.iter().zip(truths);
    views
        .map(|(own, truth)| Some(direction(own.as_ref()?).angle(&direction(truth)).to_degrees()))
        .collect()
}

/// The mean over some photos.
fn mean_deg<'a>(errors: impl IntoIterator<Item = &'a Option<f64>>) -> f64 {
    let errors: Vec<f64> = errors.into_iter().copied().flatten().collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// The mean error of the choice that is best by the truth, told for each half of the photos from the other half: the smallest of many means is smaller
/// than any choice's own.
fn best_error_deg(choices: &[Vec<Option<f64>>]) -> f64 {
    let half = |errors: &[Option<f64>], odd: usize| -> Vec<Option<f64>> {
        errors.iter().skip(odd).step_by(2).copied().collect()
    };
    let of_best = |odd: usize| {
        let best = choices
            .iter()
            .min_by(|a, b| mean_deg(&half(a, 1 - odd)).total_cmp(&mean_deg(&half(b, 1 - odd))));
        half(best.unwrap(), odd)
    };
    mean_deg(&[of_best(0), of_best(1)].concat())
}

fn advice(known: &Known) -> PoseAdvice {
    advise_poses(&known.samples, &known.scene, &known.camera, || {}).unwrap()
}

/// A session that is rendered: what differs from the usual one.
struct Setup {
    /// Of a 1:10 model; lengths follow.
    scale: f64,
    cards: u32,
    tag_mm: f64,
    pitch_deg: f64,
    distance_mm: f64,
    size: (u32, u32),
    /// Focal length by width.
    focal: f64,
    distortion: &'static [f64],
}

const USUAL: Setup = Setup {
    scale: 10.0,
    cards: 8,
    tag_mm: 50.0,
    pitch_deg: 15.0,
    distance_mm: 850.0,
    size: (800, 600),
    focal: 0.92,
    distortion: &[-0.08, 0.03],
};

impl Setup {
    /// Photos all round, each a little off its direction; only the tags that `keeps` says are there.
    fn rendered(&self, name: &'static str, keeps: impl Fn(u32) -> bool) -> Known {
        let by = 10.0 / self.scale;
        let (width, height) = self.size;
        let focal = self.focal * f64::from(width);
        let camera = Camera::pinhole(
            width,
            height,
            focal,
            focal,
            f64::from(width) / 2.0 + 3.0,
            f64::from(height) / 2.0 - 4.0,
        )
        .with_distortion(self.distortion);
        let ring = TagRing {
            model: ScaleModel {
                name: "box".to_owned(),
                scale: self.scale,
                class: "car".parse().unwrap(),
                size_mm: [455.0, 186.0, 129.0].map(|mm| mm * by),
                envelope: Envelope::Box,
                mesh: Default::default(),
            },
            bins: Bins {
                azimuth_deg: 45.0,
                pitch_deg: vec![self.pitch_deg],
                distance_mm: vec![self.distance_mm * by],
            },
            radius_mm: 400.0 * by,
            count: self.cards,
            tag_mm: self.tag_mm * by,
            family: TagFamily::Tag36h11,
            tilt_deg: 60.0,
        };
        let mut scene = ring.scene().unwrap();
        scene.tags.retain(|tag| keeps(tag.id));
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let mut near = |value: f64, by: f64| value + rng.random_range(-by..by);
        let truths: Vec<Viewpoint> = (0..PHOTOS)
            .map(|i| Viewpoint {
                azimuth_deg: near(45.0 * i as f64, 10.0).rem_euclid(360.0),
                pitch_deg: near(self.pitch_deg, 2.0),
                distance_mm: near(self.distance_mm * by, 30.0 * by),
            })
            .collect();
        let photos = rendered::photos(&scene, &camera, &truths);
        let samples = photos.into_iter().enumerate().map(|(i, luma)| Sample {
            file: format!("{i}.png"),
            luma,
            turned_deg: 0,
        });
        Known {
            name,
            samples: samples.collect(),
            truths,
            scene,
            camera,
        }
    }
}

/// Photos of the usual setup: rendered once for all tests.
static USUAL_SESSION: LazyLock<Known> = LazyLock::new(|| USUAL.rendered("usual", |_| true));

/// Twelve sessions that are rendered and differ: few tags, wide and long lenses, small models, bad light.
fn rendered_sessions() -> Vec<Known> {
    let all = |_: u32| true;
    vec![
        USUAL_SESSION.clone(),
        Setup { cards: 4, ..USUAL }.rendered("4 cards", all),
        USUAL.rendered("flat tags alone", |id| id < 8),
        USUAL.rendered("outer faces alone", |id| id >= 8 && id % 2 == 0),
        Setup {
            focal: 0.5,
            distortion: &[-0.22, 0.05],
            distance_mm: 700.0,
            ..USUAL
        }
        .rendered("wide lens", all),
        Setup {
            focal: 0.55,
            distortion: &[-0.28, 0.1, 0.002, -0.002],
            distance_mm: 750.0,
            ..USUAL
        }
        .rendered("wide lens, off its axis", all)
        .spoiled("wide lens, off its axis, noise", &[(Spoil::Noise, 6.0)]),
        Setup {
            focal: 2.2,
            distortion: &[0.1],
            distance_mm: 2000.0,
            ..USUAL
        }
        .rendered("long lens", all),
        Setup { scale: 24.0, ..USUAL }.rendered("model of 1:24", all),
        Setup {
            scale: 24.0,
            cards: 6,
            distance_mm: 1400.0,
            ..USUAL
        }
        .rendered("small and far", all),
        USUAL_SESSION.spoiled("dark and noisy", &[(Spoil::Exposure, -2.5), (Spoil::Noise, 6.0)]),
        Setup {
            pitch_deg: 45.0,
            size: (640, 480),
            ..USUAL
        }
        .rendered("", all)
        .spoiled(
            "from above, out of focus, JPEG",
            &[(Spoil::Blur, 1.2), (Spoil::Jpeg, 30.0)],
        ),
        Setup { tag_mm: 25.0, ..USUAL }
            .rendered("", all)
            .spoiled("small tags, moved", &[(Spoil::Motion, 3.0)]),
    ]
}

/// The stored photos, which are path-traced, and sessions made of them.
fn stored_sessions() -> Vec<Known> {
    let stored = stored();
    let half = |luma: &GrayImage| {
        let (width, height) = luma.dimensions();
        imageops::resize(luma, width / 2, height / 2, imageops::FilterType::Triangle)
    };
    vec![
        stored.spoiled("stored, poor JPEG", &[(Spoil::Jpeg, 20.0)]),
        stored.with("stored, small photos", half),
        stored.with("as stored", GrayImage::clone),
    ]
}

/// What is advised without the truth is held against the best choice of each question with it.
#[test]
fn what_is_advised_is_nearly_the_best_choice() {
    let mut regrets = Vec::new();
    let mut by_question: BTreeMap<Question, Vec<[f64; 2]>> = BTreeMap::new();
    for known in rendered_sessions().iter().chain(&stored_sessions()) {
        let advice = advice(known);
        let check = advice.camera_check.as_ref();
        println!(
            "{:<34} {}",
            known.name,
            check.map_or("camera file: cannot tell".to_owned(), |check| format!(
                "camera file: {:.4}°, refitted {:.4}° {:?}, {:?} px for {:.1}: {:?}",
                check.held_out_deg,
                check.refitted_deg,
                check.better_by_95,
                check.refitted_focal_px,
                check.focal_px,
                check.verdict
            ))
        );
        // It is the true camera.
        assert!(
            check.is_none_or(|check| check.verdict == CameraVerdict::Fits),
            "{}",
            known.name
        );
        for question in Question::ALL {
            let Some(advised) = advice.advised(question) else {
                println!("{:<34} {:<17} no advice", known.name, question.title());
                continue;
            };
            let usual = advice.choices_for(question).find(|choice| choice.is_usual).unwrap();
            let own = mean_deg(&true_errors_deg(advised, &known.truths));
            let as_many = advice
                .choices_for(question)
                .filter(|choice| choice.located >= usual.located);
            let best = best_error_deg(
                &as_many
                    .map(|choice| true_errors_deg(choice, &known.truths))
                    .collect::<Vec<_>>(),
            );
            let regret = own / best - 1.0;
            println!(
                "{:<34} {:<17} {:<20} {own:.4}°, the best {best:.4}°: {:.1} %",
                known.name,
                question.title(),
                advised.name,
                100.0 * regret
            );
            regrets.push(regret);
            by_question.entry(question).or_default().push([regret, own - best]);
            // Never another bin.
            for (view, truth) in advised.viewpoints.iter().zip(&known.truths) {
                assert!(
                    !view.is_some_and(|view| is_silently_wrong(&view, truth, &known.scene)),
                    "{}: {}",
                    known.name,
                    advised.name
                );
            }
            assert!(advised.located >= usual.located);
        }
    }
    for (question, regrets) in &by_question {
        let sorted = |of: usize| {
            let mut all: Vec<f64> = regrets.iter().map(|regret| regret[of]).collect();
            all.sort_by(f64::total_cmp);
            [all[all.len() / 2], all[all.len() - 1]]
        };
        let ([median, most], [median_deg, most_deg]) = (sorted(0), sorted(1));
        println!(
            "{:<17} {} answers: regret {:.1} % ({median_deg:.4}°) median, {:.1} % ({most_deg:.4}°) at most",
            question.title(),
            regrets.len(),
            100.0 * median,
            100.0 * most
        );
        assert!(median <= 0.05, "{}: {median}", question.title());
    }
    regrets.sort_by(f64::total_cmp);
    let median = regrets[regrets.len() / 2];
    println!(
        "{} answers, median regret {:.2} %, the largest {:.1} %",
        regrets.len(),
        100.0 * median,
        100.0 * regrets[regrets.len() - 1]
    );
    assert!(regrets.len() >= 60, "it hardly ever answers: {}", regrets.len());
    assert!(median <= 0.05, "{median}");
}

/// The file of a camera with another zoom or lens is known by the photos; turned photos say the same as upright ones.
#[test]
fn the_file_of_another_camera_is_noticed() {
    let known = &*USUAL_SESSION;
    let right = advice(known).camera_check.unwrap();
    assert_eq!(right.verdict, CameraVerdict::Fits, "{right:?}");
    let wrong = |camera: Camera| {
        let known = Known {
            camera,
            ..known.clone()
        };
        advice(&known).camera_check.unwrap()
    };
    let mut zoomed = known.camera.clone();
    (zoomed.fx, zoomed.fy) = (1.05 * zoomed.fx, 1.05 * zoomed.fy);
    let mut other_lens = known.camera.clone().with_distortion(&[0.08, 0.0]);
    other_lens.sigma_px = None;
    for camera in [zoomed, other_lens] {
        let check = wrong(camera.clone());
        println!("{check:?}");
        assert_eq!(check.verdict, CameraVerdict::OtherCamera, "{check:?}");
        // Both halves find the true focal length.
        for focal in check.refitted_focal_px {
            assert!((focal / known.camera.fx - 1.0).abs() < 0.01, "{check:?}");
        }
    }
    // Every other photo was zoomed: no camera fits all, and no way is judged by such poses.
    let other_zoom = Setup {
        focal: 1.04 * USUAL.focal,
        ..USUAL
    }
    .rendered("zoomed", |_| true);
    let mut mixed = known.clone();
    for (own, other) in mixed.samples.iter_mut().zip(other_zoom.samples).step_by(2) {
        *own = other;
    }
    let mixed = advice(&mixed);
    assert!(mixed.disagreeing >= 3, "{mixed:?}");
    assert_eq!(mixed.camera_check.unwrap().verdict, CameraVerdict::NoCameraFits);
    assert!(mixed.choices.is_empty() && mixed.abstention.unwrap().contains("camera file does not fit"));
    // A file that is too wrong for most photos to be located.
    let mut far_off = known.camera.clone();
    (far_off.fx, far_off.fy) = (1.3 * far_off.fx, 1.3 * far_off.fy);
    let far_off = advise_poses(&known.samples, &known.scene, &far_off, || {});
    let why = far_off.map_or_else(|e| e.to_string(), |advice| advice.abstention.unwrap());
    assert!(why.contains("disagree with scene and camera"), "{why}");
    let turned = Known {
        samples: known
            .samples
            .iter()
            .map(|sample| Sample {
                luma: imageops::rotate90(&sample.luma),
                turned_deg: 90,
                ..sample.clone()
            })
            .collect(),
        ..known.clone()
    };
    let turned = advice(&turned).camera_check.unwrap();
    assert_eq!(turned.verdict, CameraVerdict::Fits);
    for (upright, turned) in right.refitted_focal_px.iter().zip(turned.refitted_focal_px) {
        assert!((upright / turned - 1.0).abs() < 2e-3, "{upright} {turned}");
    }
}
