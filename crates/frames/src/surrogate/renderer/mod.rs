//! Models of one view that predict its image for any paint, behind one interface.
//!
//! All are closed forms: fitted per pixel and channel to a few images in flat colours by least squares, rendered or photographed, without
//! training. DTN (`x = relu((relu(η − s) + a)·m + b)`, CVPR 2022, fig. 4) is affine per pixel where its ReLUs are open, so these are its
//! rivals by construction. They work channel by channel: a camera that mixes channels is beyond them.
//!
//! | model | image x of reflectance ρ |
//! |---|---|
//! | `affine` | x = a + b·η, both as sRGB |
//! | `quadratic` | x = a + b·η + c·η², both as sRGB |
//! | `affine-curve` | T⁻¹(x) = a + b·ρ, in light, with the image's tone curve T fitted ([`Tone`]) |
//! | `quadratic-curve` | T⁻¹(x) = a + b·ρ + c·ρ²: light that goes to and fro between the paint's parts as well |

mod flat_image; // the image of a view in a flat colour
mod interface; // the interface of all surrogate renderers
mod per_pixel; // closed forms: polynomials per pixel and channel
mod tone; // the tone curve of an image

pub use flat_image::FlatImage;
pub use interface::Renderer;
pub use per_pixel::{ClosedForm, PerPixel};
pub use tone::Tone;
