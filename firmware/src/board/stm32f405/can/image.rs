//! The production image for torque drives on a CAN bus: an STM32F405RG that sends two drives their commands.
//!
//! The response of its tick may take 0.2 ms of 1 ms, so that the frames come in time.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;
use fivebar_firmware::drivers::boards::BUILT;

const _: () = if let Err(reason) = BUILT.can {
    panic!("{}", reason);
};

fivebar_firmware::stm32f405_image! {
    parts: fivebar_firmware::board::stm32f405::can::Can,
    peripherals: (TIM5, CAN1),
    tick: TIM5,
    // The drives are stopped by frames, which need a stack.
    before_stack: [], operands: [],
    tasks: {
        /// A frame has gone over the bus, or was taken back: there is room for the next one of the tick. It comes before the
        /// frames in the other two mailboxes are over, in 0.2 ms.
        #[task(binds = CAN1_TX, priority = 3, shared = [locked])]
        fn sent(mut cx: sent::Context) {
            cx.shared.locked.lock(|locked| locked.parts.bus.fill());
        }
    }
}
