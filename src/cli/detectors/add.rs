//! `scaleproof detectors add`: from an ONNX file to a manifest of the user's own.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::told;
use crate::cli::{CommandResult, Result, advice};
use scaleproof_core::files;
use scaleproof_core::message::message;
use scaleproof_detect::{
    self as detect, Family, Hints, Labels, Manifest, ProposeError, Runtime, WeightFolders, darknet_to_onnx, own_name,
    propose, weights_seen_from,
};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The network (ONNX), or the .cfg of one of Darknet.
    model: PathBuf,
    /// The .weights of a .cfg: both become an ONNX file beside the manifest.
    weights: Option<PathBuf>,
    /// The manifest to write; beside the network and named as it is, when left out.
    #[arg(short, long, alias = "out", value_name = "FILE.toml")]
    output: Option<PathBuf>,
    /// What the class numbers mean: coco80, coco91, voc20, or a text file with one label a line.
    #[arg(long, value_name = "LABELS")]
    labels: Option<String>,
    /// The family, where two have the same outputs: yolov5, yolov8, yolox, deim and others.
    #[arg(long, value_name = "NAME", value_parser = Family::from_name)]
    family: Option<Family>,
    /// The input's size in pixels, where the file leaves it open: 640 or 640x480 (width first).
    #[arg(long, value_name = "SIZE", value_parser = size)]
    size: Option<[u32; 2]>,
    /// The number that the network gives the first of the labels, where it counts otherwise than its family does; `detectors validate` finds it.
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    first_label: Option<i64>,
    /// What labels of the network count as, where the scene calls them otherwise, as in PKW=car,LKW=truck.
    #[arg(long, value_name = "OWN=COUNTED", value_delimiter = ',', value_parser = mapped)]
    map: Vec<(String, String)>,
    /// Put the detector on the list too, so that `--detector NAME` finds it from everywhere.
    #[arg(long)]
    register: bool,
    /// One JSON object instead of the text.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let path = args.output.clone().unwrap_or_else(|| args.model.with_extension("toml"));
    if path.exists() {
        let there = path.display();
        return Err(format!("{there} is already there: remove it, or name another file by --output").into());
    }
    if path.extension().is_none_or(|e| e != "toml") {
        return Err(format!(
            "{} does not end in .toml, by which --detector knows a manifest",
            path.display()
        )
        .into());
    }
    let hints = Hints {
        family: args.family,
        labels: args.labels.as_deref().map(labels).transpose()?,
        size_px: args.size,
        first_label: args.first_label,
        ..Hints::default()
    };
    let class_map = class_map(&args.map)?;
    // First, so that a file that cannot be read is named as such.
    files::read(&args.model)?;
    let runtime = Runtime::load()?;
    let converted = converted(&args, &path)?;
    let model = converted.as_deref().unwrap_or(&args.model);
    let (weights, name) = (weights_seen_from(&path, model), own_name(model)?);
    let proposal = propose(runtime, model, &weights, &name, hints);
    let proposal = proposal.map_err(|e| {
        // Without a manifest nobody wants it.
        let _ = converted
            .as_ref()
            .map(|file| files::chosen::remove(files::folder_of(file), file));
        match e {
            // These name the file themselves.
            ProposeError::File(_) | ProposeError::Detect(_) => message!("{e}").caused_by(e),
            e => message!("{}: {e}", args.model.display()).caused_by(e),
        }
    })?;
    let manifest = Manifest {
        class_map,
        ..proposal.manifest
    };
    files::write_atomically(&path, manifest.to_toml()?.as_bytes())?;
    let notes: Vec<String> = proposal.notes.iter().map(|note| advice::sentence(note)).collect();
    for note in &notes {
        say!("note: {note}");
    }
    let registered = args.register.then(|| register(&path)).transpose()?;
    let file = path.display().to_string();
    let (on_list, called) = match &registered {
        Some(list) => (format!("registered: {}\n", list.display()), &manifest.name),
        None => (String::new(), &file),
    };
    let words = format!("manifest: {file}\n{on_list}try it: scaleproof detectors check --detector {called} PHOTO…");
    let added = Added {
        name: &manifest.name,
        manifest: &path,
        family: proposal.family.name(),
        registered: registered.as_deref(),
        notes: &notes,
    };
    told(args.json, added, words, out)
}

/// The ONNX file that a Darknet network becomes; `None` where the network is one already.
fn converted(args: &Args, manifest: &Path) -> Result<Option<PathBuf>> {
    let ends_in = |path: &Path, ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    let weights = match (&args.weights, ends_in(&args.model, "cfg")) {
        (None, false) if ends_in(&args.model, "weights") => {
            return Err(
                "the .cfg of Darknet's .weights is needed: scaleproof detectors add NAME.cfg NAME.weights".into(),
            );
        }
        (None, false) => return Ok(None),
        (Some(weights), true) => weights,
        (None, true) => {
            return Err("the .weights of a .cfg are needed: scaleproof detectors add NAME.cfg NAME.weights".into());
        }
        (Some(weights), false) => {
            let second = weights.display();
            return Err(format!("{second}: a second file is needed only with Darknet's .cfg as the first").into());
        }
    };
    let onnx = manifest.with_extension("onnx");
    if onnx.exists() {
        let there = onnx.display();
        return Err(format!("{there} is already there: remove it, or name another manifest by --output").into());
    }
    files::write_atomically(&onnx, &darknet_to_onnx(&args.model, weights)?)?;
    Ok(Some(onnx))
}

/// The manifest as it lies there now, weights beside it.
fn register(manifest: &Path) -> Result<PathBuf> {
    Ok(detect::register(&Manifest::open(manifest)?, &WeightFolders::new(None))?)
}

fn mapped(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').map(|(own, counted)| (own.trim(), counted.trim()));
    let whole = pair.filter(|(own, counted)| !own.is_empty() && !counted.is_empty());
    whole
        .map(|(own, counted)| (own.to_owned(), counted.to_owned()))
        .ok_or_else(|| "write the network's label and what it counts as, as in PKW=car".to_owned())
}

fn class_map(pairs: &[(String, String)]) -> Result<BTreeMap<String, String>, String> {
    let mut map = BTreeMap::new();
    for (own, counted) in pairs {
        if map.insert(own.clone(), counted.clone()).is_some() {
            return Err(format!("--map names `{own}` twice: a label counts as one thing"));
        }
    }
    Ok(map)
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |s: &str| s.parse().ok().filter(|side| (32..=8192).contains(side));
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    let size = side(width).zip(side(height)).map(|(w, h)| [w, h]);
    size.ok_or_else(|| "give 640, or width and height as 640x480, each from 32 to 8192".to_owned())
}

fn labels(text: &str) -> Result<Labels> {
    if let Some(list) = Labels::of_list(text) {
        return Ok(list);
    }
    let lines = files::read_text(Path::new(text))
        .map_err(|e| format!("--labels {text} is neither coco80, coco91 nor voc20, and as a file: {e}"))?;
    let names = lines.lines().map(str::trim).filter(|line| !line.is_empty());
    Ok(Labels::of_names(names.map(str::to_owned).collect()).map_err(|e| format!("{text}: {e}"))?)
}

/// `detectors add --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Added<'a> {
    /// Of the new detector.
    name: &'a str,
    /// The manifest that was written.
    manifest: &'a Path,
    /// The family whose head it has.
    family: &'a str,
    /// Where it is on your own list, with `--register`.
    registered: Option<&'a Path>,
    /// What to compare with the program that the weights come from.
    notes: &'a [String],
}
