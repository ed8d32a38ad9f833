//! At which pins the peripherals of an STM32F405 and F407 have the signals that the images use (DS8626, table 9; compared
//! with ST's data as Zephyr's `hal_stm32` has it, `dts/st/f4/stm32f407i(e-g)hx-pinctrl.dtsi` at fe7d2e2).

/// A pin of the chip: 16 times its port, 0 for A, and its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin(pub u8);

impl Pin {
    /// The pin of this port, `b'A'` to `b'I'`, and number, 0 to 15.
    pub const fn new(port: u8, number: u8) -> Self {
        assert!(
            port >= b'A' && port <= b'I' && number < 16,
            "a pin of the chip"
        );
        Self((port - b'A') << 4 | number)
    }

    /// Its port, 0 for A.
    pub const fn port(self) -> u8 {
        self.0 >> 4
    }

    /// Its number in the port.
    pub const fn number(self) -> u8 {
        self.0 & 15
    }
}

impl core::fmt::Display for Pin {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.port()), self.number())
    }
}

/// A signal of a peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peripheral {
    /// A channel of TIM1, 1 to 4.
    Tim1(u8),
    /// TIM1's break input.
    Tim1Break,
    /// Channel 1 or 2 of TIM2.
    Tim2(u8),
    /// Channel 2 of TIM3.
    Tim3,
    /// Channel 1 or 2 of TIM5.
    Tim5(u8),
    /// Channel 3 of TIM8.
    Tim8,
    /// TIM8's break input.
    Tim8Break,
    /// USART1, out.
    Usart1Send,
    /// USART1, in.
    Usart1Receive,
    /// CAN1, out.
    Can1Send,
    /// CAN1, in.
    Can1Receive,
}

impl Peripheral {
    /// The number of the alternate function, and the pins that have it.
    pub const fn places(self) -> (u8, &'static [Pin]) {
        const fn p(port: u8, number: u8) -> Pin {
            Pin::new(port, number)
        }
        match self {
            Self::Tim1(1) => (1, const { &[p(b'A', 8), p(b'E', 9)] }),
            Self::Tim1(2) => (1, const { &[p(b'A', 9), p(b'E', 11)] }),
            Self::Tim1(3) => (1, const { &[p(b'A', 10), p(b'E', 13)] }),
            Self::Tim1(4) => (1, const { &[p(b'A', 11), p(b'E', 14)] }),
            Self::Tim1Break => (1, const { &[p(b'A', 6), p(b'B', 12), p(b'E', 15)] }),
            Self::Tim2(1) => (1, const { &[p(b'A', 0), p(b'A', 5), p(b'A', 15)] }),
            Self::Tim2(2) => (1, const { &[p(b'A', 1), p(b'B', 3)] }),
            Self::Tim3 => (2, const { &[p(b'A', 7), p(b'B', 5), p(b'C', 7)] }),
            Self::Tim5(1) => (2, const { &[p(b'A', 0), p(b'H', 10)] }),
            Self::Tim5(2) => (2, const { &[p(b'A', 1), p(b'H', 11)] }),
            Self::Tim8 => (3, const { &[p(b'C', 8), p(b'I', 7)] }),
            Self::Tim8Break => (3, const { &[p(b'A', 6), p(b'I', 4)] }),
            Self::Usart1Send => (7, const { &[p(b'A', 9), p(b'B', 6)] }),
            Self::Usart1Receive => (7, const { &[p(b'A', 10), p(b'B', 7)] }),
            Self::Can1Receive => (
                9,
                const { &[p(b'A', 11), p(b'B', 8), p(b'D', 0), p(b'I', 9)] },
            ),
            Self::Can1Send => (
                9,
                const { &[p(b'A', 12), p(b'B', 9), p(b'D', 1), p(b'H', 13)] },
            ),
            Self::Tim1(_) | Self::Tim2(_) | Self::Tim5(_) => (0, &[]),
        }
    }

    /// Whether this pin has the signal.
    pub const fn is_at(self, pin: Pin) -> bool {
        let (_, places) = self.places();
        let mut place = 0;
        while place < places.len() {
            if places[place].0 == pin.0 {
                return true;
            }
            place += 1;
        }
        false
    }
}

/// The pin of ADC1's and ADC2's input of this number, 10 to 15.
pub const fn analog(input: u8) -> Pin {
    Pin::new(b'C', input - 10)
}
