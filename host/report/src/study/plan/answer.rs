//! The plan as JSON.

use super::PlanStudy;
use fivebar_design::time_optimal::{Run, RunSample};
use serde_json::{Value, json};

impl PlanStudy {
    /// One JSON object; the units are in the keys.
    pub fn answer(&self) -> Value {
        let runs: Vec<Value> = self.runs.iter().map(|run| self.run(run)).collect();
        json!({
            "time_s": self.time(),
            "runs": runs,
            "active_share": self.active_share(),
            "limit_excess": self.limit_excess(),
            "planning_s": self.planning.as_secs_f64(),
        })
    }

    /// Share of the time with a limit above 95 %.
    pub fn active_share(&self) -> f64 {
        self.runs.iter().map(|run| run.active_time).sum::<f64>() / self.time()
    }

    /// Most by which any limit is passed, relative.
    pub fn limit_excess(&self) -> f64 {
        let excess = self.runs.iter().map(|run| run.limit_excess);
        excess.fold(0.0, f64::max)
    }

    fn run(&self, run: &Run) -> Value {
        let each = |of: fn(&RunSample) -> f64| run.samples.iter().map(of).collect::<Vec<f64>>();
        let torque = |of| self.has_masses.then(|| each(of));
        json!({
            "length": run.length,
            "time": run.time,
            "s": each(|at| at.s),
            "sdot": each(|at| at.s_dot),
            "sddot": each(|at| at.s_ddot),
            "t": each(|at| at.t),
            "torque1_nm": torque(|at| at.torque[0]),
            "torque4_nm": torque(|at| at.torque[1]),
        })
    }
}
