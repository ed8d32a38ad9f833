//! The margins of a loop as text.

use crate::study::margins::MarginsStudy;
use fivebar_kinematics::five_bar::Joint;
use std::fmt::Write as _;

/// What the loop is, how far it is from instability, and where.
pub fn margins(study: &MarginsStudy<'_>) -> String {
    let control = &study.robot.control;
    let worst = study.worst();
    let [theta1, theta4] = worst.theta;
    let loops = match study.robot.gains().belts {
        None => format!(
            "position loop {:.0} rad/s, integral {:.0} rad/s, observer {:.0} rad/s",
            control.bandwidth, control.integral_rate, control.observer_bandwidth
        ),
        Some([belt1, belt4]) => format!(
            "loops of both sides of the belts, feedback {:.0} and {:.0} rad/s",
            belt1.bandwidth, belt4.bandwidth
        ),
    };
    let current = study.current_bandwidth();
    let mut text = format!(
        "{}: {loops}, current loop {current:.0} rad/s, tick {:.0} Hz\n\
         worst of {} poses: θ1 = {theta1:.3} rad, θ4 = {theta4:.3} rad, C at ({:.1}, {:.1}) mm\n",
        study.robot.name,
        control.tick_rate,
        study.poses.len(),
        1e3 * worst.tool[0],
        1e3 * worst.tool[1],
    );
    let Some(margins) = &worst.margins else {
        let _ = writeln!(
            text,
            "unstable there: lower `bandwidth` of [control], or leave [control] out"
        );
        return text;
    };
    let factor = |value: f64| match value {
        value if value.is_finite() && value > 0.0 => format!("{value:.2}"),
        _ => "none".to_owned(),
    };
    let _ = writeln!(
        text,
        "  modulus margin      {:.3}   (greatest sensitivity {:.2}; 0.5 or more is good)\n\
         \u{20} gain, up            {}   times as much torque makes it oscillate\n\
         \u{20} gain, down          {}\n\
         \u{20} phase               {:.1}°\n\
         \u{20} delay               {:.0} µs",
        margins.modulus,
        1.0 / margins.modulus,
        factor(margins.gain_up),
        factor(margins.gain_down),
        margins.phase.to_degrees(),
        1e6 * margins.delay,
    );
    belts(&mut text, study);
    let _ = writeln!(
        text,
        "  torque by counts    {:.2} % of the peak torque, root mean square",
        100.0 * study.noise
    );
    if let Some(stiffness) = &study.passive_stiffness {
        let ([low, high], [least, most]) = (stiffness.home, stiffness.range);
        let _ = writeln!(
            text,
            "  rendered springs    at home up to {low:.0} N/m in all directions, {high:.0} N/m along one; \
             {least:.0} to {most:.0} N/m over the poses"
        );
    }
    if margins.modulus < 0.5 {
        text.push_str(
            "warning: below 0.5 the loop amplifies disturbances more than twice; lower \
             `bandwidth`, or leave the bandwidths of [control] out\n",
        );
    }
    text
}

/// What is of belts: frequencies, the worst arm of the range, and how far a load moves the tip.
fn belts(text: &mut String, study: &MarginsStudy<'_>) {
    for (joint, resonance) in Joint::ALL.into_iter().zip(study.resonance) {
        if let Some(frequency) = resonance {
            let _ = writeln!(
                text,
                "  drive of {joint}    free frequency {frequency:.0} Hz"
            );
        }
    }
    if let [Some(low), Some(high)] = study.modes {
        let _ = writeln!(
            text,
            "  modes of the arm    {low:.0} Hz and {high:.0} Hz, on both belts"
        );
    }
    let _ = match study.modulus_range {
        Some(modulus) => writeln!(
            text,
            "  over the range      modulus margin {modulus:.3} or more, with 80 to 130 % of the links' inertia and \
             0 to twice the payload, at all poses"
        ),
        None => writeln!(
            text,
            "  over the range      unstable with some arm of 80 to 130 % of the links' inertia and 0 to twice the payload"
        ),
    };
    if let Some(peak) = study.disturbance_peak {
        let _ = writeln!(
            text,
            "  load at the tip     it yields at most {peak:.2} times as far as to a constant one without the integral"
        );
    }
}
