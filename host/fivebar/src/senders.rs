//! Senders of G-code, as the live page's server uses them.

use fivebar_files::robot::Robot;
use fivebar_sim::controller::Session;
use fivebar_sim::link::LinkError;
use std::error::Error;
use std::fmt;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, Sender};

/// Where senders connect.
#[derive(Clone, Debug)]
pub struct Endpoints {
    /// The address for TCP, if it was asked for.
    pub address: Option<SocketAddr>,
    /// The pseudo-terminal, on systems that have them.
    pub terminal: Option<String>,
    /// Where the controller runs.
    pub place: String,
}

/// The address and the terminal, two words.
impl fmt::Display for Endpoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.address {
            Some(address) => write!(f, "{address}")?,
            None => write!(f, "no-tcp")?,
        }
        write!(f, " {}", self.terminal.as_deref().unwrap_or("no-terminal"))
    }
}

impl Endpoints {
    /// Who can move the arm over TCP, if anybody can.
    pub fn warning(&self) -> Option<String> {
        let address = self.address?;
        let who = match address.ip().is_loopback() {
            true => "every user and program of this computer",
            false => "every computer that reaches it",
        };
        Some(format!(
            "WARNING: no password protects {address}: {who} can move the arm there"
        ))
    }
}

/// A page's console: a sender whose lines the page sends. It ends when it is dropped.
pub struct Console {
    /// What the page sends.
    pub input: Sender<String>,
    /// The answers.
    pub output: Receiver<String>,
}

/// Senders that may move the arm beside the pages. One of them at a time is in control.
pub trait Senders: Send {
    /// Where they connect; none: there are consoles only.
    fn endpoints(&self) -> Option<&Endpoints>;

    /// Opens a console, which asks for control.
    fn open_console(&mut self) -> Console;

    /// Whether the console that was opened last is in control.
    fn is_console_in_control(&self) -> bool;

    /// Whether that console is in control, its lines are done, or held by a stop, and the arm rests.
    fn is_console_idle(&self, session: &Session) -> bool;

    /// Takes control from that console if it is idle; returns whether it was.
    fn release_console(&mut self, session: &Session) -> bool;

    /// Serves the sender in control; returns whether there is one. A new one is admitted only if
    /// `admits`.
    ///
    /// # Errors
    /// The connection to the controller failed.
    fn serve(&mut self, session: &mut Session, admits: bool) -> Result<bool, LinkError>;

    /// Whether a sender is in control.
    fn is_in_control(&self) -> bool;

    /// Stops on the path; the sender can go on.
    ///
    /// # Errors
    /// The connection to the controller failed.
    fn hold(&mut self, session: &mut Session) -> Result<(), LinkError>;

    /// Latches the emergency stop, whatever the state, and drops what the sender has sent.
    ///
    /// # Errors
    /// The connection to the controller failed.
    fn emergency_stop(&mut self, session: &mut Session) -> Result<(), LinkError>;

    /// The next event that users should know.
    fn take_note(&mut self) -> Option<String>;
}

/// Why senders cannot connect.
pub type SendersError = Box<dyn Error + Send + Sync>;

/// Listens for senders that move this robot through this session; the text says where its controller
/// runs.
pub type Listen =
    Box<dyn FnOnce(&Robot, &mut Session, &str) -> Result<Box<dyn Senders>, SendersError>>;
