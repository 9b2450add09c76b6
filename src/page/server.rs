//! The HTTP server: one thread, a bounded number of connections, and none that stays open without saying anything.

use std::io;
use std::net::TcpListener;
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;
use tokio::sync::{Semaphore, watch};

use super::desk::Event;

/// A laptop, some phones, and their parallel requests; further connections wait.
const MAX_CONNECTIONS: usize = 64;

/// A connection that sends no whole request head for so long is closed.
const HEAD: Duration = Duration::from_secs(10);

/// How long the last answers may take when the capture has ended.
const FAREWELL: Duration = Duration::from_secs(2);

/// A running server.
pub(super) struct Server {
    thread: JoinHandle<()>,
    end: watch::Sender<bool>,
}

impl Server {
    /// Serves `router` until it is ended; Ctrl-C asks the desk to finish.
    ///
    /// # Errors
    /// The system gives no thread or sockets.
    pub(super) fn start(listener: TcpListener, router: Router, events: Sender<Event>) -> io::Result<Server> {
        listener.set_nonblocking(true)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (end, ended) = watch::channel(false);
        let work = move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
                    return;
                };
                tokio::spawn(interrupted(events));
                accept(listener, router, ended).await;
            });
        };
        let thread = std::thread::Builder::new().name("page".into()).spawn(work)?;
        Ok(Server { thread, end })
    }

    /// Lets the answers that are under way leave, and ends.
    pub(super) fn end(self) {
        self.end.send_replace(true);
        let _ = self.thread.join(); // a thread that panicked has ended too
    }
}

/// The first Ctrl-C finishes the capture as the button does, a second one ends the program at once; nothing accepted is lost either way.
async fn interrupted(events: Sender<Event>) {
    if tokio::signal::ctrl_c().await.is_ok()
        && events.send(Event::Finish).is_ok()
        && tokio::signal::ctrl_c().await.is_ok()
    {
        std::process::exit(130);
    }
}

async fn accept(listener: tokio::net::TcpListener, router: Router, mut ended: watch::Receiver<bool>) {
    let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    loop {
        let next = async {
            let place = places.clone().acquire_owned().await;
            (place, listener.accept().await)
        };
        let (place, stream) = tokio::select! {
            next = next => next,
            _ = ended.wait_for(|ended| *ended) => break,
        };
        match stream {
            Ok((stream, _)) => {
                let work = connection(stream, router.clone(), ended.clone());
                tokio::spawn(async move {
                    work.await;
                    drop(place);
                });
            }
            // Too many open files, or a peer that left already: others may get through in a moment.
            Err(_) => tokio::time::sleep(Duration::from_millis(50)).await,
        }
    }
    let all_left = places.acquire_many(MAX_CONNECTIONS as u32);
    let _ = tokio::time::timeout(FAREWELL, all_left).await; // who has not left by now is left behind
}

async fn connection(stream: TcpStream, router: Router, mut ended: watch::Receiver<bool>) {
    let _ = stream.set_nodelay(true); // only slower without
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(HEAD);
    let mut serving = pin!(builder.serve_connection(TokioIo::new(stream), TowerToHyperService::new(router)));
    // What goes wrong on a connection is its peer's concern alone.
    tokio::select! {
        _ = serving.as_mut() => return,
        _ = ended.wait_for(|ended| *ended) => serving.as_mut().graceful_shutdown(),
    }
    let _ = serving.await;
}
