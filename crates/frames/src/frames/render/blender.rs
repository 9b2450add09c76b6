//! Blender as the Python package `bpy`: found or installed, and run.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::RenderError;
use scaleproof_core::files::{self, FileError};

/// What Blender runs.
pub const SCRIPT: &str = include_str!("render_frames.py");
/// The package and the versions the script is written for.
const PACKAGE: &str = "bpy==4.5.*";
/// The Python that package is built for.
const PYTHON: &str = "3.11";

/// A Python with Blender.
#[derive(Debug, Clone)]
pub struct Python {
    program: String,
    /// Where `bpy` was installed.
    packages: PathBuf,
}

/// What the script says.
#[derive(Debug, Clone, PartialEq)]
pub enum BlenderEvent {
    /// The masks and positions of this view are there.
    Geometry(String),
    /// The image of this frame is there.
    Frame(String),
}

/// Finds Python 3.11 and, in `cache`, Blender; installs Blender there when it is missing, after it has called `say`.
///
/// # Errors
/// No Python 3.11, or no way to install.
pub fn find(cache: &Path, say: impl FnOnce(&str)) -> Result<Python, RenderError> {
    let program = files::environment::text("SCALEPROOF_PYTHON").unwrap_or_else(|| format!("python{PYTHON}"));
    let version = ["-c", "import sys; print('%d.%d' % sys.version_info[:2])"];
    let answer = Command::new(&program)
        .args(version)
        .output()
        .ok()
        .filter(|o| o.status.success());
    let Some(answer) = answer else {
        return Err(RenderError::NoPython { program });
    };
    let version = String::from_utf8_lossy(&answer.stdout).trim().to_owned();
    if version != PYTHON {
        return Err(RenderError::OtherPython { program, version });
    }
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

/// Installs beside the place and renames, so that the folder is there only when it is whole.
fn install(program: &str, packages: &Path) -> Result<(), RenderError> {
    let temporary = packages.with_extension(format!("5.{}.partial", std::process::id()));
    let arguments = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--only-binary=:all:",
        "--target",
    ];
    let output = Command::new(program)
        .args(arguments)
        .arg(&temporary)
        .arg(PACKAGE)
        .output();
    let reason = match &output {
        Ok(o) if o.status.success() => None,
        Ok(o) => Some(last_line(&String::from_utf8_lossy(&o.stderr))),
        Err(e) => Some(files::plain(e)),
    };
    if let Some(reason) = reason {
        // Half an installation is of no use; that it cannot be removed is no second error.
        let _ = std::fs::remove_dir_all(&temporary);
        return Err(RenderError::Install {
            command: format!("{program} -m pip install {PACKAGE}"),
            reason,
        });
    }
    std::fs::rename(&temporary, packages).map_err(|e| {
        RenderError::File(FileError::Write {
            path: packages.to_owned(),
            reason: files::plain(&e),
        })
    })
}

fn last_line(text: &str) -> String {
    let line = text.lines().rev().find(|line| !line.trim().is_empty());
    line.unwrap_or("nothing").trim().to_owned()
}

/// Runs the script on a plan and calls `on_event` as images become whole. Returns whether Blender came to its end.
///
/// # Errors
/// What the script refuses, and whatever `on_event` refuses; Blender is then stopped.
pub fn run(
    python: &Python,
    plan: &Path,
    log: &Path,
    mut on_event: impl FnMut(BlenderEvent) -> Result<(), RenderError>,
) -> Result<bool, RenderError> {
    let failed = |path: &Path, e: &std::io::Error| {
        RenderError::File(FileError::Write {
            path: path.to_owned(),
            reason: files::plain(e),
        })
    };
    let script = plan.with_file_name("render_frames.py");
    files::replace_atomically(&script, SCRIPT.as_bytes())?;
    let sink = std::fs::File::create(log).map_err(|e| failed(log, &e))?;
    let mut child = Command::new(&python.program)
        .args([&script, plan])
        .env("PYTHONPATH", &python.packages)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(sink)
        .spawn()
        .map_err(|e| failed(&script, &e))?;
    let said = child.stdout.take().map(|out| follow(out, &mut on_event));
    if let Some(Err(problem)) = said {
        // It may have ended by itself already.
        let _ = child.kill();
        let _ = child.wait();
        return Err(problem);
    }
    let status = child.wait().map_err(|e| failed(&script, &e))?;
    Ok(status.success())
}

/// Reads the script's lines; those of Blender itself are passed over.
fn follow(
    out: impl Read,
    on_event: &mut impl FnMut(BlenderEvent) -> Result<(), RenderError>,
) -> Result<(), RenderError> {
    for line in BufReader::new(out).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        match line.trim_end().split_once(' ') {
            Some(("geometry", view)) => on_event(BlenderEvent::Geometry(view.to_owned()))?,
            Some(("frame", name)) => on_event(BlenderEvent::Frame(name.to_owned()))?,
            Some(("refused", sentence)) => return Err(RenderError::Refused(sentence.to_owned())),
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scripts_lines_are_told_from_blenders() {
        let text = "Blender 4.5\nFra:1 Mem:40M\ngeometry az0_p15_d500\nframe a b\n";
        let mut events = Vec::new();
        let mut keep = |event| {
            events.push(event);
            Ok(())
        };
        follow(text.as_bytes(), &mut keep).unwrap();
        assert_eq!(
            events,
            [
                BlenderEvent::Geometry("az0_p15_d500".into()),
                BlenderEvent::Frame("a b".into())
            ]
        );
        let refused = follow(&b"refused the light is black\n"[..], &mut |_| Ok(())).unwrap_err();
        assert_eq!(refused.to_string(), "the light is black");
    }
}
