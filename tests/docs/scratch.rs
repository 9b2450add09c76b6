//! A copy of the project's files in which the commands of one page are run, in order.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::markdown::Page;
use super::shell::{Kind, kind, script};
use crate::common::{self, HANG};

/// What commands of the documentation read.
const COPIED: [&str; 4] = ["captures", "calibration", "detectors", "print_templates"];
/// Removed when dropped.
pub struct Scratch<'a> {
    folder: tempfile::TempDir,
    /// What pages share: results kept by the content of photos, so that each photo is searched once.
    cache: &'a Path,
    /// The folder of detectors' weights, for the blocks that need them.
    weights: Option<&'a Path>,
}

/// A block of a page that was run.
pub struct Ran {
    pub line: usize,
    pub took: Duration,
    /// What went wrong, with line, command and its standard error.
    pub fault: Option<String>,
}

impl Ran {
    /// Its time and place, as text that sorts by time.
    pub fn timed(&self, page: &str) -> String {
        format!("{:>6.1} s  {page}, line {}", self.took.as_secs_f64(), self.line)
    }
}

impl<'a> Scratch<'a> {
    pub fn new(cache: &'a Path, weights: Option<&'a Path>) -> Scratch<'a> {
        let folder = tempfile::tempdir().unwrap();
        for name in COPIED {
            copy(&common::home().join(name), &folder.path().join(name));
        }
        std::fs::create_dir(folder.path().join(".bin")).unwrap();
        let shim = format!("#!/bin/sh\nexec '{}' \"$@\"\n", common::built().display());
        for place in ["run", ".bin/scaleproof"] {
            let path = folder.path().join(place);
            std::fs::write(&path, &shim).unwrap();
            make_executable(&path);
        }
        Scratch { folder, cache, weights }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs the blocks of a page until one fails; without weights, not those that need them.
    pub fn run(&self, page: &Page) -> Vec<Ran> {
        let mut done = Vec::new();
        for block in &page.blocks {
            let weights = match kind(block) {
                Ok(Some(Kind::Run)) => None,
                Ok(Some(Kind::RunWithWeights)) if self.weights.is_some() => self.weights,
                _ => continue,
            };
            let start = Instant::now();
            let fault = self.fault(&script(&block.text), block.line, weights);
            let has_failed = fault.is_some();
            done.push(Ran {
                line: block.line,
                took: start.elapsed(),
                fault: fault.map(|fault| format!("{}: {fault}", page.name)),
            });
            if has_failed {
                break;
            }
        }
        done
    }

    /// Runs a script whose first line is a line of a page.
    fn fault(&self, script: &str, first_line: usize, weights: Option<&Path>) -> Option<String> {
        let trap = "trap 'echo \"line $((LINENO + FIRST - 2)): $BASH_COMMAND\" >&3' ERR; set -Eeuo pipefail";
        let file = self.path().join(".bin/block.sh");
        std::fs::write(&file, format!("{trap}\n{script}")).unwrap();
        let [out, err, place] = ["out", "err", "place"].map(|name| self.path().join(".bin").join(name));
        let path = format!(
            "{}:{}",
            self.path().join(".bin").display(),
            std::env::var("PATH").unwrap_or_default()
        );
        let mut command = Command::new("bash");
        command
            .args(["-c", "exec 3>.bin/place; exec bash .bin/block.sh"])
            .current_dir(self.path())
            .env("FIRST", first_line.to_string())
            .env("PATH", path)
            .env("SCALEPROOF_HOME", self.path())
            .env("XDG_CACHE_HOME", self.cache)
            .env_remove("SCALEPROOF_SHARED")
            .env_remove("SCALEPROOF_DETECTORS")
            .stdin(Stdio::null())
            .stdout(std::fs::File::create(&out).unwrap())
            .stderr(std::fs::File::create(&err).unwrap());
        if let Some(weights) = weights {
            command.env("SCALEPROOF_DETECTORS", weights);
        }
        let ended = ended_in_time(&mut command);
        if ended == Some(true) {
            return None;
        }
        let why = if ended.is_none() {
            "still running after two minutes"
        } else {
            "failed"
        };
        let place = text(&place);
        let place = place.lines().next().unwrap_or("line unknown");
        Some(format!("{place}\n  {why}:\n{}", indented(&text(&err))))
    }
}

/// Whether it succeeded; `None` when it had to be stopped.
fn ended_in_time(command: &mut Command) -> Option<bool> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut child = command
        .spawn()
        .expect("the documentation's commands are run by bash: install it");
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status.success());
        }
        if start.elapsed() > HANG {
            // The whole group: bash alone would leave the program behind.
            let _ = Command::new("kill")
                .args(["-KILL", "--", &format!("-{}", child.id())])
                .status();
            let _ = child.wait();
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn text(path: &Path) -> String {
    let mut bytes = Vec::new();
    if let Ok(mut file) = std::fs::File::open(path) {
        let _ = file.read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn indented(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let last = &lines[lines.len().saturating_sub(12)..];
    last.iter().map(|line| format!("    {line}\n")).collect()
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &to);
        } else {
            std::fs::copy(&path, &to).unwrap();
        }
    }
}

#[cfg(unix)]
fn make_executable(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[cfg(not(unix))]
fn make_executable(_: &Path) {}
