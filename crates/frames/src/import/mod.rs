//! Frames from another engine: a folder in the layout that CARLA scripts write, whatever engine wrote it.
//!
//! ```text
//! DIR/import.json     {"field_of_view_deg": 90, "object_rgb": [[0, 0, 142]], "paint_rgb": [[255, 0, 0]], "target_height_m": 0.7}
//! DIR/poses.csv       name,place,light,paint,camera_x_m,…
//! DIR/rgb/NAME.png    what the camera saw (PNG or JPEG: NAME.jpg)
//! DIR/mask/NAME.png   the semantic or instance image of the same view: colours name what is seen
//! ```
//!
//! Keys and columns stand in docs/guide/reference/frames-json.md. The poses of camera and vehicle ([`carla::Transform`]) are those of CARLA's
//! `get_transform()`: metres and degrees, x forward, y right, z up, left-handed.
//!
//! A semantic mask tells no part of a pixel, so coverage is 0 or 1. No linear light comes with such images.

pub mod carla; // CARLA's poses
pub mod fca; // FCA's .npz files
mod limits; // fields of view and names that are possible
mod npz; // arrays of NumPy

use std::path::{Path, PathBuf};

use image::{GrayImage, Luma, RgbImage};
use nalgebra::Point3;
use serde::Deserialize;

use crate::{
    Frame, FrameList, FramePaint, FramesError, Pinhole, encode_grey, encode_rgb, light, of_file, outline, syntax,
};
use limits::{FIELDS_OF_VIEW_DEG, is_plain};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, ensure};
use scaleproof_photo::Photo;

/// The content of `import.json`.
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

impl About {
    fn check(&self) -> Result<(), Message> {
        let is_view = FIELDS_OF_VIEW_DEG.contains(&self.field_of_view_deg);
        ensure!(is_view, "field_of_view_deg must be 1 to 170, horizontal");
        let has_colours = !self.object_rgb.is_empty();
        ensure!(has_colours, "object_rgb must list the mask's colours of the model");
        let is_height = self.target_height_m > 0.0 && self.target_height_m.is_finite();
        ensure!(is_height, "target_height_m must be half the model's height in metres");
        Ok(())
    }
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
    fn check(&self, is_new: bool) -> Result<(), Message> {
        let name = &self.name;
        ensure!(
            is_plain(name),
            "the name {name:?} may have letters, digits, '-', '_', '.' and '@' only"
        );
        ensure!(is_new, "the frame {name} is listed twice");
        let is_finite = self.camera().is_finite() && self.vehicle().is_finite();
        ensure!(is_finite, "a pose has a number that is not finite");
        Ok(())
    }

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

/// Imports a folder: returns the list and the images, as files of `output`.
pub fn import(folder: &Path, output: &Path, made_by: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, FramesError> {
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
        if !is_ahead {
            return Err(wrong("the camera looks away from the vehicle: check the poses of both".to_owned()).into());
        }
        let rgb = image(folder, name)?;
        let size_px = rgb.dimensions().into();
        let list = list.get_or_insert_with(|| {
            let camera = Pinhole::with_field_of_view(size_px, about.field_of_view_deg);
            FrameList::new(made_by, size_px, camera, target_mm)
        });
        if size_px != list.size_px {
            let message = format!("{name} has another size than the first frame: frames have one camera");
            return Err(FileError::content(&folder.join("rgb"), message).into());
        }
        let path = folder.join(format!("mask/{name}.png"));
        let [object, paint_mask] = masks(&about, &Photo::open(&path)?.rgb(1)?, &rgb).map_err(of_file(&path))?;
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

fn about(path: &Path) -> Result<About, FramesError> {
    let about: About = serde_json::from_str(&files::read_text(path)?).map_err(|e| syntax(path, &e))?;
    about.check().map_err(of_file(path))?;
    Ok(about)
}

/// Reads the lines of `poses.csv` with their numbers, each frame once.
fn rows(path: &Path) -> Result<Vec<(usize, Row)>, FramesError> {
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
        let is_new = names.insert(row.name.clone());
        row.check(is_new).map_err(|reason| wrong(reason.to_string()))?;
        rows.push((number, row));
    }
    Ok(rows)
}

fn paint(text: &str) -> Result<FramePaint, String> {
    if text == "original" {
        return Ok(FramePaint::Original);
    }
    let rgb = light::from_hex(text);
    rgb.map(FramePaint::FlatRgb)
        .ok_or_else(|| format!("the paint '{text}' is neither a hex colour, as in 808080, nor 'original'"))
}

fn image(folder: &Path, name: &str) -> Result<RgbImage, FramesError> {
    let names = ["png", "jpg", "jpeg"].map(|ending| folder.join(format!("rgb/{name}.{ending}")));
    let there = names.iter().find(|path| path.is_file()).unwrap_or(&names[0]);
    Ok(Photo::open(there)?.rgb(1)?)
}

/// Makes the masks of object and paint of a semantic or instance image.
fn masks(about: &About, mask: &RgbImage, rgb: &RgbImage) -> Result<[GrayImage; 2], Message> {
    let ((width, height), (across, down)) = (mask.dimensions(), rgb.dimensions());
    ensure!(
        (width, height) == (across, down),
        "the mask has {width}×{height} pixels and its image {across}×{down}"
    );
    let covered = |colours: &[[u8; 3]]| {
        let level = |x, y| u8::from(colours.contains(&mask.get_pixel(x, y).0)) * 255;
        GrayImage::from_fn(width, height, |x, y| Luma([level(x, y)]))
    };
    // From above, paint may be all that is seen of the model.
    let paints = [("paint_rgb", &about.paint_rgb), ("object_rgb", &about.object_rgb)];
    let (key, paint_rgb) = paints[usize::from(about.paint_rgb.is_empty())];
    let paint = covered(paint_rgb);
    ensure!(
        paint.pixels().any(|p| p.0[0] > 0),
        "no pixel has a colour of {key}: name the model's colours in this mask, or take the frame out of poses.csv"
    );
    let parts: Vec<[u8; 3]> = about.object_rgb.iter().chain(&about.paint_rgb).copied().collect();
    Ok([covered(&parts), paint])
}
