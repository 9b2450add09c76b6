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

pub mod mesh; // triangles with materials and texture coordinates, from glTF, OBJ, STL and PLY
pub mod model; // the model of a scene or of the command line: its mesh, placed, and its paint
pub mod pattern; // repeated patterns: made, loaded, imported, in paints, as printed
pub mod texture; // the colour of each point of a surface
pub mod zbuffer; // the nearest triangle at each pixel
