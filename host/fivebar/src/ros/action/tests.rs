//! A client of the action, over the network of this machine: `./ci.sh ros` runs it alone.

use super::super::messages::{
    FollowFeedback, FollowGoal, FollowResult, Header, INVALID_JOINTS, JointTrajectory,
    MultiTrajectory, SUCCESSFUL, TrajectoryPoint,
};
use super::super::{RosOptions, node, serve};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_sim::controller::ControllerSource;
use fivebar_sim::drive::Homing;
use fivebar_sim::live::{LiveArm, Pace};
use ros2_client::action::{ActionClient, ActionClientQosPolicies, GoalStatusEnum};
use ros2_client::builtin_interfaces::Duration;
use ros2_client::qos::{Durability, History};
use ros2_client::{ActionTypeName, Name, QosProfile, ServiceMapping};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use tokio::task::LocalSet;

/// A domain that nobody else uses.
const DOMAIN: u16 = 86;

type Client = ActionClient<FollowGoal, FollowResult, FollowFeedback>;

fn options(name: &str) -> RosOptions {
    RosOptions {
        name: name.into(),
        domain: DOMAIN,
        rate: 100.0,
    }
}

fn goal(joints: [&str; 2], to: [f64; 2], seconds: f64) -> FollowGoal {
    let no_names = Vec::new;
    FollowGoal {
        trajectory: JointTrajectory {
            header: Header::now(""),
            joint_names: joints.map(String::from).into(),
            points: vec![TrajectoryPoint::of(to, [0.0; 2], seconds)],
        },
        multi_dof_trajectory: MultiTrajectory {
            header: Header::now(""),
            joint_names: no_names(),
            points: Vec::new(),
        },
        path_tolerance: Vec::new(),
        component_path_tolerance: Vec::new(),
        goal_tolerance: Vec::new(),
        component_goal_tolerance: Vec::new(),
        goal_time_tolerance: Duration::from_nanos(0),
    }
}

fn angles(arm: &LiveArm) -> [f64; 2] {
    arm.progress().status.angle.map(f64::from)
}

fn apart(one: [f64; 2], other: [f64; 2]) -> f64 {
    (one[0] - other[0]).abs().max((one[1] - other[1]).abs())
}

/// Sends a goal, and waits for its result.
async fn ended(client: &Client, goal: FollowGoal) -> (GoalStatusEnum, FollowResult) {
    let (id, answer) = client.async_send_goal(goal).await.unwrap();
    assert!(answer.accepted);
    client.async_request_result(id).await.unwrap()
}

async fn client_of(node: &mut ros2_client::Node) -> Client {
    let latest = |durability| {
        QosProfile::publisher_default()
            .durability(durability)
            .history(History::KeepLast { depth: 10 })
    };
    let volatile = latest(Durability::Volatile);
    let client: Client = node
        .create_action_client(
            ServiceMapping::Enhanced,
            &Name::new("/arm", "follow_joint_trajectory").unwrap(),
            &ActionTypeName::new("control_msgs", "FollowJointTrajectory"),
            ActionClientQosPolicies {
                goal_service: volatile.clone(),
                result_service: volatile.clone(),
                cancel_service: volatile.clone(),
                feedback_subscription: volatile,
                status_subscription: latest(Durability::TransientLocal),
            },
        )
        .unwrap();
    tokio::task::spawn_local(node.spinner().unwrap().spin());
    client.goal_client().wait_for_service(node).await;
    client.result_client().wait_for_service(node).await;
    client.cancel_client().wait_for_service(node).await;
    client
}

#[test]
#[ignore = "it speaks over the network of this machine: ./ci.sh ros"]
fn goals_are_reached_refused_replaced_and_cancelled() {
    let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
    let arm = LiveArm::open(&robot, ControllerSource::Simulated, Pace::RealTime).unwrap();
    let arm = Arc::new(arm);
    arm.home(Homing::IfUnknown).unwrap().finish().unwrap();
    arm.motors_on().unwrap().finish().unwrap();
    let over = Arc::new(AtomicBool::new(false));
    let served = {
        let (arm, over) = (arm.clone(), over.clone());
        thread::spawn(move || serve(&arm, &options("arm"), &|| over.load(Ordering::Relaxed)))
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()
        .unwrap();
    runtime.block_on(LocalSet::new().run_until(async {
        let mut node = node(&options("client")).unwrap();
        let client = client_of(&mut node).await;
        let start = angles(&arm);
        let away = [start[0] + 0.15, start[1] - 0.1];

        let (status, result) = ended(&client, goal(["A", "E"], away, 0.5)).await;
        assert_eq!(
            (status, result.error_code),
            (GoalStatusEnum::Succeeded, SUCCESSFUL),
            "{result:?}"
        );
        assert!(apart(angles(&arm), away) < 1e-3);

        let (status, result) = ended(&client, goal(["A", "D"], start, 0.5)).await;
        assert_eq!(
            (status, result.error_code),
            (GoalStatusEnum::Aborted, INVALID_JOINTS)
        );
        assert!(result.error_string.contains("\"D\""), "{result:?}");

        // Another goal takes the place of one on its way.
        let (first, _) = client
            .async_send_goal(goal(["E", "A"], [start[1], start[0]], 4.0))
            .await
            .unwrap();
        let (status, _) = ended(&client, goal(["A", "E"], start, 0.5)).await;
        assert_eq!(status, GoalStatusEnum::Succeeded);
        let (status, result) = client.async_request_result(first).await.unwrap();
        assert_eq!(status, GoalStatusEnum::Aborted, "{result:?}");
        assert!(apart(angles(&arm), start) < 1e-3);

        // It rests on the way, and the motors stay on.
        let (id, _) = client
            .async_send_goal(goal(["A", "E"], away, 5.0))
            .await
            .unwrap();
        let mut feedback = std::pin::pin!(client.feedback_stream(id));
        loop {
            use futures_util::StreamExt;
            let told = feedback.next().await.unwrap().unwrap();
            if apart([told.actual.positions[0], told.actual.positions[1]], start) > 0.01 {
                assert!(
                    told.error.positions.iter().all(|error| error.abs() < 0.02),
                    "{told:?}"
                );
                break;
            }
        }
        client
            .async_cancel_goal(id, ros2_client::builtin_interfaces::Time::ZERO)
            .await
            .unwrap();
        let (status, _) = client.async_request_result(id).await.unwrap();
        assert_eq!(status, GoalStatusEnum::Canceled);
        let rest = angles(&arm);
        assert!(
            apart(rest, start) > 0.01 && apart(rest, away) > 0.01,
            "{rest:?}"
        );
        arm.move_joints(start.map(|angle| angle as f32), 0.5)
            .unwrap()
            .finish()
            .unwrap();
    }));
    over.store(true, Ordering::Relaxed);
    served.join().unwrap().unwrap();
    arm.close().unwrap();
}
