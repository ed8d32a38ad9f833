//! Random arms, poses and motions.

use fivebar_kinematics::five_bar::{Accelerations, Geometry, Pose, Side, Velocities, WorkingMode};
use proptest::prelude::*;

/// A pose of an arm, with the angles and the assembly mode that give it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The arm.
    pub geometry: Geometry<f64>,
    /// θ1 [rad].
    pub theta1: f64,
    /// θ4 [rad].
    pub theta4: f64,
    /// The side of C.
    pub assembly: Side,
    /// The forward solution for these.
    pub pose: Pose<f64>,
}

/// Either side.
pub fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Left), Just(Side::Right)]
}

/// Any of the four working modes.
pub fn mode() -> impl Strategy<Value = WorkingMode> {
    (side(), side()).prop_map(|(elbow1, elbow4)| WorkingMode::new(elbow1, elbow4))
}

/// Any four links and base that can be assembled, from 5 cm to 50 cm, asymmetric; of four arms one
/// is coaxial.
pub fn geometry() -> impl Strategy<Value = Geometry<f64>> {
    let base = prop_oneof![3 => 0.05..0.5_f64, 1 => Just(0.0)];
    (prop::array::uniform4(0.05..0.5_f64), base)
        .prop_filter_map("does not close", |([l1, l2, l3, l4], base)| {
            Geometry::new([l1, l2, l3, l4, base]).ok()
        })
}

/// A pose of any arm whose three sines are all at least `margin`.
pub fn pose(margin: f64) -> impl Strategy<Value = Case> {
    let angle = || -3.1..3.1_f64;
    (geometry(), angle(), angle(), side()).prop_filter_map(
        "no pose with that margin",
        move |(geometry, theta1, theta4, assembly)| {
            let pose = geometry.forward(theta1, theta4, assembly).ok()?;
            (pose.nearest_singularity().1 >= margin).then_some(Case {
                geometry,
                theta1,
                theta4,
                assembly,
                pose,
            })
        },
    )
}

/// Rates [rad/s] or accelerations [rad/s²] of the driven joints, a few per second.
fn driven() -> impl Strategy<Value = [f64; 2]> {
    prop::array::uniform2(-5.0..5.0_f64)
}

/// A pose with a smooth motion through it: θ(t) = θ + ω t + ½ α t² of both driven joints.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// The pose at time 0.
    pub case: Case,
    /// ω1, ω4 at time 0 [rad/s].
    pub omega: [f64; 2],
    /// α1, α4 [rad/s²].
    pub alpha: [f64; 2],
}

/// A motion through a pose whose three sines are all at least `margin`.
pub fn moving(margin: f64) -> impl Strategy<Value = Moving> {
    (pose(margin), driven(), driven()).prop_map(|(case, omega, alpha)| Moving {
        case,
        omega,
        alpha,
    })
}

impl Moving {
    /// θ1, θ4 [rad] and ω1, ω4 [rad/s] at a time near 0.
    fn driven_at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let start = [self.case.theta1, self.case.theta4];
        let at = |i: usize| start[i] + self.omega[i] * t + 0.5 * self.alpha[i] * t * t;
        let rate = |i: usize| self.omega[i] + self.alpha[i] * t;
        ([at(0), at(1)], [rate(0), rate(1)])
    }

    /// The pose at a time near 0.
    ///
    /// # Panics
    /// If the forward solution refuses it.
    pub fn pose_at(&self, t: f64) -> Pose<f64> {
        let ([theta1, theta4], _) = self.driven_at(t);
        let Case {
            geometry, assembly, ..
        } = self.case;
        geometry.forward(theta1, theta4, assembly).unwrap()
    }

    /// The pose, velocities and accelerations at time 0.
    ///
    /// # Panics
    /// If the forward solution refuses it.
    pub fn now(&self) -> (Pose<f64>, Velocities<f64>, Accelerations<f64>) {
        let (pose, velocities) = self.rates_at(0.0);
        let accelerations = self
            .case
            .geometry
            .forward_accelerations(&pose, &velocities, self.alpha[0], self.alpha[1])
            .unwrap();
        (pose, velocities, accelerations)
    }

    /// The pose and velocities at a time near 0.
    ///
    /// # Panics
    /// If the forward solution refuses it.
    pub fn rates_at(&self, t: f64) -> (Pose<f64>, Velocities<f64>) {
        let (_, [omega1, omega4]) = self.driven_at(t);
        let pose = self.pose_at(t);
        let geometry = self.case.geometry;
        let velocities = geometry.forward_velocities(&pose, omega1, omega4).unwrap();
        (pose, velocities)
    }

    /// d/dt at time 0 by the five-point rule, in steps that turn no link by more than 1e-4
    /// rad: its truncation is of fourth order in that.
    pub fn rate(&self, f: impl Fn(f64) -> f64) -> f64 {
        let (_, velocities, accelerations) = self.now();
        let fastest = velocities.omega.iter().fold(1.0_f64, |m, w| m.max(w.abs()));
        let hastiest = accelerations
            .alpha
            .iter()
            .fold(1.0_f64, |m, a| m.max(a.abs()));
        let h = 1e-4 / fastest.max(hastiest.sqrt());
        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
    }
}
