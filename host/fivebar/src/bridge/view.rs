//! What reports show of the arm and its sender.

use super::protocol::{MachineState, View};
use super::slot::{Phase, SenderSlot, moves};
use fivebar_firmware::Status;
use fivebar_firmware::safety::State;
use fivebar_sim::controller::Session;

/// The tool's speed between two statuses.
pub(super) struct ToolSpeed {
    /// The tick of the latest status.
    tick: u32,
    /// The reference in it [m].
    reference: Option<[f32; 2]>,
    /// The speed up to it [m/s].
    speed: f64,
}

impl ToolSpeed {
    /// Begins to measure in this tick.
    pub(super) fn from(tick: u32) -> Self {
        Self {
            tick,
            reference: None,
            speed: 0.0,
        }
    }

    /// Measures the speed up to this status.
    pub(super) fn measure(&mut self, status: &Status, tick_rate: f32) {
        let passed = status.tick.wrapping_sub(self.tick);
        if passed == 0 {
            return;
        }
        self.speed = match (self.reference, status.reference) {
            (Some([x0, y0]), Some([x, y])) => {
                let time = f64::from(passed) / f64::from(tick_rate);
                f64::from((x - x0).hypot(y - y0)) / time
            }
            _ => 0.0,
        };
        self.tick = status.tick;
        self.reference = status.reference;
    }
}

impl SenderSlot<'_> {
    /// The machine as a report shows it.
    pub(super) fn view(&self, session: &Session) -> View {
        let state = match self.phase {
            _ if session.status.fault.is_some() => MachineState::Alarm,
            Phase::Homing => MachineState::Home,
            Phase::Holding { .. } => MachineState::Hold { rests: false },
            Phase::Held => MachineState::Hold { rests: true },
            _ if !session.status.homed => MachineState::Alarm,
            _ if self.path.is_jog => MachineState::Jog,
            Phase::Ready if self.path.queue.is_empty() && !moves(&session.status) => {
                MachineState::Idle
            }
            Phase::Ready | Phase::Dropping => MachineState::Run,
        };
        View {
            state,
            homed: session.status.homed,
            armed: matches!(session.status.state, State::Armed | State::Running),
            tool: session.status.tool.map(|tool| tool.map(f64::from)),
            speed: self.speed.speed,
            level: f64::from(session.status.tool_level),
            shares: self.path.queue.shares(),
            free: self.path.free,
            waiting: self.sender.as_ref().map_or(0, |sender| sender.waiting),
        }
    }
}
