//! The start of an image: from the reset to the first tick.

use super::tasks::Idle;
use super::{Controller, Locked, Parts};
use crate::board::cycles::{CycleMeter, TickTimes};
use crate::board::exchanged::Place;
use crate::board::log::EventLog;
use crate::board::rp2350::outputs::CommonOutputs;
use crate::board::rp2350::pins::{self, Pins};
use crate::board::rp2350::services::{self, BoardServices};
use crate::board::rp2350::watchdog::Watchdog;
use crate::board::rp2350::{clocks, end, serial, tool};
use crate::board::stored;
use crate::drives::BlindStepDrives;
use crate::planner::Planner;
use crate::protocol::{HostMessage, Identity};
use crate::session::{self, Board, Session, fault_at_start};
use crate::{ArmSample, ToldSample};

use core::mem::MaybeUninit;
use heapless::spsc::{Producer, Queue};

/// Where what lasts as long as the program is put.
#[allow(missing_docs, reason = "each is named after what is put there")]
pub struct Places {
    pub queue: &'static mut Queue<HostMessage, 4>,
    pub controllers: &'static mut [Place<BlindStepDrives>; 2],
    pub planner: &'static mut Planner,
    pub session: &'static mut MaybeUninit<Session>,
}

/// What the tasks have.
pub struct Image<P: Parts> {
    /// Shared by the tick and the session.
    pub locked: Locked<P>,
    /// The tick's.
    pub meter: CycleMeter,
    /// The tick's.
    pub outputs: CommonOutputs,
    /// The serial line's: its bytes.
    pub receiver: serial::Receiver,
    /// The serial line's: what the bytes say, for the session.
    pub arrived: Producer<'static, HostMessage>,
    /// The idle task's.
    pub idle: Idle,
}

/// Starts the image. Interrupts are masked.
#[inline(always)]
pub fn start<P: Parts>(
    device: rp235x_pac::Peripherals,
    mut core: cortex_m::Peripherals,
    places: Places,
) -> Image<P> {
    let resets = &device.RESETS;
    let reset = end::reset_reason(&device.WATCHDOG, &device.POWMAN);
    let started = clocks::start(
        &device.XOSC,
        &device.PLL_SYS,
        &device.CLOCKS,
        &device.TICKS,
        resets,
    );
    if let Err(error) = started {
        defmt::error!("no clock: {}", error);
        // Nothing is set up yet: every pin floats, and the resistors keep everything off.
        loop {
            cortex_m::asm::nop();
        }
    }
    let pins = Pins::new(&device.IO_BANK0, &device.PADS_BANK0, resets);
    let brake = pins::set_up(&pins);
    let mut parts = P::new(device.PIO0, &pins, resets);
    let (tool_timer, tool) = tool::new(device.PWM, resets);
    let (receiver, sender) = serial::new(&device.UART0, resets);
    let (arrived, commands) = places.queue.split();

    let mut storage = services::open();
    let mut settings = stored::benchtop();
    let missing = stored::load(&mut storage, &P::LIMITS, &mut settings).err();
    let settings = &settings;
    let mut services = BoardServices {
        storage,
        limits: P::LIMITS,
        tool: tool_timer,
        watchdog: Watchdog::start(device.WATCHDOG, &device.PSM),
        sample: ToldSample::default(),
        times: TickTimes::new(),
    };
    if missing.is_none() {
        services.use_settings(settings);
    }
    parts.use_settings(settings);
    defmt::info!("started after a reset: {}", reset);

    let identity = Identity::new(P::BOARD, reset);
    places.planner.reset(settings);
    let [controller, spare] = places.controllers;
    let controller = Controller::place(controller, settings);
    if let Some(fault) = fault_at_start(true, reset, missing) {
        controller.latch_fault(fault);
    }
    let idle = Idle {
        commands,
        sender,
        spare: Controller::place(spare, settings),
        planner: places.planner,
        session: session::place(places.session, identity, settings, missing.is_none()),
        services,
        log: EventLog::new(),
        systick: core.SYST,
    };
    Image {
        locked: Locked {
            controller,
            parts,
            sample: ArmSample::default(),
        },
        meter: CycleMeter::new(&mut core.DCB, &mut core.DWT),
        outputs: CommonOutputs { brake, tool },
        receiver,
        arrived,
        idle,
    }
}
