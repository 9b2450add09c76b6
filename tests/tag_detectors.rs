//! The tag detectors against exact corners: the stored session's truth, rendered tags, real photos.

use crate::common;

use std::time::Instant;

use common::{assert_refused, home, program, read_json, skyline};
use image::GrayImage;
use nalgebra::{Matrix4, Point3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_core::geometry::angle::turn;
use scaleproof_photo::Photo;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::locate;
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_pose::tags::{CornersBy, SeenTag, TagDetector, TagDetectorChoice, TagImage};

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

fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values
        .get(((values.len() as f64 - 1.0) * q).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

/// One detector on the stored session. Distances in px between found and exact corners of whole tags.
struct Measured {
    ms: f64,
    tags: usize,
    whole: usize,
    corner_px: Vec<f64>,
    /// Mean distance of a tag's sides inside their true place, px.
    inset_px: Vec<f64>,
    answered: usize,
    /// Worst error in azimuth (°), pitch (°), distance (mm).
    worst: [f64; 3],
}

fn area(corners: &Corners) -> f64 {
    let twice = |i: usize| corners[i][0] * corners[(i + 1) % 4][1] - corners[(i + 1) % 4][0] * corners[i][1];
    (0..4).map(twice).sum::<f64>() / 2.0
}

fn measured(choice: TagDetectorChoice, pictures: &[(Truth, GrayImage)], scene: &Scene, camera: &Camera) -> Measured {
    let mut detector = choice.open(&scene.families()).unwrap();
    let mut m = Measured {
        ms: 0.0,
        tags: 0,
        whole: 0,
        corner_px: Vec::new(),
        inset_px: Vec::new(),
        answered: 0,
        worst: [0.0; 3],
    };
    let mut ms = Vec::new();
    for (truth, grey) in pictures {
        let start = Instant::now();
        let seen = detector.find(grey);
        ms.push(start.elapsed().as_secs_f64() * 1000.0);
        m.tags += seen.len();
        for tag in seen.iter().filter(|tag| tag.is_whole) {
            let exact = truth.corners(scene, camera, tag.family, tag.id);
            let exact = exact.unwrap_or_else(|| panic!("{choice}: {} has no tag {}", truth.file, tag.id));
            m.whole += 1;
            m.corner_px
                .extend((0..4).map(|i| distance(tag.corners_px[i], exact[i])));
            let round: f64 = (0..4).map(|i| distance(exact[i], exact[(i + 1) % 4])).sum();
            m.inset_px.push((area(&exact) - area(&tag.corners_px)) / round);
        }
        if let Ok(located) = locate(&seen, scene, camera) {
            m.answered += 1;
            let v = located.viewpoint;
            let errors = [
                turn(v.azimuth_deg, truth.azimuth_deg),
                v.pitch_deg - truth.pitch_deg,
                v.distance_mm - truth.distance_mm,
            ];
            m.worst = std::array::from_fn(|i| m.worst[i].max(errors[i].abs()));
        }
    }
    m.ms = quantile(&mut ms, 0.5);
    m
}

/// Those that can be chosen, then libraries with their own corners.
fn with_peers() -> impl Iterator<Item = TagDetectorChoice> {
    TagDetectorChoice::ALL.into_iter().chain(TagDetectorChoice::PEERS)
}

#[test]
fn the_default_finds_every_tag_of_the_session_and_its_corners_best() {
    let scene = Scene::open(&skyline().join("scene.toml")).unwrap();
    let camera = Camera::open(&skyline().join("camera.yaml")).unwrap();
    let grey = |truth: &Truth| Photo::open(&skyline().join(&truth.file)).unwrap().luma().unwrap();
    let pictures: Vec<(Truth, GrayImage)> = Truth::of_session()
        .into_iter()
        .map(|t| (grey(&t), t))
        .map(|(g, t)| (t, g))
        .collect();
    println!("detector             ms  tags whole  corner p50    p95  inset  answered  azimuth   pitch  distance");
    let mut all = Vec::new();
    for choice in with_peers() {
        let mut m = measured(choice, &pictures, &scene, &camera);
        let (half, most) = (quantile(&mut m.corner_px, 0.5), quantile(&mut m.corner_px, 0.95));
        let inset = quantile(&mut m.inset_px, 0.5);
        let [azimuth, pitch, mm] = m.worst;
        println!(
            "{:<18} {:>6.1} {:>5} {:>5}  {half:>7.3} px {most:>6.3} {inset:>6.3} {:>9} {azimuth:>7.4}° {pitch:>6.4}° {mm:>6.3} mm",
            choice.name(),
            m.ms,
            m.tags,
            m.whole,
            m.answered
        );
        all.push((half, inset, m));
    }
    let of = |wanted| with_peers().position(|choice| choice == wanted).unwrap();
    let own_corners = &all[of(TagDetectorChoice::AprilTagC(CornersBy::Library))];
    let default = &all[of(TagDetectorChoice::default())];
    assert_eq!(default.2.answered, pictures.len());
    assert!(default.2.tags >= own_corners.2.tags && default.2.whole >= own_corners.2.whole);
    assert!(
        default.0 < 0.15 && default.0 < own_corners.0 / 3.0,
        "half of the corners are within {} px",
        default.0
    );
    assert!(
        default.1.abs() < 0.05,
        "the tags look {} px too small all round",
        default.1
    );
    assert!(default.2.worst[0] < 0.01 && default.2.worst[1] < 0.01 && default.2.worst[2] < 0.2);
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

/// Gaussian blur along one axis: `step` 1 along rows, the width along columns. The image's border is left as it is.
fn blurred(lights: &[f64], width: usize, step: usize, sigma: f64) -> Vec<f64> {
    const REACH: usize = 6;
    let weights: Vec<f64> = (0..=2 * REACH)
        .map(|i| (-0.5 * ((i as f64 - REACH as f64) / sigma).powi(2)).exp())
        .collect();
    let total: f64 = weights.iter().sum();
    let height = lights.len() / width;
    let inside = |v: usize, size: usize| v >= REACH && v + REACH < size;
    (0..lights.len())
        .map(|i| {
            if inside(i % width, width) && inside(i / width, height) {
                (0..=2 * REACH)
                    .map(|k| weights[k] * lights[i + k * step - REACH * step])
                    .sum::<f64>()
                    / total
            } else {
                lights[i]
            }
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

/// A tag of about 150 px seen from aside, turned in the image by some quarters.
fn aside(quarters: usize) -> Corners {
    let mut corners = [[121.3, 118.2], [268.9, 131.4], [259.6, 279.7], [114.1, 262.5]];
    corners.rotate_right(quarters);
    corners
}

#[test]
fn every_detector_keeps_the_conventions_for_every_family_it_reads() {
    const PHOTOS: [(usize, u32); 4] = [(0, 1), (1, 5), (2, 11), (3, 17)];
    let photos =
        TagFamily::ALL.map(|(family, _)| PHOTOS.map(|(quarters, id)| Shot::sharp(aside(quarters)).photo(family, id)));
    for choice in with_peers() {
        for ((family, name), photos) in TagFamily::ALL.into_iter().zip(&photos) {
            if !choice.reads(family) {
                let refused = choice.open(&[family]).err().unwrap().to_string();
                assert!(refused.contains(choice.name()) && refused.contains(name), "{refused}");
                assert!(refused.contains("use one of cascade"), "{refused}");
                continue;
            }
            let mut detector = choice.open(&[family]).unwrap();
            let mut worst = 0.0_f64;
            for ((quarters, id), photo) in PHOTOS.into_iter().zip(photos) {
                let exact = aside(quarters);
                let seen = detector.find(photo);
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
            let is_peer = TagDetectorChoice::PEERS.contains(&choice);
            let limit = if is_peer { 2.0 } else { 0.1 };
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
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any view, blur, tone curve and noise of a camera; bit cells of 4 px and more, below which a lone tag keeps its blur's shift.
    /// Most are within 0.05 px. A long side that runs along a pixel row within a pixel or so is cut by few rows: under another
    /// tone curve than sRGB it turns a little, which costs one corner up to 0.3 px.
    #[test]
    fn refined_corners_are_exact(
        jitter in prop::array::uniform8(-0.14..0.14_f64),
        side in 70.0..160.0_f64,
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
        let seen = TagDetectorChoice::default().open(&[TagFamily::Tag36h11]).unwrap()
            .find(&shot.photo(TagFamily::Tag36h11, id));
        prop_assert_eq!(seen.iter().map(|tag| tag.id).collect::<Vec<_>>(), vec![id]);
        let off = (0..4).map(|i| distance(seen[0].corners_px[i], exact[i])).fold(0.0, f64::max);
        println!("refined: side {side:.0} blur {blur:.2} noise {noise:.1} tone {:.0}: {off:.3} px", tone(0.4));
        prop_assert!(off < 0.4, "a corner is {:.3} px off", off);
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
#[ignore = "needs the shared material: ./run test --shared"]
fn real_photos_of_a_turned_tag_are_not_flipped() {
    let folder = common::shared("photos/tags/yaw");
    let camera = Camera::pinhole(1056, 792, 329.873, 332.946, 528.0, 396.0);
    let mut yaws: Vec<Vec<Option<f64>>> = Vec::new();
    for choice in with_peers() {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let mut of_photo = |named: i32| {
            let photo = Photo::open(&folder.join(format!("yaw_{named}.png"))).unwrap();
            let seen = detector.find(&photo.luma().unwrap());
            let located = locate(&seen, &one_tag("tag36h11", seen.first()?.id, 65.0), &camera).ok()?;
            let normal = located.pose * nalgebra::Vector3::x();
            let yaw = normal.x.atan2(-normal.z).to_degrees();
            // A library's own corners tell a tag near the front less well than ours do, and σ says so.
            let sigma_deg = located.sigma.azimuth_deg;
            let is_peer = TagDetectorChoice::PEERS.contains(&choice);
            let most = if is_peer { f64::max(5.0, 2.0 * sigma_deg) } else { 5.0 };
            assert!(
                (yaw - f64::from(named)).abs() < most,
                "{choice}: yaw_{named} is answered with {yaw}°, σ {sigma_deg}°"
            );
            Some(yaw)
        };
        let line: Vec<Option<f64>> = (-70..=70).step_by(10).map(&mut of_photo).collect();
        let text = line
            .iter()
            .map(|yaw| yaw.map_or("     –".to_owned(), |yaw| format!("{yaw:6.2}")));
        println!("{choice:<16} {}", text.collect::<Vec<_>>().join(" "));
        yaws.push(line);
    }
    assert!(
        yaws[0].iter().flatten().count() >= yaws[1].iter().flatten().count(),
        "as many as C AprilTag"
    );
    for (choice, line) in with_peers().zip(&yaws) {
        let pairs = line
            .iter()
            .zip(&yaws[0])
            .filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs()));
        let apart = pairs.fold(0.0, f64::max);
        println!("{choice:<16} at most {apart:.2}° from the default");
        // OpenCV's own corners are up to 2 px off on these photos.
        let is_peer = TagDetectorChoice::PEERS.contains(&choice);
        assert!(is_peer || apart <= 0.5, "{choice}: {apart:.2}°");
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn real_photos_of_a_desk_show_as_many_tags_as_at_full_size() {
    let folder = common::shared("photos/tags/desk");
    let mut totals = Vec::new();
    for choice in TagDetectorChoice::ALL {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let counts: Vec<usize> = (1..=5)
            .map(|n| {
                detector
                    .find(
                        &Photo::open(&folder.join(format!("desk_{n:02}.png")))
                            .unwrap()
                            .luma()
                            .unwrap(),
                    )
                    .len()
            })
            .collect();
        totals.push(counts.iter().sum::<usize>());
        println!("{choice:<16} {counts:?}, {} in all", totals[totals.len() - 1]);
    }
    assert!(
        totals[0] >= totals[1],
        "{} tags, C AprilTag at full size {}",
        totals[0],
        totals[1]
    );
}

/// The photo of a rover and the corners of its truth file, against the clock.
fn rover() -> (GrayImage, Vec<Corners>) {
    let folder = common::shared("photos/tags/rover");
    let name = folder.join("apriltag_33369213973_9d9bb4cc96_c");
    let grey = Photo::open(&name.with_extension("jpg")).unwrap().luma().unwrap();
    let text = std::fs::read_to_string(name.with_extension("txt")).unwrap();
    // A line: id, then four corners (x, y) against the clock. Its pixels are counted from the corner of the first.
    let numbers = |line: &str| -> Vec<f64> {
        let texts = line.split(|c: char| !(c.is_ascii_digit() || c == '.'));
        texts
            .filter(|text| !text.is_empty())
            .map(|text| text.parse().unwrap())
            .collect()
    };
    let lines = text.lines().filter(|line| !line.trim().is_empty()).map(numbers);
    let truth: Vec<Corners> = lines
        .map(|n| std::array::from_fn(|i| [n[1 + 2 * i] - 0.5, n[2 + 2 * i] - 0.5]))
        .collect();
    (grey, truth)
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn real_photo_of_a_rover_has_its_corners_where_the_truth_file_says() {
    let (grey, truth) = rover();
    for choice in TagDetectorChoice::ALL {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        let seen = detector.find(&grey);
        // No id is given, so that a tag is the nearest one; from which corner the file starts differs too.
        let mut off = Vec::new();
        for exact in &truth {
            let apart = |tag: &SeenTag, from: usize| -> [f64; 4] {
                std::array::from_fn(|i| distance(tag.corners_px[i], exact[(from + 4 - i) % 4]))
            };
            let turned = seen.iter().flat_map(|tag| (0..4).map(move |from| apart(tag, from)));
            let worst = |four: &[f64; 4]| four.iter().copied().fold(0.0, f64::max);
            off.extend(
                turned
                    .min_by(|a, b| worst(a).total_cmp(&worst(b)))
                    .into_iter()
                    .flatten(),
            );
        }
        let within = off.iter().filter(|off| **off <= 0.5).count();
        let (half, worst) = (quantile(&mut off, 0.5), quantile(&mut off, 1.0));
        println!(
            "{choice:<16} {} seen; {within} of {} corners within 0.5 px, median {half:.2}, worst {worst:.2} px",
            seen.len(),
            off.len()
        );
        if choice == TagDetectorChoice::default() {
            // The file is no better than that: see the test below.
            assert!(
                within >= 38 && worst < 0.75,
                "{within} within 0.5 px, worst {worst:.2} px"
            );
        }
    }
}

/// The rover's truth file is the C library's own output with its edge refinement switched off, so that its sides are where a pixelated
/// outline has them: a detector that comes nearer to the edges comes no nearer to the file.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_truth_file_of_the_rover_is_c_apriltag_without_refined_edges() {
    let (grey, truth) = rover();
    let [unrefined, refined] = [false, true].map(|refine_edges| {
        let seen = c_apriltag(&grey, refine_edges);
        let mut off: Vec<f64> = truth
            .iter()
            .flat_map(|exact| {
                // Their first corner is the same one, so that the nearest tag has them in the file's order.
                let apart = |seen: &Corners| -> [f64; 4] { std::array::from_fn(|i| distance(seen[i], exact[i])) };
                let sum = |four: &[f64; 4]| four.iter().sum::<f64>();
                seen.iter().map(apart).min_by(|a, b| sum(a).total_cmp(&sum(b))).unwrap()
            })
            .collect();
        (quantile(&mut off, 0.5), quantile(&mut off, 1.0))
    });
    println!(
        "C AprilTag at full size, edges not refined: median {:.4} px from the file, worst {:.2} px; refined: {:.2} and {:.2} px",
        unrefined.0, unrefined.1, refined.0, refined.1
    );
    assert!(unrefined.0 < 0.01 && unrefined.1 < 0.2 && refined.0 > 0.1);
}

/// The C library's corners in its own order and in this project's pixels.
fn c_apriltag(grey: &GrayImage, refine_edges: bool) -> Vec<Corners> {
    let mut detector = apriltag::DetectorBuilder::new()
        .add_family_bits(apriltag::Family::tag_36h11(), 2)
        .build()
        .unwrap();
    detector.set_decimation(1.0);
    detector.set_refine_edges(refine_edges);
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    let mut image = apriltag::Image::zeros_with_alignment(width, height, 96).unwrap();
    let stride = image.stride();
    for (row, line) in grey.rows().enumerate() {
        let to = &mut image.as_slice_mut()[row * stride..][..width];
        to.iter_mut().zip(line).for_each(|(to, from)| *to = from.0[0]);
    }
    let found = detector.detect(&image);
    found.iter().map(|d| d.corners().map(|c| c.map(|v| v - 0.5))).collect()
}

#[test]
fn a_detector_is_chosen_by_name() {
    let locate = |scene: &std::path::Path, name: &str| {
        let mut command = program();
        command
            .arg("locate")
            .arg(skyline().join("normal_000.jpg"))
            .arg("--scene")
            .arg(scene);
        command.arg("--camera").arg(skyline().join("camera.yaml"));
        command.args(["--tag-detector", name]).output().unwrap()
    };
    let scene = skyline().join("scene.toml");
    for choice in TagDetectorChoice::ALL {
        assert_eq!(choice.name().parse().ok(), Some(choice));
        assert_eq!(locate(&scene, choice.name()).status.code(), Some(0), "{choice}");
    }
    for peer in TagDetectorChoice::PEERS {
        assert!(peer.name().parse::<TagDetectorChoice>().is_err(), "{peer}");
    }
    assert_refused(
        &locate(&scene, "apriltags"),
        &["'apriltags' is not known", "cascade, coarse-to-fine, apriltag, aruco"],
    );
    let folder = tempfile::tempdir().unwrap();
    let standard = folder.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    assert!(
        !text.contains("family"),
        "the stored scene leaves the family to the default"
    );
    let text = text.replace("[[tag]]", "[[tag]]\nfamily = \"tagstandard41h12\"");
    std::fs::write(&standard, text).unwrap();
    assert_refused(
        &locate(&standard, "locus"),
        &[
            "locus cannot read",
            "tagstandard41h12",
            "use one of cascade, coarse-to-fine, apriltag",
        ],
    );
}

#[path = "../crates/pose/build/apriltag.rs"]
mod build_apriltag;

/// The version that a file of TOML or CMake states in the line after `mark`, up to its end.
fn stated<'a>(text: &'a str, mark: &str) -> &'a str {
    let rest = text.split_once(mark).unwrap_or_else(|| panic!("no {mark:?}")).1;
    rest.split(['"', ' ', '\n']).next().unwrap()
}

#[test]
fn the_provenance_names_the_apriltag_library_that_is_compiled() {
    let provenance = TagDetectorChoice::default().provenance();
    let build_apriltag::Linked { version, origin } = build_apriltag::CARRIED;
    assert!(
        provenance.contains(&format!("apriltag C {version} ({origin}, ")),
        "{provenance}"
    );

    let lock = std::fs::read_to_string(home().join("Cargo.lock")).unwrap();
    let locked = stated(&lock, "name = \"apriltag-sys\"\nversion = \"");
    let of_origin = origin.strip_prefix("apriltag-sys ").unwrap();
    assert!(
        locked.starts_with(&format!("{of_origin}.")),
        "{locked} is locked, {origin} stated"
    );
    let manifest = std::fs::read_to_string(home().join("Cargo.toml")).unwrap();
    assert_eq!(
        stated(&manifest, "apriltag-sys = \"="),
        locked,
        "dependants get another"
    );

    // The source of truth: what the C library says of itself.
    let metadata = std::process::Command::new(env!("CARGO"))
        // Of this platform alone: a build fetches no others.
        .args([
            "metadata",
            "--offline",
            "--locked",
            "--format-version",
            "1",
            "--filter-platform",
            &host(),
        ])
        .current_dir(home())
        .output()
        .unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&metadata.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let of_sys = packages
        .iter()
        .find(|package| package["name"] == "apriltag-sys")
        .unwrap();
    let carried = std::path::Path::new(of_sys["manifest_path"].as_str().unwrap()).with_file_name("apriltag-src");
    let cmake = std::fs::read_to_string(carried.join("CMakeLists.txt")).unwrap();
    let said = stated(&cmake, "project(apriltag VERSION ");
    assert!(
        said.starts_with(&format!("{version}.")),
        "it is {said}, {version} stated"
    );
}

#[test]
fn a_build_that_links_the_systems_apriltag_says_so() {
    use build_apriltag::{CARRIED, linked};
    let system = Some("3.4.2");
    for asked in [None, Some("pkg-config"), Some("pkg-config-then-static")] {
        let found = linked(asked, None, system);
        assert_eq!((found.version, found.origin), ("3.4.2", "the system's"), "{asked:?}");
    }
    assert_eq!(linked(Some("raw,static"), None, system), CARRIED);
    assert_eq!(linked(None, None, None), CARRIED);
    assert_eq!(
        linked(Some("raw,static"), Some("/src"), system).origin,
        "from APRILTAG_SRC"
    );
    // A dependant does not read this project's `.cargo/config.toml`: the crate's documentation says what it sets.
    let pin = std::fs::read_to_string(home().join(".cargo/config.toml")).unwrap();
    let pin = pin
        .lines()
        .find(|line| line.starts_with("APRILTAG_SYS_METHOD"))
        .unwrap();
    let front = std::fs::read_to_string(home().join("src/lib.rs")).unwrap();
    assert!(
        front.contains(&format!("//! {pin}\n")),
        "the crate's front page does not say {pin}"
    );
}

/// The platform that the compiler runs on.
fn host() -> String {
    let said = std::process::Command::new("rustc").arg("-vV").output().unwrap();
    stated(&String::from_utf8(said.stdout).unwrap(), "host: ").to_owned()
}
