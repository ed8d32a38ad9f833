//! A sweep as a table: a row for each sample, a column for each quantity. Cells are empty where
//! the linkage cannot be assembled.

use super::table::Table;
use crate::study::linkage::explain;
use crate::study::linkage::{moment, sliding_joints};
use fivebar_design::linkage::{
    Coordinate, LinkMotion, Linkage, PointMotion, Reaction, SolvedSample, Sweep,
};
use fivebar_files::linkage::{DrivenLinkage, driven_links, dyads, reaction_names};
use fivebar_kinematics::PlanarVector;

/// A quantity of a sample.
struct Column {
    header: String,
    value: Box<dyn Fn(&SolvedSample) -> f64>,
}

type Part<T> = (&'static str, fn(&T) -> f64);

const OF_POINTS: [Part<PointMotion<f64>>; 6] = [
    ("x_m", |p| p.position.x),
    ("y_m", |p| p.position.y),
    ("vx_m_s", |p| p.velocity.x),
    ("vy_m_s", |p| p.velocity.y),
    ("ax_m_s2", |p| p.acceleration.x),
    ("ay_m_s2", |p| p.acceleration.y),
];

const OF_LINKS: [Part<LinkMotion<f64>>; 3] = [
    ("angle_rad", |link| link.axis.polar_angle()),
    ("omega_rad_s", |link| link.omega),
    ("alpha_rad_s2", |link| link.alpha),
];

const OF_SLIDES: [Part<Coordinate<f64>>; 3] = [
    ("m", |slide| slide.value),
    ("rate_m_s", |slide| slide.rate),
    ("acceleration_m_s2", |slide| slide.acceleration),
];

const OF_REACTIONS: [Part<Reaction<f64>>; 3] = [
    ("fx_n", |r| r.wrench.force.x),
    ("fy_n", |r| r.wrench.force.y),
    ("moment_nm", moment),
];

/// The sweep as comma-separated values; each column's header ends in its unit.
pub fn linkage_csv(driven: &DrivenLinkage, sweep: &Sweep) -> String {
    let linkage = &driven.linkage;
    let columns = columns(linkage);
    let inputs = driven_links(linkage).map(|(link, unit)| format!("{link}.input_{unit}"));
    let headers = columns.iter().map(|column| column.header.clone());
    let time = std::iter::once("time_s".into());
    let mut table = Table::new(time.chain(inputs).chain(headers).chain(["failure".into()]));
    for sample in &sweep.samples {
        let inputs = sample.inputs.iter().map(|input| input.value);
        let known = std::iter::once(sample.time).chain(inputs);
        let mut row: Vec<String> = known.map(|value| value.to_string()).collect();
        match &sample.solved {
            Ok(solved) => {
                row.extend(
                    columns
                        .iter()
                        .map(|column| (column.value)(solved).to_string()),
                );
                row.push(String::new());
            }
            Err(failure) => {
                row.extend(columns.iter().map(|_| String::new()));
                row.push(explain(driven, failure));
            }
        }
        table.push(row);
    }
    table.into_text()
}

fn columns(linkage: &Linkage<f64>) -> Vec<Column> {
    let mut columns = Vec::new();
    let mut add = |header: String, value: Box<dyn Fn(&SolvedSample) -> f64>| {
        columns.push(Column { header, value });
    };
    for (i, point) in linkage.points().iter().enumerate() {
        if point.link.index() > 0 {
            for (what, part) in OF_POINTS {
                let header = format!("{}.{what}", point.name);
                add(header, Box::new(move |s| part(&s.motion.points[i])));
            }
        }
    }
    for (i, link) in linkage.links().iter().enumerate().skip(1) {
        for (what, part) in OF_LINKS {
            let header = format!("{}.{what}", link.name);
            add(header, Box::new(move |s| part(&s.motion.links[i])));
        }
    }
    for (i, name) in dyads(linkage) {
        let dyad = move |s: &SolvedSample| s.motion.dyads[i];
        add(
            format!("{name}.transmission_angle_rad"),
            Box::new(move |s| dyad(s).map_or(f64::NAN, |dyad| dyad.transmission_angle())),
        );
        for k in 0..sliding_joints(&linkage.elements()[i].group) {
            for (what, part) in OF_SLIDES {
                let slide = move |s: &SolvedSample| dyad(s)?.slides[k];
                let header = format!("{name}.slide{}_{what}", k + 1);
                add(
                    header,
                    Box::new(move |s| slide(s).as_ref().map_or(f64::NAN, part)),
                );
            }
        }
    }
    for (i, (link, unit)) in driven_links(linkage).enumerate() {
        let drive = if unit == "rad" {
            "torque_nm"
        } else {
            "force_n"
        };
        let header = format!("{link}.driving_{drive}");
        add(header, Box::new(move |s| s.forces.driving[i]));
    }
    for (i, name) in reaction_names(linkage).into_iter().enumerate() {
        for (what, part) in OF_REACTIONS {
            let header = format!("{name}.{what}");
            add(header, Box::new(move |s| part(&s.forces.reactions[i])));
        }
    }
    add("on frame.fx_n".into(), Box::new(|s| s.forces.frame.force.x));
    add("on frame.fy_n".into(), Box::new(|s| s.forces.frame.force.y));
    add(
        "on frame.moment_about_origin_nm".into(),
        Box::new(|s| s.forces.frame.moment),
    );
    columns
}
