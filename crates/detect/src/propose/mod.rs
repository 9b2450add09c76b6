//! From an ONNX file alone to a manifest: which family its outputs are of, and what no file says.

mod details;
mod family;
mod inspect;
mod metadata;
mod numbers;
mod preprocessor;
mod recognise;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub use family::Family;
pub use metadata::{height_and_width, python_names};
pub use preprocessor::preprocessed;

use super::heads::{self, HeadError, Tensor};
use super::manifest::{Head, Input, Resize, SIDES_PX, Values};
use super::weights::network_sha256;
use super::{DetectError, Labels, Manifest, ManifestError, Runtime};
use inspect::Inspected;
use preprocessor::Preprocessor;
use recognise::FamilyCandidate;
use scaleproof_core::files;

/// What the user knows and the file may not say.
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
#[derive(Debug, Clone)]
pub struct Proposal {
    pub family: Family,
    pub manifest: Manifest,
    /// The manifest as TOML.
    pub text: String,
    /// What was read from the file and what was not, as sentences.
    pub notes: Vec<ProposalNote>,
}

/// What was read from a file or taken for granted, as a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProposalNote {
    #[error(
        "{title}: inferred from inputs {inputs} and outputs {outputs}, and from what it answers to a grey image and to noise"
    )]
    Recognised {
        title: &'static str,
        inputs: String,
        outputs: String,
    },
    #[error("the labels are taken for {list}, as there are {count}")]
    LabelsByCount { list: String, count: usize },
    #[error("the file leaves the input's size open: {width}×{height} is taken")]
    OpenSize { width: u32, height: u32 },
    #[error("the input is bytes, so the network is taken to normalise them itself")]
    Bytes,
    #[error(
        "the network's first nodes bring its values into range themselves, so that it is given values 0 to {highest}"
    )]
    OwnRange { highest: u8 },
    #[error("{settings} are those of preprocessor_config.json beside it")]
    Preprocessor { settings: String },
    #[error(
        "{settings} are the family's usual, as no file says them: compare them with the program that the weights come from"
    )]
    UsualInput { settings: String },
}

/// Why no manifest can be proposed, as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum ProposeError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error(transparent)]
    Detect(#[from] DetectError),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error(
        "no input is an image of three channels (inputs: {inputs}): this is no detector for photos, or it \
         must be exported with three channels fixed"
    )]
    NoImage { inputs: String },
    #[error("several inputs could be the image ({inputs}): only networks that look at one image can be used")]
    SeveralImages { inputs: String },
    #[error("the image is neither float32 nor uint8 (inputs: {inputs}): export the network with float32 inputs")]
    OtherNumbers { inputs: String },
    #[error(
        "besides the image only the photo's size can be given, as a second input of two whole numbers (inputs: {inputs}): export the \
         network without the others"
    )]
    OtherInputs { inputs: String },
    #[error("the network takes several images at once (inputs: {inputs}): export it for a single one")]
    Batch { inputs: String },
    #[error("the input is fixed at {}×{} pixels, not {}×{}", fixed[0], fixed[1], named[0], named[1])]
    OtherSize { fixed: [u32; 2], named: [u32; 2] },
    #[error("the input is {}×{} pixels, and sides from {} to {} can be used", size_px[0], size_px[1], SIDES_PX.start(), SIDES_PX.end())]
    Size { size_px: [u32; 2] },
    #[error("an image of {}×{} pixels could not be run ({reason})", size_px[0], size_px[1])]
    Trial { size_px: [u32; 2], reason: String },
    #[error("{path} cannot be followed ({reason}): mend it, or move it away to get the family's usual way", path = path.display())]
    Preprocessor { path: PathBuf, reason: String },
    #[error("the file says that its task is {task:?}, and only detectors can be scored")]
    OtherTask { task: String },
    #[error("it answers a plain grey image or noise with {what}: no box of it could be trusted")]
    NotANumber { what: String },
    #[error(
        "its outputs {outputs} are of no known family: for an input of {}×{}, {needs}; see the table in \
         docs/guide/reference/detector-manifest.md", size_px[0], size_px[1]
    )]
    Unknown {
        outputs: String,
        size_px: [u32; 2],
        /// What each family would have, which these outputs are not.
        needs: String,
    },
    #[error("its outputs {outputs} have the shapes of {reasons}")]
    WrongNumbers {
        outputs: String,
        /// Each family, and why its numbers are others.
        reasons: String,
    },
    #[error("its outputs {outputs} are not those of {named}: {instead}")]
    NotThisFamily {
        outputs: String,
        named: &'static str,
        instead: String,
    },
    #[error(
        "its outputs {outputs} are grids before their decoding, of YOLOv3 or of a later YOLO, which decodes them otherwise: name the family \
         if it is yolov3, or export the network with its decoding"
    )]
    NotDecoded { outputs: String },
    #[error("its outputs {outputs} could be of {families}, which are fed differently")]
    Ambiguous { outputs: String, families: String },
    #[error("{what}")]
    NoLabels { what: String },
    #[error(
        "its outputs {outputs} could be of {families}, with room for {room} labels, and {given} are named: the labels are another network's"
    )]
    LabelCount {
        outputs: String,
        families: String,
        room: String,
        given: usize,
    },
    #[error("the network's outputs cannot be read as {title}: {reason}")]
    Misread { title: &'static str, reason: String },
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
        return Err(ProposeError::OtherTask { task: task.clone() });
    }
    if let Some(what) = network.answers.iter().find_map(|a| heads::with_no_number(a)) {
        return Err(ProposeError::NotANumber { what });
    }
    let known = match (hints.labels, &network.metadata.names) {
        (Some(labels), _) => Some(labels),
        (None, Some(names)) => Some(Labels::of_names(names.clone()).map_err(|e| ProposeError::NoLabels {
            what: format!("the names that the file gives cannot be used, as {e}"),
        })?),
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
            HeadError::NotFinite { what } => ProposeError::NotANumber { what },
            e => ProposeError::Misread {
                title: family.title(),
                reason: e.to_string(),
            },
        })?;
    }
    Ok(Proposal {
        family,
        notes: notes(&network, &candidate, &manifest, guessed, &said),
        manifest,
        text,
    })
}

/// What its preprocessor says, and else the family's usual way, for what this network takes; and which settings the preprocessor says.
fn input(
    network: &Inspected,
    family: Family,
    preprocessor: Option<&Preprocessor>,
    named_px: Option<[u32; 2]>,
) -> Result<(Input, Vec<&'static str>), ManifestError> {
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
) -> Result<Head, ProposeError> {
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
fn chosen(network: &Inspected, named: Option<Family>, labels: Option<Labels>) -> Result<FamilyCandidate, ProposeError> {
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
            return Err(ProposeError::NotThisFamily {
                outputs,
                named: named.title(),
                instead,
            });
        }
        fitting.retain(|c| c.family == named);
    }
    if fitting.is_empty() {
        return Err(ProposeError::Unknown {
            outputs,
            size_px: network.size_px,
            needs: recognise::needs(network.size_px),
        });
    }
    if named.is_none() && fitting.iter().any(|c| c.family == Family::Yolov3) {
        return Err(ProposeError::NotDecoded { outputs });
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
            return Err(ProposeError::LabelCount {
                outputs,
                families,
                room,
                given,
            });
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
        0 => Err(ProposeError::WrongNumbers {
            outputs,
            reasons: refuted.join("; of "),
        }),
        _ => Err(ProposeError::Ambiguous {
            outputs,
            families: titles(&fitting),
        }),
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
fn labels(candidate: &FamilyCandidate, known: Option<Labels>) -> Result<(Labels, Option<&'static str>), ProposeError> {
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
    Err(ProposeError::NoLabels { what })
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
) -> Vec<ProposalNote> {
    let family = candidate.family;
    let mut notes = vec![ProposalNote::Recognised {
        title: family.title(),
        inputs: network.inputs.clone(),
        outputs: shapes(&network.answers[0]),
    }];
    notes.extend(guessed.map(|list| ProposalNote::LabelsByCount {
        list: list.to_owned(),
        count: candidate.labels.unwrap_or(manifest.labels.count()),
    }));
    if network.takes.size_px.is_none() && !family.takes_any_size() && !said.contains(&"input.size_px") {
        let [width, height] = manifest.input.size_px;
        notes.push(ProposalNote::OpenSize { width, height });
    }
    if network.takes.values == Values::U8 && family != Family::TfOd {
        notes.push(ProposalNote::Bytes);
    }
    if network.takes.values == Values::F32
        && let Some(own) = network.file.prepares
    {
        let highest = if own.std() == 1.0 { 255 } else { 1 };
        notes.push(ProposalNote::OwnRange { highest });
    }
    let settings = said.join(", ");
    notes.extend((!said.is_empty()).then_some(ProposalNote::Preprocessor { settings }));
    let settings = usual_settings(manifest, said);
    notes.extend((!settings.is_empty()).then_some(ProposalNote::UsualInput { settings }));
    notes
}

/// What of a manifest no file says, as far as this one has it.
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
