//! The torques of joints behind belts: deviations from the set-point's motion on both sides of the belt.
//!
//! With the set-point q, and the torque fed forward for it
//!
//! τff = M(q) q̈ + h(q, q̇) + friction(q̇d),
//!
//! τff − Jr q̈ passes the belt, and the rotor leads the links by (τff − Jr q̈)/k. What an encoder shows beyond the
//! set-point, and this lead, of its moment is a deviation, which [`BeltLaw`] observes and feeds back.
//!
//! [`BeltLaw`]: fivebar_kinematics::control::BeltLaw

use super::ArmController;
use super::model::AxisModel;
use super::setpoint_history::{Belted, small_angle};
use super::tracking::add_torques_of_path;
use crate::drives::Drives;
use crate::safety::Fault;
use fivebar_kinematics::control::BeltState;
use fivebar_kinematics::five_bar::Joint;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Joints that do what they should.
pub(super) const STILL: [BeltState<f32>; 2] = [BeltState {
    rotor_angle: 0.0,
    rotor_velocity: 0.0,
    angle: 0.0,
    velocity: 0.0,
    load: 0.0,
    torque: 0.0,
}; 2];

/// M⁻¹ of M11, M14, M44, for several right sides.
struct Inverse([f32; 3]);

impl Inverse {
    #[inline(always)]
    fn of([m11, m14, m44]: [f32; 3]) -> Self {
        let per_determinant = 1.0 / (m11 * m44 - m14 * m14);
        Self([
            m44 * per_determinant,
            -m14 * per_determinant,
            m11 * per_determinant,
        ])
    }

    #[inline(always)]
    fn solve(&self, [x1, x4]: [f32; 2]) -> [f32; 2] {
        let Self([i11, i14, i44]) = self;
        [i11 * x1 + i14 * x4, i14 * x1 + i44 * x4]
    }
}

impl<D: Drives> ArmController<D> {
    /// The torques of this tick, and whether they are limited.
    #[inline(always)]
    pub(super) fn torques_on_belts(&mut self) -> Result<([f32; 2], bool), Fault> {
        let [mut state1, mut state4] = if self.setpoint_history.begins() {
            STILL
        } else {
            self.belts
        };
        let setpoint = self.setpoint;
        let [d1, d4] = setpoint.direction;
        let [joint1, joint4] = &self.joints;
        let [axis1, axis4] = &self.model.axes;
        let ages = [&axis1.servo.age, &axis4.servo.age];
        let between = [
            self.setpoint_history.between(Joint::Joint1, ages[0]),
            self.setpoint_history.between(Joint::Joint4, ages[1]),
        ];
        // Where the joints are when the torque acts, if they go on as the set-point does.
        let [u1, u4] = Vector2::units([
            joint1.counted(axis1) + between[0].angle,
            joint4.counted(axis4) + between[1].angle,
        ]);
        let links = self.measured([u1, u4])?;
        let apart = [small_angle(d1.cross_z(u1)), small_angle(d4.cross_z(u4))];
        self.error = [-apart[0], -apart[1]];
        if self.model.monitor.following_error_exceeded(self.error) {
            return Err(Fault::FollowingError);
        }
        let [axis1, axis4] = &self.model.axes;
        let (law1, law4) = (axis1.belt(), axis4.belt());
        let [lead1, lead4] = [
            self.setpoint_history.lead(Joint::Joint1, &axis1.servo.age),
            self.setpoint_history.lead(Joint::Joint4, &axis4.servo.age),
        ];
        let equations = &self.model.equations;
        let mass = equations.mass(&links);
        let [m11, m14, m44] = mass;
        let [rotor1, rotor4] = self.model.rotor_inertia;
        let inverse = Inverse::of([m11 - rotor1, m14, m44 - rotor4]);

        let rests = setpoint.omega == [0.0; 2];
        let unseen = |axis: &AxisModel| {
            let half_count = 0.5 * Scalar::abs(axis.radians_per_count);
            if rests { half_count } else { 0.0 }
        };
        let impulses = [
            law1.correct(&mut state1, apart[0] - lead1, unseen(axis1)),
            law4.correct(&mut state4, apart[1] - lead4, unseen(axis4)),
        ];
        let [change1, change4] = inverse.solve(impulses);
        state1.velocity += change1;
        state4.velocity += change4;
        let (demand1, demand4) = (law1.demand(&state1), law4.demand(&state4));

        let [omega1d, omega4d] = setpoint.omega;
        let omega = [omega1d + state1.velocity, omega4d + state4.velocity];
        let [torque1, torque4] = equations.torques(&links, omega, setpoint.alpha);
        let mut forward = [
            torque1 + axis1.friction.torque(omega1d),
            torque4 + axis4.friction.torque(omega4d),
        ];
        let (drives, path) = (&self.drives, &self.path);
        add_torques_of_path(&mut forward, drives, path, &links, setpoint.omega);
        let [alpha1d, alpha4d] = setpoint.alpha;
        let leads = [
            law1.lead(forward[0] - rotor1 * alpha1d),
            law4.lead(forward[1] - rotor4 * alpha4d),
        ];
        let (alpha1, alpha4) = (demand1.alpha, demand4.alpha);
        let (torque, limited) = self.model.torque_limit.apply([
            forward[0] + m11 * alpha1 + m14 * alpha4 + demand1.torque,
            forward[1] + m14 * alpha1 + m44 * alpha4 + demand4.torque,
        ]);

        // The next sample.
        let [late1, late4] = self.setpoint_history.demand(self.model.late_ticks);
        let [change1, change4] = inverse.solve([law1.impulse(&state1), law4.impulse(&state4)]);
        law1.advance(&mut state1, change1, late1);
        law4.advance(&mut state4, change4, late4);
        self.belts = [state1, state4];
        self.setpoint_history.keep_belted(Belted {
            lead: leads,
            demand: [torque[0] - forward[0], torque[1] - forward[1]],
        });
        Ok((torque, limited))
    }
}
