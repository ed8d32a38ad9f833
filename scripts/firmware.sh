#!/usr/bin/env bash
# Builds the images for the Cortex-M4F: the STM32F405 (stm32f405, stm32f405_stepper for
# steppers, stm32f405_can for drives on a CAN bus), the emulated board (qemu, qemu_stepper, qemu_can) and
# its benchmark. They go into target/firmware, separate from the desktop's artifacts. Then builds
# the crate kinematics by itself, with and without its features: it needs only what the target has.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
source scripts/toolchain.sh

# What the production image logs over the debug probe: "off", "error", "info", …
export DEFMT_LOG=${DEFMT_LOG:-info}

build() { cargo build --target "$target" --target-dir "$built/firmware" "${cargo_flags[@]}" "$@"; }

build --package fivebar-firmware --bins --features board --profile firmware
build --package fivebar-kinematics
build --package fivebar-kinematics --features serde,defmt
