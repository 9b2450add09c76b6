//! Shell commands in the documentation: those that are run, and those of the program that are only read.

use super::markdown::Block;

/// Lines that begin so are not run: they set up, build, test or package, which takes minutes or the network.
const SKIPPED: [&str; 10] = [
    "git clone",
    "cd ",
    "cargo ",
    "SCALEPROOF_SOAK_SECONDS",
    "./run demo",
    "./run test",
    "./run package",
    "./run attack demo",
    "scaleproof demo",
    "scaleproof attack demo",
];

/// What is done with a block.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// Run in a copy of the project, without weights of detectors.
    Run,
    /// Run only with the weights of detectors.
    RunWithWeights,
    /// Only read, for the reason that stands above it.
    Read,
}

/// `None` for a block that holds no shell commands.
///
/// # Errors
/// A block that is not run without a reason above it.
pub fn kind(block: &Block) -> Result<Option<Kind>, String> {
    let mut words = block.info.split_whitespace();
    if !["sh", "bash", "shell", "console"].contains(&words.next().unwrap_or_default()) {
        return Ok(None);
    }
    let reason = block
        .remark
        .as_deref()
        .and_then(|remark| remark.strip_prefix("not run:"));
    match (words.next(), reason) {
        (None, _) => Ok(Some(Kind::Run)),
        (Some("weights"), _) => Ok(Some(Kind::RunWithWeights)),
        (Some("ignore"), Some(reason)) if !reason.trim().is_empty() => Ok(Some(Kind::Read)),
        (Some("ignore"), _) => Err("it is not run: write the reason above it, as <!-- not run: … -->".into()),
        (Some(other), _) => Err(format!(
            "`{other}` is no way to treat a block: leave it out, or write ignore or weights"
        )),
    }
}

/// Whether commands of the program in a block are meant as such.
pub fn holds_commands(block: &Block) -> bool {
    block.info.is_empty() || !matches!(kind(block), Ok(None))
}

/// The commands of a block with the offset of their first line: comments are taken off, continued lines joined.
pub fn commands(text: &str) -> Vec<(usize, String)> {
    let mut all: Vec<(usize, String)> = Vec::new();
    let mut is_continued = false;
    for (i, line) in text.lines().enumerate() {
        let line = without_comment(line);
        let (body, goes_on) = match line.trim_end().strip_suffix('\\') {
            Some(body) => (body, true),
            None => (line.trim_end(), false),
        };
        match all.last_mut().filter(|_| is_continued) {
            Some((_, command)) => command.push_str(body),
            None => all.push((i, body.to_owned())),
        }
        is_continued = goes_on;
    }
    all.retain(|(_, command)| !command.trim().is_empty());
    all
}

/// A block as a script in which every line has its number; what is skipped is an empty line.
pub fn script(text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for (i, command) in commands(text) {
        let command = command.trim_start();
        if SKIPPED.iter().any(|start| command.starts_with(start)) {
            for line in &mut lines[i..] {
                let goes_on = without_comment(line).trim_end().ends_with('\\');
                line.clear();
                if !goes_on {
                    break;
                }
            }
        }
    }
    lines.join("\n") + "\n"
}

/// The words behind each call of the program in a command.
pub fn calls(command: &str) -> Vec<Vec<String>> {
    let mut calls: Vec<Vec<String>> = Vec::new();
    let mut is_inside = false;
    let spaced = command.replace(['\'', '"', '(', ')', '[', ']', '{', '}'], " ");
    let spaced = spaced
        .replace("&&", " ; ")
        .replace(['|', ';', '>', '<'], " ; ")
        .replace(":::", " ; ");
    for word in spaced.split_whitespace() {
        match word {
            "./run" | "scaleproof" | "target/release/scaleproof" => {
                calls.push(Vec::new());
                is_inside = true;
            }
            ";" => is_inside = false,
            word if is_inside => {
                if let Some(call) = calls.last_mut() {
                    call.push(word.trim_end_matches(',').to_owned());
                }
            }
            _ => {}
        }
    }
    // `./run test` is the script's own, and so is what follows it.
    calls.retain(|call| !["test", "package", "wheel"].contains(&call.first().map_or("", String::as_str)));
    calls
}

/// A `#` begins a comment at the start of a word, outside quotes.
fn without_comment(line: &str) -> &str {
    let (mut quote, mut before) = (None, ' ');
    for (i, c) in line.char_indices() {
        match quote {
            Some(q) if c == q => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '#' && before.is_whitespace() => return &line[..i],
            _ => {}
        }
        before = c;
    }
    line
}

#[test]
fn commands_are_found_in_shell() {
    let text = "# first\n./run locate a.jpg \\\n   --json | head -1   # one\nfor i in 1 2; do scaleproof plan --drop \"0.2\"; done\n";
    let found = commands(text);
    assert_eq!(found[0], (1, "./run locate a.jpg    --json | head -1".into()));
    assert_eq!(calls(&found[0].1), [["locate", "a.jpg", "--json"]]);
    assert_eq!(calls(&found[1].1), [["plan", "--drop", "0.2"]]);
    assert_eq!(
        calls("sbatch --wrap './run score S --shard slurm'"),
        [["score", "S", "--shard", "slurm"]]
    );
    assert_eq!(script("./run demo \\\n  --out x\n./run plan"), "\n\n./run plan\n");
}
