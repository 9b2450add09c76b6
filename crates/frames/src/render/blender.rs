//! Blender as the Python package `bpy`: found or installed, and run.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::FramesError;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{bail, ensure};

pub const SCRIPT: &str = include_str!("render_frames.py");
/// Package and versions that the script is written for.
const PACKAGE: &str = "bpy==4.5.*";
/// Version of Python that the package is built for.
const PYTHON: &str = "3.11";

/// Python with Blender's package.
#[derive(Debug, Clone)]
pub struct Python {
    program: String,
    /// The folder with `bpy`.
    packages: PathBuf,
}

/// Progress that the script reports.
#[derive(Debug, Clone, PartialEq)]
pub enum BlenderEvent {
    /// The masks and positions of this view are there.
    Geometry(String),
    /// The image of this frame is there.
    Frame(String),
}

/// Finds Python 3.11 and, in `cache`, Blender; installs Blender there when it is missing, after it has called `say`.
pub fn find(cache: &Path, say: impl FnOnce(&str)) -> Result<Python, FramesError> {
    let program = files::environment::text("SCALEPROOF_PYTHON").unwrap_or_else(|| format!("python{PYTHON}"));
    let version = ["-c", "import sys; print('%d.%d' % sys.version_info[:2])"];
    let answer = Command::new(&program).args(version).output().ok();
    let Some(answer) = answer.filter(|o| o.status.success()) else {
        bail!(
            "rendering needs Python 3.11, for which Blender's package bpy 4.5 is built, and `{program}` does not start; install it (on Debian: \
             apt install python3.11), or name it with SCALEPROOF_PYTHON"
        );
    };
    let version = String::from_utf8_lossy(&answer.stdout).trim().to_owned();
    ensure!(
        version == PYTHON,
        "`{program}` is Python {version}, and Blender's package bpy 4.5 is built for 3.11; name a Python 3.11 with SCALEPROOF_PYTHON"
    );
    let packages = cache.join("bpy-4.5");
    if !packages.is_dir() {
        say(&format!(
            "installing Blender ({PACKAGE}, about 370 MB) into {}",
            packages.display()
        ));
        install(&program, &packages)?;
    }
    Ok(Python { program, packages })
}

/// Installs Blender into a new folder, which is there only when it is whole.
fn install(program: &str, packages: &Path) -> Result<(), FramesError> {
    let mut complaint = None;
    let made = files::make_folder(packages, |inside| {
        let output = Command::new(program)
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
            .args(["--only-binary=:all:", "--target"])
            .arg(inside)
            .arg(PACKAGE)
            .output();
        complaint = match &output {
            Ok(o) if o.status.success() => return Ok(()),
            Ok(o) => {
                let said = String::from_utf8_lossy(&o.stderr);
                let last = said.lines().map(str::trim).rfind(|line| !line.is_empty());
                Some(last.unwrap_or("nothing").to_owned())
            }
            Err(e) => Some(files::plain(e)),
        };
        Err(FileError::cannot_write(packages, "half an installation is of no use"))
    });
    let command = format!("{program} -m pip install {PACKAGE}");
    match complaint {
        Some(reason) => bail!(
            "Blender's Python package could not be installed: `{command}` said: {reason}; with a network, or with the wheel in a folder that \
             PIP_FIND_LINKS names, run this again"
        ),
        None => Ok(made?),
    }
}

/// Returns the folder of Blender's raw images and log, below the folder of the frames.
pub fn work_folder(folder: &Path) -> PathBuf {
    folder.join(".render")
}

/// Returns the file of Blender's messages in a work folder.
pub fn log(work: &Path) -> PathBuf {
    work.join("blender.log")
}

/// Runs the script on a plan in the work folder of a folder, which is emptied before, and calls `on_event` as images become whole. Returns whether
/// Blender came to its end.
pub fn run(
    python: &Python,
    plan: &Value,
    folder: &Path,
    mut on_event: impl FnMut(BlenderEvent) -> Result<(), FramesError>,
) -> Result<bool, FramesError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |e| FileError::write(&path, &e)
    };
    let work = &work_folder(folder);
    empty_work_folder(folder, work)?;
    let [script, job] = ["render_frames.py", "plan.json"].map(|name| work.join(name));
    files::replace_atomically(folder, &job, plan.to_string().as_bytes())?;
    files::replace_atomically(folder, &script, SCRIPT.as_bytes())?;
    let mut child = Command::new(&python.program)
        // Whole paths: the user's may begin with a hyphen.
        .args([&script, &job].map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone())))
        .env("PYTHONPATH", &python.packages)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(files::chosen::new_file(folder, &log(work))?)
        .spawn()
        .map_err(failed(&script))?;
    let said = child.stdout.take().map(|out| read_events(out, &mut on_event));
    if let Some(Err(problem)) = said {
        // It may have ended by itself already.
        let _ = child.kill();
        let _ = child.wait();
        return Err(problem);
    }
    Ok(child.wait().map_err(failed(&script))?.success())
}

/// Makes the work folder, or takes what an earlier run left out of it: Blender would write through a link there.
fn empty_work_folder(folder: &Path, work: &Path) -> Result<(), FileError> {
    files::chosen::folder(folder, work)?;
    let unreadable = |e| FileError::read(work, &e);
    for entry in std::fs::read_dir(work).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let is_left = ["blender.log", "plan.json", "render_frames.py"].map(|name| path.ends_with(name));
        if !is_left.contains(&true) && path.extension().is_none_or(|ending| ending != "f32") {
            return Err(FileError::content(&path, "no render made it: move it away"));
        }
        files::chosen::remove(folder, &path)?;
    }
    Ok(())
}

/// Reads the script's lines; those of Blender itself are passed over.
pub fn read_events(
    out: impl Read,
    on_event: &mut impl FnMut(BlenderEvent) -> Result<(), FramesError>,
) -> Result<(), FramesError> {
    for line in BufReader::new(out).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        match line.trim_end().split_once(' ') {
            Some(("geometry", view)) => on_event(BlenderEvent::Geometry(view.to_owned()))?,
            Some(("frame", name)) => on_event(BlenderEvent::Frame(name.to_owned()))?,
            Some(("refused", sentence)) => bail!("{sentence}"),
            _ => {}
        }
    }
    Ok(())
}
