//! Frames from photos: a session that the test renders itself (two boxes on a ground with tags, lens distortion, another exposure for every
//! photo) against direct renders from the reference's true pose; what the rasteriser sees against Blender; refusals.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;

use common::{assert_refused, home, program, read_json, shared, stderr, stdout};
use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};
use scaleproof_core::geometry::Rigid;
use scaleproof_frames::light;
use scaleproof_frames::raster::Raster;
use scaleproof_frames::surrogate::projection::{Grid, world};
use scaleproof_frames::surrogate::renderer::{ClosedForm, FlatImage, PerPixel, Renderer};
use scaleproof_frames::views;
use scaleproof_frames::{Frame, FrameSet, Pinhole};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, TagFamily, Viewpoint};
use scaleproof_pose::simulate::looking_at;
use scaleproof_pose::tags::TagImage;
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use scaleproof_surface::pattern::world_aligned::Side;

const BLACK: [u8; 3] = [0x20, 0x20, 0x20];
const GREY: [u8; 3] = [0x80, 0x80, 0x80];
const WHITE: [u8; 3] = [0xe6, 0xe6, 0xe6];
/// Lowest and highest corner: the painted body, and a dark cabin upon it.
const BODY: [[f64; 3]; 2] = [[-200.0, -90.0, 0.0], [200.0, 90.0, 70.0]];
const CABIN: [[f64; 3]; 2] = [[-100.0, -80.0, 70.0], [100.0, 80.0, 120.0]];
const TAGS: u32 = 10;

/// The tags, flat in a ring around the model.
fn scene_text(model: &str) -> String {
    let mut text = format!(
        "[model]\nname = \"boxes\"\nscale = 10\nclass = \"car\"\nsize_mm = [400, 180, 120]\n{model}\n\n\
         [bins]\nazimuth_deg = 45\npitch_deg = [35]\ndistance_mm = [900]\n"
    );
    for id in 0..TAGS {
        let angle = std::f64::consts::TAU * (f64::from(id) + 0.3) / f64::from(TAGS);
        let (sin, cos) = angle.sin_cos();
        text += &format!(
            "\n[[tag]]\nid = {id}\nsize_mm = 70\ncentre_mm = [{}, {}, 0]\nright = [{}, {cos}, 0]\nup = [{}, {}, 0]\n",
            320.0 * cos,
            290.0 * sin,
            -sin,
            -cos,
            -sin
        );
    }
    text
}

const MESH: &str = "envelope = \"mesh\"\nmesh = \"boxes.obj\"";

/// Distortion as a wide phone lens has it.
fn camera() -> Camera {
    Camera::pinhole(960, 720, 820.0, 822.0, 473.0, 365.0).with_distortion(&[-0.12, 0.03, 0.001, -0.0005, 0.0])
}

fn camera_yaml() -> String {
    let c = camera();
    let [k1, k2, p1, p2, k3, ..] = c.distortion() else {
        panic!("no eight coefficients")
    };
    format!(
        "image_width: {}\nimage_height: {}\ncamera_matrix: {{rows: 3, cols: 3, data: [{}, 0, {}, 0, {}, {}, 0, 0, 1]}}\n\
         distortion_coefficients: {{rows: 1, cols: 5, data: [{k1}, {k2}, {p1}, {p2}, {k3}]}}\n",
        c.width, c.height, c.fx, c.cx, c.fy, c.cy
    )
}

/// Both boxes as an OBJ, without the face that lies between them.
fn obj() -> String {
    let mut text = String::new();
    let corner = |[low, high]: [[f64; 3]; 2], i: usize| {
        let at = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        format!("v {} {} {}\n", at(0), at(1), at(2))
    };
    for solid in [BODY, CABIN] {
        (0..8).for_each(|i| text += &corner(solid, i));
    }
    for (first, material) in [(1, "Paint"), (9, "Glass")] {
        text += &format!("usemtl {material}\n");
        for [a, b, c, d] in common::BOX_FACES {
            text += &format!("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
        }
    }
    text
}

/// What a ray meets first.
enum Met {
    /// The body or the cabin, where, and the outward direction.
    Model {
        is_paint: bool,
        point: Point3<f64>,
        normal: Vector3<f64>,
    },
    Ground(Point3<f64>),
    Sky,
}

/// Entry into a box along a ray: the distance and the face's outward direction.
fn enter(eye: &Point3<f64>, ray: &Vector3<f64>, [low, high]: [[f64; 3]; 2]) -> Option<(f64, Vector3<f64>)> {
    let (mut from, mut to, mut face) = (0.0_f64, f64::INFINITY, 0);
    for axis in 0..3 {
        let (a, b) = (
            (low[axis] - eye[axis]) / ray[axis],
            (high[axis] - eye[axis]) / ray[axis],
        );
        if a.min(b) > from {
            (from, face) = (a.min(b), axis);
        }
        to = to.min(a.max(b));
    }
    let mut normal = Vector3::zeros();
    normal[face] = -ray[face].signum();
    (from < to && from > 0.0).then_some((from, normal))
}

fn meet(eye: &Point3<f64>, ray: &Vector3<f64>) -> Met {
    let hits = [(BODY, true), (CABIN, false)].map(|(solid, is_paint)| (enter(eye, ray, solid), is_paint));
    let nearest = hits
        .into_iter()
        .filter_map(|(hit, is_paint)| Some((hit?, is_paint)))
        .min_by(|a, b| a.0.0.total_cmp(&b.0.0));
    match nearest {
        Some(((t, normal), is_paint)) => Met::Model {
            is_paint,
            point: eye + ray * t,
            normal,
        },
        None if ray.z < 0.0 => Met::Ground(eye - ray * (eye.z / ray.z)),
        None => Met::Sky,
    }
}

/// The world, with the model in a colour.
struct World {
    tags: Vec<(scaleproof_pose::scene::Tag, TagImage)>,
}

impl World {
    fn new() -> Self {
        let scene = Scene::parse(&scene_text(""), Path::new("scene.toml")).unwrap();
        let tag = |tag: scaleproof_pose::scene::Tag| {
            let picture = TagImage::new(TagFamily::Tag36h11, tag.id).unwrap();
            (tag, picture)
        };
        Self {
            tags: scene.tags.into_iter().map(tag).collect(),
        }
    }

    /// Light along a ray. Shading has waves of some centimetres, so that a shift of a pixel shows.
    fn light(&self, eye: &Point3<f64>, ray: &Vector3<f64>, paint: [f64; 3], shown: &dyn Fn(u32) -> bool) -> [f64; 3] {
        match meet(eye, ray) {
            Met::Sky => [0.3, 0.4, 0.5],
            Met::Model { is_paint: false, .. } => [0.05; 3],
            Met::Model { point: p, normal, .. } => {
                let facing = 0.55 + 0.2 * normal.z + 0.1 * normal.x - 0.1 * normal.y;
                let waves = 1.0 + 0.4 * (p.x / 9.0).sin() * ((p.y + p.z) / 7.0).cos();
                paint.map(|rho| 0.01 + rho * facing * waves)
            }
            Met::Ground(p) => [self.ground(&p, shown); 3],
        }
    }

    fn ground(&self, p: &Point3<f64>, shown: &dyn Fn(u32) -> bool) -> f64 {
        for (tag, picture) in self.tags.iter().filter(|(tag, _)| shown(tag.id)) {
            let from = p - tag.centre_mm;
            let side = picture.modules().side() as f64;
            let cell = tag.size_mm / picture.border_modules() as f64;
            let column = from.dot(&tag.right) / cell + side / 2.0;
            let row = side / 2.0 - from.dot(&tag.up) / cell;
            // The card is a module wider than the white ring.
            if (-1.0..side + 1.0).contains(&column) && (-1.0..side + 1.0).contains(&row) {
                let is_black = column >= 0.0 && row >= 0.0 && picture.modules().is_black(row as usize, column as usize);
                return if is_black { 0.04 } else { 0.8 };
            }
        }
        0.3
    }

    /// Linear light of an image; `parts`² rays a pixel.
    fn picture(
        &self,
        size: [u32; 2],
        parts: u32,
        rays: &Rays,
        pose: &Rigid,
        paint: [u8; 3],
        shown: &dyn Fn(u32) -> bool,
    ) -> Vec<[f64; 3]> {
        let inverse = pose.inverse();
        let eye = inverse * Point3::origin();
        let paint = light::linear_of(paint);
        let mut all = Vec::new();
        for y in 0..size[1] {
            for x in 0..size[0] {
                let mut sum = [0.0; 3];
                for part in 0..parts * parts {
                    let [dx, dy] = [part % parts, part / parts].map(|i| (f64::from(i) + 0.5) / f64::from(parts));
                    let [u, v] = rays.at(x, y, [dx, dy]);
                    let light = self.light(&eye, &(inverse * Vector3::new(u, v, 1.0)), paint, shown);
                    (0..3).for_each(|c| sum[c] += light[c] / f64::from(parts * parts));
                }
                all.push(sum);
            }
        }
        all
    }
}

/// Where the corners of a camera's pixels look, at depth 1.
struct Rays {
    columns: usize,
    places: Vec<[f64; 2]>,
}

impl Rays {
    fn of(camera: &Camera) -> Self {
        let places = (0..=camera.height).flat_map(|y| (0..=camera.width).map(move |x| (x, y)));
        let places = places.map(|(x, y)| camera.point_at([f64::from(x) - 0.5, f64::from(y) - 0.5]).unwrap());
        Self {
            columns: camera.width as usize + 1,
            places: places.collect(),
        }
    }

    /// Within a pixel the lens is as good as straight.
    fn at(&self, x: u32, y: u32, [dx, dy]: [f64; 2]) -> [f64; 2] {
        let corner = |i: usize, j: usize| self.places[(y as usize + j) * self.columns + x as usize + i];
        let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        std::array::from_fn(|i| (1.0 - dy) * ((1.0 - dx) * a[i] + dx * b[i]) + dy * ((1.0 - dx) * c[i] + dx * d[i]))
    }
}

/// A photo to be taken.
#[derive(Clone)]
struct Taken {
    variant: &'static str,
    paint: [u8; 3],
    azimuth_deg: f64,
    distance_mm: f64,
    /// Of each channel's light.
    exposure: [f64; 3],
    /// Ids that are not covered.
    tags: fn(u32) -> bool,
    /// What the camera makes of light before the sRGB curve.
    tone: fn(f64) -> f64,
}

impl Taken {
    fn new((variant, paint): (&'static str, [u8; 3]), azimuth_deg: f64, exposure: [f64; 3]) -> Self {
        Self {
            variant,
            paint,
            azimuth_deg,
            distance_mm: 900.0,
            exposure,
            tags: |_| true,
            tone: |light| light,
        }
    }

    fn name(&self) -> String {
        format!("{}_{}.png", self.variant, self.azimuth_deg)
    }

    /// Not quite at the model's middle, as a hand aims.
    fn pose(&self) -> Rigid {
        let viewpoint = Viewpoint {
            azimuth_deg: self.azimuth_deg,
            pitch_deg: 35.0 + 0.3 * (self.azimuth_deg % 3.0),
            distance_mm: self.distance_mm,
        };
        looking_at(&viewpoint, Point3::new(8.0, -12.0, 55.0))
    }

    fn picture(&self, world: &World, camera: &Camera, rays: &Rays) -> RgbImage {
        let size = [camera.width, camera.height];
        let light = world.picture(size, 3, rays, &self.pose(), self.paint, &self.tags);
        picture(&light.iter().map(|l| self.toned(l)).collect::<Vec<_>>(), size, [1.0; 3])
    }

    fn toned(&self, light: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| (self.tone)(self.exposure[c] * light[c]))
    }
}

fn picture(light: &[[f64; 3]], [width, height]: [u32; 2], exposure: [f64; 3]) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let pixel = light[(y * width + x) as usize];
        Rgb(light::rgb_of([0, 1, 2].map(|c| exposure[c] * pixel[c])))
    })
}

fn session(name: &str, model: &str, width_px: u32, photos: &[Taken]) -> PathBuf {
    let folder = common::kept("attack_photos").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text).unwrap();
    write("scene.toml", scene_text(model));
    write("camera.yaml", camera_yaml());
    write("boxes.obj", obj());
    let entries: Vec<_> = photos
        .iter()
        .map(|p| serde_json::json!({"file": p.name(), "variant": p.variant, "place": "bench"}))
        .collect();
    let list = serde_json::json!({"scene": "scene.toml", "camera": "camera.yaml", "photos": entries});
    write("session.json", list.to_string());
    let camera = camera().scaled_to(width_px, width_px * 3 / 4).unwrap();
    let (world, rays) = (World::new(), Rays::of(&camera));
    let take = |(): &mut (), photo: &Taken| {
        let picture = photo.picture(&world, &camera, &rays);
        picture.save(folder.join(photo.name())).map_err(|e| e.to_string())
    };
    scaleproof_core::workers::map(photos, || Ok(()), take, || {}).unwrap();
    folder
}

fn photos(session: &Path, more: &[&str], output: &Path) -> Output {
    let mut command = program();
    command.args(["attack", "photos"]).arg(session).args(more);
    command.arg("-o").arg(output).output().unwrap()
}

const B: (&str, [u8; 3]) = ("black", BLACK);
const G: (&str, [u8; 3]) = ("grey", GREY);
const W: (&str, [u8; 3]) = ("white", WHITE);

/// Two views in three colours and a photo too many. The most central photo of each is black at 30° and white at 121.5°.
fn good_photos() -> Vec<Taken> {
    let black = [1.15, 1.1, 1.0];
    vec![
        Taken::new(B, 30.0, black),
        Taken::new(G, 32.5, [0.8, 0.9, 1.0]),
        Taken {
            distance_mm: 940.0,
            ..Taken::new(W, 27.5, [0.55, 0.5, 0.45])
        },
        Taken::new(B, 38.0, black),
        Taken::new(B, 120.0, black),
        Taken::new(G, 123.0, [0.8, 0.9, 1.0]),
        Taken::new(W, 121.5, [0.55, 0.5, 0.45]),
    ]
}

/// The frames of the good session, made once, and what the program said.
pub fn good() -> &'static (PathBuf, String) {
    static MADE: OnceLock<(PathBuf, String)> = OnceLock::new();
    MADE.get_or_init(|| {
        let session = session("good", MESH, 960, &good_photos());
        let frames = session.with_file_name("good_frames");
        let _ = std::fs::remove_dir_all(&frames);
        let flats = ["--flat", "black=202020", "grey=808080", "white=e6e6e6"];
        let before = hashes(&session);
        let more = [&flats[..], &["--material", "Paint", "--size-px", "240"]].concat();
        let output = photos(&session, &more, &frames);
        assert!(output.status.success(), "{}", common::stderr(&output));
        assert_eq!(before, hashes(&session), "photos are never changed");
        (frames, stdout(&output))
    })
}

fn hashes(folder: &Path) -> Vec<(String, String)> {
    let files = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut all: Vec<_> = files
        .map(|f| {
            (
                f.display().to_string(),
                scaleproof_core::files::sha256_hex(&std::fs::read(&f).unwrap()),
            )
        })
        .collect();
    all.sort();
    all
}

/// The true pose and the exposure of a view's reference photo.
fn reference(frame: &Frame) -> Taken {
    let azimuth = if frame.name.starts_with("000") { 30.0 } else { 121.5 };
    good_photos().into_iter().find(|p| p.azimuth_deg == azimuth).unwrap()
}

/// What the frame must show: a direct render from the reference's true pose, at its exposure.
fn truth(world: &World, set: &FrameSet, frame: &Frame, paint: [u8; 3]) -> RgbImage {
    let (reference, size) = (reference(frame), set.list.size_px);
    let rays = Rays::of(&set.list.camera());
    let light = world.picture(size, 5, &rays, &reference.pose(), paint, &|_| true);
    picture(&light, size, reference.exposure)
}

/// Mean squared error in sRGB, 0 to 1, where the weight is half or more.
fn mse(a: &RgbImage, b: &RgbImage, weight: &image::GrayImage) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for ((a, b), weight) in a.pixels().zip(b.pixels()).zip(weight.pixels()) {
        if weight.0[0] >= 128 {
            sum += (0..3)
                .map(|c| ((f64::from(a.0[c]) - f64::from(b.0[c])) / 255.0).powi(2))
                .sum::<f64>();
            count += 3;
        }
    }
    sum / f64::from(count)
}

/// Pixels of a frame.
fn pixels(set: &FrameSet) -> usize {
    set.list.size_px.iter().map(|px| *px as usize).product()
}

#[test]
fn every_colour_is_as_a_render_from_the_reference_s_place_has_it() {
    let (folder, said) = good();
    assert!(said.contains("6 frames of 2 views"), "{said}");
    assert!(
        said.contains("45°/35°/900 mm: black_30.png with grey_32.5.png (2."),
        "{said}"
    );
    assert!(
        said.contains("135°/35°/900 mm: white_121.5.png with black_120.png (1."),
        "{said}"
    );
    // The factors are those between the exposures.
    for (photo, exposures) in [
        ("grey_32.5.png", [1.15 / 0.8, 1.1 / 0.9, 1.0]),
        ("black_120.png", [0.55 / 1.15, 0.5 / 1.1, 0.45]),
    ] {
        let about = said
            .split(photo)
            .nth(1)
            .and_then(|rest| rest.split("light × ").nth(1))
            .unwrap();
        let found = about
            .split(')')
            .next()
            .unwrap()
            .split(' ')
            .map(|v| v.parse::<f64>().unwrap());
        let off = found
            .zip(exposures)
            .map(|(found, true_)| (found / true_ - 1.0).abs())
            .fold(0.0, f64::max);
        println!("{photo}: factors off by {:.1} % at most", 100.0 * off);
        assert!(off < 0.02);
    }
    let set = FrameSet::open(folder).unwrap();
    assert!(set.list.linear_max.is_none(), "a photo's tone curve is not known");
    let world = World::new();
    let (mut worst, mut least_gain) = (0.0_f64, f64::INFINITY);
    for frame in &set.list.frames {
        let colour = frame.flat_rgb().unwrap();
        let (found, mask) = (set.rgb(frame).unwrap(), set.paint_mask(frame).unwrap());
        let wanted = truth(&world, &set, frame, colour);
        let error = mse(&found, &wanted, &mask);
        println!("{}: mean squared error over the paint {error:.6}", frame.name);
        worst = worst.max(error);
        // The same photo without the way through the mesh: seen from its own place.
        let own = good_photos().into_iter().find(|p| {
            let near = (p.azimuth_deg - reference(frame).azimuth_deg).abs() < 3.0;
            near && p.paint == colour
        });
        let own = own.unwrap();
        if own.azimuth_deg != reference(frame).azimuth_deg {
            let rays = Rays::of(&set.list.camera());
            let light = world.picture(set.list.size_px, 3, &rays, &own.pose(), colour, &|_| true);
            let unmoved = picture(&light, set.list.size_px, reference(frame).exposure);
            least_gain = least_gain.min(mse(&unmoved, &wanted, &mask) / error);
        }
    }
    println!(
        "worst {worst:.6}; photos that are not laid on the reference are wrong at least {least_gain:.0} times as much"
    );
    assert!(worst < 0.0002, "{worst}");
    assert!(least_gain > 4.0, "the test could not tell: {least_gain}");
}

#[test]
fn programs_are_told_the_views_and_what_was_left_out() {
    let (frames, _) = good();
    let session = frames.with_file_name("good");
    let folder = tempfile::tempdir().unwrap();
    let more = [
        "--flat",
        "black=202020",
        "grey=808080",
        "--material",
        "Paint",
        "--size-px",
        "64",
        "--json",
    ];
    let output = photos(&session, &more, folder.path());
    let made: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(made["frames"], 4);
    assert_eq!(made["file"], folder.path().join("frames.json").to_str().unwrap());
    let views = made["views"].as_array().unwrap();
    assert_eq!(views.len(), 2);
    for view in views {
        let other = &view["others"][0];
        let turn = other["turn_deg"].as_f64().unwrap();
        assert!(turn > 2.0 && turn < 3.0, "{view}");
        assert_eq!(other["light_factors"].as_array().unwrap().len(), 3);
        assert!(view["paint_seen_by_all"].as_f64().unwrap() > 0.5, "{view}");
    }
    let left_out = made["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 1, "{made}");
    assert_eq!(left_out[0]["what"], "photos of the variant white");
}

#[test]
fn masks_positions_and_the_background_are_the_reference_s() {
    let set = FrameSet::open(&good().0).unwrap();
    let [width, height] = set.list.size_px;
    let factor = set.list.positions.unwrap().factor;
    let camera = set.list.camera();
    for view in views(&set.list.frames) {
        let frame = view[0];
        set.check_images(frame).unwrap();
        let inverse = reference(frame).pose().inverse();
        let eye = inverse * Point3::origin();
        let met = |x: f64, y: f64| {
            let [u, v] = camera.point_at([x, y]).unwrap();
            meet(&eye, &(inverse * Vector3::new(u, v, 1.0)))
        };
        // Shares of each pixel, by rays of our own from the true pose.
        let (object, paint) = (set.object_mask(frame).unwrap(), set.paint_mask(frame).unwrap());
        let (mut off_object, mut off_paint, mut missing) = (0.0, 0.0, 0.0);
        let mut area = 0.0;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let (mut of_model, mut of_paint) = (0.0, 0.0);
            for part in 0..36 {
                let at = |pixel: u32, part: u32| f64::from(pixel) + (f64::from(part) + 0.5) / 6.0 - 0.5;
                if let Met::Model { is_paint, .. } = met(at(x, part % 6), at(y, part / 6)) {
                    of_model += 1.0 / 36.0;
                    of_paint += f64::from(u8::from(is_paint)) / 36.0;
                }
            }
            let share = |mask: &image::GrayImage| f64::from(mask.get_pixel(x, y).0[0]) / 255.0;
            off_object += (share(&object) - of_model).abs();
            off_paint += (share(&paint) - of_paint).max(0.0);
            missing += (of_paint - share(&paint)).max(0.0);
            area += of_paint;
        }
        println!(
            "{}: of {area:.0} px of paint, object mask off by {off_object:.1} px, paint where none is {off_paint:.1} px, taken out {missing:.1} px",
            frame.name
        );
        assert!(off_object < 0.03 * area && off_paint < 0.02 * area && missing < 0.1 * area);
        // Each place of the paint, and its side.
        let points = set.surface(frame).unwrap().unwrap();
        let (mut places, mut wrong) = (0, 0);
        for (i, point) in points.iter().enumerate() {
            let Some(side) = point.side else { continue };
            let [x, y] = [i as u32 % (width * factor), i as u32 / (width * factor)]
                .map(|v| (f64::from(v) + 0.5) / f64::from(factor) - 0.5);
            places += 1;
            let is_right = match met(x, y) {
                Met::Model {
                    is_paint: true,
                    point: p,
                    normal,
                } => (p - Point3::from(point.place_mm)).norm() < 2.0 && Side::facing(&normal) == side,
                _ => false,
            };
            wrong += usize::from(!is_right);
        }
        println!(
            "{}: {wrong} of {places} places more than 2 mm off or of another side",
            frame.name
        );
        assert!(places > 10_000 && wrong * 100 < places);
        // All frames of a view are one image beside the model.
        let pictures: Vec<_> = view.iter().map(|f| set.rgb(f).unwrap()).collect();
        for (x, y, mask) in object.enumerate_pixels() {
            let first = pictures[0].get_pixel(x, y);
            assert!(mask.0[0] > 0 || pictures.iter().all(|p| p.get_pixel(x, y) == first));
        }
        // Where the photo's pixels are: tags, ground and cabin as a render without a lens has them.
        let everywhere = image::GrayImage::from_pixel(width, height, image::Luma([255]));
        let own = view
            .iter()
            .find(|f| f.flat_rgb() == Some(reference(frame).paint))
            .unwrap();
        let wanted = truth(&World::new(), &set, frame, reference(frame).paint);
        let error = mse(&set.rgb(own).unwrap(), &wanted, &everywhere);
        println!("{}: the reference's whole picture {error:.6}", own.name);
        assert!(error < 0.001, "{error}");
    }
}

#[test]
fn surrogate_renderers_predict_the_colour_they_have_not_seen() {
    let (folder, _) = good();
    let set = FrameSet::open(folder).unwrap();
    let world = World::new();
    for view in views(&set.list.frames) {
        let mask = set.paint_mask(view[0]).unwrap();
        let shots: Vec<FlatImage> = view
            .iter()
            .filter(|f| f.flat_rgb() != Some(GREY))
            .map(|f| FlatImage {
                flat_rgb: f.flat_rgb().unwrap(),
                image: set.rgb(f).unwrap(),
            })
            .collect();
        let model = PerPixel::fit(ClosedForm::AffineCurve, &shots).unwrap();
        let [width, height] = set.list.size_px;
        let predicted = model.predict(&vec![light::linear_of(GREY); pixels(&set)]);
        let predicted = RgbImage::from_fn(width, height, |x, y| {
            Rgb(predicted[(y * width + x) as usize].map(|v| (255.0 * v).round() as u8))
        });
        let error = mse(&predicted, &truth(&world, &set, view[0], GREY), &mask);
        println!(
            "{}: grey from black and white, mean squared error over the paint {error:.6}",
            view[0].name
        );
        assert!(error < 0.0005, "{error}");
    }
    // The world-aligned laying finds the paint by positions and sides.
    let grid = Grid {
        columns: 8,
        rows: 8,
        cell_mm: 20.0,
    };
    let laid = world::project(&set, &set.list.frames[0], &grid, false, &[world::Misplacement::NONE]).unwrap();
    assert!(laid.is_some_and(|laid| laid[0].forward(&[[1.0; 3]; 64]).len() == pixels(&set)));
    let charts = folder.with_file_name("good_chart");
    let arguments = ["--reference", "202020", "e6e6e6"];
    let mut command = program();
    command
        .args(["attack", "chart"])
        .arg(folder)
        .args(arguments)
        .arg("-o")
        .arg(&charts);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", common::stderr(&output));
    let numbers = read_json(&charts.join("renderers.json"));
    let affine = numbers["rows"]
        .as_array()
        .unwrap()
        .iter()
        .find(|r| r["model"] == "affine-curve");
    assert!(affine.unwrap()["mse_paint"].as_f64().unwrap() < 0.0005);
}

/// Phones press the bright end together. One exposure for all photos costs nothing then; several cost what the curve is not sRGB's.
#[test]
fn another_tone_curve_costs_where_exposures_differ() {
    let made = |name: &str, exposures: [f64; 3], is_cautioned: bool| {
        let taken = |colour, azimuth_deg, exposure| Taken {
            tone: |light| 1.5 * light / (light + 0.5),
            ..Taken::new(colour, azimuth_deg, [exposure; 3])
        };
        let [b, g, w] = exposures;
        let shots = [taken(B, 30.0, b), taken(G, 31.5, g), taken(W, 28.5, w)];
        let folder = session(name, MESH, 640, &shots);
        let out = folder.with_file_name(format!("{name}_frames"));
        let _ = std::fs::remove_dir_all(&out);
        let flats = [
            "--flat",
            "black=202020",
            "grey=808080",
            "white=e6e6e6",
            "--material",
            "Paint",
        ];
        let output = photos(&folder, &[&flats[..], &["--size-px", "240"]].concat(), &out);
        assert!(
            stdout(&output).contains("black_30.png with grey"),
            "{}",
            common::stderr(&output)
        );
        assert_eq!(
            common::stderr(&output).contains("lock it"),
            is_cautioned,
            "{}",
            common::stderr(&output)
        );
        let set = FrameSet::open(&out).unwrap();
        let (size, rays) = (set.list.size_px, Rays::of(&set.list.camera()));
        let mut worst = 0.0_f64;
        for frame in &set.list.frames {
            let light = World::new().picture(size, 4, &rays, &shots[0].pose(), frame.flat_rgb().unwrap(), &|_| true);
            let light: Vec<_> = light.iter().map(|l| shots[0].toned(l)).collect();
            let mask = set.paint_mask(frame).unwrap();
            worst = worst.max(mse(&set.rgb(frame).unwrap(), &picture(&light, size, [1.0; 3]), &mask));
        }
        worst
    };
    let one = made("one_exposure", [0.6; 3], false);
    let several = made("exposures", [0.9, 0.6, 0.4], true);
    println!(
        "a soft shoulder as tone curve, worst error over the paint: {one:.6} with one exposure, {several:.6} with 0.9, 0.6 and 0.4"
    );
    assert!(one < 0.0002 && several > 2.0 * one);
}

/// The white model is clipped where the paper is not; made darker, that would look like a tone.
#[test]
fn clipped_paint_is_taken_out() {
    let shots = [
        Taken::new(B, 30.0, [0.6; 3]),
        Taken::new(("white", [255; 3]), 31.0, [1.18; 3]),
    ];
    let folder = session("bright", MESH, 640, &shots);
    let out = folder.with_file_name("bright_frames");
    let _ = std::fs::remove_dir_all(&out);
    let more = [
        "--flat",
        "black=202020",
        "white=ffffff",
        "--material",
        "Paint",
        "--size-px",
        "240",
    ];
    let output = photos(&folder, &more, &out);
    assert!(output.status.success(), "{}", common::stderr(&output));
    let set = FrameSet::open(&out).unwrap();
    let (size, rays) = (set.list.size_px, Rays::of(&set.list.camera()));
    let frame = &set.list.frames[1];
    let light = World::new().picture(size, 5, &rays, &shots[0].pose(), [255; 3], &|_| true);
    let mask = set.paint_mask(frame).unwrap();
    let clipped = light.iter().zip(mask.pixels()).filter(|(l, _)| l[0] > 1.02 / 1.18);
    let kept = clipped.clone().filter(|(_, m)| m.0[0] >= 128).count();
    let error = mse(&set.rgb(frame).unwrap(), &picture(&light, size, [0.6; 3]), &mask);
    let clipped = clipped.count();
    println!("{clipped} pixels of the paint are clipped, {kept} of them in the mask; error over the mask {error:.6}");
    assert!(stdout(&output).contains("black_30.png with white_31.png"));
    // Those in the mask are clipped in part; left as they are, all would be in it, and the error 0.00027.
    assert!(2 * kept < clipped && error < 0.0002);
}

#[test]
fn views_that_do_not_fit_are_left_out_and_named() {
    let plain = [0.8; 3];
    let turned = |photo: Taken, tags: fn(u32) -> bool| Taken { tags, ..photo };
    let folder = session(
        "bad",
        MESH,
        640,
        &[
            Taken::new(B, 210.0, plain),
            Taken::new(W, 218.0, plain),
            Taken::new(B, 300.0, plain),
            Taken::new(B, 359.0, plain),
            Taken::new(W, 1.0, [1.0, 1.3, 1.0]),
            Taken::new(B, 90.0, plain),
            Taken::new(W, 91.0, [0.8, 0.8, 0.03]),
            turned(Taken::new(B, 180.0, plain), |id| id % 2 == 0),
            turned(Taken::new(W, 179.0, plain), |id| id % 2 == 1),
            Taken::new(B, 45.0, plain),
            Taken {
                distance_mm: 1060.0,
                ..Taken::new(W, 46.0, plain)
            },
            turned(Taken::new(W, 250.0, plain), |_| false),
        ],
    );
    let out = folder.with_file_name("bad_frames");
    let _ = std::fs::remove_dir_all(&out);
    let output = photos(&folder, &["--flat", "black=202020", "white=e6e6e6"], &out);
    // Behind the notes on what was read.
    assert_eq!(output.status.code(), Some(2));
    let last = stderr(&output).trim_end().lines().last().unwrap().to_owned();
    assert!(
        last.contains("no view has photos in every colour") && last.contains("left out"),
        "{last}"
    );
    assert!(!out.exists(), "nothing is written");
    let said = stdout(&output);
    for words in [
        ["225°/35°/900 mm", "white_218.png was taken 6.6°", "6° is the most"],
        ["315°/35°/900 mm", "no located photo in e6e6e6", ""],
        ["0°/35°/900 mm", "clipped", "white_1.png"],
        ["90°/35°/900 mm", "too dark", "white_91.png"],
        ["180°/35°/900 mm", "located tags with", "needs 2"],
        ["45°/35°/900 mm", "nearer or further", "15 % is the most"],
        ["white_250.png", "no tag is visible", ""],
    ] {
        let fits = |line: &&str| words.iter().all(|word| line.contains(word));
        assert!(
            said.lines().filter(|l| l.starts_with("left out: ")).any(|l| fits(&l)),
            "{words:?} in {said}"
        );
    }
}

#[test]
fn bad_input_is_refused() {
    let one = [Taken::new(B, 30.0, [0.8; 3])];
    let with = session("with", MESH, 640, &one);
    let without = session("without", "envelope = \"box\"", 640, &one);
    let out = with.with_file_name("no_frames");
    let refused = |session: &Path, more: &[&str], words: &[&str]| {
        assert_refused(&photos(session, more, &out), words);
        assert!(!out.exists());
    };
    let two = ["--flat", "black=202020", "white=ffffff"];
    refused(&without, &two, &["names no mesh", "envelope"]);
    refused(&with, &two, &["no photo has the variant 'white'", "black"]);
    refused(&with, &["--flat", "black=202020"], &["one colour says nothing"]);
    refused(
        &with,
        &["--flat", "black=202020", "black=808080"],
        &["'black=808080'", "each once"],
    );
    refused(
        &with,
        &["--flat", "black=202020", "white=202020"],
        &["'white=202020'", "each once"],
    );
    refused(&with, &["--flat", "black", "white=ffffff"], &["'black'", "VARIANT=HEX"]);
    refused(
        &with,
        &["--flat", "black=2020", "white=ffffff"],
        &["'2020'", "six hexadecimal"],
    );
    refused(&home().join("captures"), &two, &["cannot read", "session.json"]);
    let twice = [with.to_str().unwrap(), two[0], two[1], two[2]];
    refused(&with, &twice, &["given twice"]);
    // A stored viewpoint is no pose.
    let list = with.join("session.json");
    let text = std::fs::read_to_string(&list).unwrap();
    let tagless = scene_text(MESH).split("\n[[tag]]").next().unwrap().to_owned();
    std::fs::write(with.join("scene.toml"), tagless).unwrap();
    let variants = text.replace("]", ",{\"file\":\"b.png\",\"variant\":\"white\"}]");
    std::fs::write(&list, variants).unwrap();
    refused(&with, &two, &["has no tags", "a viewpoint alone is no pose"]);
    let there = good();
    // Colours that are mixed up: what is said to be darker looks lighter.
    let mixed = ["--flat", "black=e6e6e6", "grey=808080", "white=202020"];
    let mixed = photos(&there.0.with_file_name("good"), &mixed, &out);
    assert_eq!(mixed.status.code(), Some(2));
    assert!(
        stdout(&mixed).contains("a lighter colour looks no lighter than a darker one"),
        "{}",
        stdout(&mixed)
    );
    assert!(!out.exists());
    let again = photos(
        &there.0.with_file_name("good"),
        &["--flat", "black=202020", "white=e6e6e6"],
        &there.0,
    );
    assert_refused(&again, &["frames.json is there already"]);
}

/// Shares of a pixel and places of the paint, as the rasteriser has them, against the stored frames of Blender.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_rasteriser_sees_what_blender_saw() {
    let file = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let placement = MeshPlacement {
        length_mm: Some(455.0),
        ..MeshPlacement::default()
    };
    let mesh = Mesh::load(&file, &placement).unwrap();
    let paint = mesh.materials_named(&["Material.001".to_owned()]).unwrap();
    let set = FrameSet::open(&home().join("captures/skyline_frames")).unwrap();
    let [width, height] = set.list.size_px;
    let factor = set.list.positions.unwrap().factor;
    let fine = |pinhole: Pinhole, factor: u32| Pinhole {
        focal_length_px: f64::from(factor) * pinhole.focal_length_px,
        centre_px: pinhole.centre_px.map(|c| f64::from(factor) * (c + 0.5) - 0.5),
    };
    for view in views(&set.list.frames) {
        let frame = view[0];
        let size = [width, height].map(|px| (px * factor) as usize);
        let raster = Raster::image(&mesh, &frame.pose(), &fine(set.list.camera, factor), size).unwrap();
        let is_paint = |t: usize| paint.contains(&mesh.triangles()[t].material);
        let mut shares = vec![[0.0; 2]; pixels(&set)];
        let points = set.surface(frame).unwrap().unwrap();
        let (mut both, mut either, mut near, mut same_side) = (0, 0, 0, 0);
        for (i, point) in points.iter().enumerate() {
            let (x, y) = (i % size[0], i / size[0]);
            let hit = raster.at(x as i64, y as i64);
            let pixel = &mut shares[y / factor as usize * width as usize + x / factor as usize];
            let part = 1.0 / f64::from(factor * factor);
            pixel[0] += if hit.is_some() { part } else { 0.0 };
            let own = hit.filter(|h| is_paint(h.triangle));
            pixel[1] += if own.is_some() { part } else { 0.0 };
            either += usize::from(own.is_some() || point.side.is_some());
            if let (Some(hit), Some(side)) = (own, point.side) {
                both += 1;
                let place = raster.point(x as i64, y as i64, &hit);
                near += usize::from((place - Point3::from(point.place_mm)).norm() < 0.2);
                let corners = mesh.corners_mm(&mesh.triangles()[hit.triangle]);
                same_side += usize::from(Side::facing(&scaleproof_surface::mesh::doubled_area(&corners)) == side);
            }
        }
        // How much of the paint is seen from beside as well.
        let pinhole = fine(set.list.camera, factor);
        let eye = frame.pose().inverse() * Point3::origin();
        let from_beside = [0.0, 2.0, 4.0, 6.0, 10.0, 15.0].map(|deg| {
            let turn = nalgebra::Isometry3::rotation(Vector3::z() * f64::to_radians(deg));
            let beside = Raster::whole(&mesh, &(frame.pose() * turn), &pinhole, size).unwrap();
            let places = (0..size[0] * size[1]).filter_map(|i| {
                let (x, y) = ((i % size[0]) as i64, (i / size[0]) as i64);
                let hit = raster.at(x, y).filter(|h| is_paint(h.triangle))?;
                Some(beside.sees(&raster.point(x, y, &hit), hit.triangle, &eye, is_paint))
            });
            let (seen, all) = places.fold((0, 0), |(seen, all), is_seen| (seen + usize::from(is_seen), all + 1));
            (deg, 100 * seen / all)
        });
        println!(
            "{}: degrees aside, % of the paint's places seen: {from_beside:?}",
            frame.name
        );
        assert!(from_beside[0].1 >= 75 && from_beside[3].1 + 15 >= from_beside[0].1);
        let off = |mask: &image::GrayImage, i: usize| {
            let pairs = mask.pixels().zip(&shares);
            pairs
                .map(|(p, share)| (f64::from(p.0[0]) / 255.0 - share[i]).abs())
                .sum::<f64>()
        };
        let area: f64 = shares.iter().map(|s| s[1]).sum();
        let (object, painted) = (set.object_mask(frame).unwrap(), set.paint_mask(frame).unwrap());
        let (off_object, off_paint) = (off(&object, 0), off(&painted, 1));
        println!(
            "{}: paint {area:.0} px, masks off by {off_object:.1} and {off_paint:.1} px; of {both} places ({either} in either) {near} within 0.2 mm, \
             {same_side} of the same side",
            frame.name
        );
        assert!(off_object < 0.02 * area && off_paint < 0.05 * area);
        assert!(both * 100 > 97 * either && near * 1000 > 990 * both && same_side * 1000 > 990 * both);
    }
}

/// A box is seen by rays of our own where the rasteriser sees it, and from beside only what is not hidden.
#[test]
fn a_box_hides_what_is_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("boxes.obj");
    std::fs::write(&file, obj()).unwrap();
    let mesh = Mesh::load(&file, &MeshPlacement::default()).unwrap();
    let pinhole = Pinhole {
        focal_length_px: 600.0,
        centre_px: [239.5, 179.5],
    };
    let pose = |azimuth_deg: f64| {
        let viewpoint = Viewpoint {
            azimuth_deg,
            pitch_deg: 20.0,
            distance_mm: 900.0,
        };
        looking_at(&viewpoint, Point3::new(0.0, 0.0, 60.0))
    };
    let (here, there) = (pose(60.0), pose(100.0));
    let size = [480, 360];
    let raster = Raster::image(&mesh, &here, &pinhole, size).unwrap();
    let beside = Raster::whole(&mesh, &there, &pinhole, size).unwrap();
    let eye = here.inverse() * Point3::origin();
    let other_eye = there.inverse() * Point3::origin();
    let (mut seen, mut wrong_depth, mut hidden, mut wrongly_seen, mut wrongly_hidden) = (0, 0, 0, 0, 0);
    for (x, y) in (0..360).flat_map(|y| (0..480).map(move |x| (x, y))) {
        let ray = Vector3::new((f64::from(x) - 239.5) / 600.0, (f64::from(y) - 179.5) / 600.0, 1.0);
        let found = raster.at(x.into(), y.into());
        match (meet(&eye, &(here.inverse() * ray)), found) {
            (Met::Model { point, .. }, Some(hit)) => {
                seen += 1;
                wrong_depth += usize::from((raster.point(x.into(), y.into(), &hit) - point).norm() > 1e-6);
                let is_seen = beside.sees(&point, hit.triangle, &eye, |_| true);
                // By a ray of our own from the other camera.
                let to = point - other_eye;
                let is_free = match meet(&other_eye, &to) {
                    Met::Model { point: first, .. } => (first - point).norm() < 1e-6,
                    _ => false,
                };
                hidden += usize::from(!is_free);
                wrongly_seen += usize::from(is_seen && !is_free);
                wrongly_hidden += usize::from(!is_seen && is_free);
            }
            (Met::Model { .. }, None) | (_, Some(_)) => wrong_depth += 1,
            _ => {}
        }
    }
    println!(
        "{seen} pixels of the model, {wrong_depth} wrong; {hidden} hidden from beside, of which {wrongly_seen} taken for seen; \
         {wrongly_hidden} of the others taken for hidden"
    );
    assert!(seen > 20_000 && hidden > 2_000 && wrong_depth < 20);
    assert!(wrongly_seen < 5 && wrongly_hidden * 20 < seen);
}
