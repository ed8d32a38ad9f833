//! Changes of arm, path and limits whose effect on a plan is known.

use super::shared::{arm, driven, factors, line, point, torque_limits};
use fivebar_design::time_optimal::{
    FallingTorque, FourierSeries, PathPiece, PlanError, PlanLimits, Run, RunSample, plan,
};
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode};
use nalgebra::Vector2;
use proptest::prelude::*;

const LEVEL: [f64; 2] = [0.0; 2];

fn all_limits() -> PlanLimits {
    PlanLimits {
        speed: [30.0; 2],
        acceleration: [1200.0; 2],
        ..torque_limits(0.6)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn without_friction_and_gravity_twice_the_speed_needs_four_times_the_torque(
        (lengths, masses, from, to) in (factors::<5>(), factors::<4>(), point(), point())
    ) {
        prop_assume!((to - from).norm() > 5e-3);
        let driven = driven(&arm(lengths, masses, LEVEL), [0.0; 2]);
        let time = |torque| plan(&driven, &torque_limits(torque), &line(from, to), None);
        let (slow, fast) = (time(0.3).unwrap().time, time(1.2).unwrap().time);
        prop_assert!((slow / fast - 2.0).abs() < 1e-9, "{slow} s and {fast} s");
    }

    #[test]
    fn without_friction_and_gravity_the_way_back_takes_as_long(
        (lengths, masses, from, to) in (factors::<5>(), factors::<4>(), point(), point())
    ) {
        prop_assume!((to - from).norm() > 5e-3);
        let driven = driven(&arm(lengths, masses, LEVEL), [0.0; 2]);
        let time = |from, to| plan(&driven, &all_limits(), &line(from, to), None).unwrap().time;
        let (there, back) = (time(from, to), time(to, from));
        prop_assert!((there / back - 1.0).abs() < 1e-3, "{there} s and {back} s");
    }

    #[test]
    fn a_looser_limit_is_never_slower_and_every_limit_holds(
        (lengths, masses, from, to, more) in
            (factors::<5>(), factors::<4>(), point(), point(), 1.0..2.0_f64)
    ) {
        prop_assume!((to - from).norm() > 5e-3);
        let arm = arm(lengths, masses, [1.0, -9.81]);
        let driven = driven(&arm, [2e-3, 1e-2]);
        let tight = PlanLimits { torque: [1.0; 2], ..all_limits() };
        let run = |limits: &PlanLimits| plan(&driven, limits, &line(from, to), None).unwrap();
        let own = run(&tight);
        prop_assert!(own.limit_excess < 5e-3 && own.active_time > 0.98 * own.time);
        for looser in [
            PlanLimits { torque: tight.torque.map(|t| more * t), ..tight },
            PlanLimits { speed: tight.speed.map(|w| more * w), ..tight },
            PlanLimits { acceleration: tight.acceleration.map(|a| more * a), ..tight },
        ] {
            prop_assert!(run(&looser).time <= own.time * (1.0 + 2e-4));
        }
        for other in [
            PlanLimits { voltage: Some(8.0), ..tight },
            PlanLimits { falling_torque: Some([FallingTorque { standing: 1.0, slope: 0.02 }; 2]), ..tight },
            PlanLimits { tip_speed: Some(0.8), ..tight },
            PlanLimits { tip_acceleration: Some(30.0), ..tight },
        ] {
            let limited = run(&other);
            prop_assert!(limited.time >= own.time * (1.0 - 2e-4));
            prop_assert!(limited.limit_excess < 5e-3, "{}", limited.limit_excess);
        }
    }

    #[test]
    fn a_path_in_two_pieces_is_the_same_path(
        (from, to, share) in (point(), point(), 0.2..0.8_f64)
    ) {
        prop_assume!((to - from).norm() > 5e-3);
        let driven = driven(&arm([1.0; 5], [1.0; 4], LEVEL), [2e-3, 1e-2]);
        let between = from + (to - from) * share;
        let two = [line(from, between), line(between, to)].concat();
        let time = |pieces: &[PathPiece]| plan(&driven, &all_limits(), pieces, None).unwrap().time;
        let (one, two) = (time(&line(from, to)), time(&two));
        prop_assert!((one / two - 1.0).abs() < 2e-4, "{one} s and {two} s");
    }
}

/// Each sample's torque by Kane's equations at q̇, q̈ of the run.
#[test]
fn the_torque_of_a_run_is_that_of_its_motion() {
    let arm = arm([1.0; 5], [1.0, 0.8, 1.1, 0.9], [0.0, -9.81]);
    let (viscous, coulomb) = (2e-3, 1e-2);
    let (from, to) = (Vector2::new(-0.03, 0.13), Vector2::new(0.1, 0.18));
    let run = plan(
        &driven(&arm, [viscous, coulomb]),
        &all_limits(),
        &line(from, to),
        None,
    )
    .unwrap();
    let geometry = arm.geometry();
    let (u, mode) = (
        (to - from).normalize(),
        WorkingMode::new(Side::Right, Side::Left),
    );
    for sample in &run.samples {
        let pose = geometry.inverse(from + u * sample.s, mode).unwrap();
        let velocities = geometry
            .inverse_velocities(&pose, u * sample.s_dot)
            .unwrap();
        let along = u * sample.s_ddot;
        let accelerations = geometry
            .inverse_accelerations(&pose, &velocities, along)
            .unwrap();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
        let (torque, [w1, _, _, w4]) = (torque.unwrap(), velocities.omega);
        let sign = geometry.inverse_velocities(&pose, u).unwrap().omega;
        for (j, (w, sign)) in [(w1, sign[0]), (w4, sign[3])].into_iter().enumerate() {
            let expected = torque[j] + viscous * w + coulomb * sign.signum();
            assert!(
                (sample.torque[j] - expected).abs() < 1e-9,
                "{} at {}",
                sample.torque[j],
                sample.s
            );
        }
    }
}

#[test]
fn the_run_stops_at_an_angle_and_not_at_a_tangent() {
    let driven = driven(&arm([1.0; 5], [1.0; 4], LEVEL), [0.0; 2]);
    let [a, b, c] = [[0.0, 0.15], [0.04, 0.15], [0.04, 0.19]].map(Vector2::from);
    let corner = [line(a, b), line(b, c)].concat();
    let run = plan(&driven, &all_limits(), &corner, None).unwrap();
    let alone = |from, to| {
        plan(&driven, &all_limits(), &line(from, to), None)
            .unwrap()
            .time
    };
    assert!((run.time / (alone(a, b) + alone(b, c)) - 1.0).abs() < 1e-3);
    let slowest = |run: &Run| {
        let inside = &run.samples[20..run.samples.len() - 20];
        inside
            .iter()
            .map(|sample| sample.s_dot)
            .fold(f64::INFINITY, f64::min)
    };
    assert_eq!(slowest(&run), 0.0);
    let straight = [line(a, b), line(b, b + (b - a))].concat();
    assert!(slowest(&plan(&driven, &all_limits(), &straight, None).unwrap()) > 0.3);
}

#[test]
fn what_cannot_be_planned_is_refused_with_its_place() {
    let own = arm([1.0; 5], [1.0; 4], [0.0, -9.81]);
    let driven = driven(&own, [0.0; 2]);
    let refusal = |limits: &PlanLimits, pieces: &[PathPiece], jerk: Option<f64>| {
        plan(&driven, limits, pieces, jerk).unwrap_err()
    };
    let [a, b, far] = [[0.0, 0.15], [0.04, 0.15], [0.04, 0.45]].map(Vector2::from);
    let limits = all_limits();
    assert_eq!(refusal(&limits, &[], None), PlanError::Empty);
    assert_eq!(refusal(&limits, &line(a, a), None), PlanError::Piece(0));
    let apart = [line(a, b), line(a, b)].concat();
    assert_eq!(refusal(&limits, &apart, None), PlanError::Gap(1));
    assert!(matches!(refusal(&limits, &line(b, far), None), PlanError::Pose(s, _) if s > 0.05));
    assert!(matches!(
        refusal(&torque_limits(1e-3), &line(a, b), None),
        PlanError::CannotStand(_)
    ));
    assert_eq!(
        refusal(&torque_limits(0.0), &line(a, b), None),
        PlanError::Limit
    );
    assert_eq!(refusal(&limits, &line(a, b), Some(-1.0)), PlanError::Limit);
    assert_eq!(refusal(&limits, &line(a, b), Some(1e-3)), PlanError::Jerk);
    // To and fro on a line by a cosine: C′ is 0 at both ends.
    let series = |mean, amplitude| FourierSeries {
        mean,
        harmonics: vec![[amplitude, 0.0]],
    };
    let to_and_fro = [PathPiece::Fourier {
        x: series(0.04, 0.03),
        y: series(0.16, 0.0),
    }];
    assert_eq!(refusal(&limits, &to_and_fro, None), PlanError::Cusp(0.0));
    // Couplers of 0.12 m stretch on the way down.
    let short = arm([1.0, 0.75, 0.75, 1.0, 1.0], [1.0; 4], LEVEL);
    let tool = Tool::new(*short.geometry(), Vector2::zeros()).unwrap();
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let short =
        fivebar_design::time_optimal::DrivenArm::new(&short, tool, mode, Default::default());
    let down = line(Vector2::new(0.06, 0.115), Vector2::new(0.03, 0.012));
    let error = plan(&short.unwrap(), &limits, &down, None).unwrap_err();
    assert!(
        matches!(error, PlanError::Crosses(s) if (s - 0.0575).abs() < 2e-3),
        "{error}"
    );
}

/// The mean jerk between two samples, from q̈ = q′ s̈ + q″ ṡ² at each.
#[test]
fn the_jerk_of_a_run_is_within_its_limit_and_reaches_it() {
    let driven = driven(&arm([1.0; 5], [1.0; 4], [0.0, -9.81]), [2e-3, 1e-2]);
    let path = line(Vector2::new(-0.03, 0.13), Vector2::new(0.1, 0.18));
    let unlimited = plan(&driven, &all_limits(), &path, None).unwrap().time;
    let mut last = unlimited;
    for jerk in [3e5, 1e5, 3e4, 5e2] {
        let run = plan(&driven, &all_limits(), &path, Some(jerk)).unwrap();
        assert!(run.time > last, "{} s after {last} s", run.time);
        last = run.time;
        assert!(run.limit_excess < 1e-9);
        let acceleration = |at: &RunSample, j: usize| {
            at.demand.q1[j] * at.s_ddot + at.demand.q2[j] * at.s_dot * at.s_dot
        };
        let mut greatest = 0.0_f64;
        for pair in run.samples.windows(2) {
            for j in 0..2 {
                let change = acceleration(&pair[1], j) - acceleration(&pair[0], j);
                greatest = greatest.max((change / (pair[1].t - pair[0].t)).abs());
            }
        }
        assert!(
            (0.8..1.03).contains(&(greatest / jerk)),
            "{greatest} of {jerk} rad/s³"
        );
    }
}

/// At 7e5 rad/s³ a jump of s̈ makes the jerk pass its limit for less than a thousandth of the time: windows
/// that overlook it cost a quarter of the time.
#[test]
fn a_looser_limit_of_jerk_is_never_slower() {
    let driven = driven(&arm([1.0; 5], [1.0; 4], LEVEL), [2e-3, 1e-2]);
    for (radius, turns) in [(0.04, 1.0), (0.015, 1.0), (0.03, 6.0)] {
        let path = [PathPiece::Arc {
            centre: Vector2::new(0.04, 0.16),
            radius,
            start: 0.0,
            sweep: std::f64::consts::TAU * turns,
        }];
        let time = |jerk| plan(&driven, &all_limits(), &path, jerk).unwrap().time;
        let (least, mut last) = (time(None), f64::INFINITY);
        for tenth in 50..=70 {
            let jerk = 10_f64.powf(0.1 * f64::from(tenth));
            let own = time(Some(jerk));
            assert!(own <= 1.003 * last, "{own} s after {last} s at {jerk}");
            assert!(
                own >= least * (1.0 - 1e-3),
                "{own} s, and {least} s without"
            );
            last = own;
        }
        assert!(last < 1.015 * least, "{last} s and {least} s");
    }
}
