//! OpenCV's ArUco detector, with each of its corner refiners.

use image::GrayImage;
use opencv::core::{Mat, Point2f, Ptr, Vector, no_array};
// OpenCV 4.7 moved the dictionaries from the contrib module `aruco` to `objdetect`; the names are the same.
#[allow(unused_imports)]
use opencv::{aruco::*, objdetect::*, prelude::*};

use super::search::{Found, Search, within_bounds};
use super::{CornersBy, SeenTag, StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;

/// How OpenCV moves the corners of the polygon it found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ArucoRefiner {
    /// Not at all.
    None,
    /// `cornerSubPix`.
    Subpix,
    /// Lines through the contour's points.
    Contour,
    /// The quads of the AprilTag 2 detector.
    AprilTag,
}

/// OpenCV's ArUco detector at full size.
pub struct ArucoOpenCv {
    dictionaries: Vec<(TagFamily, Ptr<Dictionary>)>,
    parameters: Ptr<DetectorParameters>,
    /// Where the refiner has the centre of the first pixel, px.
    pixel_centre: f64,
}

impl ArucoOpenCv {
    /// A detector for some families.
    pub fn new(families: &[TagFamily], refiner: ArucoRefiner) -> Result<ArucoOpenCv, StartError> {
        let choice = TagDetectorChoice::Aruco(refiner, CornersBy::Fit);
        choice.check_families(families)?;
        let known = families
            .iter()
            .filter_map(|family| Some((*family, dictionary(*family)?)));
        let dictionaries = known.map(|(family, name)| Ok((family, get_predefined_dictionary(name)?)));
        Ok(ArucoOpenCv {
            dictionaries: dictionaries
                .collect::<opencv::Result<_>>()
                .map_err(|e| choice.failed(e.message))?,
            parameters: parameters(refiner).map_err(|e| choice.failed(e.message))?,
            // Measured on rendered tags: OpenCV's copy of AprilTag keeps that library's convention.
            pixel_centre: if refiner == ArucoRefiner::AprilTag { 0.5 } else { 0.0 },
        })
    }

    /// Whether OpenCV has a family's codes.
    pub fn reads(family: TagFamily) -> bool {
        dictionary(family).is_some()
    }
}

/// With OpenCV's own corners.
impl TagDetector for ArucoOpenCv {
    fn find(&mut self, grey: &GrayImage) -> Vec<SeenTag> {
        self.search(grey).iter().map(|found| found.seen(grey)).collect()
    }
}

impl Search for ArucoOpenCv {
    fn search(&mut self, grey: &GrayImage) -> Vec<Found> {
        within_bounds(grey, |grey| self.search_all(grey))
    }
}

impl ArucoOpenCv {
    fn search_all(&self, grey: &GrayImage) -> Vec<Found> {
        let mut found = Vec::new();
        for (family, dictionary) in &self.dictionaries {
            // An exception of OpenCV is a picture it finds nothing in.
            let tags = detect(grey, dictionary, &self.parameters).unwrap_or_default();
            let centred = |corners: Corners| corners.map(|corner| corner.map(|v| v - self.pixel_centre));
            found.extend(tags.into_iter().map(|(id, corners)| Found {
                family: *family,
                id,
                corners_px: centred(corners),
            }));
        }
        found
    }
}

fn dictionary(family: TagFamily) -> Option<PREDEFINED_DICTIONARY_NAME> {
    match family {
        TagFamily::Tag16h5 => Some(PREDEFINED_DICTIONARY_NAME::DICT_APRILTAG_16h5),
        TagFamily::Tag25h9 => Some(PREDEFINED_DICTIONARY_NAME::DICT_APRILTAG_25h9),
        TagFamily::Tag36h11 => Some(PREDEFINED_DICTIONARY_NAME::DICT_APRILTAG_36h11),
        TagFamily::TagStandard41h12 | TagFamily::TagStandard52h13 => None,
    }
}

fn parameters(refiner: ArucoRefiner) -> opencv::Result<Ptr<DetectorParameters>> {
    let mut parameters = DetectorParameters::default()?;
    parameters.set_corner_refinement_method(match refiner {
        ArucoRefiner::None => CORNER_REFINE_NONE,
        ArucoRefiner::Subpix => CORNER_REFINE_SUBPIX,
        ArucoRefiner::Contour => CORNER_REFINE_CONTOUR,
        ArucoRefiner::AprilTag => CORNER_REFINE_APRILTAG,
    });
    Ok(Ptr::new(parameters))
}

type Corners = [[f64; 2]; 4];

fn detect(
    grey: &GrayImage,
    dictionary: &Ptr<Dictionary>,
    parameters: &Ptr<DetectorParameters>,
) -> opencv::Result<Vec<(u32, Corners)>> {
    let (Ok(rows), Ok(columns)) = (i32::try_from(grey.height()), i32::try_from(grey.width())) else {
        return Ok(Vec::new());
    };
    let picture = Mat::new_rows_cols_with_data(rows, columns, grey.as_raw().as_slice())?;
    let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
    detect_markers(
        &picture,
        dictionary,
        &mut corners,
        &mut ids,
        parameters,
        &mut no_array(),
    )?;
    let tags = ids.iter().zip(corners.iter());
    Ok(tags
        .filter_map(|(id, corners)| Some((u32::try_from(id).ok()?, upright(&corners)?)))
        .collect())
}

/// OpenCV's picture of an AprilTag is the tag turned by 180°, so its first corner is our third.
fn upright(corners: &Vector<Point2f>) -> Option<Corners> {
    let at = |i: usize| corners.get(i).ok().map(|p| [f64::from(p.x), f64::from(p.y)]);
    Some([at(2)?, at(3)?, at(0)?, at(1)?])
}
