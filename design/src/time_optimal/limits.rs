//! The limits as rows −limit ≤ a u + b x + c + d √x ≤ limit, and as greatest x.
//!
//! | limit | row, or bound of x |
//! |---|---|
//! | torque τj | the demand's own row |
//! | voltage R τj/K + K q̇j | (R/K)·(the torque's row), d increased by K q′j |
//! | torque \|τj\| + f \|q̇j\| that falls with the speed | two rows of the torque, d increased and decreased by f q′j |
//! | acceleration q′j u + q″j x | (q′j, q″j, 0, 0) |
//! | tip acceleration C′u + C″x | its components in 16 directions within a half turn: a polygon inside the circle, 0.5 % smaller at most |
//! | speed | x ≤ (ωmax/q′j)² |
//! | tip speed | x ≤ (vmax/\|C′\|)² |

use super::demand::{Demand, PlannedDrive};
use super::strip::{Row, greatest_x};
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// A drive's torque that falls with its speed, whether it drives or brakes: |τ| + `slope` |q̇| ≤ `standing`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallingTorque {
    /// At rest, at the joint [N·m].
    pub standing: f64,
    /// By which it falls with the joint's speed [N·m·s/rad].
    pub slope: f64,
}

impl FallingTorque {
    /// f and limit of both rows |τ + f q̇| ≤ limit.
    fn rows(self) -> [(f64, f64); 2] {
        [(self.slope, self.standing), (-self.slope, self.standing)]
    }
}

/// The limits of a plan; pairs are of joint 1 and joint 4. A limit that is infinite or `None`
/// does not apply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanLimits {
    /// Greatest torque at each joint [N·m].
    pub torque: [f64; 2],
    /// Greatest torque at each joint by its speed.
    pub falling_torque: Option<[FallingTorque; 2]>,
    /// Greatest speed of each joint [rad/s].
    pub speed: [f64; 2],
    /// Greatest acceleration of each joint [rad/s²].
    pub acceleration: [f64; 2],
    /// Greatest voltage at each motor [V].
    pub voltage: Option<f64>,
    /// Greatest speed of the tip [m/s].
    pub tip_speed: Option<f64>,
    /// Greatest acceleration of the tip [m/s²].
    pub tip_acceleration: Option<f64>,
}

/// Directions of the polygon within the circle of the tip's acceleration, in half a turn.
const DIRECTIONS: usize = 16;

impl PlanLimits {
    /// Appends the rows of a point; their number is the same at every point.
    pub(super) fn rows(&self, at: &Demand, drives: &[PlannedDrive; 2], rows: &mut Vec<Row>) {
        let c = at.c();
        for (j, drive) in drives.iter().enumerate() {
            let torque = Row {
                a: at.a[j],
                b: at.b[j],
                c: c[j],
                d: at.d[j],
                limit: self.torque[j],
            };
            if self.torque[j].is_finite() {
                rows.push(torque);
            }
            for (slope, limit) in self
                .falling_torque
                .into_iter()
                .flat_map(|limits| limits[j].rows())
            {
                rows.push(Row {
                    d: torque.d + slope * at.q1[j],
                    limit,
                    ..torque
                });
            }
            if let Some(voltage) = self.voltage
                && drive.torque_constant > 0.0
            {
                let constant = drive.torque_constant;
                let per = drive.resistance / constant;
                rows.push(Row {
                    a: per * torque.a,
                    b: per * torque.b,
                    c: per * torque.c,
                    d: per * torque.d + constant * at.q1[j],
                    limit: voltage,
                });
            }
            if self.acceleration[j].is_finite() {
                rows.push(of_acceleration(at.q1[j], at.q2[j], self.acceleration[j]));
            }
        }
        let Some(acceleration) = self.tip_acceleration else {
            return;
        };
        let step = PI / DIRECTIONS as f64;
        let inside = (0.5 * step).cos() * acceleration;
        for direction in 0..DIRECTIONS {
            let e = Vector2::unit(step * direction as f64);
            rows.push(of_acceleration(
                e.dot(&at.tangent),
                e.dot(&at.curvature),
                inside,
            ));
        }
    }

    /// The greatest x that the speeds allow.
    pub(super) fn ceiling(&self, at: &Demand) -> f64 {
        let joint = |j: usize| self.speed[j] / at.q1[j].abs();
        let tip = self.tip_speed.unwrap_or(f64::INFINITY) / at.tangent.norm();
        let rate = joint(0).min(joint(1)).min(tip);
        if rate.is_nan() {
            f64::INFINITY
        } else {
            rate * rate
        }
    }

    /// ṡ of the maximum velocity curve at a point: the greatest at which some s̈ satisfies every
    /// limit; infinite where none bounds it.
    pub fn maximum_velocity(&self, at: &Demand, drives: &[PlannedDrive; 2]) -> f64 {
        let mut rows = Vec::new();
        self.rows(at, drives, &mut rows);
        greatest_x(&rows, self.ceiling(at)).sqrt()
    }

    /// The least k at which k ṡ, k² s̈ reach a limit at a point: every slower motion keeps all of them.
    pub(super) fn pace(&self, at: &Demand, drives: &[PlannedDrive; 2], rate: f64, u: f64) -> f64 {
        let (x, c) = (rate * rate, at.c());
        let mut pace = self.ceiling(at).sqrt() / rate;
        for (j, drive) in drives.iter().enumerate() {
            let (square, linear) = (at.a[j] * u + at.b[j] * x, at.d[j] * rate);
            let acceleration = at.q1[j] * u + at.q2[j] * x;
            pace = pace
                .min(first_passing(square, linear, c[j], self.torque[j]))
                .min((self.acceleration[j] / acceleration.abs()).sqrt());
            for (slope, limit) in self
                .falling_torque
                .into_iter()
                .flat_map(|limits| limits[j].rows())
            {
                let linear = linear + slope * at.q1[j] * rate;
                pace = pace.min(first_passing(square, linear, c[j], limit));
            }
            if let Some(voltage) = self.voltage
                && drive.torque_constant > 0.0
            {
                let constant = drive.torque_constant;
                let per = drive.resistance / constant;
                let linear = per * linear + constant * at.q1[j] * rate;
                pace = pace.min(first_passing(per * square, linear, per * c[j], voltage));
            }
        }
        let tip = (at.tangent * u + at.curvature * x).norm();
        let acceleration = self.tip_acceleration.unwrap_or(f64::INFINITY);
        pace.min((acceleration / tip).sqrt())
    }

    /// The greatest share of a limit that a motion uses at a point; 1 is at the limit.
    pub(super) fn used(&self, at: &Demand, drives: &[PlannedDrive; 2], x: f64, u: f64) -> f64 {
        let rate = x.max(0.0).sqrt();
        let torque = at.torque(x, u);
        let mut used = 0.0_f64;
        for (j, drive) in drives.iter().enumerate() {
            let speed = at.q1[j] * rate;
            let acceleration = at.q1[j] * u + at.q2[j] * x;
            used = used
                .max(torque[j].abs() / self.torque[j])
                .max(speed.abs() / self.speed[j])
                .max(acceleration.abs() / self.acceleration[j]);
            for (slope, limit) in self
                .falling_torque
                .into_iter()
                .flat_map(|limits| limits[j].rows())
            {
                used = used.max((torque[j] + slope * speed).abs() / limit);
            }
            if let Some(voltage) = self.voltage
                && drive.torque_constant > 0.0
            {
                let constant = drive.torque_constant;
                let needed = drive.resistance * torque[j] / constant + constant * speed;
                used = used.max(needed.abs() / voltage);
            }
        }
        if let Some(speed) = self.tip_speed {
            used = used.max(at.tangent.norm() * rate / speed);
        }
        if let Some(acceleration) = self.tip_acceleration {
            used = used.max((at.tangent * u + at.curvature * x).norm() / acceleration);
        }
        used
    }
}

/// The least k > 0 with |a k² + d k + c| = limit, where |c| < limit; infinite if there is none, 0 if |c|
/// is not below the limit.
fn first_passing(a: f64, d: f64, c: f64, limit: f64) -> f64 {
    if c.abs() >= limit {
        return 0.0;
    }
    let first = |c: f64| {
        let q = -0.5 * (d + (d * d - 4.0 * a * c).sqrt().copysign(d));
        // Of no root, q is not a number, and neither comparison holds.
        let positive = |k: f64| if k > 0.0 { k } else { f64::INFINITY };
        positive(q / a).min(positive(c / q))
    };
    first(c - limit).min(first(c + limit))
}

/// The row of an acceleration a u + b x.
fn of_acceleration(a: f64, b: f64, limit: f64) -> Row {
    Row {
        a,
        b,
        c: 0.0,
        d: 0.0,
        limit,
    }
}
