//! What an arm's tip error should be: the torques that its controller does not know, through the linear closed loop.
//!
//! The simulated arm is not asked. Along the set-points the inverse dynamics of the arm as it is, less those of its
//! model, are loads on the joints, and so is what friction differs by. The closed loop at the pose of the moment, with
//! the arm's own masses and belts and the law of its model, answers them. The encoders are at the rotors, so a belt of
//! another stiffness leaves the joint beside its set-point by the torque times the difference of the compliances.
//! Counts are left out: the error of the same arm without mismatch stands for them, beside the loads' by squares.

use crate::arms::RandomArm;
use fivebar_design::servo::{ClosedLoop, Servo};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Accelerations, Joint, Pose, Velocities};
use fivebar_sim::simulation::Sample;
use nalgebra::{Matrix2, Vector2};

/// Time for which a pose serves [s].
const POSE: f64 = 0.01;

/// The arm as it is.
fn true_arm(arm: &RandomArm) -> Arm<f64> {
    let model = arm.robot.arm().expect("masses");
    let factor = 1.0 + arm.mismatch.link_mass;
    let links = model.links().map(|link| Link {
        mass: factor * link.mass,
        inertia: factor * link.inertia,
        ..link
    });
    let payload = model.payload() + arm.mismatch.payload;
    let rotors = model.rotor_inertia();
    Arm::new(*model.geometry(), links, payload, model.gravity(), rotors).expect("valid")
}

/// The set-point of a sample.
struct Motion {
    pose: Pose<f64>,
    velocities: Velocities<f64>,
    accelerations: Accelerations<f64>,
}

impl Motion {
    fn of(arm: &Arm<f64>, sample: &Sample, like: &Pose<f64>) -> Self {
        let geometry = arm.geometry();
        let [theta1, theta4] = sample.reference_angle;
        let [omega1, omega4] = sample.reference_velocity;
        let [alpha1, alpha4] = sample.reference_acceleration;
        let pose = geometry
            .forward(theta1, theta4, like.assembly())
            .expect("a pose of the way");
        let velocities = geometry
            .forward_velocities(&pose, omega1, omega4)
            .expect("clear");
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha1, alpha4)
            .expect("clear");
        Self {
            pose,
            velocities,
            accelerations,
        }
    }

    fn torque(&self, arm: &Arm<f64>) -> Vector2<f64> {
        let none = Vector2::zeros();
        let torque = arm.inverse_dynamics(&self.pose, &self.velocities, &self.accelerations, none);
        torque.expect("clear").into()
    }
}

/// The tip error [m], root mean square, that loads give along these set-points; none if the loop is unstable at one of
/// the poses.
pub(crate) fn predicted(arm: &RandomArm, samples: &[Sample]) -> Option<f64> {
    let robot = &arm.robot;
    let period = samples[1].time - samples[0].time;
    let ticks = (period * robot.control.tick_rate).round() as usize;
    let every = (POSE / period).ceil() as usize;
    let (model, truth) = (robot.arm().expect("masses"), true_arm(arm));
    let tool = robot.tool_on_link().expect("a tool");
    let home = robot.home_pose().expect("a home");
    let drives = robot.servos().expect("masses")[0].1.drives;
    let actuators = robot.drives().expect("drives");
    let belts = arm.mismatch.stiffness.expect("belts");
    let mut true_drives = drives;
    for (drive, stiffness) in true_drives.iter_mut().zip(belts) {
        drive.stiffness = Some(stiffness);
    }
    let tick = 1.0 / robot.control.tick_rate;
    let closed = |pose: &Pose<f64>| {
        let mass = |arm: &Arm<f64>| -> Matrix2<f64> { arm.mass_matrix(pose).expect("clear") };
        let law = Servo::new(mass(model), drives, tick).law(&robot.gains());
        let servo = Servo::new(mass(&truth), true_drives, tick);
        let stable = servo.spectral_radius(&law, 1.0) < 1.0;
        stable.then(|| servo.closed(&law))
    };
    let mut at: Option<ClosedLoop> = None;
    let mut state = None;
    let mut direction = [0.0; 2];
    let mut squares = 0.0;
    for (index, sample) in samples.iter().enumerate() {
        let motion = Motion::of(model, sample, &home);
        if index % every == 0 {
            at = Some(closed(&motion.pose)?);
        }
        let closed = at.as_ref()?;
        let known = motion.torque(model);
        let mut load = known - motion.torque(&truth);
        for joint in Joint::ALL {
            let (j, omega) = (joint.index(), sample.reference_velocity[joint.index()]);
            // A joint at rest stays where friction holds it.
            if omega != 0.0 {
                direction[j] = omega.signum();
            }
            let friction = actuators[joint].coulomb_friction * direction[j]
                + actuators[joint].viscous_friction * omega;
            load[j] -= arm.mismatch.friction * friction;
        }
        let state = state.get_or_insert_with(|| closed.at_rest());
        let mut angle = [0.0; 2];
        for _ in 0..ticks {
            angle = closed.tick(state, load.into());
        }
        let beside = Vector2::from_fn(|j, _| {
            let links = known[j] - drives[j].rotor_inertia * sample.reference_acceleration[j];
            angle[j] - links * (1.0 / belts[j] - 1.0 / arm.stiffness[j])
        });
        let jacobian = tool.jacobian(&motion.pose).expect("clear").matrix();
        squares += (jacobian * beside).norm_squared();
    }
    Some((squares / samples.len() as f64).sqrt())
}
