//! Guided capture: sources of frames, the gates a photo must pass, guidance, and the page in a browser.
//!
//! ```
//! use scaleproof_capture::capture::{Guidance, Tolerance};
//! use scaleproof_pose::scene::Bins;
//!
//! // Once round the model at 45° steps.
//! let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![15.0], distance_mm: vec![900.0] };
//! let views = bins.viewpoints(&bins.pitch_deg, &bins.distance_mm);
//! let guidance = Guidance::at(&views, Tolerance::of_bins(&bins, &bins.distance_mm), &bins);
//! assert_eq!(guidance.targets().len(), 8);
//! assert!(!guidance.is_finished());
//! ```

pub mod capture;
pub mod page;
