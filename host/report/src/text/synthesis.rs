//! A synthesis as text.

use fivebar_design::synthesis::{Design, Proof, Synthesis};
use std::fmt::Write as _;

/// The designs as a table, which millimetre matters, and what is proved.
pub fn synthesis(synthesis: &Synthesis) -> String {
    let mut text = String::from(
        "                    l1       l2       l3       l4     base      sum     size   1/κ  place x, y\n",
    );
    row(&mut text, "best", &synthesis.best);
    row(&mut text, "whole mm", &synthesis.whole);
    for (index, design) in synthesis.front.iter().enumerate().skip(1) {
        row(&mut text, &format!("front {}", index + 1), design);
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
        ("best", synthesis.proof),
        ("whole mm", synthesis.whole_proof),
    ] {
        let _ = match proof {
            Proof::Proved => writeln!(text, "{what}: proved free of singularities in its area"),
            Proof::Refuted([x, y]) => writeln!(
                text,
                "{what}: singular in its area, near ({:.3}, {:.3}) mm from the middle of the base",
                1e3 * x,
                1e3 * y
            ),
            Proof::Undecided([x, y]) => writeln!(
                text,
                "{what}: not proved free of singularities near ({:.3}, {:.3}) mm from the middle of the base",
                1e3 * x,
                1e3 * y
            ),
        };
    }
    text
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
