//! The page's requests and their answers, in JSON.

use crate::watched::Watched;
use fivebar_design::workspace::{Cell, Grid, WorkspaceMap};
use fivebar_files::robot::{BuiltIn, Draft, DraftError, Robot};
use fivebar_files::scenario::{Scenario, ScenarioError};
use fivebar_files::source::FileError;
use fivebar_kinematics::five_bar::Side;
use fivebar_sim::link::TargetError;
use fivebar_sim::simulation::{RunError, Simulate as _, Simulation, TipError, fault_name};
use serde::{Deserialize, Serialize};

/// Cells of the map across the reach.
const CELLS: f64 = 200.0;

#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "snake_case", deny_unknown_fields)]
enum Request {
    /// The arm and where its tool may go.
    Arm { link_lengths: Option<[f64; 5]> },
    /// A job, drawn by the simulated arm under the controller. Without `job` it is the demonstration.
    Draw {
        link_lengths: Option<[f64; 5]>,
        job: Option<String>,
    },
}

/// The arm.
#[derive(Serialize)]
struct ArmAnswer {
    /// l1, l2, l3, l4, base [m].
    link_lengths: [f64; 5],
    /// θ1, θ4 [rad] and the tool [m] at home.
    home: [f64; 4],
    /// The map's corners [m].
    low: [f64; 2],
    high: [f64; 2],
    columns: usize,
    /// Row by row from the lower left: 100 σmin/σmax, 0 where the tool may not go.
    cells: Vec<u8>,
    /// The robot file.
    file: String,
}

/// A run.
#[derive(Serialize)]
struct DrawAnswer {
    ticks: u64,
    /// From power-up to the end [s].
    simulated_s: f64,
    tip_error: TipError,
    /// Metres in the plane per metre in the job.
    scale: f64,
    faults: Vec<String>,
    /// CRC-64 over the bits of duties, enables, brake and state of all ticks.
    digest: String,
}

#[derive(Debug, thiserror::Error)]
enum Error {
    #[error("a request that this program does not know: {0}")]
    Request(#[from] serde_json::Error),
    #[error("with these lengths: {0}")]
    Draft(DraftError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{0}")]
    Workspace(String),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Target(#[from] TargetError),
}

/// Answers a request of the page. `drawn` takes the samples of a run while it is computed, rows of time [s], θ1, θ4
/// [rad], x, y of the tool [m], and its level 0 to 1. An error is `{"error": sentence}`.
pub fn answer(request: &str, drawn: &mut dyn FnMut(&[f32])) -> String {
    let answered = serde_json::from_str(request)
        .map_err(Error::from)
        .and_then(|request| match request {
            Request::Arm { link_lengths } => Ok(serde_json::to_string(&arm(link_lengths)?)?),
            Request::Draw { link_lengths, job } => {
                Ok(serde_json::to_string(&draw(link_lengths, job, drawn)?)?)
            }
        });
    answered.unwrap_or_else(|error| serde_json::json!({"error": error.to_string()}).to_string())
}

/// An arm of these lengths with typical motors, as `fivebar new` writes it; without lengths the default one.
fn robot(link_lengths: Option<[f64; 5]>) -> Result<(Robot, String), Error> {
    let Some([l1, l2, l3, l4, base]) = link_lengths else {
        let text = fivebar_files::robot::text_of(BuiltIn::DEFAULT)?;
        return Ok((Robot::load(BuiltIn::DEFAULT)?, text));
    };
    let mut draft = Draft::new("my-arm");
    draft.set_base(base);
    draft.set_cranks([l1, l4]);
    draft.set_couplers([l2, l3]);
    Ok((draft.check().map_err(Error::Draft)?, draft.text()))
}

fn arm(link_lengths: Option<[f64; 5]>) -> Result<ArmAnswer, Error> {
    let (robot, file) = robot(link_lengths)?;
    let home = robot.home_pose().map_err(RunError::from)?;
    let [theta1, _, _, theta4] = home.angles();
    let [x, y] = robot.tool_at(&home);
    let refused = |error: &dyn std::fmt::Display| Error::Workspace(error.to_string());
    let workspace = robot.workspace(robot.working_mode());
    let workspace = workspace.map_err(|error| refused(&error))?;
    let tool = &workspace.tool;
    let size = 2.0 * (tool.geometry().l1() + tool.reach()) / CELLS;
    let grid = Grid::over(tool, size).map_err(|error| refused(&error))?;
    let map = WorkspaceMap::new(workspace, grid);
    let [low, high] = [map.grid().low(), map.grid().high()];
    let assembly = home.assembly();
    Ok(ArmAnswer {
        link_lengths: robot.geometry.lengths(),
        home: [theta1, theta4, x, y],
        low: [low.x, low.y],
        high: [high.x, high.y],
        columns: map.grid().columns(),
        cells: map
            .cells()
            .iter()
            .map(|it| code(it.as_ref(), assembly))
            .collect(),
        file,
    })
}

fn code(cell: Option<&Cell>, assembly: Side) -> u8 {
    let allowed = cell.filter(|cell| cell.clear && cell.assembly == assembly);
    allowed.map_or(0, |cell| (100.0 * cell.inverse_condition) as u8)
}

fn draw(
    link_lengths: Option<[f64; 5]>,
    job: Option<String>,
    drawn: &mut dyn FnMut(&[f32]),
) -> Result<DrawAnswer, Error> {
    let (robot, _) = robot(link_lengths)?;
    let tick_rate = robot.control.tick_rate;
    let is_demonstration = link_lengths.is_none() && job.is_none();
    let mut scenario = match job {
        Some(text) => Scenario::new("a job", robot, "the job", text),
        None => Scenario::demonstration(robot),
    };
    if !is_demonstration {
        scenario.fit()?;
    }
    let job = scenario.job()?;
    scenario.check(&job)?;
    let moves = scenario.run_moves(&job)?;
    let mut target = Watched::new(scenario.controller()?, tick_rate, drawn);
    let simulation = Simulation::new(&mut target, scenario.plant()?, tick_rate);
    let record = simulation.run(&moves, &[], &mut |_| ())?;
    Ok(DrawAnswer {
        ticks: record.ticks,
        simulated_s: record.simulated,
        tip_error: record.tip_error,
        scale: scenario.scale,
        faults: record
            .faults
            .iter()
            .map(|&(_, it)| fault_name(it))
            .collect(),
        digest: format!("{:016x}", target.finish()),
    })
}

#[cfg(test)]
mod tests {
    use super::answer;
    use serde_json::{Value, json};

    fn answered(request: &Value) -> (Value, Vec<f32>) {
        let mut numbers = Vec::new();
        let text = answer(&request.to_string(), &mut |rows| numbers.extend(rows));
        (serde_json::from_str(&text).expect("JSON"), numbers)
    }

    #[test]
    fn a_job_is_drawn_with_samples_up_to_its_end_and_a_digest_of_its_own() {
        let stroke = |length: u32| {
            let job = format!("G21 G90 F3000\nM3\nG1 X{length}\nM5\n");
            answered(&json!({"op": "draw", "job": job}))
        };
        let (run, numbers) = stroke(10);
        assert!(run["tip_error"]["rms_m"].as_f64().unwrap() < 50e-6, "{run}");
        assert_eq!(run["faults"], json!([]));
        let (rows, []) = numbers.as_chunks::<{ crate::watched::ROW }>() else {
            panic!("half a row");
        };
        // The tool is down over 10 mm, and the last sample is at the end.
        let down: Vec<f32> = rows
            .iter()
            .filter(|it| it[5] > 0.0)
            .map(|it| it[3])
            .collect();
        let long = down.iter().copied().fold(f32::MIN, f32::max)
            - down.iter().copied().fold(f32::MAX, f32::min);
        assert!((long - 0.01).abs() < 1e-4, "{long} m");
        let end = f64::from(rows.last().expect("samples")[0]);
        assert!(
            (run["simulated_s"].as_f64().unwrap() - end).abs() < 0.01,
            "{end} s"
        );
        assert_eq!(stroke(10).0["digest"], run["digest"]);
        assert_ne!(stroke(11).0["digest"], run["digest"]);
    }

    #[test]
    fn the_map_is_that_of_the_lengths() {
        let lengths = [0.09, 0.15, 0.15, 0.09, 0.04];
        let (arm, _) = answered(&json!({"op": "arm", "link_lengths": lengths}));
        assert_eq!(arm["link_lengths"], json!(lengths));
        let cells = arm["cells"].as_array().expect("cells");
        assert_eq!(cells.len() as u64 % arm["columns"].as_u64().unwrap(), 0);
        assert!(cells.iter().any(|it| *it != 0) && cells.iter().any(|it| *it == 0));
    }

    #[test]
    fn what_cannot_be_done_is_a_sentence() {
        for (request, said) in [
            (json!({"op": "fly"}), "does not know"),
            (json!({"op": "draw", "job": "G1 X1000000000 Y\n"}), "line 1"),
            (
                json!({"op": "arm", "link_lengths": [0.04, 0.04, 0.04, 0.04, 0.2]}),
                "these lengths",
            ),
            (
                json!({"op": "arm", "link_lengths": [0.1, -0.1, 0.1, 0.1, 0.1]}),
                "these lengths",
            ),
            (
                json!({"op": "arm", "link_lengths": [1e300, 0.1, 0.1, 0.1, 0.1]}),
                "these lengths",
            ),
        ] {
            let (answer, numbers) = answered(&request);
            let error = answer["error"].as_str().unwrap_or_default();
            assert!(error.contains(said), "{request}: {answer}");
            assert!(numbers.is_empty(), "{numbers:?}");
        }
    }
}
