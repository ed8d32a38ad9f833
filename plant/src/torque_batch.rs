//! Steps of many arms that make the torques that they are told: four of them side by side, with the bits of one by itself.

use crate::integration::{Step, step_beside};
use crate::torque::{GREATEST_TURN, TorquePlant, internal_steps};
use fivebar_firmware::ActuatorCommand;

/// Arms side by side: as many numbers as an instruction of AVX2 computes.
const BESIDE: usize = 4;

impl TorquePlant {
    /// Advances many arms by `time` [s], each as [`TorquePlant::step`] with its torques on the rotors [N·m] and its force on
    /// the tool [N]. Returns the first one that cannot go on; each of those is then as it was.
    ///
    /// # Panics
    /// If there are fewer torques or forces than arms.
    pub fn step_many(
        arms: &mut [Self],
        torques: &[[f64; 2]],
        forces: &[[f64; 2]],
        time: f64,
    ) -> Option<usize> {
        for (index, arm) in arms.iter_mut().enumerate() {
            arm.set_tool_force(forces[index].into());
            arm.set_torque(torques[index]);
        }
        let (groups, rest) = arms.as_chunks_mut::<BESIDE>();
        let in_groups = BESIDE * groups.len();
        let mut first = None;
        for (index, group) in groups.iter_mut().enumerate() {
            for (lane, stopped) in step_group(group, time).into_iter().enumerate() {
                first = first.or(stopped.then_some(BESIDE * index + lane));
            }
        }
        for (index, arm) in rest.iter_mut().enumerate() {
            let stopped = arm.step_on(time).is_err();
            first = first.or(stopped.then_some(in_groups + index));
        }
        first
    }
}

/// Advances each arm of a group; returns which cannot go on and are as they were.
fn step_group(arms: &mut [TorquePlant; BESIDE], time: f64) -> [bool; BESIDE] {
    if arms.iter().any(|arm| arm.tolerance.is_some()) {
        return arms.each_mut().map(|arm| arm.step_on(time).is_err());
    }
    let begun = arms.each_ref().map(TorquePlant::state);
    let mut stopped = [false; BESIDE];
    let steps = internal_steps(time);
    for _ in 0..steps as u64 {
        let before = arms.each_ref().map(TorquePlant::state);
        advance_beside(arms, time / steps);
        for ((arm, before), stopped) in arms.iter_mut().zip(&before).zip(&mut stopped) {
            if !arm.has_turned_within(GREATEST_TURN, &before.q) {
                arm.set_state(before);
                *stopped |= arm.advance(time / steps).is_err();
            }
        }
    }
    for ((arm, begun), stopped) in arms.iter_mut().zip(&begun).zip(stopped) {
        if stopped {
            arm.set_state(begun);
        }
    }
    stopped
}

/// Advances all arms by one internal step.
fn advance_beside(arms: &mut [TorquePlant; BESIDE], time: f64) {
    let steps = arms
        .each_mut()
        .map(|arm| arm.arm.begin(&ActuatorCommand::default(), time));
    // All of them have drives.
    if let [Some(a), Some(b), Some(c), Some(d)] = steps {
        step_all([a, b, c, d]);
    }
    for arm in arms {
        arm.arm.end([None; 2]);
    }
}

/// With instructions for four numbers where the processor has them. They round as those for one do.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
fn step_all(arms: [Step<'_>; BESIDE]) {
    #[target_feature(enable = "avx2")]
    fn with_avx2(arms: [Step<'_>; BESIDE]) {
        step_beside(arms);
    }
    match is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has what the function needs.
        true => unsafe { with_avx2(arms) },
        false => step_beside(arms),
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn step_all(arms: [Step<'_>; BESIDE]) {
    step_beside(arms);
}
