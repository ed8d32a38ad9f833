//! A synthesis as text.

use super::quantity;
use fivebar_design::synthesis::{Design, Drive, Load, Proof, Synthesis};
use std::fmt::Write as _;

/// The designs as a table, which millimetre matters, and what is proved.
pub fn synthesis(synthesis: &Synthesis) -> String {
    let mut text = String::from(
        "                    l1       l2       l3       l4     base      sum     size   1/κ  place x, y\n",
    );
    row(&mut text, "best", &synthesis.best);
    row(&mut text, "stock", &synthesis.stock);
    for (index, design) in synthesis.front.iter().enumerate().skip(1) {
        row(&mut text, &format!("front {}", index + 1), design);
    }
    text.push_str(
        "at the worst point  torque for 1 N  speed at 1 rad/s  stiffness at 1 N·m/rad  RMS error\n",
    );
    for (name, design) in [("best", &synthesis.best), ("stock", &synthesis.stock)] {
        let measures = design.measures;
        let error = match measures.error {
            0.0 => "no tolerance given".to_owned(),
            error => quantity(error, "m"),
        };
        let _ = writeln!(
            text,
            "{name:<18}  {:>14}  {:>16}  {:>22}  {error}",
            quantity(measures.torque, "N·m"),
            quantity(measures.speed, "m/s"),
            quantity(measures.stiffness, "N/m"),
        );
    }
    for ((name, design), drive) in [("best", &synthesis.best), ("stock", &synthesis.stock)]
        .into_iter()
        .zip(&synthesis.drives)
    {
        text += &drive_line(name, design, drive.as_ref());
    }
    let per_mm = synthesis.sensitivity.map(|loss| 1e-3 * loss);
    let _ = write!(text, "loss of 1/κ per mm");
    for loss in per_mm {
        let _ = write!(text, "  {loss:.5}");
    }
    let _ = writeln!(
        text,
        "\nlengths in mm; {} areas examined",
        synthesis.evaluations
    );
    for (what, proof) in [
        ("best:", synthesis.proof),
        ("stock:", synthesis.stock_proof),
    ] {
        let _ = writeln!(text, "{}", proof_sentence(what, proof));
    }
    text
}

/// What the payload asks of a drive, and the cheapest one that suffices; nothing without a payload.
pub(crate) fn drive_line(name: &str, design: &Design, drive: Option<&Drive>) -> String {
    let load = design.load;
    if load == Load::default() {
        return String::new();
    }
    let drive = match drive {
        Some(drive) => format!(
            "{}, {} and {} each",
            drive.name,
            drive.price,
            quantity(drive.mass, "kg")
        ),
        None => "no drive of the list suffices".to_owned(),
    };
    format!(
        "{name}: a drive needs {}, {} and {}: {drive}\n",
        quantity(load.torque, "N·m"),
        quantity(load.speed, "rad/s"),
        quantity(load.acceleration, "rad/s²"),
    )
}

/// Whether `what` is proved.
pub(crate) fn proof_sentence(what: &str, proof: Proof) -> String {
    let near = |[x, y]: [f64; 2]| {
        format!(
            "near ({:.3}, {:.3}) mm from the middle of the base",
            1e3 * x,
            1e3 * y
        )
    };
    match proof {
        Proof::Proved => format!("{what} proved free of singularities in its area"),
        Proof::Refuted(place) => {
            format!(
                "{what} singular in its area, or a crank beyond its range, {}",
                near(place)
            )
        }
        Proof::Undecided(place) => {
            format!("{what} not proved free of singularities {}", near(place))
        }
    }
}

fn row(text: &mut String, name: &str, design: &Design) {
    let _ = write!(text, "{name:<14}");
    for length in design
        .lengths
        .into_iter()
        .chain([design.link_sum(), design.size])
    {
        let _ = write!(text, " {:>8.2}", 1e3 * length);
    }
    let [x, y] = design.place.map(|place| 1e3 * place);
    let _ = writeln!(text, " {:>5.3}  {x:.2}, {y:.2}", design.dexterity);
}
