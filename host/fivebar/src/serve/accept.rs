//! Accepts connections, and limits what they cost before they have shown the token.

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::{Domain, Socket, Type};
use std::collections::VecDeque;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::task::{AbortHandle, yield_now};
use tokio::time::sleep;

/// Connections at once that are no websockets: many times what a browser opens. Without it 1000
/// silent ones hold 1000 open files, more than systems allow, and no page connects.
const MAX_CONNECTIONS: usize = 96;
/// The same of one peer, so that one that opens many closes its own and not those of others.
const MAX_OF_PEER: usize = 64;
/// Time for the head of a request to arrive; otherwise a silent connection stays for ever.
const HEAD_TIMEOUT: Duration = Duration::from_secs(5);
/// Largest buffer of a connection [bytes]; a request's head has to fit. The library's own limit takes
/// 67 MB in place of 60 in the test of half requests.
const BUFFER: usize = 16 << 10;
/// Connections that the system holds until they are accepted. Beyond it the system drops requests
/// to connect, and a browser asks again after a second only: with 128, a crowd made it wait for seconds.
const BACKLOG: i32 = 1024;
/// Wait after the system refuses a connection, as when this process has too many open files.
const PAUSE: Duration = Duration::from_millis(50);
/// Open files that are left to pages and to the controller after that: a page takes five, and one that gets fewer is closed.
const RESERVE: usize = 28;
/// Fewest connections at once that are no websockets, as few as the system may allow: a browser opens
/// six.
const FEWEST_CONNECTIONS: usize = 16;

/// Whether a connection has shown the token; its requests have it as an extension.
#[derive(Clone, Debug, Default)]
pub(super) struct ShownToken(Arc<AtomicBool>);

impl ShownToken {
    pub(super) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Opens the address.
///
/// # Errors
/// The address is not one of this computer, or is in use.
pub(super) fn listen(address: SocketAddr) -> io::Result<std::net::TcpListener> {
    let socket = Socket::new(Domain::for_address(address), Type::STREAM, None)?;
    // Elsewhere than on Unix this would let two programs share a port.
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    socket.bind(&address.into())?;
    socket.listen(BACKLOG)?;
    Ok(socket.into())
}

/// Serves requests until the listener fails.
pub(super) async fn serve(listener: TcpListener, router: Router) -> io::Result<()> {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIMEOUT)
        .max_buf_size(BUFFER);
    let mut visitors = Visitors::default();
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            visitors.make_room();
            sleep(PAUSE).await;
            continue;
        };
        // States and stops are small: none waits for the next.
        let _ = stream.set_nodelay(true);
        let token = ShownToken::default();
        let service = router.clone().layer(Extension(token.clone()));
        let service = TowerToHyperService::new(service);
        let connection = http
            .serve_connection(TokioIo::new(stream), service)
            .with_upgrades();
        let visit = tokio::spawn(async move {
            let _ = connection.await;
        });
        visitors.admit(Visitor {
            peer: peer.ip(),
            token,
            visit: visit.abort_handle(),
        });
        // It is served before the next ones are accepted, which may close it.
        yield_now().await;
    }
}

/// A connection that is no websocket.
struct Visitor {
    peer: IpAddr,
    token: ShownToken,
    visit: AbortHandle,
}

/// The connections that are no websockets.
struct Visitors {
    /// The oldest first.
    open: VecDeque<Visitor>,
    /// Most of them at once.
    most: usize,
}

impl Default for Visitors {
    fn default() -> Self {
        Self {
            open: VecDeque::new(),
            most: MAX_CONNECTIONS,
        }
    }
}

impl Visitors {
    /// Closes the oldest ones after the system has refused a connection, and admits fewer from now
    /// on, so that there are open files for pages.
    fn make_room(&mut self) {
        self.drop_finished();
        let fewer = self.open.len().saturating_sub(RESERVE);
        self.most = self.most.min(fewer).max(FEWEST_CONNECTIONS);
        while self.open.len() > self.most {
            self.close_oldest(|_| true);
        }
    }

    fn drop_finished(&mut self) {
        self.open.retain(|visitor| !visitor.visit.is_finished());
    }

    /// Closes the oldest one of these, which has had the most time; one that has shown the token only if there is no
    /// other, so that a crowd without it ends no request of a page.
    fn close_oldest(&mut self, of: impl Fn(&Visitor) -> bool) {
        let stranger = |visitor: &Visitor| of(visitor) && !visitor.token.is_set();
        let oldest = self.open.iter().position(stranger);
        let oldest = oldest.or_else(|| self.open.iter().position(&of));
        if let Some(visitor) = oldest.and_then(|index| self.open.remove(index)) {
            visitor.visit.abort();
        }
    }

    /// Adds a connection. If there are too many, one of the same peer, or of all, is closed.
    fn admit(&mut self, visitor: Visitor) {
        self.drop_finished();
        let peer = visitor.peer;
        let of_peer = |other: &Visitor| other.peer == peer;
        if self.open.iter().filter(|other| of_peer(other)).count() >= MAX_OF_PEER {
            self.close_oldest(of_peer);
        } else if self.open.len() >= self.most {
            self.close_oldest(|_| true);
        }
        self.open.push_back(visitor);
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_CONNECTIONS, MAX_OF_PEER, ShownToken, Visitor, Visitors, listen, serve};
    use crate::serve::guard::Guard;
    use crate::serve::web::guarded;
    use axum::Router;
    use axum::routing::post;
    use std::io::{Read as _, Write as _};
    use std::net::{IpAddr, SocketAddr, TcpStream};
    use std::thread;
    use tokio::sync::oneshot;

    fn peers(visitors: &Visitors, peer: IpAddr) -> usize {
        let of_peer = |visitor: &&Visitor| visitor.peer == peer;
        visitors.open.iter().filter(of_peer).count()
    }

    /// A request of a page, and the status of the answer.
    struct Asker {
        stream: TcpStream,
        request: String,
    }

    impl Asker {
        fn new(address: SocketAddr, token: &str) -> Self {
            let port = address.port();
            Self {
                stream: TcpStream::connect(address).expect("a server"),
                request: format!(
                    "POST /stop HTTP/1.1\r\nHost: {address}\r\nCookie: fivebar{port}={token}\r\n\
                     Content-Length: 0\r\n\r\n"
                ),
            }
        }

        fn ask(&mut self) {
            let sent = self.stream.write_all(self.request.as_bytes());
            sent.expect("an open connection");
        }

        fn status(&mut self) -> String {
            let mut status = [0; 12];
            let read = self.stream.read_exact(&mut status);
            read.expect("an answer");
            // The rest of the head; there is no body.
            let mut end = Vec::new();
            while !end.ends_with(b"\r\n\r\n") {
                let mut byte = [0];
                self.stream.read_exact(&mut byte).expect("a head");
                end.extend(byte);
            }
            String::from_utf8_lossy(&status[9..]).into()
        }
    }

    /// More connections than a peer may have, without a word.
    fn crowd(address: SocketAddr) -> Vec<TcpStream> {
        let connect = |_| TcpStream::connect(address).expect("a server");
        (0..2 * MAX_OF_PEER).map(connect).collect()
    }

    /// Serves a route while `ask` runs, which begins before anything is accepted and gets the means to begin it.
    fn asked(ask: impl FnOnce(SocketAddr, &str, oneshot::Sender<()>) + Send) {
        let listener = listen("127.0.0.1:0".parse().unwrap()).expect("a port");
        let address = listener.local_addr().unwrap();
        let guard = Guard::with_new_token().unwrap();
        let token = guard.token().to_owned();
        let router = guarded(Router::new().route("/stop", post(|| async {})), guard);
        let (begin, begun) = oneshot::channel();
        let (ended, end) = oneshot::channel::<()>();
        thread::scope(|scope| {
            scope.spawn(move || {
                ask(address, &token, begin);
                drop(ended);
            });
            let mut runtime = tokio::runtime::Builder::new_current_thread();
            runtime.enable_all().build().unwrap().block_on(async {
                let _ = begun.await;
                listener.set_nonblocking(true).unwrap();
                let listener = tokio::net::TcpListener::from_std(listener).unwrap();
                tokio::select! {
                    _ = serve(listener, router) => {}
                    _ = end => {}
                }
            });
        });
    }

    #[test]
    fn a_request_that_has_arrived_is_answered_before_those_behind_it_close_its_connection() {
        asked(|address, token, begin| {
            let mut page = Asker::new(address, token);
            page.ask();
            let _crowd = crowd(address);
            begin.send(()).unwrap();
            assert_eq!(page.status(), "200");
        });
    }

    #[test]
    fn a_connection_that_has_shown_the_token_outlasts_a_crowd_that_has_not() {
        asked(|address, token, begin| {
            begin.send(()).unwrap();
            let mut page = Asker::new(address, token);
            page.ask();
            assert_eq!(page.status(), "200");
            let _crowd = crowd(address);
            // One of the last: all others have been accepted when it is answered.
            let mut last = Asker::new(address, token);
            last.ask();
            assert_eq!(last.status(), "200");
            page.ask();
            assert_eq!(page.status(), "200");
        });
    }

    #[test]
    fn a_peer_that_opens_many_connections_closes_its_own() {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        let runtime = runtime.expect("a runtime");
        let mut visitors = Visitors::default();
        let mut admit = |peer: &str| {
            let visit = runtime.spawn(std::future::pending::<()>());
            let peer = peer.parse().expect("an address");
            visitors.admit(Visitor {
                peer,
                token: ShownToken::default(),
                visit: visit.abort_handle(),
            });
            (visit, peer)
        };
        let (user, at) = admit("192.168.0.2");
        let mut flood = Vec::new();
        for _ in 0..1000 {
            flood.push(admit("192.168.0.3").0);
        }
        let others: Vec<_> = (4..20)
            .map(|last| admit(&format!("192.168.0.{last}")).0)
            .collect();
        runtime.block_on(async {
            // The runtime ends the aborted tasks a few at a time.
            for _ in 0..1000 {
                tokio::task::yield_now().await;
            }
        });
        assert!(!user.is_finished() && others.iter().all(|other| !other.is_finished()));
        assert_eq!(
            flood.iter().filter(|visit| !visit.is_finished()).count(),
            MAX_OF_PEER
        );
        assert_eq!(peers(&visitors, at), 1);
        assert!(visitors.open.len() <= MAX_CONNECTIONS);
    }
}
