//! A drive with loops of its own: τd = k (θd − θ̂) + d (ωd − ω̂) + τf, and dτ/dt = (τd − τ)/T of its current loop.
//!
//! θ̂ and ω̂ come from its encoder, by a tracking loop whose both poles are at 1/T.

use super::protocol::{Input, Order};
use std::f64::consts::TAU;

/// Time without a command after which a drive gives no torque by itself [s].
pub const WATCHDOG: f64 = 2e-3;
/// Time between two turns of a drive's loops [s]: ODrive's, and slower than those of MIT-type drives.
pub(super) const PERIOD: f64 = 125e-6;
/// Time from the order to give torque until a drive follows its set-point [s].
const START: f64 = 0.01;
/// Time for which a drive that resets is silent [s].
pub const BOOT: f64 = 1.0;

/// A drive with its motor and gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanDrive {
    /// Its number on the bus.
    pub node: u8,
    /// Turns of the drive's shaft per joint turn, negative if it turns against it.
    pub gear_ratio: f64,
    /// Inertia at the drive's shaft [kg·m²].
    pub rotor_inertia: f64,
    /// The greatest torque at its shaft [N·m].
    pub peak_torque: f64,
    /// T, the lag of its current loop [s]; the tracking loop of its encoder has the same bandwidth.
    pub lag: f64,
}

/// What a drive does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// No torque.
    Off,
    /// No torque yet; so much longer [s].
    Starts(f64),
    /// It makes its torque.
    Drives,
    /// No torque, because of an error.
    Error,
    /// It has reset: no torque, and no part on the bus; so much longer [s].
    Boots(f64),
}

/// A drive and its state.
#[derive(Clone, Debug)]
pub(super) struct DriveOnBus {
    pub(super) drive: CanDrive,
    stage: Stage,
    /// Whether it has been told to follow its input.
    follows: bool,
    input: Input,
    /// k/d [1/s], and d [N·m·s/rad].
    gains: [f64; 2],
    /// θ̂ [rad] and ω̂ [rad/s]; none before its first look.
    tracked: Option<[f64; 2]>,
    /// τd and τ at its shaft [N·m].
    set_point: f64,
    torque: f64,
    /// Time since the last command [s].
    unfed: f64,
    /// It takes no part on the bus.
    is_cut_off: bool,
}

impl DriveOnBus {
    pub(super) fn new(drive: CanDrive, follows: bool) -> Self {
        Self {
            drive,
            stage: Stage::Off,
            follows,
            input: Input::default(),
            gains: [0.0; 2],
            tracked: None,
            set_point: 0.0,
            torque: 0.0,
            unfed: 0.0,
            is_cut_off: false,
        }
    }

    /// It takes no part on the bus any more; it goes on until its watchdog ends that.
    pub(super) fn cut_off(&mut self) {
        self.is_cut_off = true;
    }

    /// It starts anew.
    pub(super) fn reset(&mut self) {
        self.stop(Stage::Boots(BOOT));
    }

    pub(super) fn is_silent(&self) -> bool {
        self.is_cut_off || matches!(self.stage, Stage::Boots(_))
    }

    pub(super) fn drives(&self) -> bool {
        self.stage == Stage::Drives
    }

    pub(super) fn is_in_error(&self) -> bool {
        self.stage == Stage::Error
    }

    /// Does what a frame asks for.
    pub(super) fn apply(&mut self, order: Order) {
        match order {
            Order::Start if self.follows && matches!(self.stage, Stage::Off | Stage::Error) => {
                (self.stage, self.unfed) = (Stage::Starts(START), 0.0);
            }
            Order::Stop => self.stop(Stage::Off),
            Order::Follow => self.follows = true,
            Order::Input(input) => (self.input, self.unfed) = (input, 0.0),
            Order::PositionGain(gain) => self.gains[0] = gain,
            Order::VelocityGain(gain) => self.gains[1] = gain,
            Order::Start | Order::Tell => {}
        }
    }

    /// One turn of its loops, with its encoder at so many turns.
    pub(super) fn turn(&mut self, turns: f64) {
        let (measured, tracking) = (TAU * turns, 1.0 / self.drive.lag);
        let [angle, speed] = self.tracked.unwrap_or([measured, 0.0]);
        let before = angle + PERIOD * speed;
        let off = measured - before;
        let angle = before + PERIOD * 2.0 * tracking * off;
        let speed = speed + PERIOD * tracking * tracking * off;
        self.tracked = Some([angle, speed]);
        let [ratio, gain] = self.gains;
        let [stiffness, damping] = self.input.stiffness.unwrap_or([ratio * gain, gain]);
        let Input {
            position,
            velocity,
            torque,
            ..
        } = self.input;
        let wanted = stiffness * (position - angle) + damping * (velocity - speed) + torque;
        let peak = self.drive.peak_torque;
        self.set_point = wanted.clamp(-peak, peak);
    }

    fn stop(&mut self, stage: Stage) {
        self.stage = stage;
        (self.set_point, self.torque) = (0.0, 0.0);
        self.input.torque = 0.0;
    }

    /// Lets this time pass [s]; unpowered, it gives no torque. Returns the mean torque at its shaft [N·m].
    pub(super) fn pass(&mut self, time: f64, is_powered: bool) -> f64 {
        self.unfed += time;
        match self.stage {
            Stage::Starts(left) if left <= time => self.stage = Stage::Drives,
            Stage::Starts(left) => self.stage = Stage::Starts(left - time),
            Stage::Boots(left) if left <= time => self.stage = Stage::Off,
            Stage::Boots(left) => self.stage = Stage::Boots(left - time),
            Stage::Drives if self.unfed > WATCHDOG => self.stop(Stage::Error),
            Stage::Drives | Stage::Off | Stage::Error => {}
        }
        if !self.drives() || !is_powered {
            self.torque = 0.0;
            return 0.0;
        }
        let gap = self.set_point - self.torque;
        let left = (-time / self.drive.lag).exp();
        self.torque = self.set_point - gap * left;
        // The mean of τd − Δ e^(−t/T).
        self.set_point - gap * (1.0 - left) * self.drive.lag / time
    }

    /// At its shaft [N·m].
    pub(super) fn torque(&self) -> f64 {
        self.torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVE: CanDrive = CanDrive {
        node: 1,
        gear_ratio: 3.0,
        rotor_inertia: 3e-5,
        peak_torque: 1.0,
        lag: 1e-3,
    };

    /// A drive that makes this torque.
    fn driving(torque: f64) -> DriveOnBus {
        let mut drive = DriveOnBus::new(DRIVE, true);
        drive.apply(Order::Start);
        drive.pass(START, true);
        let input = Input {
            torque,
            ..Input::default()
        };
        drive.apply(Order::Input(input));
        drive.turn(0.0);
        drive
    }

    #[test]
    fn the_torque_answers_a_step_as_a_first_order_and_its_mean_is_the_integral() {
        for parts in [1, 7, 20] {
            let mut drive = driving(0.5);
            let part = 1.5e-3 / f64::from(parts);
            let sum: f64 = (0..parts).map(|_| drive.pass(part, true) * part).sum();
            let left = (-1.5_f64).exp();
            assert!((drive.torque() - 0.5 * (1.0 - left)).abs() < 1e-12);
            assert!((sum - 0.5 * (1.5e-3 - 1e-3 * (1.0 - left))).abs() < 1e-12);
        }
    }

    #[test]
    fn gains_make_a_spring_and_a_damper_about_the_input() {
        let mut drive = driving(0.1);
        drive.apply(Order::PositionGain(50.0));
        drive.apply(Order::VelocityGain(0.02));
        // 0.1 rad ahead of a shaft that stands.
        drive.input.position = 0.1;
        drive.turn(0.0);
        assert!((drive.set_point - (0.1 + 50.0 * 0.02 * 0.1)).abs() < 1e-12);
        // A shaft that turns at 3 rad/s, on time: until the tracking loop has its speed.
        let mut time = 0.0;
        for _ in 0..200 {
            time += PERIOD;
            (drive.input.position, drive.input.velocity) = (3.0 * time, 5.0);
            drive.turn(3.0 * time / TAU);
        }
        assert!(
            (drive.set_point - (0.1 + 0.02 * 2.0)).abs() < 1e-6,
            "{}",
            drive.set_point
        );
    }

    #[test]
    fn without_commands_the_drives_own_watchdog_ends_its_torque() {
        let mut drive = driving(0.5);
        drive.pass(WATCHDOG, true);
        assert!(drive.drives() && drive.torque() > 0.4);
        drive.pass(1e-6, true);
        assert!(drive.is_in_error() && drive.torque() == 0.0);
        // It starts anew when it is told to.
        drive.apply(Order::Start);
        drive.pass(START, true);
        drive.turn(0.0);
        assert!(drive.drives() && drive.torque() == 0.0);
    }

    #[test]
    fn a_drive_gives_no_more_than_its_peak_torque_and_none_unless_it_follows_its_input() {
        let mut drive = driving(7.0);
        for _ in 0..20 {
            drive.apply(Order::Input(drive.input));
            drive.pass(1e-3, true);
        }
        assert!((drive.torque() - DRIVE.peak_torque).abs() < 1e-6);
        let mut other = DriveOnBus::new(DRIVE, false);
        other.apply(Order::Start);
        other.pass(2.0 * START, true);
        assert!(!other.drives());
    }
}
