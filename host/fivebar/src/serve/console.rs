//! The console: a line of G-code from the page in control, answered as the bridge answers a sender.
//!
//! A console is a sender of its own and begins with the first line. It ends when its page asks for something else that
//! senders exclude, such as a jog, or is in control no more; then G91, G92 and F are forgotten.

use super::controller_thread::ControllerThread;
use super::requests::Refused;
use super::wire::lease::PageId;
use super::wire::message::ServerMessage;

/// Longest line of a console [bytes].
const LONGEST: usize = 256;

impl ControllerThread {
    /// Sends a line to the console of the page in control.
    pub(super) fn send_to_console(
        &mut self,
        page: PageId,
        mut line: String,
    ) -> Result<(), Refused> {
        if self.is_sender_in_control() && self.console_in_control() != Some(page) {
            return Err("A sender of G-code is in control: disconnect it first.".into());
        }
        if self.feeder.is_running() {
            return Err("A job is running: stop it first.".into());
        }
        if line.len() > LONGEST {
            return Err(format!("A line has at most {LONGEST} characters."));
        }
        // Other bytes are commands of Grbl.
        if !line.is_ascii() {
            return Err("A line has ASCII characters only.".into());
        }
        line.push('\n');
        // A console that was refused control has ended.
        let console = self.console.take_if(|&mut (of, _)| of == page);
        let unsent = match &console {
            Some((_, console)) => console.input.send(line).err().map(|unsent| unsent.0),
            None => Some(line),
        };
        self.console = console;
        if let Some(line) = unsent {
            self.feeder.drop_target();
            let console = self.senders.open_console();
            // It takes lines from the beginning.
            let _ = console.input.send(line);
            self.console = Some((page, console));
        }
        Ok(())
    }

    /// The page whose console is in control.
    pub(super) fn console_in_control(&self) -> Option<PageId> {
        let (page, _) = self.console.as_ref()?;
        self.senders.is_console_in_control().then_some(*page)
    }

    /// Ends the console where it rests, so that its page can do something else, or another one take control; why it
    /// cannot.
    pub(super) fn take_control_from_senders(&mut self) -> Result<(), Refused> {
        if !self.is_sender_in_control() {
            return Ok(());
        }
        if self.console_in_control().is_none() {
            return Err("A sender of G-code is in control: disconnect it first.".into());
        }
        if !self.senders.release_console(&self.session) {
            return Err("The console's lines are in progress: wait, or stop the arm.".into());
        }
        self.console = None;
        Ok(())
    }

    /// Ends the console of a page that is in control no more: the arm comes to rest on its path.
    pub(super) fn drop_console_of_a_lost_page(&mut self) {
        let lease = &self.pages.shared.lease;
        let now = self.session.clock.now();
        self.console
            .take_if(|&mut (page, _)| !lease.is_held_by(page, now));
    }

    /// Sends the console's answers to its page.
    pub(super) fn pass_on_answers(&mut self) {
        let Some((page, console)) = &self.console else {
            return;
        };
        let text: String = console.output.try_iter().collect();
        if !text.is_empty() {
            let to = *page;
            self.updates.send(&ServerMessage::Console { to, text });
        }
    }
}
