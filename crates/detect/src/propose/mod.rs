//! Manifests proposed for ONNX files: the family of the outputs, and what no file says.

mod details; // units and orders of boxes, by their numbers
mod error;
mod family; // the families of detectors
mod inspect; // inputs of a network, and its answers to two images
mod metadata; // what Ultralytics' exporter writes into a file
mod numbers; // families that a network's numbers rule out
mod preprocessor; // preprocessor_config.json beside a network
mod recognise; // families by the shapes of outputs

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

pub use error::ProposeError;
pub use family::Family;
pub use metadata::{height_and_width, python_names};
pub use preprocessor::preprocessed;

use super::heads::{self, HeadError, Tensor};
use super::manifest::{Head, Input, Resize, Values};
use super::weights::network_sha256;
use super::{Labels, Manifest, ManifestError, Runtime};
use inspect::Inspected;
use preprocessor::Preprocessor;
use recognise::FamilyCandidate;
use scaleproof_core::files;
use scaleproof_core::message::{Message, bail, message};

/// Settings that a user knows and the file may not say.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hints {
    pub family: Option<Family>,
    pub labels: Option<Labels>,
    /// Width, height of the input, for files that leave it open.
    pub size_px: Option<[u32; 2]>,
    /// The number that the network gives the first of the labels, where its family numbers them otherwise.
    pub first_label: Option<i64>,
    /// Time limit for each of two runs of the network, if not 30 s.
    pub time_limit: Option<Duration>,
}

/// A manifest that the network was run with, and what it rests on.
#[derive(Debug)]
pub struct Proposal {
    pub family: Family,
    pub manifest: Manifest,
    /// The manifest as TOML.
    pub text: String,
    /// Notes on what was read from the file and what was not.
    pub notes: Vec<Message>,
}

/// Time limit for each of the two images.
const TRIAL_LIMIT: Duration = Duration::from_secs(30);

/// The network as seen from a manifest: by its name when they lie together, else by its whole path.
pub fn weights_seen_from(manifest: &Path, model: &Path) -> String {
    let folder = |path: &Path| {
        let folder = files::folder_of(path);
        folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
    };
    let file = model.file_name().map(Path::new).unwrap_or(model);
    let seen = if folder(model) == folder(manifest) {
        file.to_owned()
    } else {
        folder(model).join(file)
    };
    seen.to_string_lossy().into_owned()
}

/// The name of a network's file without its ending, in the characters that a manifest's name may have; never a built-in detector's.
pub fn own_name(model: &Path) -> Result<String, ManifestError> {
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    let name = stem.trim_start_matches('.').replace(|c| !is_plain(c), "_");
    let is_taken = name.is_empty() || Manifest::all()?.iter().any(|m| m.name == name);
    Ok(if is_taken { format!("own_{name}") } else { name })
}

/// Inspects an ONNX file, runs it on a grey image and on noise, and writes the manifest of the family that fits.
///
/// `weights` is how the manifest names the file. Nothing is guessed where two families fit or labels are not known: those
/// are errors that say what to name. How a photo is prepared is the family's usual way; the notes say so.
pub fn propose(
    runtime: &Runtime,
    path: &Path,
    weights: &str,
    name: &str,
    hints: Hints,
) -> Result<Proposal, ProposeError> {
    let bytes = files::read(path)?;
    let time_limit = hints.time_limit.unwrap_or(TRIAL_LIMIT);
    let preprocessor = Preprocessor::beside(path)?;
    let usual_px = preprocessor.as_ref().and_then(Preprocessor::size_px);
    let network = inspect::inspect(runtime, path, &bytes, [hints.size_px, usual_px], time_limit)?;
    let sha256 = network_sha256(path, bytes)?;
    if let Some(task) = network.metadata.task.as_ref().filter(|task| *task != "detect") {
        bail!("the file says that its task is {task:?}, and only detectors can be scored");
    }
    if let Some(what) = network.answers.iter().find_map(|a| heads::with_no_number(a)) {
        return Err(not_a_number(&what).into());
    }
    let known = match (hints.labels, &network.metadata.names) {
        (Some(labels), _) => Some(labels),
        (None, Some(names)) => {
            let unusable = |e| no_labels(&format!("the names that the file gives cannot be used, as {e}"));
            Some(Labels::of_names(names.clone()).map_err(unusable)?)
        }
        (None, None) => None,
    };
    let named = hints.family;
    let candidate = chosen(&network, named.or_else(|| preprocessor.as_ref()?.family()), known)?;
    let (labels, guessed) = labels(&candidate, known)?;
    let family = candidate.family;
    let (input, said) = input(&network, family, preprocessor.as_ref(), hints.size_px)?;
    let mut manifest = Manifest::unstated(name, labels, input);
    manifest.head = head(&candidate, labels, &network, hints.first_label)?;
    manifest.weights.file = weights.to_owned();
    manifest.weights.sha256 = sha256;
    if let Some(licence) = &network.metadata.licence {
        manifest.licence.clone_from(licence);
    }
    let text = manifest.to_toml()?;
    for outputs in &network.answers {
        heads::candidates(&manifest, outputs, network.size_px).map_err(|e| match e {
            HeadError::NotFinite(what) => not_a_number(&what),
            e => message!("the network's outputs cannot be read as {}: {e}", family.title()),
        })?;
    }
    Ok(Proposal {
        family,
        notes: notes(&network, &candidate, &manifest, guessed, &said),
        manifest,
        text,
    })
}

/// Returns the input as its preprocessor says, and else the family's usual one, for what this network takes; and which settings the preprocessor says.
fn input(
    network: &Inspected,
    family: Family,
    preprocessor: Option<&Preprocessor>,
    named_px: Option<[u32; 2]>,
) -> Result<(Input, Vec<&'static str>), Message> {
    let is_open = network.takes.size_px.is_none();
    let takes_any_size = is_open && family.takes_any_size();
    let mut input = family.usual_input((!takes_any_size).then_some(network.size_px))?;
    (input.layout, input.values) = (network.takes.layout, network.takes.values);
    if input.values == Values::U8 {
        (input.mean, input.std) = ([0.0; 3], [1.0; 3]);
    } else if let Some(own) = network.file.prepares {
        (input.mean, input.std) = ([0.0; 3], [own.std(); 3]);
    }
    let said = preprocessor.map(|own| own.apply(&mut input, is_open && named_px.is_none()));
    Ok((input, said.unwrap_or_default()))
}

/// The family's usual head, with what this network's numbers say.
fn head(
    candidate: &FamilyCandidate,
    labels: Labels,
    network: &Inspected,
    first_label: Option<i64>,
) -> Result<Head, Message> {
    let mut head = candidate.family.usual_head()?;
    let outputs = &network.answers[1];
    match &mut head {
        Head::Nanodet(own) | Head::Picodet(own) | Head::NanodetPlus(own) => own.strides.clone_from(&candidate.strides),
        Head::Efficientdet(own) => own.scores = numbers::scores(network),
        Head::Yolov5(own) => own.boxes = details::unit(numbers::boxes(candidate, network)),
        Head::Yolov8(own) => own.boxes = details::unit(numbers::boxes(candidate, network)),
        Head::Ssd(own) => {
            let pair = heads::Pair::find(outputs, |columns| Some(columns) == candidate.labels);
            own.boxes = pair
                .and_then(|pair| details::ssd_boxes(outputs, pair, network.size_px))
                .unwrap_or(own.boxes);
            own.scores = numbers::pair_scores(network, candidate.labels);
        }
        Head::Yolov3(own) => {
            if let Some(anchors) = &network.metadata.anchors
                && anchors.len() == own.grids.len()
            {
                let grids = own.grids.iter_mut().zip(anchors);
                grids.for_each(|(grid, anchors)| grid.anchors.clone_from(anchors));
            }
        }
        // 0 is the background, except with COCO's category ids, which need no shift.
        Head::TfOd(own) => {
            let is_ids = i64::from(labels == Labels::Coco91);
            own.outputs = recognise::tflite(network).filter(|_| candidate.family == Family::TfliteSsd);
            // TFLite's operator leaves the background out.
            own.first_label = if own.outputs.is_some() { -is_ids } else { 1 - is_ids };
            own.first_label = first_label.unwrap_or(own.first_label);
        }
        Head::SsdResnet34(own) | Head::Rcnn(own) => {
            own.first_label = first_label.unwrap_or(i64::from(labels != Labels::Coco91));
        }
        _ => {}
    }
    Ok(head)
}

/// The one family that fits, or why there is not one.
fn chosen(network: &Inspected, named: Option<Family>, labels: Option<Labels>) -> Result<FamilyCandidate, Message> {
    let outputs = shapes(&network.answers[0]);
    let mut fitting = recognise::by_shape(network);
    if let Some(named) = named {
        if !fitting.iter().any(|c| c.family == named) {
            let others: Vec<&str> = fitting.iter().map(|c| c.family.name()).collect();
            let instead = if others.is_empty() {
                "they are of no known family".to_owned()
            } else {
                format!("they could be of {}", others.join(" or "))
            };
            bail!("its outputs {outputs} are not those of {}: {instead}", named.title());
        }
        fitting.retain(|c| c.family == named);
    }
    if fitting.is_empty() {
        let [width, height] = network.size_px;
        let needs = recognise::needs(network.size_px);
        bail!(
            "its outputs {outputs} are of no known family: for an input of {width}×{height}, {needs}; see the table in docs/guide/reference/detector-manifest.md"
        );
    }
    if named.is_none() && fitting.iter().any(|c| c.family == Family::Yolov3) {
        bail!(
            "its outputs {outputs} are grids before their decoding, of YOLOv3 or of a later YOLO, which decodes them otherwise: name the family if it is yolov3, or export the network with its decoding"
        );
    }
    // Conditional DETR, which has the shapes of DETR, is rare, and must be named where no preprocessor says it.
    if fitting.iter().any(|c| c.family == Family::Detr) {
        fitting.retain(|c| c.family == Family::Detr);
    }
    // Labels that fit none of them are another mistake than numbers that do not.
    if let Some(labels) = labels {
        let (families, given) = (titles(&fitting), labels.count());
        let rooms: BTreeSet<usize> = fitting.iter().filter_map(|c| c.labels).collect();
        fitting.retain(|c| c.labels.is_none_or(|room| fits(c.family, room, labels)));
        if fitting.is_empty() {
            let room = rooms.iter().map(usize::to_string).collect::<Vec<_>>().join(" or ");
            bail!(
                "its outputs {outputs} could be of {families}, with room for {room} labels, and {given} are named: the labels are another network's"
            );
        }
    }
    let mut refuted = Vec::new();
    fitting.retain(|c| {
        let reason = numbers::against(c, network);
        refuted.extend(
            reason
                .iter()
                .map(|reason| format!("{}, but {reason}", c.family.title())),
        );
        reason.is_none()
    });
    match fitting.len() {
        1 => Ok(fitting.swap_remove(0)),
        0 => bail!("its outputs {outputs} have the shapes of {}", refuted.join("; of ")),
        _ => bail!(
            "its outputs {outputs} could be of {}, which are fed differently", titles(&fitting);
            hint: "name yours by ‹family›"
        ),
    }
}

/// "yolox (YOLOX) or yolov5 (YOLOv5, v6 or v7)".
fn titles(candidates: &[FamilyCandidate]) -> String {
    let titles = candidates
        .iter()
        .map(|c| format!("{} ({})", c.family.name(), c.family.title()));
    titles.collect::<Vec<_>>().join(" or ")
}

/// RF-DETR may have a column more, for "no object", and an SSD for the background; COCO's category ids leave 0 out.
fn fits(family: Family, room: usize, labels: Labels) -> bool {
    let count = labels.count();
    match family {
        Family::Rfdetr => room == count || room == count + 1,
        Family::Ssd => heads::has_room(room, count),
        Family::SsdTable | Family::Yolov8 => room == count || (room, count) == (90, 91),
        _ => room == count,
    }
}

/// The labels of a network, and which list they are taken for by their number alone.
fn labels(candidate: &FamilyCandidate, known: Option<Labels>) -> Result<(Labels, Option<&'static str>), Message> {
    if let Some(labels) = known {
        return Ok((labels, None));
    }
    let what = match candidate.labels {
        Some(81) if candidate.family == Family::Ssd => return Ok((Labels::Coco80, Some("coco80"))),
        Some(21) if candidate.family == Family::Ssd => return Ok((Labels::Voc20, Some("voc20"))),
        Some(80) => return Ok((Labels::Coco80, Some("coco80"))),
        Some(90) if matches!(candidate.family, Family::Ssd | Family::SsdTable) => {
            return Ok((Labels::Coco91, Some("coco91")));
        }
        Some(91) => return Ok((Labels::Coco91, Some("coco91"))),
        Some(20) => return Ok((Labels::Voc20, Some("voc20"))),
        Some(room) => format!("the outputs have room for {room} labels, which the file does not name"),
        None => "neither the file nor the outputs' shapes say what the labels are".to_owned(),
    };
    Err(no_labels(&what))
}

fn no_labels(what: &str) -> Message {
    message!("{what}").hint("name the labels by ‹labels›, as coco80, coco91, voc20 or a file with one a line")
}

fn not_a_number(what: &str) -> Message {
    message!("it answers a plain grey image or noise with {what}: no box of it could be trusted")
}

fn shapes(outputs: &[Tensor]) -> String {
    let of = |t: &Tensor| {
        let shape: Vec<String> = t.shape.iter().map(usize::to_string).collect();
        format!("{} {}", t.name, shape.join("×"))
    };
    outputs.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn notes(
    network: &Inspected,
    candidate: &FamilyCandidate,
    manifest: &Manifest,
    guessed: Option<&str>,
    said: &[&str],
) -> Vec<Message> {
    let family = candidate.family;
    let mut notes = vec![message!(
        "{}: inferred from inputs {} and outputs {}, and from what it answers to a grey image and to noise",
        family.title(),
        network.inputs,
        shapes(&network.answers[0])
    )];
    if let Some(list) = guessed {
        let count = candidate.labels.unwrap_or(manifest.labels.count());
        let note = message!("the labels are taken for {list}, as there are {count}");
        notes.push(note.hint("name others by ‹labels›"));
    }
    if network.takes.size_px.is_none() && !family.takes_any_size() && !said.contains(&"input.size_px") {
        let [width, height] = manifest.input.size_px;
        let note = message!("the file leaves the input's size open: {width}×{height} is taken");
        notes.push(note.hint("name another by ‹size›"));
    }
    if network.takes.values == Values::U8 && family != Family::TfOd {
        notes.push(message!(
            "the input is bytes, so the network is taken to normalise them itself"
        ));
    }
    if network.takes.values == Values::F32
        && let Some(own) = network.file.prepares
    {
        let highest = if own.std() == 1.0 { 255 } else { 1 };
        notes.push(message!(
            "the network's first nodes bring its values into range themselves, so that it is given values 0 to {highest}"
        ));
    }
    if !said.is_empty() {
        notes.push(message!(
            "{} are those of preprocessor_config.json beside it",
            said.join(", ")
        ));
    }
    let settings = usual_settings(manifest, said);
    if !settings.is_empty() {
        notes.push(message!(
            "{settings} are the family's usual, as no file says them: compare them with the program that the weights come from"
        ));
    }
    notes
}

/// Returns what of a manifest no file says, as far as this one has it.
fn usual_settings(manifest: &Manifest, said: &[&str]) -> String {
    let (input, head) = (&manifest.input, &manifest.head);
    let is_resized = input.resize != Resize::Original;
    let has_border = is_resized && !matches!(input.resize, Resize::Stretch | Resize::ShortSide | Resize::ShortestEdge);
    let has_labels = manifest.head.with_other_labels().is_some();
    let all = [
        ("input.resize", true),
        ("input.kernel", is_resized),
        ("input.pad", has_border),
        ("input.channels", true),
        ("input.mean", true),
        ("input.std", true),
        ("head.nms_iou", head.nms_iou().is_some()),
        ("head.labels", has_labels),
        (
            "head.first_label",
            matches!(head, Head::TfOd(_) | Head::SsdResnet34(_) | Head::Rcnn(_)),
        ),
    ];
    let is_usual = |(name, is_there): &&(&str, bool)| *is_there && !said.contains(name);
    let kept = all.iter().filter(is_usual).map(|(name, _)| *name);
    kept.collect::<Vec<_>>().join(", ")
}
