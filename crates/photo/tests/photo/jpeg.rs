//! JPEGs of every kind against the pixels that libjpeg-turbo makes of them (`tests/data/make_jpegs.py`), and damage of every kind.

use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageFormat, RgbImage, imageops};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use scaleproof_photo::{Budget, Photo};

use crate::common::{home, oriented, skyline};

fn folder() -> PathBuf {
    home().join("tests/data/jpeg")
}

/// The names of the stored files.
fn names() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).unwrap();
    let files = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let names = files.filter_map(|file| Some(file.strip_suffix(".jpg")?.to_owned()));
    let names: Vec<String> = names.filter(|name| name != "inks").collect();
    assert!(names.len() > 15, "{names:?}");
    names
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(format!("{name}.jpg"))).unwrap()
}

fn photo(bytes: Vec<u8>) -> Photo {
    Photo::from_bytes(Path::new("photo.jpg"), bytes, Budget::FILE).unwrap()
}

/// The worst and the mean difference.
fn differences(a: &[u8], b: &[u8]) -> (u8, f64) {
    assert_eq!(a.len(), b.len());
    let all = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    (all().max().unwrap(), all().map(f64::from).sum::<f64>() / a.len() as f64)
}

#[test]
fn pixels_are_those_of_libjpeg() {
    for name in names() {
        let read = photo(bytes(&name));
        let truth = |ending: &str| image::open(folder().join(format!("{name}{ending}"))).unwrap();
        let (worst, mean) = differences(&read.luma().unwrap(), &truth(".luma.png").into_luma8());
        assert!(worst <= 1 && mean < 0.1, "luma of {name}: {worst} {mean}");
        let (worst, mean) = differences(&read.rgb(1).unwrap(), &truth(".png").into_rgb8());
        // A step of luma, and one of a difference of colour, which counts 1.772 times.
        assert!(worst <= 3 && mean < 0.15, "colours of {name}: {worst} {mean}");
    }
}

/// Both in the same colours: what is reduced has the mean of what it stands for, and nearly each of its pixels in a picture without sharp
/// edges.
#[test]
fn reduced_pictures_have_the_means_of_the_whole() {
    let smooth = RgbImage::from_fn(160, 128, |x, y| {
        let wave = |a: u32, b: u32| (127.0 + 100.0 * (a as f64 / 26.0 + b as f64 / 37.0).sin()) as u8;
        image::Rgb([wave(x, y), wave(y, x), wave(x + 2 * y, 9)])
    });
    let mut encoded = std::io::Cursor::new(Vec::new());
    DynamicImage::from(smooth)
        .write_to(&mut encoded, ImageFormat::Jpeg)
        .unwrap();
    let read = photo(encoded.into_inner());
    let whole = read.rgb(1).unwrap();
    for reduction in [2, 4, 8] {
        let small = read.rgb(reduction).unwrap();
        assert_eq!(small.dimensions(), (160 / reduction, 128 / reduction));
        let means = RgbImage::from_fn(small.width(), small.height(), |x, y| {
            let square = imageops::crop_imm(&whole, x * reduction, y * reduction, reduction, reduction).to_image();
            let mean = |c: usize| {
                let sum: u32 = square.pixels().map(|pixel| u32::from(pixel.0[c])).sum();
                ((sum + reduction * reduction / 2) / (reduction * reduction)) as u8
            };
            image::Rgb([0, 1, 2].map(mean))
        });
        let (worst, mean) = differences(&small, &means);
        assert!(worst <= 6 && mean < 1.0, "1/{reduction}: {worst} {mean}");
    }
    // And over a whole picture with edges and noise.
    let read = photo(bytes("best"));
    let mean = |reduction| {
        let picture = read.rgb(reduction).unwrap();
        picture.iter().map(|v| f64::from(*v)).sum::<f64>() / picture.len() as f64
    };
    for reduction in [2, 4, 8] {
        let off = mean(reduction) - mean(1);
        assert!(off.abs() < 1.0, "1/{reduction}: {off}");
    }
}

#[test]
fn every_orientation_stands_upright() {
    for name in ["420_odd", "444_progressive", "grey"] {
        let stored = bytes(name);
        let upright = photo(stored.clone());
        for tag in 1..=8 {
            let turned = photo(oriented(&stored, tag));
            let orientation = image::metadata::Orientation::from_exif(tag).unwrap();
            let applied = |mut picture: DynamicImage| {
                picture.apply_orientation(orientation);
                picture
            };
            let luma = turned.luma().unwrap();
            assert_eq!(luma.dimensions(), (turned.width, turned.height));
            assert_eq!(
                luma,
                applied(upright.luma().unwrap().into()).into_luma8(),
                "{name} {tag}"
            );
            for reduction in [1, 2, 8] {
                let expected = applied(upright.rgb(reduction).unwrap().into()).into_rgb8();
                assert_eq!(turned.rgb(reduction).unwrap(), expected, "{name} {tag} 1/{reduction}");
            }
        }
    }
}

/// What the reader says of bytes: an image, or one sentence.
fn refusal(bytes: Vec<u8>) -> Option<String> {
    let photo = match Photo::from_bytes(Path::new("photo.jpg"), bytes, Budget::FILE) {
        Ok(photo) => photo,
        Err(e) => return Some(e.to_string()),
    };
    let [luma, rgb] = [photo.luma().err(), photo.rgb(1).err()].map(|e| e.map(|e| e.to_string()));
    assert_eq!(luma, rgb, "the same is said of luma and of colours");
    luma
}

/// Twenty bytes of each copy are others. Of 200 such copies libjpeg-turbo warns of 182; zune-jpeg refused 40.
#[test]
fn damage_is_refused_and_bytes_behind_the_image_are_not() {
    let whole = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    let mut random = Pcg64::seed_from_u64(18);
    let refused = (0..100).filter(|_| {
        let mut copy = whole.clone();
        for _ in 0..20 {
            let at = random.random_range(700..copy.len() - 2);
            copy[at] = random.random();
        }
        refusal(copy).is_some()
    });
    let refused = refused.count();
    assert!(refused >= 91, "{refused} of 100");
    for behind in [&b"motion photo"[..], &[0; 5000], &[0xFF, 0xD8, 0xFF]] {
        assert_eq!(refusal([&whole[..], behind].concat()), None);
    }
}

/// Data that is missing or too much, also where it is replaced by a whole end.
#[test]
fn data_that_ends_early_or_goes_on_is_refused() {
    for name in names() {
        let whole = bytes(&name);
        let scan = whole.windows(2).rposition(|pair| pair == [0xFF, 0xDA]).unwrap();
        let data = scan + 10..whole.len() - 2;
        let cut = data.start + data.len() / 3;
        if data.len() < 60 {
            continue;
        }
        let said = refusal([&whole[..cut], &[0xFF, 0xD9]].concat()).unwrap_or_else(|| panic!("{name} cut"));
        assert!(said.contains("cannot be decoded ("), "{said}");
        let more = [&whole[..data.end], &[0x55; 40], &[0xFF, 0xD9]].concat();
        assert!(refusal(more).is_some(), "{name} goes on");
    }
}

/// A file without the segments of a marker.
fn without(bytes: &[u8], marker: u8) -> Vec<u8> {
    let (mut left, mut at) = (bytes[..2].to_vec(), 2);
    while bytes[at + 1] != 0xDA {
        let end = at + 2 + usize::from(u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]));
        if bytes[at + 1] != marker {
            left.extend_from_slice(&bytes[at..end]);
        }
        at = end;
    }
    [&left, &bytes[at..]].concat()
}

/// Images of motion JPEG: OpenCV writes the standard's tables (T.81, K.3), and reads files without any by them.
#[test]
fn files_without_huffman_tables_are_read_by_the_standards() {
    for name in ["420_odd", "444_odd", "grey", "restarts"] {
        let bare = without(&bytes(name), 0xC4);
        assert!(bare.len() + 100 < bytes(name).len());
        assert_eq!(
            photo(bare).rgb(1).unwrap(),
            photo(bytes(name)).rgb(1).unwrap(),
            "{name}"
        );
    }
    // Progressive ones have tables of their own.
    let said = refusal(without(&bytes("444_progressive"), 0xC4)).unwrap();
    assert!(said.contains("a table for its data is missing"), "{said}");
}

/// Whole data without its end is a note; libjpeg reads it without loss. A cut anywhere before is refused at once.
#[test]
fn a_missing_end_marker_is_a_note_and_missing_data_is_not() {
    for name in names() {
        let whole = bytes(&name);
        assert_eq!(photo(whole.clone()).note(), None);
        for behind in [0, 1] {
            let read = photo(whole[..whole.len() - 2 + behind].to_vec());
            assert!(
                read.note().unwrap().contains("photo.jpg has no end-of-image marker"),
                "{name}"
            );
            assert_eq!(read.luma().unwrap(), photo(whole.clone()).luma().unwrap(), "{name}");
        }
        let scans: Vec<usize> = (2..whole.len() - 2)
            .filter(|at| whole[*at..at + 2] == [0xFF, 0xDA])
            .collect();
        // Before each scan, within the first, and near the end.
        let cuts = scans
            .iter()
            .copied()
            .chain([scans[0] + 16, whole.len() - 2 - whole.len() / 10]);
        for cut in cuts {
            let said = Photo::from_bytes(Path::new("photo.jpg"), whole[..cut].to_vec(), Budget::FILE);
            let said = said.map(|_| ()).expect_err(&format!("{name} cut at {cut}")).to_string();
            assert!(
                said.contains("ends in the middle of the image") || said.contains("no data"),
                "{name}: {said}"
            );
        }
    }
}

#[test]
fn restart_markers_out_of_order_are_refused() {
    let whole = bytes("restarts");
    let second = whole.windows(2).position(|pair| pair == [0xFF, 0xD1]).unwrap();
    let mut wrong = whole.clone();
    wrong[second + 1] = 0xD4;
    assert!(refusal(wrong).unwrap().contains("restart markers are out of order"));
    let first = whole.windows(2).position(|pair| pair == [0xFF, 0xD0]).unwrap();
    let without_one = [&whole[..first], &whole[second..]].concat();
    assert!(refusal(without_one).is_some());
}

#[test]
fn kinds_that_no_camera_writes_are_refused_by_their_header() {
    let whole = bytes("420_odd");
    let frame = whole.windows(2).position(|pair| pair == [0xFF, 0xC0]).unwrap();
    let with = |at: usize, value: u8| {
        let mut other = whole.clone();
        other[frame + at] = value;
        refusal(other).unwrap()
    };
    for (said, word) in [
        (with(1, 0xC9), "arithmetic-coded"),
        (with(1, 0xCA), "arithmetic-coded"),
        (with(1, 0xC3), "lossless"),
        (with(4, 12), "other than 8 bits"),
        (with(11, 0x51), "contradicts itself"),
        (with(14, 0x31), "sampled at fractions"),
    ] {
        assert!(said.starts_with("photo.jpg cannot be decoded ("), "{said}");
        assert!(said.contains(word), "{said}");
    }
}

/// Four inks, as Adobe's programs store them: 8x, 10y and 90 are left of cyan, magenta and yellow, and 200 of all by black.
#[test]
fn inks_become_the_colours_that_they_print() {
    let read = photo(bytes("inks"));
    let rgb = read.rgb(1).unwrap();
    for (x, y, pixel) in rgb.enumerate_pixels() {
        for (read, ink) in pixel.0.iter().zip([8 * x, 10 * y, 90]) {
            let printed = f64::from(ink) * 200.0 / 255.0;
            assert!((f64::from(*read) - printed).abs() <= 6.0, "{read} {printed}");
        }
    }
    assert_eq!(read.luma().unwrap(), imageops::grayscale(&rgb));
}
