//! Steps of many arms that make the torques that they are told: eight or four of them side by side, with the bits of one by
//! itself.

use crate::integration::{Step, step_beside};
use crate::torque::{GREATEST_TURN, TorquePlant, TorqueState, internal_steps};
use fivebar_firmware::ActuatorCommand;

/// Arms side by side: as many numbers as an instruction of AVX-512 computes, and one of AVX2.
const EIGHT: usize = 8;
const FOUR: usize = 4;

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
        let in_eights = match eight_at_once() {
            true => arms.len() - arms.len() % EIGHT,
            false => 0,
        };
        let in_fours = arms.len() - arms.len() % FOUR;
        let (eights, rest) = arms.split_at_mut(in_eights);
        let (fours, rest) = rest.split_at_mut(in_fours - in_eights);
        let mut first = step_groups(eights, time, step_eight);
        let stopped = step_groups(fours, time, step_four);
        first = first.or(stopped.map(|index| in_eights + index));
        for (index, arm) in rest.iter_mut().enumerate() {
            let stopped = arm.step_on(time).is_err();
            first = first.or(stopped.then_some(in_fours + index));
        }
        first
    }
}

/// Advances arms in whole groups; returns the first one that cannot go on.
fn step_groups<const N: usize>(
    arms: &mut [TorquePlant],
    time: f64,
    step_all: fn(&mut [Step<'_>; N]),
) -> Option<usize> {
    let mut first = None;
    for (index, group) in arms.as_chunks_mut::<N>().0.iter_mut().enumerate() {
        for (lane, stopped) in step_group(group, time, step_all).into_iter().enumerate() {
            first = first.or(stopped.then_some(N * index + lane));
        }
    }
    first
}

/// Advances each arm of a group, and tells which cannot go on: they are as they were.
fn step_group<const N: usize>(
    arms: &mut [TorquePlant; N],
    time: f64,
    step_all: fn(&mut [Step<'_>; N]),
) -> [bool; N] {
    let mut stopped = [false; N];
    if arms.iter().any(|arm| arm.tolerance.is_some()) {
        for (arm, stopped) in arms.iter_mut().zip(&mut stopped) {
            *stopped = arm.step_on(time).is_err();
        }
        return stopped;
    }
    let begun: Vec<TorqueState> = arms.iter().map(TorquePlant::state).collect();
    let steps = internal_steps(time);
    for step in 0..steps as u64 {
        let now: Vec<TorqueState>;
        let before = match step {
            0 => &begun,
            _ => {
                now = arms.iter().map(TorquePlant::state).collect();
                &now
            }
        };
        advance_beside(arms, time / steps, step_all);
        for ((arm, before), stopped) in arms.iter_mut().zip(before).zip(&mut stopped) {
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
fn advance_beside<const N: usize>(
    arms: &mut [TorquePlant; N],
    time: f64,
    step_all: fn(&mut [Step<'_>; N]),
) {
    let command = ActuatorCommand::default();
    // All of them have drives.
    let mut steps: Vec<Step<'_>> = arms
        .iter_mut()
        .filter_map(|arm| arm.arm.begin(&command, time))
        .collect();
    if let Ok(steps) = steps.as_mut_slice().try_into() {
        step_all(steps);
    }
    for arm in arms {
        arm.arm.end([None; 2]);
    }
}

/// Whether the processor has instructions for eight numbers.
fn eight_at_once() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx512f");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// With instructions for eight numbers where the processor has them. They round as those for one do.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
fn step_eight(arms: &mut [Step<'_>; EIGHT]) {
    #[target_feature(enable = "avx512f")]
    fn with_avx512(arms: &mut [Step<'_>; EIGHT]) {
        step_beside(arms);
    }
    match eight_at_once() {
        // SAFETY: the processor has what the function needs.
        true => unsafe { with_avx512(arms) },
        false => step_beside(arms),
    }
}

/// With instructions for four numbers where the processor has them.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
fn step_four(arms: &mut [Step<'_>; FOUR]) {
    #[target_feature(enable = "avx2")]
    fn with_avx2(arms: &mut [Step<'_>; FOUR]) {
        step_beside(arms);
    }
    match is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has what the function needs.
        true => unsafe { with_avx2(arms) },
        false => step_beside(arms),
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn step_eight(arms: &mut [Step<'_>; EIGHT]) {
    step_beside(arms);
}

#[cfg(not(target_arch = "x86_64"))]
fn step_four(arms: &mut [Step<'_>; FOUR]) {
    step_beside(arms);
}
