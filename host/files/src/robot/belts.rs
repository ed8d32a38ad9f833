//! The loops of joints behind belts, which follow from the arm.

use super::newest::Newest;
use super::sections::ControlFile;
use super::value::single;
use super::{Actuator, Robot};
use fivebar_design::servo::{BeltJoint, BeltTuning, CURRENTS, tune_belt};
use fivebar_firmware::settings::BeltSettings;
use fivebar_kinematics::control::Belt;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::EncoderSide;
use nalgebra::{Matrix2, SymmetricEigen};
use std::f64::consts::TAU;

/// Factors on the links' inertia for which the loops keep a margin.
pub(super) const INERTIA_RANGE: [f64; 2] = [0.8, 1.3];
/// Factors on the payload for which they keep it besides.
pub(super) const PAYLOAD_RANGE: [f64; 2] = [0.0, 2.0];

impl ControlFile {
    /// The loops of joints behind belts; none for rigid drives and other than brushed motors, where the file gives bandwidths, and where no
    /// loop with the margins was found.
    pub(super) fn belts(&self, robot: &Robot) -> Option<[BeltTuning; 2]> {
        if self.gives_bandwidths() || robot.brushed().is_err() {
            return None;
        }
        let drives = robot.drives().ok()?;
        let is_belt = |drive: &Actuator| drive.stiffness.is_some() && drive.rotor_inertia > 0.0;
        if !drives.iter().all(is_belt) {
            return None;
        }
        let (inertia, range) = robot.link_inertias()?;
        let period = 1.0 / self.given().tick_rate;
        let latency = drives.iter().fold(0.0, |latency: f64, drive| {
            latency.max(drive.encoder_latency)
        });
        let joints = drives.map(|drive| BeltJoint {
            belt: Belt {
                stiffness: drive.stiffness.unwrap_or(f64::INFINITY),
                damping: drive.drive_damping,
                rotor_inertia: drive.motor().reflected_inertia(),
                encoder_at_joint: drive.encoder_side == EncoderSide::Joint,
            },
            inertia,
            range,
            current_bandwidth: CURRENTS[0] / period,
            latency,
            count: TAU / (f64::from(drive.encoder_counts) * drive.gear_ratio.abs()),
            peak_torque: drive.peak_torque(),
            period,
        });
        let [joint1, joint4] = joints;
        let (first, second) = (tuned(&joint1)?, tuned(&joint4)?);
        (first.is_good(&joint1) && second.is_good(&joint4)).then_some([first, second])
    }
}

/// The gains of a joint.
fn tuned(joint: &BeltJoint) -> Option<BeltTuning> {
    static FOUND: Newest<BeltJoint, Option<BeltTuning>> = Newest::new();
    FOUND.of(*joint, tune_belt)
}

/// The controller's settings of the belts with these loops.
pub(super) fn belt_settings(
    tunings: Option<&[BeltTuning; 2]>,
    drives: &[Actuator; 2],
) -> [BeltSettings; 2] {
    let Some(tunings) = tunings else {
        return [BeltSettings::RIGID; 2];
    };
    Joint::ALL.map(|joint| {
        let (drive, gains) = (&drives[joint], &tunings[joint.index()].gains);
        BeltSettings {
            stiffness: drive.stiffness.map_or(0.0, single),
            damping: single(drive.drive_damping),
            encoder_at_joint: drive.encoder_side == EncoderSide::Joint,
            bandwidth: single(gains.bandwidth),
            damping_ratio: single(gains.damping),
            rotor_damping: single(gains.rotor_damping),
            observer: gains.observer.map(single),
        }
    })
}

impl Robot {
    /// The least and the greatest eigenvalue of the mass matrix without rotors over the poses [kg·m²], and the
    /// least and the greatest factor on it of an arm within [`INERTIA_RANGE`] and [`PAYLOAD_RANGE`].
    fn link_inertias(&self) -> Option<([f64; 2], [f64; 2])> {
        let arm = self.arm().ok()?;
        let [light, heavy] = PAYLOAD_RANGE.map(|factor| links_only(arm, factor * arm.payload()));
        let (light, heavy, declared) = (light?, heavy?, links_only(arm, arm.payload())?);
        let mut inertia = [f64::INFINITY, 0.0_f64];
        let mut range = [1.0_f64, 1.0_f64];
        for pose in self.poses() {
            let at = |arm: &Arm<f64>| arm.mass_matrix(&pose).ok();
            let (Some(mass), Some(light), Some(heavy)) = (at(&declared), at(&light), at(&heavy))
            else {
                continue;
            };
            let eigenvalues = SymmetricEigen::new(mass).eigenvalues;
            inertia[0] = inertia[0].min(eigenvalues.min());
            inertia[1] = inertia[1].max(eigenvalues.max());
            range[0] = range[0].min(INERTIA_RANGE[0] * relative(&mass, &light)?.min());
            range[1] = range[1].max(INERTIA_RANGE[1] * relative(&mass, &heavy)?.max());
        }
        (inertia[0] > 0.0).then_some((inertia, range))
    }
}

/// The arm with this payload and without rotors.
pub(super) fn links_only(arm: &Arm<f64>, payload: f64) -> Option<Arm<f64>> {
    Arm::new(
        *arm.geometry(),
        *arm.links(),
        payload,
        arm.gravity(),
        [0.0; 2],
    )
    .ok()
}

/// The eigenvalues of `other` by those of `mass`.
fn relative(mass: &Matrix2<f64>, other: &Matrix2<f64>) -> Option<nalgebra::Vector2<f64>> {
    let lower = mass.cholesky()?.l().try_inverse()?;
    Some(SymmetricEigen::new(lower * other * lower.transpose()).eigenvalues)
}
