#!/usr/bin/env bash
# Builds the production image from the sources beside this folder, as scripts/firmware.sh does,
# and prints its path in the last line.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/toolchain.sh
export DEFMT_LOG=${DEFMT_LOG:-info}
cargo build --target "$target" --target-dir target/firmware "${cargo_flags[@]}" \
    --package fivebar-firmware --bin stm32f405 --features board --profile firmware
echo "$PWD/target/firmware/$target/firmware/stm32f405"
