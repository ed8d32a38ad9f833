//! The map of a working mode as SVG: the condition number in bands of colour, singularity
//! curves, the arm at home, the largest clear rectangle, axes and a legend.

mod arm;
mod axes;
mod bands;
mod designs;
mod legend;
mod photo;
mod plate;
#[cfg(feature = "png")]
mod png;
mod tip_error;
mod validation;

pub(crate) use designs::designs;
pub use photo::drawing_errors;
pub use plate::plate;
#[cfg(feature = "png")]
pub use png::{PngError, png};
pub use tip_error::tip_errors;
pub use validation::{DrawnPoint, validation};

use crate::study::workspace::{WorkspaceStudy, WorkspaceStudyError};
use arm::ArmDrawing;
use axes::PictureFrame;
use fivebar_design::workspace::{Rectangle, SingularityCurve, WorkspaceMap, singularity_curves};
use fivebar_kinematics::five_bar::{Singularity, WorkingMode};
use nalgebra::Vector2;
use quick_xml::escape::escape;
use std::fmt::Write as _;

/// Colour of lines and text, and of the background.
const INK: &str = "#1d2430";
const PAPER: &str = "#ffffff";
/// Colour of singularities of type 2; those of type 1 have the colour of lines.
const TYPE_2: &str = "#d81b60";

/// Draws the map of a working mode.
///
/// # Errors
/// The robot's limits are not valid.
pub fn svg(study: &WorkspaceStudy<'_>, mode: WorkingMode) -> Result<String, WorkspaceStudyError> {
    let robot = study.robot;
    let named = |error| WorkspaceStudyError::Robot(robot.name.clone(), error);
    let workspace = robot.workspace(mode).map_err(named)?;
    let frame = PictureFrame::around(&workspace.tool)?;
    // A cell is one unit of the picture, so that steps between cells are not visible.
    let map = WorkspaceMap::new(workspace, *frame.grid());
    let rectangle = study.largest_rectangle(mode);
    let [width, height] = frame.picture_size();
    let title = format!("Workspace of {}", escape(&robot.name));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans, sans-serif\" \
         font-size=\"13\" fill=\"{INK}\">\n<title>{title}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n"
    );
    let (elbow1, elbow4) = (mode.elbow1, mode.elbow4);
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"32\" font-size=\"18\">{title}</text>\n\
         <text x=\"{}\" y=\"53\">elbow of leg 1 to the {elbow1}, of leg 4 to the {elbow4}</text>",
        frame.left(),
        frame.left(),
    );
    svg.push_str(&frame.axes());
    svg.push_str(&bands::cells(&map, &frame));
    // Curves of type 1 come last: the background of the others must not cover them.
    for curve in singularity_curves(&workspace.tool, mode).iter().rev() {
        svg.push_str(&curve_path(curve, &frame));
    }
    let best = study.branches.iter().filter(|branch| branch.mode == mode);
    let best = best.filter_map(|branch| branch.best);
    let best = best.max_by(|(_, a), (_, b)| a.total_cmp(b));
    if let Some(rectangle) = rectangle {
        svg.push_str(&outline(rectangle, &frame));
    }
    if let Some((place, _)) = best {
        let [x, y] = frame.to_picture(place);
        let _ = writeln!(svg, "{}", cross(x, y));
    }
    let arm = ArmDrawing::of(robot, mode, best.map(|(place, _)| place));
    if let Some(arm) = &arm {
        svg.push_str(&arm.drawn(&frame));
    }
    if let Some(rectangle) = rectangle {
        let links = arm.map_or_else(Vec::new, |arm| arm.links());
        svg.push_str(&size_label(rectangle, &links, &frame));
    }
    svg.push_str(&legend::legend(&legend::LegendContent {
        left: frame.legend_left(),
        top: frame.top(),
        limits: map.reached().any(|(_, cell)| !cell.within_limits),
        margin: robot.limits.singularity_margin,
        rectangle: rectangle.map(|rectangle| rectangle.size()),
        best,
    }));
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// A singularity curve: solid for type 1, dashed for type 2, which has a background of its own
/// so that it is visible on any colour.
fn curve_path(curve: &SingularityCurve, frame: &PictureFrame) -> String {
    let path = frame.path(&curve.points);
    match curve.singularity {
        Singularity::Leg1 | Singularity::Leg4 => {
            format!("<path d=\"{path}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"2\"/>\n")
        }
        Singularity::Parallel => format!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{PAPER}\" stroke-width=\"4\"/>\n\
             <path d=\"{path}\" fill=\"none\" stroke=\"{TYPE_2}\" stroke-width=\"2\" \
             stroke-dasharray=\"7 4\"/>\n"
        ),
    }
}

/// The outline of the rectangle.
fn outline(rectangle: Rectangle, frame: &PictureFrame) -> String {
    let [x, y] = frame.to_picture(Vector2::new(rectangle.low.x, rectangle.high.y));
    let [right, bottom] = frame.to_picture(Vector2::new(rectangle.high.x, rectangle.low.y));
    let (width, height) = (right - x, bottom - y);
    let line = |colour, wide| {
        format!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             fill=\"none\" stroke=\"{colour}\" stroke-width=\"{wide}\"/>\n"
        )
    };
    line(PAPER, 4) + &line(INK, 2)
}

/// The rectangle's size, in the corner that is farthest from the links; none if the rectangle
/// is too small. The legend has it too.
fn size_label(rectangle: Rectangle, links: &[[Vector2<f64>; 2]], frame: &PictureFrame) -> String {
    let text = dimensions(rectangle.size());
    let half = 4.2 * text.chars().count() as f64;
    let [left, top] = frame.to_picture(Vector2::new(rectangle.low.x, rectangle.high.y));
    let [right, bottom] = frame.to_picture(Vector2::new(rectangle.high.x, rectangle.low.y));
    if right - left < 2.0 * half + 14.0 || bottom - top < 56.0 {
        return String::new();
    }
    let middles = [left + half + 7.0, right - half - 7.0]
        .into_iter()
        .flat_map(|x| [top + 14.0, bottom - 14.0].map(|y| [x, y]));
    let links: Vec<_> = links
        .iter()
        .map(|ends| ends.map(|end| frame.to_picture(end)))
        .collect();
    let clearance = |middle: &[f64; 2]| {
        let distances = links.iter().map(|&ends| arm::distance(*middle, ends));
        distances.fold(f64::INFINITY, f64::min)
    };
    let farthest = middles.reduce(|best, middle| {
        if clearance(&middle) > clearance(&best) {
            middle
        } else {
            best
        }
    });
    farthest.map_or_else(String::new, |[x, y]| label([x, y + 4.5], &text))
}

/// Width and height in millimetres.
fn dimensions(size: Vector2<f64>) -> String {
    format!("{:.0} × {:.0} mm", 1e3 * size.x, 1e3 * size.y)
}

/// Text centred at a point of its base line, readable on any colour.
fn label([x, y]: [f64; 2], text: &str) -> String {
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" stroke=\"{PAPER}\" \
         stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\">{text}</text>\n"
    )
}

/// The symbol of the best-conditioned position.
fn cross(x: f64, y: f64) -> String {
    let arms = format!("M{:.1} {y:.1}h14M{x:.1} {:.1}v14", x - 7.0, y - 7.0);
    format!(
        "<path d=\"{arms}\" fill=\"none\" stroke=\"{PAPER}\" stroke-width=\"5\"/>\
         <path d=\"{arms}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"2\"/>"
    )
}
