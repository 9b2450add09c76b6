//! Common ways in which a manifest feeds or reads a network otherwise than its origin.

use scaleproof_detect::{Channels, Kernel, Manifest, Pad, Resize, wants_photo_size};

pub struct Feeding {
    pub what: String,
    pub manifest: Manifest,
    /// Number of entries by which its labels are shifted down the list.
    pub shift: i64,
}

/// Mean and standard deviation that networks were trained with, for red, green and blue.
const USUAL_VALUES: [(&str, [f32; 3], [f32; 3]); 4] = [
    ("values 0 to 255", [0.0; 3], [1.0; 3]),
    ("values 0 to 1", [0.0; 3], [255.0; 3]),
    ("values −1 to 1", [127.5; 3], [127.5; 3]),
    (
        "values normalised as ImageNet's",
        [123.675, 116.28, 103.53],
        [58.395, 57.12, 57.375],
    ),
];

const RESIZES: [(Resize, &str); 4] = [
    (Resize::Stretch, "resize stretch"),
    (Resize::LetterboxTopLeft, "resize letterbox_top_left"),
    (Resize::LetterboxCentre, "resize letterbox_centre"),
    (Resize::LetterboxCentreRounded, "resize letterbox_centre_rounded"),
];

/// Returns every single change that is worth a trial.
pub fn feedings(manifest: &Manifest) -> Vec<Feeding> {
    let mut found = Vec::new();
    let mut with = |what: &str, shift: i64, change: &dyn Fn(&mut Manifest)| {
        let mut manifest = manifest.clone();
        change(&mut manifest);
        let what = what.to_owned();
        found.push(Feeding { what, manifest, shift });
    };
    let input = &manifest.input;
    let (other, name) = match input.channels {
        Channels::Rgb => (Channels::Bgr, "channels bgr"),
        Channels::Bgr => (Channels::Rgb, "channels rgb"),
    };
    with(name, 0, &|m| m.input.channels = other);
    for (what, mean, std) in USUAL_VALUES {
        let (mut mean, mut std) = (mean, std);
        if input.channels == Channels::Bgr {
            mean.reverse();
            std.reverse();
        }
        if (mean, std) != (input.mean, input.std) {
            with(what, 0, &|m| (m.input.mean, m.input.std) = (mean, std));
        }
    }
    // A head whose boxes are in pixels of the photo does not undo a letterbox.
    let is_tried = RESIZES.iter().any(|(resize, _)| *resize == input.resize) && !wants_photo_size(&manifest.head);
    let was_stretched = input.resize == Resize::Stretch;
    let others = RESIZES
        .into_iter()
        .filter(|(resize, _)| is_tried && *resize != input.resize);
    for (resize, what) in others {
        with(what, 0, &|m| {
            m.input.resize = resize;
            // A stretched photo has no border; most programs fill theirs with this.
            if was_stretched {
                m.input.pad = Pad::Grey(114);
            }
        });
    }
    for (pad, what) in [(0, "pad 0"), (114, "pad 114"), (128, "pad 128")] {
        let pad = Pad::Grey(pad);
        if is_tried && !was_stretched && pad != input.pad {
            with(what, 0, &|m| m.input.pad = pad);
        }
    }
    let (other, name) = match input.kernel {
        Kernel::OpencvLinear | Kernel::OpencvCubic => (Kernel::Antialiased, "kernel antialiased"),
        Kernel::Antialiased => (Kernel::OpencvLinear, "kernel opencv_linear"),
    };
    with(name, 0, &|m| m.input.kernel = other);
    if let Some((other, what)) = manifest.head.with_other_labels() {
        with(what, 0, &|m| m.head = other.clone());
    }
    with("labels one entry further down", 1, &|_| ());
    with("labels one entry further up", -1, &|_| ());
    found
}
