//! Model and texture of `texture`, resolved from its arguments.

use super::patch::{asked, placed};
use crate::cli::Result;
use crate::cli::args::textures::{PAPER, PaintedArgs};
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::Texture;

impl PaintedArgs {
    pub fn load(&self) -> Result<(Model, Texture)> {
        let model = self.model.load_or(self.texture.mesh())?;
        if self.places.patch.is_empty() {
            let texture = self.texture.load(&model)?.texture;
            return Ok((model, texture));
        }
        let below = match self.texture.file() {
            None => Texture::Flat(PAPER),
            Some(_) => self.texture.load(&model)?.texture,
        };
        // Finished textures in their places, over another texture.
        let patches = placed(&asked(&self.places)?);
        Ok((model, Texture::Patches(Box::new(below), patches)))
    }
}
