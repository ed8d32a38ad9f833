//! Accepts connections, and limits what they cost before they have shown the token.

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::{Domain, Socket, Type};
use std::collections::VecDeque;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::task::AbortHandle;
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
/// Open files that are left to pages and to the controller after that: a page takes five.
const RESERVE: usize = 16;
/// Fewest connections at once that are no websockets, as few as the system may allow: a browser opens
/// six.
const FEWEST_CONNECTIONS: usize = 16;

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
        let service = TowerToHyperService::new(router.clone());
        let connection = http
            .serve_connection(TokioIo::new(stream), service)
            .with_upgrades();
        let visit = tokio::spawn(async move {
            let _ = connection.await;
        });
        visitors.admit(peer.ip(), visit.abort_handle());
    }
}

/// The connections that are no websockets.
struct Visitors {
    /// The oldest first.
    open: VecDeque<(IpAddr, AbortHandle)>,
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
        self.open.retain(|(_, visit)| !visit.is_finished());
        let fewer = self.open.len().saturating_sub(RESERVE);
        self.most = self.most.min(fewer).max(FEWEST_CONNECTIONS);
        while self.open.len() > self.most {
            self.close(0);
        }
    }

    fn close(&mut self, index: usize) {
        if let Some((_, visit)) = self.open.remove(index) {
            visit.abort();
        }
    }

    /// Adds a connection. If there are too many, the oldest one of the same peer, or of all, is
    /// closed: it has had the most time.
    fn admit(&mut self, peer: IpAddr, visit: AbortHandle) {
        self.open.retain(|(_, visit)| !visit.is_finished());
        let of_peer = self.open.iter().filter(|(other, _)| *other == peer);
        let oldest = if of_peer.count() >= MAX_OF_PEER {
            self.open.iter().position(|(other, _)| *other == peer)
        } else {
            (self.open.len() >= self.most).then_some(0)
        };
        if let Some(index) = oldest {
            self.close(index);
        }
        self.open.push_back((peer, visit));
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_CONNECTIONS, MAX_OF_PEER, Visitors};
    use std::net::IpAddr;

    fn peers(visitors: &Visitors, peer: IpAddr) -> usize {
        visitors
            .open
            .iter()
            .filter(|(other, _)| *other == peer)
            .count()
    }

    #[test]
    fn a_peer_that_opens_many_connections_closes_its_own() {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        let runtime = runtime.expect("a runtime");
        let mut visitors = Visitors::default();
        let mut admit = |peer: &str| {
            let visit = runtime.spawn(std::future::pending::<()>());
            let peer = peer.parse().expect("an address");
            visitors.admit(peer, visit.abort_handle());
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
