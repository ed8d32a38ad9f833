//! The margins of a loop through a bus, from its frequency response.

use super::{MarginsError, MarginsStudy, PoseMargins, least, worst_of};
use fivebar_design::servo::BusServo;
use fivebar_files::robot::{BusServos, Robot};
use rayon::prelude::*;

impl<'a> MarginsStudy<'a> {
    /// The margins of the loop with these drives.
    pub(super) fn through_bus(robot: &'a Robot, of: &BusServos) -> Result<Self, MarginsError> {
        let gains = robot.gains();
        let poses: Vec<PoseMargins> = of
            .servos
            .par_iter()
            .map(|(pose, servo)| {
                let margins = BusServo::margins(&servo.loci(&servo.law(&gains)));
                PoseMargins {
                    margins,
                    radius: if margins.is_none() { 1.0 } else { 0.0 },
                    ..PoseMargins::at(pose)
                }
            })
            .collect();
        let worst = worst_of(robot, &poses)?;
        let (_, servo) = &of.servos[worst];
        let law = servo.law(&gains);
        let pairs = of.servos.par_iter().zip(&of.unlike);
        let modulus_range = pairs
            .map(|((_, model), arms)| {
                let law = model.law(&gains);
                let margin = |arm: &BusServo| Some(BusServo::margins(&arm.loci(&law))?.modulus);
                arms.iter().map(margin).try_fold(f64::INFINITY, least)
            })
            .try_reduce(|| f64::INFINITY, |one, other| Some(one.min(other)));
        Ok(Self {
            robot,
            worst,
            loci: servo.loci(&law),
            resonance: [None; 2],
            modes: [None; 2],
            noise: servo.noise(&law),
            modulus_range,
            disturbance_peak: None,
            passive_stiffness: None,
            poses,
        })
    }
}
