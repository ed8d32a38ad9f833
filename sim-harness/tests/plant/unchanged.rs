//! The ideal arm's motion is the same, bit for bit, as before drives and sensors could be other
//! than ideal. The controller has no part in it, so that its changes leave these figures alone.

use fivebar_files::robot::Robot;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_plant::{Mismatch, Plant, State};

const TICK: f64 = 1e-4;

/// FNV-1a over 64-bit words.
struct Digest(u64);

impl Digest {
    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn add_all(&mut self, state: &State, sample: &SensorSample) {
        for part in state.q.iter().chain(&state.v) {
            for value in [part.linear.x, part.linear.y, part.angular] {
                self.add(value.to_bits());
            }
        }
        for joint in 0..2 {
            self.add(state.current[joint].to_bits());
            self.add(u64::from(sample.counts[joint] as u32));
            self.add(u64::from(sample.drives.current[joint]) << 1 | u64::from(sample.home[joint]));
        }
        self.add(sample.drives.bus_voltage.into());
    }
}

/// The digest of 0.3 s under a square wave of both duties.
fn digest(robot: &str, mismatch: &Mismatch) -> u64 {
    let robot = Robot::load(robot).unwrap();
    let parameters = robot.plant_parameters().unwrap();
    let mut plant = Plant::new(&parameters, mismatch, &robot.home_pose().unwrap(), 7);
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    for tick in 0..3000 {
        let sign = if tick / 250 % 2 == 0 { 1.0 } else { -1.0 };
        let command = ActuatorCommand {
            drives: BrushedCommand {
                duty: [-0.06 * sign, 0.04 * sign],
            },
            enable: [tick < 2800; 2],
            brake: tick < 20,
            tool: 0,
        };
        plant.step(&command, TICK);
        let sample = plant.sense();
        digest.add_all(plant.state(), &sample);
    }
    digest.0
}

#[test]
fn without_new_effects_the_motion_is_bit_for_bit_as_it_was() {
    for (robot, declared, none) in [
        ("benchtop", 0x6139_02d1_3171_f5fe, 0xb0b1_292e_9777_8f88),
        ("usp_2dof", 0x155b_2544_e200_9a96, 0x83f7_0a56_0486_7e12),
        ("air_hockey", 0xebc7_0547_11c0_9a32, 0x12f7_c45a_65a7_f52a),
    ] {
        for (mismatch, expected) in [(Mismatch::default(), declared), (Mismatch::NONE, none)] {
            let found = digest(robot, &mismatch);
            assert_eq!(found, expected, "{robot}: {found:#018x}, {mismatch:?}");
        }
    }
}
