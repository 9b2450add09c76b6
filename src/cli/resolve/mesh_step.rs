//! Model of `scene new --mesh`, resolved from its arguments and the mesh.

use std::path::{Path, PathBuf};

use crate::cli::args::mesh_step::SceneMesh;
use crate::cli::resolve::model::painted;
use crate::cli::resolve::vehicle;
use crate::cli::taken::{Taken, Wanted};
use crate::cli::{Result, units};
use scaleproof_core::files;
use scaleproof_core::geometry::extent;
use scaleproof_core::spelling::quoted;
use scaleproof_frames::encode_rgb;
use scaleproof_frames::six_views::{seen_shares, six_views};
use scaleproof_plot::lettering::number;
use scaleproof_pose::scene::{Envelope, MeshFacts, Paint};
use scaleproof_surface::mesh::{AxesDoubt, AxesProposal, Mesh, MeshPlacement, is_gltf, propose_axes, propose_paint};
use scaleproof_surface::model::vehicle::is_clearly_usual;

impl SceneMesh {
    pub fn is_given(&self) -> bool {
        self.mesh.is_some()
    }

    /// Finds what is not given, or asks.
    pub fn take(&self, wanted: Wanted) -> Result<Taken> {
        let file = self.mesh.as_deref().unwrap_or(Path::new(""));
        if files::is_standard_output(wanted.output) {
            return Err("an image of the mesh is written beside the scene: give a file by --output".into());
        }
        let preview = preview_path(wanted.output);
        let raw = Mesh::load(file, &MeshPlacement::default())?;
        let axes = self.axes(file, &raw, &wanted)?;
        let along = raw.points().iter().map(|p| raw.in_file(p)[axes.front.index()]);
        let (low, high) = extent(along);
        units::note(self.contradicted(&raw, &axes, &wanted));
        let length_mm = match self.length_mm {
            Some(length) => length,
            None => usual_length(file, high - low, &wanted)?,
        };
        let placement = MeshPlacement {
            front: Some(axes.front),
            up: Some(axes.up),
            length_mm: Some(length_mm),
        };
        let mesh = Mesh::load(file, &placement)?;
        mesh.check_is_model()?;
        units::note(vehicle::on_its_side(Some(wanted.class), mesh.size_mm()));
        units::note(vehicle::meshed(wanted.class, length_mm, wanted.scale));
        let (paint, paint_because) = self.paint(&mesh, file)?;
        let (mesh, materials) = match &paint {
            Paint::All => (mesh, Vec::new()),
            Paint::Materials(names) => painted(mesh, names, None)?,
            Paint::Faces(path) => painted(mesh, &[], Some(path))?,
        };
        let png = encode_rgb(&six_views(&mesh, &materials))?;
        let size_mm = mesh.size_mm().map(|mm| (mm * 1000.0).round() / 1000.0);
        let words = [
            format!(
                "size   {} mm (length × width × height), {} of the real thing at 1:{}",
                units::sides(&size_mm.map(|mm| (mm * 10.0).round() / 10.0), " × "),
                units::real(size_mm, wanted.scale),
                number(wanted.scale)
            ),
            format!("unit   {}", unit(length_mm / (high - low), wanted.scale)),
            format!("front  {}, {} (else --mesh-front)", axes.front, axes.front_because),
            format!("top    {}, {} (else --mesh-up)", axes.up, axes.up_because),
            format!("paint  {paint_because} (else --paint)"),
            format!(
                "look at {}: is the front the front, the top the top, and what is orange the paint?",
                preview.display()
            ),
        ];
        let facts = MeshFacts {
            axes: Some([axes.front, axes.up]),
            paint: match paint {
                Paint::Faces(path) => Paint::Faces(named_from(wanted.output, &path)?),
                other => other,
            },
        };
        Ok(Taken {
            size_mm,
            envelope: Envelope::Mesh(named_from(wanted.output, file)?),
            mesh: facts,
            preview: (preview, png),
            words: words.to_vec(),
        })
    }

    /// Returns the axes as given; else by the shape, which is known of vehicles; else as glTF says.
    pub fn axes(&self, file: &Path, mesh: &Mesh, wanted: &Wanted) -> Result<AxesProposal> {
        let given = [self.mesh_front, self.mesh_up];
        if let [Some(front), Some(up)] = given {
            return Ok(AxesProposal {
                front,
                up,
                front_because: "as given",
                up_because: "as given",
            });
        }
        let found = if wanted.class.are_vehicles() {
            propose_axes(mesh, given).map_err(Some)
        } else {
            Err(None)
        };
        let [front, up] = MeshPlacement::usual(file);
        let [front, up] = [self.mesh_front.unwrap_or(front), self.mesh_up.unwrap_or(up)];
        match found {
            Ok(found) => Ok(found),
            Err(_) if is_gltf(file) && front.index() != up.index() => {
                let because = "as glTF says, since its shape does not tell";
                Ok(AxesProposal {
                    front,
                    up,
                    front_because: because,
                    up_because: because,
                })
            }
            Err(doubt) => Err(question(file, doubt, wanted).into()),
        }
    }

    /// About axes that are given and are not those of the shape.
    pub fn contradicted(&self, mesh: &Mesh, axes: &AxesProposal, wanted: &Wanted) -> Option<String> {
        let is_given = self.mesh_front.is_some() || self.mesh_up.is_some();
        let shape = propose_axes(mesh, [None, None]).ok();
        let shape = shape.filter(|shape| {
            is_given && wanted.class.are_vehicles() && [shape.front, shape.up] != [axes.front, axes.up]
        })?;
        Some(format!(
            "by its shape the front of the mesh is {} and its top {}, and with what is given they are {} and {}: look at the image",
            shape.front, shape.up, axes.front, axes.up
        ))
    }

    pub fn paint(&self, mesh: &Mesh, file: &Path) -> Result<(Paint, String)> {
        if let [word] = &self.paint[..]
            && !mesh.materials().contains(word)
        {
            let is_file = Path::new(word).is_file();
            return match &**word {
                "all" => Ok((Paint::All, "all of the mesh, as given".into())),
                _ if is_file => Ok((Paint::Faces(word.into()), format!("the triangles that {word} lists"))),
                _ => Err(mesh
                    .materials_named(&self.paint)
                    .err()
                    .map_or_else(|| word.clone().into(), Into::into)),
            };
        }
        if !self.paint.is_empty() {
            mesh.materials_named(&self.paint)?;
            return Ok((
                Paint::Materials(self.paint.clone()),
                format!("{}, as given", self.paint.join(", ")),
            ));
        }
        let seen = seen_shares(mesh);
        let (names, because) = propose_paint(mesh.materials(), &seen).map_err(|doubt| {
            let file = file.display();
            format!("{file}: {doubt}: say it by --paint NAME, several names, a file with the numbers of triangles, or --paint all")
        })?;
        if names.is_empty() {
            return Ok((Paint::All, format!("{because}: windows and wheels too, if it has any")));
        }
        let share: f64 = mesh
            .materials()
            .iter()
            .zip(&seen)
            .filter(|(name, _)| names.contains(name))
            .map(|(_, share)| share)
            .sum();
        Ok((
            Paint::Materials(names.clone()),
            format!(
                "{}, {:.0} % of what is seen, {because}",
                names.join(", "),
                100.0 * share
            ),
        ))
    }
}

/// A unit is recognised where the given length agrees with it to this factor.
const UNIT_TOLERANCE: f64 = 1.05;

/// In mm.
const UNITS: [(&str, f64); 3] = [("mm", 1.0), ("cm", 10.0), ("metres", 1000.0)];

/// Returns the error about axes that cannot be found, with the options that say them.
pub fn question(file: &Path, doubt: Option<AxesDoubt>, wanted: &Wanted) -> String {
    let file = file.display();
    let both = "say it by --mesh-front and --mesh-up, as in --mesh-front +x --mesh-up +z";
    match doubt {
        None => format!(
            "{file}: where the front and the top of a {} are is known only of vehicles: {both}",
            wanted.class
        ),
        Some(doubt @ AxesDoubt::Upside { .. }) => format!("{file}: {doubt}: say which by --mesh-up"),
        Some(doubt @ AxesDoubt::Ends { .. }) => format!("{file}: {doubt}: say which by --mesh-front"),
        Some(doubt) => format!("{file}: {doubt}: {both}"),
    }
}

/// The length of the printed model where only one unit makes a usual vehicle of the mesh.
pub fn usual_length(file: &Path, length: f64, wanted: &Wanted) -> Result<f64> {
    let mut lengths: Vec<f64> = UNITS
        .iter()
        .flat_map(|(_, mm)| [length * mm, length * mm / wanted.scale])
        .collect();
    lengths.retain(|mm| is_clearly_usual(wanted.class.labels(), mm * wanted.scale));
    lengths.sort_by(f64::total_cmp);
    lengths.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * *b);
    let (file, length) = (file.display(), number((1000.0 * length).round() / 1000.0));
    match lengths[..] {
        [only] => Ok(only),
        [] => Err(format!("{file} is {length} long in its own unit, which is no usual length in mm, cm or metres: give that of the printed model by --length-mm").into()),
        _ => {
            let each: Vec<String> = lengths.iter().map(|mm| number(mm.round())).collect();
            Err(format!("{file} is {length} long in its own unit, so that the printed model may be {} mm long: say it by --length-mm", each.join(" or ")).into())
        }
    }
}

/// Returns a line on the unit of the file, given its length on the model in mm.
pub fn unit(mm: f64, scale: f64) -> String {
    let is = |known: f64, mm: f64| (mm / known).max(known / mm) < UNIT_TOLERANCE;
    let of = |mm: f64| UNITS.iter().find(|(_, known)| is(*known, mm)).map(|(name, _)| *name);
    let shown = format!(
        "1 in the file is {} mm of the model",
        number((mm * 1000.0).round() / 1000.0)
    );
    match (of(mm), of(mm * scale)) {
        (Some(name), _) => format!("{shown}: {name} of the model"),
        (None, Some(name)) => format!("{shown}: {name} of the real thing"),
        (None, None) => format!("{shown}: no known unit, so the length alone says how large it is"),
    }
}

/// The image of the six views, beside the scene.
pub fn preview_path(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    scene.with_file_name(format!("{stem}_mesh.png"))
}

/// A file's path from the scene's folder, if it lies there or below; else its whole path.
pub fn named_from(scene: &Path, file: &Path) -> Result<PathBuf> {
    let whole = files::whole_path(files::folder_of(file))?.join(file.file_name().unwrap_or_default());
    // A folder that is still to be made has no files.
    let folder = files::whole_path(files::folder_of(scene)).ok();
    let below = folder.and_then(|folder| whole.strip_prefix(folder).ok().map(Path::to_owned));
    let named = below.unwrap_or(whole);
    match named.to_str() {
        Some(_) => Ok(named),
        None => Err(format!(
            "the path {} is not written in Unicode: rename it",
            quoted(&named.display().to_string())
        )
        .into()),
    }
}
