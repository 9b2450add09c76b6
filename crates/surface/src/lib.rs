//! A model's surface: meshes, repeated patterns, and the colour of each point of the surface.
//!
//! Lengths are millimetres in the model frame: x to the front, y to the left, z up, the origin on the ground.
//!
//! ```
//! use scaleproof_surface::pattern::Pattern;
//!
//! let pattern = Pattern::random(16, 1)?;
//! assert_eq!((pattern.columns(), pattern.rows()), (16, 16));
//! assert_eq!(pattern, Pattern::random(16, 1)?);
//! # Ok::<(), scaleproof_surface::pattern::PatternError>(())
//! ```

pub mod mesh;
pub mod model;
pub mod pattern;
pub mod texture;
