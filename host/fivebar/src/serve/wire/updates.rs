//! What the controller's thread sends to the pages, past every lock.
//!
//! The channels that wake the pages' threads have locks. A page's thread that lost the processor
//! while it held one kept the controller's thread waiting, and with it a stop, for up to 0.3 s. So a
//! thread of its own passes the updates on: the controller's thread adds them to a queue without a lock
//! and wakes it.

use super::channels::{Notice, PageChannels};
use super::message::ServerMessage;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::{self, Thread};
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// A message as text.
enum Item {
    State(Utf8Bytes),
    Fault(Utf8Bytes),
    Job(Utf8Bytes),
    Notice(Notice),
}

impl PageChannels {
    /// May wait for the pages' threads.
    fn pass_on(&self, item: Item) {
        match item {
            Item::State(text) => drop(self.state.send_replace(Some(text))),
            Item::Fault(text) => drop(self.fault.send_replace(Some(text))),
            Item::Job(text) => drop(self.job.send_replace(Some(text))),
            // This fails only if no page is connected.
            Item::Notice(notice) => drop(self.notices.send(notice)),
        }
    }
}

/// The end at the controller's thread. It never waits.
pub(in crate::serve) struct Updates {
    queue: Sender<Item>,
    // After the queue, whose end it makes known.
    thread: Wake,
}

/// Wakes the thread once more when nothing else will.
struct Wake(Thread);

impl Drop for Wake {
    fn drop(&mut self) {
        self.0.unpark();
    }
}

impl Updates {
    /// Starts the thread, which ends with this value.
    pub(in crate::serve) fn start(pages: PageChannels) -> Self {
        let (queue, items) = channel();
        let thread = thread::spawn(move || pass_on(&items, &pages));
        Self {
            queue,
            thread: Wake(thread.thread().clone()),
        }
    }

    /// Sends a message to its page, or to all pages.
    pub(in crate::serve) fn send(&self, message: &ServerMessage<'_>) {
        let text = message.json();
        self.queue(match message {
            ServerMessage::State(_) | ServerMessage::Guide(_) => Item::State(text),
            ServerMessage::Fault(_) => Item::Fault(text),
            ServerMessage::Job(_) => Item::Job(text),
            ServerMessage::Notice { to, .. } => Item::Notice((*to, text)),
            ServerMessage::Console { to, .. }
            | ServerMessage::Line { to, .. }
            | ServerMessage::Answer { to, .. } => Item::Notice((Some(*to), text)),
            ServerMessage::Stopped(_) => Item::Notice((None, text)),
        });
    }

    /// Sends a job's message to all pages, and later to each page that connects.
    pub(in crate::serve) fn send_job(&self, message: Utf8Bytes) {
        self.queue(Item::Job(message));
    }

    fn queue(&self, item: Item) {
        // The thread outlives this value.
        let _ = self.queue.send(item);
        self.thread.0.unpark();
    }
}

/// Passes updates on until their queue ends. It never waits in the queue, which would take a lock.
fn pass_on(items: &Receiver<Item>, pages: &PageChannels) {
    loop {
        match items.try_recv() {
            Ok(item) => {
                pages.pass_on(item);
            }
            Err(TryRecvError::Empty) => thread::park(),
            Err(TryRecvError::Disconnected) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Updates;
    use crate::serve::wire::channels::channels;
    use crate::serve::wire::message::ServerMessage;
    use fivebar_sim::clock::Clock;
    use std::sync::mpsc;
    use std::time::{Duration, Instant};

    /// Many more than pages look at before the lock is free.
    const UPDATES: usize = 640;

    fn until(wanted: impl Fn() -> bool) {
        let start = Instant::now();
        while !wanted() {
            assert!(start.elapsed() < Duration::from_secs(20), "it takes long");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_page_that_holds_a_lock_makes_the_controllers_thread_wait_for_nothing() {
        let (web, _controller, pages) = channels(Clock::simulated());
        let held = web.job.borrow();
        let (sent, done) = mpsc::channel();
        let sender = std::thread::spawn(move || {
            let updates = Updates::start(pages);
            for number in 0..UPDATES {
                updates.send_job(number.to_string().into());
            }
            sent.send(()).expect("a test");
            updates
        });
        let in_time = done.recv_timeout(Duration::from_secs(20));
        drop(held);
        in_time.expect("updates are sent while a page holds the lock");
        let last = (UPDATES - 1).to_string();
        until(|| {
            web.job
                .borrow()
                .as_ref()
                .is_some_and(|text| **text == *last)
        });
        drop(sender.join());
        until(|| web.job.has_changed().is_err());
    }

    #[test]
    fn updates_of_each_kind_arrive_where_pages_look_for_them() {
        let (web, _controller, pages) = channels(Clock::simulated());
        let mut notices = web.notices.subscribe();
        let updates = Updates::start(pages);
        updates.send(&ServerMessage::Fault(None));
        updates.send(&ServerMessage::Notice {
            to: Some(7),
            refused: true,
            text: "no".into(),
        });
        let (to, text) = notices.blocking_recv().expect("a notice");
        assert!(to == Some(7) && text.contains("no"));
        assert!(web.fault.borrow().is_some() && web.job.borrow().is_none());
    }
}
