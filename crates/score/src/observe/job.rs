//! One photo of a run, as its observer takes it.

use crate::figures::NotScored;
use crate::observe::NotScoredReason;
use scaleproof_session::{PhotoEntry, Session};

pub(crate) struct ScoringJob<'a> {
    /// Number from 1, in the order of the sessions.
    pub id: u64,
    pub session_index: usize,
    pub session: &'a Session,
    pub entry: &'a PhotoEntry,
    /// True if the photo's tags are searched to check the list, though the list says all that they would.
    pub is_checked: bool,
}

impl ScoringJob<'_> {
    pub(crate) fn all(sessions: &[Session]) -> Vec<ScoringJob<'_>> {
        let sessions = sessions.iter().enumerate();
        let entries = sessions.flat_map(|(i, s)| s.photos.iter().map(move |entry| (i, s, entry)));
        let job = |(id, (session_index, session, entry))| ScoringJob {
            id,
            session_index,
            session,
            entry,
            is_checked: false,
        };
        (1..).zip(entries).map(job).collect()
    }

    pub(crate) fn left_out(&self, reason: NotScoredReason) -> NotScored {
        NotScored {
            session: self.session.name.clone(),
            file: self.entry.file.clone(),
            variant: self.entry.variant.clone(),
            reason: reason.0,
            near_copy_of: None,
        }
    }

    /// Returns the index among the photos of the run, from 0.
    pub(crate) fn index(&self) -> usize {
        usize::try_from(self.id.saturating_sub(1)).unwrap_or(usize::MAX)
    }

    pub(crate) fn needs_tags(&self) -> bool {
        self.entry.box_xyxy_px.is_none() || self.entry.viewpoint.is_none()
    }
}
