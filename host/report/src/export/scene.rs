//! The arm in a 3D scene, as RViz and Foxglove show it: a line through its joints, the message `visualization_msgs/Marker`.

use super::mcap::{HEADER, header};
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Pose;
use serde::Serialize;

/// The name of the message.
pub(super) const NAME: &str = "visualization_msgs/msg/Marker";

const LINE_STRIP: i32 = 4;
const ADD: i32 = 0;
/// [m]
const THICKNESS: f64 = 0.006;
/// Red, green, blue and opacity.
const COLOUR: [f32; 4] = [0.2, 0.45, 0.8, 1.0];

/// The definition of the message, and of those in it.
pub(super) fn definition() -> String {
    const MARKER: &str = "\
std_msgs/Header header
string ns
int32 id
int32 type
int32 action
geometry_msgs/Pose pose
geometry_msgs/Vector3 scale
std_msgs/ColorRGBA color
builtin_interfaces/Duration lifetime
bool frame_locked
geometry_msgs/Point[] points
std_msgs/ColorRGBA[] colors
string texture_resource
sensor_msgs/CompressedImage texture
visualization_msgs/UVCoordinate[] uv_coordinates
string text
string mesh_resource
visualization_msgs/MeshFile mesh_file
bool mesh_use_embedded_materials
";
    const PARTS: [(&str, &str); 9] = [
        (
            "geometry_msgs/Pose",
            "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        ),
        ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
        ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
        (
            "geometry_msgs/Quaternion",
            "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
        ),
        (
            "std_msgs/ColorRGBA",
            "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
        ),
        ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
        (
            "sensor_msgs/CompressedImage",
            "std_msgs/Header header\nstring format\nuint8[] data\n",
        ),
        ("visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"),
        (
            "visualization_msgs/MeshFile",
            "string filename\nuint8[] data\n",
        ),
    ];
    let line = "=".repeat(80);
    let part = |(name, fields): &(&str, &str)| format!("{line}\nMSG: {name}\n{fields}");
    let parts: String = PARTS.iter().map(part).collect();
    format!("{MARKER}{HEADER}{parts}")
}

/// The arm in the plane z = 0: A, B, C, D, E.
pub(super) fn scene(robot: &Robot, pose: &Pose<f64>, time: f64) -> impl Serialize {
    let e = robot.geometry.e();
    let points: Vec<[f64; 3]> = [
        [0.0, 0.0],
        [pose.b.x, pose.b.y],
        [pose.c.x, pose.c.y],
        [pose.d.x, pose.d.y],
        [e.x, e.y],
    ]
    .map(|[x, y]| [x, y, 0.0])
    .into();
    let (nothing, no_bytes) = ("", Vec::<u8>::new());
    let place = ([0.0_f64; 3], [0.0, 0.0, 0.0, 1.0_f64]);
    let marker = (
        header(time),
        ("arm", 0_i32, LINE_STRIP, ADD),
        place,
        // Of a line only the first counts.
        [THICKNESS, 0.0, 0.0],
        COLOUR,
        // It lasts until the next one.
        (0_i32, 0_u32),
        false,
    );
    let texture = (
        nothing,
        (header(time), nothing, no_bytes.clone()),
        Vec::<[f32; 2]>::new(),
    );
    let mesh = (nothing, nothing, (nothing, no_bytes), false);
    (marker, (points, Vec::<[f32; 4]>::new()), texture, mesh)
}
