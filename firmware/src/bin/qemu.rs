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

use fivebar_firmware::board::instructions::InstructionCounter;
use fivebar_firmware::session::Board;
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{Command, Controller, Sensed, Settings};

/// The emulated chip: no sensors, no bridges, no flash that keeps anything.
struct Emulated {
    counter: InstructionCounter,
}

impl Board for Emulated {
    fn save(&mut self, _: &Settings) -> Result<(), StorageError> {
        Err(StorageError::Flash)
    }

    fn tick(&mut self, controller: &mut Controller, sensed: &Sensed) -> Option<(Command, u32)> {
        let start = self.counter.now();
        let command = controller.tick(sensed);
        Some((command, self.counter.since(start)))
    }
}

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use super::Emulated;
    use fivebar_firmware::board::instructions::InstructionCounter;
    use fivebar_firmware::board::{clocks, serial};
    use fivebar_firmware::protocol::{Board, Decoder, HostMessage, Identity, Reset};
    use fivebar_firmware::session::Session;
    use fivebar_firmware::{Controller, Planner, Settings};
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
        controller: Controller,
        planner: Planner,
        session: Session,
        board: Emulated,
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
        // Nothing is stored here: the session wants settings before it moves anything.
        let settings = Settings::BENCHTOP;
        let (Ok(controller), Ok(planner)) = (Controller::new(&settings), Planner::new(&settings))
        else {
            panic!("the benchtop arm's settings are sound");
        };
        let identity = Identity::new(Board::Emulated, Reset::Power);
        let local = Local {
            receiver,
            decoder: Decoder::new(),
            arrived,
            orders,
            sender,
            controller,
            planner,
            session: Session::new(identity, &settings, false),
            board: Emulated {
                counter: InstructionCounter::new(cx.core.SYST),
            },
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
                // With no room the order is lost, and the host asks again.
                let _ = arrived.enqueue(message);
            }
        });
    }

    #[idle(local = [orders, sender, controller, planner, session, board])]
    fn talk(cx: talk::Context) -> ! {
        let talk::LocalResources {
            orders,
            sender,
            controller,
            planner,
            session,
            board,
            ..
        } = cx.local;
        loop {
            if let Some(message) = orders.dequeue()
                && let Some(frame) = session.answer(&message, controller, planner, board)
            {
                sender.send(&frame);
            }
            if let Some(frame) = session.telemetry(controller) {
                sender.send(&frame);
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
