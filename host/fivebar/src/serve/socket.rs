//! The exchange with one page over its websocket.
//!
//! Reading never waits for writing: a page that reads slowly, or reads nothing, can still
//! send. Signs of life and stops take effect here, when they arrive.

use super::frame_meter::{FrameMeter, LimitError};
use super::wire::channels::{EventKind, Notice, QueueError, WebEnd};
use super::wire::lease::Page;
use super::wire::message::{ClientRequest, ServerMessage, brief};
use super::wire::numbered::NumberedRequest;
use axum::body::Bytes;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use std::borrow::Cow;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::sync::broadcast::{self, error::RecvError};
use tokio::sync::mpsc;
use tokio::time::timeout;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::protocol::frame::coding::CloseCode;
use tokio_tungstenite::tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tokio_tungstenite::tungstenite::{Error, Message, Utf8Bytes};

/// Longest message that is read here [bytes]. Only jobs are longer; the thread of jobs reads those,
/// because the signs of life and stops of the same page would wait for it.
const MAX_SHORT_MESSAGE: usize = 4 << 10;
/// Refusals and answers that may wait for their page: it may send and read nothing.
const OWN: usize = 8;
/// A page that reads nothing for this time is disconnected. Without it 32 pages that read nothing
/// keep every other page out for ever.
const LONGEST_SEND: Duration = Duration::from_secs(30);
/// Time for a page to receive the reason for which it is disconnected.
const LONGEST_GOODBYE: Duration = Duration::from_millis(250);
/// Bytes read into the websocket's buffer at once.
const BUFFER: usize = 4 << 10;

type Socket<S> = WebSocketStream<FrameMeter<S>>;

/// A page's connection, after its web request was accepted.
pub(super) trait Connection: AsyncRead + AsyncWrite + Unpin {}

impl<S: AsyncRead + AsyncWrite + Unpin> Connection for S {}

/// Why a connection ends: a sentence, if the page is to know.
type End = Option<Cow<'static, str>>;

/// Exchanges messages with a page until it disconnects or exceeds a limit. `early` are its first
/// bytes, read already; `probe` is the same connection.
pub(super) async fn exchange<S: Connection>(
    stream: S,
    early: Bytes,
    probe: Option<TcpStream>,
    pages: WebEnd,
) {
    let page = Arc::new(Page::new(pages.shared.clock.now()));
    let stream = FrameMeter::new(stream, early, probe, Arc::clone(&page), pages.clone());
    let config = WebSocketConfig::default()
        .read_buffer_size(BUFFER)
        .write_buffer_size(BUFFER)
        .max_message_size(Some(super::frame_meter::MAX_MESSAGE as usize));
    let socket = Socket::from_raw_socket(stream, Role::Server, Some(config)).await;
    let (sink, stream) = socket.split();
    let (to_page, own) = mpsc::channel(OWN);
    let mut reader = Reader {
        page: &page,
        pages: &pages,
        stream,
        own: to_page,
    };
    let mut writer = Writer {
        page: &page,
        pages: pages.clone(),
        sink,
        own,
    };
    let notices = pages.notices.subscribe();
    // Before anything is read that the page has sent, which may need control.
    if pages.join(&page).is_err() {
        return;
    }
    let end = tokio::select! {
        end = reader.run() => end,
        end = writer.run(notices) => end,
    };
    page.disconnect(&pages.shared.lease);
    let (stream, sink) = (reader.stream, writer.sink);
    if let (Some(reason), Ok(mut socket)) = (end, stream.reunite(sink)) {
        let _ = timeout(LONGEST_GOODBYE, close(&mut socket, &reason)).await;
    }
}

/// Sends the reason and waits until the page has closed. A connection closed while it is sent
/// to would drop the reason.
async fn close<S: Connection>(socket: &mut Socket<S>, reason: &str) {
    let frame = CloseFrame {
        code: CloseCode::Policy,
        reason: Utf8Bytes::from(reason),
    };
    if socket.send(Message::Close(Some(frame))).await.is_ok() {
        socket.get_mut().drain().await;
    }
}

struct Reader<'a, S> {
    page: &'a Arc<Page>,
    pages: &'a WebEnd,
    stream: SplitStream<Socket<S>>,
    /// Messages to this page alone.
    own: mpsc::Sender<Utf8Bytes>,
}

impl<S: Connection> Reader<'_, S> {
    async fn run(&mut self) -> End {
        loop {
            let message = match self.stream.next().await? {
                Ok(message) => message,
                Err(error) => return limit(&error),
            };
            self.pages.shared.lease.renew(self.page);
            let result = match message {
                Message::Text(text) => self.receive(text),
                Message::Ping(_) | Message::Pong(_) => Ok(()),
                Message::Binary(_) | Message::Close(_) | Message::Frame(_) => return None,
            };
            if let Err(end) = result {
                return end;
            }
            // Refusals are written also while the page goes on sending.
            tokio::task::yield_now().await;
        }
    }

    fn receive(&mut self, text: Utf8Bytes) -> Result<(), End> {
        if text.len() > MAX_SHORT_MESSAGE {
            return self.queue(EventKind::LongMessage(text));
        }
        let numbered = match serde_json::from_str::<NumberedRequest>(&text) {
            Ok(numbered) => numbered,
            Err(error) => {
                self.refuse(format!(
                    "The server does not know this request; load the page again ({error})."
                ));
                return Ok(());
            }
        };
        let stop = match &numbered.request {
            ClientRequest::Request(wanted) => wanted.kind().ok(),
            _ => None,
        };
        if let Some(stop) = stop {
            self.pages.shared.stop.raise(stop, self.page.id);
        }
        match (&numbered.request, numbered.number) {
            // All that was sent before it has been read.
            (ClientRequest::Alive, Some(number)) => self.send_to_page(&ServerMessage::Answer {
                to: self.page.id,
                number,
                tick: None,
                refused: None,
            }),
            (ClientRequest::Alive, None) => {}
            // The queue gets a stop for its answer only, which comes when the stop is done.
            (_, None) if stop.is_some() => {}
            _ => return self.queue(EventKind::Request(numbered)),
        }
        Ok(())
    }

    fn queue(&mut self, event: EventKind) -> Result<(), End> {
        match self.pages.queue(self.page, event) {
            Ok(()) => Ok(()),
            Err(QueueError::Full) => {
                self.refuse("Too many requests of this page wait: this one is dropped.".into());
                Ok(())
            }
            Err(QueueError::Ended) => Err(None),
        }
    }

    /// Sends a refusal to this page alone.
    fn refuse(&self, text: String) {
        self.send_to_page(&ServerMessage::Notice {
            to: Some(self.page.id),
            refused: true,
            text: brief(text),
        });
    }

    fn send_to_page(&self, message: &ServerMessage<'_>) {
        // If many wait already, the page floods and loses this one.
        let _ = self.own.try_send(message.json());
    }
}

/// The sentence about a limit that was exceeded.
fn limit(error: &Error) -> End {
    let Error::Io(error) = error else { return None };
    let limit = error.get_ref()?.downcast_ref::<LimitError>()?;
    Some(limit.to_string().into())
}

struct Writer<'a, S> {
    page: &'a Arc<Page>,
    pages: WebEnd,
    sink: SplitSink<Socket<S>, Message>,
    /// Messages to this page alone.
    own: mpsc::Receiver<Utf8Bytes>,
}

impl<S: Connection> Writer<'_, S> {
    async fn run(&mut self, mut notices: broadcast::Receiver<Notice>) -> End {
        let hello = format!(r#"{{"hello":{}}}"#, self.page.id);
        self.send(hello.into()).await?;
        // What was sent before this page connected.
        self.pages.fault.mark_changed();
        self.pages.job.mark_changed();
        loop {
            let WebEnd {
                state, fault, job, ..
            } = &mut self.pages;
            // A channel's end is the end of the controller's thread.
            let message = tokio::select! {
                changed = state.changed() => changed.map(|()| state.borrow_and_update().clone()).ok()?,
                changed = fault.changed() => changed.map(|()| fault.borrow_and_update().clone()).ok()?,
                changed = job.changed() => changed.map(|()| job.borrow_and_update().clone()).ok()?,
                own = self.own.recv() => own,
                notice = notices.recv() => match notice {
                    Ok((to, text)) if to.is_none_or(|to| to == self.page.id) => Some(text),
                    Ok(_) | Err(RecvError::Lagged(_)) => None,
                    Err(RecvError::Closed) => return None,
                },
            };
            if let Some(message) = message {
                self.send(message).await?;
            }
        }
    }

    /// Sends a message. `None` if the page does not read it.
    async fn send(&mut self, text: Utf8Bytes) -> Option<()> {
        let sent = timeout(LONGEST_SEND, self.sink.send(Message::Text(text))).await;
        sent.ok()?.ok()
    }
}
