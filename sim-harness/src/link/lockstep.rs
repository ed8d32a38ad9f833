//! A controller at the other end of a connection, in lockstep with a plant at this end. A
//! twin of the controller in this process gets the same inputs and must give outputs with
//! the same bits.

use super::{Client, EmulatedDrives, InProcess, LinkError, Target, TargetError, motors_of};
use crate::boards::{Facts, Ticks};
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::BrushedDrives;
use fivebar_firmware::motion::{StreamConfig, StreamPoint};
use fivebar_firmware::planner::{MoveErrorKind, StreamError, StreamProgress};
use fivebar_firmware::protocol::{
    Board, CommandError, ControllerMessage, HostCommand, Identity, Reply, Sequence, StepResult,
    encode,
};
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::{ArmCommand, ArmSample, Move, Settings, Status};
use serde::Serialize;
use std::fmt::Debug;
use std::io::{Read, Write};

/// Time of the ticks without another command after which the host requests the status, so that
/// the controller does not consider it silent [s].
const LONGEST_SILENCE: f32 = 0.04;

/// A [`Target`] that runs each tick at the other end and in the twin, and compares them.
pub struct Lockstep<L, I: EmulatedDrives = BrushedDrives> {
    client: Client<L>,
    twin: InProcess<I>,
    silence: u32,
    /// [`LONGEST_SILENCE`] [ticks].
    longest_silence: u32,
    instructions: Instructions,
    ticks: u64,
    first_difference: Option<Difference>,
}

/// Instructions per tick, counted at the other end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instructions {
    /// Fewest in a tick.
    pub min: u32,
    /// Most in a tick.
    pub max: u32,
    /// In all ticks together.
    pub total: u64,
}

/// The first difference between board and twin.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
#[error("tick {tick}: {field} is {there} on the board and {here} in this process")]
pub struct Difference {
    /// The tick, counted from 1.
    pub tick: u64,
    /// The output that differs.
    pub field: &'static str,
    /// Its value in this process.
    pub here: String,
    /// Its value at the other end.
    pub there: String,
}

/// Why a run in lockstep cannot begin.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockstepError {
    /// The controller is silent or the connection failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The twin's settings are not valid.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The other end has its own clock.
    #[error(
        "this controller has its own clock, because it drives motors; a run in lockstep needs \
         a board with the image `{0}`"
    )]
    OwnClock(&'static str),
    /// The other end is for other motors.
    #[error("this controller is for {0}; the run needs a board with the image `{1}`")]
    ForOthers(&'static str, &'static str),
    /// The other end refuses the settings.
    #[error("the controller refuses the settings: {0:?}")]
    Refused(CommandError),
}

impl<L: Read + Write, I: EmulatedDrives> Lockstep<L, I> {
    /// Sends `settings` to the other end and applies the settings `twin` to the twin. They
    /// are the same, except in tests that need a difference.
    ///
    /// # Errors
    /// A silent controller, one with its own clock or for other motors, or refused settings.
    pub fn begin(
        line: L,
        settings: &Settings,
        twin: &Settings,
    ) -> Result<(Self, Identity), LockstepError> {
        let twin = InProcess::new(twin)?;
        let (mut client, identity) = Client::open(line)?;
        let motors = motors_of(identity.board);
        if identity.board != Board::Desktop && motors != motors_of(I::BOARD) {
            return Err(LockstepError::ForOthers(motors, I::IMAGE));
        }
        // Checked before the settings change; applying settings resets what this tick did.
        let is_stepped = match Facts::of(identity.board).ticks {
            // They know samples of brushed motors only.
            Ticks::Own => false,
            Ticks::Host | Ticks::Either => {
                let tick = HostCommand::Tick(ArmSample::<I::Sample>::default());
                let reply = client.exchange::<_, I::Command>(tick)?;
                !matches!(reply, Reply::Refused(CommandError::Unsupported))
            }
        };
        if !is_stepped {
            return Err(LockstepError::OwnClock(I::IMAGE));
        }
        client
            .write_settings(settings)?
            .map_err(LockstepError::Refused)?;
        let lockstep = Self {
            client,
            twin,
            silence: 0,
            longest_silence: (LONGEST_SILENCE * settings.control.tick_rate) as u32,
            instructions: Instructions::default(),
            ticks: 0,
            first_difference: None,
        };
        Ok((lockstep, identity))
    }

    /// Ticks run so far.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Instructions per tick so far.
    pub fn instructions(&self) -> Instructions {
        self.instructions
    }

    /// The first output whose bits differ from the twin's.
    pub fn first_difference(&self) -> Option<&Difference> {
        self.first_difference.as_ref()
    }

    /// The client of the other end.
    pub fn client(&mut self) -> &mut Client<L> {
        &mut self.client
    }

    /// Begins a stream of set-points at both ends. Inside: why the board begins none.
    ///
    /// # Errors
    /// The board does not reply.
    pub fn begin_stream(
        &mut self,
        config: &StreamConfig,
    ) -> Result<Result<(), StreamError>, TargetError> {
        let here = self.twin.called().begin_stream(config);
        let there = match self.call(HostCommand::BeginStream(*config))? {
            Reply::Done => Ok(()),
            Reply::Refused(CommandError::Stream(error)) => Err(error),
            reply => return Err(unexpected(&reply)),
        };
        if here != there {
            let show = |outcome| format!("{outcome:?}");
            self.note_difference(Some(("stream", show(here), show(there))));
        }
        Ok(there)
    }

    /// Gives both ends the n-th point of the stream.
    ///
    /// # Errors
    /// A failed connection.
    pub fn send_point(&mut self, n: u16, point: &StreamPoint) -> Result<(), TargetError> {
        self.silence = 0;
        self.twin.called().take_point(n, point);
        Ok(self.client.send_point(n, point)?)
    }

    /// Ends the stream at both ends behind its last point.
    ///
    /// # Errors
    /// The board does not reply.
    pub fn end_stream(&mut self) -> Result<(), TargetError> {
        self.twin.called().end_stream();
        match self.call(HostCommand::EndStream)? {
            Reply::Done => Ok(()),
            reply => Err(unexpected(&reply)),
        }
    }

    /// What the stream has done in the twin, and by the board's last message.
    pub fn stream(&mut self) -> [Option<StreamProgress>; 2] {
        let client = &mut self.client;
        let there = core::iter::from_fn(|| client.take_stream_state()).last();
        [
            self.twin.called().stream(),
            there.map(|state| state.progress),
        ]
    }

    fn call(&mut self, command: HostCommand<I::Sample>) -> Result<Reply<I::Command>, TargetError> {
        self.silence = 0;
        Ok(self.client.exchange(command)?)
    }

    fn note_difference(&mut self, difference: Option<(&'static str, String, String)>) {
        if let (None, Some((field, here, there))) = (&self.first_difference, difference) {
            self.first_difference = Some(Difference {
                tick: self.ticks,
                field,
                here,
                there,
            });
        }
    }

    fn count(&mut self, instructions: u32) {
        let Instructions { min, max, total } = &mut self.instructions;
        *min = if self.ticks == 1 {
            instructions
        } else {
            instructions.min(*min)
        };
        *max = instructions.max(*max);
        *total += u64::from(instructions);
    }
}

impl<L: Read + Write, I: EmulatedDrives> Target<I> for Lockstep<L, I> {
    fn tick(
        &mut self,
        sample: &ArmSample<I::Sample>,
    ) -> Result<(ArmCommand<I::Command>, Status), TargetError> {
        self.silence += 1;
        if self.silence >= self.longest_silence {
            self.call(HostCommand::Status)?;
        }
        let there = match self.client.exchange(HostCommand::Tick(*sample))? {
            Reply::StepResult(result) => result,
            reply => return Err(unexpected(&reply)),
        };
        let (command, status) = self.twin.tick(sample)?;
        let here = StepResult::new(command, &status, there.instructions);
        self.ticks += 1;
        self.count(there.instructions);
        self.note_difference(difference::<I>(&here, &there));
        let status = Status {
            state: there.state,
            fault: there.fault,
            angle: there.angle,
            velocity: there.velocity,
            tool: there.tool,
            current_demand: there.current_demand,
            tool_level: self.twin.tool_level(there.command.tool),
            ..status
        };
        Ok((there.command, status))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        let here = self.twin.request(request);
        let there = match self.call(HostCommand::Request(request))? {
            Reply::Done => Ok(()),
            Reply::Refused(CommandError::Request(error)) => {
                Err(TargetError::Request { request, error })
            }
            reply => Err(unexpected(&reply)),
        };
        if here.is_ok() != there.is_ok() {
            self.note_difference(Some(("request", text(&here), text(&there))));
        }
        there
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        let here = self.twin.offer(next);
        let there = match self.call(HostCommand::Move(*next))? {
            Reply::Taken { .. } => Ok(true),
            Reply::Refused(CommandError::Move(error)) if error.kind == MoveErrorKind::Full => {
                Ok(false)
            }
            Reply::Refused(CommandError::Move(error)) => Err(TargetError::Move(error)),
            reply => Err(unexpected(&reply)),
        };
        if text(&here) != text(&there) {
            self.note_difference(Some(("move", text(&here), text(&there))));
        }
        there
    }

    fn is_idle(&self) -> bool {
        self.twin.is_idle()
    }
}

fn unexpected(reply: &impl Debug) -> TargetError {
    TargetError::Unexpected(format!("{reply:?}"))
}

fn text<T: Debug>(outcome: &Result<T, TargetError>) -> String {
    match outcome {
        Ok(value) => format!("{value:?}"),
        Err(error) => error.to_string(),
    }
}

/// The first field whose bits differ: its name, its value here and its value there. What goes to the drives is
/// the last one.
fn difference<I: EmulatedDrives>(
    here: &StepResult<I::Command>,
    there: &StepResult<I::Command>,
) -> Option<(&'static str, String, String)> {
    let frame = |&reply: &_| {
        let (sequence, reply) = (Sequence(0), Reply::StepResult(reply));
        encode(&ControllerMessage::Reply { sequence, reply })
    };
    if frame(here) == frame(there) {
        return None;
    }
    let bits = |pair: [f32; 2]| pair.map(f32::to_bits);
    let discrete = |result: &StepResult<I::Command>| {
        let StepResult {
            command,
            tick,
            state,
            fault,
            ..
        } = *result;
        let ArmCommand {
            enable,
            brake,
            tool,
            ..
        } = command;
        (enable, brake, tool, tick, state, fault)
    };
    if discrete(here) != discrete(there) {
        let show = |result| format!("{:?}", discrete(result));
        return Some((
            "enable, brake, tool, tick, state, fault",
            show(here),
            show(there),
        ));
    }
    if here.tool.map(bits) != there.tool.map(bits) {
        return Some((
            "tool",
            format!("{:?}", here.tool),
            format!("{:?}", there.tool),
        ));
    }
    let pairs = [
        ("angle", here.angle, there.angle),
        ("velocity", here.velocity, there.velocity),
        ("current_demand", here.current_demand, there.current_demand),
    ];
    let pair = pairs
        .into_iter()
        .find(|&(_, here, there)| bits(here) != bits(there));
    Some(match pair {
        Some((field, here, there)) => (field, format!("{here:?}"), format!("{there:?}")),
        None => (
            I::OUTPUTS,
            format!("{:?}", here.command.drives),
            format!("{:?}", there.command.drives),
        ),
    })
}
