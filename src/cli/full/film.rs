//! `scaleproof session from-video`: the best frames of a walk round the model become photos of a session.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use schemars::JsonSchema;
use serde::Serialize;

use super::capture::check_names;
use super::interrupt::on_interrupt;
use crate::cli::answer::told;
use crate::cli::session::{by_variant, in_words};
use crate::cli::sessions::{self, FolderFiles};
use crate::cli::{CommandResult, Result};
use scaleproof_capture::{Measures, slug};
use scaleproof_core::files;
use scaleproof_core::geometry::angle::direction_text;
use scaleproof_core::spelling::count;
use scaleproof_core::statistics::upper_median;
use scaleproof_film::choose::{Refusal, Wish, refused};
use scaleproof_film::hold::Held;
use scaleproof_film::keep::{KeepError, Kept, PairDifference};
use scaleproof_film::look::Look;
use scaleproof_film::pairs::Wanted;
use scaleproof_film::walk::{LookError, Walk, open_video, usual_step};
use scaleproof_film::{cause, coverage, sheet};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::{Bin, Scene, Viewpoint};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::filling;
use scaleproof_session::folders::PhotoFolder;
use scaleproof_session::{NewSession, PhotoEntry, Session};
use scaleproof_terminal::progress;
use scaleproof_video::Selection;

/// Make photos of a video of a walk round the model: the best frames of each bin, in a session
///
/// Every frame is located by its tags; kept are the sharpest that show the whole model as the scene's bins ask. Where the session has photos of another
/// texture at the same place, the frames nearest to their viewpoints are kept, so that pairs differ in the texture alone. The video is never changed.
/// Videos are read with ffmpeg.
#[derive(clap::Args)]
pub(in crate::cli) struct FilmArgs {
    /// The video: MP4, MOV, MKV or WebM, as the camera wrote it
    video: PathBuf,
    /// What stands on the table, scene.toml [default: that of the session]
    #[arg(long, value_name = "TOML")]
    scene: Option<PathBuf>,
    /// The camera file of this camera's videos, whose crop is another than that of its photos [default: that of the session]
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// The texture on the model; `normal` is the plain one
    #[arg(long, value_name = "NAME")]
    variant: String,
    /// Where it was filmed; photos of one place are not independent
    #[arg(long, value_name = "NAME")]
    place: String,
    /// The session's folder; one that is there gets the photos besides those it has
    #[arg(short, long, value_name = "SESSION")]
    output: PathBuf,
    /// Frames of each bin; as many as there are photos to pair with, where the session has another texture
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1000))]
    per_bin: u16,
    /// Seconds between two frames of one bin, at least
    #[arg(long, value_name = "S", default_value = "0.3", value_parser = seconds)]
    apart: f64,
    /// Begin at this time of the video, s
    #[arg(long, value_name = "S", default_value = "0", value_parser = seconds)]
    from: f64,
    /// End at this time of the video, s
    #[arg(long, value_name = "S", value_parser = seconds)]
    to: Option<f64>,
    /// Look at every so-manieth frame only [default: as leaves 30 a second or so]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    every: Option<u64>,
    /// Keep frames as PNG instead of JPEG of quality 95
    #[arg(long)]
    png: bool,
    /// Print what was made as one JSON object
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|s| (0.0..=1e6).contains(s));
    number.ok_or_else(|| "give seconds, from 0 to 1000000".into())
}

/// `session from-video --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// The session's folder.
    session: PathBuf,
    /// The `session.json` in it.
    file: PathBuf,
    video: VideoFacts,
    /// Every so-manieth frame was looked at.
    every: u64,
    /// How many frames were looked at.
    frames: usize,
    /// How many of them have a pose.
    located: usize,
    /// How many of them were fit to be chosen.
    fit: usize,
    /// The others by reason.
    refused: BTreeMap<Refusal, usize>,
    /// The photos that were made.
    chosen: Vec<ChosenFrame>,
    /// Bins of the scene without a photo of this video.
    empty_bins: Vec<Bin>,
    /// The texture whose photos frames were paired with; `null` where there is none.
    paired_with: Option<String>,
    /// Its photos without a pair in this video.
    unpaired: Vec<String>,
    /// The chosen frames, small, on one image.
    contact_sheet: PathBuf,
    /// Where the camera stood in all frames.
    coverage: PathBuf,
    /// What to know before the photos are believed, as sentences.
    notes: Vec<String>,
}

/// A video, as its header says.
#[derive(Serialize, JsonSchema)]
struct VideoFacts {
    name: String,
    sha256: String,
    /// Of an upright frame.
    width_px: u32,
    /// Of an upright frame.
    height_px: u32,
    /// Clockwise.
    turned_deg: u32,
    codec: String,
    duration_s: Option<f64>,
    /// SDR, HLG or PQ.
    range: &'static str,
}

/// A frame that is a photo now.
#[derive(Serialize, JsonSchema)]
struct ChosenFrame {
    /// From the session's folder.
    file: String,
    /// Its number in the video, from 0.
    frame: u64,
    time_s: f64,
    bin: Bin,
    viewpoint: Viewpoint,
    sigma: Sigma,
    gates: Measures,
    pair: Option<Pair>,
}

/// The photo that a frame is a pair of.
#[derive(Serialize, JsonSchema)]
struct Pair {
    file: String,
    /// From the photo's viewpoint to the frame's.
    difference: PairDifference,
}

/// What is read before a frame is looked at.
struct Film {
    walk: Walk,
    files: FolderFiles,
    /// The frames that are looked at.
    part: Selection,
    /// SHA-256 of the session's list; `None` without a session.
    list: Option<String>,
}

impl Film {
    /// Another run may have filled the session between the reading of it and the lock on it.
    fn refuse_if_changed(&self, args: &FilmArgs) -> Result<()> {
        if hash_of_list(&args.output)? == self.list {
            return Ok(());
        }
        let folder = args.output.display();
        Err(format!("{folder} was filled by another run just now: call this again").into())
    }
}

fn hash_of_list(session: &Path) -> Result<Option<String>> {
    let list = session.join("session.json");
    Ok(list.exists().then(|| files::sha256_of_file(&list)).transpose()?)
}

pub(in crate::cli) fn run(args: FilmArgs, out: &mut dyn Write) -> CommandResult {
    let film = opened(&args)?;
    let stopped = Arc::new(AtomicBool::new(false));
    let heard = stopped.clone();
    on_interrupt(move || heard.store(true, Ordering::Relaxed));
    let had_folder = args.output.exists();
    files::make_named_folder(&args.output)?;
    let lock = filling::locked(&args.output)?;
    let made = film
        .refuse_if_changed(&args)
        .and_then(|()| make(&args, &film, &stopped));
    // Also that of a run that was killed; a capture makes its own again.
    let _ = files::chosen::remove(&args.output, &args.output.join(filling::MARK));
    if !had_folder {
        files::remove_if_empty(&args.output);
    }
    drop(lock);
    match made {
        Ok((answer, words)) => told(args.json, answer, words, out),
        Err(e) if e.is::<Interruption>() => {
            say!("{e}");
            std::process::exit(130)
        }
        Err(e) => Err(e),
    }
}

/// Ctrl-C.
#[derive(Debug, thiserror::Error)]
#[error("stopped: no photo was kept")]
struct Interruption;

fn opened(args: &FilmArgs) -> Result<Film> {
    check_names(&args.variant, &args.place)?;
    if args.to.is_some_and(|to| to <= args.from) {
        return Err("--to must be later than --from".into());
    }
    let mut files = FolderFiles::new(args.scene.clone(), args.camera.clone(), args.place.clone());
    let list = args.output.join("session.json");
    let session = list.exists().then(|| {
        files::inputs::own(&list);
        sessions::session(&args.output)
    });
    let session = session.transpose()?;
    let hash = hash_of_list(&args.output)?;
    if let Some(session) = &session {
        files.or_those_of(session)?;
    }
    let (scene, camera) = (Scene::open(files.scene()?)?, Camera::open(files.camera()?)?);
    let state = files::FileState::of(&args.video)?;
    let video = open_video(&args.video, &camera)?;
    let sha256 = files::sha256_of_file(&args.video)?;
    let wanted = match &session {
        Some(session) => {
            refuse_twice(session, args, &sha256)?;
            Wanted::of(session, &args.variant, &args.place, TagDetectorChoice::default())?
        }
        None => Wanted::default(),
    };
    let part = Selection {
        from_s: args.from,
        to_s: args.to,
        every: args.every.unwrap_or_else(|| usual_step(&video)),
        ..Selection::default()
    };
    let walk = Walk {
        name: files::name_of(&args.video),
        video,
        sha256,
        state,
        scene,
        camera,
        wanted,
    };
    Ok(Film {
        walk,
        files,
        part,
        list: hash,
    })
}

/// Each photo counts once.
fn refuse_twice(session: &Session, args: &FilmArgs, sha256: &str) -> Result<()> {
    let is_it = |photo: &&PhotoEntry| photo.frame.as_ref().is_some_and(|frame| frame.sha256 == sha256);
    match session.photos.iter().find(is_it) {
        Some(photo) => {
            let (folder, video) = (args.output.display(), args.video.display());
            Err(format!(
                "{folder} has frames of {video} already, as {}: name a new session",
                photo.file
            )
            .into())
        }
        None => Ok(()),
    }
}

/// Looks, chooses, writes; the answer, and the answer in words.
fn make(args: &FilmArgs, film: &Film, stopped: &AtomicBool) -> Result<(Answer, String)> {
    let wish = film.walk.wish(args.per_bin.into(), args.apart);
    let (looks, held) = look(args, film, &wish, stopped)?;
    let folder = folder_name(&slug(&args.variant), &slug(&stem(&film.walk.name)));
    let folder = files::free_place(&args.output.join(folder));
    let kept = keep(args, film, (&looks, &wish), &held, &folder, stopped)?;
    if kept.is_empty() {
        let why = nothing(args, &wish, &looks);
        let cause = cause::cause(&film.walk, &looks, [film.files.scene()?, film.files.camera()?]);
        return Err(cause.map_or(why.clone(), |cause| format!("{why}: {cause}")).into());
    }
    let made = write(args, film, &looks, &wish, &folder, &kept);
    if made.is_err() {
        // Photos that no list names would be taken for photos of nobody knows what.
        let _ = files::chosen::remove_folder(&args.output, &folder);
        for picture in pictures(&folder) {
            let _ = files::chosen::remove(&args.output, &picture);
        }
    }
    made
}

/// The folder of the photos: named by the texture and the video.
fn folder_name(variant: &str, video: &str) -> String {
    if video.starts_with(variant) {
        video.to_owned()
    } else {
        format!("{variant}_{video}")
    }
}

fn stem(name: &str) -> String {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}

/// Why no frame was chosen, and what to do.
fn nothing(args: &FilmArgs, wish: &Wish, looks: &[Look]) -> String {
    let video = args.video.display();
    let refused = refused(wish, looks);
    let reasons: Vec<String> = refused
        .iter()
        .map(|(why, count)| format!("{} {count}", why.name()))
        .collect();
    if reasons.is_empty() {
        return format!(
            "{video}: no frame is near enough to a photo of the session to be its pair: film from the same height and distance"
        );
    }
    format!(
        "{video}: none of {} can be a photo ({}): see the guide, Film instead of photographs",
        count(looks.len(), "frame"),
        reasons.join(", ")
    )
}

/// Looks at the frames.
fn look(args: &FilmArgs, film: &Film, wish: &Wish, stopped: &AtomicBool) -> Result<(Vec<Look>, Held)> {
    let walk = &film.walk;
    let mut shown = None;
    let looked = |looks: &[Look]| {
        let progress = shown.get_or_insert_with(|| progress::frames("looking at", walk.expected(&film.part)));
        progress.set_position(looks.len() as u64);
        !stopped.load(Ordering::Relaxed)
    };
    let (looks, held) = walk.looks(&film.part, wish, looked).map_err(|e| match e {
        LookError::Interrupted => Interruption.into(),
        // What is before the damage can be used.
        LookError::Video {
            error,
            whole_s: Some(whole_s),
        } => format!("{error}, or use what is before with --to {whole_s:.1}").into(),
        other => Box::<dyn std::error::Error>::from(other),
    })?;
    if let Some(progress) = shown {
        progress.finish_and_clear();
    }
    if looks.is_empty() {
        let to = args.to.map_or(String::new(), |to| format!(" and before {to} s"));
        return Err(format!("{} has no frame after {} s{to}", args.video.display(), args.from).into());
    }
    Ok((looks, held))
}

/// Writes the chosen frames into a folder of the session.
fn keep(
    args: &FilmArgs,
    film: &Film,
    (looks, wish): (&[Look], &Wish),
    held: &Held,
    folder: &Path,
    stopped: &AtomicBool,
) -> Result<Vec<Kept>> {
    let progress = progress::frames("keeping", film.walk.choose(looks, wish).len());
    let goes_on = || {
        progress.inc(1);
        !stopped.load(Ordering::Relaxed)
    };
    let texture = (args.variant.as_str(), args.place.as_str());
    let kept = film.walk.keep(texture, args.png, (looks, wish), held, folder, goes_on);
    let kept = kept.map_err(|e| match e {
        KeepError::Interrupted => Interruption.into(),
        other => Box::<dyn std::error::Error>::from(other),
    })?;
    progress.finish_and_clear();
    Ok(kept)
}

/// The contact sheet and the coverage plot of the photos in a folder, beside it.
fn pictures(photos: &Path) -> [PathBuf; 2] {
    let inside = files::name_of(photos);
    ["contact.png", "coverage.svg"].map(|ending| photos.with_file_name(format!("{inside}.{ending}")))
}

/// Writes the session and the pictures beside it.
fn write(
    args: &FilmArgs,
    film: &Film,
    looks: &[Look],
    wish: &Wish,
    folder: &Path,
    kept: &[Kept],
) -> Result<(Answer, String)> {
    let walk = &film.walk;
    let mut gathered = film.files.gather(&[PhotoFolder {
        variant: args.variant.clone(),
        place: Some(args.place.clone()),
        folder: folder.to_owned(),
    }])?;
    for photo in &mut gathered.session.photos {
        let own = kept
            .iter()
            .find(|one| Path::new(&one.file) == Path::new(&files::name_of(Path::new(&photo.file))));
        photo.frame = own.map(|one| one.frame.clone());
    }
    let inside = files::name_of(folder);
    let [contact_sheet, coverage] = pictures(folder);
    let title = format!("{}: {}", walk.name, args.variant);
    files::replace_all_atomically(
        &args.output,
        &[
            (&contact_sheet, sheet::png(kept).unwrap_or_default()),
            (&coverage, coverage::svg(&title, wish, looks, kept).into_bytes()),
        ],
    )?;
    let (file, photos) = NewSession {
        folder: &args.output,
        photos: &gathered,
        scene: film.files.scene()?,
        camera: film.files.camera()?,
        copy: false,
    }
    .write()?;
    let chosen = kept.iter().map(|one| ChosenFrame {
        file: format!("{inside}/{}", one.file),
        frame: one.frame.number,
        time_s: one.frame.time_s,
        bin: one.bin,
        viewpoint: one.viewpoint,
        sigma: one.sigma,
        gates: one.measures,
        pair: one.pair.map(|(place, difference)| Pair {
            file: walk.wanted.files[place].clone(),
            difference,
        }),
    });
    let refused = refused(wish, looks);
    let video = &walk.video;
    let answer = Answer {
        session: args.output.clone(),
        file: file.clone(),
        video: VideoFacts {
            name: walk.name.clone(),
            sha256: walk.sha256.clone(),
            width_px: video.width,
            height_px: video.height,
            turned_deg: video.turned_deg,
            codec: video.codec.clone(),
            duration_s: video.duration_s,
            range: video.range.name(),
        },
        every: film.part.every,
        frames: looks.len(),
        located: looks.iter().filter(|look| look.shows.is_ok()).count(),
        fit: looks.len() - refused.values().sum::<usize>(),
        refused,
        chosen: chosen.collect(),
        empty_bins: walk.empty_bins(kept),
        paired_with: Some(walk.wanted.variant.clone()).filter(|variant| !variant.is_empty()),
        unpaired: walk.unpaired(kept),
        contact_sheet,
        coverage,
        notes: walk.notes(kept),
    };
    let variants = by_variant(photos.iter().map(|photo| &*photo.variant));
    let words = words(&answer) + &in_words(&file, photos.len(), &variants, &args.output);
    Ok((answer, words))
}

fn words(answer: &Answer) -> String {
    let mut lines = vec![format!(
        "{}: {} looked at, {} located, {} fit, {} chosen",
        answer.video.name,
        count(answer.frames, "frame"),
        answer.located,
        answer.fit,
        answer.chosen.len()
    )];
    let refused: Vec<String> = answer
        .refused
        .iter()
        .map(|(why, count)| format!("{} {count}", why.name()))
        .collect();
    if !refused.is_empty() {
        lines.push(format!("refused: {}", refused.join(", ")));
    }
    for one in &answer.chosen {
        let (v, s) = (&one.viewpoint, &one.sigma);
        let blur = one
            .gates
            .blur_px
            .map_or(String::new(), |px| format!(", blur {px:.2} px"));
        let pair = one.pair.as_ref().map_or(String::new(), |pair| {
            format!(", {:.2}° from {}", pair.difference.apart_deg, pair.file)
        });
        lines.push(format!(
            "  {}: frame {} at {:.2} s, {}° ± {:.2}° / {:.1}° / {:.0} mm{blur}{pair}",
            one.file,
            one.frame,
            one.time_s,
            direction_text(v.azimuth_deg, 2),
            s.azimuth_deg,
            v.pitch_deg,
            v.distance_mm
        ));
    }
    if let Some(variant) = &answer.paired_with {
        let apart: Vec<f64> = answer
            .chosen
            .iter()
            .filter_map(|one| Some(one.pair.as_ref()?.difference.apart_deg))
            .collect();
        let most = apart.iter().copied().fold(0.0, f64::max);
        let median = upper_median(&apart).unwrap_or(0.0);
        lines.push(format!(
            "{} with {variant}: viewpoints differ by {median:.2}° (median), {most:.2}° at most",
            count(apart.len(), "pair")
        ));
    }
    if !answer.unpaired.is_empty() {
        lines.push(format!("without a pair: {}", answer.unpaired.join(", ")));
    }
    if !answer.empty_bins.is_empty() && answer.paired_with.is_none() {
        let names = answer
            .empty_bins
            .iter()
            .map(|b| format!("{:.0}°/{:.0}°/{:.0} mm", b.azimuth_deg, b.pitch_deg, b.distance_mm));
        lines.push(format!(
            "bins without a frame: {}",
            names.collect::<Vec<_>>().join(", ")
        ));
    }
    lines.extend(answer.notes.iter().map(|note| format!("note: {note}")));
    lines.push(format!(
        "{}, {}",
        answer.contact_sheet.display(),
        answer.coverage.display()
    ));
    lines.join("\n") + "\n"
}
