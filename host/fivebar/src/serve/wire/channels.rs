//! What passes between the websockets and the controller's thread.
//!
//! Stops and signs of life do not pass through a queue ([`StopSignal`], [`ControlLease`]). Other
//! requests wait in one, a few of each page. Pages get the latest state, fault and job and
//! share their texts, so a page that reads slowly makes nobody wait and keeps no backlog.

use super::lease::{ControlLease, Page, PageId};
use super::numbered::NumberedRequest;
use super::stop_signal::StopSignal;
use fivebar_sim::clock::Clock;
use std::sync::{Arc, mpsc};
use std::time::Instant;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast, watch};
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// Notices that may wait for a slow page before it loses the oldest ones.
const NOTICES: usize = 64;
/// Pages that may be connected. With 400, an emergency stop took 94 to 218 ms.
const PAGES: usize = 32;

/// An event of a page.
#[derive(Debug)]
pub(in crate::serve) struct Event {
    pub(in crate::serve) page: Arc<Page>,
    pub(in crate::serve) kind: EventKind,
    pub(in crate::serve) received: Instant,
    /// A time at which the page certainly lived ([`Page::received`]).
    pub(in crate::serve) lived: Instant,
    /// How many stops had been asked for by then.
    pub(in crate::serve) stops: u64,
    /// The event's place in the queue; none for the one event that every page has.
    _place: Option<OwnedSemaphorePermit>,
}

#[derive(Debug)]
pub(in crate::serve) enum EventKind {
    /// The page has connected.
    Joined,
    /// The page makes a request.
    Request(NumberedRequest),
    /// The page sends a long message, which can only be a job. It is not read yet, because that
    /// takes time.
    LongMessage(Utf8Bytes),
}

/// The queue is full, or the controller's thread has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::serve) enum QueueError {
    Full,
    Ended,
}

/// What both threads use without a queue.
#[derive(Debug)]
pub(in crate::serve) struct Shared {
    pub(in crate::serve) lease: ControlLease,
    pub(in crate::serve) stop: StopSignal,
    pub(in crate::serve) clock: Clock,
}

/// A notice, and the page that it is for; none: all pages.
pub(in crate::serve) type Notice = (Option<PageId>, Utf8Bytes);
/// The latest message of a kind; none before the first.
pub(in crate::serve) type Latest = Option<Utf8Bytes>;

/// The end at the websockets.
#[derive(Clone)]
pub(in crate::serve) struct WebEnd {
    events: mpsc::Sender<Event>,
    pub(in crate::serve) shared: Arc<Shared>,
    pub(in crate::serve) state: watch::Receiver<Latest>,
    pub(in crate::serve) fault: watch::Receiver<Latest>,
    pub(in crate::serve) job: watch::Receiver<Latest>,
    pub(in crate::serve) notices: broadcast::Sender<Notice>,
    /// A place for each page.
    pub(in crate::serve) places: Arc<Semaphore>,
    /// One page may send a long message without being in control.
    pub(in crate::serve) long_messages: Arc<Semaphore>,
}

/// The end at the controller's thread.
pub(in crate::serve) struct ControllerEnd {
    pub(in crate::serve) events: mpsc::Receiver<Event>,
    pub(in crate::serve) shared: Arc<Shared>,
}

/// The channels to the pages.
pub(in crate::serve) struct PageChannels {
    pub(in crate::serve) state: watch::Sender<Latest>,
    pub(in crate::serve) fault: watch::Sender<Latest>,
    pub(in crate::serve) job: watch::Sender<Latest>,
    pub(in crate::serve) notices: broadcast::Sender<Notice>,
}

/// Makes both ends, and the channels for updates from the controller.
pub(in crate::serve) fn channels(clock: Clock) -> (WebEnd, ControllerEnd, PageChannels) {
    let (sender, events) = mpsc::channel();
    let (state, states) = watch::channel(None);
    let (fault, faults) = watch::channel(None);
    let (job, jobs) = watch::channel(None);
    let (notices, _) = broadcast::channel(NOTICES);
    let shared = Arc::new(Shared {
        lease: ControlLease::new(clock.now()),
        stop: StopSignal::default(),
        clock,
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
    pub(in crate::serve) fn join(&self, page: &Arc<Page>) -> Result<(), QueueError> {
        self.send(page, EventKind::Joined, None)
    }

    /// Queues an event of a page.
    pub(in crate::serve) fn queue(
        &self,
        page: &Arc<Page>,
        kind: EventKind,
    ) -> Result<(), QueueError> {
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
            received: self.shared.clock.now(),
            lived: page.received(),
            stops: self.shared.stop.count(),
            _place: place,
        };
        self.events.send(event).map_err(|_| QueueError::Ended)
    }
}

#[cfg(test)]
mod tests {
    use super::{EventKind, Page, QueueError, channels};
    use crate::serve::wire::lease::REQUESTS;
    use crate::serve::wire::message::ClientRequest;
    use crate::serve::wire::numbered::NumberedRequest;
    use fivebar_sim::clock::Clock;
    use std::sync::Arc;

    #[test]
    fn a_page_that_floods_fills_its_own_places_only() {
        let (web, controller, _updates) = channels(Clock::simulated());
        let now = web.shared.clock.now();
        let [flooding, other] = [now; 2].map(|now| Arc::new(Page::new(now)));
        let request = || {
            let (number, request) = (None, ClientRequest::Run);
            EventKind::Request(NumberedRequest { number, request })
        };
        for _ in 0..REQUESTS {
            assert_eq!(web.queue(&flooding, request()), Ok(()));
        }
        assert_eq!(web.queue(&flooding, request()), Err(QueueError::Full));
        assert_eq!(web.queue(&other, request()), Ok(()));
        drop(controller.events.recv());
        assert_eq!(web.queue(&flooding, request()), Ok(()), "one was handled");
    }
}
