//! Pictures and files through whatever reaches a C library, one numbered item after the other.
//!
//! An item is named before work on it begins: when a sanitizer ends the process, the last line of its output says where. `../sanitize.sh`
//! builds and runs this, and goes on behind an item that failed.
//!
//! `scaleproof-sanitize raw|sizes|photos|corpus|boards [FIRST] [few]`: from item FIRST on; `few` is for valgrind, which takes fifty times as
//! long.

#[path = "../../entry.rs"]
mod entry;

use std::path::{Path, PathBuf};

use apriltag::{Detector, DetectorBuilder, Family, Image};
use image::imageops::{self, FilterType};
use image::{GrayImage, Luma};
use rand::rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_photo::Photo;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::locate;
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_pose::tags::{TagDetector, TagDetectorChoice};
use scaleproof_rig::calibrate;

/// Sides of the small pictures, px.
const SIDES: std::ops::RangeInclusive<u32> = 1..=64;

/// Those of them that are left for valgrind: some on either side of the guard.
const FEW_SIDES: [u32; 9] = [1, 4, 15, 16, 17, 24, 33, 48, 64];

/// The middle of a tag of 44 × 34 px in `captures/skyline/normal_000.jpg`.
const TAG_PX: [u32; 2] = [644, 372];

type Parser = fn(&[u8]);

/// The corpora by their folders.
const PARSERS: [(&str, Parser); 21] = [
    ("board", entry::board),
    ("camera", entry::camera),
    ("coco", entry::coco),
    ("frames", entry::frames),
    ("glb", entry::glb),
    ("manifest", entry::manifest),
    ("darknet", entry::darknet),
    ("obj", entry::obj),
    ("palette", entry::palette),
    ("pattern", entry::pattern),
    ("photo", entry::photo),
    ("ply", entry::ply),
    ("poses", entry::poses),
    ("preprocessor", entry::preprocessor),
    ("printer", entry::printer),
    ("recording", entry::recording),
    ("scene", entry::scene),
    ("session", entry::session),
    ("shard", entry::shard),
    ("stl", entry::stl),
    ("table", entry::table),
];

/// How much of a part is done.
struct Extent {
    first: usize,
    is_few: bool,
}

impl Extent {
    /// Does `work` on every item from the first on. `sanitize.sh` reads these lines.
    fn each<T>(&self, items: &[T], name: impl Fn(&T) -> String, mut work: impl FnMut(&T)) {
        for (number, item) in items.iter().enumerate().skip(self.first) {
            println!("item {number} {}", name(item));
            work(item);
        }
        println!("end {}", items.len());
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (part, rest) = arguments.split_first().expect("name a part");
    let extent = Extent {
        first: rest.iter().find_map(|word| word.parse().ok()).unwrap_or(0),
        is_few: rest.iter().any(|word| word == "few"),
    };
    match part.as_str() {
        "raw" => raw(&extent),
        "sizes" => sizes(&extent),
        "photos" => photos(&extent),
        "corpus" => corpus(&extent),
        "boards" => boards(&extent),
        other => panic!("there is no part {other}"),
    }
}

// --- the parts -----------------------------------------------------------------------------------------------------------

/// C AprilTag itself, below this program's guard against small pictures.
fn raw(extent: &Extent) {
    let contents = Contents::stored();
    // Made when first needed: the largest family takes a second, and this starts again behind every size that fails.
    let mut detectors: Vec<(TagFamily, Option<Detector>)> = families(extent.is_few).map(|f| (f, None)).collect();
    extent.each(&small_sizes(extent.is_few), size_name, |size| {
        let pictures = contents.of(*size);
        for (family, detector) in &mut detectors {
            let detector = detector.get_or_insert_with(|| c_detector(*family));
            for picture in &pictures {
                detector.detect(&c_image(picture));
            }
        }
    });
}

/// Small pictures through every tag detector of this program.
fn sizes(extent: &Extent) {
    let contents = Contents::stored();
    let mut detectors = tag_detectors(extent.is_few);
    extent.each(&small_sizes(extent.is_few), size_name, |size| {
        for picture in contents.of(*size) {
            for detector in &mut detectors {
                detector.find(&picture);
            }
        }
    });
}

/// The stored photos, whole and shrunk, through every tag detector; of the whole ones the pose too, which OpenCV begins.
fn photos(extent: &Extent) {
    let skyline = home("captures/skyline");
    let scene = Scene::open(&skyline.join("scene.toml")).expect("the stored scene");
    let camera = Camera::open(&skyline.join("camera.yaml")).expect("the stored camera");
    let (photos, divisors) = match extent.is_few {
        true => (files(&skyline, "jpg")[..2].to_vec(), 1..=2),
        false => {
            let sessions = folders(&home("captures"));
            (sessions.iter().flat_map(|s| files(s, "jpg")).collect(), 1..=4)
        }
    };
    let items: Vec<(&PathBuf, u32)> = photos
        .iter()
        .flat_map(|photo| divisors.clone().map(move |divisor| (photo, divisor)))
        .collect();
    let mut detectors = tag_detectors(extent.is_few);
    let name = |(photo, divisor): &(&PathBuf, u32)| format!("{} 1/{divisor}", photo.display());
    extent.each(&items, name, |(photo, divisor)| {
        let whole = Photo::open(photo)
            .expect("a stored photo")
            .luma()
            .expect("a whole photo");
        let [width, height] = [whole.width() / divisor, whole.height() / divisor];
        let grey = match divisor {
            1 => whole,
            _ => imageops::resize(&whole, width, height, FilterType::Triangle),
        };
        for detector in &mut detectors {
            let tags = detector.find(&grey);
            if *divisor == 1 {
                let _ = locate(&tags, &scene, &camera); // a board's photo has no pose
            }
        }
    });
}

/// The fuzzing corpus through its parsers, and pictures through every tag detector.
fn corpus(extent: &Extent) {
    stored_session_for_entry();
    let items: Vec<(String, PathBuf)> = folders(&home("fuzz/corpus"))
        .iter()
        .flat_map(|folder| {
            let name = folder
                .file_name()
                .expect("it has a name")
                .to_string_lossy()
                .into_owned();
            entries(folder).into_iter().map(move |file| (name.clone(), file))
        })
        .collect();
    let mut detectors = tag_detectors(extent.is_few);
    let name = |(_, file): &(String, PathBuf)| file.display().to_string();
    extent.each(&items, name, |(folder, file)| {
        let known = PARSERS.iter().find(|(name, _)| name == folder);
        let (_, parse) = known.expect("every folder of the corpus stands in PARSERS");
        parse(&std::fs::read(file).expect("the corpus can be read"));
        if folder == "photo"
            && let Ok(grey) = Photo::open(file).and_then(|photo| photo.luma())
        {
            detectors.iter_mut().for_each(|detector| drop(detector.find(&grey)));
        }
    });
}

/// Photos of a board, looked at for every kind of board; then the camera of all of them.
fn boards(extent: &Extent) {
    let mut photos = files(&home("captures/board"), "jpg");
    photos.truncate(if extent.is_few { 1 } else { usize::MAX });
    let all = (!extent.is_few).then_some(&photos[..]);
    let sets: Vec<&[PathBuf]> = photos.chunks(1).chain(all).collect();
    let boards = files(&home("calibration"), "toml");
    let items: Vec<(&[PathBuf], &PathBuf)> = boards
        .iter()
        .flat_map(|board| sets.iter().map(move |set| (*set, board)))
        .collect();
    let name = |(set, board): &(&[PathBuf], &PathBuf)| match set {
        [photo] => format!("{} as {}", photo.display(), board.display()),
        _ => format!("{} photos as {}", set.len(), board.display()),
    };
    extent.each(&items, name, |(set, board)| {
        let board = Definition::open(board).expect("a stored board");
        let (shots, left_out) = calibrate::look(set, &board, || {});
        if set.len() > 1 {
            let _ = calibrate::calibrate(shots, left_out, &board); // refused where the photos show another board
        }
    });
}

// --- small pictures ------------------------------------------------------------------------------------------------------

/// The smallest side first: what fails comes together.
fn small_sizes(is_few: bool) -> Vec<[u32; 2]> {
    let sides: Vec<u32> = match is_few {
        true => FEW_SIDES.to_vec(),
        false => SIDES.collect(),
    };
    let mut sizes: Vec<[u32; 2]> = sides.iter().flat_map(|w| sides.iter().map(|h| [*w, *h])).collect();
    sizes.sort_by_key(|[w, h]| (*w.min(h), *w.max(h)));
    sizes
}

fn size_name([width, height]: &[u32; 2]) -> String {
    format!("{width}x{height}")
}

/// What small pictures show.
struct Contents {
    /// A photo with a tag in it.
    photo: GrayImage,
}

impl Contents {
    fn stored() -> Contents {
        let photo = Photo::open(&home("captures/skyline/normal_000.jpg")).expect("a stored photo");
        Contents {
            photo: photo.luma().expect("a whole photo"),
        }
    }

    /// Black, white, noise of all greys and of two, a checkerboard, the middle of a tag as it is, and the whole tag made to fit.
    fn of(&self, [width, height]: [u32; 2]) -> [GrayImage; 7] {
        let mut random = Pcg32::seed_from_u64(u64::from(width << 16 | height));
        let noise = GrayImage::from_fn(width, height, |_, _| Luma([random.next_u32() as u8]));
        let mut two_greys = noise.clone();
        two_greys.iter_mut().for_each(|v| *v = if *v < 128 { 0 } else { 255 });
        let of_photo = |width: u32, height: u32| {
            let [x, y] = TAG_PX;
            imageops::crop_imm(&self.photo, x - width / 2, y - height / 2, width, height).to_image()
        };
        [
            GrayImage::new(width, height),
            GrayImage::from_pixel(width, height, Luma([255])),
            noise,
            two_greys,
            // Squares of 6 px: their 36 are more than the 25 from which C AprilTag looks at an area.
            GrayImage::from_fn(width, height, |x, y| {
                Luma([if (x / 6 + y / 6) % 2 == 0 { 0 } else { 255 }])
            }),
            of_photo(width, height),
            imageops::resize(&of_photo(64, 56), width, height, FilterType::Triangle),
        ]
    }
}

// --- detectors -----------------------------------------------------------------------------------------------------------

fn families(is_few: bool) -> impl Iterator<Item = TagFamily> {
    let all = TagFamily::ALL.into_iter().map(|(family, _)| family);
    all.filter(move |family| !is_few || *family == TagFamily::default())
}

/// Every detector, and its faster search for live pictures; for valgrind without the one that has no C.
fn tag_detectors(is_few: bool) -> Vec<Box<dyn TagDetector>> {
    let mut detectors = Vec::new();
    for choice in TagDetectorChoice::ALL.into_iter().chain(TagDetectorChoice::PEERS) {
        if is_few && matches!(choice, TagDetectorChoice::Locus | TagDetectorChoice::Cascade) {
            continue;
        }
        let families: Vec<TagFamily> = families(is_few).filter(|family| choice.reads(*family)).collect();
        detectors.push(choice.open(&families).expect("it reads these families"));
        detectors.extend(choice.open_live(&families).expect("it reads these families"));
    }
    detectors
}

/// As `crates/pose/src/tags/apriltag_c.rs` sets it up.
fn c_detector(family: TagFamily) -> Detector {
    let family = match family {
        TagFamily::Tag16h5 => Family::tag_16h5(),
        TagFamily::Tag25h9 => Family::tag_25h9(),
        TagFamily::Tag36h11 => Family::tag_36h11(),
        TagFamily::TagStandard41h12 => Family::tag_standard_41h12(),
        TagFamily::TagStandard52h13 => Family::tag_standard_52h13(),
        TagFamily::TagCircle21h7 => Family::tag_circle_21h7(),
        TagFamily::TagCircle49h12 => Family::tag_circle_49h12(),
        TagFamily::TagCustom48h12 => Family::tag_custom_48h12(),
    };
    let mut detector = DetectorBuilder::new()
        .add_family_bits(family, 1)
        .build()
        .expect("C AprilTag starts");
    detector.set_thread_number(1);
    detector.set_decimation(1.0);
    detector.set_refine_edges(true);
    detector
}

/// A copy in C AprilTag's memory, its rows aligned as in `crates/pose/src/tags/apriltag_c.rs`.
fn c_image(grey: &GrayImage) -> Image {
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    let mut image = Image::zeros_with_alignment(width, height, 96).expect("there is memory for it");
    let stride = image.stride();
    for (row, line) in grey.rows().enumerate() {
        let to = &mut image.as_slice_mut()[row * stride..][..width];
        to.iter_mut().zip(line).for_each(|(to, from)| *to = from.0[0]);
    }
    image
}

// --- files ---------------------------------------------------------------------------------------------------------------

/// A path in the project.
fn home(path: &str) -> PathBuf {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    above.expect("this package lies in fuzz/").join(path)
}

/// What lies in a folder, in the order of the names.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("it can be listed").path()).collect();
    paths.sort();
    paths
}

fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut paths = entries(folder);
    paths.retain(|path| path.extension().is_some_and(|e| e == extension));
    paths
}

fn folders(folder: &Path) -> Vec<PathBuf> {
    let mut paths = entries(folder);
    paths.retain(|path| path.is_dir());
    paths
}

/// `entry::session` looks for the stored session from the folders of the program and of `fuzz/`; from here it finds none, and takes what
/// already lies in its temporary folder.
fn stored_session_for_entry() {
    let folder = std::env::temp_dir().join(format!("scaleproof-parsers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder takes files");
    for name in ["scene.toml", "camera.yaml"] {
        let stored = home("captures/skyline").join(name);
        std::fs::copy(stored, folder.join(name)).expect("the temporary folder takes files");
    }
}
