//! A run as MCAP, the log format of Foxglove: one channel for the figures, and a 3D
//! scene of the arm. The figures are binary, in the encoding of ROS 1: numbers of 32 bits one behind
//! the other, as their schema lists them. One message for all of them takes a fifth of what JSON takes
//! in five channels. The scene, which has many parts and few messages, is JSON.

use super::scene;
use fivebar_files::robot::Robot;
use fivebar_sim::simulation::{Sample, Trace};
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Time between two frames of the scene [s].
const FRAME: f64 = 0.02;

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
fn figures(s: &Sample) -> Vec<u8> {
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
    let all = groups.into_iter().flatten();
    all.flat_map(|&value| (value as f32).to_le_bytes())
        .collect()
}

/// The run as the bytes of an MCAP file.
///
/// # Errors
/// The error of the format's writer.
pub fn mcap(robot: &Robot, trace: &Trace) -> Result<Vec<u8>, McapError> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(None).profile("");
    let mut writer = options.create(&mut bytes)?;
    let metadata = BTreeMap::new();
    let schema = writer.add_schema("fivebar/Run", "ros1msg", schema().as_bytes())?;
    let id = writer.add_channel(schema, TOPIC, "ros1", &metadata)?;
    for (sequence, sample) in trace.samples().iter().enumerate() {
        let header = header(id, sequence, sample.time);
        writer.write_to_known_channel(&header, &figures(sample))?;
    }
    let schema = writer.add_schema(
        scene::NAME,
        "jsonschema",
        scene::schema().to_string().as_bytes(),
    )?;
    let id = writer.add_channel(schema, "/scene", "json", &metadata)?;
    let assembly = robot.home_pose().map(|pose| pose.assembly());
    let mut due = f64::NEG_INFINITY;
    let mut frames = 0;
    for sample in trace.samples() {
        let [theta1, theta4] = sample.angle;
        let Some(pose) = assembly
            .as_ref()
            .ok()
            .and_then(|side| robot.geometry.forward(theta1, theta4, *side).ok())
            .filter(|_| sample.time >= due)
        else {
            continue;
        };
        due = sample.time + FRAME;
        let message = scene::scene(robot, &pose, sample.time).to_string();
        writer.write_to_known_channel(&header(id, frames, sample.time), message.as_bytes())?;
        frames += 1;
    }
    writer.finish()?;
    drop(writer);
    Ok(bytes.into_inner())
}

fn header(channel_id: u16, sequence: usize, time: f64) -> MessageHeader {
    let nanoseconds = (time * 1e9).round() as u64;
    MessageHeader {
        channel_id,
        sequence: sequence as u32,
        log_time: nanoseconds,
        publish_time: nanoseconds,
    }
}

/// The fields in the language of ROS 1, with their units.
fn schema() -> String {
    let field = |(name, unit): &(&str, &str)| format!("float32 {name}  # [{unit}]\n");
    FIELDS.iter().map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_files::robot::BuiltIn;
    use serde_json::Value;

    fn short_run(robot: &Robot) -> Trace {
        let [theta1, theta4] = robot.home;
        let mut trace = Trace::default();
        for tick in 0..300 {
            trace.push(Sample {
                time: f64::from(tick) * 1e-3,
                angle: [theta1, theta4],
                tool: [0.1, 0.2],
                reference: [0.1, 0.2 + 1e-5],
                ..Sample::default()
            });
        }
        trace
    }

    /// Foxglove's reader parses the whole schema first, and refuses the channel if any part
    /// has no description.
    fn is_readable(schema: &Value) -> bool {
        match schema["type"].as_str() {
            Some("object") => schema["properties"]
                .as_object()
                .is_some_and(|parts| parts.values().all(is_readable)),
            Some("array") => is_readable(&schema["items"]),
            Some(kind) => ["number", "integer", "boolean", "string"].contains(&kind),
            None => false,
        }
    }

    /// Whether a value has exactly the parts that a schema describes.
    fn matches_schema(value: &Value, schema: &Value) -> bool {
        match (schema["type"].as_str(), value) {
            (Some("object"), Value::Object(parts)) => {
                let described = schema["properties"].as_object().unwrap();
                let mut each = parts.iter().zip(described);
                parts.len() == described.len()
                    && each.all(|((name, part), (known, of))| {
                        name == known && matches_schema(part, of)
                    })
            }
            (Some("array"), Value::Array(items)) => items
                .iter()
                .all(|item| matches_schema(item, &schema["items"])),
            (Some("number"), Value::Number(_))
            | (Some("boolean"), Value::Bool(_))
            | (Some("string"), Value::String(_)) => true,
            (Some("integer"), value) => value.is_u64(),
            _ => false,
        }
    }

    #[test]
    fn every_message_matches_its_schema() {
        let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
        let bytes = mcap(&robot, &short_run(&robot)).unwrap();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            if schema.encoding == "ros1msg" {
                let text = std::str::from_utf8(&schema.data).unwrap();
                assert!(
                    text.lines().all(|line| line.starts_with("float32 ")),
                    "{text}"
                );
                assert_eq!(message.data.len(), 4 * text.lines().count(), "{text}");
                continue;
            }
            let schema = &schema.data;
            let schema: Value = serde_json::from_slice(schema).unwrap();
            let value = serde_json::from_slice(&message.data).unwrap();
            assert!(is_readable(&schema), "{schema}");
            assert!(
                matches_schema(&value, &schema),
                "{value} does not match {schema}"
            );
        }
    }

    #[test]
    fn every_channel_holds_every_sample_and_reads_back() {
        let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
        let bytes = mcap(&robot, &short_run(&robot)).unwrap();
        let mut counts = BTreeMap::new();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            if message.channel.topic == TOPIC {
                let error = f32::from_le_bytes(message.data[16..20].try_into().unwrap());
                assert!((error - 1e-5).abs() < 1e-11);
            }
            *counts.entry(message.channel.topic.clone()).or_insert(0) += 1;
        }
        assert_eq!(counts[TOPIC], 300);
        assert_eq!(counts["/scene"], 15);
    }
}
