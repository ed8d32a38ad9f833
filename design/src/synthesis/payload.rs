//! A payload that the tip carries at a speed and an acceleration in any direction, and the drives that suffice for it.
//!
//! A uniform rod moves as three points with 1/6, 2/3 and 1/6 of its mass at its ends and its middle do. So the couplers add
//! to the payload at C and to the cranks at B and D, and their middles M have the mean velocity of their ends. With the
//! velocity v of C, θ̇ = v·f/(n⊥·f), and with its acceleration a, θ̈ = (a·f + θ̇² n·f + φ̇² f·f)/(n⊥·f), n and f being crank
//! and coupler. By virtual power the torque is τi = Σ m (a − g)·∂v/∂θ̇i + I θ̈i: linear in a and quadratic in v, so that its
//! greatest values over all directions follow from a length and from eigenvalues.

use super::area::{Density, Placed};
use super::condition::{Condition, condition};
use super::problem::{Problem, Worst};
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The share of a drive's torque that the search keeps free: its samples may miss so much.
const KEPT: f64 = 1e-3;

/// What the tip carries, and what may drive the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// Mass at the tip [kg].
    pub mass: f64,
    /// Greatest speed of the tip, in any direction [m/s].
    pub speed: f64,
    /// Greatest acceleration of the tip, in any direction [m/s²].
    pub acceleration: f64,
    /// Gravity in the plane of the arm [m/s²].
    pub gravity: [f64; 2],
    /// Mass of the links by their length [kg/m].
    pub link_density: f64,
    /// The drives to choose from, the cheapest first.
    pub drives: Vec<Drive>,
}

/// A motor with its gear, as a driven joint sees both.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// What to buy.
    pub name: String,
    /// Torque at standstill, on a line to no torque at [`Drive::speed`] [N·m].
    pub torque: f64,
    /// Speed without load [rad/s].
    pub speed: f64,
    /// Greatest torque that the gear takes [N·m].
    pub torque_limit: f64,
    /// Inertia of the rotor, at the joint [kg·m²].
    pub inertia: f64,
    /// Price of one.
    pub price: f64,
    /// Mass of one [kg].
    pub mass: f64,
}

/// What a drive must do at most in an area, each at the worst point for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Load {
    /// Torque without that for the rotor [N·m].
    pub torque: f64,
    /// Speed [rad/s].
    pub speed: f64,
    /// Acceleration [rad/s²].
    pub acceleration: f64,
}

impl Load {
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            torque: self.torque.max(other.torque),
            speed: self.speed.max(other.speed),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }
}

impl Drive {
    /// The share of the torque at standstill that a load leaves; negative if the drive does not suffice.
    fn margin(&self, load: Load) -> f64 {
        let torque = load.torque + self.inertia * load.acceleration;
        let by_curve = 1.0 - load.speed / self.speed - torque / self.torque;
        by_curve.min(1.0 - torque / self.torque_limit)
    }
}

impl Payload {
    /// The cheapest drive that suffices for a load.
    pub fn cheapest(&self, load: Load) -> Option<&Drive> {
        self.drives.iter().find(|drive| drive.margin(load) >= 0.0)
    }

    /// The margin of the drive that has the greatest one.
    pub(super) fn margin(&self, load: Load) -> f64 {
        let margins = self.drives.iter().map(|drive| drive.margin(load));
        let margin = margins.fold(f64::NEG_INFINITY, f64::max) - KEPT;
        // Of the size of the other margins.
        match margin < 0.0 {
            true => margin / (1.0 - margin),
            false => margin,
        }
    }

    /// The load at a point.
    pub(super) fn load(&self, at: &Condition) -> Load {
        let state = State::new(self, at);
        let still = Vector2::zeros();
        let [x, y] = [Vector2::x(), Vector2::y()];
        let [by_x, by_y] = [x, y].map(|a| state.answer(still, a, still));
        let by_gravity = state.answer(still, still, self.gravity.into());
        let squares = [x, y, x + y].map(|v| state.answer(v, still, still));
        let square = self.speed * self.speed;
        let mut load = Load::default();
        for joint in 0..2 {
            // The extremes of vᵀ Q v, 0 at rest among them.
            let extremes = |[xx, yy, both]: [f64; 3]| {
                let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
                let radius = half.hypot(0.5 * (both - xx - yy));
                [mean - radius, mean + radius].map(|value| square * value)
            };
            let along = |x: f64, y: f64| self.acceleration * x.hypot(y);
            let greatest = |still: f64, [low, high]: [f64; 2]| {
                let ends = [still + low.min(0.0), still + high.max(0.0)];
                ends[0].abs().max(ends[1].abs())
            };
            let torques = squares.map(|answer| answer.torque[joint]);
            let turns = squares.map(|answer| answer.acceleration[joint]);
            let torque = greatest(by_gravity.torque[joint], extremes(torques))
                + along(by_x.torque[joint], by_y.torque[joint]);
            let acceleration = greatest(0.0, extremes(turns))
                + along(by_x.acceleration[joint], by_y.acceleration[joint]);
            load = load.max(Load {
                torque,
                speed: self.speed * state.rows[joint].norm(),
                acceleration,
            });
        }
        load
    }
}

impl Problem<'_> {
    /// With the margin of the payload where all else is met.
    pub(super) fn with_payload(
        &self,
        worst: Worst,
        lengths: [f64; 5],
        area: Placed,
        density: Density,
    ) -> Worst {
        match &self.specification.payload {
            Some(payload) if worst.margin >= 0.0 => {
                let margin = payload.margin(self.load(lengths, area, density));
                let margin = worst.margin.min(margin);
                Worst { margin, ..worst }
            }
            _ => worst,
        }
    }

    /// What the payload asks of a drive in an area, 0 without one.
    pub(super) fn load(&self, lengths: [f64; 5], area: Placed, density: Density) -> Load {
        let Some(payload) = &self.specification.payload else {
            return Load::default();
        };
        let samples = self.samples(density);
        let middle = Vector2::new(0.5 * lengths[4], 0.0);
        let at = |sample| match condition(lengths, middle + samples.at(sample, area)) {
            Ok(here) => payload.load(&here),
            Err(_) => Load::default(),
        };
        let mut worst = Load::default();
        let mut places = [[0.0; 2]; 2];
        for &sample in samples.points(lengths[4]) {
            let here = at(sample);
            if here.torque > worst.torque {
                places[0] = sample;
            }
            if here.speed > worst.speed {
                places[1] = sample;
            }
            worst = worst.max(here);
        }
        let by_torque = samples.lowest_near(density, places[0], |sample| -at(sample).torque);
        let by_speed = samples.lowest_near(density, places[1], |sample| -at(sample).speed);
        worst.max(at(by_torque)).max(at(by_speed))
    }
}

/// An arm at a point with its masses.
struct State {
    cranks: [Vector2<f64>; 2],
    couplers: [Vector2<f64>; 2],
    /// Of J⁻¹: θ̇ = row · v.
    rows: [Vector2<f64>; 2],
    /// Of J: the velocity of C by θ̇ of each joint.
    columns: [Vector2<f64>; 2],
    /// At C [kg].
    tip: f64,
    /// At the middle of each coupler [kg].
    middles: [f64; 2],
    /// At each elbow, for gravity [kg].
    elbows: [f64; 2],
    /// Of each crank with the end of its coupler about its pivot [kg·m²].
    inertia: [f64; 2],
}

/// The answer of both joints.
#[derive(Clone, Copy)]
struct Answer {
    torque: [f64; 2],
    acceleration: [f64; 2],
}

impl State {
    fn new(payload: &Payload, at: &Condition) -> Self {
        let couplers = at.legs.map(|leg| leg.far);
        let cranks = at.legs.map(|leg| leg.foot - leg.far);
        let rows = [0, 1].map(|leg| couplers[leg] / cranks[leg].cross_z(couplers[leg]));
        let det = rows[0].cross_z(rows[1]);
        let columns = [
            rows[1].perpendicular() / -det,
            rows[0].perpendicular() / det,
        ];
        let of = |link: Vector2<f64>| payload.link_density * link.norm();
        let ends = couplers.map(|coupler| of(coupler) / 6.0);
        Self {
            rows,
            columns,
            tip: payload.mass + ends[0] + ends[1],
            middles: ends.map(|end| 4.0 * end),
            elbows: [0, 1].map(|leg| ends[leg] + 0.5 * of(cranks[leg])),
            inertia: [0, 1].map(|leg| {
                let square = cranks[leg].norm_squared();
                (ends[leg] + of(cranks[leg]) / 3.0) * square
            }),
            cranks,
            couplers,
        }
    }

    /// For the velocity and the acceleration of C, under gravity.
    fn answer(&self, v: Vector2<f64>, a: Vector2<f64>, gravity: Vector2<f64>) -> Answer {
        let mut turned = [0.0; 2];
        let mut middles = [Vector2::zeros(); 2];
        for leg in 0..2 {
            let (n, f) = (self.cranks[leg], self.couplers[leg]);
            let rate = self.rows[leg].dot(&v);
            let around = (v - n.perpendicular() * rate).dot(&f.perpendicular()) / f.norm_squared();
            let inwards = n.dot(&f) * rate * rate + f.norm_squared() * around * around;
            turned[leg] = (a.dot(&f) + inwards) / n.cross_z(f);
            let elbow = n.perpendicular() * turned[leg] - n * (rate * rate);
            middles[leg] = (elbow + a) * 0.5;
        }
        let torque = [0, 1].map(|joint| {
            let own = self.cranks[joint].perpendicular();
            let by_middles: f64 = [0, 1]
                .map(|leg| {
                    let moved = match leg == joint {
                        true => own + self.columns[joint],
                        false => self.columns[joint],
                    };
                    self.middles[leg] * (middles[leg] - gravity).dot(&moved) * 0.5
                })
                .iter()
                .sum();
            self.tip * (a - gravity).dot(&self.columns[joint])
                + by_middles
                + self.inertia[joint] * turned[joint]
                - self.elbows[joint] * gravity.dot(&own)
        });
        Answer {
            torque,
            acceleration: turned,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::condition::condition;
    use super::*;
    use fivebar_kinematics::dynamics::{Arm, Link};
    use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
    use fivebar_testkit::{Tally, geometry};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn payload(drives: Vec<Drive>) -> Payload {
        Payload {
            mass: 0.3,
            speed: 0.7,
            acceleration: 6.0,
            gravity: [1.0, -9.7],
            link_density: 0.8,
            drives,
        }
    }

    /// By the inverse dynamics in directions that are tried one by one, with rods for links.
    fn by_directions(payload: &Payload, geometry: &Geometry<f64>, c: Vector2<f64>) -> Load {
        let mode = WorkingMode::new(Side::Right, Side::Left);
        let pose = geometry.inverse(c, mode).unwrap();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let rods = [l1, l2, l3, l4].map(|l| Link::uniform_rod(payload.link_density * l, l));
        let gravity = payload.gravity.into();
        let arm = Arm::new(*geometry, rods, payload.mass, gravity, [0.0; 2]).unwrap();
        let around = |count: u32| {
            let angles = (0..count).map(move |i| TAU * f64::from(i) / f64::from(count));
            angles.map(|angle| Vector2::new(angle.cos(), angle.sin()))
        };
        let mut load = Load::default();
        for speed in [0.0, payload.speed] {
            for v in around(90) {
                for a in around(90) {
                    let (v, a) = (v * speed, a * payload.acceleration);
                    let velocities = geometry.inverse_velocities(&pose, v).unwrap();
                    let accelerations = geometry
                        .inverse_accelerations(&pose, &velocities, a)
                        .unwrap();
                    let torques = arm
                        .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
                        .unwrap();
                    for joint in [0, 1] {
                        load = load.max(Load {
                            torque: torques[joint].abs(),
                            speed: velocities.omega[3 * joint].abs(),
                            acceleration: accelerations.alpha[3 * joint].abs(),
                        });
                    }
                }
            }
        }
        load
    }

    #[test]
    fn the_load_is_the_greatest_of_the_inverse_dynamics_in_all_directions() {
        let reached = Tally::default();
        let payload = payload(Vec::new());
        proptest!(ProptestConfig::with_cases(150), |(geometry in geometry(), x in -0.5..0.5_f64, y in -0.5..0.5_f64)| {
            let c = Vector2::new(x, y);
            let Ok(here) = condition(geometry.lengths(), c) else { return Ok(()) };
            let mode = WorkingMode::new(Side::Right, Side::Left);
            prop_assume!(geometry.inverse(c, mode).unwrap().nearest_singularity().1 > 0.1);
            let (found, tried) = (payload.load(&here), by_directions(&payload, &geometry, c));
            let pairs = [
                (found.torque, tried.torque),
                (found.speed, tried.speed),
                (found.acceleration, tried.acceleration),
            ];
            for (found, tried) in pairs {
                // Four degrees between directions miss 0.06 % of a length and 0.25 % of a square.
                prop_assert!(tried <= found * (1.0 + 1e-9), "{found} {tried}");
                prop_assert!(tried >= found * 0.995, "{found} {tried}");
            }
            reached.count(true);
        });
        assert!(reached.accepted() > 10);
    }

    #[test]
    fn the_cheapest_drive_that_suffices_is_chosen() {
        let drive = |name: &str, torque: f64, speed: f64, torque_limit: f64| Drive {
            name: name.into(),
            torque,
            speed,
            torque_limit,
            inertia: 0.01,
            price: 0.0,
            mass: 0.0,
        };
        let payload = payload(vec![
            drive("slow", 5.0, 9.0, f64::INFINITY),
            drive("weak gear", 5.0, 40.0, 1.0),
            drive("right", 5.0, 40.0, 3.0),
            drive("strong", 50.0, 40.0, 30.0),
        ]);
        let load = |speed: f64| Load {
            torque: 1.0,
            speed,
            acceleration: 10.0,
        };
        let chosen = |speed: f64| payload.cheapest(load(speed)).map(|drive| &*drive.name);
        assert_eq!(chosen(1.0), Some("slow"));
        assert_eq!(chosen(10.0), Some("right"));
        // 1.1 N·m of 5 N·m at 31.2 rad/s of 40 rad/s are the limit.
        assert_eq!(chosen(31.1), Some("right"));
        assert_eq!(chosen(31.3), Some("strong"));
        assert_eq!(chosen(40.0), None);
    }
}
