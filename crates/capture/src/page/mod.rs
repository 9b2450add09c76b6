//! The page of a guided capture: a dial, the newest frame, one sentence, and buttons, in a browser on this machine or in the local
//! network.
//!
//! Two threads: the caller's runs the worker (`worker.rs`), the only place that touches the capture; the server's (`server.rs`) answers
//! from what the worker published last. Nothing a browser sends becomes a name or a path.

pub mod access; // who may ask
pub mod connections; // who stays connected when there is no room for all
pub mod dial; // a viewpoint's place on the dial
mod error; // reasons why the page ends
mod ground; // the required views as a ring on the ground
mod previews; // small images of frames and photos
mod routes; // answers to requests
mod server; // the HTTP server and its connections
mod serving; // the page while it is served
mod state; // what the page shows, as JSON
mod tls; // the certificate for the local network
mod upload; // photos that a browser sends
mod worker; // the one place that touches the capture

pub use error::PageError;
pub use serving::{Lan, Page};
pub use state::{CaptureInfo, PairsSoFar};
pub use worker::{AskPairs, CaptureNotice};
