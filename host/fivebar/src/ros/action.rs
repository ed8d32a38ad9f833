//! The action `control_msgs/FollowJointTrajectory`, under the name of a joint trajectory controller, so that MoveIt and the
//! clients of ros2_control find it.

use super::RosError;
use super::follower::{Ended, Follower};
use super::messages::{
    FollowFeedback, FollowGoal, FollowResult, Header, INVALID_GOAL, INVALID_JOINTS, MultiPoint,
    PATH_TOLERANCE_VIOLATED, SUCCESSFUL, TrajectoryPoint,
};
use super::state::BASE;
use super::trajectory::{DRIVEN, Unfollowed};
use fivebar_sim::live::LiveArm;
use ros2_client::action::{
    ActionServerQosPolicies, AsyncActionServer, GoalEndStatus, NewGoalHandle,
};
use ros2_client::qos::{Durability, History};
use ros2_client::{ActionTypeName, Name, Node, QosProfile, ServiceMapping};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::{spawn_blocking, spawn_local};
use tokio::time::interval;

/// Time between two messages of feedback.
const FEEDBACK: Duration = Duration::from_millis(50);

type Server = AsyncActionServer<FollowGoal, FollowResult, FollowFeedback>;

/// What the tasks of the action share.
struct Action {
    server: Server,
    arm: Arc<LiveArm>,
    follower: Follower,
    /// Goals that shall end.
    canceled: RefCell<Vec<ros2_client::action::GoalId>>,
}

/// Begins to take goals.
pub(super) fn begin(
    node: &mut Node,
    arm: &Arc<LiveArm>,
    follower: Follower,
    name: &str,
) -> Result<(), RosError> {
    let latest = |durability| {
        QosProfile::publisher_default()
            .durability(durability)
            .history(History::KeepLast { depth: 10 })
    };
    let volatile = latest(Durability::Volatile);
    let server = node.create_action_server(
        ServiceMapping::Enhanced,
        &Name::new(&format!("/{name}"), "follow_joint_trajectory")?,
        &ActionTypeName::new("control_msgs", "FollowJointTrajectory"),
        ActionServerQosPolicies {
            goal_service: volatile.clone(),
            result_service: volatile.clone(),
            cancel_service: volatile.clone(),
            feedback_publisher: volatile,
            status_publisher: latest(Durability::TransientLocal),
        },
    )?;
    let action = Rc::new(Action {
        server: AsyncActionServer::new(server),
        arm: arm.clone(),
        follower,
        canceled: RefCell::default(),
    });
    spawn_local(take_goals(action.clone()));
    spawn_local(take_cancels(action));
    Ok(())
}

async fn take_goals(action: Rc<Action>) {
    loop {
        // A message that cannot be read is no goal.
        if let Ok(goal) = action.server.receive_new_goal().await {
            spawn_local(follow(action.clone(), goal));
        }
    }
}

/// A cancelled goal brings the arm to rest on its path.
async fn take_cancels(action: Rc<Action>) {
    loop {
        let Ok(cancel) = action.server.receive_cancel_request().await else {
            continue;
        };
        action.canceled.borrow_mut().extend(cancel.goals());
        let goals: Vec<_> = cancel.goals().collect();
        let _ = action
            .server
            .respond_to_cancel_requests(&cancel, goals.into_iter())
            .await;
        let arm = action.arm.clone();
        spawn_blocking(move || arm.stop());
    }
}

async fn follow(action: Rc<Action>, goal: NewGoalHandle<FollowGoal>) {
    let server = &action.server;
    let Some(FollowGoal { trajectory, .. }) = server.get_new_goal(goal.clone()) else {
        return;
    };
    let id = goal.goal_id();
    let Ok(accepted) = server.accept_goal(goal).await else {
        return;
    };
    let Ok(executing) = server.start_executing_goal(accepted).await else {
        return;
    };
    let mut answer = action.follower.follow(trajectory);
    let mut tick = interval(FEEDBACK);
    let ended = loop {
        tokio::select! {
            ended = &mut answer => break ended,
            _ = tick.tick() => {
                if let Some(feedback) = feedback(&action) {
                    let _ = server.publish_feedback(executing.clone(), feedback).await;
                }
            }
        }
    };
    let is_canceled = action.canceled.borrow().contains(&id);
    action.canceled.borrow_mut().retain(|other| *other != id);
    let (error_code, error_string) = match ended {
        Ok(Ok(())) => (SUCCESSFUL, String::new()),
        Ok(Err(error)) => (code(&error), error.to_string()),
        Err(_) => (PATH_TOLERANCE_VIOLATED, "the arm is no longer there".into()),
    };
    let status = match error_code {
        SUCCESSFUL => GoalEndStatus::Succeeded,
        _ if is_canceled => GoalEndStatus::Canceled,
        _ => GoalEndStatus::Aborted,
    };
    let result = FollowResult {
        error_code,
        error_string,
    };
    // It waits until the client asks for it.
    let _ = server.send_result_response(executing, status, result).await;
}

fn code(error: &Ended) -> i32 {
    match error {
        Ended::Unfollowed(Unfollowed::Joints(_)) => INVALID_JOINTS,
        Ended::Unfollowed(_) => INVALID_GOAL,
        Ended::Live(_) | Ended::Replaced | Ended::Stopped => PATH_TOLERANCE_VIOLATED,
    }
}

/// Where the arm should be and is; none: it follows nothing.
fn feedback(action: &Action) -> Option<FollowFeedback> {
    let desired = action.follower.desired()?;
    let status = action.arm.progress().status;
    let actual = (status.angle.map(f64::from), status.velocity.map(f64::from));
    let error = [(desired.position, actual.0), (desired.velocity, actual.1)]
        .map(|(wanted, is)| [0, 1].map(|k| wanted[k] - is[k]));
    Some(FollowFeedback {
        header: Header::now(BASE),
        joint_names: DRIVEN.map(String::from).into(),
        desired: TrajectoryPoint::of(desired.position, desired.velocity, 0.0),
        actual: TrajectoryPoint::of(actual.0, actual.1, 0.0),
        error: TrajectoryPoint::of(error[0], error[1], 0.0),
        multi_dof_joint_names: Vec::new(),
        multi_dof_desired: MultiPoint::none(),
        multi_dof_actual: MultiPoint::none(),
        multi_dof_error: MultiPoint::none(),
    })
}

#[cfg(test)]
mod tests;
