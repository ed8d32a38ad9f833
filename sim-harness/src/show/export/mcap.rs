//! A run as MCAP, the log format of Foxglove: one channel for each kind of figure, and a 3D
//! scene of the arm. The messages are JSON with JSON schemas.

use super::scene;
use crate::input::robot::Robot;
use crate::run::simulation::{Sample, Trace};
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Time between two frames of the scene [s].
const FRAME: f64 = 0.02;

/// A channel of numbers, in pairs for joints 1 and 4 or for x and y.
struct Channel {
    topic: &'static str,
    /// Field and unit.
    fields: &'static [(&'static str, &'static str)],
    values: fn(&Sample) -> Vec<f64>,
}

const CHANNELS: [Channel; 5] = [
    Channel {
        topic: "/tool",
        fields: &[
            ("x", "m"),
            ("y", "m"),
            ("reference_x", "m"),
            ("reference_y", "m"),
            ("error", "m"),
            ("level", "1"),
        ],
        values: |s| {
            [
                s.tool.as_slice(),
                &s.reference,
                &[s.tip_error(), s.tool_level],
            ]
            .concat()
        },
    },
    Channel {
        topic: "/joints",
        fields: &[
            ("theta1", "rad"),
            ("theta4", "rad"),
            ("reference_theta1", "rad"),
            ("reference_theta4", "rad"),
        ],
        values: |s| [s.angle, s.reference_angle].concat(),
    },
    Channel {
        topic: "/torque",
        fields: &[("joint1", "N·m"), ("joint4", "N·m")],
        values: |s| s.torque.to_vec(),
    },
    Channel {
        topic: "/current",
        fields: &[
            ("joint1", "A"),
            ("joint4", "A"),
            ("set_point1", "A"),
            ("set_point4", "A"),
        ],
        values: |s| [s.current, s.current_set_point].concat(),
    },
    Channel {
        topic: "/duty",
        fields: &[("joint1", "1"), ("joint4", "1")],
        values: |s| s.duty.to_vec(),
    },
];

/// The run as the bytes of an MCAP file.
///
/// # Errors
/// The error of the format's writer.
pub fn mcap(robot: &Robot, trace: &Trace) -> Result<Vec<u8>, McapError> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(None).profile("");
    let mut writer = options.create(&mut bytes)?;
    let metadata = BTreeMap::new();
    for channel in &CHANNELS {
        let name = format!("fivebar{}", channel.topic.replace('/', "."));
        let schema =
            writer.add_schema(&name, "jsonschema", schema(channel).to_string().as_bytes())?;
        let id = writer.add_channel(schema, channel.topic, "json", &metadata)?;
        for (sequence, sample) in trace.samples().iter().enumerate() {
            let fields = channel.fields.iter().map(|(name, _)| (*name).to_string());
            let values = (channel.values)(sample)
                .into_iter()
                .map(|value| json!(value));
            let message: Value = fields.zip(values).collect();
            let header = header(id, sequence, sample.time);
            writer.write_to_known_channel(&header, message.to_string().as_bytes())?;
        }
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

fn schema(channel: &Channel) -> Value {
    let property = |(name, unit): &(&str, &str)| {
        let description = json!({ "type": "number", "description": format!("[{unit}]") });
        ((*name).to_string(), description)
    };
    let properties: Value = channel.fields.iter().map(property).collect();
    json!({ "type": "object", "properties": properties })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::robot::BuiltIn;

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
            let schema = &message.channel.schema.as_ref().unwrap().data;
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
            let value: Value = serde_json::from_slice(&message.data).unwrap();
            if message.channel.topic == "/tool" {
                assert!((value["error"].as_f64().unwrap() - 1e-5).abs() < 1e-12);
            }
            *counts.entry(message.channel.topic.clone()).or_insert(0) += 1;
        }
        for channel in &CHANNELS {
            assert_eq!(counts[channel.topic], 300, "{}", channel.topic);
        }
        assert_eq!(counts["/scene"], 15);
    }
}
