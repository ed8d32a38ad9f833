//! Computed torque against a plant with other masses than the controller's model.
//!
//! The controller moves C along a circle: τ = M(q) (q̈d + Kd ė + Kp e) + h(q, q̇), the
//! demanded acceleration put into inverse dynamics. The plant is integrated by the midpoint
//! method.
//!
//! `cargo run --example computed_torque`

use fivebar_kinematics::control::{Integral, PositionLoop};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Joint, PoseError, Side, WorkingMode};
use fivebar_kinematics::nalgebra::{Vector2, Vector4};
use std::error::Error;
use std::f64::consts::TAU;

const PERIOD: f64 = 1e-3; // s
const MODE: WorkingMode = WorkingMode::new(Side::Right, Side::Left);

/// (θ1, θ4, ω1, ω4) [rad, rad/s].
type State = Vector4<f64>;

/// A five-bar of four uniform rods [kg], with a payload [kg], in a vertical plane.
fn arm(rod_mass: f64, payload: f64) -> Result<Arm<f64>, Box<dyn Error>> {
    let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?;
    let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(rod_mass, length));
    let gravity = Vector2::new(0.0, -9.81);
    Ok(Arm::new(geometry, rods, payload, gravity, [2e-5; 2])?)
}

/// The reference at time `t` [s]: C [m] on a circle of 20 mm about (40, 190) mm at 1 Hz, and
/// the angles, rates and accelerations of joints 1 and 4.
fn reference(model: &Arm<f64>, t: f64) -> Result<(Vector2<f64>, [[f64; 2]; 3]), PoseError> {
    let (sin, cos) = (TAU * t).sin_cos();
    let (geometry, outwards) = (model.geometry(), Vector2::new(cos, sin) * 0.02);
    let c = Vector2::new(0.04, 0.19) + outwards;
    let pose = geometry.inverse(c, MODE)?;
    let rates = geometry.inverse_velocities(&pose, Vector2::new(-sin, cos) * (0.02 * TAU))?;
    let accelerations = geometry.inverse_accelerations(&pose, &rates, outwards * -TAU.powi(2))?;
    let driven = |[joint1, _, _, joint4]: [f64; 4]| [joint1, joint4];
    let angles = pose.angles();
    Ok((c, [angles, rates.omega, accelerations.alpha].map(driven)))
}

/// The plant's state one period later.
fn step(plant: &Arm<f64>, x: State, torque: [f64; 2]) -> Result<State, PoseError> {
    let derivative = |x: State| -> Result<State, PoseError> {
        let pose = plant.geometry().forward(x.x, x.y, Side::Left)?;
        let rates = plant.geometry().forward_velocities(&pose, x.z, x.w)?;
        let [alpha1, alpha4] = plant.forward_dynamics(&pose, &rates, torque, Vector2::zeros())?;
        Ok(State::new(x.z, x.w, alpha1, alpha4))
    };
    let middle = x + derivative(x)? * (0.5 * PERIOD);
    Ok(x + derivative(middle)? * PERIOD)
}

/// The greatest distance of C from the circle's moving point [m] over two seconds.
fn worst_error(model: &Arm<f64>, plant: &Arm<f64>, bandwidth: f64) -> Result<f64, PoseError> {
    let geometry = model.geometry();
    let gains = PositionLoop::new(bandwidth, 1.0, 0.0, 0.0, PERIOD);
    let (_, [[theta1, theta4], [omega1, omega4], _]) = reference(model, 0.0)?;
    let mut state = State::new(theta1, theta4, omega1, omega4);
    let mut worst = 0.0_f64;
    for tick in 0..2000 {
        let (c, [theta, omega, alpha]) = reference(model, f64::from(tick) * PERIOD)?;
        let demand = |joint: Joint, position: f64, rate: f64| {
            let (error, error_rate) = (theta[joint] - position, omega[joint] - rate);
            gains.acceleration(Integral(0.0), alpha[joint], error, error_rate)
        };
        let alpha1 = demand(Joint::Joint1, state.x, state.z);
        let alpha4 = demand(Joint::Joint4, state.y, state.w);

        // The torque for that demand, at the measured state.
        let pose = geometry.forward(state.x, state.y, Side::Left)?;
        worst = worst.max((pose.c - c).norm());
        let measured = geometry.forward_velocities(&pose, state.z, state.w)?;
        let demanded = geometry.forward_accelerations(&pose, &measured, alpha1, alpha4)?;
        let torque = model.inverse_dynamics(&pose, &measured, &demanded, Vector2::zeros())?;
        state = step(plant, state, torque)?;
    }
    Ok(worst)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (model, heavier) = (arm(0.06, 0.03)?, arm(0.066, 0.04)?);
    let exact = worst_error(&model, &model, 60.0)?;
    let soft = worst_error(&model, &heavier, 60.0)?;
    let stiff = worst_error(&model, &heavier, 120.0)?;
    let errors = [exact, soft, stiff].map(|error| 1e3 * error);
    println!("true masses, 60 rad/s; other masses, 60 and 120 rad/s: {errors:.3?} mm");
    // The error of wrong masses falls with the square of the bandwidth.
    assert!(exact < 0.1e-3 && soft < 5e-3);
    assert!((3.0..5.0).contains(&(soft / stiff)), "{soft} and {stiff}");
    Ok(())
}

#[test]
fn wrong_masses_cost_accuracy_that_bandwidth_restores() -> Result<(), Box<dyn Error>> {
    main()
}
