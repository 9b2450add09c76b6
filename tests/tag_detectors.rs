//! The tag detectors against exact corners: the stored session's truth, rendered tags, real photos.

mod common;

use std::time::Instant;

use common::{read_json, skyline};
use image::GrayImage;
use nalgebra::{Matrix4, Point3};
use scaleproof::camera::Camera;
use scaleproof::geometry::angle::turn;
use scaleproof::locate::locate;
use scaleproof::photo::Photo;
use scaleproof::scene::{Scene, TagFamily};
use scaleproof::tags::{SeenTag, TagDetector, TagDetectorChoice};

type Corners = [[f64; 2]; 4];

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Exact pose of a stored photo, and the corners of its tags from it.
struct Truth {
    file: String,
    t_camera_model: Matrix4<f64>,
    azimuth_deg: f64,
    pitch_deg: f64,
    distance_mm: f64,
}

impl Truth {
    fn of_session() -> Vec<Truth> {
        let json = read_json(&skyline().join("truth.json"));
        let of = |photo: &serde_json::Value| {
            let number = |key: &str| photo[key].as_f64().unwrap();
            Truth {
                file: photo["file"].as_str().unwrap().to_owned(),
                t_camera_model: Matrix4::from_fn(|r, c| photo["T_camera_model_mm"][r][c].as_f64().unwrap()),
                azimuth_deg: number("azimuth_deg"),
                pitch_deg: number("pitch_deg"),
                distance_mm: number("distance_mm"),
            }
        };
        json["photos"].as_array().unwrap().iter().map(of).collect()
    }

    fn corners(&self, scene: &Scene, camera: &Camera, family: TagFamily, id: u32) -> Option<Corners> {
        let corners = scene.tag(family, id)?.corners_mm();
        let mut px = [[0.0; 2]; 4];
        for (px, corner) in px.iter_mut().zip(corners) {
            *px = camera.project(&Point3::from_homogeneous(self.t_camera_model * corner.to_homogeneous())?)?;
        }
        Some(px)
    }
}

fn enlarged(grey: &GrayImage, factor: u32) -> GrayImage {
    let (w, h) = (grey.width() * factor, grey.height() * factor);
    image::imageops::resize(grey, w, h, image::imageops::FilterType::CatmullRom)
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(((values.len() as f64 - 1.0) * q).round() as usize).copied().unwrap_or(f64::NAN)
}

#[test]
fn table_of_the_detectors_on_the_stored_session() {
    let scene = Scene::open(&skyline().join("scene.toml")).unwrap();
    let camera = Camera::open(&skyline().join("camera.yaml")).unwrap();
    for factor in [1, 3] {
        let pictures: Vec<(Truth, GrayImage)> = Truth::of_session()
            .into_iter()
            .map(|truth| {
                let photo = Photo::open(&skyline().join(&truth.file)).unwrap();
                let grey = enlarged(&photo.grey(), factor);
                (truth, grey)
            })
            .collect();
        let f = f64::from(factor);
        let scaled = |c: &Camera| Camera::pinhole(
            c.width * factor,
            c.height * factor,
            c.fx * f,
            c.fy * f,
            (c.cx + 0.5) * f - 0.5,
            (c.cy + 0.5) * f - 0.5,
        ).with_distortion(c.distortion());
        let camera = scaled(&camera);
        for choice in TagDetectorChoice::ALL {
            let mut detector = choice.open(&scene.families()).unwrap();
            let (mut ms, mut tags, mut whole, mut off, mut worst, mut inward) = (vec![], 0, 0, vec![], vec![], vec![]);
            let mut pose = [vec![], vec![], vec![]];
            let mut ghosts = 0;
            for (truth, grey) in &pictures {
                let start = Instant::now();
                let seen: Vec<SeenTag> = detector.find(grey);
                ms.push(start.elapsed().as_secs_f64() * 1000.0);
                for tag in &seen {
                    let Some(exact) = truth.corners(&scene, &camera, tag.family, tag.id) else { ghosts += 1; continue };
                    tags += 1;
                    if !tag.is_whole { continue }
                    whole += 1;
                    let d: Vec<f64> = (0..4).map(|i| distance(tag.corners_px[i], exact[i])).collect();
                    let area = |c: &Corners| (0..4).map(|i| c[i][0]*c[(i+1)%4][1]-c[(i+1)%4][0]*c[i][1]).sum::<f64>().abs()/2.0;
                    let per: f64 = (0..4).map(|i| distance(exact[i], exact[(i+1)%4])).sum();
                    inward.push((area(&exact)-area(&tag.corners_px))/per);
                    worst.push(d.iter().copied().fold(0.0, f64::max));
                    off.extend(d);
                }
                if let Ok(l) = locate(&seen, &scene, &camera) {
                    pose[0].push(turn(l.viewpoint.azimuth_deg, truth.azimuth_deg).abs());
                    pose[1].push((l.viewpoint.pitch_deg - truth.pitch_deg).abs());
                    pose[2].push((l.viewpoint.distance_mm - truth.distance_mm).abs());
                }
            }
            let n = pose[0].len();
            println!("x{factor} {choice:<16} {:>7.1} ms {tags:>4} tags {whole:>4} whole {ghosts} ghosts  corner p50 {:.3} p95 {:.3} max {:.3}  worst/tag p50 {:.3}  inward {:+.3}  answered {n} az {:.4}/{:.4} pitch {:.4}/{:.4} mm {:.3}/{:.3}",
                quantile(&mut ms, 0.5), quantile(&mut off, 0.5), quantile(&mut off, 0.95), quantile(&mut off, 1.0), quantile(&mut worst, 0.5), quantile(&mut inward, 0.5),
                quantile(&mut pose[0], 0.5), quantile(&mut pose[0], 1.0), quantile(&mut pose[1], 0.5), quantile(&mut pose[1], 1.0), quantile(&mut pose[2], 0.5), quantile(&mut pose[2], 1.0));
        }
    }
}
