//! The design of a crank-rocker: which coupler transmits force best, and what torque its
//! crank needs.
//!
//! `cargo run --example linkage_design`

use fivebar_design::linkage::dyad::Rrr;
use fivebar_design::linkage::{DriveLaw, FourBarType, Group, LinkId, Linkage, Sweep};
use fivebar_kinematics::dynamics::Link;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;
use std::error::Error;
use std::f64::consts::TAU;

const FRAME: f64 = 0.20; // m
const CRANK: f64 = 0.06; // m
const ROCKER: f64 = 0.14; // m
const SPEED: f64 = 20.0; // rad/s
/// Mass of the bars per length [kg/m].
const BAR: f64 = 0.5;

fn crank_rocker(coupler: f64) -> Result<Linkage<f64>, Box<dyn Error>> {
    let mut linkage = Linkage::new(Vector2::zeros())?;
    let a = linkage.add_point("A", LinkId::GROUND, Vector2::zeros())?;
    let d = linkage.add_point("D", LinkId::GROUND, Vector2::new(FRAME, 0.0))?;
    let crank = linkage.add_group("crank", Group::Crank { pivot: a })?;
    let b = linkage.add_point("B", crank.first_link(), Vector2::new(CRANK, 0.0))?;
    let dyad = Rrr {
        lengths: [coupler, ROCKER],
        side: Side::Left,
    };
    let dyad = linkage.add_group("C", Group::Rrr { dyad, ends: [b, d] })?;
    let bars = [("crank", CRANK), ("coupler", coupler), ("rocker", ROCKER)];
    for (link, (name, length)) in crank.links().chain(dyad.links()).zip(bars) {
        linkage.set_link(link, name, Link::uniform_rod(BAR * length, length))?;
    }
    Ok(linkage)
}

/// One turn of the crank at constant speed.
fn turn(linkage: &Linkage<f64>) -> Sweep {
    let law = DriveLaw {
        speed: SPEED,
        ..DriveLaw::default()
    };
    Sweep::new(linkage, &[law], TAU / SPEED, 720)
}

/// The least transmission angle μ over a turn [rad].
fn least_transmission_angle(sweep: &Sweep) -> f64 {
    let solved = sweep.solved().map(|(_, solved)| solved);
    let angles = solved.filter_map(|solved| Some(solved.motion.dyads[1]?.transmission_angle()));
    angles.fold(TAU, f64::min)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("coupler [mm]   least transmission angle [°]");
    let mut best = (0.0, 0.0);
    for millimetres in (160..=240).step_by(10) {
        let coupler = 1e-3 * f64::from(millimetres);
        let linkage = crank_rocker(coupler)?;
        let four_bar = linkage.four_bar().ok_or("no four-bar")?;
        assert_eq!(four_bar.classify(), FourBarType::CrankRocker);
        let sweep = turn(&linkage);
        assert!(sweep.limits.is_empty(), "the crank turns fully");
        let angle = least_transmission_angle(&sweep);
        println!("{millimetres:12} {:20.1}", angle.to_degrees());

        // The extremes are where the crank lies along the frame: |BD| = frame ∓ crank.
        let extreme = [FRAME - CRANK, FRAME + CRANK].map(|diagonal| {
            let square = coupler * coupler + ROCKER * ROCKER - diagonal * diagonal;
            (square / (2.0 * coupler * ROCKER)).abs().acos()
        });
        assert!((angle - extreme[0].min(extreme[1])).abs() < 1e-6);
        if angle > best.1 {
            best = (coupler, angle);
        }
    }
    let (coupler, angle) = best;
    assert!(angle.to_degrees() > 40.0, "40° is the usual least value");

    // At constant speed the torque only moves energy to and fro: its mean over a turn is 0.
    let sweep = turn(&crank_rocker(coupler)?);
    let torques = sweep.solved().map(|(_, solved)| solved.forces.driving[0]);
    let torques: Vec<f64> = torques.collect();
    let greatest = torques.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
    let mean = torques.iter().skip(1).sum::<f64>() / 720.0;
    let millimetres = 1e3 * coupler;
    println!("best coupler: {millimetres:.0} mm, at most {greatest:.3} N·m");
    assert!(greatest > 0.01 && mean.abs() < 1e-6 * greatest);
    Ok(())
}

#[test]
fn the_best_coupler_transmits_force_well() -> Result<(), Box<dyn Error>> {
    main()
}
