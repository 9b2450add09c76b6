//! `scaleproof attack import`: frames from another engine.

use crate::cli::print::attack::frames::say_frames;
use crate::cli::resolve::attack::frames::new_list;
use std::io::Write;

use crate::cli::args::attack::import::{ImportArgs, Layout};
use crate::cli::print::NewFile;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_frames::import::fca::{self};
use scaleproof_frames::import::import;

/// A vehicle that was recorded where it stands, not where it was put, is about on the road's level.
const NOTED_HEIGHT_M: f64 = 0.1;

pub fn run(args: &ImportArgs, out: &mut dyn Write) -> CommandResult {
    let list = new_list(&args.output)?;
    if files::is_same(&args.folder, &args.output) {
        return Err("the frames would be written over the images they come from; give another folder".into());
    }
    // Images a frame, beside the list.
    let (new, images) = match args.layout {
        Layout::Carla if args.model.mesh.is_some() => {
            return Err(
                "this layout brings its masks, so it takes no mesh; leave --mesh out, or give --layout fca".into(),
            );
        }
        Layout::Carla if let Some(option) = args.of_fca() => {
            return Err(
                format!("{option} is for --layout fca: import.json and poses.csv say it here; leave it out").into(),
            );
        }
        Layout::Carla => (import(&args.folder, &args.output, "attack import")?, 3),
        Layout::Fca => (import_fca(args)?, 5),
    };
    files::replace_all_atomically(&args.output, &new)?;
    say_frames(&list, new.len() / images, args.json, out)
}

fn import_fca(args: &ImportArgs) -> Result<Vec<NewFile>> {
    if args.model.filled()?.mesh.is_none() {
        return Err("this layout brings no masks: give the vehicle's mesh by --mesh or a scene that names it, as long as your model, as in --length-mm 487 --scale 10".into());
    }
    let request = args.fca_request()?;
    let made = progress::busy("drawing the mesh").during(|_| fca::import(&args.folder, &args.output, &request))?;
    let lowest_m = made.lowest_vehicle_m;
    if args.drop_m() == 0.0 && lowest_m > NOTED_HEIGHT_M {
        say!(
            "note: veh_trans puts the vehicle at {lowest_m:.2} m or higher; if the masks lie above it in the images, it dropped from there to \
             the road: give --drop-m {lowest_m:.2}"
        );
    }
    Ok(made.files)
}
