//! Frames from another engine: a folder in the layout that CARLA scripts write, whatever engine wrote it.
//!
//! ```text
//! DIR/import.json     {"field_of_view_deg": 90, "object_rgb": [[0, 0, 142]], "paint_rgb": [[255, 0, 0]], "target_height_m": 0.7}
//! DIR/poses.csv       name,place,light,paint,camera_x_m,…
//! DIR/rgb/NAME.png    what the camera saw (PNG or JPEG: NAME.jpg)
//! DIR/mask/NAME.png   the semantic or instance image of the same view: colours name what is seen
//! ```
//!
//! `object_rgb` lists the mask's colours of the model with all its parts; `paint_rgb`, when given, those of its paint (else all of the
//! object counts as paint). `target_height_m` is half the model's height. `poses.csv` has a line a frame: `paint` is a flat colour in hex
//! (`808080`) or `original`; `light` and `place` as in [`frames`](crate::frames). The poses of camera and vehicle
//! ([`carla::Transform`]) are those of CARLA's `get_transform()`: metres and degrees, x forward, y right, z up, left-handed.
//!
//! A semantic mask tells no part of a pixel, so coverage is 0 or 1. No linear light comes with such images.

pub mod carla;
pub mod fca;
mod npz;

use std::path::{Path, PathBuf};

use image::{GrayImage, Luma, RgbImage};
use nalgebra::Point3;
use serde::Deserialize;

use crate::{
    Frame, FrameList, FramePaint, FramesError, Pinhole, encode_grey, encode_rgb, light, outline, require, syntax,
};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::length::shown;
use scaleproof_photo::{Photo, PhotoError};

/// Horizontal; what a pinhole camera can have.
const FIELDS_OF_VIEW_DEG: std::ops::RangeInclusive<f64> = 1.0..=170.0;

#[derive(Debug, thiserror::Error)]
pub enum FrameImportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error("the field of view cannot be {}°; give the horizontal one, from 1 to 170", shown(*value))]
    FieldOfView { value: f64 },
    #[error("the scale cannot be {}; give 10 for a 1:10 model, from 0.01 to 10000", shown(*value))]
    Scale { value: f64 },
    #[error("the car cannot have dropped by {} m; give a height from -10 to 10 m", shown(*value))]
    Drop { value: f64 },
}

/// `import.json`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct About {
    /// Horizontal.
    field_of_view_deg: f64,
    object_rgb: Vec<[u8; 3]>,
    #[serde(default)]
    paint_rgb: Vec<[u8; 3]>,
    target_height_m: f64,
}

/// A line of `poses.csv`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    name: String,
    place: String,
    light: String,
    paint: String,
    camera_x_m: f64,
    camera_y_m: f64,
    camera_z_m: f64,
    camera_pitch_deg: f64,
    camera_yaw_deg: f64,
    camera_roll_deg: f64,
    vehicle_x_m: f64,
    vehicle_y_m: f64,
    vehicle_z_m: f64,
    vehicle_pitch_deg: f64,
    vehicle_yaw_deg: f64,
    vehicle_roll_deg: f64,
}

impl Row {
    fn camera(&self) -> carla::Transform {
        carla::Transform {
            place_m: [self.camera_x_m, self.camera_y_m, self.camera_z_m],
            angles_deg: [self.camera_pitch_deg, self.camera_yaw_deg, self.camera_roll_deg],
        }
    }

    fn vehicle(&self) -> carla::Transform {
        carla::Transform {
            place_m: [self.vehicle_x_m, self.vehicle_y_m, self.vehicle_z_m],
            angles_deg: [self.vehicle_pitch_deg, self.vehicle_yaw_deg, self.vehicle_roll_deg],
        }
    }
}

/// Everything that a folder becomes: the list and the images, as files of `output`.
///
/// # Errors
/// Missing or damaged files, unknown keys or columns, images of different sizes, masks without the object.
pub fn import(folder: &Path, output: &Path, made_by: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, FrameImportError> {
    let about = about(&folder.join("import.json"))?;
    let poses = folder.join("poses.csv");
    let mut new = Vec::new();
    let mut list: Option<FrameList> = None;
    for (line, row) in rows(&poses)? {
        let name = &row.name;
        let wrong = |message| FileError::syntax(&poses, line, message);
        let paint = paint(&row.paint).map_err(wrong)?;
        let pose = carla::pose(&row.camera(), &row.vehicle());
        let target_mm = [0.0, 0.0, 1000.0 * about.target_height_m];
        let is_ahead = (pose * Point3::from(target_mm)).z > 0.0;
        let message = "the camera looks away from the vehicle: check the poses of both";
        require(is_ahead, || wrong(message.to_owned()))?;
        let rgb = image(folder, name)?;
        let size_px = rgb.dimensions().into();
        let list = list.get_or_insert_with(|| {
            let camera = Pinhole::with_field_of_view(size_px, about.field_of_view_deg);
            FrameList::new(made_by, size_px, camera, target_mm)
        });
        require(size_px == list.size_px, || {
            let message = format!("{name} has another size than the first frame: frames have one camera");
            FileError::content(&folder.join("rgb"), message)
        })?;
        let [object, paint_mask] = masks(&about, &folder.join(format!("mask/{name}.png")), &rgb)?;
        let frame = Frame {
            positions: None,
            sides: None,
            light: row.light.clone(),
            place: row.place.clone(),
            box_xyxy_px: outline(&object),
            ..Frame::new(name, &format!("masks/{name}"), &pose, paint)
        };
        new.push((output.join(&frame.rgb), encode_rgb(&rgb)?));
        new.push((output.join(&frame.object_mask), encode_grey(&object)?));
        new.push((output.join(&frame.paint_mask), encode_grey(&paint_mask)?));
        list.frames.push(frame);
    }
    let list = list.ok_or_else(|| FileError::content(&poses, "it has no lines below its header"))?;
    new.push(list.to_file(output)?);
    Ok(new)
}

fn about(path: &Path) -> Result<About, FrameImportError> {
    let about: About = serde_json::from_str(&files::read_text(path)?).map_err(|e| syntax(path, &e))?;
    let check = |holds, message: &str| require(holds, || FileError::content(path, message));
    let is_view = FIELDS_OF_VIEW_DEG.contains(&about.field_of_view_deg);
    check(is_view, "field_of_view_deg must be 1 to 170, horizontal")?;
    let has_colours = !about.object_rgb.is_empty();
    check(has_colours, "object_rgb must list the mask's colours of the model")?;
    let is_height = about.target_height_m > 0.0 && about.target_height_m.is_finite();
    check(is_height, "target_height_m must be half the model's height in metres")?;
    Ok(about)
}

/// The lines with their numbers, each frame once.
fn rows(path: &Path) -> Result<Vec<(usize, Row)>, FrameImportError> {
    let text = files::read_text(path)?;
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut names = std::collections::HashSet::new();
    let mut rows = Vec::new();
    for (index, row) in reader.deserialize::<Row>().enumerate() {
        let number = index + 2;
        let wrong = |message| FileError::syntax(path, number, message);
        let row = row.map_err(|e| match e.kind() {
            csv::ErrorKind::Deserialize { pos, err } => {
                let line = pos.as_ref().map_or(number, |pos| pos.line() as usize);
                FileError::syntax(path, line, err.to_string())
            }
            _ => wrong(e.to_string()),
        })?;
        let name = &row.name;
        let check = |holds, message: String| require(holds, || wrong(message));
        let message = format!("the name {name:?} may have letters, digits, '-', '_', '.' and '@' only");
        check(is_plain(name), message)?;
        let is_new = names.insert(name.clone());
        check(is_new, format!("the frame {name} is listed twice"))?;
        let is_finite = row.camera().is_finite() && row.vehicle().is_finite();
        check(is_finite, "a pose has a number that is not finite".to_owned())?;
        rows.push((number, row));
    }
    Ok(rows)
}

/// Whether a frame can be called so.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "-_.@".contains(c)) && !name.starts_with('.')
}

fn paint(text: &str) -> Result<FramePaint, String> {
    if text == "original" {
        return Ok(FramePaint::Original);
    }
    let rgb = light::from_hex(text);
    rgb.map(FramePaint::FlatRgb)
        .ok_or_else(|| format!("the paint '{text}' is neither a hex colour, as in 808080, nor 'original'"))
}

fn image(folder: &Path, name: &str) -> Result<RgbImage, FrameImportError> {
    let names = ["png", "jpg", "jpeg"].map(|ending| folder.join(format!("rgb/{name}.{ending}")));
    let there = names.iter().find(|path| path.is_file()).unwrap_or(&names[0]);
    Ok(Photo::open(there)?.rgb(1)?)
}

/// Object and paint.
fn masks(about: &About, path: &Path, rgb: &RgbImage) -> Result<[GrayImage; 2], FrameImportError> {
    let mask = Photo::open(path)?.rgb(1)?;
    let ((width, height), (across, down)) = (mask.dimensions(), rgb.dimensions());
    require((width, height) == (across, down), || {
        let message = format!("the mask has {width}×{height} pixels and its image {across}×{down}");
        FileError::content(path, message)
    })?;
    let covered = |colours: &[[u8; 3]]| {
        let level = |x, y| u8::from(colours.contains(&mask.get_pixel(x, y).0)) * 255;
        GrayImage::from_fn(width, height, |x, y| Luma([level(x, y)]))
    };
    // From above, paint may be all that is seen of the model.
    let paints = [("paint_rgb", &about.paint_rgb), ("object_rgb", &about.object_rgb)];
    let (key, paint_rgb) = paints[usize::from(about.paint_rgb.is_empty())];
    let paint = covered(paint_rgb);
    require(paint.pixels().any(|p| p.0[0] > 0), || {
        let message = format!(
            "no pixel has a colour of {key}: name the model's colours in this mask, or take the frame out of poses.csv"
        );
        FileError::content(path, message)
    })?;
    let parts: Vec<[u8; 3]> = about.object_rgb.iter().chain(&about.paint_rgb).copied().collect();
    Ok([covered(&parts), paint])
}
