//! The rival: one acceleration of the tool for each arm, what a builder sets.
//!
//! It is the greatest one with which the arm draws all of the jobs that it is tuned on, found by halving, with the better
//! of two jerks: the acceleration changes within a swing of the motors, or at once. Then it draws jobs that it was not
//! tuned on, and is lowered until it draws all of them.

use super::{Arm, Job, Outcome};
use fivebar_firmware::settings::{BeltSettings, FieldLag};
use rayon::prelude::*;

/// So large a share that no limit of the torque holds the rival back.
const NO_LIMIT: f64 = 10.0;
/// Accelerations between which the rival is searched [m/s²].
const ACCELERATIONS: [f64; 2] = [4.0, 400.0];
/// Halvings of their logarithm: to 4 %, 2 % of the time.
const HALVINGS: u32 = 7;
/// By what the acceleration is multiplied where a job is not drawn.
const LOWER: f64 = 0.95;

/// A constant acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rival {
    /// Whether the field leads by the load, as that of the motion by torque does.
    leads: bool,
    /// [m/s²].
    pub(super) acceleration: f64,
    /// The time in which the acceleration changes [s].
    changes_in: f64,
}

impl Rival {
    /// The best one on these jobs.
    pub(super) fn tuned(arm: &Arm, jobs: &[Job], leads: bool) -> Self {
        let swing = arm.scenario(&jobs[0], NO_LIMIT).robot.swing_period();
        let found = [swing.expect("steppers"), 1e-3].map(|changes_in| {
            let [mut good, mut bad] = ACCELERATIONS;
            let rival = |acceleration| Self {
                leads,
                acceleration,
                changes_in,
            };
            let mut order: Vec<&Job> = jobs.iter().collect();
            for _ in 0..HALVINGS {
                let middle = (good * bad).sqrt();
                if rival(middle).draws(arm, &mut order) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            rival(good)
        });
        let [smooth, hard] = found.map(|it| it.time(arm, jobs));
        found[usize::from(hard < smooth)]
    }

    /// The same, lowered until it draws these jobs, and how many it did not draw before.
    pub(super) fn checked(mut self, arm: &Arm, jobs: &[Job]) -> (Self, usize) {
        let outcomes: Vec<Outcome> = jobs.par_iter().map(|job| self.run(arm, job)).collect();
        let not_drawn = outcomes.iter().filter(|it| !it.is_drawn()).count();
        let mut order: Vec<&Job> = jobs.iter().collect();
        let mut is_drawn = not_drawn == 0;
        while !is_drawn {
            self.acceleration *= LOWER;
            is_drawn = self.draws(arm, &mut order);
        }
        (self, not_drawn)
    }

    /// Whether all jobs are drawn; the one that was not drawn last is tried first.
    fn draws(&self, arm: &Arm, jobs: &mut [&Job]) -> bool {
        let bad = jobs.iter().position(|job| !self.run(arm, job).is_drawn());
        if let Some(place) = bad {
            jobs[..=place].rotate_right(1);
        }
        bad.is_none()
    }

    /// The time of these jobs [s].
    pub(super) fn time(&self, arm: &Arm, jobs: &[Job]) -> f64 {
        let times = jobs.par_iter().map(|job| self.run(arm, job).time);
        times.sum()
    }

    fn run(&self, arm: &Arm, job: &Job) -> Outcome {
        let mut scenario = arm.scenario(job, NO_LIMIT);
        let motion = &mut scenario.robot.motion;
        motion.max_acceleration = self.acceleration;
        motion.max_jerk = self.acceleration / self.changes_in;
        Outcome::of(&scenario, |settings| {
            if !self.leads {
                settings.belts = [BeltSettings::RIGID; 2];
                settings.field_lags = [FieldLag::NONE; 2];
            }
        })
    }
}
