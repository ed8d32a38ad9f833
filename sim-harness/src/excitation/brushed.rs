//! An excitation on brushed motors: the voltage is the resistance's and the back-EMF's.

use super::{ExcitationError, Follower};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::io::ActuatorCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Parameters, Plant};

pub(super) fn excite(
    follower: &mut Follower<'_>,
    parameters: &Parameters,
    mismatch: &Mismatch,
    seed: u64,
) -> Result<Vec<[f64; 5]>, ExcitationError> {
    let mut plant = Plant::new(parameters, mismatch, &follower.pose, seed);
    let axes = &parameters.settings.axes;
    let zero = axes.map(|axis| f64::from(axis.current_zero_code));
    let per_code = axes.map(|axis| f64::from(axis.current_per_code));
    let mut last_current = [0.0; 2];
    for tick in 0..=follower.ticks {
        let sample = plant.sense();
        follower.see(sample.counts);
        let current = Joint::ALL.map(|joint| {
            let sign = follower.drives[joint].gear_ratio.signum();
            sign * (f64::from(sample.drives.current[joint]) - zero[joint]) * per_code[joint]
        });
        // The mean of both ends of the tick: the current that acted within it.
        let acted = Joint::ALL.map(|joint| 0.5 * (current[joint] + last_current[joint]));
        follower.log(tick, acted);
        last_current = current;
        let [torque, omega] = follower.torques(tick)?;
        let duty = Joint::ALL.map(|joint| {
            let drive = &follower.drives[joint];
            let constant = drive.torque_constant * drive.gear_ratio;
            let volts = drive.resistance * (torque[joint] / constant) + constant * omega[joint];
            (volts / follower.robot.supply.voltage).clamp(-0.95, 0.95) as f32
        });
        let command = ActuatorCommand {
            drives: BrushedCommand { duty },
            enable: [true; 2],
            brake: false,
            tool: 0,
        };
        plant.step(&command, follower.period);
    }
    Ok(std::mem::take(&mut follower.rows))
}
