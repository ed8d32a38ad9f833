//! What each image sets up of the chip: from the reset to the one body's start.

use super::{LinePlaces, OnChip};
use crate::board::image::Hardware;
use crate::board::image::tasks::Commands;
use crate::board::rp2350::flash::SettingsFlash;
use crate::board::rp2350::lines::BothLines;
use crate::board::rp2350::pins::{self, Pins};
use crate::board::rp2350::tool::ToolTimer;
use crate::board::rp2350::usb::{self, bus::Bus};
use crate::board::rp2350::{clocks, end, serial};
use crate::storage::SettingsStorage;

/// Sets the chip up. Interrupts are masked.
#[inline(always)]
pub fn set_up<P: OnChip>(
    device: rp235x_pac::Peripherals,
    places: &'static mut LinePlaces,
    commands: Commands,
) -> Hardware<P> {
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
    let parts = P::new(device.PIO0, &pins, resets);
    let tool = ToolTimer::new(device.PWM, resets);
    let (receiver, sender) = serial::new(&device.UART0, &mut places.waiting, resets);
    let (usb_arrived, usb_commands) = places.usb_queue.split();
    let usb_runs = clocks::start_usb(&device.PLL_USB, &device.CLOCKS, resets);
    let (usb, usb_sender) = usb_runs
        .map(|()| {
            let bus = Bus::new(device.USB, device.USB_DPRAM, resets);
            usb::new(&mut places.usb, bus, P::NAME)
        })
        .ok()
        .unzip();
    Hardware {
        parts,
        clock: (),
        clock_runs: true,
        reset,
        brake,
        tool,
        receiver,
        lines: BothLines {
            serial: (commands, sender),
            usb: usb_sender.map(|sender| (usb_commands, sender)),
            usb_leads: false,
        },
        locals: (usb, usb_arrived),
        storage: SettingsStorage::new(SettingsFlash::new(), SettingsFlash::RANGE).ok(),
        watchdog: (device.WATCHDOG, device.PSM),
        facts: (),
    }
}
