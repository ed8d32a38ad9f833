//! Set-points of a program on their way to the controller.

use super::{Controlled, Drive, DriveError, LONGEST_STOP};
use crate::safe_exit;
use crate::streaming::{SetPoint, StreamOptions, Streamer};
use fivebar_firmware::Status;
use fivebar_firmware::motion::{Impedance, StreamConfig, StreamMode, StreamPolicy};
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamReason};
use fivebar_firmware::protocol::{CommandError, HostCommand, StreamState};

/// What a program gives next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// A point.
    Point(SetPoint),
    /// Other springs and dampers of a stream with an impedance.
    Spring(Impedance),
    /// Nothing yet: time passes.
    Nothing,
    /// The stream ends.
    End,
}

impl<C: Controlled> Drive<'_, C> {
    /// Streams the points of a program to an arm that is held, until it ends the stream. Then the arm rests.
    ///
    /// A program that pauses longer than the delay lets the arm come to rest; with its next point the arm goes on from there,
    /// smoothly back to the program's motion.
    ///
    /// # Errors
    /// The stream does not begin, a point beyond a limit, a fault, a stop by the user, or a failed connection. The arm rests
    /// then.
    pub fn follow_stream(
        &mut self,
        options: &StreamOptions,
        tick_rate: f64,
        given: &mut dyn FnMut() -> Given,
    ) -> Result<(), DriveError> {
        let config = options.config(self.fault_free_status()?.tick, tick_rate);
        if let StreamMode::Impedance(_) = options.mode {
            for (place, fixture) in (0..).zip(options.fixtures) {
                let command = HostCommand::SetFixture { place, fixture };
                self.command("set a wall or a guide", command)?;
            }
        }
        self.begin_when_free(config)?;
        if let StreamMode::Impedance(_) = options.mode {
            let felt = self.feel(&config, given);
            if felt.is_err() {
                self.bring_to_rest()?;
                return felt;
            }
            return self.end_stream(options.policy);
        }
        let tick = self.fault_free_status()?.tick;
        let mut streamer = Streamer::new(config, tick_rate, tick);
        let streamed = self.stream_points(options.mode, &mut streamer, given);
        if streamed.is_err() {
            self.bring_to_rest()?;
            return streamed;
        }
        self.end_stream(options.policy)
    }

    /// Begins a stream as soon as the arm is held.
    pub(super) fn begin_when_free(&mut self, config: StreamConfig) -> Result<(), DriveError> {
        let mut begun = self.begin_stream(config);
        for _ in 0..LONGEST_STOP {
            // Motors that have just been switched on wake up, and holding brakes release.
            let Err(DriveError::Refused { error, .. }) = &begun else {
                break;
            };
            if *error != CommandError::Stream(StreamError::Moving) {
                break;
            }
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(None));
            }
            self.controller.pass_time()?;
            begun = self.begin_stream(config);
        }
        begun?;
        // What was told of a stream before is old.
        self.latest_state();
        Ok(())
    }

    /// Ends the stream, and waits until the arm is held.
    pub(super) fn end_stream(&mut self, policy: StreamPolicy) -> Result<(), DriveError> {
        self.command("end the stream", HostCommand::EndStream)?;
        for _ in 0..LONGEST_STOP {
            let status = self.fault_free_status()?;
            let state = self.latest_state();
            let reason = state.and_then(|state| state.progress.reason);
            if let (StreamPolicy::Stop, Some(StreamReason::Limit(_))) = (policy, reason) {
                return Err(ended(state));
            }
            // The last points may not have begun.
            let over = state.is_some_and(|state| state.progress.phase == StreamPhase::Ended);
            if over && !safe_exit::moves(&status) {
                return Ok(());
            }
            self.controller.pass_time()?;
        }
        // What told of its end was lost.
        Ok(self.bring_to_rest()?)
    }

    fn begin_stream(&mut self, config: StreamConfig) -> Result<(), DriveError> {
        self.command("begin a stream", HostCommand::BeginStream(config))
    }

    /// Sends points until the program gives no more.
    fn stream_points(
        &mut self,
        mode: StreamMode,
        streamer: &mut Streamer,
        given: &mut dyn FnMut() -> Given,
    ) -> Result<(), DriveError> {
        let mut tick = self.controller.client().status()?.0.tick;
        let mut is_starved = false;
        loop {
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(None));
            }
            if let Some(state) = self.latest_state() {
                tick = state.tick;
                match state.progress.phase {
                    StreamPhase::Waits | StreamPhase::Follows => is_starved = false,
                    StreamPhase::Starved => is_starved = true,
                    StreamPhase::Ends | StreamPhase::Ended => {
                        self.fault_free_status()?;
                        return Err(ended(Some(state)));
                    }
                }
                if let (StreamPhase::Waits, Some(StreamReason::Away(_))) =
                    (state.progress.phase, state.progress.reason)
                {
                    return Err(ended(Some(state)));
                }
            }
            if !streamer.is_due(tick) {
                self.controller.pass_time()?;
                continue;
            }
            let next = given();
            if is_starved && matches!(next, Given::Point(_)) {
                let status = self.until_rest()?;
                let rest = place(mode, &status).ok_or(DriveError::NoTool)?;
                tick = status.tick;
                streamer.go_on_from(rest, tick);
                is_starved = false;
            }
            let point = match next {
                Given::Point(point) => streamer.push(point, tick),
                Given::Spring(impedance) => {
                    self.set_impedance(streamer.config(), impedance)?;
                    continue;
                }
                Given::Nothing => {
                    self.controller.pass_time()?;
                    continue;
                }
                Given::End => streamer.last(tick),
            };
            if let Some((n, point)) = &point {
                self.controller.client().send_point(*n, point)?;
            }
            if next == Given::End {
                return Ok(());
            }
        }
    }

    /// The state of the stream that the controller told last, if it told one since the last call.
    pub(super) fn latest_state(&mut self) -> Option<StreamState> {
        let client = self.controller.client();
        let latest = std::iter::from_fn(|| client.take_stream_state()).last();
        if let Some(state) = &latest {
            self.controller.note_stream(state);
        }
        latest
    }

    /// Changes the springs and dampers of the stream in progress.
    pub(super) fn set_impedance(
        &mut self,
        stream: &StreamConfig,
        impedance: Impedance,
    ) -> Result<(), DriveError> {
        let config = StreamConfig {
            mode: StreamMode::Impedance(impedance),
            ..*stream
        };
        self.command("change the springs", HostCommand::BeginStream(config))
    }

    /// The status of the arm when it rests.
    fn until_rest(&mut self) -> Result<Status, DriveError> {
        for _ in 0..LONGEST_STOP {
            if !safe_exit::moves(&self.fault_free_status()?) {
                break;
            }
            self.controller.pass_time()?;
        }
        // What the controller told before it rested is old.
        self.latest_state();
        self.fault_free_status()
    }
}

/// Where the arm is held.
fn place(mode: StreamMode, status: &Status) -> Option<[f64; 2]> {
    let place = match mode {
        StreamMode::Joint => held_angles(status),
        StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => status.reference,
    };
    place.map(|place| place.map(f64::from))
}

/// θ1, θ4 at which the arm is held [rad], with the whole turns of the measured ones; none: it is not held.
pub fn held_angles(status: &Status) -> Option<[f32; 2]> {
    let reference = status.joint_reference?;
    let turn = std::f32::consts::TAU;
    Some([0, 1].map(|k| {
        let (measured, held) = (status.angle[k], reference.angle[k]);
        held + turn * ((measured - held) / turn).round()
    }))
}

pub(super) fn ended(state: Option<StreamState>) -> DriveError {
    let progress = state.map(|state| state.progress);
    let reason = progress.and_then(|progress| progress.reason);
    DriveError::Stream(reason.unwrap_or(StreamReason::Stopped))
}

#[cfg(test)]
mod tests {
    use super::{Drive, Given};
    use crate::clock::Clock;
    use crate::controller::{ControllerSource, open};
    use crate::drive::Homing;
    use crate::streaming::{SetPoint, StreamOptions};
    use fivebar_files::robot::Robot;
    use fivebar_firmware::motion::{StreamMode, StreamPolicy};

    /// A program stalls for longer than the delay, and for less than the command timeout.
    #[test]
    fn a_stream_goes_on_after_a_stall_and_ends_where_its_motion_ends() {
        let robot = Robot::load("benchtop").unwrap();
        let clock = Clock::simulated();
        let (mut session, _) = open(&robot, ControllerSource::Simulated, &clock).unwrap();
        let mut drive = Drive::new(&mut session, &|| false);
        drive.home(Homing::IfUnknown).unwrap();
        drive.switch_on().unwrap();
        let [x, y] = drive.tool().unwrap();
        let motion = |time: f64| {
            let way = 5e-3 * (1.0 - (6.0 * time).cos());
            [f64::from(x) - way, f64::from(y) + 0.5 * way]
        };
        let options = StreamOptions {
            mode: StreamMode::Tip,
            rate: 500.0,
            delay: None,
            policy: StreamPolicy::Stop,
            fixtures: [None; 3],
        };
        let (mut points, mut stall) = (0_u32, 9_u32);
        let mut given = || match points {
            100 if stall > 0 => {
                stall -= 1;
                Given::Nothing
            }
            600.. => Given::End,
            _ => {
                let position = motion(f64::from(points) * 2e-3);
                points += 1;
                Given::Point(SetPoint::at(position))
            }
        };
        drive.follow_stream(&options, 10_000.0, &mut given).unwrap();
        let [ex, ey] = drive.fault_free_status().unwrap().reference.unwrap();
        let [mx, my] = motion(599.0 * 2e-3);
        // It keeps its velocity of 30 mm/s for two periods and stops.
        let off = (f64::from(ex) - mx).hypot(f64::from(ey) - my);
        assert!(off < 1e-3, "{off} m");
    }
}
