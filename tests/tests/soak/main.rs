//! Long runs over random jobs, arms, faults and links, from seeds. `cargo test` runs a short part
//! of each; scripts/soak.sh runs them for as long as it is told. docs/verify/soak.md has the results.

#[cfg(feature = "emulator")]
mod board;
mod jobs;
mod links;
#[cfg(feature = "emulator")]
mod replay;
mod robots;
mod slow_line;
mod watched;

/// The number in an environment variable, or else `default`.
fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| {
        text.parse()
            .unwrap_or_else(|error| panic!("{name}={text}: {error}"))
    })
}
