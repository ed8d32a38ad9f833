//! The messages of ROS 2 that the node speaks, field by field as in their packages (sensor_msgs, geometry_msgs, tf2_msgs,
//! diagnostic_msgs, trajectory_msgs, control_msgs and std_srvs of Jazzy and Kilted). Units are those of ROS: m, rad, s, N·m.

use ros2_client::Message;
use ros2_client::builtin_interfaces::{Duration, Time};
use serde::{Deserialize, Serialize};

/// Messages of these names and fields.
macro_rules! messages {
    ($($(#[$about:meta])* $name:ident { $($field:ident: $kind:ty,)* })*) => { $(
        $(#[$about])*
        #[derive(Clone, Debug, Serialize, Deserialize)]
        pub(super) struct $name { $(pub(super) $field: $kind,)* }
        impl Message for $name {}
    )* };
}

messages! {
    /// `std_msgs/Header`
    Header { stamp: Time, frame_id: String, }
    /// `std_msgs/String`
    Text { data: String, }
    /// `sensor_msgs/JointState`
    JointState {
        header: Header,
        name: Vec<String>,
        position: Vec<f64>,
        velocity: Vec<f64>,
        effort: Vec<f64>,
    }
    /// `geometry_msgs/Vector3`
    Vector3 { x: f64, y: f64, z: f64, }
    /// `geometry_msgs/Quaternion`
    Quaternion { x: f64, y: f64, z: f64, w: f64, }
    /// `geometry_msgs/Transform`
    Transform { translation: Vector3, rotation: Quaternion, }
    /// `geometry_msgs/TransformStamped`
    TransformStamped { header: Header, child_frame_id: String, transform: Transform, }
    /// `tf2_msgs/TFMessage`
    Transforms { transforms: Vec<TransformStamped>, }
    /// `geometry_msgs/Twist`
    Twist { linear: Vector3, angular: Vector3, }
    /// `diagnostic_msgs/KeyValue`
    KeyValue { key: String, value: String, }
    /// `diagnostic_msgs/DiagnosticStatus`
    DiagnosticStatus {
        level: u8,
        name: String,
        message: String,
        hardware_id: String,
        values: Vec<KeyValue>,
    }
    /// `diagnostic_msgs/DiagnosticArray`
    Diagnostics { header: Header, status: Vec<DiagnosticStatus>, }
    /// `trajectory_msgs/JointTrajectory`
    JointTrajectory { header: Header, joint_names: Vec<String>, points: Vec<TrajectoryPoint>, }
    /// `trajectory_msgs/JointTrajectoryPoint`
    TrajectoryPoint {
        positions: Vec<f64>,
        velocities: Vec<f64>,
        accelerations: Vec<f64>,
        effort: Vec<f64>,
        time_from_start: Duration,
    }
    /// `trajectory_msgs/MultiDOFJointTrajectory`
    MultiTrajectory { header: Header, joint_names: Vec<String>, points: Vec<MultiPoint>, }
    /// `trajectory_msgs/MultiDOFJointTrajectoryPoint`
    MultiPoint {
        transforms: Vec<Transform>,
        velocities: Vec<Twist>,
        accelerations: Vec<Twist>,
        time_from_start: Duration,
    }
    /// `control_msgs/JointTolerance`
    JointTolerance { name: String, position: f64, velocity: f64, acceleration: f64, }
    /// `control_msgs/JointComponentTolerance`
    ComponentTolerance {
        joint_name: String,
        component: u16,
        position: f64,
        velocity: f64,
        acceleration: f64,
    }
    /// The goal of `control_msgs/FollowJointTrajectory`
    FollowGoal {
        trajectory: JointTrajectory,
        multi_dof_trajectory: MultiTrajectory,
        path_tolerance: Vec<JointTolerance>,
        component_path_tolerance: Vec<ComponentTolerance>,
        goal_tolerance: Vec<JointTolerance>,
        component_goal_tolerance: Vec<ComponentTolerance>,
        goal_time_tolerance: Duration,
    }
    /// The result of `control_msgs/FollowJointTrajectory`
    FollowResult { error_code: i32, error_string: String, }
    /// The feedback of `control_msgs/FollowJointTrajectory`
    FollowFeedback {
        header: Header,
        joint_names: Vec<String>,
        desired: TrajectoryPoint,
        actual: TrajectoryPoint,
        error: TrajectoryPoint,
        multi_dof_joint_names: Vec<String>,
        multi_dof_desired: MultiPoint,
        multi_dof_actual: MultiPoint,
        multi_dof_error: MultiPoint,
    }
    /// The request of `std_srvs/Trigger`: a message without fields has this one.
    TriggerRequest { structure_needs_at_least_one_member: u8, }
    /// The answer of `std_srvs/Trigger`
    TriggerResponse { success: bool, message: String, }
}

/// `error_code` of [`FollowResult`].
pub(super) const SUCCESSFUL: i32 = 0;
/// The trajectory cannot be followed.
pub(super) const INVALID_GOAL: i32 = -1;
/// It names other joints.
pub(super) const INVALID_JOINTS: i32 = -2;
/// The motion ended on the way.
pub(super) const PATH_TOLERANCE_VIOLATED: i32 = -4;

impl Header {
    /// Of now, in this frame.
    pub(super) fn now(frame: &str) -> Self {
        Self {
            stamp: Time::now(),
            frame_id: frame.into(),
        }
    }
}

impl TrajectoryPoint {
    /// θ1, θ4 [rad] and ω1, ω4 [rad/s], after this time.
    pub(super) fn of(position: [f64; 2], velocity: [f64; 2], after: f64) -> Self {
        Self {
            positions: position.into(),
            velocities: velocity.into(),
            accelerations: Vec::new(),
            effort: Vec::new(),
            time_from_start: Duration::from_nanos((after * 1e9) as i64),
        }
    }
}

impl MultiPoint {
    /// None: this arm has no joints of several degrees of freedom.
    pub(super) fn none() -> Self {
        Self {
            transforms: Vec::new(),
            velocities: Vec::new(),
            accelerations: Vec::new(),
            time_from_start: Duration::from_nanos(0),
        }
    }
}
