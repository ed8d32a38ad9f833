//! The page of a synthesis, and its robot files.

use crate::html::{Chart, Page};
use crate::picture::designs;
use crate::study::synthesis::robot_file;
use crate::text::{drive_line, proof_sentence, quantity};
use fivebar_design::synthesis::{Design, Measure, Objective, Specification, Synthesis};
use fivebar_files::robot::DraftError;

/// Most arms that are drawn.
const MOST_DRAWN: usize = 24;

/// The files of a synthesis by name: report.html; best.toml, the arm of lengths in stock; and
/// front-2.toml and so on, the other arms of the front, as exact as they were found.
///
/// # Errors
/// The controller can't take one of the arms.
pub fn synthesis_files(
    name: &str,
    specification: &Specification,
    found: &Synthesis,
) -> Result<Vec<(String, String)>, DraftError> {
    let mut files = vec![
        (
            "report.html".into(),
            synthesis(name, specification, found).render(),
        ),
        ("best.toml".into(), robot_file(name, &found.stock)?),
    ];
    for (index, design) in found.front.iter().enumerate().skip(1) {
        let name = format!("front-{}", index + 1);
        files.push((format!("{name}.toml"), robot_file(&name, design)?));
    }
    Ok(files)
}

/// The page: the best arm, the front as a chart and as a table, and a drawing of each arm.
fn synthesis(name: &str, specification: &Specification, found: &Synthesis) -> Page {
    let sought = Sought::of(specification.objective);
    let stock = &found.stock;
    let mut page = Page::new(format!("An arm for {name}"));
    page.key_figures(&[
        (sought.name, sought.text(stock)),
        ("least 1/κ", format!("{:.3}", stock.dexterity)),
        ("links and half the base", quantity(stock.link_sum(), "m")),
    ]);
    // To a micrometre, without zeros behind.
    let [l1, l2, l3, l4, base] = stock.lengths.map(|length| (1e6 * length).round() / 1e3);
    page.paragraph(&format!(
        "The arm of lengths in stock, best.toml, has l1 = {l1}, l2 = {l2}, l3 = {l3}, l4 = {l4}, base {base} mm. {}.",
        proof_sentence("It is", found.stock_proof),
    ));
    let drive = drive_line("The payload", stock, found.drives[1].as_ref());
    if !drive.is_empty() {
        page.paragraph(&drive);
    }
    if found.front.len() > 1 {
        page.heading("The front");
        page.paragraph(
            "No arm that was found is better than one of these in both. Each was searched by itself, with more 1/κ \
             required than of the one before. Found is not proved: a longer search may find better ones.",
        );
        let points = found.front.iter();
        let points = points.map(|d| [d.dexterity, sought.shown(d)]).collect();
        page.chart(
            &Chart::new("Arms of the front", "least 1/κ in the area", sought.axis)
                .dots("found", points),
        );
    }
    page.heading("The arms");
    let arms = arms(found);
    let rows: Vec<Vec<String>> = arms
        .iter()
        .map(|(name, design)| row(name, design))
        .collect();
    page.table(
        &[
            "arm",
            "l1 [mm]",
            "l2 [mm]",
            "l3 [mm]",
            "l4 [mm]",
            "base [mm]",
            "size [mm]",
            "place x, y [mm]",
            "1/κ",
            "torque [N·m/N]",
            "speed [mm/s]",
            "stiffness [N/m]",
            "error [µm]",
        ],
        &rows,
    );
    page.paragraph(
        "At the worst point of the area: the torque of a motor for a force of 1 N in any direction, the speed of the \
         tip in every direction with no motor above 1 rad/s, its stiffness with drives of 1 N·m/rad, and its RMS error \
         under the specification's tolerances.",
    );
    let drawn = &arms[..arms.len().min(MOST_DRAWN)];
    page.figure(
        &designs(drawn, &specification.area),
        &match arms.len() - drawn.len() {
            0 => "The arms with their areas, at one scale.".to_owned(),
            more => format!(
                "The first arms with their areas, at one scale; {more} more are in the table."
            ),
        },
    );
    page.heading("Which millimetre matters");
    let loss = found.sensitivity.map(|loss| format!("{:.5}", 1e-3 * loss));
    page.table(
        &["", "l1", "l2", "l3", "l4", "base"],
        &[[vec!["loss of 1/κ per mm".to_owned()], loss.to_vec()].concat()],
    );
    page
}

/// The arms by name: the best, of lengths in stock, and the others of the front.
fn arms(found: &Synthesis) -> Vec<(String, Design)> {
    let first = [
        ("best".to_owned(), found.best),
        ("stock".to_owned(), found.stock),
    ];
    let others = found.front.iter().enumerate().skip(1);
    let others = others.map(|(index, design)| (format!("front {}", index + 1), *design));
    first.into_iter().chain(others).collect()
}

fn row(name: &str, design: &Design) -> Vec<String> {
    let mm = |length: f64| format!("{:.2}", 1e3 * length);
    let measures = design.measures;
    let mut row = vec![name.to_owned()];
    row.extend(design.lengths.map(mm));
    row.push(mm(design.size));
    row.push(design.place.map(mm).join(", "));
    row.push(format!("{:.3}", design.dexterity));
    row.push(format!("{:.4}", measures.torque));
    row.push(format!("{:.2}", 1e3 * measures.speed));
    row.push(format!("{:.2}", measures.stiffness));
    row.push(match measures.error {
        0.0 => "–".to_owned(),
        error => format!("{:.1}", 1e6 * error),
    });
    row
}

/// What is sought, in the words and the unit of the page.
struct Sought {
    name: &'static str,
    axis: &'static str,
    unit: &'static str,
    /// The unit of the axis in that unit.
    scale: f64,
    of: fn(&Design) -> f64,
}

impl Sought {
    fn of(objective: Objective) -> Self {
        let (name, axis, unit, scale, of): (_, _, _, _, fn(&Design) -> f64) = match objective {
            Objective::LinkSum(_) => (
                "links and half the base",
                "links and half the base [mm]",
                "m",
                1e3,
                Design::link_sum,
            ),
            Objective::Measure(Measure::Torque, _) => (
                "torque for 1 N",
                "torque for 1 N [mN·m]",
                "N·m",
                1e3,
                |d| d.measures.torque,
            ),
            Objective::Measure(Measure::Speed, _) => (
                "speed at 1 rad/s",
                "speed at 1 rad/s [mm/s]",
                "m/s",
                1e3,
                |d| d.measures.speed,
            ),
            Objective::Measure(Measure::Stiffness, _) => (
                "stiffness for 1 N·m/rad",
                "stiffness for 1 N·m/rad [N/m]",
                "N/m",
                1.0,
                |d| d.measures.stiffness,
            ),
            Objective::Measure(Measure::Error, _) => {
                ("RMS error", "RMS error [µm]", "m", 1e6, |d| {
                    d.measures.error
                })
            }
            _ => ("size of the area", "size of the area [mm]", "m", 1e3, |d| {
                d.size
            }),
        };
        Self {
            name,
            axis,
            unit,
            scale,
            of,
        }
    }

    fn text(&self, design: &Design) -> String {
        quantity((self.of)(design), self.unit)
    }

    fn shown(&self, design: &Design) -> f64 {
        self.scale * (self.of)(design)
    }
}
