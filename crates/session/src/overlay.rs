//! Copies of photos annotated with the detected tags and poses.

use std::path::Path;

use nalgebra::Point3;

use crate::envelope::EnvelopeShape;
use scaleproof_core::geometry::Rigid;
use scaleproof_photo::copies::{self, CopiesError};
use scaleproof_photo::draw::{self, DrawColour, LabelAnchor, Lettering, Pen, RgbImage};
use scaleproof_photo::{Photo, PhotoError, fitting, shrunk};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{Located, LocatedPhoto};
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::SeenTag;

/// Longest side of a copy, px.
const LONGEST_SIDE_PX: u32 = 2000;

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

/// Annotates a copy of a photo with the tags, the model's box and axes and its ground truth box, and writes it.
///
/// # Errors
/// The photo cannot be read again; the copy cannot be written.
pub fn write(
    place: &Path,
    photo: &Path,
    examined: &LocatedPhoto,
    scene: &Scene,
    outline: &EnvelopeShape,
) -> Result<(), CopiesError> {
    let mut overlay = Overlay::new(&Photo::open(photo)?)?;
    if let (Ok(located), Ok(fitted)) = (&examined.result, &examined.fitted) {
        overlay.model(scene, outline, &located.pose, &fitted.camera);
    }
    for tag in &examined.seen {
        let (colour, text) = mark(tag, examined, scene);
        overlay.tag(tag, colour, &text);
    }
    let name = photo.file_name().unwrap_or_default().to_string_lossy();
    match &examined.result {
        Ok(located) => overlay.words(&format!("{name}\n{}", in_words(located)), GROUND),
        Err(reason) => overlay.words(&format!("{name}\nno pose: {reason}\n{}", seen(examined)), NO_POSE),
    }
    copies::write(place, &overlay.image)
}

/// Copy being annotated; positions are in pixels of the photo.
struct Overlay {
    image: RgbImage,
    /// Scale from photo to copy, across and down.
    scale: [f64; 2],
    width_px: f64,
    size_px: f64,
}

impl Overlay {
    /// Creates a copy with a longest side of at most [`LONGEST_SIDE_PX`].
    fn new(file: &Photo) -> Result<Overlay, PhotoError> {
        let sides = [file.width, file.height];
        let small = fitting(sides, LONGEST_SIDE_PX);
        let image = shrunk(&file.rgb(file.reduction(small))?, small);
        let (width_px, size_px) = draw::readable_px(&image);
        let scale = [0, 1].map(|i| f64::from(small[i]) / f64::from(sides[i]));
        Ok(Overlay {
            image,
            scale,
            width_px,
            size_px,
        })
    }

    /// Converts a position in the photo to the copy.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x + 0.5) * self.scale[0] - 0.5, (y + 0.5) * self.scale[1] - 0.5]
    }

    /// Returns a pen of this colour, `wider` times the usual width.
    fn pen(&self, colour: DrawColour, wider: f64) -> Pen {
        let width_px = wider * self.width_px;
        Pen { colour, width_px }
    }

    fn label(&mut self, middle: [f64; 2], text: &str, [colour, ground]: [DrawColour; 2]) {
        let size_px = self.size_px;
        let letters = Lettering {
            colour,
            ground,
            size_px,
        };
        draw::label(&mut self.image, middle, LabelAnchor::Centre, text, letters);
    }

    /// Draws the model's box, its ground truth box, and the axes.
    fn model(&mut self, scene: &Scene, outline: &EnvelopeShape, pose: &Rigid, camera: &Camera) {
        let corners = scene.model.box_corners_mm();
        for (i, from) in corners.iter().enumerate() {
            for bit in [1, 2, 4].into_iter().filter(|bit| i & bit == 0) {
                self.edge(from, &corners[i | bit], pose, camera, self.pen(MODEL, 1.0));
            }
        }
        if let Ok(truth) = outline.box_in_photo(pose, camera) {
            // The box counts from the image's corner, drawing from the first pixel's centre.
            let [left, top, right, bottom] = [truth.x1, truth.y1, truth.x2, truth.y2].map(|v| v - 0.5);
            let (corners, pen) = ([self.at([left, top]), self.at([right, bottom])], self.pen(TRUTH, 1.0));
            draw::rectangle(&mut self.image, corners[0], corners[1], pen);
        }
        let [length, width, height] = scene.model.size_mm;
        let ends = [
            [0.65 * length, 0.0, 0.0],
            [0.0, 0.8 * width, 0.0],
            [0.0, 0.0, 1.3 * height],
        ];
        for ((colour, name), end) in AXES.into_iter().zip(ends.map(Point3::from)) {
            self.edge(&Point3::origin(), &end, pose, camera, self.pen(colour, 1.6));
            if let Some(pixel) = camera.project(&(pose * end)) {
                self.label(self.at(pixel), name, [colour, GROUND]);
            }
        }
    }

    /// Draws a straight edge of the model frame as curved by the lens.
    fn edge(&mut self, from: &Point3<f64>, to: &Point3<f64>, pose: &Rigid, camera: &Camera, pen: Pen) {
        const PIECES: u32 = 24;
        let pixel = |i: u32| camera.project(&(pose * (from + (to - from) * (f64::from(i) / f64::from(PIECES)))));
        for i in 0..PIECES {
            if let (Some(a), Some(b)) = (pixel(i), pixel(i + 1)) {
                let [a, b] = [self.at(a), self.at(b)];
                draw::line(&mut self.image, a, b, pen);
            }
        }
    }

    fn tag(&mut self, tag: &SeenTag, colour: DrawColour, text: &str) {
        let (corners, pen) = (tag.corners_px.map(|corner| self.at(corner)), self.pen(colour, 1.3));
        draw::polygon(&mut self.image, &corners, pen);
        let middle = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).sum::<f64>() / 4.0);
        self.label(middle, text, [[0; 3], colour]);
    }

    /// Draws text in the top-left corner, broken into lines that fit.
    fn words(&mut self, text: &str, ground: DrawColour) {
        let size_px = 1.15 * self.size_px;
        let widest = 0.96 * f64::from(self.image.width());
        let lines: Vec<String> = text.lines().flat_map(|line| wrapped(line, size_px, widest)).collect();
        let (colour, corner) = (WORDS, [0.0, 0.0]);
        let letters = Lettering {
            colour,
            ground,
            size_px,
        };
        draw::label(
            &mut self.image,
            corner,
            LabelAnchor::TopLeft,
            &lines.join("\n"),
            letters,
        );
    }
}

/// Returns a tag's colour and label, by its use for the pose.
fn mark(tag: &SeenTag, examined: &LocatedPhoto, scene: &Scene) -> (DrawColour, String) {
    let id = tag.id;
    let is_ignored = |located: &Located| located.ignored_tags.iter().find(|tag| tag.id == id).map(|tag| tag.why);
    match &examined.result {
        _ if scene.tag(tag.family, id).is_none() => (UNKNOWN, format!("{id}: not in the scene")),
        Ok(located) => match is_ignored(located) {
            Some(why) => (LEFT_OUT, format!("{id}: {why}")),
            None => (USED, id.to_string()),
        },
        Err(_) => (LEFT_OUT, id.to_string()),
    }
}

fn seen(examined: &LocatedPhoto) -> String {
    let mut ids: Vec<u32> = examined.seen.iter().map(|tag| tag.id).collect();
    ids.sort_unstable();
    let ids: Vec<String> = ids.iter().map(u32::to_string).collect();
    if ids.is_empty() {
        "no tag was seen".to_owned()
    } else {
        format!("tags seen: {}", ids.join(", "))
    }
}

fn in_words(l: &Located) -> String {
    let (v, s, b) = (&l.viewpoint, &l.sigma, &l.bin);
    format!(
        "azimuth {:.2}° ± {:.3}°, pitch {:.2}° ± {:.3}°, distance {:.1} mm ± {:.2} mm\nbin {}°/{}°/{} mm, {:.0} % sure; {} tags, rms {:.2} px",
        v.azimuth_deg,
        s.azimuth_deg,
        v.pitch_deg,
        s.pitch_deg,
        v.distance_mm,
        s.distance_mm,
        b.azimuth_deg,
        b.pitch_deg,
        b.distance_mm,
        (100.0 * l.bin_probability).floor(),
        l.tags.len(),
        l.rms_px
    )
}

/// Breaks a line at spaces into lines of at most `widest_px` pixels.
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
