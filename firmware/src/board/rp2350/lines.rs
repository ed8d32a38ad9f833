//! Both lines to a host: the serial one and that over USB. The host that has begun a session last leads.
//!
//! What the other line says is not answered, but for an emergency stop, which the interrupts see, and for the beginning of a session.

use super::{serial, usb};
use crate::board::image::Lines;
use crate::board::image::tasks::Commands;
use crate::protocol::{Frame, HostCommand, HostMessage};
use heapless::spsc::Consumer;

/// The lines, for the idle task.
pub struct BothLines {
    /// The serial line.
    pub serial: (Commands, serial::Sender),
    /// The line over USB; none if its clock does not run.
    pub usb: Option<(Commands, usb::Sender)>,
    /// Whether USB leads.
    pub usb_leads: bool,
}

impl Lines for BothLines {
    fn next(&mut self) -> Option<HostMessage> {
        let (commands, _) = &mut self.serial;
        let over_usb = self.usb.as_mut().map(|(commands, _)| commands);
        let lines = [Some(commands), over_usb].into_iter().zip([false, true]);
        for (commands, is_usb) in lines {
            let Some(message) = commands.and_then(Consumer::dequeue) else {
                continue;
            };
            if matches!(message.command, HostCommand::Hello { .. }) {
                self.usb_leads = is_usb;
            }
            if self.usb_leads == is_usb {
                return Some(message);
            }
        }
        None
    }

    fn send(&mut self, frame: &Frame) {
        match (&mut self.usb, self.usb_leads) {
            (Some((_, sender)), true) => sender.send(frame),
            _ => self.serial.1.send(frame),
        }
    }

    fn advance(&mut self) {
        self.serial.1.advance();
    }
}
