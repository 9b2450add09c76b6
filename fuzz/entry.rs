//! One function per parser of user files: any bytes in, no panic. The fuzz targets and `tests/parsers.rs` call the same ones.
#![allow(dead_code)] // each target uses its part

// The file itself: the crate `capture` would bring a web server and camera drivers into every target.
#[path = "../crates/capture/src/source/live/jpegs.rs"]
mod jpegs;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};
use scaleproof_core::files::sha256_hex;
use scaleproof_detect::onnx_model::{Model, Numbers, Tensor};
use scaleproof_detect::{
    InputPlacement, Labels, Manifest, OutsideResults, PhotoName, ProgramSpec, Recorded, ResultsRequest,
    darknet_contents_to_onnx, preprocessed, protocol,
};
use scaleproof_frames::FrameSet;
use scaleproof_frames::import::import as import_frames;
use scaleproof_photo::Photo;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::{Camera, CameraFormat};
use scaleproof_pose::scene::{Classes, Scene};
use scaleproof_print::printer::PrinterFile;
use scaleproof_score::shard::{self, Run, Shard, ShardId};
use scaleproof_session::Session;
use scaleproof_session::import;
use scaleproof_surface::mesh::{Mesh, MeshPlacement};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::Palette;
use scaleproof_surface::texture::{FaceTexels, MappedImages, SurfacePoint, Texture};
use scaleproof_video::log::{FrameLog, LogEvent};
use scaleproof_video::{Input, Video};

/// Camera files: what is read can be written, and reads back as the same camera.
pub fn camera(bytes: &[u8]) {
    let Some(camera) = text(bytes).and_then(|t| Camera::parse(t, Path::new("camera")).ok()) else {
        return;
    };
    for (format, name) in CameraFormat::ALL {
        let Ok(written) = camera.write(format) else { continue };
        let again = Camera::parse(&written, Path::new(name)).expect("what was written can be read");
        assert_eq!(again, camera, "{written}");
    }
    let _ = Camera::guessed(camera.width, camera.height, &Default::default());
    let _ = camera.for_photo(640, 480, 90);
}

pub fn scene(bytes: &[u8]) {
    let Some(scene) = text(bytes).and_then(|t| Scene::parse(t, Path::new("scene.toml")).ok()) else {
        return;
    };
    let _ = scene.to_toml();
}

pub fn session(bytes: &[u8]) {
    let folder = folder();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let stored = [root.join("captures/skyline"), root.join("../captures/skyline")];
    if let (Some(stored), false) = (stored.iter().find(|f| f.exists()), folder.join("scene.toml").exists()) {
        for name in ["scene.toml", "camera.yaml"] {
            std::fs::copy(stored.join(name), folder.join(name)).expect("the stored session is there");
        }
    }
    let _ = Session::open(&file("session.json", bytes));
}

/// Annotation files: what is read names a photo and has a box of numbers.
pub fn coco(bytes: &[u8]) {
    annotations(bytes, import::coco::parse);
}

pub fn table(bytes: &[u8]) {
    annotations(bytes, import::csv::parse);
}

type Parser = fn(&str, &Classes) -> Result<import::ImportedRows, import::ImportFault>;

fn annotations(bytes: &[u8], parse: Parser) {
    let Some(Ok((rows, _))) = text(bytes).map(|t| parse(t, &"car".parse().expect("a label"))) else {
        return;
    };
    for row in rows {
        assert!(row.entry.box_xyxy_px.is_some(), "{row:?}");
    }
}

pub fn pattern(bytes: &[u8]) {
    let _ = Pattern::load(&file("pattern.png", bytes));
}

pub fn printer(bytes: &[u8]) {
    if let Ok(printer) = PrinterFile::load(&file("printer.toml", bytes)) {
        let written = printer.to_toml().expect("a printer file can be written");
        let again = PrinterFile::load(&file("printer.toml", written.as_bytes()));
        assert_eq!(again.map(|p| p.colours), Ok(printer.colours), "{written}");
    }
}

pub fn manifest(bytes: &[u8]) {
    let _ = text(bytes).map(|t| Manifest::parse(t, "detector.toml"));
}

/// A Darknet network: the configuration up to the first zero byte, the weights behind it.
pub fn darknet(bytes: &[u8]) {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (cfg, weights) = bytes.split_at(end);
    let weights = weights.get(1..).unwrap_or_default();
    let _ = text(cfg).map(|cfg| darknet_contents_to_onnx(cfg, "x.cfg", weights, "x.weights"));
}

/// An ONNX file: what is read has as many numbers as its shapes say.
pub fn onnx(bytes: &[u8]) {
    let Ok(model) = Model::read(bytes) else { return };
    for Tensor { shape, numbers } in model.constants.values() {
        let count = match numbers {
            Numbers::Floats(v) => v.len(),
            Numbers::Whole(v) => v.len(),
        };
        assert_eq!(count, shape.iter().product::<usize>());
    }
}

/// What Transformers says beside a network: whatever is accepted brings photos to an input of a size and of numbers.
pub fn preprocessor(bytes: &[u8]) {
    let usual = Manifest::named("deimv2_atto").expect("the program knows it").input;
    for is_open in [false, true] {
        let Ok(input) = preprocessed(bytes, &usual, is_open) else {
            continue;
        };
        assert!(input.mean.iter().all(|v| v.is_finite()) && input.std.iter().all(|v| v.is_normal()));
        let placement = InputPlacement::new(&input, 641, 480);
        assert!(placement.size.iter().chain(&placement.canvas).all(|side| *side > 0));
    }
}

/// Board files: what is read can be written, and reads back as the same board.
pub fn board(bytes: &[u8]) {
    let Ok(board) = Definition::open(&file("board.toml", bytes)) else {
        return;
    };
    let written = board.to_toml().expect("a board can be written");
    assert_eq!(
        Definition::open(&file("board.toml", written.as_bytes())).ok(),
        Some(board),
        "{written}"
    );
}

pub fn palette(bytes: &[u8]) {
    let _ = Palette::load(&file("palette.toml", bytes));
}

pub fn glb(bytes: &[u8]) {
    mesh("mesh.glb", bytes);
}

pub fn obj(bytes: &[u8]) {
    mesh("mesh.obj", bytes);
}

pub fn stl(bytes: &[u8]) {
    mesh("mesh.stl", bytes);
}

pub fn ply(bytes: &[u8]) {
    mesh("mesh.ply", bytes);
}

/// The material library of a mesh whose materials have the names that the corpus's libraries give.
pub fn mtl(bytes: &[u8]) {
    file("mesh.mtl", bytes);
    file("p.png", &PIXELS);
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n";
    mesh(
        "with_library.obj",
        format!("mtllib mesh.mtl\n{square}usemtl a\nf 1/1 2/2 3/3\n").as_bytes(),
    );
}

/// Texels of the triangles of a box.
pub fn npy(bytes: &[u8]) {
    let mesh = Mesh::cuboid([10.0; 3]);
    if let Ok((texels, _)) = FaceTexels::load(&file("texels.npy", bytes), &mesh) {
        colours(&Texture::Faces(texels), &mesh);
    }
}

/// A colour at some points of each triangle.
fn colours(texture: &Texture, mesh: &Mesh) {
    for triangle in 0..mesh.triangles().len().min(100) {
        for weights in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0 / 3.0; 3], [0.7, 0.5, -0.2]] {
            let _ = texture.colour(mesh, &SurfacePoint { triangle, weights });
        }
        let _ = texture.texel_mm(mesh, triangle);
    }
}

/// A small image.
static PIXELS: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = DynamicImage::from(RgbImage::from_pixel(3, 2, Rgb([1, 2, 3])));
    image
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("an image can be written");
    png.into_inner()
});

/// What is read has corners and materials that exist, and its own images give colours or a sentence.
fn mesh(name: &str, bytes: &[u8]) {
    let placement = MeshPlacement {
        length_mm: Some(100.0),
        ..MeshPlacement::default()
    };
    if let Ok(mesh) = Mesh::load(&file(name, bytes), &placement) {
        for triangle in mesh.triangles() {
            assert!(
                mesh.corners_mm(triangle)
                    .iter()
                    .all(|p| p.iter().all(|c| c.is_finite()))
            );
            assert!(triangle.material < mesh.materials().len());
        }
        if let Ok(mapped) = MappedImages::from_mesh(&mesh, &[]) {
            colours(&Texture::Images(mapped.images), &mesh);
        }
    }
}

/// What ffmpeg says: a frame's time is a number, and no line that begins otherwise than the filter's is a frame.
pub fn ffmpeg(bytes: &[u8]) {
    const NAME: &str = "secret";
    let mut lines = FrameLog::named(NAME).parser();
    for line in String::from_utf8_lossy(bytes).lines() {
        match lines.parse(line) {
            Some(LogEvent::Frame { time_s, .. }) => assert!(time_s.is_finite() && line.contains(NAME)),
            Some(LogEvent::Error(words)) => {
                assert!(line.contains(words.as_str()) || line.contains(NAME) || line.contains("Redirecting"))
            }
            None => {}
        }
    }
}

/// What ffprobe says of an RTSP server's answers: a video within bounds, or a sentence.
pub fn ffprobe(bytes: &[u8]) {
    if let Ok(video) = Video::by_answer(Input::other("rtsp://camera/".to_owned(), Vec::new()), bytes) {
        assert!(video.width > 0 && video.height > 0 && u64::from(video.width) * u64::from(video.height) <= 36_000_000);
        assert!(video.duration_s.is_none_or(|s| s.is_finite() && s > 0.0));
        assert!(video.frames_per_s.is_none_or(|rate| rate.is_finite() && rate > 0.0));
        assert!(video.turned_deg.is_multiple_of(90) && video.turned_deg < 360);
    }
}

/// A stream of JPEG files: what is cut out of it is a part of it with a JPEG's first and last marker, the same whether it comes at once or in pieces.
pub fn motion_jpeg(bytes: &[u8]) {
    let at_once = cut(bytes);
    let mut left = bytes;
    for jpeg in &at_once {
        assert!(jpeg.starts_with(&[0xFF, 0xD8]) && jpeg.ends_with(&[0xFF, 0xD9]));
        let at = left.windows(jpeg.len()).position(|part| part == jpeg);
        left = &left[at.expect("it is a part of the stream, behind the one before") + jpeg.len()..];
    }
    assert_eq!(cut(Pieces(bytes)), at_once);
}

fn cut(stream: impl std::io::Read) -> Vec<Vec<u8>> {
    let mut jpegs = jpegs::Jpegs::new(stream);
    std::iter::from_fn(|| jpegs.next_jpeg().ok().flatten()).collect()
}

struct Pieces<'a>(&'a [u8]);

impl std::io::Read for Pieces<'_> {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let count = to.len().min(7);
        self.0.read(&mut to[..count])
    }
}

pub fn photo(bytes: &[u8]) {
    let path = file("photo", bytes);
    if let Ok(photo) = Photo::open(&path) {
        let _ = Camera::guessed(photo.width, photo.height, &photo.lens());
        let _ = photo.luma();
        let wanted = [1, 2, 4, 8].map(|r| photo.reduction([photo.width / r, photo.height / r]));
        wanted.iter().for_each(|reduction| drop(photo.rgb(*reduction)));
    }
}

/// Both files of a recording: COCO results with a provenance that fits them, and a provenance.
pub fn recording(bytes: &[u8]) {
    static MANIFEST: LazyLock<Manifest> = LazyLock::new(|| {
        let all = Manifest::all().expect("the program's own manifests are in order");
        all.into_iter().next().expect("the program knows detectors")
    });
    let manifest = &*MANIFEST;
    let provenance = serde_json::json!({
        "detector": manifest.name,
        "weights_sha256": manifest.weights.sha256,
        "results_sha256": sha256_hex(bytes),
        "scaleproof": "0.1.0",
        "runtime": "",
        "score_floor": 0.001,
        "photos": [{"id": 1, "file": "a.jpg", "sha256": "0a"}],
    });
    let results = file(&format!("{}.json", manifest.name), bytes);
    let provenance_name = format!("{}.provenance.json", manifest.name);
    file(&provenance_name, provenance.to_string().as_bytes());
    let folder = results.parent().expect("it lies in a folder");
    let _ = Recorded::open(folder, manifest).map(|r| r.of_photo("0a").map(<[_]>::len));
    file(&provenance_name, bytes);
    let _ = Recorded::open(folder, manifest);
}

/// Detections from outside: the bytes as a results list, as its images, as names of its categories and as a text file of YOLO's. What is read
/// are boxes with an area in the photo or over its border, best first.
pub fn results(bytes: &[u8]) {
    let given = file("given.json", bytes);
    let coco = file(
        "list.json",
        br#"[{"image_id": 1, "category_id": 3, "bbox": [1, 2, 30, 40], "score": 0.9}]"#,
    );
    let folder = given.with_file_name("yolo");
    std::fs::create_dir_all(&folder).expect("a folder for the text");
    let text = |bytes| std::fs::write(folder.join("a.txt"), bytes).expect("a text of boxes");
    let photos = [PhotoName::new(Path::new("/s"), "photos/a.jpg")];
    let read = |path: &Path, images: Option<&Path>, categories: Option<&Path>| {
        let name = "given";
        let request = ResultsRequest {
            first_label: None,
            name,
            path,
            images,
            categories,
            photos: &photos,
        };
        let Ok(found) = OutsideResults::open(&request).and_then(|results| results.of_photo(0, "a.jpg", [64, 48]))
        else {
            return;
        };
        assert!(
            found.len() <= 100
                && found
                    .iter()
                    .all(|d| d.box_px.is_solid() && (0.001..=1.0).contains(&d.score))
        );
        assert!(found.is_sorted_by(|a, b| a.score >= b.score));
    };
    read(&given, None, None);
    read(&given, Some(&given), None);
    read(&coco, Some(&given), None);
    read(&coco, None, Some(&given));
    text(bytes);
    read(&folder, None, None);
    text(b"2 0.5 0.5 0.25 0.3 0.91\n");
    read(&folder, None, Some(&given));
}

/// What a program says: a hello, also of a defence, an answer about a photo of 64 × 48 px, a manifest that starts it, and a command line.
pub fn program(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let labels = protocol::Hello::parse(text).map_or(Labels::Coco80, |hello| hello.labels);
    if let Ok(found) = protocol::detections(text, 1, [64, 48], labels) {
        assert!(
            found.len() <= 100
                && found
                    .iter()
                    .all(|d| d.box_px.is_solid() && labels.name(d.label).is_some())
        );
        assert!(found.is_sorted_by(|a, b| a.score >= b.score));
    }
    if let Ok(Some(loss)) = protocol::loss(text, 1, [64, 48]) {
        assert!(loss >= 0.0);
    }
    let _ = protocol::Hello::parse_of_defence(text);
    let _ = protocol::image(text, 1, [64, 48]);
    let _ = ProgramSpec::parse(text, Path::new("mine.toml"));
    let _ = ProgramSpec::named(&format!("exec:{text}"));
}

/// Shard files: the bytes as they are, and behind a head that says they are whole; what is read can be written and read again.
pub fn shard(bytes: &[u8]) {
    static HEAD: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let (run, id, observed) = (Run::default(), ShardId { index: 1, count: 1 }, Vec::new());
        let written = Shard { run, id, observed }.write(&folder());
        let file = std::fs::read(written.expect("the temporary folder takes files")).expect("it was written");
        file.split_inclusive(|b| *b == b'\n')
            .next()
            .unwrap_or_default()
            .to_vec()
    });
    let _ = shard::whole_run(&[file("shard", bytes)]);
    let sum = sha256_hex(bytes) + "\n";
    let path = file("shard", &[&HEAD, sum.as_bytes(), bytes].concat());
    let Ok(shard) = Shard::open(&path) else { return };
    let _ = shard::whole_run(&[path]);
    let written = shard.write(&folder()).expect("a shard can be written");
    let again = Shard::open(&written);
    std::fs::remove_file(written).expect("it was written");
    // Debug writes a float that is no number as itself, where == says no.
    assert_eq!(format!("{:?}", again.ok()), format!("{:?}", Some(shard)));
}

/// Lists of frames: what is opened can be read, or says why not.
pub fn frames(bytes: &[u8]) {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| frames_folder("frames"));
    std::fs::write(FOLDER.join("frames.json"), bytes).expect("the temporary folder takes files");
    let Ok(set) = FrameSet::open(&FOLDER) else { return };
    for frame in set.list.frames.iter().take(2) {
        let _ = set.check_images(frame);
    }
}

/// A folder with one picture of each kind that frames have.
pub fn frames_folder(name: &str) -> PathBuf {
    let pictures = [
        ("rgb.png", RgbImage::new(8, 6).into()),
        ("mask.png", GrayImage::from_pixel(8, 6, Luma([255])).into()),
        ("linear.png", DynamicImage::new_rgb16(8, 6)),
        ("sides.png", GrayImage::from_pixel(8, 6, Luma([1])).into()),
    ];
    pictures_in(name, &pictures)
}

/// The table of poses of another engine, beside a picture and its mask.
pub fn poses(bytes: &[u8]) {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
        let picture = || DynamicImage::from(RgbImage::from_pixel(8, 6, Rgb([0, 0, 142])));
        let folder = pictures_in("poses", &[("rgb/a.png", picture()), ("mask/a.png", picture())]);
        let about = r#"{"field_of_view_deg": 90, "object_rgb": [[0, 0, 142]], "target_height_m": 0.7}"#;
        std::fs::write(folder.join("import.json"), about).expect("the temporary folder takes files");
        folder
    });
    std::fs::write(FOLDER.join("poses.csv"), bytes).expect("the temporary folder takes files");
    let _ = import_frames(&FOLDER, Path::new("out"), "");
}

fn pictures_in(name: &str, pictures: &[(&str, DynamicImage)]) -> PathBuf {
    let folder = folder().join(name);
    std::fs::create_dir_all(&folder).expect("the temporary folder takes files");
    for (file, picture) in pictures {
        let path = folder.join(file);
        std::fs::create_dir_all(path.parent().unwrap_or(&folder)).expect("the temporary folder takes files");
        picture.save(path).expect("the temporary folder takes files");
    }
    folder
}

fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

/// A folder of this process.
fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("scaleproof-parsers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder takes files");
    folder
}

/// Some bytes as a file.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    std::fs::write(&path, bytes).expect("the temporary folder takes files");
    path
}
