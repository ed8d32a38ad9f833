//! The emulated board's image.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes the code that needs it"
)]

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::debug;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use fivebar_firmware::board::instructions::InstructionCounter;
    use fivebar_firmware::board::{clocks, serial};
    use fivebar_firmware::protocol::*;
    use fivebar_firmware::{Command, Sensed};
    use heapless::spsc::{Consumer, Producer, Queue};
    use stm32f4xx_hal::prelude::*;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: serial::Receiver,
        decoder: Decoder<HostMessage>,
        arrived: Producer<'static, HostMessage>,
        orders: Consumer<'static, HostMessage>,
        sender: serial::Sender,
        counter: InstructionCounter,
    }

    #[init(local = [buffers: serial::Buffers = serial::Buffers::new(), queue: Queue<HostMessage, 4> = Queue::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (mut rcc, _) = clocks::start(cx.device.RCC);
        let pins = cx.device.GPIOB.split(&mut rcc);
        let clocks = rcc.clocks.clone();
        let (receiver, sender) = serial::new(
            &cx.device.USART1,
            &cx.device.DMA2,
            (pins.pb6.into_alternate(), pins.pb7.into_alternate()),
            cx.local.buffers,
            &clocks,
            &mut rcc,
        );
        let (arrived, orders) = cx.local.queue.split();
        let local = Local {
            receiver,
            decoder: Decoder::new(),
            arrived,
            orders,
            sender,
            counter: InstructionCounter::new(cx.core.SYST),
        };
        (Shared {}, local)
    }

    #[task(binds = USART1, priority = 2, local = [receiver, decoder, arrived])]
    fn receive(cx: receive::Context) {
        let receive::LocalResources {
            receiver,
            decoder,
            arrived,
            ..
        } = cx.local;
        receiver.drain(|byte| {
            if let Some(Ok(message)) = decoder.feed(byte) {
                let _ = arrived.enqueue(message);
            }
        });
    }

    #[idle(local = [orders, sender, counter, ticks: u32 = 0])]
    fn session(cx: session::Context) -> ! {
        let session::LocalResources {
            orders,
            sender,
            counter,
            ticks,
            ..
        } = cx.local;
        loop {
            if let Some(message) = orders.dequeue() {
                let start = counter.now();
                let reply = match message.order {
                    Order::Hello { .. } => {
                        Reply::Hello(Identity::new(Board::Emulated, Reset::Power))
                    }
                    Order::Tick(sensed) => {
                        *ticks += 1;
                        Reply::Ticked(Ticked {
                            command: Command::default(),
                            tick: *ticks,
                            mode: Mode::Stopped,
                            fault: 0,
                            angle: [0.0; 2],
                            velocity: [0.0; 2],
                            tool: [0.0; 2],
                            current: [0.0; 2],
                            instructions: counter.since(start),
                        })
                    }
                    _ => Reply::Refused(Refusal::Unsupported),
                };
                if let Some(frame) = encode(&ControllerMessage::Reply {
                    sequence: message.sequence,
                    reply,
                }) {
                    sender.send(&frame);
                }
            }
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
