//! All example linkages in all assemblies: velocities and accelerations compared with finite
//! differences, forces with the change of energy and momentum; and results from textbooks.

use fivebar_design::linkage::{Coordinate, DriveLaw, Linkage, LinkageMotion};
use fivebar_files::linkage::{DrivenLinkage, EXAMPLES};
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

fn inputs(laws: &[DriveLaw], t: f64) -> Vec<Coordinate<f64>> {
    laws.iter().map(|law| law.at(t)).collect()
}

/// Three lists: all positions, their velocities and their accelerations.
fn coordinates(motion: &LinkageMotion<f64>) -> [Vec<f64>; 3] {
    let mut all = [vec![], vec![], vec![]];
    let mut add = |place: [Vector2<f64>; 3]| {
        for (list, vector) in all.iter_mut().zip(place) {
            list.extend([vector.x, vector.y]);
        }
    };
    for point in &motion.points {
        add([point.position, point.velocity, point.acceleration]);
    }
    for link in &motion.links {
        let (u, n) = (link.axis, link.axis.perpendicular());
        add([
            u,
            n * link.omega,
            n * link.alpha - u * (link.omega * link.omega),
        ]);
    }
    all
}

/// The sum of kinetic and gravitational energy [J], the momentum's x and y [N·s], and the
/// angular momentum about the plane's origin [N·m·s].
fn energy_and_momentum(linkage: &Linkage<f64>, motion: &LinkageMotion<f64>) -> [f64; 4] {
    let mut sum = [0.0; 4];
    let mut add = |mass: f64, place: Vector2<f64>, velocity: Vector2<f64>| {
        let energy = 0.5 * velocity.norm_squared() - linkage.gravity().dot(&place);
        let parts = [energy, velocity.x, velocity.y, place.cross_z(velocity)];
        for (total, part) in sum.iter_mut().zip(parts) {
            *total += mass * part;
        }
    };
    for (link, motion) in linkage.links().iter().zip(&motion.links) {
        let com = motion.local_point(link.inertia.com);
        add(link.inertia.mass, com.position, com.velocity);
    }
    for (point, motion) in linkage.points().iter().zip(&motion.points) {
        add(point.mass, motion.position, motion.velocity);
    }
    for (link, motion) in linkage.links().iter().zip(&motion.links) {
        sum[0] += 0.5 * link.inertia.inertia * motion.omega * motion.omega;
        sum[3] += link.inertia.inertia * motion.omega;
    }
    sum
}

/// The linkage with every length, position, mass and load changed by up to the share `spread`.
fn varied(linkage: &Linkage<f64>, seed: u32, spread: f64) -> Linkage<f64> {
    let mut state = seed;
    linkage.map_parameters(|_, value| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        value * (1.0 + spread * (2.0 * f64::from(state >> 8) / f64::from(1 << 24) - 1.0))
    })
}

/// Runs `check` on every assembly of every example, unchanged and with varied dimensions, at
/// instants far from singularities. Asserts that the unchanged examples are among them.
fn on_every_assembly(check: impl Fn(&str, &Linkage<f64>, &[DriveLaw], f64, &LinkageMotion<f64>)) {
    for example in EXAMPLES {
        let driven = example.linkage().unwrap();
        for variant in 0..8 {
            let spread = if variant == 0 { 0.0 } else { 0.25 };
            let varied = varied(&driven.linkage, variant, spread);
            for (assembly, linkage) in varied.assemblies().enumerate() {
                let mut checked = 0;
                for i in 0..37 {
                    let t = driven.duration * (f64::from(i) + 0.3) / 37.0;
                    let Ok(motion) = linkage.motion(&inputs(&driven.laws, t)) else {
                        continue;
                    };
                    let mut dyads = motion.dyads.iter().flatten();
                    if dyads.all(|dyad| dyad.sine.abs() > 0.2) {
                        check(example.name, &linkage, &driven.laws, t, &motion);
                        checked += 1;
                    }
                }
                let shipped = variant == 0 && assembly == 0;
                assert!(!shipped || checked > 20, "{}: {checked}", example.name);
            }
        }
    }
}

/// Step of the finite differences [s]; short compared with a turn of the fastest example, 0.1 s.
const STEP: f64 = 1e-6;

#[test]
fn velocities_and_accelerations_match_finite_differences() {
    on_every_assembly(|name, linkage, laws, t, motion| {
        let beside = |dt: f64| coordinates(&linkage.motion(&inputs(laws, t + dt)).unwrap());
        let (before, now, after) = (beside(-STEP), coordinates(motion), beside(STEP));
        for order in 0..2 {
            let scale = now[order + 1].iter().fold(1.0_f64, |m, x| m.max(x.abs()));
            for (i, &rate) in now[order + 1].iter().enumerate() {
                let difference = (after[order][i] - before[order][i]) / (2.0 * STEP);
                assert!(
                    (difference - rate).abs() <= 1e-6 * scale,
                    "{name} at {t} s, coordinate {i}, order {order}: {rate} for {difference}"
                );
            }
        }
        assert!(
            now[1].iter().any(|v| v.abs() > 1e-3),
            "{name} does not move"
        );
    });
}

#[test]
fn forces_balance_energy_and_momentum() {
    on_every_assembly(|name, linkage, laws, t, motion| {
        let beside = |dt: f64| {
            let motion = linkage.motion(&inputs(laws, t + dt)).unwrap();
            energy_and_momentum(linkage, &motion)
        };
        let (before, after) = (beside(-STEP), beside(STEP));
        let [energy, px, py, spin] = [0, 1, 2, 3].map(|i| (after[i] - before[i]) / (2.0 * STEP));

        let forces = linkage.forces(motion).unwrap();
        let drives = forces.driving.iter().zip(inputs(laws, t));
        let mut power: f64 = drives.map(|(drive, input)| drive * input.rate).sum();
        // External forces: the frame's reaction −frame, weights and loads.
        let mut force = -forces.frame.force;
        let mut moment = -forces.frame.moment;
        let mut weigh = |mass: f64, place: Vector2<f64>| {
            force += linkage.gravity() * mass;
            moment += place.cross_z(linkage.gravity() * mass);
        };
        for (link, motion) in linkage.links().iter().zip(&motion.links) {
            weigh(
                link.inertia.mass,
                motion.local_point(link.inertia.com).position,
            );
        }
        for (point, motion) in linkage.points().iter().zip(&motion.points) {
            weigh(point.mass, motion.position);
        }
        for (point, motion) in linkage.points().iter().zip(&motion.points) {
            power += point.force.dot(&motion.velocity);
            force += point.force;
            moment += motion.position.cross_z(point.force);
        }
        let reactions = forces.reactions.iter().map(|r| r.wrench.force.norm());
        let largest = reactions.fold(1.0_f64, f64::max);
        let speeds = motion.points.iter().map(|p| p.velocity.norm());
        let fastest = speeds.fold(1.0_f64, f64::max);
        assert!(
            (power - energy).abs() <= 1e-5 * largest * fastest,
            "{name} at {t} s: {power} W for {energy} W"
        );
        for (found, expected) in [(force.x, px), (force.y, py), (moment, spin)] {
            assert!(
                (found - expected).abs() <= 1e-5 * largest,
                "{name} at {t} s: {found} for {expected}"
            );
        }
        assert!(largest > 1.0, "{name} has no reactions");
    });
}

#[test]
fn reactions_at_rest_are_those_of_statics() {
    // For a slider-crank at rest with a force F on the piston, the torque is F·dx/dθ.
    let text = EXAMPLES[1].text.replace("3600.0", "0.0");
    let driven = DrivenLinkage::parse("slider_crank", &text).unwrap();
    let at = |angle: f64, rate: f64| {
        let input = Coordinate {
            value: angle,
            rate,
            acceleration: 0.0,
        };
        driven.linkage.motion(&[input]).unwrap()
    };
    for angle in [0.4, 1.3, 2.9, 4.4] {
        let piston = driven.linkage.points().iter().position(|p| p.name == "C");
        let slope = at(angle, 1.0).points[piston.unwrap()].velocity.x;
        let torque = driven.linkage.forces(&at(angle, 0.0)).unwrap().driving[0];
        assert!((torque - 50.0 * slope).abs() < 1e-11, "{torque}");
    }
}

#[test]
fn the_whitworth_quick_return_has_its_textbook_ratio() {
    // The ram reverses where the slotted arm is level: the crank turns 180° + 2β and 180° − 2β
    // between, with sin β = frame / crank.
    let driven = DrivenLinkage::load("shaper").unwrap();
    let ram = driven.linkage.points().iter().position(|p| p.name == "F");
    let sweep = driven.sweep();
    let forward = sweep
        .solved()
        .skip(1)
        .filter(|(_, solved)| solved.motion.points[ram.unwrap()].velocity.x < 0.0)
        .count();
    let steps = sweep.samples.len() - 1;
    let slow = forward.max(steps - forward) as f64;
    let beta = (0.05_f64 / 0.15).asin();
    let expected = (std::f64::consts::PI + 2.0 * beta) / (std::f64::consts::PI - 2.0 * beta);
    let ratio = slow / (steps as f64 - slow);
    assert!((ratio - expected).abs() < 0.01, "{ratio} for {expected}");
    // The stroke is twice the length of the arm that drives the rod.
    let places = sweep
        .solved()
        .map(|(_, s)| s.motion.points[ram.unwrap()].position.x);
    let [least, greatest] = places.fold([f64::MAX, f64::MIN], |[l, g], x| [l.min(x), g.max(x)]);
    assert!((greatest - least - 0.24).abs() < 1e-4);
}

#[test]
fn the_scotch_yoke_moves_as_a_sine_and_the_tangent_mechanism_as_a_tangent() {
    let point = |name: &str, point: &str, laws: usize| {
        let driven = DrivenLinkage::load(name).unwrap();
        assert_eq!(driven.laws.len(), laws);
        let index = driven.linkage.points().iter().position(|p| p.name == point);
        let sweep = driven.sweep();
        let of = |(sample, solved): (&fivebar_design::linkage::SweepSample, _)| {
            let solved: &fivebar_design::linkage::SolvedSample = solved;
            (
                sample.inputs[0].value,
                solved.motion.points[index.unwrap()].position,
            )
        };
        sweep.solved().map(of).collect::<Vec<_>>()
    };
    for (angle, yoke) in point("scotch_yoke", "Y", 1) {
        assert!((yoke.x - 0.06 * angle.cos()).abs() < 1e-14);
    }
    for (angle, pin) in point("tangent", "P", 1) {
        assert!((pin.y - 0.20 * angle.tan()).abs() < 1e-14);
    }
}

#[test]
fn every_example_completes_its_sweep_on_one_branch() {
    for example in EXAMPLES {
        let driven = example.linkage().unwrap();
        let sweep = driven.sweep();
        assert_eq!(sweep.solved().count(), driven.steps + 1, "{}", example.name);
        assert!(sweep.limits.is_empty() && sweep.branch_changes.is_empty());
        assert!(example.summary().len() > 30 && !driven.name.is_empty());
    }
}
