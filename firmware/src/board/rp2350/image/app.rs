//! What each image for this chip gives the one body.

/// The whole program of an image with this [`OnChip`](crate::board::rp2350::image::OnChip).
#[macro_export]
macro_rules! rp2350_image {
    ($parts:ty) => {
        $crate::image! {
            registers: [rp235x_pac],
            set_up: (device, lines, commands) => $crate::board::rp2350::image::set_up::<$parts>(device, lines, commands),
            started: |()| (),
            parts: $parts,
            tick: SysTick,
            receive: UART0_IRQ,
            before_stack: [
                // The enables of stepper drivers high.
                "movw r0, #{out_low}",
                "movt r0, #{out_high}",
                "movw r1, #{enables}",
                "str r1, [r0]",
                // The state machines into their reset: no pulse goes on.
                "movw r0, #{reset_low}",
                "movt r0, #{reset_high}",
                "movw r1, #{pio}",
                "str r1, [r0]"
            ],
            operands: [
                out_low = const $crate::board::rp2350::end::OUTPUTS_HIGH & 0xffff,
                out_high = const $crate::board::rp2350::end::OUTPUTS_HIGH >> 16,
                enables = const $crate::board::rp2350::end::ENABLES,
                reset_low = const $crate::board::rp2350::end::RESET_SET & 0xffff,
                reset_high = const $crate::board::rp2350::end::RESET_SET >> 16,
                pio = const $crate::board::rp2350::resets::PIO0,
            ],
            locals: { usb: Option<&'static mut $crate::board::rp2350::usb::Device>, usb_arrived: Arrived },
            tasks: {
                /// The same as `receive` over USB, and what is sent there.
                #[task(binds = USBCTRL_IRQ, priority = 1, local = [
                    usb,
                    usb_arrived,
                    usb_decoder: Decoder<HostMessage> = Decoder::new(),
                ])]
                fn serve_usb(cx: serve_usb::Context) {
                    let local = cx.local;
                    if let Some(usb) = local.usb {
                        usb.serve(|byte| tasks::hear(byte, local.usb_arrived, local.usb_decoder));
                    }
                }
            }
        }
    };
}
