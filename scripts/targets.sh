#!/usr/bin/env bash
# Builds the kinematics, which need no operating system, for microcontrollers without and with a floating-point unit, and
# for a browser: scripts/targets.sh
set -euo pipefail
cd "$(dirname "$0")/.."
for target in thumbv6m-none-eabi thumbv7em-none-eabihf thumbv8m.main-none-eabihf riscv32imac-unknown-none-elf wasm32-unknown-unknown; do
    (
        source scripts/toolchain.sh
        CARGO_PROFILE_DEV_OPT_LEVEL=0 cargo build --quiet --package fivebar-kinematics --target "$target" "${cargo_flags[@]}"
    )
done
