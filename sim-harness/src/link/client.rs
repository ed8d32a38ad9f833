//! The host's end of a connection to a controller: it sends one command at a time, and
//! repeats it until the reply arrives.

use super::READ;
use fivebar_firmware::drives::{BrushedCommand, BrushedSample, DriveInterface};
use fivebar_firmware::motion::StreamPoint;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, Decoder, HostCommand, HostMessage, Identity, LinkCounts,
    Reply, SectionKey, Sequence, StackUse, StepResult, StreamState, Telemetry, VERSION, encode,
};
use fivebar_firmware::{ArmSample, Settings, Status, ToldSample};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::fmt::Debug;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Wait for a reply before the first repetition. This wait and the next, twice as long,
/// end before the command timeout of 0.1 s: two lost frames in a row do not stop a moving
/// arm.
const FIRST_WAIT: Duration = Duration::from_millis(30);
/// Each wait is twice the one before, up to this: a slow controller, such as an emulated
/// one on a busy machine, gets few repetitions.
const LONGEST_WAIT: Duration = Duration::from_millis(480);
/// Number of attempts after which the controller counts as silent. They take more than 6 s,
/// longer than the controller needs to erase its flash.
const ATTEMPTS: u32 = 16;

/// The wait after each attempt.
fn waits() -> impl Iterator<Item = Duration> {
    let doubled = |wait: &Duration| Some((2 * *wait).min(LONGEST_WAIT));
    std::iter::successors(Some(FIRST_WAIT), doubled).take(ATTEMPTS as usize)
}

/// A client of a controller over the connection `L`, whose reads time out
/// ([`ErrorKind::TimedOut`]).
#[derive(Debug)]
pub struct Client<L> {
    line: L,
    decoder: Decoder<ControllerMessage>,
    last: Sequence,
    telemetry: VecDeque<Telemetry>,
    stream: VecDeque<StreamState>,
    unread: VecDeque<u8>,
    repeats: u32,
    /// The time by which it waits for replies, from any beginning.
    clock: fn(&L) -> Duration,
}

/// Why there is no usable reply.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// No reply arrived.
    #[error(
        "the controller is silent: no reply to {ATTEMPTS} attempts in {:.0} s; check that it is \
         powered and connected, and that its firmware is of this release",
        waits().sum::<Duration>().as_secs_f64()
    )]
    Silent,
    /// The controller uses another version of the protocol.
    #[error(
        "the controller uses version {0} of the protocol and this program version {VERSION}: install \
         firmware and program of the same release"
    )]
    Version(u16),
    /// The connection failed.
    #[error("the connection to the controller failed: {0}")]
    Connection(#[from] io::Error),
    /// The reply does not belong to the command.
    #[error("the controller replied to {command} with {reply}, which is no reply to it")]
    UnexpectedReply {
        /// The command, as sent.
        command: String,
        /// The reply, as received.
        reply: String,
    },
}

impl<L: Read + Write> Client<L> {
    /// Opens a session: sends `Hello` until the controller replies.
    ///
    /// # Errors
    /// A silent controller, a failed connection, or another version of the protocol.
    pub fn open(line: L) -> Result<(Self, Identity), LinkError> {
        Self::open_with_clock(line, computer_time)
    }

    /// As [`Client::open`], with waits by the time of a simulated controller: a computer that is too
    /// slow for real time makes none of its replies late.
    ///
    /// # Errors
    /// As [`Client::open`].
    pub fn open_with_clock(
        line: L,
        clock: fn(&L) -> Duration,
    ) -> Result<(Self, Identity), LinkError> {
        let mut client = Self {
            line,
            decoder: Decoder::new(),
            last: Sequence(0),
            telemetry: VecDeque::new(),
            stream: VecDeque::new(),
            unread: VecDeque::new(),
            repeats: 0,
            clock,
        };
        let hello = HostCommand::Hello {
            version: VERSION,
            session: new_session(),
        };
        match client.call(hello)? {
            Reply::Hello(identity) if identity.version == VERSION => Ok((client, identity)),
            Reply::Hello(identity) => Err(LinkError::Version(identity.version)),
            Reply::Refused(CommandError::Version(version)) => Err(LinkError::Version(version)),
            other => Err(unexpected(&hello, &other)),
        }
    }

    /// Sends a command and returns its reply, which may be an error.
    ///
    /// # Errors
    /// A silent controller or a failed connection.
    pub fn call(&mut self, command: HostCommand) -> Result<Reply, LinkError> {
        self.exchange::<BrushedSample, BrushedCommand>(command)
    }

    /// As [`Client::call`], where a tick has a sample `S` and a command `C`.
    ///
    /// # Errors
    /// As [`Client::call`].
    pub fn exchange<S, C>(&mut self, command: HostCommand<S>) -> Result<Reply<C>, LinkError>
    where
        S: Serialize + DeserializeOwned,
        C: Serialize + DeserializeOwned,
    {
        let sequence = self.last.next();
        let message = HostMessage { sequence, command };
        let frame = encode(&message).ok_or_else(too_long)?;
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

    /// Sends a command that is either done or refused.
    ///
    /// # Errors
    /// A silent controller, a failed connection or an unexpected reply. A refusal is the
    /// inner error.
    pub fn command(&mut self, command: HostCommand) -> Result<Result<(), CommandError>, LinkError> {
        match self.call(command)? {
            Reply::Done | Reply::Taken { .. } => Ok(Ok(())),
            Reply::Refused(error) => Ok(Err(error)),
            other => Err(unexpected(&command, &other)),
        }
    }

    /// The controller's status, and how many more moves it accepts now.
    ///
    /// # Errors
    /// A silent controller or a failed connection.
    pub fn status(&mut self) -> Result<(Status, u8), LinkError> {
        match self.call(HostCommand::Status)? {
            Reply::Status { status, free } => Ok((status, free)),
            other => Err(unexpected(&HostCommand::<BrushedSample>::Status, &other)),
        }
    }

    /// Runs one tick on a board in lockstep.
    ///
    /// # Errors
    /// A silent controller, a failed connection, or a board with its own clock.
    pub fn tick<I: DriveInterface>(
        &mut self,
        sample: ArmSample<I::Sample>,
    ) -> Result<StepResult<I::Command>, LinkError> {
        let command = HostCommand::Tick(sample);
        match self.exchange(command)? {
            Reply::StepResult(result) => Ok(result),
            other => Err(unexpected(&command, &other)),
        }
    }

    /// How much of its stack the controller has used; none if it does not measure it.
    ///
    /// # Errors
    /// A silent controller or a failed connection.
    pub fn stack(&mut self) -> Result<Option<StackUse>, LinkError> {
        match self.call(HostCommand::Stack)? {
            Reply::Stack(used) => Ok(Some(used)),
            Reply::Refused(CommandError::Unsupported) => Ok(None),
            other => Err(unexpected(&HostCommand::<BrushedSample>::Stack, &other)),
        }
    }

    /// The sensor sample of the controller's last tick; none from a board whose samples come from
    /// its host.
    ///
    /// # Errors
    /// A silent controller or a failed connection.
    pub fn sample(&mut self) -> Result<Option<ToldSample>, LinkError> {
        match self.call(HostCommand::Sample)? {
            Reply::Sample(sample) => Ok(Some(sample)),
            Reply::Refused(CommandError::Unsupported) => Ok(None),
            other => Err(unexpected(&HostCommand::<BrushedSample>::Sample, &other)),
        }
    }

    /// Reads the settings in use, section by section, into `settings`.
    ///
    /// # Errors
    /// A silent controller or a failed connection.
    pub fn read_settings(&mut self, settings: &mut Settings) -> Result<(), LinkError> {
        for key in SectionKey::ALL {
            let command = HostCommand::GetSection(key);
            match self.call(command)? {
                Reply::Section(section) if section.put(settings).is_some() => {}
                other => return Err(unexpected(&command, &other)),
            }
        }
        Ok(())
    }

    /// Sends settings and applies them: all of them, or none if one is refused.
    ///
    /// # Errors
    /// A silent controller or a failed connection. A refusal is the inner error.
    pub fn write_settings(
        &mut self,
        settings: &Settings,
    ) -> Result<Result<(), CommandError>, LinkError> {
        for section in SectionKey::ALL.iter().filter_map(|key| key.of(settings)) {
            if let Err(error) = self.command(HostCommand::SetSection(section))? {
                return Ok(Err(error));
            }
        }
        self.command(HostCommand::ApplySettings)
    }

    /// Sends the n-th point of a stream of set-points. It gets no reply.
    ///
    /// # Errors
    /// A failed connection.
    pub fn send_point(&mut self, n: u16, point: &StreamPoint) -> Result<(), LinkError> {
        let message = HostMessage::<BrushedSample> {
            sequence: Sequence(n),
            command: HostCommand::Point(*point),
        };
        self.line
            .write_all(&encode(&message).ok_or_else(too_long)?)?;
        Ok(self.line.flush()?)
    }

    /// Reads once and keeps a sample of telemetry or the state of a stream that arrives.
    ///
    /// # Errors
    /// A failed connection.
    pub fn poll(&mut self) -> Result<(), LinkError> {
        if let Some(message) = self.next_message::<BrushedCommand>()? {
            self.keep(&message);
        }
        Ok(())
    }

    /// Keeps what is no reply. A reply is a late one to a command that was sent twice.
    fn keep<C>(&mut self, message: &ControllerMessage<C>) {
        match message {
            ControllerMessage::Telemetry(sample) => self.telemetry.push_back(*sample),
            ControllerMessage::Stream(state) => self.stream.push_back(*state),
            ControllerMessage::Reply { .. } => {}
        }
    }

    /// Takes the oldest state of a stream received.
    pub fn take_stream_state(&mut self) -> Option<StreamState> {
        self.stream.pop_front()
    }

    /// Takes the oldest sample received.
    pub fn take_telemetry(&mut self) -> Option<Telemetry> {
        self.telemetry.pop_front()
    }

    /// The connection itself.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }

    /// The frames received, whole and damaged.
    pub fn counts(&self) -> LinkCounts {
        self.decoder.counts()
    }

    /// How many times a command was sent again.
    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The reply with this sequence number; none if it does not arrive within `wait`.
    fn reply_to<C: Serialize + DeserializeOwned>(
        &mut self,
        sequence: Sequence,
        wait: Duration,
    ) -> Result<Option<Reply<C>>, LinkError> {
        let deadline = (self.clock)(&self.line) + wait;
        // On a connection within this process reads take no time: count timed-out reads too.
        let max_idle_reads = wait.as_millis() / READ.as_millis();
        let mut idle_reads = 0;
        while (self.clock)(&self.line) < deadline && idle_reads < max_idle_reads {
            match self.next_message::<C>()? {
                Some(ControllerMessage::Reply { sequence: s, reply }) if s == sequence => {
                    return Ok(Some(reply));
                }
                Some(other) => self.keep(&other),
                None => idle_reads += u128::from(self.unread.is_empty()),
            }
        }
        Ok(None)
    }

    /// The next whole message; none if a read times out first.
    fn next_message<C: Serialize + DeserializeOwned>(
        &mut self,
    ) -> Result<Option<ControllerMessage<C>>, LinkError> {
        while let Some(byte) = self.unread.pop_front() {
            if let Some(Ok(message)) = self.decoder.feed_as(byte) {
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

fn too_long() -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, "a command is longer than a frame")
}

/// This computer's time since its first use here.
fn computer_time<L>(_: &L) -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed()
}

/// A session number that no recent session has used.
fn new_session() -> u32 {
    static OPENED: AtomicU32 = AtomicU32::new(0);
    let opened = OPENED.fetch_add(1, Ordering::Relaxed);
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.map_or(0, |now| now.as_micros() as u32);
    now.wrapping_add(opened)
        .wrapping_add(std::process::id() << 16)
}

fn unexpected(command: &impl Debug, reply: &impl Debug) -> LinkError {
    LinkError::UnexpectedReply {
        command: format!("{command:?}"),
        reply: format!("{reply:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::waits;
    use std::time::Duration;

    #[test]
    fn two_lost_frames_stay_within_the_command_timeout_and_a_slow_controller_gets_few_repeats() {
        let until = |count| waits().take(count).sum::<Duration>();
        assert!(until(2) < Duration::from_millis(100), "{:?}", until(2));
        // Five attempts in all during a stall of one second.
        assert!(until(5) > Duration::from_millis(900), "{:?}", until(5));
        assert!(until(usize::MAX) > Duration::from_secs(6));
    }
}
