//! The plan of a render: every decision is made here, so that it can be tested without Blender.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use nalgebra::Point3;
use serde_json::{Value, json};

use super::Panorama;
use super::blender::work_folder;
use super::request::{RenderPaint, RenderRequest, absolute};
use crate::drawn::{clip_box, paint_sides, side_number};
use crate::{Frame, FrameList, FramesError, Pinhole, Positions, light};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::rigid::{self, Rigid};
use scaleproof_core::message::{Message, bail, ensure, message};
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::simulate::looking_at;
use scaleproof_surface::mesh::doubled_area;

/// The linear light that the highest level of a linear image stands for: two stops above white.
pub(super) const LINEAR_MAX: f64 = 4.0;
/// Most reflections of a light path.
const BOUNCES: u32 = 4;

/// Plan of a render, checked.
#[derive(Debug, Clone)]
pub struct RenderPlan {
    request: RenderRequest,
    mesh_sha256: String,
    /// SHA-256 of each light's file; `None` for Blender's own lights.
    lights_sha256: Vec<Option<String>>,
    target_mm: Point3<f64>,
    /// The paint's triangles, as the script gets them.
    surface: Value,
    /// Indices of the mesh's triangles in `surface`.
    surface_triangles: Vec<usize>,
}

/// Frame of a plan, as indices into the request.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedFrame {
    pub light: usize,
    pub viewpoint: usize,
    pub colour: usize,
}

/// Images that are still to be rendered.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Missing {
    pub frames: Vec<PlannedFrame>,
    /// Viewpoints without their masks and positions.
    pub viewpoints: Vec<usize>,
}

impl Missing {
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.viewpoints.is_empty()
    }
}

impl RenderPlan {
    pub fn new(request: RenderRequest) -> Result<Self, FramesError> {
        check(&request)?;
        let hash = |file: &Path| files::read(file).map(|bytes| files::sha256_hex(&bytes));
        let mesh_sha256 = hash(&request.mesh_file)?;
        let of_light = |light: &Panorama| light.file.as_deref().map(hash).transpose();
        let lights_sha256 = request.lights.iter().map(of_light).collect::<Result<_, _>>()?;
        let (low, high) = request.mesh.bounds_mm();
        let target_mm = Point3::new(0.0, 0.0, 0.5 * high.z);
        for view in &request.viewpoints {
            let centre = view.camera_centre_mm(target_mm);
            let is_inside = (0..3).all(|i| centre[i] > low[i] && centre[i] < high[i]);
            ensure!(
                !is_inside && centre.z > 0.0,
                "the camera at {} is not above the ground and outside the model; move it away",
                in_words(view)
            );
        }
        let (surface, surface_triangles) = surface(&request)?;
        let plan = Self {
            request,
            mesh_sha256,
            lights_sha256,
            target_mm,
            surface,
            surface_triangles,
        };
        let mut names: Vec<String> = plan.frames().iter().map(|f| plan.frame_name(f)).collect();
        names.sort();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => bail!(
                "the frame {} would be rendered twice; give each light, viewpoint and paint once",
                pair[0]
            ),
            None => Ok(plan),
        }
    }

    /// Lists every frame, those of one view together.
    pub fn frames(&self) -> Vec<PlannedFrame> {
        let frames = self.views().flat_map(|(light, viewpoint)| {
            (0..self.request.colours.len()).map(move |colour| PlannedFrame {
                light,
                viewpoint,
                colour,
            })
        });
        frames.collect()
    }

    /// Lists every viewpoint under every light, as indices.
    fn views(&self) -> impl Iterator<Item = (usize, usize)> {
        let viewpoints = self.request.viewpoints.len();
        (0..self.request.lights.len()).flat_map(move |light| (0..viewpoints).map(move |viewpoint| (light, viewpoint)))
    }

    pub fn everything(&self) -> Missing {
        Missing {
            frames: self.frames(),
            viewpoints: (0..self.request.viewpoints.len()).collect(),
        }
    }

    /// Returns the meaning of the values of `positions` images.
    pub(super) fn positions(&self) -> Positions {
        Positions::around(&self.request.mesh, self.request.factor)
    }

    pub fn view_name(&self, viewpoint: usize) -> String {
        let v = &self.request.viewpoints[viewpoint];
        format!("az{}_p{}_d{}", v.azimuth_deg, v.pitch_deg, v.distance_mm)
    }

    pub fn frame_name(&self, frame: &PlannedFrame) -> String {
        let light = self.request.lights[frame.light].place();
        let colour = self.request.colours[frame.colour].name();
        format!("{light}_{}_{colour}", self.view_name(frame.viewpoint))
    }

    fn pose(&self, viewpoint: usize) -> Rigid {
        looking_at(&self.request.viewpoints[viewpoint], self.target_mm)
    }

    fn pinhole(&self) -> Pinhole {
        Pinhole::with_field_of_view(self.request.size_px, self.request.field_of_view_deg)
    }

    /// Returns all that decides about the pixels: two plans of one identity render the same.
    pub fn identity(&self) -> String {
        let mut identity = self.view_identity();
        identity["paints"] = self.request.colours.iter().map(RenderPaint::identity).collect();
        format!("{identity:#}\n")
    }

    /// Returns all that decides about the pixels besides the paints.
    pub fn view_identity(&self) -> Value {
        let r = &self.request;
        json!({
            "scaleproof": env!("CARGO_PKG_VERSION"),
            "script_sha256": files::sha256_hex(super::blender::SCRIPT.as_bytes()),
            "mesh_sha256": self.mesh_sha256,
            "surface_sha256": files::sha256_hex(self.surface.to_string().as_bytes()),
            "lights": r.lights.iter().map(Panorama::place).collect::<Vec<_>>(),
            "lights_sha256": self.lights_sha256,
            "viewpoints": r.viewpoints,
            "size_px": r.size_px,
            "field_of_view_deg": r.field_of_view_deg,
            "roughness": r.roughness,
            "samples": r.samples,
            "denoise": r.denoise,
            "seed": r.seed,
            "positions_factor": r.factor,
        })
    }

    /// Encodes the patterns and textures, as files below the folder of the frames.
    pub fn pattern_files(&self, folder: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>, FramesError> {
        let stored = self.request.colours.iter().map(RenderPaint::stored);
        let stored = stored.filter_map(Result::transpose);
        stored
            .map(|file| file.map(|(name, png)| (folder.join(name), png)))
            .collect()
    }

    /// Returns the input of `render_frames.py`: only what is missing in the folder.
    pub fn to_script(&self, missing: &Missing, folder: &Path) -> Value {
        let r = &self.request;
        let colour = |c: &RenderPaint| (c.name(), c.to_script(&self.surface_triangles, folder));
        let lights = r.lights.iter().map(|l| {
            let file = l.file.as_deref().map(absolute);
            (l.place(), json!({"name": l.name, "file": file, "turn_deg": l.turn_deg}))
        });
        let view = |(light, viewpoint): (usize, usize)| {
            let is_of_view = |f: &&PlannedFrame| (f.light, f.viewpoint) == (light, viewpoint);
            let frame = |f: &PlannedFrame| json!({"name": self.frame_name(f), "paint": r.colours[f.colour].name()});
            let frames: Vec<Value> = missing.frames.iter().filter(is_of_view).map(frame).collect();
            // The shape is the same under every light: it comes with the first.
            let needs_geometry = light == 0 && missing.viewpoints.contains(&viewpoint);
            (needs_geometry || !frames.is_empty()).then(|| {
                json!({
                    "name": self.view_name(viewpoint),
                    "light": r.lights[light].place(),
                    "T_model_camera": rigid::rows(&self.pose(viewpoint).inverse()),
                    "needs_geometry": needs_geometry,
                    "frames": frames,
                })
            })
        };
        let (low, high) = r.mesh.bounds_mm();
        let turn: Vec<[f64; 3]> = (0..3).map(|i| std::array::from_fn(|j| r.turn[(i, j)])).collect();
        json!({
            "mesh": absolute(&r.mesh_file),
            "turn_rows": turn,
            "bounds_mm": [<[f64; 3]>::from(low.coords), <[f64; 3]>::from(high.coords)],
            "paint_surface": self.surface,
            "width_px": r.size_px[0],
            "height_px": r.size_px[1],
            "focal_length_px": self.pinhole().focal_length_px,
            "roughness": r.roughness,
            "samples": r.samples,
            "denoise": r.denoise,
            "seed": r.seed,
            "bounces": BOUNCES,
            "threads": r.threads,
            "geometry_factor": r.factor,
            "lights": lights.collect::<serde_json::Map<_, _>>(),
            "paints": r.colours.iter().map(colour).collect::<serde_json::Map<_, _>>(),
            "views": self.views().filter_map(view).collect::<Vec<_>>(),
            // Linear light of the levels of 8-bit images.
            "levels": (0..=u8::MAX).map(|v| light::decode(f64::from(v) / 255.0)).collect::<Vec<_>>(),
            "raw": absolute(&work_folder(folder)),
        })
    }

    pub fn list(&self) -> FrameList {
        let r = &self.request;
        let mut list = FrameList {
            linear_max: Some(LINEAR_MAX),
            positions: Some(self.positions()),
            ..FrameList::new(&r.made_by, r.size_px, self.pinhole(), self.target_mm.coords.into())
        };
        // The boxes of the whole mesh, exactly: of its projected corners, clipped to the image.
        let outline = |viewpoint| clip_box(&self.projected(viewpoint)?, r.size_px);
        let boxes: Vec<Option<BoxPx>> = (0..r.viewpoints.len()).map(outline).collect();
        let frame = |frame: PlannedFrame| {
            let name = self.frame_name(&frame);
            let shape = format!("views/{}", self.view_name(frame.viewpoint));
            let (pose, paint) = (self.pose(frame.viewpoint), r.colours[frame.colour].paint());
            Frame {
                linear: Some(format!("linear/{name}.png")),
                light: r.lights[frame.light].name.clone(),
                place: r.lights[frame.light].place(),
                box_xyxy_px: boxes[frame.viewpoint],
                ..Frame::new(&name, &shape, &pose, paint)
            }
        };
        list.frames = self.frames().into_iter().map(frame).collect();
        list
    }

    /// Returns the box around the mesh's projected corners, pixel (0, 0) is the centre of the top-left pixel; `None` when a corner is not before
    /// the camera.
    fn projected(&self, viewpoint: usize) -> Option<BoxPx> {
        let (camera, pose) = (self.pinhole().camera(self.request.size_px), self.pose(viewpoint));
        let mesh = &self.request.mesh;
        let corners = mesh.triangles().iter().flat_map(|t| mesh.corners_mm(t));
        let seen: Option<Vec<[f64; 2]>> = corners.map(|p| camera.project(&(pose * p))).collect();
        BoxPx::around(seen?)
    }

    /// Returns the box of the whole mesh as scoring counts, from the corner of the top-left pixel.
    pub fn truth(&self, viewpoint: usize) -> Result<BoxPx, Message> {
        let [width, height] = self.request.size_px.map(f64::from);
        let whole = self
            .projected(viewpoint)
            .map(|b| BoxPx::new(b.x1 + 0.5, b.y1 + 0.5, b.x2 + 0.5, b.y2 + 0.5));
        let cut_off = || {
            message!(
                "the model is not whole in the image at {}, so it would be judged by a part; move the camera away, or widen the field of view",
                in_words(&self.request.viewpoints[viewpoint])
            )
            .hint("‹field_of_view_deg› widens it")
        };
        whole.filter(|b| *b == b.clipped(width, height)).ok_or_else(cut_off)
    }

    pub fn request(&self) -> &RenderRequest {
        &self.request
    }
}

/// Returns a viewpoint as part of a sentence.
fn in_words(viewpoint: &Viewpoint) -> String {
    let v = viewpoint;
    format!(
        "azimuth {}°, pitch {}°, {} mm",
        v.azimuth_deg, v.pitch_deg, v.distance_mm
    )
}

fn check(request: &RenderRequest) -> Result<(), Message> {
    let nothing = [
        (request.lights.is_empty(), "light"),
        (request.viewpoints.is_empty(), "viewpoint"),
        (request.colours.is_empty(), "flat colour, pattern or texture"),
    ];
    for (is_missing, what) in nothing {
        ensure!(!is_missing, "nothing to render: give at least one {what}");
    }
    let number = |what: &str, value: f64, wanted: &str, is_fine: bool| {
        ensure!(is_fine, "{what} cannot be {value}; give {wanted}");
        Ok::<(), Message>(())
    };
    let within = |what: &str, value: f64, range: RangeInclusive<f64>, wanted: &str| {
        number(what, value, wanted, range.contains(&value))
    };
    for px in request.size_px {
        within("a side of the frames", px.into(), 16.0..=2048.0, "16 to 2048 px")?;
    }
    let (fov, samples, factor) = (request.field_of_view_deg, request.samples, request.factor);
    within("the field of view", fov, 5.0..=120.0, "5 to 120 degrees")?;
    within("the roughness", request.roughness, 0.0..=1.0, "0 to 1")?;
    within("samples", samples.into(), 1.0..=65536.0, "1 to 65536")?;
    let wanted = "1 to 8 along a side";
    within("the positions in a pixel", factor.into(), 1.0..=8.0, wanted)?;
    for view in &request.viewpoints {
        let wanted = "an angle from -89.9 to 89.9 degrees: straight from above no side of the image is up";
        within("a pitch", view.pitch_deg, -89.9..=89.9, wanted)?;
        let is_possible = view.is_possible() && view.distance_mm <= 1e6;
        let wanted = "a distance above 0 and up to 1000000 mm";
        number("a distance", view.distance_mm, wanted, is_possible)?;
    }
    for colour in &request.colours {
        if let RenderPaint::Pattern(name, ..) | RenderPaint::Texture(name, _) = colour
            // Names become file names, lines of what Blender says, and names of its outputs, in which # stands for digits.
            && (name.trim() != name || name.is_empty() || name.chars().any(|c| c.is_control() || "/\\#".contains(c)))
        {
            bail!("a pattern or texture cannot be called {name:?}; rename its file to plain letters and digits");
        }
        if let RenderPaint::Pattern(_, _, tile) = colour {
            let wanted = "its width on the model, above 0 and up to 100000 mm";
            number("a tile", *tile, wanted, *tile > 0.0 && *tile <= 1e5)?;
        }
    }
    Ok(())
}

/// Lists the paint's triangles with the side and the place in the pattern of each corner, in repeats, as the printed panels have them
/// ([`Side`](scaleproof_surface::pattern::world_aligned::Side)); and which triangles of the mesh these are. Those without area show nothing and are
/// left out.
fn surface(request: &RenderRequest) -> Result<(Value, Vec<usize>), Message> {
    let mesh = &request.mesh;
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut index = std::collections::HashMap::new();
    let (mut triangles, mut sides, mut uv_mm, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, side) in paint_sides(mesh, &request.materials).into_iter().enumerate() {
        let triangle = &mesh.triangles()[i];
        let corners = mesh.corners_mm(triangle);
        let Some(side) = side.filter(|_| doubled_area(&corners).norm() >= 1e-9) else {
            continue;
        };
        indices.push(i);
        sides.push(side_number(side));
        uv_mm.push(corners.map(|p| side.project(&p)));
        triangles.push(std::array::from_fn::<usize, 3, _>(|i| {
            *index.entry(triangle.corners[i]).or_insert_with(|| {
                points.push(corners[i].coords.into());
                points.len() - 1
            })
        }));
    }
    ensure!(
        !triangles.is_empty(),
        "the mesh has no triangles of the paint's materials"
    );
    let surface = json!({"points_mm": points, "triangles": triangles, "sides": sides, "uv_mm": uv_mm});
    Ok((surface, indices))
}
