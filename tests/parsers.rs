//! Every parser of user files on the fuzzing corpus and on damaged copies of it: an answer or an error, never a panic.

use crate::fuzz_entry as entry;

use std::path::Path;

use rand::rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Damaged copies of each corpus file.
const COPIES: usize = 200;

/// The files of a corpus, in the order of their names.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Cut, overwritten, with a part twice or left out, or with another file's part, as chance says.
fn damaged(file: &[u8], other: &[u8], random: &mut Pcg32) -> Vec<u8> {
    let mut copy = file.to_vec();
    let mut below = |limit: usize| random.next_u32() as usize % limit.max(1);
    for _ in 0..=below(4) {
        let (from, length) = (below(copy.len()), below(16));
        let to = (from + length).min(copy.len());
        let part = copy[from..to].to_vec();
        match below(6) {
            0 => copy.truncate(from),
            1 => drop(copy.splice(from..to, [])),
            2 => drop(copy.splice(from..from, part)),
            3 => copy[from..to].iter_mut().for_each(|b| *b = below(256) as u8),
            4 => {
                let at = below(other.len());
                let piece = &other[at..(at + length).min(other.len())];
                drop(copy.splice(from..to, piece.iter().copied()));
            }
            _ => {
                let words = [
                    "nan",
                    "-1",
                    "1e999",
                    "99999999999999999999",
                    "\"",
                    "[",
                    "\n",
                    ": ",
                    "0x7f",
                    "é",
                ];
                drop(copy.splice(from..to, words[below(words.len())].bytes()));
            }
        }
    }
    copy
}

fn survives(name: &str, parse: fn(&[u8])) {
    let files = corpus(name);
    let mut random = Pcg32::seed_from_u64(4);
    parse(b"");
    for (i, file) in files.iter().enumerate() {
        parse(file);
        for _ in 0..COPIES {
            parse(&damaged(file, &files[(i + 1) % files.len()], &mut random));
        }
    }
    println!("{name}: {} files, {} damaged copies", files.len(), files.len() * COPIES);
}

#[test]
fn camera_files() {
    survives("camera", entry::camera);
}

#[test]
fn words_of_ffmpeg() {
    survives("ffmpeg", entry::ffmpeg);
}

#[test]
fn answers_of_ffprobe() {
    survives("ffprobe", entry::ffprobe);
}

#[test]
fn motion_jpegs() {
    survives("motion_jpeg", entry::motion_jpeg);
}

#[test]
fn scene_files() {
    survives("scene", entry::scene);
}

#[test]
fn session_files() {
    survives("session", entry::session);
}

#[test]
fn annotations_in_coco() {
    survives("coco", entry::coco);
}

#[test]
fn annotations_in_tables() {
    survives("table", entry::table);
}

#[test]
fn patterns() {
    survives("pattern", entry::pattern);
}

#[test]
fn printer_files() {
    survives("printer", entry::printer);
}

#[test]
fn detector_manifests() {
    survives("manifest", entry::manifest);
}

#[test]
fn darknet_networks() {
    survives("darknet", entry::darknet);
}

#[test]
fn onnx_networks() {
    survives("onnx", entry::onnx);
}

#[test]
fn preprocessors_of_transformers() {
    survives("preprocessor", entry::preprocessor);
}

#[test]
fn board_definitions() {
    survives("board", entry::board);
}

#[test]
fn photos() {
    survives("photo", entry::photo);
}

#[test]
fn shards() {
    survives("shard", entry::shard);
}

#[test]
fn recordings() {
    survives("recording", entry::recording);
}

#[test]
fn detections_from_outside() {
    survives("results", entry::results);
}

#[test]
fn what_programs_say() {
    survives("program", entry::program);
}

#[test]
fn palettes() {
    survives("palette", entry::palette);
}

#[test]
fn lists_of_frames() {
    survives("frames", entry::frames);
}

#[test]
fn poses_of_another_engine() {
    survives("poses", entry::poses);
}

#[test]
fn meshes_in_glb() {
    survives("glb", entry::glb);
}

#[test]
fn meshes_in_obj() {
    survives("obj", entry::obj);
}

#[test]
fn meshes_in_stl() {
    survives("stl", entry::stl);
}

#[test]
fn meshes_in_ply() {
    survives("ply", entry::ply);
}

#[test]
fn material_libraries() {
    survives("mtl", entry::mtl);
}

#[test]
fn texels_of_triangles() {
    survives("npy", entry::npy);
}

/// The corpus must reach past the first check of each parser, or the tests above say little.
#[test]
fn the_corpus_has_files_that_are_accepted() {
    use scaleproof_pose::camera::Camera;
    use scaleproof_pose::scene::Classes;
    use scaleproof_session::import;
    let read = |bytes: &Vec<u8>| Camera::parse(std::str::from_utf8(bytes).unwrap_or(""), Path::new("camera")).is_ok();
    assert!(corpus("camera").iter().filter(|bytes| read(bytes)).count() >= 7);
    type Parser = fn(&str, &Classes) -> Result<import::ImportedRows, import::ImportFault>;
    let rows = |name: &str, parse: Parser| {
        let texts = corpus(name).into_iter().map(|bytes| String::from_utf8(bytes).unwrap());
        let read = texts.map(|text| parse(&text, &"car".parse().unwrap()));
        read.flatten().map(|(rows, _)| rows.len()).sum::<usize>()
    };
    assert!(rows("coco", import::coco::parse) >= 4 && rows("table", import::csv::parse) >= 4);
    let usual = scaleproof_detect::Manifest::named("deimv2_atto").unwrap().input;
    let prepared = |json: &Vec<u8>| scaleproof_detect::preprocessed(json, &usual, true).is_ok();
    assert!(corpus("preprocessor").iter().all(prepared));
    let folder = tempfile::tempdir().unwrap();
    let opened = corpus("photo").into_iter().filter(|bytes| {
        let path = folder.path().join("photo");
        std::fs::write(&path, bytes).unwrap();
        scaleproof_photo::Photo::open(&path).is_ok_and(|photo| photo.rgb(1).is_ok())
    });
    assert!(opened.count() >= 4);
    let folder = entry::frames_folder("accepted");
    let whole = corpus("frames").into_iter().filter(|list| {
        std::fs::write(folder.join("frames.json"), list).unwrap();
        let set = scaleproof_frames::FrameSet::open(&folder);
        set.is_ok_and(|set| set.list.frames.iter().all(|frame| set.check_images(frame).is_ok()))
    });
    assert!(whole.count() >= 1);
    let meshes = [("glb", 4), ("ply", 2), ("mtl", 2)];
    for (format, least) in meshes {
        let folder = tempfile::tempdir().unwrap();
        image::RgbImage::new(2, 2).save(folder.path().join("p.png")).unwrap();
        let textured = corpus(format)
            .into_iter()
            .filter(|bytes| textured(format, bytes, folder.path()));
        assert!(textured.count() >= least, "{format}");
    }
    let texels = corpus("npy").into_iter().filter(|bytes| {
        let path = folder.join("t.npy");
        std::fs::write(&path, bytes).unwrap();
        scaleproof_surface::texture::FaceTexels::load(&path, &scaleproof_surface::mesh::Mesh::cuboid([1.0; 3])).is_ok()
    });
    assert!(texels.count() >= 3);
}

/// Whether a mesh has images that can be laid on it.
fn textured(format: &str, bytes: &[u8], folder: &Path) -> bool {
    use scaleproof_surface::mesh::{Mesh, MeshPlacement};
    let path = match format {
        "mtl" => {
            std::fs::write(folder.join("m.mtl"), bytes).unwrap();
            let path = folder.join("m.obj");
            let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/3\n";
            std::fs::write(&path, text).unwrap();
            path
        }
        _ => {
            let path = folder.join(format!("m.{format}"));
            std::fs::write(&path, bytes).unwrap();
            path
        }
    };
    let mesh = Mesh::load(&path, &MeshPlacement::default());
    mesh.is_ok_and(|mesh| scaleproof_surface::texture::MappedImages::from_mesh(&mesh, &[]).is_ok())
}
