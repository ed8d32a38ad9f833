//! The page of a loop's margins: Bode and sensitivity plots at the worst pose, and the map.

use crate::html::{Chart, Page};
use crate::study::margins::MarginsStudy;
use crate::text;
use std::f64::consts::TAU;

/// The page.
pub fn margins(study: &MarginsStudy<'_>) -> Page {
    let mut page = Page::new(format!(
        "{}: margins of the position loop",
        study.robot.name
    ));
    let parts = match study.robot.can_drives() {
        None => {
            "current loop with its tick of delay, windings, springs of the drives, the arm's inertia, the encoder's \
             latency"
        }
        Some(_) => {
            "the bus, the drives' own current loops, springs and dampers, the arm's inertia, the age of the answers"
        }
    };
    page.paragraph(&format!(
        "The whole sampled loop: observers, prediction, position loop, computed torque, {parts}. It is opened at both \
         torques at once; the lines are the two eigenvalues of the open loop at the worst pose."
    ));
    for line in text::margins(study).lines() {
        page.paragraph(line.trim());
    }
    let decibel = |size: f64| 20.0 * size.max(1e-9).log10();
    let lines = |value: &dyn Fn(nalgebra::Complex<f64>) -> f64, i: usize| {
        study
            .loci
            .iter()
            .map(|point| [point.omega / TAU, value(point.loci[i])])
            .collect::<Vec<[f64; 2]>>()
    };
    let x = "frequency [Hz]";
    let both = |title: &str, unit: &str, value: &dyn Fn(nalgebra::Complex<f64>) -> f64| {
        Chart::new(title, x, unit)
            .line("first eigenvalue", lines(value, 0))
            .dashed("second eigenvalue", lines(value, 1))
            .with_log_x()
    };
    page.chart(&both("Open loop: size", "size [dB]", &|l| {
        decibel(l.norm())
    }));
    page.chart(&both("Open loop: phase", "phase [°]", &|l| {
        l.arg().to_degrees()
    }));
    page.chart(&both("Sensitivity 1/(1 + λ)", "size [dB]", &|l| {
        -decibel((l + 1.0).norm())
    }));
    let rows: Vec<Vec<String>> = study
        .poses
        .iter()
        .map(|pose| {
            let mut row: Vec<String> = pose.theta.iter().map(|t| format!("{t:.3}")).collect();
            row.extend(pose.tool.iter().map(|x| format!("{:.1}", 1e3 * x)));
            row.push(
                pose.margins
                    .map_or("unstable".into(), |m| format!("{:.3}", m.modulus)),
            );
            row
        })
        .collect();
    page.heading("All poses");
    page.table(
        &["θ1 [rad]", "θ4 [rad]", "x [mm]", "y [mm]", "modulus margin"],
        &rows,
    );
    page
}
