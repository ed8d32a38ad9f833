//! Frames against those of other encoders; tests/data/README.md says which.

use fivebar_firmware::drives::can::mit::{Command, Ranges, Reply};
use fivebar_firmware::drives::can::odrive::{self, Message};
use fivebar_firmware::drives::can::{Frame, Payload};
use serde_json::Value;

fn vectors() -> Value {
    let text = include_str!("../../data/can_frames.json");
    serde_json::from_str(text).expect("JSON")
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().expect("a list")
}

fn numbers<const N: usize>(value: &Value, key: &str) -> [f32; N] {
    let numbers = list(value, key)
        .iter()
        .map(|it| it.as_f64().expect("a number") as f32);
    numbers.collect::<Vec<f32>>().try_into().expect("as many")
}

fn data(value: &Value) -> Payload {
    let text = value["data"].as_str().expect("hexadecimal digits");
    std::array::from_fn(|i| u8::from_str_radix(&text[2 * i..2 * i + 2], 16).expect("a byte"))
}

#[test]
fn can_simple_frames_are_those_of_odrives_own_description() {
    let vectors = vectors();
    let mut seen = [0; 7];
    for vector in list(&vectors, "odrive") {
        let signal = |name: &str| vector["signals"][name].as_f64().expect("a number") as f32;
        let node = vector["node"].as_u64().expect("a node") as u8;
        let frame = Frame::new(
            vector["id"].as_u64().expect("an identifier") as u16,
            data(vector),
        );
        let told = Message::decode(&frame);
        let kind = match vector["name"].as_str().expect("a name") {
            "Set_Input_Pos" => {
                let inputs = ["Input_Pos", "Vel_FF", "Torque_FF"].map(signal);
                let [position, velocity, torque] = inputs;
                assert_eq!(odrive::set_input(node, position, velocity, torque), frame);
                0
            }
            "Set_Pos_Gain" => {
                assert_eq!(odrive::set_position_gain(node, signal("Pos_Gain")), frame);
                5
            }
            "Set_Vel_Gains" => {
                assert_eq!(odrive::set_velocity_gain(node, signal("Vel_Gain")), frame);
                6
            }
            "Set_Axis_State" => {
                let state = signal("Axis_Requested_State") as u8;
                assert_eq!(odrive::set_axis_state(node, state), frame);
                1
            }
            "Set_Controller_Mode" => {
                assert_eq!(odrive::set_mode(node), frame);
                2
            }
            "Get_Encoder_Estimates" => {
                let position = signal("Pos_Estimate");
                let velocity = signal("Vel_Estimate");
                assert_eq!(
                    told,
                    Some((node, Message::Estimates { position, velocity }))
                );
                assert_eq!(odrive::ask_for_estimates(node).id, frame.id);
                3
            }
            "Heartbeat" => {
                let error = vector["signals"]["Axis_Error"].as_u64().expect("flags") as u32;
                let state = signal("Axis_State") as u8;
                assert_eq!(told, Some((node, Message::Heartbeat { error, state })));
                4
            }
            other => panic!("{other}"),
        };
        seen[kind] += 1;
    }
    assert!(seen.iter().all(|&count| count >= 3), "{seen:?}");
}

#[test]
fn mit_type_frames_are_those_of_two_other_encoders() {
    let vectors = vectors();
    for vector in list(&vectors["mit"], "commands") {
        let [position, velocity, torque] = numbers(vector, "ranges");
        let ranges = Ranges {
            position,
            velocity,
            torque,
        };
        let [position, velocity, stiffness, damping, torque] = numbers(vector, "values");
        let command = Command {
            position,
            velocity,
            stiffness,
            damping,
            torque,
        };
        assert_eq!(command.encode(&ranges), data(vector), "{command:?}");
    }
    for vector in list(&vectors["mit"], "replies") {
        let [position, velocity, torque] = numbers(vector, "ranges");
        let ranges = Ranges {
            position,
            velocity,
            torque,
        };
        let reply = Reply::decode(&data(vector), &ranges);
        let wanted: [f32; 3] = numbers(vector, "values");
        let told = [reply.position, reply.velocity, reply.torque];
        for (told, wanted) in told.into_iter().zip(wanted) {
            assert!((told - wanted).abs() < 1e-5, "{told} for {wanted}");
        }
        let state = vector["state"].as_u64().expect("a state");
        assert_eq!(
            u64::from(reply.node),
            vector["id"].as_u64().expect("an identifier")
        );
        assert_eq!(
            (reply.is_enabled(), reply.is_error()),
            (state == 1, state >= 8)
        );
    }
}

#[test]
fn what_is_beyond_a_range_is_limited_and_what_is_no_number_pushes_least() {
    let ranges = Ranges {
        position: 12.5,
        velocity: 30.0,
        torque: 10.0,
    };
    let torque = |torque: f32| {
        let data = Command {
            torque,
            ..Command::default()
        }
        .encode(&ranges);
        u16::from_be_bytes([data[6] & 0xF, data[7]])
    };
    assert_eq!([torque(-99.0), torque(99.0), torque(10.0)], [0, 4095, 4095]);
}
