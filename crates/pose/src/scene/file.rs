//! File format `scene.toml`, with its checks.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use nalgebra::{Point3, Vector3};
use serde::Deserialize;

use super::limits::{MOST_BINS, MOST_TAGS};
use super::{Bins, Classes, Envelope, MeshFacts, Paint, ScaleModel, Scene, Tag, TagFamily, TagSigma};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::SignedAxis;
use scaleproof_core::geometry::length::{self, FARTHEST_MM, LONGEST_MM, SCALES, shown};
use scaleproof_core::message::{Message, bail, message};

/// Scene file as parsed, before its values are checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    model: ModelTable,
    bins: Bins,
    #[serde(default)]
    cards: CardsTable,
    #[serde(default, rename = "tag")]
    tags: Vec<TagTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelTable {
    name: String,
    scale: f64,
    class: Classes,
    size_mm: [f64; 3],
    #[serde(default)]
    envelope: EnvelopeWord,
    mesh: Option<PathBuf>,
    mesh_front: Option<String>,
    mesh_up: Option<String>,
    #[serde(default)]
    paint: PaintValue,
}

/// Materials by name, or a file that lists triangles.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "paint is a list of material names, as in [\"Paint\"], or the file that lists the painted triangles, as in \"faces.txt\""
)]
enum PaintValue {
    Materials(Vec<String>),
    Faces(PathBuf),
}

impl Default for PaintValue {
    fn default() -> Self {
        Self::Materials(Vec::new())
    }
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum EnvelopeWord {
    #[default]
    Box,
    Hull,
    Mesh,
}

/// Difference of all printed cards from the tags of the file.
#[derive(Deserialize, Default, Clone, Copy)]
#[serde(deny_unknown_fields, default)]
struct CardsTable {
    /// Clockwise rotation of the cards, as one looks at them, degrees.
    turned_deg: u32,
    ids_higher_by: i64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TagTable {
    id: u32,
    #[serde(default)]
    family: TagFamily,
    size_mm: f64,
    centre_mm: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    sigma_mm: Option<f64>,
    sigma_deg: Option<f64>,
}

impl Scene {
    /// Reads and checks a `scene.toml`.
    pub fn open(path: &Path) -> Result<Scene, FileError> {
        Scene::parse(&files::read_text(path)?, path)
    }

    /// Parses and checks the text of a `scene.toml`; `path` is only named in errors.
    pub fn parse(text: &str, path: &Path) -> Result<Scene, FileError> {
        let file: SceneFile = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            let is_toml = path.extension().is_none_or(|ending| ending == "toml");
            let hint = if is_toml {
                ""
            } else {
                " (a scene is a .toml file, as `scaleproof scene new` writes)"
            };
            FileError::syntax(path, line, e.message().replace('\n', " ") + hint)
        })?;
        checked(file).map_err(|fault| FileError::content(path, fault))
    }
}

/// Checks the values beyond the grammar: sizes, directions, duplicates.
fn checked(file: SceneFile) -> Result<Scene, Message> {
    let envelope = checked_envelope(file.model.envelope, file.model.mesh)?;
    let mesh = MeshFacts {
        axes: checked_axes([file.model.mesh_front, file.model.mesh_up])?,
        paint: match file.model.paint {
            PaintValue::Faces(path) => Paint::Faces(path),
            PaintValue::Materials(names) if names.is_empty() => Paint::All,
            PaintValue::Materials(names) => Paint::Materials(names),
        },
    };
    if envelope == Envelope::Box && mesh != MeshFacts::default() {
        bail!(
            "model.mesh_front, model.mesh_up and model.paint are about a mesh: write envelope = \"mesh\" and mesh = \"car.obj\", or leave them out"
        );
    }
    let scale = checked_scale(file.model.scale)?;
    for size in file.model.size_mm {
        length::size_mm("a side of model.size_mm", size)?;
    }
    check_tag_count(file.tags.len() as u64)?;
    let tags = file
        .tags
        .into_iter()
        .map(|tag| as_printed(checked_tag(tag)?, file.cards));
    let tags = tags.collect::<Result<Vec<_>, _>>()?;
    for (i, tag) in tags.iter().enumerate() {
        if tags[..i].iter().any(|t| (t.family, t.id) == (tag.family, tag.id)) {
            bail!("tag id {} appears twice: give every [[tag]] its own id", tag.id);
        }
    }
    Ok(Scene {
        model: ScaleModel {
            name: file.model.name,
            scale,
            class: file.model.class,
            size_mm: file.model.size_mm,
            envelope,
            mesh,
        },
        bins: checked_bins(file.bins)?,
        tags,
    })
}

fn no_mesh(envelope: &str) -> Message {
    message!("model.envelope is {envelope}: name the model's mesh, e.g. mesh = \"model.stl\"")
}

fn one_axis() -> Message {
    message!(
        "model.mesh_front and model.mesh_up go together and lie along different axes, as in mesh_front = \"+x\" and mesh_up = \"+y\": give both or neither"
    )
}

/// Checks the scale of a file's or a preset's model.
pub(super) fn checked_scale(scale: f64) -> Result<f64, Message> {
    // False for NaN too.
    SCALES.contains(&scale).then_some(scale).ok_or_else(|| {
        message!(
            "model.scale is {}: give 10 for a 1:10 model, from {} to {}",
            shown(scale),
            SCALES.start(),
            SCALES.end()
        )
    })
}

/// Returns an error for too many tags.
pub(super) fn check_tag_count(count: u64) -> Result<(), Message> {
    (count <= MOST_TAGS)
        .then_some(())
        .ok_or_else(|| message!("{count} tags are too many: a scene has at most {MOST_TAGS}"))
}

fn checked_envelope(word: EnvelopeWord, mesh: Option<PathBuf>) -> Result<Envelope, Message> {
    match (word, mesh) {
        (_, Some(mesh)) if mesh.as_os_str().is_empty() => {
            Err(message!("model.mesh is empty: name a file, or leave it out"))
        }
        (EnvelopeWord::Box, None) => Ok(Envelope::Box),
        (EnvelopeWord::Box, Some(_)) => Err(message!(
            "model.mesh is named but the envelope is the box: write envelope = \"mesh\" or \"hull\""
        )),
        (EnvelopeWord::Hull, mesh) => mesh.map(Envelope::Hull).ok_or_else(|| no_mesh("hull")),
        (EnvelopeWord::Mesh, mesh) => mesh.map(Envelope::Mesh).ok_or_else(|| no_mesh("mesh")),
    }
}

/// Parses the directions of a mesh file's front and top.
fn checked_axes(words: [Option<String>; 2]) -> Result<Option<[SignedAxis; 2]>, Message> {
    let [front, up] = match words {
        [None, None] => return Ok(None),
        [Some(front), Some(up)] => [front.parse::<SignedAxis>()?, up.parse::<SignedAxis>()?],
        _ => return Err(one_axis()),
    };
    let differ = front.index() != up.index();
    differ.then_some(Some([front, up])).ok_or_else(one_axis)
}

/// Checks the bins of a file or a preset, and sorts their centres.
pub(super) fn checked_bins(mut bins: Bins) -> Result<Bins, Message> {
    let count = 360.0 / bins.azimuth_deg;
    // False for NaN, and for a step of 0.
    if !(1.0..=360.0).contains(&count) || (count - count.round()).abs() > 1e-9 {
        bail!(
            "bins.azimuth_deg = {} does not divide 360° into 1 to 360 bins: use 45, 30, …",
            shown(bins.azimuth_deg)
        );
    }
    check_centres(&mut bins.pitch_deg, -90.0..=90.0, "bins.pitch_deg")?;
    check_centres(&mut bins.distance_mm, 1.0..=FARTHEST_MM, "bins.distance_mm")?;
    let all = count.round() as usize * bins.pitch_deg.len() * bins.distance_mm.len();
    if all > MOST_BINS {
        bail!("bins make {all} bins, more than {MOST_BINS}: give fewer centres or a larger azimuth_deg");
    }
    Ok(bins)
}

/// Returns an error for impossible centres, and sorts the others.
fn check_centres(centres: &mut Vec<f64>, range: RangeInclusive<f64>, what: &'static str) -> Result<(), Message> {
    let (least, most) = range.clone().into_inner();
    if centres.is_empty() {
        let example = least.max(15.0);
        bail!("{what} is empty: give at least one centre, e.g. [{example}]");
    }
    if let Some(value) = centres.iter().copied().find(|c| !range.contains(c)) {
        bail!("{what} has {}: give numbers from {least} to {most}", shown(value));
    }
    centres.sort_by(f64::total_cmp);
    centres.dedup();
    Ok(())
}

fn checked_tag(t: TagTable) -> Result<Tag, Message> {
    let id = t.id;
    let last = t.family.count() - 1;
    if id > last {
        bail!("tag id {id} does not exist in its family: ids end at {last}");
    }
    for v in t.centre_mm {
        length::place_mm(&format!("centre_mm of tag {id}"), v)?;
    }
    let (right, up) = (unit_vector(t.right, "right", id)?, unit_vector(t.up, "up", id)?);
    if right.dot(&up).abs() > 1e-3 {
        bail!("right and up of tag {id} are not at a right angle: check the two vectors");
    }
    // The file's values are rounded; orthogonalise the pair so that the tag's pose is a true rotation.
    let up = (up - right * right.dot(&up)).normalize();
    Ok(Tag {
        id,
        family: t.family,
        size_mm: length::size_mm(&format!("size_mm of tag {id}"), t.size_mm)?,
        centre_mm: Point3::from(t.centre_mm),
        right,
        up,
        sigma: match (t.sigma_mm, t.sigma_deg) {
            (None, None) => None,
            (Some(mm), Some(deg)) if (0.0..=LONGEST_MM).contains(&mm) && (0.0..=360.0).contains(&deg) => {
                Some(TagSigma { mm, deg })
            }
            _ => bail!(
                "sigma_mm and sigma_deg of tag {id} go together and are 0 or more, up to {LONGEST_MM} mm and 360°: give both or neither"
            ),
        },
    })
}

fn as_printed(tag: Tag, cards: CardsTable) -> Result<Tag, Message> {
    let (right, up) = match cards.turned_deg {
        0 => (tag.right, tag.up),
        90 => (-tag.up, tag.right),
        180 => (-tag.right, -tag.up),
        270 => (tag.up, -tag.right),
        other => bail!("cards.turned_deg is {other}: give 0, 90, 180 or 270"),
    };
    let higher = i64::from(tag.id).checked_add(cards.ids_higher_by);
    let id = higher
        .and_then(|id| u32::try_from(id).ok())
        .filter(|id| *id < tag.family.count());
    let id = id.ok_or_else(|| {
        message!(
            "cards.ids_higher_by is {by}, and tag {id} has no such id in its family: ids go from 0 to {last}",
            id = tag.id,
            by = cards.ids_higher_by,
            last = tag.family.count() - 1
        )
    })?;
    Ok(Tag { id, right, up, ..tag })
}

/// Normalises a direction of a tag, whose length must be 1 to within 0.001.
fn unit_vector(v: [f64; 3], what: &'static str, id: u32) -> Result<Vector3<f64>, Message> {
    let v = Vector3::from(v);
    let length = v.norm();
    if (length - 1.0).abs() < 1e-3 {
        Ok(v.normalize())
    } else {
        Err(message!(
            "{what} of tag {id} has length {length:.4}: give a unit vector"
        ))
    }
}
