#!/usr/bin/env bash
# Builds the production images, for brushed motors, steppers and drives on a CAN bus, from the sources beside this folder, as scripts/firmware.sh does,
# and prints the first one's path in the last line.
set -euo pipefail
cd "$(dirname "$0")/../.."
source scripts/target-dir.sh
source scripts/toolchain.sh
export DEFMT_LOG=${DEFMT_LOG:-info}
cargo build --target "$target" --target-dir "$built/firmware" "${cargo_flags[@]}" \
    --package fivebar-firmware --bin stm32f405 --bin stm32f405_stepper --bin stm32f405_can --features board --profile firmware
echo "$built/firmware/$target/firmware/stm32f405"
