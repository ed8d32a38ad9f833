//! The drives on a CAN bus that settings name: by the code that is a converter's zero with brushed motors.

use super::{AxisSettings, Settings};

/// Codes of one kind.
const CODES: u16 = 1024;

/// What drives on a bus speak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusKind {
    /// CANSimple of ODrive.
    Odrive,
    /// The protocol of the MIT Mini Cheetah's drives.
    Mit,
}

impl BusKind {
    /// The greatest node.
    pub const fn most_node(self) -> u8 {
        match self {
            Self::Odrive => 63,
            // The upper half of an answer's first byte is the drive's state.
            Self::Mit => 15,
        }
    }

    /// The code of node 0: far from 2048, that of a converter's zero, and from the ends of its range.
    const fn first_code(self) -> u16 {
        match self {
            Self::Odrive => 1024,
            Self::Mit => 3072,
        }
    }

    /// The code of an axis whose drive has this node.
    pub const fn code(self, node: u8) -> u16 {
        self.first_code() + node as u16
    }

    /// The kind and the node of an axis; none if its drive is on no bus.
    fn of(axis: &AxisSettings) -> Option<(Self, u8)> {
        let code = axis.current_zero_code;
        let kind = match code / CODES {
            1 => Self::Odrive,
            3 => Self::Mit,
            _ => return None,
        };
        let node = code - kind.first_code();
        (node <= kind.most_node().into()).then_some((kind, node as u8))
    }
}

impl Settings {
    /// The kind of the drives on a bus, and the nodes of joint 1 and joint 4; none if they are on no bus, or cannot share one.
    pub fn bus_drives(&self) -> Option<(BusKind, [u8; 2])> {
        let [axis1, axis4] = &self.axes;
        let ((kind, node1), (other, node4)) = (BusKind::of(axis1)?, BusKind::of(axis4)?);
        (kind == other && node1 != node4).then_some((kind, [node1, node4]))
    }
}
