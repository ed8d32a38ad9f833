//! The tasks of each image, as the framework wants them, and the handlers that end it.

/// The whole program of an image: its chip's crate of registers; how the chip sets [`Hardware`](crate::board::image::Hardware)
/// up, from its peripherals, the place of its lines and what comes over the serial one, and what it does at the end of the start with its clock; the [`Parts`](crate::board::image::Parts); the interrupts of the tick
/// and of the serial line; what the handler of faults does before it has a stack (instructions that need none, and take the power
/// as [`Parts::end`](crate::board::image::Parts::end) does); and tasks of the chip or the drives alone, with what they have.
#[macro_export]
macro_rules! image {
    (
        registers: [$($registers:tt)*],
        set_up: ($device:ident, $lines:ident, $commands:ident) => $set_up:expr,
        started: $started:expr,
        parts: $parts:ty,
        tick: $tick:ident,
        receive: $receive:ident,
        before_stack: [$($instruction:literal),*], operands: [$($operand:tt)*],
        locals: { $($local:ident: $local_type:ty),* },
        tasks: { $($tasks:tt)* }
    ) => {
        #[rtic::app(device = $($registers)*, peripherals = true)]
        mod app {
            use core::mem::MaybeUninit;
            use heapless::spsc::Queue;
            use $crate::board::cycles::CycleMeter;
            use $crate::board::exchanged::Place;
            use $crate::board::image::tasks::{self, Arrived, Brake, Idle};
            use $crate::board::image::{Chip, Image, Locked, Parts, Places, start};
            use $crate::planner::Planner;
            use $crate::protocol::{Decoder, HostMessage};
            use $crate::session::{Session, WAITING};

            type OfChip = <$parts as Parts>::Chip;

            #[shared]
            struct Shared {
                locked: Locked<$parts>,
            }

            #[local]
            struct Local {
                meter: CycleMeter,
                brake: Brake<$parts>,
                receiver: <OfChip as Chip>::Receiver,
                arrived: Arrived,
                idle: Idle<$parts>,
                $($local: $local_type,)*
            }

            #[init(local = [
                queue: Queue<HostMessage, WAITING> = Queue::new(),
                lines: <OfChip as Chip>::LinePlaces = <OfChip as Chip>::NO_LINES,
                controllers: [Place<<$parts as Parts>::Drives>; 2] = [const { Place::uninit() }; 2],
                planner: Planner = Planner::NONE,
                session: MaybeUninit<Session> = MaybeUninit::uninit(),
            ])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let (arrived, $commands) = cx.local.queue.split();
                let ($device, $lines) = (cx.device, cx.local.lines);
                let places = Places {
                    controllers: cx.local.controllers,
                    planner: cx.local.planner,
                    session: cx.local.session,
                };
                let Image {
                    locked,
                    meter,
                    brake,
                    receiver,
                    locals: ($($local,)*),
                    idle,
                } = start::start::<$parts>($set_up, cx.core, places);
                ($started)(idle.clock);
                let local = Local {
                    meter,
                    brake,
                    receiver,
                    arrived,
                    idle,
                    $($local,)*
                };
                (Shared { locked }, local)
            }

            #[task(binds = $tick, priority = 3, shared = [locked], local = [meter, brake])]
            fn tick(mut cx: tick::Context) {
                let local = cx.local;
                cx.shared.locked.lock(|locked| tasks::tick(local.meter, local.brake, locked));
            }

            #[task(binds = $receive, priority = 2, local = [
                receiver,
                arrived,
                decoder: Decoder<HostMessage> = Decoder::new(),
            ])]
            fn receive(cx: receive::Context) {
                let local = cx.local;
                local.receiver.drain(|byte| tasks::hear(byte, local.arrived, local.decoder));
            }

            #[idle(shared = [locked], local = [idle])]
            fn converse(cx: converse::Context) -> ! {
                cx.local.idle.run(cx.shared.locked)
            }

            $($tasks)*
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            <$parts as $crate::board::image::Parts>::end($crate::board::end_cause::EndCause::Panic)
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
            <$parts as $crate::board::image::Parts>::end($crate::board::end_cause::EndCause::HardFault)
        }

        /// The default handler of exceptions and interrupts without their own.
        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_: i16) {
            <$parts as $crate::board::image::Parts>::end($crate::board::end_cause::EndCause::HardFault)
        }
    };
}
