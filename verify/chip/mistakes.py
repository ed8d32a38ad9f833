#!/usr/bin/env python3
"""Seeds mistakes into the board's drivers, one at a time, in a copy of the sources, and runs the
tests on the images built from it. Each must be caught. The table is verify/chip/mistakes.csv.

    verify/chip/mistakes.py            all of them
    verify/chip/mistakes.py 3 7        those by number
    verify/chip/mistakes.py --check    only whether each old text occurs once in its file, and what the page says
"""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))
import seeded_mistakes

CHIP = pathlib.Path(__file__).resolve().parent
TABLE = CHIP / "mistakes.csv"
# What, file, and pairs of old and new text.
MISTAKES = [
    ("the converter's trigger: enable instead of update", "board/stm32f405/brushed/pwm.rs", "w.mms().update()", "w.mms().enable()"),
    ("encoders swapped", "board/stm32f405/brushed/encoders.rs", "[timer1.ccr(2).read().bits(), timer4.ccr(2).read().bits()]", "[timer4.ccr(2).read().bits(), timer1.ccr(2).read().bits()]"),
    ("break polarity", "board/stm32f405/brushed/pwm.rs", ".bkp().active_high()", ".bkp().active_low()"),
    ("break input not enabled", "board/stm32f405/brushed/pwm.rs", "w.bke().enabled()", "w.bke().disabled()"),
    ("outputs return by themselves after a break", "board/stm32f405/brushed/pwm.rs", ".aoe().manual()", ".aoe().automatic()"),
    ("LOCK stays set for an erase", "storage.rs", "w.lock()\n                        .clear_bit()", "w.lock()\n                        .set_bit()"),
    ("the key register's keys exchanged", "storage.rs", "[0x4567_0123, 0xcdef_89ab]", "[0xcdef_89ab, 0x4567_0123]"),
    ("the first sector's number", "storage.rs", "const FIRST: u8 = 8;", "const FIRST: u8 = 7;"),
    ("the data cache not emptied after an erase", "storage.rs", "        self.empty_data_cache();\n", ""),
    ("receive stream", "serial.rs", "const RECEIVE_STREAM: usize = 2;", "const RECEIVE_STREAM: usize = 3;"),
    ("DMA channel", "serial.rs", "const CHANNEL: u8 = 4;", "const CHANNEL: u8 = 5;"),
    ("baud rate", "serial.rs", "const BAUD: u32 = 1_000_000;", "const BAUD: u32 = 921_600;"),
    ("the receive ring not circular", "serial.rs", ".circ()\n                .enabled()", ".circ()\n                .disabled()"),
    ("APB2's prescaler", "clocks.rs", ".ppre2().div2()", ".ppre2().div4()"),
    ("flash wait states", "clocks.rs", "w.latency().bits(5);", "w.latency().bits(4);"),
    ("no clock security system", "clocks.rs", "w.csson().on()", "w.csson().off()"),
    ("a home switch without its pull-up", "pins.rs", "(gpio::input(Resistor::Up), gpio::input(Resistor::Up))", "(gpio::input(Resistor::None), gpio::input(Resistor::Up))"),
    ("currents exchanged", "board/stm32f405/brushed/analog.rs", "const CURRENT1: u8 = 10;\nconst CURRENT4: u8 = 11;", "const CURRENT1: u8 = 11;\nconst CURRENT4: u8 = 10;"),
    ("a sequence without SCAN", "board/stm32f405/brushed/analog.rs", "w.scan().enabled().jeocie()", "w.scan().disabled().jeocie()"),
    ("the converters' prescaler", "board/stm32f405/brushed/analog.rs", ".adcpre()\n                .div4()", ".adcpre()\n                .div2()"),
    ("three half periods to a tick", "board/stm32f405/brushed/pwm.rs", "const HALF_PERIODS_PER_TICK: u8 = 3;", "const HALF_PERIODS_PER_TICK: u8 = 2;"),
    ("edge aligned PWM", "board/stm32f405/brushed/pwm.rs", "w.cms().center_aligned1().arpe()", "w.cms().edge_aligned().arpe()"),
    ("compare registers without preload", "board/stm32f405/brushed/pwm.rs", "w.oc1m().pwm_mode1().oc1pe().enabled();", "w.oc1m().pwm_mode1().oc1pe().disabled();"),
    ("the break's set-up not locked", "board/stm32f405/brushed/pwm.rs", "w.lock().level1()", "w.lock().off()"),
    ("a channel inverted", "board/stm32f405/brushed/pwm.rs", "w.oc3m().pwm_mode1()", "w.oc3m().pwm_mode2()"),
    ("the watchdog's prescaler", "watchdog.rs", "prescaler: 0,\n    reload: 399,", "prescaler: 3,\n    reload: 399,"),
    ("the watchdog not refreshed after a change", "watchdog.rs", "let _ = (0..TIMEOUT_READS).any(|_| arrived());\n        self.write_key(REFRESH);", "self.write_key(REFRESH);"),
    ("the watchdog fed whatever hangs", "board/alive.rs", "== Tasks::all().bits()", "!= 0"),
    ("reset flags: the watchdog's not looked at", "post_mortem.rs", "flags.wdgrstf().bit_is_set() || flags.wwdgrstf()", "flags.wwdgrstf().bit_is_set() || flags.wwdgrstf()"),
    ("the brake's sense", "board/image/tasks.rs", "PinState::from(!command.brake)", "PinState::from(command.brake)"),
    ("unpower: the wrong half of BSRR", "board/stm32f405/brushed/pwm.rs", "w.bits(SLEEP_PINS << 16)", "w.bits(SLEEP_PINS)"),
    ("the divider does not follow when the crystal dies", "clocks.rs", "    rcc.cfgr().modify(|_, w| w.ppre1().div1().ppre2().div1());\n}\n", "}\n"),
    ("no input filter", "board/stm32f405/brushed/encoders.rs", ".modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());\n        timer4", ".modify(|_, w| w.ic1f().no_filter().ic2f().no_filter());\n        timer4"),
    ("current 4 sampled after current 1, by one converter", "board/stm32f405/brushed/analog.rs",
     "unsafe { w.multi().bits(INJECTED_SIMULTANEOUS) }\n                .adcpre()", "w.adcpre()",
     "w.smp10().cycles28().smp12()", "w.smp10().cycles28().smp11().cycles28().smp12()",
     "w.jl().bits(1).jsq3().bits(CURRENT1)", "w.jl().bits(2).jsq2().bits(CURRENT1).jsq3().bits(CURRENT4)",
     "adc2.cr2().modify(|_, w| w.adon().enabled());", "",
     "self.adc2.jdr1()", "self.adc1.jdr2()",
     "bus_voltage: self.adc1.jdr2()", "bus_voltage: self.adc1.jdr3()"),
    ("a push at the start of the fault handler", "board/stm32f405/brushed/image.rs", '"movw r0, #{low_half}",', '"push {{r4, lr}}",\n        "movw r0, #{low_half}",'),
    ("a wait shorter than the longest frame", "serial.rs", "const TIMEOUT_READS: u32 = 150_000;", "const TIMEOUT_READS: u32 = 30_000;"),
    ("the PLL's divider P", "clocks.rs", "w.pllp().div2()", "w.pllp().div4()"),
    ("the PLL's divider Q: 84 MHz for 48", "clocks.rs", ".pllq().bits(7)", ".pllq().bits(4)"),
    ("APB1 undivided", "clocks.rs", ".ppre1().div4()", ".ppre1().div1()"),
    ("the slow tick's reload", "clocks.rs", "const SLOW_TICK: u32 = 16_000;", "const SLOW_TICK: u32 = 168_000;"),
    ("the clock failure not acknowledged", "clocks.rs", "    rcc.cir().write(|w| w.cssc().set_bit());\n", ""),
    ("joint 4's filter of three times the length", "board/stm32f405/brushed/encoders.rs", "w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());\n        // SAFETY", "w.ic1f().fdts_div32_n5().ic2f().fdts_div32_n5());\n        // SAFETY"),
    ("a filter on one input of two", "board/stm32f405/brushed/encoders.rs", ".ic2f().fdts_div8_n6());\n        timer4", ".ic2f().no_filter());\n        timer4"),
    ("current 1's sample time of 3 cycles", "board/stm32f405/brushed/analog.rs", "w.smp10().cycles28()", "w.smp10().cycles3()"),
    ("current 4's sample time of 15 cycles", "board/stm32f405/brushed/analog.rs", "w.smp11().cycles28()", "w.smp11().cycles15()"),
    ("the bus's sample time of 3 cycles", "board/stm32f405/brushed/analog.rs", ".smp12().cycles15()", ".smp12().cycles3()"),
    ("the sequence's order: bus first", "board/stm32f405/brushed/analog.rs", ".jsq3().bits(CURRENT1).jsq4().bits(BUS)", ".jsq3().bits(BUS).jsq4().bits(CURRENT1)"),
    ("the trigger's falling edge", "board/stm32f405/brushed/analog.rs", ".rising_edge()", ".falling_edge()"),
    ("the second converter off", "board/stm32f405/brushed/analog.rs", "adc2.cr2().modify(|_, w| w.adon().enabled());", ""),
    ("the converters' flag not cleared", "board/stm32f405/brushed/analog.rs", "w.jeoc().clear_bit().jstrt().clear_bit()", "w.jstrt().clear_bit()"),
    ("the half period off by one", "board/stm32f405/brushed/pwm.rs", "const HALF_PERIOD: u16 = 4200;", "const HALF_PERIOD: u16 = 4199;"),
    ("outputs released when off, with no idle state", "board/stm32f405/brushed/pwm.rs", "w.ossi().idle_level()", "w.ossi().hi_z()"),
    ("a high idle state", "board/stm32f405/brushed/pwm.rs", ".ois3()\n                .reset()", ".ois3()\n                .set_bit()"),
    ("a channel not enabled", "board/stm32f405/brushed/pwm.rs", "w.cc3e().set_bit().cc4e().set_bit()", "w.cc3e().set_bit().cc4e().clear_bit()"),
    ("the break's interrupt not enabled again", "board/stm32f405/brushed/pwm.rs", "if self.timer.sr().read().bif().bit_is_clear() {", "if self.timer.sr().read().bif().bit_is_set() {"),
    ("the tick's rate halved by the repetitions", "board/stm32f405/brushed/pwm.rs", "const HALF_PERIODS_PER_TICK: u8 = 3;", "const HALF_PERIODS_PER_TICK: u8 = 7;"),
    ("a PWM pin's function", "board/stm32f405/brushed/pins.rs", "gpio::connect(pin, Peripheral::Tim1(channel), Resistor::None);", "gpio::connect(pin, if channel == 4 { Peripheral::Usart1Send } else { Peripheral::Tim1(channel) }, Resistor::None);"),
    ("the break pin's function", "pins.rs", "gpio::connect(PINS.stop, Peripheral::Tim1Break, Resistor::Up)", "gpio::connect(PINS.stop, Peripheral::Tim8Break, Resistor::Up)"),
    ("pull-downs for pull-ups", "gpio.rs", "(resistor as u32) << at", "((3 - resistor as u32) % 3) << at"),
    ("the serial input without a pull-up", "pins.rs", "Peripheral::Usart1Receive, Resistor::Up", "Peripheral::Usart1Receive, Resistor::None"),
    ("an encoder's input without a pull-up", "board/stm32f405/brushed/pins.rs", "Peripheral::Tim2(channel), Resistor::Up", "Peripheral::Tim2(channel), Resistor::None"),
    ("joint 4's home switch without a pull-up", "pins.rs", "(gpio::input(Resistor::Up), gpio::input(Resistor::Up))", "(gpio::input(Resistor::Up), gpio::input(Resistor::None))"),
    ("the bridges' duties exchanged", "board/stm32f405/brushed/outputs.rs", "let [duty1, duty4] = command.drives.duty;", "let [duty4, duty1] = command.drives.duty;"),
    ("a stop between two ticks forgotten", "drivers/inputs.rs", "self.emergency_stop() || stopped", "self.emergency_stop() && stopped"),
    ("the brown-out level 2.4 V", "brown_out.rs", "const LEVEL_3: u8 = 0;", "const LEVEL_3: u8 = 1;"),
    ("option bytes never programmed", "brown_out.rs", "    flash.optcr().modify(|_, w| w.optstrt().set_bit());\n", ""),
    ("option bytes left unlocked", "brown_out.rs", "    flash.optcr().modify(|_, w| w.optlock().set_bit());\n", ""),
    ("the flags of a reset not cleared", "post_mortem.rs", "    rcc.csr().modify(|_, w| w.rmvf().set_bit());\n", ""),
    ("the notes of panic and fault exchanged", "board/end_cause.rs", "PANIC => Reset::Panic,\n            HARD_FAULT => Reset::HardFault,", "PANIC => Reset::HardFault,\n            HARD_FAULT => Reset::Panic,"),
    ("power-up taken for a brown-out", "post_mortem.rs", "flags.porrstf().bit_is_set()", "flags.porrstf().bit_is_set() && !flags.borrstf().bit_is_set()"),
    ("the watchdog's reload", "watchdog.rs", "    reload: 399,", "    reload: 3999,"),
    ("too short a time for an erase", "watchdog.rs", "    prescaler: 6,", "    prescaler: 4,"),
    ("a sector too few", "storage.rs", "const SECTORS: usize = 4;", "const SECTORS: usize = 2;"),
    ("words written as half words", "storage.rs", ".write(|w| w.lock().clear_bit().psize().psize32().pg()", ".write(|w| w.lock().clear_bit().psize().psize16().pg()"),
    ("the flash not locked again", "storage.rs", "w.psize().psize32().lock().set_bit()", "w.psize().psize32().lock().clear_bit()"),
    ("the error of a protected sector not looked at", "storage.rs", "status.wrperr().bit_is_set()\n            || ", ""),
    ("old errors of the flash not cleared", "storage.rs", "w.operr().clear_bit_by_one().wrperr().clear_bit_by_one();", "w.operr().clear_bit_by_one();"),
    ("the receive ring's length", "serial.rs", "w.ndt().bits(RING as u16)", "w.ndt().bits(RING as u16 / 2)"),
    ("received bytes all to one place", "serial.rs", "w.minc()\n                .incremented()\n                .circ()", "w.minc()\n                .fixed()\n                .circ()"),
    ("the sending stream", "serial.rs", "const SEND_STREAM: usize = 7;", "const SEND_STREAM: usize = 6;"),
    ("the sending stream's flags not cleared", "serial.rs", "w.ctcif7().clear().chtif7().clear();", "w.chtif7().clear();"),
    ("the idle line's flag not cleared", "serial.rs", "                    let _ = usart.dr().read();\n", ""),
    ("no cycle counter", "board/cycles.rs", "        dwt.enable_cycle_counter();\n", ""),
    ("used and unused stack exchanged", "board/stack.rs", "size - (painted * size_of::<u32>()) as u32", "(painted * size_of::<u32>()) as u32"),
    ("settings of another tick rate used", "board/stored.rs", "bounded.and_then(|()| stored.check())", "bounded.map_or_else(|_| stored.check(), |()| stored.check())"),
    ("priorities of tick and serial line exchanged", "board/image/app.rs", "binds = $tick, priority = 3", "binds = $tick, priority = 2", "binds = $receive, priority = 2", "binds = $receive, priority = 3"),
    ("joint 1's index input without a pull-up", "board/stm32f405/brushed/pins.rs", "index1: gpio::input(Resistor::Up)", "index1: gpio::input(Resistor::None)"),
    ("joint 4's index input without a pull-up", "board/stm32f405/brushed/pins.rs", "index4: gpio::input(Resistor::Up)", "index4: gpio::input(Resistor::None)"),
    ("the index of joint 1 for both", "drivers/inputs.rs", "self.index4.is_high().unwrap_or(true)", "self.index1.is_high().unwrap_or(true)"),
    ("an index that is low in its pulse", "drivers/inputs.rs", "self.index1.is_high().unwrap_or(true)", "self.index1.is_low().unwrap_or(true)"),
    ("the flash accelerator left off", "clocks.rs", "w.prften().set_bit().icen().set_bit().dcen().set_bit()", "w.prften().clear_bit().icen().clear_bit().dcen().clear_bit()"),
    ("no prefetch from the flash", "clocks.rs", "w.prften().set_bit()", "w.prften().clear_bit()"),
    ("the watchdog's long time kept after a save", "watchdog.rs", "        let result = work();\n        self.set(RUNNING);\n        result\n", "        work()\n"),
    ("the watchdog's long time set again after a save", "watchdog.rs", "        self.set(RUNNING);\n        result\n", "        self.set(ERASING);\n        result\n"),
    ("missed ticks rounded down", "board/cycles.rs", "(elapsed + period / 2) / period", "(elapsed / period)"),
    ("missed ticks rounded up", "board/cycles.rs", "(elapsed + period / 2) / period", "elapsed.div_ceil(period)"),
    ("the tick itself counted as missed", "board/cycles.rs", ".saturating_sub(1)", ".saturating_sub(0)"),
    ("the note in RAM not cleared", "post_mortem.rs", "    write(NOTHING);\n", ""),
    ("a software reset without a note taken for power-up", "board/end_cause.rs", "_ => Reset::Software,", "_ => Reset::Power,"),
    ("the reset pin taken for power-up", "post_mortem.rs", "        Reset::Pin\n", "        Reset::Power\n"),
    ("a low-power reset taken for power-up", "post_mortem.rs", "flags.lpwrrstf().bit_is_set() {\n        Reset::Unknown", "flags.lpwrrstf().bit_is_set() {\n        Reset::Power"),
    ("the crystal not measured", "clocks.rs", "crystal.and_then(Crystal::measured)", "crystal.map(|_| Crystal::TAKEN[0])"),
    ("a crystal of 7 MHz taken as right", "drivers/crystal.rs", "nominal / 20 * 19", "nominal / 20 * 17"),
    ("too little allowed for the internal oscillator", "drivers/crystal.rs", "nominal / 32 * 35", "nominal / 80 * 81"),
    ("a fault output pulled up", "board/stm32f405/brushed/pins.rs", "fault1: gpio::input(Resistor::Down)", "fault1: gpio::input(Resistor::Up)"),
    ("joint 4's fault output without its pull-down", "board/stm32f405/brushed/pins.rs", "fault4: gpio::input(Resistor::Down)", "fault4: gpio::input(Resistor::None)"),
    ("joint 1's counts latched by another timer", "board/stm32f405/brushed/encoders.rs", "const TIM8_OF_TIM5: u8 = 3;", "const TIM8_OF_TIM5: u8 = 2;"),
    ("the latch's pulse not from TIM1's trigger", "board/stm32f405/brushed/encoders.rs", "w.ts().itr0().sms()", "w.ts().itr1().sms()"),
    ("steps: repetitions that end within a tick", "board/stm32f405/stepper/timers.rs", "const NO_REPETITION_ENDS: u8 = u8::MAX;", "const NO_REPETITION_ENDS: u8 = 3;"),
    ("steps: a compare value without preload", "board/stm32f405/stepper/timers.rs", "w.oc3m().pwm_mode2().oc3pe().enabled()", "w.oc3m().pwm_mode2().oc3pe().disabled()"),
    ("steps: joint 4's direction inverted", "board/stm32f405/stepper/outputs.rs", "self.direction4.write(axis4.forwards())", "self.direction4.write(!axis4.forwards())"),
    ("can: no interrupt of a free mailbox", "board/stm32f405/can/bxcan.rs", "w.bits(MAILBOX_FREE)", "w.bits(0)"),
    ("can: the prescaler of the bit rate", "board/stm32f405/can/bxcan.rs", "| (3 - 1);", "| (4 - 1);"),
    ("can: mailboxes leave by identifier", "board/stm32f405/can/bxcan.rs", "HALT_WITH_CORE | RETURN_BY_ITSELF | IN_ORDER", "HALT_WITH_CORE | RETURN_BY_ITSELF"),
    ("can: no return after a bus off", "board/stm32f405/can/bxcan.rs", "HALT_WITH_CORE | RETURN_BY_ITSELF | IN_ORDER", "HALT_WITH_CORE | IN_ORDER"),
    ("can: an old frame is not taken back", "board/stm32f405/can/bxcan.rs", "w.bits(ABORT)", "w.bits(0)"),
    ("can: a FIFO is not released", "board/stm32f405/can/bxcan.rs", "w.bits(RELEASE)", "w.bits(0)"),
    ("can: the second filter is off", "board/stm32f405/can/bxcan.rs", "can.fa1r().write(|w| w.bits(0b11));", "can.fa1r().write(|w| w.bits(0b01));"),
    ("can: a bus off is not looked at", "board/stm32f405/can/bxcan.rs", "can.esr().read().bits() & BUS_OFF != 0 || ", ""),
    ("can: no last frames", "board/stm32f405/can/stop.rs", "(0..TIMEOUT_READS).any(|_| bxcan::put(can, words))", "words"),
    ("can: it stays on the bus without its crystal", "board/stm32f405/can/mod.rs", "        bxcan::leave();\n", ""),
    ("can: requests have data", "board/stm32f405/can/bxcan.rs", "None => [id | REMOTE, ", "None => [id, "),
    ("steps: the NMI leaves the motors their power", "board/stm32f405/stepper/mod.rs", "    timers::unpower_until_reset();\n", ""),
    ("steps: a hard fault leaves motor 4 its power", "board/stm32f405/stepper/image.rs", "enable = const ENABLE_PINS,", "enable = const ENABLE_PINS & 0x4000,"),
    ("steps: driver 4 has power before the first tick", "board/stm32f405/stepper/pins.rs", "(gpio::output(true), gpio::output(true))", "(gpio::output(true), gpio::output(false))"),
    ("can: the tick does not read the host's emergency stop", "board/image/tasks.rs", "let stopped = STOP.swap(false, Ordering::Relaxed);", "let stopped = false;"),
    ("can: drive 1 without its torque", "drives/can/link.rs", "[torque1, ahead1, omega1]", "[0.0 * torque1, ahead1, omega1]"),
    ("can: an error of drive 4 is not seen while it wakes up", "drives/torque.rs", " || health4 == DriveHealth::Error {", " {"),
    ("steps: motor 4 keeps its power in a panic", "board/stm32f405/stepper/timers.rs", " | 1 << PINS.enable[1].number();", ";"),
    ("steps: break inputs not enabled", "board/stm32f405/stepper/timers.rs", "w.bke().enabled()", "w.bke().disabled()"),
    ("steps: the second contact without a pull-up", "board/stm32f405/stepper/pins.rs", "Peripheral::Tim8Break, Resistor::Up", "Peripheral::Tim8Break, Resistor::None"),
    ("steps: motor 4's pulses are not connected", "board/stm32f405/stepper/timers.rs", "            self.timer4.bdtr().modify(|_, w| w.moe().bit(on));\n", ""),
    ("steps: a second contact that is held is not read", "board/stm32f405/stepper/mod.rs", " || self.outputs.timers.is_held()", ""),
    ("steps: the break's interrupt not enabled again", "board/stm32f405/stepper/timers.rs", "                timer.dier().modify(|_, w| w.bie().set_bit());\n            } else", "                timer.dier().modify(|_, w| w.bie().clear_bit());\n            } else"),
    ("steps: motor 4's step pulses repeat in a halt", "halt.rs", ".dbg_tim8_stop().set_bit()", ".dbg_tim8_stop().clear_bit()"),
    ("a debugger's stop of the watchdog stays", "watchdog.rs", "            halt::keep_watchdog_counting();\n", ""),
    ("the duties repeat in a halt", "halt.rs", ".dbg_tim1_stop().set_bit()", ".dbg_tim1_stop().clear_bit()"),
    ("the NMI leaves the bridges awake", "board/stm32f405/brushed/mod.rs", "    pwm::unpower_until_reset();\n", ""),
    ("a hard fault leaves bridge 4 awake", "board/stm32f405/brushed/image.rs", "sleep = const SLEEP_PINS,", "sleep = const SLEEP_PINS & 0x4000,"),
    ("the tool's output is not set", "board/image/tasks.rs", "        <P::Chip as Chip>::Tool::set(command.tool);\n", ""),
    ("bridge 4 is awake before the first tick", "board/stm32f405/brushed/pins.rs", "(gpio::output(false), gpio::output(false))", "(gpio::output(false), gpio::output(true))"),
    ("can: an unexpected interrupt ends nothing", "board/image/app.rs", "unsafe fn DefaultHandler(_: i16) {\n            <$parts as $crate::board::image::Parts>::end($crate::board::end_cause::EndCause::HardFault)", "unsafe fn DefaultHandler(_: i16) {\n            loop {}"),
    ("can: drive 4 without its last frame", "board/stm32f405/can/stop.rs", "    for place in &STOPS {", "    for place in &STOPS[..1] {"),
    ("can: the emergency stop without a pull-up", "board/stm32f405/can/pins.rs", "emergency_stop: gpio::input(Resistor::Up)", "emergency_stop: gpio::input(Resistor::None)"),
    ("can: ticks at half their rate", "board/stm32f405/can/timer.rs", "const TICK_COUNTS: u32 = TICK_CYCLES / 2;", "const TICK_COUNTS: u32 = TICK_CYCLES;"),
    ("can: no power over the bus", "board/stm32f405/can/bus.rs", "link.send(command.enable, &command.drives, frames)", "link.send([command.enable[0]; 2].map(|on| on && command.brake), &command.drives, frames)"),
    ("a tick that the NMI interrupts wakes the bridges again", "board/stm32f405/brushed/mod.rs", "    pwm::unpower_until_reset();", "    pwm::unpower();"),
    ("steps: a tick that the NMI interrupts gives power again", "board/stm32f405/stepper/mod.rs", "    timers::unpower_until_reset();", "    timers::unpower();"),
    ("the NMI keeps bridge 1 alone asleep", "board/stm32f405/brushed/pwm.rs", " | 3 << (2 * PINS.sleep[1].number());", ";"),
    ("steps: the NMI keeps motor 4 alone without power", "board/stm32f405/stepper/timers.rs", "3 << (2 * PINS.enable[0].number()) | 3 << (2 *", "3 << (2 *"),
    ("a clock failure during the start is forgotten", "board/stm32f405/image/start.rs", "    if !crystal_runs {\n        CLOCK_FAILED.store(true, Ordering::Relaxed);\n    }\n", "    CLOCK_FAILED.store(!crystal_runs, Ordering::Relaxed);\n"),
    ("steps: what the NMI set during the start is set up again", "board/stm32f405/image/start.rs", "    if crystal_runs && CLOCK_FAILED", "    if !crystal_runs && CLOCK_FAILED"),
    ("the clock's failure is not told to the controller", "board/image/tasks.rs", "controller.tick_without_clock(sample)", "controller.tick(sample)"),
    ("steps: the ticks' timer goes on in a halt", "halt.rs", ".dbg_tim4_stop().set_bit()", ".dbg_tim4_stop().clear_bit()"),
    ("steps: a press of the second contact is not told", "board/stm32f405/stepper/image.rs", "            if timers::take_break4() {\n                STOP.store(true, Ordering::Relaxed);\n            }\n", "            let _ = timers::take_break4();\n"),
    ("can: ticks do not keep the watchdog quiet", "board/image/tasks.rs", "    Tasks::TICK.advanced();\n", ""),
    ("can: the session feeds the watchdog of ticks that stop", "board/image/tasks.rs", "            Tasks::SESSION.advanced();\n", "            Tasks::all().advanced();\n"),
    ("the host's emergency stop waits for the session", "board/image/tasks.rs", "            STOP.store(true, Ordering::Relaxed);\n        }\n        let _ = arrived", "        }\n        let _ = arrived"),
    ("a panic leaves the bridges awake until its reset", "board/stm32f405/brushed/mod.rs", "        pwm::unpower();\n", ""),
    ("steps: an unexpected interrupt leaves power until its reset", "board/stm32f405/stepper/mod.rs", "        timers::unpower();\n", ""),
    ("can: the brake is released before the first tick", "pins.rs", "let brake = gpio::output(false);", "let brake = gpio::output(true);"),
    ("can: answers of drive 1 alone are taken", "board/stm32f405/can/bxcan.rs", "[0, 1].into_iter().zip(answers)", "[0, 1].into_iter().zip([answers[0]; 2])"),
    ("steps: motor 1 has the direction of motor 4", "board/stm32f405/stepper/outputs.rs", "self.direction1.write(axis1.forwards())", "self.direction1.write(axis4.forwards())"),
    ("steps: what the timers have taken is exchanged", "board/stm32f405/stepper/timers.rs", "[&*self.timer1, &*self.timer4].map(|timer| timer.sr()", "[&*self.timer4, &*self.timer1].map(|timer| timer.sr()"),
    ("a trip of the break is not told", "board/stm32f405/brushed/image.rs", "if PwmTimer::take_break() {", "if !PwmTimer::take_break() {"),
    ("steps: break polarity", "board/stm32f405/stepper/timers.rs", ".bkp().active_high()", ".bkp().active_low()"),
    ("can: the drives of new settings have no last frames", "board/stm32f405/can/bus.rs", "        stop::prepare(setup.stops());\n", ""),
]


def path_of(file):
    return ("firmware/src/" if "/" in file else "firmware/src/board/stm32f405/") + file


def main():
    seeded_mistakes.check_texts(MISTAKES, path_of, TABLE, TABLE.with_suffix(".md"))
    copy = seeded_mistakes.BUILT / "mistakes"
    seeded_mistakes.copy_sources(copy)
    copied = seeded_mistakes.without_target_dir()

    def test(_, near):
        built = seeded_mistakes.run(str(copy / "verify/chip/image.sh"), env=copied)
        if built.returncode != 0:
            return built.returncode, built.stdout + built.stderr
        # The tests are those of the sources here, which have no mistake.
        folder = str(pathlib.Path(built.stdout.splitlines()[-1]).parent)
        command = ["cargo", "test", "--manifest-path", str(CHIP / "Cargo.toml"), near]
        done = seeded_mistakes.run(*filter(None, command), env={**os.environ, "CHIP_IMAGES": folder})
        return done.returncode, done.stdout + done.stderr

    seeded_mistakes.check(MISTAKES, copy, path_of, test, TABLE)


main()
