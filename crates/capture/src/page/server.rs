//! The HTTP server: one thread, a bounded number of connections, and none that stays open without saying or hearing anything.

use std::io;
use std::net::{IpAddr, Ipv4Addr, TcpListener};
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpSocket, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio_io_timeout::TimeoutStream;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

use super::access::Scheme;
use super::connections::{Connection, Connections};
use super::worker::WorkerEvent;
use super::{routes, tls};

/// Maximum number of connections, including those that are closing; a process may have some 1000 files open. Further connections wait.
const MAX_CONNECTIONS: usize = 512;

/// Time within which a connection must agree on TLS and send a whole request head; else it is closed.
const HEAD_TIMEOUT: Duration = Duration::from_secs(10);

/// Time within which a connection must take a byte of an answer; else it is closed.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);

/// Buffer for a request's head, and for the part of a body that waits to be read, bytes.
const MAX_BUFFERED: usize = 64 << 10;

/// Time for the last answers when the capture has ended.
const SHUTDOWN: Duration = Duration::from_secs(2);

/// Time after the end of the capture in which requests are still accepted and answered: those that browsers sent before may still be on their
/// way, such as that for the small image of the last photo.
const LAST_REQUESTS: Duration = Duration::from_millis(500);

/// Number of connections that may wait to be accepted, instead of the usual 128: one that is lost costs its browser a second.
const BACKLOG: u32 = 1024;

/// Opens a port.
///
/// # Errors
/// A port that is in use or not allowed.
pub(super) fn listen(from: Ipv4Addr, port: u16) -> io::Result<TcpListener> {
    // Only within a runtime is a socket made whose backlog one can choose.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
    let _within = runtime.enter();
    let socket = TcpSocket::new_v4()?;
    if cfg!(unix) {
        socket.set_reuseaddr(true)?; // as the standard library does
    }
    socket.bind((from, port).into())?;
    socket.listen(BACKLOG)?.into_std()
}

/// A running server.
pub(super) struct Server {
    thread: JoinHandle<()>,
    end: watch::Sender<bool>,
}

impl Server {
    /// Serves `site` until [`Server::shutdown`]; Ctrl-C asks the worker to finish, and a second one calls `hurry`.
    ///
    /// # Errors
    /// The system gives no thread or sockets.
    pub(super) fn start(
        listener: TcpListener,
        site: Site,
        events: Sender<WorkerEvent>,
        hurry: Box<dyn FnOnce() + Send>,
    ) -> io::Result<Server> {
        listener.set_nonblocking(true)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (end, ended) = watch::channel(false);
        let work = move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
                    return;
                };
                tokio::spawn(interrupted(events, hurry));
                accept(listener, site, ended).await;
            });
        };
        let thread = std::thread::Builder::new().name("page".into()).spawn(work)?;
        Ok(Server { thread, end })
    }

    /// Finishes requests in flight, then stops.
    pub(super) fn shutdown(self) {
        std::thread::sleep(LAST_REQUESTS);
        self.end.send_replace(true);
        let _ = self.thread.join(); // a thread that panicked has ended too
    }
}

/// Finishes the capture at the first Ctrl-C, as the button does; nothing accepted is lost whatever a second one does.
async fn interrupted(events: Sender<WorkerEvent>, hurry: Box<dyn FnOnce() + Send>) {
    if tokio::signal::ctrl_c().await.is_ok()
        && events.send(WorkerEvent::Finish).is_ok()
        && tokio::signal::ctrl_c().await.is_ok()
    {
        hurry();
    }
}

/// Pages that are served; with a certificate, other machines get them only by TLS.
#[derive(Clone)]
pub(super) struct Site {
    pub router: Router,
    pub acceptor: Option<TlsAcceptor>,
}

async fn accept(listener: tokio::net::TcpListener, site: Site, mut ended: watch::Receiver<bool>) {
    let sockets = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    let connections = Arc::new(Connections::default());
    loop {
        let next = async {
            let socket = sockets.clone().acquire_owned().await;
            (socket, listener.accept().await)
        };
        let (socket, stream) = tokio::select! {
            next = next => next,
            _ = ended.wait_for(|ended| *ended) => break,
        };
        match stream {
            Ok((stream, from)) => {
                let place = Arc::new(connections.enter(from.ip()));
                let work = connection(stream, from.ip(), site.clone(), place, ended.clone());
                tokio::spawn(async move {
                    work.await;
                    drop(socket);
                });
            }
            // Too many open files, or a peer that left already: others may get through in a moment.
            Err(_) => tokio::time::sleep(Duration::from_millis(50)).await,
        }
    }
    let all_left = sockets.acquire_many(MAX_CONNECTIONS as u32);
    let _ = tokio::time::timeout(SHUTDOWN, all_left).await; // who has not left by now is left behind
}

/// Serves one connection, from an address.
async fn connection(
    stream: TcpStream,
    from: IpAddr,
    Site { router, acceptor }: Site,
    place: Arc<Connection>,
    mut ended: watch::Receiver<bool>,
) {
    let _ = stream.set_nodelay(true); // only slower without
    let Some(acceptor) = acceptor else {
        return serve(bounded(stream), router, Scheme::Http, place, ended).await;
    };
    let begin = async {
        let is_tls = tls::begins_with_handshake(&stream).await;
        let stream = bounded(stream);
        if is_tls {
            acceptor
                .accept(stream)
                .await
                .ok()
                .map(|stream| Opened::Encrypted(Box::new(stream)))
        } else {
            Some(Opened::Plain(stream))
        }
    };
    let begun = tokio::select! {
        begun = tokio::time::timeout(HEAD_TIMEOUT, begin) => begun,
        () = place.asked_to_leave() => return,
        _ = ended.wait_for(|ended| *ended) => return,
    };
    match begun {
        Ok(Some(Opened::Encrypted(stream))) => serve(*stream, router, Scheme::Https, place, ended).await,
        // What stays on this machine nobody else hears, and its browser trusts it.
        Ok(Some(Opened::Plain(stream))) if from.is_loopback() => {
            serve(stream, router, Scheme::Http, place, ended).await
        }
        Ok(Some(Opened::Plain(stream))) => serve(stream, routes::unencrypted(), Scheme::Http, place, ended).await,
        Ok(None) | Err(_) => {}
    }
}

/// A connection whose peer must take what it is sent.
type Bounded = Pin<Box<TimeoutStream<TcpStream>>>;

enum Opened {
    Plain(Bounded),
    Encrypted(Box<TlsStream<Bounded>>),
}

fn bounded(stream: TcpStream) -> Bounded {
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(WRITE_TIMEOUT));
    Box::pin(stream)
}

async fn serve(
    stream: impl AsyncRead + AsyncWrite + Unpin,
    router: Router,
    scheme: Scheme,
    place: Arc<Connection>,
    mut ended: watch::Receiver<bool>,
) {
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(HEAD_TIMEOUT);
    builder.max_buf_size(MAX_BUFFERED);
    // Every request carries the connection on which it came.
    let guest = TowerToHyperService::new(router.layer(Extension(place.clone())).layer(Extension(scheme)));
    let mut serving = pin!(builder.serve_connection(TokioIo::new(stream), guest));
    // What goes wrong on a connection is its peer's concern alone.
    tokio::select! {
        _ = serving.as_mut() => return,
        () = place.asked_to_leave() => return,
        _ = ended.wait_for(|ended| *ended) => serving.as_mut().graceful_shutdown(),
    }
    let _ = serving.await;
}
