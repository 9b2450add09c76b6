//! The markers of a JPEG file, without its pixels.

/// What the first image of a JPEG file consists of (ITU-T T.81, annex B).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JpegStructure {
    /// Start-of-scan markers.
    pub scans: u64,
    pub components: u64,
    pub is_progressive: bool,
}

const END_OF_IMAGE: u8 = 0xD9;
const START_OF_SCAN: u8 = 0xDA;

/// Starts of frames, but for DHT, JPG and DAC, which lie among them.
const FRAMES: std::ops::RangeInclusive<u8> = 0xC0..=0xCF;
const NO_FRAMES: [u8; 3] = [0xC4, 0xC8, 0xCC];

/// Start of a progressive frame, with Huffman or arithmetic codes.
const PROGRESSIVE: [u8; 2] = [0xC2, 0xCA];

impl JpegStructure {
    /// `None` when the image does not reach its end-of-image marker.
    ///
    /// Segments are skipped by their length, so the thumbnail inside the EXIF segment cannot be taken for the end; bytes after the
    /// end (motion photos, depth maps) do not matter.
    pub fn of(bytes: &[u8]) -> Option<JpegStructure> {
        let mut structure = JpegStructure {
            scans: 0,
            components: 0,
            is_progressive: false,
        };
        let mut at = 2; // behind the start-of-image marker
        loop {
            let marker_at = find_marker(bytes, at)?;
            let marker = bytes[marker_at + 1];
            at = marker_at + 2;
            match marker {
                END_OF_IMAGE => return Some(structure),
                // Markers without a segment: TEM and the restart markers, which also stand inside scan data.
                0x01 | 0xD0..=0xD7 => continue,
                START_OF_SCAN => structure.scans += 1,
                _ if FRAMES.contains(&marker) && !NO_FRAMES.contains(&marker) => {
                    structure.is_progressive |= PROGRESSIVE.contains(&marker);
                    // Behind the length, the precision, and the two sides.
                    structure.components = (*bytes.get(at + 7)?).into();
                }
                _ => {}
            }
            let length = bytes.get(at..at + 2)?;
            at += usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
        }
    }
}

/// The next marker at or after `from`: 0xFF followed by neither a stuffed zero nor another fill byte.
fn find_marker(bytes: &[u8], from: usize) -> Option<usize> {
    let rest = bytes.get(from..)?;
    rest.windows(2)
        .position(|pair| pair[0] == 0xFF && !matches!(pair[1], 0x00 | 0xFF))
        .map(|i| from + i)
}
