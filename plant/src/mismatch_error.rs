//! Why a mismatch is refused.

use std::fmt;

/// What a value of a mismatch must be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bound {
    /// Finite.
    Finite,
    /// Finite and at least this.
    AtLeast(f64),
    /// From the first to the second value, in this unit.
    Within(f64, f64, &'static str),
    /// A stiffness: positive and finite.
    Stiffness,
    /// A stiffness that can be simulated: at most this [N·m/rad].
    TooStiff(f64),
    /// Backlash and stiffness need a rotor with inertia on the motor's side.
    NoRotor,
    /// Damping needs a stiffness or backlash beside it.
    NoSpring,
    /// The changed lengths must still be those of an arm.
    Assembly,
    /// The number of a harmonic, from 1.
    Harmonic,
    /// The sum of |harmonic · amplitude|, below 1.
    Monotonic,
}

/// A value of a mismatch that is not valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MismatchError {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub bound: Bound,
}

impl Bound {
    /// Checks a value against this bound.
    ///
    /// # Errors
    /// The value breaks it. The bounds without a value always fail.
    pub fn check(self, name: &'static str, value: f64) -> Result<(), MismatchError> {
        let holds = match self {
            Self::Finite => value.is_finite(),
            Self::AtLeast(least) => value >= least && value.is_finite(),
            Self::Within(least, most, _) => (least..=most).contains(&value),
            Self::Stiffness => value > 0.0 && value.is_finite(),
            Self::TooStiff(most) => value <= most,
            Self::Monotonic => value < 1.0,
            Self::NoRotor | Self::NoSpring | Self::Assembly | Self::Harmonic => false,
        };
        if holds {
            Ok(())
        } else {
            Err(self.broken_by(name, value))
        }
    }

    /// The error of this value.
    pub fn broken_by(self, name: &'static str, value: f64) -> MismatchError {
        MismatchError {
            name,
            value,
            bound: self,
        }
    }
}

impl fmt::Display for MismatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.value;
        match self.bound {
            Bound::Finite => write!(f, "must be finite, not {value:?}"),
            Bound::AtLeast(least) => {
                write!(f, "must be finite and at least {least}, not {value:?}")
            }
            Bound::Within(least, most, "") => {
                write!(f, "must be {least} to {most}, not {value:?}")
            }
            Bound::Within(least, most, unit) => {
                write!(f, "must be {least} to {most} {unit}, not {value:?}")
            }
            Bound::Stiffness => write!(
                f,
                "must be positive and finite [N·m/rad], not {value:?}; leave it out for a rigid \
                 drive, or for the one of the robot file"
            ),
            Bound::TooStiff(most) => write!(
                f,
                "must be at most {most:.3e} N·m/rad, which puts the rotor's resonance at 20 kHz, \
                 not {value:?}; leave it out for a rigid drive"
            ),
            Bound::NoRotor => f.write_str(
                "needs a rotor on the motor's side: give each [[actuator]] a `rotor_inertia` \
                 above 0, or leave this key out",
            ),
            Bound::NoSpring => {
                f.write_str("needs a spring beside it: give a `stiffness`, or leave this key out")
            }
            Bound::Assembly => f.write_str(
                "and `base_length` leave lengths that cannot be assembled: make them smaller",
            ),
            Bound::Harmonic => f.write_str("must have a `harmonic` of 1 or more, not 0"),
            Bound::Monotonic => write!(
                f,
                "must have a sum of |harmonic · amplitude| below 1, or the measured angle turns \
                 back where the shaft turns on; it is {value:?}: make the amplitudes smaller"
            ),
        }
    }
}

impl std::error::Error for MismatchError {}
