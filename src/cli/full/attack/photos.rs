//! `scaleproof attack photos`: frames from photos of the real model in flat colours.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::render::{hex, options};
use crate::cli::answer::told;
use crate::cli::resolve::model::{paint_of, painted};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_frames::light;
use scaleproof_frames::photos::sessions::{
    FlatVariant, LocatedPhotos, check_variants, common_mesh, locate_flats, of_flats, variants,
};
use scaleproof_frames::photos::{FramedView, LeftOutPhoto, PhotoFrames, PhotoFramesRequest, make};
use scaleproof_session::Session;

/// Make frames of photos of the model in flat colours: one photo of each colour from about the same place is a view
///
/// Photos are located by their tags and mapped onto the reference photo of their view through the mesh that the scene names, at its
/// exposure. Photos and views that do not fit are left out and named; the photos are never changed.
#[derive(clap::Args)]
pub(in crate::cli) struct PhotosArgs {
    /// Sessions with photos of the model: photos of one place may be in several
    #[arg(value_name = "SESSION", required = true)]
    sessions: Vec<PathBuf>,
    /// Which variant of the session was painted in which flat colour: the paint's reflectance as hex sRGB, as in black=0a0a0a white=f0f0f0
    #[arg(long, value_name = "VARIANT=HEX", num_args = 1.., required = true)]
    flat: Vec<String>,
    /// The materials of the mesh that are the paint; without it, the scene's paint, or all
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

pub(super) fn run(args: &PhotosArgs, out: &mut dyn Write) -> CommandResult {
    let flats = flats(&args.flat)?;
    let sessions = args
        .sessions
        .iter()
        .map(|s| Session::open(s))
        .collect::<Result<Vec<_>, _>>()?;
    let list = check_output(args, &sessions)?;
    let mesh = common_mesh(&sessions)?;
    check_variants(&flats, &sessions)?;
    let first = &sessions[0];
    let (materials, faces) = match &args.material[..] {
        [] => paint_of(&first.scene.model, &first.scene_path),
        given => (given.to_vec(), None),
    };
    let (mesh, materials) = painted(mesh, &materials, faces.as_deref())?;
    let request = PhotoFramesRequest {
        materials,
        mesh,
        target_mm: first.scene.model.target_mm(),
        flats: flats.iter().map(|flat| flat.rgb).collect(),
        width_px: args.size_px,
        made_by: made_by(args, &sessions, &flats),
    };
    let LocatedPhotos {
        photos,
        mut left_out,
        notes,
    } = progress::photos("locating", of_flats(&sessions, &flats).len())
        .during(|bar| locate_flats(&sessions, &flats, || bar.inc(1)))?;
    notes.iter().for_each(|note| say!("note: {note}"));
    let mut nowhere = std::io::sink();
    let text: &mut dyn Write = if args.json { &mut nowhere } else { &mut *out };
    left_out.extend(other_variants(&flats, &sessions));
    say_left_out(&left_out, text)?;
    let made = progress::frames("mapping photos", 0).during(|bar| {
        make(&request, &photos, &args.output, |views| {
            bar.set_length(views as u64);
            bar.inc(1);
        })
    })?;
    say(&made, text)?;
    if made.frames == 0 {
        return Err("no view has photos in every colour that fit together; the lines `left out` say why".into());
    }
    files::replace_all_atomically(&args.output, &made.files)?;
    let (path, views) = (list.display(), made.views.len());
    let words = format!("{path}: {} of {}", count(made.frames, "frame"), count(views, "view"));
    left_out.extend(made.left_out);
    let framed = FramesOfPhotos {
        file: &list,
        frames: made.frames,
        views: &made.views,
        left_out: &left_out,
    };
    told(args.json, &framed, words, out)
}

/// `attack photos --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct FramesOfPhotos<'a> {
    /// The path of `frames.json`.
    file: &'a Path,
    /// How many frames it lists.
    frames: usize,
    views: &'a [FramedView],
    left_out: &'a [LeftOutPhoto],
}

fn flats(texts: &[String]) -> Result<Vec<FlatVariant>> {
    let mut flats: Vec<FlatVariant> = Vec::new();
    for text in texts {
        let (variant, colour) = text
            .rsplit_once('=')
            .filter(|(variant, _)| !variant.is_empty())
            .ok_or_else(|| format!("--flat '{text}' is not understood; write VARIANT=HEX, as in black=0a0a0a"))?;
        let rgb = hex(colour)?;
        if flats.iter().any(|flat| flat.variant == variant || flat.rgb == rgb) {
            return Err(format!("--flat '{text}': its variant or its colour is there already; give each once").into());
        }
        flats.push(FlatVariant {
            variant: variant.to_owned(),
            rgb,
        });
    }
    match flats.len() {
        1 => Err("one colour says nothing of others: give two variants or more with --flat, better three".into()),
        _ => Ok(flats),
    }
}

/// Where the frames will be listed.
fn check_output(args: &PhotosArgs, sessions: &[Session]) -> Result<PathBuf> {
    let list = super::new_list(&args.output)?;
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
    files::check_writable(&args.output)?;
    Ok(list)
}

fn made_by(args: &PhotosArgs, sessions: &[Session], flats: &[FlatVariant]) -> String {
    let names: Vec<&str> = sessions.iter().map(|s| s.name.as_str()).collect();
    let colours: Vec<String> = flats
        .iter()
        .map(|flat| format!("{}={}", flat.variant, light::to_hex(flat.rgb)))
        .collect();
    let material = (!args.material.is_empty()).then(|| args.material.join(" "));
    format!("attack photos {}", names.join(" "))
        + &options([
            ("flat", Some(colours.join(" "))),
            ("material", material),
            ("size-px", Some(args.size_px.to_string())),
        ])
}

fn say(made: &PhotoFrames, out: &mut dyn Write) -> std::io::Result<()> {
    for view in &made.views {
        let others = view.others.iter().map(|other| {
            let (photo, turn_deg, [r, g, b]) = (&other.photo, other.turn_deg, other.light_factors);
            format!("{photo} ({turn_deg:.1}° aside, light × {r:.2} {g:.2} {b:.2})")
        });
        writeln!(
            out,
            "{}: {} with {}; {:.0} % of its paint is seen by all",
            view.name,
            view.reference,
            others.collect::<Vec<_>>().join(", "),
            100.0 * view.paint_seen_by_all
        )?;
    }
    let others = made.views.iter().flat_map(|view| &view.others);
    let gains = others.flat_map(|other| other.light_factors);
    let most = gains.map(|gain| gain.max(1.0 / gain)).fold(1.0, f64::max);
    if most > MOST_GAIN {
        say!(
            "note: the photos' exposures or white balances differ by up to × {most:.1}, and a camera's tone curve is not sRGB's: colours are less \
             exact than with one exposure; lock it, for black, grey and white paint alike"
        );
    }
    say_left_out(&made.left_out, out)
}

fn say_left_out(left_out: &[LeftOutPhoto], out: &mut dyn Write) -> std::io::Result<()> {
    let mut lines = left_out.iter();
    lines.try_for_each(|left| writeln!(out, "left out: {}: {}", left.what, left.reason))
}

fn other_variants(flats: &[FlatVariant], sessions: &[Session]) -> impl Iterator<Item = LeftOutPhoto> {
    let mut all = variants(sessions);
    all.retain(|variant| flats.iter().all(|flat| flat.variant != *variant));
    all.into_iter().map(|variant| LeftOutPhoto {
        what: format!("photos of the variant {variant}"),
        reason: "--flat does not name it".into(),
    })
}
