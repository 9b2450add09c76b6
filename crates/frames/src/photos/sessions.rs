//! Photos of sessions, located by their tags, in the flat colours of their variants.

use std::collections::BTreeSet;
use std::error::Error;

use super::located::{FlatPhoto, LeftOutPhoto, TagPaper};
use crate::FramesError;
use scaleproof_core::message::{bail, ensure, message};
use scaleproof_core::workers;
use scaleproof_photo::Photo;
use scaleproof_pose::locate::{Warning, locate_photo};
use scaleproof_pose::tags::{TagDetector, TagDetectorChoice, paper_levels};
use scaleproof_session::{PhotoEntry, Session, envelope};
use scaleproof_surface::mesh::Mesh;

/// Variant of a session with the flat colour that it is painted in.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatVariant {
    pub variant: String,
    pub rgb: [u8; 3],
}

/// Photos with a pose, those without one, and cautions about the poses.
#[derive(Debug, Default)]
pub struct LocatedPhotos {
    pub photos: Vec<FlatPhoto>,
    pub left_out: Vec<LeftOutPhoto>,
    pub notes: BTreeSet<String>,
}

/// Loads the mesh that all scenes name.
pub fn common_mesh(sessions: &[Session]) -> Result<Mesh, FramesError> {
    let mut common: Option<(&Session, Mesh)> = None;
    for session in sessions {
        let name = &session.name;
        let no_mesh = || {
            message!(
                "the scene of {name} names no mesh, through which photos are mapped onto each other: give its [model] envelope = \"mesh\" and mesh = \
                 \"FILE\""
            )
        };
        let path = session.mesh_path.as_ref().ok_or_else(no_mesh)?;
        session.known_camera()?;
        ensure!(
            !session.scene.tags.is_empty(),
            "the scene of {name} has no tags, and a viewpoint alone is no pose: photos are located by their tags"
        );
        let mesh = envelope::load(path, &session.scene.model)?;
        let (first, known) = common.get_or_insert_with(|| (session, mesh.clone()));
        let is_same = *known == mesh && first.scene.model.size_mm == session.scene.model.size_mm;
        ensure!(
            is_same,
            "{} and {name} have different models: make frames of each by itself",
            first.name
        );
    }
    Ok(common.map(|(_, mesh)| mesh).ok_or_else(|| message!("give a session"))?)
}

/// Lists the variants of all photos.
pub fn variants(sessions: &[Session]) -> BTreeSet<&str> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    photos.map(|p| p.variant.as_str()).collect()
}

/// Checks that every variant has photos.
pub fn check_variants(flats: &[FlatVariant], sessions: &[Session]) -> Result<(), FramesError> {
    let known = variants(sessions);
    let unknown = flats.iter().find(|flat| !known.contains(flat.variant.as_str()));
    unknown.map_or(Ok(()), |flat| {
        let (variant, known) = (&flat.variant, Vec::from_iter(known).join(", "));
        bail!("no photo has the variant '{variant}'; the variants are {known}")
    })
}

/// Photo of a session and the flat colour of its variant.
pub type ColouredEntry<'a> = (&'a Session, &'a PhotoEntry, [u8; 3]);

/// Lists the photos in one of the colours.
pub fn of_flats<'a>(sessions: &'a [Session], flats: &[FlatVariant]) -> Vec<ColouredEntry<'a>> {
    let of_session = |session: &'a Session| {
        session.photos.iter().filter_map(move |entry| {
            let flat = flats.iter().find(|flat| flat.variant == entry.variant)?;
            Some((session, entry, flat.rgb))
        })
    };
    sessions.iter().flat_map(of_session).collect()
}

/// Locates every photo in one of the colours. `on_photo` is called after each, from any thread.
pub fn locate_flats(
    sessions: &[Session],
    flats: &[FlatVariant],
    on_photo: impl Fn() + Sync,
) -> Result<LocatedPhotos, FramesError> {
    let entries = of_flats(sessions, flats);
    let families: BTreeSet<_> = sessions.iter().flat_map(|s| s.scene.families()).collect();
    let families: Vec<_> = families.into_iter().collect();
    let start = || TagDetectorChoice::default().open(&families);
    let answers = workers::map(&entries, start, |tags, entry| Ok(flat_photo(entry, tags)), on_photo)?;
    let mut located = LocatedPhotos::default();
    for ((_, entry, _), answer) in entries.iter().zip(answers) {
        match answer {
            Ok((photo, notes)) => {
                located.photos.push(photo);
                located.notes.extend(notes);
            }
            Err(reason) => located.left_out.push(LeftOutPhoto::new(entry.file.clone(), reason)),
        }
    }
    Ok(located)
}

/// Locates a photo: returns it with its pose and cautions, or why it is left out.
fn flat_photo(
    (session, entry, rgb): &ColouredEntry,
    tags: &mut dyn TagDetector,
) -> Result<(FlatPhoto, Vec<String>), Box<dyn Error + Send + Sync>> {
    let file = session.photo_path(entry);
    let photo = Photo::open(&file)?;
    let camera = session.known_camera()?;
    let found = locate_photo(&photo, &session.scene, camera, tags)?;
    let seen = found.seen.clone();
    let (located, fitted) = found.pose_and_camera()?;
    if located.warnings.contains(&Warning::PoorFit) {
        bail!(
            "its tags fit badly (off by {:.1} px), so that the paint would not lie where it is: was a card moved, or is this another camera?",
            located.rms_px
        );
    }
    let image = photo.rgb(1)?;
    let trusted = |id: u32| located.tags.contains(&id);
    let papers = seen.iter().zip(paper_levels(&image, &seen)).filter_map(|(tag, level)| {
        (tag.is_whole && trusted(tag.id)).then_some(TagPaper {
            family: tag.family,
            id: tag.id,
            level: level?,
        })
    });
    let notes = fitted.cautions();
    let flat = FlatPhoto {
        flat_rgb: *rgb,
        // Photos of another session may be of the same place only where both name it.
        place: entry.place.clone().unwrap_or_else(|| session.name.clone()),
        bin: located.bin,
        pose: located.pose,
        papers: papers.collect(),
        camera: fitted.camera,
        file,
    };
    Ok((flat, notes))
}
