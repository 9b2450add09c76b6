//! Frames in the layout of the FCA line of work: a `.npz` file a frame, with the image (`img`, height × width × 3, 8-bit BGR) and two poses
//! (`veh_trans`, `cam_trans`: x, y, z in metres, then pitch, yaw, roll in degrees).
//!
//! The poses are CARLA's ([`Transform`]), but the camera's place counts from the vehicle's origin along the *world's* axes; its angles are the
//! world's too. No masks come with the images: the mesh, drawn where the poses say, gives them.
//!
//! Such scripts write down the point that the vehicle was put at. CARLA lets it drop from there to the road before the image is taken, so
//! the model stands `drop_m` lower than `veh_trans` says, and the camera does not.

use std::path::{Path, PathBuf};

use image::RgbImage;

use super::carla::{Transform, pose};
use super::limits::{FIELDS_OF_VIEW_DEG, is_plain};
use super::npz::{Archive, Array};
use crate::drawn::{draw, paint_sides};
use crate::{Frame, FrameList, FramePaint, FramesError, Pinhole, Positions, encode_rgb, of_file};
use scaleproof_core::files::FileError;
use scaleproof_core::geometry::length::{SCALES, shown};
use scaleproof_core::message::{Message, ensure, message};
use scaleproof_core::workers;
use scaleproof_surface::mesh::Mesh;

/// Samples of the surface along each side of a pixel.
const FACTOR: u32 = 2;
/// Sides of an image, px.
const SIDES_PX: std::ops::RangeInclusive<u64> = 16..=2048;
/// All frames of a folder are held until they are written: some gigabytes.
const MOST_FRAMES: usize = 2000;
/// Possible drops before an image is taken.
const DROPS_M: std::ops::RangeInclusive<f64> = -10.0..=10.0;

/// Settings of an import of FCA's files.
#[derive(Debug, Clone)]
pub struct FcaRequest {
    pub mesh: Mesh,
    /// Indices of the materials that are the paint; all when empty.
    pub materials: Vec<usize>,
    /// The model is 1:`scale`; the poses are of the thing itself.
    pub scale: f64,
    /// Height by which the vehicle stands lower than `veh_trans` says.
    pub drop_m: f64,
    /// Horizontal.
    pub field_of_view_deg: f64,
    pub paint: FramePaint,
    /// The command that made the frames.
    pub made_by: String,
}

/// Imported frames that are not yet written: five images each, and the list.
pub struct FcaFrames {
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// The least z of `veh_trans`.
    pub lowest_vehicle_m: f64,
}

struct Shot {
    name: String,
    image: RgbImage,
    camera: Transform,
    vehicle: Transform,
}

/// Imports a folder: returns the list and the images, as files of `output`.
pub fn import(folder: &Path, output: &Path, request: &FcaRequest) -> Result<FcaFrames, FramesError> {
    check(request)?;
    let paths = archives(folder)?;
    let first = read(&paths[0])?;
    let sides = paint_sides(&request.mesh, &request.materials);
    let (_, high) = request.mesh.bounds_mm();
    let size_px = first.image.dimensions().into();
    let camera = Pinhole::with_field_of_view(size_px, request.field_of_view_deg);
    let positions = Positions::around(&request.mesh, FACTOR);
    let draw_car = |shot: &Shot| {
        ensure!(
            shot.image.dimensions() == first.image.dimensions(),
            "its image has another size than that of {}: frames have one camera",
            first.name
        );
        let mut stand = shot.vehicle;
        stand.place_m[2] -= request.drop_m;
        let mut pose = pose(&shot.camera, &stand);
        // At model scale.
        pose.translation.vector /= request.scale;
        let check = "check the poses of both, and the mesh's length and scale";
        let behind = || message!("part of the car is not before the camera: {check}");
        let drawn = draw(&request.mesh, &sides, &pose, &camera, size_px, FACTOR).ok_or_else(behind)?;
        let is_seen = drawn.object_mask.pixels().any(|p| p.0[0] > 0);
        ensure!(is_seen, "the car is not in the image: {check}");
        Ok((pose, drawn))
    };
    let work = |(): &mut (), path: &PathBuf| {
        let shot = read(path)?;
        let (pose, drawn) = draw_car(&shot).map_err(of_file(path))?;
        let shape = format!("masks/{}", shot.name);
        let frame = Frame {
            box_xyxy_px: drawn.box_xyxy_px,
            ..Frame::new(&shot.name, &shape, &pose, request.paint.clone())
        };
        let mut files = vec![(output.join(&frame.rgb), encode_rgb(&shot.image)?)];
        files.extend(drawn.files(output, &frame, &positions)?);
        Ok::<_, FramesError>((files, frame, shot.vehicle.place_m))
    };
    let done = workers::map(&paths, || Ok(()), work, || ())?;
    let mut list = FrameList {
        positions: Some(positions),
        ..FrameList::new(&request.made_by, size_px, camera, [0.0, 0.0, 0.5 * high.z])
    };
    let (mut new, mut stands) = (Vec::new(), Vec::new());
    for (files, mut frame, stand) in done {
        new.extend(files);
        // Frames around one stand of the vehicle are not independent.
        let number = stands.iter().position(|known| *known == stand).unwrap_or(stands.len());
        if number == stands.len() {
            stands.push(stand);
        }
        frame.place = format!("place{}", number + 1);
        frame.light.clone_from(&frame.place);
        list.frames.push(frame);
    }
    new.push(list.to_file(output)?);
    Ok(FcaFrames {
        files: new,
        lowest_vehicle_m: stands.iter().map(|stand| stand[2]).fold(f64::INFINITY, f64::min),
    })
}

fn check(request: &FcaRequest) -> Result<(), Message> {
    let (angle, drop_m, scale) = (request.field_of_view_deg, request.drop_m, request.scale);
    ensure!(
        FIELDS_OF_VIEW_DEG.contains(&angle),
        "the field of view cannot be {}°; give the horizontal one, from 1 to 170",
        shown(angle)
    );
    ensure!(
        DROPS_M.contains(&drop_m),
        "the car cannot have dropped by {} m; give a height from -10 to 10 m",
        shown(drop_m)
    );
    ensure!(
        SCALES.contains(&scale),
        "the scale cannot be {}; give 10 for a 1:10 model, from 0.01 to 10000",
        shown(scale)
    );
    Ok(())
}

/// Lists the `.npz` files of a folder, by name; at least one.
fn archives(folder: &Path) -> Result<Vec<PathBuf>, FramesError> {
    let failed = |e| FileError::read(folder, &e);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz")) {
            paths.push(path);
        }
    }
    paths.sort();
    let message = match paths.len() {
        0 => "it has no .npz files".to_owned(),
        1..=MOST_FRAMES => return Ok(paths),
        many => format!("it has {many} .npz files, and {MOST_FRAMES} are read at once: choose some"),
    };
    Err(FileError::content(folder, message).into())
}

fn read(path: &Path) -> Result<Shot, FramesError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if !is_plain(&name) {
        return Err(FileError::content(path, "its name may have letters, digits, '-', '_', '.' and '@' only").into());
    }
    let mut archive = Archive::open(path)?;
    let image = image(archive.array("img")?)?;
    let [vehicle, camera] = ["veh_trans", "cam_trans"].map(|name| transform(archive.array(name)?));
    let (vehicle, mut camera) = (vehicle?, camera?);
    for (place, from) in camera.place_m.iter_mut().zip(vehicle.place_m) {
        *place += from;
    }
    Ok(Shot {
        name,
        image,
        camera,
        vehicle,
    })
}

fn image(array: Array) -> Result<RgbImage, FramesError> {
    let (height, width) = match *array.shape() {
        [height, width, 3] if SIDES_PX.contains(&height) && SIDES_PX.contains(&width) => (height as u32, width as u32),
        _ => return Err(array.wrong_shape("height × width × 3, with sides of 16 to 2048 pixels")),
    };
    let is_damaged = array.wrong("is damaged: save it again");
    let bgr = array.numbers::<u8>("8-bit numbers")?;
    let mut image = RgbImage::from_raw(width, height, bgr).ok_or(is_damaged)?;
    image.pixels_mut().for_each(|pixel| pixel.0.reverse());
    Ok(image)
}

fn transform(array: Array) -> Result<Transform, FramesError> {
    if array.shape() != [2, 3] {
        return Err(array.wrong_shape("2×3: x, y, z, then pitch, yaw, roll"));
    }
    let not_finite = array.wrong("has a number that is not finite");
    let numbers = array.reals()?;
    let rows = <[[f64; 3]; 2]>::try_from(numbers.as_chunks::<3>().0).ok();
    let transform = rows.map(|[place_m, angles_deg]| Transform { place_m, angles_deg });
    transform.filter(Transform::is_finite).ok_or(not_finite)
}
