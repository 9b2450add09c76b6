//! Guided capture: sources of frames, the gates a photo must pass, guidance, and the page in a browser.
//!
//! ```
//! use scaleproof_capture::capture::{usual, viewpoints_of};
//! use scaleproof_pose::scene::Bins;
//!
//! // Once round the model at 45° steps.
//! let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![15.0], distance_mm: vec![900.0] };
//! assert_eq!(viewpoints_of(&bins, &[15.0], &[900.0]).len(), 8);
//! assert_eq!(usual(&bins), (15.0, 900.0));
//! ```

pub mod capture;
pub mod page;
