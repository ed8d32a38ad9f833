//! The production image: an STM32F405RG that drives two motors.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | `tripped`: the break input | 4 | none: the outputs are off before it runs |
//! | `tick`: samples in, bridge commands out | 3 | the next tick, 100 µs; misses are counted |
//! | `receive`: bytes into orders | 2 | the ring's 5 ms |
//! | `converse`: session, planner, telemetry, watchdog | idle | the watchdog's 50 ms |
//!
//! Without a crystal the PWM never starts. `slow_tick` then lets the tick run all the same,
//! so that the controller tells of its clock fault, which cannot be cleared.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;
use fivebar_firmware::board::post_mortem::{Death, die};
use fivebar_firmware::board::pwm;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use core::sync::atomic::{AtomicBool, Ordering};
    use cortex_m::peripheral::NVIC;
    use cortex_m::peripheral::syst::SystClkSource;
    use fivebar_firmware::board::analog::CurrentsAndBus;
    use fivebar_firmware::board::clocks::{self, Source};
    use fivebar_firmware::board::cycles::CycleMeter;
    use fivebar_firmware::board::encoders::Encoders;
    use fivebar_firmware::board::outputs::Outputs;
    use fivebar_firmware::board::pwm::PwmTimer;
    use fivebar_firmware::board::storage::SettingsFlash;
    use fivebar_firmware::board::watchdog::{Task, Watchdog};
    use fivebar_firmware::board::{post_mortem, serial, stack};
    use fivebar_firmware::drivers::{Bridge, Inputs};
    use fivebar_firmware::planner::Planner;
    use fivebar_firmware::protocol::{Board, Decoder, HostMessage, Identity, Order, StackUse};
    use fivebar_firmware::safety::Fault;
    use fivebar_firmware::session::{self, Session, fault_at_start};
    use fivebar_firmware::storage::{SettingsStorage, StorageError};
    use fivebar_firmware::{Command, Controller, Request, Sensed, Settings};
    use heapless::spsc::{Consumer, Producer, Queue};
    use stm32f4xx_hal::gpio::{
        Alternate, Input, Output, PB0, PB1, PB12, PB14, PB15, PC4, PC5, PC6,
    };
    use stm32f4xx_hal::pac::Interrupt;
    use stm32f4xx_hal::prelude::*;

    /// The tick's rate, by the PWM timer; settings of another rate are not used [Hz].
    const TICK_RATE: f32 = 10_000.0;
    /// Cycles from one tick to the next.
    const TICK_CYCLES: u32 = 16_800;
    /// Cycles of the internal oscillator from one slow tick to the next: 1 kHz.
    const SLOW_TICK: u32 = 16_000;
    /// Ticks from one line of the log to the next.
    const LOG_EVERY: u32 = 10_000;

    /// The break input tripped, or the host ordered an emergency stop: for the next tick.
    static STOP: AtomicBool = AtomicBool::new(false);
    /// The crystal did not start, or died.
    pub(crate) static CLOCK_FAILED: AtomicBool = AtomicBool::new(false);

    /// The stop button hangs on the timer's break pin, which can be read all the same.
    type Switches = Inputs<PC4<Input>, PC5<Input>, PB12<Alternate<1>>, PB0<Input>, PB1<Input>>;

    #[shared]
    struct Shared {
        controller: Controller,
    }

    #[local]
    struct Local {
        sensors: Sensors,
        outputs: Outputs<PB14<Output>, PB15<Output>, PC6<Output>>,
        meter: CycleMeter,
        receiver: serial::Receiver,
        arrived: Producer<'static, HostMessage>,
        orders: Consumer<'static, HostMessage>,
        sender: serial::Sender,
        planner: Planner,
        session: Session,
        keeper: Keeper,
    }

    /// Everything a tick's samples come from.
    pub(crate) struct Sensors {
        encoders: Encoders,
        analog: CurrentsAndBus,
        switches: Switches,
    }

    impl Sensors {
        fn sense(&mut self, missed_ticks: u32) -> Sensed {
            let counts = self.encoders.latch();
            let samples = self.analog.take();
            let stopped = STOP.swap(false, Ordering::Relaxed);
            Sensed {
                counts,
                current: samples.current,
                bus_voltage: samples.bus_voltage,
                home: self.switches.home(),
                emergency_stop: self.switches.emergency_stop() || stopped,
                driver_fault: self.switches.driver_fault(),
                missed_ticks,
            }
        }
    }

    /// Keeps settings, and the watchdog from biting meanwhile.
    pub(crate) struct Keeper {
        storage: Option<SettingsStorage<SettingsFlash>>,
        watchdog: Watchdog,
    }

    impl session::Board for Keeper {
        fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
            let storage = self.storage.as_mut().ok_or(StorageError::Range)?;
            self.watchdog.widened(|| storage.save(settings))
        }

        fn tick_rate(&self) -> Option<f32> {
            Some(TICK_RATE)
        }

        fn tick(&mut self, _: &mut Controller, _: &Sensed) -> Option<(Command, u32)> {
            None
        }

        fn stack(&self) -> Option<StackUse> {
            Some(stack::used())
        }
    }

    #[init(local = [
        buffers: serial::Buffers = serial::Buffers::new(),
        queue: Queue<HostMessage, 4> = Queue::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (device, mut core) = (cx.device, cx.core);
        let reset = post_mortem::reset_reason(&device.RCC);
        let (mut rcc, source) = clocks::start(device.RCC, &device.FLASH);
        let (a, b, c) = (
            device.GPIOA.split(&mut rcc),
            device.GPIOB.split(&mut rcc),
            device.GPIOC.split(&mut rcc),
        );

        // The bridges first: asleep, outputs low.
        let sleep = (
            b.pb14.into_push_pull_output(),
            b.pb15.into_push_pull_output(),
        );
        let pins = (
            a.pa8.into_alternate(),
            a.pa9.into_alternate(),
            a.pa10.into_alternate(),
            a.pa11.into_alternate(),
        );
        let (timer, (in1, in2, in3, in4)) = PwmTimer::new(device.TIM1, pins, &mut rcc);
        let mut outputs = Outputs {
            timer,
            bridge1: Bridge::new(in1, in2, sleep.0),
            bridge4: Bridge::new(in3, in4, sleep.1),
            brake: c.pc6.into_push_pull_output(),
        };

        let joint1 = (device.TIM5, a.pa0.into_alternate(), a.pa1.into_alternate());
        let joint4 = (device.TIM2, a.pa15.into_alternate(), b.pb3.into_alternate());
        let analog = (
            c.pc0.into_analog(),
            c.pc1.into_analog(),
            c.pc2.into_analog(),
        );
        let sensors = Sensors {
            encoders: Encoders::new(joint1, joint4, &mut rcc),
            analog: CurrentsAndBus::new(device.ADC1, &device.ADC_COMMON, analog, &mut rcc),
            switches: Inputs {
                home1: c.pc4.into_pull_up_input(),
                home4: c.pc5.into_pull_up_input(),
                emergency_stop: b.pb12.into_alternate(),
                fault1: b.pb0.into_pull_up_input(),
                fault4: b.pb1.into_pull_up_input(),
            },
        };
        let line = (b.pb6.into_alternate(), b.pb7.into_alternate());
        let (receiver, sender) = serial::new(
            &device.USART1,
            &device.DMA2,
            line,
            cx.local.buffers,
            source.second_bus(),
            &mut rcc,
        );
        let (arrived, orders) = cx.local.queue.split();

        let (storage, loaded) = load(SettingsFlash::new(device.FLASH));
        let settings = loaded.unwrap_or(Settings::BENCHTOP);
        let (Ok(mut controller), Ok(planner)) =
            (Controller::new(&settings), Planner::new(&settings))
        else {
            panic!("settings are checked when they are loaded");
        };
        let crystal_runs = source == Source::Crystal;
        CLOCK_FAILED.store(!crystal_runs, Ordering::Relaxed);
        if let Some(fault) = fault_at_start(crystal_runs, reset, loaded.err()) {
            controller.latch_fault(fault);
        }
        defmt::info!("started from reset {}", reset as u8);

        let meter = CycleMeter::new(&mut core.DCB, &mut core.DWT);
        match source {
            Source::Crystal => outputs.timer.start(),
            Source::Internal => {
                core.SYST.set_clock_source(SystClkSource::Core);
                core.SYST.set_reload(SLOW_TICK - 1);
                core.SYST.clear_current();
                core.SYST.enable_interrupt();
                core.SYST.enable_counter();
            }
        }
        let identity = Identity::new(Board::Stm32f405, reset);
        let local = Local {
            sensors,
            outputs,
            meter,
            receiver,
            arrived,
            orders,
            sender,
            planner,
            session: Session::new(identity, &settings, loaded.is_ok()),
            keeper: Keeper {
                storage,
                watchdog: Watchdog::start(device.IWDG),
            },
        };
        (Shared { controller }, local)
    }

    /// The stored settings, if there are any that this board can use.
    fn load(
        flash: SettingsFlash,
    ) -> (
        Option<SettingsStorage<SettingsFlash>>,
        Result<Settings, StorageError>,
    ) {
        let range = SettingsFlash::RANGE;
        let mut storage = match SettingsStorage::new(flash, range) {
            Ok(storage) => storage,
            Err(error) => return (None, Err(error)),
        };
        let loaded = storage.load().and_then(|settings| {
            let usable = settings.control.tick_rate == TICK_RATE && settings.validate().is_ok();
            if usable {
                Ok(settings)
            } else {
                Err(StorageError::Corrupt)
            }
        });
        (Some(storage), loaded)
    }

    /// The break input has switched the outputs off; the controller is told.
    #[task(binds = TIM1_BRK_TIM9, priority = 4)]
    fn tripped(_: tripped::Context) {
        if PwmTimer::take_break() {
            STOP.store(true, Ordering::Relaxed);
        }
    }

    /// Without the PWM timer's beat: the converter's interrupt, raised by hand.
    #[task(binds = SysTick, priority = 3)]
    fn slow_tick(_: slow_tick::Context) {
        NVIC::pend(Interrupt::ADC);
    }

    /// The control tick, at the end of the converter's sequence.
    #[task(binds = ADC, priority = 3, shared = [controller], local = [sensors, outputs, meter])]
    fn tick(mut cx: tick::Context) {
        let (sensors, outputs, meter) = (cx.local.sensors, cx.local.outputs, cx.local.meter);
        let missed = meter.missed(TICK_CYCLES);
        let ticks = meter.measure(|| {
            let sensed = sensors.sense(missed);
            cx.shared.controller.lock(|controller| {
                if CLOCK_FAILED.load(Ordering::Relaxed) {
                    controller.latch_fault(Fault::ClockFailure);
                }
                outputs.obey(&controller.tick(&sensed));
                controller.ticks()
            })
        });
        Task::Tick.advanced();
        if ticks % LOG_EVERY == 0 {
            defmt::info!("tick: {} cycles, at most {}", meter.last(), meter.most());
        }
    }

    /// Bytes into orders. One that finds the queue full is dropped; the host asks again.
    #[task(binds = USART1, priority = 2, local = [
        receiver,
        arrived,
        decoder: Decoder<HostMessage> = Decoder::new(),
    ])]
    fn receive(cx: receive::Context) {
        let (decoder, arrived) = (cx.local.decoder, cx.local.arrived);
        cx.local.receiver.drain(|byte| {
            if let Some(Ok(message)) = decoder.feed(byte) {
                if message.order == Order::Request(Request::EmergencyStop) {
                    // Ahead of the queue, which may wait for the planner.
                    STOP.store(true, Ordering::Relaxed);
                }
                let _ = arrived.enqueue(message);
            }
        });
    }

    #[idle(shared = [controller], local = [orders, sender, planner, session, keeper])]
    fn converse(mut cx: converse::Context) -> ! {
        let local = cx.local;
        loop {
            let controller = &mut cx.shared.controller;
            if let Some(message) = local.orders.dequeue() {
                let session = &mut *local.session;
                if let Some(frame) =
                    session.answer(&message, controller, local.planner, local.keeper)
                {
                    local.sender.send(&frame);
                }
            }
            local.planner.run(controller);
            if let Some(frame) = local.session.telemetry(controller) {
                local.sender.send(&frame);
            }
            Task::Session.advanced();
            local.keeper.watchdog.feed_if_all_advanced();
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    pwm::unpower();
    die(Death::Panic)
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    pwm::unpower();
    die(Death::HardFault)
}

/// The crystal died: the core goes on from the internal oscillator, the break input has
/// tripped.
#[exception]
unsafe fn NonMaskableInt() {
    pwm::unpower();
    app::CLOCK_FAILED.store(true, core::sync::atomic::Ordering::Relaxed);
    fivebar_firmware::board::clocks::acknowledge_failure();
}
