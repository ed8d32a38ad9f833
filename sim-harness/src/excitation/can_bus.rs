//! An excitation on drives on a bus: they are told torques, and make no spring, whose torque would not be in the log.

use super::{ExcitationError, Follower};
use fivebar_firmware::drives::TorqueSetPoint;
use fivebar_firmware::drives::can::{Frames, Link, Protocol, odrive};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{CanDrive, CanPlant, Mismatch, Parameters};

/// Ticks before the motion in which the drives start, at rest under the brakes.
const START: u32 = 60;
/// By this share the amplitude shrinks while the log lasts. In the same motion again and again, encoders of few counts err at
/// the same places, and ten periods would tell no more than one.
const SHRINKS: f64 = 0.05;
/// By this share the drives' clocks are slower than the controller's: crystals differ by as much.
const SLOWER: f64 = 1e-4;
/// The one of the first ticks in which drives that keep their gains get none.
const LIMP: u32 = 10;

pub(super) fn excite(
    follower: &mut Follower<'_>,
    parameters: &Parameters,
    bus: (Protocol, [CanDrive; 2]),
    mismatch: &Mismatch,
    seed: u64,
) -> Result<Vec<[f64; 5]>, ExcitationError> {
    let (protocol, drives) = bus;
    let nodes = drives.map(|drive| drive.node);
    let settings = parameters.settings.check()?;
    let logged = follower.ticks - follower.lead_in;
    follower.change = -SHRINKS / (f64::from(logged) * follower.period);
    let mut link = Link::new(protocol, nodes, &settings);
    let mut plant = CanPlant::new(parameters, bus, mismatch, &follower.pose, seed);
    plant.slow_down(SLOWER);
    let most = drives.map(|drive| drive.peak_torque * drive.gear_ratio.abs());
    for tick in 0..=START + follower.ticks {
        for frame in plant.take_received() {
            link.receive(&frame);
        }
        let (counts, _) = link.sample(plant.is_bus_off());
        let mut torque = [0.0; 2];
        if let Some(tick) = tick.checked_sub(START) {
            follower.see(counts);
            let [wanted, _] = follower.torques(tick)?;
            torque = Joint::ALL.map(|joint| wanted[joint].clamp(-most[joint], most[joint]) as f32);
            follower.log(tick, torque.map(f64::from));
        }
        let set_point = TorqueSetPoint {
            torque,
            ..TorqueSetPoint::default()
        };
        let mut sent = Frames::new();
        link.send([true; 2], &set_point, &mut sent);
        let mut frames = sent.to_vec();
        if tick == LIMP && protocol == Protocol::Odrive {
            frames.extend(nodes.map(|node| odrive::set_velocity_gain(node, 0.0)));
        }
        plant.step(&frames, tick < START, 0, follower.period);
    }
    Ok(std::mem::take(&mut follower.rows))
}
