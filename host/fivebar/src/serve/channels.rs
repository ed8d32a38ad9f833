//! What passes between the websockets and the controller's thread.
//!
//! Stops and signs of life do not pass through a queue ([`StopSignal`], [`ControlLease`]). Other
//! requests wait in one, a few of each page. Pages get the latest state, fault and job and
//! share their texts, so a page that reads slowly makes nobody wait and keeps no backlog.

use super::lease::{ControlLease, PageId};
use super::message::ClientRequest;
use super::stop_signal::StopSignal;
use super::updates::PageChannels;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast, watch};
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// Notices that may wait for a slow page before it loses the oldest ones.
const NOTICES: usize = 64;
/// Requests of one page that may wait for the controller's thread. Requests of all pages wait in one
/// queue: those of a page that floods would keep the others' waiting, on a port a round trip each.
const REQUESTS: usize = 32;
/// Pages that may be connected. With 400, an emergency stop took 94 to 218 ms.
const PAGES: usize = 32;

/// A page's connection.
#[derive(Debug)]
pub(super) struct Page {
    pub(super) id: PageId,
    connected: AtomicBool,
    places: Arc<Semaphore>,
    begun: Instant,
    /// See [`Page::received`] [µs after `begun`].
    received: AtomicU64,
}

impl Page {
    /// A connected page with a number of its own.
    pub(super) fn new() -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(1);
        Self {
            id: COUNT.fetch_add(1, Ordering::Relaxed),
            connected: AtomicBool::new(true),
            places: Arc::new(Semaphore::new(REQUESTS)),
            begun: Instant::now(),
            received: AtomicU64::new(0),
        }
    }

    /// A time at which the page certainly lived: its latest bytes arrived after it. What waited for
    /// the server, however long, counts for no later time.
    pub(super) fn received(&self) -> Instant {
        self.begun + Duration::from_micros(self.received.load(Ordering::SeqCst))
    }

    pub(super) fn set_received(&self, received: Instant) {
        let time = received.saturating_duration_since(self.begun);
        self.received
            .store(time.as_micros() as u64, Ordering::SeqCst);
    }

    pub(super) fn is_connected(&self) -> bool {
        self.connected.load(Ordering::SeqCst)
    }

    /// Ends the page's control at once. Its requests that still wait are dropped.
    pub(super) fn disconnect(&self, lease: &ControlLease) {
        self.connected.store(false, Ordering::SeqCst);
        lease.release(self.id);
    }
}

/// An event of a page.
#[derive(Debug)]
pub(super) struct Event {
    pub(super) page: Arc<Page>,
    pub(super) kind: EventKind,
    pub(super) received: Instant,
    /// How many stops had been asked for by then.
    pub(super) stops: u64,
    /// The event's place in the queue; none for the one event that every page has.
    _place: Option<OwnedSemaphorePermit>,
}

#[derive(Debug)]
pub(super) enum EventKind {
    /// The page has connected.
    Joined,
    /// The page makes a request.
    Request(ClientRequest),
    /// The page sends a long message, which can only be a job. It is not read yet, because that
    /// takes time.
    LongMessage(Utf8Bytes),
}

/// The queue is full, or the controller's thread has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QueueError {
    Full,
    Ended,
}

/// What both threads use without a queue.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) lease: ControlLease,
    pub(super) stop: StopSignal,
}

/// A notice, and the page that it is for; none: all pages.
pub(super) type Notice = (Option<PageId>, Utf8Bytes);
/// The latest message of a kind; none before the first.
pub(super) type Latest = Option<Utf8Bytes>;

/// The end at the websockets.
#[derive(Clone)]
pub(super) struct WebEnd {
    events: mpsc::Sender<Event>,
    pub(super) shared: Arc<Shared>,
    pub(super) state: watch::Receiver<Latest>,
    pub(super) fault: watch::Receiver<Latest>,
    pub(super) job: watch::Receiver<Latest>,
    pub(super) notices: broadcast::Sender<Notice>,
    /// A place for each page.
    pub(super) places: Arc<Semaphore>,
    /// One page may send a long message without being in control.
    pub(super) long_messages: Arc<Semaphore>,
}

/// The end at the controller's thread.
pub(super) struct ControllerEnd {
    pub(super) events: mpsc::Receiver<Event>,
    pub(super) shared: Arc<Shared>,
}

/// Makes both ends, and the channels for updates from the controller.
pub(super) fn channels() -> (WebEnd, ControllerEnd, PageChannels) {
    let (sender, events) = mpsc::channel();
    let (state, states) = watch::channel(None);
    let (fault, faults) = watch::channel(None);
    let (job, jobs) = watch::channel(None);
    let (notices, _) = broadcast::channel(NOTICES);
    let shared = Arc::new(Shared {
        lease: ControlLease::new(Instant::now()),
        stop: StopSignal::default(),
    });
    let web = WebEnd {
        events: sender,
        shared: Arc::clone(&shared),
        state: states,
        fault: faults,
        job: jobs,
        notices: notices.clone(),
        places: Arc::new(Semaphore::new(PAGES)),
        long_messages: Arc::new(Semaphore::new(1)),
    };
    let pages = PageChannels {
        state,
        fault,
        job,
        notices,
    };
    (web, ControllerEnd { events, shared }, pages)
}

impl WebEnd {
    /// Announces a page.
    pub(super) fn join(&self, page: &Arc<Page>) -> Result<(), QueueError> {
        self.send(page, EventKind::Joined, None)
    }

    /// Queues an event of a page.
    pub(super) fn queue(&self, page: &Arc<Page>, kind: EventKind) -> Result<(), QueueError> {
        let place = Arc::clone(&page.places).try_acquire_owned();
        self.send(page, kind, Some(place.map_err(|_| QueueError::Full)?))
    }

    fn send(
        &self,
        page: &Arc<Page>,
        kind: EventKind,
        place: Option<OwnedSemaphorePermit>,
    ) -> Result<(), QueueError> {
        let event = Event {
            page: Arc::clone(page),
            kind,
            received: Instant::now(),
            stops: self.shared.stop.count(),
            _place: place,
        };
        self.events.send(event).map_err(|_| QueueError::Ended)
    }
}

#[cfg(test)]
mod tests {
    use super::{EventKind, Page, QueueError, REQUESTS, channels};
    use crate::serve::message::ClientRequest;
    use std::sync::Arc;

    #[test]
    fn a_page_that_floods_fills_its_own_places_only() {
        let (web, controller, _updates) = channels();
        let [flooding, other] = [Page::new(), Page::new()].map(Arc::new);
        let request = || EventKind::Request(ClientRequest::Run);
        for _ in 0..REQUESTS {
            assert_eq!(web.queue(&flooding, request()), Ok(()));
        }
        assert_eq!(web.queue(&flooding, request()), Err(QueueError::Full));
        assert_eq!(web.queue(&other, request()), Ok(()));
        drop(controller.events.recv());
        assert_eq!(web.queue(&flooding, request()), Ok(()), "one was handled");
    }
}
