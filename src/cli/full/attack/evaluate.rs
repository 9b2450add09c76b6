//! `scaleproof attack evaluate`: patterns re-rendered on the model and scored.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::render::{MESH, azimuths, cache, hex, mesh_file, named, size, textured};
use crate::cli::answer::told;
use crate::cli::args::model::ModelArgs;
use crate::cli::detectors::{self, Folder};
use crate::cli::print::tile_mm;
use crate::cli::results::Programs;
use crate::cli::score::{Effort, caution, score_with_progress};
use crate::cli::{CommandResult, Result, progress};
use crate::cli::{at_hand, patterns};
use scaleproof_attack::evaluate::RenderedSet;
use scaleproof_core::files;
use scaleproof_detect::Manifest;
use scaleproof_frames::render::{Panorama, ROUGHNESS, RenderPaint, RenderRequest, blender};
use scaleproof_pose::scene::{Classes, Scene, Viewpoint};
use scaleproof_score::Summary;
use scaleproof_score::report;
use scaleproof_score::{
    ApDefinition, BASE_VARIANT, Comparison, EvaluatedDetector, Scores, WornPattern, compare_with, decide,
    evaluated_detectors,
};
use scaleproof_session::Session;
use scaleproof_surface::model::Model;
use scaleproof_surface::pattern::Pattern;

/// Judge patterns on the model: render them at the paper's viewpoints under other lights, and score the detectors on the photos
///
/// Each paint's photos are kept: run the same command again to go on after an interruption, and with more patterns to add them.
#[derive(clap::Args)]
#[command(mut_arg("mesh", |mesh| mesh.help(MESH)))]
pub(in crate::cli) struct EvaluateArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// What the plain model wears: a flat colour as hex sRGB, as in 808080, or original for the mesh file's own materials
    #[arg(long, value_name = "HEX|original")]
    normal: String,
    /// Patterns and their names: PNG files with one pixel per cell, mapped onto the model as `print wrap` prints them
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1.., required_unless_present = "textures")]
    patterns: Vec<String>,
    /// Width of one repeat of the patterns on the model, in mm; without it, what each pattern's card says
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tile_mm: Option<f64>,
    /// Textures and their names, as in car.obj or NAME=car.obj: images for the mesh's texture coordinates, .obj, .glb or .ply files with images of
    /// their own, or .npy files with the texels of each triangle
    #[arg(long = "texture", value_name = "[NAME=]FILE", num_args = 1..)]
    textures: Vec<String>,
    /// The detectors that the patterns were made against: table 1 has them, table 2 the others; all are in table 1 without it
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    target: Vec<String>,
    /// Detector to score; several may be named; all whose weights are here when none is
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: Folder,
    #[command(flatten)]
    programs: Programs,
    /// Lights: Blender's own (city, courtyard, forest, interior, night, studio, sunrise, sunset) or .exr and .hdr files, turned as in forest@90;
    /// take others than the patterns were made under
    #[arg(long, value_name = "LIGHT", num_args = 1.., default_values = ["courtyard", "sunrise@60"])]
    light: Vec<String>,
    /// Azimuths in degrees, as in 0 45 90, or every so many degrees, as in every30
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "every30", allow_negative_numbers = true)]
    azimuth_deg: Vec<String>,
    #[arg(long, value_name = "DEG", num_args = 1.., default_values = ["0", "15", "30"], allow_negative_numbers = true)]
    pitch_deg: Vec<f64>,
    #[arg(long, value_name = "MM", num_args = 1.., default_values = ["900", "1200", "1500"], allow_negative_numbers = true)]
    distance_mm: Vec<f64>,
    /// Width and height of the photos in pixels, as in 320 or 320x240
    #[arg(long, value_name = "PX", default_value = "320x240")]
    size_px: String,
    /// Horizontal field of view
    #[arg(long, value_name = "DEG", default_value_t = 40.0, allow_negative_numbers = true)]
    field_of_view_deg: f64,
    /// Roughness of the paint's coat: 0 reflects like glass, 1 is matt
    #[arg(long, default_value_t = ROUGHNESS, allow_negative_numbers = true)]
    roughness: f64,
    /// Panorama paths a pixel, before the noise is cleaned away
    #[arg(long, default_value_t = 8)]
    samples: u32,
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// The label that counts as the model, or several, as in car,truck [default: as the scene says, else car]
    #[arg(long, value_name = "LABEL,…")]
    class: Option<Classes>,
    #[command(flatten)]
    effort: Effort,
    /// The tables as one JSON object instead of the text
    #[arg(long)]
    json: bool,
    /// Folder for the photos (a session, in `session`), evaluation.html, .csv and .tex, differences.csv, and the report of `score` in `score`
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn run(args: &EvaluateArgs, out: &mut dyn Write) -> CommandResult {
    let model = args.model.load()?;
    let mesh = mesh_file(&model)?;
    let scale = model.scale;
    let class = args.class()?;
    let (variants, paints, worn) = args.paints(&model)?;
    let evaluation = RenderedSet::new(args.request(model, paints)?, variants.clone())?;
    // What is missing for the scores is said before the long work.
    let detectors = args.detectors(&class)?;
    files::check_writable(&args.output)?;
    let [folder, report] = ["session", "score"].map(|name| args.output.join(name));
    files::chosen::check_folder(&args.output, &folder)?;
    files::chosen::check_folder(&args.output, &report)?;
    let python = || blender::find(&cache(), progress::announce);
    progress::frames("rendering", evaluation.photos().len())
        .during(|bar| evaluation.render(&folder, python, |done| bar.set_position(done as u64)))?;
    // The scene and the list of photos.
    let name = mesh.file_stem().unwrap_or_default().to_string_lossy();
    evaluation.write_session(&folder, (&name, &class, scale))?;
    let mut scores = args.scores(&folder, detectors)?;
    scores.patterns = worn;
    let tables = report::Evaluation {
        comparisons: comparisons(&scores, &variants)?,
        scores: &scores,
        patterns: variants,
        targets: args.target.clone(),
    };
    report::write(&report, &scores, None)?;
    let page = report::write_evaluation(&args.output, &tables)?;
    caution(&scores);
    let evaluated = Evaluated {
        classes: &class,
        box_labels: report::box_labels(tables.scores),
        patterns: &tables.patterns,
        targets: &tables.targets,
        results: &scores.summaries,
        comparisons: &tables.comparisons,
        page: &page,
    };
    let words = format!("{}\npage: {}", report::evaluation_tables(&tables), page.display());
    told(args.json, &evaluated, words, out)
}

/// Each variant against those after it.
fn comparisons(scores: &Scores, variants: &[String]) -> Result<Vec<Comparison>> {
    let names: Vec<&str> = variants.iter().map(String::as_str).collect();
    let compared = (1..names.len()).map(|i| compare_with(scores, names[i - 1], &names[i..], ApDefinition::Coco101));
    let mut compared: Vec<Comparison> = compared.collect::<Result<_, _>>()?;
    // Against the plain model; pattern against pattern has intervals alone.
    if let Some(from_plain) = compared.iter_mut().find(|comparison| comparison.base == BASE_VARIANT) {
        decide(from_plain);
    }
    Ok(compared)
}

type Paints = (Vec<String>, Vec<RenderPaint>, Vec<WornPattern>);

impl EvaluateArgs {
    /// The names of what the model wears, and the paints: the plain model's, then patterns and textures in the order of the command; and what
    /// the report shows of the patterns.
    fn paints(&self, model: &Model) -> Result<Paints> {
        let normal = match self.normal.as_str() {
            "original" => RenderPaint::Original,
            text => RenderPaint::Flat(hex(text)?),
        };
        let (mut names, mut paints, mut worn) = (vec![BASE_VARIANT.to_owned()], vec![normal], Vec::new());
        for text in &self.patterns {
            let (name, file) = patterns::named(text)?;
            let pattern = Pattern::load(file)?;
            let tile_mm = tile_mm(self.tile_mm, file, &pattern)?;
            worn.push(patterns::shown(name, file, &pattern, Some(tile_mm))?);
            names.push(name.to_owned());
            paints.push(RenderPaint::Pattern(name.to_owned(), pattern, tile_mm));
        }
        for text in &self.textures {
            let (name, path) = named(text);
            names.push(name.clone());
            paints.push(textured(name, path, model)?);
        }
        Ok((names, paints, worn))
    }

    fn request(&self, model: Model, colours: Vec<RenderPaint>) -> Result<RenderRequest> {
        let mesh_file = mesh_file(&model)?;
        let lights = self.light.iter().map(|text| text.parse());
        Ok(RenderRequest {
            turn: model.turn,
            mesh: model.mesh,
            materials: model.materials,
            lights: lights.collect::<Result<Vec<Panorama>, _>>()?,
            viewpoints: Viewpoint::combinations(&azimuths(&self.azimuth_deg)?, &self.pitch_deg, &self.distance_mm),
            colours,
            size_px: size(&self.size_px)?,
            field_of_view_deg: self.field_of_view_deg,
            roughness: self.roughness,
            samples: self.samples,
            denoise: true,
            seed: self.seed,
            factor: 1,
            threads: self.effort.threads.map_or(0, u32::from),
            made_by: String::new(),
            mesh_file,
        })
    }

    /// The labels that count as the model: as given, else as the scene says.
    fn class(&self) -> Result<Classes> {
        match (&self.class, &self.model.scene) {
            (Some(class), _) => Ok(class.clone()),
            (None, Some(scene)) => Ok(Scene::open(scene)?.model.class),
            (None, None) => Ok("car".parse()?),
        }
    }

    /// The detectors to score, whose weights are here, and those that are programs; the targets are among them.
    fn detectors(&self, class: &Classes) -> Result<(Vec<Manifest>, Vec<EvaluatedDetector>)> {
        let (networks, programs) = self.programs.among(&self.detectors)?;
        let manifests = if networks.is_empty() && !programs.is_empty() {
            Vec::new()
        } else {
            detectors::present(&networks, &self.folder.folders()?)?
        };
        for manifest in &manifests {
            manifest.counted(class.labels())?;
        }
        let started = self.programs.started(programs)?.into_iter();
        let programs: Vec<EvaluatedDetector> = started
            .map(|program| EvaluatedDetector::program(program, class))
            .collect::<Result<_, _>>()?;
        let all = || manifests.iter().chain(programs.iter().map(|p| &p.manifest));
        let names = || all().map(|manifest| manifest.name.as_str());
        at_hand::check_names(names())?;
        match self.target.iter().find(|target| names().all(|name| name != *target)) {
            Some(target) => {
                let names = names().collect::<Vec<_>>().join(", ");
                Err(format!("the target '{target}' is not among the detectors that are scored: {names}").into())
            }
            None => Ok((manifests, programs)),
        }
    }

    fn scores(&self, folder: &Path, (manifests, programs): (Vec<Manifest>, Vec<EvaluatedDetector>)) -> Result<Scores> {
        let sessions = vec![Session::open(folder)?];
        let mut detectors = evaluated_detectors(&sessions, manifests, Some(&self.folder.folders()?))?;
        detectors.extend(programs);
        let options = self.effort.options(&detectors)?;
        let scores = score_with_progress(sessions, detectors, &options)?;
        if let Some(photo) = scores.not_scored.first() {
            let (path, reason) = (folder.join(&photo.file), &photo.reason);
            let path = path.display();
            return Err(format!("{path} was not scored, so that the tables would not be whole: {reason}").into());
        }
        Ok(scores)
    }
}

/// `attack evaluate --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Evaluated<'a> {
    /// The labels that count as the model.
    classes: &'a Classes,
    /// As in `summary.json`.
    box_labels: BTreeMap<&'a str, &'static str>,
    /// Names of the patterns.
    patterns: &'a [String],
    /// The detectors that the patterns were made against.
    targets: &'a [String],
    /// As in `summary.json`.
    results: &'a [Summary],
    /// As in `comparison.json`.
    comparisons: &'a [Comparison],
    /// The path of the page.
    page: &'a Path,
}
