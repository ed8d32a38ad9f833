//! Proposed excitations.

use crate::logs::{MODE, setup};
use fivebar_design::identification::{
    Bounds, Regressor, base_parameters, propose_excitation, standard_parameters,
};
use fivebar_kinematics::five_bar::Side;

#[test]
fn proposed_excitations_keep_within_every_limit() {
    for (upright, worst) in [(false, 10.0), (true, 50.0)] {
        let setup = setup(upright, 0);
        let bounds = Bounds {
            geometry: *setup.arm.geometry(),
            assembly: Side::Left,
            mode: MODE,
            gravity: setup.arm.gravity(),
            base: base_parameters(
                setup.arm.geometry().lengths(),
                &standard_parameters(&setup.arm),
            ),
            friction: [[1.5e-3, 9e-3]; 2],
            angle: [[0.65, 3.55], [-0.41, 2.49]],
            velocity: [20.0; 2],
            acceleration: [900.0; 2],
            torque: [0.5; 2],
            torque_rms: [0.2; 2],
            margin: 0.3,
            middle: [2.2, 0.9],
        };
        for seed in [1, 2] {
            let found = propose_excitation(&bounds, seed).unwrap();
            println!("{upright} {seed}: {}", found.condition);
            assert!(
                found.condition <= worst,
                "{upright} {seed}: {}",
                found.condition
            );
            let mut squares = [0.0; 2];
            for step in 0..1000 {
                let time = 1.25e-3 * f64::from(step);
                let [q, omega, alpha] = found.excitation.at(time);
                // The derivatives are those of the angles.
                let h = 1e-5;
                let [before, ..] = found.excitation.at(time - h);
                let [behind, ..] = found.excitation.at(time + h);
                let motion = [q, omega, alpha];
                let at =
                    Regressor::at(&bounds.geometry, Side::Left, bounds.gravity, motion).unwrap();
                let used = if upright { 11 } else { 7 };
                let torque = at.torque(&bounds.base[..used]);
                for joint in 0..2 {
                    assert!(
                        ((behind[joint] - before[joint]) / (2.0 * h) - omega[joint]).abs() < 1e-5
                    );
                    let [least, greatest] = bounds.angle[joint];
                    assert!(least - 2e-3 < q[joint] && q[joint] < greatest + 2e-3);
                    assert!(omega[joint].abs() < 20.2 && alpha[joint].abs() < 905.0);
                    let friction = 1.5e-3 * omega[joint] + 9e-3 * omega[joint].signum();
                    assert!((torque[joint] + friction).abs() < 0.51);
                    squares[joint] += (torque[joint] + friction).powi(2) / 1000.0;
                }
                let pose = at.pose;
                for sine in [pose.sin21(), pose.sin34(), pose.sin32()] {
                    assert!(sine.abs() > 0.295, "{sine}");
                }
                assert_eq!(pose.working_mode(), MODE);
            }
            assert!(squares.iter().all(|square| square.sqrt() < 0.202));
        }
    }
}
