//! Ctrl-C while a capture waits: the first ends it as when the source ends, the second at once.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::cli::full::interrupt::on_interrupt;
use scaleproof_capture::{CameraSettings, FrameSource, SourceError, SourceFrame};

/// What a source gave, and what its camera is set to.
type SourceItem = Result<Option<(SourceFrame, Option<CameraSettings>)>, SourceError>;

enum InterruptEvent {
    SourceItem(Box<SourceItem>),
    Interrupted,
}

/// Says that there will be no more when the source's thread ends, by a panic too, which was reported by then.
struct EndNotice(Sender<InterruptEvent>);

impl Drop for EndNotice {
    fn drop(&mut self) {
        let _ = self.0.send(InterruptEvent::SourceItem(Box::new(Ok(None))));
    }
}

/// A source that is asked from a thread of its own, so that Ctrl-C is heard while it waits.
pub(super) struct Interruptible {
    ask: Sender<()>,
    events: Receiver<InterruptEvent>,
    was_interrupted: bool,
}

impl Interruptible {
    /// A source that waits for ever is left behind in its thread when the program ends.
    pub(super) fn new(mut source: Box<dyn FrameSource + Send>) -> Interruptible {
        let (ask, asked) = channel();
        let (tell, events) = channel();
        let interrupt = tell.clone();
        std::thread::spawn(move || {
            let tell = EndNotice(tell);
            while asked.recv().is_ok() {
                let given = source.next().map(|frame| frame.map(|frame| (frame, source.settings())));
                if tell.0.send(InterruptEvent::SourceItem(Box::new(given))).is_err() {
                    break;
                }
            }
        });
        on_interrupt(move || drop(interrupt.send(InterruptEvent::Interrupted)));
        Interruptible {
            ask,
            events,
            was_interrupted: false,
        }
    }

    /// The next frame, waited for; `None` when there will be no more, also after Ctrl-C.
    ///
    /// # Errors
    /// The source is gone.
    pub(super) fn next(&mut self) -> SourceItem {
        if self.was_interrupted || self.ask.send(()).is_err() {
            return Ok(None);
        }
        match self.events.recv() {
            Ok(InterruptEvent::SourceItem(given)) => *given,
            Ok(InterruptEvent::Interrupted) => {
                self.was_interrupted = true;
                Ok(None)
            }
            Err(_) => Ok(None),
        }
    }

    /// Whether Ctrl-C ended it.
    pub(super) fn was_interrupted(&self) -> bool {
        self.was_interrupted
    }
}
