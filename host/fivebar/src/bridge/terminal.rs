//! Senders at a pseudo-terminal, which this user's programs open like a serial port.

#[cfg(not(unix))]
pub(super) fn open(_: super::connection::Desk) -> std::io::Result<Option<String>> {
    Ok(None)
}

#[cfg(unix)]
pub(super) use unix::open;

#[cfg(unix)]
mod unix {
    use crate::bridge::connection::{Desk, Outlet};
    use serialport::{SerialPort as _, TTYPort};
    use std::fs::{Permissions, set_permissions};
    use std::io::{self, ErrorKind, Read as _, Write};
    use std::os::unix::fs::PermissionsExt as _;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;
    use std::time::Duration;

    /// Time between two looks at a pseudo-terminal that no program has open.
    const LOOK: Duration = Duration::from_millis(20);
    /// Longest wait for a sender that does not read.
    const LONGEST_WRITE: Duration = Duration::from_secs(10);
    /// This user reads and writes; the system lets the group `tty` write too.
    const OWNER_ONLY: u32 = 0o600;

    /// Opens a pseudo-terminal. A program that opens it is a sender until it closes it.
    pub(in crate::bridge) fn open(desk: Desk) -> io::Result<Option<String>> {
        let (mut master, slave) = TTYPort::pair()?;
        let name = slave.name();
        drop(slave);
        if let Some(name) = &name {
            set_permissions(name, Permissions::from_mode(OWNER_ONLY))?;
        }
        let path = name.clone();
        let mut out = master.try_clone_native()?;
        master.set_timeout(LOOK)?;
        out.set_timeout(LOOK)?;
        thread::spawn(move || {
            loop {
                // While no program has the terminal open, reading fails at once.
                let mut first = [0; 1024];
                let count = match master.read(&mut first) {
                    Ok(count) => count,
                    Err(error) if error.kind() == ErrorKind::TimedOut => 0,
                    Err(_) => {
                        thread::sleep(LOOK);
                        continue;
                    }
                };
                make_raw(path.as_deref());
                if let Ok(writer) = out.try_clone_native() {
                    serve(&desk, &mut master, writer, &first[..count]);
                }
                // A program that has lost control opens the terminal anew to ask for it.
                while !is_closed(&mut master) {}
            }
        });
        Ok(name)
    }

    fn serve(desk: &Desk, master: &mut TTYPort, mut writer: TTYPort, first: &[u8]) {
        let presence = desk.presence("the terminal");
        let closed = Arc::new(AtomicBool::new(false));
        let (close, line) = (Arc::clone(&closed), Arc::clone(&presence));
        let outlet = Outlet::start(
            Arc::clone(&presence),
            move |text| {
                let begun = line.clock.now();
                let goes_on = || line.ended().is_none() && line.clock.since(begun) < LONGEST_WRITE;
                write_slowly(&mut writer, text.as_bytes(), goes_on).is_ok()
            },
            move || close.store(true, Ordering::SeqCst),
        );
        if !desk.ask(outlet) {
            return;
        }
        let mut first = Some(first).filter(|first| !first.is_empty());
        desk.pass_on(&presence, desk.open_gate(), |bytes| {
            if closed.load(Ordering::SeqCst) {
                return Err(ErrorKind::ConnectionAborted.into());
            }
            if let Some(first) = first.take() {
                bytes[..first.len()].copy_from_slice(first);
                return Ok(first.len());
            }
            master.read(bytes)
        });
    }

    /// Whether no program has the terminal open. Bytes that wait are dropped.
    fn is_closed(master: &mut TTYPort) -> bool {
        let read = master.read(&mut [0; 1024]);
        matches!(read, Err(error) if error.kind() != ErrorKind::TimedOut)
    }

    /// Sets the terminal to pass bytes unchanged, for programs that open it like a file. A program
    /// that has it for itself has done so.
    fn make_raw(path: Option<&str>) {
        let builder = path.map(|path| serialport::new(path, 0));
        drop(builder.map(|builder| TTYPort::open(&builder.exclusive(false))));
    }

    /// Writes to a terminal whose reader may be slow.
    fn write_slowly(
        out: &mut impl Write,
        mut bytes: &[u8],
        goes_on: impl Fn() -> bool,
    ) -> io::Result<()> {
        while !bytes.is_empty() {
            match out.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::TimedOut && goes_on() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
