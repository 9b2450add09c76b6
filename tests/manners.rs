//! How the program speaks: which word was meant, quiet, JSON, progress in a log, colours, completions, manual pages, help, and doubts about
//! units.

use crate::common;

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

use common::{assert_refused, home, program, stderr, stdout};

fn run(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    program().args(arguments).current_dir(folder).output().unwrap()
}

/// A folder with a pattern of 16 × 16 cells and a scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        "pattern random --cells 16 --seed 1 -o P.png",
        "scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o scene.toml",
    ] {
        let output = run(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output), "", "{arguments}");
    }
    folder
}

#[test]
fn a_misspelt_word_is_answered_with_the_word_that_was_meant() {
    let folder = folder();
    for (arguments, sentence) in [
        (
            "print check --ouput x.pdf",
            "error: 'scaleproof print check' has no option '--ouput': did you mean '--output'? (see scaleproof print check --help)",
        ),
        (
            "scor",
            "error: there is no command 'scaleproof scor': did you mean 'score'? (see scaleproof --help)",
        ),
        (
            "print tempalte",
            "error: there is no command 'scaleproof print tempalte': did you mean 'template'? (see scaleproof print --help)",
        ),
        (
            "detectors fetch yolo_nano",
            "error: no detector is called yolo_nano: choose from yolox_nano, nanodet_m, fastestdet, deimv2_femto, deimv2_atto; did you mean \
             yolox_nano?",
        ),
        (
            "print check --paper leter -o x.pdf",
            "error: paper 'leter' is not known; use a0 to a5, letter, legal, tabloid, ledger, WIDTHxHEIGHT in mm, as in 210x297, or a roll by its width, as in \
             roll610; did you mean letter?",
        ),
    ] {
        let output = run(folder.path(), arguments);
        assert_refused(&output, &[]);
        assert_eq!(stderr(&output).trim_end(), sentence);
    }
    let family = "scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o x.toml --family tag36h1";
    assert_refused(
        &run(folder.path(), family),
        &["tag25h9", "did you mean tag36h11? (see scaleproof scene new --help)"],
    );
    let tags = "locate P.png --scene scene.toml --camera c.yaml --tag-detector aprltag";
    let said = stderr(&run(folder.path(), tags));
    assert!(
        said.contains("is not known; use one of") && said.contains("; did you mean apriltag?"),
        "{said}"
    );
    // Nothing is guessed.
    let said = stderr(&run(folder.path(), "bananas"));
    assert_eq!(
        said,
        "error: there is no command 'scaleproof bananas' (see scaleproof --help)\n"
    );
}

#[cfg(unix)]
#[test]
fn names_that_are_no_text_are_refused() {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let count = || std::fs::read_dir(folder.path()).unwrap().count();
    let before = count();
    let name = std::ffi::OsStr::from_bytes(b"u\xff.pdf");
    let mut command = program();
    command
        .current_dir(folder.path())
        .args(["print", "check", "--json", "-o"])
        .arg(name);
    assert_refused(
        &command.output().unwrap(),
        &["u\u{fffd}.pdf is not UTF-8 text", "another name"],
    );
    assert_eq!(count(), before, "nothing is written");
}

#[test]
fn quiet_silences_notes_and_neither_results_nor_errors() {
    let folder = folder();
    let noted = "print template --pattern P.png --tile-mm 118 --size-mm 60x30 -o t.pdf";
    let loud = run(folder.path(), noted);
    assert!(stderr(&loud).starts_with("note: "), "{}", stderr(&loud));
    for arguments in [
        format!("{noted} --quiet"),
        format!("-q {noted}"),
        format!("print -q {}", &noted[6..]),
    ] {
        let quiet = run(folder.path(), &arguments);
        assert_eq!(
            (stderr(&quiet).as_str(), stdout(&quiet)),
            ("", stdout(&loud)),
            "{arguments}"
        );
    }
    assert_refused(
        &run(folder.path(), "-q print check --paper leter -o x.pdf"),
        &["error: paper 'leter'"],
    );
}

#[test]
fn what_was_written_is_told_as_json() {
    let folder = folder();
    for (arguments, files, facts) in [
        (
            "pattern random --cells 4 --seed 2 -o Q.png",
            vec!["Q.png"],
            vec!["cells", "seed", "pattern_sha256"],
        ),
        (
            "scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o s.toml",
            vec!["s.toml"],
            vec!["tags"],
        ),
        ("print check -o check.pdf", vec!["check.pdf"], vec!["next"]),
        (
            "print verify --x-mm 99.3 --y-mm 99.8 -o printer.toml",
            vec!["printer.toml"],
            vec!["correction"],
        ),
        (
            "print chart -o chart.pdf",
            vec!["chart.pdf"],
            vec!["chart", "patches", "levels"],
        ),
        (
            "print board --type charuco --squares 5x4 --square-mm 22 -o b.pdf",
            vec!["b.pdf", "b.toml"],
            vec!["board", "definition"],
        ),
        (
            "print template --pattern P.png --tile-mm 118 --size-mm 150x100 -o t.svg",
            vec!["t-assembly.svg", "t-A1.svg"],
            vec!["sheets", "rows", "columns", "page_mm", "cell_mm"],
        ),
        (
            "print template --pattern P.png --tile-mm 118 --size-mm 150x100 --paints 2 -o p.pdf",
            vec!["p.pdf"],
            vec!["sheets", "paints", "delta_e_mean", "delta_e_max"],
        ),
        (
            "print wrap --panels --scene scene.toml --pattern P.png --tile-mm 118 -o w.pdf",
            vec!["w.pdf"],
            vec!["model_size_mm", "cell_mm", "panels", "largest_stretch"],
        ),
        (
            "print patch --scene scene.toml --patch P.png --panel left --at-mm 0,60 --size-mm 60 -o patch.pdf",
            vec!["patch.pdf"],
            vec!["patches"],
        ),
    ] {
        let output = run(folder.path(), &format!("{arguments} --json"));
        assert!(output.status.success(), "{arguments}: {}", stderr(&output));
        let text = stdout(&output);
        assert_eq!(text.lines().count(), 1, "{text}");
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(answer["files"], serde_json::json!(files), "{arguments}");
        assert!(
            files.iter().all(|file| folder.path().join(file).is_file()),
            "{arguments}"
        );
        for fact in facts {
            assert!(!answer[fact].is_null(), "{arguments}: {fact} in {text}");
        }
    }
    // The numbers are those of the sheets: A4 holds two of 150 × 100 mm, a box of 455 × 186 × 128 mm has five panels without stretch.
    let wrap = "print wrap --panels --scene scene.toml --pattern P.png --tile-mm 118 -o w.pdf --json";
    let answer: serde_json::Value = serde_json::from_str(&stdout(&run(folder.path(), wrap))).unwrap();
    assert_eq!(answer["model_size_mm"], serde_json::json!([455.0, 186.0, 128.0]));
    assert_eq!(answer["panels"].as_array().unwrap().len(), 5);
    assert!((answer["largest_stretch"].as_f64().unwrap() - 1.0).abs() < 1e-9);
}

#[test]
fn a_chart_is_told_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let session = home().join("captures/skyline").display().to_string();
    let arguments = format!("chart envelope --session {session} --truth {session}/truth.json -o charts --json");
    let output = run(folder.path(), &arguments);
    let answer: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(
        answer["files"],
        serde_json::json!(["charts/envelope.json", "charts/envelope.svg"])
    );
    let written = common::read_json(&folder.path().join("charts/envelope.json"));
    assert_eq!(answer["rows"], written["rows"]);
}

/// A detector whose weights come from a server that takes `pause` before the second half of them.
fn slow_detector(folder: &Path, pause: Duration) {
    const CONTENT: &[u8] = &[7; 2_000_000];
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let lines = BufReader::new(stream.try_clone().unwrap()).lines();
        lines
            .map_while(Result::ok)
            .take_while(|line| !line.is_empty())
            .for_each(drop);
        let head = format!(
            "HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
            CONTENT.len()
        );
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(&CONTENT[..1_000_000]).unwrap();
        std::thread::sleep(pause);
        stream.write_all(&CONTENT[1_000_000..]).unwrap();
    });
    let hash = scaleproof_core::files::sha256_hex(CONTENT);
    let manifest = format!(
        "name = \"slow\"\ntitle = \"Slow\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = [\"car\"]\n[weights]\nfile = \"slow.onnx\"\n\
         url = \"http://{address}/slow.onnx\"\nsha256 = \"{hash}\"\n[input]\nsize_px = [64, 64]\nresize = \"stretch\"\nkernel = \
         \"opencv_linear\"\nchannels = \"rgb\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\nkind = \"yolov10\"\n"
    );
    std::fs::write(folder.join("slow.toml"), manifest).unwrap();
    std::fs::create_dir(folder.join("weights")).unwrap();
}

#[test]
fn long_work_says_in_a_log_how_far_it_is_and_nothing_with_quiet() {
    let lines = |option: &str| {
        let folder = tempfile::tempdir().unwrap();
        slow_detector(folder.path(), Duration::from_secs(6));
        let output = run(
            folder.path(),
            &format!("detectors fetch slow.toml --detectors weights {option}"),
        );
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let quiet = std::thread::scope(|scope| {
        let quiet = scope.spawn(|| lines("--quiet"));
        let loud = lines("");
        let said: Vec<&str> = loud.lines().collect();
        assert!(said.len() >= 2, "{loud}");
        assert!(said[0].starts_with("slow 1.0 MB of 2.0 MB"), "{loud}");
        assert!(
            said.last().unwrap().starts_with("slow 2.0 MB of 2.0 MB, done in "),
            "{loud}"
        );
        assert!(!loud.contains('\u{1b}') && !loud.contains('\r'), "{loud:?}");
        quiet.join().unwrap()
    });
    assert_eq!(quiet, "");
}

/// What the program shows in a terminal; `None` without `script`, which makes one.
fn in_terminal(arguments: &str, variables: &[(&str, &str)]) -> Option<String> {
    let command = format!("{} {arguments}", common::built().display());
    let mut script = Command::new("script");
    script
        .args(["-qec", &command, "/dev/null"])
        .env("TERM", "xterm-256color")
        .env_remove("NO_COLOR");
    script
        .env_remove("CLICOLOR_FORCE")
        .env_remove("CLICOLOR")
        .env_remove("CI");
    let output = script
        .envs(variables.iter().copied())
        .stdin(std::process::Stdio::null())
        .output();
    Some(String::from_utf8_lossy(&output.ok()?.stdout).into_owned())
}

#[test]
fn colours_are_for_terminals_that_may_have_them() {
    const ESCAPE: char = '\u{1b}';
    for arguments in ["--help", "print --help", "print template --help"] {
        let Some(coloured) = in_terminal(arguments, &[]) else {
            return;
        };
        assert!(coloured.contains(ESCAPE), "{arguments}: no terminal was made");
        for variables in [("NO_COLOR", "1"), ("TERM", "dumb")] {
            let plain = in_terminal(arguments, &[variables]).unwrap();
            assert!(
                plain.contains("Options:") && !plain.contains(ESCAPE),
                "{arguments}, {variables:?}: {plain:?}"
            );
        }
    }
    for variables in [&[("NO_COLOR", "1")][..], &[("TERM", "dumb")], &[]] {
        let refused = in_terminal("scor", variables).unwrap();
        assert!(
            refused.starts_with("error: there is no command") && !refused.contains(ESCAPE),
            "{refused:?}"
        );
    }
    // No cursor is moved where that cannot be.
    let demo = format!(
        "chart envelope --session {0} --truth {0}/truth.json -o {1}",
        home().join("captures/skyline").display(),
        tempfile::tempdir().unwrap().path().display()
    );
    let dumb = in_terminal(&demo, &[("TERM", "dumb")]).unwrap();
    assert!(dumb.contains("envelope.svg") && !dumb.contains(ESCAPE), "{dumb:?}");
}

#[test]
fn every_shell_gets_completions() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, words) in [
        ("bash", "complete -F _scaleproof"),
        ("zsh", "#compdef scaleproof"),
        ("fish", "complete -c scaleproof"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "edit:completion"),
    ] {
        let output = run(folder.path(), &format!("completions {shell}"));
        let script = stdout(&output);
        assert!(output.status.success() && script.contains(words), "{shell}: {script}");
        assert!(script.contains("template") && script.contains("size-mm"), "{shell}");
        assert!(!script.contains("manuals -"), "{shell}");
        if shell == "bash" {
            std::fs::write(folder.path().join("completion"), &script).unwrap();
            let checked = Command::new("bash")
                .arg("-n")
                .arg(folder.path().join("completion"))
                .output()
                .unwrap();
            assert!(checked.status.success(), "{}", stderr(&checked));
        }
    }
    assert_refused(&run(folder.path(), "completions bsh"), &["did you mean 'bash'?"]);
}

/// The commands below one, by its help.
fn commands(path: &[&str]) -> Vec<String> {
    let help = stdout(&program().args(path).arg("--help").output().unwrap());
    let listed = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| {
        line.strip_prefix("  ")?
            .split(' ')
            .next()
            .filter(|name| !name.is_empty())
    });
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn there_is_a_manual_page_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "manuals -o man");
    assert!(output.status.success(), "{}", stderr(&output));
    let entries = std::fs::read_dir(folder.path().join("man")).unwrap();
    let pages: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    assert!(stdout(&output).contains(&format!("man: {} manual pages", pages.len())));
    let named = |name: &str| pages.iter().any(|page| page.ends_with(format!("{name}.1")));
    assert!(named("scaleproof") && named("scaleproof-score") && named("scaleproof-completions"));
    for group in ["print", "chart", "detectors", "attack", "pattern", "scene"] {
        let inner = commands(&[group]);
        assert!(!inner.is_empty(), "{group}");
        assert!(
            inner.iter().all(|name| named(&format!("scaleproof-{group}-{name}"))),
            "{group}: {pages:?}"
        );
    }
    for page in &pages {
        let text = std::fs::read_to_string(page).unwrap();
        for section in [".SH NAME", ".SH SYNOPSIS", ".SH OPTIONS"] {
            assert!(text.contains(section), "{section} is not in {}", page.display());
        }
    }
    // Rendered, where there is a renderer.
    let page = folder.path().join("man/scaleproof-print-template.1");
    if let Ok(rendered) = Command::new("groff").args(["-man", "-Tutf8", "-ww"]).arg(page).output() {
        assert_eq!(stderr(&rendered), "");
        let text = stdout(&rendered);
        assert!(
            text.contains("--size-mm") && text.contains("Width and height of the whole template"),
            "{text}"
        );
    }
    let again = tempfile::tempdir().unwrap();
    assert!(run(again.path(), "manuals -o man").status.success());
    for page in &pages {
        let other = again.path().join("man").join(page.file_name().unwrap());
        assert_eq!(std::fs::read(page).unwrap(), std::fs::read(other).unwrap());
    }
}

#[test]
fn the_help_lists_the_commands_in_the_order_of_the_work_and_ends_with_examples() {
    let help = stdout(&program().arg("--help").output().unwrap());
    let order = [
        "\nPrint:",
        "\n  print ",
        "\n  scene ",
        "\n  calibrate ",
        "\n  capture ",
        "\n  locate ",
        "\n  score ",
        "\n  compare ",
        "\n  attack ",
    ];
    let places: Vec<_> = order
        .iter()
        .map(|word| help.find(word).unwrap_or_else(|| panic!("{word} is not in {help}")))
        .collect();
    assert!(places.is_sorted(), "{help}");
    assert!(help.contains("-q, --quiet") && !help.contains("manuals"), "{help}");
    for path in [
        "",
        "print template",
        "scene new",
        "calibrate",
        "locate",
        "score",
        "compare",
        "attack",
    ] {
        let help = stdout(&program().args(path.split_whitespace()).arg("--help").output().unwrap());
        let examples = help
            .split("\nExamples:\n")
            .nth(1)
            .unwrap_or_else(|| panic!("no examples: {help}"));
        assert!(
            examples.lines().all(|line| line.starts_with("  scaleproof ")),
            "{examples}"
        );
    }
}

#[test]
fn lengths_in_another_unit_are_doubted_and_taken() {
    let folder = folder();
    let obj = "v 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\nv 0 0 50\nv 100 0 50\nv 100 200 50\nv 0 200 50\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf \
               4 1 5 8\n";
    std::fs::write(folder.path().join("wide.obj"), obj).unwrap();
    for (arguments, sentence) in [
        (
            "print template --pattern P.png --tile-mm 118 --size-mm 60x30 -o t.pdf",
            "note: the template of 60 × 30 mm is smaller than one repeat of the pattern (118 mm): was it in cm? That is --size-mm 600x300",
        ),
        (
            "scene new --preset ring --radius-mm 400 --model-size-mm 46x20x13 -o s.toml",
            "note: the car of 46 × 20 × 13 mm at 1:10 would be 0.46 m long in reality: were these cm? That is --model-size-mm 460x200x130",
        ),
        (
            "print wrap --panels --mesh wide.obj --mesh-front +x --mesh-up +z --length-mm 100 --pattern P.png --tile-mm 118 -o w.pdf",
            "note: the model is 100 mm long and 200 mm wide: are its front and its top right (--mesh-front, --mesh-up)?",
        ),
        (
            "print board --type chessboard --squares 10x7 --square-mm 4 -o b.pdf",
            "note: the board is 40 × 28 mm: were the squares in cm? That is --square-mm 40",
        ),
    ] {
        let output = run(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output).trim_end(), sentence);
    }
    for usual in [
        "print template --pattern P.png --tile-mm 118 --size-mm 600x300 -o t.pdf",
        "print wrap --panels --mesh wide.obj --mesh-front +y --pattern P.png --tile-mm 118 -o w.pdf",
        "print board --type charuco --squares 9x7 --square-mm 22 --marker-mm 16 -o b.pdf",
        "print board --type aprilgrid --squares 6x5 --square-mm 26 -o b.pdf",
    ] {
        let output = run(folder.path(), usual);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output), "", "{usual}");
    }
}
