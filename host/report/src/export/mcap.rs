//! A run as MCAP, the log format of Foxglove, in the profile of ROS 2: programs that read bags (`rosbags`, `ros2 bag`) read it,
//! too. One channel has the figures, one the driven joints as `sensor_msgs/JointState`, one the arm as a 3D scene. Messages are
//! in CDR, the encoding of ROS 2; each channel has the definition of its message beside it.

use super::scene;
use byteorder::LittleEndian;
use cdr_encoding::Error;
use fivebar_files::robot::Robot;
use fivebar_sim::simulation::{Sample, Trace};
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Cursor;

/// Time between two frames of the scene [s].
const FRAME: f64 = 0.02;
/// Time between two states of the joints [s].
const STATE: f64 = 0.01;

/// What stands before a message in CDR: little-endian, no options.
const LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

/// The header of a message: its time, and the frame.
pub(super) const HEADER: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// `sensor_msgs/JointState`
const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position  # [rad]
float64[] velocity  # [rad/s]
float64[] effort  # [N·m]
";

/// The topic of the figures.
const TOPIC: &str = "/run";

/// Each figure with its unit.
const FIELDS: [(&str, &str); 18] = [
    ("tool_x", "m"),
    ("tool_y", "m"),
    ("reference_x", "m"),
    ("reference_y", "m"),
    ("tip_error", "m"),
    ("tool_level", "1"),
    ("theta1", "rad"),
    ("theta4", "rad"),
    ("reference_theta1", "rad"),
    ("reference_theta4", "rad"),
    ("torque1", "N·m"),
    ("torque4", "N·m"),
    ("current1", "A"),
    ("current4", "A"),
    ("current_set_point1", "A"),
    ("current_set_point4", "A"),
    ("duty1", "1"),
    ("duty4", "1"),
];

/// The figures of a sample, in the order of [`FIELDS`].
fn figures(s: &Sample) -> [f32; FIELDS.len()] {
    let groups: [&[f64]; 9] = [
        &s.tool,
        &s.reference,
        &[s.tip_error(), s.tool_level],
        &s.angle,
        &s.reference_angle,
        &s.torque,
        &s.current,
        &s.current_set_point,
        &s.duty,
    ];
    let mut all = groups.into_iter().flatten().map(|&value| value as f32);
    std::array::from_fn(|_| all.next().unwrap_or(f32::NAN))
}

/// The time of a message as `builtin_interfaces/Time` in a header.
pub(super) fn header(time: f64) -> impl Serialize {
    let nanoseconds = nanoseconds(time);
    let (second, rest) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
    (second as i32, rest as u32, "base")
}

/// The driven joints, by their names in the exported URDF.
fn joint_state(s: &Sample) -> impl Serialize {
    let of = |values: [f64; 2]| Vec::from(values);
    (
        header(s.time),
        vec!["A", "E"],
        of(s.angle),
        of(s.reference_velocity),
        of(s.torque),
    )
}

/// The run as the bytes of an MCAP file.
///
/// # Errors
/// The error of the format's writer.
pub fn mcap(robot: &Robot, trace: &Trace) -> Result<Vec<u8>, McapError> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(None).profile("ros2");
    let mut bag = Bag {
        writer: options.create(&mut bytes)?,
    };
    let mut run = bag.channel(TOPIC, "fivebar_msgs/msg/Run", &schema())?;
    for sample in trace.samples() {
        bag.write(&mut run, sample.time, &figures(sample))?;
    }
    let definition = format!("{JOINT_STATE}{HEADER}");
    let mut joints = bag.channel("/joint_states", "sensor_msgs/msg/JointState", &definition)?;
    for sample in each(STATE, trace) {
        bag.write(&mut joints, sample.time, &joint_state(sample))?;
    }
    let mut frames = bag.channel("/scene", scene::NAME, &scene::definition())?;
    let assembly = robot.home_pose().map(|pose| pose.assembly());
    for sample in each(FRAME, trace) {
        let [theta1, theta4] = sample.angle;
        let side = assembly.as_ref().ok();
        if let Some(pose) = side.and_then(|side| robot.geometry.forward(theta1, theta4, *side).ok())
        {
            bag.write(
                &mut frames,
                sample.time,
                &scene::scene(robot, &pose, sample.time),
            )?;
        }
    }
    bag.writer.finish()?;
    drop(bag);
    Ok(bytes.into_inner())
}

/// The samples that are so far apart [s].
fn each(interval: f64, trace: &Trace) -> impl Iterator<Item = &Sample> {
    let mut due = f64::NEG_INFINITY;
    trace.samples().iter().filter(move |sample| {
        // Times are sums of ticks.
        let is_due = sample.time >= due - 1e-9;
        if is_due {
            due = sample.time + interval;
        }
        is_due
    })
}

/// Channels and their messages.
struct Bag<'a> {
    writer: Writer<&'a mut Cursor<Vec<u8>>>,
}

/// A channel, and how many messages it has.
struct Channel {
    id: u16,
    messages: u32,
}

impl Bag<'_> {
    fn channel(&mut self, topic: &str, kind: &str, definition: &str) -> Result<Channel, McapError> {
        let schema = self
            .writer
            .add_schema(kind, "ros2msg", definition.as_bytes())?;
        let id = self
            .writer
            .add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        Ok(Channel { id, messages: 0 })
    }

    fn write(
        &mut self,
        channel: &mut Channel,
        time: f64,
        message: &impl Serialize,
    ) -> Result<(), McapError> {
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.messages,
            log_time: nanoseconds(time),
            publish_time: nanoseconds(time),
        };
        channel.messages += 1;
        let data = cdr(message).map_err(std::io::Error::other)?;
        self.writer.write_to_known_channel(&header, &data)
    }
}

/// A message in CDR.
fn cdr(message: &impl Serialize) -> Result<Vec<u8>, Error> {
    let mut data = LITTLE_ENDIAN.to_vec();
    cdr_encoding::to_writer::<_, LittleEndian, _>(&mut data, message)?;
    Ok(data)
}

fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}

/// The fields with their units.
fn schema() -> String {
    let field = |(name, unit): &(&str, &str)| format!("float32 {name}  # [{unit}]\n");
    FIELDS.iter().map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_files::robot::BuiltIn;

    fn short_run(robot: &Robot) -> Trace {
        let [theta1, theta4] = robot.home;
        let mut trace = Trace::default();
        for tick in 0..300 {
            trace.push(Sample {
                time: f64::from(tick) * 1e-3,
                angle: [theta1, theta4],
                tool: [0.1, 0.2],
                reference: [0.1, 0.2 + 1e-5],
                torque: [0.5, -0.25],
                ..Sample::default()
            });
        }
        trace
    }

    /// The reader of another project, `rosbags`, reads the same in `scripts/peers.sh`.
    #[test]
    fn every_channel_holds_every_sample_and_reads_back() {
        let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
        let bytes = mcap(&robot, &short_run(&robot)).unwrap();
        let mut counts = BTreeMap::new();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            assert_eq!(
                (&*schema.encoding, &*message.channel.message_encoding),
                ("ros2msg", "cdr")
            );
            assert_eq!(message.data[..4], LITTLE_ENDIAN);
            let body = &message.data[4..];
            match &*message.channel.topic {
                TOPIC => {
                    let error = f32::from_le_bytes(body[16..20].try_into().unwrap());
                    assert!((error - 1e-5).abs() < 1e-11);
                    assert_eq!(body.len(), 4 * FIELDS.len());
                }
                "/joint_states" => {
                    type State = ((i32, u32, String), Vec<String>, [Vec<f64>; 3]);
                    let (state, _) = cdr_encoding::from_bytes::<State, LittleEndian>(body).unwrap();
                    let ((_, _, frame), names, [angles, _, torques]) = state;
                    assert_eq!(
                        (&*frame, &names[..]),
                        ("base", &["A", "E"].map(String::from)[..])
                    );
                    assert_eq!(
                        (&angles[..], &torques[..]),
                        (&robot.home[..], &[0.5, -0.25][..])
                    );
                }
                _ => {}
            }
            *counts.entry(message.channel.topic.clone()).or_insert(0) += 1;
        }
        assert_eq!(
            (counts[TOPIC], counts["/joint_states"], counts["/scene"]),
            (300, 30, 15)
        );
    }
}
