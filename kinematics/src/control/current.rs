//! The current loop of one brushed DC motor, on the same tick as the position loop.
//!
//! L i̇ = v − R i − Ke ω. Without the back-EMF, and exactly for a voltage held over T,
//!
//! i[k+1] = a i[k] + (1 − a)/R · v[k−1], a = e^(−RT/L),
//!
//! where v is one tick late. The PI law v = Kp e + x, x ← x + KiT e has a zero at
//! 1 − KiT/Kp; put on a, it leaves the loop g/(z(z − 1)) with
//!
//! g = ωc T, Kp = R g/(1 − a), KiT = R g.
//!
//! Closed, z² − z + g = 0: both poles real for g ≤ ¼, at ½ for g = ¼, and the loop follows
//! a slow demand with the lag T/g = 1/ωc, the tick of delay included.
//!
//! v = Kp e + x + Ke ω is limited to a share of the bus voltage. While it is limited, x
//! follows the limit: x ← x + KiT e + (1 − a)(v_limited − v) removes exactly what Kp e adds
//! beyond the limit. Duty = v / bus voltage.

use super::discrete::decay;
use crate::Scalar;

/// The current loop's constants.
///
/// ```
/// use fivebar_kinematics::control::{Bus, CurrentLoop, CurrentState};
///
/// // A motor of 1 Ω and 1 mH on 24 V, at rest, in ticks of 0.1 ms.
/// let (period, resistance, inductance) = (1e-4, 1.0, 1e-3);
/// let current_loop = CurrentLoop::new(2000.0, period, resistance, inductance, 0.05);
/// let (mut state, bus) = (CurrentState(0.0), Bus::new(24.0, 0.95));
/// let (mut current, mut late_duty) = (0.0, 0.0); // A
/// let decay = f64::exp(-resistance * period / inductance);
/// for _ in 0..100 {
///     let drive = current_loop.update(&mut state, 2.0, current, 0.0, &bus);
///     // The duty of the tick before acts.
///     current = decay * current + (1.0 - decay) * late_duty * 24.0 / resistance;
///     late_duty = drive.duty;
/// }
/// assert!((current - 2.0).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop<S> {
    kp: S,
    ki_period: S,
    tracking: S,
    back_emf: S,
}

/// The voltage that the bridges can give.
///
/// ```
/// use fivebar_kinematics::control::{Bus, CurrentLoop, CurrentState};
///
/// // Bridges may give 90 % of 24 V, and of 12 V.
/// let current_loop = CurrentLoop::new(2000.0, 1e-4, 1.0, 1e-3, 0.05);
/// let duty = |bus| current_loop.update(&mut CurrentState(0.0), 2.0, 0.0, 0.0, &bus).duty;
/// let (at_24_volts, at_12_volts) = (duty(Bus::new(24.0, 0.9)), duty(Bus::new(12.0, 0.9)));
/// // The same voltage needs twice the duty on half the bus voltage.
/// assert!((at_12_volts / at_24_volts - 2.0_f64).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bus<S> {
    /// Greatest mean voltage that a bridge may give [V].
    limit: S,
    /// Duty per volt [1/V].
    per_volt: S,
}

impl<S: Scalar> Bus<S> {
    /// A bus of `voltage` [V], of which bridges may give the share `duty_limit`.
    #[inline(always)]
    pub fn new(voltage: S, duty_limit: S) -> Self {
        Self {
            limit: duty_limit * voltage,
            per_volt: S::ONE / voltage,
        }
    }
}

/// The integral x [V].
///
/// ```
/// use fivebar_kinematics::control::{Bus, CurrentLoop, CurrentState};
///
/// let current_loop = CurrentLoop::new(2000.0, 1e-4, 1.0, 1e-3, 0.05);
/// let mut state = CurrentState(0.0); // V
/// current_loop.update(&mut state, 2.0, 1.0, 0.0, &Bus::new(24.0, 0.95));
/// // One tick adds KiT e = R ωc T e = 1 Ω · 2000 rad/s · 0.1 ms · 1 A.
/// assert!((state.0 - 0.2_f64).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentState<S>(pub S);

/// The output of the current loop for a bridge.
///
/// ```
/// use fivebar_kinematics::control::{Bus, CurrentLoop, CurrentState};
///
/// let current_loop = CurrentLoop::new(2000.0, 1e-4, 1.0, 1e-3, 0.05);
/// // 100 A would need more than the bus has: the duty stays at its limit.
/// let drive = current_loop.update(&mut CurrentState(0.0), 100.0, 0.0, 0.0, &Bus::new(24.0, 0.95));
/// assert!(drive.limited);
/// assert!((drive.duty - 0.95_f64).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<S> {
    /// Duty in −1…1.
    pub duty: S,
    /// Whether the voltage was limited.
    pub limited: bool,
}

impl<S: Scalar> CurrentLoop<S> {
    /// A loop of the bandwidth ωc [rad/s] at the tick period T [s] for a motor of
    /// `resistance` R [Ω] and `inductance` L [H] whose back-EMF is `back_emf` [V·s/rad]
    /// times the velocity that [`CurrentLoop::update`] is given.
    pub fn new(bandwidth: S, period: S, resistance: S, inductance: S, back_emf: S) -> Self {
        let g = bandwidth * period;
        let tracking = S::ONE - decay(resistance * period / inductance);
        Self {
            kp: resistance * g / tracking,
            ki_period: resistance * g,
            tracking,
            back_emf,
        }
    }

    /// One tick: the drive that brings the current [A] to `demand` [A] at `velocity`
    /// [rad/s].
    #[inline(always)]
    pub fn update(
        &self,
        state: &mut CurrentState<S>,
        demand: S,
        current: S,
        velocity: S,
        bus: &Bus<S>,
    ) -> Drive<S> {
        let error = demand - current;
        let v = self.kp * error + state.0 + self.back_emf * velocity;
        let limited = v.abs() > bus.limit;
        state.0 += self.ki_period * error;
        let mut given = v;
        if limited {
            given = if v > S::ZERO { bus.limit } else { -bus.limit };
            state.0 += self.tracking * (given - v);
        }
        Drive {
            duty: given * bus.per_volt,
            limited,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;

    struct Motor {
        r: f64,
        l: f64,
        ke: f64,
        i: f64,
        late: f64,
    }

    impl Motor {
        /// The exact solution over one tick, with the duty of the tick before.
        fn step(&mut self, duty: f64, omega: f64, bus: f64) {
            let a = libm::exp(-self.r * T / self.l);
            let v = self.late * bus - self.ke * omega;
            self.i = a * self.i + (1.0 - a) / self.r * v;
            self.late = duty;
        }
    }

    fn respond(g: f64, r: f64, l: f64, demand: f64, omega: f64, bus: f64) -> [f64; 200] {
        let ke = 0.05;
        let current = CurrentLoop::new(g / T, T, r, l, ke);
        let mut state = CurrentState(0.0);
        let mut motor = Motor {
            r,
            l,
            ke,
            i: 0.0,
            late: ke * omega / bus,
        };
        core::array::from_fn(|_| {
            let drive = current.update(&mut state, demand, motor.i, omega, &Bus::new(bus, 0.95));
            assert!(drive.duty.abs() <= 0.95 + 1e-12);
            motor.step(drive.duty, omega, bus);
            motor.i
        })
    }

    proptest! {
        #[test]
        fn step_response_is_the_designed_second_order(
            g in 0.05..0.25_f64,
            r in 0.3..5.0_f64,
            time_constant in 0.05e-3..5e-3_f64,
            omega in -30.0..30.0_f64,
            bus in 12.0..48.0_f64,
        ) {
            // A demand so small that the bus is never limiting.
            let i = respond(g, r, r * time_constant, 1e-3, omega, bus);
            // y[k+2] = y[k+1] − g y[k] + g u, the closed loop z² − z + g.
            let (mut y0, mut y1) = (0.0, 0.0);
            for (k, &measured) in i.iter().enumerate() {
                // The first voltage acts in the second tick.
                prop_assert!((measured - y1).abs() < 1e-8, "tick {k}: {measured} {y1}");
                (y0, y1) = (y1, y1 - g * y0 + g * 1e-3);
            }
        }
    }

    #[test]
    fn current_lags_a_ramp_by_one_over_the_bandwidth() {
        let (g, r, l) = (0.2, 1.0, 1e-3);
        let current = CurrentLoop::new(g / T, T, r, l, 0.05);
        let mut state = CurrentState(0.0);
        let mut motor = Motor {
            r,
            l,
            ke: 0.05,
            i: 0.0,
            late: 0.0,
        };
        let mut lag = 0.0;
        for k in 0..400_u32 {
            let demand = f64::from(k) * 1e-3;
            lag = (demand - motor.i) / 1e-3;
            let drive = current.update(&mut state, demand, motor.i, 0.0, &Bus::new(24.0, 0.95));
            motor.step(drive.duty, 0.0, 24.0);
        }
        assert!((lag - 1.0 / g).abs() < 1e-6, "{lag} ticks");
    }

    #[test]
    fn a_demand_beyond_the_bus_is_limited_on_its_own_side_and_its_integral_follows() {
        // ωc T = 0.2 and R T/L = 0.1: kp = R ωc T/(1 − e^(−0.1)), ki T = R ωc T.
        let current = CurrentLoop::new(2000.0, T, 1.0, 1e-3, 0.05);
        let tracking = 1.0 - libm::exp(-0.1);
        for demand in [100.0, -100.0] {
            let limit = 11.4_f64.copysign(demand);
            let mut state = CurrentState(0.0);
            let drive = current.update(&mut state, demand, 0.0, 0.0, &Bus::new(12.0, 0.95));
            assert!(drive.limited && (drive.duty - limit / 12.0).abs() < 1e-12);
            let asked = 0.2 / tracking * demand;
            let integral = 0.2 * demand + tracking * (limit - asked);
            assert!((state.0 - integral).abs() < 1e-9, "{} V", state.0);
        }
    }

    #[test]
    fn a_long_saturation_does_not_wind_up() {
        let (r, l) = (1.0, 1e-3);
        let current = CurrentLoop::new(2000.0, T, r, l, 0.05);
        let mut state = CurrentState(0.0);
        let mut motor = Motor {
            r,
            l,
            ke: 0.05,
            i: 0.0,
            late: 0.0,
        };
        let mut after = [0.0; 40];
        for k in 0..2040_usize {
            let demand = if k < 2000 { 100.0 } else { 1.0 };
            let drive = current.update(&mut state, demand, motor.i, 0.0, &Bus::new(12.0, 0.95));
            assert!(drive.limited || k >= 2000, "tick {k}");
            motor.step(drive.duty, 0.0, 12.0);
            if k >= 2000 {
                after[k - 2000] = motor.i;
            }
        }
        // From the saturated 11.4 A down to 1 A within 20 ticks and hardly below it.
        assert!((after[25] - 1.0).abs() < 0.2, "{after:?}");
        assert!(after.iter().all(|&i| i > 0.8), "{after:?}");
    }
}
