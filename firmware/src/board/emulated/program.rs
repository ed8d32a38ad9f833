//! The emulated board: the controller, the planner and the session of the production
//! image, their sensors and drives replaced by frames from the host.
//!
//! The host steps the board in lockstep: each command `Tick` carries one sensor sample, and its
//! reply the actuator command and the number of instructions of the tick. Nothing else advances
//! the controller, so a run depends on its commands only.
//!
//! The crate's root says which `Interface` the image has to its drives, and which `BOARD` it is.
use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use crate::{BOARD, Interface};
    use core::mem::MaybeUninit;
    use fivebar_firmware::board::emulated::instructions::InstructionCounter;
    use fivebar_firmware::board::emulated::lockstep::Lockstep;
    use fivebar_firmware::board::exchanged::{Exchanged, Place};
    use fivebar_firmware::board::stm32f405::{clocks, serial};
    use fivebar_firmware::drives::DriveInterface;
    use fivebar_firmware::planner::Planner;
    use fivebar_firmware::protocol::{Decoder, HostMessage, Identity, Reset};
    use fivebar_firmware::session::{self, Session, WAITING};
    use fivebar_firmware::{ArmController, Settings};
    use heapless::spsc::{Consumer, Producer, Queue};

    type Drives = <Interface as DriveInterface>::Drives;
    type Controller = ArmController<Drives>;
    type Message = HostMessage<<Interface as DriveInterface>::Sample>;

    #[shared]
    struct Shared {
        controller: &'static mut Controller,
    }

    #[local]
    struct Local {
        receiver: serial::Receiver,
        arrived: Producer<'static, Message>,
        commands: Consumer<'static, Message>,
        sender: serial::Sender,
        spare: &'static mut Controller,
        planner: &'static mut Planner,
        session: &'static mut Session,
        lockstep: Lockstep<Interface>,
    }

    #[init(local = [
        buffers: serial::Buffers = serial::Buffers::new(),
        queue: Queue<Message, WAITING> = Queue::new(),
        controllers: [Place<Drives>; 2] = [const { Place::uninit() }; 2],
        place_of_planner: Planner = Planner::NONE,
        place_of_session: MaybeUninit<Session> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        // The emulator has no clock control and runs from the internal oscillator.
        let (mut rcc, clocks) = clocks::start(cx.device.RCC, &cx.device.FLASH, &cx.device.TIM11);
        // Nor has it pins: the line is there by itself.
        let (usart, dma) = (&cx.device.USART1, &cx.device.DMA2);
        let (buffers, bus) = (cx.local.buffers, clocks.source.second_bus());
        let (receiver, sender) = serial::new(usart, dma, buffers, bus, &mut rcc);
        let (arrived, commands) = cx.local.queue.split();
        let identity = Identity::new(BOARD, Reset::Power);
        let Ok(settings) = Settings::BENCHTOP.check() else {
            panic!("the benchtop arm's settings are valid");
        };
        let planner = cx.local.place_of_planner;
        planner.reset(&settings);
        let [controller, spare] = cx.local.controllers;
        let controller = Controller::place(controller, &settings);
        let local = Local {
            receiver,
            arrived,
            commands,
            sender,
            spare: Controller::place(spare, &settings),
            planner,
            session: session::place(cx.local.place_of_session, identity, &settings, false),
            lockstep: Lockstep::new(InstructionCounter::new(cx.core.SYST), &settings),
        };
        (Shared { controller }, local)
    }

    /// From bytes to commands. A command for which the queue has no room is dropped; the host
    /// sends it again.
    #[task(binds = USART1, priority = 2, local = [
        receiver,
        arrived,
        decoder: Decoder<Message> = Decoder::new(),
    ])]
    fn receive(cx: receive::Context) {
        let (decoder, arrived) = (cx.local.decoder, cx.local.arrived);
        cx.local.receiver.drain(|byte| {
            if let Some(Ok(message)) = decoder.feed(byte) {
                let _ = arrived.enqueue(message);
            }
        });
    }

    #[idle(shared = [controller], local = [commands, sender, spare, planner, session, lockstep])]
    fn converse(cx: converse::Context) -> ! {
        let local = cx.local;
        let mut controller = Exchanged {
            lock: cx.shared.controller,
            spare: local.spare,
        };
        loop {
            if let Some(message) = local.commands.dequeue() {
                let answer =
                    local
                        .session
                        .answer(&message, &mut controller, local.planner, local.lockstep);
                if let Some(frame) = answer {
                    local.sender.send(&frame);
                }
            }
            if let Some(frame) = local.session.telemetry(&mut controller, local.planner) {
                local.sender.send(&frame);
            }
            // Sleeps until the next byte. A byte that has come since the check wakes it at once.
            cortex_m::interrupt::free(|_| {
                if !local.commands.ready() {
                    cortex_m::asm::wfi();
                }
            });
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // The board stays silent, and the host reports that.
    loop {
        cortex_m::asm::wfi();
    }
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
