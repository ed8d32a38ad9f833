//! Derivatives carried by dual numbers against finite differences, through every function
//! that the models use.

use fivebar_design::Dual;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;

/// τ1, τ4, the distal angles and C of one state, as functions of the arm's parameters and motion:
/// l1…l4, the base, θ1, θ4, ω1, α4, the mass and the centre of link 2.
fn outputs<S: Scalar>(given: [S; 11]) -> [S; 6] {
    let [
        l1,
        l2,
        l3,
        l4,
        base,
        theta1,
        theta4,
        omega1,
        alpha4,
        mass2,
        along2,
    ] = given;
    let number = S::from_f64;
    let geometry = Geometry::new([l1, l2, l3, l4, base]).unwrap();
    let link = Link {
        mass: number(0.12),
        com: Vector2::new(number(0.05), number(0.003)),
        inertia: number(1e-4),
    };
    let distal = Link {
        mass: mass2,
        com: Vector2::new(along2, number(-0.004)),
        ..link
    };
    let gravity = Vector2::new(number(0.0), number(-9.81));
    let rotors = [number(1e-5); 2];
    let arm = Arm::new(
        geometry,
        [link, distal, link, link],
        number(0.1),
        gravity,
        rotors,
    );
    let pose = geometry.forward(theta1, theta4, Side::Left).unwrap();
    let rates = geometry
        .forward_velocities(&pose, omega1, number(-2.0))
        .unwrap();
    let acc = geometry
        .forward_accelerations(&pose, &rates, number(20.0), alpha4)
        .unwrap();
    let force = Vector2::new(number(1.0), number(-3.0));
    let [torque1, torque4] = arm
        .unwrap()
        .inverse_dynamics(&pose, &rates, &acc, force)
        .unwrap();
    let [_, theta2, theta3, _] = pose.angles();
    [torque1, torque4, theta2, theta3, pose.c.x, pose.c.y]
}

#[test]
fn derivatives_by_dual_numbers_are_those_of_finite_differences() {
    let given = [
        0.09, 0.1, 0.11, 0.085, 0.118, 2.0, 0.9, 3.0, -30.0, 0.08, 0.05,
    ];
    let value = outputs(given);
    for input in 0..given.len() {
        let mut seeded = given.map(Dual::constant);
        seeded[input] = Dual::variable(given[input]);
        let dual = outputs(seeded);
        let step = 1e-6 * given[input].abs();
        let moved = |by: f64| {
            let mut moved = given;
            moved[input] += by;
            outputs(moved)
        };
        let (ahead, behind) = (moved(step), moved(-step));
        let mut largest = 0.0_f64;
        for output in 0..value.len() {
            let difference = (ahead[output] - behind[output]) / (2.0 * step);
            // The value differs by rounding, because num-dual divides in another way.
            assert!((dual[output].value() - value[output]).abs() <= 1e-14 * value[output].abs());
            let bound = 1e-6 * difference.abs().max(1.0);
            assert!(
                (dual[output].derivative() - difference).abs() <= bound,
                "output {output} by input {input}: {} for {difference}",
                dual[output].derivative()
            );
            largest = largest.max(dual[output].derivative().abs());
        }
        assert!(largest > 1e-4, "input {input} matters");
    }
}
