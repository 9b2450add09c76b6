//! Patterns from any image: the mean light of cells against sums of our own, enlarged grids with the noise of JPEG, photos that are none; textures
//! without cells, measured on the rendered page; images that cannot be used.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, home, program, shared, stderr, stdout};
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use scaleproof_photo::Photo;
use scaleproof_print::template::{LayoutRequest, layout};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::enlarged::grid_of;

use crate::print_template::render::{pages, usual_request};

fn run(folder: &Path, command: &str) -> Output {
    program().current_dir(folder).args(command.split(' ')).output().unwrap()
}

fn done(folder: &Path, command: &str) -> Output {
    let output = run(folder, command);
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    output
}

fn noise(width: u32, height: u32, seed: u64) -> RgbImage {
    let mut image = RgbImage::new(width, height);
    Pcg64::seed_from_u64(seed).fill_bytes(&mut image);
    image
}

fn as_jpeg(image: &RgbImage, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(image)
        .unwrap();
    bytes
}

fn decoded(jpeg: &[u8]) -> RgbImage {
    image::load_from_memory(jpeg).unwrap().to_rgb8()
}

/// IEC 61966-2-1.
fn light(level: u8) -> f64 {
    let v = f64::from(level) / 255.0;
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

fn level(light: f64) -> f64 {
    255.0
        * if light <= 0.0031308 {
            12.92 * light
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
}

/// The mean of one of `cells` parts of each side: how much of a pixel is in it is counted in whole numbers of 1/cells of a pixel.
fn mean_of(image: &RgbImage, cells: [u32; 2], at: [u32; 2]) -> [f64; 3] {
    let sides = [image.width(), image.height()];
    let share = |axis: usize, pixel: u32| {
        let (from, to) = (at[axis] * sides[axis], (at[axis] + 1) * sides[axis]);
        let (first, last) = (pixel * cells[axis], (pixel + 1) * cells[axis]);
        f64::from(last.min(to).saturating_sub(first.max(from)))
    };
    let mut sum = [0.0; 3];
    for (x, y, pixel) in image.enumerate_pixels() {
        let weight = share(0, x) * share(1, y) / f64::from(sides[0] * sides[1]);
        (0..3).for_each(|c| sum[c] += weight * light(pixel.0[c]));
    }
    sum.map(level)
}

fn assert_close(found: [u8; 3], wanted: [f64; 3], most: f64, what: &str) {
    let off = (0..3)
        .map(|c| (f64::from(found[c]) - wanted[c]).abs())
        .fold(0.0, f64::max);
    assert!(off <= most, "{what}: {found:?}, not {wanted:?}");
}

#[test]
fn a_cell_is_the_mean_light_of_its_area() {
    let folder = tempfile::tempdir().unwrap();
    let image = noise(50, 31, 1);
    image.save(folder.path().join("image.png")).unwrap();
    let said = done(folder.path(), "pattern import image.png --cells 7x5 -o pattern.png");
    assert!(
        stdout(&said).contains("7×5 cells, each the mean light of 7.143 × 6.2 pixels"),
        "{}",
        stdout(&said)
    );
    let pattern = Pattern::load(&folder.path().join("pattern.png")).unwrap();
    for (column, row, cell) in pattern.cells().enumerate_pixels() {
        let wanted = mean_of(&image, [7, 5], [column, row]);
        assert_close(cell.0, wanted, 0.501, &format!("cell {column}, {row}"));
    }
    // Rows by the image's shape: 24 · 31 / 50 = 14.9.
    let json = done(folder.path(), "pattern import image.png --cells 24 -o other.png --json");
    let told: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!((&told["columns"], &told["rows"]), (&24.into(), &15.into()));
    assert_eq!(told["enlarged_grid"], serde_json::Value::Null);
    let other = Pattern::load(&folder.path().join("other.png")).unwrap();
    assert_eq!(
        (other.columns(), other.rows(), other.sha256()),
        (24, 15, told["pattern_sha256"].as_str().unwrap())
    );
    done(folder.path(), "pattern import image.png --cells 50x31 -o same.png");
    assert_eq!(*Pattern::load(&folder.path().join("same.png")).unwrap().cells(), image);
}

/// A finer grid than the true one meets the cells of a picture with a border about as well; most of its borders hold nothing.
#[test]
fn a_grid_with_a_border_around_it_is_no_grid() {
    let grid = resize(&noise(16, 16, 3), 16 * 23, 16 * 23, FilterType::Nearest);
    assert_eq!(grid_of(&grid), Some([16, 16]));
    for border in [5, 10, 17] {
        let side = 16 * 23 + 2 * border;
        let mut page = image::RgbImage::from_pixel(side, side, image::Rgb([255; 3]));
        image::imageops::replace(&mut page, &grid, i64::from(border), i64::from(border));
        assert_eq!(grid_of(&page), None, "a border of {border} px");
    }
}

#[test]
fn enlarged_grids_are_found_in_spite_of_jpeg() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (number, (cells, size)) in [
        ([16, 16], [512, 512]),
        ([16, 16], [500, 500]),
        ([9, 5], [333, 185]),
        ([40, 40], [250, 250]),
    ]
    .into_iter()
    .enumerate()
    {
        let grid = noise(cells[0], cells[1], number as u64);
        let large = resize(&grid, size[0], size[1], FilterType::Nearest);
        for quality in [95, 75, 50] {
            std::fs::write(at("large.jpg"), as_jpeg(&large, quality)).unwrap();
            let said = done(folder.path(), "pattern import large.jpg -o pattern.png");
            let words = format!("large.jpg is an enlarged grid of {}×{} cells", cells[0], cells[1]);
            assert!(stdout(&said).contains(&words), "{quality}: {}", stdout(&said));
            let found = Pattern::load(&at("pattern.png")).unwrap();
            let off = found
                .cells()
                .iter()
                .zip(grid.iter())
                .map(|(a, b)| a.abs_diff(*b))
                .max()
                .unwrap();
            // Chroma is coarse in small blocks of a JPEG.
            assert!(
                off <= if size[0] / cells[0] > 20 { 8 } else { 40 },
                "{cells:?}, quality {quality}: off by {off}"
            );
        }
    }
    // To the bit, also where blocks are small, or rows are equal.
    for (cells, factor) in [([16, 16], 2), ([7, 3], 3), ([12, 1], 10)] {
        let grid = noise(cells[0], cells[1], 7);
        let high = if cells[1] == 1 { 60 } else { cells[1] * factor };
        resize(&grid, cells[0] * factor, high, FilterType::Nearest)
            .save(at("large.png"))
            .unwrap();
        done(folder.path(), "pattern import large.png -o pattern.png");
        let found = Pattern::load(&at("pattern.png")).unwrap();
        assert_eq!(
            *found.cells(),
            resize(&grid, cells[0], high / factor, FilterType::Nearest),
            "{cells:?}"
        );
    }
    // Stripes in a JPEG: what tells nothing of rows has cells that are as high as wide.
    let stripes = resize(&noise(16, 1, 3), 512, 128, FilterType::Nearest);
    assert_eq!(grid_of(&decoded(&as_jpeg(&stripes, 75))), Some([16, 4]));
    let mixed = resize(&noise(16, 16, 1), 512, 512, FilterType::Nearest);
    mixed.save(at("mixed.png")).unwrap();
    let note = done(folder.path(), "pattern import mixed.png --cells 24 -o pattern.png");
    assert!(
        stderr(&note).contains("enlarged grid of 16×16 cells, which --cells mixes"),
        "{}",
        stderr(&note)
    );
}

#[test]
fn photos_and_noise_are_no_grids() {
    assert_no_grids((0..3).map(|i| home().join(format!("captures/skyline/normal_00{i}.jpg"))));
    assert_eq!(grid_of(&noise(300, 200, 5)), None);
    assert_eq!(grid_of(&decoded(&as_jpeg(&noise(300, 200, 5), 75))), None);
    assert_eq!(
        grid_of(&RgbImage::from_fn(256, 256, |x, y| Rgb([x as u8, y as u8, 9]))),
        None
    );
    assert_eq!(grid_of(&RgbImage::from_pixel(64, 64, Rgb([1, 2, 3]))), None);
    assert_eq!(grid_of(&noise(1, 1, 5)), None);
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn real_photos_of_cars_and_toys_are_no_grids() {
    for folder in ["photos/cars", "photos/toys"] {
        let files = std::fs::read_dir(shared(folder)).unwrap();
        assert_no_grids(files.map(|entry| entry.unwrap().path()));
    }
}

/// At least three photos (JPEG), whole, small and of low quality.
fn assert_no_grids(photos: impl Iterator<Item = PathBuf>) {
    let mut seen = 0;
    for path in photos.filter(|path| path.extension().is_some_and(|e| e == "jpg")) {
        let photo = Photo::open(&path).unwrap().rgb(1).unwrap();
        let small = image::imageops::thumbnail(&photo, 500, 370);
        // Saved again at low quality, it has the blocks of JPEG.
        for (what, image) in [
            ("whole", &photo),
            ("small", &small),
            ("saved again", &decoded(&as_jpeg(&small, 20))),
        ] {
            assert_eq!(grid_of(image), None, "{what}: {}", path.display());
            seen += 1;
        }
    }
    assert!(seen >= 9);
}

#[test]
fn what_is_no_pattern_leads_to_import() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    noise(600, 400, 1).save(at("noise.png")).unwrap();
    std::fs::write(at("photo.jpg"), as_jpeg(&noise(600, 400, 1), 75)).unwrap();
    let refused = |command: &str, words: &[&str]| {
        assert_refused(&run(folder.path(), command), words);
        assert!(!at("out.pdf").exists() && !at("out.png").exists());
    };
    refused(
        "pattern import photo.jpg -o out.png",
        &["photo.jpg is no enlarged grid", "--cells 24"],
    );
    let template = "print template --tile-mm 100 --size-mm 200x100 -o out.pdf";
    for name in ["noise.png", "photo.jpg"] {
        let words = format!("scaleproof pattern import {name} --cells 24");
        refused(&format!("{template} --pattern {name}"), &[&words]);
        refused(
            &format!("{template} --texture {name} --paints 3"),
            &["a texture has none", &words],
        );
    }
    let mut two_colours = noise(60, 45, 2);
    two_colours
        .pixels_mut()
        .for_each(|pixel| pixel.0 = [pixel.0[0] & 128; 3]);
    two_colours.save(at("cells.png")).unwrap();
    refused(
        &format!("{template} --pattern cells.png --paints 2"),
        &["too small", "pattern import --cells"],
    );
    refused(
        "print template --tile-mm 3 --size-mm 200x100 -o out.pdf --pattern cells.png",
        &["0.050 mm", "pattern import"],
    );
    resize(&noise(16, 16, 1), 128, 128, FilterType::Nearest)
        .save(at("large.png"))
        .unwrap();
    for command in [
        "pattern check large.png",
        &format!("{} --pattern large.png", template.replace("out", "fine")),
    ] {
        let said = stderr(&done(folder.path(), command));
        assert!(
            said.contains("note: large.png is an enlarged grid of 16×16 cells"),
            "{said}"
        );
    }
    // Said before anything is rendered.
    std::fs::write(at("box.obj"), "v 0 0 0\nv 300 0 0\nv 0 100 90\nf 1 2 3\n").unwrap();
    for command in [
        "attack render --pattern large.png",
        "attack evaluate --normal 808080 --pattern large=large.png",
    ] {
        let command = format!("{command} --mesh box.obj --tile-mm 100 --light none.exr -o rendered");
        let said = stderr(&run(folder.path(), &command));
        assert!(
            said.contains("note: large.png is an enlarged grid") && said.contains("none.exr"),
            "{said}"
        );
    }
    let cells = |text: &str| format!("pattern import noise.png --cells {text} -o out.png");
    refused(&cells("0"), &["0×1 cells"]);
    refused(&cells("601"), &["601×401 cells", "600×400 pixels"]);
    refused(&cells("-3"), &["'-3' is no number of cells"]);
    refused(&cells("4x"), &["'4x' is no number of cells"]);
    refused("pattern import noise.png --cells 3 -o noise.png", &["is an input"]);
    for (command, words) in [
        ("--texture noise.png --tile-mm 0.5", "1 mm or more"),
        ("--texture noise.png --tile-mm nan", "tile width"),
        ("--texture noise.png --tile-mm 100 --dpi 0", "dots per inch"),
        ("--texture noise.png", "--tile-mm"),
    ] {
        refused(
            &format!("print template --size-mm 200x100 -o out.pdf {command}"),
            &[words],
        );
    }
}

#[test]
fn images_that_cannot_be_used_are_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    image::ImageBuffer::<Rgb<u16>, _>::from_pixel(40, 40, Rgb([9; 3]))
        .save(at("deep.png"))
        .unwrap();
    std::fs::write(at("inks.jpg"), of_four_inks()).unwrap();
    RgbImage::new(20_000, 10).save(at("wide.png")).unwrap();
    let whole = as_jpeg(&noise(64, 64, 1), 75);
    std::fs::write(at("cut.jpg"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(at("text.png"), "no image").unwrap();
    for (name, words) in [
        ("deep.png", "16 bits a channel"),
        ("inks.jpg", "CMYK"),
        ("wide.png", "20000×10 pixels, more than 16384"),
        ("cut.jpg", "ends in the middle"),
        ("text.png", "neither PNG nor JPEG"),
        ("missing.png", "no such file"),
    ] {
        for command in [
            format!("pattern import {name} --cells 8 -o out.png"),
            format!("pattern import {name} -o out.png"),
            format!("print template --texture {name} --tile-mm 90 --size-mm 90x90 -o out.png"),
        ] {
            let command = command.replace("90x90 -o out.png", "90x90 -o out.pdf");
            assert_refused(&run(folder.path(), &command), &[name, words]);
        }
    }
    assert!(!at("out.png").exists() && !at("out.pdf").exists());
}

#[test]
fn see_through_pixels_are_laid_on_white_and_noted() {
    let folder = tempfile::tempdir().unwrap();
    let mut clear = image::RgbaImage::from_pixel(40, 40, image::Rgba([9, 9, 9, 255]));
    (0..20).for_each(|x| (0..20).for_each(|y| clear.put_pixel(x, y, image::Rgba([9, 9, 9, 0]))));
    clear.save(folder.path().join("clear.png")).unwrap();
    for command in [
        "pattern import clear.png --cells 2 -o cells.png",
        "print template --texture clear.png --tile-mm 90 --size-mm 90x90 -o t.pdf",
    ] {
        let said = stderr(&done(folder.path(), command));
        assert!(
            said.contains("note: clear.png is see-through in 25.0 % of its pixels, which are laid on white"),
            "{said}"
        );
    }
    let cells = image::open(folder.path().join("cells.png")).unwrap().to_rgb8();
    assert_eq!(
        [(0, 0), (1, 0), (1, 1)].map(|(x, y)| cells.get_pixel(x, y).0[0]),
        [255, 9, 9]
    );
}

/// A grey JPEG whose frame and scan name three more components: as far as the header goes, CMYK.
fn of_four_inks() -> Vec<u8> {
    let mut grey = Vec::new();
    JpegEncoder::new(&mut grey)
        .encode_image(&image::GrayImage::new(16, 16))
        .unwrap();
    let mut bytes = Vec::new();
    let mut at = 0;
    while at < grey.len() {
        let length = || usize::from(u16::from_be_bytes([grey[at + 2], grey[at + 3]]));
        match grey[at..] {
            [0xFF, 0xC0, ..] => {
                bytes.extend([0xFF, 0xC0, 0, 20]);
                bytes.extend(&grey[at + 4..at + 9]);
                bytes.push(4);
                (1..=4).for_each(|id| bytes.extend([id, 0x11, 0]));
                at += 2 + length();
            }
            [0xFF, 0xDA, ..] => {
                bytes.extend([0xFF, 0xDA, 0, 14, 4]);
                (1..=4).for_each(|id| bytes.extend([id, 0]));
                bytes.extend([0, 63, 0]);
                bytes.extend(&grey[at + 2 + length()..]);
                return bytes;
            }
            [0xFF, 0xD8, ..] => {
                bytes.extend([0xFF, 0xD8]);
                at += 2;
            }
            _ => {
                bytes.extend(&grey[at..at + 2 + length()]);
                at += 2 + length();
            }
        }
    }
    bytes
}

/// Every printed pixel of every repeat, at its centre on the page.
#[test]
fn a_texture_is_printed_at_true_size() {
    let folder = tempfile::tempdir().unwrap();
    let image = noise(150, 90, 4);
    image.save(folder.path().join("texture.png")).unwrap();
    // 150 pixels on 60 mm are 63.5 dpi; at 40 dpi they become 94 by 57.
    for (dpi, size) in [(300, [150_u32, 90]), (40, [94, 57])] {
        done(
            folder.path(),
            &format!(
                "print template --texture texture.png --tile-mm 60 --dpi {dpi} --size-mm 170x130 --overlap-mm 0 -o t.pdf"
            ),
        );
        let request = LayoutRequest {
            size_mm: (170.0, 130.0),
            overlap_mm: 0.0,
            ..usual_request()
        };
        let (plan, page) = (
            &layout(&request).unwrap().sheets[0],
            &pages(&folder.path().join("t.pdf"), 2, 600.0)[0],
        );
        let page_mm = f64::from(page.height()) * 25.4 / 600.0;
        let pixel_mm = [60.0 / f64::from(size[0]), 36.0 / f64::from(size[1])];
        let expected = RgbImage::from_fn(size[0], size[1], |x, y| {
            Rgb(match size {
                [150, 90] => image.get_pixel(x, y).0,
                _ => mean_of(&image, size, [x, y]).map(|level| level.round() as u8),
            })
        });
        let counts = [170.0 / pixel_mm[0], 130.0 / pixel_mm[1]].map(|count| count as u32);
        let mut seen = 0;
        for row in 0..counts[1] {
            for column in 0..counts[0] {
                let centre = [column, row].map(|index| f64::from(index) + 0.5);
                let x = (plan.trim.left_mm + centre[0] * pixel_mm[0]) / 25.4 * 600.0;
                let y = (page_mm - plan.trim.top_mm + centre[1] * pixel_mm[1]) / 25.4 * 600.0;
                let found = page.get_pixel(x as u32, y as u32).0;
                let wanted = expected.get_pixel(column % size[0], row % size[1]).0;
                assert_close(
                    found,
                    wanted.map(f64::from),
                    1.0,
                    &format!("{dpi} dpi, pixel {column}, {row}"),
                );
                seen += 1;
            }
        }
        assert!(seen > 60_000 || dpi == 40 && seen > 50_000, "{seen}");
    }
    let told = done(
        folder.path(),
        "print template --texture texture.png --tile-mm 60 --size-mm 170x130 -o t.svg --json",
    );
    let told: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(told["pixel_mm"], 0.4);
    let svg = std::fs::read_to_string(folder.path().join("t-A1.svg")).unwrap();
    assert_eq!(
        svg.matches("data:image/png").count(),
        1,
        "the image stands in the file once"
    );
    assert!(svg.matches("xlink:href=\"#image0\"").count() >= 12);
}

/// A plain texture shows any hairline between repeats, at a resolution that fits no pixel.
#[test]
fn there_are_no_seams_between_repeats_of_a_texture() {
    let folder = tempfile::tempdir().unwrap();
    RgbImage::from_pixel(70, 70, Rgb([0, 40, 80]))
        .save(folder.path().join("plain.png"))
        .unwrap();
    for tile_mm in ["2.9", "31.3"] {
        done(
            folder.path(),
            &format!("print template --texture plain.png --tile-mm {tile_mm} --size-mm 150x200 -o t.pdf"),
        );
        let page = &pages(&folder.path().join("t.pdf"), 2, 61.0)[0];
        let size_mm = (150.0, 200.0);
        let printed = layout(&LayoutRequest {
            size_mm,
            ..usual_request()
        })
        .unwrap()
        .sheets[0]
            .printed;
        let px = |mm: f64| (mm / 25.4 * 61.0) as u32;
        for y in px(297.0 - printed.top_mm) + 2..px(297.0 - printed.bottom_mm) - 1 {
            for x in px(printed.left_mm) + 2..px(printed.right_mm) - 1 {
                assert_close(
                    page.get_pixel(x, y).0,
                    [0.0, 40.0, 80.0],
                    1.0,
                    &format!("tile {tile_mm} mm, pixel ({x}, {y})"),
                );
            }
        }
    }
}
