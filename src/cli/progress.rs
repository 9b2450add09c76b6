//! Progress on standard error; nothing is drawn when nobody watches.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar that counts photos.
pub fn photos(what: &str, count: usize) -> ProgressBar {
    bar(
        ProgressBar::new(count as u64),
        what,
        "{msg:<18} {bar:30} {pos}/{len} photos, {eta} left",
    )
}

/// A bar that counts frames, one whole picture after the other.
pub fn frames(what: &str, count: usize) -> ProgressBar {
    bar(
        ProgressBar::new(count as u64),
        what,
        "{msg:<18} {bar:30} {pos}/{len} frames, {eta} left",
    )
}

/// A bar that counts the seconds or the steps of a training; its message is how well it goes.
#[cfg(feature = "attack")]
pub fn training(is_time: bool, length: u64) -> ProgressBar {
    let unit = if is_time { "s" } else { "steps" };
    let template = format!("training {{bar:30}} {{pos}}/{{len}} {unit}, {{msg}}");
    bar(ProgressBar::new(length), "", &template)
}

/// A bar that counts the steps of a search.
pub fn steps(what: &str, count: usize) -> ProgressBar {
    bar(
        ProgressBar::new(count as u64),
        what,
        "{msg:<18} {bar:30} {pos}/{len} steps, {eta} left",
    )
}

/// A bar that counts the bytes of a download, whose length may become known later.
pub fn bytes(what: &str) -> ProgressBar {
    bar(
        ProgressBar::no_length(),
        what,
        "{msg:<18} {bar:30} {bytes} of {total_bytes}, {eta} left",
    )
}

fn bar(bar: ProgressBar, what: &str, template: &str) -> ProgressBar {
    // A template that does not parse would only cost the looks.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.with_style(style).with_message(what.to_owned())
}
