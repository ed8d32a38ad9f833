//! The start of an image: from what its chip has set up to the first tick.

use super::tasks::{Brake, Idle};
use super::{BoardServices, Chip, Locked, Parts, Watchdog};
use crate::board::cycles::{CycleMeter, TickTimes};
use crate::board::exchanged::Place;
use crate::board::log::EventLog;
use crate::board::stored;
use crate::planner::Planner;
use crate::protocol::{Identity, Reset};
use crate::session::{self, Board, Session, fault_at_start};
use crate::storage::SettingsStorage;
use crate::{ArmController, ArmSample, ToldSample};
use core::mem::MaybeUninit;
use rtic_core::Exclusive;

/// Where what lasts as long as the program is put.
#[allow(missing_docs, reason = "each is named after what is put there")]
pub struct Places<P: Parts> {
    pub controllers: &'static mut [Place<P::Drives>; 2],
    pub planner: &'static mut Planner,
    pub session: &'static mut MaybeUninit<Session>,
}

/// What a chip has set up, the drives without power.
pub struct Hardware<P: Parts> {
    /// What is of the drives.
    pub parts: P,
    /// What the core runs from.
    pub clock: <P::Chip as Chip>::Clock,
    /// Whether that is as exact as the controller needs.
    pub clock_runs: bool,
    /// Why the chip started.
    pub reset: Reset,
    /// The brake, engaged.
    pub brake: Brake<P>,
    /// The tool's output, which floats.
    pub tool: <P::Chip as Chip>::Tool,
    /// The serial line's.
    pub receiver: <P::Chip as Chip>::Receiver,
    /// The lines' other halves.
    pub lines: <P::Chip as Chip>::Lines,
    /// What tasks of the chip alone have.
    pub locals: <P::Chip as Chip>::Locals,
    /// None if the flash has no place for it.
    pub storage: Option<SettingsStorage<<P::Chip as Chip>::Flash>>,
    /// Not started: reading the settings may erase a sector.
    pub watchdog: <<P::Chip as Chip>::Watchdog as Watchdog>::Stopped,
    /// For the test of a bare board.
    pub facts: <P::Chip as Chip>::Facts,
}

/// What the tasks have.
pub struct Image<P: Parts> {
    /// Shared by the tick, the tasks of the drives alone, and the session.
    pub locked: Locked<P>,
    /// The tick's.
    pub meter: CycleMeter,
    /// The tick's.
    pub brake: Brake<P>,
    /// The serial line's.
    pub receiver: <P::Chip as Chip>::Receiver,
    /// What tasks of the chip alone have.
    pub locals: <P::Chip as Chip>::Locals,
    /// The idle task's.
    pub idle: Idle<P>,
}

/// Starts the image. Interrupts are masked.
#[inline(always)]
pub fn start<P: Parts>(
    mut hardware: Hardware<P>,
    mut core: cortex_m::Peripherals,
    places: Places<P>,
) -> Image<P> {
    let mut settings = stored::benchtop();
    let missing = stored::load(&mut hardware.storage, &P::LIMITS, &mut settings).err();
    let settings = &settings;
    let mut services = BoardServices {
        storage: hardware.storage,
        tool: hardware.tool,
        watchdog: Watchdog::start(hardware.watchdog),
        sample: ToldSample::default(),
        times: TickTimes::new(),
        facts: hardware.facts,
    };
    if missing.is_none() {
        services.use_settings(settings);
    }
    let reset = hardware.reset;
    defmt::info!("started after a reset: {}", reset);

    let identity = Identity::new(P::BOARD, reset);
    places.planner.reset(settings);
    let [controller, spare] = places.controllers;
    let controller = ArmController::place(controller, settings);
    if let Some(fault) = fault_at_start(hardware.clock_runs, reset, missing) {
        controller.latch_fault(fault);
    }
    let mut locked = Locked {
        controller,
        parts: hardware.parts,
        sample: ArmSample::default(),
    };
    P::use_settings(&mut Exclusive(&mut locked), settings);
    let idle = Idle {
        lines: hardware.lines,
        spare: ArmController::place(spare, settings),
        planner: places.planner,
        session: session::place(places.session, identity, settings, missing.is_none()),
        services,
        log: EventLog::new(),
        clock: hardware.clock,
        systick: core.SYST,
    };
    Image {
        locked,
        meter: CycleMeter::new(&mut core.DCB, &mut core.DWT),
        brake: hardware.brake,
        receiver: hardware.receiver,
        locals: hardware.locals,
        idle,
    }
}
