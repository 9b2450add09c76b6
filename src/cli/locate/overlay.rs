//! `locate --overlay`: copies of the photos with what was found drawn on them.

use std::path::{Path, PathBuf};

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use nalgebra::Point3;

use super::words;
use crate::cli::copies::{self, CopiesError};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::Rigid;
use scaleproof_photo::draw::{self, DrawColour, LabelAnchor, Lettering, Pen};
use scaleproof_photo::photo::{Photo, PhotoError, shrunk};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Ignored, Located, LocatedPhoto};
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::SeenTag;
use scaleproof_session::envelope::EnvelopeShape;

/// Longest side of a copy, px.
const LONGEST_SIDE_PX: u32 = 2000;

const QUALITY: u8 = 90;

const USED: DrawColour = [0, 210, 90];
const LEFT_OUT: DrawColour = [255, 140, 0];
const UNKNOWN: DrawColour = [160, 160, 160];
const MODEL: DrawColour = [255, 225, 60];
const TRUTH: DrawColour = [255, 60, 200];
const AXES: [(DrawColour, &str); 3] = [
    ([255, 70, 60], "x front"),
    ([70, 230, 70], "y left"),
    ([90, 150, 255], "z up"),
];
const WORDS: DrawColour = [255; 3];
const GROUND: DrawColour = [25, 25, 30];
const NO_POSE: DrawColour = [150, 20, 20];

/// Why there is no overlay.
#[derive(Debug, thiserror::Error)]
pub(super) enum OverlayError {
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} cannot be encoded as JPEG", path = path.display())]
    Encode { path: PathBuf },
}

/// Where the copy of each photo goes: `NAME.overlay.jpg`, and `NAME-2.overlay.jpg` for the next photo of that name.
///
/// # Errors
/// A folder that holds one of the photos, or a file of such a name that no run has drawn.
pub(super) fn places(folder: &Path, photos: &[PathBuf]) -> Result<Vec<PathBuf>, CopiesError> {
    copies::places(folder, photos, "--overlay", |stem, number| match number {
        1 => format!("{stem}.overlay.jpg"),
        number => format!("{stem}-{number}.overlay.jpg"),
    })
}

/// Draws what was found in a photo and writes the copy.
pub(super) fn write(
    place: &Path,
    photo: &Path,
    examined: &LocatedPhoto,
    scene: &Scene,
    outline: &EnvelopeShape,
) -> Result<(), OverlayError> {
    let file = Photo::open(photo)?;
    let (mut image, scale) = reduced(&file)?;
    Overlay {
        image: &mut image,
        scale,
        examined,
        scene,
        outline,
    }
    .draw(photo);
    let mut jpeg = Vec::new();
    let encoded = JpegEncoder::new_with_quality(&mut jpeg, QUALITY).encode_image(&image);
    encoded.map_err(|_| OverlayError::Encode { path: place.to_owned() })?;
    Ok(files::replace_all_atomically(&[(
        place.to_owned(),
        copies::marked(&jpeg),
    )])?)
}

/// The photo with a longest side of [`LONGEST_SIDE_PX`] at most, and how much smaller it is in both directions.
fn reduced(file: &Photo) -> Result<(RgbImage, [f64; 2]), PhotoError> {
    let sides = [file.width, file.height];
    let share = (f64::from(LONGEST_SIDE_PX) / f64::from(sides[0].max(sides[1]))).min(1.0);
    let small = sides.map(|side| (f64::from(side) * share).round().max(1.0) as u32);
    let image = shrunk(&file.rgb(file.reduction(small))?, small);
    Ok((image, [0, 1].map(|i| f64::from(small[i]) / f64::from(sides[i]))))
}

/// A copy that is drawn on; places are in pixels of the photo.
struct Overlay<'a> {
    image: &'a mut RgbImage,
    scale: [f64; 2],
    examined: &'a LocatedPhoto,
    scene: &'a Scene,
    outline: &'a EnvelopeShape,
}

impl Overlay<'_> {
    fn draw(&mut self, photo: &Path) {
        if let (Ok(located), Ok(fitted)) = (&self.examined.result, &self.examined.fitted) {
            let (located, camera) = (located.clone(), fitted.camera.clone());
            self.model(&located.pose, &camera);
        }
        self.tags();
        let name = photo.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (text, ground) = match &self.examined.result {
            Ok(located) => (format!("{name}\n{}", words(located)), GROUND),
            Err(reason) => (format!("{name}\nno pose: {reason}\n{}", self.seen()), NO_POSE),
        };
        self.words(&text, ground);
    }

    /// A place of the photo in the copy.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x + 0.5) * self.scale[0] - 0.5, (y + 0.5) * self.scale[1] - 0.5]
    }

    fn sizes(&self) -> (f64, f64) {
        draw::readable_px(self.image)
    }

    /// The model's box, the box that detections are held against, and the axes.
    fn model(&mut self, pose: &Rigid, camera: &Camera) {
        let (width_px, _) = self.sizes();
        let corners = self.scene.model.box_corners_mm();
        let thin = Pen {
            colour: MODEL,
            width_px,
        };
        for (i, from) in corners.iter().enumerate() {
            for bit in [1, 2, 4].into_iter().filter(|bit| i & bit == 0) {
                self.edge(from, &corners[i | bit], pose, camera, thin);
            }
        }
        if let Ok(truth) = self.outline.box_in_photo(pose, camera) {
            // It counts from the image's corner, drawing from the first pixel's centre.
            let [left, top, right, bottom] = [truth.x1, truth.y1, truth.x2, truth.y2].map(|v| v - 0.5);
            let pen = Pen {
                colour: TRUTH,
                width_px,
            };
            let corners = [self.at([left, top]), self.at([right, bottom])];
            draw::rectangle(self.image, corners[0], corners[1], pen);
        }
        self.axes(pose, camera);
    }

    fn axes(&mut self, pose: &Rigid, camera: &Camera) {
        let (width_px, size_px) = self.sizes();
        let [length, width, height] = self.scene.model.size_mm;
        let ends = [
            [0.65 * length, 0.0, 0.0],
            [0.0, 0.8 * width, 0.0],
            [0.0, 0.0, 1.3 * height],
        ];
        for ((colour, name), end) in AXES.into_iter().zip(ends) {
            let end = Point3::from(end);
            let pen = Pen {
                colour,
                width_px: 1.6 * width_px,
            };
            self.edge(&Point3::origin(), &end, pose, camera, pen);
            if let Some(pixel) = camera.project(&(pose * end)) {
                let letters = Lettering {
                    colour,
                    ground: GROUND,
                    size_px,
                };
                let at = self.at(pixel);
                draw::label(self.image, at, LabelAnchor::Centre, name, letters);
            }
        }
    }

    /// A straight edge of the model frame, bent as the lens bends it.
    fn edge(&mut self, from: &Point3<f64>, to: &Point3<f64>, pose: &Rigid, camera: &Camera, pen: Pen) {
        const PIECES: u32 = 24;
        let pixel = |i: u32| camera.project(&(pose * (from + (to - from) * (f64::from(i) / f64::from(PIECES)))));
        for i in 0..PIECES {
            if let (Some(a), Some(b)) = (pixel(i), pixel(i + 1)) {
                let [a, b] = [self.at(a), self.at(b)];
                draw::line(self.image, a, b, pen);
            }
        }
    }

    fn tags(&mut self) {
        let examined = self.examined;
        let (width_px, size_px) = self.sizes();
        for tag in &examined.seen {
            let (colour, text) = self.fate(tag);
            let corners = tag.corners_px.map(|corner| self.at(corner));
            let pen = Pen {
                colour,
                width_px: 1.3 * width_px,
            };
            draw::polygon(self.image, &corners, pen);
            let middle = |axis: usize| corners.iter().map(|c| c[axis]).sum::<f64>() / 4.0;
            let letters = Lettering {
                colour: [0; 3],
                ground: colour,
                size_px,
            };
            draw::label(self.image, [middle(0), middle(1)], LabelAnchor::Centre, &text, letters);
        }
    }

    /// What became of a tag: its colour and label.
    fn fate(&self, tag: &SeenTag) -> (DrawColour, String) {
        if self.scene.tag(tag.family, tag.id).is_none() {
            return (UNKNOWN, format!("{}: not in the scene", tag.id));
        }
        match &self.examined.result {
            Ok(located) => match ignored(located, tag.id) {
                Some(why) => (LEFT_OUT, format!("{}: {why}", tag.id)),
                None => (USED, tag.id.to_string()),
            },
            Err(_) => (LEFT_OUT, tag.id.to_string()),
        }
    }

    /// The tags that were seen, in words.
    fn seen(&self) -> String {
        let mut ids: Vec<u32> = self.examined.seen.iter().map(|tag| tag.id).collect();
        ids.sort_unstable();
        let ids: Vec<String> = ids.iter().map(u32::to_string).collect();
        if ids.is_empty() {
            "no tag was seen".to_owned()
        } else {
            format!("tags seen: {}", ids.join(", "))
        }
    }

    /// Text in the top-left corner, broken into lines that fit.
    fn words(&mut self, text: &str, ground: DrawColour) {
        let (_, size_px) = self.sizes();
        let size_px = 1.15 * size_px;
        let widest = 0.96 * f64::from(self.image.width());
        let lines: Vec<String> = text.lines().flat_map(|line| wrapped(line, size_px, widest)).collect();
        let letters = Lettering {
            colour: WORDS,
            ground,
            size_px,
        };
        draw::label(self.image, [0.0, 0.0], LabelAnchor::TopLeft, &lines.join("\n"), letters);
    }
}

fn ignored(located: &Located, id: u32) -> Option<Ignored> {
    located.ignored_tags.iter().find(|tag| tag.id == id).map(|tag| tag.why)
}

/// A line in lines of at most so many pixels, broken at spaces.
fn wrapped(line: &str, size_px: f64, widest_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in line.split(' ') {
        let longer = lines.last().map(|last| format!("{last} {word}"));
        match (lines.last_mut(), longer) {
            (Some(last), Some(longer)) if draw::label_size_px(&longer, size_px)[0] <= widest_px => *last = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
