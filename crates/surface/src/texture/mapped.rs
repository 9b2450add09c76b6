//! Images on the texture coordinates of a mesh.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::sync::Arc;

use image::RgbImage;

use super::{SurfacePoint, TextureError};
use crate::mesh::{ImageSource, Look, Mesh, TextureCoordinates, Wrap};
use crate::pattern::light;
use crate::pattern::picture::Picture;
use scaleproof_core::files;
use scaleproof_core::geometry::doubled_area;
use scaleproof_core::spelling::count;
use scaleproof_photo::Budget;

/// Largest texture coordinate: more is damage. An image is repeated some hundred times at most.
const MAX_COORDINATE: f64 = 1e6;
/// Share by which a point is drawn to the middle of its triangle, so that rounding at a border of a texel does not take the texel beside it.
const INWARD: f64 = 1e-9;
/// Size of all images of a mesh, as files and decoded, bytes. One of the largest that are decoded fits.
const MOST_BYTES: usize = 2 << 30;
/// Colour where a file gives no image, no coordinates and no colour.
const PAPER: [u8; 3] = [255; 3];

/// The image of each triangle and the triangle's place in it. The coordinates are kept here: the mesh that is painted may be another file.
#[derive(Debug, Clone)]
pub struct MappedImages {
    /// Skin of each triangle, with the places of its corners where it has an image.
    places: Arc<[(Skin, TextureCoordinates)]>,
    maps: Arc<[Map]>,
}

/// An image and its wrapping beyond its borders.
#[derive(Debug)]
struct Map {
    image: Arc<RgbImage>,
    wrap: [Wrap; 2],
}

/// An image and the places of triangles in it.
pub struct OnlyImage {
    pub image: Arc<RgbImage>,
    pub wrap: Wrap,
    pub coordinates: Vec<TextureCoordinates>,
}

/// A texture that was read, and notes on it.
pub struct Mapped {
    pub images: MappedImages,
    /// SHA-256 of each image, in the order of the materials.
    pub sha256: Vec<String>,
    /// Notes, a sentence each, without a full stop.
    pub notes: Vec<String>,
}

impl MappedImages {
    /// Reads one image instead of those that the mesh's file names; it wraps as they do. `paint`: the materials that are painted, all when empty.
    pub fn from_image(mesh: &Mesh, paint: &[usize], path: &Path) -> Result<Mapped, TextureError> {
        let picture = Picture::load(path)?;
        let map = |material| Map {
            image: Arc::clone(&picture.pixels),
            wrap: mesh.look(material).map_or([Wrap::Repeat; 2], |look| look.wrap),
        };
        let maps: Vec<_> = (0..mesh.materials().len()).map(map).collect();
        let by_material: Vec<_> = (0..maps.len()).map(Skin::Image).collect();
        Ok(Mapped {
            images: Self::new(mesh, paint, &by_material, maps)?,
            sha256: vec![picture.sha256],
            notes: picture
                .note
                .iter()
                .map(|note| format!("{} {note}", path.display()))
                .collect(),
        })
    }

    /// Reads the images that the mesh's own file names.
    pub fn from_mesh(mesh: &Mesh, paint: &[usize]) -> Result<Mapped, TextureError> {
        let mut collected = Collected::default();
        let mut skins = vec![Skin::None; mesh.materials().len()];
        let used = mesh.painted(paint).map(|triangle| mesh.triangles()[triangle].material);
        for material in used.collect::<BTreeSet<_>>() {
            skins[material] = collected.skin(&mesh.materials()[material], mesh.look(material))?;
        }
        if collected.maps.is_empty() {
            return Err(TextureError::NoImages);
        }
        Ok(Mapped {
            images: Self::new(mesh, paint, &skins, collected.maps)?,
            sha256: collected.sha256,
            notes: collected.notes,
        })
    }

    /// Gives each triangle its image and place; `skins`: of each material.
    fn new(mesh: &Mesh, paint: &[usize], skins: &[Skin], maps: Vec<Map>) -> Result<Self, TextureError> {
        let place = |i: usize| match skins[mesh.triangles()[i].material] {
            Skin::Image(map) => mesh.coordinates(i).map_or(NOWHERE, |at| (Skin::Image(map), at)),
            skin => (skin, NOWHERE.1),
        };
        let places: Vec<_> = (0..mesh.triangles().len()).map(place).collect();
        let (mut all, mut missing) = (0, 0);
        for triangle in mesh.painted(paint) {
            all += 1;
            match &places[triangle] {
                (Skin::None, _) => missing += 1,
                (Skin::Image(_), at) => check(at)?,
                (Skin::Plain(_), _) => {}
            }
        }
        if missing > 0 {
            return Err(TextureError::NoCoordinates { missing, all });
        }
        Ok(Self {
            places: places.into(),
            maps: maps.into(),
        })
    }

    pub(super) fn colour(&self, at: &SurfacePoint) -> [u8; 3] {
        match self.places.get(at.triangle) {
            Some((Skin::Plain(rgb), _)) => *rgb,
            Some((Skin::Image(map), corners)) => {
                let weights = at.within().map(|weight| weight + INWARD * (1.0 / 3.0 - weight));
                let [u, v] = [0, 1].map(|axis| (0..3).map(|i| weights[i] * corners[i][axis]).sum());
                self.maps.get(*map).map_or(PAPER, |map| map.texel([u, v]))
            }
            Some((Skin::None, _)) | None => PAPER,
        }
    }

    /// Returns the places of a triangle's corners in its image, in texels.
    pub(super) fn in_cells(&self, triangle: usize) -> [[f64; 2]; 3] {
        match self.in_image(triangle) {
            Some((map, corners)) => {
                corners.map(|[u, v]| [u * f64::from(map.image.width()), v * f64::from(map.image.height())])
            }
            None => [[0.0; 2]; 3],
        }
    }

    /// Returns the colour at a place in a triangle's image, in texels.
    pub(super) fn cell(&self, triangle: usize, [across, up]: [f64; 2]) -> [u8; 3] {
        match (self.in_image(triangle), self.places.get(triangle)) {
            (Some((map, _)), _) => map.texel([
                across / f64::from(map.image.width()),
                up / f64::from(map.image.height()),
            ]),
            (None, Some((Skin::Plain(rgb), _))) => *rgb,
            _ => PAPER,
        }
    }

    fn in_image(&self, triangle: usize) -> Option<(&Map, TextureCoordinates)> {
        match self.places.get(triangle)? {
            (Skin::Image(map), at) => Some((self.maps.get(*map)?, *at)),
            _ => None,
        }
    }

    /// Returns the one image of these triangles; `None` where they have several, or a plain colour.
    pub fn only_image(&self, triangles: &[usize]) -> Option<OnlyImage> {
        let mut only: Option<(Arc<RgbImage>, Wrap)> = None;
        let mut coordinates = Vec::with_capacity(triangles.len());
        for triangle in triangles {
            let (map, at) = self.in_image(*triangle)?;
            let (image, wrap) = only.get_or_insert_with(|| (Arc::clone(&map.image), map.wrap[0]));
            if !Arc::ptr_eq(image, &map.image) || map.wrap != [*wrap; 2] {
                return None;
            }
            coordinates.push(at);
        }
        only.map(|(image, wrap)| OnlyImage {
            image,
            wrap,
            coordinates,
        })
    }

    /// Returns the area of a triangle in its image, in texels; `None` without an image.
    pub(super) fn texels(&self, triangle: usize) -> Option<f64> {
        self.in_image(triangle)?;
        let [a, b, c] = self.in_cells(triangle);
        Some(0.5 * doubled_area(a, b, c).abs())
    }
}

impl Map {
    /// Returns the texel that a place lies in. Rows count from the top.
    fn texel(&self, [u, v]: [f64; 2]) -> [u8; 3] {
        let [across, up] = [self.wrap[0].within(u), self.wrap[1].within(v)];
        let (width, height) = self.image.dimensions();
        let index = |share: f64, count: u32| ((share * f64::from(count)) as u32).min(count.saturating_sub(1));
        let (column, row) = (index(across, width), index(1.0 - up, height));
        self.image.get_pixel_checked(column, row).map_or(PAPER, |texel| texel.0)
    }
}

/// Skin and place of a triangle without an image.
const NOWHERE: (Skin, TextureCoordinates) = (Skin::None, [[0.0; 2]; 3]);

#[derive(Debug, Clone, Copy)]
enum Skin {
    None,
    Plain([u8; 3]),
    Image(usize),
}

#[derive(Default)]
struct Collected {
    maps: Vec<Map>,
    decoded: HashMap<(String, String), Arc<RgbImage>>,
    /// Number of bytes of all that was read and decoded.
    held: usize,
    sha256: Vec<String>,
    notes: Vec<String>,
}

impl Collected {
    fn skin(&mut self, material: &str, look: Option<&Look>) -> Result<Skin, TextureError> {
        let unusable = |reason: String| TextureError::Material {
            material: material.to_owned(),
            reason,
        };
        let look = look.ok_or_else(|| unusable("the file names no image for it".into()))?;
        let Some(source) = &look.image else {
            return Ok(Skin::Plain(light::rgb_of(look.factor)));
        };
        let (name, key) = match source {
            ImageSource::Refused(reason) => return Err(unusable(reason.clone())),
            ImageSource::Inside(blob, range) => {
                let name = format!("the image of material '{material}'");
                (name, format!("{:p} {range:?}", Arc::as_ptr(blob)))
            }
            ImageSource::File(path) => (path.display().to_string(), path.display().to_string()),
        };
        let key = (key, format!("{:?} {:?}", look.factor, look.alpha));
        let image = match self.decoded.get(&key) {
            Some(image) => Arc::clone(image),
            None => {
                let image = self.decode(&name, source, look).map_err(unusable)?;
                self.decoded.insert(key, Arc::clone(&image));
                image
            }
        };
        self.maps.push(Map { image, wrap: look.wrap });
        Ok(Skin::Image(self.maps.len() - 1))
    }

    fn decode(&mut self, name: &str, source: &ImageSource, look: &Look) -> Result<Arc<RgbImage>, String> {
        let read;
        let bytes = match source {
            ImageSource::Inside(blob, range) => blob.get(range.clone()).unwrap_or_default(),
            ImageSource::File(path) => {
                read = files::read_at_most(path, Budget::FILE.bytes).map_err(|e| e.to_string())?;
                &read
            }
            ImageSource::Refused(reason) => return Err(reason.clone()),
        };
        let picture = Picture::from_bytes(bytes, look.alpha).map_err(|reason| format!("{name}: {reason}"))?;
        self.held += bytes.len() + picture.pixels.as_raw().len();
        if self.held > MOST_BYTES {
            return Err(format!("the mesh's images take more than {} MB", MOST_BYTES >> 20));
        }
        self.notes.extend(picture.note.map(|note| format!("{name} {note}")));
        self.sha256.push(picture.sha256);
        let mut pixels = picture.pixels;
        multiply(&mut pixels, look.factor);
        Ok(pixels)
    }
}

fn multiply(pixels: &mut Arc<RgbImage>, factor: [f64; 3]) {
    if factor == [1.0; 3] {
        return;
    }
    let tables = factor.map(|factor| {
        let level = |v: u8| light::rgb_of([factor * light::decode(f64::from(v) / 255.0); 3])[0];
        (0..=u8::MAX).map(level).collect::<Vec<u8>>()
    });
    for pixel in Arc::make_mut(pixels).pixels_mut() {
        (0..3).for_each(|c| pixel.0[c] = tables[c][usize::from(pixel.0[c])]);
    }
}

/// Refuses damaged coordinates.
fn check(corners: &TextureCoordinates) -> Result<(), TextureError> {
    let mut values = corners.as_flattened().iter().copied();
    let bad = values.find(|c| c.is_nan() || c.abs() > MAX_COORDINATE);
    bad.map_or(Ok(()), |value| Err(TextureError::BadCoordinate { value }))
}

impl TextureError {
    pub(super) fn coverage(missing: &usize, all: &usize) -> String {
        if missing == all {
            "the mesh has no texture coordinates".into()
        } else {
            let missing = count(*missing, "triangle");
            format!("{missing} of the paint's {all} have no texture coordinates")
        }
    }
}
