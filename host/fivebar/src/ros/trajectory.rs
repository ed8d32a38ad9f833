//! A trajectory of the driven joints, from the arm's present motion through the points of a message.
//!
//! Between two points each angle is a cubic of time by positions and velocities, or a quintic if both points have
//! accelerations, as ros2_control's joint trajectory controller has it. Points without velocities get those of a parabola
//! through their neighbours, the last one rests. So a trajectory of positions alone has no jumps of speed.

use super::messages::{JointTrajectory, TrajectoryPoint};
use fivebar_files::robot::Limits;

/// The driven joints, by their names in the exported URDF: θ1 and θ4.
pub(super) const DRIVEN: [&str; 2] = ["A", "E"];
/// The longest trajectory [s].
const LONGEST: f64 = 3600.0;
/// Time between two checks [s].
const CHECK: f64 = 5e-3;

/// Why a trajectory is not followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Unfollowed {
    /// Other joints.
    #[error("joint_names must be \"A\" and \"E\", the driven joints, not {0:?}")]
    Joints(Vec<String>),
    /// A point without two positions, or with other numbers than two of the rest.
    #[error(
        "point {0}: positions, velocities and accelerations must be two numbers each, one for A and one for E"
    )]
    Numbers(usize),
    /// Times that do not rise.
    #[error(
        "point {0}: time_from_start must be positive, rise from point to point, and be 3600 s at most"
    )]
    Time(usize),
    /// An angle beyond the limits.
    #[error(
        "after {time:.2} s joint {joint} would be at {angle:.4} rad, and may be from {least:.4} to {most:.4} rad"
    )]
    Angle {
        joint: &'static str,
        time: f64,
        angle: f64,
        least: f64,
        most: f64,
    },
    /// A speed beyond the limits.
    #[error(
        "after {time:.2} s joint {joint} would turn at {speed:.2} rad/s, and may at {most:.2} rad/s: give it more time"
    )]
    Speed {
        joint: &'static str,
        time: f64,
        speed: f64,
        most: f64,
    },
    /// An acceleration beyond the limits.
    #[error(
        "after {time:.2} s joint {joint} would need {acceleration:.0} rad/s², and may have {most:.0} rad/s²: give it more time"
    )]
    Acceleration {
        joint: &'static str,
        time: f64,
        acceleration: f64,
        most: f64,
    },
}

/// Where a trajectory is at a time: θ1, θ4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// [rad]
    pub(super) position: [f64; 2],
    /// [rad/s]
    pub(super) velocity: [f64; 2],
}

/// A point: its time [s], and per joint θ [rad], θ̇ [rad/s] and θ̈ [rad/s²].
#[derive(Clone, Copy, Debug)]
struct Knot {
    time: f64,
    position: [f64; 2],
    velocity: [f64; 2],
    acceleration: Option<[f64; 2]>,
}

/// A motion of the driven joints.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    knots: Vec<Knot>,
}

impl Trajectory {
    /// From this motion through the points of a message; within these limits.
    pub(super) fn new(
        message: &JointTrajectory,
        from: Place,
        limits: &Limits,
    ) -> Result<Self, Unfollowed> {
        let trajectory = Self::through(message, from)?;
        trajectory.check(limits)?;
        Ok(trajectory)
    }

    fn through(message: &JointTrajectory, from: Place) -> Result<Self, Unfollowed> {
        let names: Vec<&str> = message.joint_names.iter().map(String::as_str).collect();
        let order = match names[..] {
            ["A", "E"] => [0, 1],
            ["E", "A"] => [1, 0],
            _ => return Err(Unfollowed::Joints(message.joint_names.clone())),
        };
        let mut knots = vec![Knot {
            time: 0.0,
            position: from.position,
            velocity: from.velocity,
            acceleration: None,
        }];
        let mut without_velocity = Vec::new();
        for (index, point) in message.points.iter().enumerate() {
            let wrong = Unfollowed::Numbers(index + 1);
            let two = |values: &[f64]| match values {
                [] => Ok(None),
                [_, _] if values.iter().all(|value| value.is_finite()) => {
                    Ok(Some(order.map(|at| values[at])))
                }
                _ => Err(wrong.clone()),
            };
            let position = two(&point.positions)?.ok_or_else(|| wrong.clone())?;
            let (velocity, acceleration) = (two(&point.velocities)?, two(&point.accelerations)?);
            let time = seconds(point);
            let before = knots.last().map_or(0.0, |knot: &Knot| knot.time);
            // The first point may be where the arm is now.
            let is_now = index == 0 && time == 0.0;
            if is_now {
                continue;
            }
            if !(time > before && time <= LONGEST) {
                return Err(Unfollowed::Time(index + 1));
            }
            if velocity.is_none() {
                without_velocity.push(knots.len());
            }
            knots.push(Knot {
                time,
                position,
                velocity: velocity.unwrap_or_default(),
                acceleration,
            });
        }
        for at in without_velocity {
            if let Some(velocity) = between_neighbours(&knots, at) {
                knots[at].velocity = velocity;
            }
        }
        Ok(Self { knots })
    }

    /// Its duration [s].
    pub(super) fn time(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.time)
    }

    /// Where it is after this time [s]; behind its end it rests there.
    pub(super) fn at(&self, time: f64) -> Place {
        let behind = self.knots.partition_point(|knot| knot.time <= time);
        let Some(from) = behind.checked_sub(1).map(|at| &self.knots[at]) else {
            let Knot {
                position, velocity, ..
            } = self.knots[0];
            return Place { position, velocity };
        };
        match self.knots.get(behind) {
            Some(to) => between(from, to, time),
            None => Place {
                position: from.position,
                velocity: [0.0; 2],
            },
        }
    }

    /// At times so close together that what lies between them is the stream's own check.
    fn check(&self, limits: &Limits) -> Result<(), Unfollowed> {
        let end = self.time();
        let count = (end / CHECK).ceil() as u32;
        let mut before: Option<(f64, [f64; 2])> = None;
        for step in 0..=count {
            let time = (f64::from(step) * CHECK).min(end);
            let Place { position, velocity } = self.at(time);
            for (k, joint) in DRIVEN.into_iter().enumerate() {
                let (angle, [least, most]) = (position[k], limits.angle[k]);
                if !(least..=most).contains(&angle) {
                    return Err(Unfollowed::Angle {
                        joint,
                        time,
                        angle,
                        least,
                        most,
                    });
                }
                let (speed, most) = (velocity[k].abs(), limits.max_speed[k]);
                if speed > most {
                    return Err(Unfollowed::Speed {
                        joint,
                        time,
                        speed,
                        most,
                    });
                }
                let Some((earlier, slower)) = before else {
                    continue;
                };
                let change = (velocity[k] - slower[k]).abs();
                let most = limits.max_acceleration[k];
                if change > most * (time - earlier) {
                    return Err(Unfollowed::Acceleration {
                        joint,
                        time,
                        acceleration: change / (time - earlier),
                        most,
                    });
                }
            }
            before = Some((time, velocity));
        }
        Ok(())
    }
}

fn seconds(point: &TrajectoryPoint) -> f64 {
    point.time_from_start.to_nanos() as f64 * 1e-9
}

/// The velocity at a knot of the parabola through it and its two neighbours; none: it is the last one.
fn between_neighbours(knots: &[Knot], at: usize) -> Option<[f64; 2]> {
    let (before, here, behind) = (
        knots.get(at.checked_sub(1)?)?,
        knots.get(at)?,
        knots.get(at + 1)?,
    );
    let (h0, h1) = (here.time - before.time, behind.time - here.time);
    Some([0, 1].map(|k| {
        let slope0 = (here.position[k] - before.position[k]) / h0;
        let slope1 = (behind.position[k] - here.position[k]) / h1;
        (slope0 * h1 + slope1 * h0) / (h0 + h1)
    }))
}

/// Hermite's polynomial of θ: with u = (t − t₀)/h and its basis for positions, velocities h·θ̇ and accelerations h²·θ̈.
fn between(from: &Knot, to: &Knot, time: f64) -> Place {
    let h = to.time - from.time;
    let u = (time - from.time) / h;
    let [mut position, mut velocity] = [[0.0; 2]; 2];
    for k in 0..2 {
        let (p0, v0) = (from.position[k], h * from.velocity[k]);
        let (way, v1) = (to.position[k] - p0, h * to.velocity[k]);
        // θ = Σ cᵢ uⁱ.
        let c = match (from.acceleration, to.acceleration) {
            (Some(a0), Some(a1)) => {
                let (a0, a1) = (h * h * a0[k], h * h * a1[k]);
                [
                    p0,
                    v0,
                    0.5 * a0,
                    10.0 * way - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
                    -15.0 * way + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
                    6.0 * way - 3.0 * (v0 + v1) + 0.5 * (a1 - a0),
                ]
            }
            _ => [
                p0,
                v0,
                3.0 * way - 2.0 * v0 - v1,
                v0 + v1 - 2.0 * way,
                0.0,
                0.0,
            ],
        };
        let by_u = |from: usize, of: &dyn Fn(usize) -> f64| {
            (from..6).rev().fold(0.0, |sum, i| sum * u + of(i))
        };
        position[k] = by_u(0, &|i| c[i]);
        velocity[k] = by_u(1, &|i| i as f64 * c[i]) / h;
    }
    Place { position, velocity }
}

#[cfg(test)]
mod tests;
