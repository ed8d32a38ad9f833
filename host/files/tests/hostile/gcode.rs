//! Hostile G-code.

use crate::{Kind, counted, kind};

pub(crate) fn kinds() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for letter in ["X", "F", "N", "G", "M", "T", "S", "X-", "X.", "X0."] {
        let name = format!("gcode: 40,000 digits behind {letter}");
        kinds.push(kind(name, move || {
            format!("G0 X1\n{letter}{}\n", "1".repeat(counted(40_000)))
        }));
    }
    // A part that is repeated, on lines of its own or on one line.
    for (name, part, count) in [
        ("empty lines", "\n", 1_100_000),
        ("carriage returns", "\r", 1_100_000),
        ("lines", "G1 X1\nG1 X0\n", 100_000),
        ("comments on a line", "()", 500_000),
        ("open comments", "(", 500_000),
        ("exponents", "1e1", 300_000),
        ("blanks in a number", "1 ", 300_000),
        ("codes on a line", "M7 ", 200_000),
        ("tools on a line", "T1 ", 200_000),
        ("motions on a line", "G1", 200_000),
        ("arcs of a rounding", "G2 X0.001 I5\nG2 X0 I5\n", 30_000),
        ("circles of a kilometre", "G2 I-900000\n", 30_000),
        ("stops", "M0 (wait)\nG1 X1\nG1 X0\n", 30_000),
        ("modes", "M780 I1 J-1\n", 30_000),
        ("crossings", "M781 X1 Y1 P1\n", 30_000),
        ("settings", "$32=1\n", 100_000),
        ("shifts", "G92 X1\nG92.1\nG10 L20 P1 X9\n", 30_000),
        ("dwells", "G4 P1\n", 100_000),
        ("slashes", "/", 500_000),
        ("stars", "*", 500_000),
        ("percent signs", "%\n", 300_000),
        ("zeros", "\0", 500_000),
        ("quotation marks", "M117 \"", 200_000),
        ("relative kilometres", "G91 G1 X900000\n", 10),
        ("arcs of many turns", "G2 X0.001 Y0 I-5 J0 P1000\n", 30_000),
        ("parameters", "#1=[1+2]\nG1 X#1\n", 60_000),
        ("expressions", "[1+", 200_000),
        ("loops", "o100 while [1 GT 0]\no100 endwhile\n", 60_000),
        ("calls of macros", "M98 P1 L1000000\n", 60_000),
        ("dwells of nothing", "G4 P0.000\n", 200_000),
        ("coordinate systems", "G10 L2 P1 X1\nG54\nG55\n", 60_000),
        (
            "arcs by radius of half a turn",
            "G2 X9 Y9 R6.364\nG2 X0 Y0 R6.364\n",
            60_000,
        ),
        (
            "changes of tools with comments",
            "T1 M6 (a pen)\nG1 X1\nG1 X0\n",
            60_000,
        ),
        (
            "scripts of a slicer",
            "; thumbnail begin 9x9 9\n;QUJD\n",
            300_000,
        ),
    ] {
        let text = move || format!("G21 G90 F600\nG1 X0\n{}", part.repeat(counted(count)));
        kinds.push(kind(format!("gcode: {name}"), text));
    }
    // A line with a number of its own each.
    for (name, line) in [
        ("kinds of unknown codes", "M1#"),
        ("angles of a servo", "M280 P0 S#\nG1 X#"),
        ("kinds of tools", "T#"),
        ("line numbers", "N# G1 X1"),
        ("speeds of a spindle", "M3 S#\nG1 X#"),
        ("commands of a printer", "START_# A=1"),
    ] {
        let text = move || {
            let lines =
                (1..counted(60_000)).map(|n| line.replace('#', &(n % 50_000).to_string()) + "\n");
            format!("F600\nG1 X0\n{}", lines.collect::<String>())
        };
        kinds.push(kind(format!("gcode: {name}"), text));
    }
    kinds
}
