//! A stored session in place of a camera.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::error::SourceError;
use super::frame::{FrameSource, Original, SourceFrame};
use scaleproof_core::files;
use scaleproof_core::message::bail;
use scaleproof_session::{PhotoEntry, Session};

/// The photos of one variant of a session, one after the other.
pub struct Replay {
    session: Session,
    /// Photos that are left, in reverse: the next one is the last.
    left: Vec<PhotoEntry>,
    /// Time from one frame to the next.
    pace: Duration,
    due: Option<Instant>,
}

impl Replay {
    /// Opens the photos of `variant` in the session's order, or shuffled by a seed; a frame every `pace`, as fast as possible when that is zero.
    ///
    /// # Errors
    /// A session that cannot be opened; no photo of that variant.
    pub fn open(folder: &Path, variant: &str, shuffle: Option<u64>, pace: Duration) -> Result<Replay, SourceError> {
        let session = Session::open(folder)?;
        let of_variant = session.photos.iter().filter(|photo| photo.variant == variant);
        let mut left: Vec<PhotoEntry> = of_variant.cloned().collect();
        if left.is_empty() {
            let others: BTreeSet<&str> = session.photos.iter().map(|photo| photo.variant.as_str()).collect();
            bail!(
                "the session in {} has no photo of the variant {variant}, only of {}",
                folder.display(),
                Vec::from_iter(others).join(", ");
                hint: "replay another, or name one of these by ‹variant›"
            );
        }
        if let Some(seed) = shuffle {
            left.shuffle(&mut Pcg64::seed_from_u64(seed));
        }
        left.reverse();
        Ok(Replay {
            session,
            left,
            pace,
            due: None,
        })
    }
}

impl FrameSource for Replay {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        let Some(photo) = self.left.pop() else {
            return Ok(None);
        };
        if let Some(due) = self.due {
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
        self.due = Some(Instant::now() + self.pace);
        let read = files::read(&self.session.photo_path(&photo));
        Ok(Some(SourceFrame {
            taken: photo.taken,
            ..SourceFrame::untimed(photo.file, Original::from_file(read))
        }))
    }
}
