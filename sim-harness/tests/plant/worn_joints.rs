//! The arm with worn joints: its energy, and its convergence to the ideal arm.

use fivebar_design::accuracy::arm::DrivenJointMotion;
use fivebar_design::accuracy::clearance_equilibrium::clearance_equilibrium;
use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Mismatch;
use fivebar_plant::contact::Contact;
use fivebar_plant::{Loads, Model, Plant, State, WornJoints};
use nalgebra::Vector2;
use proptest::prelude::*;

const TICK: f64 = 1e-4;
const FREE: Loads = Loads {
    voltage: [None; 2],
    joint_torque: [0.0; 2],
    tool_force: Vector2::new(0.0, 0.0),
};

/// The benchtop arm with these clearances, hanging in gravity. It starts at home with the crank
/// speeds `omega`.
fn initial(contact: &Contact, clearance: [f64; 5], omega: [f64; 2]) -> (Model, State, WornJoints) {
    let robot = Robot::load("benchtop").unwrap();
    let mut model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::NONE);
    let wear = WornJoints::new(contact, clearance).unwrap();
    model.gravity = Vector2::new(0.0, -9.81);
    model.chain.constrained = wear.constrained();
    let pose = robot.home_pose().unwrap();
    let [omega1, omega4] = omega;
    let rates = robot.geometry.forward_velocities(&pose, omega1, omega4);
    let state = model.state_at(&pose, rates.unwrap().omega);
    (model, state, wear)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Without drive, the sum of kinetic, gravitational and contact energy does not grow;
    /// impacts and friction reduce it.
    #[test]
    fn the_energy_of_a_passive_run_does_not_grow(
        clearance in prop::array::uniform5(prop_oneof![Just(0.0), 5e-6..2e-4_f64]),
        restitution in 0.5..1.0_f64,
        friction in 0.0..0.3_f64,
        omega in prop::array::uniform2(-8.0..8.0_f64),
    ) {
        let contact = Contact { restitution, friction, ..Contact::default() };
        let (mut model, mut state, mut wear) = initial(&contact, clearance, omega);
        for motor in &mut model.motors {
            motor.viscous_friction = 0.0;
            motor.coulomb_friction = 0.0;
        }
        let energy = |wear: &WornJoints, state: &State| model.energy(state) + wear.energy(&model, state);
        let mut least = energy(&wear, &state);
        // A step may have an error of 1 µm/s, with a momentum of about 0.05 kg·m/s.
        let rounding = 5e-8 + 1e-6 * model.kinetic_energy(&state);
        for _ in 0..300 {
            wear.step(&model, &mut state, &FREE, TICK);
            let after = energy(&wear, &state);
            prop_assert!(after <= least + rounding, "grew by {:e} J", after - least);
            least = least.min(after);
            let shares = wear.eccentricity(&model, &state);
            prop_assert!(shares.iter().flatten().all(|&share| share < 1.5), "{shares:?}");
        }
        let impacts: u32 = wear.take_statistics().iter().map(|joint| joint.impacts).sum();
        // A pin may also turn back before it meets its bearing.
        prop_assert!(impacts == 0 || clearance.iter().any(|&c| c > 0.0));
    }
}

#[test]
fn pins_that_begin_in_the_middle_meet_their_bearings() {
    let (model, mut state, mut wear) = initial(&Contact::default(), [1e-4; 5], [2.0, -3.0]);
    for _ in 0..1000 {
        wear.step(&model, &mut state, &FREE, TICK);
    }
    let statistics = wear.take_statistics();
    assert!(
        statistics.iter().all(|joint| joint.impacts > 0),
        "{statistics:?}"
    );
}

/// The greatest distance of the tool from that of an ideal arm within 50 ms. The pins have no
/// friction, because its effect does not vanish with the clearance.
fn departure(clearance: [f64; 5]) -> f64 {
    let contact = Contact {
        friction: 0.0,
        ..Contact::default()
    };
    let (model, mut worn, mut wear) = initial(&contact, clearance, [-3.0, 2.0]);
    let (ideal_model, mut ideal, _) = initial(&contact, [0.0; 5], [-3.0, 2.0]);
    let mut most = 0.0_f64;
    for _ in 0..500 {
        wear.step(&model, &mut worn, &FREE, TICK);
        ideal_model.step(&mut ideal, &FREE, TICK);
        most = most.max((model.tool(&worn) - ideal_model.tool(&ideal)).norm());
    }
    most
}

#[test]
fn the_motion_converges_to_the_ideal_arms_as_the_clearance_vanishes() {
    let departures = [1e-4, 1e-5, 1e-6].map(|c| departure([c; 5]));
    println!("100, 10, 1 µm: {departures:?} m");
    let [large, middle, small] = departures;
    assert!(small < 1e-5 && middle < 1e-4 && large < 1e-3);
    assert!(middle < 0.3 * large && small < 0.3 * middle);
    // Without wear, the adaptive integrator agrees with the fixed steps.
    let none = departure([0.0; 5]);
    assert!(none < 1e-7, "{none:e}");
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let run = || {
        let (model, mut state, mut wear) = initial(&Contact::default(), [5e-5; 5], [4.0, -4.0]);
        for _ in 0..200 {
            wear.step(&model, &mut state, &FREE, TICK);
        }
        (state, wear.take_statistics())
    };
    assert_eq!(run(), run());
}

/// The arm at rest, after 0.3 s with a force on its tool. Independent models, statics and the
/// equilibrium of the pins, give its reactions and its position.
fn pushed(robot: &Robot, clearance: [f64; 5]) -> Plant {
    let contact = Contact {
        restitution: 0.5,
        ..Contact::default()
    };
    let pose = robot.home_pose().unwrap();
    let wear = WornJoints::new(&contact, clearance).unwrap();
    let mut plant = Plant::new(
        &robot.plant_parameters().unwrap(),
        &Mismatch::NONE,
        &pose,
        1,
    )
    .worn(wear);
    plant.set_tool_force(Vector2::new(0.0, -5.0));
    for _ in 0..3000 {
        plant.step(&ActuatorCommand::default(), TICK);
    }
    plant
}

fn with_stiff_motors() -> Robot {
    let mut robot = Robot::load("benchtop").unwrap();
    for drive in robot.actuators.iter_mut().flatten() {
        drive.coulomb_friction = 1.0;
    }
    robot
}

#[test]
fn a_worn_joint_at_rest_has_the_reaction_of_an_ideal_one() {
    let robot = with_stiff_motors();
    let ideal = pushed(&robot, [0.0; 5]).reactions();
    let worn = pushed(&robot, [1e-5; 5]).reactions();
    for (ideal, worn) in ideal.iter().zip(&worn) {
        assert!(ideal.norm() > 1.0);
        let off = (ideal - worn).norm();
        assert!(off < 0.02 * ideal.norm(), "{worn:?} for {ideal:?}");
    }
}

#[test]
fn a_pushed_arm_rests_at_the_position_of_the_kineto_static_model() {
    let robot = with_stiff_motors();
    let assembly = robot.home_pose().unwrap().assembly();
    for clearance in [1e-5, 5e-5] {
        let plant = pushed(&robot, [clearance; 5]);
        let theta = [plant.angle(Joint::Joint1), plant.angle(Joint::Joint4)];
        let inputs = DrivenJointMotion {
            theta,
            omega: [0.0; 2],
            alpha: [0.0; 2],
        };
        let force = Vector2::new(0.0, -5.0);
        let equilibrium = clearance_equilibrium(
            robot.arm().unwrap(),
            assembly,
            &inputs,
            force,
            [clearance; 5],
        )
        .unwrap();
        let ideal = robot
            .geometry
            .forward(theta[0], theta[1], assembly)
            .unwrap();
        let tool = plant.tool();
        let simulated = Vector2::new(tool.x, tool.y) - ideal.c;
        let off = (simulated - equilibrium.displacement).norm();
        println!("{simulated:?} for {:?}", equilibrium.displacement);
        // The pins penetrate their bearings by a few hundredths of a micrometre.
        assert!(equilibrium.converged && equilibrium.displacement.norm() > clearance);
        assert!(
            off < 0.03 * equilibrium.displacement.norm(),
            "off by {off:e} m"
        );
    }
}
