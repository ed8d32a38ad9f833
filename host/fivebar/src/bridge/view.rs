//! What reports tell of the machine.

use super::machine::{Machine, Phase};
use super::protocol::{MachineState, View};
use fivebar_firmware::safety::State;

impl Machine<'_> {
    /// Measures the tool's speed between two looks at the status.
    pub(super) fn measure_speed(&mut self) {
        let (tick, before, _) = self.speed;
        let passed = self.status.tick.wrapping_sub(tick);
        if passed == 0 {
            return;
        }
        let speed = match (before, self.status.reference) {
            (Some([x0, y0]), Some([x, y])) => {
                let time = f64::from(passed) / f64::from(self.settings.control.tick_rate);
                f64::from((x - x0).hypot(y - y0)) / time
            }
            _ => 0.0,
        };
        self.speed = (self.status.tick, self.status.reference, speed);
    }

    /// The machine as a report shows it.
    pub(super) fn view(&self) -> View {
        let state = match self.phase {
            _ if self.status.fault.is_some() => MachineState::Alarm,
            Phase::Homing => MachineState::Home,
            Phase::Hold { rests } => MachineState::Hold { rests },
            _ if !self.status.homed => MachineState::Alarm,
            _ if self.jogs => MachineState::Jog,
            Phase::Ready if self.path.is_empty() && !self.moves() => MachineState::Idle,
            Phase::Ready | Phase::Dropping => MachineState::Run,
        };
        View {
            state,
            homed: self.status.homed,
            armed: matches!(self.status.state, State::Armed | State::Running),
            tool: self.status.tool.map(|tool| tool.map(f64::from)),
            speed: self.speed.2,
            level: f64::from(self.status.tool_level),
            shares: self.path.shares(),
            room: self.room,
            waiting: self.sender.as_ref().map_or(0, |sender| sender.waiting),
        }
    }
}
