#!/usr/bin/env python3
"""Seeds mistakes into the board's drivers, one at a time, in a copy of the sources, and runs the
tests on the image built from it. Each must be caught.

    verify/chip/mistakes.py            all of them; the table goes to verify/chip/mistakes.md
    verify/chip/mistakes.py 3 7        those by number, without writing the table
    verify/chip/mistakes.py --check    only whether each old text occurs once in its file
"""
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))
import seeded_mistakes

# What, file, and pairs of old and new text.
MISTAKES = [
    ("the converter's trigger: enable instead of update", "pwm.rs", "w.mms().update()", "w.mms().enable()"),
    ("encoders swapped", "encoders.rs", "[timer1.ccr(2).read().bits(), timer4.ccr(2).read().bits()]", "[timer4.ccr(2).read().bits(), timer1.ccr(2).read().bits()]"),
    ("break polarity", "pwm.rs", ".bkp().active_high()", ".bkp().active_low()"),
    ("break input not enabled", "pwm.rs", "w.bke().enabled()", "w.bke().disabled()"),
    ("outputs return by themselves after a break", "pwm.rs", ".aoe().manual()", ".aoe().automatic()"),
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
    ("a home switch without its pull-up", "pins.rs", "c.pc4.into_pull_up_input()", "c.pc4.into_floating_input()"),
    ("currents exchanged", "analog.rs", "const CURRENT1: u8 = 10;\nconst CURRENT4: u8 = 11;", "const CURRENT1: u8 = 11;\nconst CURRENT4: u8 = 10;"),
    ("a sequence without SCAN", "analog.rs", "w.scan().enabled().jeocie()", "w.scan().disabled().jeocie()"),
    ("the converters' prescaler", "analog.rs", ".adcpre()\n                .div4()", ".adcpre()\n                .div2()"),
    ("three half periods to a tick", "pwm.rs", "const HALF_PERIODS_PER_TICK: u8 = 3;", "const HALF_PERIODS_PER_TICK: u8 = 2;"),
    ("edge aligned PWM", "pwm.rs", "w.cms().center_aligned1().arpe()", "w.cms().edge_aligned().arpe()"),
    ("compare registers without preload", "pwm.rs", "w.oc1m().pwm_mode1().oc1pe().enabled();", "w.oc1m().pwm_mode1().oc1pe().disabled();"),
    ("the break's set-up not locked", "pwm.rs", "w.lock().level1()", "w.lock().off()"),
    ("a channel inverted", "pwm.rs", "w.oc3m().pwm_mode1()", "w.oc3m().pwm_mode2()"),
    ("the watchdog's prescaler", "watchdog.rs", "prescaler: 0,\n    reload: 399,", "prescaler: 3,\n    reload: 399,"),
    ("the watchdog not refreshed after a change", "watchdog.rs", "let _ = (0..PATIENCE).any(|_| arrived());\n        self.write_key(REFRESH);", "self.write_key(REFRESH);"),
    ("the watchdog fed whatever hangs", "watchdog.rs", "== Tasks::all().bits()", "!= 0"),
    ("reset flags: the watchdog's not looked at", "post_mortem.rs", "flags.wdgrstf().bit_is_set() || flags.wwdgrstf()", "flags.wwdgrstf().bit_is_set() || flags.wwdgrstf()"),
    ("the brake's sense", "outputs.rs", "(!command.brake).into()", "(command.brake).into()"),
    ("unpower: the wrong half of BSRR", "pwm.rs", "w.bits(SLEEP_PINS << 16)", "w.bits(SLEEP_PINS)"),
    ("the divider does not follow when the crystal dies", "clocks.rs", "    rcc.cfgr().modify(|_, w| w.ppre1().div1().ppre2().div1());\n}\n", "}\n"),
    ("no input filter", "encoders.rs", ".modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());\n        timer4", ".modify(|_, w| w.ic1f().no_filter().ic2f().no_filter());\n        timer4"),
    ("current 4 sampled after current 1, by one converter", "analog.rs",
     "unsafe { w.multi().bits(INJECTED_SIMULTANEOUS) }\n                .adcpre()", "w.adcpre()",
     "w.smp10().cycles28().smp12()", "w.smp10().cycles28().smp11().cycles28().smp12()",
     "w.jl().bits(1).jsq3().bits(CURRENT1)", "w.jl().bits(2).jsq2().bits(CURRENT1).jsq3().bits(CURRENT4)",
     "adc2.cr2().modify(|_, w| w.adon().enabled());", "",
     "self.adc2.jdr1()", "self.adc1.jdr2()",
     "bus_voltage: self.adc1.jdr2()", "bus_voltage: self.adc1.jdr3()"),
    ("a push at the start of the fault handler", "board/stm32f405/image.rs", '"movw r0, #0x0418",', '"push {{r4, lr}}",\n        "movw r0, #0x0418",'),
    ("a wait shorter than the longest frame", "serial.rs", "const PATIENCE: u32 = 150_000;", "const PATIENCE: u32 = 30_000;"),
    ("the PLL's divider P", "clocks.rs", "w.pllp().div2()", "w.pllp().div4()"),
    ("the PLL's divider Q: 84 MHz for 48", "clocks.rs", ".pllq().bits(7)", ".pllq().bits(4)"),
    ("APB1 undivided", "clocks.rs", ".ppre1().div4()", ".ppre1().div1()"),
    ("the slow tick's reload", "clocks.rs", "const SLOW_TICK: u32 = 16_000;", "const SLOW_TICK: u32 = 168_000;"),
    ("the clock failure not acknowledged", "clocks.rs", "    rcc.cir().modify(|_, w| w.cssc().set_bit());\n", ""),
    ("joint 4's filter of three times the length", "encoders.rs", "w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());\n        // SAFETY", "w.ic1f().fdts_div32_n5().ic2f().fdts_div32_n5());\n        // SAFETY"),
    ("a filter on one input of two", "encoders.rs", ".ic2f().fdts_div8_n6());\n        timer4", ".ic2f().no_filter());\n        timer4"),
    ("current 1's sample time of 3 cycles", "analog.rs", "w.smp10().cycles28()", "w.smp10().cycles3()"),
    ("current 4's sample time of 15 cycles", "analog.rs", "w.smp11().cycles28()", "w.smp11().cycles15()"),
    ("the bus's sample time of 3 cycles", "analog.rs", ".smp12().cycles15()", ".smp12().cycles3()"),
    ("the sequence's order: bus first", "analog.rs", ".jsq3().bits(CURRENT1).jsq4().bits(BUS)", ".jsq3().bits(BUS).jsq4().bits(CURRENT1)"),
    ("the trigger's falling edge", "analog.rs", ".rising_edge()", ".falling_edge()"),
    ("the second converter off", "analog.rs", "adc2.cr2().modify(|_, w| w.adon().enabled());", ""),
    ("the converters' flag not cleared", "analog.rs", "w.jeoc().clear_bit().jstrt().clear_bit()", "w.jstrt().clear_bit()"),
    ("the half period off by one", "pwm.rs", "const HALF_PERIOD: u16 = 4200;", "const HALF_PERIOD: u16 = 4199;"),
    ("outputs released when off, with no idle state", "pwm.rs", "w.ossi().idle_level()", "w.ossi().hi_z()"),
    ("a high idle state", "pwm.rs", ".ois3()\n                .reset()", ".ois3()\n                .set_bit()"),
    ("a channel not enabled", "pwm.rs", "w.cc3e().set_bit().cc4e().set_bit()", "w.cc3e().set_bit().cc4e().clear_bit()"),
    ("the break's interrupt not enabled again", "pwm.rs", "if self.timer.sr().read().bif().bit_is_clear() {", "if self.timer.sr().read().bif().bit_is_set() {"),
    ("the tick's rate halved by the repetitions", "pwm.rs", "const HALF_PERIODS_PER_TICK: u8 = 3;", "const HALF_PERIODS_PER_TICK: u8 = 7;"),
    ("a PWM pin's function", "pwm.rs", "    PA10<Alternate<1>>,\n    PA11<Alternate<1>>,\n);", "    PA10<Alternate<1>>,\n    PA11<Alternate<7>>,\n);"),
    ("the break pin's function", "pins.rs", "PB12<Alternate<1>>", "PB12<Alternate<5>>"),
    ("pull-downs for pull-ups", "pins.rs", "pin.internal_resistor(Pull::Up)", "pin.internal_resistor(Pull::Down)"),
    ("the serial input without a pull-up", "pins.rs", "pulled_up(b.pb7.into_alternate())", "b.pb7.into_alternate()"),
    ("an encoder's input without a pull-up", "pins.rs", "pulled_up(b.pb3.into_alternate())", "b.pb3.into_alternate()"),
    ("joint 4's home switch without a pull-up", "pins.rs", "c.pc5.into_pull_up_input()", "c.pc5.into_floating_input()"),
    ("the bridges' duties exchanged", "outputs.rs", "let [duty1, duty4] = command.drives.duty;", "let [duty4, duty1] = command.drives.duty;"),
    ("a stop between two ticks forgotten", "sensors.rs", "self.switches.emergency_stop() || stopped", "self.switches.emergency_stop() && stopped"),
    ("the brown-out level 2.4 V", "brown_out.rs", "const LEVEL_3: u8 = 0;", "const LEVEL_3: u8 = 1;"),
    ("option bytes never programmed", "brown_out.rs", "    flash.optcr().modify(|_, w| w.optstrt().set_bit());\n", ""),
    ("option bytes left unlocked", "brown_out.rs", "    flash.optcr().modify(|_, w| w.optlock().set_bit());\n", ""),
    ("the flags of a reset not cleared", "post_mortem.rs", "    rcc.csr().modify(|_, w| w.rmvf().set_bit());\n", ""),
    ("the notes of panic and fault exchanged", "post_mortem.rs", "EndCause::Panic => PANICKED,\n        EndCause::HardFault => FAULTED,", "EndCause::Panic => FAULTED,\n        EndCause::HardFault => PANICKED,"),
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
    ("no cycle counter", "cycles.rs", "        dwt.enable_cycle_counter();\n", ""),
    ("used and unused stack exchanged", "board/stack.rs", "size - (painted * size_of::<u32>()) as u32", "(painted * size_of::<u32>()) as u32"),
    ("settings of another tick rate used", "services.rs", "bounded.and_then(|()| stored.check())", "bounded.map_or_else(|_| stored.check(), |()| stored.check())"),
    ("priorities of tick and serial line exchanged", "board/stm32f405/image.rs", "binds = ADC, priority = 3", "binds = ADC, priority = 2", "binds = SysTick, priority = 3", "binds = SysTick, priority = 2", "binds = USART1, priority = 2", "binds = USART1, priority = 3"),
    ("joint 1's index input without a pull-up", "pins.rs", "c.pc8.into_pull_up_input()", "c.pc8.into_floating_input()"),
    ("joint 4's index input without a pull-up", "pins.rs", "c.pc9.into_pull_up_input()", "c.pc9.into_floating_input()"),
    ("the index of joint 1 for both", "drivers/inputs.rs", "self.index4.is_high().unwrap_or(true)", "self.index1.is_high().unwrap_or(true)"),
    ("an index that is low in its pulse", "drivers/inputs.rs", "self.index1.is_high().unwrap_or(true)", "self.index1.is_low().unwrap_or(true)"),
    ("the flash accelerator left off", "clocks.rs", "w.prften().set_bit().icen().set_bit().dcen().set_bit()", "w.prften().clear_bit().icen().clear_bit().dcen().clear_bit()"),
    ("no prefetch from the flash", "clocks.rs", "w.prften().set_bit()", "w.prften().clear_bit()"),
    ("the watchdog's long time kept after a save", "watchdog.rs", "        let result = work();\n        self.set(RUNNING);\n        result\n", "        work()\n"),
    ("the watchdog's long time set again after a save", "watchdog.rs", "        self.set(RUNNING);\n        result\n", "        self.set(ERASING);\n        result\n"),
    ("missed ticks rounded down", "cycles.rs", "(elapsed + period / 2) / period", "(elapsed / period)"),
    ("missed ticks rounded up", "cycles.rs", "(elapsed + period / 2) / period", "elapsed.div_ceil(period)"),
    ("the tick itself counted as missed", "cycles.rs", ".saturating_sub(1)", ".saturating_sub(0)"),
    ("the note in RAM not cleared", "post_mortem.rs", "    write(NOTHING);\n", ""),
    ("a software reset without a note taken for power-up", "post_mortem.rs", "_ => Reset::Software,", "_ => Reset::Power,"),
    ("the reset pin taken for power-up", "post_mortem.rs", "        Reset::Pin\n", "        Reset::Power\n"),
    ("a low-power reset taken for power-up", "post_mortem.rs", "flags.lpwrrstf().bit_is_set() {\n        Reset::Unknown", "flags.lpwrrstf().bit_is_set() {\n        Reset::Power"),
    ("the crystal not measured", "clocks.rs", "crystal.is_some_and(crystal::is_right)", "crystal.is_some()"),
    ("a crystal of 7 MHz taken as right", "crystal.rs", "7_600_000..=8_750_000", "6_800_000..=8_750_000"),
    ("too little allowed for the internal oscillator", "crystal.rs", "7_600_000..=8_750_000", "7_600_000..=8_100_000"),
    ("a fault output pulled up", "pins.rs", "fault1: b.pb0.into_pull_down_input()", "fault1: b.pb0.into_pull_up_input()"),
    ("joint 4's fault output without its pull-down", "pins.rs", "fault4: b.pb1.into_pull_down_input()", "fault4: b.pb1.into_floating_input()"),
    ("joint 1's counts latched by another timer", "encoders.rs", "const TIM8_OF_TIM5: u8 = 3;", "const TIM8_OF_TIM5: u8 = 2;"),
    ("the latch's pulse not from TIM1's trigger", "encoders.rs", "w.ts().itr0().sms()", "w.ts().itr1().sms()"),
    ("steps: repetitions that end within a tick", "board/stm32f405/stepper/timers.rs", "const NO_REPETITION_ENDS: u8 = u8::MAX;", "const NO_REPETITION_ENDS: u8 = 3;"),
    ("steps: a compare value without preload", "board/stm32f405/stepper/timers.rs", "w.oc3m().pwm_mode2().oc3pe().enabled()", "w.oc3m().pwm_mode2().oc3pe().disabled()"),
    ("steps: joint 4's direction inverted", "board/stm32f405/stepper/outputs.rs", "set_state(axis4.forwards().into())", "set_state((!axis4.forwards()).into())"),
    ("can: no interrupt of a free mailbox", "board/stm32f405/can/bxcan.rs", "w.bits(MAILBOX_FREE)", "w.bits(0)"),
    ("can: the prescaler of the bit rate", "board/stm32f405/can/bxcan.rs", "| (3 - 1);", "| (4 - 1);"),
    ("can: mailboxes leave by identifier", "board/stm32f405/can/bxcan.rs", "HALT_WITH_CORE | RETURN_BY_ITSELF | IN_ORDER", "HALT_WITH_CORE | RETURN_BY_ITSELF"),
    ("can: no return after a bus off", "board/stm32f405/can/bxcan.rs", "HALT_WITH_CORE | RETURN_BY_ITSELF | IN_ORDER", "HALT_WITH_CORE | IN_ORDER"),
    ("can: an old frame is not taken back", "board/stm32f405/can/bxcan.rs", "w.bits(ABORT)", "w.bits(0)"),
    ("can: a FIFO is not released", "board/stm32f405/can/bxcan.rs", "w.bits(RELEASE)", "w.bits(0)"),
    ("can: the second filter is off", "board/stm32f405/can/bxcan.rs", "can.fa1r().write(|w| w.bits(0b11));", "can.fa1r().write(|w| w.bits(0b01));"),
    ("can: a bus off is not looked at", "board/stm32f405/can/bxcan.rs", "can.esr().read().bits() & BUS_OFF != 0 || ", ""),
    ("can: no last frames", "board/stm32f405/can/stop.rs", "(0..PATIENCE).any(|_| bxcan::put(can, words))", "words"),
    ("can: it stays on the bus without its crystal", "board/stm32f405/can/image.rs", "    bxcan::leave();\n", ""),
    ("can: requests have data", "board/stm32f405/can/bxcan.rs", "None => [id | REMOTE, ", "None => [id, "),
]


def path_of(file):
    return ("firmware/src/" if "/" in file else "firmware/src/board/stm32f405/") + file


def main():
    seeded_mistakes.check_texts(MISTAKES, path_of)
    copy = seeded_mistakes.BUILT / "mistakes"
    seeded_mistakes.copy_sources(copy)
    # What is not ours is compiled already.
    for folder in ["target/firmware", "verify/chip/target"]:
        if (ROOT / folder).exists() and not (copy / folder).exists():
            shutil.copytree(ROOT / folder, copy / folder)

    environment = seeded_mistakes.without_target_dir()

    def test():
        manifest = str(copy / "verify/chip/Cargo.toml")
        done = seeded_mistakes.run("cargo", "test", "--manifest-path", manifest, env=environment)
        return done.returncode, done.stdout + done.stderr

    head = (
        "Mistakes that `verify/chip/mistakes.py` seeds into the board's drivers, and the tests that caught each. A run\n"
        "ends with the first file of tests in which one fails, so others may catch it, too.\n\n"
    )
    seeded_mistakes.check(MISTAKES, copy, path_of, test, ROOT / "verify/chip/mistakes.md", head)


main()
