//! What each image for this chip gives the one body.

/// The whole program of an image: its [`OnChip`](crate::board::stm32f405::image::OnChip), what it takes of the chip, and what
/// [`image!`](crate::image) asks for the drives.
#[macro_export]
macro_rules! stm32f405_image {
    (
        parts: $parts:ty,
        peripherals: ($($peripheral:ident),*),
        tick: $tick:ident,
        before_stack: [$($instruction:literal),*], operands: [$($operand:tt)*],
        tasks: { $($tasks:tt)* }
    ) => {
        $crate::image! {
            registers: [stm32f4xx_hal::pac],
            set_up: (device, lines, commands) => $crate::board::stm32f405::image::set_up::<$parts>(
                $crate::board::stm32f405::image::CommonPeripherals {
                    rcc: device.RCC,
                    flash: device.FLASH,
                    debug: device.DBGMCU,
                    watchdog: device.IWDG,
                    crystal_timer: device.TIM11,
                    tool_timer: device.TIM3,
                    usart: device.USART1,
                    dma: device.DMA2,
                },
                ($(device.$peripheral),*),
                lines,
                commands,
            ),
            started: $crate::board::stm32f405::image::started::<$parts>,
            parts: $parts,
            tick: $tick,
            receive: USART1,
            before_stack: [$($instruction),*], operands: [$($operand)*],
            locals: {},
            tasks: { $($tasks)* }
        }

        /// The crystal failed: the core now runs from the internal oscillator.
        #[cortex_m_rt::exception]
        unsafe fn NonMaskableInt() {
            $crate::board::stm32f405::image::crystal_failed::<$parts>();
        }
    };
}
