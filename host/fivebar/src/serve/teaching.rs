//! An arm that a hand leads for a page, and the record of what it has taught.
//!
//! The page's signs of life are the arm's: without them the controller damps the arm, and holds it 0.15 s later.

use super::wire::lease::PageId;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_kinematics::five_bar::{Side, Tool};
use fivebar_sim::controller::{Session, sentence};
use fivebar_sim::drive::LED_PERIOD;
use fivebar_sim::link::LinkError;
use fivebar_sim::teaching::{Record, TaughtPath, TeachError};

/// The name of what was taught.
pub(super) const NAME: &str = "taught.gcode";

/// An arm that a hand leads.
pub(super) struct Teaching {
    /// The page that asked for it.
    pub(super) page: PageId,
    /// The number of its stream, and of the last sign of life.
    id: u32,
    n: u16,
    record: Record,
    assembly: Side,
    /// Whether it was asked to end.
    ends: bool,
}

impl Teaching {
    /// Lets a hand lead an arm that rests in this assembly mode; or says why not.
    pub(super) fn begin(
        session: &mut Session,
        page: PageId,
        assembly: Side,
    ) -> Result<Self, String> {
        let rate = session.settings.control.tick_rate;
        let period = (LED_PERIOD as f32 * rate) as u16;
        let config = StreamConfig {
            id: session.status.tick,
            mode: StreamMode::Free,
            period,
            delay: 2 * period,
            policy: StreamPolicy::Stop,
        };
        asked(session, HostCommand::BeginStream(config))?;
        Ok(Self {
            page,
            id: config.id,
            n: 0,
            record: Record::new(rate.into()),
            assembly,
            ends: false,
        })
    }

    /// Damps the arm, then holds it.
    pub(super) fn end(&mut self, session: &mut Session) -> Result<(), String> {
        self.ends = true;
        asked(session, HostCommand::EndStream)
    }

    /// Gives the arm a sign of life if its page does, and keeps what it tells. Returns whether the arm is held again.
    pub(super) fn go_on(
        &mut self,
        session: &mut Session,
        page_is_alive: bool,
    ) -> Result<bool, LinkError> {
        if page_is_alive && !self.ends {
            self.n = self.n.wrapping_add(1);
            let point = StreamPoint {
                id: self.id,
                due: 0,
                position: (0.0, 0.0),
                velocity: (0.0, 0.0),
                force: (0.0, 0.0),
            };
            session.client.send_point(self.n, &point)?;
        } else if !self.ends {
            // The page is lost, or a stop was asked for.
            self.ends = true;
            session.client.call(HostCommand::EndStream)?;
        }
        let mut is_full = false;
        while let Some(state) = session.client.take_stream_state() {
            if state.progress.id == self.id {
                is_full |= !self.record.keep(&state);
            }
        }
        if is_full && !self.ends {
            self.ends = true;
            session.client.call(HostCommand::EndStream)?;
        }
        session.read_status()?;
        Ok(session.status.state != State::Compliant)
    }

    /// The path of the tip of an arm with this tool.
    pub(super) fn path(&self, tool: &Tool<f64>) -> Result<TaughtPath, TeachError> {
        self.record.path(NAME, tool, self.assembly)
    }
}

fn asked(session: &mut Session, command: HostCommand) -> Result<(), String> {
    match session.client.call(command) {
        Ok(Reply::Done) => Ok(()),
        Ok(Reply::Refused(refusal)) => Err(sentence(&refusal)),
        Ok(other) => Err(format!("Unexpected reply: {other:?}.")),
        Err(error) => Err(format!("The controller does not answer ({error}).")),
    }
}
