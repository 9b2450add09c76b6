//! The file format `scene.toml`, and every reason to refuse one.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use nalgebra::{Point3, Vector3};
use serde::Deserialize;

use super::fault::{MOST_BINS, MOST_TAGS};
use super::{Bins, Classes, Envelope, ScaleModel, Scene, SceneFault, Tag, TagFamily, TagSigma};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::length::{self, FARTHEST_MM, LONGEST_MM, SCALES};

/// A scene file by its grammar alone.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    model: ModelTable,
    bins: Bins,
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
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum EnvelopeWord {
    #[default]
    Box,
    Hull,
    Mesh,
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
            FileError::syntax(path, line, e.message().replace('\n', " "))
        })?;
        checked(file).map_err(|fault| FileError::content(path, fault))
    }
}

/// Checks what the grammar cannot: sizes, directions, duplicates.
fn checked(file: SceneFile) -> Result<Scene, SceneFault> {
    let envelope = checked_envelope(file.model.envelope, file.model.mesh)?;
    let scale = checked_scale(file.model.scale)?;
    for size in file.model.size_mm {
        length::size_mm("a side of model.size_mm", size)?;
    }
    check_tag_count(file.tags.len() as u64)?;
    let tags = file.tags.into_iter().map(checked_tag).collect::<Result<Vec<_>, _>>()?;
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
        },
        bins: checked_bins(file.bins)?,
        tags,
    })
}

/// The scale of a file's or a preset's model.
pub(super) fn checked_scale(scale: f64) -> Result<f64, SceneFault> {
    // False for NaN too.
    SCALES.contains(&scale).then_some(scale).ok_or(SceneFault::Scale(scale))
}

/// Refuses more tags than anyone places.
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

/// The bins of a file or a preset, with their centres in order.
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

/// Refuses impossible centres, and puts the others in order.
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
    let (right, up) = (unit(t.right, "right", id)?, unit(t.up, "up", id)?);
    if right.dot(&up).abs() > 1e-3 {
        return Err(SceneFault::NoRightAngle(id));
    }
    // The file rounds; make the pair exactly orthogonal so that the tag's pose is a true rotation.
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

fn unit(v: [f64; 3], what: &'static str, id: u32) -> Result<Vector3<f64>, SceneFault> {
    let v = Vector3::from(v);
    let length = v.norm();
    if (length - 1.0).abs() < 1e-3 {
        Ok(v.normalize())
    } else {
        Err(SceneFault::NotUnit { what, id, length })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = r#"
[model]
name = "car"
scale = 10
class = "car"
size_mm = [455.0, 186.0, 128.0]
[bins]
azimuth_deg = 45
pitch_deg = [15]
distance_mm = [850]
[[tag]]
id = 0
size_mm = 50.0
centre_mm = [396.1, 0.0, 24.7]
right = [0.0, 1.0, 0.0]
up = [-0.5, 0.0, 0.866]
"#;

    fn refusal(text: &str) -> String {
        Scene::parse(text, Path::new("scene.toml")).unwrap_err().to_string()
    }

    #[test]
    fn the_design_example_reads() {
        let scene = Scene::parse(GOOD, Path::new("scene.toml")).unwrap();
        assert_eq!(scene.tags[0].family, TagFamily::Tag36h11);
        assert_eq!(scene.model.target_mm(), Point3::new(0.0, 0.0, 64.0));
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line() {
        let text = refusal(&GOOD.replace("scale = 10", "scale = 10\ncolour = \"red\""));
        assert!(text.starts_with("scene.toml, line 5: unknown field `colour`"), "{text}");
    }

    #[test]
    fn an_envelope_and_its_mesh_are_read() {
        let text = GOOD.replace("[bins]", "envelope = \"hull\"\nmesh = \"car.stl\"\n[bins]");
        let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
        assert_eq!(scene.model.envelope, Envelope::Hull("car.stl".into()));
    }

    #[test]
    fn a_duplicate_tag_id_is_refused() {
        let tag = &GOOD[GOOD.find("[[tag]]").unwrap()..];
        assert!(refusal(&format!("{GOOD}{tag}")).contains("tag id 0 appears twice"));
    }

    #[test]
    fn impossible_scenes_are_refused() {
        for (from, to, reason) in [
            ("scale = 10", "scale = 0", "model.scale is 0"),
            ("azimuth_deg = 45", "azimuth_deg = 50", "does not divide 360"),
            ("pitch_deg = [15]", "pitch_deg = []", "at least one centre"),
            ("class = \"car\"", "class = []", "line 5: the class is an empty list"),
            ("class = \"car\"", "class = \"\"", "\"\" is no label"),
            ("class = \"car\"", "class = [\"car\", \"car\"]", "lists `car` twice"),
            ("class = \"car\"", "class = 3", "or a list of labels"),
            (
                "up = [-0.5, 0.0, 0.866]",
                "up = [0.0, 0.5, 0.866]",
                "not at a right angle",
            ),
            ("right = [0.0, 1.0, 0.0]", "right = [0.0, 2.0, 0.0]", "unit vector"),
            ("id = 0", "id = 587", "does not exist in its family"),
            ("[bins]", "envelope = \"ball\"\n[bins]", "unknown variant `ball`"),
            ("[bins]", "envelope = \"hull\"\n[bins]", "name the model's mesh"),
            ("[bins]", "mesh = \"a.stl\"\n[bins]", "the envelope is the box"),
            (
                "[bins]",
                "envelope = \"mesh\"\nmesh = \"\"\n[bins]",
                "model.mesh is empty",
            ),
            ("size_mm = 50.0", "size_mm = nan", "size_mm of tag 0 cannot be NaN"),
            (
                "size_mm = 50.0",
                "size_mm = 1e200",
                "size_mm of tag 0 cannot be 1e200 mm",
            ),
            ("396.1, 0.0", "396.1, 1e6", "centre_mm of tag 0 cannot be 1000000 mm"),
            ("[455.0, 186.0", "[455.0, 1e-300", "model.size_mm cannot be 1e-300 mm"),
            ("scale = 10", "scale = 1e9", "model.scale is 1e9"),
            ("azimuth_deg = 45", "azimuth_deg = 1e-9", "1e-9 does not divide 360"),
            ("azimuth_deg = 45", "azimuth_deg = nan", "NaN does not divide 360"),
            ("pitch_deg = [15]", "pitch_deg = [nan]", "bins.pitch_deg has NaN"),
            (
                "distance_mm = [850]",
                "distance_mm = [1e200]",
                "bins.distance_mm has 1e200",
            ),
            ("id = 0", "id = 0\nsigma_mm = 0.1", "sigma_mm and sigma_deg of tag 0"),
            ("id = 0", "id = 0\nsigma_mm = -1\nsigma_deg = 1", "0 or more"),
        ] {
            let text = refusal(&GOOD.replace(from, to));
            assert!(text.contains(reason), "{to}: {text}");
            assert!(!text.contains('\n'), "one sentence: {text}");
        }
    }

    proptest! {
        /// Any text: a scene or a sentence, never a panic.
        #[test]
        fn parsing_never_panics(text in "\\PC*", cut in 0usize..400) {
            let _ = Scene::parse(&text, Path::new("s"));
            let _ = Scene::parse(GOOD.get(..cut.min(GOOD.len())).unwrap_or(GOOD), Path::new("s"));
        }
    }
}
