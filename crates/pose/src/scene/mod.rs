//! The scene on the table: the model, its scale, the tags around it, and the viewpoint bins. Read from `scene.toml`, or made by a preset
//! ([`TagRing`]).

mod bins;
mod classes;
mod envelope;
mod file;
mod layout;
mod limits;
mod model;
mod ring;
mod tag;
mod viewpoint;
mod views;
mod write;

pub use bins::{Bin, Bins};
pub use classes::{Classes, VEHICLES};
pub use envelope::Envelope;
pub use layout::Scene;
pub use model::{MeshFacts, Paint, ScaleModel};
pub use ring::TagRing;
pub use tag::{Tag, TagFamily, TagSigma, corners_in_tag_mm};
pub use viewpoint::Viewpoint;
pub use views::NoSuchBin;
