//! Writing of Wavefront OBJ with its material library, in the frame and unit of the mesh's own file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::model::{Distinct, TexturedModel, ending};
use scaleproof_surface::mesh::{Mesh, Wrap};
use scaleproof_surface::pattern::light;

/// Returns the .obj, the .mtl and the images of other materials, named after the baked image `png` and placed beside it.
pub fn write(mesh: &Mesh, model: &TexturedModel, png: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let stem = png.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = |(i, image): (usize, &std::sync::Arc<[u8]>)| match i {
        0 => png.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => format!("{stem}_{i}.{}", ending(image)),
    };
    let images: Vec<String> = model.images.iter().enumerate().map(name).collect();
    let mut files = vec![
        (png.with_extension("obj"), faces(mesh, model, &stem).into_bytes()),
        (png.with_extension("mtl"), library(model, &images).into_bytes()),
    ];
    let others = images.iter().zip(&model.images).skip(1);
    files.extend(others.map(|(name, bytes)| (png.with_file_name(name), bytes.to_vec())));
    files
}

fn faces(mesh: &Mesh, model: &TexturedModel, stem: &str) -> String {
    let (mut places, mut coordinates) = (Distinct::default(), Distinct::default());
    let (mut lines, mut skin) = (String::new(), None);
    for face in &model.faces {
        if skin.replace(face.skin) != Some(face.skin) {
            let _ = writeln!(lines, "usemtl {}", model.skins[face.skin].name);
        }
        lines.push('f');
        for (i, place) in face.places_mm.iter().enumerate() {
            let place = places.index_of(mesh.in_file(place).coords.into()) + 1;
            let _ = match face.coordinates {
                Some(uv) => write!(lines, " {place}/{}", coordinates.index_of(uv[i]) + 1),
                None => write!(lines, " {place}"),
            };
        }
        lines.push('\n');
    }
    let mut text = format!("mtllib {stem}.mtl\n");
    for [x, y, z] in places.values {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for [u, v] in coordinates.values {
        let _ = writeln!(text, "vt {u} {v}");
    }
    text + &lines
}

fn library(model: &TexturedModel, images: &[String]) -> String {
    let mut text = String::new();
    for skin in &model.skins {
        // The format's colours are sRGB-encoded.
        let [r, g, b] = skin.factor.map(light::encode);
        let _ = writeln!(text, "newmtl {}\nKd {r:.4} {g:.4} {b:.4}", skin.name);
        if let Some((image, wrap)) = skin.image {
            let is_clamped = image != 0 && wrap == [Wrap::ClampToEdge; 2];
            let options = if is_clamped { "-clamp on " } else { "" };
            let _ = writeln!(text, "map_Kd {options}{}", images[image]);
        }
    }
    text
}
