//! The arm in a 3D scene: Foxglove's message `foxglove.SceneUpdate`, in JSON.

use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Pose;
use serde_json::{Value, json};

/// Foxglove's name for the message.
pub(super) const NAME: &str = "foxglove.SceneUpdate";

/// The JSON schema of the message. Foxglove reads all of its parts: it refuses the channel if
/// an array has no `items` or an object no `properties`.
pub(super) fn schema() -> Value {
    let [number, integer, flag, text] =
        ["number", "integer", "boolean", "string"].map(|kind| json!({ "type": kind }));
    let object = |properties: Value| json!({ "type": "object", "properties": properties });
    let array = |items: &Value| json!({ "type": "array", "items": items });
    let time = object(json!({ "sec": integer, "nsec": integer }));
    let vector = object(json!({ "x": number, "y": number, "z": number }));
    let rotation = object(json!({ "x": number, "y": number, "z": number, "w": number }));
    let pose = object(json!({ "position": vector, "orientation": rotation }));
    let color = object(json!({ "r": number, "g": number, "b": number, "a": number }));
    let line = object(json!({
        "type": integer, "pose": pose, "thickness": number, "scale_invariant": flag,
        "points": array(&vector), "color": color, "colors": array(&color),
        "indices": array(&integer),
    }));
    let entity = object(json!({
        "timestamp": time, "frame_id": text, "id": text, "lifetime": time,
        "frame_locked": flag,
        "metadata": array(&object(json!({ "key": text, "value": text }))),
        "arrows": array(&object(json!({
            "pose": pose, "shaft_length": number, "shaft_diameter": number,
            "head_length": number, "head_diameter": number, "color": color,
        }))),
        "cubes": array(&object(json!({ "pose": pose, "size": vector, "color": color }))),
        "spheres": array(&object(json!({ "pose": pose, "size": vector, "color": color }))),
        "cylinders": array(&object(json!({
            "pose": pose, "size": vector, "bottom_scale": number, "top_scale": number,
            "color": color,
        }))),
        "lines": array(&line),
        "triangles": array(&object(json!({
            "pose": pose, "points": array(&vector), "color": color,
            "colors": array(&color), "indices": array(&integer),
        }))),
        "texts": array(&object(json!({
            "pose": pose, "billboard": flag, "font_size": number, "scale_invariant": flag,
            "color": color, "text": text,
        }))),
        "models": array(&object(json!({
            "pose": pose, "scale": vector, "color": color, "override_color": flag,
            "url": text, "media_type": text,
            "data": { "type": "string", "contentEncoding": "base64" },
        }))),
    }));
    let deletion = object(json!({ "timestamp": time, "type": integer, "id": text }));
    let mut schema = object(json!({
        "deletions": array(&deletion),
        "entities": array(&entity),
    }));
    schema["title"] = NAME.into();
    schema
}

/// The arm as a line strip in the plane z = 0: A, B, C, D, E.
pub(super) fn scene(robot: &Robot, pose: &Pose<f64>, time: f64) -> Value {
    let e = robot.geometry.e();
    let points = [
        [0.0, 0.0],
        [pose.b.x, pose.b.y],
        [pose.c.x, pose.c.y],
        [pose.d.x, pose.d.y],
        [e.x, e.y],
    ];
    let points: Vec<Value> = points
        .iter()
        .map(|[x, y]| json!({"x": x, "y": y, "z": 0.0}))
        .collect();
    let nanoseconds = (time * 1e9).round() as u64;
    json!({
        "deletions": [],
        "entities": [{
            "timestamp": { "sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000 },
            "frame_id": "base",
            "id": "arm",
            "lifetime": { "sec": 0, "nsec": 0 },
            "frame_locked": false,
            "metadata": [],
            "arrows": [], "cubes": [], "spheres": [], "cylinders": [],
            "triangles": [], "texts": [], "models": [],
            "lines": [{
                "type": 0,
                "pose": {
                    "position": { "x": 0.0, "y": 0.0, "z": 0.0 },
                    "orientation": { "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0 },
                },
                "thickness": 0.006,
                "scale_invariant": false,
                "points": points,
                "color": { "r": 0.2, "g": 0.45, "b": 0.8, "a": 1.0 },
                "colors": [],
                "indices": [],
            }],
        }],
    })
}
