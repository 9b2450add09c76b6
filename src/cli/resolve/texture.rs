//! Textures of `--pattern` and `--texture`, loaded for a model.

use std::path::Path;

use crate::cli::Result;
use crate::cli::args::texture::TextureArgs;
use scaleproof_core::files;
use scaleproof_surface::mesh::{FaceList, Mesh, MeshPlacement};
use scaleproof_surface::model::Model;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::{Card, card, says_sides};
use scaleproof_surface::texture::{FaceTexels, Mapped, MappedImages, SidePatterns, Texture, Tile, check_same_shape};

impl TextureArgs {
    /// The mesh that `--texture` names.
    pub fn mesh(&self) -> Option<&Path> {
        self.texture.as_deref().filter(|path| is_mesh(path))
    }

    pub fn file(&self) -> Option<&Path> {
        self.pattern.as_deref().or(self.texture.as_deref())
    }

    /// Returns true if the texture belongs to the triangles of the model as its file has them.
    pub fn is_of_triangles(&self, model: &Model) -> bool {
        let is_of_triangles = |path: &Path| extension(path) == "npy" || (is_mesh(path) && !model.is_of_file(path));
        self.texture.as_deref().is_some_and(is_of_triangles)
    }

    pub fn load(&self, model: &Model) -> Result<NamedTexture> {
        match (&self.pattern, &self.texture) {
            (Some(path), _) => {
                let pattern = Pattern::load(path)?;
                let tile_mm = crate::cli::print::tile_mm(self.tile_mm, path, &pattern)?;
                let sha256 = pattern.sha256().to_owned();
                Ok(named(path, Texture::Tile(Tile::new(pattern, tile_mm)), sha256))
            }
            (None, Some(path)) => load_texture(path, model),
            (None, None) => Err("give --pattern or --texture".into()),
        }
    }
}

/// A texture, as outputs name it.
pub struct NamedTexture {
    pub name: String,
    pub texture: Texture,
    /// Of what it was read from: of the file, or of its hash and those of its images.
    pub sha256: String,
}

/// A file of `--texture` on a model.
pub fn load_texture(path: &Path, model: &Model) -> Result<NamedTexture> {
    if extension(path) == "npy" {
        let (texels, sha256) = FaceTexels::load(path, &model.mesh)?;
        return Ok(named(path, Texture::Faces(texels), sha256));
    }
    if let Some(sides) = of_sides(path, model)? {
        return Ok(sides);
    }
    refuse_repeated(path)?;
    let (mapped, sha256) = if is_mesh(path) {
        let mapped = textured_mesh(path, model)?;
        let own = files::sha256_hex(&files::read(path)?);
        let all = own + &mapped.sha256.concat();
        (mapped, files::sha256_hex(all.as_bytes()))
    } else {
        let mapped = MappedImages::from_image(&model.mesh, &model.materials, path)?;
        let sha256 = mapped.sha256.concat();
        (mapped, sha256)
    };
    for note in &mapped.notes {
        say!("note: {note}");
    }
    Ok(named(path, Texture::Images(mapped.images), sha256))
}

/// A pattern for each side of the model, where the card beside it says so.
fn of_sides(path: &Path, model: &Model) -> Result<Option<NamedTexture>> {
    if extension(path) != "png" || !says_sides(path) {
        return Ok(None);
    }
    // From here on it is no image on texture coordinates, whatever is wrong with it.
    let pattern = Pattern::load(path)?;
    let card = card(path, &pattern)?;
    let Some(patterns) = SidePatterns::new(&pattern, card.tile_mm, &model.mesh)? else {
        let (path, rows) = (path.display(), pattern.rows());
        return Err(format!("{path} has {rows} rows, which are not those of six sides").into());
    };
    let (texture, sha256) = (Texture::Sides(patterns), pattern.sha256().to_owned());
    Ok(Some(named(path, texture, sha256)))
}

/// A pattern with a card is no image for texture coordinates, which would stretch it.
fn refuse_repeated(path: &Path) -> Result<(), String> {
    // A large image without a card is not decoded for this.
    if extension(path) != "png" || !Card::path(path).is_file() {
        return Ok(());
    }
    let pattern = Pattern::load(path).ok();
    let Some(card) = pattern.and_then(|pattern| card(path, &pattern).ok()) else {
        return Ok(());
    };
    let (path, mm) = (path.display(), card.tile_mm);
    Err(format!(
        "{path} is a pattern to be repeated every {mm} mm (so says its card): give it by --pattern"
    ))
}

/// The images of a mesh's own file, on its own triangles or on the same ones of the model.
fn textured_mesh(path: &Path, model: &Model) -> Result<Mapped> {
    if model.is_of_file(path) {
        return Ok(MappedImages::from_mesh(&model.mesh, &model.materials)?);
    }
    let textured = Mesh::load(path, &MeshPlacement::default())?;
    check_same_shape(&textured, &model.mesh)?;
    let (textured, paint) = if model.materials.is_empty() {
        (textured, Vec::new())
    } else {
        textured.with_paint(&FaceList::from_materials(&model.mesh, &model.materials))
    };
    Ok(MappedImages::from_mesh(&textured, &paint)?)
}

pub fn is_mesh(path: &Path) -> bool {
    ["obj", "glb", "ply"].contains(&extension(path).as_str())
}

pub fn extension(path: &Path) -> String {
    path.extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase()
}

pub fn named(path: &Path, texture: Texture, sha256: String) -> NamedTexture {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    NamedTexture { name, texture, sha256 }
}

#[cfg(test)]
#[path = "../tests/texture.rs"]
mod tests;
