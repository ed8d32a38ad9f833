//! The gains of joints behind belts: their margins against a joint that is integrated in time, with whole counts.

use fivebar_design::servo::{BeltJoint, BeltTuning, MOST_LATE, tune_belt};
use fivebar_kinematics::control::{Belt, BeltLaw, BeltState};

const PERIOD: f64 = 1e-4;
/// 131 072 counts a turn.
const COUNT: f64 = std::f64::consts::TAU / 131_072.0;

/// A joint of an arm of the benchtop's size.
fn joint(stiffness: f64) -> BeltJoint {
    let rotor_inertia = 6.4e-5_f64;
    BeltJoint {
        belt: Belt {
            stiffness,
            damping: 0.02 * (stiffness * rotor_inertia).sqrt(),
            rotor_inertia,
            encoder_at_joint: false,
        },
        inertia: [5e-4, 3e-3],
        range: [0.7, 1.5],
        current_bandwidth: 3500.0,
        latency: 0.0,
        count: COUNT,
        peak_torque: 0.75,
        period: PERIOD,
    }
}

/// The joint's angles [rad] at the ticks after a load [N·m] begins, when the loop's torque is multiplied by `factor`:
/// its equations integrated in small steps, its angle counted.
fn angles(
    joint: &BeltJoint,
    tuning: &BeltTuning,
    [inertia, factor]: [f64; 2],
    load: f64,
) -> Vec<f64> {
    let Belt {
        stiffness: k,
        damping: d,
        rotor_inertia: jr,
        encoder_at_joint,
    } = joint.belt;
    let lag = 1.0 / joint.current_bandwidth;
    let law = BeltLaw::new(&joint.belt, &tuning.gains, lag, lag + joint.latency, PERIOD);
    let (late, g) = (joint.late(), joint.current_bandwidth * PERIOD);
    let mut state = BeltState::default();
    // θm, ωm, θ, ω.
    let mut x = [0.0_f64; 4];
    let (mut torque, mut torque_before) = (0.0, 0.0);
    let mut demands = vec![0.0; late + 1];
    let mut shown = vec![0.0; late + 1];
    let declared = inertia;
    (0..8000)
        .map(|tick| {
            shown.rotate_right(1);
            shown[0] = x[if encoder_at_joint { 2 } else { 0 }];
            let counted = (shown[late] / COUNT).round() * COUNT;
            let impulse = law.correct(&mut state, counted, 0.0);
            state.velocity += impulse / declared;
            let demand = law.demand(&state);
            let demanded = (declared + jr) * demand.alpha + demand.torque;
            let change = law.impulse(&state) / declared;
            law.advance(&mut state, change, demands[late]);
            // The demand of the tick before acts in the current loop.
            let next = torque - g * torque_before + g * factor * demands[0];
            demands.rotate_right(1);
            demands[0] = demanded;
            let push = if tick < 1000 { 0.0 } else { load };
            let steps = 50;
            for step in 0..steps {
                let share = (f64::from(step) + 0.5) / f64::from(steps);
                let drive = torque + share * (next - torque);
                let spring = k * (x[0] - x[2]) + d * (x[1] - x[3]);
                let h = PERIOD / f64::from(steps);
                x[1] += h * (drive - spring) / jr;
                x[3] += h * (spring + push) / inertia;
                x[0] += h * x[1];
                x[2] += h * x[3];
            }
            (torque_before, torque) = (torque, next);
            x[2]
        })
        .collect()
}

/// The angle that is still there after 0.5 s, and the greatest one; infinite where a number overflows.
fn settled(angles: &[f64]) -> [f64; 2] {
    let finite = angles.iter().all(|angle| angle.is_finite());
    let greatest = |part: &[f64]| match part.iter().map(|angle| angle.abs()) {
        sizes if finite => sizes.fold(0.0, f64::max),
        _ => f64::INFINITY,
    };
    [greatest(&angles[6000..]), greatest(angles)]
}

#[test]
fn a_belt_of_any_stiffness_gets_gains_that_keep_their_margins_in_time() {
    keep_their_margins_in_time(&[300.0, 2500.0]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_belts_whose_gains_keep_their_margins_in_time() {
    keep_their_margins_in_time(&[300.0, 700.0, 1250.0, 2500.0, 5000.0]);
}

fn keep_their_margins_in_time(belts: &[f64]) {
    for &stiffness in belts {
        let joint = joint(stiffness);
        let tuning = tune_belt(&joint).expect("gains");
        assert!(tuning.is_good(&joint), "{stiffness}: {tuning:?}");
        for inertia in joint.inertia {
            // A margin of m allows the factors 1/(1 + m) to 1/(1 − m).
            for factor in [0.68, 1.0, 2.0] {
                let [rest, peak] = settled(&angles(&joint, &tuning, [inertia, factor], 5e-3));
                assert!(
                    rest < 2e-3 * 5e-3 + 4.0 * COUNT,
                    "{stiffness} {inertia} {factor}: {rest} rad"
                );
                assert!(
                    peak < 6e-3 && peak > 1e-6,
                    "{stiffness} {inertia} {factor}: {peak} rad"
                );
            }
        }
        // The test can fail: far beyond the margin the joint swings.
        let [rest, _] = settled(&angles(&joint, &tuning, [joint.inertia[0], 8.0], 5e-3));
        assert!(rest > 20.0 * COUNT, "{stiffness}: {rest} rad");
    }
}

#[test]
fn a_late_encoder_gets_gains_unless_it_is_too_late() {
    let of = |latency: f64| BeltJoint {
        latency,
        ..joint(1250.0)
    };
    let late = of(2e-4);
    let tuning = tune_belt(&late).expect("gains");
    assert!(tuning.is_good(&late), "{tuning:?}");
    let [rest, _] = settled(&angles(&late, &tuning, [late.inertia[0], 1.0], 5e-3));
    assert!(rest < 1e-5 + 4.0 * COUNT, "{rest} rad");
    assert_eq!(tune_belt(&of((MOST_LATE as f64 + 1.0) * PERIOD)), None);
}
