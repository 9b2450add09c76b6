//! Programs that find objects in photos, and as many of each as may run side by side.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitStatus;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use image::RgbImage;

use super::answer::{self, NoAnswer};
use super::child::{Child, Silence};
use super::error::{ProgramError, untrusted};
use super::groups::lock;
use super::hello::{Gradients, Hello, InputRule};
use super::spec::ProgramSpec;
use crate::{Detection, ForeignCard, ForeignKind};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, message};

/// A photo for a program.
pub struct ProgramPhoto<'a> {
    pub path: &'a Path,
    /// Name in messages.
    pub file: &'a str,
    /// Width and height of the upright photo, px.
    pub size: [u32; 2],
    /// Its pixels at full size, where [`ProgramDetector::takes_pixels`].
    pub pixels: Option<&'a RgbImage>,
}

/// An image whose loss and gradient a program is asked for.
pub struct ProgramImage<'a> {
    /// sRGB, 0 to 1, row by row.
    pub pixels: &'a [[f64; 3]],
    /// Width, height, px.
    pub size: [u32; 2],
    pub model: BoxPx,
    /// Boxes that overlap it less do not meet it.
    pub least_iou: f64,
    pub labels: &'a [usize],
}

/// The loss of an image, and its derivative by each value.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramLoss {
    pub loss: f64,
    pub gradient: Vec<[f64; 3]>,
}

/// Reads the first line of a program.
type ReadHello = fn(&str) -> Result<Hello, String>;

/// A program that answers with boxes, and as many of it as may run side by side.
#[derive(Debug)]
pub struct ProgramDetector {
    spec: ProgramSpec,
    read_hello: ReadHello,
    hello: Hello,
    card: ForeignCard,
    pub(super) limit: Duration,
    asked: AtomicU64,
    pool: Mutex<Pool>,
    freed: Condvar,
    /// Answers of this run, by the SHA-256 of the photo.
    answers: Mutex<BTreeMap<String, Vec<Detection>>>,
}

#[derive(Debug, Default)]
struct Pool {
    idle: Vec<Child>,
    running: usize,
    /// Why no photo is looked at any more.
    failed: Option<Arc<ProgramError>>,
}

impl ProgramDetector {
    /// Starts a program and hears what it is. It gets `limit` for each thing that it says.
    pub fn open(spec: ProgramSpec, limit: Duration) -> Result<ProgramDetector, ProgramError> {
        Self::open_as(Hello::parse, spec, limit)
    }

    pub(super) fn open_as(
        read_hello: ReadHello,
        spec: ProgramSpec,
        limit: Duration,
    ) -> Result<ProgramDetector, ProgramError> {
        let (child, hello) = start(read_hello, &spec, limit)?;
        let card = card(&spec, &hello)?;
        let pool = Pool {
            idle: vec![child],
            running: 1,
            ..Pool::default()
        };
        Ok(ProgramDetector {
            spec,
            read_hello,
            hello,
            card,
            limit,
            asked: AtomicU64::new(0),
            pool: Mutex::new(pool),
            freed: Condvar::new(),
            answers: Mutex::default(),
        })
    }

    pub fn card(&self) -> &ForeignCard {
        &self.card
    }

    pub fn is_deterministic(&self) -> bool {
        self.hello.deterministic
    }

    /// Returns whether it is fed with pixels, else with paths.
    pub fn takes_pixels(&self) -> bool {
        self.hello.input == InputRule::Rgb
    }

    /// Returns what [`ProgramDetector::loss_and_gradient`] gives.
    pub fn gradients(&self) -> Gradients {
        self.hello.gradients
    }

    /// Returns the detections in a photo, best first.
    pub fn detect(&self, photo: &ProgramPhoto) -> Result<Vec<Detection>, ProgramError> {
        let id = self.next_id();
        self.ask(photo.file, self.request(id, photo)?, |line, _| {
            Ok(answer::detections(line, id, photo.size, self.hello.labels))
        })
    }

    /// Returns its answer for a photo in this run, by the SHA-256 of its file: a session that is scored again after each photo keeps earlier answers, whatever the program
    /// would say now.
    pub fn answered(&self, sha256: &str) -> Option<Vec<Detection>> {
        lock(&self.answers).get(sha256).cloned()
    }

    /// Remembers an answer for [`ProgramDetector::answered`].
    pub fn remember(&self, sha256: &str, found: &[Detection]) {
        lock(&self.answers).insert(sha256.to_owned(), found.to_vec());
    }

    /// The loss `−ln(1 − C)` of the surest box that meets the model in an image, and its derivative; `None` where none meets it.
    pub fn loss_and_gradient(&self, image: &ProgramImage) -> Result<Option<ProgramLoss>, ProgramError> {
        let (id, [width, height]) = (self.next_id(), image.size);
        let pixels = image.pixels.iter().flatten().flat_map(|v| (*v as f32).to_le_bytes());
        let pixels: Vec<u8> = pixels.collect();
        let count = pixels.len();
        let line = serde_json::json!({
            "id": id, "task": "loss_and_gradient", "width": width, "height": height, "bytes": count,
            "box": <[f64; 4]>::from(image.model), "least_iou": image.least_iou, "labels": image.labels,
        });
        let message = [line.to_string().as_bytes(), b"\n", &pixels].concat();
        self.ask("an image", message, |line, child| {
            let loss = match answer::loss(line, id, image.size) {
                Ok(Some(loss)) => loss,
                nothing => return Ok(nothing.map(|_| None)),
            };
            let gradient = answer::derivatives(&child.read(Some(count), self.limit)?, width);
            Ok(gradient.map(|gradient| Some(ProgramLoss { loss, gradient })))
        })
    }

    /// The number of the next request.
    pub(super) fn next_id(&self) -> u64 {
        self.asked.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Sends a request about something to a program that has nothing to do, and reads its answer.
    pub(super) fn ask<T>(
        &self,
        about: &str,
        request: Vec<u8>,
        read: impl FnOnce(&str, &mut Child) -> Result<Result<T, NoAnswer>, Silence>,
    ) -> Result<T, ProgramError> {
        let mut child = self.lease()?;
        let line = child.send(request).and_then(|()| child.line(self.limit));
        let answer = line.and_then(|line| read(&line, &mut child));
        let detector = &self.card.name;
        let fault = match answer {
            Err(silence) => {
                let when = format!("before it answered about {about}");
                explained(&self.spec, child, silence, self.limit, when)
            }
            Ok(Err(NoAnswer::Fault(fault))) => {
                drop(child.post_mortem());
                untrusted(detector, about, fault)
            }
            Ok(usable) => {
                lock(&self.pool).idle.push(child);
                self.freed.notify_one();
                return usable.map_err(|why| {
                    let (NoAnswer::Declined(sentence) | NoAnswer::Fault(sentence)) = why;
                    ProgramError::Declined(message!("{detector} gives no answer: {sentence}"))
                });
            }
        };
        Err(self.lost(fault.into()))
    }

    /// A program that has nothing to do.
    fn lease(&self) -> Result<Child, ProgramError> {
        let mut pool = lock(&self.pool);
        loop {
            if let Some(error) = &pool.failed {
                return Err(ProgramError::Lost(Arc::clone(error)));
            }
            if let Some(child) = pool.idle.pop() {
                return Ok(child);
            }
            if pool.running < self.hello.workers {
                pool.running += 1;
                break;
            }
            pool = self.freed.wait(pool).unwrap_or_else(PoisonError::into_inner);
        }
        drop(pool);
        let (child, hello) = start(self.read_hello, &self.spec, self.limit).map_err(|e| self.lost(e.into()))?;
        if hello == self.hello {
            Ok(child)
        } else {
            let detector = &self.card.name;
            let fault =
                message!("{detector} started another time is another program: its hello must always be the same");
            Err(self.lost(fault.into()))
        }
    }

    /// After an error no photo is looked at any more, and nobody waits for a program.
    fn lost(&self, error: ProgramError) -> ProgramError {
        let error = Arc::new(error);
        lock(&self.pool).failed.get_or_insert(Arc::clone(&error));
        self.freed.notify_all();
        ProgramError::Lost(error)
    }

    fn request(&self, id: u64, photo: &ProgramPhoto) -> Result<Vec<u8>, ProgramError> {
        let [width, height] = photo.size;
        let mut line = serde_json::json!({"id": id, "task": "detect", "width": width, "height": height});
        let mut pixels = &[][..];
        if self.takes_pixels() {
            pixels = photo.pixels.map_or(pixels, |pixels| pixels.as_raw());
            line["bytes"] = pixels.len().into();
        } else {
            line["path"] = files::whole_path(photo.path)?.to_string_lossy().into();
        }
        Ok([line.to_string().as_bytes(), b"\n", pixels].concat())
    }
}

fn start(read_hello: ReadHello, spec: &ProgramSpec, limit: Duration) -> Result<(Child, Hello), Message> {
    let command = spec.in_words();
    let mut child = Child::start(&spec.command, spec.folder.as_deref())
        .map_err(|e| message!("cannot start `{command}`: {}{}", files::plain(&e), spec.instead()))?;
    let line = match child.line(limit) {
        Ok(line) => line,
        Err(silence) => return Err(explained(spec, child, silence, limit, "before its hello".into())),
    };
    match read_hello(&line) {
        Ok(hello) => Ok((child, hello)),
        Err(fault) => {
            drop(child.post_mortem());
            Err(unusable(&command, &fault))
        }
    }
}

fn unusable(command: &str, fault: &str) -> Message {
    message!("`{command}` cannot be used: {fault}")
}

/// Says why a program wrote nothing that can be read; `when`: as in "before it answered about a.jpg".
fn explained(spec: &ProgramSpec, child: Child, silence: Silence, limit: Duration, when: String) -> Message {
    let command = spec.in_words();
    let (status, words) = child.post_mortem();
    let how = match (silence, status) {
        (Silence::TooLong, _) => {
            let seconds = limit.as_secs_f64();
            let fault = message!("`{command}` has not said anything within {seconds} s {when} and was stopped");
            return fault.hint("give it more time by ‹detector_timeout›");
        }
        (Silence::Unread, _) => return unusable(&command, "it answers without reading its requests"),
        (Silence::HugeLine, _) => "wrote a line that has no end".to_owned(),
        (Silence::NoText, _) => "wrote what is no UTF-8 text".to_owned(),
        (Silence::Ended, None) => "ended".to_owned(),
        (Silence::Ended, Some(status)) => match status.code() {
            Some(code) => format!("ended with exit code {code}"),
            None => format!("was {}", signalled(status)),
        },
    };
    let words = words.map_or_else(String::new, |words| format!("; its last words: {words}"));
    message!("`{command}` {how} {when}{words}")
}

/// Says how a program without an exit code ended.
fn signalled(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("ended by signal {signal}");
    }
    format!("ended ({status})")
}

/// Creates the card of a program: what it says, what its manifest says, and the files of both.
fn card(spec: &ProgramSpec, hello: &Hello) -> Result<ForeignCard, FileError> {
    let own = |text: &Option<String>, of_hello: &Option<String>| text.clone().or_else(|| of_hello.clone());
    let name = spec.name.clone().unwrap_or_else(|| hello.name.clone());
    let mut seen: Vec<(String, String)> = Vec::new();
    for path in (spec.files().into_iter()).chain(hello.files.iter().map(|file| spec.seen(file))) {
        let hashed = files::hashed(&path)?;
        if !seen.contains(&hashed) {
            seen.push(hashed);
        }
    }
    let doubt =
        format!("{name} does not say that it answers alike each time, so that another run may give other figures");
    let notes = if hello.deterministic { Vec::new() } else { vec![doubt] };
    Ok(ForeignCard {
        kind: ForeignKind::Program,
        title: own(&spec.title, &hello.title).unwrap_or_else(|| name.clone()),
        licence: own(&spec.licence, &hello.licence).unwrap_or_else(|| "not stated".into()),
        origin: own(&spec.origin, &hello.origin).unwrap_or_else(|| "a program".into()),
        version: Some(hello.version.clone()),
        command: spec.command.clone(),
        labels: hello.labels,
        class_map: spec.class_map.clone(),
        files: seen,
        notes,
        name,
    })
}
