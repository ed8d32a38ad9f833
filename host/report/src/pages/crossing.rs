//! The page of a crossing: the regions by mode, the curves between them, the line that crosses.

use crate::html::{Chart, Page};
use crate::study::regions::ModeRegions;
use fivebar_design::crossing::CrossingPlan;
use fivebar_kinematics::five_bar::WorkingMode;
use nalgebra::Vector2;

/// The page: a chart of each working mode; that of the plan has its line `ends` [m] too.
pub fn crossing(
    plan: &CrossingPlan,
    ends: [[f64; 2]; 2],
    own: WorkingMode,
    regions: &[ModeRegions],
) -> Page {
    let mut page = Page::new("Crossing a type 2 singularity");
    let [before, after] = plan.assembly;
    page.key_figures(&[
        ("crosses at", format!("{:.1} ms", 1e3 * plan.t_c)),
        ("assembly", format!("{before} to {after}")),
    ]);
    page.paragraph(
        "Each chart is a working mode. Dots are the places that it reaches, by assembly mode. Between them lie \
         the curves of type 2: solid where a straight motion can cross within the joints' speeds and \
         accelerations, dashed where none can.",
    );
    for regions in regions {
        let (elbow1, elbow4) = (regions.mode.elbow1, regions.mode.elbow4);
        let title = format!("Elbow 1 {elbow1}, elbow 4 {elbow4}");
        let [left, right] = regions.reached.each_ref().map(|places| millimetres(places));
        let mut chart = Chart::new(title, "x [mm]", "y [mm]")
            .dots("assembly left", left)
            .dots("assembly right", right)
            .line("can cross", with_gaps(&regions.crossable))
            .dashed("cannot cross", with_gaps(&regions.barred));
        if regions.mode == own {
            let [from, to] = ends.map(Vector2::from);
            let at = from + (to - from) * plan.s_c;
            chart = chart
                .line("planned", millimetres(&[from, to]))
                .dots("crosses here", millimetres(&[at]));
        }
        page.chart(&chart.with_equal_aspect());
    }
    page
}

fn millimetres(places: &[Vector2<f64>]) -> Vec<[f64; 2]> {
    let places = places.iter();
    places.map(|place| [1e3 * place.x, 1e3 * place.y]).collect()
}

/// Curves one after the other, with a gap after each.
fn with_gaps(curves: &[Vec<Vector2<f64>>]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for curve in curves {
        points.extend(millimetres(curve));
        points.push([f64::NAN; 2]);
    }
    points
}
