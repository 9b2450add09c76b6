//! Wrong turns of everyday use, through the program: what is meant is named, and what cannot be known is said. A new friction is a new line of a table.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, copy_of_skyline, home, program, read_json, run, skyline, stderr, stdout, text, write};
use serde_json::Value;

/// A detector program that finds one car in every photo.
fn car_program(folder: &Path) -> String {
    let script = r#"
echo '{"scaleproof_detector": 1, "name": "car1", "version": "1", "labels": ["van", "car"], "input": "path", "deterministic": true}'
while read -r line; do
    id=${line#*\"id\":}
    echo "{\"id\": ${id%%,*}, \"detections\": [{\"label\": \"car\", \"score\": 0.75, \"box\": [400, 300, 800, 600]}]}"
done
"#;
    format!("exec:sh {}", write(folder, "car1.sh", script).display())
}

/// A line of what was typed, and words of the one sentence that answers it.
#[test]
fn every_wrong_turn_names_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let script = write(folder.path(), "mine.py", "print('hello')\n");
    let photo = skyline().join("normal_000.jpg");
    let (photo, script) = (text(&photo), text(&script));
    let exec = format!("exec:{script}");
    let session = skyline();
    let score = |detector: &'static str| vec!["score", text(&session), "--detector", detector, "-o", "nowhere"];
    let scene = skyline().join("scene.toml");
    let scene = text(&scene);
    let camera = skyline().join("camera.yaml");
    let camera = text(&camera);
    write(folder.path(), "res.csv", "file,label,score\na.jpg,car,0.9\n");
    let detection = r#"[{"image_id": "normal_000", "category_id": 3, "bbox": [1, 1, 9, 9], "score": 0.9}]"#;
    write(folder.path(), "names.json", detection);
    let (truth, out) = (
        folder.path().join("report/coco_truth.json"),
        folder.path().join("report"),
    );
    assert!(
        run(&[
            "score",
            text(&session),
            "--recorded",
            "--detector",
            "fastestdet",
            "-o",
            text(&out)
        ])
        .status
        .success()
    );
    // A pattern of the model's sides: six of 2 × 2 cells, and the card that says so.
    let sides = folder.path().join("sides");
    std::fs::create_dir(&sides).unwrap();
    image::RgbImage::new(2, 12).save(sides.join("pattern.png")).unwrap();
    write(
        &sides,
        "pattern.json",
        r#"{"pattern_sha256": "", "tile_mm": 480.0, "sides": true}"#,
    );
    write(&sides, "scene.toml", "");
    let flat = ["--tile-mm", "480", "--size-mm", "300x200", "-o", "x.pdf"];
    let typed: Vec<(Vec<&str>, &[&str])> = vec![
        (score("yolox_nano, yolo99"), &["no detector is called yolo99"]),
        (score("exe:mine.py"), &["write 'exec:python3 mine.py'"]),
        (
            vec!["score", text(&session), "--results", "mine=res.csv", "-o", "nowhere"],
            &["it is no JSON", "COCO list", "YOLO's text files"],
        ),
        (
            vec![
                "score",
                text(&session),
                "--results",
                "mine=names.json",
                "--images",
                text(&truth),
                "-o",
                "nowhere",
            ],
            &["leave --images out"],
        ),
        (
            vec!["plan", "--scene", camera],
            &["camera.yaml, line 1", "a scene is a .toml file"],
        ),
        (
            vec!["scene", "show", "sides"],
            &["it holds sides/pattern.png, sides/scene.toml"],
        ),
        (
            [&["print", "template", "--texture", "sides/pattern.png"][..], &flat].concat(),
            &["lies on no flat sheet", "print wrap --texture sides/pattern.png"],
        ),
        (
            [&["print", "template", "--pattern", "sides/pattern.png"][..], &flat].concat(),
            &["lies on no flat sheet"],
        ),
        (
            score("yolo11n.pt"),
            &["PyTorch", "format=onnx", "detectors add yolo11n.onnx", "exec:python3"],
        ),
        (score("net.weights"), &["Darknet", "detectors add net.cfg net.weights"]),
        (score("net.tflite"), &["another framework", "detectors add net.onnx"]),
        (score("mine.py"), &["is a program", "'exec:python3 mine.py'"]),
        (
            vec!["score", text(&session), "--detector", &exec, "-o", "nowhere"],
            &["cannot start", "`python3 "],
        ),
        (
            vec!["detectors", "check", photo, "--detector", script],
            &["'exec:python3 "],
        ),
        (vec!["evaluate"], &["did you mean 'attack evaluate'?"]),
        (vec!["judge"], &["did you mean 'attack judge'?"]),
        (vec!["new"], &["'scene new' or 'session new'"]),
        (vec!["plan", "--drop", "20%"], &["0.2"]),
        (vec!["plan", "--drop", "0,2"], &["write 0.2, with a point"]),
        (
            vec![
                "print",
                "template",
                "--pattern",
                "x.png",
                "--tile-mm",
                "118xx",
                "--size-mm",
                "1x1",
                "-o",
                "x.pdf",
            ],
            &["as in 118, 118mm, 11.8cm"],
        ),
        (
            vec!["plan", "--scene", scene, "--pitch-deg", "17"],
            &["the pitch 17 is no bin of the scene", "15"],
        ),
        (
            vec![
                "plan",
                "--seal",
                "p.json",
                "--scene",
                scene,
                "--texture",
                "normal",
                "--detector",
                "yolox_nano",
            ],
            &["--drop"],
        ),
    ];
    for (arguments, words) in typed {
        let output = program().args(&arguments).current_dir(folder.path()).output().unwrap();
        assert_refused(&output, words);
    }
    assert!(!folder.path().join("nowhere").exists());
}

/// Nothing is written among the photos of a session, however its folder is named.
#[test]
fn a_report_is_not_written_among_the_photos() {
    let session = copy_of_skyline();
    let before = std::fs::read_dir(session.path()).unwrap().count();
    for command in ["score", "compare"] {
        let output = run(&[command, text(session.path()), "--recorded", "-o", text(session.path())]);
        assert_refused(&output, &["among the photos", "-o"]);
    }
    assert_eq!(std::fs::read_dir(session.path()).unwrap().count(), before);
}

#[test]
fn programs_are_checked_as_networks_are() {
    let folder = tempfile::tempdir().unwrap();
    let line = car_program(folder.path());
    let photos = folder.path().join("photos");
    std::fs::create_dir(&photos).unwrap();
    for number in 0..2 {
        let name = format!("normal_00{number}.jpg");
        std::fs::copy(skyline().join(&name), photos.join(&name)).unwrap();
    }
    let output = run(&["detectors", "check", text(&photos), "--detector", &line, "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let found: Vec<Value> = stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(found.len(), 2, "a folder stands for its photos");
    for one in &found {
        assert_eq!(
            (&one["detector"], &one["label"], &one["score"]),
            (&"car1".into(), &"car".into(), &0.75.into())
        );
    }
    assert!(found[1]["file"].as_str().unwrap().ends_with("normal_001.jpg"));
}

/// One truth, written by the numbers that COCO has, and counted from 0 with and without a list of names.
#[test]
fn classes_that_count_from_0_are_stated_and_else_noted() {
    let folder = tempfile::tempdir().unwrap();
    let photos: Vec<String> = (0..8)
        .map(|i| format!("normal_{i:03}.jpg"))
        .chain((8..16).map(|i| format!("random_{i:03}.jpg")))
        .collect();
    let results = |number: u32| {
        let found = |file: &String| serde_json::json!({"image_id": file, "category_id": number, "bbox": [400.0, 300.0, 400.0, 300.0], "score": 0.9});
        let all: Vec<Value> = photos.iter().map(found).collect();
        write(
            folder.path(),
            &format!("{number}.json"),
            serde_json::to_vec(&all).unwrap(),
        )
    };
    let names = write(folder.path(), "names.txt", "van\ncar\n");
    let scored = |number: u32, more: &[&str]| {
        let out = folder.path().join("out");
        let given = format!("mine={}", results(number).display());
        let output = run(&[
            &["score", text(&skyline()), "--results", &given, "-o", text(&out)][..],
            more,
        ]
        .concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let figures = read_json(&out.join("summary.json"))["results"].to_string();
        std::fs::remove_dir_all(out).unwrap();
        (figures, stderr(&output))
    };
    let (truth, said) = scored(3, &[]);
    assert!(!said.contains("the label of the model"), "{said}");
    assert_eq!(scored(2, &["--first-label", "0"]).0, truth);
    assert_eq!(
        scored(1, &["--first-label", "0", "--categories", text(&names)]).0,
        truth
    );
    // A car that is counted from 0 is COCO's bicycle.
    let (other, said) = scored(2, &[]);
    assert!(other != truth && said.contains("most often “bicycle”"), "{said}");
    let given = format!("mine={}", results(0).display());
    let output = run(&[
        "score",
        text(&skyline()),
        "--results",
        &given,
        "-o",
        text(&folder.path().join("none")),
    ]);
    assert_refused(&output, &["the category 0 is none of COCO's", "--first-label 0"]);
}

/// The views of a scene are the same for a capture, a plan and a sealed plan.
#[test]
fn plans_and_captures_agree_on_the_views_of_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    let scene = scene
        .replace("[15]", "[0, 15, 30]")
        .replace("[850]", "[500, 850, 1500]");
    let scene = write(folder.path(), "scene.toml", scene);
    for (more, views) in [
        (&[][..], 8),
        (&["--pitch-deg", "0,15", "--distance-mm", "850,1500"], 32),
    ] {
        let planned = run(&[&["plan", "--scene", text(&scene), "--json"][..], more].concat());
        let planned: Value = serde_json::from_slice(&planned.stdout).unwrap();
        assert_eq!(planned["directions"], views);
        let plan = folder.path().join(format!("{views}.json"));
        let sealing = [
            "plan",
            "--seal",
            text(&plan),
            "--scene",
            text(&scene),
            "--drop",
            "0.5",
            "--texture",
            "normal",
            "random",
        ];
        let sealed = run(&[&sealing[..], &["--detector", "yolox_nano,nanodet_m"], more].concat());
        assert!(sealed.status.success(), "{}", stderr(&sealed));
        assert_eq!(read_json(&plan)["plan"]["views"].as_array().unwrap().len(), views);
        let session = folder.path().join(format!("session_{views}"));
        let source = format!("replay:{}", skyline().display());
        let camera = skyline().join("camera.yaml");
        let capture = [
            "capture",
            "--source",
            &source,
            "--scene",
            text(&scene),
            "--camera",
            text(&camera),
            "--variant",
            "normal",
        ];
        let captured = run(&[
            &capture[..],
            &["--place", "y", "--headless", "--json", "-o", text(&session)],
            more,
        ]
        .concat());
        let last: Value = serde_json::from_str(stdout(&captured).lines().last().unwrap()).unwrap();
        assert_eq!(last["targets"], views);
    }
}

/// `locate` of the stored photos, or copies that were changed, as one note says.
fn notes_of(photos: &[PathBuf], scene: &Path) -> (String, Output) {
    let camera = skyline().join("camera.yaml");
    let mut command = program();
    command
        .arg("locate")
        .args(photos)
        .arg("--scene")
        .arg(scene)
        .arg("--camera")
        .arg(camera);
    let output = command.output().unwrap();
    (stderr(&output), output)
}

#[test]
fn blurred_photos_are_called_blurred() {
    let folder = tempfile::tempdir().unwrap();
    let blurred = |(number, sigma): (usize, f32)| {
        let picture = image::open(skyline().join(format!("normal_00{number}.jpg"))).unwrap();
        let path = folder.path().join(format!("b{number}_{sigma}.png"));
        picture.fast_blur(sigma).save(&path).unwrap();
        path
    };
    let photos: Vec<PathBuf> = (0..4).map(|number| blurred((number, 14.0))).collect();
    let (said, output) = notes_of(&photos, &skyline().join("scene.toml"));
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("blurred, by motion or focus"), "{said}");
    let (said, _) = notes_of(&photos[..1], &skyline().join("scene.toml"));
    assert!(
        said.contains("no tag can be read, and no edge in the photo is sharper"),
        "{said}"
    );
    // What is sharp and shows no tag is not called so.
    let street = home().join("captures/skyline_frames");
    assert!(street.is_dir());
    let bare = image::RgbImage::from_fn(640, 480, |x, y| {
        image::Rgb([if (x / 40 + y / 40) % 2 == 0 { 30 } else { 220 }; 3])
    });
    let bare_file = folder.path().join("bare.png");
    bare.save(&bare_file).unwrap();
    let (said, _) = notes_of(&[bare_file], &skyline().join("scene.toml"));
    assert!(!said.contains("blur"), "{said}");
}

/// The sixteen faces of the tent cards, or the eight flat tags of the mat, were printed at another size than the scene says.
#[test]
fn a_wrong_size_of_some_tags_is_diagnosed() {
    let stored = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    let photos: Vec<PathBuf> = (0..8).map(|i| skyline().join(format!("normal_00{i}.jpg"))).collect();
    let folder = tempfile::tempdir().unwrap();
    let changed = |is_in: &dyn Fn(u32) -> bool, size: &str| {
        let parts: Vec<String> = stored
            .split("[[tag]]")
            .map(|part| {
                let id = part
                    .trim_start()
                    .strip_prefix("id = ")
                    .and_then(|rest| rest.lines().next()?.parse().ok());
                if id.is_some_and(is_in) {
                    part.replace("size_mm = 50.0", size)
                } else {
                    part.to_owned()
                }
            })
            .collect();
        write(folder.path(), "scene.toml", parts.join("[[tag]]"))
    };
    for (is_in, size, words) in [
        (
            &(|id: u32| id >= 8) as &dyn Fn(u32) -> bool,
            "size_mm = 45.0",
            "ids 8 to 23 seem to be 50.",
        ),
        (&|id: u32| id >= 8, "size_mm = 55.0", "ids 8 to 23 seem to be 50."),
        (&|id: u32| id < 8, "size_mm = 45.0", "ids 0 to 7 seem to be 50."),
    ] {
        let (said, _) = notes_of(&photos, &changed(is_in, size));
        assert!(
            said.contains(words) || said.contains(&words.replace("50.", "49.")),
            "{size}: {said}"
        );
    }
    let (said, _) = notes_of(&photos, &skyline().join("scene.toml"));
    assert!(!said.contains("seem to be"), "{said}");
}

#[test]
fn folders_stand_for_their_photos_and_say_what_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let photo = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    write(folder.path(), "a.jpg", &photo);
    write(folder.path(), "b.webp", "RIFF");
    let (said, output) = notes_of(&[folder.path().to_owned()], &skyline().join("scene.toml"));
    assert!(output.status.success() && stdout(&output).contains("a.jpg"), "{said}");
    assert!(said.contains("b.webp: convert it to JPEG"), "{said}");
    let empty = tempfile::tempdir().unwrap();
    let (said, output) = notes_of(&[empty.path().to_owned()], &skyline().join("scene.toml"));
    assert!(
        output.status.code() == Some(2) && said.contains("has no photos"),
        "{said}"
    );
}

/// Cards of another size leave photos located, and their poses doubtful: `score` says the cause as `locate` does.
#[test]
fn a_wrong_size_of_some_tags_is_said_beside_the_figures() {
    let session = copy_of_skyline();
    let out = tempfile::tempdir().unwrap();
    let scored = |words: &str| {
        let output = run(&[
            "score",
            text(session.path()),
            "--recorded",
            "--detector",
            "fastestdet",
            "-o",
            text(out.path()),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output).contains(words)
    };
    let words = "the tags with ids 8 to 23 seem to be 50";
    assert!(!scored(words));
    let scene = std::fs::read_to_string(session.path().join("scene.toml")).unwrap();
    let (flat, cards) = scene.split_once("\nid = 8\n").unwrap();
    let cards = cards.replace("size_mm = 50.0", "size_mm = 45.0");
    write(session.path(), "scene.toml", format!("{flat}\nid = 8\n{cards}"));
    assert!(scored(words));
}

/// A re-encoded photo is no photo of another place.
#[test]
fn a_near_copy_that_is_named_for_another_place_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let line = car_program(folder.path());
    for place in ["lab", "yard"] {
        std::fs::create_dir(folder.path().join(place)).unwrap();
    }
    let copied = |number: usize, to: usize| {
        let from = skyline().join(format!("normal_00{number}.jpg"));
        std::fs::copy(&from, folder.path().join(format!("lab/{number}.jpg"))).unwrap();
        let file = std::fs::File::create(folder.path().join(format!("yard/{number}.jpg"))).unwrap();
        let picture = image::open(skyline().join(format!("normal_00{to}.jpg"))).unwrap();
        picture
            .write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(file, 80))
            .unwrap();
    };
    let said = || {
        let places = ["lab", "yard"].map(|place| format!("normal@{place}={}", folder.path().join(place).display()));
        let (scene, camera) = (skyline().join("scene.toml"), skyline().join("camera.yaml"));
        let out = folder.path().join("out");
        let usual = [
            "--scene",
            text(&scene),
            "--camera",
            text(&camera),
            "--detector",
            &line,
            "-o",
            text(&out),
        ];
        let output = run(&[&["score", &places[0], &places[1]][..], &usual].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    (0..2).for_each(|number| copied(number, number));
    let noted = said();
    assert!(
        noted.contains("2 photos show what an earlier photo shows, named for another place, direction or texture"),
        "{noted}"
    );
    // Photos of other directions are none.
    (0..2).for_each(|number| copied(number, number + 2));
    let noted = said();
    assert!(
        !noted.contains("near-cop") && !noted.contains("an earlier photo"),
        "{noted}"
    );
}

/// Shells complete the names that an option takes, and files only where a file is meant.
#[test]
fn shells_complete_names_and_not_files() {
    let script = stdout(&run(&["completions", "bash"]));
    let score = script.split("scaleproof__subcmd__score)").nth(1).unwrap();
    let of = |option: &str| {
        let rest = score.split(&format!("                {option})\n")).nth(1).unwrap();
        rest.lines().next().unwrap().trim().to_owned()
    };
    assert!(
        of("--detector").contains("yolox_nano") && of("--ap").contains("coco-101"),
        "{}",
        of("--detector")
    );
    assert!(
        of("--protocol").contains("dta") && !of("--confidence").contains("compgen -f"),
        "{}",
        of("--confidence")
    );
    assert!(of("--output").contains("compgen"), "{}", of("--output"));
    // As a shell asks it.
    let folder = tempfile::tempdir().unwrap();
    let ask = "\n_scaleproof scaleproof \"$1\" --source\necho \"${COMPREPLY[@]}\"\n";
    let asked = write(
        folder.path(),
        "ask.sh",
        format!("COMP_WORDS=(scaleproof capture --source \"$1\")\nCOMP_CWORD=3\n{script}{ask}"),
    );
    for (typed, names) in [("", "camera http:// rtsp:// watch: replay: upload"), ("re", "replay:")] {
        let output = std::process::Command::new("bash")
            .arg(&asked)
            .arg(typed)
            .output()
            .unwrap();
        assert_eq!(stdout(&output).trim(), names, "{}", stderr(&output));
    }
    for (shell, words) in [
        ("zsh", "SOURCE:(camera http\\:// rtsp\\:// watch\\: replay\\: upload)"),
        (
            "fish",
            "-r -f -a \"camera\\t''\nhttp://\\t''\nrtsp://\\t''\nwatch:\\t''\nreplay:\\t''\nupload\\t''\"",
        ),
    ] {
        let script = stdout(&run(&["completions", shell]));
        assert!(script.contains(words), "{shell} lacks {words}");
    }
}

#[test]
fn a_view_alone_is_one_view_and_keeps_the_images_of_what_is_not_painted() {
    let folder = tempfile::tempdir().unwrap();
    // Three squares side by side: paint, an image that is all red, and a material without one.
    let square = |y: i32, first: usize| {
        let corners =
            [[0, y, 0], [0, y + 100, 0], [0, y + 100, 100], [0, y, 100]].map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| format!("{}/{}", first + i, i + 1));
        (corners.concat(), format!("f {a} {b} {c} {d}\n"))
    };
    let [one, two, three] = [(-150, 1), (-50, 5), (50, 9)].map(|(y, first)| square(y, first));
    // What lies on the ground gives the model its length.
    let ground = "v -150 50 0\nv 150 50 0\nv 150 150 0\nv -150 150 0\n";
    let obj = format!(
        "mtllib m.mtl\n{}{}{}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl paint\n{}usemtl wheels\n{}usemtl glass\n{}",
        one.0, two.0, ground, one.1, two.1, three.1
    );
    let obj = write(folder.path(), "m.obj", obj);
    write(
        folder.path(),
        "m.mtl",
        "newmtl paint\nnewmtl wheels\nmap_Kd red.png\nnewmtl glass\n",
    );
    image::RgbImage::from_pixel(8, 8, image::Rgb([230, 20, 20]))
        .save(folder.path().join("red.png"))
        .unwrap();
    let shown = folder.path().join("shown.png");
    let pattern = home().join("print_templates/random16.png");
    let output = run(&[
        "texture",
        "show",
        "--mesh",
        text(&obj),
        "--material",
        "paint",
        "--pattern",
        text(&pattern),
        "--tile-mm",
        "118",
        "--azimuth-deg",
        "0",
        "--length-mm",
        "300",
        "-o",
        text(&shown),
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("1 view\n"), "{}", stdout(&output));
    let picture = image::open(&shown).unwrap().into_rgb8();
    let red = picture
        .pixels()
        .filter(|p| p.0[0] > 2 * p.0[1].max(p.0[2]).max(1))
        .count();
    assert!(red > 3000, "{red} red pixels");
}
