//! The program gphoto2: which cameras it finds, what one can do, and its commands.

use std::io::Read;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::error::TetherError;
use crate::capture::programs::{RunningProgram, is_there};

pub(super) const PROGRAM: &str = "gphoto2";

/// What it says of cameras within this; it asks every USB device.
const SAYS_WITHIN: Duration = Duration::from_secs(20);
/// More than its longest list.
const MOST_SAID: u64 = 1 << 20;

/// A camera that gphoto2 finds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundCamera {
    /// As its driver calls it, such as `Canon EOS 90D`.
    pub model: String,
    /// Where it is, such as `usb:001,005`.
    pub port: String,
}

/// What a camera can do for a computer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Abilities {
    pub model: String,
    /// It takes photos.
    pub captures: bool,
    /// It shows what it sees.
    pub previews: bool,
}

/// The cameras that gphoto2 finds at USB ports; `None` where the system has no gphoto2.
///
/// # Errors
/// It does not answer.
pub fn found_cameras() -> Result<Option<Vec<FoundCamera>>, TetherError> {
    if !is_there(PROGRAM) {
        return Ok(None);
    }
    Ok(Some(parse_found(&said(&["--auto-detect"], None)?)))
}

/// Of `gphoto2 --auto-detect`: below a line of dashes, a model and a port in each line.
pub fn parse_found(text: &str) -> Vec<FoundCamera> {
    let below = text.lines().skip_while(|line| !line.starts_with("-----")).skip(1);
    let cameras = below.filter_map(|line| {
        let (model, port) = line.trim().rsplit_once(char::is_whitespace)?;
        Some(FoundCamera {
            model: model.trim().to_owned(),
            port: port.to_owned(),
        })
    });
    cameras.collect()
}

/// What the camera at a port, or the only one, can do.
pub(super) fn abilities(port: Option<&str>) -> Result<Abilities, TetherError> {
    Ok(parse_abilities(&said(&["--abilities"], port)?))
}

/// Of `gphoto2 --abilities`: names and values with a colon between them; a line without a name goes on with the value of the line before.
pub fn parse_abilities(text: &str) -> Abilities {
    let mut abilities = Abilities::default();
    let mut last = "";
    for (name, value) in text.lines().filter_map(|line| line.split_once(':')) {
        let (name, value) = (name.trim(), value.trim());
        last = if name.is_empty() { last } else { name };
        match (last, value) {
            ("Abilities for camera", model) => abilities.model = model.to_owned(),
            ("Capture choices", "Image") => abilities.captures = true,
            ("Capture choices", "Preview") => abilities.previews = true,
            _ => {}
        }
    }
    abilities
}

/// A command for the camera at a port, or for the only one.
pub(super) fn command(arguments: &[&str], port: Option<&str>) -> Command {
    let mut command = Command::new(PROGRAM);
    if let Some(port) = port {
        command.args(["--port", port]);
    }
    command.args(arguments);
    command
}

/// Starts a command that leaves its files in a folder, under the camera's own names; none is removed from the camera.
pub(super) fn start_in(folder: &Path, action: &str, port: Option<&str>) -> Result<RunningProgram, TetherError> {
    let arguments = ["--keep", "--force-overwrite", "--filename", "%f.%C", action];
    let mut command = command(&arguments, port);
    let (program, mut stdout) = started(command.current_dir(folder))?;
    // What it tells there is not needed, but a full pipe would stop it.
    std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
    Ok(program)
}

pub(super) fn started(command: &mut Command) -> Result<(RunningProgram, std::process::ChildStdout), TetherError> {
    RunningProgram::start(command).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => TetherError::NoProgram,
        _ => TetherError::NotStarted(scaleproof_core::files::plain(&e)),
    })
}

/// What it says on standard output.
fn said(arguments: &[&str], port: Option<&str>) -> Result<String, TetherError> {
    let (program, stdout) = started(&mut command(arguments, port))?;
    let reading = std::thread::spawn(move || {
        let mut said = Vec::new();
        let _ = stdout.take(MOST_SAID).read_to_end(&mut said);
        said
    });
    let seconds = SAYS_WITHIN.as_secs();
    let ended = program
        .ended_within(SAYS_WITHIN)
        .ok_or(TetherError::TooSlow { seconds })?;
    if !ended.success() {
        return Err(TetherError::understood(&program.said()));
    }
    Ok(String::from_utf8_lossy(&reading.join().unwrap_or_default()).into_owned())
}
