//! Models of a view: light adds up, surrogate renderers, projections; against direct renders, finite differences and each other.

use crate::common;

use std::path::PathBuf;

use common::{assert_refused, home, program, read_json};
use image::{Rgb, RgbImage};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_frames::light;
use scaleproof_frames::surrogate::additive::Additive;
use scaleproof_frames::surrogate::chart::mse;
use scaleproof_frames::surrogate::projection::world::{self, Misplacement};
use scaleproof_frames::surrogate::projection::{Grid, Projection, repeated};
use scaleproof_frames::surrogate::renderer::{ClosedForm, FlatImage, PerPixel, Renderer, Tone};
use scaleproof_frames::views;
use scaleproof_frames::{Frame, FrameSet};

fn stored() -> FrameSet {
    FrameSet::open(&home().join("captures/skyline_frames")).unwrap()
}

const REFERENCES: [[u8; 3]; 3] = [[0; 3], [255; 3], [128; 3]];

fn shots(set: &FrameSet, view: &[&Frame]) -> Vec<FlatImage> {
    let shot = |rgb: &[u8; 3]| {
        let frame = view.iter().find(|f| f.flat_rgb() == Some(*rgb)).unwrap();
        FlatImage {
            flat_rgb: *rgb,
            image: set.rgb(frame).unwrap(),
        }
    };
    REFERENCES.iter().map(shot).collect()
}

fn srgb(pixels: &[[u8; 3]]) -> Vec<[f64; 3]> {
    pixels.iter().map(|p| p.map(|v| f64::from(v) / 255.0)).collect()
}

/// Pixels of a frame.
fn pixels(set: &FrameSet) -> usize {
    set.list.size_px.iter().map(|px| *px as usize).product()
}

#[test]
fn colours_made_of_three_are_those_that_were_rendered() {
    let set = stored();
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0);
    for view in views(&set.list.frames) {
        let additive = Additive::of_view(&set, &view).unwrap();
        assert_eq!(additive.colours.len(), 3);
        for frame in &view {
            let Some(rgb) = frame.flat_rgb() else { continue };
            let direct = set.rgb(frame).unwrap();
            let (on_paint, all) = mse(&srgb(&additive.rgb(rgb)), &direct, &set.paint_mask(frame).unwrap());
            if REFERENCES.contains(&rgb) {
                assert!(all < 1e-6, "the colours it is made of come back: {all}");
            } else {
                let on_paint = on_paint.unwrap();
                (sum, worst, count) = (sum + on_paint, worst.max(on_paint), count + 1);
            }
        }
    }
    println!(
        "{count} unseen flat colours made of three: MSE over the paint {:.6}, worst {worst:.6}",
        sum / f64::from(count)
    );
    assert!(count == 8 && worst < 3e-4, "{worst}");
}

/// What a network learns from, and is judged by, are no colours that the frames do not reach.
#[test]
fn further_colours_are_drawn_between_those_that_were_rendered() {
    let set = stored();
    let mut additive = Additive::of_view(&set, &views(&set.list.frames)[0]).unwrap();
    assert_eq!(
        additive.between([0, 77, 255]),
        [0, 77, 255],
        "black and white were rendered"
    );
    let rendered = [[40, 200, 90], [128, 60, 91], [220, 90, 92]];
    additive.colours = rendered.map(light::linear_of).to_vec();
    assert_eq!(additive.between([0; 3]), [40, 60, 90]);
    assert_eq!(additive.between([255; 3]), [220, 200, 92]);
    assert_eq!(additive.between([128; 3]), [130, 130, 91]);
}

#[test]
fn models_predict_unseen_colours() {
    let set = stored();
    for kind in ClosedForm::ALL {
        let (mut sum, mut count) = (0.0, 0);
        for view in views(&set.list.frames) {
            let model = PerPixel::fit(kind, &shots(&set, &view)).unwrap();
            for frame in &view {
                let Some(rgb) = frame.flat_rgb().filter(|rgb| !REFERENCES.contains(rgb)) else {
                    continue;
                };
                let predicted = model.predict(&vec![light::linear_of(rgb); pixels(&set)]);
                sum += mse(&predicted, &set.rgb(frame).unwrap(), &set.paint_mask(frame).unwrap())
                    .0
                    .unwrap();
                count += 1;
            }
        }
        let mean = sum / f64::from(count);
        println!(
            "{}: MSE over the paint {mean:.6} in {count} unseen colours",
            kind.name()
        );
        let most = match kind {
            // The paper's best, which is the acceptance line.
            ClosedForm::AffineCurve | ClosedForm::QuadraticCurve => 0.0007,
            ClosedForm::Affine | ClosedForm::Quadratic => 0.005,
        };
        assert!(mean < most, "{}: {mean}", kind.name());
    }
}

/// Images of a view that follow a known model exactly, but for 8 bits.
fn known(tone: Tone, rng: &mut impl Rng, colours: &[[u8; 3]]) -> (Vec<[[f64; 2]; 3]>, Vec<FlatImage>) {
    let terms: Vec<[[f64; 2]; 3]> = (0..64)
        .map(|_| std::array::from_fn(|_| [rng.random_range(0.0..0.1), rng.random_range(0.2..0.8)]))
        .collect();
    let picture = |rgb: [u8; 3]| {
        let paint = light::linear_of(rgb);
        RgbImage::from_fn(8, 8, |x, y| {
            let pixel = &terms[(y * 8 + x) as usize];
            Rgb(std::array::from_fn(|c| {
                (255.0 * tone.value(pixel[c][0] + pixel[c][1] * paint[c])).round() as u8
            }))
        })
    };
    let shots = colours.iter().map(|rgb| FlatImage {
        flat_rgb: *rgb,
        image: picture(*rgb),
    });
    (terms.clone(), shots.collect())
}

#[test]
fn a_known_tone_curve_is_found() {
    let mut rng = Pcg32::seed_from_u64(3);
    for power in [0.7, 1.0, 1.4] {
        let tone = Tone { power };
        let (terms, shots) = known(tone, &mut rng, &[[0; 3], [128; 3], [190; 3], [255; 3]]);
        let model = PerPixel::fit(ClosedForm::AffineCurve, &shots).unwrap();
        let found = model.tone().unwrap().power;
        assert!((found - power).abs() < 0.02, "{found} for {power}");
        let rgb = [60, 220, 100];
        let predicted = model.predict(&[light::linear_of(rgb); 64]);
        for (p, pixel) in predicted.iter().zip(&terms) {
            for c in 0..3 {
                let truth = tone.value(pixel[c][0] + pixel[c][1] * light::linear_of(rgb)[c]);
                assert!((p[c] - truth).abs() < 0.01, "{} for {truth}", p[c]);
            }
        }
    }
}

#[test]
fn clipped_values_do_not_bend_the_fit() {
    // Pixels of light 0.1 + 1.6 ρ: white is clipped, the others are not.
    let value = |rgb: [u8; 3]| light::rgb_of(light::linear_of(rgb).map(|rho| 0.1 + 1.6 * rho));
    let shot = |v: u8| FlatImage {
        flat_rgb: [v; 3],
        image: RgbImage::from_pixel(4, 4, Rgb(value([v; 3]))),
    };
    let shots = [shot(0), shot(128), shot(160), shot(255)];
    assert_eq!(shots[3].image.get_pixel(0, 0).0, [255; 3], "white is clipped");
    for kind in [ClosedForm::AffineCurve, ClosedForm::QuadraticCurve] {
        let model = PerPixel::fit(kind, &shots).unwrap();
        let predicted = model.predict(&[light::linear_of([90, 150, 255]); 16])[5];
        let truth = value([90, 150, 255]).map(|v| f64::from(v) / 255.0);
        assert!(
            (0..3).all(|c| (predicted[c] - truth[c]).abs() < 0.012),
            "{kind:?}: {predicted:?}, {truth:?}"
        );
        // Where the image is clipped, no paint changes it.
        assert_eq!(model.derivative(&[light::linear_of([90, 150, 255]); 16])[5][2], 0.0);
    }
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let shot = |rgb: [u8; 3], side: u32| FlatImage {
        flat_rgb: rgb,
        image: RgbImage::new(side, side),
    };
    let sentence = |kind, shots: &[FlatImage]| PerPixel::fit(kind, shots).unwrap_err().to_string();
    let two = [shot([0; 3], 4), shot([255; 3], 4)];
    assert!(sentence(ClosedForm::Quadratic, &two).contains("needs images in 3 flat colours"));
    // Red never changes.
    let same_red = [shot([9, 0, 0], 4), shot([9, 255, 255], 4)];
    assert!(sentence(ClosedForm::Affine, &same_red).contains("and there are 1"));
    assert!(sentence(ClosedForm::Affine, &[shot([0; 3], 4), shot([255; 3], 5)]).contains("different sizes"));
}

fn random_colours(count: usize, rng: &mut impl Rng) -> Vec<[f64; 3]> {
    (0..count)
        .map(|_| std::array::from_fn(|_| rng.random_range(0.02..0.98)))
        .collect()
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

const GRID: Grid = Grid {
    columns: 16,
    rows: 12,
    cell_mm: 30.0,
};

/// Every projection of a stored view: both makers, with and without φ_rd.
fn projections(set: &FrameSet, frame: &Frame) -> Vec<(String, Projection)> {
    let mask = set.paint_mask(frame).unwrap();
    let world = world::project(set, frame, &GRID, false, &[Misplacement::NONE])
        .unwrap()
        .unwrap()
        .remove(0);
    let mut all = vec![("world".to_owned(), world)];
    let moved = repeated::Jitter {
        shift_tiles: [0.21, -0.37],
        scale: 1.13,
    };
    for jitter in [repeated::Jitter::NONE, moved] {
        let projection = repeated::project(&set.list, frame, &mask, &GRID, &jitter);
        all.push((format!("repeated {jitter:?}"), projection));
    }
    all
}

#[test]
fn projections_are_linear_and_their_transposed_is_theirs() {
    let set = stored();
    let mut rng = Pcg32::seed_from_u64(4);
    for view in views(&set.list.frames) {
        for (name, projection) in projections(&set, view[0]) {
            assert_eq!((projection.cells, projection.pixels()), (GRID.cells(), pixels(&set)));
            let (x, y) = (
                random_colours(projection.cells, &mut rng),
                random_colours(projection.pixels(), &mut rng),
            );
            let (left, right) = (dot(&projection.forward(&x), &y), dot(&x, &projection.transposed(&y)));
            assert!((left - right).abs() < 1e-9 * left.abs(), "{name}: {left} {right}");
            // One colour everywhere stays that colour: weights add up to 1 in every pixel.
            let flat = projection.forward(&vec![[0.3, 0.5, 0.7]; projection.cells]);
            assert!(
                flat.iter()
                    .all(|p| (p[0] - 0.3).abs() < 1e-12 && (p[2] - 0.7).abs() < 1e-12),
                "{name}"
            );
            let painted = projection.starts.windows(2).filter(|w| w[0] < w[1]).count();
            assert!(painted > 500, "{name}: {painted} pixels see paint");
        }
    }
}

/// Loss ½ Σ (x − wanted)² through projection and model, against finite differences in the pattern's sRGB.
#[test]
fn gradients_through_projection_and_model_are_those_of_finite_differences() {
    let set = stored();
    let all = views(&set.list.frames);
    let (view, mut rng) = (&all[0], Pcg32::seed_from_u64(9));
    let linear = |eta: &[[f64; 3]]| -> Vec<[f64; 3]> { eta.iter().map(|c| c.map(light::decode)).collect() };
    for kind in ClosedForm::ALL {
        let model = PerPixel::fit(kind, &shots(&set, view)).unwrap();
        for (name, projection) in projections(&set, view[0]).into_iter().step_by(2) {
            let eta = random_colours(projection.cells, &mut rng);
            let wanted = random_colours(projection.pixels(), &mut rng);
            let loss = |eta: &[[f64; 3]]| {
                let x = model.predict(&projection.forward(&linear(eta)));
                0.5 * x
                    .iter()
                    .flatten()
                    .zip(wanted.iter().flatten())
                    .map(|(a, b)| (a - b).powi(2))
                    .sum::<f64>()
            };
            let paint = projection.forward(&linear(&eta));
            let (x, derivative) = (model.predict(&paint), model.derivative(&paint));
            let at_pixels: Vec<[f64; 3]> = (0..x.len())
                .map(|i| std::array::from_fn(|c| (x[i][c] - wanted[i][c]) * derivative[i][c]))
                .collect();
            let at_cells = projection.transposed(&at_pixels);
            let gradient: Vec<[f64; 3]> = at_cells
                .iter()
                .zip(&eta)
                .map(|(g, e)| std::array::from_fn(|c| g[c] * light::decode_derivative(e[c])))
                .collect();
            let direction = random_colours(eta.len(), &mut rng);
            let moved = |step: f64| -> Vec<[f64; 3]> {
                let add = |(e, d): (&[f64; 3], &[f64; 3])| std::array::from_fn(|c| e[c] + step * (d[c] - 0.5));
                eta.iter().zip(&direction).map(add).collect()
            };
            let centred: Vec<[f64; 3]> = direction.iter().map(|d| d.map(|v| v - 0.5)).collect();
            let (step, analytic) = (1e-6, dot(&gradient, &centred));
            let measured = (loss(&moved(step)) - loss(&moved(-step))) / (2.0 * step);
            let off = (analytic - measured).abs() / measured.abs().max(1e-3);
            assert!(off < 1e-3, "{kind:?}, {name}: {analytic} {measured}");
        }
    }
}

/// The error of a predicted pattern against its direct render, over the paint.
fn pattern_error(set: &FrameSet, view: &[&Frame], place: impl Fn(&Frame, &Grid) -> Projection, mirrored: bool) -> f64 {
    let model = PerPixel::fit(ClosedForm::AffineCurve, &shots(set, view)).unwrap();
    let frame = view.iter().find(|f| f.flat_rgb().is_none()).unwrap();
    let (pattern, tile_mm) = set.pattern(frame).unwrap().unwrap();
    let mut cells: Vec<[f64; 3]> = pattern.cells().pixels().map(|p| light::linear_of(p.0)).collect();
    if mirrored {
        cells
            .chunks_mut(pattern.columns() as usize)
            .for_each(|row| row.reverse());
    }
    let predicted =
        model.predict(&place(frame, &Grid::new([pattern.columns(), pattern.rows()], tile_mm)).forward(&cells));
    mse(&predicted, &set.rgb(frame).unwrap(), &set.paint_mask(frame).unwrap())
        .0
        .unwrap()
}

#[test]
fn the_world_aligned_projection_is_what_was_rendered() {
    let set = stored();
    for view in views(&set.list.frames) {
        let world = |frame: &Frame, grid: &Grid| {
            world::project(&set, frame, grid, false, &[Misplacement::NONE])
                .unwrap()
                .unwrap()
                .remove(0)
        };
        let plane = |frame: &Frame, grid: &Grid| {
            let mask = set.paint_mask(frame).unwrap();
            repeated::project(&set.list, frame, &mask, grid, &repeated::Jitter::NONE)
        };
        let right = pattern_error(&set, &view, world, false);
        let mirrored = pattern_error(&set, &view, world, true);
        let repeated = pattern_error(&set, &view, plane, false);
        println!(
            "{}: world-aligned {right:.5}, mirrored {mirrored:.5}, repeated over a plane {repeated:.5}",
            view[0].name
        );
        assert!(right < 0.002, "{right}");
        assert!(
            mirrored > 20.0 * right && repeated > 20.0 * right,
            "another pattern would show: {mirrored} {repeated}"
        );
    }
}

#[test]
fn the_repeated_texture_has_its_true_size_at_the_target() {
    // Straight from the left: a cell of 30 mm at the target's distance is f · 30 / d pixels wide.
    let set = stored();
    let frame = &set.list.frames[0];
    let target = nalgebra::Point3::from(set.list.target_mm);
    let view = scaleproof_pose::scene::Viewpoint {
        azimuth_deg: 90.0,
        pitch_deg: 0.0,
        distance_mm: 560.0,
    };
    let pose = scaleproof_pose::simulate::looking_at(&view, target);
    let frame = Frame {
        t_camera_model: scaleproof_core::geometry::rigid::rows(&pose),
        ..frame.clone()
    };
    let everywhere = image::GrayImage::from_pixel(96, 64, image::Luma([255]));
    // Cells of 30 mm, each in a thousand stripes, so that places are read as finely.
    let grid = Grid {
        columns: 64_000,
        rows: 1,
        cell_mm: 0.03,
    };
    // Each stripe says its place, in cells.
    let columns: Vec<[f64; 3]> = (0..grid.cells()).map(|i| [i as f64 / 1000.0, 0.0, 0.0]).collect();
    let seen = |jitter: &repeated::Jitter| {
        let projection = repeated::project(&set.list, &frame, &everywhere, &grid, jitter);
        let paint = projection.forward(&columns);
        let row = 32 * 96;
        // Away from where the pattern starts over.
        (paint[row + 80][0] - paint[row + 60][0]) / 20.0
    };
    let wanted = 560.0 / (set.list.camera.focal_length_px * 30.0);
    let calibrated = seen(&repeated::Jitter::NONE);
    assert!(
        (calibrated - wanted).abs() < 1e-4,
        "{calibrated} cells a pixel, not {wanted}"
    );
    let larger = repeated::Jitter {
        scale: 1.25,
        shift_tiles: [0.25, 0.0],
    };
    assert!((seen(&larger) - wanted / 1.25).abs() < 1e-4);
}

fn run(arguments: &[&str]) -> std::process::Output {
    program().arg("attack").args(arguments).output().unwrap()
}

#[test]
fn the_chart_is_drawn_and_the_colours_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let frames = home().join("captures/skyline_frames");
    let frames = frames.to_str().unwrap();
    let output = run(&["chart", frames, "-o", &at("chart")]);
    assert!(output.status.success(), "{}", common::stderr(&output));
    println!("{}", common::stdout(&output));
    let numbers = read_json(&PathBuf::from(at("chart/renderers.json")));
    let rows = numbers["rows"].as_array().unwrap();
    assert_eq!(
        rows.len(),
        6,
        "affine with two and three colours, quadratic with three, each in sRGB and in light"
    );
    assert!(rows.iter().all(|r| r["frames"] == 8 && r["views"] == 2));
    assert!(
        std::fs::read_to_string(at("chart/renderers.svg"))
            .unwrap()
            .starts_with("<svg")
    );

    let output = run(&[
        "colours",
        frames,
        "--flat",
        "c83214",
        "--random",
        "49",
        "-o",
        &at("fifty"),
    ]);
    assert!(output.status.success(), "{}", common::stderr(&output));
    assert!(run(&["check", &at("fifty")]).status.success());
    let fifty = FrameSet::open(&PathBuf::from(at("fifty"))).unwrap();
    assert_eq!(fifty.list.frames.len(), 100);
    // The first of them was rendered, too.
    let set = stored();
    let direct = set
        .list
        .frames
        .iter()
        .find(|f| f.flat_rgb() == Some([0xc8, 0x32, 0x14]))
        .unwrap();
    let (made, mask) = (
        fifty.rgb(&fifty.list.frames[0]).unwrap(),
        set.paint_mask(direct).unwrap(),
    );
    let pixels: Vec<[u8; 3]> = made.pixels().map(|p| p.0).collect();
    let error = mse(&srgb(&pixels), &set.rgb(direct).unwrap(), &mask).0.unwrap();
    assert!(error < 3e-4, "{error}");

    let output = run(&["colours", frames, "--random", "3", "--json", "-o", &at("three")]);
    let made: serde_json::Value = serde_json::from_str(&common::stdout(&output)).unwrap();
    let list = PathBuf::from(at("three")).join("frames.json");
    assert_eq!(made, serde_json::json!({ "file": list, "frames": 6 }));

    assert_refused(
        &run(&["colours", frames, "-o", &at("none")]),
        &["no colours were given"],
    );
    assert_refused(
        &run(&["colours", &at("fifty"), "--random", "2", "-o", &at("more")]),
        &["has 0 flat colours in linear light"],
    );
    assert_refused(
        &run(&["chart", frames, "--reference", "000000", "123456", "-o", &at("x")]),
        &["no frame in the reference colour 123456"],
    );
}
