//! Prints the stencils of wrapped models, renders the pages with poppler, sprays them in their order and holds the result against the tile at
//! points of the surface. Nothing here knows how the stencils were made.

use crate::common;
use crate::print_paint::raster::Stencil;
use crate::print_pieces::{at_border, house, placement, points, request, turns};
use crate::print_template::render;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use common::{assert_refused, shared};
use image::RgbImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use render::{done, pages, scaleproof, text_of};
use scaleproof_print::paper::Paper;
use scaleproof_print::pdf;
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::{Painted, Palette};
use scaleproof_surface::pattern::world_aligned::WorldAligned;
use scaleproof_surface::texture::Tile;
use scaleproof_wrap::pieces::painted::{PaintedPieces, PaintedRequest, flattened, painted_pieces};

const COLOURS: [[u8; 3]; 4] = [[200, 30, 30], [30, 160, 60], [40, 60, 200], [230, 220, 90]];
const FEATURE_MM: f64 = 1.5;
const DPI: f64 = 300.0;
/// Half a pixel, and how far a line on the outline reaches.
const BORDER_MM: f64 = 0.15;

fn palette_file(folder: &Path) -> PathBuf {
    let paint = |(i, rgb): (usize, &[u8; 3])| format!("[[paint]]\nname = \"tin {i}\"\nrgb = {rgb:?}\n");
    let text: String = COLOURS.iter().enumerate().map(paint).collect();
    let path = folder.join("tins.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// Cells of the four colours: of the first, twice as many as of the others.
fn pattern_file(cells: u32, folder: &Path) -> PathBuf {
    let mut random = Pcg32::seed_from_u64(5);
    let image = RgbImage::from_fn(cells, cells, |_, _| {
        image::Rgb(COLOURS[random.random_range(0..5_usize).saturating_sub(1)])
    });
    let path = folder.join("tile.png");
    image.save(&path).unwrap();
    path
}

/// A painted model on rendered pages.
struct Sprayed {
    made: PaintedPieces,
    pattern: Pattern,
    cell_mm: f64,
    mirror: bool,
    /// By paint (0: by number) and sheet, from 0.
    pages: BTreeMap<(usize, usize), RgbImage>,
}

impl Sprayed {
    fn new((mesh, paint): (&Mesh, &[usize]), tile_mm: f64, request: &PaintedRequest, folder: &Path) -> Self {
        let pattern = Pattern::load(&pattern_file(16, folder)).unwrap();
        let palette = Palette::load(&palette_file(folder)).unwrap();
        let painted = Painted::by_palette(&pattern, &palette).unwrap();
        let tile = Tile::new(pattern.clone(), tile_mm);
        let flat = flattened((mesh, paint), &tile, request, &mut |_| ()).unwrap();
        let made = painted_pieces(mesh, &flat, (&tile, &painted), request).unwrap();
        made.facts().iter().for_each(|fact| println!("{fact}"));
        let file = folder.join("painted.pdf");
        std::fs::write(&file, pdf::write("t", &made.pages).unwrap()).unwrap();
        let place = |name: &str| {
            let (kind, sheet) = name.split_once('-')?;
            let paint = kind
                .strip_prefix("paint")
                .map_or(0, |n| n.parse::<usize>().unwrap() - 1);
            Some((paint, sheet.parse::<usize>().unwrap() - 1))
        };
        let first = made.names.iter().position(|name| place(name).is_some()).unwrap();
        let rendered = pages(&file, first + 1, DPI);
        let places = made.names[first..].iter().filter_map(|name| place(name));
        Self {
            pages: places.zip(rendered).collect(),
            cell_mm: tile.cell_mm,
            mirror: request.mirror,
            pattern,
            made,
        }
    }

    /// The page's pixel of a place in a piece's plane. Stencils may be mirrored, the sheets to paint by number are not.
    fn pixel(&self, paint: usize, piece: usize, p: [f64; 2]) -> Option<(u32, u32)> {
        let [x, y] = self.made.places[piece].pose.at(p);
        let printable = self.made.frame.printable;
        let x = if self.mirror && paint > 0 {
            printable.left_mm + printable.right_mm - x
        } else {
            x
        };
        let page = self.pages.get(&(paint, self.made.places[piece].page))?;
        let px = |mm: f64| (mm / 25.4 * DPI) as u32;
        let at = (px(x), px(self.made.frame.page.height_mm - y));
        (at.0 < page.width() && at.1 < page.height()).then_some(at)
    }

    fn is_open(&self, paint: usize, piece: usize, p: [f64; 2]) -> bool {
        let at = self.pixel(paint, piece, p);
        at.is_some_and(|(x, y)| is_tinted(self.pages[&(paint, self.made.places[piece].page)].get_pixel(x, y).0))
    }

    /// Sprays all stencils in their order, and compares points of the surface with the tile.
    fn has_the_tiles_colours(&self, count: usize) {
        let laid = WorldAligned {
            pattern: &self.pattern,
            cell_mm: self.cell_mm,
        };
        let turns = turns(&self.made.pieces);
        let paints = &self.made.painted.paints;
        let (mut compared, mut right, mut base, mut not_base) = (0.0, 0.0, 0.0, 0.0);
        for point in points(&self.made.pieces, count) {
            let (at, normal) = point.in_space(&self.made.pieces);
            if at_border((at, normal), self.cell_mm, &turns, BORDER_MM) {
                continue;
            }
            compared += 1.0;
            let p = point.flat(&self.made.pieces);
            let truth = laid.colour(&at, &normal);
            let mut coat = paints[0].paint.rgb;
            for (paint, used) in paints.iter().enumerate().skip(1) {
                if self.is_open(paint, point.piece, p) {
                    coat = used.paint.rgb;
                }
            }
            not_base += f64::from(u8::from(truth != paints[0].paint.rgb));
            if coat == truth {
                right += 1.0;
            } else if coat == paints[0].paint.rgb {
                base += 1.0;
            }
        }
        let wrong = compared - right - base;
        println!(
            "{count} points, {} at borders; {right} right, {base} to be touched up, {wrong} wrong",
            count as f64 - compared
        );
        assert!(compared > 0.85 * count as f64, "{compared} of {count} are off borders");
        assert!(wrong <= 0.0005 * compared, "{wrong} of {compared} have a wrong paint");
        // What is under a bridge is stated; the lines of outlines hide some more.
        let stated: f64 = self.made.areas.iter().map(|a| a.bridges_mm2).sum();
        let stencilled: f64 = self.made.areas[1..].iter().map(|a| a.cells_mm2).sum();
        let (found, stated) = (base / not_base, stated / stencilled);
        println!("to touch up: {found:.4} of the points, {stated:.4} as stated");
        assert!((found - stated).abs() < 0.012, "{found} of the points, stated {stated}");
        assert!(found < 0.15, "{found} of the points are left to the brush");
    }

    /// The registration marks of a piece are at the same place, and look the same, on all of its stencils and by number.
    fn registers(&self) {
        for (i, material) in self.made.materials.iter().enumerate() {
            let page = self.made.places[i].page;
            assert!(
                material.holes.len() >= 3,
                "piece {} has {} holes",
                i + 1,
                material.holes.len()
            );
            let stencils: Vec<usize> = self
                .made
                .stencils
                .iter()
                .filter(|s| s.piece == i)
                .map(|s| s.paint)
                .collect();
            for hole in &material.holes {
                let seen = |paint: usize| {
                    let (x, y) = self.pixel(paint, i, *hole).unwrap();
                    let reach = (2.8 / 25.4 * DPI) as u32;
                    image::imageops::crop_imm(&self.pages[&(paint, page)], x - reach, y - reach, 2 * reach, 2 * reach)
                        .to_image()
                };
                for paint in &stencils {
                    let here = seen(*paint);
                    assert!(
                        here == seen(stencils[0]),
                        "piece {}: marks of paint {}",
                        i + 1,
                        paint + 1
                    );
                    let open = here.pixels().filter(|p| is_tinted(p.0)).count() as f64 * (25.4 / DPI).powi(2);
                    assert!(
                        (open - std::f64::consts::PI * 1.5f64.powi(2)).abs() < 0.5,
                        "a hole of {open} mm²"
                    );
                }
                if self.mirror {
                    continue;
                }
                // By number there is a cross with its middle there.
                let cross = seen(0);
                let dark = |x: u32, y: u32| (0..2).any(|d| cross.get_pixel(x + d, y + d).0[0] < 140);
                let middle = cross.width() / 2 - 1;
                let arm = |mm: f64| (mm / 25.4 * DPI) as u32;
                for (dx, dy) in [(arm(2.0), 0), (0, arm(2.0))] {
                    assert!(
                        dark(middle + dx, middle + dy) && dark(middle - dx, middle - dy),
                        "piece {}",
                        i + 1
                    );
                }
            }
        }
    }

    /// The material of each stencil is one sheet: what the flood reaches from outside is no material, and all else hangs together.
    fn holds_together(&self) {
        let mut random = Pcg32::seed_from_u64(2);
        for ((paint, sheet), page) in self.pages.iter().filter(|((paint, _), _)| *paint > 0) {
            let (width, height) = (page.width() as usize, page.height() as usize);
            let is = |of: fn([u8; 3]) -> bool| page.pixels().map(|p| of(p.0)).collect::<Vec<bool>>();
            let (open, dark) = (is(is_tinted), is(|rgb| rgb.iter().all(|v| *v < 150)));
            let outside = outside(&dark, &open, width);
            let image = |open: Vec<bool>| Stencil {
                width,
                height,
                open,
                mm_per_px: 25.4 / DPI,
            };
            let material: Vec<bool> = (0..outside.len()).map(|i| !outside[i] && !open[i]).collect();
            let labels = image(open).labelled(&material, false, &mut vec![0.0]);
            let mut sheets = Vec::new();
            let here = |s: &&scaleproof_wrap::pieces::painted::PieceStencil| {
                s.paint == *paint && self.made.places[s.piece].page == *sheet
            };
            for stencil in self.made.stencils.iter().filter(here) {
                let region = &self.made.pieces[stencil.piece].region;
                let (low, high) = region.bounds().unwrap();
                let mut found = BTreeMap::<usize, usize>::new();
                for _ in 0..20_000 {
                    let p = [0, 1].map(|axis| low[axis] + random.random::<f64>() * (high[axis] - low[axis]));
                    if region.contains(p) {
                        let (x, y) = self.pixel(*paint, stencil.piece, p).unwrap();
                        let at = y as usize * width + x as usize;
                        assert!(!outside[at], "piece {}: its sheet is not closed", stencil.piece + 1);
                        if material[at] {
                            *found.entry(labels[at]).or_default() += 1;
                        }
                    }
                }
                // Single pixels between a dash and an opening may stand alone.
                let all: usize = found.values().sum();
                let (label, most) = found.iter().max_by_key(|(_, n)| **n).unwrap();
                assert!(
                    all - most <= all / 500,
                    "piece {}, paint {}: the material is in parts {found:?}",
                    stencil.piece + 1,
                    paint + 1
                );
                assert!(!sheets.contains(label), "two stencils are one");
                sheets.push(*label);
            }
        }
    }
}

/// What can be reached from the page's corner without crossing a line or an opening.
fn outside(dark: &[bool], open: &[bool], width: usize) -> Vec<bool> {
    let mut outside = vec![false; dark.len()];
    let mut waiting = vec![0_usize];
    outside[0] = true;
    while let Some(i) = waiting.pop() {
        let column = i % width;
        let near = [
            (column > 0).then(|| i - 1),
            (column + 1 < width).then_some(i + 1),
            i.checked_sub(width),
            (i + width < dark.len()).then_some(i + width),
        ];
        for n in near.into_iter().flatten() {
            if !outside[n] && !dark[n] && !open[n] {
                outside[n] = true;
                waiting.push(n);
            }
        }
    }
    outside
}

/// The tint is the only thing on a stencil with more red than blue.
fn is_tinted(rgb: [u8; 3]) -> bool {
    rgb[0].saturating_sub(rgb[2]) > 57
}

fn painted_request(most_pieces: usize, paper: Paper, mirror: bool) -> PaintedRequest {
    PaintedRequest {
        pieces: request(most_pieces, paper),
        min_feature_mm: FEATURE_MM,
        mirror,
    }
}

#[test]
fn a_sprayed_house_has_the_tiles_colours() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = Mesh::load(&house(folder.path()), &MeshPlacement::default()).unwrap();
    for mirror in [false, true] {
        let sprayed = Sprayed::new(
            (&mesh, &[]),
            112.0,
            &painted_request(6, Paper::A3, mirror),
            folder.path(),
        );
        // The largest is the base coat.
        let areas: Vec<f64> = sprayed.made.areas.iter().map(|a| a.cells_mm2).collect();
        assert!(areas.windows(2).all(|pair| pair[0] >= pair[1]), "{areas:?}");
        let surface = 2.0 * 120.0 * 30.0 + 2.0 * 120.0 * 50.0 + 2.0 * (80.0 * 30.0 + 80.0 * 30.0 / 2.0);
        assert!(
            (areas.iter().sum::<f64>() - surface).abs() < 0.002 * surface,
            "{areas:?} of {surface} mm²"
        );
        assert!(sprayed.made.areas[0].openings_mm2 == 0.0 && sprayed.made.stencils.iter().all(|s| s.paint > 0));
        sprayed.has_the_tiles_colours(5_000);
        sprayed.registers();
        sprayed.holds_together();
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn a_sprayed_skyline_has_the_tiles_colours() {
    let glb = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let folder = tempfile::tempdir().unwrap();
    let mesh = Mesh::load(&glb, &placement(455.0)).unwrap();
    let paint = mesh.materials_named(&["Material.001".into()]).unwrap();
    let sprayed = Sprayed::new(
        (&mesh, &paint),
        160.0,
        &painted_request(24, Paper::A3, false),
        folder.path(),
    );
    assert!(sprayed.made.pieces.len() <= 24);
    sprayed.has_the_tiles_colours(10_000);
    sprayed.registers();
    sprayed.holds_together();
}

#[test]
fn what_the_program_says_of_paint_on_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (obj, png) = (house(folder.path()), pattern_file(16, folder.path()));
    let print = format!("print wrap --mesh {} --pattern {}", obj.display(), png.display());
    let palette = palette_file(folder.path()).display().to_string();
    let asked = format!("{print} --tile-mm 112 --palette {palette}");
    let said = scaleproof(&format!("{asked} -o {}", path("w.pdf")));
    let said = String::from_utf8(said.stdout).unwrap();
    println!("{said}");
    assert!(
        said.contains("4 paints") && said.contains("base coat") && said.contains("tin 0"),
        "{said}"
    );
    let first = text_of(Path::new(&path("w.pdf")), 1);
    assert!(
        first.contains("Order of spraying") && first.contains("base coat") && first.contains("tin 3"),
        "{first}"
    );
    let once = std::fs::read(path("w.pdf")).unwrap();
    let json = scaleproof(&format!("{asked} --json -o {}", path("w.pdf")));
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(
        once == std::fs::read(path("w.pdf")).unwrap(),
        "the same input gives the same bytes"
    );
    let sum = |key: &str| {
        json["paints"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| p[key].as_f64().unwrap())
            .sum::<f64>()
    };
    let base = json["paints"][0]["cells_mm2"].as_f64().unwrap();
    assert!((sum("openings_mm2") + sum("bridges_mm2") + base - sum("cells_mm2")).abs() < 0.01);
    // As SVG, every page is a file, and the outlines to cut are in their layer.
    done(&format!("{asked} -o {}", path("w.svg")));
    for page in ["paint", "legend1", "numbers-1"] {
        assert!(Path::new(&path(&format!("w-{page}.svg"))).exists(), "{page}");
    }
    let svg = std::fs::read_to_string(path("w-paint2-1.svg")).unwrap();
    let cut = svg.split("id=\"cut\"").nth(1).unwrap().split("</g>").next().unwrap();
    // Three outer edges, twelve holes, and the openings.
    assert!(cut.matches('M').count() > 15 + 20, "{}", cut.matches('M').count());
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    RgbImage::from_pixel(8, 8, image::Rgb([9, 9, 9]))
        .save(path("t.png"))
        .unwrap();
    let wall = "v 40 5 0\nv -40 5 0\nv -40 5 40\nv 40 5 40\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    std::fs::write(path("wall.obj"), wall).unwrap();
    let with_texture = format!(
        "print wrap --mesh {} --texture {} --paints 3",
        path("wall.obj"),
        path("t.png")
    );
    for (command, words) in [
        (with_texture, &["made of cells", "--pattern", "pattern import"][..]),
        (format!("{print} --tile-mm 112 --paints 1"), &["1 paint cannot be made"]),
        (format!("{print} --tile-mm 112 --paints 9"), &["4 colours", "2 to 4"]),
        (
            format!("{print} --tile-mm 40 --paints 3"),
            &["cells of 2.5 mm are too small", "--tile-mm 72"],
        ),
        (
            format!("{print} --tile-mm 112 --paints 3 --min-feature-mm 0"),
            &["minimum feature width cannot be 0"],
        ),
        (
            format!("{print} --tile-mm 112 --paints 3 --tabs"),
            &["--tabs", "--paints"],
        ),
        (
            format!("{print} --tile-mm 112 --paints 3 --dpi 200"),
            &["--dpi", "--paints"],
        ),
        (
            format!("{print} --tile-mm 112 --paints 3 --panels"),
            &["--panels", "--paints"],
        ),
        (format!("{print} --tile-mm 112 --mirror"), &["--paints"]),
        (format!("{asked} --paper 100x100"), &["too small"]),
        (
            format!("{print} --tile-mm 112 --palette {}", path("t.png")),
            &["cannot be used"],
        ),
    ] {
        assert_refused(&scaleproof(&format!("{command} -o {}", path("x.pdf"))), words);
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        before + 2,
        "nothing is written"
    );
}
