//! The table: a row for each behaviour, a cell for each image. A cell is `yes`, or why the behaviour is not one of the image.

use super::images::{BRUSHED, CAN, STEPPERS};
use super::{endings, order, stops};

/// The test of a cell, if it is `yes`.
macro_rules! cell {
    ($row:path, $image:ident, $description:expr, yes) => {
        #[test]
        fn $image() {
            $row(&$description);
        }
    };
    ($row:path, $image:ident, $description:expr, $why:literal) => {};
}

/// The table's rows, and a module of tests for each.
macro_rules! behaviours {
    ($($room:ident::$row:ident: [$brushed:tt, $steppers:tt, $can:tt],)*) => {
        const ROWS: &[(&str, [&str; 3])] = &[$((
            stringify!($row),
            [stringify!($brushed), stringify!($steppers), stringify!($can)],
        )),*];

        $(mod $row {
            use super::*;
            cell!($room::$row, stm32f405, BRUSHED, $brushed);
            cell!($room::$row, stm32f405_stepper, STEPPERS, $steppers);
            cell!($room::$row, stm32f405_can, CAN, $can);
        })*
    };
}

behaviours! {
    order::nothing_has_power_from_power_up_until_the_arm_is_armed: [yes, yes, yes],
    order::ticks_come_at_their_rate_from_the_first_one_on: [yes, yes, yes],
    order::power_comes_before_the_brake_releases_and_goes_after_it_has_engaged: [yes, yes, yes],
    order::arming_moves_no_joint_also_after_a_motion: [yes, yes, yes],
    order::a_move_turns_both_joints_as_far_as_it_says: [yes, yes, yes],
    order::a_stop_on_the_path_ends_the_motion_and_disarming_the_power: [yes, yes, yes],
    order::a_tick_accesses_as_many_slow_registers_as_the_bounds_add: [yes, yes, yes],
    endings::a_panic_ends_power_and_restarts: [yes, yes, yes],
    endings::an_undefined_instruction_ends_power_and_restarts: [yes, yes, yes],
    endings::a_stack_at_its_end_ends_power_and_restarts: [yes, yes, yes],
    endings::an_interrupt_that_nothing_handles_ends_power_and_restarts: [yes, yes, yes],
    endings::a_crystal_that_fails_ends_power_by_the_nmi: [yes, yes, yes],
    endings::a_crystal_that_fails_during_the_start_is_a_clock_failure: [yes, yes, yes],
    endings::the_watchdog_ends_a_program_that_hangs: [yes, yes, yes],
    endings::the_watchdog_ends_a_program_without_ticks: [yes, yes, yes],
    endings::the_watchdog_ends_a_program_whose_session_hangs: [yes, yes, yes],
    endings::a_debugger_that_halts_the_core_ends_the_motion: [yes, yes, yes],
    endings::the_watchdog_ends_a_halt_though_a_debugger_has_stopped_it: [yes, yes, yes],
    stops::each_contact_of_the_emergency_stop_ends_power: [yes, yes, yes],
    stops::a_short_press_of_the_emergency_stop_is_latched:
        [yes, yes, "no timer drives the motors: a press is read in each tick, and lasts for tens of milliseconds"],
    stops::the_hosts_emergency_stop_does_not_wait_for_the_session: [yes, yes, yes],
    stops::a_fault_output_of_either_driver_ends_power:
        [yes, yes, "drives on a bus report their errors by frames: the row of their errors"],
    stops::a_fault_output_of_either_driver_that_stays_ends_the_waking:
        [yes, yes, "drives on a bus report their errors by frames: the row of their errors"],
    stops::an_error_of_either_drive_ends_power:
        ["no drives with errors of their own: the rows of the fault outputs", "no drives with errors of their own: the rows of the fault outputs", yes],
    stops::an_error_of_either_drive_ends_the_waking:
        ["no drives with errors of their own: the rows of the fault outputs", "no drives with errors of their own: the rows of the fault outputs", yes],
    stops::silence_of_either_drive_ends_the_waking:
        ["no drives that answer", "no drives that answer", yes],
}

/// The table as the file has it.
fn printed() -> String {
    let mut text = String::from("behaviour,stm32f405,stm32f405_stepper,stm32f405_can\n");
    for (row, cells) in ROWS {
        let name = row.replace('_', " ");
        // A reason stands in its quotation marks.
        let cells = cells.map(|cell| if cell == "yes" { "tested" } else { cell });
        text += &format!("{name},{}\n", cells.join(","));
    }
    text
}

#[test]
fn the_file_has_the_table() {
    let printed = printed();
    let committed = include_str!("../../conformance.csv");
    assert!(
        committed == printed,
        "conformance.csv should be:\n{printed}"
    );
}
