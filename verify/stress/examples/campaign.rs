//! A campaign: sessions of one seed after the other until the time is over.
//!
//! ```text
//! cargo run --release -p fivebar-stress --example campaign -- FIRST_SEED SECONDS [LENGTH]
//! ```

use fivebar_stress::{Report, bytes_of, run};
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let first: u64 = arguments.next().unwrap_or("0".into()).parse()?;
    let seconds: u64 = arguments.next().unwrap_or("1".into()).parse()?;
    let length: usize = arguments.next().unwrap_or("600".into()).parse()?;
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut seed, mut ticks, mut broken) = (first, 0_u64, 0_u32);
    let mut sum = Report::default();
    while Instant::now() < end && broken < 20 {
        match std::panic::catch_unwind(|| run(&bytes_of(seed, length))) {
            Ok(Ok(report)) => {
                ticks += u64::from(report.ticks);
                sum = Report::default().plus(sum).plus(report);
                // The sums of a campaign may be too large for its counts.
                sum.ticks = 0;
            }
            Ok(Err(violation)) => {
                let text: String = violation.to_string().chars().take(600).collect();
                println!("seed {seed}: {text}");
                broken += 1;
            }
            Err(_) => {
                println!("seed {seed}: panic");
                broken += 1;
            }
        }
        seed += 1;
    }
    println!(
        "seeds {first} to {}, {length} bytes each: {ticks} ticks, {broken} broken",
        seed - 1
    );
    println!("{sum:#?}");
    Ok(())
}
