//! Streams of JPEG files cut into their files, byte for byte.

use std::io::Read;
use std::path::Path;

use proptest::prelude::*;
use scaleproof_capture::live::{Jpegs, jpeg_size};

/// JPEG files of libjpeg, among them progressive ones, one with restart markers, and one of a single colour.
fn files() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/jpeg");
    let names = ["420_odd", "444_progressive", "restarts", "grey", "tiny", "inks"];
    let read = |name: &str| std::fs::read(folder.join(format!("{name}.jpg"))).unwrap();
    let mut files: Vec<Vec<u8>> = names.map(read).into();
    // A thumbnail inside a file is no file of its own: the first lies in a segment of the second (EXIF, APP1).
    let (small, large) = (read("tiny"), read("420_odd"));
    let segment = [&[0xFF, 0xE1][..], &(small.len() as u16 + 2).to_be_bytes(), &small].concat();
    files.push([&large[..2], &segment, &large[2..]].concat());
    files
}

/// Gives its bytes in pieces.
struct Pieces {
    bytes: Vec<u8>,
    at: usize,
    length: usize,
}

impl Read for Pieces {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let left = &self.bytes[self.at..];
        let count = left.len().min(into.len()).min(self.length);
        into[..count].copy_from_slice(&left[..count]);
        self.at += count;
        Ok(count)
    }
}

fn cut(bytes: Vec<u8>, length: usize) -> Vec<Vec<u8>> {
    let mut jpegs = Jpegs::new(Pieces { bytes, at: 0, length });
    let mut found = Vec::new();
    while let Some(jpeg) = jpegs.next_jpeg().unwrap() {
        found.push(jpeg);
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whole_files_are_given_byte_for_byte_whatever_lies_between_them(
        order in proptest::collection::vec((0usize..7, proptest::collection::vec(0u8..=0xFE, 0..40)), 0..8),
        length in 1usize..5000,
    ) {
        let files = files();
        let stream = order.iter().flat_map(|(file, between)| [between.clone(), files[*file].clone()].concat()).collect();
        let expected: Vec<Vec<u8>> = order.iter().map(|(file, _)| files[*file].clone()).collect();
        prop_assert!(cut(stream, length) == expected);
    }

    /// A camera that is switched off, or a packet that is lost: what follows is read on.
    #[test]
    fn a_file_that_breaks_off_is_left_out(file in 0usize..7, share in 0.01f64..0.99, length in 1usize..5000) {
        let files = files();
        let whole = &files[3];
        let half = &files[file][..(files[file].len() as f64 * share) as usize];
        let stream = [whole, half, whole, whole].map(<[u8]>::to_vec).concat();
        let found = cut(stream, length);
        prop_assert!(found.first() == Some(whole) && found.last() == Some(whole));
        prop_assert!(found.len() >= 2);
    }

    #[test]
    fn any_bytes_are_read_to_their_end(bytes in proptest::collection::vec(prop_oneof![Just(0xFFu8), Just(0xD8), Just(0xDA), Just(0), any::<u8>()], 0..3000)) {
        for jpeg in cut(bytes, 700) {
            prop_assert!(jpeg.starts_with(&[0xFF, 0xD8]) && jpeg.ends_with(&[0xFF, 0xD9]));
            let _ = jpeg_size(&jpeg);
        }
    }
}

#[test]
fn what_is_no_jpeg_for_32_megabytes_ends_it_and_is_not_held() {
    let endless = [0xFF, 0xD8, 0xFF, 0xE0].into_iter().cycle();
    for bytes in [vec![7; 40 << 20], endless.take(40 << 20).collect::<Vec<u8>>()] {
        let error = Jpegs::new(&bytes[..]).next_jpeg().unwrap_err();
        assert_eq!(error.to_string(), "what it sends is no JPEG");
    }
    // A scan without an end.
    let head = [0xFF, 0xD8, 0xFF, 0xDA, 0, 2];
    let long = head.as_slice().chain(std::io::repeat(1));
    assert_eq!(
        Jpegs::new(long).next_jpeg().unwrap_err().to_string(),
        "what it sends is no JPEG"
    );
}
