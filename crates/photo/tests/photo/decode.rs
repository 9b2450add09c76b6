//! From bytes to pixels, whole or not at all.

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, RgbImage};
use proptest::prelude::*;
use scaleproof_photo::{Budget, DecodeProblem, Photo, PhotoError};

fn decode(bytes: &[u8]) -> Result<RgbImage, PhotoError> {
    Photo::from_bytes(Path::new("picture"), bytes.to_vec(), Budget::FILE)?.rgb(1)
}

fn small_jpeg() -> Vec<u8> {
    let image = RgbImage::from_fn(64, 48, |x, y| {
        image::Rgb([(x * 4) as u8, (y * 5) as u8, ((x * y) % 256) as u8])
    });
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).unwrap();
    bytes
}

#[test]
fn a_whole_jpeg_decodes_and_trailing_bytes_do_not_matter() {
    let mut bytes = small_jpeg();
    assert_eq!(decode(&bytes).unwrap().dimensions(), (64, 48));
    bytes.extend_from_slice(b"motion photo video");
    assert_eq!(decode(&bytes).unwrap().dimensions(), (64, 48));
}

#[test]
fn every_cut_is_noticed() {
    let bytes = small_jpeg();
    // Without its end-of-image marker alone, it is whole.
    for keep in 3..bytes.len() - 2 {
        assert!(
            decode(&bytes[..keep]).is_err(),
            "a JPEG cut at byte {keep} of {} was accepted",
            bytes.len()
        );
    }
}

#[test]
fn a_picture_that_claims_to_be_huge_is_refused_before_decoding() {
    let mut bytes = Vec::new();
    RgbImage::new(1, 1)
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .unwrap();
    // The second is the largest that the format has, at which the decoder ends by itself.
    for (side, size_in_words) in [
        (100_000_u32, "10000 megapixels"),
        (i32::MAX as u32, "4611686014132 megapixels"),
    ] {
        // Width and height stand in the header chunk, whose checksum follows them; without a right one it is damaged.
        bytes[16..24].copy_from_slice(&[side.to_be_bytes(), side.to_be_bytes()].concat());
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let problem = decode(&bytes).unwrap_err();
        assert!(
            matches!(&problem, PhotoError::Bytes { problem: DecodeProblem::TooLarge(size), .. } if size.starts_with(size_in_words)),
            "{problem:?}"
        );
    }
}

/// CRC-32 as PNG uses it (RFC 2083, 15), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, b| {
        (0..8).fold(crc ^ u32::from(*b), |c, _| {
            if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 }
        })
    })
}

/// Damage inside a JPEG decodes into some other image; what cannot be right is refused, where lenient decoders refuse none of these.
#[test]
fn damage_that_can_be_noticed_is_refused() {
    let photo = concat!(env!("CARGO_MANIFEST_DIR"), "/../../captures/skyline/normal_000.jpg");
    let bytes = std::fs::read(photo).unwrap();
    let mut random = 1_u64;
    let mut next = || {
        random = random
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (random >> 33) as usize
    };
    let refused = (0..60).filter(|_| {
        let mut copy = bytes.clone();
        for _ in 0..20 {
            let at = 700 + next() % (copy.len() - 702);
            copy[at] = next() as u8;
        }
        decode(&copy).is_err()
    });
    assert!(refused.count() >= 54);
}

#[test]
fn text_is_not_an_image() {
    for text in [&b"this is a shopping list"[..], b""] {
        assert!(matches!(
            decode(text),
            Err(PhotoError::Bytes {
                problem: DecodeProblem::NotAnImage,
                ..
            })
        ));
    }
}

#[test]
fn photos_of_iphones_are_known_by_their_brands() {
    let ftyp = |brands: &[u8]| {
        [
            &(8 + brands.len() as u32).to_be_bytes()[..],
            b"ftyp",
            brands,
            b"\0\0\0\x08mdat",
        ]
        .concat()
    };
    for (brands, kind) in [
        (&b"heic\0\0\0\0mif1heic"[..], Some("HEIC")),
        (b"mif1\0\0\0\0mif1heix", Some("HEIC")),
        (b"mif1\0\0\0\0mif1", Some("HEIF")),
        (b"avif\0\0\0\0avifmif1miaf", Some("AVIF")),
        (b"isom\0\0\x02\0isomiso2", None),
        (b"", None),
    ] {
        let file = ftyp(brands);
        let found = match decode(&file).unwrap_err() {
            PhotoError::Bytes {
                problem: DecodeProblem::Heif(kind),
                ..
            } => Some(kind),
            PhotoError::Bytes {
                problem: DecodeProblem::NotAnImage,
                ..
            } => None,
            other => panic!("{other}"),
        };
        assert_eq!(found, kind, "{}", brands.escape_ascii());
        for cut in 0..file.len() {
            let _ = decode(&file[..cut]);
        }
    }
}

proptest! {
    /// User files of any content: an error or an image, never a panic.
    #[test]
    fn damaged_jpegs_never_panic(at in 2usize..600, value in any::<u8>()) {
        let mut bytes = small_jpeg();
        let at = at % bytes.len();
        bytes[at] = value;
        let _ = decode(&bytes);
    }
}

/// A chunk of a PNG with its check sum (ISO/IEC 15948, annex D).
fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let summed = [&kind[..], content].concat();
    let crc = !summed.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    });
    let length = (content.len() as u32).to_be_bytes();
    [&length[..], &summed, &crc.to_be_bytes()].concat()
}

/// A decoder that takes such a palette for whole colours reads beyond it.
#[test]
fn a_palette_that_ends_within_a_colour_is_damage() {
    let with_palette = |palette: &[u8]| {
        let header = [0, 0, 0, 1, 0, 0, 0, 1, 8, 3, 0, 0, 0];
        // One row of one pixel, the palette's first: zlib's, stored as it is.
        let pixels = [0x78, 0x01, 0x01, 2, 0, 0xFD, 0xFF, 0, 0, 0, 2, 0, 1];
        let chunks = [
            (b"IHDR", &header[..]),
            (b"PLTE", palette),
            (b"tRNS", &[9]),
            (b"IDAT", &pixels),
            (b"IEND", &[]),
        ];
        let chunks = chunks.map(|(kind, content)| chunk(kind, content));
        [b"\x89PNG\r\n\x1a\n".to_vec(), chunks.concat()].concat()
    };
    assert_eq!(
        decode(&with_palette(&[10, 20, 30])).unwrap().get_pixel(0, 0).0,
        [10, 20, 30]
    );
    for cut in [&[10, 20, 30, 40][..], &[10, 20, 30, 40, 50], &[10], &[10, 20]] {
        let error = decode(&with_palette(cut)).unwrap_err().to_string();
        assert!(error.contains("its palette ends within a colour"), "{error}");
    }
}
