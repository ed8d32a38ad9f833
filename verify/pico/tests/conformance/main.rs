//! What every image must do: the rows of `verify/chip`, on the images of a Pico 2. `conformance.csv` beside the tests says which
//! image passes what, and why a row is not one of it.

#[path = "../bench/mod.rs"]
mod bench;
mod images;
mod rows;

use images::{SERVO, STEPPER};

/// The test of a cell, if it is `yes`.
macro_rules! cell {
    ($row:ident, $image:ident, $description:expr, yes) => {
        #[test]
        fn $image() {
            rows::$row(&$description);
        }
    };
    ($row:ident, $image:ident, $description:expr, $why:literal) => {};
}

/// The table's rows, and a module of tests for each.
macro_rules! behaviours {
    ($($row:ident: [$stepper:tt, $servo:tt],)*) => {
        const ROWS: &[(&str, [&str; 2])] = &[$((
            stringify!($row),
            [stringify!($stepper), stringify!($servo)],
        )),*];

        $(mod $row {
            #[allow(unused_imports, reason = "a row may have no cell")]
            use super::*;
            cell!($row, rp2350_stepper, STEPPER, $stepper);
            cell!($row, rp2350_servo, SERVO, $servo);
        })*
    };
}

behaviours! {
    nothing_has_power_from_power_up_until_the_arm_is_armed:
        [yes, yes],
    ticks_come_at_their_rate_from_the_first_one_on: [yes, yes],
    power_comes_before_the_brake_releases_and_goes_after_it_has_engaged:
        ["the built-in arms have no brake; the order is the controller's, not the board's", "the built-in arms have no brake; the order is the controller's, not the board's"],
    arming_moves_no_joint_also_after_a_motion:
        [yes, yes],
    a_move_turns_both_joints_as_far_as_it_says:
        [yes, yes],
    a_stop_on_the_path_ends_the_motion_and_disarming_the_power:
        [yes, yes],
    a_tick_accesses_as_many_slow_registers_as_the_bounds_add:
        ["the bounds take every access for one of a slow register", "the bounds take every access for one of a slow register"],
    a_panic_ends_power_and_restarts: [yes, yes],
    an_undefined_instruction_ends_power_and_restarts: [yes, yes],
    a_stack_at_its_end_ends_power_and_restarts:
        ["the emulated core ends the run at an access outside the SRAM", "the emulated core ends the run at an access outside the SRAM"],
    an_interrupt_that_nothing_handles_ends_power_and_restarts: [yes, yes],
    a_crystal_that_fails_ends_power_by_the_nmi:
        ["the chip has no such interrupt: ticks and state machines stand still, and S1 ends the power", "the chip has no such interrupt: no pulse is made"],
    a_crystal_that_fails_during_the_start_is_a_clock_failure: [yes, yes],
    the_watchdog_ends_a_program_that_hangs: [yes, yes],
    the_watchdog_ends_a_program_without_ticks: [yes, yes],
    the_watchdog_ends_a_program_whose_session_hangs: [yes, yes],
    a_debugger_that_halts_the_core_ends_the_motion:
        ["the emulated core has no debugger", "the emulated core has no debugger"],
    the_watchdog_ends_a_halt_though_a_debugger_has_stopped_it:
        ["the emulated core has no debugger", "the emulated core has no debugger"],
    each_contact_of_the_emergency_stop_ends_power: [yes, yes],
    a_short_press_of_the_emergency_stop_is_latched: [yes, yes],
    the_hosts_emergency_stop_does_not_wait_for_the_session: [yes, yes],
    a_fault_output_of_either_driver_ends_power: [yes, "hobby servos report no fault"],
    a_fault_output_of_either_driver_that_stays_ends_the_waking: [yes, "hobby servos report no fault"],
    an_error_of_either_drive_ends_power:
        ["no drives with errors of their own: the rows of the fault outputs", "no drives with errors of their own"],
    an_error_of_either_drive_ends_the_waking:
        ["no drives with errors of their own: the rows of the fault outputs", "no drives with errors of their own"],
    silence_of_either_drive_ends_the_waking: ["no drives that answer", "no drives that answer"],
}

/// The table as the file has it.
fn printed() -> String {
    let mut text = String::from("behaviour,rp2350_stepper,rp2350_servo\n");
    for (row, cells) in ROWS {
        let name = row.replace('_', " ");
        // A reason stands in its quotation marks.
        let cells = cells.map(|cell| if cell == "yes" { "tested" } else { cell });
        text += &format!("{name},{}\n", cells.join(","));
    }
    text
}

/// The file has this table, and its rows are those of the first board's table, in their order.
#[test]
fn the_file_has_the_table_and_every_row_of_the_first_board() {
    let printed = printed();
    let committed = include_str!("../../conformance.csv");
    assert!(
        committed == printed,
        "conformance.csv should be:\n{printed}"
    );
    let rows = |text: &'static str| {
        let lines = text.lines().skip(1);
        lines.map(|line| line.split(',').next().unwrap_or_default())
    };
    let first_board = include_str!("../../../chip/conformance.csv");
    assert!(rows(committed).eq(rows(first_board)));
}
