//! `scaleproof attack photos`: frames from photos of the real model in flat colours.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use crate::cli::answer::told;
use crate::cli::args::attack::photos::PhotosArgs;
use crate::cli::print::attack::photos::{FramesOfPhotos, say, say_left_out};
use crate::cli::resolve::attack::frames::new_list;
use crate::cli::resolve::attack::render::{hex, options};
use crate::cli::resolve::model::{paint_of, painted};
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_frames::light;
use scaleproof_frames::photos::sessions::{
    FlatVariant, LocatedPhotos, check_variants, common_mesh, locate_flats, of_flats, variants,
};
use scaleproof_frames::photos::{LeftOutPhoto, PhotoFramesRequest, make};
use scaleproof_session::Session;

pub fn run(args: &PhotosArgs, out: &mut dyn Write) -> CommandResult {
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

/// Returns the path of the list of frames. Refuses output among the photos, and a session given twice.
fn check_output(args: &PhotosArgs, sessions: &[Session]) -> Result<PathBuf> {
    let list = new_list(&args.output)?;
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

fn other_variants(flats: &[FlatVariant], sessions: &[Session]) -> impl Iterator<Item = LeftOutPhoto> {
    let mut all = variants(sessions);
    all.retain(|variant| flats.iter().all(|flat| flat.variant != *variant));
    all.into_iter().map(|variant| LeftOutPhoto {
        what: format!("photos of the variant {variant}"),
        reason: "--flat does not name it".into(),
    })
}
