//! Kane's equations against energy, Newton–Euler equations and statics.

use fivebar_kinematics::dynamics::{
    Arm, BaseParameterModel, Link, ModelError, ShareTotals, TorqueComponents,
};
use fivebar_kinematics::five_bar::{Geometry, Links, PoseError, Side, Singularity};
use fivebar_testkit::{Moving, assert_close, moving};
use nalgebra::Vector2;
use proptest::prelude::*;

fn vec2(size: f64) -> impl Strategy<Value = Vector2<f64>> {
    (-size..size, -size..size).prop_map(|(x, y)| Vector2::new(x, y))
}

fn link() -> impl Strategy<Value = Link<f64>> {
    (0.01..1.0_f64, vec2(0.3), 1e-5..1e-2_f64).prop_map(|(mass, com, inertia)| Link {
        mass,
        com,
        inertia,
    })
}

/// A moving arm with any masses, centres anywhere, gravity, rotors, and a force on C.
fn loaded() -> impl Strategy<Value = (Moving, Arm<f64>, Vector2<f64>)> {
    (
        moving(0.1),
        prop::array::uniform4(link()),
        0.0..0.5_f64,
        vec2(10.0),
        prop::array::uniform2(0.0..1e-3_f64),
        vec2(10.0),
    )
        .prop_map(|(moving, links, payload, gravity, rotors, force)| {
            let arm = Arm::new(moving.case.geometry, links, payload, gravity, rotors).unwrap();
            (moving, arm, force)
        })
}

/// Asserts that two torques are equal to `tolerance` of the larger.
#[track_caller]
fn assert_torque(what: &str, a: [f64; 2], b: [f64; 2], tolerance: f64) {
    let scale = a.iter().chain(&b).fold(1.0_f64, |m, x| m.max(x.abs()));
    for (a, b) in a.into_iter().zip(b) {
        assert!((a - b).abs() <= tolerance * scale, "{what}: {a} for {b}");
    }
}

proptest! {
    #[test]
    fn regrouped_equations_are_kanes((moving, arm, _) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let [omega1, _, _, omega4] = velocities.omega;
        let kane = arm
            .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::new(0.0, 0.0))
            .unwrap();
        let base_parameters = BaseParameterModel::new(&arm);
        let links = Links::of(&pose, arm.geometry());
        let torque = base_parameters.torques(&links, [omega1, omega4], moving.alpha);
        assert_torque("τ", torque, kane, 1e-9);
        let mass = arm.mass_matrix(&pose).unwrap();
        for (regrouped, mass) in base_parameters.mass(&links).into_iter().zip([
            mass.m11, mass.m12, mass.m22,
        ]) {
            prop_assert!((regrouped - mass).abs() <= 1e-9 * mass.abs().max(1e-3), "{regrouped} for {mass}");
        }
    }

    #[test]
    fn mass_matrix_and_nonlinear_effects_make_inverse_dynamics((moving, arm, force) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, force).unwrap();
        let mass = arm.mass_matrix(&pose).unwrap();
        let inertia = mass * Vector2::from(moving.alpha);
        let effects = arm.nonlinear_effects(&pose, &velocities, force).unwrap();
        assert_torque("τ", [inertia[0] + effects[0], inertia[1] + effects[1]], torque, 1e-9);
        prop_assert!(mass.m11 > 0.0 && mass.m11 * mass.m22 > mass.m12 * mass.m12);
    }

    #[test]
    fn forward_dynamics_undoes_inverse_dynamics((moving, arm, force) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, force).unwrap();
        let alpha = arm.forward_dynamics(&pose, &velocities, torque, force).unwrap();
        // The terms that cancel are as large as the torque and the nonlinear effects.
        let mass = arm.mass_matrix(&pose).unwrap();
        let determinant = mass.m11 * mass.m22 - mass.m12 * mass.m12;
        let amplification = (mass.m11 + mass.m22) / determinant
            * torque.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let bound = 1e-9 * moving.alpha.iter().fold(1.0_f64, |m, a| m.max(a.abs()))
            + 1e-13 * amplification;
        for (a, b) in alpha.into_iter().zip(moving.alpha) {
            prop_assert!((a - b).abs() <= bound, "{} for {}", a, b);
        }
    }

    #[test]
    fn kinetic_energy_is_half_q_m_q((moving, arm, _) in loaded()) {
        let (pose, velocities, _) = moving.now();
        let omega = Vector2::from(moving.omega);
        let energy = 0.5 * omega.dot(&(arm.mass_matrix(&pose).unwrap() * omega));
        assert_close("T", arm.kinetic_energy(&pose, &velocities), energy, 1e-10);
    }

    #[test]
    fn energy_grows_by_the_power_put_in((moving, arm, force) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let [torque1, torque4] =
            arm.inverse_dynamics(&pose, &velocities, &accelerations, force).unwrap();
        let power =
            torque1 * moving.omega[0] + torque4 * moving.omega[1] + force.dot(&velocities.c);
        let energy = |t| {
            let (pose, velocities) = moving.rates_at(t);
            arm.kinetic_energy(&pose, &velocities) + arm.potential_energy(&pose)
        };
        // The error of a difference grows with the energy and with the speed of the motion.
        let speed = velocities.omega.iter().fold(1.0_f64, |m, w| m.max(w.abs()));
        let size = power.abs() + arm.kinetic_energy(&pose, &velocities) * speed;
        let gained = moving.rate(energy);
        prop_assert!((gained - power).abs() <= 1e-7 * size.max(1.0), "{} for {}", gained, power);
    }

    #[test]
    fn joint_forces_ask_for_the_same_torques((moving, arm, force) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, force).unwrap();
        let reactions = arm.reactions(&pose, &velocities, &accelerations, force).unwrap();
        assert_torque("τ", reactions.torque, torque, 1e-9);
    }

    #[test]
    fn at_rest_a_driven_link_hands_its_load_on_with_its_own_weight((moving, arm, force) in loaded()) {
        let still = Moving { omega: [0.0; 2], alpha: [0.0; 2], ..moving };
        let (pose, velocities, accelerations) = still.now();
        let reactions = arm.reactions(&pose, &velocities, &accelerations, force).unwrap();
        let [weight1, _, _, weight4] = arm.links().map(|link| -arm.gravity() * link.mass);
        let size = reactions.b.norm() + reactions.d.norm() + 1.0;
        prop_assert!((reactions.a - reactions.b - weight1).norm() < 1e-12 * size);
        prop_assert!((reactions.e - reactions.d - weight4).norm() < 1e-12 * size);
    }

    #[test]
    fn gravity_torque_is_inverse_dynamics_at_rest_and_the_slope_of_the_potential(
        (moving, arm, _) in loaded()
    ) {
        let still = Moving { omega: [0.0; 2], alpha: [0.0; 2], ..moving };
        let (pose, velocities, accelerations) = still.now();
        let torque = arm.gravity_torque(&pose).unwrap();
        let at_rest = arm
            .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
            .unwrap();
        assert_torque("at rest", torque, at_rest, 1e-10);
        for joint in 0..2 {
            let mut omega = [0.0; 2];
            omega[joint] = 1.0;
            let turning = Moving { omega, ..still };
            let slope = turning.rate(|t| arm.potential_energy(&turning.pose_at(t)));
            assert_close("∂V/∂θ", torque[joint], slope, 1e-6);
        }
    }

    #[test]
    fn shares_add_up_to_the_torque((moving, arm, force) in loaded()) {
        let (pose, velocities, accelerations) = moving.now();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, force).unwrap();
        let friction = [0.02, -0.03];
        let shares = arm
            .torque_components(&pose, &velocities, &accelerations, force, friction)
            .unwrap();
        let whole = [torque[0] + friction[0], torque[1] + friction[1]];
        assert_torque("sum of shares", shares.total(), whole, 1e-9);
    }
}

/// An ordinary arm.
fn arm() -> Arm<f64> {
    let geometry = Geometry::new([0.1, 0.16, 0.16, 0.1, 0.08]).unwrap();
    let link = Link {
        mass: 0.1,
        com: Vector2::new(0.05, 0.002),
        inertia: 1e-4,
    };
    Arm::new(
        geometry,
        [link; 4],
        0.05,
        Vector2::new(0.0, -9.81),
        [1e-5; 2],
    )
    .unwrap()
}

#[test]
fn shares_of_a_motion_are_time_weighted_portions() {
    let shares = |inertia: f64, gravity: f64| TorqueComponents {
        inertia: [inertia, 3.0],
        velocity: [0.0; 2],
        gravity: [gravity, -1.0],
        external: [0.0; 2],
        friction: [0.0; 2],
    };
    let mut totals = ShareTotals::default();
    totals.add(&shares(2.0, -1.0), 0.5);
    totals.add(&shares(-4.0, 1.0), 0.25);
    let fractions = totals.fractions();
    // ∫|inertia| = 1 + 1, ∫|gravity| = 0.5 + 0.25.
    assert_close("inertia", fractions[0][0], 2.0 / 2.75, 1e-15);
    assert_close("gravity", fractions[2][0], 0.75 / 2.75, 1e-15);
    assert_eq!(fractions.map(|part| part[1]), [0.75, 0.0, 0.25, 0.0, 0.0]);
    assert_eq!(totals.peaks()[0], [4.0, 3.0]);
    assert_eq!(ShareTotals::<f64>::default().fractions(), [[0.0; 2]; 5]);
}

#[test]
fn a_uniform_rod_has_its_mass_spread_over_its_length() {
    let rod = Link::uniform_rod(0.06, 0.16);
    assert_eq!((rod.mass, rod.com), (0.06, Vector2::new(0.08, 0.0)));
    // m l²/12.
    assert_close("inertia", rod.inertia, 1.28e-4, 1e-14);
}

#[test]
fn dynamics_are_refused_where_b_c_d_are_in_line() {
    let arm = arm();
    let geometry = *arm.geometry();
    // The elbows of this arm cannot be 2·0.16 m apart, because cos θ1 = (0.04 − 0.16)/0.1 has no
    // solution. They meet, B = D, at cos θ1 = 0.04/0.1; this is just beside it.
    let theta1 = 0.4_f64.acos() + 1e-9;
    let pose = geometry
        .forward(theta1, std::f64::consts::PI - theta1, Side::Left)
        .unwrap();
    let singular = PoseError::Singular(Singularity::Parallel);
    assert_eq!(arm.mass_matrix(&pose), Err(singular));
    assert_eq!(arm.gravity_torque(&pose), Err(singular));
    assert_eq!(geometry.forward_velocities(&pose, 1.0, 1.0), Err(singular));
}

#[test]
fn unsound_masses_are_refused_by_name() {
    let good = arm();
    let geometry = *good.geometry();
    let gravity = Vector2::new(0.0, -9.81);
    let links = *good.links();
    let with = |index: usize, change: fn(&mut Link<f64>)| {
        let mut changed = links;
        change(&mut changed[index]);
        Arm::new(geometry, changed, 0.0, gravity, [0.0; 2]).unwrap_err()
    };
    assert_eq!(with(1, |link| link.mass = -0.1), ModelError::Link(2));
    assert_eq!(with(2, |link| link.inertia = f64::NAN), ModelError::Link(3));
    assert_eq!(
        with(3, |link| link.com.x = f64::INFINITY),
        ModelError::Link(4)
    );
    let massless = |link: &mut Link<f64>| (link.mass, link.inertia) = (0.0, 0.0);
    assert_eq!(with(0, massless), ModelError::NoInertia(1));
    assert_eq!(with(3, massless), ModelError::NoInertia(4));
    let refuse = |payload, gravity, rotors| Arm::new(geometry, links, payload, gravity, rotors);
    assert_eq!(refuse(-1.0, gravity, [0.0; 2]), Err(ModelError::Payload));
    let nowhere = Vector2::new(f64::NAN, 0.0);
    assert_eq!(refuse(0.0, nowhere, [0.0; 2]), Err(ModelError::Gravity));
    assert_eq!(
        refuse(0.0, gravity, [0.0, -1.0]),
        Err(ModelError::RotorInertia)
    );
}

/// Towards type 2 an answer is right within what `forward_dynamics` promises, or refused; far from it there is one.
#[test]
fn forward_dynamics_near_type_2_is_right_or_refused() {
    let link = |mass, length: f64| Link {
        mass,
        com: Vector2::new(0.5 * length, 0.0),
        inertia: mass * length * length / 12.0,
    };
    let geometry = Geometry::new([0.10, 0.11, 0.11, 0.10, 0.06]).unwrap();
    let links = [
        link(0.05, 0.10),
        link(0.04, 0.11),
        link(0.04, 0.11),
        link(0.05, 0.10),
    ];
    let arm = Arm::new(geometry, links, 0.03, Vector2::new(0.0, -9.81), [2e-4; 2]).unwrap();
    let force = Vector2::new(0.3, -0.5);
    let posed = |theta4| geometry.forward(2.5, theta4, Side::Left);
    let (mut answered, mut refused) = (0, 0);
    for level in 0..=70 {
        let sine = 10.0_f64.powf(-0.1 * f64::from(level)) * 0.5;
        // Links 2 and 3 stretch as θ4 falls.
        let (mut open, mut apart) = (1.4, -0.6);
        for _ in 0..200 {
            let middle = 0.5 * (open + apart);
            let stretched = posed(middle).map_or(0.0, |pose| pose.sin32().abs());
            *(if stretched > sine {
                &mut open
            } else {
                &mut apart
            }) = middle;
        }
        let Ok(pose) = posed(open) else { continue };
        let sine = pose.sin32().abs();
        for (omega, alpha) in [
            ([0.0; 2], [10.0, -3.0]),
            ([0.0; 2], [0.0; 2]),
            ([2.0, -1.0], [0.2, 40.0]),
            ([-5.0, 4.0], [-8.0, 7.0]),
        ] {
            // The nearest poses have no velocities either.
            let Ok(velocities) = geometry.forward_velocities(&pose, omega[0], omega[1]) else {
                continue;
            };
            let Ok(accelerations) =
                geometry.forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            else {
                continue;
            };
            let Ok(torque) = arm.inverse_dynamics(&pose, &velocities, &accelerations, force) else {
                continue;
            };
            match arm.forward_dynamics(&pose, &velocities, torque, force) {
                Ok(found) => {
                    answered += 1;
                    let error = (found[0] - alpha[0]).abs() + (found[1] - alpha[1]).abs();
                    let size = found[0].abs() + found[1].abs();
                    assert!(
                        error <= 0.01 * size.max(1.0),
                        "|s| = {sine:.1e}, {omega:?}: {found:?} for {alpha:?}"
                    );
                }
                Err(error) => {
                    refused += 1;
                    assert_eq!(error, PoseError::Singular(Singularity::Parallel));
                    assert!(sine < 1e-2, "refused at |s| = {sine:.1e}, {omega:?}");
                }
            }
        }
    }
    assert!(
        answered > 100 && refused > 40,
        "{answered} answered, {refused} refused"
    );
}
