//! The peripherals, from the reference manual RM0090. One that is not simulated, or a
//! function of one that is not, ends the run.

pub(crate) mod adc;
pub(crate) mod bxcan;
pub(crate) mod capture_timer;
pub(crate) mod dma;
pub(crate) mod encoder_timer;
pub(crate) mod flash;
pub(crate) mod gpio;
pub(crate) mod iwdg;
pub(crate) mod pulse_timer;
pub(crate) mod pwm_timer;
pub(crate) mod rcc;
pub(crate) mod reset_cause;
pub(crate) mod tick_timer;
pub(crate) mod tim1;
pub(crate) mod usart;
