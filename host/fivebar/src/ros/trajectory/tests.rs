//! What a trajectory is between its points, and what it refuses.

use super::super::messages::{Header, JointTrajectory, TrajectoryPoint};
use super::{Place, Trajectory, Unfollowed};
use fivebar_files::robot::Limits;
use proptest::prelude::*;

const REST: Place = Place {
    position: [0.5, 1.0],
    velocity: [0.0; 2],
};

fn message(points: Vec<TrajectoryPoint>) -> JointTrajectory {
    JointTrajectory {
        header: Header::now(""),
        joint_names: ["A", "E"].map(String::from).into(),
        points,
    }
}

fn positions(after: f64, position: [f64; 2]) -> TrajectoryPoint {
    TrajectoryPoint {
        velocities: Vec::new(),
        ..TrajectoryPoint::of(position, [0.0; 2], after)
    }
}

fn limits() -> Limits {
    Limits {
        max_speed: [20.0; 2],
        max_acceleration: [500.0; 2],
        ..Limits::default()
    }
}

fn followed(points: Vec<TrajectoryPoint>) -> Result<Trajectory, Unfollowed> {
    Trajectory::new(&message(points), REST, &limits())
}

/// A motion of fifth degree in each angle, with its first two derivatives.
fn motion(time: f64) -> [[f64; 2]; 3] {
    let u = time / 2.0;
    let h = |k: f64| k * (10.0 * u.powi(3) - 15.0 * u.powi(4) + 6.0 * u.powi(5));
    let v = |k: f64| k * (30.0 * u.powi(2) - 60.0 * u.powi(3) + 30.0 * u.powi(4)) / 2.0;
    let a = |k: f64| k * (60.0 * u - 180.0 * u.powi(2) + 120.0 * u.powi(3)) / 4.0;
    [
        [0.5 + h(0.4), 1.0 - h(0.3)],
        [v(0.4), -v(0.3)],
        [a(0.4), -a(0.3)],
    ]
}

#[test]
fn points_with_accelerations_give_back_a_motion_of_fifth_degree() {
    let points = [0.7, 1.1, 2.0].map(|time| {
        let [position, velocity, acceleration] = motion(time);
        TrajectoryPoint {
            accelerations: acceleration.into(),
            ..TrajectoryPoint::of(position, velocity, time)
        }
    });
    let trajectory = followed(points.into()).unwrap();
    for step in 0..=130 {
        let time = 0.7 + f64::from(step) * 1e-2;
        let [position, velocity, _] = motion(time);
        let place = trajectory.at(time);
        for k in 0..2 {
            assert!((place.position[k] - position[k]).abs() < 1e-12, "{time} s");
            assert!(
                (place.velocity[k] - velocity[k]).abs() < 1e-11 || time > 1.999,
                "{time} s"
            );
        }
    }
}

#[test]
fn joints_may_come_in_either_order() {
    let mut other = message(vec![positions(1.0, [0.9, 0.7])]);
    other.joint_names.reverse();
    let trajectory = Trajectory::new(&other, REST, &limits()).unwrap();
    assert_eq!(trajectory.at(1.0).position, [0.7, 0.9]);
}

#[test]
fn what_cannot_be_followed_is_refused_by_its_point() {
    let other = JointTrajectory {
        joint_names: ["A", "B"].map(String::from).into(),
        ..message(Vec::new())
    };
    let refused = Trajectory::new(&other, REST, &limits()).unwrap_err();
    assert_eq!(
        refused,
        Unfollowed::Joints(["A", "B"].map(String::from).into())
    );
    let there = || positions(1.0, [0.6, 1.1]);
    let cut = TrajectoryPoint {
        positions: vec![0.1],
        ..there()
    };
    assert_eq!(
        followed(vec![there(), cut]).unwrap_err(),
        Unfollowed::Numbers(2)
    );
    let endless = positions(1.0, [f64::NAN, 0.0]);
    assert_eq!(followed(vec![endless]).unwrap_err(), Unfollowed::Numbers(1));
    assert_eq!(
        followed(vec![there(), there()]).unwrap_err(),
        Unfollowed::Time(2)
    );
    let refused = followed(vec![positions(10.0, [7.0, 1.0])]).unwrap_err();
    assert!(
        matches!(refused, Unfollowed::Angle { joint: "A", .. }),
        "{refused}"
    );
    let refused = followed(vec![positions(0.1, [0.5, 2.2])]).unwrap_err();
    assert!(
        matches!(refused, Unfollowed::Acceleration { joint: "E", .. }),
        "{refused}"
    );
    let refused = followed(vec![TrajectoryPoint::of([0.5, 1.2], [0.0, 25.0], 1.0)]).unwrap_err();
    assert!(
        matches!(refused, Unfollowed::Speed { joint: "E", .. }),
        "{refused}"
    );
}

#[test]
fn a_point_of_now_and_no_points_are_the_arms_rest() {
    for points in [Vec::new(), vec![positions(0.0, [0.1, 0.2])]] {
        let trajectory = followed(points).unwrap();
        assert_eq!((trajectory.time(), trajectory.at(3.0)), (0.0, REST));
    }
}

proptest! {
    /// Positions and velocities have no jumps, and velocities are those of the positions.
    #[test]
    fn it_is_smooth_and_ends_at_rest_at_its_last_point(
        steps in prop::collection::vec((0.2..1.0_f64, -0.1..0.1_f64, -0.1..0.1_f64), 1..8),
        speeds in any::<bool>(),
    ) {
        let (mut time, mut position, mut points) = (0.0, REST.position, Vec::new());
        for (step, way1, way4) in steps {
            time += step;
            position = [position[0] + way1, position[1] + way4];
            points.push(match speeds {
                true => TrajectoryPoint::of(position, [way4, way1], time),
                false => positions(time, position),
            });
        }
        if let (true, Some(last)) = (speeds, points.last_mut()) {
            last.velocities = vec![0.0; 2];
        }
        let trajectory = followed(points).unwrap();
        let h = 1e-5;
        let mut at = h;
        while at < time - h {
            let [before, here, behind] = [at - h, at, at + h].map(|at| trajectory.at(at));
            for k in 0..2 {
                let slope = (behind.position[k] - before.position[k]) / (2.0 * h);
                prop_assert!((slope - here.velocity[k]).abs() < 1e-3, "{at}");
                prop_assert!((behind.velocity[k] - before.velocity[k]).abs() < 1e-2, "{at}");
            }
            at += 7e-3;
        }
        let end = trajectory.at(time);
        for (reached, last) in end.position.into_iter().zip(position) {
            prop_assert!((reached - last).abs() < 1e-12);
        }
        prop_assert_eq!(end.velocity, [0.0; 2]);
    }
}
