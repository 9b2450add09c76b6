//! Renders a PDF with poppler and finds things on its pages in millimetres.
#![allow(dead_code)] // each test file uses its part

use std::path::Path;

use image::GrayImage;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{AprilTagC, TagDetector};

use crate::common::pictured;

/// The short and the long side of A4.
pub const A4: (f64, f64) = (210.0, 297.0);

/// A point in millimetres; page frame, y up.
pub type Mm = [f64; 2];

/// One rendered page.
pub struct Page {
    pub picture: GrayImage,
    pub dpi: f64,
    pub height_mm: f64,
}

impl Page {
    /// The place of a point of the image; pixel (0, 0) is the centre of the top left pixel.
    pub fn mm(&self, [x, y]: [f64; 2]) -> Mm {
        let mm = |pixels: f64| (pixels + 0.5) * 25.4 / self.dpi;
        [mm(x), self.height_mm - mm(y)]
    }

    /// Whether the image is black at a place.
    pub fn is_black(&self, [x, y]: Mm) -> bool {
        let pixel = |mm: f64| (mm / 25.4 * self.dpi) as u32;
        self.picture.get_pixel(pixel(x), pixel(self.height_mm - y)).0[0] < 128
    }

    /// Every tag of some families: family, id, corners top-left, top-right, bottom-right, bottom-left of the upright tag.
    pub fn tags(&self, families: &[TagFamily]) -> Vec<(TagFamily, u32, [Mm; 4])> {
        let found = AprilTagC::new(families).unwrap().find(&self.picture);
        for tag in &found {
            assert!(
                tag.is_whole,
                "nothing covers tag {} of {:?} on the page",
                tag.id, tag.family
            );
        }
        let on_page = found
            .into_iter()
            .map(|tag| (tag.family, tag.id, tag.corners_px.map(|px| self.mm(px))));
        on_page.collect()
    }
}

/// The pages of a PDF on paper of some short and long side, upright or across.
pub fn render(pdf: &Path, dpi: u32, (short_mm, long_mm): (f64, f64)) -> Vec<Page> {
    pictured(pdf, &["-gray", "-r", &dpi.to_string()], |bytes| {
        let picture = pgm(bytes);
        let across = picture.width() > picture.height();
        Page {
            picture,
            dpi: f64::from(dpi),
            height_mm: if across { short_mm } else { long_mm },
        }
    })
}

/// A binary PGM as pdftoppm writes it: `P5 width height 255` and the pixels.
fn pgm(bytes: &[u8]) -> GrayImage {
    let mut fields = bytes.splitn(5, |b| b.is_ascii_whitespace());
    let mut text = || std::str::from_utf8(fields.next().unwrap()).unwrap().to_owned();
    assert_eq!(text(), "P5");
    let [width, height] = [text(), text()].map(|number| number.parse().unwrap());
    assert_eq!(text(), "255");
    GrayImage::from_raw(width, height, fields.next().unwrap().to_vec()).unwrap()
}

pub fn distance(a: Mm, b: Mm) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
