//! How the plant differs from the controller's model.

use crate::encoder::Harmonics;
use crate::mismatch_error::{Bound, MismatchError};
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::pulley::Pulley;
use crate::transmission::{Spring, Transmission};
use fivebar_kinematics::five_bar::{Geometry, Joint};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Differences between the simulated arm and the controller's model of it. Pairs are of joint 1
/// and joint 4; angles and torques are at the joint. With a value of 0 an effect is off.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mismatch {
    /// Excess of the links' masses and inertias, as a share: 0.1 is 10 % more.
    pub link_mass: f64,
    /// Excess of the joints' friction, as a share.
    pub friction: f64,
    /// Excess of the payload at C [kg].
    pub payload: f64,
    /// Standard deviation of the current samples [ADC codes].
    pub current_noise: f64,
    /// Error of the current sensors' zero [ADC codes].
    pub current_offset: f64,
    /// Excess of the lengths l1…l4 [m].
    pub link_length: [f64; 4],
    /// Excess of the distance from A to E [m].
    pub base_length: f64,
    /// Excess of the angles at which the home switches close [rad].
    pub home_error: [f64; 2],
    /// Excess of the torque constants, as a share.
    pub torque_constant: [f64; 2],
    /// Amplitude of the torque constants' ripple, as a share, with the periods per motor turn of
    /// [`RipplePeriods`](crate::RipplePeriods).
    pub torque_ripple: [f64; 2],
    /// Amplitude of the cogging torques [N·m], with the periods of
    /// [`RipplePeriods`](crate::RipplePeriods).
    pub cogging: [f64; 2],
    /// Stiffness of the drives [N·m/rad], in place of the known one; none: as known.
    pub stiffness: Option<[f64; 2]>,
    /// Damping of the drives [N·m·s/rad], in place of the known one; 0: as known.
    pub drive_damping: [f64; 2],
    /// Backlash of the drives, the full gap [rad].
    pub backlash: [f64; 2],
    /// Amplitude of the joints' error by the eccentricity of the small pulleys [rad], once a motor
    /// turn: the eccentricity over the radius of the pulley at the joint.
    pub pulley_run_out: [f64; 2],
    /// Amplitude of the joints' error by the teeth of the small pulleys [rad],
    /// [`PULLEY_TEETH`](crate::PULLEY_TEETH) times a motor turn.
    pub tooth_mesh: [f64; 2],
    /// Excess of the friction at rest over the Coulomb friction, as a share of it. Above 0,
    /// friction holds the joint at rest.
    pub stiction: [f64; 2],
    /// Errors of the encoders, besides the known ones.
    pub encoder_error: [Harmonics; 2],
    /// Latency of the encoders [s], besides the known one.
    pub encoder_latency: [f64; 2],
    /// Resistance of the supply and its leads [Ω].
    pub supply_resistance: f64,
    /// Force by which a pen that is down is held back while it slides on the paper [N].
    pub pen_friction: f64,
    /// Growth of the paper in x and y after it was drawn on, as a share. It moves what is drawn,
    /// not the arm.
    pub paper_growth: [f64; 2],
}

/// Lengths per greatest change of a length.
const LENGTHS_PER_CHANGE: f64 = 10.0;
/// Greatest natural frequency of a rotor on its drive's stiffness [rad/s]: 20 kHz.
const HIGHEST_RESONANCE: f64 = TAU * 20e3;

impl Mismatch {
    /// No mismatch, and perfect current sensors. Encoder counts are still quantised, and the
    /// outputs still act one tick later.
    pub const NONE: Self = Self {
        link_mass: 0.0,
        friction: 0.0,
        payload: 0.0,
        current_noise: 0.0,
        current_offset: 0.0,
        link_length: [0.0; 4],
        base_length: 0.0,
        home_error: [0.0; 2],
        torque_constant: [0.0; 2],
        torque_ripple: [0.0; 2],
        cogging: [0.0; 2],
        stiffness: None,
        drive_damping: [0.0; 2],
        backlash: [0.0; 2],
        pulley_run_out: [0.0; 2],
        tooth_mesh: [0.0; 2],
        stiction: [0.0; 2],
        encoder_error: [Harmonics::NONE; 2],
        encoder_latency: [0.0; 2],
        supply_resistance: 0.0,
        pen_friction: 0.0,
        paper_growth: [0.0; 2],
    };

    /// Checks the values.
    ///
    /// # Errors
    /// The first value that is not valid.
    pub fn check(&self) -> Result<(), MismatchError> {
        use Bound::{AtLeast, Within};
        for (name, values, bound) in [
            // −1 would be a link without mass.
            ("link_mass", &[self.link_mass][..], AtLeast(-0.99)),
            ("friction", &[self.friction], AtLeast(-1.0)),
            ("payload", &[self.payload], AtLeast(0.0)),
            ("current_noise", &[self.current_noise], AtLeast(0.0)),
            ("current_offset", &[self.current_offset], AtLeast(-2048.0)),
            ("link_length", &self.link_length, Bound::Finite),
            ("base_length", &[self.base_length], Bound::Finite),
            ("home_error", &self.home_error, Within(-0.1, 0.1, "rad")),
            ("torque_constant", &self.torque_constant, AtLeast(-0.9)),
            ("torque_ripple", &self.torque_ripple, Within(0.0, 0.9, "")),
            ("cogging", &self.cogging, AtLeast(0.0)),
            (
                "stiffness",
                self.stiffness.as_ref().map_or(&[], |both| &both[..]),
                Bound::Stiffness,
            ),
            ("drive_damping", &self.drive_damping, AtLeast(0.0)),
            ("backlash", &self.backlash, Within(0.0, 0.1, "rad")),
            ("pulley_run_out", &self.pulley_run_out, AtLeast(0.0)),
            ("tooth_mesh", &self.tooth_mesh, AtLeast(0.0)),
            ("stiction", &self.stiction, Within(0.0, 10.0, "")),
            (
                "encoder_latency",
                &self.encoder_latency,
                Within(0.0, 0.1, "s"),
            ),
            (
                "supply_resistance",
                &[self.supply_resistance],
                Within(0.0, 100.0, "Ω"),
            ),
            ("pen_friction", &[self.pen_friction], Within(0.0, 10.0, "N")),
            ("paper_growth", &self.paper_growth, Within(-0.05, 0.05, "")),
        ] {
            for &value in values {
                bound.check(name, value)?;
            }
        }
        for error in &self.encoder_error {
            check_harmonics("encoder_error", error)?;
        }
        Ok(())
    }

    /// Checks the values against the arm that they change, after [`Mismatch::check`].
    ///
    /// # Errors
    /// The first value that does not fit the arm.
    pub fn check_for(&self, parameters: &Parameters) -> Result<(), MismatchError> {
        let lengths = parameters.arm.geometry().lengths();
        let [l1, l2, l3, l4, _] = lengths;
        let links = self.link_length.into_iter().zip([l1, l2, l3, l4]);
        let changes = links.map(|(change, length)| ("link_length", change, length));
        let base = ("base_length", self.base_length, lengths[4]);
        for (name, change, length) in changes.chain([base]) {
            let most = length / LENGTHS_PER_CHANGE;
            Bound::Within(-most, most, "m").check(name, change)?;
        }
        if Geometry::new(self.lengths(lengths)).is_err() {
            let [change, ..] = self.link_length;
            return Err(Bound::Assembly.broken_by("link_length", change));
        }
        for joint in Joint::ALL {
            let transmission = self.transmission(parameters, joint);
            let motor = &parameters.motors[joint];
            self.check_drive(&transmission, motor, joint)?;
            let known = parameters.encoders[joint].error.steepest();
            let added = self.encoder_error[joint].steepest();
            Bound::Monotonic.check("encoder_error", known + added)?;
        }
        Ok(())
    }

    fn check_drive(
        &self,
        transmission: &Transmission,
        motor: &Motor,
        joint: Joint,
    ) -> Result<(), MismatchError> {
        let backlash = self.backlash[joint];
        let damping = self.drive_damping[joint];
        let most = Pulley::most(motor.gear_ratio);
        let uneven = [
            ("pulley_run_out", self.pulley_run_out[joint], most[0]),
            ("tooth_mesh", self.tooth_mesh[joint], most[1]),
        ];
        for (name, amplitude, most) in uneven {
            Bound::Within(0.0, most, "rad").check(name, amplitude)?;
        }
        if damping > 0.0 && motor.rotor_inertia > 0.0 {
            Bound::Within(0.0, motor.most_drive_damping(), "N·m·s/rad")
                .check("drive_damping", damping)?;
        }
        let Some(stiffness) = transmission.stiffness else {
            let mut flanks = uneven
                .map(|(name, amplitude, _)| (name, amplitude))
                .to_vec();
            flanks.push(("backlash", backlash));
            flanks.retain(|&(_, value)| value > 0.0);
            if let (Some(&(name, value)), true) = (flanks.first(), motor.rotor_inertia <= 0.0) {
                return Err(Bound::NoRotor.broken_by(name, value));
            }
            if flanks.is_empty() && damping > 0.0 {
                return Err(Bound::NoSpring.broken_by("drive_damping", damping));
            }
            return Ok(());
        };
        // Known values that are not valid are refused where they are known from.
        let Some(given) = self.stiffness else {
            return Ok(());
        };
        if motor.rotor_inertia <= 0.0 {
            return Err(Bound::NoRotor.broken_by("stiffness", given[joint]));
        }
        let stiffest = motor.stiffest_drive();
        if stiffness > stiffest {
            return Err(Bound::TooStiff(stiffest).broken_by("stiffness", stiffness));
        }
        Ok(())
    }

    /// The lengths l1…l4 and the base with this mismatch [m].
    pub(crate) fn lengths(&self, [l1, l2, l3, l4, base]: [f64; 5]) -> [f64; 5] {
        let [d1, d2, d3, d4] = self.link_length;
        [l1 + d1, l2 + d2, l3 + d3, l4 + d4, base + self.base_length]
    }

    /// The transmission of a drive, with this mismatch.
    pub fn transmission(&self, parameters: &Parameters, joint: Joint) -> Transmission {
        let known = parameters.transmissions[joint];
        let damping = self.drive_damping[joint];
        Transmission {
            stiffness: self.stiffness.map(|both| both[joint]).or(known.stiffness),
            damping: if damping > 0.0 {
                damping
            } else {
                known.damping
            },
        }
    }
}

impl Mismatch {
    /// The errors of a drive's pulley; none without any.
    pub(crate) fn pulley(&self, gear_ratio: f64, joint: Joint) -> Option<Pulley> {
        let amplitudes = [self.pulley_run_out[joint], self.tooth_mesh[joint]];
        Pulley::new(gear_ratio, amplitudes)
    }

    /// The spring of a drive, with this mismatch; none if it is rigid.
    pub(crate) fn spring(&self, parameters: &Parameters, joint: Joint) -> Option<Spring> {
        let transmission = self.transmission(parameters, joint);
        Spring::new(
            &transmission,
            self.backlash[joint],
            self.pulley(1.0, joint).is_some(),
            &parameters.motors[joint],
        )
    }
}

/// Checks the harmonics of an encoder under this key.
///
/// # Errors
/// The first value that is not valid.
pub fn check_harmonics(name: &'static str, error: &Harmonics) -> Result<(), MismatchError> {
    for term in error.terms() {
        if term.harmonic == 0 {
            return Err(Bound::Harmonic.broken_by(name, 0.0));
        }
        for value in [term.amplitude, term.phase] {
            Bound::Finite.check(name, value)?;
        }
    }
    Bound::Monotonic.check(name, error.steepest())
}

impl Motor {
    /// The greatest stiffness of this motor's drive that can be simulated [N·m/rad]: with it
    /// the rotor's natural frequency is 20 kHz.
    pub fn stiffest_drive(&self) -> f64 {
        self.reflected_inertia() * HIGHEST_RESONANCE * HIGHEST_RESONANCE
    }

    /// The greatest damping of this motor's drive that can be simulated [N·m·s/rad]: the
    /// critical damping at 20 kHz.
    pub fn most_drive_damping(&self) -> f64 {
        2.0 * self.reflected_inertia() * HIGHEST_RESONANCE
    }
}

impl Default for Mismatch {
    /// The declared mismatch. All stated figures of accuracy are under this mismatch.
    fn default() -> Self {
        Self {
            link_mass: 0.1,
            friction: 0.3,
            payload: 0.02,
            current_noise: 2.0,
            current_offset: 2.0,
            ..Self::NONE
        }
    }
}
