//! The workspace in each working mode, as pages draw it.

use super::ServeError;
use fivebar_design::workspace::{Cell, Grid, WorkspaceMap, singularity_curves};
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::{Side, Singularity, WorkingMode};
use serde::Serialize;

/// Cells across the reach.
const CELLS: f64 = 200.0;
/// Code of a cell out of reach.
const OUTSIDE: i16 = -1;
/// Added to the code of a cell within reach that is not allowed.
const FORBIDDEN: i16 = 200;

/// The map of a working mode. Positions [m].
#[derive(Debug, Serialize)]
struct ModeMap {
    elbows: [Side; 2],
    /// The grid's corners.
    low: [f64; 2],
    high: [f64; 2],
    columns: usize,
    /// Row by row from the lower left: [`OUTSIDE`] out of reach, else 100 σmin/σmax, plus
    /// [`FORBIDDEN`] beyond a joint limit, within the singularity margin or on the other
    /// assembly mode.
    cells: Vec<i16>,
    /// The curves of the singularities of type 1 and of type 2.
    type1: Vec<Vec<[f64; 2]>>,
    type2: Vec<Vec<[f64; 2]>>,
}

/// The maps of all working modes, as JSON. `assembly` is the arm's assembly mode, which it
/// does not leave.
///
/// # Errors
/// Tool or limits that allow no workspace.
pub(super) fn describe(robot: &Robot, assembly: Side) -> Result<String, ServeError> {
    let mut maps = Vec::new();
    for mode in WorkingMode::ALL {
        let workspace = robot.workspace(mode)?;
        let tool = &workspace.tool;
        let size = 2.0 * (tool.geometry().l1() + tool.reach());
        let map = WorkspaceMap::new(workspace, Grid::over(tool, size / CELLS)?);
        let code = |cell: &Option<Cell>| cell.as_ref().map_or(OUTSIDE, |cell| code(cell, assembly));
        let all_curves = singularity_curves(tool, mode);
        let curves = |parallel: bool| {
            all_curves
                .iter()
                .filter(|curve| (curve.singularity == Singularity::Parallel) == parallel)
                .map(|curve| curve.points.iter().map(|p| rounded([p.x, p.y])).collect())
                .collect()
        };
        let [low, high] = [map.grid().low(), map.grid().high()];
        maps.push(ModeMap {
            elbows: [mode.elbow1, mode.elbow4],
            low: [low.x, low.y],
            high: [high.x, high.y],
            columns: map.grid().columns(),
            cells: map.cells().iter().map(code).collect(),
            type1: curves(false),
            type2: curves(true),
        });
    }
    Ok(serde_json::json!(maps).to_string())
}

fn code(cell: &Cell, assembly: Side) -> i16 {
    let hundredths = (100.0 * cell.inverse_condition) as i16;
    if cell.clear && cell.assembly == assembly {
        hundredths
    } else {
        hundredths + FORBIDDEN
    }
}

/// Rounded to micrometres, which is enough for a drawing.
fn rounded(place: [f64; 2]) -> [f64; 2] {
    place.map(|x| (1e6 * x).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::{FORBIDDEN, OUTSIDE, describe};
    use fivebar_files::robot::{BuiltIn, Robot};
    use fivebar_kinematics::five_bar::Side;

    #[test]
    fn the_home_position_is_allowed_in_one_working_mode_and_on_one_assembly_mode_only() {
        let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
        let home = robot.home_pose().unwrap();
        let [x, y] = robot.tool_at(&home);
        let at_home = |assembly: Side| -> Vec<i16> {
            let maps = describe(&robot, assembly).unwrap();
            let maps: Vec<serde_json::Value> = serde_json::from_str(&maps).unwrap();
            let cell = |map: &serde_json::Value| {
                let number = |value: &serde_json::Value| value.as_f64().unwrap();
                let (low, high) = (&map["low"], &map["high"]);
                let columns = map["columns"].as_u64().unwrap() as usize;
                let pitch = (number(&high[0]) - number(&low[0])) / columns as f64;
                let column = ((x - number(&low[0])) / pitch) as usize;
                let row = ((y - number(&low[1])) / pitch) as usize;
                assert!(!map["type1"].as_array().unwrap().is_empty());
                assert!(!map["type2"].as_array().unwrap().is_empty());
                map["cells"][row * columns + column].as_i64().unwrap() as i16
            };
            maps.iter().map(cell).collect()
        };
        let allowed = |cells: &[i16]| cells.iter().filter(|&&cell| cell < FORBIDDEN).count();
        let own = at_home(home.assembly());
        assert!(own.iter().all(|&cell| cell != OUTSIDE), "{own:?}");
        assert_eq!(allowed(&own), 1, "{own:?}");
        assert_eq!(allowed(&at_home(home.assembly().opposite())), 0);
    }
}
