//! Images of AprilTags, drawn by the C AprilTag library, so that no table of codes is kept twice.

use std::ptr::NonNull;

use apriltag_sys as sys;

use super::Modules;
use crate::scene::TagFamily;

/// Image of one tag, with the white ring that a detector needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TagImage {
    modules: Modules,
    border: usize,
}

impl TagImage {
    /// Draws the image of a tag; `None` for an id its family does not have, or if the C library has no memory.
    pub fn new(family: TagFamily, id: u32) -> Option<TagImage> {
        let c = CFamily::new(family)?;
        let drawn = c.modules(id)?;
        // All but the classic families have bits outside their border, up to the image's edge; the white ring is added here.
        let ring = usize::from(c.raw().reversed_border);
        Some(TagImage {
            modules: drawn.framed(ring, false),
            border: usize::try_from(c.raw().width_at_border).ok()?,
        })
    }

    /// Returns the tag inside a ring of white modules.
    pub fn modules(&self) -> &Modules {
        &self.modules
    }

    /// Returns the width in modules of the square whose corners a detector gives: a scene's `size_mm`.
    pub fn border_modules(&self) -> usize {
        self.border
    }

    /// Returns the width of the whole image, white ring included, of a tag of `size_mm`.
    pub fn width_mm(&self, size_mm: f64) -> f64 {
        size_mm * self.modules.side() as f64 / self.border as f64
    }
}

type Create = unsafe extern "C" fn() -> *mut sys::apriltag_family_t;
type Destroy = unsafe extern "C" fn(*mut sys::apriltag_family_t);

/// Family of the C library; the only place that calls the library without the `apriltag` crate.
struct CFamily {
    family: NonNull<sys::apriltag_family_t>,
    destroy: Destroy,
}

impl CFamily {
    fn new(family: TagFamily) -> Option<Self> {
        let (create, destroy): (Create, Destroy) = match family {
            TagFamily::Tag16h5 => (sys::tag16h5_create, sys::tag16h5_destroy),
            TagFamily::Tag25h9 => (sys::tag25h9_create, sys::tag25h9_destroy),
            TagFamily::Tag36h11 => (sys::tag36h11_create, sys::tag36h11_destroy),
            TagFamily::TagStandard41h12 => (sys::tagStandard41h12_create, sys::tagStandard41h12_destroy),
            TagFamily::TagStandard52h13 => (sys::tagStandard52h13_create, sys::tagStandard52h13_destroy),
            TagFamily::TagCircle21h7 => (sys::tagCircle21h7_create, sys::tagCircle21h7_destroy),
            TagFamily::TagCircle49h12 => (sys::tagCircle49h12_create, sys::tagCircle49h12_destroy),
            TagFamily::TagCustom48h12 => (sys::tagCustom48h12_create, sys::tagCustom48h12_destroy),
        };
        // SAFETY: the `create` functions take nothing and return a family that their own `destroy` frees, or null.
        let family = unsafe { create() };
        NonNull::new(family).map(|family| Self { family, destroy })
    }

    fn raw(&self) -> &sys::apriltag_family_t {
        // SAFETY: not null, made by `create`, and alive until `drop`.
        unsafe { self.family.as_ref() }
    }

    fn modules(&self, id: u32) -> Option<Modules> {
        if id >= self.raw().ncodes {
            return None; // the C function would end the program
        }
        let id = i32::try_from(id).ok()?;
        // SAFETY: the family is alive and has this id; the image returned, unless null, is ours to destroy.
        let image = NonNull::new(unsafe { sys::apriltag_to_image(self.family.as_ptr(), id) })?;
        let modules = copied(image);
        // SAFETY: made by the library just now and not used afterwards.
        unsafe { sys::image_u8_destroy(image.as_ptr()) };
        modules
    }
}

impl Drop for CFamily {
    fn drop(&mut self) {
        // SAFETY: made by the matching `create`, destroyed once.
        unsafe { (self.destroy)(self.family.as_ptr()) };
    }
}

fn copied(image: NonNull<sys::image_u8_t>) -> Option<Modules> {
    // SAFETY: the library has just made this image: `height` lines of `stride` bytes, `width` of which are image.
    let ([width, height, stride], bytes) = unsafe {
        let image = image.as_ref();
        let sizes = [image.width, image.height, image.stride].map(|n| usize::try_from(n).unwrap_or(0));
        (sizes, std::slice::from_raw_parts(image.buf, sizes[1] * sizes[2]))
    };
    (width == height && width <= stride).then(|| Modules::new(width, |row, column| bytes[row * stride + column] == 0))
}
