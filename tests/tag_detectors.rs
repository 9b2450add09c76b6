//! The tag detectors against exact corners: the stored session's truth, rendered tags, real photos.

mod common;

use std::time::Instant;

use common::{read_json, skyline};
use image::GrayImage;
use nalgebra::{Matrix4, Point3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof::camera::Camera;
use scaleproof::geometry::angle::turn;
use scaleproof::locate::locate;
use scaleproof::photo::Photo;
use scaleproof::scene::{Scene, TagFamily};
use scaleproof::tags::{SeenTag, TagDetector, TagDetectorChoice, TagImage};

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
            *px = camera.project(&Point3::from_homogeneous(
                self.t_camera_model * corner.to_homogeneous(),
            )?)?;
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
    values
        .get(((values.len() as f64 - 1.0) * q).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

#[test]
fn table_of_the_detectors_on_the_stored_session() {
    let scene = Scene::open(&skyline().join("scene.toml")).unwrap();
    let camera = Camera::open(&skyline().join("camera.yaml")).unwrap();
    for factor in [1, 3] {
        let quick = |c: TagDetectorChoice| {
            factor == 1 || matches!(c, TagDetectorChoice::CoarseToFine | TagDetectorChoice::Locus)
        };
        let pictures: Vec<(Truth, GrayImage)> = Truth::of_session()
            .into_iter()
            .map(|truth| {
                let photo = Photo::open(&skyline().join(&truth.file)).unwrap();
                let grey = enlarged(&photo.grey(), factor);
                (truth, grey)
            })
            .collect();
        let f = f64::from(factor);
        let scaled = |c: &Camera| {
            Camera::pinhole(
                c.width * factor,
                c.height * factor,
                c.fx * f,
                c.fy * f,
                (c.cx + 0.5) * f - 0.5,
                (c.cy + 0.5) * f - 0.5,
            )
            .with_distortion(c.distortion())
        };
        let camera = scaled(&camera);
        for choice in TagDetectorChoice::ALL.into_iter().filter(|c| quick(*c)) {
            let mut detector = choice.open(&scene.families()).unwrap();
            let (mut ms, mut tags, mut whole, mut off, mut worst, mut inward) = (vec![], 0, 0, vec![], vec![], vec![]);
            let mut pose = [vec![], vec![], vec![]];
            let mut ghosts = 0;
            for (truth, grey) in &pictures {
                let start = Instant::now();
                let seen: Vec<SeenTag> = detector.find(grey);
                ms.push(start.elapsed().as_secs_f64() * 1000.0);
                for tag in &seen {
                    let Some(exact) = truth.corners(&scene, &camera, tag.family, tag.id) else {
                        ghosts += 1;
                        continue;
                    };
                    tags += 1;
                    if !tag.is_whole {
                        continue;
                    }
                    whole += 1;
                    let d: Vec<f64> = (0..4).map(|i| distance(tag.corners_px[i], exact[i])).collect();
                    let area = |c: &Corners| {
                        (0..4)
                            .map(|i| c[i][0] * c[(i + 1) % 4][1] - c[(i + 1) % 4][0] * c[i][1])
                            .sum::<f64>()
                            .abs()
                            / 2.0
                    };
                    let per: f64 = (0..4).map(|i| distance(exact[i], exact[(i + 1) % 4])).sum();
                    inward.push((area(&exact) - area(&tag.corners_px)) / per);
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
            println!(
                "x{factor} {choice:<16} {:>7.1} ms {tags:>4} tags {whole:>4} whole {ghosts} ghosts  corner p50 {:.3} p95 {:.3} max {:.3}  worst/tag p50 {:.3}  inward {:+.3}  answered {n} az {:.4}/{:.4} pitch {:.4}/{:.4} mm {:.3}/{:.3}",
                quantile(&mut ms, 0.5),
                quantile(&mut off, 0.5),
                quantile(&mut off, 0.95),
                quantile(&mut off, 1.0),
                quantile(&mut worst, 0.5),
                quantile(&mut inward, 0.5),
                quantile(&mut pose[0], 0.5),
                quantile(&mut pose[0], 1.0),
                quantile(&mut pose[1], 0.5),
                quantile(&mut pose[1], 1.0),
                quantile(&mut pose[2], 0.5),
                quantile(&mut pose[2], 1.0)
            );
        }
    }
}

/// Light (0–1) to grey level (0–255).
type ToneCurve = fn(f64) -> f64;

fn srgb(light: f64) -> f64 {
    255.0
        * if light <= 0.0031308 {
            12.92 * light
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
}

fn proportional(light: f64) -> f64 {
    255.0 * light
}

/// A soft shoulder, as phones and films have it: white is pressed together.
fn filmic(light: f64) -> f64 {
    srgb(1.5 * light / (light + 0.5))
}

/// How a tag is photographed.
struct Shot {
    size: [u32; 2],
    /// Where the outline's corners are: upright tag, top-left first.
    corners: Corners,
    /// Standard deviation, px.
    blur: f64,
    tone: ToneCurve,
    /// Standard deviation, grey levels.
    noise: f64,
}

impl Shot {
    fn sharp(corners: Corners) -> Shot {
        Shot {
            size: [400, 400],
            corners,
            blur: 0.7,
            tone: srgb,
            noise: 0.0,
        }
    }

    /// The photo: exact coverage to a fifth of a pixel, blur of the light, the tone curve, noise.
    fn photo(&self, family: TagFamily, id: u32) -> GrayImage {
        let tag = TagImage::new(family, id).unwrap();
        let (modules, border) = (tag.modules(), tag.border_modules() as f64);
        let first = (modules.side() as f64 - border) / 2.0;
        let to_tag = homography(&self.corners).try_inverse().unwrap();
        let light = |x: f64, y: f64| {
            let p = to_tag * nalgebra::Vector3::new(x, y, 1.0);
            let cell = |v: f64| (v / p.z * border + first).floor();
            let (row, column) = (cell(p.y), cell(p.x));
            let side = modules.side() as f64;
            let on_card = (-2.0..side + 2.0).contains(&row) && (-2.0..side + 2.0).contains(&column);
            let black = row >= 0.0 && column >= 0.0 && modules.is_black(row as usize, column as usize);
            match (on_card, black) {
                (false, _) => 0.3,
                (true, true) => 0.04,
                (true, false) => 0.8,
            }
        };
        let [width, height] = self.size;
        let mut lights = vec![0.0; (width * height) as usize];
        for (i, mean) in lights.iter_mut().enumerate() {
            let (x, y) = ((i as u32 % width) as f64, (i as u32 / width) as f64);
            for step in 0..25 {
                let sub = |n: i32| (f64::from(n) - 2.0) / 5.0;
                *mean += light(x + sub(step % 5), y + sub(step / 5)) / 25.0;
            }
        }
        let lights = blurred(
            &blurred(&lights, width as usize, 1, self.blur),
            width as usize,
            width as usize,
            self.blur,
        );
        let mut noise = Pcg64Mcg::seed_from_u64(7);
        GrayImage::from_fn(width, height, |x, y| {
            let even: f64 = (0..12).map(|_| noise.random_range(-0.5..0.5)).sum();
            image::Luma([((self.tone)(lights[(y * width + x) as usize]) + self.noise * even)
                .round()
                .clamp(0.0, 255.0) as u8])
        })
    }
}

/// Gaussian blur along one axis: `step` 1 along rows, the width along columns. The picture's border is left as it is.
fn blurred(lights: &[f64], width: usize, step: usize, sigma: f64) -> Vec<f64> {
    const REACH: usize = 6;
    let weights: Vec<f64> = (0..=2 * REACH)
        .map(|i| (-0.5 * ((i as f64 - REACH as f64) / sigma).powi(2)).exp())
        .collect();
    let total: f64 = weights.iter().sum();
    let height = lights.len() / width;
    let inside = |v: usize, size: usize| v >= REACH && v + REACH < size;
    (0..lights.len())
        .map(|i| match inside(i % width, width) && inside(i / width, height) {
            true => {
                (0..=2 * REACH)
                    .map(|k| weights[k] * lights[i + k * step - REACH * step])
                    .sum::<f64>()
                    / total
            }
            false => lights[i],
        })
        .collect()
}

/// The unit square onto four points, by the eight linear equations.
fn homography(corners: &Corners) -> nalgebra::Matrix3<f64> {
    let mut a = nalgebra::SMatrix::<f64, 8, 8>::zeros();
    let mut b = nalgebra::SVector::<f64, 8>::zeros();
    for (i, ([x, y], [u, v])) in corners
        .iter()
        .zip([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        .enumerate()
    {
        let rows = [
            [u, v, 1.0, 0.0, 0.0, 0.0, -u * x, -v * x],
            [0.0, 0.0, 0.0, u, v, 1.0, -u * y, -v * y],
        ];
        for (k, row) in rows.iter().enumerate() {
            (0..8).for_each(|c| a[(2 * i + k, c)] = row[c]);
            b[2 * i + k] = [*x, *y][k];
        }
    }
    let h = a.lu().solve(&b).unwrap();
    nalgebra::Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0)
}

/// A tag of about 150 px seen from aside, turned in the picture by some quarters.
fn aside(quarters: usize) -> Corners {
    let mut corners = [[121.3, 118.2], [268.9, 131.4], [259.6, 279.7], [114.1, 262.5]];
    corners.rotate_right(quarters);
    corners
}

#[test]
fn every_detector_keeps_the_conventions_for_every_family_it_reads() {
    for choice in TagDetectorChoice::ALL {
        for (family, name) in TagFamily::ALL {
            if !choice.reads(family) {
                let refused = choice.open(&[family]).err().unwrap().to_string();
                assert!(refused.contains(choice.name()) && refused.contains(name), "{refused}");
                assert!(refused.contains("use one of coarse-to-fine"), "{refused}");
                continue;
            }
            let mut detector = choice.open(&[family]).unwrap();
            let mut worst = 0.0_f64;
            for (quarters, id) in [(0, 1), (1, 5), (2, 11), (3, 17)] {
                let exact = aside(quarters);
                let seen = detector.find(&Shot::sharp(exact).photo(family, id));
                let [tag] = &seen[..] else {
                    panic!("{choice}, {name} {id}: {} tags", seen.len())
                };
                assert_eq!(
                    (tag.family, tag.id, tag.is_whole),
                    (family, id, true),
                    "{choice}, {name}"
                );
                for axis in [0, 1] {
                    // Blur makes a tag smaller or larger, but does not move it: half a pixel of a wrong convention does.
                    let moved: f64 = (0..4).map(|i| tag.corners_px[i][axis] - exact[i][axis]).sum::<f64>() / 4.0;
                    assert!(moved.abs() < 0.2, "{choice}, {name} {id}: moved by {moved:.2} px");
                }
                worst = (0..4)
                    .map(|i| distance(tag.corners_px[i], exact[i]))
                    .fold(worst, f64::max);
            }
            println!("{choice:<16} {name:<18} worst corner {worst:.3} px");
            let limit = if choice == TagDetectorChoice::CoarseToFine {
                0.1
            } else {
                2.0
            };
            assert!(worst < limit, "{choice}, {name}: {worst:.3} px");
        }
    }
}

#[test]
fn a_mirrored_tag_is_no_tag() {
    let mut mirrored = aside(0);
    mirrored.swap(0, 1);
    mirrored.swap(3, 2);
    for choice in TagDetectorChoice::ALL {
        let seen = choice
            .open(&[TagFamily::Tag36h11])
            .unwrap()
            .find(&Shot::sharp(mirrored).photo(TagFamily::Tag36h11, 3));
        assert_eq!(seen, [], "{choice}");
    }
}

#[test]
fn a_cut_tag_is_not_called_whole() {
    let mut cut = aside(0);
    cut.iter_mut().for_each(|corner| corner[0] -= 118.0);
    for choice in TagDetectorChoice::ALL {
        let seen = choice
            .open(&[TagFamily::Tag36h11])
            .unwrap()
            .find(&Shot::sharp(cut).photo(TagFamily::Tag36h11, 3));
        assert!(seen.iter().all(|tag| !tag.is_whole), "{choice}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Any view, blur, tone curve and noise of a camera.
    #[test]
    fn refined_corners_are_exact(
        jitter in prop::array::uniform8(-0.14..0.14_f64),
        side in 45.0..160.0_f64,
        turn in 0.0..std::f64::consts::TAU,
        blur in 0.4..1.2_f64,
        noise in 0.0..2.0_f64,
        tone in prop::sample::select(vec![srgb as ToneCurve, proportional, filmic]),
        id in 0..587_u32,
    ) {
        let square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let (sine, cosine) = turn.sin_cos();
        let exact: Corners = std::array::from_fn(|i| {
            let (x, y) = (side * (square[i][0] + jitter[2 * i]), side * (square[i][1] + jitter[2 * i + 1]));
            [160.0 + cosine * x - sine * y, 160.0 + sine * x + cosine * y]
        });
        let shot = Shot { size: [320, 320], corners: exact, blur, tone, noise };
        let seen = TagDetectorChoice::CoarseToFine.open(&[TagFamily::Tag36h11]).unwrap()
            .find(&shot.photo(TagFamily::Tag36h11, id));
        prop_assert_eq!(seen.iter().map(|tag| tag.id).collect::<Vec<_>>(), vec![id]);
        let off = (0..4).map(|i| distance(seen[0].corners_px[i], exact[i])).fold(0.0, f64::max);
        println!("refined: side {side:.0} blur {blur:.2} noise {noise:.1} tone {:.0}: {off:.3} px", tone(0.4));
        prop_assert!(off < 0.25, "a corner is {:.3} px off", off);
    }
}

/// A scene of one tag at the origin that faces the front.
fn one_tag(family: &str, id: u32, size_mm: f64) -> Scene {
    let text = format!(
        "[model]\nname = \"m\"\nscale = 10\nclass = \"car\"\nsize_mm = [100.0, 100.0, 100.0]\n\
         [bins]\nazimuth_deg = 45\npitch_deg = [0]\ndistance_mm = [1000]\n\
         [[tag]]\nid = {id}\nfamily = \"{family}\"\nsize_mm = {size_mm}\ncentre_mm = [0.0, 0.0, 50.0]\n\
         right = [0.0, 1.0, 0.0]\nup = [0.0, 0.0, 1.0]\n"
    );
    Scene::parse(&text, std::path::Path::new("one.toml")).unwrap()
}

#[test]
fn real_photos_of_a_turned_tag_are_not_flipped() {
    let Some(folder) = common::shared("photos/tags/yaw") else {
        return;
    };
    let camera = Camera::pinhole(1056, 792, 329.873, 332.946, 528.0, 396.0);
    let (mut yaws, mut answered) = (Vec::new(), 0);
    for choice in TagDetectorChoice::ALL {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let mut line = Vec::new();
        for named in (-70..=70).step_by(10) {
            let photo = Photo::open(&folder.join(format!("yaw_{named}.png"))).unwrap();
            let seen = detector.find(&photo.grey());
            let yaw = seen.first().and_then(|tag| {
                let located = locate(&seen, &one_tag("tag36h11", tag.id, 65.0), &camera).ok()?;
                let normal = located.pose * nalgebra::Vector3::x();
                Some(normal.x.atan2(-normal.z).to_degrees())
            });
            line.push(yaw);
            answered += usize::from(yaw.is_some());
        }
        println!(
            "{choice:<16} {}",
            line.iter()
                .map(|y| y.map_or("  –   ".into(), |y| format!("{y:6.2}")))
                .collect::<Vec<_>>()
                .join(" ")
        );
        yaws.push((choice, line));
    }
    println!("{answered} answered");
}

#[test]
fn real_photos_of_a_desk_show_as_many_tags_as_at_full_size() {
    let Some(folder) = common::shared("photos/tags/desk") else {
        return;
    };
    for choice in TagDetectorChoice::ALL {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let counts: Vec<usize> = (1..=5)
            .map(|n| {
                detector
                    .find(&Photo::open(&folder.join(format!("desk_{n:02}.png"))).unwrap().grey())
                    .len()
            })
            .collect();
        println!("{choice:<16} {counts:?} {}", counts.iter().sum::<usize>());
    }
}

#[test]
fn real_photo_of_a_rover_has_its_corners_where_the_truth_file_says() {
    let Some(folder) = common::shared("photos/tags/rover") else {
        return;
    };
    let name = folder.join("apriltag_33369213973_9d9bb4cc96_c");
    let grey = Photo::open(&name.with_extension("jpg")).unwrap().grey();
    let text = std::fs::read_to_string(name.with_extension("txt")).unwrap();
    let truth: Vec<Vec<f64>> = text
        .lines()
        .filter(|l| !l.trim().is_empty())
        .map(|l| {
            let numbers = l
                .split(|c: char| !(c.is_ascii_digit() || c == '.'))
                .filter(|n| !n.is_empty());
            numbers.map(|n| n.parse().unwrap()).collect()
        })
        .collect();
    for choice in TagDetectorChoice::ALL {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let seen = detector.find(&grey);
        let mut all = Vec::new();
        let mut mean = [0.0; 2];
        let mut n = 0.0;
        for t in &truth {
            let corner = |i: usize| [t[1 + 2 * (i % 4)], t[2 + 2 * (i % 4)]];
            let off = |tag: &SeenTag, turn: usize| {
                (0..4)
                    .map(|i| distance(tag.corners_px[i], corner(i + turn)))
                    .fold(0.0, f64::max)
            };
            let best = seen
                .iter()
                .flat_map(|tag| (0..4).map(move |turn| (off(tag, turn), turn, tag)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((o, turn, tag)) = best.filter(|b| b.0 < 6.0) else {
                all.push("–".to_owned());
                continue;
            };
            for i in 0..4 {
                for a in 0..2 {
                    mean[a] += tag.corners_px[i][a] - corner(i + turn)[a];
                }
                n += 1.0;
            }
            all.push(format!("{o:.2}{}", if tag.is_whole { "" } else { "c" }));
        }
        println!(
            "{choice:<16} {} seen; {} mean {:.2} {:.2}",
            seen.len(),
            all.join(" "),
            mean[0] / n,
            mean[1] / n
        );
    }
}
