//! Limits what a page sends, frame by frame, before the websocket's library gathers it.

use super::backlog::Backlog;
use super::rate::PerSecond;
use super::wire::channels::WebEnd;
use super::wire::lease::Page;
use axum::body::Bytes;
use std::io::{self, Cursor};
use std::net::TcpStream;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::OwnedSemaphorePermit;
use tokio_tungstenite::tungstenite::protocol::frame::FrameHeader;
use tokio_tungstenite::tungstenite::protocol::frame::coding::{Data, OpCode};

/// Longest message of the page in control [bytes]: a job of two million moves. A longer one is refused by its
/// header, before the server has memory for it.
pub(super) const MAX_MESSAGE: u64 = 52 << 20;
/// The same of a page that watches and is the one that may send a long message.
const MAX_LONG_MESSAGE: u64 = 12 << 20;
/// Longest message of a page that is not in control [bytes], except for one page at a time. Without
/// this limit 31 pages that send jobs take 377 MB, with it 41 MB.
const MAX_WATCHER_MESSAGE: u64 = 64 << 10;
/// Most messages and small frames of a page per second, several times what a user and the signs
/// of life produce. Without this limit a page that sends as fast as it can takes half a core, and the
/// others get 22 states a second in place of 30.
const MAX_PER_SECOND: u32 = 1000;
/// Size below which a frame counts although it begins no message [bytes]. Without it a message that
/// goes on in empty frames never ends. Larger frames are limited by the connection.
const SMALL: u64 = 1 << 10;
/// Frames are passed on in parts of at most this size [bytes]; a multiple of the mask's length.
/// The websocket's library keeps a buffer as large as the largest frame it has read: after 30 messages
/// of 12 MB the server has 29 MB with parts, 40 MB without.
const PART: u64 = 16 << 10;
/// Bytes read from the connection at once.
const READ: usize = 4 << 10;

/// Why a page is disconnected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum LimitError {
    #[error("This page sent more than {MAX_PER_SECOND} messages or frames in a second.")]
    TooMany,
    #[error("This page sent a message of more than {} MB.", .0 / 1_000_000)]
    TooLong(u64),
    #[error("Another page is sending a long message: take control, or try again later.")]
    Watches,
}

/// Where the meter is in the stream.
enum Place {
    /// Before a frame's header.
    Header,
    /// Within a frame: this many bytes of it are left. The next part gets this header.
    Frame(FrameHeader, u64),
    /// Within a part of a frame: this many bytes of the part are left, and then as above.
    Part(u64, FrameHeader, u64),
}

/// A connection whose incoming frames are counted, limited and cut into parts.
pub(super) struct FrameMeter<S> {
    stream: S,
    /// The first bytes, which were read with the request for the websocket.
    early: Bytes,
    page: Arc<Page>,
    pages: WebEnd,
    rate: PerSecond,
    backlog: Backlog,
    /// The size of the message that is being received [bytes].
    message: u64,
    /// The place of a long message.
    long: Option<OwnedSemaphorePermit>,
    place: Place,
    /// Bytes read, and the range of them that is not passed on yet.
    input: Box<[u8; READ]>,
    unread: std::ops::Range<usize>,
    /// A part's header that is not passed on yet.
    header: Vec<u8>,
    /// Why the frame after those that were passed on is refused.
    refused: Option<io::Error>,
}

impl<S: AsyncRead + Unpin> FrameMeter<S> {
    pub(super) fn new(
        stream: S,
        early: Bytes,
        probe: Option<TcpStream>,
        page: Arc<Page>,
        pages: WebEnd,
    ) -> Self {
        let now = pages.shared.clock.now();
        Self {
            stream,
            early,
            page,
            pages,
            rate: PerSecond::new(MAX_PER_SECOND, now),
            backlog: Backlog::new(probe, now),
            message: 0,
            long: None,
            place: Place::Header,
            input: Box::new([0; READ]),
            unread: 0..0,
            header: Vec::new(),
            refused: None,
        }
    }

    /// Reads and drops what the page still sends, until it has closed the connection.
    pub(super) async fn drain(&mut self) {
        std::future::poll_fn(|cx| {
            self.unread = 0..0;
            loop {
                match ready!(self.fill(cx)) {
                    Ok(0) | Err(_) => return Poll::Ready(()),
                    Ok(_) => self.unread = 0..0,
                }
            }
        })
        .await;
    }

    /// Reads after the unread bytes, which leave room; returns how many bytes came.
    fn fill(&mut self, cx: &mut Context<'_>) -> Poll<io::Result<usize>> {
        self.input.copy_within(self.unread.clone(), 0);
        self.unread = 0..self.unread.len();
        let mut unfilled = ReadBuf::new(&mut self.input[self.unread.end..]);
        if !self.early.is_empty() {
            let early = self
                .early
                .split_to(self.early.len().min(unfilled.remaining()));
            unfilled.put_slice(&early);
            self.unread.end += early.len();
            return Poll::Ready(Ok(early.len()));
        }
        let asked = self.pages.shared.clock.now();
        let read = Pin::new(&mut self.stream).poll_read(cx, &mut unfilled)?;
        if read.is_pending() {
            self.backlog.look(asked);
            return Poll::Pending;
        }
        let (count, left) = (unfilled.filled().len(), unfilled.remaining());
        self.unread.end += count;
        if count > 0 {
            self.page.set_received(self.backlog.emptied());
        }
        if left > 0 {
            self.backlog.empty_at(asked);
        }
        Poll::Ready(Ok(count))
    }

    /// Takes the next frame's header, if all of it was read, and counts the frame.
    fn take_header(&mut self) -> io::Result<bool> {
        let mut cursor = Cursor::new(&self.input[self.unread.clone()]);
        let parsed = FrameHeader::parse(&mut cursor).map_err(io::Error::other)?;
        let Some((header, length)) = parsed else {
            return Ok(false);
        };
        self.unread.start += cursor.position() as usize;
        self.count(&header, length).map_err(io::Error::other)?;
        self.place = Place::Frame(header, length);
        Ok(true)
    }

    fn count(&mut self, header: &FrameHeader, length: u64) -> Result<(), LimitError> {
        let continues = header.opcode == OpCode::Data(Data::Continue);
        let now = self.pages.shared.clock.now();
        if (!continues || length < SMALL) && !self.rate.admit(now) {
            return Err(LimitError::TooMany);
        }
        if let OpCode::Data(_) = header.opcode {
            if !continues {
                self.message = 0;
                self.long = None;
            }
            self.message = self.message.saturating_add(length);
            let is_holder = self.pages.shared.lease.holder() == Some(self.page.id);
            let most = if is_holder {
                MAX_MESSAGE
            } else {
                MAX_LONG_MESSAGE
            };
            if self.message > most {
                return Err(LimitError::TooLong(most));
            }
            if self.message > MAX_WATCHER_MESSAGE && !is_holder && self.long.is_none() {
                let place = Arc::clone(&self.pages.long_messages).try_acquire_owned();
                self.long = Some(place.map_err(|_| LimitError::Watches)?);
            }
        }
        Ok(())
    }

    /// Begins the next part of a frame: its header goes before it.
    fn begin_part(&mut self, header: &FrameHeader, left: u64) -> io::Result<()> {
        let part = left.min(PART);
        let rest = left - part;
        let shown = FrameHeader {
            is_final: header.is_final && rest == 0,
            ..header.clone()
        };
        self.header.clear();
        shown
            .format(part, &mut self.header)
            .map_err(io::Error::other)?;
        let following = FrameHeader {
            opcode: OpCode::Data(Data::Continue),
            ..header.clone()
        };
        self.place = Place::Part(part, following, rest);
        Ok(())
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for FrameMeter<S> {
    fn poll_read(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        out: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        let before = out.filled().len();
        if let Some(error) = this.refused.take() {
            return Poll::Ready(Err(error));
        }
        while out.remaining() > 0 {
            if !this.header.is_empty() {
                let count = this.header.len().min(out.remaining());
                out.put_slice(&this.header[..count]);
                this.header.drain(..count);
                continue;
            }
            match &mut this.place {
                Place::Header => match this.take_header() {
                    Ok(true) => continue,
                    Ok(false) => {}
                    // What came before may be a stop: it is passed on first.
                    Err(error) if out.filled().len() > before => {
                        this.refused = Some(error);
                        break;
                    }
                    Err(error) => return Poll::Ready(Err(error)),
                },
                Place::Frame(header, left) => {
                    let (header, left) = (header.clone(), *left);
                    this.begin_part(&header, left)?;
                    continue;
                }
                Place::Part(0, _, 0) => {
                    this.place = Place::Header;
                    continue;
                }
                Place::Part(0, header, left) => {
                    this.place = Place::Frame(header.clone(), *left);
                    continue;
                }
                Place::Part(left, ..) if !this.unread.is_empty() => {
                    let count = (*left).min(this.unread.len() as u64) as usize;
                    let count = count.min(out.remaining());
                    let from = this.unread.start;
                    out.put_slice(&this.input[from..from + count]);
                    *left -= count as u64;
                    this.unread.start += count;
                    continue;
                }
                Place::Part(..) => {}
            }
            // More bytes are needed. What is ready is passed on first.
            if out.filled().len() > before {
                break;
            }
            if ready!(this.fill(cx))? == 0 {
                break;
            }
        }
        Poll::Ready(Ok(()))
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for FrameMeter<S> {
    fn poll_write(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.get_mut().stream).poll_write(cx, bytes)
    }

    fn poll_flush(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_flush(cx)
    }

    fn poll_shutdown(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_shutdown(cx)
    }
}

#[cfg(test)]
mod tests {
    use super::{
        FrameMeter, LimitError, MAX_LONG_MESSAGE, MAX_PER_SECOND, MAX_WATCHER_MESSAGE, PART,
    };
    use crate::serve::wire::channels::{WebEnd, channels};
    use crate::serve::wire::lease::Page;
    use axum::body::Bytes;
    use fivebar_sim::clock::Clock;
    use futures_util::StreamExt as _;
    use std::io::Cursor;
    use std::sync::Arc;
    use std::time::Duration;
    use tokio::io::{AsyncRead, AsyncWriteExt as _};
    use tokio_tungstenite::WebSocketStream;
    use tokio_tungstenite::tungstenite::protocol::Role;
    use tokio_tungstenite::tungstenite::protocol::frame::Frame;
    use tokio_tungstenite::tungstenite::protocol::frame::coding::{Control, Data, OpCode};
    use tokio_tungstenite::tungstenite::{Error, Message};

    /// A frame as a page sends it.
    fn frame(opcode: OpCode, is_final: bool, payload: &str) -> Vec<u8> {
        let mut frame = match opcode {
            OpCode::Data(_) => Frame::message(payload.to_owned(), opcode, is_final),
            OpCode::Control(_) => Frame::pong(payload.to_owned()),
        };
        frame.header_mut().mask = Some([1, 2, 3, 4]);
        let mut bytes = Vec::new();
        frame.format(&mut bytes).expect("memory");
        bytes
    }

    /// The messages that the server gets from these bytes, up to an error.
    fn received(bytes: Vec<u8>, pages: &WebEnd) -> Vec<Result<Message, Error>> {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        runtime.expect("a runtime").block_on(async {
            let meter = meter(
                Cursor::new(bytes),
                Arc::new(Page::new(pages.shared.clock.now())),
                pages.clone(),
            );
            let socket = WebSocketStream::from_raw_socket(meter, Role::Server, None).await;
            socket.collect().await
        })
    }

    fn limit(messages: &[Result<Message, Error>]) -> Option<LimitError> {
        let Some(Err(Error::Io(error))) = messages.iter().find(|message| message.is_err()) else {
            return None;
        };
        error.get_ref()?.downcast_ref().copied()
    }

    #[test]
    fn a_message_arrives_as_it_was_sent_whatever_its_frames() {
        let (pages, _controller, _updates) = channels(Clock::simulated());
        let text: String = (0..5 * PART)
            .map(|index| char::from(b'a' + (index % 23) as u8))
            .collect();
        let text = &text[..(4 * PART + 3) as usize];
        let (one, two) = text.split_at(PART as usize + 1);
        let [whole, next] = [OpCode::Data(Data::Text), OpCode::Data(Data::Continue)];
        let mut bytes = frame(whole, true, text);
        bytes.extend(frame(whole, false, one));
        bytes.extend(frame(OpCode::Control(Control::Pong), true, "between"));
        bytes.extend(frame(next, true, two));
        bytes.extend(frame(whole, true, ""));
        let messages = received(bytes, &pages);
        let texts = messages.iter().flatten();
        let texts: Vec<_> = texts.filter_map(|message| message.to_text().ok()).collect();
        assert_eq!(texts, [text, "between", text, ""]);
    }

    #[test]
    fn empty_frames_count_although_they_begin_no_message() {
        let (pages, _controller, _updates) = channels(Clock::simulated());
        let mut bytes = frame(OpCode::Data(Data::Text), false, "");
        bytes.extend(
            frame(OpCode::Data(Data::Continue), false, "").repeat(2 * MAX_PER_SECOND as usize),
        );
        assert_eq!(limit(&received(bytes, &pages)), Some(LimitError::TooMany));
    }

    #[test]
    fn a_page_that_watches_sends_long_messages_only_if_no_other_does() {
        let (pages, _controller, _updates) = channels(Clock::simulated());
        let text = "x".repeat(MAX_WATCHER_MESSAGE as usize + 1);
        let bytes = frame(OpCode::Data(Data::Text), true, &text);
        assert_eq!(limit(&received(bytes.clone(), &pages)), None);
        let other = pages.long_messages.try_acquire();
        let other = other.expect("the place is free again");
        assert_eq!(limit(&received(bytes, &pages)), Some(LimitError::Watches));
        drop(other);
    }

    fn meter<S: AsyncRead + Unpin>(stream: S, page: Arc<Page>, pages: WebEnd) -> FrameMeter<S> {
        FrameMeter::new(stream, Bytes::new(), None, page, pages)
    }

    /// A server that gets no time reads late what arrived in time, and does not know when it arrived.
    #[test]
    fn what_waited_to_be_read_counts_as_received_when_nothing_waited_last() {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        runtime.expect("a runtime").block_on(async {
            let clock = Clock::simulated();
            let (pages, _controller, _updates) = channels(clock.clone());
            let (mut sent, stream) = tokio::io::duplex(1 << 10);
            let page = Arc::new(Page::new(pages.shared.clock.now()));
            let meter = meter(stream, Arc::clone(&page), pages);
            let mut socket = WebSocketStream::from_raw_socket(meter, Role::Server, None).await;
            let text = frame(OpCode::Data(Data::Text), true, "alive");
            let mut emptied = page.received(); // When a reading left nothing.
            for _ in 0..3 {
                sent.write_all(&text).await.expect("room");
                clock.sleep(Duration::from_millis(20));
                socket.next().await.expect("a message").expect("a message");
                assert_eq!(page.received(), emptied);
                emptied = clock.now();
            }
        });
    }

    #[test]
    fn a_watchers_message_of_more_than_12_mb_is_refused_by_its_header() {
        let (pages, _controller, _updates) = channels(Clock::simulated());
        let mut bytes = frame(OpCode::Data(Data::Text), true, &"x".repeat(15 << 20));
        bytes.truncate(100);
        assert_eq!(
            limit(&received(bytes, &pages)),
            Some(LimitError::TooLong(MAX_LONG_MESSAGE))
        );
    }
}
