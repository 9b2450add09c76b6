//! Frames from photos of the real model in flat colours.
//!
//! Photos of one place and bin, one in each colour, are a view ([`views`]). Its frames have the camera of one of them, the reference,
//! without its lens distortion (`pinhole.rs`). The others come to it through the mesh: the surface point that a place of the frame shows is looked
//! up in the other photo, by that photo's own pose and lens, where it is seen there too ([`raster`](crate::raster)). So no tripod is needed. All this is computed in
//! linear light, as far as a photo tells of it: its tone curve is taken for sRGB's, and what it really is, the surrogate renderers fit. For that reason
//! these frames have no `linear` images.
//!
//! Outside the paint every frame of a view shows the reference photo. Paint that not every photo sees, or that lies so near to an edge that light
//! from beside it has strayed in, looks like the paint beside it in the same pixel. Where that pixel has none it is taken out of the mask, and looks
//! like the neighbours' paint, or else as in the reference photo.

pub mod contrast; // whether photos show the colours that they are said to show
mod draw; // the settings, and the images of one view
mod exposure; // a photo brought to the exposure of another
mod located; // located photos, and those that make no frames
mod pinhole; // the pinhole camera inside the images of a camera
pub mod sessions; // photos of sessions, located by their tags
mod views; // photos of one place and bin, one in each colour

pub use draw::{FACTOR, PhotoFramesRequest};
pub use located::{FlatPhoto, LeftOutPhoto, TagPaper};

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::drawn::paint_sides;
use crate::{Frame, FrameList, FramePaint, FramesError, Pinhole, Positions, encode_rgb, light};
use draw::Canvas;
use scaleproof_core::message::{ensure, message};
use scaleproof_core::workers;
use views::PhotosOfView;

/// View that became frames.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct FramedView {
    pub name: String,
    /// The photo that the others are mapped onto.
    pub reference: String,
    pub others: Vec<MappedPhoto>,
    /// Share of the paint that every photo of the view shows, 0 to 1.
    pub paint_seen_by_all: f64,
}

/// Photo of a view that is mapped onto its reference.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct MappedPhoto {
    pub photo: String,
    /// The angle between the two cameras.
    pub turn_deg: f64,
    /// By which its red, green and blue light are multiplied to have the exposure of the reference.
    pub light_factors: [f64; 3],
}

/// Frames from photos that are not yet written.
#[derive(Debug, Default)]
pub struct PhotoFrames {
    pub files: Vec<(PathBuf, Vec<u8>)>,
    pub frames: usize,
    pub views: Vec<FramedView>,
    pub left_out: Vec<LeftOutPhoto>,
}

/// Makes frames for a folder, without writing them; no files where no view has every colour. `on_view` is called after each view, with how many
/// there are; from any thread.
pub fn make(
    request: &PhotoFramesRequest,
    photos: &[FlatPhoto],
    folder: &Path,
    on_view: impl Fn(usize) + Sync,
) -> Result<PhotoFrames, FramesError> {
    let mut made = PhotoFrames::default();
    let Some(first) = photos.first() else {
        return Ok(made);
    };
    let size_px = pinhole::size_px(&first.camera, request.width_px);
    let (shared, photos, left_out) = common_pinhole(photos, size_px)?;
    let canvas = Canvas {
        request,
        size_px,
        pinhole: shared,
        sides: paint_sides(&request.mesh, &request.materials),
    };
    let has_paint = canvas.sides.iter().any(Option::is_some);
    ensure!(has_paint, "the mesh has no triangles of the paint's materials");
    let (views, without) = views::views(&photos, &request.flats, request.target_mm);
    made.left_out = left_out.into_iter().chain(without).collect();
    let (count, positions) = (views.len(), Positions::around(&request.mesh, FACTOR));
    let numbered: Vec<(usize, &PhotosOfView)> = views.iter().enumerate().collect();
    let draw =
        |(): &mut (), (number, view): &(usize, &PhotosOfView)| images(&canvas, *number, view, &positions, folder);
    let drawn = workers::map(&numbered, || Ok(()), draw, || on_view(count))?;
    let mut list = FrameList {
        positions: Some(positions),
        ..FrameList::new(&request.made_by, size_px, shared, request.target_mm.coords.into())
    };
    for (view, images) in views.iter().zip(drawn) {
        match images {
            Ok((files, frames, view)) => {
                made.files.extend(files);
                list.frames.extend(frames);
                made.views.push(view);
            }
            Err(reason) => made
                .left_out
                .push(LeftOutPhoto::new(view.reference.view_name(), reason)),
        }
    }
    made.frames = list.frames.len();
    if made.frames > 0 {
        made.files.push(list.to_file(folder)?);
    }
    Ok(made)
}

/// Finds the pinhole inside all cameras' images, and leaves out photos whose images are too different from the first one's.
fn common_pinhole(
    photos: &[FlatPhoto],
    size_px: [u32; 2],
) -> Result<(Pinhole, Vec<FlatPhoto>, Vec<LeftOutPhoto>), FramesError> {
    let [width, height] = size_px;
    let none = || {
        message!("no pinhole camera of {width}×{height} px lies inside the images of the camera; calibrate it again")
    };
    let mut shared = pinhole::inside(&photos[0].camera, size_px).ok_or_else(none)?;
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for photo in photos {
        match pinhole::longer(shared, &photo.camera, size_px) {
            Some(longer) => {
                shared = longer;
                kept.push(photo.clone());
            }
            None => {
                let reason = format!(
                    "its image shows too little of what {} shows: hold the camera the same way, and do not zoom",
                    photos[0].name()
                );
                left_out.push(LeftOutPhoto::new(photo.name(), reason));
            }
        }
    }
    Ok((shared, kept, left_out))
}

/// The files and frames of a view.
type Images = (Vec<(PathBuf, Vec<u8>)>, Vec<Frame>, FramedView);

/// Draws the frames of a view; the inner error is the reason why it has none.
fn images(
    canvas: &Canvas,
    number: usize,
    view: &PhotosOfView,
    positions: &Positions,
    folder: &Path,
) -> Result<Result<Images, &'static str>, FramesError> {
    let Some(drawn) = canvas.draw(view)? else {
        return Ok(Err("part of the model is behind a camera: step back"));
    };
    if drawn.kept == 0.0 {
        return Ok(Err("no paint is seen in every photo"));
    }
    let bin = &view.reference.bin;
    let (azimuth, pitch, distance) = (bin.azimuth_deg, bin.pitch_deg, bin.distance_mm);
    let name = format!("{number:03}_az{azimuth}_p{pitch}_d{distance}");
    let photos = std::iter::once(view.reference).chain(view.others.iter().map(|o| o.photo));
    let mut coloured: Vec<(&FlatPhoto, &image::RgbImage)> = photos.zip(&drawn.images).collect();
    let shown: Vec<_> = coloured.iter().map(|(photo, image)| (photo.flat_rgb, *image)).collect();
    if !contrast::is_in_order(&shown, &drawn.shape.paint_mask) {
        return Ok(Err(
            "a lighter colour looks no lighter than a darker one: give each variant its colour, and check that each photo is of its variant",
        ));
    }
    // The frames stand in the order of the colours, whichever is the reference.
    coloured.sort_by_key(|(photo, _)| canvas.request.flats.iter().position(|rgb| *rgb == photo.flat_rgb));
    let (mut frames, mut files) = (Vec::new(), Vec::new());
    for (photo, image) in coloured {
        let paint = FramePaint::FlatRgb(photo.flat_rgb);
        let coloured = format!("{name}_{}", light::to_hex(photo.flat_rgb));
        let frame = Frame {
            light: view.reference.place.clone(),
            place: view.reference.place.clone(),
            box_xyxy_px: drawn.shape.box_xyxy_px,
            ..Frame::new(&coloured, &format!("views/{name}"), &view.reference.pose, paint)
        };
        if files.is_empty() {
            files = drawn.shape.files(folder, &frame, positions)?;
        }
        files.push((folder.join(&frame.rgb), encode_rgb(image)?));
        frames.push(frame);
    }
    let others = view.others.iter().map(|other| MappedPhoto {
        photo: other.photo.name(),
        turn_deg: other.turn_deg,
        light_factors: other.gain,
    });
    let view = FramedView {
        name: view.reference.view_name(),
        reference: view.reference.name(),
        others: others.collect(),
        paint_seen_by_all: drawn.kept,
    };
    Ok(Ok((files, frames, view)))
}
