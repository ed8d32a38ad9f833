//! A drive with loops of its own: τd = k (θd − θ̂) + d (ωd − ω̂) + τf, and dτ/dt = (τd − τ)/T of its current loop.
//!
//! θ̂ and ω̂ come from its encoder, by a tracking loop whose both poles are at 1/T.

use super::protocol::{Input, Order};
use std::f64::consts::TAU;

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
    /// Time without a command after which it gives no torque by itself [s].
    pub watchdog: f64,
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
    /// No torque, because of an error, which stays until it is cleared.
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
    /// Whether it follows its input without being told to.
    always_follows: bool,
    input: Input,
    /// k/d [1/s], and d [N·m·s/rad].
    gains: [f64; 2],
    /// θ̂ [rad] and ω̂ [rad/s]; none before its first look.
    tracked: Option<[f64; 2]>,
    /// τd and τ at its shaft [N·m].
    set_point: f64,
    torque: f64,
    /// Time since the last command [s]; none before the first one since its power-up.
    unfed: Option<f64>,
    /// Its error comes back whenever it is cleared.
    is_broken: bool,
    /// It takes no part on the bus.
    is_cut_off: bool,
}

impl DriveOnBus {
    pub(super) fn new(drive: CanDrive, follows: bool) -> Self {
        Self {
            drive,
            stage: Stage::Off,
            follows,
            always_follows: follows,
            input: Input::default(),
            gains: [0.0; 2],
            tracked: None,
            set_point: 0.0,
            torque: 0.0,
            unfed: None,
            is_broken: false,
            is_cut_off: false,
        }
    }

    /// It takes no part on the bus any more; it goes on until its watchdog ends that.
    pub(super) fn cut_off(&mut self) {
        self.is_cut_off = true;
    }

    /// It starts anew: its errors are gone, and its mode.
    pub(super) fn reset(&mut self) {
        self.stop(Stage::Boots(BOOT));
        (self.unfed, self.follows) = (None, self.always_follows);
    }

    /// It leaves the mode in which it gives torque, without an error.
    pub(super) fn lose_mode(&mut self) {
        self.stop(Stage::Off);
        self.follows = self.always_follows;
    }

    /// It has an error from now on that no clear removes.
    pub(super) fn break_down(&mut self) {
        self.stop(Stage::Error);
        self.is_broken = true;
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

    /// Does what a frame asks for. Each frame that is meant for it feeds its watchdog, as in ODrive's firmware 0.5.
    pub(super) fn apply(&mut self, order: Order) {
        self.unfed = Some(0.0);
        match order {
            Order::Start if self.follows && self.stage == Stage::Off => {
                self.stage = Stage::Starts(START);
            }
            Order::Stop if self.stage != Stage::Error => self.stop(Stage::Off),
            Order::Clear if self.stage == Stage::Error && !self.is_broken => {
                self.stop(Stage::Off);
            }
            Order::Follow => self.follows = true,
            Order::Input(input) => self.input = input,
            Order::PositionGain(gain) => self.gains[0] = gain,
            Order::VelocityGain(gain) => self.gains[1] = gain,
            Order::Start | Order::Stop | Order::Clear | Order::Tell => {}
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
        let unfed = self.unfed.map(|unfed| unfed + time);
        self.unfed = unfed;
        match self.stage {
            Stage::Starts(left) if left <= time => self.stage = Stage::Drives,
            Stage::Starts(left) => self.stage = Stage::Starts(left - time),
            Stage::Boots(left) if left <= time => self.stage = Stage::Off,
            Stage::Boots(left) => self.stage = Stage::Boots(left - time),
            Stage::Drives | Stage::Off | Stage::Error => {}
        }
        // In every state, also without torque.
        let is_awake = !matches!(self.stage, Stage::Boots(_));
        if is_awake && unfed.is_some_and(|unfed| unfed > self.drive.watchdog) {
            self.stop(Stage::Error);
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
        watchdog: 2e-3,
    };

    /// Orders it to give torque, and goes on with commands until it does.
    fn start(drive: &mut DriveOnBus) {
        drive.apply(Order::Start);
        for _ in 0..11 {
            drive.apply(Order::Input(Input::default()));
            drive.pass(0.1 * START, true);
        }
    }

    /// A drive that makes this torque.
    fn driving(torque: f64) -> DriveOnBus {
        let mut drive = DriveOnBus::new(DRIVE, true);
        start(&mut drive);
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
        drive.pass(DRIVE.watchdog, true);
        assert!(drive.drives() && drive.torque() > 0.4);
        drive.pass(1e-6, true);
        assert!(drive.is_in_error() && drive.torque() == 0.0);
    }

    #[test]
    fn an_error_stays_until_it_is_cleared_and_one_whose_cause_stays_does_not_go() {
        let mut drive = driving(0.5);
        // Without torque the watchdog runs, too.
        drive.apply(Order::Stop);
        drive.pass(1e-3, true);
        assert!(!drive.is_in_error());
        drive.pass(1.1e-3, true);
        assert!(drive.is_in_error());
        drive.apply(Order::Stop);
        start(&mut drive);
        assert!(drive.is_in_error());
        drive.apply(Order::Clear);
        assert!(!drive.is_in_error() && !drive.drives());
        start(&mut drive);
        assert!(drive.drives());
        drive.break_down();
        drive.apply(Order::Clear);
        start(&mut drive);
        assert!(drive.is_in_error() && drive.torque() == 0.0);
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
        start(&mut other);
        assert!(!other.drives() && !other.is_in_error());
    }
}
