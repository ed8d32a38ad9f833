//! The arm as a node of ROS 2, over DDS, without an installed ROS.
//!
//! It publishes the joints, the frames of the links, the URDF and diagnostics. It follows trajectories from a topic and from
//! the action `FollowJointTrajectory`, and homes, switches and stops the arm by services.

mod action;
mod follower;
mod messages;
mod services;
mod state;
mod trajectory;

use fivebar_firmware::Status;
use fivebar_report::export::{ExportError, urdf};
use fivebar_sim::live::LiveArm;
use follower::Follower;
use futures_util::StreamExt;
use messages::{Diagnostics, JointState, JointTrajectory, Text, Transforms};
use ros2_client::names::NameError;
use ros2_client::qos::{Durability, History};
use ros2_client::{
    Context, ContextOptions, CreateError, MessageTypeName, Name, Node, NodeCreateError, NodeName,
    NodeOptions, Publisher, QosProfile,
};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::LocalSet;
use tokio::time::interval;

/// Time between two diagnostics.
const DIAGNOSIS: Duration = Duration::from_secs(1);
/// Time between two looks for the end of the program.
const LOOK: Duration = Duration::from_millis(50);

/// How the node is seen.
#[derive(Clone, Debug)]
pub struct RosOptions {
    /// The name of the node.
    pub name: String,
    /// The domain: nodes of another one do not see it.
    pub domain: u16,
    /// Messages of the joints' states per second [1/s].
    pub rate: f64,
}

/// Why the node does not work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RosError {
    /// The name of the node.
    #[error("--name: {0}")]
    Name(#[from] NameError),
    /// The network.
    #[error("the node cannot be made: {0}")]
    Create(String),
    /// The robot has no URDF.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The machine gives no threads.
    #[error(transparent)]
    Runtime(#[from] std::io::Error),
}

impl From<CreateError> for RosError {
    fn from(error: CreateError) -> Self {
        Self::Create(error.to_string())
    }
}

impl From<NodeCreateError> for RosError {
    fn from(error: NodeCreateError) -> Self {
        Self::Create(error.to_string())
    }
}

/// Why the last motion failed; none: it did not.
type Failure = Rc<RefCell<Option<String>>>;

/// A node of ROS 2 for this arm, until `ends` says so.
///
/// # Errors
/// The node cannot be made.
pub fn serve(
    arm: &Arc<LiveArm>,
    options: &RosOptions,
    ends: &dyn Fn() -> bool,
) -> Result<(), RosError> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()?;
    let tasks = LocalSet::new();
    runtime.block_on(tasks.run_until(async {
        let mut node = node(options)?;
        begin(&mut node, arm, options)?;
        tokio::task::spawn_local(node.spinner()?.spin());
        let mut look = interval(LOOK);
        while !ends() {
            look.tick().await;
        }
        Ok(())
    }))
}

fn node(options: &RosOptions) -> Result<Node, RosError> {
    let name = NodeName::new("/", &options.name)?;
    let context = Context::with_options(ContextOptions::new().domain_id(options.domain))?;
    Ok(context.new_node(name, NodeOptions::new())?)
}

/// Begins all that the node does.
fn begin(node: &mut Node, arm: &Arc<LiveArm>, options: &RosOptions) -> Result<(), RosError> {
    let (follower, failure) = (Follower::new(arm.clone()), Failure::default());
    describe(node, arm)?;
    tell_of_joints(node, arm, options.rate)?;
    diagnose(node, arm, failure.clone())?;
    follow_topic(node, follower.clone(), failure)?;
    services::begin(node, arm, &options.name)?;
    action::begin(node, arm, follower, &options.name)
}

/// A publisher of this topic, whose last messages late subscribers get if they are kept.
fn publisher<M: serde::Serialize>(
    node: &mut Node,
    topic: &str,
    [package, kind]: [&str; 2],
    durability: Durability,
    depth: usize,
) -> Result<Publisher<M>, RosError> {
    let qos = QosProfile::publisher_default()
        .durability(durability)
        .history(History::KeepLast { depth });
    let topic = node.create_topic(
        &Name::new("/", topic)?,
        MessageTypeName::new(package, kind),
        &qos,
    )?;
    Ok(node.create_publisher(&topic, None)?)
}

/// The URDF, for all who come.
fn describe(node: &mut Node, arm: &LiveArm) -> Result<(), RosError> {
    let data = urdf(arm.robot())?;
    let description = publisher(
        node,
        "robot_description",
        ["std_msgs", "String"],
        Durability::TransientLocal,
        1,
    )?;
    tokio::task::spawn_local(async move {
        let _ = description.async_publish(Text { data }).await;
        // The message lives as long as its publisher.
        std::future::pending::<()>().await;
    });
    Ok(())
}

/// The joints' states and the links' frames, while the angles are known.
fn tell_of_joints(node: &mut Node, arm: &Arc<LiveArm>, rate: f64) -> Result<(), RosError> {
    let volatile = Durability::Volatile;
    let joints: Publisher<JointState> = publisher(
        node,
        "joint_states",
        ["sensor_msgs", "JointState"],
        volatile,
        10,
    )?;
    let frames: Publisher<Transforms> =
        publisher(node, "tf", ["tf2_msgs", "TFMessage"], volatile, 100)?;
    let arm = arm.clone();
    tokio::task::spawn_local(async move {
        let mut tick = interval(Duration::from_secs_f64(1.0 / rate));
        loop {
            tick.tick().await;
            let (robot, status) = (arm.robot(), arm.progress().status);
            let Some(pose) = state::pose(robot, &status) else {
                continue;
            };
            // A subscriber that takes nothing loses messages.
            let _ = joints
                .async_publish(state::joint_state(robot, &status, &pose))
                .await;
            let _ = frames.async_publish(state::transforms(robot, &pose)).await;
        }
    });
    Ok(())
}

fn diagnose(node: &mut Node, arm: &Arc<LiveArm>, failure: Failure) -> Result<(), RosError> {
    let diagnostics: Publisher<Diagnostics> = publisher(
        node,
        "diagnostics",
        ["diagnostic_msgs", "DiagnosticArray"],
        Durability::Volatile,
        10,
    )?;
    let arm = arm.clone();
    tokio::task::spawn_local(async move {
        let mut tick = interval(DIAGNOSIS);
        loop {
            tick.tick().await;
            let status: Status = arm.progress().status;
            let failure = failure.borrow().clone();
            let message = state::diagnostics(arm.robot(), &status, failure.as_deref());
            let _ = diagnostics.async_publish(message).await;
        }
    });
    Ok(())
}

/// Follows the trajectories of the topic. It has no answers: the diagnostics say why one failed.
fn follow_topic(node: &mut Node, follower: Follower, failure: Failure) -> Result<(), RosError> {
    let qos = QosProfile::subscription_default()
        .reliability_best_effort()
        .history(History::KeepLast { depth: 10 });
    let topic = node.create_topic(
        &Name::new("/", "joint_trajectory")?,
        MessageTypeName::new("trajectory_msgs", "JointTrajectory"),
        &qos,
    )?;
    let trajectories = node.create_subscription::<JointTrajectory>(&topic, None)?;
    tokio::task::spawn_local(async move {
        let mut messages = std::pin::pin!(trajectories.async_stream());
        while let Some(message) = messages.next().await {
            let Ok((message, _)) = message else {
                continue;
            };
            *failure.borrow_mut() = None;
            let (answer, failure) = (follower.follow(message), failure.clone());
            tokio::task::spawn_local(async move {
                if let Ok(Err(error)) = answer.await
                    && !matches!(error, follower::Ended::Replaced)
                {
                    *failure.borrow_mut() = Some(error.to_string());
                }
            });
        }
    });
    Ok(())
}
