//! Charts of the reports as drawings.

pub mod colours; // colours of the variants
pub mod curves; // precision over recall, photos found by confidence
pub mod drops; // drops with intervals and numbers
pub mod files; // charts as SVG and PDF files
pub mod heat; // heat maps of the viewing directions
pub mod intervals; // drop of the mean confidence
pub mod looks; // evidence of a sequential comparison
pub mod plane; // plot area for shares
pub mod polar; // mean confidence by azimuth
pub mod ranking; // order of the textures here and there
pub mod reliability; // share correct by confidence
pub mod robustness; // AP against severity
pub mod shade; // colour scale of the heat maps
pub mod speed; // AP against time
