//! From folders of photos to figures: `score` and `compare` of VARIANT=DIR, `session new` and `session show`, and the detectors at hand.

use crate::common;
use crate::common::onnx;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, contents, copy_of_skyline, program, read_json, shared, skyline, stderr, stdout};
use serde_json::Value;

/// Names as people give them.
const NORMAL: &str = "Fotos März = normal";
const RANDOM: &str = "zufällig (2)";

/// The stored photos in two folders, as a phone leaves them, and a detector that needs no download.
struct Desk {
    home: tempfile::TempDir,
}

impl Desk {
    fn new() -> Desk {
        let desk = Desk {
            home: tempfile::tempdir().unwrap(),
        };
        for folder in [NORMAL, RANDOM] {
            std::fs::create_dir(desk.at(folder)).unwrap();
        }
        for name in stored_photos() {
            let folder = if name.starts_with("normal") { NORMAL } else { RANDOM };
            // Cameras write their endings as they like.
            let own = name.replace("_00", " ü 00").replace("3.jpg", "3.JPG");
            std::fs::copy(skyline().join(&name), desk.at(folder).join(own)).unwrap();
        }
        for name in ["scene.toml", "camera.yaml"] {
            std::fs::copy(skyline().join(name), desk.at(name)).unwrap();
        }
        desk.write_detector();
        desk
    }

    fn at(&self, name: &str) -> PathBuf {
        self.home.path().join(name)
    }

    /// A network that finds a car in the middle of whatever it is shown: where the model is in some photos, and not in others.
    fn write_detector(&self) {
        let answer = vec![16.5, 24.7, 48.0, 42.7, 0.8, 2.0];
        let network = onnx::network(
            &[onnx::Input::floats("images", &[1, 3, 64, 64])],
            &[onnx::Output::floats("output0", &[1, 1, 6], answer)],
        );
        let hash = scaleproof_core::files::sha256_hex(&network);
        std::fs::write(self.at("made.onnx"), network).unwrap();
        let manifest = format!(
            "name = \"made\"\ntitle = \"Made\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = \"coco80\"\n[weights]\n\
             file = \"made.onnx\"\nsha256 = \"{hash}\"\n[input]\nsize_px = [64, 64]\nresize = \"stretch\"\nkernel = \"opencv_linear\"\n\
             channels = \"rgb\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\nkind = \"yolov10\"\n"
        );
        std::fs::write(self.at("made.toml"), manifest).unwrap();
    }

    /// The program in the desk's folder.
    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = program();
        // What the system can decode besides is another test's.
        command.current_dir(self.home.path()).env("PATH", "").args(arguments);
        command.output().unwrap()
    }

    fn succeeds(&self, arguments: &[&str]) -> Output {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        output
    }

    /// Both folders as arguments, with the scene and the camera.
    fn folders(&self) -> Vec<String> {
        let both = [format!("normal={NORMAL}"), format!("random={RANDOM}")];
        let about = ["--scene", "scene.toml", "--camera", "camera.yaml"].map(str::to_owned);
        both.into_iter().chain(about).collect()
    }

    /// A command on both folders.
    fn on_folders(&self, command: &[&str], more: &[&str]) -> Output {
        let folders = self.folders();
        let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
        self.run(&[command, &folders, more].concat())
    }

    /// Every file of both folders with its content.
    fn photos(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        [NORMAL, RANDOM]
            .iter()
            .flat_map(|folder| contents(&self.at(folder)))
            .collect()
    }
}

fn stored_photos() -> Vec<String> {
    let list = read_json(&skyline().join("session.json"));
    let photos = list["photos"].as_array().unwrap();
    photos.iter().map(|p| p["file"].as_str().unwrap().to_owned()).collect()
}

const MADE: [&str; 2] = ["--detector", "made.toml"];

#[test]
fn two_folders_have_the_figures_of_the_stored_session() {
    let desk = Desk::new();
    // What lies about is passed over, and images are named.
    std::fs::write(desk.at(NORMAL).join("IMG_9.HEIC"), b"x").unwrap();
    std::fs::write(desk.at(NORMAL).join("notes.txt"), b"x").unwrap();
    std::fs::write(desk.at(NORMAL).join(".hidden.jpg"), b"x").unwrap();
    std::fs::create_dir(desk.at(NORMAL).join("inner")).unwrap();
    std::fs::write(desk.at(NORMAL).join("inner/a.jpg"), b"x").unwrap();
    let before = desk.photos();
    let stored = skyline().display().to_string();

    desk.succeeds(&[&["score", &stored, "-o", "stored"][..], &MADE].concat());
    let scored = desk.on_folders(
        &["score"],
        &["--place", "yard", "-o", "own", "--json", "--detector", "made.toml"],
    );
    assert!(scored.status.success(), "{}", stderr(&scored));
    assert!(
        stderr(&scored).contains(
            "note: 1 image in Fotos März = normal is left out, being neither JPEG nor PNG or there in JPEG too (the first: IMG_9.HEIC: set the iPhone to"
        ),
        "{}",
        stderr(&scored)
    );
    let (own, then) = (
        read_json(&desk.at("own/summary.json")),
        read_json(&desk.at("stored/summary.json")),
    );
    assert_eq!((&own["photos_scored"], &own["results"]), (&16.into(), &then["results"]));
    assert_eq!(serde_json::from_slice::<Value>(&scored.stdout).unwrap(), own);
    // The detector finds some and misses others, so that equal figures say something.
    let hits: Vec<_> = own["results"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["overall"]["hit_rate"]["count"].as_u64())
        .collect();
    assert!(hits.iter().all(|hits| (1..8).contains(&hits.unwrap())), "{hits:?}");

    desk.succeeds(&[&["compare", &stored, "-o", "stored"][..], &MADE].concat());
    let compared = desk.on_folders(&["compare", "--detector", "made.toml"], &["--out", "own"]);
    assert!(compared.status.success(), "{}", stderr(&compared));
    let (own, then) = (
        read_json(&desk.at("own/comparison.json")),
        read_json(&desk.at("stored/comparison.json")),
    );
    assert_eq!(
        (&own["results"], own["results"][0]["pairs"].as_u64()),
        (&then["results"], Some(8))
    );
    assert_eq!(desk.photos(), before, "the user's folders are as they were");
}

/// A drive that is not there any more: a photo on it is missed, and said to be.
#[cfg(unix)]
#[test]
fn a_photo_that_leads_nowhere_is_among_those_left_out() {
    let desk = Desk::new();
    std::os::unix::fs::symlink("unplugged/a.jpg", desk.at(NORMAL).join("away.jpg")).unwrap();
    let scored = desk.on_folders(&["score"], &["--place", "yard", "-o", "own", "--detector", "made.toml"]);
    assert!(stderr(&scored).contains("away.jpg"), "{}", stderr(&scored));
    let summary = read_json(&desk.at("own/summary.json"));
    assert_eq!(summary["photos_scored"], 16);
    let left_out = summary["not_scored"].as_array().unwrap();
    let [away] = &left_out[..] else { panic!("{left_out:?}") };
    assert!(away["file"].as_str().unwrap().ends_with("away.jpg"), "{away}");
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn detectors_that_look_say_the_same_of_folders_too() {
    let weights = shared("detectors/FastestDet.onnx");
    let desk = Desk::new();
    std::fs::create_dir(desk.at("weights")).unwrap();
    std::fs::copy(weights, desk.at("weights/FastestDet.onnx")).unwrap();
    let scored = desk.on_folders(&["score"], &["--place", "yard", "--detectors", "weights", "-o", "own"]);
    assert!(scored.status.success(), "{}", stderr(&scored));
    // One of the five is here, and the others are named.
    assert!(
        stderr(&scored).contains(
            "note: not scored, because their weights are not here: yolox_nano, nanodet_m, deimv2_femto, deimv2_atto (get them with \
             `scaleproof detectors fetch`)"
        ),
        "{}",
        stderr(&scored)
    );
    let stored = skyline().display().to_string();
    desk.succeeds(&["score", &stored, "--detectors", "weights", "-o", "stored"]);
    let results = |folder: &str| read_json(&desk.at(folder).join("summary.json"))["results"].clone();
    assert_eq!(results("own"), results("stored"));
    assert_eq!(results("own").as_array().unwrap().len(), 2);
}

#[test]
fn one_texture_may_have_several_folders_and_each_bin_several_photos() {
    let desk = Desk::new();
    // The same names again, and other bytes: a second round of photos.
    std::fs::create_dir(desk.at("round 2")).unwrap();
    for (path, bytes) in contents(&desk.at(NORMAL)) {
        let again = desk.at("round 2").join(path.file_name().unwrap());
        std::fs::write(again, [bytes, vec![0]].concat()).unwrap();
    }
    let more = ["normal@yard=round 2", "-o", "out", "--detector", "made.toml"];
    let output = desk.on_folders(&["score"], &more);
    assert!(output.status.success(), "{}", stderr(&output));
    let summary = read_json(&desk.at("out/summary.json"));
    let normal = &summary["results"][0];
    assert_eq!(
        (&normal["variant"], &normal["overall"]["photos"]),
        (&"normal".into(), &16.into())
    );
    for bin in normal["azimuth_bins"].as_array().unwrap() {
        assert_eq!(bin["figures"]["photos"], 2, "{bin}");
    }
    assert_eq!(normal["places"][0]["place"], "here");
    // A photo is known by its folder and name.
    let mut rows = csv::Reader::from_path(desk.at("out/photos.csv")).unwrap();
    let files: std::collections::BTreeSet<String> = rows.records().map(|r| r.unwrap()[2].to_owned()).collect();
    assert_eq!(files.len(), 24);
    let named = format!("{NORMAL}/normal ü 000.jpg");
    assert!(
        files.contains(&named) && files.contains("round 2/normal ü 000.jpg"),
        "{files:?}"
    );
}

#[test]
fn folders_that_cannot_be_are_one_sentence_and_leave_nothing_behind() {
    let desk = Desk::new();
    std::fs::create_dir_all(desk.at("empty/inner")).unwrap();
    std::fs::create_dir(desk.at("phone")).unwrap();
    std::fs::write(desk.at("phone/a.heic"), b"x").unwrap();
    let before = contents(desk.home.path());
    let about = ["--scene", "scene.toml", "--camera", "camera.yaml"];
    let normal = format!("normal={NORMAL}");
    let again = format!("random=./{NORMAL}/../{NORMAL}");
    let stored = skyline().display().to_string();
    let cases: [(&[&str], &str); 16] = [
        (
            &[],
            "no photos are named: name session folders, or VARIANT=FOLDER for each texture with --scene and --camera",
        ),
        (
            &["normal="],
            "normal= names no folder: write VARIANT=FOLDER, as in normal=monday",
        ),
        (
            &["=empty"],
            "=empty names no texture: write VARIANT=FOLDER, as in normal=monday",
        ),
        (&["normal=nowhere"], "normal=nowhere: there is no such folder"),
        (
            &["normal=scene.toml"],
            "normal=scene.toml: this is a file; name the folder with the photos",
        ),
        (
            &["normal=empty/inner"],
            "normal=empty/inner: the folder has no JPEG or PNG files\n",
        ),
        (
            &["normal=empty"],
            "no JPEG or PNG files (those in folders inside it, as inner, are not read: name these)",
        ),
        (
            &["normal=phone"],
            "no JPEG or PNG files (it has a.heic: set the iPhone to",
        ),
        (&[&normal, &again], "is given twice: each photo counts once"),
        (
            &[&normal, &stored],
            "is no VARIANT=FOLDER as the others are: name sessions only, or make one",
        ),
        (&[&normal, "--place", " "], "has blanks around it or control characters"),
        (
            &[&normal, "--recorded"],
            "--recorded needs a session, and folders of photos get no files: make one with `scaleproof session new NAME`",
        ),
        (&[&normal, "--record"], "--record needs a session"),
        (&[&normal, "--shard", "1/2"], "--shard needs a session"),
        (&[&normal, "--replace"], "--record"),
        (&["normal =zufällig (2)"], "has blanks around it"),
    ];
    for (arguments, sentence) in cases {
        let output = desk.run(&[&["score"], arguments, &about, &MADE, &["-o", "out"]].concat());
        assert_refused(&output, &[]);
        assert!(
            stderr(&output).contains(sentence),
            "{sentence} is not in: {}",
            stderr(&output)
        );
    }
    let refused = |arguments: &[&str], words: &[&str]| assert_refused(&desk.run(arguments), words);
    for command in ["score", "compare"] {
        refused(
            &[command, &normal, "-o", "out", "--camera", "camera.yaml"],
            &["photos in folders need --scene scene.toml", "scaleproof scene"],
        );
        refused(
            &[command, &normal, "-o", "out", "--scene", "scene.toml"],
            &["photos in folders need --camera camera.yaml", "scaleproof calibrate"],
        );
        refused(
            &[command, &stored, "-o", "out", "--scene", "scene.toml"],
            &["--scene is for VARIANT=FOLDER only", "session.json"],
        );
        let among = [&[command, &normal][..], &about, &MADE, &["-o", NORMAL]].concat();
        refused(&among, &["the report would be written among the photos", NORMAL]);
    }
    assert_eq!(contents(desk.home.path()), before, "something was left behind");
}

#[test]
fn a_folder_that_is_no_session_is_answered_with_what_to_type() {
    let desk = Desk::new();
    std::fs::create_dir_all(desk.at("holiday/inner")).unwrap();
    std::fs::create_dir(desk.at("rounds")).unwrap();
    for name in ["a.jpg", "b.png"] {
        std::fs::write(desk.at("holiday").join(name), b"x").unwrap();
    }
    for texture in ["checker", "normal"] {
        std::fs::create_dir(desk.at("rounds").join(texture)).unwrap();
        std::fs::write(desk.at("rounds").join(texture).join("a.jpg"), b"x").unwrap();
    }
    let refused = |arguments: &[&str], words: &[&str]| assert_refused(&desk.run(arguments), words);
    for command in ["score", "compare"] {
        let more = ["--recorded", "-o", "out"];
        refused(
            &[&[command, "holiday"][..], &more].concat(),
            &[
                "holiday has no session.json: for its 2 photos of one texture give normal=holiday with --scene scene.toml and --camera \
               camera.yaml; or make a session: `scaleproof session new NAME normal=holiday --scene scene.toml --camera camera.yaml`",
            ],
        );
        refused(
            &[&[command, RANDOM][..], &more].concat(),
            &["for its 8 photos of one texture give 'normal=zufällig (2)' with"],
        );
        refused(
            &[&[command, "rounds"][..], &more].concat(),
            &[
                "rounds has no session.json: for the photos in its folders give checker=rounds/checker normal=rounds/normal with",
            ],
        );
        refused(
            &[&[command, "holiday/inner"][..], &more].concat(),
            &["holiday/inner has no session.json and no photos: name session folders, or VARIANT=FOLDER"],
        );
        refused(
            &[&[command, "holiday/a.jpg", "holiday/b.png"][..], &more].concat(),
            &["holiday/a.jpg is a photo: name its folder and the texture it shows, as in normal=holiday, with --scene"],
        );
        refused(&[&[command, "nowhere"][..], &more].concat(), &["cannot read nowhere"]);
    }
    refused(
        &["session", "show", "holiday"],
        &["holiday has no session.json: for its 2 photos"],
    );
    // What is typed as told works; the session in it is then found.
    std::fs::remove_dir_all(desk.at("holiday")).unwrap();
    let made = desk.on_folders(&["session", "new", "rounds/first"], &[]);
    assert!(made.status.success(), "{}", stderr(&made));
    refused(
        &["score", "rounds", "-o", "out"],
        &["rounds has no session.json, but rounds/first has one: name that"],
    );
}

#[test]
fn a_session_with_an_equal_sign_in_its_name_is_a_session() {
    let desk = Desk::new();
    std::fs::rename(copy_of_skyline().keep(), desk.at("normal=yard")).unwrap();
    desk.succeeds(&[
        "score",
        "normal=yard",
        "--recorded",
        "--detector",
        "fastestdet",
        "-o",
        "out",
    ]);
    assert_eq!(read_json(&desk.at("out/summary.json"))["photos_scored"], 16);
    // One that is no session is answered as any folder.
    std::fs::create_dir(desk.at("a=b")).unwrap();
    assert_refused(
        &desk.run(&["score", "a=b", "-o", "out"]),
        &["a=b has no session.json and no photos"],
    );
}

#[test]
fn a_new_session_is_scored_as_its_folders_are() {
    let desk = Desk::new();
    let before = desk.photos();
    let scored = desk.on_folders(&["score"], &["--place", "yard", "-o", "own", "--detector", "made.toml"]);
    assert!(scored.status.success(), "{}", stderr(&scored));
    let wanted = read_json(&desk.at("own/summary.json"))["results"].clone();
    for (name, more) in [("named", &[][..]), ("deep/copied session", &["--copy"])] {
        let made = desk.on_folders(&["session", "new", name], &[&["--place", "yard"], more].concat());
        assert!(made.status.success(), "{}", stderr(&made));
        let text = stdout(&made);
        assert!(
            text.contains("16 photos (normal 8, random 8); score them with `scaleproof score "),
            "{text}"
        );
        desk.succeeds(&[&["score", name, "-o", "report"][..], &MADE].concat());
        assert_eq!(read_json(&desk.at("report/summary.json"))["results"], wanted, "{name}");
        if name == "named" {
            let refused = desk.on_folders(&["session", "new", name], &[]);
            assert_refused(&refused, &[name, "already: each photo counts once"]);
        }
    }
    let list = |name: &str| read_json(&desk.at(name).join("session.json"));
    assert_eq!(
        list("named")["photos"][0]["file"],
        format!("../{NORMAL}/normal ü 000.jpg")
    );
    let copied = list("deep/copied session");
    assert_eq!(copied["photos"][0]["file"], format!("{NORMAL}/normal ü 000.jpg"));
    assert_eq!(
        (&copied["scene"], &copied["camera"]),
        (&"scene.toml".into(), &"camera.yaml".into())
    );
    assert_eq!(desk.photos(), before, "the user's folders are as they were");
    // With its copies the session goes anywhere.
    std::fs::rename(desk.at("deep"), desk.at("moved")).unwrap();
    for folder in [NORMAL, RANDOM] {
        std::fs::remove_dir_all(desk.at(folder)).unwrap();
    }
    desk.succeeds(&[&["score", "moved/copied session", "-o", "report"][..], &MADE].concat());
    assert_eq!(read_json(&desk.at("report/summary.json"))["results"], wanted);
}

#[test]
fn a_new_session_is_whole_or_nothing_and_replaces_nothing() {
    let desk = Desk::new();
    let about = ["--scene", "scene.toml", "--camera", "camera.yaml"];
    let normal = format!("normal={NORMAL}");
    std::fs::create_dir(desk.at("there")).unwrap();
    std::fs::write(desk.at("there/scene.toml"), b"mine").unwrap();
    let before = contents(desk.home.path());
    let refused = |arguments: &[&str], words: &[&str]| {
        assert_refused(&desk.run(&[&["session", "new"], arguments].concat()), words);
        assert_eq!(
            contents(desk.home.path()),
            before,
            "{arguments:?} left something behind"
        );
    };
    refused(
        &[&["there", &normal][..], &about].concat(),
        &["there/scene.toml is there already and another file: name a new folder for the session"],
    );
    refused(
        &[&["there", &normal, "--copy"][..], &about].concat(),
        &["there has files already\nhint: with --copy name a new folder"],
    );
    refused(
        &[&["camera.yaml", &normal][..], &about].concat(),
        &["cannot write camera.yaml"],
    );
    refused(
        &[&["new"][..], &about].concat(),
        &["no photos are named: add VARIANT=FOLDER for each texture"],
    );
    refused(
        &[&[normal.as_str()][..], &about].concat(),
        &["is taken for the session's folder: name that first, as in `scaleproof session new NAME"],
    );
    refused(
        &[&["new", NORMAL][..], &about].concat(),
        &["is no VARIANT=FOLDER", "normal=monday"],
    );
    refused(
        &["new", &normal, "--scene", "camera.yaml", "--camera", "camera.yaml"],
        &["camera.yaml"],
    );
    refused(
        &["new", &normal, "--scene", "scene.toml"],
        &["photos in folders need --camera"],
    );

    // A photo that cannot be copied: no folder at all.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let photo = desk.at(NORMAL).join("normal ü 007.jpg");
        std::fs::set_permissions(&photo, std::fs::Permissions::from_mode(0o000)).unwrap();
        // Who may read everything cannot be refused.
        if std::fs::read(&photo).is_err() {
            let output = desk.run(&[&["session", "new", "new", &normal, "--copy"][..], &about].concat());
            assert_refused(&output, &["cannot write", "copying", "permission denied"]);
            assert!(!desk.at("new").exists());
        }
        std::fs::set_permissions(&photo, std::fs::Permissions::from_mode(0o644)).unwrap();
    }
    let hidden = std::fs::read_dir(desk.home.path())
        .unwrap()
        .filter(|e| e.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'));
    assert_eq!(hidden.count(), 0);
}

/// The folder that has the photos, the scene and the camera becomes the session: nothing is copied.
#[test]
fn a_folder_of_folders_becomes_a_session_in_its_place() {
    let desk = Desk::new();
    let before = contents(desk.home.path());
    let output = desk.on_folders(&["session", "new", "."], &["--json", "--place", "garden"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let made: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&made["photos"], &made["variants"], &made["places"], &made["copied"]),
        (
            &16.into(),
            &serde_json::json!({"normal": 8, "random": 8}),
            &serde_json::json!(["garden"]),
            &false.into()
        )
    );
    let mut now = contents(desk.home.path());
    now.retain(|path, _| path.file_name().unwrap() != "session.json");
    assert_eq!(now, before);
    let list = read_json(&desk.at("session.json"));
    assert_eq!(list["photos"][8]["file"], format!("{RANDOM}/random ü 008.jpg"));
    assert_eq!(
        (&list["scene"], &list["photos"][8]["place"]),
        (&"scene.toml".into(), &"garden".into())
    );
}

/// The truth boxes' mesh goes with the scene, or the session could not be opened.
#[test]
fn a_scene_is_copied_with_its_mesh() {
    let desk = Desk::new();
    let scene = std::fs::read_to_string(desk.at("scene.toml")).unwrap();
    let with = |mesh: &str| {
        let text = scene.replace("envelope = \"box\"", &format!("envelope = \"hull\"\nmesh = \"{mesh}\""));
        std::fs::write(desk.at("scene.toml"), text).unwrap();
    };
    let [l, w, h] = [227.5, 92.85, 129.1];
    let corners = [
        [-l, -w, 0.0],
        [l, -w, 0.0],
        [0.0, w, 0.0],
        [0.0, 0.0, h],
        [-l, w, 0.0],
        [l, w, h],
    ];
    let points: String = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    std::fs::create_dir(desk.at("meshes")).unwrap();
    std::fs::write(desk.at("meshes/m.obj"), points + "f 1 2 4\nf 2 3 4\nf 1 5 6\n").unwrap();
    with("meshes/m.obj");
    let made = desk.on_folders(&["session", "new", "new"], &[]);
    assert!(made.status.success(), "{}", stderr(&made));
    assert_eq!(
        std::fs::read(desk.at("new/meshes/m.obj")).unwrap(),
        std::fs::read(desk.at("meshes/m.obj")).unwrap()
    );
    desk.succeeds(&["session", "show", "new"]);
    std::fs::create_dir(desk.at("scenes")).unwrap();
    with("../meshes/m.obj");
    std::fs::rename(desk.at("scene.toml"), desk.at("scenes/scene.toml")).unwrap();
    let folders = [format!("normal={NORMAL}")];
    let output = desk.run(&[
        "session",
        "new",
        "other",
        &folders[0],
        "--scene",
        "scenes/scene.toml",
        "--camera",
        "camera.yaml",
    ]);
    assert_refused(
        &output,
        &["the scene's mesh ../meshes/m.obj does not lie below the scene's folder"],
    );
    assert!(!desk.at("other").exists());
}

#[test]
fn a_session_is_shown_on_one_screen() {
    let show = |session: &Path, more: &[&str]| {
        let output = program()
            .args(["session", "show"])
            .arg(session)
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    let text = show(&skyline(), &[]);
    let wanted = [
        "skyline: 16 photos",
        "model    skyline-r32, 1:10, 455 × 185.7 × 129.1 mm, detected as car; truth envelope: box",
        "tags     24 (tag36h11)",
        "bins     8: azimuth every 45°, pitch 15°, distance 850 mm",
        "camera   1280 × 960 px, focal length 1180 px",
        "photos   8 normal, place yard",
        "         8 random, place yard",
        "recorded deimv2_atto (16 photos), deimv2_femto (16 photos), fastestdet (16 photos), nanodet_m (16 photos), yolox_nano (16 photos)",
    ];
    assert_eq!(text.lines().collect::<Vec<_>>(), wanted);
    let page: Value = serde_json::from_str(&show(&skyline(), &["--json"])).unwrap();
    assert_eq!(
        (
            &page["photos"],
            &page["scene"]["class"],
            &page["scene"]["bins"]["count"],
            &page["camera"]["width_px"]
        ),
        (&16.into(), &"car".into(), &8.into(), &1280.into())
    );
    assert_eq!(
        page["groups"][1],
        serde_json::json!({"variant": "random", "place": "yard", "photos": 8})
    );
    assert_eq!(
        page["recordings"][0],
        serde_json::json!({"detector": "deimv2_atto", "photos": 16})
    );
    assert_eq!(
        (&page["notes"], &page["unreadable"]),
        (&serde_json::json!([]), &serde_json::json!([]))
    );

    // What is amiss: a photo that is gone, one that was exchanged, a copy, a recording that was spoilt.
    let session = copy_of_skyline();
    let at = |name: &str| session.path().join(name);
    std::fs::remove_file(at("normal_000.jpg")).unwrap();
    std::fs::copy(at("random_009.jpg"), at("random_010.jpg")).unwrap();
    let mut bytes = std::fs::read(at("normal_001.jpg")).unwrap();
    bytes.push(0);
    std::fs::write(at("normal_001.jpg"), bytes).unwrap();
    std::fs::write(at("recorded/nanodet_m.json"), "[]").unwrap();
    let text = show(session.path(), &[]);
    for line in [
        "note     1 photo cannot be read (the first: cannot read ",
        "note     1 photo is a byte-for-byte copy of another (the first: random_010.jpg)",
        "note     1 photo has no recorded detections of yolox_nano (the first: normal_001.jpg): it is new, or another file than the one recorded",
        "nanodet_m.json is not the recording of nanodet_m",
        "yolox_nano (14 photos)",
    ] {
        assert!(text.contains(line), "`{line}` is not in: {text}");
    }
    let page: Value = serde_json::from_str(&show(session.path(), &["--json"])).unwrap();
    assert_eq!(page["unreadable"][0]["file"], "normal_000.jpg");
    assert!(page["notes"].as_array().unwrap().len() >= 6, "{page}");
}

#[test]
fn recordings_are_replaced_only_when_told_to() {
    let desk = Desk::new();
    assert!(desk.on_folders(&["session", "new", "s"], &[]).status.success());
    let score = |more: &[&str]| desk.run(&[&["score", "s", "-o", "out"], more].concat());
    assert_refused(
        &score(&["--recorded"]),
        &["s has no recordings: run without --recorded, or store them with `scaleproof score s --record -o DIR`"],
    );
    let recorded = score(&[&MADE[..], &["--record"]].concat());
    assert!(recorded.status.success(), "{}", stderr(&recorded));
    let before = contents(&desk.at("s/recorded"));
    assert_eq!(before.len(), 2);
    std::fs::remove_dir_all(desk.at("out")).unwrap();
    assert_refused(
        &score(&[&MADE[..], &["--record"]].concat()),
        &["s has a recording of made already\nhint: add --replace to store it anew, or play it with --recorded"],
    );
    assert!(!desk.at("out").exists(), "refused before the work");
    assert_eq!(contents(&desk.at("s/recorded")), before);
    let replaced = score(&[&MADE[..], &["--record", "--replace"]].concat());
    assert!(replaced.status.success(), "{}", stderr(&replaced));
    // The detector is the user's own, so that only its manifest can play it.
    assert_refused(
        &score(&["--recorded"]),
        &["name their manifests, as in --detector made.toml"],
    );
    assert!(score(&[&MADE[..], &["--recorded"]].concat()).status.success());
    // Exchanged photos that lie elsewhere must not get the old detections either.
    let photo = desk.at(NORMAL).join("normal ü 000.jpg");
    let mut bytes = std::fs::read(&photo).unwrap();
    bytes.push(0);
    std::fs::write(&photo, bytes).unwrap();
    assert_refused(
        &score(&[&MADE[..], &["--recorded"]].concat()),
        &["normal ü 000.jpg has no recorded detections"],
    );
}

#[test]
fn recordings_that_are_there_are_played_and_the_others_are_named() {
    let session = copy_of_skyline();
    for name in ["yolox_nano", "deimv2_atto"] {
        for ending in ["json", "provenance.json"] {
            std::fs::remove_file(session.path().join(format!("recorded/{name}.{ending}"))).unwrap();
        }
    }
    let out = tempfile::tempdir().unwrap();
    for command in ["score", "compare"] {
        let mut run = program();
        run.arg(command)
            .arg(session.path())
            .args(["--recorded", "--json", "-o"])
            .arg(out.path());
        let output = run.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(
            stderr(&output).contains("has no recordings of them: yolox_nano, deimv2_atto (run without --recorded, or store them with --record)"),
            "{}",
            stderr(&output)
        );
        let page: Value = serde_json::from_slice(&output.stdout).unwrap();
        let names: std::collections::BTreeSet<&str> = page["results"]
            .as_array()
            .unwrap()
            .iter()
            .map(|r| r["detector"].as_str().unwrap())
            .collect();
        assert_eq!(
            names.into_iter().collect::<Vec<_>>(),
            ["deimv2_femto", "fastestdet", "nanodet_m"]
        );
    }
    // Two sessions play what both have.
    let other = copy_of_skyline();
    for name in ["deimv2_femto", "fastestdet", "nanodet_m"] {
        for ending in ["json", "provenance.json"] {
            std::fs::remove_file(other.path().join(format!("recorded/{name}.{ending}"))).unwrap();
        }
    }
    let mut both = program();
    both.arg("score")
        .args([session.path(), other.path()])
        .args(["--recorded", "-o"])
        .arg(out.path());
    assert_refused(
        &both.output().unwrap(),
        &["the sessions have no recordings of one detector in common"],
    );
}

#[test]
fn without_any_weights_the_way_to_them_is_said() {
    let desk = Desk::new();
    let output = desk.on_folders(&["score"], &["-o", "out"]);
    assert_refused(
        &output,
        &["no detector's weights are here: get them with `scaleproof detectors fetch`\n"],
    );
    let stored = skyline().display().to_string();
    let output = desk.run(&["compare", &stored, "-o", "out"]);
    assert_refused(
        &output,
        &["`scaleproof detectors fetch`, or score what the session stores with --recorded"],
    );
    assert!(!desk.at("out").exists());
}

#[test]
fn shards_and_merged_runs_speak_json() {
    let desk = Desk::new();
    let parsed = |output: Output| serde_json::from_slice::<Value>(&output.stdout).unwrap();
    let stored = skyline().display().to_string();
    let part = ["score", stored.as_str(), "--shard", "1/1", "--json", "-o", "parts"];
    let shard = parsed(desk.succeeds(&[&part[..], &MADE].concat()));
    assert_eq!(shard["shard"], "1/1");
    let merged = desk.succeeds(&["merge", shard["file"].as_str().unwrap(), "--json", "-o", "merged"]);
    assert_eq!(parsed(merged), read_json(&desk.at("merged/summary.json")));
}

/// A session from a stranger may name any file to be read; it is no photo, and nothing is written beside it.
#[test]
fn a_session_that_names_files_outside_reads_photos_and_writes_nothing_there() {
    let desk = Desk::new();
    assert!(desk.on_folders(&["session", "new", "s"], &[]).status.success());
    std::fs::write(desk.at("secret.txt"), b"secret").unwrap();
    let path = desk.at("s/session.json");
    let mut list = read_json(&path);
    list["photos"][0]["file"] = "../secret.txt".into();
    list["photos"][1]["file"] = "../../../../../../../../../../dev/zero".into();
    std::fs::write(&path, list.to_string()).unwrap();
    let before = contents(desk.home.path());
    let output = desk.succeeds(&[&["score", "s", "--record", "-o", "s/report"][..], &MADE].concat());
    let complaints = stderr(&output);
    assert!(
        complaints.contains("secret.txt is not a JPEG or PNG") && complaints.contains("dev/zero: it is not a file"),
        "{complaints}"
    );
    let mut now = contents(desk.home.path());
    now.retain(|path, _| !path.starts_with(desk.at("s/report")) && !path.starts_with(desk.at("s/recorded")));
    assert_eq!(now, before);
    for file in ["/etc/passwd", "a/../../secret.txt", ".."] {
        list["photos"][0]["file"] = file.into();
        std::fs::write(&path, list.to_string()).unwrap();
        assert_refused(
            &desk.run(&["session", "show", "s"]),
            &["no path from the session's folder: write it as photos/a.jpg or ../photos/a.jpg"],
        );
    }
}

/// Photos that fail alike have one cause, with the names of the files that it lies in.
#[test]
fn folders_with_another_cameras_file_are_told_so_once() {
    let desk = Desk::new();
    let camera = std::fs::read_to_string(desk.at("camera.yaml")).unwrap();
    std::fs::write(desk.at("camera.yaml"), camera.replace("1180.0", "1357.0")).unwrap();
    let output = desk.on_folders(&["score", "--detector", "made.toml"], &["-o", "report"]);
    let text = stderr(&output);
    assert_eq!(
        text.matches("the focal length in camera.yaml seems 15 % too long")
            .count(),
        1,
        "{text}"
    );
    let left_out = text.lines().filter(|line| line.starts_with("not scored: "));
    assert_eq!(left_out.count(), 1, "{text}");
    // Where a photo was scored all the same, it stands beside the figures.
    let cautions = read_json(&desk.at("report/summary.json"))["cautions"].to_string();
    assert!(cautions.contains("seems 15 % too long"), "{cautions}");
}

/// A detector that calls the model by another name has the figures of one that calls it as the scene does, when its manifest says so; every output says
/// what counted.
#[test]
fn a_label_of_another_name_counts_as_the_manifest_says() {
    let desk = Desk::new();
    let manifest = std::fs::read_to_string(desk.at("made.toml")).unwrap();
    let own = manifest.replace("labels = \"coco80\"", "labels = [\"Person\", \"Rad\", \"PKW\"]");
    std::fs::write(
        desk.at("german.toml"),
        own.replace("name = \"made\"", "name = \"german\"") + "[class_map]\nPKW = \"car\"\n",
    )
    .unwrap();
    let scored = desk.on_folders(
        &["score", "--detector", "made.toml,german.toml", "--all"],
        &["-o", "own"],
    );
    assert!(scored.status.success(), "{}", stderr(&scored));
    let results = read_json(&desk.at("own/summary.json"))["results"]
        .as_array()
        .unwrap()
        .clone();
    let figures = |name: &str| -> Vec<serde_json::Value> {
        let of = results.iter().filter(|r| r["detector"] == name);
        of.map(|r| {
            serde_json::json!([
                r["variant"],
                r["overall"]["ap50"],
                r["overall"]["hit_rate"],
                r["overall"]["mean_confidence"]
            ])
        })
        .collect()
    };
    assert_eq!(figures("german"), figures("made"));
    assert_eq!(figures("german").len(), 2);
    let said = common::stdout(&scored);
    assert!(said.contains("counts as the model: car (german: PKW"), "{said}");
    let compared = desk.on_folders(&["compare", "--detector", "german.toml", "--all"], &["-o", "own"]);
    assert!(
        common::stdout(&compared).contains("counts as the model: car (german: PKW"),
        "{}",
        common::stdout(&compared)
    );

    // Without the map nothing of it counts, and the way out is named.
    std::fs::write(
        desk.at("german.toml"),
        own.replace("name = \"made\"", "name = \"german\""),
    )
    .unwrap();
    let refused = desk.on_folders(&["score", "--detector", "german.toml"], &["-o", "other"]);
    common::assert_refused(&refused, &["german has no label `car`", "[class_map]"]);
}

/// ONNX Runtime's own builds keep a device's number and what they run on in the user's cache, to be sent.
#[test]
fn nothing_is_kept_for_anybody_elses_statistics() {
    let desk = Desk::new();
    let output = program()
        .current_dir(desk.home.path())
        .env("HOME", desk.at("home"))
        .env("XDG_CACHE_HOME", desk.at("cache"))
        .args(["detectors", "check", "--detector", "made.toml"])
        .arg(skyline().join("normal_000.jpg"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let kept: Vec<_> = ["home", "cache"]
        .iter()
        .filter(|place| desk.at(place).exists())
        .flat_map(|place| contents(&desk.at(place)))
        .map(|(path, _)| path)
        .collect();
    assert!(
        kept.iter().all(|path| !path.to_string_lossy().contains("onnxruntime")),
        "{kept:?}"
    );
}
