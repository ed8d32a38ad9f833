//! The instruction counts of the tick and of the library's solutions, against the committed
//! counts and, of the solutions, the budgets.

use std::collections::BTreeMap;
use std::process::Command;

use fivebar_sim::link::Emulator;

/// Counts as last committed.
const COMMITTED: &str = include_str!("../data/instructions.txt");
/// The share by which another compiler's counts may differ from the committed ones.
const TOLERANCE: f64 = 0.1;
/// The most instructions that each function may take.
const BUDGETS: [(&str, u32); 2] = [
    ("forward position", 140),
    ("inverse position, both legs", 180),
];

/// Mean and maximum by function; a peer's line has no maximum.
fn counts(table: &str) -> BTreeMap<String, (u32, Option<u32>)> {
    let row = |line: &str| {
        let (name, numbers) = line.split_at_checked(58)?;
        let mut numbers = numbers.split_whitespace().map(str::parse);
        let mean = numbers.next()?.ok()?;
        let most = numbers.next().transpose().ok()?;
        Some((name.trim().to_owned(), (mean, most)))
    };
    table.lines().filter_map(row).collect()
}

fn counted_now() -> String {
    let output = Command::new("qemu-system-arm")
        .args(["-machine", "netduinoplus2", "-icount", "shift=0"])
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(Emulator::built_image("instructions"))
        .output()
        .expect("qemu-system-arm starts");
    assert!(output.status.success(), "{output:?}");
    // Semihosting prints to standard error.
    let said = [output.stdout, output.stderr].concat();
    String::from_utf8(said).expect("the table is text")
}

#[test]
fn instruction_counts_are_those_committed_and_within_budget() {
    let table = counted_now();
    println!("{table}");
    let (now, committed) = (counts(&table), counts(COMMITTED));
    assert!(now.keys().eq(committed.keys()), "other functions: {table}");
    for (name, (mean, most)) in &now {
        let (committed_mean, committed_most) = committed[name];
        for (now, then) in [(Some(*mean), Some(committed_mean)), (*most, committed_most)] {
            let (now, then) = (f64::from(now.unwrap_or(0)), f64::from(then.unwrap_or(0)));
            assert!(
                (now - then).abs() <= TOLERANCE * then,
                "{name}: {now} instructions, committed {then}; if that is right, \
                 scripts/emulate.sh instructions > tests/data/instructions.txt"
            );
        }
    }
    for (name, budget) in BUDGETS {
        let (_, most) = now[name];
        assert!(most.is_some_and(|most| most <= budget), "{name}: {most:?}");
    }
}
