//! EXIF numbers in every type that TIFF has, in both byte orders.

use std::path::Path;

use image::RgbImage;
use scaleproof_photo::{Budget, Photo, preview_jpeg};

/// TIFF 6.0, section 2: numbers of a type, and how many bytes they take.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Type {
    Byte = 1,
    Short = 3,
    Long = 4,
    Rational = 5,
    SByte = 6,
    SShort = 8,
    SLong = 9,
    SRational = 10,
    Float = 11,
    Double = 12,
}
use Type::{Byte, Double, Float, Long, Rational, SByte, SLong, SRational, SShort, Short};

const ALL: [Type; 10] = [
    Byte, Short, Long, Rational, SByte, SShort, SLong, SRational, Float, Double,
];

fn bytes(kind: Type, number: u8, is_big: bool) -> Vec<u8> {
    let ordered = |little: &[u8]| {
        let mut bytes = little.to_vec();
        if is_big {
            bytes.reverse();
        }
        bytes
    };
    let whole = |width: usize| ordered(&u64::from(number).to_le_bytes()[..width]);
    match kind {
        Byte | SByte => whole(1),
        Short | SShort => whole(2),
        Long | SLong => whole(4),
        Rational | SRational => [whole(4), ordered(&1u32.to_le_bytes())].concat(),
        Float => ordered(&f32::from(number).to_le_bytes()),
        Double => ordered(&f64::from(number).to_le_bytes()),
    }
}

/// A JPEG whose EXIF block has one number: of the image itself, or in the directory of the camera's settings (Exif 2.32, 4.6.3).
fn jpeg(tag: u16, of_camera: bool, kind: Type, number: u8, is_big: bool) -> Vec<u8> {
    let two = |v: u16| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
    let four = |v: u32| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
    let directory = |at: u32, tag: u16, kind: u16, value: &[u8]| {
        let mut inline = value.to_vec();
        let is_long = value.len() > 4;
        if is_long {
            inline = four(at + 18).to_vec();
        }
        inline.resize(4, 0);
        let entry = [&two(1)[..], &two(tag), &two(kind), &four(1), &inline, &four(0)].concat();
        [&entry[..], if is_long { value } else { &[] }].concat()
    };
    let value = bytes(kind, number, is_big);
    let body = if of_camera {
        [
            directory(8, 0x8769, 4, &four(26)),
            directory(26, tag, kind as u16, &value),
        ]
        .concat()
    } else {
        directory(8, tag, kind as u16, &value)
    };
    let order = if is_big { b"MM" } else { b"II" };
    let block = [&b"Exif\0\0"[..], order, &two(42), &four(8), &body].concat();
    let plain = preview_jpeg(&RgbImage::new(64, 48), 90).unwrap();
    let length = (block.len() as u16 + 2).to_be_bytes();
    [&plain[..2], &[0xFF, 0xE1], &length, &block, &plain[2..]].concat()
}

fn photo(bytes: Vec<u8>) -> Photo {
    Photo::from_bytes(Path::new("photo.jpg"), bytes, Budget::FILE).unwrap()
}

/// PIL 13 turns the image for every type but BYTE; OpenCV 5 reads every integer of little-endian files.
#[test]
fn orientation_is_read_in_every_type() {
    for kind in ALL {
        for is_big in [false, true] {
            for (number, turned_deg) in [(1, 0), (3, 180), (6, 90), (8, 270)] {
                let read = photo(jpeg(0x0112, false, kind, number, is_big));
                assert_eq!(read.turned_deg, turned_deg, "{kind:?} {is_big}");
                assert_eq!(read.width == 48, turned_deg % 180 == 90, "{kind:?} {is_big}");
            }
        }
    }
    // What no orientation is, is none.
    assert_eq!(photo(jpeg(0x0112, false, Long, 9, true)).turned_deg, 0);
}

#[test]
fn what_a_lens_is_computed_from_is_read_in_every_type() {
    for kind in ALL {
        for is_big in [false, true] {
            let lens = |tag| photo(jpeg(tag, true, kind, 28, is_big)).lens();
            assert_eq!(lens(0x920A).focal_mm, Some(28.0), "{kind:?} {is_big}");
            assert_eq!(lens(0xA405).equivalent_35_mm, Some(28.0), "{kind:?} {is_big}");
            assert_eq!(lens(0xA404).digital_zoom, Some(28.0), "{kind:?} {is_big}");
            assert_eq!(lens(0xA20E).sensor_px_per_mm, Some(28.0 / 25.4), "{kind:?} {is_big}");
        }
    }
}
