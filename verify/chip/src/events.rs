//! What happens by itself in the peripherals, and how they act on each other.

use crate::mcu::{Mcu, RAM};
use crate::nvic::SYS_TICK;
use crate::peripherals::gpio::{Mode, Pin};
use crate::peripherals::pwm_timer::Pulses;
use crate::peripherals::reset_cause::ResetCause;
use crate::peripherals::tim1::Output;
use crate::time::Time;
use crate::violation::refuse;
use crate::wiring::Outputs;
use fivebar_firmware::drivers::boards::{self, Peripheral};
use fivebar_kinematics::five_bar::Joint;

/// The address of USART1's data register, for the DMA.
const USART1_DR: u32 = 0x4001_1004;

impl Mcu {
    pub(crate) fn next_due(&self) -> Time {
        self.rcc
            .due()
            .min(self.tim1.due())
            .min(self.pulse.due())
            .min(self.tim8.due())
            .min(self.ticks.due())
            .min(self.can.due())
            .min(self.tool.due())
            .min(self.adc.due())
            .min(self.usart.due())
            .min(self.iwdg.due())
            .min(self.time_of_cycle(self.systick.due()))
            .min(self.wiring.due())
    }

    /// Lets everything happen that is due by `now`.
    pub(crate) fn run_events(&mut self) {
        while self.due <= self.now && self.reset.is_none() {
            let at = self.due;
            self.dispatch(at);
            self.settle(at);
        }
    }

    fn dispatch(&mut self, at: Time) {
        if self.wiring.due() <= at {
            self.wiring.advance(at);
            while let Some(event) = self.wiring.bus_event() {
                self.can.follow(&event, at);
            }
        }
        if self.can.due() <= at {
            self.can.advance(at);
        }
        if self.rcc.due() <= at {
            self.rcc.advance(at);
            self.follow_clocks(at);
        }
        if self.ticks.due() <= at && self.ticks.advance() {
            self.tim1.restart(at);
            self.tim8.restart(at);
        }
        if self.tim8.due() <= at {
            self.tim8.advance(at);
        }
        if self.tim1.due() <= at {
            let events = self.tim1.advance(at);
            if events.trigger {
                self.trigger_converters(at);
            }
        }
        if self.pulse.due() <= at && self.pulse.advance(at) {
            self.latch_encoders(at);
        }
        if self.tool.due() <= at {
            self.tool.advance(at);
        }
        if self.adc.due() <= at {
            self.adc.advance(at);
        }
        if self.usart.due() <= at {
            let [send, receive] = self.options.board.common.serial;
            let connected = [
                self.is_connected(send, Peripheral::Usart1Send),
                self.is_connected(receive, Peripheral::Usart1Receive),
            ];
            self.usart.advance(at, connected);
        }
        if self.iwdg.due() <= at && self.iwdg.advance(at) {
            self.reset = Some(ResetCause::Watchdog);
        }
        let cycle = self.cycle_at(at);
        if self.systick.due() <= cycle && self.systick.advance(cycle) {
            self.nvic.pend(SYS_TICK);
        }
    }

    pub(crate) fn trigger_converters(&mut self, at: Time) {
        let bus = self.bus_period(1);
        self.triggered_at = Some((self.tim1.counter(at).0, at));
        if self.rcc.is_clocked(4, 1) {
            let clock = self.pulse_clock();
            self.pulse.trigger(at, clock);
        }
        let triggered = self.adc.trigger(at, bus);
        for (place, window) in self.note(triggered).unwrap_or_default() {
            let edges = [[0, 1], [2, 3]].map(|[in1, in2]| {
                let ages = |channel| self.tim1.ages_of_edges(channel, window.until);
                let ([a, b], [c, d]) = (ages(in1), ages(in2));
                [a, b, c, d]
            });
            let code = self.wiring.sample(&window, &edges);
            self.adc.store(place, &window, code);
        }
    }

    /// Whether a pin is given to a peripheral, which has a signal there.
    fn is_connected(&self, pin: boards::Pin, peripheral: Peripheral) -> bool {
        let (function, _) = peripheral.places();
        let mode = self.ports[usize::from(pin.port())].mode(pin.number());
        mode == Mode::Alternate(function.into()) && peripheral.is_at(pin)
    }

    /// The level at which the program drives a pin, if it does.
    fn driven(&self, pin: boards::Pin) -> Option<bool> {
        self.ports[usize::from(pin.port())].driven(pin.number())
    }

    /// The level of a pin; a floating one reads low.
    pub(crate) fn level(&mut self, at: Time, pin: Pin) -> bool {
        let port = &self.ports[usize::from(pin.0)];
        let (driven, pull) = (port.driven(pin.1), port.pull(pin.1));
        driven
            .or_else(|| {
                let wire = self.wires.at(pin)?;
                self.wiring.level(at, wire)
            })
            .or(pull)
            .unwrap_or(false)
    }

    /// The levels of a port's pins, as its input register shows them.
    pub(crate) fn levels(&mut self, port: u8) -> u32 {
        let now = self.now;
        (0..16).fold(0, |bits, pin| {
            let analog = self.ports[usize::from(port)].mode(pin) == Mode::Analog;
            let level = !analog && self.level(now, Pin(port, pin));
            bits | u32::from(level) << pin
        })
    }

    /// TIM8 triggers TIM5 and TIM2.
    fn latch_encoders(&mut self, at: Time) {
        for (joint, trigger) in [(Joint::Joint1, 3), (Joint::Joint4, 1)] {
            self.follow_encoder(joint, at);
            if self.encoders[joint].trigger(trigger) {
                self.counts_are_taken(at);
            }
        }
    }

    /// The program gets counts of this time.
    pub(crate) fn counts_are_taken(&mut self, at: Time) {
        if let Some((_, triggered)) = self.triggered_at {
            let after = at - triggered;
            let [least, greatest] = self.latched_after.unwrap_or([after; 2]);
            self.latched_after = Some([least.min(after), greatest.max(after)]);
        }
    }

    /// Counts what the encoders have done up to a time.
    pub(crate) fn follow_encoder(&mut self, joint: Joint, at: Time) {
        let pins = self.options.board.brushed();
        let [a, b] = [pins.encoder1, pins.encoder4][joint];
        let timer = [Peripheral::Tim5, Peripheral::Tim2][joint];
        let connected = self.is_connected(a, timer(1)) && self.is_connected(b, timer(2));
        let clocks = self.encoders[joint].filter_clocks();
        let filter = self.core * self.rcc.timer_cycles(0) * u64::from(clocks);
        let counts = self.wiring.encoder(at, joint, filter);
        self.encoders[joint].follow(counts, connected);
    }

    fn serve_dma(&mut self, at: Time) {
        while self.usart.asks_to_store() {
            let Some(transfer) = self.dma.request(&[2, 5], 4) else {
                break;
            };
            let byte = self.usart.take_data();
            let place = (transfer.memory - RAM) as usize;
            match self.ram.get_mut(place) {
                Some(slot) if transfer.to_memory && transfer.peripheral == USART1_DR => {
                    *slot = byte;
                }
                _ => {
                    self.note::<()>(refuse(
                        "DMA2",
                        transfer.memory,
                        "not a transfer from USART1",
                    ));
                }
            }
        }
        while self.usart.asks_to_load() {
            let Some(transfer) = self.dma.request(&[7], 4) else {
                break;
            };
            let place = (transfer.memory - RAM) as usize;
            let byte = self.ram.get(place).copied();
            let sent = match byte {
                Some(byte) if !transfer.to_memory && transfer.peripheral == USART1_DR => {
                    self.usart.put_data(byte, at)
                }
                _ => refuse("DMA2", transfer.memory, "not a transfer to USART1"),
            };
            if self.note(sent).is_none() {
                break;
            }
        }
    }

    /// Lets levels, requests and interrupt lines follow what has changed.
    pub(crate) fn settle(&mut self, at: Time) {
        let board = self.options.board;
        let (stop, stop4) = (board.common.stop, board.stepper().stop4);
        let stops = self.is_connected(stop, Peripheral::Tim1Break) && self.level(at, stop.into());
        self.tim1.set_break(stops, self.rcc.nmi());
        let stops = self.is_connected(stop4, Peripheral::Tim8Break) && self.level(at, stop4.into());
        self.tim8.set_break(stops, self.rcc.nmi());
        let [receive, send] = board.can().bus;
        let connected = self.is_connected(receive, Peripheral::Can1Receive)
            && self.is_connected(send, Peripheral::Can1Send);
        self.can.connect(connected);
        if let Some(frame) = self.can.changed_offer() {
            self.wiring.offer(at, frame);
        }
        self.serve_dma(at);
        let outputs = self.drives(at);
        if outputs != self.outputs {
            self.outputs = outputs;
            self.wiring.drive(at, &outputs);
        }
        let mut lines = 0;
        for (interrupt, level) in [
            (4, self.flash.interrupt()),
            (18, self.adc.interrupt()),
            (19, self.can.interrupt()),
            (24, self.tim1.break_interrupt()),
            (25, self.tim1.update_interrupt()),
            (
                if self.is_on_bus() { 50 } else { 30 },
                self.ticks.interrupt(),
            ),
            (37, self.usart.interrupt()),
            (43, self.tim8.break_interrupt()),
            (58, self.dma.interrupt(2)),
            (68, self.dma.interrupt(5)),
            (70, self.dma.interrupt(7)),
        ] {
            lines |= u128::from(level) << interrupt;
        }
        self.nvic.set_lines(lines);
        if self.nvic.reset_requested {
            self.reset.get_or_insert(ResetCause::Software);
        }
        self.due = self.next_due();
    }

    fn drives(&self, at: Time) -> Outputs {
        let board = self.options.board;
        let (brushed, stepper) = (board.brushed(), board.stepper());
        let [step1, step4] = stepper.step;
        let step1 = self.is_connected(step1, Peripheral::Tim1(1));
        let step4 = self.is_connected(step4, Peripheral::Tim8);
        let steps = [
            step1.then(|| self.tim1.level(0, at)),
            step4.then(|| self.tim8.level(2, at)),
        ];
        let channel = |channel: usize| {
            let signal = Peripheral::Tim1(channel as u8 + 1);
            match self.is_connected(brushed.bridges[channel], signal) {
                true => self.tim1.output(channel),
                false => Output::Released,
            }
        };
        Outputs {
            pwm: [0, 1, 2, 3].map(channel),
            sleep: match self.has_steppers() {
                true => stepper.enable.map(|pin| self.driven(pin)),
                false => brushed.sleep.map(|pin| self.driven(pin)),
            },
            steps: match self.has_steppers() {
                true => steps.map(Option::flatten),
                false => [None; 2],
            },
            direction: stepper.direction.map(|pin| self.driven(pin)),
            brake: self.driven(board.common.brake),
            tool: match self.is_connected(board.common.tool, Peripheral::Tim3) {
                true => self.tool.pulses(1),
                false => Pulses::Released,
            },
        }
    }
}
