//! Measures a rendered template: edges, ruler ticks, cell colours, and the pieces laid edge to edge.

#![allow(dead_code)] // each test file uses its part

use image::{Rgb, RgbImage};
use scaleproof_print::template::{SheetLayout, SheetPlan};
use scaleproof_surface::pattern::Pattern;

/// How far from its nominal place an edge is looked for.
const REACH_MM: f64 = 0.42;
/// What cut sheets laid edge to edge are held to.
const SEAM_MM: f64 = 0.1;
/// The ghost line lies this far into the overlap.
const GHOST_MM: f64 = 0.4;
const WHITE: [u8; 3] = [255; 3];

/// A printed template and the numbers it was asked for.
pub struct Printed {
    pub pattern: Pattern,
    pub cell_mm: f64,
    pub size_mm: (f64, f64),
    pub layout: SheetLayout,
    pub dpi: f64,
    /// What the printed millimetres are held to.
    pub tolerance_mm: f64,
    /// The pages of the sheets, without the instructions.
    pub pages: Vec<RgbImage>,
}

impl Printed {
    fn mm_per_px(&self) -> f64 {
        25.4 / self.dpi
    }

    fn sheets(&self) -> impl Iterator<Item = (&SheetPlan, &RgbImage)> {
        assert_eq!(self.layout.sheets.len(), self.pages.len(), "one page per sheet");
        self.layout.sheets.iter().zip(&self.pages)
    }

    /// The nominal colour at a point of the template (from its top-left corner, y down).
    fn colour_at(&self, x_mm: f64, y_mm: f64) -> [u8; 3] {
        // The bleed lies before the first cell, and shows the last ones of the repeat before.
        let cell = |mm: f64, count: u32| (mm / self.cell_mm).floor().rem_euclid(f64::from(count)) as u32;
        let (column, row) = (cell(x_mm, self.pattern.columns()), cell(y_mm, self.pattern.rows()));
        self.pattern.cells().get_pixel(column, row).0
    }

    /// The template coordinates at which the colour may change along one axis: cell edges and both ends of the stretch.
    fn edges(&self, from_mm: f64, to_mm: f64) -> Vec<f64> {
        let first = (from_mm / self.cell_mm).floor() as i32 + 1;
        let inner = (first..)
            .map(|i| f64::from(i) * self.cell_mm)
            .take_while(|x| *x < to_mm - 1e-9);
        [from_mm].into_iter().chain(inner).chain([to_mm]).collect()
    }

    /// Middles of the cells along one axis that lie well inside a stretch.
    fn middles(&self, from_mm: f64, to_mm: f64) -> Vec<f64> {
        let all = (-1000..).map(|i| (f64::from(i) + 0.5) * self.cell_mm);
        all.skip_while(|m| *m < from_mm + 0.5)
            .take_while(|m| *m < to_mm - 0.5)
            .collect()
    }
}

/// A line of pixels across a page; positions are in mm from the page's left or top edge.
struct Scan<'a> {
    page: &'a RgbImage,
    mm_per_px: f64,
    down: bool,
    across_px: u32,
}

impl<'a> Scan<'a> {
    fn new(printed: &Printed, page: &'a RgbImage, down: bool, across_mm: f64) -> Self {
        let mm_per_px = printed.mm_per_px();
        Self {
            page,
            mm_per_px,
            down,
            across_px: (across_mm / mm_per_px) as u32,
        }
    }

    fn pixel(&self, along: u32) -> [u8; 3] {
        let (x, y) = if self.down {
            (self.across_px, along)
        } else {
            (along, self.across_px)
        };
        self.page.get_pixel(x, y).0
    }

    /// The pixels within [`REACH_MM`].
    fn window(&self, nominal_mm: f64) -> std::ops::Range<u32> {
        let centre = (nominal_mm / self.mm_per_px).round() as u32;
        let reach = (REACH_MM / self.mm_per_px).round() as u32;
        centre - reach..centre + reach
    }

    /// Where the colour goes over from `before` to `after`, to a fraction of a pixel: a soft pixel belongs to both sides by
    /// its mixture.
    fn edge_mm(&self, nominal_mm: f64, before: [u8; 3], after: [u8; 3]) -> f64 {
        let window = self.window(nominal_mm);
        let step: Vec<f64> = (0..3).map(|c| f64::from(after[c]) - f64::from(before[c])).collect();
        let square: f64 = step.iter().map(|s| s * s).sum();
        let mut position = f64::from(window.start);
        for along in window {
            let pixel = self.pixel(along);
            let passed: f64 = (0..3)
                .map(|c| (f64::from(pixel[c]) - f64::from(before[c])) * step[c])
                .sum();
            position += 1.0 - passed / square;
        }
        position * self.mm_per_px
    }

    /// The middle of the dark line near `nominal_mm`.
    fn dark_line_mm(&self, nominal_mm: f64) -> f64 {
        let darkness = |along: u32| 255.0 - f64::from(self.pixel(along)[1]);
        let window = self.window(nominal_mm);
        let total: f64 = window.clone().map(darkness).sum();
        assert!(total > 150.0, "no line at {nominal_mm:.2} mm");
        window
            .map(|along| darkness(along) * (f64::from(along) + 0.5))
            .sum::<f64>()
            / total
            * self.mm_per_px
    }
}

fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    (0..3).map(|c| u32::from(a[c].abs_diff(b[c]))).sum()
}

/// The largest edge error on a page and how many edges were measured, along x or (`down`) along y.
fn worst_edge(printed: &Printed, plan: &SheetPlan, page: &RgbImage, down: bool) -> (f64, usize) {
    let c = plan.carried;
    let page_top = printed.layout.frame.page.height_mm;
    // From template to page, both y down, for this sheet.
    let (dx, dy) = (
        plan.printed.left_mm - c.left_mm,
        page_top - plan.printed.top_mm - c.top_mm,
    );
    let (along, across) = ((c.left_mm, c.right_mm, dx), (c.top_mm, c.bottom_mm, dy));
    let (along, across) = if down { (across, along) } else { (along, across) };
    let own = plan.own;
    let (own_along, own_across) = if down {
        (own.bottom_mm, own.right_mm)
    } else {
        (own.right_mm, own.bottom_mm)
    };
    // At the template's own edge there is bleed and no ghost line.
    let (whole_along, whole_across) = match (down, printed.size_mm) {
        (true, (width, height)) => (height, width),
        (false, (width, height)) => (width, height),
    };
    let in_ghost =
        |at: f64, own_end: f64, whole: f64| own_end < whole && at > own_end - 0.5 && at < own_end + GHOST_MM + 0.5;
    let (mut worst, mut measured) = (0.0f64, 0);
    for middle in printed
        .middles(across.0, across.1)
        .into_iter()
        .filter(|m| !in_ghost(*m, own_across, whole_across))
    {
        let scan = Scan::new(printed, page, down, middle + across.2);
        let edges = printed.edges(along.0, along.1);
        for (i, &edge) in edges.iter().enumerate() {
            let colour = |at: f64| match at {
                at if at < along.0 || at > along.1 => WHITE,
                at if down => printed.colour_at(middle, at),
                at => printed.colour_at(at, middle),
            };
            let (before, after) = (colour(edge - 0.01), colour(edge + 0.01));
            // A sliver of a cell at the border is narrower than the window of the measurement.
            let crowded = |other: Option<&f64>| other.is_some_and(|other| (other - edge).abs() < 0.6);
            let crowded = crowded(edges.get(i + 1)) || i > 0 && crowded(edges.get(i - 1));
            if crowded || in_ghost(edge, own_along, whole_along) || distance(before, after) < 60 {
                continue;
            }
            worst = worst.max((scan.edge_mm(edge + along.2, before, after) - edge - along.2).abs());
            measured += 1;
        }
    }
    (worst, measured)
}

pub fn assert_edges(printed: &Printed, least: usize) {
    for (plan, page) in printed.sheets() {
        for down in [false, true] {
            let (worst, measured) = worst_edge(printed, plan, page, down);
            println!(
                "{} {}: {measured} edges, worst {worst:.4} mm",
                plan.id(),
                if down { "y" } else { "x" }
            );
            assert!(
                worst <= printed.tolerance_mm,
                "sheet {}: an edge is {worst:.3} mm off",
                plan.id()
            );
            assert!(
                measured > least,
                "sheet {}: only {measured} edges were measured",
                plan.id()
            );
        }
    }
}

pub fn assert_rulers(printed: &Printed) {
    let page_top = printed.layout.frame.page.height_mm;
    let (h, v) = (
        printed.layout.frame.horizontal_ruler,
        printed.layout.frame.vertical_ruler,
    );
    for page in &printed.pages {
        let horizontal = Scan::new(printed, page, false, page_top - h[1] + 0.75);
        let vertical = Scan::new(printed, page, true, v[0] - 0.75);
        let mut worst = 0.0f64;
        for mm in (0..=100).map(f64::from) {
            let (x, y) = (h[0] + mm, page_top - v[1] - mm);
            worst = worst
                .max((horizontal.dark_line_mm(x) - x).abs())
                .max((vertical.dark_line_mm(y) - y).abs());
        }
        println!("rulers: worst {worst:.4} mm");
        assert!(worst <= printed.tolerance_mm, "a ruler tick is {worst:.3} mm off");
    }
}

pub fn assert_cell_centres(printed: &Printed) {
    for (plan, page) in printed.sheets() {
        for y in printed.middles(plan.own.top_mm, plan.own.bottom_mm) {
            for x in printed.middles(plan.own.left_mm, plan.own.right_mm) {
                let page_x = plan.trim.left_mm + x - plan.own.left_mm;
                let page_y = printed.layout.frame.page.height_mm - plan.trim.top_mm + y - plan.own.top_mm;
                let seen = Scan::new(printed, page, false, page_y).pixel((page_x / printed.mm_per_px()) as u32);
                assert_eq!(
                    seen,
                    printed.colour_at(x, y),
                    "sheet {} at template ({x:.1}, {y:.1})",
                    plan.id()
                );
            }
        }
    }
}

/// Cuts every page at its trim and lays the pieces edge to edge.
fn assembled(printed: &Printed) -> RgbImage {
    let px = |mm: f64| (mm / printed.mm_per_px()).round() as u32;
    let mut table = RgbImage::from_pixel(px(printed.size_mm.0), px(printed.size_mm.1), Rgb([1, 2, 3]));
    for (plan, page) in printed.sheets() {
        let (x, y) = (
            px(plan.trim.left_mm),
            px(printed.layout.frame.page.height_mm - plan.trim.top_mm),
        );
        let (width, height) = (
            px(plan.own.right_mm) - px(plan.own.left_mm),
            px(plan.own.bottom_mm) - px(plan.own.top_mm),
        );
        let piece = image::imageops::crop_imm(page, x, y, width, height).to_image();
        image::imageops::replace(
            &mut table,
            &piece,
            px(plan.own.left_mm).into(),
            px(plan.own.top_mm).into(),
        );
    }
    table
}

pub fn assert_pieces_make_the_whole(printed: &Printed) {
    let table = assembled(printed);
    let mm_per_px = printed.mm_per_px();
    let seams = |cuts: Vec<f64>| move |at: f64| cuts.iter().any(|cut| (at - cut).abs() <= SEAM_MM);
    let sheets = &printed.layout.sheets;
    let (x_seam, y_seam) = (
        seams(sheets.iter().map(|s| s.own.left_mm).collect()),
        seams(sheets.iter().map(|s| s.own.top_mm).collect()),
    );
    let near_edge = |at: f64| {
        let rest = at % printed.cell_mm;
        rest.min(printed.cell_mm - rest) <= SEAM_MM
    };
    let mut checked = 0;
    for y_px in (0..table.height()).step_by(5) {
        let y = (f64::from(y_px) + 0.5) * mm_per_px;
        for x_px in (0..table.width()).step_by(5) {
            let x = (f64::from(x_px) + 0.5) * mm_per_px;
            if near_edge(x) || near_edge(y) || x_seam(x) || y_seam(y) || x > printed.size_mm.0 || y > printed.size_mm.1
            {
                continue;
            }
            assert_eq!(
                table.get_pixel(x_px, y_px).0,
                printed.colour_at(x, y),
                "at ({x:.2}, {y:.2}) mm of the template"
            );
            checked += 1;
        }
    }
    assert!(checked > 500_000, "only {checked} points were compared");
}

/// The middles of the dark lines near some places along a scan of a page at `dpi`; places and answers from its left or top.
pub fn dark_lines_mm(page: &RgbImage, dpi: f64, down: bool, across_mm: f64, near_mm: &[f64]) -> Vec<f64> {
    let mm_per_px = 25.4 / dpi;
    let scan = Scan {
        page,
        mm_per_px,
        down,
        across_px: (across_mm / mm_per_px) as u32,
    };
    near_mm.iter().map(|mm| scan.dark_line_mm(*mm)).collect()
}
