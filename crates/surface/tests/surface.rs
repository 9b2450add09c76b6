//! Unit and property tests of meshes and patterns.

#[path = "surface/colour.rs"]
mod colour;
#[path = "surface/contrast.rs"]
mod contrast;
#[path = "surface/gamut.rs"]
mod gamut;
#[path = "surface/light.rs"]
mod light;
#[path = "surface/mesh.rs"]
mod mesh;
#[path = "surface/outside.rs"]
mod outside;
#[path = "surface/paint.rs"]
mod paint;
#[path = "surface/pattern.rs"]
mod pattern;
#[path = "surface/simplified.rs"]
mod simplified;
#[path = "surface/world_aligned.rs"]
mod world_aligned;
#[path = "surface/zbuffer.rs"]
mod zbuffer;
