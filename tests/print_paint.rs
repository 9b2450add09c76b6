//! Paint mode: stencils rendered and measured as images; paints against formulas written for the test; what is refused.

mod colour;
use crate::common;
pub mod raster;
use crate::print_template::render;

use std::path::Path;

use common::assert_refused;
use image::{Rgb, RgbImage};
use proptest::prelude::*;
use raster::{Stencil, filled};
use render::{done, pages, scaleproof, usual_request, words};
use scaleproof_core::geometry::Point2;
use scaleproof_print::paint::{PaintRequest, PaintSheets, paint_sheets};
use scaleproof_print::sheet::{Mark, Sheet};
use scaleproof_print::template::{Front, LayoutRequest, SheetPlan, TemplateRequest};
use scaleproof_print::{pdf, svg};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::{Painted, Palette};

const FEATURE_MM: f64 = 1.5;
const SOME: [[u8; 3]; 4] = [[200, 30, 30], [30, 160, 60], [40, 60, 200], [230, 220, 90]];

fn pattern_of(columns: u32, rows: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> Pattern {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    RgbImage::from_fn(columns, rows, |x, y| Rgb(colour(x, y)))
        .save(&path)
        .unwrap();
    Pattern::load(&path).unwrap()
}

fn request(size_mm: (f64, f64), tile_mm: f64) -> PaintRequest {
    PaintRequest {
        template: TemplateRequest {
            tile_mm,
            scale: 10.0,
            pattern_name: "p.png".into(),
            front: Front::Left,
            layout: LayoutRequest {
                size_mm,
                ..usual_request()
            },
        },
        min_feature_mm: FEATURE_MM,
        mirror: false,
    }
}

/// The stencils: paint from 0, where the sheet lies, the page.
fn stencils(made: &PaintSheets) -> Vec<(usize, &SheetPlan, &Sheet)> {
    let named = made.names.iter().zip(&made.pages);
    let stencil = |(name, page)| {
        let (paint, id) = str::strip_prefix(name, "paint")?.split_once('-')?;
        let plan = made.layout.sheets.iter().find(|plan| plan.id() == id)?;
        Some((paint.parse::<usize>().ok()? - 1, plan, page))
    };
    named
        .filter_map(|(name, page)| stencil((name.as_str(), page)))
        .collect()
}

fn rim_mm(plan: &SheetPlan) -> f64 {
    plan.own.left_mm - plan.carried.left_mm
}

/// The part of a rendered page inside the stencil's outer edge; tinted is open.
fn seen(page: &RgbImage, sheet: &Sheet, dpi: f64) -> Stencil {
    let mm_per_px = 25.4 / dpi;
    let px = |mm: f64| (mm / mm_per_px).round() as u32;
    let (left, top) = (px(sheet.trim.left_mm), px(sheet.height_mm - sheet.trim.top_mm));
    let (width, height) = (px(sheet.trim.width_mm()), px(sheet.trim.height_mm()));
    let cut = image::imageops::crop_imm(page, left, top, width, height).to_image();
    // The tint is the only thing on a stencil with more red than blue: lines and text are grey at their soft edges.
    let open = cut.pixels().map(|p| p.0[0].saturating_sub(p.0[2]) > 57).collect();
    Stencil {
        width: width as usize,
        height: height as usize,
        open,
        mm_per_px,
    }
}

/// The four registration holes: 24-gons of 3 mm across.
fn holes_mm2() -> f64 {
    4.0 * 0.5 * 24.0 * 1.5f64.powi(2) * (std::f64::consts::TAU / 24.0).sin()
}

/// Draws, renders and measures; gives what was drawn.
fn check(what: &str, pattern: &Pattern, paints: usize, size_mm: (f64, f64), tile_mm: f64) -> PaintSheets {
    let painted = Painted::by_count(pattern, paints).unwrap();
    let made = paint_sheets(pattern, &painted, &request(size_mm, tile_mm)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("t.pdf");
    std::fs::write(&file, pdf::write("t", &made.pages).unwrap()).unwrap();
    let first = made.pages.len() - stencils(&made).len() + 1;
    let dpi = 300.0;
    let rendered = pages(&file, first, dpi);
    let mut open = vec![0.0; paints];
    let mut uncut = vec![0.0; paints];
    for ((paint, plan, sheet), page) in stencils(&made).into_iter().zip(&rendered) {
        let name = format!("{what}, paint {} on {}", paint + 1, plan.id());
        let stencil = seen(page, sheet, dpi);
        stencil.assert_sound(FEATURE_MM, &name);
        open[paint] += stencil.open_mm2() - holes_mm2();
        uncut[paint] += assert_in_its_cells(&stencil, plan, &painted, paint, made.cell_mm, &name);
    }
    assert_areas(what, &made, size_mm);
    for (paint, area) in made.areas.iter().enumerate() {
        let stated = (area.openings_mm2, area.bridges_mm2);
        println!(
            "{what}, paint {}: openings {:.1} (measured {:.1}), bridges {:.1} ({:.1}) mm²",
            paint + 1,
            stated.0,
            open[paint],
            stated.1,
            uncut[paint]
        );
        // A small part of a pixel along all edges; what is uncut counts the pixels that err to one side only.
        assert!(
            (open[paint] - stated.0).abs() < 0.003 * stated.0 + 1.0,
            "{what}: openings of paint {}",
            paint + 1
        );
        assert!(
            (uncut[paint] - stated.1).abs() < 0.006 * stated.0 + 1.0,
            "{what}: bridges of paint {}",
            paint + 1
        );
    }
    made
}

fn assert_areas(what: &str, made: &PaintSheets, size_mm: (f64, f64)) {
    // The program's unit is a ten-thousandth of a millimetre.
    let held = |mm: f64| (mm * 1e4).round() / 1e4;
    let panel = held(size_mm.0) * held(size_mm.1);
    assert!(
        (made.whole().cells_mm2 - panel).abs() < 1e-6,
        "{what}: {} of {panel} mm²",
        made.whole().cells_mm2
    );
    for area in &made.areas {
        let sum = area.openings_mm2 + area.bridges_mm2;
        assert!(
            (sum - area.cells_mm2).abs() < 1e-3,
            "{what}: {sum} of {} mm²",
            area.cells_mm2
        );
    }
}

/// No opening lets this paint onto another's cell. Gives the area of the paint's cells that is not open.
fn assert_in_its_cells(
    stencil: &Stencil,
    plan: &SheetPlan,
    painted: &Painted,
    paint: usize,
    cell_mm: f64,
    what: &str,
) -> f64 {
    let mut uncut = 0;
    for y in 0..stencil.height {
        for x in 0..stencil.width {
            let on_panel = |px: usize, from: f64| from - rim_mm(plan) + (px as f64 + 0.5) * stencil.mm_per_px;
            let (px, py) = (on_panel(x, plan.own.left_mm), on_panel(y, plan.own.top_mm));
            let own = plan.own;
            if px < own.left_mm || px > own.right_mm || py < own.top_mm || py > own.bottom_mm {
                continue;
            }
            let open = stencil.open[y * stencil.width + x];
            let mine = |dx: f64, dy: f64| {
                let cell = |mm: f64| (mm.max(0.0) / cell_mm) as usize;
                painted.paint_at(cell(px + dx), cell(py + dy)) == paint
            };
            let near = [(0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)];
            assert!(
                !open || near.iter().any(|(dx, dy)| mine(*dx, *dy)),
                "{what}: open at ({px:.2}, {py:.2}), not its cell"
            );
            uncut += usize::from(!open && mine(0.0, 0.0));
        }
    }
    uncut as f64 * stencil.mm_per_px.powi(2)
}

#[test]
fn a_checkerboard_hangs_together_in_every_corner() {
    let board = pattern_of(2, 2, |x, y| SOME[((x + y) % 2) as usize]);
    check("checkerboard", &board, 2, (84.0, 60.0), 12.0);
    // Every cell as small as it may be.
    check("smallest checkerboard", &board, 2, (54.0, 45.0), 9.0);
}

#[test]
fn islands_and_rings_are_held() {
    let islands = pattern_of(3, 3, |x, y| SOME[usize::from((x, y) == (1, 1))]);
    check("islands", &islands, 2, (90.0, 72.0), 18.0);
    let rings = pattern_of(13, 13, |x, y| SOME[(6 - x.abs_diff(6).max(y.abs_diff(6))) as usize % 3]);
    check("rings", &rings, 3, (91.0, 91.0), 91.0);
    let lone = pattern_of(14, 10, |x, y| SOME[usize::from((x, y) == (7, 4))]);
    let made = check("all but one cell", &lone, 2, (84.0, 60.0), 84.0);
    // The island of 6 mm hangs on one bridge to the nearest rim: over four cells, 24 mm of 1.5 mm.
    assert!(
        (made.areas[0].bridges_mm2 - 36.0).abs() < 0.1,
        "{}",
        made.areas[0].bridges_mm2
    );
}

/// A panel over several sheets, whose right and lower cells are cut off, with a slanted repeat.
#[test]
fn a_panel_over_several_sheets_is_sound_on_each() {
    let pattern = Pattern::random(11, 5).unwrap();
    let made = check("random", &pattern, 4, (331.0, 203.0), 83.7);
    assert!(made.layout.sheets.len() > 1 && stencils(&made).len() == 4 * made.layout.sheets.len());
    // Registration holes and the outer edge are at the same place of the page for every paint of a sheet.
    for plan in &made.layout.sheets {
        let pages = stencils(&made)
            .into_iter()
            .filter(|(_, other, _)| other.id() == plan.id());
        let holes: Vec<_> = pages
            .map(|(_, _, page)| {
                (
                    page.trim,
                    cut_outlines(page).into_iter().rev().take(4).collect::<Vec<_>>(),
                )
            })
            .collect();
        assert!(
            holes.len() == 4 && holes.iter().all(|h| *h == holes[0]),
            "sheet {}",
            plan.id()
        );
    }
}

/// The outlines for the cutter, in mm from the outer edge's top-left corner, y down.
fn cut_outlines(sheet: &Sheet) -> Vec<Vec<(f64, f64)>> {
    let cuts = sheet.marks.iter().filter_map(|mark| match mark {
        Mark::Cut { outlines, .. } => Some(outlines),
        _ => None,
    });
    let place = |o: &Vec<_>| {
        let corner = |p: &Point2| (p[0] - sheet.trim.left_mm, sheet.trim.top_mm - p[1]);
        o.iter().map(corner).collect()
    };
    cuts.flatten().map(place).collect()
}

fn as_picture(sheet: &Sheet, mm_per_px: f64) -> Stencil {
    filled(
        &cut_outlines(sheet),
        (sheet.trim.width_mm(), sheet.trim.height_mm()),
        mm_per_px,
    )
}

/// Every patch of one paint has one number, its paint's, and lines where paints meet and nowhere else; the legend shows each
/// number beside its colour.
#[test]
fn the_numbers_and_the_legend_name_the_paints() {
    let pattern = Pattern::random(9, 6).unwrap();
    let painted = Painted::by_count(&pattern, 4).unwrap();
    let made = paint_sheets(&pattern, &painted, &request((331.0, 203.0), 99.0)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("t.pdf");
    std::fs::write(&file, pdf::write("t", &made.pages).unwrap()).unwrap();
    let rendered = pages(&file, 1, 200.0);
    let (mut sheets, mut patches) = (0, 0);
    for (i, (name, sheet)) in made.names.iter().zip(&made.pages).enumerate() {
        let words = words(&file, i + 1);
        if name.starts_with("legend") {
            for (number, used) in painted.paints.iter().enumerate() {
                legend_shows(number + 1, used.paint.rgb, &used.paint.hex(), &words, &rendered[i]);
            }
        } else if let Some(id) = name.strip_prefix("numbers-") {
            let plan = made.layout.sheets.iter().find(|plan| plan.id() == id).unwrap();
            let numbers = NumberSheet {
                plan,
                sheet,
                painted: &painted,
                cell_mm: made.cell_mm,
            };
            patches += numbers.patches_are_numbered(&words);
            numbers.lines_are_where_paints_meet(&rendered[i]);
            sheets += 1;
        }
    }
    println!("{patches} patches on {sheets} sheets, each with its number");
    assert!(sheets == made.layout.sheets.len() && sheets > 1 && patches > 40);
}

/// A paint's row of the legend: its number, a swatch of its colour, its sRGB.
fn legend_shows(number: usize, rgb: [u8; 3], hex: &str, words: &[(String, [f64; 4])], page: &RgbImage) {
    let (_, at) = words.iter().find(|(word, _)| word == hex).expect(hex);
    let middle = 0.5 * (at[1] + at[3]);
    let (_, before) = words
        .iter()
        .find(|(word, area)| *word == number.to_string() && area[1] < middle && middle < area[3])
        .unwrap_or_else(|| panic!("no {number} beside {hex}"));
    let px = |mm: f64| (mm / 25.4 * 200.0) as u32;
    let swatch = (px(before[2])..px(at[0])).filter(|x| page.get_pixel(*x, px(middle)).0 == rgb);
    assert!(swatch.count() > 20, "no swatch of {hex}");
}

/// A sheet to paint by number.
struct NumberSheet<'a> {
    plan: &'a SheetPlan,
    sheet: &'a Sheet,
    painted: &'a Painted,
    cell_mm: f64,
}

impl NumberSheet<'_> {
    /// The columns and rows of cells on it.
    fn cells(&self) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let own = self.plan.own;
        let cell = |mm: f64| (mm / self.cell_mm + 1e-6).floor() as usize;
        let end = |mm: f64| (mm / self.cell_mm - 1e-6).ceil() as usize;
        (
            cell(own.left_mm)..end(own.right_mm),
            cell(own.top_mm)..end(own.bottom_mm),
        )
    }

    /// Where a place of the panel is on the page, from its top-left corner.
    fn on_page(&self, x_mm: f64, y_mm: f64) -> (f64, f64) {
        let (own, trim) = (self.plan.own, self.sheet.trim);
        let top = self.sheet.height_mm - trim.top_mm;
        (trim.left_mm + x_mm - own.left_mm, top + y_mm - own.top_mm)
    }

    /// Gives how many there are.
    fn patches_are_numbered(&self, words: &[(String, [f64; 4])]) -> usize {
        let (columns, rows) = self.cells();
        let paint = |(column, row): (usize, usize)| self.painted.paint_at(column, row);
        let mut patch = std::collections::BTreeMap::new();
        let mut count = 0;
        for start in rows
            .clone()
            .flat_map(|row| columns.clone().map(move |column| (column, row)))
        {
            let mut open = vec![start];
            while let Some((column, row)) = open.pop() {
                let inside = columns.contains(&column) && rows.contains(&row) && paint((column, row)) == paint(start);
                if !inside || patch.contains_key(&(column, row)) {
                    continue;
                }
                patch.insert((column, row), count);
                open.extend([(column + 1, row), (column, row + 1)]);
                open.extend(column.checked_sub(1).map(|column| (column, row)));
                open.extend(row.checked_sub(1).map(|row| (column, row)));
            }
            count += usize::from(patch[&start] == count);
        }
        let mut seen = vec![0; count];
        let (left, top) = self.on_page(self.plan.own.left_mm, self.plan.own.top_mm);
        for (word, [x0, y0, x1, y1]) in words {
            let cell = |mm: f64| (mm / self.cell_mm).floor() as usize;
            let (x, y) = (0.5 * (x0 + x1) - left, 0.5 * (y0 + y1) - top);
            let (width, height) = (self.sheet.trim.width_mm(), self.sheet.trim.height_mm());
            if (0.0..width).contains(&x) && (0.0..height).contains(&y) {
                let at = (cell(x + self.plan.own.left_mm), cell(y + self.plan.own.top_mm));
                assert_eq!(*word, (paint(at) + 1).to_string(), "{at:?} on {}", self.plan.id());
                seen[patch[&at]] += 1;
            }
        }
        assert!(seen.iter().all(|n| *n == 1), "{}: {seen:?}", self.plan.id());
        count
    }

    fn lines_are_where_paints_meet(&self, page: &RgbImage) {
        let (columns, rows) = self.cells();
        let dark = |x_mm: f64, y_mm: f64| {
            let (x, y) = self.on_page(x_mm, y_mm);
            let px = |mm: f64| (mm / 25.4 * 200.0) as u32;
            let near = (0..9).map(|i| page.get_pixel(px(x) + i % 3 - 1, px(y) + i / 3 - 1).0[0]);
            near.min().unwrap() < 100
        };
        // Three places of every border: a number may lie on one of them.
        let along = [0.12, 0.5, 0.88];
        for row in rows.start + 1..rows.end - 1 {
            for column in columns.start + 1..columns.end - 1 {
                let (x, y) = (column as f64 * self.cell_mm, row as f64 * self.cell_mm);
                let beside = along.map(|share| dark(x, y + share * self.cell_mm));
                let above = along.map(|share| dark(x + share * self.cell_mm, y));
                let paint = |column, row| self.painted.paint_at(column, row);
                let here = paint(column, row);
                for (lines, other) in [(beside, paint(column - 1, row)), (above, paint(column, row - 1))] {
                    let all = lines.iter().all(|line| *line);
                    assert!((here != other) == all, "({column}, {row}): {lines:?}");
                }
            }
        }
    }
}

#[test]
fn a_mirrored_stencil_is_the_stencil_from_behind() {
    let pattern = Pattern::random(8, 2).unwrap();
    let painted = Painted::by_count(&pattern, 3).unwrap();
    let plain = request((120.0, 80.0), 60.0);
    let mirrored = PaintRequest {
        mirror: true,
        ..plain.clone()
    };
    let made = paint_sheets(&pattern, &painted, &plain).unwrap();
    let back = paint_sheets(&pattern, &painted, &mirrored).unwrap();
    assert_eq!(made.areas, back.areas);
    for ((_, _, front), (_, _, back)) in stencils(&made).into_iter().zip(stencils(&back)) {
        let (front, back) = (as_picture(front, 0.1), as_picture(back, 0.1));
        let mut differ = 0;
        for y in 0..front.height {
            for x in 0..front.width {
                let other = y * front.width + front.width - 1 - x;
                differ += usize::from(front.open[y * front.width + x] != back.open[other]);
            }
        }
        // Pixels whose centre is on an edge.
        assert!(
            differ < front.open.len() / 500,
            "{differ} of {} pixels",
            front.open.len()
        );
    }
}

/// The cut layer of the SVG has closed outlines, holes the other way round, that enclose what is stated.
#[test]
fn the_cut_layer_is_what_a_cutter_needs() {
    let pattern = Pattern::random(8, 7).unwrap();
    let painted = Painted::by_count(&pattern, 2).unwrap();
    let made = paint_sheets(&pattern, &painted, &request((120.0, 80.0), 60.0)).unwrap();
    for (paint, _, sheet) in stencils(&made) {
        let text = svg::write("t", sheet);
        let document = roxmltree::Document::parse(&text).unwrap();
        let layer = document
            .descendants()
            .find(|n| n.attribute("id") == Some("cut"))
            .unwrap();
        let paths: Vec<&str> = layer.descendants().filter_map(|n| n.attribute("d")).collect();
        let mut doubled = 0.0;
        for path in &paths {
            let corners = path
                .strip_prefix('M')
                .and_then(|p| p.strip_suffix('Z'))
                .expect("one closed outline");
            let corners: Vec<(f64, f64)> = corners
                .split('L')
                .map(|corner| {
                    corner
                        .split_once(' ')
                        .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
                        .unwrap()
                })
                .collect();
            assert!(corners.len() > 2);
            let next = corners.iter().cycle().skip(1);
            doubled += corners
                .iter()
                .zip(next)
                .map(|(a, b)| b.0 * a.1 - a.0 * b.1)
                .sum::<f64>();
        }
        let enclosed = doubled / 2.0 - holes_mm2();
        let stated = made.areas[paint].openings_mm2;
        assert!(
            (enclosed - stated).abs() < 0.05,
            "paint {}: {enclosed} of {stated} mm²",
            paint + 1
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    /// Any pattern, size, tile and number of paints: every stencil is sound, and the areas add up.
    #[test]
    fn stencils_of_any_pattern_are_sound(
        side in (2..9u32, 2..9u32),
        colours in prop::collection::vec(0..4usize, 81),
        cell_mm in 4.5..12.0f64,
        size_mm in (5.0..90.0f64, 5.0..70.0f64),
    ) {
        let (columns, rows) = side;
        let pattern = pattern_of(columns, rows, |x, y| SOME[colours[(y * 9 + x) as usize]]);
        let mut distinct: Vec<[u8; 3]> = pattern.cells().pixels().map(|p| p.0).collect();
        distinct.sort_unstable();
        distinct.dedup();
        prop_assume!(distinct.len() > 1);
        let painted = Painted::by_count(&pattern, distinct.len()).unwrap();
        prop_assert!(painted.delta_e().1 < 1e-9, "as many paints as colours are these colours");
        let request = request(size_mm, cell_mm * f64::from(columns) + 1e-9);
        let made = paint_sheets(&pattern, &painted, &request).unwrap();
        assert_areas("any", &made, size_mm);
        for (paint, plan, sheet) in stencils(&made) {
            as_picture(sheet, 0.12).assert_sound(FEATURE_MM, &format!("paint {} on {}", paint + 1, plan.id()));
        }
    }

    #[test]
    fn the_nearest_paint_is_the_nearest_of_all(seed in 0..1000u64, paints in prop::collection::vec(any::<[u8; 3]>(), 2..20)) {
        let pattern = Pattern::random(6, seed).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("palette.toml");
        let table = |(i, rgb): (usize, &[u8; 3])| format!("[[paint]]\nname = \"paint {i}\"\nrgb = {rgb:?}\n");
        std::fs::write(&file, paints.iter().enumerate().map(table).collect::<String>()).unwrap();
        let Ok(palette) = Palette::load(&file) else { return Ok(()) };
        let Ok(painted) = Painted::by_palette(&pattern, &palette) else { return Ok(()) };
        let mut off = vec![Vec::new(); painted.paints.len()];
        for (x, y, cell) in pattern.cells().enumerate_pixels() {
            let taken = painted.paint_at(x as usize, y as usize);
            let far = |rgb: [u8; 3]| colour::delta_e(colour::lab(cell.0), colour::lab(rgb));
            let here = far(painted.paints[taken].paint.rgb);
            let least = paints.iter().map(|rgb| far(*rgb)).fold(f64::INFINITY, f64::min);
            prop_assert!(here < least + 0.01, "{here}, but {least} was to be had");
            off[taken].push(here);
        }
        for (used, off) in painted.paints.iter().zip(off) {
            prop_assert_eq!(used.cells as usize, off.len());
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            let max = off.iter().copied().fold(0.0, f64::max);
            prop_assert!((used.mean_delta_e - mean).abs() < 0.01 && (used.max_delta_e - max).abs() < 0.02, "{:?}: {} {}", used, mean, max);
        }
    }

    /// k-means against all ways to split seven colours: Lloyd's steps end in a local optimum, within 2 % of the best.
    #[test]
    fn few_colours_are_clustered_as_well_as_can_be(colours in prop::collection::vec(any::<[u8; 3]>(), 7), count in 2..4usize) {
        let pattern = pattern_of(7, 1, |x, _| colours[x as usize]);
        let Ok(painted) = Painted::by_count(&pattern, count) else { return Ok(()) };
        let labs: Vec<[f64; 3]> = colours.iter().map(|rgb| colour::lab(*rgb)).collect();
        let spread = |of: &dyn Fn(usize) -> usize| -> f64 {
            (0..count).map(|k| {
                let mine: Vec<&[f64; 3]> = (0..7).filter(|i| of(*i) == k).map(|i| &labs[i]).collect();
                (0..3).map(|c| {
                    let mean = mine.iter().map(|lab| lab[c]).sum::<f64>() / mine.len().max(1) as f64;
                    mine.iter().map(|lab| (lab[c] - mean).powi(2)).sum::<f64>()
                }).sum::<f64>()
            }).sum()
        };
        let best = (0..count.pow(7)).map(|code| spread(&|i| code / count.pow(i as u32) % count)).fold(f64::INFINITY, f64::min);
        let found = spread(&|i| painted.paint_at(i, 0));
        prop_assert!(found <= best * 1.02 + 0.1, "{found}, but {best} was to be had");
    }
}

/// Every impossible request, and words of the answer.
#[test]
fn impossible_requests_are_refused_in_one_sentence_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("p.png"), Pattern::random(16, 1).unwrap().to_png().unwrap()).unwrap();
    std::fs::write(path("plain.png"), pattern_of(2, 2, |_, _| [9; 3]).to_png().unwrap()).unwrap();
    std::fs::write(
        path("two.png"),
        pattern_of(2, 2, |x, _| SOME[x as usize]).to_png().unwrap(),
    )
    .unwrap();
    let paint = |name: &str, rgb: &str| format!("[[paint]]\nname = \"{name}\"\nrgb = {rgb}\n");
    let (red, blue) = (paint("Red", "[200, 0, 0]"), paint("Blue", "[0, 0, 200]"));
    for (name, text) in [
        ("good.toml", format!("{red}{blue}")),
        ("one.toml", red.clone()),
        ("none.toml", String::new()),
        ("twice.toml", format!("{red}{}", paint("Red", "[1, 2, 3]"))),
        ("same.toml", format!("{red}{}", paint("Rot", "[200, 0, 0]"))),
        ("bright.toml", format!("{red}{}", paint("Sun", "[256, 2, 3]"))),
        ("negative.toml", format!("{red}{}", paint("Night", "[-1, 2, 3]"))),
        ("unknown.toml", format!("{red}{blue}gloss = true\n")),
        ("nameless.toml", format!("{red}{}", paint(" ", "[1, 2, 3]"))),
        (
            "far.toml",
            format!("{}{}", paint("Grey", "[9, 9, 10]"), paint("White", "[255, 255, 255]")),
        ),
        ("text.toml", "paint by numbers".to_owned()),
    ] {
        std::fs::write(path(name), text).unwrap();
    }
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    let usual = "--tile-mm 118 --size-mm 180x120";
    for (pattern, options, words) in [
        (
            "p.png",
            format!("{usual} --paints 1"),
            ["1 paint cannot", "ask for 2 to 24"],
        ),
        ("p.png", format!("{usual} --paints 0"), ["0 paints", "ask for 2 to 24"]),
        (
            "p.png",
            format!("{usual} --paints 25"),
            ["25 paints", "ask for 2 to 24"],
        ),
        (
            "p.png",
            format!("{usual} --paints -3"),
            ["-3 paints", "ask for 2 to 24"],
        ),
        (
            "two.png",
            format!("{usual} --paints 3"),
            ["2 colours", "requested paints; ask for 2"],
        ),
        (
            "plain.png",
            format!("{usual} --paints 2"),
            ["1 colour,", "needs no stencil"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("absent.toml")),
            ["absent.toml", "no such file"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("one.toml")),
            ["this one 1", "2 to 256"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("none.toml")),
            ["this one 0", "2 to 256"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("twice.toml")),
            ["'Red'", "two paints"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("same.toml")),
            ["'Rot'", "one colour"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("bright.toml")),
            ["'Sun'", "0 to 255"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("negative.toml")),
            ["'Night'", "0 to 255"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("unknown.toml")),
            ["gloss", "[[paint]]"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("nameless.toml")),
            ["no name", "[[paint]]"],
        ),
        (
            "p.png",
            format!("{usual} --palette {}", path("text.toml")),
            ["text.toml", "[[paint]]"],
        ),
        (
            "plain.png",
            format!("{usual} --palette {}", path("far.toml")),
            ["'Grey'", "other paints"],
        ),
        (
            "p.png",
            "--tile-mm 60 --size-mm 180x120 --paints 4".to_owned(),
            ["cells of 3.75 mm", "--min-feature-mm 1.25 or less, or --tile-mm 72"],
        ),
        (
            "p.png",
            format!("{usual} --paints 4 --min-feature-mm 0"),
            ["minimum feature width cannot be 0", "0.2 to 10"],
        ),
        (
            "p.png",
            format!("{usual} --paints 4 --min-feature-mm nan"),
            ["minimum feature width cannot be NaN", "0.2 to 10"],
        ),
        (
            "p.png",
            format!("{usual} --paints 4 --min-feature-mm 11"),
            ["minimum feature width cannot be 11", "0.2 to 10"],
        ),
        (
            "p.png",
            "--tile-mm 118 --size-mm 5000x4000 --paints 4".to_owned(),
            ["pages", "fewer paints"],
        ),
        (
            "p.png",
            "--tile-mm 0 --size-mm 180x120 --paints 4".to_owned(),
            ["tile width cannot be 0", "above 0"],
        ),
        ("p.png", format!("{usual} --mirror"), ["--paints", "required"]),
        (
            "p.png",
            format!("{usual} --paints 4 --bleed-mm 3"),
            ["--bleed-mm", "cannot be used with"],
        ),
        (
            "p.png",
            format!("{usual} --paints 4 --palette {}", path("good.toml")),
            ["--paints", "cannot be used with"],
        ),
    ] {
        let output = scaleproof(&format!(
            "print template --pattern {} {options} -o {}",
            path(pattern),
            path("out/t.pdf")
        ));
        println!("{}", String::from_utf8_lossy(&output.stderr).trim_end());
        assert_refused(&output, &words);
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            before,
            "{options} left a file"
        );
    }
    let palette = path("good.toml");
    let output = scaleproof(&format!(
        "print template --pattern {} {usual} --palette {palette} -o {palette} --format pdf",
        path("p.png")
    ));
    assert_refused(&output, &["is an input"]);
}

/// By the command of its README.
#[test]
fn the_shipped_example_is_what_its_command_gives() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("print_templates");
    let folder = tempfile::tempdir().unwrap();
    let (name, made) = ("random16_paint.pdf", folder.path().join("random16_paint.pdf"));
    let (pattern, palette) = (shipped.join("random16.png"), shipped.join("paints.toml"));
    let (pattern, palette) = (pattern.display(), palette.display());
    let command = format!("print template --pattern {pattern} --tile-mm 118 --size-mm 118x118 --palette {palette} -o");
    done(&format!("{command} {}", made.display()));
    let bytes = std::fs::read(&made).unwrap();
    assert!(
        bytes == std::fs::read(shipped.join(name)).unwrap(),
        "{name} is out of date: its README says how to make it again"
    );
    println!("{} bytes", bytes.len());
    // As SVG, a file a page, and the report's areas add up to the panel: 11.8 cm squared.
    let output = scaleproof(&format!("{command} {}", folder.path().join("s.svg").display()));
    let text = String::from_utf8(output.stdout).unwrap();
    println!("{text}");
    let areas: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split_whitespace().rev().nth(4)?.parse().ok())
        .collect();
    let (panel, paints) = areas.split_last().unwrap();
    assert!(
        (paints.iter().sum::<f64>() - panel).abs() < 0.03 && (panel - 139.24).abs() < 0.005,
        "{areas:?}"
    );
    for page in ["paint", "legend1", "numbers-A1", "paint1-A1"] {
        assert!(folder.path().join(format!("s-{page}.svg")).exists(), "{page}");
    }
}
