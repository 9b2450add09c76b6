//! Methods compared on the same photos, and advice on the smallest way that a session needs.
//!
//! ```
//! use scaleproof_study::chart::stability::{photo_steps, view_steps};
//!
//! // Numbers of steps of the sweeps that drive a method until it breaks.
//! assert!(view_steps() > 40 && photo_steps(16) > 400);
//! ```

pub mod advise; // the smallest way that a session needs, by left-out tags
pub mod chart; // methods compared on the same photos, and driven until they break
