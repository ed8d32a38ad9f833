//! The start of an image: from the reset to the first tick.

use super::tasks::{Hearing, Idle};
use super::{Controller, Locked, Parts};
use crate::board::cycles::{CycleMeter, TickTimes};
use crate::board::exchanged::Place;
use crate::board::log::EventLog;
use crate::board::rp2350::lines::Lines;
use crate::board::rp2350::outputs::CommonOutputs;
use crate::board::rp2350::pins::{self, Pins};
use crate::board::rp2350::services::{self, BoardServices};
use crate::board::rp2350::usb::{self, bus::Bus};
use crate::board::rp2350::watchdog::Watchdog;
use crate::board::rp2350::{clocks, end, serial, tool};
use crate::board::stored;
use crate::drives::BlindStepDrives;
use crate::planner::Planner;
use crate::protocol::{Decoder, HostMessage, Identity};
use crate::session::{self, Board, Session, WAITING, fault_at_start};
use crate::{ArmSample, ToldSample};

use core::mem::MaybeUninit;
use heapless::spsc::{Producer, Queue};

/// Where what lasts as long as the program is put.
#[allow(missing_docs, reason = "each is named after what is put there")]
pub struct Places {
    pub queues: &'static mut [Queue<HostMessage, WAITING>; 2],
    pub usb: &'static mut usb::Place,
    pub usb_waiting: &'static mut usb::Waiting,
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
    /// The serial line's.
    pub receiver: (serial::Receiver, Hearing),
    /// The line's over USB.
    pub usb: (Option<usb::Device>, Hearing),
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
    let [(arrived, commands), (usb_arrived, usb_commands)] =
        places.queues.each_mut().map(Queue::split);
    let usb_runs = clocks::start_usb(&device.PLL_USB, &device.CLOCKS, resets);
    let (usb, usb_sender) = usb_runs
        .map(|()| {
            let bus = Bus::new(device.USB, device.USB_DPRAM, resets);
            usb::new(places.usb, places.usb_waiting, bus, P::NAME)
        })
        .ok()
        .unzip();

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
        lines: Lines {
            serial: (commands, sender),
            usb: usb_sender.map(|sender| (usb_commands, sender)),
            usb_leads: false,
        },
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
        receiver: (receiver, hearing(arrived)),
        usb: (usb, hearing(usb_arrived)),
        idle,
    }
}

fn hearing(arrived: Producer<'static, HostMessage>) -> Hearing {
    Hearing {
        arrived,
        decoder: Decoder::new(),
    }
}
