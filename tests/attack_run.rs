//! The attack, its baselines and their files, against a detector made up in the test whose gradient is known.

use crate::common;

use std::cell::Cell;
use std::collections::BTreeSet;
use std::path::Path;
use std::rc::Rc;

use common::{assert_refused, home, program, read_json, stderr, stdout};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_attack::AttackError;
use scaleproof_attack::baseline::patches::{is_seen, paint};
use scaleproof_attack::baseline::{self, BlackBox, genetic};
use scaleproof_attack::run::augmentation::{Augmentation, Eot, rolled};
use scaleproof_attack::run::history::Entry;
use scaleproof_attack::run::judge::{detect, judge};
use scaleproof_attack::run::loss::from_floor;
use scaleproof_attack::run::penalty::{distance, nearest, smooth};
use scaleproof_attack::run::printer::PrinterMap;
use scaleproof_attack::run::view_set::{TextureMapping, ViewSet};
use scaleproof_attack::run::weights::Against;
use scaleproof_attack::run::{
    Attack, AttackConfig, CellColours, Near, Rgb, batch, loss_and_gradient, of_image, of_pattern, to_image,
};
use scaleproof_core::geometry::BoxPx;
use scaleproof_frames::light;
use scaleproof_frames::surrogate::projection::Grid;
use scaleproof_frames::surrogate::projection::world::{self, Misplacement};
use scaleproof_frames::{FrameSet, Positions, encode_grey, encode_positions, encode_rgb, views};
use scaleproof_gradients::{Boxes, ForwardPass, ImageLoss, MEETS_IOU, Prediction, WhiteBox, WhiteBoxError, strongest};
use scaleproof_photo::defence::{Defence, Frame};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::gamut::Gamut;
use scaleproof_surface::pattern::world_aligned::Side;
use scaleproof_surface::texture::PlacedPatch;

/// C = σ(z), z = gain · Σ w(x, y) · (image − base) / pixels: sees the model the better, the more its image is like
/// a fixed weave. Unsure of a grey model.
struct Weave {
    gain: f64,
    boxes: Vec<BoxPx>,
    /// The image of this number is answered with NaN.
    bad_at: Option<usize>,
    looks: Rc<Cell<usize>>,
    base: f64,
}

impl Weave {
    fn new(gain: f64, view_set: &ViewSet) -> Self {
        let cells = vec![[0.5; 3]; (CELLS * CELLS) as usize];
        let of_grey = |view| woven(&view_set.textured(view, &cells, &Augmentation::NONE).augmented.image);
        let grey: Vec<f64> = (0..view_set.views.len()).map(of_grey).collect();
        Self {
            gain,
            boxes: view_set.views.iter().map(|v| v.outline).collect(),
            bad_at: None,
            looks: Rc::default(),
            base: grey.iter().sum::<f64>() / grey.len() as f64,
        }
    }
}

struct Woven {
    predictions: Vec<Prediction>,
    slope: Vec<Rgb>,
}

fn woven(picture: &[Rgb]) -> f64 {
    let sum = |(i, p): (usize, &Rgb)| (0..3).map(|c| weave(i, c) * p[c]).sum::<f64>();
    picture.iter().enumerate().map(sum).sum::<f64>() / picture.len() as f64
}

fn weave(i: usize, c: usize) -> f64 {
    (i as f64 * 0.37 + c as f64).sin() + 0.4
}

impl WhiteBox for Weave {
    fn name(&self) -> &str {
        "weave"
    }

    fn nms_iou(&self) -> f64 {
        0.65
    }

    fn predictions(&self, picture: &[Rgb], size_px: [u32; 2]) -> Result<Vec<Prediction>, WhiteBoxError> {
        Ok(self.forward(picture, size_px).predictions)
    }

    fn loss_and_gradient(
        &self,
        picture: &[Rgb],
        size_px: [u32; 2],
        outline: &BoxPx,
        boxes: Boxes,
    ) -> Result<Option<ImageLoss>, WhiteBoxError> {
        Ok(ImageLoss::from_pass(
            Box::new(self.forward(picture, size_px)),
            outline,
            boxes,
        ))
    }
}

impl Weave {
    fn forward(&self, picture: &[Rgb], size_px: [u32; 2]) -> Woven {
        assert_eq!(picture.len() as u32, size_px[0] * size_px[1]);
        let look = self.looks.get();
        self.looks.set(look + 1);
        let scale = self.gain / picture.len() as f64;
        let z = self.gain * (woven(picture) - self.base);
        let (mut confidence, mut loss) = (1.0 / (1.0 + (-z).exp()), z.max(0.0) + (-z.abs()).exp().ln_1p());
        if self.bad_at == Some(look) {
            (confidence, loss) = (f64::NAN, f64::NAN);
        }
        let prediction = |box_px| Prediction {
            is_reported: true,
            box_px,
            confidence,
            loss,
        };
        let mut predictions: Vec<Prediction> = self.boxes.iter().map(|b| prediction(*b)).collect();
        // Something in the background is always seen, and is nobody's business.
        predictions.push(Prediction {
            is_reported: true,
            box_px: BoxPx::new(0.0, 0.0, 4.0, 4.0),
            confidence: 0.999,
            loss: 6.9,
        });
        let slope = 1.0 / (1.0 + (-z).exp());
        let slope = (0..picture.len())
            .map(|i| std::array::from_fn(|c| slope * scale * weave(i, c)))
            .collect();
        Woven { predictions, slope }
    }
}

impl ForwardPass for Woven {
    fn predictions(&self) -> &[Prediction] {
        &self.predictions
    }

    fn vjp(self: Box<Self>, weights: &[f64]) -> Vec<Rgb> {
        // The background's prediction does not depend on the image.
        let weight: f64 = weights[..weights.len() - 1].iter().sum();
        self.slope.iter().map(|p| p.map(|v| weight * v)).collect()
    }
}

const CELLS: u32 = 6;

fn stored() -> FrameSet {
    FrameSet::open(&home().join("captures/skyline_frames")).unwrap()
}

fn view_set(laying: TextureMapping) -> ViewSet {
    view_set_for(laying, &Eot::NONE)
}

fn view_set_for(laying: TextureMapping, eot: &Eot) -> ViewSet {
    let grid = Grid {
        columns: CELLS,
        rows: CELLS,
        cell_mm: 40.0,
    };
    ViewSet::open(&[stored()], grid, laying, eot, || {}).unwrap()
}

fn detectors(gain: f64, view_set: &ViewSet) -> Vec<Box<dyn WhiteBox>> {
    vec![Box::new(Weave::new(gain, view_set))]
}

fn config(steps: u32) -> AttackConfig {
    AttackConfig {
        cells: CELLS,
        tile_mm: 240.0,
        steps,
        batch: 2,
        learning_rate: 0.05,
        boxes: Boxes::Strongest,
        floor: 0.5,
        against: Against::Mean,
        hard: 0.0,
        seed: 7,
        detectors: vec!["weave".to_owned()],
        ..AttackConfig::usual("car".parse().unwrap())
    }
}

fn random_cells(seed: u64) -> Vec<Rgb> {
    let mut rng = Pcg32::seed_from_u64(seed);
    (0..CELLS * CELLS)
        .map(|_| std::array::from_fn(|_| rng.random_range(0.2..0.8)))
        .collect()
}

/// The largest difference between a derivative and central differences of `value`, against the largest derivative.
fn worst(cells: &[Rgb], gradient: &[Rgb], value: impl Fn(&[Rgb]) -> f64) -> f64 {
    let largest = gradient.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(largest > 0.0, "there is a gradient");
    let step = 1e-5;
    let mut worst = 0.0_f64;
    for i in 0..cells.len() {
        for c in 0..3 {
            let at = |by: f64| {
                let mut moved = cells.to_vec();
                moved[i][c] += by;
                value(&moved)
            };
            let numeric = (at(step) - at(-step)) / (2.0 * step);
            worst = worst.max((numeric - gradient[i][c]).abs());
        }
    }
    worst / largest
}

#[test]
fn the_gradient_from_cells_to_the_loss_is_that_of_finite_differences() {
    let still = Eot {
        noise: 0.02,
        ..Eot::USUAL
    };
    for (laying, eot) in [
        (TextureMapping::World, Eot::NONE),
        (
            TextureMapping::World,
            Eot {
                shift_tiles: 0.5,
                ..still
            },
        ),
        (
            TextureMapping::World,
            Eot {
                white_balance: 0.8,
                blur_px: 2.0,
                background: 1.0,
                ..still
            },
        ),
        (
            TextureMapping::World,
            Eot {
                tile_scale: 0.1,
                turn_deg: 5.0,
                pose: 2.0,
                any_renderer: true,
                tone: 0.7,
                ..still
            },
        ),
        (
            TextureMapping::Repeated,
            Eot {
                shift_tiles: 0.5,
                tile_scale: 0.25,
                ..still
            },
        ),
        (
            TextureMapping::World,
            Eot {
                defence: Some(Defence::ResizePad),
                ..still
            },
        ),
        (
            TextureMapping::World,
            Eot {
                defence: Some(Defence::Crops(30)),
                ..still
            },
        ),
    ] {
        let view_set = view_set_for(laying, &eot);
        // Two detectors: their losses add up, each with its weight.
        let detectors: Vec<Box<dyn WhiteBox>> = vec![
            Box::new(Weave::new(4.0, &view_set)),
            Box::new(Weave::new(-9.0, &view_set)),
        ];
        for seed in 0..2 {
            let cells = random_cells(seed);
            let draw = Augmentation::random(&eot, &mut Pcg32::seed_from_u64(seed + 40));
            let view = seed as usize % view_set.views.len();
            let floor = [0.5, 0.001][seed as usize];
            let boxes = [Boxes::Strongest, Boxes::Overlap][seed as usize];
            let weights = [0.4, 1.6];
            let at = |cells: &[Rgb]| {
                loss_and_gradient(&view_set, &detectors, (view, cells, &draw), (0, boxes, floor), &weights).unwrap()
            };
            let weighted = |cells: &[Rgb]| {
                at(cells)
                    .losses
                    .iter()
                    .zip(weights)
                    .map(|(loss, weight)| weight * loss)
                    .sum()
            };
            let off = worst(&cells, &at(&cells).gradient, weighted);
            println!("{laying:?}, draw {seed}: gradients off by {off:.1e} of the largest");
            assert!(off < 1e-4, "{laying:?} {seed} {off}");
        }
    }
}

#[test]
fn penalties_have_the_gradients_of_finite_differences_and_mean_what_they_say() {
    let cells = random_cells(3);
    let columns = CELLS as usize;
    assert!(worst(&cells, &smooth(&cells, columns).1, |c| smooth(c, columns).0) < 1e-5);
    let below = random_cells(4);
    let both: Vec<Rgb> = cells.iter().chain(&below).copied().collect();
    let mean = (smooth(&cells, columns).0 + smooth(&below, columns).0) / 2.0;
    assert!((smooth(&both, columns).0 - mean).abs() < 1e-12, "one below the other");
    assert!(worst(&both, &smooth(&both, columns).1, |c| smooth(c, columns).0) < 1e-5);
    assert!(smooth(&[[0.4; 3]; 36], columns).0 < 2e-3, "one colour is smooth");
    let other = random_cells(4);
    assert!(worst(&cells, &distance(&cells, &other).1, |c| distance(c, &other).0) < 1e-5);
    assert_eq!(distance(&[[0.5; 3]; 2], &[[0.5; 3], [0.5, 0.5, 1.0]]).0, 0.125);
}

/// Each side in one colour: every pixel has the colours of the sides that are seen in it.
#[test]
fn each_side_has_cells_of_its_own() {
    let set = stored();
    let [columns, rows] = TextureMapping::Sides.grid(CELLS);
    let grid = Grid {
        columns,
        rows,
        cell_mm: 40.0,
    };
    let of_side = |side: usize| [0.1 * side as f64, 1.0 - 0.15 * side as f64, 0.5];
    let a_side = grid.cells() / 6;
    let cells: Vec<Rgb> = (0..grid.cells()).map(|i| of_side(i / a_side)).collect();
    for frame in views(&set.list.frames).iter().map(|frames| frames[0]) {
        let projection = world::project(&set, frame, &grid, true, &[Misplacement::NONE])
            .unwrap()
            .unwrap()
            .remove(0);
        let points = set.surface(frame).unwrap().unwrap();
        let factor = set.list.positions.as_ref().unwrap().factor as usize;
        let width = set.list.size_px[0] as usize;
        let mut seen = BTreeSet::<usize>::new();
        for (i, colour) in projection.forward(&cells).iter().enumerate() {
            let (x, y) = (i % width, i / width);
            let parts = (0..factor * factor).map(|p| (x * factor + p % factor, y * factor + p / factor));
            let sides: Vec<usize> = parts
                .filter_map(|(x, y)| points[y * width * factor + x].side.map(|side| side as usize))
                .collect();
            seen.extend(&sides);
            for (c, value) in colour.iter().enumerate() {
                let expected: f64 = sides.iter().map(|side| of_side(*side)[c]).sum::<f64>() / sides.len() as f64;
                assert!(
                    sides.is_empty() || (value - expected).abs() < 1e-9,
                    "{} {i}",
                    frame.name
                );
            }
        }
        assert!(seen.len() > 1, "{}: {seen:?}", frame.name);
    }
}

/// A pattern that is turned, larger, or seen two pixels off, against the same on the frame's own points.
#[test]
fn a_misplaced_pattern_is_turned_and_larger_on_each_side_and_off_in_the_image() {
    let set = stored();
    let grid = Grid {
        columns: CELLS,
        rows: CELLS,
        cell_mm: 40.0,
    };
    let cells = random_cells(7);
    let frame = &set.list.frames[0];
    let points = set.surface(frame).unwrap().unwrap();
    let factor = set.list.positions.as_ref().unwrap().factor as usize;
    let [width, height] = set.list.size_px.map(|px| px as usize);
    let laid = Misplacement {
        size: 1.2,
        turn_deg: 90.0,
        ..Misplacement::NONE
    };
    let seen = Misplacement {
        seen_off_px: [2.0, 1.0],
        ..Misplacement::NONE
    };
    let all = [Misplacement::NONE, laid, seen];
    let projections = world::project(&set, frame, &grid, false, &all).unwrap().unwrap();
    let [plain, turned, off] = [0, 1, 2].map(|i| projections[i].forward(&cells));
    let (mut looked, mut moved) = (0, 0);
    for (x, y) in (0..height - 1).flat_map(|y| (0..width - 2).map(move |x| (x, y))) {
        let parts = (0..factor * factor).map(|p| (y * factor + p / factor) * width * factor + x * factor + p % factor);
        let sides: Vec<_> = parts
            .filter_map(|p| points[p].side.map(|side| (side, points[p].place_mm)))
            .collect();
        if sides.is_empty() {
            continue;
        }
        // By a quarter turn (u, v) comes from (−v, u), and there it is 1.2 times as large.
        let expected = sides.iter().fold([0.0; 3], |sum, (side, place_mm)| {
            let [u, v] = side.project(&(*place_mm).into());
            let cell = |mm: f64| (mm / 1.2 / 40.0).floor().rem_euclid(f64::from(CELLS)) as usize;
            let colour = cells[cell(-u) * CELLS as usize + cell(-v)];
            std::array::from_fn(|c| sum[c] + colour[c] / sides.len() as f64)
        });
        let found = turned[y * width + x];
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-9), "{x} {y}");
        looked += 1;
        let there = (y + 1) * width + x + 2;
        let is_whole = |pixel: (usize, usize)| {
            let mut parts = (0..factor * factor)
                .map(|p| (pixel.1 * factor + p / factor) * width * factor + pixel.0 * factor + p % factor);
            parts.all(|p| points[p].side.is_some())
        };
        if is_whole((x, y)) && is_whole((x + 2, y + 1)) {
            let (found, expected) = (off[y * width + x], plain[there]);
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-9), "{x} {y}");
            moved += 1;
        }
    }
    assert!(looked > 500 && moved > 300, "{looked} {moved}");
}

/// What a whole run makes.
fn made(view_set: &ViewSet, config: &AttackConfig) -> (Vec<Rgb>, Vec<Entry>) {
    let folder = tempfile::tempdir().unwrap();
    let detectors = detectors(40.0, view_set);
    let attack = Attack::begin(view_set, &detectors, config, folder.path()).unwrap();
    attack.run(folder.path(), |_, _| {}).unwrap()
}

fn confidence(view_set: &ViewSet, cells: &[Rgb]) -> f64 {
    let judged = judge(view_set, &detectors(40.0, view_set), cells);
    judged.unwrap().mean_confidence
}

/// A printer that makes everything paler: the pattern asks for more contrast than it would have.
#[test]
fn a_pattern_is_moved_for_what_comes_out_of_the_printer() {
    let levels = [0, 51, 102, 153, 204, 255];
    let pale = |rgb: [u8; 3]| Lab::from_linear(rgb.map(|v| 0.25 + 0.4 * light::decode(f64::from(v) / 255.0)));
    let printer = || PrinterMap::new(Gamut::new(&levels, pale), "pale".to_owned());
    let view_set = view_set(TextureMapping::World);
    let made = |printer: Option<PrinterMap>| made(&view_set, &AttackConfig { printer, ..config(60) });
    let confidence = |cells: &[Rgb]| confidence(&view_set, cells);
    let (for_printer, entries) = made(Some(printer()));
    let (for_screen, _) = made(None);
    let [printed, clipped] = [&for_printer, &for_screen].map(|cells| confidence(&printer().printed(cells)));
    println!("as printed: made for the printer {printed:.3}, made for a screen {clipped:.3}");
    assert!(printed <= clipped);
    let judged = entries.last().unwrap().held_out.unwrap();
    assert!(
        (judged.mean_confidence - printed).abs() < 0.01,
        "what is judged is what is printed"
    );
}

/// Four dull paints: what the detector sees on the way is what is kept.
#[test]
fn a_pattern_of_paints_is_moved_for_what_the_paints_do() {
    let paints = [[70, 80, 70], [150, 140, 120], [110, 90, 80], [180, 180, 170]];
    let view_set = view_set(TextureMapping::World);
    let made = |colours: CellColours| made(&view_set, &AttackConfig { colours, ..config(60) });
    let confidence = |cells: &[Rgb]| confidence(&view_set, cells);
    let as_rgb = |cell: &Rgb| cell.map(|v| (255.0 * v).round() as u8);
    let (in_paints, entries) = made(CellColours::Palette(paints.to_vec()));
    assert!(in_paints.iter().all(|cell| paints.contains(&as_rgb(cell))));
    let colours = paints.map(|paint| paint.map(|v| f64::from(v) / 255.0));
    let first = of_pattern(&Pattern::random(CELLS, config(0).seed).unwrap());
    let first: Vec<Rgb> = first.iter().map(|cell| nearest(*cell, &colours).unwrap()).collect();
    let [own, before] = [&in_paints, &first].map(|cells| confidence(cells));
    println!("in paints {own:.3}, at first {before:.3}");
    assert!(own < 0.8 * before);
    let judged = entries.last().unwrap().held_out.unwrap();
    assert!(
        (judged.mean_confidence - own).abs() < 1e-9,
        "what is judged is what is kept"
    );
    let (own_colours, _) = made(CellColours::Own(3));
    let distinct: BTreeSet<[u8; 3]> = own_colours.iter().map(as_rgb).collect();
    assert!((2..=3).contains(&distinct.len()));
    assert!(
        confidence(&own_colours) < 0.8 * before,
        "up to three colours of its own"
    );
}

#[test]
fn a_pattern_stays_near_another_where_it_is_asked_to() {
    let view_set = view_set(TextureMapping::World);
    let near = random_cells(8);
    let off = |weight: f64| {
        let folder = tempfile::tempdir().unwrap();
        let config = AttackConfig {
            near: Some(Near {
                weight,
                cells: near.clone(),
            }),
            ..config(60)
        };
        let detectors = detectors(40.0, &view_set);
        let attack = Attack::begin(&view_set, &detectors, &config, folder.path()).unwrap();
        distance(&attack.run(folder.path(), |_, _| {}).unwrap().0, &near).0
    };
    let offs = [0.01, 1.0, 100.0].map(off);
    println!("mean squared distance: {offs:?}");
    assert!(offs[0] > offs[1] && offs[1] > offs[2] && offs[2] < 1e-3);
}

/// A coarse pattern that is refined starts as the same picture.
#[test]
fn a_coarse_pattern_is_the_same_in_finer_cells() {
    let coarse = Pattern::random(4, 1).unwrap();
    let fine = coarse.divided([12, 12]).unwrap();
    assert_eq!(fine.dimensions(), (12, 12));
    for (x, y, cell) in fine.enumerate_pixels() {
        assert_eq!(cell, coarse.cells().get_pixel(x / 3, y / 3));
    }
    assert_eq!(coarse.divided([4, 4]).unwrap(), *coarse.cells());
    // The last one would squash the picture.
    for grid in [[6, 8], [8, 6], [2, 2], [12, 8]] {
        assert!(coarse.divided(grid).is_none(), "{grid:?}");
    }
}

#[test]
fn all_boxes_count_by_the_sum_of_their_odds() {
    struct Said(Vec<Prediction>);
    impl ForwardPass for Said {
        fn predictions(&self) -> &[Prediction] {
            &self.0
        }
        fn vjp(self: Box<Self>, weights: &[f64]) -> Vec<Rgb> {
            weights.iter().map(|w| [*w, 0.0, 0.0]).collect()
        }
    }
    let model = BoxPx::new(0.0, 0.0, 40.0, 20.0);
    let of = |odds: [f64; 3], boxes: Boxes| {
        let wide = [1.0, 0.5, 0.01].map(|share| BoxPx::new(0.0, 0.0, 40.0 * share, 20.0));
        let said = wide.into_iter().zip(odds).map(|(box_px, odds)| Prediction {
            is_reported: true,
            box_px,
            confidence: odds / (1.0 + odds),
            loss: odds.ln_1p(),
        });
        ImageLoss::from_pass(Box::new(Said(said.collect())), &model, boxes).unwrap()
    };
    // The last box is not on the model.
    let odds = [0.3, 0.05, 9.0];
    assert!((of(odds, Boxes::Strongest).loss - 1.3_f64.ln()).abs() < 1e-12);
    assert!((of(odds, Boxes::All).loss - 1.35_f64.ln()).abs() < 1e-12);
    assert!((of(odds, Boxes::Overlap).loss - 1.325_f64.ln()).abs() < 1e-12);
    assert_eq!(of(odds, Boxes::All).confidence, 0.3 / 1.3);
    // By the loss of each, ln(1 + odds), as differences have it.
    for boxes in Boxes::ALL {
        let gradient = of(odds, boxes).gradient;
        for i in 0..3 {
            let by = |d: f64| {
                let mut moved = odds;
                moved[i] = (odds[i].ln_1p() + d).exp_m1();
                of(moved, boxes).loss
            };
            let difference = (by(1e-6) - by(-1e-6)) / 2e-6;
            assert!(
                (difference - gradient[i][0]).abs() < 1e-6,
                "{boxes:?} {i}: {difference} {gradient:?}"
            );
        }
    }
    // One that is as good as certain overflows nothing.
    let sure = of([1e300, 1e300, 0.0], Boxes::All);
    assert!((sure.loss - 2e300_f64.ln()).abs() < 1e-9 && sure.gradient[0][0].is_finite());
}

#[test]
fn cells_roll_round_and_back() {
    let cells = random_cells(5);
    let whole = rolled(&cells, 6, [1.0 / 6.0, 0.0]);
    assert!((whole[1][0] - cells[0][0]).abs() < 1e-12 && (whole[0][0] - cells[5][0]).abs() < 1e-12);
    let (other, by) = (random_cells(6), [0.23, -0.61]);
    let product =
        |a: &[Rgb], b: &[Rgb]| -> f64 { a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum() };
    let both: Vec<Rgb> = cells.iter().chain(&other).copied().collect();
    let each = [rolled(&cells, 6, by), rolled(&other, 6, by)].concat();
    assert_eq!(rolled(&both, 6, by), each, "one below the other");
    let there = product(&rolled(&cells, 6, by), &other);
    let back = product(&cells, &rolled(&other, 6, by.map(|v: f64| -v)));
    assert!((there - back).abs() < 1e-9);
}

#[test]
fn only_boxes_on_the_model_drive_the_loss() {
    let model = BoxPx::new(10.0, 10.0, 50.0, 40.0);
    let prediction = |box_px, confidence: f64| Prediction {
        is_reported: true,
        box_px,
        confidence,
        loss: -(1.0 - confidence).ln(),
    };
    let beside = prediction(BoxPx::new(60.0, 10.0, 90.0, 40.0), 0.99);
    let on = prediction(BoxPx::new(12.0, 10.0, 50.0, 41.0), 0.2);
    let weaker = prediction(model, 0.1);
    assert_eq!(strongest(&[beside, weaker, on], &model, MEETS_IOU), Some(2));
    assert_eq!(strongest(&[beside], &model, MEETS_IOU), None);
    assert_eq!(strongest(&[], &model, MEETS_IOU), None);
    let damaged = prediction(BoxPx::new(0.0, 0.0, 1.0, 1.0), f64::NAN);
    assert_eq!(
        strongest(&[on, damaged], &model, MEETS_IOU),
        Some(1),
        "what is not a number is not passed over"
    );
}

#[test]
fn the_attack_beats_the_genetic_search_and_that_beats_chance() {
    let view_set = view_set(TextureMapping::World);
    let detectors = detectors(60.0, &view_set);
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let config = config(60);
    let attack = Attack::begin(&view_set, &detectors, &config, folders[0].path()).unwrap();
    let (cells, entries) = attack.run(folders[0].path(), |_, _| {}).unwrap();
    let searching = search_config(2000);
    let mut oracle = BlackBox::begin(&view_set, &detectors, &searching, folders[1].path(), &|_| {}).unwrap();
    let er = genetic::search(&mut oracle, &searching).unwrap();
    let noted = oracle.finish().unwrap();
    let of = |cells: &[Rgb]| judge(&view_set, &detectors, cells).unwrap().mean_confidence;
    let chance: f64 = (0..8).map(|seed| of(&random_cells(seed))).sum::<f64>() / 8.0;
    println!(
        "mean confidence: chance {chance:.3}, er {:.3}, attack {:.3}",
        of(&er),
        of(&cells)
    );
    assert!(of(&er) < chance && of(&cells) < of(&er));
    assert_eq!((entries.len(), entries[59].queries), (60, 120));
    let in_history = entries[59].held_out.unwrap().mean_confidence;
    assert!((in_history - of(&cells)).abs() < 0.01, "but for the rounding to 8 bits");
    assert!(noted.last().unwrap().queries <= 2000);
    assert!(
        cells
            .iter()
            .flatten()
            .all(|v| (255.0 * v - (255.0 * v).round()).abs() < 1e-9),
        "cells of 8 bits"
    );
}

/// Two detectors want opposite patterns: the mean gives one of them up.
#[test]
fn the_worst_of_several_detectors_is_misled_best_when_it_counts_most() {
    let view_set = view_set(TextureMapping::World);
    let detectors: Vec<Box<dyn WhiteBox>> = vec![
        Box::new(Weave::new(60.0, &view_set)),
        Box::new(Weave::new(-20.0, &view_set)),
    ];
    let worst_of = |against: Against| {
        let config = AttackConfig {
            against,
            floor: 0.001,
            ..config(120)
        };
        let folder = tempfile::tempdir().unwrap();
        let attack = Attack::begin(&view_set, &detectors, &config, folder.path()).unwrap();
        let (cells, _) = attack.run(folder.path(), |_, _| {}).unwrap();
        let views = view_set.judged();
        let image = |view| Ok(view_set.textured(view, &cells, &Augmentation::NONE).augmented.image);
        let seen = detect(&view_set, &detectors, &views, image).unwrap();
        seen.iter().map(|seen| seen.mean_confidence()).fold(0.0, f64::max)
    };
    let (mean, worst) = (worst_of(Against::Mean), worst_of(Against::Worst));
    println!("confidence of the detector that sees it best: mean {mean:.3}, worst {worst:.3}");
    assert!(worst < mean);
}

#[test]
fn frames_of_several_models_are_looked_at_together_each_at_its_size() {
    let attack = FrameSet::open(&home().join("captures/skyline_attack")).unwrap();
    let grid = Grid {
        columns: CELLS,
        rows: CELLS,
        cell_mm: 40.0,
    };
    let open = |sets: &[FrameSet]| ViewSet::open(sets, grid, TextureMapping::World, &Eot::NONE, || {}).unwrap();
    let alone = [open(&[stored()]), open(std::slice::from_ref(&attack))];
    let sizes = [stored().list.size_px, attack.list.size_px];
    let both = open(&[stored(), attack]);
    assert_eq!(both.views.len(), alone[0].views.len() + alone[1].views.len());
    let cells = random_cells(3);
    let mut background = Augmentation::NONE;
    background.background = Some(0.99);
    let first = alone[0].views.len();
    for (view, (set, of_set)) in [(0, (0, 0)), (first, (1, 0)), (first + 1, (1, 1))] {
        let image = both.textured(view, &cells, &Augmentation::NONE).augmented.image;
        assert_eq!(both.size_px(view), sizes[set]);
        assert!(image == alone[set].textured(of_set, &cells, &Augmentation::NONE).augmented.image);
        // The last view's surroundings fit those of its own size alone; the model is still there.
        let other = both.textured(view, &cells, &background).augmented.image;
        let differ = image.iter().zip(&other).filter(|(a, b)| a != b).count();
        if sizes[set] == sizes[1] {
            assert!(
                differ > image.len() / 4 && differ < image.len(),
                "{differ} of {}",
                image.len()
            )
        } else {
            assert_eq!(differ, 0)
        }
    }
}

#[test]
fn compression_is_that_of_a_jpeg_and_colours_move_by_channel() {
    let view_set = view_set(TextureMapping::World);
    let cells = random_cells(3);
    let plain = view_set.textured(0, &cells, &Augmentation::NONE).augmented.image;
    let augmented = |eot: Eot| {
        let draw = Augmentation::random(&eot, &mut Pcg32::seed_from_u64(4));
        view_set.textured(0, &cells, &draw).augmented.image
    };
    let off = |image: &[Rgb], c: usize| {
        let squares = image.iter().zip(&plain).map(|(a, b)| (a[c] - b[c]).powi(2));
        (squares.sum::<f64>() / plain.len() as f64).sqrt()
    };
    let jpeg = |quality| {
        off(
            &augmented(Eot {
                jpeg_quality: quality,
                ..Eot::NONE
            }),
            1,
        )
    };
    assert!(jpeg(10) > 2.0 * jpeg(95) && jpeg(10) < 0.1, "{} {}", jpeg(10), jpeg(95));
    let balanced = augmented(Eot {
        white_balance: 0.6,
        ..Eot::NONE
    });
    let factors = [0, 1, 2].map(|c| {
        let open = balanced.iter().zip(&plain).filter(|(a, b)| a[c] < 1.0 && b[c] > 0.1);
        let ratios: Vec<f64> = open.map(|(a, b)| a[c] / b[c]).collect();
        assert!(
            ratios.iter().all(|ratio| (ratio - ratios[0]).abs() < 1e-9),
            "one factor a channel"
        );
        ratios[0]
    });
    let toned = augmented(Eot { tone: 0.5, ..Eot::NONE });
    let exponents: Vec<f64> = toned
        .iter()
        .zip(&plain)
        .filter(|(_, b)| (0.1..0.9).contains(&b[1]))
        .map(|(a, b)| a[1].ln() / b[1].ln())
        .collect();
    assert!(exponents.iter().all(|e| (e - exponents[0]).abs() < 1e-9), "one curve");
    assert!((0.5..=2.0).contains(&exponents[0]) && exponents[0] != 1.0);
    assert!(factors.iter().all(|f| (0.6..=1.0 / 0.6).contains(f)) && factors[0] != factors[1]);
}

/// What the detectors see in the attack is what `score --defence` shows them; the gradient goes straight through what has none.
#[test]
fn a_defence_of_pixels_is_that_of_scoring_and_lets_the_gradient_through() {
    let view_set = view_set(TextureMapping::World);
    let cells = random_cells(3);
    let plain = view_set.textured(0, &cells, &Augmentation::NONE).augmented.image;
    let size = view_set.size_px(0);
    for name in ["bit-depth", "median=3", "jpeg=50"] {
        let defence = Defence::named(name).unwrap();
        let eot = Eot {
            defence: Some(defence),
            ..Eot::NONE
        };
        let draw = Augmentation::random(&eot, &mut Pcg32::seed_from_u64(4));
        let augmented = draw.apply(&plain, size);
        let shown = defence.image(&to_image(&plain, size[0]), &Frame::whole(size)).unwrap();
        assert!(augmented.image == of_image(&shown), "{name}");
        let gradient: Vec<Rgb> = plain.iter().map(|rgb| rgb.map(|v| v - 0.3)).collect();
        assert!(augmented.vjp(gradient.clone()) == gradient, "{name}");
    }
}

fn search_config(queries: u64) -> baseline::SearchConfig {
    baseline::SearchConfig {
        method: "er",
        cells: CELLS,
        tile_mm: 240.0,
        queries,
        seed: 3,
        mapping: TextureMapping::World,
        eot: Eot::USUAL,
        frames_sha256: String::new(),
        detectors: Vec::new(),
        classes: "car".parse().unwrap(),
    }
}

#[test]
fn a_run_that_goes_on_is_one_that_never_stopped() {
    let view_set = view_set(TextureMapping::World);
    let [whole, halves] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let config = AttackConfig {
        against: Against::Worst,
        hard: 0.5,
        ..config(12)
    };
    let run = |detectors: &[Box<dyn WhiteBox>], folder: &Path| {
        Attack::begin(&view_set, detectors, &config, folder)
            .unwrap()
            .run(folder, |_, _| {})
    };
    let good = detectors(20.0, &view_set);
    let (cells, entries) = run(&good, whole.path()).unwrap();
    // It breaks off in the middle: at a number that is none, which also must leave the checkpoint whole.
    let mut bad = Weave::new(20.0, &view_set);
    bad.bad_at = Some(17);
    let broken: Vec<Box<dyn WhiteBox>> = vec![Box::new(bad)];
    let error = run(&broken, halves.path()).unwrap_err();
    assert!(matches!(error, AttackError::NotANumber { .. }), "{error}");
    assert!(error.to_string().contains("not a number"), "{error}");
    assert!(halves.path().join("checkpoint").exists());
    let looks = Rc::new(Cell::new(0));
    let mut counted = Weave::new(20.0, &view_set);
    counted.looks = Rc::clone(&looks);
    let (again, later) = run(&[Box::new(counted) as Box<dyn WhiteBox>], halves.path()).unwrap();
    assert!(
        looks.get() < 12 * 4 - 12,
        "it does not begin anew: {} looks",
        looks.get()
    );
    assert_eq!(again, cells);
    assert_eq!(later.len(), entries.len());
    assert!(
        later
            .iter()
            .zip(&entries)
            .all(|(a, b)| (a.loss, a.held_out) == (b.loss, b.held_out))
    );
    // It breaks off while a pattern is judged: after a step in the middle, and after the last, whose pattern is then only judged anew.
    let all = Rc::new(Cell::new(0));
    let mut counted = Weave::new(20.0, &view_set);
    counted.looks = Rc::clone(&all);
    run(
        &[Box::new(counted) as Box<dyn WhiteBox>],
        tempfile::tempdir().unwrap().path(),
    )
    .unwrap();
    let judged = view_set.judged().len();
    for bad_at in [config.batch as usize + judged - 1, all.get() - 1] {
        let folder = tempfile::tempdir().unwrap();
        let mut bad = Weave::new(20.0, &view_set);
        bad.bad_at = Some(bad_at);
        let error = run(&[Box::new(bad) as Box<dyn WhiteBox>], folder.path()).unwrap_err();
        assert!(error.to_string().contains("not a number"), "{error}");
        let looks = Rc::new(Cell::new(0));
        let mut counted = Weave::new(20.0, &view_set);
        counted.looks = Rc::clone(&looks);
        let (again, later) = run(&[Box::new(counted) as Box<dyn WhiteBox>], folder.path()).unwrap();
        // What was looked at before is kept, but for the judging itself.
        assert_eq!(looks.get(), all.get() - bad_at - 1 + judged);
        assert_eq!(again, cells);
        let figures = |entries: &[Entry]| entries.iter().map(|e| (e.loss, e.held_out)).collect::<Vec<_>>();
        assert_eq!(figures(&later), figures(&entries));
    }
    // Other settings do not go on with it.
    let other = AttackConfig {
        learning_rate: 0.01,
        ..config.clone()
    };
    let of_trucks = AttackConfig {
        classes: "truck".parse().unwrap(),
        ..config.clone()
    };
    for (other, which) in [
        (&other, ", here 0.01)"),
        (&of_trucks, "(classes \"car\", here \"truck\")"),
    ] {
        let refused = Attack::begin(&view_set, &good, other, whole.path()).err().unwrap();
        assert!(matches!(refused, AttackError::OtherRun { .. }));
        assert!(refused.to_string().contains(which), "{refused}");
    }
    // Nor do two runs that began together in one folder write over each other.
    let shared = tempfile::tempdir().unwrap();
    let [first, second] = [&config, &other].map(|c| Attack::begin(&view_set, &good, c, shared.path()).unwrap());
    first.run(shared.path(), |_, _| {}).unwrap();
    let refused = second.run(shared.path(), |_, _| {}).unwrap_err();
    assert!(matches!(refused, AttackError::OtherRun { .. }), "{refused}");
    Attack::begin(&view_set, &good, &config, shared.path()).unwrap();
    // Half a file, and one with a single bit turned, wherever that is.
    let written = std::fs::read(whole.path().join("checkpoint")).unwrap();
    let mut damaged = vec![b"half a file".to_vec()];
    for at in [3, 70, written.len() / 2, written.len() - 1] {
        let mut copy = written.clone();
        copy[at] ^= 4;
        damaged.push(copy);
    }
    for bytes in damaged {
        std::fs::write(whole.path().join("checkpoint"), bytes).unwrap();
        let refused = Attack::begin(&view_set, &good, &config, whole.path()).err().unwrap();
        assert!(matches!(refused, AttackError::Damaged { .. }));
    }
}

#[test]
fn a_search_that_goes_on_is_one_that_never_stopped_and_asks_nothing_twice() {
    let view_set = view_set(TextureMapping::World);
    let [whole, halves] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let config = search_config(400);
    let search = |detectors: &[Box<dyn WhiteBox>], folder: &Path| {
        let mut oracle = BlackBox::begin(&view_set, detectors, &config, folder, &|_| {})?;
        let cells = genetic::search(&mut oracle, &config)?;
        Ok::<_, AttackError>((cells, oracle.finish()?))
    };
    let (cells, entries) = search(&detectors(20.0, &view_set), whole.path()).unwrap();
    let mut bad = Weave::new(20.0, &view_set);
    bad.bad_at = Some(250);
    assert!(search(&[Box::new(bad) as Box<dyn WhiteBox>], halves.path()).is_err());
    let looks = Rc::new(Cell::new(0));
    let mut counted = Weave::new(20.0, &view_set);
    counted.looks = Rc::clone(&looks);
    let (again, later) = search(&[Box::new(counted) as Box<dyn WhiteBox>], halves.path()).unwrap();
    assert!(looks.get() < 250, "{} looks", looks.get());
    assert!(later.is_sorted_by(|a, b| a.wall_s < b.wall_s), "the time before counts");
    assert_eq!(again, cells);
    assert!(
        later
            .iter()
            .zip(&entries)
            .all(|(a, b)| (a.queries, a.held_out) == (b.queries, b.held_out))
    );
    assert_eq!(later.len(), entries.len());
    let of_trucks = baseline::SearchConfig {
        classes: "truck".parse().unwrap(),
        ..config.clone()
    };
    let good = detectors(20.0, &view_set);
    let refused = BlackBox::begin(&view_set, &good, &of_trucks, whole.path(), &|_| {})
        .err()
        .unwrap();
    assert!(matches!(refused, AttackError::OtherRun { .. }));
}

#[test]
fn steps_see_every_view_before_any_again() {
    let views: Vec<usize> = (0..10).collect();
    let mut seen: Vec<usize> = (0..5).flat_map(|step| batch(&views, 2, 1, step)).collect();
    seen.sort_unstable();
    assert_eq!(seen, views);
    assert_ne!(batch(&views, 10, 1, 0), batch(&views, 10, 1, 1));
    assert_eq!(batch(&views, 99, 1, 0).len(), 10, "no view twice in a step");
}

#[test]
fn saturated_detectors_extreme_colours_and_hidden_models_give_numbers() {
    for laying in [TextureMapping::World, TextureMapping::Repeated] {
        let view_set = view_set(laying);
        for gain in [1e4, -1e4, 0.0] {
            let detectors = detectors(gain, &view_set);
            for value in [0.0, 1.0] {
                let cells = vec![[value; 3]; (CELLS * CELLS) as usize];
                for floor in [0.5, 0.001] {
                    let looked = loss_and_gradient(
                        &view_set,
                        &detectors,
                        (0, &cells, &Augmentation::NONE),
                        (0, Boxes::All, floor),
                        &[1.0],
                    )
                    .unwrap();
                    assert!(
                        looked.losses[0].is_finite() && looked.gradient.iter().flatten().all(|v| v.is_finite()),
                        "{gain} {value} {floor}"
                    );
                }
            }
        }
        // No box is on the model: nothing to do, and nothing is done.
        let mut blind = Weave::new(1.0, &view_set);
        blind.boxes.clear();
        let blind: Vec<Box<dyn WhiteBox>> = vec![Box::new(blind)];
        let looked = loss_and_gradient(
            &view_set,
            &blind,
            (0, &random_cells(1), &Augmentation::NONE),
            (0, Boxes::Strongest, 0.5),
            &[1.0],
        )
        .unwrap();
        assert_eq!((looked.losses[0], looked.confidence), (0.0, 0.0));
        assert!(looked.gradient.iter().flatten().all(|v| *v == 0.0));
        let judged = judge(&view_set, &blind, &random_cells(1)).unwrap();
        assert_eq!((judged.ap50, judged.hit_rate), (0.0, 0.0));
    }
}

#[test]
fn the_loss_lets_go_at_its_floor() {
    let of = |confidence: f64| -(-confidence).ln_1p();
    for confidence in [1e-9, 0.001, 0.3, 0.5, 0.99] {
        let own = from_floor(of(confidence), 0.5);
        assert!(
            (own.0 / of(confidence) - 1.0).abs() < 1e-12 && (own.1 - 1.0).abs() < 1e-12,
            "DTA's own"
        );
        for floor in [0.001, 0.1] {
            let (value, slope) = from_floor(of(confidence), floor);
            let odds = |c: f64| c / (1.0 - c);
            assert!((value - (1.0 + odds(confidence) / odds(floor)).ln()).abs() < 1e-9);
            // By the logit: half of the pull is left at the floor.
            let by_logit = slope * confidence;
            let expected = 1.0 / (1.0 + odds(floor) / odds(confidence));
            assert!(
                (by_logit - expected).abs() < 1e-9,
                "{confidence} {floor}: {by_logit} {expected}"
            );
        }
    }
    let (value, slope) = from_floor(1e5, 0.001);
    assert!((value - 1e5 - 999_f64.ln()).abs() < 1e-6 && slope == 1.0);
    assert_eq!(from_floor(0.0, 0.001).0, 0.0);
}

/// Frames of a roof of 455 × 186 mm at a height of 128 mm, seen from the front at 700 mm, in three flat colours under even light.
fn roof_seen_from(pitch_deg: f64, folder: &Path) -> FrameSet {
    const SIZE: [u32; 2] = [64, 48];
    const FACTOR: u32 = 4;
    const FOCAL_PX: f64 = 88.0;
    let (sin, cos) = pitch_deg.to_radians().sin_cos();
    let centre = nalgebra::Vector3::new(700.0 * cos, 0.0, 64.0 + 700.0 * sin);
    // Rows: the camera's right, down and forward in the model frame.
    let turn = nalgebra::Matrix3::new(0.0, 1.0, 0.0, sin, 0.0, -cos, -cos, 0.0, -sin);
    let shift = -(turn * centre);
    let parts = [SIZE[0] * FACTOR, SIZE[1] * FACTOR];
    let hit = |i: u32| -> Option<[f64; 3]> {
        let (x, y) = (f64::from(i % parts[0]) + 0.5, f64::from(i / parts[0]) + 0.5);
        let at = |v: f64, size: u32| (v / f64::from(FACTOR) - 0.5 - (f64::from(size) - 1.0) / 2.0) / FOCAL_PX;
        let ray = turn.transpose() * nalgebra::Vector3::new(at(x, SIZE[0]), at(y, SIZE[1]), 1.0);
        let along = (128.0 - centre.z) / ray.z;
        let point = centre + ray * along;
        (ray.z < 0.0 && point.x.abs() < 227.5 && point.y.abs() < 93.0).then(|| point.into())
    };
    let hits: Vec<Option<[f64; 3]>> = (0..parts[0] * parts[1]).map(hit).collect();
    let share = |x: u32, y: u32| {
        let inside = (0..FACTOR * FACTOR).map(|k| (x * FACTOR + k % FACTOR, y * FACTOR + k / FACTOR));
        let seen = inside
            .filter(|(x, y)| hits[(y * parts[0] + x) as usize].is_some())
            .count();
        seen as f64 / f64::from(FACTOR * FACTOR)
    };
    let write = |name: &str, bytes: Vec<u8>| std::fs::write(folder.join(name), bytes).unwrap();
    let mask = image::GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        image::Luma([(255.0 * share(x, y)).round() as u8])
    });
    write("mask.png", encode_grey(&mask).unwrap());
    let (low, high) = ([-300.0; 3], [300.0; 3]);
    let positions = hits.iter().map(|hit| hit.unwrap_or(low));
    let about = Positions {
        low_mm: low,
        high_mm: high,
        factor: FACTOR,
    };
    write("positions.png", encode_positions(positions, parts, &about).unwrap());
    let roof = 1 + Side::ALL.iter().position(|s| *s == Side::Roof).unwrap() as u8;
    let sides = hits.iter().map(|hit| if hit.is_some() { roof } else { 0 }).collect();
    let sides = image::GrayImage::from_raw(parts[0], parts[1], sides).unwrap();
    write("sides.png", encode_grey(&sides).unwrap());
    let mut frames = Vec::new();
    for level in [0_u8, 128, 255] {
        let paint = 0.05 + 0.7 * light::decode(f64::from(level) / 255.0);
        let picture = image::RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
            let share = share(x, y);
            let seen = light::encode(share * paint + (1.0 - share) * 0.3);
            image::Rgb([(255.0 * seen).round() as u8; 3])
        });
        write(&format!("{level}.png"), encode_rgb(&picture).unwrap());
        let rows: Vec<Vec<f64>> = (0..4)
            .map(|r| match r {
                3 => vec![0.0, 0.0, 0.0, 1.0],
                r => vec![turn[(r, 0)], turn[(r, 1)], turn[(r, 2)], shift[r]],
            })
            .collect();
        frames.push(serde_json::json!({
            "name": format!("in_{level}"), "rgb": format!("{level}.png"), "object_mask": "mask.png", "paint_mask": "mask.png",
            "positions": "positions.png", "sides": "sides.png", "T_camera_model": rows, "paint": { "flat_rgb": [level, level, level] },
            "light": "even", "place": "even",
        }));
    }
    let list = serde_json::json!({
        "format": "scaleproof frames 1", "made_by": "this test", "size_px": SIZE, "target_mm": [0.0, 0.0, 64.0],
        "camera": { "focal_length_px": FOCAL_PX, "centre_px": [31.5, 23.5] },
        "positions": { "low_mm": low, "high_mm": high, "factor": FACTOR }, "frames": frames,
    });
    std::fs::write(folder.join("frames.json"), list.to_string()).unwrap();
    FrameSet::open(folder).unwrap()
}

/// From 7° up the roof is 1.8° from edge-on: all of its 16 cells' length is within two pixels.
#[test]
fn grazing_views_give_numbers_and_the_right_gradient() {
    let grid = Grid {
        columns: CELLS,
        rows: CELLS,
        cell_mm: 28.0,
    };
    for laying in [TextureMapping::World, TextureMapping::Repeated] {
        let folder = tempfile::tempdir().unwrap();
        let set = roof_seen_from(7.0, folder.path());
        let view_set = ViewSet::open(std::slice::from_ref(&set), grid, laying, &Eot::NONE, || {}).unwrap();
        let detectors = detectors(30.0, &view_set);
        let cells = random_cells(5);
        let at = |cells: &[Rgb]| {
            loss_and_gradient(
                &view_set,
                &detectors,
                (0, cells, &Augmentation::NONE),
                (0, Boxes::Strongest, 0.5),
                &[1.0],
            )
            .unwrap()
        };
        let seen = at(&cells);
        assert!(seen.losses[0].is_finite() && seen.gradient.iter().flatten().all(|v| v.is_finite()));
        let off = worst(&cells, &seen.gradient, |cells| at(cells).losses[0]);
        println!("{laying:?}: gradients of a grazing view off by {off:.1e} of the largest");
        assert!(off < 1e-4, "{laying:?}: {off}");
        if laying == TextureMapping::World {
            let reached = seen.gradient.iter().filter(|g| g.iter().any(|v| *v != 0.0)).count();
            assert!(
                reached > 30,
                "the few pixels mix the cells they show: {reached} of 36 are reached"
            );
        }
        // From below, it is not seen.
        let below = tempfile::tempdir().unwrap();
        let none = ViewSet::open(&[roof_seen_from(4.0, below.path())], grid, laying, &Eot::NONE, || {});
        assert!(matches!(none.err().unwrap(), AttackError::NothingSeen));
    }
}

#[test]
fn camou_beats_what_it_starts_from_and_goes_on_as_if_it_had_not_stopped() {
    use scaleproof_attack::baseline::camou;
    let view_set = view_set(TextureMapping::World);
    let [whole, halves] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let search = |detectors: &[Box<dyn WhiteBox>], seed: u64, folder: &Path| {
        let config = baseline::SearchConfig {
            method: "camou",
            seed,
            ..search_config(900)
        };
        let mut oracle = BlackBox::begin(&view_set, detectors, &config, folder, &|_| {})?;
        let cells = camou::search(&mut oracle, &config)?;
        Ok::<_, AttackError>((cells, oracle.finish()?))
    };
    let (cells, entries) = search(&detectors(60.0, &view_set), 1, whole.path()).unwrap();
    let judging = detectors(60.0, &view_set);
    let of = |cells: &[Rgb]| judge(&view_set, &judging, cells).unwrap().mean_confidence;
    // What 32 random patterns give, of which it takes the best to begin with.
    let chance: Vec<f64> = (0..32).map(|seed| of(&random_cells(seed))).collect();
    let best = chance.iter().copied().fold(1.0, f64::min);
    // One search of so few queries may end anywhere between .1 and .6.
    let others = [2, 3].map(|seed| {
        let folder = tempfile::tempdir().unwrap();
        search(&detectors(60.0, &view_set), seed, folder.path()).unwrap().0
    });
    let found = (of(&cells) + of(&others[0]) + of(&others[1])) / 3.0;
    println!(
        "mean confidence: chance {:.3}, the best of 32 {best:.3}, camou of three seeds {found:.3}",
        chance.iter().sum::<f64>() / 32.0,
    );
    assert!(found < best);
    assert!(entries.last().unwrap().queries <= 900 && entries.last().unwrap().held_out.is_some());
    let mut bad = Weave::new(60.0, &view_set);
    bad.bad_at = Some(400);
    assert!(search(&[Box::new(bad) as Box<dyn WhiteBox>], 1, halves.path()).is_err());
    let (again, _) = search(&detectors(60.0, &view_set), 1, halves.path()).unwrap();
    assert_eq!(again, cells);
}

/// Two views, in both of which the detector predictions the same.
#[test]
fn ap_of_held_out_views_is_that_of_a_count_by_hand() {
    struct Fixed(Vec<Prediction>);
    impl WhiteBox for Fixed {
        fn name(&self) -> &str {
            "fixed"
        }
        fn nms_iou(&self) -> f64 {
            0.5
        }
        fn predictions(&self, _: &[Rgb], _: [u32; 2]) -> Result<Vec<Prediction>, WhiteBoxError> {
            Ok(self.0.clone())
        }
        fn loss_and_gradient(
            &self,
            _: &[Rgb],
            _: [u32; 2],
            _: &BoxPx,
            _: Boxes,
        ) -> Result<Option<ImageLoss>, WhiteBoxError> {
            Ok(None)
        }
    }
    let view_set = view_set(TextureMapping::World);
    let prediction = |box_px, confidence| Prediction {
        is_reported: true,
        box_px,
        confidence,
        loss: 0.0,
    };
    let judged = |predictions: Vec<Prediction>| {
        let detectors: Vec<Box<dyn WhiteBox>> = vec![Box::new(Fixed(predictions))];
        judge(&view_set, &detectors, &random_cells(1)).unwrap()
    };
    assert_eq!(view_set.judged().len(), 2);
    let (first, far) = (view_set.views[0].outline, BoxPx::new(0.0, 0.0, 4.0, 4.0));
    let is_second = view_set.views[1].outline.iou(&first) >= 0.5;
    // A box around the first view's model, in both views: it finds one of two models, or both where they overlap.
    let alone = judged(vec![prediction(first, 0.9)]);
    let half = if is_second { 1.0 } else { 51.0 / 101.0 };
    assert!((alone.ap50 - half).abs() < 1e-9, "{alone:?}");
    // A second box on it is hidden by the first and costs nothing; a surer one elsewhere does cost.
    let twice = judged(vec![prediction(first, 0.9), prediction(first, 0.8)]);
    assert_eq!(twice.ap50, alone.ap50);
    let behind = judged(vec![prediction(first, 0.6), prediction(far, 0.9)]);
    // Two misses come first: precision 1/3, or 2/4 where both are found.
    let expected = if is_second { 0.5 } else { 51.0 / 101.0 / 3.0 };
    assert!((behind.ap50 - expected).abs() < 1e-9, "{behind:?}");
    assert_eq!(
        judged(vec![prediction(first, 0.0005)]).ap50,
        0.0,
        "below the floor of scoring"
    );
}

#[test]
fn a_view_without_the_model_is_left_out_and_frames_without_any_are_refused() {
    let copy = tempfile::tempdir().unwrap();
    let set = stored();
    for frame in &set.list.frames {
        for (_, file) in frame.files() {
            let to = copy.path().join(file);
            std::fs::create_dir_all(to.parent().unwrap()).unwrap();
            std::fs::copy(set.folder.join(file), to).unwrap();
        }
    }
    std::fs::copy(set.folder.join("frames.json"), copy.path().join("frames.json")).unwrap();
    let grid = Grid {
        columns: CELLS,
        rows: CELLS,
        cell_mm: 40.0,
    };
    let open = || {
        ViewSet::open(
            &[FrameSet::open(copy.path()).unwrap()],
            grid,
            TextureMapping::World,
            &Eot::NONE,
            || {},
        )
    };
    let mut masks: Vec<String> = set.list.frames.iter().map(|f| f.paint_mask.clone()).collect();
    masks.dedup();
    let [width, height] = set.list.size_px;
    let hide = |mask: &String| {
        image::GrayImage::new(width, height)
            .save(copy.path().join(mask))
            .unwrap()
    };
    hide(&masks[0]);
    let view_set = open().unwrap();
    assert_eq!((view_set.views.len(), view_set.unseen), (1, 1));
    masks.iter().for_each(hide);
    assert!(matches!(open().err().unwrap(), AttackError::NothingSeen));
}

#[test]
fn patches_lie_where_they_are_put() {
    let set = stored();
    let frame = &set.list.frames[0];
    let patch = PlacedPatch {
        image: image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [255, 0, 0] } else { [0, 0, 255] })).into(),
        side: Side::Roof,
        at_mm: [0.0, 0.0],
        size_mm: (400.0, 100.0),
    };
    assert_eq!(is_seen(&set, frame, &patch).unwrap(), Some(true));
    let far = PlacedPatch {
        at_mm: [9999.0, 60.0],
        ..patch.clone()
    };
    assert_eq!(is_seen(&set, frame, &far).unwrap(), Some(false));
    let painted = paint(&set, frame, &[patch], [128; 3]).unwrap().unwrap();
    let (points, factor) = (
        set.surface(frame).unwrap().unwrap(),
        set.list.positions.unwrap().factor as usize,
    );
    let width = set.list.size_px[0] as usize;
    let (mut left, mut right, mut beside) = (0, 0, 0);
    for (i, colour) in painted.iter().enumerate() {
        let part =
            |p: usize| points[((i / width) * factor + p / factor) * width * factor + (i % width) * factor + p % factor];
        let all: Vec<_> = (0..factor * factor).map(part).collect();
        let roof = |p: &scaleproof_frames::SurfacePoint| p.side == Some(Side::Roof) && p.place_mm[0].abs() < 49.0;
        // Seen from above with the front up, the model's left is on the left.
        if all.iter().all(|p| roof(p) && p.place_mm[1] > 1.0) {
            assert_eq!(*colour, [1.0, 0.0, 0.0]);
            left += 1;
        } else if all.iter().all(|p| roof(p) && p.place_mm[1] < -1.0) {
            assert_eq!(*colour, [0.0, 0.0, 1.0]);
            right += 1;
        } else if all.iter().all(|p| p.side == Some(Side::Left)) {
            let grey = light::linear_of([128; 3]);
            assert!((0..3).all(|c| (colour[c] - grey[c]).abs() < 1e-12));
            beside += 1;
        }
    }
    assert!(left > 5 && right > 5 && beside > 20, "{left} {right} {beside}");
}

/// The project's own detector sees random cells on the stored views; one that is shown next to nothing of them does not.
#[test]
fn an_attack_says_where_random_cells_leave_nothing_to_learn() {
    let folder = tempfile::tempdir().unwrap();
    let detectors = home().join("detectors");
    std::fs::copy(
        detectors.join("scaleproof_car.onnx"),
        folder.path().join("scaleproof_car.onnx"),
    )
    .unwrap();
    let manifest = std::fs::read_to_string(detectors.join("scaleproof_car.toml")).unwrap();
    for (name, std, is_hidden) in [("sees", "255.0", false), ("blind", "100000.0", true)] {
        let own = folder.path().join(format!("{name}.toml"));
        std::fs::write(
            &own,
            manifest
                .replace("255.0", std)
                .replace("scaleproof_car\"", &format!("{name}\"")),
        )
        .unwrap();
        let mut command = program();
        let command = command.args(["attack", "run", "--steps", "1", "--batch", "1", "--cells", "4"]);
        let command = command
            .args(["--augment", "median=2"])
            .arg(home().join("captures/skyline_attack"))
            .arg("--detector")
            .arg(own);
        let output = command.arg("-o").arg(folder.path().join(name)).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let text = stdout(&output);
        assert!(text.contains("random cells on these views"), "{text}");
        assert!(text.contains("both without the defence median=2"), "{text}");
        assert_eq!(text.contains("hide the model here already"), is_hidden, "{text}");
    }
}

#[test]
fn bad_arguments_are_one_sentence() {
    let frames = home().join("captures/skyline_frames");
    let out = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let mut command = program();
        command
            .arg("attack")
            .args(arguments)
            .arg(&frames)
            .arg("-o")
            .arg(out.path().join("x"));
        command.output().unwrap()
    };
    assert_refused(&run(&["run"]), &["no weights for yolox_nano", "detectors fetch"]);
    assert_refused(&run(&["run", "--detector", "nothing"]), &["nothing"]);
    assert_refused(&run(&["run", "--rate", "0"]), &["--rate"]);
    assert_refused(&run(&["run", "--rate", "1e-320"]), &["--rate", "0.000001"]);
    assert_refused(&run(&["run", "--floor", "0.7"]), &["--floor"]);
    assert_refused(&run(&["run", "--range", "200", "20"]), &["--range"]);
    let paints = home().join("print_templates/paints.toml");
    let palette = ["run", "--palette", paints.to_str().unwrap(), "--range", "20", "200"];
    assert_refused(&run(&palette), &["--range", "--palette"]);
    assert_refused(&run(&["run", "--smooth", "-1"]), &["--smooth"]);
    assert_refused(&run(&["run", "--hard", "1.5"]), &["--hard"]);
    let sides = ["run", "--laying", "sides", "--cells", "86"];
    assert_refused(&run(&sides), &["--cells is 86", "516 rows", "up to 85"]);
    let near = home().join("print_templates/random16.png");
    let near = [
        "run",
        "--cells",
        "24",
        "--near",
        near.to_str().unwrap(),
        "--near-weight",
        "1",
    ];
    assert_refused(&run(&near), &["16×16 cells, and here are 24×24", "of a half, a third"]);
    assert_refused(&run(&["run", "--augment", "blurr"]), &["blurr", "blur"]);
    assert_refused(&run(&["run", "--augment", "none,blur"]), &["none"]);
    assert_refused(&run(&["run", "--augment", "median=1"]), &["median=1", "from 2 to 15"]);
    assert_refused(
        &run(&["run", "--augment", "median,crops"]),
        &["crops", "second defence"],
    );
    assert_refused(
        &run(&["run", "--augment", "exec:./blur"]),
        &["exec:./blur", "no derivative", "median"],
    );
    assert_refused(&run(&["run", "--against", "best"]), &["best", "worst"]);
    assert_refused(&run(&["baseline", "flat", "--flat", "red"]), &["red"]);
    let patch = out.path().join("patch.png");
    image::RgbImage::new(4, 4).save(&patch).unwrap();
    for (place, size, words) in [
        ("0,60", "0", "patch width"),
        ("nan,60", "80", "patch place"),
        ("0,60", "inf", "patch width"),
    ] {
        let place = [
            "baseline",
            "patches",
            "--patch",
            patch.to_str().unwrap(),
            "--panel",
            "left",
            "--at-mm",
            place,
            "--size-mm",
            size,
        ];
        assert_refused(&run(&place), &[words]);
        assert_refused(
            &run(&[&place[..], &["--cells", "8"]].concat()),
            &["patches have no cells"],
        );
    }
    assert!(!out.path().join("x").exists(), "nothing half-written");
}

#[test]
fn a_result_is_written_whole_with_its_settings_or_not_at_all() {
    use scaleproof_attack::result::{CONFIG, PATTERN, write};
    use scaleproof_attack::setup::Setup;
    let texture = (CELLS, 240.0, TextureMapping::World);
    let detectors = (Vec::new(), Vec::new(), "car".parse().unwrap());
    let setup = Setup::open(vec![stored()], texture, &Eot::NONE, detectors, || {}).unwrap();
    let history = setup.history("dta", 1, Vec::new());
    let (cells, config) = (random_cells(1), config(2));
    let write = |folder: &Path, config| write(folder, (&cells, CELLS, TextureMapping::World), &history, config);
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    // Where one file finds no place, none is written.
    let blocked = tempfile::tempdir().unwrap();
    std::fs::create_dir(blocked.path().join(CONFIG)).unwrap();
    assert!(write(blocked.path(), Some(&config)).is_err());
    assert_eq!(names(blocked.path()), [CONFIG]);

    let folder = tempfile::tempdir().unwrap();
    assert_eq!(
        write(folder.path(), Some(&config)).unwrap(),
        folder.path().join(PATTERN)
    );
    let all = [CONFIG, "history.json", "pattern.json", PATTERN];
    assert_eq!(names(folder.path()), all);
    // What it was made to withstand goes with the pattern.
    let card = |folder: &Path| read_json(&folder.join("pattern.json"));
    assert!(card(folder.path()).get("knows_defence").is_none());
    let mut knowing = config.clone();
    knowing.eot.defence = Some(Defence::named("median").unwrap());
    write(folder.path(), Some(&knowing)).unwrap();
    assert_eq!(card(folder.path())["knows_defence"], "median=2");
    // A pattern that the attack did not make has no settings of it.
    write(folder.path(), None).unwrap();
    assert_eq!(names(folder.path()), all[1..]);
}
