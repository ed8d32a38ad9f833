//! The tasks of each image, as the framework wants them, and the handlers that end it.

/// The whole program of an image with these [`Parts`](crate::board::rp2350::image::Parts).
#[macro_export]
macro_rules! rp2350_image {
    ($parts:ty) => {
        #[rtic::app(device = rp235x_pac, peripherals = true)]
        mod app {
            use core::mem::MaybeUninit;
            use heapless::spsc::Queue;
            use $crate::board::cycles::CycleMeter;
            use $crate::board::exchanged::Place;
            use $crate::board::rp2350::image::Locked;
            use $crate::board::rp2350::image::start::{self, Image, Places};
            use $crate::board::rp2350::image::tasks::{self, Hearing, Idle};
            use $crate::board::rp2350::outputs::CommonOutputs;
            use $crate::board::rp2350::serial::Receiver;
            use $crate::board::rp2350::usb;
            use $crate::drives::BlindStepDrives;
            use $crate::planner::Planner;
            use $crate::protocol::HostMessage;
            use $crate::session::{Session, WAITING};

            #[shared]
            struct Shared {
                locked: Locked<$parts>,
            }

            #[local]
            struct Local {
                meter: CycleMeter,
                outputs: CommonOutputs,
                receiver: (Receiver, Hearing),
                usb: (Option<usb::Device>, Hearing),
                idle: Idle,
            }

            #[init(local = [
                queues: [Queue<HostMessage, WAITING>; 2] = [const { Queue::new() }; 2],
                usb_bus: usb::Place = usb::Place::uninit(),
                usb_waiting: usb::Waiting = usb::Waiting::new(),
                controllers: [Place<BlindStepDrives>; 2] = [const { Place::uninit() }; 2],
                planner: Planner = Planner::NONE,
                session: MaybeUninit<Session> = MaybeUninit::uninit(),
            ])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let places = Places {
                    queues: cx.local.queues,
                    usb: cx.local.usb_bus,
                    usb_waiting: cx.local.usb_waiting,
                    controllers: cx.local.controllers,
                    planner: cx.local.planner,
                    session: cx.local.session,
                };
                let Image {
                    locked,
                    meter,
                    outputs,
                    receiver,
                    usb,
                    idle,
                } = start::start::<$parts>(cx.device, cx.core, places);
                let local = Local {
                    meter,
                    outputs,
                    receiver,
                    usb,
                    idle,
                };
                (Shared { locked }, local)
            }

            #[task(binds = SysTick, priority = 4, shared = [locked], local = [meter, outputs])]
            fn tick(mut cx: tick::Context) {
                let local = cx.local;
                cx.shared.locked.lock(|locked| tasks::tick(local.meter, local.outputs, locked));
            }

            #[task(binds = UART0_IRQ, priority = 2, local = [receiver])]
            fn receive(cx: receive::Context) {
                let (receiver, hearing) = cx.local.receiver;
                receiver.drain(|byte| hearing.hear(byte));
            }

            #[task(binds = USBCTRL_IRQ, priority = 1, local = [usb])]
            fn serve_usb(cx: serve_usb::Context) {
                if let (Some(usb), hearing) = cx.local.usb {
                    usb.serve(|byte| hearing.hear(byte));
                }
            }

            #[idle(shared = [locked], local = [idle])]
            fn converse(cx: converse::Context) -> ! {
                cx.local.idle.run(cx.shared.locked)
            }
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            $crate::board::rp2350::end::end($crate::board::end_cause::EndCause::Panic)
        }

        /// Any fault of the processor. The stack may be at its end, and a push would then lock the core up with the drives
        /// powered: so this takes the power and ends the pulses without one, and goes on with a fresh stack.
        #[unsafe(naked)]
        #[unsafe(export_name = "HardFault")]
        unsafe extern "C" fn hard_fault() -> ! {
            core::arch::naked_asm!(
                "movw r0, #{out_low}",
                "movt r0, #{out_high}",
                "movw r1, #{enables}",
                "str r1, [r0]",
                "movw r0, #{reset_low}",
                "movt r0, #{reset_high}",
                "movw r1, #{pio}",
                "str r1, [r0]",
                "movw r0, #:lower16:_stack_start",
                "movt r0, #:upper16:_stack_start",
                "msr msp, r0",
                "b {after}",
                out_low = const $crate::board::rp2350::end::OUTPUTS_HIGH & 0xffff,
                out_high = const $crate::board::rp2350::end::OUTPUTS_HIGH >> 16,
                enables = const $crate::board::rp2350::end::ENABLES,
                reset_low = const $crate::board::rp2350::end::RESET_SET & 0xffff,
                reset_high = const $crate::board::rp2350::end::RESET_SET >> 16,
                pio = const $crate::board::rp2350::resets::PIO0,
                after = sym after_hard_fault,
            )
        }

        extern "C" fn after_hard_fault() -> ! {
            $crate::board::rp2350::end::end($crate::board::end_cause::EndCause::HardFault)
        }

        /// The default handler of exceptions and interrupts without their own.
        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_: i16) {
            $crate::board::rp2350::end::end($crate::board::end_cause::EndCause::HardFault)
        }
    };
}
