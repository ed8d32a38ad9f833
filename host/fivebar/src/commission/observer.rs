//! What the simulated arm itself went through, step by step: its own energies and angles, which no
//! sensor and no wiring can falsify.

use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Plant;
use serde::Serialize;

/// The links that the motors drive.
const DRIVEN: [usize; 2] = [0, 3];

/// The greatest values of a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct StepExtremes {
    /// The step; empty before the first one.
    step: &'static str,
    /// Time for which a bridge was on [s].
    powered_s: f64,
    /// Greatest kinetic energy of the arm with its rotors [J].
    kinetic_energy_j: f64,
    /// Most heat in both windings while the bridges were on without a pause [J]; 0 of other motors than brushed ones.
    heat_j: f64,
    /// Greatest distance of joints 1 and 4 from where they were when the bridges went on [rad].
    travel_rad: [f64; 2],
    /// Least and greatest angle of joints 1 and 4 while a bridge was on [rad]; none before.
    angle_rad: [Option<[f64; 2]>; 2],
    /// Greatest speed of joints 1 and 4 while a bridge was on [rad/s].
    speed_rad_s: [f64; 2],
}

/// The time since the bridges went on.
#[derive(Clone, Copy)]
struct PoweredSpan {
    start: [f64; 2],
    heat: f64,
}

/// Observes the simulated arm in each step.
pub(super) struct Observer {
    steps: Vec<StepExtremes>,
    span: Option<PoweredSpan>,
}

impl StepExtremes {
    fn new(step: &'static str) -> Self {
        Self {
            step,
            powered_s: 0.0,
            kinetic_energy_j: 0.0,
            heat_j: 0.0,
            travel_rad: [0.0; 2],
            angle_rad: [None; 2],
            speed_rad_s: [0.0; 2],
        }
    }
}

impl Observer {
    pub(super) fn new() -> Self {
        Self {
            steps: vec![StepExtremes::new("")],
            span: None,
        }
    }

    /// What follows belongs to this step.
    pub(super) fn begin(&mut self, step: &'static str) {
        self.steps.push(StepExtremes::new(step));
    }

    /// Observes a tick of `period` [s] in which the drives may have power, or none.
    pub(super) fn observe(&mut self, plant: &Plant, powered: bool, period: f64) {
        let Some(step) = self.steps.last_mut() else {
            return;
        };
        let state = plant.state();
        let energy = plant.model().kinetic_energy(state);
        step.kinetic_energy_j = step.kinetic_energy_j.max(energy);
        if !powered {
            self.span = None;
            return;
        }
        let angle = Joint::ALL.map(|joint| plant.angle(joint));
        let new = PoweredSpan {
            start: angle,
            heat: 0.0,
        };
        let span = self.span.get_or_insert(new);
        let heating = |joint: Joint| {
            plant.model().motors[joint].resistance * state.current[joint] * state.current[joint]
        };
        let [heating1, heating4] = Joint::ALL.map(heating);
        span.heat += (heating1 + heating4) * period;
        step.powered_s += period;
        step.heat_j = step.heat_j.max(span.heat);
        for joint in Joint::ALL {
            let angle = angle[joint];
            let travel = (angle - span.start[joint]).abs();
            step.travel_rad[joint] = step.travel_rad[joint].max(travel);
            let [least, most] = step.angle_rad[joint].unwrap_or([angle; 2]);
            step.angle_rad[joint] = Some([least.min(angle), most.max(angle)]);
            let speed = state.v[DRIVEN[joint]].angular.abs();
            step.speed_rad_s[joint] = step.speed_rad_s[joint].max(speed);
        }
    }

    /// What it has observed, as JSON.
    pub(super) fn report(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(&self.steps)
    }
}
