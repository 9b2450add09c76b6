//! A network with the state of its training in one file: a line with the version, a line with the SHA-256 of the rest, and the rest.

use std::path::Path;

use super::training::Trainer;
use crate::FramesError;
use scaleproof_core::files;
use scaleproof_core::message::message;

const MAGIC: &str = "scaleproof dtn 1\n";

/// Writes the state of a training.
pub fn save(trainer: &Trainer, path: &Path) -> Result<(), FramesError> {
    trainer.check_numbers()?;
    let content = postcard::to_allocvec(trainer).map_err(|e| message!("the network cannot be computed ({e})"))?;
    let head = format!("{MAGIC}{}\n", files::sha256_hex(&content));
    files::write_atomically(path, &[head.into_bytes(), content].concat())?;
    Ok(())
}

/// Reads the state of a training.
pub fn load(path: &Path) -> Result<Trainer, FramesError> {
    let bytes = files::read(path)?;
    let rest = bytes.strip_prefix(MAGIC.as_bytes());
    let path = path.display();
    let foreign = || message!("{path} is no network of this program; give a file that attack train-dtn wrote");
    let rest = rest.ok_or_else(foreign)?;
    let end = rest.iter().take(100).position(|b| *b == b'\n');
    let whole = end.map(|end| (&rest[..end], &rest[end + 1..]));
    let whole = whole.filter(|(sum, content)| *sum == files::sha256_hex(content).as_bytes());
    let trainer: Option<Trainer> = whole.and_then(|(_, content)| postcard::from_bytes(content).ok());
    let trainer = trainer.filter(Trainer::is_whole);
    Ok(trainer.ok_or_else(|| message!("{path} is damaged: delete it and train again"))?)
}
