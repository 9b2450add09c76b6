//! Looks of the materials of a glTF: their base colours, and the texture coordinates of these.

use std::path::Path;

use gltf::material::AlphaMode;
use gltf::texture::WrappingMode;
use gltf::{Document, Material, Texture};

use super::gltf_data::{Buffers, UriContent, uri_content};
use super::image::{ImageSource, Look, Wrap};

/// The older description of materials, in which the image of a surface may stand alone.
const SPECULAR: &str = "KHR_materials_pbrSpecularGlossiness";

/// Returns the look of each material.
pub(super) fn looks(document: &Document, buffers: &Buffers, folder: &Path) -> Vec<Look> {
    let images = sources(document, buffers, folder);
    document.materials().map(|material| look(&material, &images)).collect()
}

/// Returns the base colour: an image times a factor, or the factor alone (glTF 2.0, section 3.9.2).
fn look(material: &Material, images: &[ImageSource]) -> Look {
    let base = material.pbr_metallic_roughness();
    let texture = base.base_color_texture().map(|info| info.texture());
    let [r, g, b, alpha] = base.base_color_factor().map(f64::from);
    let alpha = (material.alpha_mode() != AlphaMode::Opaque).then_some(alpha);
    let image = texture.as_ref().map(|texture| {
        let source = source(texture).and_then(|index| images.get(index)).cloned();
        source.unwrap_or_else(|| refused("is of a kind that this program does not read: export PNG, JPEG or WebP"))
    });
    let image = image.or_else(|| {
        let is_elsewhere = material.extension_value(SPECULAR).is_some();
        is_elsewhere.then(|| refused(&format!("stands in {SPECULAR}, which this program does not read")))
    });
    let sampler = texture.map(|texture| texture.sampler());
    Look {
        image: if alpha.is_some_and(|alpha| alpha <= 0.0) {
            let reason = "its factor has alpha 0, so it cannot be seen";
            Some(ImageSource::Refused(reason.into()))
        } else {
            image
        },
        wrap: sampler.map_or([Wrap::Repeat; 2], |s| [s.wrap_s(), s.wrap_t()].map(wrap)),
        factor: [r, g, b],
        alpha,
    }
}

/// Returns the index of a texture's image: a plain one, else a WebP.
fn source(texture: &Texture) -> Option<usize> {
    let webp = || texture.extension_value("EXT_texture_webp")?.get("source")?.as_u64();
    let plain = texture.source().map(|image| image.index());
    plain.or_else(|| usize::try_from(webp()?).ok())
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
    }
}

fn refused(reason: &str) -> ImageSource {
    ImageSource::Refused(format!("its image {reason}"))
}

/// Returns the source of each image. The gltf crate's own reader trusts that embedded ones name their type.
fn sources(document: &Document, buffers: &Buffers, folder: &Path) -> Vec<ImageSource> {
    let inside = |view: usize| {
        let view = document.views().nth(view).ok_or("its data are nowhere")?;
        let (bytes, range) = buffers.view(&view)?;
        Ok::<_, String>(ImageSource::Inside(bytes.clone(), range))
    };
    let source = |image: &gltf::json::Image| match (&image.buffer_view, &image.uri) {
        (Some(view), _) => inside(view.value()).unwrap_or_else(|why| refused(&format!("cannot be read: {why}"))),
        (None, Some(uri)) => match uri_content(uri, folder) {
            UriContent::Inside(bytes) => ImageSource::Inside(bytes.as_slice().into(), 0..bytes.len()),
            UriContent::Unread => refused("is a data URI that is no base64"),
            UriContent::Elsewhere(source) => source,
        },
        (None, None) => refused("is named nowhere"),
    };
    document.as_json().images.iter().map(source).collect()
}

/// Set of texture coordinates that a material takes, and their transform in its image (`KHR_texture_transform`).
#[derive(Default)]
pub(super) struct Placing {
    pub set: u32,
    transform: Option<Affine>,
}

struct Affine {
    offset: [f64; 2],
    sin_cos: (f64, f64),
    scale: [f64; 2],
}

impl Placing {
    pub(super) fn new(material: &Material) -> Self {
        let Some(info) = material.pbr_metallic_roughness().base_color_texture() else {
            return Self::default();
        };
        let transform = info.texture_transform();
        Self {
            set: transform
                .as_ref()
                .and_then(|t| t.tex_coord())
                .unwrap_or(info.tex_coord()),
            transform: transform.map(|transform| Affine {
                offset: transform.offset().map(f64::from),
                sin_cos: f64::from(transform.rotation()).sin_cos(),
                scale: transform.scale().map(f64::from),
            }),
        }
    }

    /// Transforms coordinates from v down, as stored, to v up. Scaled, turned counter-clockwise as an image with v down is seen, then moved. The
    /// extension's listing turns the other way; its text, its sample model and the engines turn this way (glTF issue 1563).
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Some(Affine { offset, sin_cos, scale }) = &self.transform else {
            return [u, 1.0 - v];
        };
        let (sin, cos) = sin_cos;
        let [u, v] = [scale[0] * u, scale[1] * v];
        [cos * u + sin * v + offset[0], 1.0 - (cos * v - sin * u + offset[1])]
    }
}
