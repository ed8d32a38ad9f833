//! Everything of the chip but its core: peripherals, their connections, and time.

use crate::board_wires::BoardWires;
use crate::debug::Debug;
use crate::defect::Defect;
use crate::nvic::{NMI, Nvic};
use crate::peripherals::adc::Adc;
use crate::peripherals::bxcan::BxCan;
use crate::peripherals::capture_timer::{CaptureTimer, Clocks};
use crate::peripherals::dma::Dma;
use crate::peripherals::encoder_timer::EncoderTimer;
use crate::peripherals::flash::Flash;
use crate::peripherals::gpio::Port;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::pulse_timer::PulseTimer;
use crate::peripherals::pwm_timer::PwmTimer;
use crate::peripherals::rcc::Rcc;
use crate::peripherals::reset_cause::ResetCause;
use crate::peripherals::tick_timer::TickTimer;
use crate::peripherals::tim1::Tim1;
use crate::peripherals::usart::Usart;
use crate::pwr::Pwr;
use crate::systick::{Dwt, SysTick};
use crate::time::{NEVER, Time};
use crate::violation::{Access, Violation, refuse};
use crate::wiring::{Outputs, Wiring};
use fivebar_firmware::drivers::boards::{Board, REFERENCE, Row, Use};

/// Address and size of the RAM.
pub(crate) const RAM: u32 = 0x2000_0000;
pub(crate) const RAM_SIZE: usize = 128 * 1024;

/// How the chip is made and what it runs at.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Frequency of the crystal [Hz].
    pub crystal: f64,
    /// Whether the crystal starts.
    pub crystal_works: bool,
    /// Frequency of the internal oscillator: 16 MHz − 8 to + 4.5 % [Hz].
    pub hsi: f64,
    /// Frequency of the slow oscillator: 17 to 47 kHz [Hz].
    pub lsi: f64,
    /// Symbols per second that the host sends and receives.
    pub host_baud: u64,
    /// What the image is for.
    pub drives: DriveKind,
    /// The board that the image is built for.
    pub board: &'static Board,
    /// What is wrong with the chip, if something is.
    pub defect: Option<Defect>,
}

/// What turns the joints. Some timers are simulated only as the image for these uses them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Brushed motors. TIM8 makes one pulse for each tick, TIM5 counts an encoder.
    Brushed,
    /// Steppers. TIM8 makes the pulses of one.
    Steppers,
    /// Drives on a CAN bus. TIM5 counts the ticks.
    OnBus,
}

impl DriveKind {
    /// The signals of a board with the image for these.
    fn rows(self, board: &Board) -> Vec<Row> {
        let mut rows = board.common.rows(Use::Level).to_vec();
        match self {
            Self::Brushed => rows.extend(board.brushed().rows()),
            Self::Steppers => rows.extend(board.stepper().rows()),
            Self::OnBus => rows.extend(board.can().rows()),
        }
        rows
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            crystal: 8e6,
            crystal_works: true,
            hsi: 16e6,
            lsi: 32e3,
            host_baud: 1_000_000,
            drives: DriveKind::Brushed,
            board: &REFERENCE,
            defect: None,
        }
    }
}

/// The chip without its core.
pub(crate) struct Mcu {
    pub(crate) now: Time,
    /// Period of the core's clock.
    pub(crate) core: Time,
    /// Cycles up to `cycles_at`, and that time.
    pub(crate) cycles: u64,
    pub(crate) cycles_at: Time,
    pub(crate) rcc: Rcc,
    pub(crate) flash: Flash,
    pub(crate) tim1: Tim1,
    /// TIM8 with brushed motors.
    pub(crate) pulse: PulseTimer,
    /// TIM8 with steppers.
    pub(crate) tim8: Tim1,
    /// TIM4, or TIM5 with drives on a bus.
    pub(crate) ticks: TickTimer,
    /// CAN1.
    pub(crate) can: BxCan,
    pub(crate) encoders: [EncoderTimer; 2],
    /// TIM3.
    pub(crate) tool: PwmTimer,
    /// TIM11.
    pub(crate) capture: CaptureTimer,
    pub(crate) adc: Adc,
    pub(crate) dma: Dma,
    pub(crate) usart: Usart,
    pub(crate) iwdg: Iwdg,
    pub(crate) pwr: Pwr,
    pub(crate) ports: Vec<Port>,
    pub(crate) nvic: Nvic,
    pub(crate) systick: SysTick,
    pub(crate) dwt: Dwt,
    pub(crate) debug: Debug,
    pub(crate) ram: Box<[u8]>,
    pub(crate) wiring: Box<dyn Wiring>,
    pub(crate) outputs: Outputs,
    /// The core stands still until then: the flash is busy.
    pub(crate) stalled_until: Time,
    pub(crate) bus_error: bool,
    /// TIM1's counter when it last triggered the converters, and that time.
    pub(crate) triggered_at: Option<(u32, Time)>,
    /// Least and greatest time from there to that of the encoders' counts which the program reads.
    pub(crate) latched_after: Option<[Time; 2]>,
    /// A reset that waits to be made.
    pub(crate) reset: Option<ResetCause>,
    pub(crate) violation: Option<Violation>,
    pub(crate) options: Options,
    pub(crate) wires: BoardWires,
    /// When the next event is due.
    pub(crate) due: Time,
}

impl Mcu {
    pub(crate) fn new(options: Options, sectors: Vec<u8>, wiring: Box<dyn Wiring>) -> Self {
        let mut rcc = Rcc::new(options.crystal, options.hsi);
        rcc.crystal_works = options.crystal_works;
        rcc.reset(ResetCause::Power);
        let core = rcc.core_period().unwrap_or(1);
        let mut mcu = Self {
            now: 0,
            core,
            cycles: 0,
            cycles_at: 0,
            rcc,
            flash: Flash::with_defect(sectors, options.defect),
            tim1: Tim1::new(core),
            pulse: PulseTimer::new(),
            tim8: Tim1::tim8(core),
            ticks: TickTimer::new(core),
            can: BxCan::new(),
            encoders: [EncoderTimer::new(), EncoderTimer::new()],
            tool: PwmTimer::new(core),
            capture: CaptureTimer::new(),
            adc: Adc::new(),
            dma: Dma::new(),
            usart: Usart::new(options.host_baud),
            iwdg: Iwdg::new(options.lsi, options.defect != Some(Defect::NoWatchdog)),
            pwr: Pwr::new(),
            ports: (0..9).map(Port::new).collect(),
            nvic: Nvic::new(),
            systick: SysTick::new(),
            dwt: Dwt::new(),
            debug: Debug::default(),
            // Memory holds anything at power-up.
            ram: vec![0xa5; RAM_SIZE].into_boxed_slice(),
            wiring,
            outputs: Outputs::RELEASED,
            stalled_until: 0,
            bus_error: false,
            triggered_at: None,
            latched_after: None,
            reset: None,
            violation: None,
            options,
            wires: BoardWires::new(
                &options.drives.rows(options.board),
                &options.drives.rows(&REFERENCE),
            ),
            due: 0,
        };
        mcu.settle(0);
        mcu
    }

    /// Resets everything but RAM, flash and time.
    pub(crate) fn make_reset(&mut self, cause: ResetCause) {
        self.rcc.reset(cause);
        self.flash.reset();
        self.tim1.reset();
        self.pulse = PulseTimer::new();
        self.tim8.reset();
        self.ticks = TickTimer::new(self.core);
        self.can = BxCan::new();
        self.encoders = [EncoderTimer::new(), EncoderTimer::new()];
        self.tool = PwmTimer::new(self.core);
        self.capture = CaptureTimer::new();
        self.adc = Adc::new();
        self.dma = Dma::new();
        self.usart.reset();
        let has_watchdog = self.options.defect != Some(Defect::NoWatchdog);
        self.iwdg = Iwdg::new(self.options.lsi, has_watchdog);
        self.pwr = Pwr::new();
        self.ports = (0..9).map(Port::new).collect();
        self.nvic = Nvic::new();
        self.systick = SysTick::new();
        self.dwt = Dwt::new();
        self.cycles = self.cycle_at(self.now);
        self.cycles_at = self.now;
        self.debug.reset(cause);
        self.stalled_until = 0;
        self.bus_error = false;
        self.reset = None;
        self.follow_clocks(self.now);
        self.settle(self.now);
    }

    /// Cycles that the core has counted up to a time; it counts none while a debugger halts it.
    pub(crate) fn cycle_at(&self, time: Time) -> u64 {
        if self.debug.is_halted() {
            return self.cycles;
        }
        self.cycles + time.saturating_sub(self.cycles_at) / self.core
    }

    pub(crate) fn time_of_cycle(&self, cycle: u64) -> Time {
        if cycle == NEVER || self.debug.is_halted() {
            return NEVER;
        }
        self.cycles_at + cycle.saturating_sub(self.cycles) * self.core
    }

    /// Gives every part its clock after a change in RCC.
    pub(crate) fn follow_clocks(&mut self, at: Time) {
        let core = self.rcc.core_period();
        self.cycles = self.cycle_at(at);
        self.cycles_at = at;
        // Without a clock the core stands still; time goes on.
        self.core = core.unwrap_or(self.core);
        self.stalled_until = match core {
            None => NEVER,
            Some(_) if self.stalled_until == NEVER => at,
            Some(_) => self.stalled_until,
        };
        self.tim1
            .set_clock(self.core * self.rcc.timer_cycles(1), at);
        self.tim8
            .set_clock(self.core * self.rcc.timer_cycles(1), at);
        self.ticks
            .set_clock(self.core * self.rcc.timer_cycles(0), at);
        self.tool
            .set_clock(self.core * self.rcc.timer_cycles(0), at);
        self.usart.set_clock(self.bus_period(1));
        self.can.set_clock(self.bus_period(0));
        if let Some(rule) = self.rcc.check_limits(self.flash.wait_states()) {
            self.note::<()>(refuse("RCC", self.rcc.read(8), rule));
        }
    }

    pub(crate) fn bus_period(&self, bus: usize) -> Time {
        self.core * self.rcc.bus_cycles(bus)
    }

    /// Whether TIM8 makes the pulses of a stepper.
    pub(crate) fn has_steppers(&self) -> bool {
        self.options.drives == DriveKind::Steppers
    }

    /// Whether the drives are on a bus.
    pub(crate) fn is_on_bus(&self) -> bool {
        self.options.drives == DriveKind::OnBus
    }

    /// Whether the figures of the image for brushed motors are collected.
    pub(crate) fn has_brushed_motors(&self) -> bool {
        self.options.drives == DriveKind::Brushed
    }

    pub(crate) fn pulse_clock(&self) -> Time {
        self.core * self.rcc.timer_cycles(1)
    }

    pub(crate) fn capture_clocks(&self) -> Clocks {
        Clocks {
            timer: self.core * self.rcc.timer_cycles(1),
            crystal: self.rcc.divided_crystal(),
        }
    }

    pub(crate) fn note<T>(&mut self, result: Access<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(violation) => {
                self.violation.get_or_insert(violation);
                None
            }
        }
    }

    /// The crystal stops.
    pub(crate) fn crystal_fails(&mut self) {
        if self.rcc.crystal_fails() {
            self.nvic.pend(NMI);
        }
        self.follow_clocks(self.now);
        self.settle(self.now);
    }
}
