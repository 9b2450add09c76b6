//! File format `scene.toml`, with its checks.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use nalgebra::{Point3, Vector3};
use serde::Deserialize;

use super::fault::{MOST_BINS, MOST_TAGS};
use super::{Bins, Classes, Envelope, MeshFacts, Paint, ScaleModel, Scene, SceneFault, Tag, TagFamily, TagSigma};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::SignedAxis;
use scaleproof_core::geometry::length::{self, FARTHEST_MM, LONGEST_MM, SCALES};

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
fn checked(file: SceneFile) -> Result<Scene, SceneFault> {
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
        return Err(SceneFault::FactsOfNoMesh);
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
            return Err(SceneFault::TagTwice(tag.id));
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

/// Checks the scale of a file's or a preset's model.
pub(super) fn checked_scale(scale: f64) -> Result<f64, SceneFault> {
    // False for NaN too.
    SCALES.contains(&scale).then_some(scale).ok_or(SceneFault::Scale(scale))
}

/// Returns an error for too many tags.
pub(super) fn check_tag_count(count: u64) -> Result<(), SceneFault> {
    (count <= MOST_TAGS).then_some(()).ok_or(SceneFault::TooManyTags(count))
}

fn checked_envelope(word: EnvelopeWord, mesh: Option<PathBuf>) -> Result<Envelope, SceneFault> {
    match (word, mesh) {
        (_, Some(mesh)) if mesh.as_os_str().is_empty() => Err(SceneFault::EmptyMesh),
        (EnvelopeWord::Box, None) => Ok(Envelope::Box),
        (EnvelopeWord::Box, Some(_)) => Err(SceneFault::MeshOfBox),
        (EnvelopeWord::Hull, mesh) => mesh.map(Envelope::Hull).ok_or(SceneFault::NoMesh("hull")),
        (EnvelopeWord::Mesh, mesh) => mesh.map(Envelope::Mesh).ok_or(SceneFault::NoMesh("mesh")),
    }
}

/// Parses the directions of a mesh file's front and top.
fn checked_axes(words: [Option<String>; 2]) -> Result<Option<[SignedAxis; 2]>, SceneFault> {
    let [front, up] = match words {
        [None, None] => return Ok(None),
        [Some(front), Some(up)] => [front.parse::<SignedAxis>()?, up.parse()?],
        _ => return Err(SceneFault::OneAxis),
    };
    let differ = front.index() != up.index();
    differ.then_some(Some([front, up])).ok_or(SceneFault::OneAxis)
}

/// Checks the bins of a file or a preset, and sorts their centres.
pub(super) fn checked_bins(mut bins: Bins) -> Result<Bins, SceneFault> {
    let count = 360.0 / bins.azimuth_deg;
    // False for NaN, and for a step of 0.
    if !(1.0..=360.0).contains(&count) || (count - count.round()).abs() > 1e-9 {
        return Err(SceneFault::AzimuthStep(bins.azimuth_deg));
    }
    check_centres(&mut bins.pitch_deg, -90.0..=90.0, "bins.pitch_deg")?;
    check_centres(&mut bins.distance_mm, 1.0..=FARTHEST_MM, "bins.distance_mm")?;
    let all = count.round() as usize * bins.pitch_deg.len() * bins.distance_mm.len();
    if all > MOST_BINS {
        return Err(SceneFault::TooManyBins(all));
    }
    Ok(bins)
}

/// Returns an error for impossible centres, and sorts the others.
fn check_centres(centres: &mut Vec<f64>, range: RangeInclusive<f64>, what: &'static str) -> Result<(), SceneFault> {
    let (least, most) = range.clone().into_inner();
    if centres.is_empty() {
        let example = least.max(15.0);
        return Err(SceneFault::NoCentre { what, example });
    }
    if let Some(value) = centres.iter().copied().find(|c| !range.contains(c)) {
        return Err(SceneFault::Centre {
            what,
            value,
            least,
            most,
        });
    }
    centres.sort_by(f64::total_cmp);
    centres.dedup();
    Ok(())
}

fn checked_tag(t: TagTable) -> Result<Tag, SceneFault> {
    let id = t.id;
    let last = t.family.count() - 1;
    if id > last {
        return Err(SceneFault::NoSuchTag { id, last });
    }
    for v in t.centre_mm {
        length::place_mm(&format!("centre_mm of tag {id}"), v)?;
    }
    let (right, up) = (unit_vector(t.right, "right", id)?, unit_vector(t.up, "up", id)?);
    if right.dot(&up).abs() > 1e-3 {
        return Err(SceneFault::NoRightAngle(id));
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
            _ => return Err(SceneFault::Sigma(id)),
        },
    })
}

fn as_printed(tag: Tag, cards: CardsTable) -> Result<Tag, SceneFault> {
    let (right, up) = match cards.turned_deg {
        0 => (tag.right, tag.up),
        90 => (-tag.up, tag.right),
        180 => (-tag.right, -tag.up),
        270 => (tag.up, -tag.right),
        other => return Err(SceneFault::CardsTurned(other)),
    };
    let higher = i64::from(tag.id).checked_add(cards.ids_higher_by);
    let id = higher
        .and_then(|id| u32::try_from(id).ok())
        .filter(|id| *id < tag.family.count());
    let id = id.ok_or(SceneFault::CardsIds {
        id: tag.id,
        by: cards.ids_higher_by,
        last: tag.family.count() - 1,
    })?;
    Ok(Tag { id, right, up, ..tag })
}

/// Normalises a direction of a tag, whose length must be 1 to within 0.001.
fn unit_vector(v: [f64; 3], what: &'static str, id: u32) -> Result<Vector3<f64>, SceneFault> {
    let v = Vector3::from(v);
    let length = v.norm();
    if (length - 1.0).abs() < 1e-3 {
        Ok(v.normalize())
    } else {
        Err(SceneFault::NotUnit { what, id, length })
    }
}
