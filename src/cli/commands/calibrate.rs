//! `scaleproof calibrate`: photos of a board, or a video of one or of a scene's tags, become a camera file.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::answer::answer;
use crate::cli::args::calibrate::Args;
use crate::cli::{CommandResult, Outcome, photos, progress};
use scaleproof_core::files;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::CameraFormat;
use scaleproof_pose::scene::Scene;
use scaleproof_rig::calibrate::{self, Film, Target};

/// Runs `scaleproof calibrate`.
pub fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    let board = args.board.as_deref().map(Definition::open).transpose()?;
    let scene = args.scene.as_deref().map(Scene::open).transpose()?;
    let target = match (&board, &scene) {
        (Some(board), _) => Target::Board(board),
        (None, Some(scene)) => Target::Scene(scene),
        (None, None) => return Err("give what the photos show: --board, or of a video --scene".into()),
    };
    board.as_ref().map_or(Ok(()), calibrate::check)?;
    let found = match video(&args.photos)? {
        Some(video) => {
            let film = look(video, target)?;
            progress::busy("fitting the camera").during(|_| calibrate::calibrate_film(film, target))?
        }
        None => {
            let board = board
                .as_ref()
                .ok_or("--scene takes a video: photos calibrate with a printed board (--board)")?;
            args.photos = photos::of(&args.photos)?;
            let bar = progress::photos("looking", args.photos.len());
            let (seen, left_out) = calibrate::detect_boards(&args.photos, board, || bar.inc(1));
            bar.finish_and_clear();
            progress::busy("fitting the camera").during(|_| calibrate::calibrate(seen, left_out, board))?
        }
    };
    let mut files = Vec::new();
    if let Some(path) = &args.output {
        let text = found.camera.write(CameraFormat::OpenCv)?;
        files.push((path.clone(), text.into_bytes()));
    }
    let page = |path: &PathBuf| (path.clone(), calibrate::page(&found).into_bytes());
    files.extend(args.report.iter().map(page));
    files::write_all_atomically(&files)?;
    if args.json {
        answer(&calibrate::answer(&found), out)?;
    } else {
        write!(out, "{}", calibrate::table(&found))?;
        for (path, _) in &files {
            writeln!(out, "written: {}", path.display())?;
        }
    }
    for left in &found.left_out {
        say!("left out {}: {}", left.file, left.reason);
    }
    found.cautions.iter().for_each(|c| say!("note: {}", c.0));
    Ok(Outcome::Done)
}

/// The one video, where a video is named.
pub fn video(named: &[PathBuf]) -> crate::cli::Result<Option<&PathBuf>> {
    match (named.iter().find(|path| is_video(path)), named) {
        (Some(video), [_, _, ..]) => Err(format!(
            "{} is a video, and a camera comes from one video alone, since another shot may be cropped otherwise: leave out the rest",
            video.display()
        )
        .into()),
        (found, _) => Ok(found),
    }
}

fn look(video: &Path, target: Target) -> crate::cli::Result<Film> {
    Ok(progress::frames("looking", 0).during(|bar| {
        calibrate::look_at_video(video, target, |done, all| {
            bar.set_length(all);
            bar.set_position(done);
        })
    })?)
}

/// Endings of the containers that are read, as cameras and telephones write them.
const VIDEOS: [&str; 12] = [
    "mp4", "m4v", "mov", "3gp", "mkv", "webm", "avi", "ts", "mts", "m2ts", "mpg", "mpeg",
];

/// By the name's end.
fn is_video(path: &Path) -> bool {
    let end = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase());
    end.is_some_and(|end| VIDEOS.contains(&end.as_str()))
}
