//! Senders over TCP.

use super::connection::{Desk, Outlet};
use super::options::BridgeError;
use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Connections at once: the sender in control, and those that are refused because there is one.
const CONNECTIONS: usize = 16;
/// Longest wait for a sender that does not read.
const LONGEST_WRITE: Duration = Duration::from_secs(10);
/// Wait after the system refuses a connection, as when this process has too many open files.
const PAUSE: Duration = Duration::from_millis(50);

/// Opens the address, and starts the thread that accepts senders there.
pub(super) fn listen(address: SocketAddr, desk: Desk) -> Result<SocketAddr, BridgeError> {
    let listener = TcpListener::bind(address);
    let listener = listener.map_err(|source| BridgeError::Listen { address, source })?;
    let bound = listener.local_addr().map_err(BridgeError::Terminal)?;
    let places = Arc::new(());
    thread::spawn(move || {
        loop {
            let Ok((stream, peer)) = listener.accept() else {
                thread::sleep(PAUSE);
                continue;
            };
            // One more is dropped, which closes it.
            if Arc::strong_count(&places) <= CONNECTIONS {
                let (desk, place) = (desk.clone(), Arc::clone(&places));
                thread::spawn(move || {
                    let _ = serve(&desk, stream, peer);
                    drop(place);
                });
            }
        }
    });
    Ok(bound)
}

fn serve(desk: &Desk, mut stream: TcpStream, peer: SocketAddr) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(LONGEST_WRITE))?;
    let (mut out, closer) = (stream.try_clone()?, stream.try_clone()?);
    let presence = desk.presence(peer.to_string());
    let outlet = Outlet::start(
        Arc::clone(&presence),
        move |text| out.write_all(text.as_bytes()).is_ok(),
        move || {
            let _ = closer.shutdown(Shutdown::Both);
        },
    );
    if desk.ask(outlet) {
        desk.pass_on(&presence, desk.guarded_gate(), |bytes| stream.read(bytes));
        stream.shutdown(Shutdown::Both)?;
    }
    Ok(())
}
