//! Answers to requests. All that changes the session goes to the worker; the rest is answered from the state that the worker published last.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{FromRequestParts, Path, Request, State};
use axum::http::header::{CACHE_CONTROL, CONNECTION, CONTENT_TYPE, LOCATION, SET_COOKIE};
use axum::http::request::Parts;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::de::DeserializeOwned;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot, watch};

use super::access::{Access, Scheme};
use super::connections::Connection;
use super::worker::{Action, ActionReply, FilmKind, Published, WorkerEvent};
use super::{previews, upload};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Time for which a request for news waits for some.
const NEWS: Duration = Duration::from_secs(10);

/// Lengths of the longest side, px.
const PREVIEW_PX: u32 = 960;
const THUMBNAIL_PX: u32 = 240;

/// Maximum number of uploads in memory at once; further ones wait before they are read.
pub(super) const MAX_UPLOADS: usize = 4;

/// Headers of every answer: no content from elsewhere, no frame around the page, no guessing of types, no cache.
const HEADERS: [(&str, &str); 5] = [
    (
        "content-security-policy",
        "default-src 'none'; img-src 'self' data:; style-src 'self'; script-src 'self'; connect-src 'self'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// Context of the answers.
#[derive(Clone)]
pub(super) struct PageContext {
    pub access: Arc<Access>,
    pub published: watch::Receiver<Arc<Published>>,
    pub events: Sender<WorkerEvent>,
    /// The session's folder, of which only accepted photos are read.
    pub session: PathBuf,
    pub uploads: Arc<Semaphore>,
    /// One image is made at a time.
    pub previews: Arc<Semaphore>,
}

impl PageContext {
    pub(super) fn router(self) -> Router {
        Router::new()
            .route("/", get(|| async { asset("text/html; charset=utf-8", PAGE) }))
            .route("/page.css", get(|| async { asset("text/css; charset=utf-8", STYLE) }))
            .route(
                "/page.js",
                get(|| async { asset("text/javascript; charset=utf-8", SCRIPT) }),
            )
            .route("/state/{seen}", get(state))
            .route("/preview/{number}", get(preview))
            .route("/photo/{name}", get(photo))
            .route("/upload", post(|site, request| receive(site, request, Action::Upload)))
            .route("/film/{device}/{kind}/{after_ms}", post(film))
            .route("/shoot", post(|site| ask(site, Action::Shoot)))
            .route("/undo", post(|site| ask(site, Action::Undo)))
            .route(
                "/redo/{sector}",
                post(|site, Named(sector)| ask(site, Action::Redo(sector))),
            )
            .route("/finish", post(finish))
            .layer(middleware::from_fn_with_state(self.clone(), known))
            .route("/join/{token}", get(join))
            .layer(middleware::from_fn_with_state(self.clone(), from_here))
            .with_state(self)
    }
}

/// Parameters of an address, parsed; an address with others is answered in a sentence of ours, not of the framework's.
struct Named<T>(T);

impl<T: DeserializeOwned + Send> FromRequestParts<PageContext> for Named<T> {
    type Rejection = Response;

    async fn from_request_parts(parts: &mut Parts, site: &PageContext) -> Result<Named<T>, Response> {
        let named = Path::from_request_parts(parts, site).await;
        named
            .map(|Path(named)| Named(named))
            .map_err(|_| stranger(StatusCode::BAD_REQUEST, "this page has no such address"))
    }
}

/// Checks every request first, and adds the headers to every answer.
async fn from_here(State(site): State<PageContext>, request: Request, next: Next) -> Response {
    let mut response = match site
        .access
        .check_site(request.method(), request.headers(), scheme(&request))
    {
        Ok(()) => next.run(request).await,
        Err((status, sentence)) => stranger(status, sentence),
    };
    for (name, value) in HEADERS {
        let header = response.headers_mut().entry(HeaderName::from_static(name));
        header.or_insert(HeaderValue::from_static(value));
    }
    response
}

fn scheme(request: &Request) -> Scheme {
    request.extensions().get().copied().unwrap_or(Scheme::Http)
}

async fn known(State(site): State<PageContext>, request: Request, next: Next) -> Response {
    let Some(browser) = site.access.browser(request.headers()) else {
        let sentence = "open the address with its code, which the terminal shows; each is good once";
        return stranger(StatusCode::UNAUTHORIZED, sentence);
    };
    if let Some(place) = request.extensions().get::<Arc<Connection>>() {
        place.belongs_to(&browser);
    }
    next.run(request).await
}

async fn join(State(site): State<PageContext>, Named(token): Named<String>, request: Request) -> Response {
    let to_page = [(LOCATION, "/")];
    match site.access.join(&token, scheme(&request)) {
        Some(cookie) => (StatusCode::SEE_OTHER, to_page, [(SET_COOKIE, cookie)]).into_response(),
        // The same browser once more: it has its cookie.
        None if site.access.browser(request.headers()).is_some() => (StatusCode::SEE_OTHER, to_page).into_response(),
        None => {
            let sentence =
                "this code is not known, or another browser has used it: start the capture again for a new one";
            stranger(StatusCode::UNAUTHORIZED, sentence)
        }
    }
}

/// Answers with the newest state, as soon as it is another than the one that was seen.
async fn state(State(site): State<PageContext>, Named(seen): Named<u64>) -> Response {
    let mut published = site.published.clone();
    let is_news = |p: &Arc<Published>| p.revision != seen || p.has_ended;
    let _ = tokio::time::timeout(NEWS, published.wait_for(is_news)).await; // without news, the old once more
    let json = published.borrow().json.clone();
    ([(CONTENT_TYPE, "application/json")], json).into_response()
}

/// Answers with the newest frame; an older one is gone.
async fn preview(State(site): State<PageContext>, Named(number): Named<u64>) -> Response {
    let Ok(turn) = site.previews.clone().acquire_owned().await else {
        return StatusCode::GONE.into_response();
    };
    let newest = site.published.borrow().frame.clone();
    match newest.filter(|frame| frame.number == number) {
        Some(newest) => jpeg(turn, move || previews::of_frame(&newest.frame.original, PREVIEW_PX)).await,
        None => StatusCode::GONE.into_response(),
    }
}

/// Answers with a photo that fills a view. The name is compared with those of such photos, and never made into a path unless it is one.
async fn photo(State(site): State<PageContext>, Named(name): Named<String>) -> Response {
    let is_one = site.published.borrow().photos.contains(&name);
    if !is_one {
        return StatusCode::NOT_FOUND.into_response();
    }
    let Ok(turn) = site.previews.clone().acquire_owned().await else {
        return StatusCode::GONE.into_response();
    };
    let path = site.session.join(name);
    let mut response = jpeg(turn, move || previews::of_photo(&path, THUMBNAIL_PX)).await;
    // Names are given once.
    let kept = HeaderValue::from_static("private, max-age=86400, immutable");
    response.headers_mut().insert(CACHE_CONTROL, kept);
    response
}

/// Answers with an image that another thread makes. The turn goes with the work, which goes on when the browser has left.
async fn jpeg(turn: OwnedSemaphorePermit, make: impl FnOnce() -> Option<Vec<u8>> + Send + 'static) -> Response {
    let work = move || {
        let _turn = turn;
        make()
    };
    match tokio::task::spawn_blocking(work).await {
        Ok(Some(jpeg)) => ([(CONTENT_TYPE, "image/jpeg")], jpeg).into_response(),
        _ => StatusCode::NOT_FOUND.into_response(),
    }
}

/// Takes a picture that a device films, `after_ms` after the one before; the page made up the device's number.
async fn film(
    site: State<PageContext>,
    Named((device, kind, after_ms)): Named<(u32, FilmKind, u32)>,
    request: Request,
) -> Response {
    let filmed = |bytes, place| Action::Filmed {
        device,
        kind,
        after_ms,
        bytes,
        place,
    };
    receive(site, request, filmed).await
}

/// Reads a picture within the bounds of an upload, and hands it to the worker as the action that `of` makes of it.
async fn receive(
    site: State<PageContext>,
    request: Request,
    of: impl FnOnce(Vec<u8>, OwnedSemaphorePermit) -> Action,
) -> Response {
    let (parts, body) = request.into_parts();
    if let Err((status, sentence)) = upload::check_length(&parts.headers) {
        return response(ActionReply::new(status, sentence));
    }
    let Ok(place) = site.uploads.clone().acquire_owned().await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    // Read in any case: a browser shows no answer that comes while it is still sending.
    let read = upload::read(body).await;
    match upload::check_kind(&parts.headers).and(read) {
        Ok(bytes) => ask(site, of(bytes, place)).await,
        Err((status, sentence)) => response(ActionReply::new(status, sentence)),
    }
}

async fn finish(State(site): State<PageContext>) -> Response {
    match site.events.send(WorkerEvent::Finish) {
        Ok(()) => StatusCode::ACCEPTED.into_response(),
        Err(_) => has_ended(),
    }
}

/// Hands something to the worker and waits for its reply.
async fn ask(State(site): State<PageContext>, action: Action) -> Response {
    let (reply, answer) = oneshot::channel();
    if site.events.send(WorkerEvent::Asked(action, reply)).is_err() {
        return has_ended();
    }
    answer.await.map_or_else(|_| has_ended(), response)
}

fn response(response: ActionReply) -> Response {
    let json = serde_json::to_vec(&response).unwrap_or_default(); // strings always serialise
    (response.status, [(CONTENT_TYPE, "application/json")], json).into_response()
}

fn has_ended() -> Response {
    response(ActionReply::new(
        StatusCode::SERVICE_UNAVAILABLE,
        "The capture has ended",
    ))
}

/// Returns the one answer to a connection of the network that is not encrypted: the code in its address, if it has one, was seen by others.
pub(super) fn unencrypted() -> Router {
    let sentence = "this page is encrypted: open the address that the terminal shows, which begins with https://";
    Router::new().fallback(move || async move { stranger(StatusCode::BAD_REQUEST, sentence) })
}

/// Answers an unknown client; the connection closes after it.
fn stranger(status: StatusCode, sentence: &'static str) -> Response {
    let headers = [(CONTENT_TYPE, "text/plain; charset=utf-8"), (CONNECTION, "close")];
    (status, headers, sentence).into_response()
}

fn asset(kind: &'static str, text: &'static str) -> Response {
    ([(CONTENT_TYPE, kind)], Body::from(Bytes::from_static(text.as_bytes()))).into_response()
}
