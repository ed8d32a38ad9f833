//! The joints that motors drive.

use core::fmt;
use core::ops::{Index, IndexMut};

/// One of the driven joints. It is an index of an array that has a value of each, joint 1's first.
///
/// ```
/// use fivebar_kinematics::five_bar::Joint;
///
/// let angles = [0.5, 2.6]; // rad
/// assert_eq!(Joint::ALL.map(|joint| angles[joint]), angles);
/// assert_eq!(angles[Joint::Joint4.other()], 0.5);
/// assert_eq!(Joint::Joint4.to_string(), "joint 4");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Joint {
    /// At A, turning link 1.
    Joint1,
    /// At E, turning link 4.
    Joint4,
}

impl Joint {
    /// Both, in the order of an array's values.
    pub const ALL: [Self; 2] = [Self::Joint1, Self::Joint4];

    /// Its number in files, messages and drawings: 1 or 4.
    pub const fn number(self) -> u8 {
        match self {
            Self::Joint1 => 1,
            Self::Joint4 => 4,
        }
    }

    /// The joint of this number; none but 1 and 4 have a motor.
    pub const fn numbered(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::Joint1),
            4 => Some(Self::Joint4),
            _ => None,
        }
    }

    /// The position of its value in an array: 0 or 1.
    #[inline]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The other driven joint.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Joint1 => Self::Joint4,
            Self::Joint4 => Self::Joint1,
        }
    }
}

impl fmt::Display for Joint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Joint1 => "joint 1",
            Self::Joint4 => "joint 4",
        })
    }
}

impl<T> Index<Joint> for [T; 2] {
    type Output = T;

    #[inline]
    fn index(&self, joint: Joint) -> &T {
        &self[joint.index()]
    }
}

impl<T> IndexMut<Joint> for [T; 2] {
    #[inline]
    fn index_mut(&mut self, joint: Joint) -> &mut T {
        &mut self[joint.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::Joint;

    #[test]
    fn numbers_indices_and_joints_belong_together() {
        for (index, joint) in Joint::ALL.into_iter().enumerate() {
            assert_eq!(joint.index(), index);
            assert_eq!([1, 4][joint], joint.number());
            assert_eq!(Joint::numbered(joint.number()), Some(joint));
            assert_eq!(joint.other(), Joint::ALL[1 - index]);
        }
        let mut values = [0, 0];
        values[Joint::Joint4] = 1;
        assert_eq!(values, [0, 1]);
        for number in [0, 2, 3, 5] {
            assert_eq!(Joint::numbered(number), None);
        }
    }
}
