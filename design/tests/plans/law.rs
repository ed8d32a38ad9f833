//! The law of a run in time: its motion at any time, between the even points too.

use crate::shared::{arm, driven, torque_limits};
use fivebar_design::time_optimal::{PathPiece, PlanLimits, Run, Waypoints, plan};
use nalgebra::Vector2;

fn path() -> [PathPiece; 1] {
    let points = [[0.0, 0.15], [0.02, 0.18], [0.06, 0.17], [0.08, 0.14]];
    [PathPiece::Waypoints(
        Waypoints::new(&points.map(Vector2::from)).unwrap(),
    )]
}

fn runs() -> Vec<(Run, PlanLimits)> {
    let driven = driven(&arm([1.0; 5], [1.0; 4], [0.0, -9.81]), [1e-3, 0.01]);
    let of_torque = torque_limits(0.5);
    let of_motion = PlanLimits {
        torque: [f64::INFINITY; 2],
        speed: [6.0; 2],
        acceleration: [150.0; 2],
        ..of_torque
    };
    let cases = [(of_torque, None), (of_torque, Some(2e4)), (of_motion, None)];
    let run = |(limits, jerk)| (plan(&driven, &limits, &path(), jerk).unwrap(), limits);
    cases.map(run).into()
}

#[test]
fn it_passes_the_even_points_at_their_times_and_is_its_own_derivative() {
    for (run, _) in runs() {
        for sample in &run.samples {
            let [s, s_dot, _] = run.at(sample.t);
            let fastest = run.length / run.time;
            assert!((s - sample.s).abs() < 1e-4 * run.length, "{s} {sample:?}");
            assert!(
                (s_dot - sample.s_dot).abs() < 2e-2 * fastest,
                "{s_dot} {sample:?}"
            );
        }
        let step = 1e-7 * run.time;
        let mut differing = 0;
        for i in 1..1000 {
            let t = run.time * f64::from(i) / 1000.3;
            let [low, high] = [-step, step].map(|by| run.at(t + by));
            let [_, s_dot, s_ddot] = run.at(t);
            let slope = (high[0] - low[0]) / (2.0 * step);
            assert!(
                (slope - s_dot).abs() < 1e-4 * run.length / run.time,
                "{slope} {s_dot}"
            );
            let slope = (high[1] - low[1]) / (2.0 * step);
            // It jumps with the acceleration.
            differing += u32::from((slope - s_ddot).abs() > 1e-3 * s_ddot.abs().max(1.0));
        }
        assert!(differing < 20, "{differing}");
        assert_eq!(run.at(-1.0), [0.0; 3]);
        assert_eq!(run.at(run.time + 1.0), [run.length, 0.0, 0.0]);
    }
}

#[test]
fn it_keeps_the_limits_at_any_time() {
    let driven = driven(&arm([1.0; 5], [1.0; 4], [0.0, -9.81]), [1e-3, 0.01]);
    let path = path();
    for (run, limits) in runs() {
        let mut most = 0.0_f64;
        for i in 0..=5000 {
            let [s, s_dot, s_ddot] = run.at(run.time * f64::from(i) / 5000.0);
            let demand = driven.demand(&path[0].at(s)).unwrap();
            let x = s_dot * s_dot;
            let torque = demand.torque(x, s_ddot);
            let omega = demand.q1.map(|rate| rate * s_dot);
            let alpha = [0, 1].map(|j| demand.q1[j] * s_ddot + demand.q2[j] * x);
            for (used, limits) in [
                (torque, limits.torque),
                (omega, limits.speed),
                (alpha, limits.acceleration),
            ] {
                for (used, limit) in used.into_iter().zip(limits) {
                    most = most.max(used.abs() / limit);
                }
            }
        }
        println!("{most} with an excess of {}", run.limit_excess);
        // With a limit of jerk the others are not all reached.
        let most_allowed = 1.001 + run.limit_excess;
        assert!((0.8..most_allowed).contains(&most), "{most}");
    }
}
