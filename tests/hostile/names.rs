//! Every command that writes, in a folder from somebody else: at each name that the program itself chooses lies a link, a dangling one, a second name
//! of a file elsewhere, a pipe or a folder. Nothing elsewhere changes, no input changes, and nothing waits.
//!
//! The names are not listed: each command is run once, and a library that is loaded before the system's notes what it makes, renames or opens to
//! write. So a new command needs its line, and what it writes is tried by itself.
#![cfg(target_os = "linux")]

use std::collections::{BTreeMap, BTreeSet};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use super::over_inputs;
use crate::common::{contents, home, program, stderr, write_program};
use crate::docs::help::Commands;
use crate::hostile::bounded;
use crate::{attack_import, attack_photos};

/// A line for each command that writes, and more where a command chooses other names by its options. Each succeeds.
const LINES: &[&str] = &[
    "advise session --recorded -o out",
    "attack baseline camou views --detector detectors/scaleproof_car.toml --cells 6 --queries 8 --tile-mm 118 -o out",
    "attack baseline er views --detector detectors/scaleproof_car.toml --cells 2 --queries 8 --tile-mm 118 -o out",
    "attack baseline flat views --flat 123456 --detector detectors/scaleproof_car.toml --tile-mm 118 -o out",
    "attack baseline import views --pattern p.png --detector detectors/scaleproof_car.toml --tile-mm 118 -o out",
    "attack baseline patches views --patch p.png --panel left --at-mm 0,55 --size-mm 40 --detector detectors/scaleproof_car.toml --tile-mm 118 -o out",
    "attack baseline random views --detector detectors/scaleproof_car.toml --tile-mm 118 -o out",
    "attack chart frames -o out",
    "attack colours frames --flat 123456 -o out",
    "attack demo -o out",
    "attack evaluate --normal 808080 --tile-mm 60 --size-px 32x24 --field-of-view-deg 50 --light forest --azimuth-deg 0 --pitch-deg 15 --distance-mm 400 \
     --mesh cube.obj --mesh-up +z --mesh-front +x --detector detectors/scaleproof_car.toml --pattern one=p.png --cache cache -o out",
    "attack history result -o out",
    "attack import fca --layout fca --mesh fca/car.obj --length-mm 400 --scale 10 -o out",
    "attack photos photographed --flat black=202020 grey=808080 white=e6e6e6 --material Paint --size-px 240 -o out",
    "attack render --mesh box.stl --azimuth-deg 0 --size-px 32x24 --flat 000000 ffffff -o out",
    "attack run views --detector detectors/scaleproof_car.toml --steps 2 --cells 2 --tile-mm 118 -o out",
    "attack train-dtn frames --depth 1 --width-px 24 --epochs 1 -o out.dtn",
    "calibrate --board board.toml board_00.jpg board_01.jpg board_02.jpg board_06.jpg -o out.yaml --report out.html",
    "camera convert camera.yaml --format ros -o out.yaml",
    "capture --scene scene.toml --camera camera.yaml --source replay:session --variant normal --place b --headless -o out",
    "chart capture --session session -o out",
    "chart envelope --session session --truth truth.json -o out",
    "chart locate --session session --truth truth.json -o out",
    "chart score --session session --detector detectors/scaleproof_car.toml --rounds 1 -o out",
    "chart sigma --session session --truth truth.json --views 0 -o out",
    "chart stability --session session --truth truth.json --views 1 -o out",
    "compare session --recorded -o out",
    "demo -o out",
    "detectors add net.onnx --labels labels.txt -o out.toml",
    "detectors check a.jpg --detector detectors/scaleproof_car.toml --save out",
    "detectors speed a.jpg --detector detectors/scaleproof_car.toml --machine m -o out.json",
    "locate a.jpg --scene scene.toml --camera camera.yaml --overlay out",
    "manuals -o out",
    "merge part.scaleproof -o out",
    "pattern import p.png --cells 2 -o out.png",
    "pattern random --cells 4 --seed 1 -o out.png",
    "plan --seal out.toml --scene scene.toml --texture normal random=p.png --detector yolox_nano --drop 0.3",
    "print board --type chessboard --squares 7x5 --square-mm 20 -o out.svg",
    "print chart -o out.svg",
    "print check -o out.svg",
    "print patch --scene scene.toml --patch p.png --panel left --at-mm 0,55 --size-mm 40 -o out.svg",
    "print tags --scene scene.toml -o out.svg",
    "print template --pattern p.png --tile-mm 40 --size-mm 100x100 -o out.svg",
    "print template --pattern p.png --tile-mm 40 --size-mm 100x100 --paints 2 -o out.svg",
    "print verify --x-mm 99.5 --y-mm 100.5 -o out.toml",
    "print wrap --panels --mesh car.obj --length-mm 440 --pattern p.png --tile-mm 40 -o out.svg",
    "schemas -o out",
    "scene new --mesh car.obj --length-mm 440 --mesh-front +x --mesh-up +z --radius-mm 400 -o out.toml",
    "score session --detector detectors/scaleproof_car.toml --record --cache cache -o out",
    "score session --recorded --shard 1/1 -o out",
    "session export session --format yolo -o out",
    "session from-video walk.mp4 --scene walk/scene.toml --camera walk/camera.yaml --variant a --place b --to 2 -o out",
    "session import rows.csv --photos photos --scene scene.toml",
    "session new out normal=photos --scene scene.toml --camera camera.yaml --copy",
    "survey a.jpg b.jpg --scene scene.toml --camera camera.yaml --fixed mat -o out.toml",
    "texture bake --texture car.obj --mesh car.obj --length-mm 440 --size 64 -o out.png",
    "texture show --texture car.obj --mesh car.obj --length-mm 440 -o out",
];

/// Commands that write nothing but files that the user named, and need what no line has: a guess needs a phone's EXIF, a chart's colours a photo of the chart.
const ONLY_NAMED: [&str; 3] = ["camera guess", "colour read", "pattern check"];

/// What lies in the place of a name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum InPlace {
    LinkToAFile,
    LinkToAFolder,
    DanglingLink,
    SecondName,
    Pipe,
    Folder,
}

/// A command may go on over these, in the place of a file.
const PASSED_OVER: [InPlace; 4] = [
    InPlace::LinkToAFile,
    InPlace::SecondName,
    InPlace::DanglingLink,
    InPlace::Pipe,
];

/// Commands that take seconds: each name is tried with one thing in its place.
const SLOW: [&str; 11] = [
    "advise",
    "attack baseline camou",
    "attack demo",
    "attack evaluate",
    "attack photos",
    "chart capture",
    "chart locate",
    "chart stability",
    "print wrap",
    "session from-video",
    "texture show",
];

const VICTIM: &str = "the user's own";

/// Stands in for Blender: every image is black.
const STAND_IN: &str = r#"if [ "$1" = -c ]; then echo 3.11; exit 0; fi
raw=$(dirname "$2")
values() { head -c $(($2 * 4)) /dev/zero > "$raw/$1.f32"; }
if grep -q '"needs_geometry":true' "$2"; then
  for view in $(grep -o '"name":"az[^"]*"' "$2" | sed 's/"name":"//; s/"//'); do
    values $view.object 768; values $view.paint 768; values $view.position 9216; values $view.side 3072
    echo "geometry $view"
  done
fi
for name in $(grep -o '"name":"[^"]*","paint"' "$2" | sed 's/"name":"//; s/","paint"//'); do
  values $name.rgb 2304; echo "frame $name"
done"#;

const BOX_STL: &str = "solid box
facet normal 0 0 1\nouter loop\nvertex -90 -45 60\nvertex 90 -45 60\nvertex 90 45 60\nendloop\nendfacet
facet normal 0 0 -1\nouter loop\nvertex -90 -45 0\nvertex 90 45 0\nvertex 90 -45 0\nendloop\nendfacet
endsolid box\n";

const ROWS: &str = "file,variant,place,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm\nnormal_000.jpg,normal,yard,100,100,300,300,0,15,900\n";

/// Notes, in the file that NAMES names, what a program makes, renames to, or opens to write.
const LIBRARY: &str = r#"
    #define _GNU_SOURCE
    #include <dlfcn.h>
    #include <fcntl.h>
    #include <limits.h>
    #include <stdarg.h>
    #include <stdio.h>
    #include <stdlib.h>
    #include <string.h>
    #include <sys/stat.h>
    #include <unistd.h>
    #define REAL(name) dlsym(RTLD_NEXT, name)
    static void note(int at, const char *path) {
        char folder[PATH_MAX] = "", line[2 * PATH_MAX + 4], link[64];
        const char *names = getenv("NAMES");
        if (!names || !path) return;
        if (path[0] != '/') {
            if (at == AT_FDCWD) { if (!getcwd(folder, sizeof folder)) return; }
            else {
                snprintf(link, sizeof link, "/proc/self/fd/%d", at);
                ssize_t length = readlink(link, folder, sizeof folder - 1);
                if (length < 0) return;
                folder[length] = 0;
            }
        }
        int length = snprintf(line, sizeof line, "%s%s%s\n", folder, folder[0] ? "/" : "", path);
        int (*open_it)(const char *, int, ...) = REAL("open");
        int file = open_it(names, O_WRONLY | O_APPEND | O_CREAT, 0644);
        if (file < 0) return;
        if (write(file, line, length) < 0) {}
        close(file);
    }
    static int writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT); }
    #define OPEN(name) int name(const char *path, int flags, ...) { \
        va_list more; va_start(more, flags); mode_t mode = va_arg(more, mode_t); va_end(more); \
        if (writes(flags)) note(AT_FDCWD, path); \
        return ((int (*)(const char *, int, ...))REAL(#name))(path, flags, mode); }
    #define OPENAT(name) int name(int at, const char *path, int flags, ...) { \
        va_list more; va_start(more, flags); mode_t mode = va_arg(more, mode_t); va_end(more); \
        if (writes(flags)) note(at, path); \
        return ((int (*)(int, const char *, int, ...))REAL(#name))(at, path, flags, mode); }
    OPEN(open) OPEN(open64) OPENAT(openat) OPENAT(openat64)
    int mkdir(const char *path, mode_t mode) {
        note(AT_FDCWD, path); return ((int (*)(const char *, mode_t))REAL("mkdir"))(path, mode); }
    int rename(const char *from, const char *to) {
        note(AT_FDCWD, to); return ((int (*)(const char *, const char *))REAL("rename"))(from, to); }
    int symlink(const char *target, const char *path) {
        note(AT_FDCWD, path); return ((int (*)(const char *, const char *))REAL("symlink"))(target, path); }
"#;

struct Bench {
    inputs: TempDir,
    before: BTreeMap<PathBuf, Vec<u8>>,
    tools: TempDir,
}

impl Bench {
    fn new() -> Bench {
        let bench = Bench {
            inputs: over_inputs::folder(),
            before: BTreeMap::new(),
            tools: tempfile::tempdir().unwrap(),
        };
        let at = |name: &str| bench.at(name);
        for folder in ["walk", "photos", "fca", "photographed", ".cache/bpy-4.5"] {
            std::fs::create_dir_all(at(folder)).unwrap();
        }
        for name in ["walk/scene.toml", "walk/camera.yaml"] {
            std::fs::copy(home().join("captures").join(name), at(name)).unwrap();
        }
        std::fs::copy(at("a.jpg"), at("photos/normal_000.jpg")).unwrap();
        std::fs::write(at("rows.csv"), ROWS).unwrap();
        std::fs::write(at("labels.txt"), "car\n").unwrap();
        std::fs::write(at("box.stl"), BOX_STL).unwrap();
        std::fs::write(at("cube.obj"), cube()).unwrap();
        std::fs::write(at(".cache/bpy-4.5/bpy.py"), "").unwrap();
        write_program(&at("python"), STAND_IN);
        let views = home().join("captures/skyline_attack");
        for (from, to) in [
            (views, "views"),
            (attack_import::folder().keep(), "fca"),
            (attack_photos::good().0.with_file_name("good"), "photographed"),
        ] {
            for path in contents(&from).keys() {
                let to = at(to).join(path.strip_prefix(&from).unwrap());
                std::fs::create_dir_all(to.parent().unwrap()).unwrap();
                std::fs::copy(path, to).unwrap();
            }
        }
        for made in [
            "score session --recorded --shard 1/1 -o parts",
            "attack baseline random views --detector detectors/scaleproof_car.toml --tile-mm 118 -o result",
        ] {
            let output = bench.command(made).output().unwrap();
            assert!(output.status.success(), "{made}: {}", stderr(&output));
        }
        let part = std::fs::read_dir(at("parts")).unwrap().next().unwrap().unwrap();
        std::fs::rename(part.path(), at("part.scaleproof")).unwrap();
        std::fs::write(bench.tools.path().join("names.c"), LIBRARY).unwrap();
        let built = Command::new("cc")
            .args(["-shared", "-fPIC", "-o", "names.so", "names.c", "-ldl"])
            .current_dir(bench.tools.path())
            .status();
        assert!(built.unwrap().success());
        let before = contents(bench.inputs.path());
        Bench { before, ..bench }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.inputs.path().join(name)
    }

    fn command(&self, line: &str) -> Command {
        let mut command = program();
        command
            .current_dir(self.inputs.path())
            .args(line.split_whitespace())
            .env("SCALEPROOF_PYTHON", self.at("python"));
        if line.contains("attack render") || line.contains("attack evaluate") {
            command.env("SCALEPROOF_HOME", self.inputs.path());
        }
        command
    }

    /// What a command names by itself below the folder, files and folders; the line succeeds.
    fn names(&self, line: &str) -> BTreeSet<PathBuf> {
        let noted = self.tools.path().join("noted");
        let mut command = self.command(line);
        command
            .env("LD_PRELOAD", self.tools.path().join("names.so"))
            .env("NAMES", &noted);
        let output = bounded::run(&mut command).output;
        // A capture that lacks views has taken photos all the same.
        let is_done = output.status.success() || line.starts_with("capture ");
        assert!(is_done, "{line}: {}", stderr(&output));
        let text = std::fs::read_to_string(&noted).unwrap_or_default();
        let _ = std::fs::remove_file(&noted);
        let inside = self.inputs.path().canonicalize().unwrap();
        let named: BTreeSet<&str> = line.split([' ', '=']).collect();
        let is_temporary = |path: &Path| {
            path.iter().any(|part| {
                let name = part.to_string_lossy();
                name.starts_with('.')
                    && (name.ends_with(".partial") || name.ends_with("-journal") || name.starts_with(".scaleproof"))
            })
        };
        text.lines()
            .filter_map(|path| Some(Path::new(path).strip_prefix(&inside).ok()?.components().collect()))
            .filter(|path: &PathBuf| !path.as_os_str().is_empty() && !is_temporary(path))
            .filter(|path| !path.to_str().is_some_and(|path| named.contains(path)))
            .collect()
    }

    /// Everything as it was before the first command.
    fn restore(&self) {
        for entry in std::fs::read_dir(self.inputs.path()).unwrap() {
            let path = entry.unwrap().path();
            let is_input = |input: &PathBuf| input.starts_with(&path);
            if !self.before.keys().any(is_input) {
                remove(&path);
            }
        }
        for (path, bytes) in &self.before {
            let is_there = path.is_file() && !path.is_symlink();
            if !is_there || std::fs::read(path).unwrap() != *bytes {
                remove(path);
                let folder = path.parent().unwrap();
                if !folder.is_dir() || folder.is_symlink() {
                    remove(folder);
                    std::fs::create_dir_all(folder).unwrap();
                }
                std::fs::write(path, bytes).unwrap();
            }
        }
        for path in ["session", "photos", "result"].map(|name| self.at(name)) {
            for entry in all_below(&path) {
                if !self.before.keys().any(|input| input.starts_with(&entry)) {
                    remove(&entry);
                }
            }
        }
    }

    /// Runs a command with something in the place of these names, and whether it succeeded.
    fn runs(&self, line: &str, names: &[(InPlace, &PathBuf)]) -> bool {
        self.restore();
        let elsewhere = tempfile::tempdir().unwrap();
        let (file, folder) = (elsewhere.path().join("file"), elsewhere.path().join("folder"));
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(&file, VICTIM).unwrap();
        std::fs::write(folder.join("inside"), VICTIM).unwrap();
        let mut planted = Vec::new();
        for (in_place, name) in names {
            let place = self.at(name.to_str().unwrap());
            // A name of an input is what the input is, as a session's list.
            if self.before.contains_key(&place) {
                continue;
            }
            remove(&place);
            std::fs::create_dir_all(place.parent().unwrap()).unwrap();
            match in_place {
                InPlace::LinkToAFile => symlink(&file, &place).unwrap(),
                InPlace::LinkToAFolder => symlink(&folder, &place).unwrap(),
                InPlace::DanglingLink => symlink(elsewhere.path().join("absent"), &place).unwrap(),
                InPlace::SecondName => std::fs::hard_link(&file, &place).unwrap(),
                InPlace::Pipe => assert!(Command::new("mkfifo").arg(&place).status().unwrap().success()),
                InPlace::Folder => {
                    std::fs::create_dir(&place).unwrap();
                    std::fs::write(place.join("mine"), VICTIM).unwrap();
                    planted.push(place.join("mine"));
                }
            }
        }
        let before = contents(elsewhere.path());
        let output = bounded::run(&mut self.command(line)).output;
        let about = format!("{line} with {names:?}: {}", stderr(&output));
        assert!(matches!(output.status.code(), Some(0 | 2)), "{about}");
        assert_eq!(contents(elsewhere.path()), before, "{about}");
        assert!(planted.iter().all(|path| path.is_file()), "{about}");
        for (path, bytes) in &self.before {
            let is_written = names
                .iter()
                .any(|(_, name)| path.starts_with(self.at(name.to_str().unwrap())));
            let is_listed = path.ends_with("photos/session.json");
            let is_kept = is_written || is_listed || std::fs::read(path).is_ok_and(|now| now == *bytes);
            assert!(is_kept, "{about}: {} changed", path.display());
        }
        output.status.success()
    }
}

fn remove(path: &Path) {
    let _ = match path.is_dir() && !path.is_symlink() {
        true => std::fs::remove_dir_all(path),
        false => std::fs::remove_file(path),
    };
}

fn all_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(all_below(&path));
        }
        found.push(path);
    }
    found
}

/// A cuboid of 180 × 90 × 60 mm.
fn cube() -> String {
    let mut text = String::new();
    for i in 0..8 {
        let at = |axis: usize, low: i32, high: i32| if i >> axis & 1 == 1 { high } else { low };
        text += &format!("v {} {} {}\n", at(0, -90, 90), at(1, -45, 45), at(2, 0, 60));
    }
    for [a, b, c, d] in crate::common::BOX_FACES {
        text += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1);
    }
    text
}

/// Of names in one folder that differ in figures alone, as pages and frames do, two are enough.
fn few(names: &BTreeSet<PathBuf>) -> Vec<&PathBuf> {
    let mut of_kind: BTreeMap<String, u32> = BTreeMap::new();
    let is_new = |name: &&PathBuf| {
        let kind = name.display().to_string();
        let kind: String = kind.chars().filter(|c| !c.is_ascii_hexdigit()).collect();
        let count = of_kind.entry(kind).or_default();
        *count += 1;
        *count <= 2
    };
    names.iter().filter(is_new).collect()
}

#[test]
fn nothing_is_written_through_a_name_that_the_program_chose() {
    let bench = Bench::new();
    for line in LINES {
        let begin = std::time::Instant::now();
        bench.restore();
        let names = bench.names(line);
        let names = few(&names);
        let is_folder = |name: &&&PathBuf| names.iter().any(|other| *other != **name && other.starts_with(name));
        let leaves: Vec<&PathBuf> = names.iter().copied().filter(|name| !is_folder(&name)).collect();
        let folders: Vec<&PathBuf> = names.iter().copied().filter(|name| is_folder(&name)).collect();
        let is_slow = SLOW.iter().any(|slow| line.starts_with(slow));
        for turn in 0..if is_slow { 1 } else { PASSED_OVER.len() } {
            let kinds = PASSED_OVER.into_iter().cycle().skip(turn);
            let planted: Vec<(InPlace, &PathBuf)> = kinds.zip(leaves.iter().copied()).collect();
            // A refusal at one name says nothing of the others.
            if !planted.is_empty() && !bench.runs(line, &planted) && turn == 0 {
                let alone = if is_slow { planted.len() - 1 } else { 0 };
                planted[alone..].iter().for_each(|one| _ = bench.runs(line, &[*one]));
            }
        }
        for in_place in [InPlace::LinkToAFolder, InPlace::Folder] {
            let planted: Vec<(InPlace, &PathBuf)> = leaves.iter().map(|name| (in_place, *name)).collect();
            if !planted.is_empty() && !is_slow {
                bench.runs(line, &planted);
            }
        }
        for in_place in [InPlace::LinkToAFolder, InPlace::DanglingLink, InPlace::LinkToAFile] {
            if in_place == InPlace::LinkToAFolder || !is_slow {
                folders
                    .iter()
                    .for_each(|name| _ = bench.runs(line, &[(in_place, *name)]));
            }
        }
        println!("{:.1} s: {line}: {} names", begin.elapsed().as_secs_f64(), names.len());
    }
}

/// A new command needs its line above.
#[test]
fn every_command_that_writes_has_a_line() {
    let commands = Commands::of_program();
    let name_of = |line: &&str| {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let name = (1..=words.len())
            .rev()
            .find(|count| commands.is_command(&words[..*count]));
        // `schemas` and `manuals` are hidden.
        name.map_or(words[0].clone(), |count| words[..count].join(" "))
    };
    let mut tried: BTreeSet<String> = LINES.iter().map(name_of).collect();
    tried.extend(ONLY_NAMED.map(str::to_owned));
    let missing: Vec<String> = commands.writing().difference(&tried).cloned().collect();
    assert!(missing.is_empty(), "no line above tries {missing:?}");
}
