//! Pieces of `print wrap`, resolved from its arguments.

use crate::cli::args::pieces::PiecesArgs;
use scaleproof_print::wrap::WrapRequest;
use scaleproof_wrap::pieces::PiecesRequest;
use scaleproof_wrap::unwrap::UnwrapRequest;

impl PiecesArgs {
    /// Returns the request for the printed pieces of a painted model.
    pub fn request(&self, sheets: WrapRequest) -> PiecesRequest {
        let unwrap = UnwrapRequest {
            most_pieces: Some(self.pieces),
            mean_stretch: self.mean_stretch,
            stretch_99: self.max_stretch,
            ..UnwrapRequest::default()
        };
        PiecesRequest {
            unwrap,
            tabs_mm: self.tabs,
            sheets,
        }
    }
}
