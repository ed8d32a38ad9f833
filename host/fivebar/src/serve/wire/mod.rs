//! What passes between the pages and the controller's thread.
//!
//! | module | content |
//! |---|---|
//! | `message`, `numbered` | the messages between pages and server; the numbers of requests |
//! | `lease` | a page's connection; which page is in control, and whether it is alive |
//! | `stop_signal` | stops, on a path past every queue |
//! | `channels` | what else passes between pages and controller |
//! | `updates` | what the controller's thread sends to the pages, without waiting for them |

pub(super) mod channels;
pub(super) mod lease;
pub(super) mod message;
pub(super) mod numbered;
pub(super) mod stop_signal;
pub(super) mod updates;
