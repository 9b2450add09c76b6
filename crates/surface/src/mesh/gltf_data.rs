//! The bytes behind a glTF's surfaces and images: every view is read from its own buffer, which is the file's binary chunk, a data URI or a file
//! beside the mesh.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;
use gltf::json::Buffer;
use gltf::{Accessor, Document};
use percent_encoding::percent_decode_str;

use super::image::ImageSource;
use super::soup::{MAX_BYTES, Trouble};
use scaleproof_core::files;

/// Both names of the extension that packs views with meshoptimizer.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The buffers of a file; of one that cannot be read, the reason.
pub(super) struct Buffers(Vec<Result<Arc<[u8]>, String>>);

impl Buffers {
    pub(super) fn read(document: &Document, chunk: Option<Vec<u8>>, folder: &Path) -> Self {
        let (mut chunk, mut room) = (chunk, MAX_BYTES);
        let buffers = document.as_json().buffers.iter().enumerate();
        let buffers = buffers.map(|(i, buffer)| {
            // Only the first buffer is the chunk's, and a stand-in for unpacked data has no bytes (glTF 2.0, section 4.4.3.3).
            let chunk = chunk.take_if(|_| i == 0 && !is_stand_in(buffer));
            let bytes = content(buffer, chunk, folder, room)?;
            room = room.saturating_sub(bytes.len());
            let length = usize::try_from(buffer.byte_length.0).unwrap_or(usize::MAX);
            let whole = bytes.get(..length).map(Arc::from);
            whole.ok_or_else(|| format!("its buffer {i} has {} bytes of {length}", bytes.len()))
        });
        Self(buffers.collect())
    }

    /// Returns the buffer of a view, and the range of the view in it.
    ///
    /// # Errors
    /// A view that is packed, beyond its buffer's end, or of a buffer that cannot be read; as a clause.
    pub(super) fn view(&self, view: &View) -> Result<(&Arc<[u8]>, Range<usize>), String> {
        if MESHOPT.iter().any(|name| view.extension_value(name).is_some()) && self.of(view).is_err() {
            return Err("its data are packed by meshoptimizer; switch its compression off (gltfpack: without -c and -cc; gltf-transform: \
                        --compress false)"
                .into());
        }
        let bytes = self.of(view)?;
        let end = view
            .offset()
            .checked_add(view.length())
            .filter(|end| *end <= bytes.len());
        let end = end.ok_or("its data end too early")?;
        Ok((bytes, view.offset()..end))
    }

    fn of(&self, view: &View) -> Result<&Arc<[u8]>, String> {
        let buffer = self.0.get(view.buffer().index());
        buffer.ok_or("its data are nowhere")?.as_ref().map_err(Clone::clone)
    }

    /// Returns the bytes of each item of an accessor. The gltf crate's own readers trust offsets and counts, which damaged files have wrong.
    fn items<'a>(&'a self, accessor: &Accessor) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, Trouble> {
        let (Some(view), None) = (accessor.view(), accessor.sparse()) else {
            return Err(Trouble::damaged("it has sparse data, which this program does not read"));
        };
        let (bytes, range) = self.view(&view).map_err(Trouble::Damaged)?;
        let (size, count) = (accessor.size(), accessor.count());
        let stride = view.stride().unwrap_or(size).max(size);
        let past_the_end = || Trouble::damaged("its data end too early");
        let data = bytes[range].get(accessor.offset()..).ok_or_else(past_the_end)?;
        let needed = count.saturating_sub(1).checked_mul(stride);
        if count > 0 && needed.and_then(|n| n.checked_add(size)).is_none_or(|n| n > data.len()) {
            return Err(past_the_end());
        }
        Ok((0..count).map(move |i| &data[i * stride..i * stride + size]))
    }

    /// Returns tuples of numbers of any type.
    pub(super) fn tuples<'a, const N: usize>(
        &'a self,
        accessor: &Accessor,
    ) -> Result<impl Iterator<Item = [f64; N]> + use<'a, N>, Trouble> {
        let is_vector = matches!(
            (accessor.dimensions(), N),
            (Dimensions::Vec2, 2) | (Dimensions::Vec3, 3)
        );
        let number = number(accessor.data_type(), accessor.normalized()).filter(|_| is_vector);
        let number = number.ok_or_else(|| Trouble::Damaged(format!("it has no {N} numbers where it should")))?;
        let items = self.items(accessor)?;
        Ok(items.map(move |bytes| std::array::from_fn(|i| number(bytes, i))))
    }

    pub(super) fn indices(&self, accessor: &Accessor) -> Result<Vec<usize>, Trouble> {
        use DataType::{U8, U16, U32};
        let is_whole = matches!(accessor.data_type(), U8 | U16 | U32) && accessor.dimensions() == Dimensions::Scalar;
        let number = number(accessor.data_type(), false).filter(|_| is_whole);
        let number = number.ok_or_else(|| Trouble::damaged("indices are not single whole numbers"))?;
        Ok(self.items(accessor)?.map(|bytes| number(bytes, 0) as usize).collect())
    }
}

/// Returns true if a buffer has no bytes but stands for what packed views unpack to.
fn is_stand_in(buffer: &Buffer) -> bool {
    let extensions = buffer.extensions.as_ref().map(|extensions| &extensions.others);
    let is_fallback = |name: &&str| extensions?.get::<str>(name)?.get("fallback")?.as_bool();
    MESHOPT.iter().any(|name| is_fallback(name) == Some(true))
}

fn content(buffer: &Buffer, chunk: Option<Vec<u8>>, folder: &Path, room: usize) -> Result<Vec<u8>, String> {
    match (&buffer.uri, chunk) {
        (Some(uri), _) => match uri_content(uri, folder) {
            UriContent::Inside(bytes) => Ok(bytes),
            UriContent::Elsewhere(ImageSource::File(path)) => {
                files::read_at_most(&path, room as u64).map_err(|e| format!("its data are in another file, and {e}"))
            }
            _ => Err(
                "its data are in another file that is not named within the mesh's folder; save everything in one .glb"
                    .into(),
            ),
        },
        (None, Some(chunk)) => Ok(chunk),
        (None, None) => Err("its data are nowhere; save everything in one .glb".into()),
    }
}

/// Content of a URI of a glTF.
pub(super) enum UriContent {
    Inside(Vec<u8>),
    /// A data URI that is not base64.
    Unread,
    Elsewhere(ImageSource),
}

pub(super) fn uri_content(uri: &str, folder: &Path) -> UriContent {
    if !uri.starts_with("data:") {
        let name = percent_decode_str(uri).decode_utf8_lossy();
        return UriContent::Elsewhere(ImageSource::beside(folder, &name));
    }
    match uri.split_once(";base64,").map(|(_, text)| STANDARD.decode(text)) {
        Some(Ok(bytes)) => UriContent::Inside(bytes),
        _ => UriContent::Unread,
    }
}

/// Returns the function that reads the number with an index in some bytes. Normalised ones stand for 0 to 1, or -1 to 1 (glTF 2.0, section 3.6.2.2);
/// surfaces may have any type (`KHR_mesh_quantization`).
fn number(kind: DataType, normalized: bool) -> Option<fn(&[u8], usize) -> f64> {
    Some(match (kind, normalized) {
        (DataType::I8, true) => |b, i| (f64::from(b[i] as i8) / 127.0).max(-1.0),
        (DataType::U8, true) => |b, i| f64::from(b[i]) / 255.0,
        (DataType::I16, true) => |b, i| (f64::from(i16::from_le_bytes(at(b, i))) / 32767.0).max(-1.0),
        (DataType::U16, true) => |b, i| f64::from(u16::from_le_bytes(at(b, i))) / 65535.0,
        (DataType::U32, true) => return None,
        (DataType::I8, false) => |b, i| f64::from(b[i] as i8),
        (DataType::U8, false) => |b, i| f64::from(b[i]),
        (DataType::I16, false) => |b, i| f64::from(i16::from_le_bytes(at(b, i))),
        (DataType::U16, false) => |b, i| f64::from(u16::from_le_bytes(at(b, i))),
        (DataType::U32, false) => |b, i| f64::from(u32::from_le_bytes(at(b, i))),
        (DataType::F32, _) => |b, i| f64::from(f32::from_le_bytes(at(b, i))),
    })
}

fn at<const N: usize>(bytes: &[u8], i: usize) -> [u8; N] {
    std::array::from_fn(|k| bytes[N * i + k])
}
