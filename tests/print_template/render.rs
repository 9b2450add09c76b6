//! Runs the program, and makes images of what it wrote.
#![allow(dead_code)] // each test file uses its part

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::RgbImage;
use scaleproof_print::media::Media;
use scaleproof_print::paper::{Orientation, Paper};
use scaleproof_print::template::LayoutRequest;
use scaleproof_surface::pattern::Pattern;

use crate::common::pictured;

pub fn scaleproof(command: &str) -> Output {
    Command::new(crate::common::built())
        .args(command.split(' '))
        .output()
        .unwrap()
}

/// Runs a command that must succeed.
pub fn done(command: &str) {
    let output = scaleproof(command);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The template of the guide, and what the program takes when nothing is said.
pub fn usual_request() -> LayoutRequest {
    LayoutRequest {
        size_mm: (600.0, 300.0),
        media: Media::new(Paper::A4),
        orientation: Orientation::Auto,
        overlap_mm: 8.0,
        bleed_mm: 2.0,
    }
}

pub fn pattern_file(pattern: &Pattern, folder: &Path) -> PathBuf {
    let path = folder.join("p.png");
    std::fs::write(&path, pattern.to_png().unwrap()).unwrap();
    path
}

/// A pattern of 9 by 5 cells.
pub fn oblong_pattern(folder: &Path) -> Pattern {
    let path = folder.join("oblong.png");
    let wide = Pattern::random(9, 4).unwrap();
    let cropped = image::imageops::crop_imm(wide.cells(), 0, 0, 9, 5).to_image();
    cropped.save(&path).unwrap();
    Pattern::load(&path).unwrap()
}

/// The pages of a PDF from `first` (counted from 1) on.
pub fn pages(pdf: &Path, first: usize, dpi: f64) -> Vec<RgbImage> {
    pictured(pdf, &["-r", &dpi.to_string(), "-f", &first.to_string()], ppm)
}

/// What is written on a page, counted from 1.
pub fn text_of(pdf: &Path, page: usize) -> String {
    pdftotext(pdf, page, &[])
}

/// The words of a page, counted from 1, and their boxes: left, top, right, bottom in mm from the page's top-left corner.
pub fn words(pdf: &Path, page: usize) -> Vec<(String, [f64; 4])> {
    let text = pdftotext(pdf, page, &["-bbox"]);
    let word = |tag: &str| {
        let (attributes, rest) = tag.split_once('>')?;
        let mm = |name: &str| {
            let value = attributes.split_once(&format!("{name}=\""))?.1.split_once('"')?.0;
            Some(value.parse::<f64>().ok()? / 72.0 * 25.4)
        };
        let area = [mm("xMin")?, mm("yMin")?, mm("xMax")?, mm("yMax")?];
        Some((rest.split_once("</word>")?.0.to_owned(), area))
    };
    text.split("<word ").skip(1).filter_map(word).collect()
}

fn pdftotext(pdf: &Path, page: usize, options: &[&str]) -> String {
    let page = page.to_string();
    let run = Command::new("pdftotext")
        .args(["-f", &page, "-l", &page])
        .args(options)
        .arg(pdf)
        .arg("-")
        .output();
    String::from_utf8(run.expect("install poppler-utils").stdout).unwrap()
}

/// A binary PPM: "P6", width, height, 255, and the pixels. A PNG of an A3 page at 600 dpi takes ten times as long.
fn ppm(bytes: &[u8]) -> RgbImage {
    let mut fields = bytes.splitn(4, |b| b.is_ascii_whitespace());
    let (magic, width, height) = (fields.next(), fields.next(), fields.next());
    assert_eq!(magic, Some(&b"P6"[..]));
    let number = |field: Option<&[u8]>| std::str::from_utf8(field.unwrap()).unwrap().parse::<u32>().unwrap();
    let pixels = fields.next().unwrap().strip_prefix(b"255\n").unwrap();
    RgbImage::from_raw(number(width), number(height), pixels.to_vec()).unwrap()
}
