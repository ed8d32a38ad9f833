//! The protocols of senders: text in, orders and answers out, without input or output.
//!
//! | module | content |
//! |---|---|
//! | `splitter` | from bytes to lines and real-time commands |
//! | `gate` | which connections are a sender's: web browsers are kept out |
//! | `engine` | what a line asks for, and the answers to it |
//! | `grbl` | the words of Grbl 1.1 |
//! | `reprap` | the words of RepRap: line numbers, checksums, reports |

mod engine;
mod gate;
mod grbl;
mod reprap;
mod splitter;
#[cfg(test)]
mod tests;

pub(super) use engine::{Engine, MachineState, Order, Refusal, Response, View};
pub(super) use gate::Gate;
#[cfg(test)]
use splitter::Splitter;
pub(super) use splitter::{Input, Line, RealTime, ShareChange};
