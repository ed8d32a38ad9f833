#!/usr/bin/env bash
# Builds the kinematics, which need no operating system, for microcontrollers without and with a floating-point unit, and
# for a browser; then runs a leg's control period on an emulated Cortex-M0 and counts it: scripts/targets.sh
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
for target in thumbv6m-none-eabi thumbv7em-none-eabihf thumbv8m.main-none-eabihf riscv32imac-unknown-none-elf wasm32-unknown-unknown; do
    (
        source scripts/toolchain.sh
        CARGO_PROFILE_DEV_OPT_LEVEL=0 cargo build --quiet --package fivebar-kinematics --target "$target" "${cargo_flags[@]}"
    )
done

leg=(--quiet --locked --manifest-path verify/leg_m0/Cargo.toml --target-dir "$built/leg_m0")
cargo fmt --manifest-path verify/leg_m0/Cargo.toml --check
cargo clippy "${leg[@]}" --all-targets -- -D warnings
target=thumbv6m-none-eabi
(
    source scripts/toolchain.sh
    find_emulator
    cargo build "${leg[@]}" --release --features image --target "$target" "${cargo_flags[@]}"
)
most=15000
if [ ! -d "$(rustc --print sysroot)/lib/rustlib/$target" ]; then
    most=30000
    echo "targets: Debian's compiler built the leg's image with a \`core\` of its own: its instructions are not held to 15,000"
fi
LEG_MOST=$most LEG_IMAGE=$built/leg_m0/$target/release/image cargo test "${leg[@]}" -- --nocapture
