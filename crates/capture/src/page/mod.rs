//! The page of a guided capture: a dial, the newest frame, one sentence, and buttons, in a browser on this machine or in the local
//! network.
//!
//! Two threads: the caller's runs the worker (`worker.rs`), the only place that touches the capture; the server's (`server.rs`) answers
//! from what the worker published last. Nothing a browser sends becomes a name or a path.

pub mod access;
pub mod connections;
pub mod dial;
mod ground;
mod previews;
mod routes;
mod server;
mod state;
mod tls;
mod upload;
mod worker;

use std::io;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use axum::body::Bytes;
use qrcode::QrCode;
use qrcode::render::unicode::Dense1x2;
use tokio::sync::{Semaphore, watch};

use crate::{Capture, FrameSource, SourceError, StoreError};
use access::Access;
use routes::{MAX_UPLOADS, PageContext};
use scaleproof_core::files;
use scaleproof_pose::scene::Scene;
use server::Server;
use worker::{CaptureWorker, Published, WorkerEvent};

pub use state::{CaptureInfo, PairsSoFar};
pub use worker::{AskPairs, CaptureNotice};

/// What keeps the page, or the capture behind it, from going on.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    #[error("the port {port} cannot be opened ({reason})")]
    Port { port: u16, reason: String },
    #[error("the page cannot be served ({reason})")]
    Server { reason: String },
    #[error("this machine is in no network that a phone could reach")]
    NoNetwork,
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Source(#[from] SourceError),
    /// What keeps the pairs from being looked at.
    #[error(transparent)]
    Pairs(Box<dyn std::error::Error>),
    #[error(transparent)]
    Output(io::Error),
}

/// A page that is being served.
pub struct Page {
    server: Server,
    /// For the source's thread.
    own: Sender<WorkerEvent>,
    events: Receiver<WorkerEvent>,
    published: watch::Sender<Arc<Published>>,
    /// The address for a browser on this machine.
    pub address: String,
    pub lan: Option<Lan>,
}

/// How a phone in the local network gets to the page.
pub struct Lan {
    pub address: String,
    /// SHA-256 of the certificate, as browsers show it.
    pub fingerprint: String,
    /// The address as a QR code, drawn with characters that are half as wide as high.
    pub code: String,
}

impl Page {
    /// Serves on 127.0.0.1, or with `lan` on all networks of this machine, encrypted, to whoever brings a one-time token: one for a browser on
    /// this machine, which needs no encryption, with `lan` one for a phone. Port 0 is any free one. `session` is the folder whose accepted photos are shown. The first Ctrl-C finishes
    /// the capture; `hurry` is what a second one does.
    ///
    /// # Errors
    /// A port that is in use; no network; no certificate.
    pub fn open(
        port: u16,
        lan: bool,
        session: &Path,
        hurry: impl FnOnce() + Send + 'static,
    ) -> Result<Page, PageError> {
        let unserved = |reason: String| PageError::Server { reason };
        let not_served = |e: io::Error| unserved(files::plain(&e));
        let network = lan.then(|| own_address().ok_or(PageError::NoNetwork)).transpose()?;
        let from = if lan {
            Ipv4Addr::UNSPECIFIED
        } else {
            Ipv4Addr::LOCALHOST
        };
        let listener = server::listen(from, port).map_err(|e| {
            let reason = files::plain(&e);
            PageError::Port { port, reason }
        })?;
        let port = listener.local_addr().map_err(not_served)?.port();
        let here = format!("http://{}:{port}/", Ipv4Addr::LOCALHOST);
        let (access, address, lan, tls) = match network {
            None => {
                let (access, token) = Access::local(port).map_err(|e| unserved(e.to_string()))?;
                (access, format!("{here}join/{token}"), None, None)
            }
            Some(ip) => {
                let tokens = Access::in_network(port).map_err(|e| unserved(e.to_string()))?;
                let (access, [for_here, for_phone]) = tokens;
                let address = format!("https://{ip}:{port}/join/{for_phone}");
                let code = QrCode::new(&address).map_err(|e| unserved(e.to_string()))?;
                // With its quiet zone, two rows of modules to a line, for dark characters on a light ground.
                let code = code.render::<Dense1x2>().build();
                let identity = tls::identity(ip).map_err(unserved)?;
                let lan = Lan {
                    address,
                    fingerprint: identity.fingerprint,
                    code,
                };
                (
                    access,
                    format!("{here}join/{for_here}"),
                    Some(lan),
                    Some(identity.acceptor),
                )
            }
        };
        let (own, events) = channel();
        let nothing = Published {
            json: Bytes::from_static(b"{}"),
            ..Published::default()
        };
        let (published, newest) = watch::channel(Arc::new(nothing));
        let site = PageContext {
            access: Arc::new(access),
            published: newest,
            events: own.clone(),
            session: session.to_owned(),
            uploads: Arc::new(Semaphore::new(MAX_UPLOADS)),
            previews: Arc::new(Semaphore::new(1)),
        };
        let site = (site.router(), tls);
        let server = Server::start(listener, site, own.clone(), Box::new(hurry)).map_err(not_served)?;
        Ok(Page {
            server,
            own,
            events,
            published,
            address,
            lan,
        })
    }

    /// Captures from a source and from what browsers send, until somebody finishes on the page or with Ctrl-C. The page stays when all
    /// views are there or the source has ended: photos may still be taken back. `ask` says after each photo what the pairs say so far; when they
    /// decide, no further photo is taken. Whether they have decided.
    ///
    /// # Errors
    /// A photo that cannot be written, a source that is gone, an output that cannot be written; browsers are shown the sentence, and the server
    /// has ended.
    pub fn follow(
        self,
        capture: &mut Capture,
        scene: &Scene,
        source: Option<Box<dyn FrameSource + Send>>,
        about: &CaptureInfo,
        ask: Option<AskPairs>,
        notify: &mut dyn FnMut(CaptureNotice) -> io::Result<()>,
    ) -> Result<bool, PageError> {
        let mut worker = CaptureWorker::new(capture, scene, about, &self.published, notify, ask);
        let worked = worker.work(&self.events, self.own, source);
        self.server.end();
        worked
    }
}

/// The address under which other machines in the local network see this one. Nothing is sent: the system is asked which way it would
/// take.
fn own_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    // An address for documentation (RFC 5737), which no network has.
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    let ip = socket.local_addr().ok()?.ip();
    (!ip.is_unspecified() && !ip.is_loopback()).then_some(ip)
}
