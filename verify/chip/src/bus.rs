//! Which unit is at which address, and whether its clock runs.

use crate::mcu::Mcu;
use crate::violation::{Access, Violation};
use fivebar_kinematics::five_bar::Joint;

/// A unit with registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    Rcc,
    Flash,
    Tim1,
    /// TIM8.
    Pulse,
    /// TIM4.
    Ticks,
    /// TIM5 of joint 1, TIM2 of joint 4.
    Encoder(Joint),
    Adc,
    Dma2,
    /// TIM3.
    Tool,
    /// TIM11.
    Capture,
    Usart1,
    /// CAN1.
    Can,
    Iwdg,
    Pwr,
    Gpio(u8),
    /// NVIC, SCB, SysTick.
    Scs,
    Dwt,
    /// DBGMCU.
    Debug,
}

/// The bus and bit of a unit's clock in RCC; none for one that is always clocked.
type Gate = Option<(usize, u32)>;

/// Where the units are: first address, size, unit, and the bus and bit of its clock.
const MAP: [(u32, u32, Unit, Gate); 19] = [
    (
        0x4000_0000,
        0x400,
        Unit::Encoder(Joint::Joint4),
        Some((3, 0)),
    ),
    (0x4000_0400, 0x400, Unit::Tool, Some((3, 1))),
    (0x4000_0800, 0x400, Unit::Ticks, Some((3, 2))),
    (
        0x4000_0c00,
        0x400,
        Unit::Encoder(Joint::Joint1),
        Some((3, 3)),
    ),
    (0x4000_3000, 0x400, Unit::Iwdg, None),
    (0x4000_6400, 0x400, Unit::Can, Some((3, 25))),
    (0x4000_7000, 0x400, Unit::Pwr, Some((3, 28))),
    (0x4001_0000, 0x400, Unit::Tim1, Some((4, 0))),
    (0x4001_0400, 0x400, Unit::Pulse, Some((4, 1))),
    (0x4001_1000, 0x400, Unit::Usart1, Some((4, 4))),
    (0x4001_2000, 0x400, Unit::Adc, Some((4, 8))),
    (0x4001_4800, 0x400, Unit::Capture, Some((4, 18))),
    (0x4002_0000, 0x2400, Unit::Gpio(0), Some((0, 0))),
    (0x4002_3800, 0x400, Unit::Rcc, None),
    (0x4002_3c00, 0x400, Unit::Flash, None),
    (0x4002_6400, 0x400, Unit::Dma2, Some((0, 22))),
    (0xe000_1000, 0x1000, Unit::Dwt, None),
    (0xe000_e000, 0x1000, Unit::Scs, None),
    (0xe004_2000, 0x400, Unit::Debug, None),
];

/// The unit at an address, and the offset in it; `written` is the value, for the report.
pub(crate) fn locate(mcu: &Mcu, address: u32, written: Option<u32>) -> Access<(Unit, u32)> {
    let violation = |rule: &str| Violation {
        register: format!("{address:#010x}"),
        written,
        rule: rule.to_owned(),
    };
    let found = MAP
        .iter()
        .find(|(start, size, ..)| (*start..start + size).contains(&address));
    let Some(&(start, _, unit, gate)) = found else {
        return Err(violation("no simulated unit has this address"));
    };
    let offset = address - start;
    let (unit, offset, gate) = match unit {
        Unit::Gpio(_) => {
            let port = offset / 0x400;
            (Unit::Gpio(port as u8), offset % 0x400, Some((0, port)))
        }
        // ADC1 to ADC3 have gates of their own.
        Unit::Adc if offset < 0x300 => (unit, offset, Some((4, 8 + offset / 0x100))),
        _ => (unit, offset, gate),
    };
    match gate {
        Some((bus, bit)) if !mcu.rcc.is_clocked(bus, bit) => Err(violation(&format!(
            "{unit:?} has no clock, or is held in reset"
        ))),
        _ => Ok((unit, offset)),
    }
}
