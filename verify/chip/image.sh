#!/usr/bin/env bash
# Builds the production images, for brushed motors, steppers and drives on a CAN bus, from the sources beside this folder, as scripts/firmware.sh does,
# and prints the first one's path in the last line. With FIVEBAR_CRYSTAL it builds that one alone, into a folder of its own.
set -euo pipefail
cd "$(dirname "$0")/../.."
source scripts/target-dir.sh
source scripts/toolchain.sh
export DEFMT_LOG=${DEFMT_LOG:-info}
folder=$built/firmware${FIVEBAR_CRYSTAL:+-$FIVEBAR_CRYSTAL-mhz}
images=(--bin stm32f405)
[ -n "${FIVEBAR_CRYSTAL:-}" ] || images+=(--bin stm32f405_stepper --bin stm32f405_can)
cargo build --target "$target" --target-dir "$folder" "${cargo_flags[@]}" \
    --package fivebar-firmware "${images[@]}" --features board --profile firmware
echo "$folder/$target/firmware/stm32f405"
