//! Wavefront OBJ: convex polygons with the materials that `usemtl` names. The material library beside it is not read.

use std::collections::HashMap;
use std::io::Cursor;

use nalgebra::Point3;
use tobj::{LoadOptions, Material};

use super::{Soup, Trouble, corner};

/// What faces before the first `usemtl` are of.
const NO_MATERIAL: &str = "none";

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let names = material_names(bytes);
    // tobj knows only materials of a library: it is handed one that has every name.
    let mut file = b"mtllib names\n".to_vec();
    // Normals and texture coordinates are not used, and tobj does not survive every index of them.
    // It parts words at all white space of Unicode, so words are parted the same way here.
    let unused = |line: &[u8]| {
        let line = String::from_utf8_lossy(line);
        line.split_whitespace()
            .next()
            .is_some_and(|word| ["vn", "vt"].contains(&word))
    };
    for line in bytes
        .split_inclusive(|byte| *byte == b'\n')
        .filter(|line| !unused(line))
    {
        file.extend_from_slice(line);
    }
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(file), &LoadOptions::default(), |_| Ok(library(&names)))
        .map_err(Trouble::damaged)?;
    for model in &models {
        let mesh = &model.mesh;
        let points: Vec<Point3<f64>> = mesh
            .positions
            .as_chunks::<3>()
            .0
            .iter()
            .map(|[x, y, z]| Point3::new(f64::from(*x), f64::from(*y), f64::from(*z)))
            .collect();
        // The file's own mtllib lines hand the same library over again, after the first.
        let name = mesh.material_id.and_then(|id| names.get(id % names.len().max(1)));
        let material = soup.material(name.map_or(NO_MATERIAL, String::as_str));
        let mut rest = &mesh.indices[..];
        // Without arities all faces are triangles.
        let arities = mesh.face_arities.iter().map(|n| *n as usize);
        let triangles = std::iter::repeat_n(
            3,
            if mesh.face_arities.is_empty() {
                rest.len() / 3
            } else {
                0
            },
        );
        for arity in arities.chain(triangles) {
            let (face, after) = rest
                .split_at_checked(arity)
                .ok_or_else(|| Trouble::damaged("a face is cut short"))?;
            rest = after;
            let corners: Result<Vec<_>, _> = face.iter().map(|i| corner(&points, *i as usize)).collect();
            soup.fan(&corners?, material)?;
        }
    }
    Ok(())
}

/// Every name after `usemtl`, each once, in the file's order.
fn material_names(bytes: &[u8]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut known = std::collections::HashSet::new();
    for line in String::from_utf8_lossy(bytes).lines() {
        if let Some((_, name)) = line
            .trim()
            .split_once(char::is_whitespace)
            .filter(|(word, _)| *word == "usemtl")
            && known.insert(name.trim().to_owned())
        {
            names.push(name.trim().to_owned());
        }
    }
    names
}

fn library(names: &[String]) -> (Vec<Material>, HashMap<String, usize>) {
    let material = |name: &String| Material {
        name: name.clone(),
        ..Material::default()
    };
    let index = names.iter().enumerate().map(|(i, name)| (name.clone(), i));
    (names.iter().map(material).collect(), index.collect())
}
