//! A model covered with a pattern: its surface cut into few flat pieces to print, and textures baked onto texture coordinates.
//!
//! ```
//! use scaleproof_surface::mesh::Mesh;
//! use scaleproof_wrap::unwrap::{UnwrapRequest, unwrap};
//!
//! // A box of 180 × 90 × 60 mm, flattened without stretch.
//! let mesh = Mesh::cuboid([180.0, 90.0, 60.0]);
//! let unwrapped = unwrap(&mesh, &[], &UnwrapRequest::default(), &mut |_| ())?;
//! let surface: f64 = unwrapped.charts.iter().map(|chart| chart.surface_mm2).sum();
//! assert!(surface > 30_000.0);
//! # Ok::<(), scaleproof_wrap::unwrap::UnwrapError>(())
//! ```

pub mod bake; // a texture as one image on texture coordinates
pub mod pieces; // flat pieces nested on sheets, with letters, tabs and stencils
pub mod unwrap; // the paint cut into few flat pieces of bounded stretch
