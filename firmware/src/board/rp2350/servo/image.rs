//! The production image for hobby servos: an RP2350 that makes the pulses of two.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | `tick`: emergency stop in, pulses out | 4 | the next tick; misses are counted |
//! | `receive`: from bytes to commands | 2 | 16 bytes of 10 µs: 160 µs |
//! | `converse`: session, planner, telemetry, log, watchdog | idle | the watchdog's 50 ms |
//!
//! Without its crystal the program ends before it has set a pin up: no clock of the chip is exact enough for the serial line.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;
use fivebar_firmware::board::end_cause::EndCause;
use fivebar_firmware::board::rp2350::end::end;
use fivebar_firmware::board::rp2350::pulses::RESET_SET;
use fivebar_firmware::board::rp2350::resets::PIO0;

#[rtic::app(device = rp235x_pac, peripherals = true)]
mod app {
    use core::mem::MaybeUninit;
    use core::sync::atomic::{AtomicBool, Ordering};
    use cortex_m::peripheral::SYST;
    use cortex_m::peripheral::syst::SystClkSource;
    use fivebar_firmware::board::alive::Tasks;
    use fivebar_firmware::board::cycles::{CycleMeter, TickTimes};
    use fivebar_firmware::board::exchanged::{Exchanged, Guarded, Place};
    use fivebar_firmware::board::log::EventLog;
    use fivebar_firmware::board::rp2350::pins::{self, Brake, Stop};
    use fivebar_firmware::board::rp2350::pulses::Pulses;
    use fivebar_firmware::board::rp2350::serial::{self, Receiver, Sender};
    use fivebar_firmware::board::rp2350::services::{self, BoardServices};
    use fivebar_firmware::board::rp2350::servo::Servos;
    use fivebar_firmware::board::rp2350::tool::{self, ToolChannel};
    use fivebar_firmware::board::rp2350::watchdog::Watchdog;
    use fivebar_firmware::board::rp2350::{clocks, end};
    use fivebar_firmware::board::stored;
    use fivebar_firmware::drivers::{Inputs, Level};
    use fivebar_firmware::drives::{BlindStepDrives, Drives, StepSample};
    use fivebar_firmware::planner::Planner;
    use fivebar_firmware::protocol::{Board, Decoder, HostCommand, HostMessage, Identity};
    use fivebar_firmware::session::{self, Board as _, Session, fault_at_start};
    use fivebar_firmware::settings::{BoardLimits, CheckedSettings};
    use fivebar_firmware::{ArmController, ArmSample, Request, ToldSample};
    use heapless::spsc::{Consumer, Producer, Queue};

    type Controller = ArmController<BlindStepDrives>;
    /// A servo knows its angle and tells no fault; only the emergency stop is read.
    type Switches = Inputs<
        Level<false>,
        Level<false>,
        Level<false>,
        Level<false>,
        Stop,
        Level<true>,
        Level<true>,
    >;

    /// Cycles from one tick to the next: 10 kHz.
    const TICK_CYCLES: u32 = clocks::CORE / 10_000;

    /// The host sent an emergency stop. The next tick reads this.
    static STOP: AtomicBool = AtomicBool::new(false);

    /// What the tick has, under one lock.
    pub struct Locked {
        controller: &'static mut Controller,
        servos: Servos,
        sample: ArmSample<StepSample>,
    }

    impl Guarded<BlindStepDrives> for Locked {
        fn controller(&mut self) -> &mut &'static mut Controller {
            &mut self.controller
        }

        fn use_settings(lock: &mut impl rtic_core::Mutex<T = Self>, settings: &CheckedSettings) {
            lock.lock(|locked| locked.servos.use_settings(settings));
        }
    }

    #[shared]
    struct Shared {
        locked: Locked,
    }

    #[local]
    struct Local {
        meter: CycleMeter,
        switches: Switches,
        brake: Brake,
        tool: ToolChannel,
        receiver: Receiver,
        arrived: Producer<'static, HostMessage>,
        commands: Consumer<'static, HostMessage>,
        sender: Sender,
        spare: &'static mut Controller,
        planner: &'static mut Planner,
        session: &'static mut Session,
        services: BoardServices,
        systick: SYST,
    }

    #[init(local = [
        queue: Queue<HostMessage, 4> = Queue::new(),
        controllers: [Place<BlindStepDrives>; 2] = [const { Place::uninit() }; 2],
        place_of_planner: Planner = Planner::NONE,
        place_of_session: MaybeUninit<Session> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (device, mut core, places) = (cx.device, cx.core, cx.local);
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
        let (stop, brake) = pins::set_up(&device.IO_BANK0, &device.PADS_BANK0, resets);
        let mut servos = Servos::new(Pulses::new(device.PIO0, resets));
        let (tool_timer, tool) = tool::new(device.PWM, resets);
        let (receiver, sender) = serial::new(&device.UART0, resets);
        let (arrived, commands) = places.queue.split();

        let mut storage = services::open();
        let mut settings = stored::benchtop();
        let limits = BoardLimits::RP2350_SERVO;
        let missing = stored::load(&mut storage, &limits, &mut settings).err();
        let mut services = BoardServices {
            storage,
            tool: tool_timer,
            watchdog: Watchdog::start(device.WATCHDOG, &device.PSM),
            sample: ToldSample::default(),
            times: TickTimes::new(),
        };
        if missing.is_none() {
            services.use_settings(&settings);
        }
        servos.use_settings(&settings);
        defmt::info!("started after a reset: {}", reset);

        let identity = Identity::new(Board::Rp2350Servo, reset);
        let planner = places.place_of_planner;
        planner.reset(&settings);
        let [controller, spare] = places.controllers;
        let controller = Controller::place(controller, &settings);
        if let Some(fault) = fault_at_start(true, reset, missing) {
            controller.latch_fault(fault);
        }
        let has_settings = missing.is_none();
        let local = Local {
            meter: CycleMeter::new(&mut core.DCB, &mut core.DWT),
            switches: Inputs {
                home1: Level,
                home4: Level,
                index1: Level,
                index4: Level,
                emergency_stop: stop,
                fault1: Level,
                fault4: Level,
            },
            brake,
            tool,
            receiver,
            arrived,
            commands,
            sender,
            spare: Controller::place(spare, &settings),
            planner,
            session: session::place(places.place_of_session, identity, &settings, has_settings),
            services,
            systick: core.SYST,
        };
        let locked = Locked {
            controller,
            servos,
            sample: ArmSample::default(),
        };
        (Shared { locked }, local)
    }

    #[task(binds = SysTick, priority = 4, shared = [locked], local = [meter, switches, brake, tool])]
    fn tick(mut cx: tick::Context) {
        let local = cx.local;
        let waited = TICK_CYCLES - 1 - SYST::get_current();
        let missed = local.meter.missed(TICK_CYCLES);
        cx.shared.locked.lock(|locked| {
            local.meter.measure(waited, || {
                let Locked {
                    controller,
                    servos,
                    sample,
                } = locked;
                let was_pressed = local.switches.emergency_stop.was_pressed();
                let stopped = STOP.swap(false, Ordering::Relaxed) || was_pressed;
                let units = servos.units();
                let drives = StepSample {
                    steps: units,
                    ..StepSample::default()
                };
                *sample = local.switches.sample(units, drives, missed, stopped);
                let command = controller.tick(sample);
                servos.apply(&command);
                local.brake.write(!command.brake);
                local.tool.set(command.tool);
                let drives = controller.drives();
                services::recorder().record(drives, sample, &command, controller.ticks());
            });
        });
        Tasks::TICK.advanced();
    }

    /// From bytes to commands. A command for which the queue has no room is dropped; the host sends it again.
    #[task(binds = UART0_IRQ, priority = 2, local = [
        receiver,
        arrived,
        decoder: Decoder<HostMessage> = Decoder::new(),
    ])]
    fn receive(cx: receive::Context) {
        let (decoder, arrived) = (cx.local.decoder, cx.local.arrived);
        cx.local.receiver.drain(|byte| {
            if let Some(Ok(message)) = decoder.feed(byte) {
                if message.command == HostCommand::Request(Request::EmergencyStop) {
                    // This does not wait in the queue behind the planner's work.
                    STOP.store(true, Ordering::Relaxed);
                }
                let _ = arrived.enqueue(message);
            }
        });
    }

    #[idle(shared = [locked], local = [commands, sender, spare, planner, session, services, systick])]
    fn converse(cx: converse::Context) -> ! {
        let local = cx.local;
        local.systick.set_clock_source(SystClkSource::Core);
        local.systick.set_reload(TICK_CYCLES - 1);
        local.systick.clear_current();
        local.systick.enable_interrupt();
        local.systick.enable_counter();
        let mut log = EventLog::new();
        let mut shared = Exchanged {
            lock: cx.shared.locked,
            spare: local.spare,
        };
        let controller = &mut shared;
        loop {
            if let Some(message) = local.commands.dequeue() {
                local.services.sample = controller.lock.lock(|locked| {
                    let sample = &locked.sample;
                    let words = locked.controller.drives().sensed_words(&sample.drives);
                    sample.with_drives(words)
                });
                let (session, services) = (&mut *local.session, &mut *local.services);
                if let Some(frame) = session.answer(&message, controller, local.planner, services) {
                    local.sender.send(&frame);
                }
            }
            local.planner.run(controller);
            if let Some(frame) = local.session.telemetry(controller, local.planner) {
                local.sender.send(&frame);
            }
            local.sender.advance();
            local.services.times.count();
            log.update(controller, &local.services.times);
            Tasks::SESSION.advanced();
            local.services.watchdog.refresh_if_all_advanced();
        }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end(EndCause::Panic)
}

/// Any fault of the processor. The stack may be at its end, and a push would then lock the core up: so this ends the pulses
/// without one, and goes on with a fresh stack.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
unsafe extern "C" fn hard_fault() -> ! {
    core::arch::naked_asm!(
        "movw r0, #{low_half}",
        "movt r0, #{high_half}",
        "movw r1, #{bit}",
        "str r1, [r0]",
        "movw r0, #:lower16:_stack_start",
        "movt r0, #:upper16:_stack_start",
        "msr msp, r0",
        "b {after}",
        low_half = const RESET_SET & 0xffff,
        high_half = const RESET_SET >> 16,
        bit = const PIO0,
        after = sym after_hard_fault,
    )
}

extern "C" fn after_hard_fault() -> ! {
    end(EndCause::HardFault)
}

/// The default handler of exceptions and interrupts without their own.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(_: i16) {
    end(EndCause::HardFault)
}
