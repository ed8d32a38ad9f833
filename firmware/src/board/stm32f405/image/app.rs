//! The tasks of each image, as the framework wants them, and the handlers that end it.

/// The whole program of an image: its [`Parts`](crate::board::stm32f405::image::Parts), what these take of the chip, the
/// interrupt of the tick, what the handler of faults does before it has a stack (instructions that need none, and take the
/// power as [`Parts::end`](crate::board::stm32f405::image::Parts::end) does), and tasks of the drives alone.
#[macro_export]
macro_rules! image {
    (
        parts: $parts:ty,
        peripherals: ($($peripheral:ident),*),
        tick: $tick:ident,
        before_stack: [$($instruction:literal),*], operands: [$($operand:tt)*],
        tasks: { $($tasks:tt)* }
    ) => {
        #[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
        mod app {
            use core::mem::MaybeUninit;
            use heapless::spsc::{Producer, Queue};
            use $crate::board::exchanged::Place;
            use $crate::board::cycles::CycleMeter;
            use $crate::board::stm32f405::image::start::{self, CommonPeripherals, Image, Places};
            use $crate::board::stm32f405::image::tasks::{self, Idle};
            use $crate::board::stm32f405::image::Parts;
            use $crate::board::stm32f405::image::shared::Locked;
            use $crate::board::stm32f405::outputs::CommonOutputs;
            use $crate::board::stm32f405::serial::{Buffers, Receiver};
            use $crate::planner::Planner;
            use $crate::protocol::{Decoder, HostMessage};
            use $crate::session::{Session, WAITING};

            #[shared]
            struct Shared {
                locked: Locked<$parts>,
            }

            #[local]
            struct Local {
                meter: CycleMeter,
                outputs: CommonOutputs,
                receiver: Receiver,
                arrived: Producer<'static, HostMessage>,
                idle: Idle<$parts>,
            }

            #[init(local = [
                buffers: Buffers = Buffers::new(),
                queue: Queue<HostMessage, WAITING> = Queue::new(),
                controllers: [Place<<$parts as Parts>::Drives>; 2] = [const { Place::uninit() }; 2],
                planner: Planner = Planner::NONE,
                session: MaybeUninit<Session> = MaybeUninit::uninit(),
            ])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let (device, places) = (cx.device, cx.local);
                let common = CommonPeripherals {
                    rcc: device.RCC,
                    flash: device.FLASH,
                    debug: device.DBGMCU,
                    watchdog: device.IWDG,
                    crystal_timer: device.TIM11,
                    tool_timer: device.TIM3,
                    usart: device.USART1,
                    dma: device.DMA2,
                };
                let places = Places {
                    buffers: places.buffers,
                    queue: places.queue,
                    controllers: places.controllers,
                    planner: places.planner,
                    session: places.session,
                };
                let own = ($(device.$peripheral),*);
                let Image {
                    locked,
                    meter,
                    outputs,
                    receiver,
                    arrived,
                    idle,
                } = start::start::<$parts>(common, own, cx.core, places);
                let local = Local {
                    meter,
                    outputs,
                    receiver,
                    arrived,
                    idle,
                };
                (Shared { locked }, local)
            }

            #[task(binds = $tick, priority = 3, shared = [locked], local = [meter, outputs])]
            fn tick(mut cx: tick::Context) {
                let local = cx.local;
                cx.shared.locked.lock(|locked| tasks::tick(local.meter, local.outputs, locked));
            }

            #[task(binds = USART1, priority = 2, local = [
                receiver,
                arrived,
                decoder: Decoder<HostMessage> = Decoder::new(),
            ])]
            fn receive(cx: receive::Context) {
                let local = cx.local;
                tasks::receive(local.receiver, local.arrived, local.decoder);
            }

            #[idle(shared = [locked], local = [idle])]
            fn converse(cx: converse::Context) -> ! {
                cx.local.idle.run(cx.shared.locked)
            }

            $($tasks)*
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            <$parts as $crate::board::stm32f405::image::Parts>::end($crate::board::end_cause::EndCause::Panic)
        }

        /// Any fault of the processor. The stack may be at its end, and a push would then lock the core up with the drives
        /// powered: so this takes the power without one, and goes on with a fresh stack.
        #[allow(unsafe_code, reason = "a handler without a prologue is written in assembly")]
        #[unsafe(naked)]
        #[unsafe(export_name = "HardFault")]
        unsafe extern "C" fn hard_fault() -> ! {
            core::arch::naked_asm!(
                $($instruction,)*
                "movw r0, #:lower16:_stack_start",
                "movt r0, #:upper16:_stack_start",
                "msr msp, r0",
                "b {after}",
                $($operand)*
                after = sym after_hard_fault,
            )
        }

        extern "C" fn after_hard_fault() -> ! {
            <$parts as $crate::board::stm32f405::image::Parts>::end($crate::board::end_cause::EndCause::HardFault)
        }

        /// The default handler of exceptions and interrupts without their own.
        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_: i16) {
            <$parts as $crate::board::stm32f405::image::Parts>::end($crate::board::end_cause::EndCause::HardFault)
        }

        /// The crystal failed: the core now runs from the internal oscillator.
        #[cortex_m_rt::exception]
        unsafe fn NonMaskableInt() {
            $crate::board::stm32f405::image::crystal_failed::<$parts>();
        }
    };
}
