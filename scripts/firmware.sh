#!/usr/bin/env bash
# Builds the images for the Cortex-M4F: the STM32F405 (stm32f405, stm32f405_stepper for
# steppers, stm32f405_can for drives on a CAN bus), the emulated board (qemu, qemu_stepper, qemu_can) and
# its benchmark. They go into target/firmware, separate from the desktop's artifacts. Then builds
# the crate kinematics by itself, with and without its features: it needs only what the target has.
#
#   scripts/firmware.sh                           all of it, for the first board
#   scripts/firmware.sh --board NAME IMAGE...     images for another board (docs/use/wiring.md), into target/firmware-NAME
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
source scripts/toolchain.sh

folder=$built/firmware
# What the production image logs over the debug probe: "off", "error", "info", …
export DEFMT_LOG=${DEFMT_LOG:-info}

build() { cargo build --target "$target" --target-dir "$folder" "${cargo_flags[@]}" "$@"; }

if [ "${1:-}" = --board ]; then
    [ $# -gt 2 ] || { echo "firmware: name a board and an image, such as --board feather_f405 stm32f405_can" >&2; exit 2; }
    export FIVEBAR_BOARD=$2
    folder=$built/firmware-$2
    shift 2
    build --package fivebar-firmware "${@/#/--bin=}" --features board --profile firmware
    exit
fi
[ $# -eq 0 ] || { echo "firmware: unknown: $*" >&2; exit 2; }
build --package fivebar-firmware --bins --features board --profile firmware
build --package fivebar-kinematics
build --package fivebar-kinematics --features serde,defmt
