//! Which drives are on the bus: where the settings of an arm say it.
//!
//! A drive on a bus has no converter, no model of its heat and no index output, so their numbers in
//! [`AxisSettings`](crate::settings::AxisSettings) say what its frames need. No other settings are longer for that.
//!
//! | number of an axis | with a drive on a bus |
//! |---|---|
//! | `current_zero_code` | 1024 and the node with ODrive, 3072 and the node with MIT-type drives |
//! | `current_per_code` | the greatest torque of a command [N·m] |
//! | `thermal_time_constant` | of MIT-type drives: the greatest velocity of their frames [rad/s] |
//! | `index_counts` | of MIT-type drives: the greatest position of their frames [µrad] |

use super::{Frame, Protocol, mit, odrive};
use crate::settings::{BusKind, Settings};

/// [1/µrad].
const MICRORADIANS: f32 = 1e6;

/// What the drives of joint 1 and joint 4 speak, and their nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusSetup {
    /// Of both.
    pub protocol: Protocol,
    /// Of each.
    pub nodes: [u8; 2],
}

impl BusSetup {
    /// What these settings say; none where their drives are on no bus, or cannot share one.
    pub fn of(settings: &Settings) -> Option<Self> {
        let (kind, nodes) = settings.bus_drives()?;
        let [axis, _] = &settings.axes;
        let protocol = match kind {
            BusKind::Odrive => Protocol::Odrive,
            BusKind::Mit => Protocol::Mit(mit::Ranges {
                position: axis.index_counts as f32 / MICRORADIANS,
                velocity: axis.thermal_time_constant,
                torque: axis.current_per_code,
            }),
        };
        Some(Self { protocol, nodes })
    }

    /// Writes it into the settings.
    pub fn put(&self, settings: &mut Settings) {
        for (axis, node) in settings.axes.iter_mut().zip(self.nodes) {
            let kind = match &self.protocol {
                Protocol::Odrive => {
                    axis.current_per_code = odrive::MOST_INPUT;
                    BusKind::Odrive
                }
                Protocol::Mit(ranges) => {
                    axis.current_per_code = ranges.torque;
                    axis.thermal_time_constant = ranges.velocity;
                    // `as` saturates.
                    axis.index_counts = (ranges.position * MICRORADIANS + 0.5) as u32;
                    BusKind::Mit
                }
            };
            axis.current_zero_code = kind.code(node);
        }
    }

    /// The identifiers of the frames that are taken from each drive.
    pub fn answers(&self) -> [[u16; 2]; 2] {
        match self.protocol {
            Protocol::Odrive => self.nodes.map(odrive::answers),
            Protocol::Mit(_) => [[mit::ANSWER; 2]; 2],
        }
    }

    /// The frames after which the drives give no torque.
    pub fn stops(&self) -> [Frame; 2] {
        self.nodes.map(|node| match self.protocol {
            Protocol::Odrive => odrive::set_axis_state(node, odrive::IDLE),
            Protocol::Mit(_) => mit::enable(node, false),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODRIVE: u16 = BusKind::Odrive.code(0);
    const MIT: u16 = BusKind::Mit.code(0);

    const RANGES: [mit::Ranges; 3] = [
        mit::Ranges {
            position: 12.5,
            velocity: 45.0,
            torque: 18.0,
        },
        mit::Ranges {
            position: 12.566,
            velocity: 0.25,
            torque: 0.7,
        },
        mit::Ranges {
            position: 95.5,
            velocity: 640.0,
            torque: 144.0,
        },
    ];

    #[test]
    fn settings_say_what_was_written_into_them_and_stay_valid() {
        let protocols = RANGES.map(Protocol::Mit).into_iter();
        for protocol in protocols.chain([Protocol::Odrive]) {
            for nodes in [[0, 1], [15, 0], [3, 14]] {
                let setup = BusSetup { protocol, nodes };
                let mut settings = Settings::BENCHTOP;
                setup.put(&mut settings);
                assert_eq!(BusSetup::of(&settings), Some(setup));
                assert!(settings.check().is_ok(), "{setup:?}");
            }
        }
    }

    #[test]
    fn settings_of_other_arms_and_of_drives_that_cannot_share_a_bus_say_none() {
        assert_eq!(BusSetup::of(&Settings::BENCHTOP), None);
        let odrives = [ODRIVE + 1, ODRIVE + 2];
        for (codes, are_drives) in [
            (odrives, true),
            ([ODRIVE + 1, ODRIVE + 1], false),
            ([ODRIVE + 1, MIT + 2], false),
            ([ODRIVE + 64, ODRIVE + 1], false),
            ([MIT + 15, MIT], true),
            ([MIT + 16, MIT], false),
            ([MIT + 1, ODRIVE + 2], false),
            ([0, 1], false),
        ] {
            let mut settings = Settings::BENCHTOP;
            for (axis, code) in settings.axes.iter_mut().zip(codes) {
                axis.current_zero_code = code;
            }
            assert_eq!(BusSetup::of(&settings).is_some(), are_drives, "{codes:?}");
        }
    }
}
