//! What the materials of a glTF look like: their base colours, and which texture coordinates these are laid on with.

use std::path::Path;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::material::AlphaMode;
use gltf::texture::WrappingMode;
use gltf::{Document, Material};
use percent_encoding::percent_decode_str;

use super::image::{ImageSource, Look, Wrap};

/// Of each material.
pub(super) fn looks(document: &Document, blob: &[u8], folder: &Path) -> Vec<Look> {
    let images = sources(document, blob, folder);
    document.materials().map(|material| look(&material, &images)).collect()
}

/// The base colour: an image times a factor, or the factor alone (glTF 2.0, section 3.9.2).
fn look(material: &Material, images: &[ImageSource]) -> Look {
    let base = material.pbr_metallic_roughness();
    let texture = base.base_color_texture().map(|info| info.texture());
    let [r, g, b, alpha] = base.base_color_factor().map(f64::from);
    let alpha = (material.alpha_mode() != AlphaMode::Opaque).then_some(alpha);
    let image = texture.as_ref().map(|texture| {
        let source = images.get(texture.source().index()).cloned();
        source.unwrap_or_else(|| refused("is not in the file"))
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

/// Of each image. The gltf crate's own reader trusts that embedded ones name their type.
fn sources(document: &Document, blob: &[u8], folder: &Path) -> Vec<ImageSource> {
    let images = &document.as_json().images;
    let blob: Arc<[u8]> = if images.is_empty() { [].into() } else { blob.into() };
    let inside = |view: usize| {
        let view = document.views().nth(view)?;
        let range = view.offset()..view.offset().checked_add(view.length())?;
        blob.get(range.clone())?;
        Some(ImageSource::Inside(Arc::clone(&blob), range))
    };
    let source = |image: &gltf::json::Image| match (&image.buffer_view, &image.uri) {
        (Some(view), _) => inside(view.value()).unwrap_or_else(|| refused("ends too early")),
        (None, Some(uri)) if uri.starts_with("data:") => {
            let bytes = uri.split_once(";base64,").map(|(_, text)| STANDARD.decode(text));
            match bytes {
                Some(Ok(bytes)) => ImageSource::Inside(bytes.as_slice().into(), 0..bytes.len()),
                _ => refused("is a data URI that is no base64"),
            }
        }
        (None, Some(uri)) => ImageSource::beside(folder, &percent_decode_str(uri).decode_utf8_lossy()),
        (None, None) => refused("is named nowhere"),
    };
    images.iter().map(source).collect()
}

/// Which set of coordinates a material takes, and where they lie in its image (`KHR_texture_transform`).
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

    /// From v down, as stored, to v up. Scaled, turned counter-clockwise as an image with v down is seen, then moved. The extension's listing
    /// turns the other way; its text, its sample model and the engines turn this way (glTF issue 1563).
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Some(Affine { offset, sin_cos, scale }) = &self.transform else {
            return [u, 1.0 - v];
        };
        let (sin, cos) = sin_cos;
        let [u, v] = [scale[0] * u, scale[1] * v];
        [cos * u + sin * v + offset[0], 1.0 - (cos * v - sin * u + offset[1])]
    }
}
