//! The production image for torque drives on a CAN bus: an STM32F405RG that sends two drives their commands.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | `tick`: answers and switches in, commands out | 3 | 0.2 ms of 1 ms: with the frames in time; misses are counted |
//! | `sent`: the next frame into a free mailbox | 3 | the end of the frames in the other two, 0.2 ms |
//! | `receive`: from bytes to commands | 2 | the ring buffer's 5 ms |
//! | `converse`: session, planner, telemetry, log, watchdog | idle | the watchdog's 50 ms |
//!
//! Without a crystal the ticks come more slowly, and the controller reports its clock fault, which cannot be cleared.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use core::panic::PanicInfo;
use cortex_m_rt::exception;
use defmt_rtt as _;
use fivebar_firmware::board::stm32f405::can::{bxcan, stop};
use fivebar_firmware::board::stm32f405::post_mortem::EndCause;
use fivebar_firmware::board::stm32f405::{clocks, serial, tool};

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use core::mem::MaybeUninit;
    use core::sync::atomic::{AtomicBool, Ordering};
    use fivebar_firmware::board;
    use fivebar_firmware::board::exchanged::{Exchanged, Place};
    use fivebar_firmware::board::stm32f405::can::bus::Bus;
    use fivebar_firmware::board::stm32f405::can::bxcan::BxCan;
    use fivebar_firmware::board::stm32f405::can::outputs::Outputs;
    use fivebar_firmware::board::stm32f405::can::pins::Pins;
    use fivebar_firmware::board::stm32f405::can::sensors::Sensors;
    use fivebar_firmware::board::stm32f405::can::shared::WithBus;
    use fivebar_firmware::board::stm32f405::can::timer::{self, TICK_CYCLES};
    use fivebar_firmware::board::stm32f405::clocks::{self, Source};
    use fivebar_firmware::board::stm32f405::cycles::CycleMeter;
    use fivebar_firmware::board::stm32f405::log::EventLog;
    use fivebar_firmware::board::stm32f405::self_test::Started;
    use fivebar_firmware::board::stm32f405::services::{self, BoardServices};
    use fivebar_firmware::board::stm32f405::watchdog::Tasks;
    use fivebar_firmware::board::stm32f405::{brown_out, halt, post_mortem, serial, tool};
    use fivebar_firmware::drives::{Drives, TorqueDrives, TorqueSample};
    use fivebar_firmware::planner::Planner;
    use fivebar_firmware::protocol::{Board, Decoder, HostCommand, HostMessage, Identity};
    use fivebar_firmware::session::{self, Session, fault_at_start};
    use fivebar_firmware::settings::BoardLimits;
    use fivebar_firmware::{ArmController, ArmSample, Request};
    use heapless::spsc::{Consumer, Producer, Queue};

    type Controller = ArmController<TorqueDrives>;

    /// The host sent an emergency stop. The next tick reads this.
    static STOP: AtomicBool = AtomicBool::new(false);
    /// The crystal did not start, or failed later.
    pub(crate) static CLOCK_FAILED: AtomicBool = AtomicBool::new(false);

    #[shared]
    struct Shared {
        controller: &'static mut Controller,
        /// The sample of the last tick.
        sample: ArmSample<TorqueSample>,
        bus: &'static mut Bus,
    }

    #[local]
    struct Local {
        sensors: Sensors,
        outputs: Outputs,
        meter: CycleMeter,
        receiver: serial::Receiver,
        arrived: Producer<'static, HostMessage>,
        commands: Consumer<'static, HostMessage>,
        sender: serial::Sender,
        spare: &'static mut Controller,
        planner: &'static mut Planner,
        session: &'static mut Session,
        services: BoardServices,
        log: EventLog,
    }

    #[init(local = [
        buffers: serial::Buffers = serial::Buffers::new(),
        queue: Queue<HostMessage, 4> = Queue::new(),
        controllers: [Place<TorqueDrives>; 2] = [const { Place::uninit() }; 2],
        place_of_planner: Planner = Planner::NONE,
        place_of_session: MaybeUninit<Session> = MaybeUninit::uninit(),
        place_of_bus: MaybeUninit<Bus> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (device, mut core) = (cx.device, cx.core);
        let (reset, hung) = post_mortem::reset_reason(&device.RCC);
        halt::prepare(&device.DBGMCU);
        let brown_out = brown_out::enable_reset(&device.FLASH);
        let (mut rcc, clocks) = clocks::start(device.RCC, &device.FLASH, &device.TIM11);
        let source = clocks.source;
        if source == Source::Internal {
            defmt::error!(
                "no clock from a crystal that this image takes; it has {} Hz",
                clocks.crystal
            );
        }
        let pins = Pins::new(device.GPIOB, device.GPIOC, &mut rcc);
        let (tool_timer, tool) = tool::new(device.TIM3, pins.tool, source.tool_timer(), &mut rcc);
        let sensors = Sensors {
            switches: pins.switches,
        };
        let outputs = Outputs {
            brake: pins.brake,
            tool,
        };
        timer::set_up(&device.TIM5, &mut rcc);
        let crystal_runs = source == Source::Crystal;
        let can = BxCan::new(device.CAN1, pins.bus, crystal_runs, &mut rcc);
        let (receiver, sender) = serial::new(
            &device.USART1,
            &device.DMA2,
            pins.serial,
            cx.local.buffers,
            source.second_bus(),
            &mut rcc,
        );
        let (arrived, commands) = cx.local.queue.split();

        let mut storage = services::open(device.FLASH);
        let mut settings = services::benchtop();
        let missing =
            services::load(&mut storage, &BoardLimits::STM32F405_CAN, &mut settings).err();
        let settings = &settings;
        let started = Started {
            clocks,
            brown_out,
            hung,
        };
        let mut services = BoardServices::start(storage, device.IWDG, tool_timer, started);
        if missing.is_none() {
            board::Board::<TorqueDrives>::use_settings(&mut services, settings);
        }
        if !crystal_runs {
            CLOCK_FAILED.store(true, Ordering::Relaxed);
        }
        defmt::info!("started after a reset: {}", reset);

        let meter = CycleMeter::new(&mut core.DCB, &mut core.DWT);
        let identity = Identity::new(Board::Stm32f405Can, reset);
        let planner = cx.local.place_of_planner;
        planner.reset(settings);
        let [controller, spare] = cx.local.controllers;
        let controller = Controller::place(controller, settings);
        if let Some(fault) = fault_at_start(crystal_runs, reset, missing) {
            controller.latch_fault(fault);
        }
        let local = Local {
            sensors,
            outputs,
            meter,
            receiver,
            arrived,
            commands,
            sender,
            spare: Controller::place(spare, settings),
            planner,
            session: session::place(
                cx.local.place_of_session,
                identity,
                settings,
                missing.is_none(),
            ),
            services,
            log: EventLog::new(),
        };
        if crystal_runs && CLOCK_FAILED.load(Ordering::Relaxed) {
            // It failed meanwhile, and what came behind it set up pins and dividers as if it had not.
            super::crystal_failed();
        }
        let sample = ArmSample::default();
        let shared = Shared {
            controller,
            sample,
            bus: Bus::place(cx.local.place_of_bus, can, settings),
        };
        (shared, local)
    }

    /// The control tick.
    #[task(binds = TIM5, priority = 3, shared = [controller, sample, bus], local = [sensors, outputs, meter])]
    fn tick(mut cx: tick::Context) {
        let (sensors, outputs, meter) = (cx.local.sensors, cx.local.outputs, cx.local.meter);
        timer::take_tick();
        let waited = timer::since_tick();
        let missed = meter.missed(TICK_CYCLES);
        meter.measure(waited, || {
            let stopped = STOP.swap(false, Ordering::Relaxed);
            let sensed = cx.shared.bus.lock(|bus| bus.sense());
            let sample = sensors.sample(sensed, missed, stopped);
            cx.shared.sample.lock(|latest| *latest = sample);
            cx.shared.controller.lock(|controller| {
                let command = if CLOCK_FAILED.load(Ordering::Relaxed) {
                    controller.tick_without_clock(&sample)
                } else {
                    controller.tick(&sample)
                };
                cx.shared.bus.lock(|bus| bus.send(&command));
                outputs.apply(&command);
                let drives = controller.drives();
                services::recorder().record(drives, &sample, &command, controller.ticks());
            });
        });
        Tasks::TICK.advanced();
    }

    /// A frame has gone over the bus, or was taken back: there is room for the next one of the tick.
    #[task(binds = CAN1_TX, priority = 3, shared = [bus])]
    fn sent(mut cx: sent::Context) {
        cx.shared.bus.lock(|bus| bus.fill());
    }

    /// From bytes to commands. A command for which the queue has no room is dropped; the host
    /// sends it again.
    #[task(binds = USART1, priority = 2, local = [
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

    #[idle(shared = [controller, sample, bus], local = [commands, sender, spare, planner, session, services, log])]
    fn converse(cx: converse::Context) -> ! {
        let local = cx.local;
        timer::start();
        let mut sample = cx.shared.sample;
        let mut shared = WithBus {
            controller: Exchanged {
                lock: cx.shared.controller,
                spare: local.spare,
            },
            bus: cx.shared.bus,
        };
        let controller = &mut shared;
        loop {
            if let Some(message) = local.commands.dequeue() {
                let session = &mut *local.session;
                let latest = sample.lock(|latest| *latest);
                let words =
                    controller.lock(|controller| controller.drives().sensed_words(&latest.drives));
                local.services.sample = latest.with_drives(words);
                if let Some(frame) =
                    session.answer(&message, controller, local.planner, local.services)
                {
                    local.sender.send(&frame);
                }
            }
            local.planner.run(controller);
            if let Some(frame) = local.session.telemetry(controller, local.planner) {
                local.sender.send(&frame);
            }
            local.services.times.count();
            local.log.update(controller, &local.services.times);
            Tasks::SESSION.advanced();
            local.services.watchdog.refresh_if_all_advanced();
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    stop::end(EndCause::Panic)
}

/// Any fault of the processor. The stack may be at its end, and a push would then lock the core up before the drives are
/// stopped: so this goes on with a fresh stack at once.
#[allow(
    unsafe_code,
    reason = "a handler without a prologue is written in assembly"
)]
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
unsafe extern "C" fn hard_fault() -> ! {
    core::arch::naked_asm!(
        "movw r0, #:lower16:_stack_start",
        "movt r0, #:upper16:_stack_start",
        "msr msp, r0",
        "b {after}",
        after = sym after_hard_fault,
    )
}

extern "C" fn after_hard_fault() -> ! {
    stop::end(EndCause::HardFault)
}

/// The default handler of exceptions and interrupts without their own.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    stop::end(EndCause::HardFault)
}

/// The crystal failed: the core now runs from the internal oscillator, whose clock is not good enough for the bus.
#[exception]
unsafe fn NonMaskableInt() {
    crystal_failed();
}

/// Whatever it interrupts. The power goes first, and no code that goes on gives it back.
fn crystal_failed() {
    bxcan::leave();
    app::CLOCK_FAILED.store(true, core::sync::atomic::Ordering::Relaxed);
    clocks::acknowledge_failure();
    serial::follow_internal_oscillator();
    tool::follow_internal_oscillator();
}
