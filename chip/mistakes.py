#!/usr/bin/env python3
"""Seeds mistakes into the board's drivers, one at a time, in a copy of the sources, and runs the
tests on the image built from it. Each must be caught.

    chip/mistakes.py            all of them; the table goes to chip/mistakes.md
    chip/mistakes.py 3 7        those by number, without writing the table
"""
import filecmp
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOARD = "firmware/src/board/"
MISTAKES = [
    ("the converter's trigger: enable instead of update", "pwm.rs", "w.mms().update()", "w.mms().enable()"),
    ("encoders swapped", "encoders.rs", "(self.joint1.count(), self.joint4.count())", "(self.joint4.count(), self.joint1.count())"),
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
]


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, **options)


def seed(copy, file, old, new):
    path = copy / BOARD / file
    text = path.read_text()
    if old not in text:
        raise SystemExit(f"{file} has no '{old}'")
    path.write_text(text.replace(old, new, 1))
    return text


def main():
    chosen = [int(word) for word in sys.argv[1:]] or range(1, len(MISTAKES) + 1)
    copy = ROOT / "target" / "mistakes"
    tracked = run("git", "ls-files", cwd=ROOT).stdout.split("\n")
    for file in filter(None, tracked):
        source, target = ROOT / file, copy / file
        target.parent.mkdir(parents=True, exist_ok=True)
        # A copy gets the present time: with an old one, cargo would not see that it replaces a
        # file in which a mistake was seeded and compiled.
        if source.exists() and not (target.exists() and filecmp.cmp(source, target, shallow=False)):
            shutil.copy(source, target)
    # What is not ours is compiled already.
    for folder in ["target/firmware", "chip/target"]:
        if (ROOT / folder).exists() and not (copy / folder).exists():
            shutil.copytree(ROOT / folder, copy / folder)
    rows, missed = [], []
    sound = run("cargo", "test", "--manifest-path", str(copy / "chip" / "Cargo.toml"))
    if sound.returncode != 0:
        raise SystemExit("without a mistake:\n" + (sound.stdout + sound.stderr)[-2000:])
    for number in chosen:
        name, file, old, new = MISTAKES[number - 1]
        before = seed(copy, file, old, new)
        tests = run("cargo", "test", "--manifest-path", str(copy / "chip" / "Cargo.toml"))
        failed = sorted(set(re.findall(r"^test (\w+) \.\.\. FAILED", tests.stdout, re.M)))
        if failed and "could not compile" not in tests.stdout + tests.stderr:
            found = f"`{failed[0]}`"
            found += f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        else:
            found = "nothing"
            missed.append(name)
            print((tests.stdout + tests.stderr)[-1500:])
        (copy / BOARD / file).write_text(before)
        rows.append(f"| {number} | {name} | `{file}` | {found} |")
        print(rows[-1], flush=True)
    if not sys.argv[1:]:
        table = ["| # | mistake | in | caught by |", "|---|---|---|---|", *rows]
        head = (
            "Mistakes that `chip/mistakes.py` seeds into the board's drivers, and the tests that caught each. A run\n"
            "ends with the first file of tests in which one fails, so others may catch it, too.\n\n"
        )
        (ROOT / "chip" / "mistakes.md").write_text(head + "\n".join(table) + "\n")
    if missed:
        raise SystemExit(f"not caught: {', '.join(missed)}")


main()
