//! Decoding of HEIC and its relatives (ISO 23008-12) by the system's decoder: `heif-dec` or `heif-convert` of libheif.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::budget::Budget;
use super::error::{DecodeProblem, PhotoError};
use scaleproof_core::files;

/// Names of libheif's command, the newer one first: `heif-dec`.
const DECODERS: [&str; 2] = ["heif-dec", "heif-convert"];
/// Maximum time of a decoder for one image; beyond it, the decoder hangs.
const MOST_TIME: Duration = Duration::from_secs(60);
const LOOK_AGAIN: Duration = Duration::from_millis(10);

/// Returns true if the system has a decoder for HEIC files.
pub fn reads_heif() -> bool {
    decoder().is_some()
}

/// Decodes an HEIF file to an upright PNG; `None` if the system has no decoder for it.
pub(super) fn as_png(path: &Path, bytes: &[u8]) -> Result<Option<Vec<u8>>, PhotoError> {
    let Some(decoder) = decoder() else { return Ok(None) };
    let failed = |reason: String| DecodeProblem::Damaged(reason).at(path);
    let folder = own_folder().map_err(|e| failed(format!("no folder for decoding it: {e}")))?;
    let [from, to, first, complaint] = ["in.heic", "out.png", "out-1.png", "said"].map(|name| folder.path().join(name));
    std::fs::write(&from, bytes).map_err(|e| failed(format!("no room for decoding it: {e}")))?;
    let started = Command::new(&decoder)
        .args([&from, &to])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(&complaint).map_or_else(|_| Stdio::null(), Stdio::from))
        .spawn();
    let name = decoder.file_name().unwrap_or_default().display();
    let ended = started.and_then(within_time);
    let is_done = ended.map_err(|e| failed(format!("{name} could not decode it: {e}")))?;
    // A file of several images gives several outputs; the first is the one to show.
    let image = [to, first].into_iter().find(|path| path.is_file());
    if let Some(image) = image.filter(|_| is_done) {
        return Ok(Some(pixels_only(&files::read_at_most(&image, Budget::FILE.bytes)?)));
    }
    let said = files::read_at_most(&complaint, 1 << 20).unwrap_or_default();
    let said = match String::from_utf8_lossy(&said).lines().next().unwrap_or_default().trim() {
        "" => String::new(),
        said => format!(" ({said})"),
    };
    Err(failed(format!(
        "{name} could not decode it{said}; is libheif's decoder for it installed (Debian: libheif-plugin-libde265)?"
    )))
}

fn decoder() -> Option<PathBuf> {
    DECODERS.iter().find_map(|name| files::environment::program(name))
}

/// Waits for the decoder; returns true if it succeeded. Kills it if it takes too long.
fn within_time(mut child: Child) -> std::io::Result<bool> {
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if began.elapsed() > MOST_TIME {
            child.kill()?;
            child.wait()?;
            return Err(std::io::Error::other("it took more than a minute"));
        }
        std::thread::sleep(LOOK_AGAIN);
    }
}

/// Removes a PNG's ancillary chunks. The decoder has turned the image upright; preserved EXIF data would turn it again.
fn pixels_only(png: &[u8]) -> Vec<u8> {
    const SIGNATURE: usize = 8;
    let mut kept = png.get(..SIGNATURE).unwrap_or_default().to_vec();
    let mut rest = png.get(SIGNATURE..).unwrap_or_default();
    // Length, type, data and checksum of each chunk; the PNG decoder reports damage.
    while let Some((length, kind)) = rest.first_chunk::<8>().map(|head| head.split_at(4)) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let end = length.saturating_add(12).min(rest.len());
        // Critical chunks, needed for pixels, begin with a capital (PNG specification, 5.4); tRNS is transparency.
        if kind[0].is_ascii_uppercase() || kind == b"tRNS" {
            kept.extend_from_slice(&rest[..end]);
        }
        rest = &rest[end..];
    }
    kept
}

/// Returns the EXIF block of an HEIF file: a TIFF structure.
pub(super) fn exif(bytes: &[u8]) -> Option<Vec<u8>> {
    let read = exif::Reader::new().read_from_container(&mut std::io::Cursor::new(bytes));
    read.ok().map(|exif| exif.buf().to_vec())
}

/// Creates a folder that only this user may enter; it is removed when dropped.
fn own_folder() -> std::io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    builder.prefix("scaleproof-").tempdir()
}
