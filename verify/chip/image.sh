#!/usr/bin/env bash
# Builds the production images, or those that are named, from the sources beside this folder, as scripts/firmware.sh does,
# and prints the first one's path in the last line. With FIVEBAR_CRYSTAL or FIVEBAR_BOARD it builds into a folder of their own.
set -euo pipefail
cd "$(dirname "$0")/../.."
source scripts/target-dir.sh
source scripts/toolchain.sh
export DEFMT_LOG=${DEFMT_LOG:-info}
folder=$built/firmware${FIVEBAR_CRYSTAL:+-$FIVEBAR_CRYSTAL-mhz}${FIVEBAR_BOARD:+-$FIVEBAR_BOARD}
[ $# -gt 0 ] || set -- stm32f405 stm32f405_stepper stm32f405_can
cargo build --target "$target" --target-dir "$folder" "${cargo_flags[@]}" \
    --package fivebar-firmware "${@/#/--bin=}" --features board --profile firmware
echo "$folder/$target/firmware/$1"
