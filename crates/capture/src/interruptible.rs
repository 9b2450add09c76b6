//! A source of frames that can be given up while it waits.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::{CameraSettings, FrameSource, SourceError, SourceFrame};

/// A frame of a source with the settings of its camera; `None` when there will be no more.
type SourceItem = Result<Option<(SourceFrame, Option<CameraSettings>)>, SourceError>;

/// Registers something that is called once, when the user interrupts the program.
pub type OnInterrupt<'a> = &'a dyn Fn(Box<dyn FnOnce() + Send>);

enum InterruptEvent {
    SourceItem(Box<SourceItem>),
    Interrupted,
}

/// Sender that reports the end of the source's thread when dropped, by a panic too, which was reported by then.
struct EndNotice(Sender<InterruptEvent>);

impl Drop for EndNotice {
    fn drop(&mut self) {
        let _ = self.0.send(InterruptEvent::SourceItem(Box::new(Ok(None))));
    }
}

/// A source that is asked from a thread of its own, so that an interruption is heard while it waits.
pub(crate) struct Interruptible {
    ask: Sender<()>,
    events: Receiver<InterruptEvent>,
    was_interrupted: bool,
}

impl Interruptible {
    /// Starts the source's thread. A source that waits for ever is left behind in it when the program ends.
    pub(crate) fn new(mut source: Box<dyn FrameSource + Send>, on_interrupt: OnInterrupt) -> Interruptible {
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
        on_interrupt(Box::new(move || drop(interrupt.send(InterruptEvent::Interrupted))));
        Interruptible {
            ask,
            events,
            was_interrupted: false,
        }
    }

    /// Waits for the next frame; `None` when there will be no more, also after an interruption.
    ///
    /// # Errors
    /// The source is gone.
    pub(crate) fn next(&mut self) -> SourceItem {
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

    pub(crate) fn was_interrupted(&self) -> bool {
        self.was_interrupted
    }
}
