#!/usr/bin/env bash
# Builds the image of the RP2350 for hobby servos, with its file for drag and drop, and runs it on the simulated Pico 2 of the
# folder verify/pico.
#
#   scripts/pico.sh          all of it
#   scripts/pico.sh image    the image alone; its path is the last line
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
target=thumbv8m.main-none-eabihf
(
    source scripts/toolchain.sh
    export DEFMT_LOG=${DEFMT_LOG:-info}
    cargo build --target "$target" --target-dir "$built/firmware" "${cargo_flags[@]}" \
        --package fivebar-firmware --bin rp2350_servo --features rp2350 --profile firmware
)
image=$built/firmware/$target/firmware/rp2350_servo
scripts/uf2.py "$image" "$image.uf2"
if [ "${1:-}" != image ]; then
    manifest=(--manifest-path verify/pico/Cargo.toml)
    cargo fmt "${manifest[@]}" --check
    cargo clippy "${manifest[@]}" --all-targets --quiet -- -D warnings
    PICO_IMAGE=$image cargo test "${manifest[@]}"
fi
echo "$image"
