//! The start of an image: from the reset to the first tick.

use super::shared::Locked;
use super::tasks::Idle;
use super::{CLOCK_FAILED, Parts, crystal_failed};
use crate::board::cycles::CycleMeter;
use crate::board::exchanged::Place;
use crate::board::log::EventLog;
use crate::board::stm32f405::clocks::{self, Source};
use crate::board::stm32f405::outputs::CommonOutputs;
use crate::board::stm32f405::self_test::Started;
use crate::board::stm32f405::services::{self, BoardServices, OnBoard};
use crate::board::stm32f405::{brown_out, halt, pins, post_mortem, serial, tool};
use crate::board::stored;
use crate::planner::Planner;
use crate::protocol::{HostMessage, Identity};
use crate::session::{self, Board, Session, WAITING, fault_at_start};
use crate::{ArmController, ArmSample};
use core::mem::MaybeUninit;
use core::sync::atomic::Ordering;
use heapless::spsc::{Producer, Queue};
use rtic_core::Exclusive;
use stm32f4xx_hal::pac;

/// What each image takes of the chip.
#[allow(missing_docs, reason = "the names are those of the chip")]
pub struct CommonPeripherals {
    pub rcc: pac::RCC,
    pub flash: pac::FLASH,
    pub debug: pac::DBGMCU,
    pub watchdog: pac::IWDG,
    pub crystal_timer: pac::TIM11,
    pub tool_timer: pac::TIM3,
    pub usart: pac::USART1,
    pub dma: pac::DMA2,
}

/// Where what lasts as long as the program is put.
#[allow(missing_docs, reason = "each is named after what is put there")]
pub struct Places<P: Parts> {
    pub buffers: &'static mut serial::Buffers,
    pub queue: &'static mut Queue<HostMessage, WAITING>,
    pub controllers: &'static mut [Place<P::Drives>; 2],
    pub planner: &'static mut Planner,
    pub session: &'static mut MaybeUninit<Session>,
}

/// What the tasks have.
pub struct Image<P: Parts> {
    /// Shared by the tick, the tasks of the drives alone, and the session.
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
    pub idle: Idle<P>,
}

/// Starts the image. Interrupts are masked.
#[inline(always)]
pub fn start<P: Parts>(
    common: CommonPeripherals,
    own: P::Peripherals,
    mut core: cortex_m::Peripherals,
    places: Places<P>,
) -> Image<P> {
    let (reset, hung) = post_mortem::reset_reason(&common.rcc);
    halt::prepare(&common.debug);
    let brown_out = brown_out::enable_reset(&common.flash);
    let (mut rcc, clocks) = clocks::start(common.rcc, &common.flash, &common.crystal_timer);
    let source = clocks.source;
    let crystal_runs = source == Source::Crystal;
    if !crystal_runs {
        defmt::error!(
            "no clock from a crystal that this image takes; it has {} Hz",
            clocks.crystal
        );
    }
    let parts = P::new(own, source, &mut rcc);
    let brake = pins::set_up();
    let (tool_timer, tool) = tool::new(common.tool_timer, source.tool_timer(), &mut rcc);
    let (receiver, sender) = serial::new(
        &common.usart,
        &common.dma,
        places.buffers,
        source.second_bus(),
        &mut rcc,
    );
    let (arrived, commands) = places.queue.split();

    let mut storage = services::open(common.flash);
    let mut settings = stored::benchtop();
    let missing = stored::load(&mut storage, &P::Drives::LIMITS, &mut settings).err();
    let settings = &settings;
    let started = Started {
        clocks,
        brown_out,
        hung,
    };
    let mut services = BoardServices::start(storage, common.watchdog, tool_timer, started);
    if missing.is_none() {
        Board::<P::Drives>::use_settings(&mut services, settings);
    }
    if !crystal_runs {
        CLOCK_FAILED.store(true, Ordering::Relaxed);
    }
    defmt::info!("started after a reset: {}", reset);

    let identity = Identity::new(P::BOARD, reset);
    places.planner.reset(settings);
    let [controller, spare] = places.controllers;
    let controller = ArmController::place(controller, settings);
    if let Some(fault) = fault_at_start(crystal_runs, reset, missing) {
        controller.latch_fault(fault);
    }
    let mut locked = Locked {
        controller,
        parts,
        sample: ArmSample::default(),
    };
    P::use_settings(&mut Exclusive(&mut locked), settings);
    let idle = Idle {
        commands,
        sender,
        spare: ArmController::place(spare, settings),
        planner: places.planner,
        session: session::place(places.session, identity, settings, missing.is_none()),
        services,
        log: EventLog::new(),
        source,
        systick: core.SYST,
    };
    if crystal_runs && CLOCK_FAILED.load(Ordering::Relaxed) {
        // It failed meanwhile, and what came behind it set up pins and dividers as if it had not.
        crystal_failed::<P>();
    }
    Image {
        locked,
        meter: CycleMeter::new(&mut core.DCB, &mut core.DWT),
        outputs: CommonOutputs { brake, tool },
        receiver,
        arrived,
        idle,
    }
}
