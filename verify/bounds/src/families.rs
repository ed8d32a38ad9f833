//! The images that drive an arm, by their chips: their ticks, their limits, what people state of them and their committed figures. This is
//! the one table of chips here.

use crate::report::Row;
use crate::response::Driving;
use crate::stated::Stated;
use crate::timing::Measure;

/// Images that are built and checked together.
pub struct Family {
    /// What the program's arguments call it; nothing for the first one.
    pub name: &'static str,
    /// Those with a tick of their own.
    pub images: &'static [Driving],
    /// Those besides.
    pub others: &'static [&'static str],
    /// What people state of them, besides what they state of all images.
    stated: &'static str,
    /// The figures as last committed.
    pub committed: &'static str,
    /// Their file.
    pub file: &'static str,
}

/// Of the STM32F405 and of the emulated board.
pub const STM32F405: Family = Family {
    images: &[BRUSHED, STEPPER, CAN],
    others: &["tick", "qemu"],
    name: "",
    stated: include_str!("../stated_stm32f405.txt"),
    committed: include_str!("../figures.txt"),
    file: "figures.txt",
};
/// Of the RP2350.
pub const RP2350: Family = Family {
    images: &[PICO_STEPPER, PICO_SERVO],
    others: &[],
    name: "rp2350",
    stated: include_str!("../stated_rp2350.txt"),
    committed: include_str!("../figures_rp2350.txt"),
    file: "figures_rp2350.txt",
};

/// All of them.
pub const FAMILIES: [&Family; 2] = [&STM32F405, &RP2350];
/// What people state of any image.
const STATED: &str = include_str!("../stated.txt");

/// The image for brushed motors. `SysTick` is not above its tick: it raises the tick where there is no crystal, and then
/// the converter does not.
pub const BRUSHED: Driving = Driving {
    label: "stm32f405",
    tick: "ADC",
    above: &["TIM1_BRK_TIM9", "NonMaskableInt"],
    below: &["USART1"],
    lowest: None,
    judged: Measure::CyclesCodeWaits,
    conversion: CONVERSION,
    blocking: 840,
    budgets: [TICK_BUDGET, BEFORE_BUDGET, PERIOD],
    receiver: None,
    stack: STACK_BUDGET,
    rom: 0,
};
/// The image for steppers: the update itself raises the interrupt. A status of drives that measure nothing is cleared by a
/// call, which takes longer than to copy what brushed ones measure.
pub const STEPPER: Driving = Driving {
    label: "stm32f405_stepper",
    tick: "TIM4",
    above: &["TIM1_BRK_TIM9", "TIM8_BRK_TIM12", "NonMaskableInt"],
    below: &["USART1"],
    lowest: None,
    judged: Measure::CyclesCodeWaits,
    conversion: 0,
    blocking: 1_008,
    budgets: [TICK_BUDGET, BEFORE_BUDGET, PERIOD],
    receiver: None,
    stack: STACK_BUDGET,
    rom: 0,
};
/// The image for drives on a CAN bus. The interrupt of a free mailbox has the tick's priority, so it comes before the tick, and
/// once: the next frame ends later than it. Its period is ten times as long; 0.2 ms of it are left for the response, so that the
/// frames of both drives go over the bus in it.
pub const CAN: Driving = Driving {
    label: "stm32f405_can",
    tick: "TIM5",
    above: &["CAN1_TX", "NonMaskableInt"],
    below: &["USART1"],
    lowest: None,
    judged: Measure::CyclesCodeWaits,
    conversion: 0,
    blocking: 840,
    budgets: [2 * TICK_BUDGET, 1_008, 2 * PERIOD],
    receiver: None,
    stack: STACK_BUDGET,
    rom: 0,
};
/// The image of a Pico 2 for steppers. Nothing interrupts its tick: the emergency stop's pin has a state machine of its own, which no
/// program delays. Half of the chip's buffer of 32 bytes are 16 of 10 µs.
pub const PICO_STEPPER: Driving = Driving {
    label: "rp2350_stepper",
    tick: "SysTick",
    above: &[],
    below: &["UART0_IRQ"],
    lowest: Some("USBCTRL_IRQ"),
    judged: Measure::CyclesWaiting,
    conversion: 0,
    blocking: 1_800,
    budgets: [12_600, 0, PICO_PERIOD],
    receiver: Some(16 * PICO_PERIOD / 10),
    stack: 24 * 1024,
    rom: 2048,
};
/// The image of a Pico 2 for hobby servos.
pub const PICO_SERVO: Driving = Driving {
    label: "rp2350_servo",
    ..PICO_STEPPER
};
/// Cycles from the trigger to the interrupt: 70 of the converter's clock, which is an eighth of the core's
/// (3 to begin, 40 for a current and 27 for the bus voltage, `firmware/src/board/stm32f405/brushed/analog.rs`).
const CONVERSION: u64 = 8 * (3 + 28 + 12 + 15 + 12);

/// Cycles of a period: 168 MHz over 10 kHz.
pub const PERIOD: u64 = 16_800;
/// Cycles of a period of the RP2350: 150 MHz over 10 kHz.
const PICO_PERIOD: u64 = 15_000;
/// Cycles that the interrupt may take where the code waits for the flash and RAM does not.
const TICK_BUDGET: u64 = 10_080;
/// Cycles that pre-emption may take there.
const BEFORE_BUDGET: u64 = 840;

/// The most that the stack may take, every interrupt within another one [bytes].
pub const STACK_BUDGET: u32 = 12 * 1024;

impl Family {
    /// The rows of its images whose figures are above their budgets.
    pub fn over_budget(&self, rows: &[Row]) -> Vec<String> {
        let over = |image: &Driving| image.over_budget(rows);
        self.images.iter().flat_map(over).collect()
    }

    /// What people state of its images.
    ///
    /// # Errors
    /// A line that says nothing.
    pub fn stated(&self) -> Result<Stated, String> {
        Stated::read(&[STATED, self.stated].concat())
    }
}

/// What people state of any image.
///
/// # Errors
/// A line that says nothing.
pub fn stated_of_all() -> Result<Stated, String> {
    Stated::read(
        &[&[STATED], &FAMILIES.map(|family| family.stated)[..]]
            .concat()
            .concat(),
    )
}
