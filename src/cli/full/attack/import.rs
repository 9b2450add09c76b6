//! `scaleproof attack import`: frames from another engine.

use std::io::Write;
use std::path::PathBuf;

use clap::ValueEnum;

use super::render::{described, file_name, hex, options};
use crate::cli::args::model::ModelArgs;
use crate::cli::print::NewFile;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_frames::FramePaint;
use scaleproof_frames::import::fca::{self, FcaRequest};
use scaleproof_frames::import::import;

/// Make frames of a folder that another engine exported (layouts of CARLA scripts; see the guide, `frames.md`)
#[derive(clap::Args)]
// Only one of the layouts needs a mesh.
#[command(mut_arg("mesh", |mesh| mesh.required_unless_present_any(["scene", "folder"]).help("The vehicle's surface: .glb, .obj, .stl or .ply (fca)")))]
pub(in crate::cli) struct ImportArgs {
    /// The folder with import.json, poses.csv, rgb/ and mask/, or with .npz files
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// What is in the folder
    #[arg(long, value_enum, default_value = "carla")]
    layout: Layout,
    #[command(flatten)]
    model: ModelArgs,
    /// How far below veh_trans the vehicle stands, in metres: scripts write down where it was put, before it dropped to the road
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    drop_m: Option<f64>,
    /// Horizontal field of view (fca) [default: 90]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    field_of_view_deg: Option<f64>,
    /// The reflectance of the paint as hex sRGB, if it is flat and known (fca)
    #[arg(long, value_name = "HEX")]
    flat: Option<String>,
    /// Folder for the frames
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Layout {
    /// import.json, poses.csv, images and masks
    Carla,
    /// .npz files with img, veh_trans and cam_trans; the masks are drawn from the mesh
    Fca,
}

/// A vehicle that was recorded where it stands, not where it was put, is about on the road's level.
const NOTED_HEIGHT_M: f64 = 0.1;

pub(super) fn run(args: &ImportArgs, out: &mut dyn Write) -> CommandResult {
    let list = super::new_list(&args.output)?;
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
    super::say_frames(&list, new.len() / images, args.json, out)
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

impl ImportArgs {
    fn drop_m(&self) -> f64 {
        self.drop_m.unwrap_or(0.0)
    }

    fn field_of_view_deg(&self) -> f64 {
        self.field_of_view_deg.unwrap_or(90.0)
    }

    /// An option that was given and says nothing to the layout with masks.
    fn of_fca(&self) -> Option<&'static str> {
        let given = [
            ("--drop-m", self.drop_m.is_some()),
            ("--field-of-view-deg", self.field_of_view_deg.is_some()),
            ("--flat", self.flat.is_some()),
            ("--scale", self.model.scale.is_some()),
        ];
        let own = given.iter().find_map(|(option, is_given)| is_given.then_some(*option));
        own.or_else(|| self.model.of_a_mesh())
    }

    fn fca_request(&self) -> Result<FcaRequest> {
        let model = self.model.load()?;
        Ok(FcaRequest {
            mesh: model.mesh,
            materials: model.materials,
            scale: model.scale,
            drop_m: self.drop_m(),
            field_of_view_deg: self.field_of_view_deg(),
            paint: match &self.flat {
                Some(text) => FramePaint::FlatRgb(hex(text)?),
                None => FramePaint::Original,
            },
            made_by: self.made_by(&self.model.filled()?, model.scale),
        })
    }

    /// The arguments that decide about the frames, with files by their names only.
    fn made_by(&self, model: &ModelArgs, scale: f64) -> String {
        format!(
            "attack import --layout fca --mesh {}{} --scale {scale} --drop-m {} --field-of-view-deg {}{}",
            model.mesh.as_deref().map(file_name).unwrap_or_default(),
            described(model),
            self.drop_m(),
            self.field_of_view_deg(),
            options([("flat", self.flat.clone())])
        )
    }
}
