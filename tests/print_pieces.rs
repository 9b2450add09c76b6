//! Prints models in pieces, renders the pages with poppler, and holds what is on paper against the model: colours, lengths, letters, and
//! that nothing lies over anything.

use crate::common;
use crate::print_template::render;
use crate::print_wrap;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use common::{assert_refused, shared};
use image::RgbImage;
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use render::{done, pages, scaleproof, text_of, words};
use scaleproof_print::paper::Paper;
use scaleproof_print::pdf;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshPlacement};
use scaleproof_surface::pattern::colour::Lab;
use scaleproof_surface::pattern::world_aligned::{Side, WorldAligned};
use scaleproof_surface::pattern::{Pattern, light};
use scaleproof_surface::texture::{MappedImages, Texture, Tile};
use scaleproof_wrap::pieces::{Piece, PiecesRequest, PrintedPieces, flattened, pieces};
use scaleproof_wrap::unwrap::UnwrapRequest;

/// What the program takes when nothing is said.
pub fn request(most_pieces: usize, paper: Paper) -> PiecesRequest {
    PiecesRequest {
        unwrap: UnwrapRequest {
            most_pieces: Some(most_pieces),
            ..UnwrapRequest::default()
        },
        tabs_mm: None,
        sheets: print_wrap::request(paper),
    }
}

/// Pieces on rendered pages.
struct Read {
    made: PrintedPieces,
    pages: Vec<RgbImage>,
    dpi: f64,
}

/// A place of the paint: its piece and triangle there, and the shares of the triangle's corners.
#[derive(Clone, Copy)]
pub struct PaintPoint {
    pub piece: usize,
    pub triangle: usize,
    pub shares: [f64; 3],
}

impl PaintPoint {
    /// Where it is in its piece's plane.
    pub fn flat(&self, pieces: &[Piece]) -> [f64; 2] {
        let flat = pieces[self.piece].triangles[self.triangle].flat_mm;
        [0, 1].map(|axis| (0..3).map(|c| self.shares[c] * flat[c][axis]).sum::<f64>())
    }

    /// Where it is on the model, and the normal there.
    pub fn in_space(&self, pieces: &[Piece]) -> (Point3<f64>, Vector3<f64>) {
        let corners = &pieces[self.piece].corners[self.triangle];
        let [a, b, c] = corners;
        (a + self.shares[1] * (b - a) + self.shares[2] * (c - a), normal(corners))
    }
}

/// Points spread evenly over the surface.
pub fn points(pieces: &[Piece], count: usize) -> Vec<PaintPoint> {
    let mut random = Pcg32::seed_from_u64(11);
    let mut sums: Vec<(f64, usize, usize)> = Vec::new();
    for (p, piece) in pieces.iter().enumerate() {
        for (t, [a, b, c]) in piece.corners.iter().enumerate() {
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            sums.push((sums.last().map_or(0.0, |s| s.0) + area, p, t));
        }
    }
    let whole = sums.last().unwrap().0;
    let mut point = || {
        let at = random.random::<f64>() * whole;
        let (_, piece, triangle) = sums[sums.partition_point(|s| s.0 < at)];
        let (mut s, mut t) = (random.random::<f64>(), random.random::<f64>());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let shares = [1.0 - s - t, s, t];
        PaintPoint {
            piece,
            triangle,
            shares,
        }
    };
    (0..count).map(|_| point()).collect()
}

/// The edges at which the surface begins to look to another side, so that other cells begin.
pub fn turns(pieces: &[Piece]) -> Vec<[Point3<f64>; 2]> {
    let mut sides = BTreeMap::<_, (_, BTreeSet<Side>)>::new();
    for corners in pieces.iter().flat_map(|piece| &piece.corners) {
        for edge in edges(corners) {
            let (_, sides) = sides.entry(key(edge)).or_insert((edge, BTreeSet::new()));
            sides.insert(Side::facing(&normal(corners)));
        }
    }
    let turning = sides.into_values().filter(|(_, sides)| sides.len() > 1);
    turning.map(|(edge, _)| edge).collect()
}

/// Whether a place is within so many mm of a cell's border. A border is where the surface meets x, y or z = k · cell, a plane of which two
/// coordinates count, or turns. Thin triangles turn within little, so the edges of others count, too.
pub fn at_border(
    (at, normal): (Point3<f64>, Vector3<f64>),
    cell_mm: f64,
    turns: &[[Point3<f64>; 2]],
    within_mm: f64,
) -> bool {
    let steepest = [normal.x, normal.y, normal.z].map(f64::abs);
    let most = steepest.into_iter().fold(0.0, f64::max);
    let near = |axis: usize| {
        let rest = at[axis].rem_euclid(cell_mm);
        steepest[axis] < most && rest.min(cell_mm - rest) <= within_mm
    };
    let at_turn = |[a, b]: &[Point3<f64>; 2]| {
        let along = b - a;
        let share = (along.dot(&(at - a)) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (at - a - share * along).norm() <= within_mm
    };
    (0..3).any(near) || turns.iter().any(at_turn)
}

impl Read {
    fn new(made: PrintedPieces, folder: &Path, dpi: f64) -> (Self, PathBuf) {
        let file = folder.join("pieces.pdf");
        std::fs::write(&file, pdf::write("pieces", &made.pages).unwrap()).unwrap();
        let pages = pages(&file, 2, dpi);
        assert_eq!(pages.len(), made.sheets());
        (Self { made, pages, dpi }, file)
    }

    /// Where a point is on its page, in mm from the top-left corner.
    fn on_page(&self, point: &PaintPoint) -> [f64; 2] {
        let p = point.flat(&self.made.pieces);
        let [x, y] = self.made.places[point.piece].pose.at(p);
        [x, self.made.frame.page.height_mm - y]
    }

    fn pixel(&self, piece: usize, [x, y]: [f64; 2]) -> [u8; 3] {
        let px = |mm: f64| (mm / 25.4 * self.dpi) as u32;
        self.pages[self.made.places[piece].page].get_pixel(px(x), px(y)).0
    }

    /// Which share of 10,000 points has its world-aligned colour on paper, those within 0.1 mm of a cell's border excepted.
    fn share_as_tile(&self, pattern: &Pattern, cell_mm: f64) -> f64 {
        let laid = WorldAligned { pattern, cell_mm };
        let turns = turns(&self.made.pieces);
        let (mut right, mut compared) = (0.0, 0.0);
        for point in points(&self.made.pieces, 10_000) {
            let (at, normal) = point.in_space(&self.made.pieces);
            if at_border((at, normal), cell_mm, &turns, 0.1) {
                continue;
            }
            compared += 1.0;
            // A corner of the pixel may reach over the border.
            let [found, wanted] =
                [self.pixel(point.piece, self.on_page(&point)), laid.colour(&at, &normal)].map(Lab::from_rgb);
            right += f64::from(u8::from(found.delta_e(wanted) <= 2.0));
        }
        println!("{right} of {compared} points have their colour");
        assert!(compared > 8_000.0, "{compared}");
        right / compared
    }

    /// Every seam's letter stands twice on paper, beside its two pieces; no word touches a piece's colours or another word, and nothing
    /// leaves what the printer reaches.
    fn letters_stand_clear(&self, file: &Path, colourful: impl Fn([u8; 3]) -> bool) {
        let mut found = BTreeMap::<String, Vec<usize>>::new();
        for (i, page) in self.pages.iter().enumerate() {
            let words = words(file, i + 2);
            // Captions, rulers and the page's number are at the lower edge, left and right; letters may stand between them.
            let foot_mm = self.made.frame.page.height_mm - self.made.frame.usable.bottom_mm + 6.0;
            let between = 130.0..self.made.frame.page.width_mm - 40.0;
            let is_foot = |left: f64, bottom: f64| bottom >= foot_mm && !between.contains(&left);
            for (n, (word, [left, top, right, bottom])) in words.iter().enumerate() {
                let middle = 0.5 * (top + bottom);
                let half = 0.25 * (bottom - top);
                for (_, other) in &words[..n] {
                    let apart = *left >= other[2] || other[0] >= *right || *top >= other[3] || other[1] >= *bottom;
                    assert!(
                        apart || is_foot(*left, *bottom),
                        "page {}: {word} touches another word",
                        i + 2
                    );
                }
                if !is_foot(*left, *bottom) {
                    let px = |mm: f64| (mm / 25.4 * self.dpi) as u32;
                    for y in px(middle - half)..=px(middle + half) {
                        for x in px(*left)..=px(*right) {
                            let rgb = page.get_pixel(x, y).0;
                            assert!(!colourful(rgb), "page {}: {word} lies on a piece ({rgb:?})", i + 2);
                        }
                    }
                    if word.chars().all(|c| c.is_ascii_lowercase()) && word != "mm" {
                        found.entry(word.clone()).or_default().push(self.nearest(
                            i,
                            [0.5 * (left + right), middle],
                            word,
                        ));
                    }
                }
            }
            let edge = (4.9 / 25.4 * self.dpi) as u32;
            let (wide, high) = page.dimensions();
            for (x, y, pixel) in page.enumerate_pixels() {
                let inside = x >= edge && y >= edge && x + edge < wide && y + edge < high;
                assert!(
                    inside || pixel.0 == [255; 3],
                    "page {}: ink in the margin at {x}, {y}",
                    i + 2
                );
            }
        }
        for seam in &self.made.seams {
            let mut on = found.remove(&seam.letter).unwrap_or_default();
            on.sort_unstable();
            let mut pieces = seam.pieces().to_vec();
            pieces.sort_unstable();
            assert_eq!(on, pieces, "seam {}, {} mm", seam.letter, seam.length_mm);
        }
        assert!(found.is_empty(), "letters without a seam: {found:?}");
    }

    /// The piece on a page whose border is nearest to a place, of those that have a seam of this letter.
    fn nearest(&self, page: usize, [x, y]: [f64; 2], letter: &str) -> usize {
        let seam = self.made.seams.iter().find(|seam| seam.letter == letter).unwrap();
        let height = self.made.frame.page.height_mm;
        let here = seam.pieces().into_iter().filter(|i| self.made.places[*i].page == page);
        let away = |i: &usize| {
            let place = self.made.places[*i].pose;
            self.made.pieces[*i]
                .region
                .moved(|p| place.at(p))
                .distance_mm([x, height - y])
        };
        let found = here.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
        assert!(
            away(&found) < 26.0,
            "{letter} stands {} mm from its piece",
            away(&found)
        );
        found
    }

    /// No two pieces come nearer to each other than their bleeds.
    fn pieces_lie_apart(&self) {
        let lying: Vec<_> = self.made.pieces.iter().zip(&self.made.places).collect();
        let grown: Vec<_> = lying
            .iter()
            .map(|(p, at)| p.region.moved(|q| at.pose.at(q)).grown(2.0))
            .collect();
        for (i, (_, at)) in lying.iter().enumerate() {
            for (j, (_, other)) in lying.iter().enumerate().take(i) {
                let shared = if at.page == other.page {
                    grown[i].and(&grown[j]).area_mm2()
                } else {
                    0.0
                };
                assert!(shared < 1e-3, "pieces {} and {} share {shared} mm²", i + 1, j + 1);
            }
        }
    }
}

fn edges([a, b, c]: &[Point3<f64>; 3]) -> [[Point3<f64>; 2]; 3] {
    [[*a, *b], [*b, *c], [*c, *a]]
}

/// An edge by its places in nanometres, whichever way it runs.
fn key(edge: [Point3<f64>; 2]) -> [[i64; 3]; 2] {
    let mut ends = edge.map(|p| [p.x, p.y, p.z].map(|mm| (mm * 1e6).round() as i64));
    ends.sort_unstable();
    ends
}

fn normal([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// Saturated cells, so that ink is told from letters.
fn bright(size: u32) -> Pattern {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Pcg32::seed_from_u64(3);
    let image = RgbImage::from_fn(size, size, |_, _| {
        let low = random.random_range(0..60);
        let mut rgb = [low, random.random_range(60..200), 255 - low];
        rgb.rotate_left(random.random_range(0..3));
        image::Rgb(rgb)
    });
    let path = folder.path().join("bright.png");
    image.save(&path).unwrap();
    Pattern::load(&path).unwrap()
}

fn is_bright(rgb: [u8; 3]) -> bool {
    rgb.iter().max().unwrap() - rgb.iter().min().unwrap() > 80
}

pub fn placement(length_mm: f64) -> MeshPlacement {
    MeshPlacement {
        length_mm: Some(length_mm),
        ..MeshPlacement::default()
    }
}

/// The acceptance lines that every model meets.
fn is_as_asked(read: &Read, file: &Path, most_pieces: usize, most_pages: usize) {
    let made = &read.made;
    made.facts().iter().for_each(|fact| println!("{fact}"));
    println!("{} pages", made.pages.len());
    assert!(made.pieces.len() <= most_pieces && made.pages.len() <= most_pages);
    assert!(made.visible_share() >= 0.97 && made.flat.mean_stretch <= 1.03 && made.flat.stretch_99 <= 1.2);
    assert_eq!(made.unlettered_mm, 0.0);
    read.letters_stand_clear(file, is_bright);
    read.pieces_lie_apart();
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_skyline_in_pieces_has_its_colours() {
    let glb = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let folder = tempfile::tempdir().unwrap();
    let mesh = Mesh::load(&glb, &placement(455.0)).unwrap();
    let paint = mesh.materials_named(&["Material.001".into()]).unwrap();
    let request = request(24, Paper::A3);
    let flat = flattened((&mesh, &paint), &request, &mut |_| ()).unwrap();
    let pattern = bright(16);
    let tile = Texture::Tile(Tile::new(pattern.clone(), 118.0));
    let made = pieces(&mesh, &flat, &tile, &request).unwrap();
    let (read, file) = Read::new(made, folder.path(), 600.0);
    // Panels and strips took 12.
    is_as_asked(&read, &file, 24, 8);
    let share = read.share_as_tile(&pattern, 118.0 / 16.0);
    assert!(share >= 0.999, "{share}");
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_published_camouflage_is_on_the_pieces_of_its_car() {
    let obj = shared("meshes/rauca_etron/model_save.obj");
    let folder = tempfile::tempdir().unwrap();
    let mesh = Mesh::load(&obj, &placement(490.0)).unwrap();
    let faces = FaceList::load(&shared("meshes/rauca_etron/exterior_face.txt"), &mesh).unwrap();
    let (mesh, paint) = mesh.with_paint(&faces);
    let request = request(36, Paper::A3);
    let flat = flattened((&mesh, &paint), &request, &mut |_| ()).unwrap();
    let pattern = bright(16);
    let tile = Texture::Tile(Tile::new(pattern.clone(), 118.0));
    let made = pieces(&mesh, &flat, &tile, &request).unwrap();
    let (read, file) = Read::new(made, folder.path(), 600.0);
    // Panels and strips took 15.
    is_as_asked(&read, &file, 36, 10);
    let share = read.share_as_tile(&pattern, 118.0 / 16.0);
    assert!(share >= 0.999, "{share}");
    let atlas = Texture::Images(MappedImages::from_mesh(&mesh, &paint).unwrap().images);
    let made = pieces(&mesh, &flat, &atlas, &request).unwrap();
    let (read, _) = Read::new(made, folder.path(), 300.0);
    let atlas = image::open(shared("meshes/rauca_etron/model_save.png"))
        .unwrap()
        .to_rgb8();
    let share = share_as_atlas(&read, &Coordinates::read(&obj), &atlas);
    assert!(share >= 0.99, "{share}");
}

/// The texture coordinates of an OBJ's triangles, read here a second time.
struct Coordinates(Vec<[[f64; 2]; 3]>);

impl Coordinates {
    fn read(obj: &Path) -> Self {
        let text = std::fs::read_to_string(obj).unwrap();
        let places: Vec<[f64; 2]> = text
            .lines()
            .filter_map(|l| l.strip_prefix("vt "))
            .map(|l| {
                let numbers: Vec<f64> = l.split_whitespace().map(|n| n.parse().unwrap()).collect();
                [numbers[0], numbers[1]]
            })
            .collect();
        let faces = text.lines().filter_map(|l| l.strip_prefix("f ")).map(|l| {
            let corner = |c: &str| places[c.split('/').nth(1).unwrap().parse::<usize>().unwrap() - 1];
            let corners: Vec<_> = l.split_whitespace().map(corner).collect();
            [corners[0], corners[1], corners[2]]
        });
        Self(faces.collect())
    }
}

/// Which share of 10,000 points has the atlas' colour: the mean, as light adds, of a grid of places in the pixel of the point, as far as the paint
/// reaches.
fn share_as_atlas(read: &Read, coordinates: &Coordinates, atlas: &RgbImage) -> f64 {
    const SIDE: u32 = 40;
    let pixel_mm = 25.4 / read.dpi;
    let height = read.made.frame.page.height_mm;
    let cross = |o: [f64; 2], s: [f64; 2], t: [f64; 2]| (s[0] - o[0]) * (t[1] - o[1]) - (s[1] - o[1]) * (t[0] - o[0]);
    // Triangles of each piece on its page, from the top.
    let on_page = |piece: usize| {
        let pose = read.made.places[piece].pose;
        let flat = read.made.pieces[piece].triangles.iter();
        flat.map(move |triangle| {
            triangle.flat_mm.map(|p| {
                let [x, y] = pose.at(p);
                [x, height - y]
            })
        })
        .collect::<Vec<_>>()
    };
    let placed: Vec<_> = (0..read.made.pieces.len()).map(on_page).collect();
    let mut good = [0.0; 2];
    let mut compared = [0.0; 2];
    for point in points(&read.made.pieces, 10_000) {
        let low = read.on_page(&point).map(|mm| (mm / pixel_mm).floor() * pixel_mm);
        let near: Vec<usize> = (0..placed[point.piece].len())
            .filter(|i| {
                (0..2).all(|axis| {
                    let values = placed[point.piece][*i].map(|p| p[axis]);
                    let beyond = values.iter().all(|v| *v > low[axis] + pixel_mm);
                    !beyond && values.iter().any(|v| *v >= low[axis])
                })
            })
            .collect();
        let texel = |p: [f64; 2]| {
            near.iter().find_map(|i| {
                let [a, b, c] = placed[point.piece][*i];
                let shares = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|part| part / cross(a, b, c));
                let triangle = &read.made.pieces[point.piece].triangles[*i];
                let uv = coordinates.0[triangle.triangle];
                // The corners of what may be a part of the mesh's triangle, in that triangle.
                let weight = |k: usize| (0..3).map(|i| shares[i] * triangle.weights[i][k]).sum::<f64>();
                let [u, v] = [0, 1].map(|axis| (0..3).map(|k| weight(k) * uv[k][axis]).sum::<f64>());
                let at = |share: f64, count: u32| (share * f64::from(count)).floor().clamp(0.0, f64::from(count - 1));
                let inside = shares.iter().all(|s| *s >= 0.0);
                inside.then(|| [at(u, atlas.width()) as u32, at(1.0 - v, atlas.height()) as u32])
            })
        };
        let part = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) * pixel_mm;
        let places = (0..SIDE * SIDE).map(|i| [low[0] + part(i % SIDE), low[1] + part(i / SIDE)]);
        let texels: Vec<[u32; 2]> = places.filter_map(texel).collect();
        let mut linear = [0.0; 3];
        for [x, y] in &texels {
            let light = light::linear_of(atlas.get_pixel(*x, *y).0);
            (0..3).for_each(|k| linear[k] += light[k] / texels.len() as f64);
        }
        let found = read.pixel(point.piece, read.on_page(&point));
        let off = Lab::from_rgb(found).delta_e(Lab::from_rgb(light::rgb_of(linear)));
        let mixed = usize::from(texels.iter().any(|t| *t != texels[0]));
        good[mixed] += f64::from(u8::from(off <= 2.0));
        compared[mixed] += 1.0;
    }
    println!("of pixels with one texel and with several, {good:?} of {compared:?} have the atlas' colour");
    (good[0] + good[1]) / 10_000.0
}

/// A roof of two slopes on walls, as OBJ: nothing of it is curved.
pub fn house(folder: &Path) -> PathBuf {
    let text = "v -60 -40 0\nv 60 -40 0\nv 60 40 0\nv -60 40 0\nv -60 -40 30\nv 60 -40 30\nv 60 40 30\nv -60 40 30\n\
                v -60 0 60\nv 60 0 60\nusemtl paint\nf 1 2 6 5\nf 3 4 8 7\nf 5 6 10 9\nf 7 8 9 10\nf 2 3 7 10 6\nf 4 1 5 9 8\n";
    let path = folder.join("house.obj");
    std::fs::write(&path, text).unwrap();
    path
}

fn saved(pattern: &Pattern, folder: &Path) -> PathBuf {
    let path = folder.join("p.png");
    std::fs::write(&path, pattern.to_png().unwrap()).unwrap();
    path
}

/// A tilted rectangle of 120 × 47 mm is as large on paper, with 2 mm of bleed all around, whichever way it was turned.
#[test]
fn a_piece_has_its_true_size_on_paper() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let up = 47.0 / 2f64.sqrt();
    let text = format!(
        "v 0 0 5\nv 120 0 5\nv 120 {up} {0}\nv 0 {up} {0}\nf 1 2 3 4\n",
        up + 5.0
    );
    std::fs::write(path("tilted.obj"), text).unwrap();
    RgbImage::from_pixel(1, 1, image::Rgb([230, 0, 120]))
        .save(path("p.png"))
        .unwrap();
    let print = format!(
        "print wrap --mesh {} --pattern {} --tile-mm 50",
        path("tilted.obj"),
        path("p.png")
    );
    done(&format!("{print} -o {}", path("w.pdf")));
    let page = &pages(Path::new(&path("w.pdf")), 2, 600.0)[0];
    let ink: Vec<_> = page.enumerate_pixels().filter(|(.., p)| is_bright(p.0)).collect();
    let extent = |of: fn(&(u32, u32, &image::Rgb<u8>)) -> u32| {
        let (low, high) = (ink.iter().map(of).min().unwrap(), ink.iter().map(of).max().unwrap());
        f64::from(high + 1 - low) * 25.4 / 600.0
    };
    let (wide, high) = (extent(|p| p.0), extent(|p| p.1));
    println!("{wide:.2} × {high:.2} mm");
    assert!(
        (wide.max(high) - 124.0).abs() < 0.15 && (wide.min(high) - 51.0).abs() < 0.15,
        "{wide} × {high}"
    );
    // As SVG, the cutter's path is the rectangle itself.
    done(&format!("{print} -o {}", path("w.svg")));
    let svg = std::fs::read_to_string(path("w-sheet-1.svg")).unwrap();
    let cut = svg.split("id=\"cut\"").nth(1).unwrap();
    let numbers = cut.split("d=\"M").nth(1).unwrap().split('Z').next().unwrap();
    let numbers: Vec<f64> = numbers.split(['L', ' ']).map(|n| n.parse().unwrap()).collect();
    let corners: Vec<[f64; 2]> = numbers.chunks(2).map(|p| [p[0], p[1]]).collect();
    let next = corners.iter().cycle().skip(1);
    let around: f64 = corners
        .iter()
        .zip(next)
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .sum();
    assert!((around - 2.0 * (120.0 + 47.0)).abs() < 0.02, "{around}");
}

#[test]
fn a_house_is_cut_lettered_and_tabbed() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = Mesh::load(&house(folder.path()), &MeshPlacement::default()).unwrap();
    let pattern = bright(7);
    let texture = Texture::Tile(Tile::new(pattern.clone(), 35.0));
    for tabs_mm in [None, Some(6.0)] {
        let request = PiecesRequest {
            tabs_mm,
            ..request(6, Paper::A4)
        };
        let flat = flattened((&mesh, &[]), &request, &mut |_| ()).unwrap();
        let made = pieces(&mesh, &flat, &texture, &request).unwrap();
        made.facts().iter().for_each(|fact| println!("{fact}"));
        let surface = 2.0 * 120.0 * 30.0 + 2.0 * 120.0 * 50.0 + 2.0 * (80.0 * 30.0 + 80.0 * 30.0 / 2.0);
        assert!((made.flat.surface_mm2() - surface).abs() < 0.1 && (made.flat.largest_stretch - 1.0).abs() < 1e-3);
        let extra: f64 = made
            .cut
            .iter()
            .zip(&made.pieces)
            .map(|(c, p)| c.area_mm2() - p.region.area_mm2())
            .sum();
        let seams: f64 = made.seams.iter().map(|seam| seam.length_mm).sum();
        match tabs_mm {
            None => assert!(extra.abs() < 1e-6),
            Some(mm) => assert!(
                extra > 0.5 * seams * mm && extra < seams * mm,
                "{extra} mm² along {seams} mm"
            ),
        }
        let (read, file) = Read::new(made, folder.path(), 600.0);
        read.letters_stand_clear(&file, is_bright);
        read.pieces_lie_apart();
        // The dashes of folds are ink, too.
        let share = read.share_as_tile(&pattern, 5.0);
        assert!(share >= 0.999, "{share}");
    }
}

#[test]
fn what_the_program_says_of_pieces() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let png = saved(&Pattern::random(4, 1).unwrap(), folder.path())
        .display()
        .to_string();
    let obj = house(folder.path()).display().to_string();
    let print = format!(
        "print wrap --mesh {obj} --pattern {png} --tile-mm 40 -o {}",
        path("w.pdf")
    );
    let json = scaleproof(&format!("{print} --json --tabs"));
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let listed = json["pieces"].as_array().unwrap();
    let area: f64 = listed.iter().map(|piece| piece["surface_mm2"].as_f64().unwrap()).sum();
    assert!((area - json["surface_mm2"].as_f64().unwrap()).abs() < 1e-6);
    let said = scaleproof(&print);
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains(&format!("{} pieces on 1 sheet", listed.len())) && said.contains("largest 1.00"),
        "{said}"
    );
    // The first page has the same facts.
    let first = text_of(Path::new(&path("w.pdf")), 1);
    let first = first.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        first.contains("Matching letters mark edges to be joined")
            && first.contains("grey is the back of a piece")
            && first.contains("100.0 % of what can be seen"),
        "{first}"
    );
    let once = std::fs::read(path("w.pdf")).unwrap();
    done(&print);
    assert!(
        once == std::fs::read(path("w.pdf")).unwrap(),
        "the same input gives the same bytes"
    );
    for (more, words) in [
        ("--tabs 2", &["a glue tab cannot be 2 mm", "4 to 15 mm"][..]),
        ("--tabs nan", &["a glue tab cannot be NaN"]),
        ("--dpi 0", &["0 dpi", "as in 300"]),
        ("--dpi nan", &["NaN dpi"]),
        ("--max-stretch 0.9", &["a stretch of 0.9", "--max-stretch"]),
        ("--mean-stretch nan", &["--mean-stretch"]),
        ("--overlap-mm 5", &["--panels"]),
        ("--panels --tabs", &["--panels", "--tabs"]),
        ("--paper 90x90", &["too small"]),
        ("--margin-mm -1", &["margin cannot be -1"]),
        ("--scale 0", &["scale cannot be 0"]),
    ] {
        assert_refused(&scaleproof(&format!("{print} {more}")), words);
    }
}

/// An image on texture coordinates, printed as panels: each point has the colour of its texel.
#[test]
fn panels_take_a_texture() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    // A wall of 80 × 40 mm on the left side; the image's left half is red, its right half blue.
    let text = "v 40 5 0\nv -40 5 0\nv -40 5 40\nv 40 5 40\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    std::fs::write(path("wall.obj"), text).unwrap();
    let image = RgbImage::from_fn(10, 10, |x, _| {
        image::Rgb(if x < 5 { [220, 10, 10] } else { [10, 10, 220] })
    });
    image.save(path("t.png")).unwrap();
    done(&format!(
        "print wrap --panels --mesh {} --texture {} -o {}",
        path("wall.obj"),
        path("t.png"),
        path("w.pdf")
    ));
    let page = &pages(Path::new(&path("w.pdf")), 2, 600.0)[0];
    let columns = |of: fn([u8; 3]) -> bool| {
        let at: Vec<u32> = page
            .enumerate_pixels()
            .filter(|(.., p)| of(p.0))
            .map(|(x, ..)| x)
            .collect();
        [*at.iter().min().unwrap(), at.iter().max().unwrap() + 1].map(|px| f64::from(px) * 25.4 / 600.0)
    };
    let (red, blue) = (
        columns(|c| c[0] > 150 && c[2] < 60),
        columns(|c| c[2] > 150 && c[0] < 60),
    );
    println!("red {red:?}, blue {blue:?}");
    assert!(
        (blue[1] - red[0] - 84.0).abs() < 0.15,
        "80 mm and the bleed of 2 mm on both sides"
    );
    assert!((blue[0] - red[1]).abs() < 0.15 && (red[1] - red[0] - 42.0).abs() < 0.15);
}

/// A binary STL of a box whose faces are cut into `cuts` × `cuts` × 2 triangles each.
fn finely_cut_box(size_mm: [f32; 3], cuts: usize) -> Vec<u8> {
    let mut bytes = vec![b'.'; 80];
    bytes.extend((12 * cuts as u32 * cuts as u32).to_le_bytes());
    let mut triangle = |corners: [[f32; 3]; 3]| {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flatten().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0; 2]);
    };
    for (axis, end) in (0..3).flat_map(|axis| [(axis, 0.0), (axis, 1.0)]) {
        let place = |i: usize, j: usize| {
            let mut at = [end; 3];
            [at[(axis + 1) % 3], at[(axis + 2) % 3]] = [i, j].map(|n| n as f32 / cuts as f32);
            std::array::from_fn(|k| at[k] * size_mm[k])
        };
        for (i, j) in (0..cuts).flat_map(|i| (0..cuts).map(move |j| (i, j))) {
            let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
            // Counter-clockwise seen from outside.
            let halves = if end > 0.0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, c, b], [a, d, c]]
            };
            halves.into_iter().for_each(&mut triangle);
        }
    }
    bytes
}

#[test]
fn a_scan_is_simplified_and_keeps_its_surface() {
    let folder = tempfile::tempdir().unwrap();
    let [mesh, pattern, pdf] = ["scan.stl", "p.png", "scan.pdf"].map(|name| folder.path().join(name));
    std::fs::write(&mesh, finely_cut_box([240.0, 100.0, 60.0], 53)).unwrap();
    std::fs::write(&pattern, Pattern::random(4, 1).unwrap().to_png().unwrap()).unwrap();
    let [mesh, pattern, pdf] = [&mesh, &pattern, &pdf].map(|path| path.display());
    let output = scaleproof(&format!(
        "print wrap --mesh {mesh} --mesh-front +x --mesh-up +z --length-mm 240 --pattern {pattern} --tile-mm 40 --json -o {pdf}"
    ));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("33708 triangles of the mesh were simplified to 12000,"),
        "{said}"
    );
    // All but the floor, which cannot be seen: 240 × 100 + 2 × 60 × (240 + 100) mm².
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let surface = answer["surface_mm2"].as_f64().unwrap();
    assert!((surface / 64_800.0 - 1.0).abs() < 1e-3, "{surface} mm²");
}
