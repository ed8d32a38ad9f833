//! The report of a sweep: animation, structure, curves, forces.

mod motion;
mod structure;

use crate::html::{Chart, Page, Point};
use crate::study;
use crate::study::linkage::{Range, SHOWN_ASSEMBLIES, Summary};
use crate::text::quantity;
use fivebar_design::linkage::{LinkId, SolvedSample, Sweep};
use fivebar_files::linkage::{DrivenLinkage, driven_links, dyads, reaction_names};
use fivebar_kinematics::PlanarVector;

/// The page of a sweep.
pub fn linkage(driven: &DrivenLinkage, sweep: &Sweep, summary: &Summary) -> Page {
    let mut page = Page::new(&driven.name);
    key_figures(&mut page, summary);
    page.animation(&motion::animation(driven, sweep));
    put_together(&mut page, driven, summary);
    curves(&mut page, driven, sweep);
    limits(&mut page, summary);
    forces(&mut page, driven, sweep, summary);
    page
}

fn key_figures(page: &mut Page, summary: &Summary) {
    let mut figures = vec![("degrees of freedom", summary.freedoms.to_string())];
    let least = |worst: f64, range: &Range| worst.min(range.min);
    let angle = summary.transmission.iter().fold(f64::INFINITY, least);
    if angle.is_finite() {
        figures.push(("least transmission angle", format!("{angle:.1}°")));
    }
    let drives = summary.driving.iter();
    let drives: Vec<_> = drives
        .map(|range| {
            let peak = range.max.abs().max(range.min.abs());
            let name = format!("peak drive, {}", range.of);
            (name, quantity(peak, range.unit))
        })
        .collect();
    figures.extend(
        drives
            .iter()
            .map(|(name, peak)| (name.as_str(), peak.clone())),
    );
    let peak = summary.peak_reactions.iter().map(|peak| peak.force_n);
    figures.push(("peak joint force", quantity(peak.fold(0.0, f64::max), "N")));
    let share = summary.closed as f64 / summary.samples as f64;
    figures.push(("closes over", format!("{:.0} %", 100.0 * share)));
    page.key_figures(&figures);
}

fn put_together(page: &mut Page, driven: &DrivenLinkage, summary: &Summary) {
    page.heading("Structure");
    page.paragraph(
        "Driven links come first. Every other pair of links is an Assur dyad, which adds no \
         degree of freedom: its position, velocity and acceleration follow from those of the \
         points and guides that carry it. The linkage is solved element by element, in this \
         order. Angles are counter-clockwise from +x, lengths in metres.",
    );
    let header = ["", "kind", "links", "carried by", "dimensions", "branch"];
    page.table(&header, &structure::elements(driven));
    page.table(
        &["link", "mass", "centre of mass", "inertia"],
        &structure::masses(driven),
    );
    for equation in structure::equations(driven) {
        page.paragraph(equation);
    }
    if let Some(grashof) = &summary.grashof {
        page.paragraph(&format!(
            "By Grashof's rule (shortest + longest length compared with the sum of the other \
             two), the four-bar is a {grashof}."
        ));
    }
}

fn curves(page: &mut Page, driven: &DrivenLinkage, sweep: &Sweep) {
    let linkage = &driven.linkage;
    page.heading("Curves of the points");
    let mut chart = Chart::new("Curves", "x [m]", "y [m]").with_equal_aspect();
    for (name, points) in motion::curves(driven, sweep) {
        chart = chart.line(name, points);
    }
    page.chart(&chart);

    page.heading("Motion");
    page.paragraph(
        "Rates and accelerations are solved exactly, without differences. Tests compare them with \
         the derivatives of the curves above.",
    );
    let points = linkage.points().iter().enumerate();
    let points: Vec<_> = points
        .filter(|(_, point)| point.link != LinkId::GROUND)
        .map(|(i, point)| (i, &point.name))
        .collect();
    let turns = |i: usize| sweep.solved().any(|(_, s)| s.motion.links[i].omega != 0.0);
    let links = linkage.links().iter().enumerate().skip(1);
    let links: Vec<_> = links
        .filter(|&(i, _)| turns(i))
        .map(|(i, link)| (i, &link.name))
        .collect();
    let axis = Axis::of(driven);
    let mut angles = Chart::new("Angles of the links", axis.label(), "angle [°]");
    for &(i, name) in &links {
        let mut line = axis.line(sweep, |s| s.motion.links[i].axis.polar_angle().to_degrees());
        unwrap(&mut line);
        angles = angles.line(name, line);
    }
    if !links.is_empty() {
        page.chart(&angles);
    }
    let mut plot =
        |title, label, of: &[(usize, &String)], value: fn(&SolvedSample, usize) -> f64| {
            let mut chart = Chart::new(title, axis.label(), label);
            for &(i, name) in of {
                chart = chart.line(name, axis.line(sweep, |solved| value(solved, i)));
            }
            if !of.is_empty() {
                page.chart(&chart);
            }
        };
    plot("Angular velocities", "ω [rad/s]", &links, |s, i| {
        s.motion.links[i].omega
    });
    plot("Angular accelerations", "α [rad/s²]", &links, |s, i| {
        s.motion.links[i].alpha
    });
    plot("Speeds of the points", "speed [m/s]", &points, |s, i| {
        s.motion.points[i].velocity.norm()
    });
    let label = "acceleration [m/s²]";
    plot("Accelerations of the points", label, &points, |s, i| {
        s.motion.points[i].acceleration.norm()
    });
    slides(page, driven, sweep);
    transmission(page, driven, sweep);
}

fn slides(page: &mut Page, driven: &DrivenLinkage, sweep: &Sweep) {
    let axis = Axis::of(driven);
    let mut chart = Chart::new("Sliding joints", axis.label(), "displacement [m]");
    for (dyad, name) in dyads(&driven.linkage) {
        for k in 0..study::linkage::sliding_joints(&driven.linkage.elements()[dyad].group) {
            let line = axis.line(sweep, |solved| {
                let slide = solved.motion.dyads[dyad].and_then(|dyad| dyad.slides[k]);
                slide.map_or(f64::NAN, |slide| slide.value)
            });
            chart = chart.line(format!("{name}, slide {}", k + 1), line);
        }
    }
    if !chart.series.is_empty() {
        page.chart(&chart);
    }
}

fn transmission(page: &mut Page, driven: &DrivenLinkage, sweep: &Sweep) {
    page.heading("Transmission angle");
    page.paragraph(
        "μ of a dyad: sin μ is the determinant of its rate equations, divided by the lengths. \
         90° transmits motion and force best; at 0° the dyad is singular. Below about 40° a \
         machine runs roughly.",
    );
    let axis = Axis::of(driven);
    let mut chart = Chart::new("Transmission angle", axis.label(), "μ [°]");
    for (dyad, name) in dyads(&driven.linkage) {
        let line = axis.line(sweep, |solved| {
            let dyad = solved.motion.dyads[dyad];
            dyad.map_or(f64::NAN, |dyad| dyad.transmission_angle().to_degrees())
        });
        chart = chart.line(name, line);
    }
    page.chart(&chart);
}

fn limits(page: &mut Page, summary: &Summary) {
    page.heading("Limits of motion and branches");
    if summary.limits.is_empty() {
        let extent = match summary.closed {
            0 => "The linkage does not close anywhere in the sweep on this assembly.",
            _ => "The linkage moves through the whole sweep without a limit.",
        };
        page.paragraph(extent);
    } else {
        let rows = summary.limits.iter().map(|limit| {
            let inputs: Vec<_> = limit.inputs.iter().map(|x| format!("{x:.9}")).collect();
            vec![
                format!("{:.6} s", limit.time_s),
                inputs.join(", "),
                if limit.ends {
                    "motion ends"
                } else {
                    "motion begins"
                }
                .into(),
                limit.reason.clone(),
            ]
        });
        let header = ["time", "inputs [rad or m]", "", "beyond it"];
        page.table(&header, &rows.collect::<Vec<_>>());
    }
    for change in &summary.branch_changes {
        page.paragraph(&format!(
            "Shortly before {:.6} s, {} passes a dead point. A smooth motion would continue on its \
             other branch; the figures here are of the stated branch.",
            change.time_s, change.dyad
        ));
    }
    if summary.assemblies.len() > 1 {
        page.paragraph(
            "The same links can be assembled in these ways; each dyad with two branches doubles \
             their number. This report shows the first.",
        );
        let shown = summary.assemblies.iter().take(SHOWN_ASSEMBLIES);
        let rows = shown.map(|assembly| {
            let share = format!("{:.0} %", 100.0 * assembly.closes);
            vec![assembly.branches.clone(), share]
        });
        page.table(&["branches", "closes over"], &rows.collect::<Vec<_>>());
    }
}

fn forces(page: &mut Page, driven: &DrivenLinkage, sweep: &Sweep, summary: &Summary) {
    page.heading("Forces");
    page.paragraph(
        "With the inertia forces −m a and −I α among the loads (d'Alembert), each dyad is in \
         equilibrium: six equations for the two unknowns of each of its three joints. Dyads are \
         solved from the last to the first, and each loads the links that carry it. The driven \
         link comes last and gives the driving torque or force. Joints have no friction.",
    );
    let axis = Axis::of(driven);
    for (unit, title, label) in [
        ("rad", "Driving torque", "torque [N·m]"),
        ("m", "Driving force", "force [N]"),
    ] {
        let mut chart = Chart::new(title, axis.label(), label);
        for (k, (link, of)) in driven_links(&driven.linkage).enumerate() {
            if of == unit {
                chart = chart.line(link, axis.line(sweep, |s| s.forces.driving[k]));
            }
        }
        if !chart.series.is_empty() {
            page.chart(&chart);
        }
    }
    let mut chart = Chart::new("Joint forces", axis.label(), "force [N]");
    for (k, name) in reaction_names(&driven.linkage).into_iter().enumerate() {
        let force = |s: &SolvedSample| s.forces.reactions[k].wrench.force.norm();
        chart = chart.line(name, axis.line(sweep, force));
    }
    page.chart(&chart);
    let rows = summary.peak_reactions.iter().map(|peak| {
        let time = format!("{:.4} s", peak.time_s);
        let moment = quantity(peak.moment_nm, "N·m");
        vec![
            peak.joint.clone(),
            quantity(peak.force_n, "N"),
            time,
            moment,
        ]
    });
    page.paragraph(
        "The moment is about the joint's centre: in a driven pin it is the driving torque, in a \
         slide it keeps the slider from tilting, in a free pin it is zero.",
    );
    page.table(
        &["joint", "peak force", "at", "peak moment"],
        &rows.collect::<Vec<_>>(),
    );
    let frame = Chart::new("Shaking force on the frame", axis.label(), "force [N]")
        .line("x", axis.line(sweep, |s| s.forces.frame.force.x))
        .line("y", axis.line(sweep, |s| s.forces.frame.force.y));
    page.chart(&frame);
}

/// The horizontal axis of the curves.
#[derive(Clone, Copy)]
enum Axis {
    /// The angle of the only driven link, a crank with constant speed [°].
    Crank,
    /// Time [s].
    Time,
}

impl Axis {
    fn of(driven: &DrivenLinkage) -> Self {
        let mut links = driven_links(&driven.linkage);
        match (links.next(), links.next(), &driven.laws[..]) {
            (Some((_, "rad")), None, [law]) if law.amplitude == 0.0 && law.speed != 0.0 => {
                Self::Crank
            }
            _ => Self::Time,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Crank => "crank angle [°]",
            Self::Time => "time [s]",
        }
    }

    /// A quantity over this axis, with gaps where the linkage does not close.
    fn line(self, sweep: &Sweep, value: impl Fn(&SolvedSample) -> f64) -> Vec<Point> {
        let samples = sweep.samples.iter();
        samples
            .map(|sample| {
                let x = match (self, &sample.inputs[..]) {
                    (Self::Crank, [input, ..]) => input.value.to_degrees(),
                    _ => sample.time,
                };
                [x, sample.solved.as_ref().map_or(f64::NAN, &value)]
            })
            .collect()
    }
}

/// Removes jumps of whole turns [°].
fn unwrap(line: &mut [Point]) {
    let (mut turns, mut last) = (0.0, f64::NAN);
    for [_, angle] in line.iter_mut().filter(|[_, angle]| angle.is_finite()) {
        let jump: f64 = *angle - last;
        if jump.abs() > 180.0 {
            turns -= 360.0 * jump.signum();
        }
        last = *angle;
        *angle += turns;
    }
}
