//! Asking a controller: one order at a time, asked again while the line is silent.

use super::READ;
use fivebar_firmware::protocol::{
    ControllerMessage, Decoder, HostMessage, Identity, Order, Refusal, Reply, SectionKey, Sequence,
    StackUse, Telemetry, Ticked, VERSION, encode,
};
use fivebar_firmware::{Sensed, Settings, Status};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How long to wait for a reply before asking again. Two such waits, the second twice as
/// long, stay under the 0.1 s of silence at which a moving arm stops: two lost frames in a
/// row do not stop it.
const FIRST_WAIT: Duration = Duration::from_millis(30);
/// Each wait is twice the one before, up to this: a controller that is only slow, such as
/// an emulated one on a busy machine, is not flooded with repetitions.
const LONGEST_WAIT: Duration = Duration::from_millis(480);
/// How often to ask before the controller counts as silent: over 6 s, in which the
/// controller may be erasing flash.
const ATTEMPTS: u32 = 16;

/// How long to wait after each time of asking.
fn waits() -> impl Iterator<Item = Duration> {
    let doubled = |wait: &Duration| Some((2 * *wait).min(LONGEST_WAIT));
    std::iter::successors(Some(FIRST_WAIT), doubled).take(ATTEMPTS as usize)
}

/// A conversation with a controller over a line whose reads give up in time
/// ([`ErrorKind::TimedOut`]).
#[derive(Debug)]
pub struct Conversation<L> {
    line: L,
    decoder: Decoder<ControllerMessage>,
    last: Sequence,
    telemetry: VecDeque<Telemetry>,
    unread: VecDeque<u8>,
    repeats: u32,
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// Nothing came.
    #[error(
        "the controller is silent: asked {ATTEMPTS} times in {:.0} s; is it powered and connected, \
         and is its firmware of this release?",
        waits().sum::<Duration>().as_secs_f64()
    )]
    Silent,
    /// The controller speaks another version.
    #[error(
        "the controller speaks version {0} of the protocol, this program {VERSION}: its firmware is of \
         another release"
    )]
    Version(u16),
    /// The line broke.
    #[error("the line to the controller broke: {0}")]
    Line(#[from] io::Error),
    /// The controller said something that does not answer the question.
    #[error("the controller answered {order} with {reply}")]
    Confused {
        /// The order, as it was put.
        order: String,
        /// The reply, as it came.
        reply: String,
    },
}

impl<L: Read + Write> Conversation<L> {
    /// Begins a conversation: says hello until the controller answers.
    ///
    /// # Errors
    /// A silent or broken line, or another version of the protocol.
    pub fn open(line: L) -> Result<(Self, Identity), LinkError> {
        let mut conversation = Self {
            line,
            decoder: Decoder::new(),
            last: Sequence(0),
            telemetry: VecDeque::new(),
            unread: VecDeque::new(),
            repeats: 0,
        };
        let hello = Order::Hello {
            version: VERSION,
            session: new_session(),
        };
        match conversation.ask(hello)? {
            Reply::Hello(identity) if identity.version == VERSION => Ok((conversation, identity)),
            Reply::Hello(identity) => Err(LinkError::Version(identity.version)),
            Reply::Refused(Refusal::Version(version)) => Err(LinkError::Version(version)),
            other => Err(confused(&hello, &other)),
        }
    }

    /// Asks and waits for the reply, refusals included.
    ///
    /// # Errors
    /// A silent or broken line.
    pub fn ask(&mut self, order: Order) -> Result<Reply, LinkError> {
        let sequence = self.last.next();
        let message = HostMessage { sequence, order };
        let frame = encode(&message).ok_or_else(|| {
            io::Error::new(ErrorKind::InvalidInput, "an order is longer than a frame")
        })?;
        for (attempt, wait) in waits().enumerate() {
            self.repeats += u32::from(attempt > 0);
            self.line.write_all(&frame)?;
            self.line.flush()?;
            if let Some(reply) = self.reply_to(sequence, wait)? {
                self.last = sequence;
                return Ok(reply);
            }
        }
        Err(LinkError::Silent)
    }

    /// Asks for something that is either done or refused.
    ///
    /// # Errors
    /// A silent or broken line, or a reply that is neither; a refusal is the inner error.
    pub fn order(&mut self, order: Order) -> Result<Result<(), Refusal>, LinkError> {
        match self.ask(order)? {
            Reply::Done | Reply::Taken { .. } => Ok(Ok(())),
            Reply::Refused(refusal) => Ok(Err(refusal)),
            other => Err(confused(&order, &other)),
        }
    }

    /// The controller's status, and how many moves it can take.
    ///
    /// # Errors
    /// A silent or broken line.
    pub fn status(&mut self) -> Result<(Status, u8), LinkError> {
        match self.ask(Order::Status)? {
            Reply::Status { status, room } => Ok((status, room)),
            other => Err(confused(&Order::Status, &other)),
        }
    }

    /// Has a board that is stepped make one tick.
    ///
    /// # Errors
    /// A silent or broken line, or a board that ticks by itself.
    pub fn tick(&mut self, sensed: Sensed) -> Result<Ticked, LinkError> {
        let order = Order::Tick(sensed);
        match self.ask(order)? {
            Reply::Ticked(ticked) => Ok(ticked),
            other => Err(confused(&order, &other)),
        }
    }

    /// How much of its stack the controller has used; none where it does not know.
    ///
    /// # Errors
    /// A silent or broken line.
    pub fn stack(&mut self) -> Result<Option<StackUse>, LinkError> {
        match self.ask(Order::Stack)? {
            Reply::Stack(used) => Ok(Some(used)),
            Reply::Refused(Refusal::Unsupported) => Ok(None),
            other => Err(confused(&Order::Stack, &other)),
        }
    }

    /// The settings in use, section by section into `settings`.
    ///
    /// # Errors
    /// A silent or broken line.
    pub fn read_settings(&mut self, settings: &mut Settings) -> Result<(), LinkError> {
        for key in SectionKey::ALL {
            let order = Order::GetSection(key);
            match self.ask(order)? {
                Reply::Section(section) if section.put(settings).is_some() => {}
                other => return Err(confused(&order, &other)),
            }
        }
        Ok(())
    }

    /// Puts settings to use, whole or not at all.
    ///
    /// # Errors
    /// A silent or broken line; a refusal is the inner error.
    pub fn write_settings(
        &mut self,
        settings: &Settings,
    ) -> Result<Result<(), Refusal>, LinkError> {
        for section in SectionKey::ALL.iter().filter_map(|key| key.of(settings)) {
            if let Err(refusal) = self.order(Order::SetSection(section))? {
                return Ok(Err(refusal));
            }
        }
        self.order(Order::ApplySettings)
    }

    /// Lets one read's time pass and keeps the samples that come.
    ///
    /// # Errors
    /// A broken line.
    pub fn listen(&mut self) -> Result<(), LinkError> {
        if let Some(ControllerMessage::Telemetry(sample)) = self.next_message()? {
            self.telemetry.push_back(sample);
        }
        Ok(())
    }

    /// The oldest sample that came meanwhile.
    pub fn take_telemetry(&mut self) -> Option<Telemetry> {
        self.telemetry.pop_front()
    }

    /// The line itself.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }

    /// How often an order had to be sent again.
    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The reply with this number, if it comes in time.
    fn reply_to(&mut self, sequence: Sequence, wait: Duration) -> Result<Option<Reply>, LinkError> {
        let deadline = Instant::now() + wait;
        // Reads in vain that amount to the same: on a line in this process they take no
        // time.
        let most = wait.as_millis() / READ.as_millis();
        let mut idle_reads = 0;
        while Instant::now() < deadline && idle_reads < most {
            match self.next_message()? {
                Some(ControllerMessage::Reply { sequence: s, reply }) if s == sequence => {
                    return Ok(Some(reply));
                }
                Some(ControllerMessage::Telemetry(sample)) => self.telemetry.push_back(sample),
                // A late reply to an order asked twice.
                Some(ControllerMessage::Reply { .. }) => {}
                None => idle_reads += u128::from(self.unread.is_empty()),
            }
        }
        Ok(None)
    }

    /// The next whole message of the line; nothing if none comes before a read gives up.
    fn next_message(&mut self) -> Result<Option<ControllerMessage>, LinkError> {
        while let Some(byte) = self.unread.pop_front() {
            if let Some(Ok(message)) = self.decoder.feed(byte) {
                return Ok(Some(message));
            }
        }
        let mut bytes = [0; 512];
        match self.line.read(&mut bytes) {
            Ok(count) => self.unread.extend(bytes.iter().take(count)),
            Err(error) if error.kind() == ErrorKind::TimedOut => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
        Ok(None)
    }
}

/// A number that no conversation has had lately.
fn new_session() -> u32 {
    static OPENED: AtomicU32 = AtomicU32::new(0);
    let opened = OPENED.fetch_add(1, Ordering::Relaxed);
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.map_or(0, |now| now.as_micros() as u32);
    now.wrapping_add(opened)
        .wrapping_add(std::process::id() << 16)
}

fn confused(order: &Order, reply: &Reply) -> LinkError {
    LinkError::Confused {
        order: format!("{order:?}"),
        reply: format!("{reply:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::waits;
    use std::time::Duration;

    #[test]
    fn two_lost_frames_do_not_stop_an_arm_and_a_slow_controller_is_not_flooded() {
        let until = |count| waits().take(count).sum::<Duration>();
        assert!(until(2) < Duration::from_millis(100), "{:?}", until(2));
        // Asked five times in all by the end of a second's stall.
        assert!(until(5) > Duration::from_millis(900), "{:?}", until(5));
        assert!(until(usize::MAX) > Duration::from_secs(6));
    }
}
