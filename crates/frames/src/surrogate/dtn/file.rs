//! A network with the state of its training in one file: a line with the version, a line with the SHA-256 of the rest, and the rest.

use std::path::Path;

use super::DtnError;
use super::training::Trainer;
use scaleproof_core::files;

const MAGIC: &str = "scaleproof dtn 1\n";

pub fn save(trainer: &Trainer, path: &Path) -> Result<(), DtnError> {
    trainer.check_numbers()?;
    let content = postcard::to_allocvec(trainer).map_err(|e| DtnError::Tensor(e.to_string()))?;
    let head = format!("{MAGIC}{}\n", files::sha256_hex(&content));
    files::write_atomically(path, &[head.into_bytes(), content].concat())?;
    Ok(())
}

pub fn load(path: &Path) -> Result<Trainer, DtnError> {
    let bytes = files::read(path)?;
    let path = || path.to_owned();
    let rest = bytes.strip_prefix(MAGIC.as_bytes());
    let rest = rest.ok_or_else(|| DtnError::NotANetwork { path: path() })?;
    let end = rest.iter().take(100).position(|b| *b == b'\n');
    let whole = end.map(|end| (&rest[..end], &rest[end + 1..]));
    let whole = whole.filter(|(sum, content)| *sum == files::sha256_hex(content).as_bytes());
    let trainer: Option<Trainer> = whole.and_then(|(_, content)| postcard::from_bytes(content).ok());
    let trainer = trainer.filter(Trainer::is_whole);
    trainer.ok_or_else(|| DtnError::Damaged { path: path() })
}
