//! The exchange with a page whose bytes are known: for tests, and for the fuzzer.

use super::socket::exchange;
use super::wire::channels::{Event, EventKind, channels};
use axum::body::Bytes;
use fivebar_sim::clock::Clock;
use std::io;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio_tungstenite::tungstenite::error::ProtocolError;
use tokio_tungstenite::tungstenite::protocol::{Role, WebSocket};
use tokio_tungstenite::tungstenite::{Error, Message};

/// Longest message of the server that is no state and no job [bytes]: a notice of 300 characters.
const LONGEST: usize = 4096;
/// Most events of a page that wait: its joining and its requests.
const EVENTS: usize = 33;

/// What the server made of a page's bytes.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// Requests and long messages that wait for the controller's thread.
    pub requests: usize,
    /// Stops, which take effect at once.
    pub stops: u64,
    /// Refusals that were sent to the page.
    pub refusals: usize,
    /// The reason for which the page was disconnected.
    pub reason: Option<String>,
}

/// A connection: the bytes of the page, then its end; what the server writes is kept.
struct Line<'a> {
    page: &'a [u8],
    server: Arc<Mutex<Vec<u8>>>,
}

impl AsyncRead for Line<'_> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
        out: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let (now, later) = self.page.split_at(self.page.len().min(out.remaining()));
        out.put_slice(now);
        self.page = later;
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Line<'_> {
    fn poll_write(
        self: Pin<&mut Self>,
        _: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let mut server = self.server.lock().unwrap_or_else(PoisonError::into_inner);
        server.extend(bytes);
        Poll::Ready(Ok(bytes.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}

/// Exchanges messages with a page that sends these bytes after its request for a websocket, and
/// then closes the connection. It is not in control, and nobody takes its requests.
///
/// # Panics
/// If more requests wait than a page may have, if the server's bytes are no websocket messages, if
/// one of them is long, or if the page leaves a trace: the lease, or the place for a long message.
pub fn receive(bytes: &[u8]) -> Received {
    let (pages, controller, _updates) = channels(Clock::simulated());
    let server = Arc::<Mutex<Vec<u8>>>::default();
    let line = Line {
        page: bytes,
        server: Arc::clone(&server),
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build();
    let lease = &controller.shared.lease;
    runtime
        .expect("a runtime")
        .block_on(exchange(line, Bytes::new(), None, pages.clone()));
    assert_eq!(lease.holder(), None, "a page that is gone is in control");
    let events: Vec<_> = controller.events.try_iter().collect();
    assert!(events.len() <= EVENTS, "{} events wait", events.len());
    let joins = |event: &Event| matches!(event.kind, EventKind::Joined);
    assert!(joins(&events[0]), "a request waits before its page");
    let mut received = Received {
        requests: events.len().saturating_sub(1),
        stops: controller.shared.stop.count(),
        ..Received::default()
    };
    drop(events);
    assert_eq!(pages.long_messages.available_permits(), 1);
    let sent = server
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .clone();
    received.read(sent);
    received
}

impl Received {
    /// Reads what the server sent.
    fn read(&mut self, sent: Vec<u8>) {
        let mut socket = WebSocket::from_raw_socket(io::Cursor::new(sent), Role::Client, None);
        loop {
            match socket.read() {
                Ok(Message::Text(text)) => {
                    assert!(text.len() < LONGEST, "{} bytes came back", text.len());
                    let message: serde_json::Value = serde_json::from_str(&text).expect("JSON");
                    let kinds = ["hello", "notice", "answer"];
                    assert!(
                        kinds.iter().any(|kind| message.get(kind).is_some()),
                        "{message}"
                    );
                    self.refusals += usize::from(message.get("notice").is_some());
                }
                Ok(Message::Close(Some(frame))) => self.reason = Some(frame.reason.to_string()),
                Ok(_) => {}
                Err(Error::ConnectionClosed | Error::AlreadyClosed) => return,
                // The connection ends without a farewell where the page has ended it so.
                Err(Error::Protocol(ProtocolError::ResetWithoutClosingHandshake)) => return,
                Err(error) => panic!("the server's bytes are no messages: {error}"),
            }
        }
    }
}

/// The bytes of a text message: one frame, masked by zeros.
pub fn text_frame(text: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x81];
    match text.len() {
        short @ 0..126 => frame.push(0x80 | short as u8),
        middle @ 126..0x1_0000 => {
            frame.push(0x80 | 126);
            frame.extend((middle as u16).to_be_bytes());
        }
        long => {
            frame.push(0x80 | 127);
            frame.extend((long as u64).to_be_bytes());
        }
    }
    frame.extend([0; 4]);
    frame.extend(text);
    frame
}
