//! Reading frames: the list is checked at once, images when they are read.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use image::{ColorType, RgbImage};
use nalgebra::{Matrix3, Point3};

use crate::images::{Coverage, read_png};
use crate::{FORMAT, Frame, FrameList, FramePaint, FramesError, LIST, of_file, views};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, bail, ensure, message};
use scaleproof_core::statistics::upper_median;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::world_aligned::Side;

/// Largest side of an image, px.
const MAX_SIDE_PX: u32 = 8192;
/// Largest focal length and coordinate of the principal point, px.
const MAX_CAMERA_PX: f64 = 1e6;
/// Largest coordinate of a camera, mm.
const MAX_DISTANCE_MM: f64 = 1e8;
/// Largest median error of the projected points, px: they are stored to a fraction of a millimetre, at the centres of parts of pixels.
const MOST_OFF_PX: f64 = 1.0;
/// Tolerance of a rotation's orthonormality.
const RIGID_TOLERANCE: f64 = 1e-4;

/// Frames of one camera, without their pixels.
#[derive(Debug, Clone)]
pub struct FrameSet {
    /// The folder of `frames.json`.
    pub folder: PathBuf,
    /// The content of `frames.json`.
    pub list: FrameList,
    /// SHA-256 of `frames.json` when the set was opened.
    pub sha256: String,
}

/// The paint at one point of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Model frame; without meaning where there is no paint.
    pub place_mm: [f64; 3],
    /// The side the paint belongs to; `None` where there is no paint.
    pub side: Option<Side>,
}

impl FrameSet {
    /// Opens the frames in a folder and checks all but the images.
    pub fn open(folder: &Path) -> Result<Self, FramesError> {
        let path = folder.join(LIST);
        let text = files::read_text(&path)?;
        let list: FrameList = serde_json::from_str(&text).map_err(|e| syntax(&path, &e))?;
        let set = Self {
            folder: folder.to_owned(),
            list,
            sha256: files::sha256_hex(text.as_bytes()),
        };
        check(&set).map_err(of_file(&path))?;
        Ok(set)
    }

    /// Opens several folders of frames, none of them twice: its views would count twice, and intervals be too narrow.
    pub fn open_all<'a>(folders: impl IntoIterator<Item = &'a PathBuf>) -> Result<Vec<Self>, FramesError> {
        let mut opened = Vec::<Self>::new();
        for folder in folders {
            let set = Self::open(folder)?;
            if let Some(same) = opened.iter().find(|known| known.sha256 == set.sha256) {
                let (first, again) = (same.folder.display(), set.folder.display());
                bail!("{first} and {again} are the same frames: name them once");
            }
            opened.push(set);
        }
        Ok(opened)
    }

    /// Counts the views (poses at a place).
    pub fn view_count(&self) -> usize {
        views(&self.list.frames).len()
    }

    /// Reads the image of a frame, 8-bit sRGB.
    pub fn rgb(&self, frame: &Frame) -> Result<RgbImage, FramesError> {
        Ok(self.image(&frame.rgb, "rgb image", ColorType::Rgb8)?.into_rgb8())
    }

    /// Reads how much of each pixel the model covers.
    pub fn object_mask(&self, frame: &Frame) -> Result<Coverage, FramesError> {
        self.coverage(&frame.object_mask, "object mask")
    }

    /// Reads how much of each pixel the paint covers.
    pub fn paint_mask(&self, frame: &Frame) -> Result<Coverage, FramesError> {
        self.coverage(&frame.paint_mask, "paint mask")
    }

    /// Reads the image in linear light, row by row; `None` where the frame has none.
    pub fn linear(&self, frame: &Frame) -> Result<Option<Vec<[f32; 3]>>, FramesError> {
        let (Some(file), Some(max)) = (&frame.linear, self.list.linear_max) else {
            return Ok(None);
        };
        let image = self.image(file, "linear image", ColorType::Rgb16)?.into_rgb16();
        let value = |level: u16| (f64::from(level) / 65535.0 * max) as f32;
        Ok(Some(image.pixels().map(|p| p.0.map(value)).collect()))
    }

    /// Reads the surface point at the centre of each part of each pixel, row by row of the finer image; `None` for a frame without positions.
    pub fn surface(&self, frame: &Frame) -> Result<Option<Vec<SurfacePoint>>, FramesError> {
        let (Some(file), Some(sides), Some(about)) = (&frame.positions, &frame.sides, &self.list.positions) else {
            return Ok(None);
        };
        let size = self.list.size_px.map(|px| px * about.factor);
        let at = |file: &String| self.folder.join(file);
        let positions = read_png(&at(file), "positions image", size, ColorType::Rgb16)?.into_rgb16();
        let image = read_png(&at(sides), "sides image", size, ColorType::L8)?.into_luma8();
        if image.pixels().any(|p| usize::from(p.0[0]) > Side::ALL.len()) {
            let message = "a side is above 6; sides are 0 for no paint and 1 to 6: make the frame again";
            return Err(FileError::content(&at(sides), message).into());
        }
        let place = |p: [u16; 3]| {
            std::array::from_fn(|i| {
                let share = f64::from(p[i]) / 65535.0;
                about.low_mm[i] + share * (about.high_mm[i] - about.low_mm[i])
            })
        };
        let side = |number: u8| Side::ALL.get(usize::from(number).checked_sub(1)?).copied();
        let point = |(p, number): (&image::Rgb<u16>, &image::Luma<u8>)| SurfacePoint {
            place_mm: place(p.0),
            side: side(number.0[0]),
        };
        let points: Vec<SurfacePoint> = positions.pixels().zip(image.pixels()).map(point).collect();
        if let Some(off_px) = median_off_px(&self.list, frame, &points, about.factor).filter(|off| *off > MOST_OFF_PX) {
            let message = format!(
                "its points lie {off_px:.0} px from where the camera of frame {} sees them: the image, the pose, the camera or the positions' \
                 low_mm and high_mm are of other frames",
                frame.name
            );
            return Err(FileError::content(&at(file), message).into());
        }
        Ok(Some(points))
    }

    /// Reads the pattern on the model, with the width of one repeat in mm; `None` for another paint.
    pub fn pattern(&self, frame: &Frame) -> Result<Option<(Pattern, f64)>, FramesError> {
        match &frame.paint {
            FramePaint::Pattern { file, tile_mm } => Ok(Some((Pattern::load(&self.folder.join(file))?, *tile_mm))),
            _ => Ok(None),
        }
    }

    /// Checks every image of a frame: that it can be read, that there is paint and none outside the object, and that the object meets its box.
    pub fn check_images(&self, frame: &Frame) -> Result<(), FramesError> {
        self.rgb(frame)?;
        self.linear(frame)?;
        self.surface(frame)?;
        self.pattern(frame)?;
        let (object, paint) = (self.object_mask(frame)?, self.paint_mask(frame)?);
        let content = |file: &String, message: &str| FileError::content(&self.folder.join(file), message);
        // Coverage is sampled, so that the two may differ by a few hundredths.
        let is_outside =
            |(x, y, p): &(u32, u32, &image::Luma<u8>)| p.0[0] > object.get_pixel(*x, *y).0[0].saturating_add(16);
        if let Some((x, y, _)) = paint.enumerate_pixels().find(is_outside) {
            let message =
                format!("the paint at column {x}, row {y} is outside the object: one of the masks is of another frame");
            return Err(content(&frame.paint_mask, &message).into());
        }
        if paint.pixels().all(|p| p.0[0] == 0) {
            return Err(content(&frame.paint_mask, "no paint is seen: take the frame out of the list").into());
        }
        let both = frame.box_xyxy_px.zip(outline(&object));
        if both.is_some_and(|(stated, seen)| stated.iou(&seen) == 0.0) {
            let message = "the object does not meet the frame's box_xyxy_px: one of them is of another frame";
            return Err(content(&frame.object_mask, message).into());
        }
        Ok(())
    }

    fn coverage(&self, file: &str, key: &str) -> Result<Coverage, FramesError> {
        Ok(self.image(file, key, ColorType::L8)?.into_luma8())
    }

    fn image(&self, file: &str, key: &str, kind: ColorType) -> Result<image::DynamicImage, FramesError> {
        read_png(&self.folder.join(file), key, self.list.size_px, kind)
    }
}

/// Returns the box around what is covered by half or more, in the convention of pixel centres; `None` when nothing is.
pub fn outline(mask: &Coverage) -> Option<BoxPx> {
    let covered = mask.enumerate_pixels().filter(|(_, _, p)| p.0[0] >= 128);
    BoxPx::around(covered.flat_map(|(x, y, _)| {
        let (x, y) = (f64::from(x), f64::from(y));
        [[x - 0.5, y - 0.5], [x + 0.5, y + 0.5]]
    }))
}

/// Converts serde's error to one sentence with the line.
pub fn syntax(path: &Path, e: &serde_json::Error) -> FileError {
    let text = e.to_string();
    let message = match text.split(" at line ").next().unwrap_or(&text) {
        inside if inside.contains("expected struct") => "an object {…} belongs here",
        message => message,
    };
    FileError::syntax(path, e.line(), message.to_owned())
}

/// Returns the median reprojection error of the points of the paint, px; that of a point behind the camera is infinite. `None` without any paint.
/// `points`: row by row of the image, `factor` times as fine along each side.
fn median_off_px(list: &FrameList, frame: &Frame, points: &[SurfacePoint], factor: u32) -> Option<f64> {
    let (camera, pose) = (list.camera(), frame.pose());
    let (width, factor) = ((list.size_px[0] * factor) as usize, f64::from(factor));
    let off = |i: usize, point: &SurfacePoint| {
        let projected = camera.project(&(pose * Point3::from(point.place_mm)));
        let [x, y] = [i % width, i / width].map(|v| (v as f64 + 0.5) / factor - 0.5);
        projected.map_or(f64::INFINITY, |[u, v]| (u - x).hypot(v - y))
    };
    let painted = points.iter().enumerate().filter(|(_, point)| point.side.is_some());
    let all: Vec<f64> = painted.map(|(i, point)| off(i, point)).collect();
    upper_median(&all)
}

fn check(set: &FrameSet) -> Result<(), Message> {
    let list = &set.list;
    let format = &list.format;
    ensure!(
        format == FORMAT,
        "the format is '{format}', and this program reads '{FORMAT}'"
    );
    let is_size = list.size_px.iter().all(|px| (1..=MAX_SIDE_PX).contains(px));
    ensure!(is_size, "size_px must be 1 to {MAX_SIDE_PX} along both sides");
    let camera = &list.camera;
    let numbers = [camera.focal_length_px, camera.centre_px[0], camera.centre_px[1]];
    let is_camera = camera.focal_length_px > 0.0 && numbers.iter().all(|v| v.abs() <= MAX_CAMERA_PX);
    ensure!(
        is_camera,
        "the camera's focal_length_px must be above 0, and neither it nor its centre_px beyond {MAX_CAMERA_PX}"
    );
    let is_light = list.linear_max.is_none_or(|max| max > 0.0 && max.is_finite());
    ensure!(is_light, "linear_max must be above 0");
    if let Some(about) = &list.positions {
        let grows =
            (0..3).all(|i| about.high_mm[i] > about.low_mm[i] && (about.high_mm[i] - about.low_mm[i]).is_finite());
        let most = MAX_SIDE_PX / list.size_px[0].max(list.size_px[1]);
        let is_range = grows && (1..=most).contains(&about.factor);
        ensure!(
            is_range,
            "positions must have a high_mm above its low_mm and a factor of 1 to {most}"
        );
    }
    ensure!(!list.frames.is_empty(), "it lists no frames");
    let mut names = HashSet::new();
    for frame in &list.frames {
        let name = &frame.name;
        ensure!(names.insert(name), "the frame {name} is listed twice");
        check_frame(set, frame).map_err(|problem| message!("frame {name}: {problem}"))?;
    }
    Ok(())
}

fn check_frame(set: &FrameSet, frame: &Frame) -> Result<(), Message> {
    for (key, file) in frame.files() {
        let mut parts = Path::new(file).components();
        let is_below = !file.is_empty() && parts.all(|part| matches!(part, Component::Normal(_)));
        ensure!(is_below, "{key} '{file}' is not a path below the folder of the frames");
        let is_there = set.folder.join(file).is_file();
        ensure!(
            is_there,
            "{key} '{file}' is not there: make the frame again, or take it out of the list"
        );
    }
    let [width, height] = set.list.size_px.map(f64::from);
    let in_image = |b: BoxPx| b.clipped(width, height).is_solid();
    let has_max = frame.linear.is_none() || set.list.linear_max.is_some();
    ensure!(has_max, "it has a linear image, but the list has no linear_max");
    let both = frame.positions.is_some() == frame.sides.is_some();
    ensure!(both, "positions and sides belong together: give both or neither");
    let has_bounds = frame.positions.is_none() || set.list.positions.is_some();
    ensure!(
        has_bounds,
        "it has positions, but the list does not say what their values mean"
    );
    if let FramePaint::Pattern { tile_mm, .. } = frame.paint {
        let is_width = tile_mm > 0.0 && tile_mm.is_finite();
        ensure!(is_width, "the tile_mm of its pattern must be above 0");
    }
    let is_solid = frame.box_xyxy_px.is_none_or(|b| b.is_solid());
    ensure!(is_solid, "its box_xyxy_px is empty: give [x1, y1, x2, y2] in pixels");
    let is_inside = frame.box_xyxy_px.is_none_or(in_image);
    ensure!(
        is_inside,
        "its box_xyxy_px lies outside the image: give it in pixels of the image"
    );
    let is_pose = is_pose(&frame.t_camera_model);
    ensure!(
        is_pose,
        "its T_camera_model is no rotation and translation: give a 4×4 matrix, row by row, mm"
    );
    Ok(())
}

/// Returns true for a matrix that is a rotation and a possible translation.
fn is_pose(rows: &[[f64; 4]; 4]) -> bool {
    let rotation = Matrix3::from_fn(|r, c| rows[r][c]);
    let off = (rotation * rotation.transpose() - Matrix3::identity()).abs().max();
    off < RIGID_TOLERANCE
        && rotation.determinant() > 0.0
        && rows.iter().flatten().all(|v| v.abs() <= MAX_DISTANCE_MM)
        && rows[3] == [0.0, 0.0, 0.0, 1.0]
}
