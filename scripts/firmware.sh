#!/usr/bin/env bash
# Builds the images for the Cortex-M4F: the STM32F405 (stm32f405), the emulated board (qemu) and
# its benchmark. They go into target/firmware, separate from the desktop's artifacts.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/toolchain.sh

cargo build --package fivebar-firmware --bins --features board --profile firmware \
    --target "$target" --target-dir target/firmware "${cargo_flags[@]}"
