//! Photos that a browser sends: bounded before they are read, looked at before they are decoded, and named by nobody but the store.

use std::path::Path;
use std::time::Duration;

use axum::body::Body;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderName, StatusCode};
use http_body_util::BodyExt;
use tokio::time::{Instant, timeout_at};

use crate::{Original, SourceFrame};
use scaleproof_photo::{Budget, IPHONE_TO_JPEG, Photo};
use scaleproof_pose::camera::Camera;

/// Maximum size of one photo, bytes.
pub(super) const MAX_BYTES: usize = Budget::UPLOAD.bytes as usize;

/// The rate counts after this time: a phone may have to convert the photo first.
const GRACE: Duration = Duration::from_secs(6);

/// A sender slower than this, on the whole, loses its place; any wireless network that can show the page is faster.
const LEAST_BYTES_PER_S: f64 = 64_000.0;

/// A sender that is silent for this long is gone.
const SILENCE: Duration = Duration::from_secs(8);

/// Maximum time of an upload over a local network.
const WHOLE: Duration = Duration::from_secs(120);

pub(super) type Refusal = (StatusCode, String);

/// Refuses an upload whose header states too large a size.
pub(super) fn check_length(headers: &HeaderMap) -> Result<(), Refusal> {
    match text(headers, CONTENT_LENGTH).parse::<u64>() {
        Ok(length) if length > MAX_BYTES as u64 => Err(too_large()),
        _ => Ok(()),
    }
}

/// Refuses an upload whose header states another type than an image's. The bytes decide about JPEG or PNG.
pub(super) fn check_kind(headers: &HeaderMap) -> Result<(), Refusal> {
    let kind = text(headers, CONTENT_TYPE).trim().to_ascii_lowercase();
    let sentence = match kind.as_str() {
        "image/heic" | "image/heif" => {
            let sentence = format!("this is an HEIC image: {IPHONE_TO_JPEG}, or send it as JPEG");
            return Err((StatusCode::UNSUPPORTED_MEDIA_TYPE, sentence));
        }
        // Of the types a form of another site could send without asking first, none is an image's.
        kind if !kind.starts_with("image/") => "this is no image: send a JPEG or PNG straight from the camera",
        _ => return Ok(()),
    };
    Err(refusal(StatusCode::UNSUPPORTED_MEDIA_TYPE, sentence))
}

fn text(headers: &HeaderMap, name: HeaderName) -> &str {
    let value = headers.get(name).and_then(|value| value.to_str().ok());
    value.unwrap_or_default()
}

/// Reads the whole body; gives up when it grows too large or too slowly.
pub(super) async fn read(mut body: Body) -> Result<Vec<u8>, Refusal> {
    let begin = Instant::now();
    let slow = "the photo came too slowly: go nearer to the router and send it again";
    let broken = "the photo did not arrive whole: send it again";
    let (mut bytes, mut last) = (Vec::new(), begin);
    loop {
        let due = begin + GRACE + Duration::from_secs_f64(bytes.len() as f64 / LEAST_BYTES_PER_S);
        let next = timeout_at(due.min(last + SILENCE).min(begin + WHOLE), body.frame()).await;
        last = Instant::now();
        let Some(frame) = next.map_err(|_| refusal(StatusCode::REQUEST_TIMEOUT, slow))? else {
            return Ok(bytes);
        };
        let frame = frame.map_err(|_| refusal(StatusCode::BAD_REQUEST, broken))?;
        if let Ok(data) = frame.into_data() {
            if bytes.len() + data.len() > MAX_BYTES {
                return Err(too_large());
            }
            bytes.extend_from_slice(&data);
        }
    }
}

/// Makes a frame of a name and bytes without decoding its pixels. One that claims to be huge is unreadable.
pub(super) fn frame(name: String, bytes: Vec<u8>) -> SourceFrame {
    let photo = Photo::from_bytes(Path::new(&name), bytes, Budget::UPLOAD).map(Photo::into_bytes);
    SourceFrame::untimed(name, Original::from_file(photo))
}

/// Refuses a whole picture of a film of another size than the camera file's image: the video mode of phones crops and steadies, so that a camera file
/// of photos fits no film even when it has its shape.
pub(super) fn whole_frame(frame: SourceFrame, camera: &Camera) -> SourceFrame {
    let (Original::Encoded(bytes), own) = (&frame.original, [camera.width, camera.height]) else {
        return frame;
    };
    let size = match Photo::from_bytes(Path::new(&frame.name), bytes.clone(), Budget::UPLOAD) {
        Ok(photo) if [photo.width, photo.height] != own => [photo.width, photo.height],
        _ => return frame,
    };
    let [film, file] = [size, own].map(|[width, height]| format!("{width}×{height}"));
    let sentence =
        format!("the film is {film} and the camera file for {file}: calibrate with pictures saved from this film");
    SourceFrame::untimed(frame.name, Original::Unreadable(sentence))
}

fn too_large() -> Refusal {
    let megabytes = MAX_BYTES >> 20;
    let sentence = format!("the photo has more than {megabytes} MB: let the camera make smaller photos");
    (StatusCode::PAYLOAD_TOO_LARGE, sentence)
}

fn refusal(status: StatusCode, sentence: &str) -> Refusal {
    (status, sentence.to_owned())
}
