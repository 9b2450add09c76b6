//! Scenes, cameras, and where photos were taken.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc;

use image::{RgbImage, imageops};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use scaleproof::in_process;
use scaleproof_core::geometry::rigid;
use scaleproof_core::workers;
use scaleproof_photo::{Photo, PhotoError};
use scaleproof_pose::locate::{LocatedPhoto, locate_luma, locate_photo};
use scaleproof_pose::tags::{TagDetector, TagDetectorChoice};
use scaleproof_session::envelope::EnvelopeShape;

use crate::error::{Error, refused, unpanicked};
use crate::watched::{self, Course, Event};

/// A scene file, and the model's outline.
#[pyclass(frozen, module = "scaleproof._native")]
pub struct Scene {
    scene: Arc<scaleproof::Scene>,
    outline: EnvelopeShape,
}

#[pymethods]
impl Scene {
    #[new]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Scene> {
        py.detach(|| {
            unpanicked(|| {
                let scene = scaleproof::Scene::open(&path).map_err(refused)?;
                let outline = EnvelopeShape::open(&scene.model, path.parent().unwrap_or(Path::new("")));
                Ok(Scene {
                    outline: outline.map_err(refused)?,
                    scene: Arc::new(scene),
                })
            })?
        })
    }

    /// Name, scale and size of the model, the labels that count as it, and (family, id, side in mm) of the tags.
    #[allow(clippy::type_complexity)]
    fn about(&self) -> (String, f64, [f64; 3], Vec<String>, Vec<(String, u32, f64)>) {
        let model = &self.scene.model;
        let tags = self.scene.tags.iter();
        let tags = tags.map(|tag| (tag.family.name().to_owned(), tag.id, tag.size_mm));
        (
            model.name.clone(),
            model.scale,
            model.size_mm,
            model.class.labels().to_vec(),
            tags.collect(),
        )
    }

    /// The truth box (left, top, right, bottom) of the model in a photo of a width and height, px, by its pose, row by row.
    fn truth_box(
        &self,
        py: Python<'_>,
        pose: [[f64; 4]; 4],
        camera: &Camera,
        size: (u32, u32),
    ) -> PyResult<(f64, f64, f64, f64)> {
        py.detach(|| {
            unpanicked(|| {
                let fitted = camera.0.for_photo(size.0, size.1, 0).map_err(refused)?;
                let rotation = std::array::from_fn::<_, 9, _>(|i| pose[i / 3][i % 3]);
                let rotation = nalgebra::Matrix3::from_row_slice(&rotation);
                let pose = rigid::from_matrix(rotation, nalgebra::Vector3::new(pose[0][3], pose[1][3], pose[2][3]));
                let truth = self.outline.box_in_photo(&pose, &fitted.camera).map_err(refused)?;
                Ok((truth.x1, truth.y1, truth.x2, truth.y2))
            })?
        })
    }
}

/// A camera file.
#[pyclass(frozen, module = "scaleproof._native")]
pub struct Camera(scaleproof::Camera);

#[pymethods]
impl Camera {
    #[new]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Camera> {
        py.detach(|| unpanicked(|| scaleproof::Camera::open(&path).map(Camera).map_err(refused))?)
    }

    /// Width and height of its image, px.
    fn size(&self) -> (u32, u32) {
        (self.0.width, self.0.height)
    }

    /// Focal lengths across and down, and the principal point, px from the centre of the top-left pixel.
    fn matrix(&self) -> (f64, f64, f64, f64) {
        (self.0.fx, self.0.fy, self.0.cx, self.0.cy)
    }
}

/// A photo as Python gives it: a file, or the bytes of an upright image (red, green, blue; row by row) with its name, width and height.
#[derive(FromPyObject)]
pub enum Given {
    Image(PyBackedBytes, String, u32, u32),
    File(PathBuf),
}

impl Given {
    fn name(&self) -> &Path {
        match self {
            Given::Image(_, name, ..) => Path::new(name),
            Given::File(path) => path,
        }
    }

    fn located(
        &self,
        scene: &scaleproof::Scene,
        camera: &scaleproof::Camera,
        tags: &mut dyn TagDetector,
    ) -> Result<LocatedPhoto, PhotoError> {
        match self {
            Given::File(path) => locate_photo(&Photo::open(path)?, scene, camera, tags),
            Given::Image(bytes, _, width, height) => {
                // Of another length it would be no image; its maker has checked it.
                let image = RgbImage::from_raw(*width, *height, bytes.to_vec()).unwrap_or_default();
                let luma = imageops::grayscale(&image);
                Ok(locate_luma(&luma, 0, None, scene, camera, tags))
            }
        }
    }
}

/// Where photos were taken: for each what `locate --json` prints of it.
#[pyfunction]
#[pyo3(signature = (photos, scene, camera, tag_detector, threads, progress))]
pub fn locate(
    py: Python<'_>,
    photos: Vec<Given>,
    scene: &Scene,
    camera: &Camera,
    tag_detector: &str,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    let choice: TagDetectorChoice = tag_detector.parse().map_err(|e| Error::new_err(format!("{e}")))?;
    let (course, families) = (Course::default(), scene.scene.families());
    course.of.store(photos.len(), Ordering::Relaxed);
    let look = |tags: &mut Box<dyn TagDetector>, photo: &Given| {
        if course.is_stopped() {
            return Err("stopped".to_owned());
        }
        let answer = photo.located(&scene.scene, &camera.0, tags.as_mut());
        in_process::located(photo.name(), answer)
    };
    let open = || choice.open(&families).map_err(|e| in_process::sentence(&e));
    let threads = threads.unwrap_or_else(workers::thread_count).max(1);
    let all = || workers::map_over(threads, &photos, open, look, || course.step());
    let requests = mpsc::channel::<Event<()>>();
    watched::work(py, &course, progress, requests, |_, (), _| Ok(()), all)?.map_err(Error::new_err)
}
