//! `scaleproof attack photos`: frames from photos of the real model in flat colours.

use std::collections::BTreeSet;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::render::hex;
use super::{CommandResult, Outcome, progress};
use crate::envelope;
use crate::files;
use crate::frames::LIST;
use crate::frames::light;
use crate::frames::photos::{LeftOut, Made, MadeView, Paper, Request, Shot, make};
use crate::locate::{Warning, locate_photo};
use crate::mesh::Mesh;
use crate::photo::Photo;
use crate::session::{PhotoEntry, Session};
use crate::tags::{TagDetector, TagDetectorChoice, paper_levels};
use crate::workers;

/// Make frames of photos of the model in flat colours: one photo of each colour from about the same place is a view
///
/// Photos are located by their tags and laid onto the reference photo of their view through the mesh that the scene names, at its
/// exposure. Photos and views that do not fit are left out and named; the photos are never changed.
#[derive(clap::Args)]
pub struct PhotosArgs {
    /// Sessions with photos of the model: photos of one place may be in several
    #[arg(value_name = "SESSION", required = true)]
    sessions: Vec<PathBuf>,
    /// Which variant of the session was painted in which flat colour: the paint's reflectance as hex sRGB, as in black=0a0a0a white=f0f0f0
    #[arg(long, value_name = "VARIANT=HEX", num_args = 1.., required = true)]
    flat: Vec<String>,
    /// The materials of the mesh that are the paint; all without it
    #[arg(long, value_name = "NAME", num_args = 1..)]
    material: Vec<String>,
    /// Width of the frames in pixels; they are as high as the photos' shape makes them
    #[arg(long, value_name = "PX", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=2048))]
    size_px: u32,
    /// Folder for the frames
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Exposures that differ by more cost accuracy, as cameras' tone curves are not sRGB's.
const MOST_GAIN: f64 = 1.2;

/// A variant and the colour it is painted in.
struct Flat {
    variant: String,
    rgb: [u8; 3],
}

pub fn run(args: &PhotosArgs, out: &mut dyn Write) -> CommandResult {
    let flats = flats(&args.flat)?;
    let sessions = args
        .sessions
        .iter()
        .map(|s| Session::open(s))
        .collect::<Result<Vec<_>, _>>()?;
    check_output(args, &sessions)?;
    let mesh = common_mesh(&sessions)?;
    check_variants(&flats, &sessions)?;
    let request = Request {
        materials: mesh.materials_named(&args.material)?,
        mesh,
        target_mm: sessions[0].scene.model.target_mm(),
        flats: flats.iter().map(|flat| flat.rgb).collect(),
        width_px: args.size_px,
        made_by: made_by(args, &sessions, &flats),
    };
    let Located { shots, left_out, notes } = located(&sessions, &flats)?;
    notes.iter().for_each(|note| say!("note: {note}"));
    let mut nowhere = std::io::sink();
    let text: &mut dyn Write = if args.json { &mut nowhere } else { &mut *out };
    say_left_out(&left_out, text)?;
    say_other_variants(&flats, &sessions, text)?;
    let bar = progress::frames("laying photos", 0);
    let made = make(&request, &shots, &args.output, |views| {
        bar.set_length(views as u64);
        bar.inc(1);
    });
    bar.finish_and_clear();
    let made = made?;
    say(&made, text)?;
    if made.frames == 0 {
        return Err("no view has photos in every colour that fit together; the lines `left out` say why".into());
    }
    files::replace_all_atomically(&made.files)?;
    let list = args.output.join(LIST);
    match args.json {
        true => writeln!(out, "{}", summary(&list, &made, &left_out))?,
        false => writeln!(
            out,
            "{}: {} frames of {} views",
            list.display(),
            made.frames,
            made.views.len()
        )?,
    }
    Ok(Outcome::Done)
}

/// `--json`.
fn summary(list: &Path, made: &Made, not_located: &[LeftOut]) -> Value {
    let view = |view: &MadeView| {
        let others = view.others.iter().map(|(photo, turn_deg, light_factors)| {
            json!({ "photo": photo, "turn_deg": turn_deg, "light_factors": light_factors })
        });
        json!({
            "name": view.name,
            "reference": view.reference,
            "others": others.collect::<Vec<_>>(),
            "paint_seen_by_all": view.kept,
        })
    };
    let left_out = not_located.iter().chain(&made.left_out);
    json!({
        "file": list,
        "frames": made.frames,
        "views": made.views.iter().map(view).collect::<Vec<_>>(),
        "left_out": left_out.map(|left| json!({ "what": left.what, "reason": left.reason })).collect::<Vec<_>>(),
    })
}

fn flats(texts: &[String]) -> Result<Vec<Flat>, Box<dyn Error>> {
    let mut flats: Vec<Flat> = Vec::new();
    for text in texts {
        let (variant, colour) = text
            .rsplit_once('=')
            .filter(|(variant, _)| !variant.is_empty())
            .ok_or_else(|| format!("--flat '{text}' is not understood; write VARIANT=HEX, as in black=0a0a0a"))?;
        let rgb = hex(colour)?;
        if flats.iter().any(|flat| flat.variant == variant || flat.rgb == rgb) {
            return Err(format!("--flat '{text}': its variant or its colour is there already; give each once").into());
        }
        flats.push(Flat {
            variant: variant.to_owned(),
            rgb,
        });
    }
    match flats.len() {
        1 => Err("one colour says nothing of others: give two variants or more with --flat, better three".into()),
        _ => Ok(flats),
    }
}

fn check_output(args: &PhotosArgs, sessions: &[Session]) -> Result<(), Box<dyn Error>> {
    let list = args.output.join(LIST);
    if list.exists() {
        return Err(format!("{} is there already; give another folder", list.display()).into());
    }
    let mut folders = BTreeSet::new();
    for session in sessions {
        let real = session.folder.canonicalize().unwrap_or_else(|_| session.folder.clone());
        if args.output.canonicalize().is_ok_and(|output| output == real) {
            return Err("the frames would be written among the photos they come from; give another folder".into());
        }
        if !folders.insert(real) {
            return Err(format!("the session {} is given twice; give it once", session.name).into());
        }
    }
    Ok(files::check_writable(&args.output)?)
}

/// The mesh that all scenes name; photos that say nothing of poses are refused.
fn common_mesh(sessions: &[Session]) -> Result<Mesh, Box<dyn Error>> {
    let mut common: Option<(&Session, Mesh)> = None;
    for session in sessions {
        let name = &session.name;
        let Some(path) = &session.mesh_path else {
            return Err(format!(
                "the scene of {name} names no mesh, through which photos are laid on each other: give its [model] envelope = \"mesh\" and mesh = \"FILE\""
            )
            .into());
        };
        session.known_camera()?;
        if session.scene.tags.is_empty() {
            return Err(format!(
                "the scene of {name} has no tags, and a viewpoint alone is no pose: photos are located by their tags"
            )
            .into());
        }
        let mesh = envelope::load(path, &session.scene.model)?;
        match &common {
            Some((first, known)) if *known != mesh || first.scene.model.size_mm != session.scene.model.size_mm => {
                return Err(format!(
                    "{} and {name} have different models: make frames of each by itself",
                    first.name
                )
                .into());
            }
            Some(_) => {}
            None => common = Some((session, mesh)),
        }
    }
    common.map(|(_, mesh)| mesh).ok_or_else(|| "give a session".into())
}

fn variants(sessions: &[Session]) -> BTreeSet<&str> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    photos.map(|p| p.variant.as_str()).collect()
}

fn check_variants(flats: &[Flat], sessions: &[Session]) -> Result<(), String> {
    let known = variants(sessions);
    let unknown = flats.iter().find(|flat| !known.contains(flat.variant.as_str()));
    unknown.map_or(Ok(()), |flat| {
        let known: Vec<_> = known.into_iter().collect();
        Err(format!(
            "no photo has the variant '{}'; the variants are {}",
            flat.variant,
            known.join(", ")
        ))
    })
}

/// A photo to be located, and the colour it shows.
struct Job<'a> {
    session: &'a Session,
    entry: &'a PhotoEntry,
    rgb: [u8; 3],
}

/// The photos with a pose, those without one, and what to know before believing the poses.
#[derive(Default)]
struct Located {
    shots: Vec<Shot>,
    left_out: Vec<LeftOut>,
    notes: BTreeSet<String>,
}

/// Locates every photo in one of the colours.
fn located(sessions: &[Session], flats: &[Flat]) -> Result<Located, Box<dyn Error>> {
    let mut jobs = Vec::new();
    for session in sessions {
        for entry in &session.photos {
            if let Some(flat) = flats.iter().find(|flat| flat.variant == entry.variant) {
                let rgb = flat.rgb;
                jobs.push(Job { session, entry, rgb });
            }
        }
    }
    let families: BTreeSet<_> = sessions.iter().flat_map(|s| s.scene.families()).collect();
    let families: Vec<_> = families.into_iter().collect();
    let bar = progress::photos("locating", jobs.len());
    let answers = workers::map(
        &jobs,
        || TagDetectorChoice::default().open(&families),
        |tags, job| Ok(shot(job, tags)),
        || bar.inc(1),
    );
    bar.finish_and_clear();
    let mut located = Located::default();
    for (job, answer) in jobs.iter().zip(answers?) {
        match answer {
            Ok((shot, notes)) => {
                located.shots.push(shot);
                located.notes.extend(notes);
            }
            Err(reason) => located.left_out.push(LeftOut {
                what: job.entry.file.clone(),
                reason,
            }),
        }
    }
    Ok(located)
}

/// A photo with its pose and its cautions, or why it is left out.
fn shot(job: &Job, tags: &mut dyn TagDetector) -> Result<(Shot, Vec<String>), String> {
    let session = job.session;
    let file = session.photo_path(job.entry);
    let photo = Photo::open(&file).map_err(|e| e.to_string())?;
    let camera = session.known_camera().map_err(|e| e.to_string())?;
    let found = locate_photo(&photo, &session.scene, camera, tags).map_err(|e| e.to_string())?;
    let seen = found.seen.clone();
    let (located, fitted) = found.pose_and_camera().map_err(|e| e.to_string())?;
    if located.warnings.contains(&Warning::PoorFit) {
        return Err(format!(
            "its tags fit badly (off by {:.1} px), so that the paint would not lie where it is: was a card moved, or is this another camera?",
            located.rms_px
        ));
    }
    let rgb = photo.rgb(1).map_err(|e| e.to_string())?;
    let trusted = |id: u32| located.tags.contains(&id);
    let papers = seen.iter().zip(paper_levels(&rgb, &seen)).filter_map(|(tag, level)| {
        (tag.is_whole && trusted(tag.id)).then_some(Paper {
            family: tag.family,
            id: tag.id,
            level: level?,
        })
    });
    let notes = fitted.cautions();
    let shot = Shot {
        flat_rgb: job.rgb,
        // Photos of another session may be of the same place only where both name it.
        place: job.entry.place.clone().unwrap_or_else(|| session.name.clone()),
        bin: located.bin,
        pose: located.pose,
        papers: papers.collect(),
        camera: fitted.camera,
        file,
    };
    Ok((shot, notes))
}

fn made_by(args: &PhotosArgs, sessions: &[Session], flats: &[Flat]) -> String {
    let names: Vec<&str> = sessions.iter().map(|s| s.name.as_str()).collect();
    let colours: Vec<String> = flats
        .iter()
        .map(|flat| format!("{}={}", flat.variant, light::to_hex(flat.rgb)))
        .collect();
    let mut text = format!("attack photos {} --flat {}", names.join(" "), colours.join(" "));
    if !args.material.is_empty() {
        text += &format!(" --material {}", args.material.join(" "));
    }
    text + &format!(" --size-px {}", args.size_px)
}

fn say(made: &Made, out: &mut dyn Write) -> std::io::Result<()> {
    for view in &made.views {
        let others = view.others.iter().map(|(name, turn_deg, gain)| {
            let [r, g, b] = gain;
            format!("{name} ({turn_deg:.1}° aside, light × {r:.2} {g:.2} {b:.2})")
        });
        writeln!(
            out,
            "{}: {} with {}; {:.0} % of its paint is seen by all",
            view.name,
            view.reference,
            others.collect::<Vec<_>>().join(", "),
            100.0 * view.kept
        )?;
    }
    let gains = made.views.iter().flat_map(|v| &v.others).flat_map(|(_, _, gain)| gain);
    let most = gains.map(|gain| gain.max(1.0 / gain)).fold(1.0, f64::max);
    if most > MOST_GAIN {
        say!(
            "note: the photos' exposures or white balances differ by up to × {most:.1}, and a camera's tone curve is not sRGB's: colours are less \
             exact than with one exposure; lock it, for black, grey and white paint alike"
        );
    }
    say_left_out(&made.left_out, out)
}

fn say_left_out(left_out: &[LeftOut], out: &mut dyn Write) -> std::io::Result<()> {
    let mut lines = left_out.iter();
    lines.try_for_each(|left| writeln!(out, "left out: {}: {}", left.what, left.reason))
}

fn say_other_variants(flats: &[Flat], sessions: &[Session], out: &mut dyn Write) -> std::io::Result<()> {
    let mut all = variants(sessions);
    all.retain(|variant| flats.iter().all(|flat| flat.variant != *variant));
    all.iter().try_for_each(|variant| {
        writeln!(
            out,
            "left out: photos of the variant {variant}: --flat does not name it"
        )
    })
}
