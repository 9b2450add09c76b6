//! The help of the whole program: its commands in the order of the work; and examples below the help of each.

use std::fmt::Write;

use clap::Command;
use clap::builder::Styles;

/// The commands in the order of the work, and what each is for.
const GROUPS: [(&str, &[(&str, &str)]); 6] = [
    (
        "Start",
        &[(
            "demo",
            "Try everything on stored photos: a pattern, its sheets, and a report",
        )],
    ),
    (
        "Print",
        &[
            ("pattern", "Make a random pattern; see what your printer makes of any"),
            (
                "print",
                "Sheets at true size: patterns, panels of a model, tags, boards, charts",
            ),
            ("colour", "Measure your printer's colours in photos of a printed chart"),
        ],
    ),
    (
        "Set up",
        &[
            ("scene", "Describe the model and the tags around it"),
            ("calibrate", "Measure the camera with photos of a printed board"),
            ("camera", "Show or convert camera files; guess a camera without a board"),
        ],
    ),
    (
        "Photograph",
        &[
            (
                "capture",
                "Be guided round the model until every view has a sharp photo",
            ),
            ("locate", "Where was each photo taken from?"),
            ("survey", "Where do tags stand that were placed by hand?"),
            (
                "session",
                "Make sessions of folders of photos or of known truth; see what is in one",
            ),
        ],
    ),
    (
        "Score",
        &[
            ("detectors", "List, download, try out and add object detectors"),
            (
                "score",
                "Run detectors on photos: a report per texture and viewing direction",
            ),
            ("merge", "Put the parts of a large scoring run together"),
            (
                "compare",
                "Is one texture detected less than another, or are the photos too few?",
            ),
            ("plan", "How many photos show a difference?"),
        ],
    ),
    (
        "Go further",
        &[
            ("attack", "Make patterns that detectors do not see a model in"),
            (
                "texture",
                "Take patterns and textures to simulators; preview them on the model",
            ),
            (
                "chart",
                "Compare the methods of this program on photos whose truth is known",
            ),
            ("completions", "Let your shell complete commands and options"),
        ],
    ),
];

/// Commands and lines to try.
const EXAMPLES: [(&str, &[&str]); 29] = [
    (
        "pattern random",
        &["scaleproof pattern random --cells 16 --seed 1 -o P.png"],
    ),
    (
        "pattern check",
        &[
            "scaleproof pattern check P.png",
            "scaleproof pattern check P.png --printer printer.toml -o preview.png",
        ],
    ),
    (
        "print template",
        &[
            "scaleproof print template --pattern P.png --tile-mm 118 --size-mm 600x300 -o sheets.pdf",
            "scaleproof print template --pattern P.png --tile-mm 118 --size-mm 600x300 --paper roll610 -o roll.pdf",
            "scaleproof print template --pattern P.png --tile-mm 118 --size-mm 600x300 --paints 5 -o stencils.svg",
        ],
    ),
    (
        "print wrap",
        &[
            "scaleproof print wrap --scene scene.toml --pattern P.png --tile-mm 118 -o panels.pdf",
            "scaleproof print wrap --mesh car.glb --length-mm 455 --pattern P.png --tile-mm 118 --paper a3 -o panels.pdf",
        ],
    ),
    (
        "print patch",
        &[
            "scaleproof print patch --scene scene.toml --patch P.png --panel left --at-mm -60,55 --size-mm 80 -o patch.pdf",
        ],
    ),
    ("print tags", &["scaleproof print tags --scene scene.toml -o tags.pdf"]),
    (
        "print board",
        &[
            "scaleproof print board --type charuco --squares 9x7 --square-mm 22 --marker-mm 16 -o board.pdf",
            "scaleproof print board --type chessboard --squares 10x7 --square-mm 20 -o board.pdf",
        ],
    ),
    ("print chart", &["scaleproof print chart -o chart.pdf"]),
    ("print check", &["scaleproof print check -o check.pdf"]),
    (
        "print verify",
        &["scaleproof print verify --x-mm 99.3 --y-mm 99.8 -o printer.toml"],
    ),
    (
        "colour read",
        &["scaleproof colour read photo1.jpg photo2.jpg -o printer.toml"],
    ),
    (
        "scene new",
        &["scaleproof scene new --preset ring --radius-mm 400 --model-size-mm 455x186x128 -o scene.toml"],
    ),
    (
        "calibrate",
        &["scaleproof calibrate --board board.toml board/*.jpg -o camera.yaml --report calibration.html"],
    ),
    (
        "camera",
        &[
            "scaleproof camera show camera.yaml",
            "scaleproof camera guess photo.jpg -o camera.yaml",
        ],
    ),
    (
        "locate",
        &["scaleproof locate photos/*.jpg --scene scene.toml --camera camera.yaml"],
    ),
    (
        "survey",
        &["scaleproof survey photos/*.jpg --scene mat.toml --camera camera.yaml --fixed mat -o scene.toml"],
    ),
    (
        "session import",
        &["scaleproof session import truth.json --photos photos --scene scene.toml"],
    ),
    (
        "detectors",
        &[
            "scaleproof detectors list",
            "scaleproof detectors fetch yolox_nano",
            "scaleproof detectors check photo.jpg --detector yolox_nano",
        ],
    ),
    (
        "score",
        &[
            "scaleproof score session -o report",
            "scaleproof score session --detector yolox_nano,fastestdet -o report",
        ],
    ),
    ("merge", &["scaleproof merge parts/*.scaleproof -o report"]),
    ("compare", &["scaleproof compare session --base normal -o comparison"]),
    ("plan", &["scaleproof plan --drop 0.2 --base-rate 0.9 --bins 8"]),
    (
        "attack",
        &[
            "scaleproof attack demo",
            "scaleproof attack run frames --detector yolox_nano --tile-mm 240 -o pattern",
        ],
    ),
    (
        "texture bake",
        &["scaleproof texture bake --mesh car.glb --length-mm 455 --pattern P.png --tile-mm 240 -o texture.png"],
    ),
    (
        "texture show",
        &["scaleproof texture show --mesh car.obj --length-mm 490 --texture car.obj -o views.png"],
    ),
    (
        "chart locate",
        &["scaleproof chart locate --session session --truth truth.json -o charts"],
    ),
    ("demo", &["scaleproof demo", "scaleproof demo -o demo"]),
    (
        "completions",
        &[
            "scaleproof completions bash > ~/.local/share/bash-completion/completions/scaleproof",
            "scaleproof completions fish > ~/.config/fish/completions/scaleproof.fish",
        ],
    ),
    ("", &["scaleproof demo", "scaleproof print template --help"]),
];

/// The command line with its commands grouped and with examples.
pub(super) fn explained(command: Command) -> Command {
    let template = format!(
        "{{before-help}}{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}{}\n{{options}}{{after-help}}",
        groups(&command),
        heading("Options")
    );
    with_examples(command, "").help_template(template)
}

fn heading(text: &str) -> String {
    let style = Styles::styled().get_header().to_owned();
    format!("{style}{text}:{style:#}")
}

fn groups(whole: &Command) -> String {
    let style = Styles::styled().get_literal().to_owned();
    let mut text = String::new();
    for (name, commands) in GROUPS {
        let _ = writeln!(text, "{}", heading(name));
        // Builds without the feature `full` have fewer.
        for (command, purpose) in commands
            .iter()
            .filter(|(name, _)| whole.find_subcommand(name).is_some())
        {
            let _ = writeln!(text, "  {style}{command:<12}{style:#}{purpose}");
        }
        text.push('\n');
    }
    text
}

fn with_examples(command: Command, path: &str) -> Command {
    let inner: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_owned()).collect();
    let command = inner.into_iter().fold(command, |command, name| {
        let path = format!("{path} {name}");
        command.mut_subcommand(name, |sub| with_examples(sub, path.trim_start()))
    });
    match EXAMPLES.iter().find(|(of, _)| *of == path) {
        Some((_, lines)) => command.after_help(format!("{}\n  {}", heading("Examples"), lines.join("\n  "))),
        None => command,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_command_stands_in_one_group() {
        let whole = crate::cli::command();
        let there: BTreeSet<&str> = whole
            .get_subcommands()
            .filter(|sub| !sub.is_hide_set())
            .map(Command::get_name)
            .collect();
        let grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, commands)| *commands)
            .map(|(name, _)| *name)
            .collect();
        assert_eq!(there, grouped.iter().copied().collect());
        assert_eq!(there.len(), grouped.len(), "one is there twice");
        assert!(
            GROUPS
                .iter()
                .flat_map(|(_, commands)| *commands)
                .all(|(_, purpose)| purpose.len() <= 78)
        );
    }

    #[test]
    fn every_example_is_a_command_line_that_the_program_takes() {
        for (path, lines) in EXAMPLES {
            for line in lines {
                let words = line.split(" > ").next().unwrap().split(' ');
                assert!(line.starts_with(format!("scaleproof {path}").trim_end()), "{line}");
                if let Err(e) = crate::cli::command().try_get_matches_from(words) {
                    let is_help = e.kind() == clap::error::ErrorKind::DisplayHelp;
                    assert!(is_help, "{line}: {e}");
                }
            }
        }
    }
}
