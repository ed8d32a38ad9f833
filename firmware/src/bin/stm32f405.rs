//! The production image.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes the code that needs it"
)]

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;
use fivebar_firmware::board::post_mortem::{Death, die};
use fivebar_firmware::board::pwm;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use fivebar_firmware::board::{
        analog::Analog3, clocks, cycles::CycleMeter, encoders::Encoders, post_mortem,
        pwm::PwmTimer, serial, storage::SettingsFlash, watchdog::Watchdog,
    };
    use fivebar_firmware::drivers::{Bridge, Inputs};
    use stm32f4xx_hal::prelude::*;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: serial::Receiver,
        analog: Analog3,
        encoders: Encoders,
    }

    #[init(local = [buffers: serial::Buffers = serial::Buffers::new()])]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        let reset = post_mortem::reset_reason(&cx.device.RCC);
        let (mut rcc, source) = clocks::start(cx.device.RCC);
        let a = cx.device.GPIOA.split(&mut rcc);
        let b = cx.device.GPIOB.split(&mut rcc);
        let c = cx.device.GPIOC.split(&mut rcc);
        let (receiver, sender) = serial::new(
            &cx.device.USART1,
            &cx.device.DMA2,
            (b.pb6.into_alternate(), b.pb7.into_alternate()),
            cx.local.buffers,
            &rcc.clocks.clone(),
            &mut rcc,
        );
        let encoders = Encoders::new(
            (
                cx.device.TIM5,
                a.pa0.into_alternate(),
                a.pa1.into_alternate(),
            ),
            (
                cx.device.TIM2,
                a.pa15.into_alternate(),
                b.pb3.into_alternate(),
            ),
            &mut rcc,
        );
        let analog = Analog3::new(
            cx.device.ADC1,
            &cx.device.ADC_COMMON,
            (
                c.pc0.into_analog(),
                c.pc1.into_analog(),
                c.pc2.into_analog(),
            ),
            &mut rcc,
        );
        (
            Shared {},
            Local {
                receiver,
                analog,
                encoders,
            },
        )
    }

    #[task(binds = USART1, priority = 2, local = [receiver])]
    fn receive(cx: receive::Context) {
        cx.local.receiver.drain(|byte| {
            core::hint::black_box(byte);
        });
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
