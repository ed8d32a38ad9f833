//! A margin around what a fitted job draws: the arm reaches all of it, too.

use super::Scenario;
use super::outline::Outline;
use crate::job::Job;
use std::f64::consts::TAU;

/// Directions in which a margin is looked at from each point of a drawing.
const DIRECTIONS: u32 = 16;
/// Shares of the margin at which it is looked at.
const SHARES: [f64; 2] = [0.5, 1.0];

impl Scenario {
    /// Whether the arm reaches, in the assembly mode of home, each point within the margin around what a job draws.
    pub(super) fn has_margin(&self, job: &Job) -> bool {
        if self.margin == 0.0 {
            return true;
        }
        let robot = &self.robot;
        let (Ok(workspace), Ok(home)) = (robot.workspace(robot.working_mode()), robot.home_pose())
        else {
            return false;
        };
        let is_clear = |x: f64, y: f64| {
            let pose = workspace.check([x, y].into());
            pose.is_ok_and(|pose| pose.assembly() == home.assembly())
        };
        let around = |share: f64, direction: u32| {
            let (sin, cos) = (TAU * f64::from(direction) / f64::from(DIRECTIONS)).sin_cos();
            [share * self.margin * cos, share * self.margin * sin]
        };
        let outline = Outline::of(job);
        SHARES.iter().all(|&share| {
            (0..DIRECTIONS).all(|direction| {
                let [dx, dy] = around(share, direction);
                let mut points = outline.points().iter();
                points.all(|[x, y]| is_clear(x + dx, y + dy))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::job::JobOptions;
    use crate::robot::Robot;
    use crate::scenario::placement::outline::Outline;
    use crate::scenario::{FitError, Kept, Scenario};

    /// A frame of 60 mm by 40 mm, fitted on the arm in its copies; its size [m] and the scenario.
    fn fitted(margin: f64, copies: [u32; 2]) -> Result<([f64; 2], Scenario), FitError> {
        let robot = Robot::load("benchtop_pen").expect("a robot");
        let frame = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60mm\" height=\"40mm\" viewBox=\"0 0 60 40\">\
                     <path fill=\"none\" stroke=\"black\" d=\"M0 0H60V40H0Z\"/></svg>";
        let mut scenario = Scenario::new("frame", robot, "frame.svg", frame.into());
        scenario.margin = margin;
        scenario.options = JobOptions {
            copies,
            ..JobOptions::default()
        };
        let free = Kept {
            scale: false,
            turn: false,
        };
        scenario.fit_to_reach(free)?;
        let job = scenario.job().expect("a job");
        let mut planner = scenario.planner().expect("a planner");
        scenario
            .verify(&mut planner, &job)
            .expect("a job that is drawn");
        Ok((Outline::of(&job).extent().size(), scenario))
    }

    #[test]
    fn a_fitted_drawing_and_its_copies_keep_the_margin_on_every_side_and_use_what_is_left() {
        for copies in [[1, 1], [2, 2]] {
            let (whole, scenario) = fitted(0.0, copies).expect("a place");
            let job = scenario.job().expect("a job");
            let wide = Scenario {
                margin: 0.01,
                ..scenario
            };
            assert!(
                !wide.has_margin(&job),
                "without a margin the reach is used up"
            );
            for margin in [5e-3, 0.01, 0.02] {
                let (size, scenario) = fitted(margin, copies).expect("a place");
                let job = scenario.job().expect("a job");
                // Each corner, moved by the margin along x or y, is still within reach.
                let workspace = scenario.robot.workspace(scenario.robot.working_mode());
                let workspace = workspace.expect("a workspace");
                for [x, y] in Outline::of(&job).points() {
                    for [dx, dy] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                        let beside = [x + margin * dx, y + margin * dy];
                        workspace.check(beside.into()).expect("within reach");
                    }
                }
                let lost = whole[0].max(whole[1]) - size[0].max(size[1]);
                assert!(
                    lost > 0.0 && lost < 6.0 * margin + 0.02,
                    "{lost} m of {margin} m"
                );
            }
        }
    }

    #[test]
    fn a_margin_that_leaves_nothing_is_refused_with_the_option() {
        for margin in [0.15, 1.0] {
            let refusal = fitted(margin, [1, 1]).expect_err("a refusal").to_string();
            assert!(refusal.contains("choose a smaller --margin"), "{refusal}");
        }
    }
}
