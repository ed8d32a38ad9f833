#!/usr/bin/env bash
# Builds the images of the RP2350 for hobby servos and for steppers, each with its file for drag and drop, checks their bounds
# of time and stack, and runs them on the simulated Pico 2 of the folder verify/pico.
#
#   scripts/pico.sh          all of it
#   scripts/pico.sh image    the images and their bounds; their folder is the last line
#   scripts/pico.sh build    the images alone, without their bounds
#   scripts/pico.sh draw [ROBOT [JOB]]  draws on the simulated Pico 2, by default a half circle, into out/pico.svg
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
target=thumbv8m.main-none-eabihf
(
    source scripts/toolchain.sh
    export DEFMT_LOG=${DEFMT_LOG:-info}
    cargo build --target "$target" --target-dir "$built/firmware" "${cargo_flags[@]}" \
        --package fivebar-firmware --bin rp2350_servo --bin rp2350_stepper --features rp2350 --profile firmware
)
images=$built/firmware/$target/firmware
for image in rp2350_stepper rp2350_servo; do
    firmware/src/board/rp2350/uf2.py "$images/$image" "$images/$image.uf2"
done
if [ "${1:-}" = draw ]; then
    mkdir -p out
    cargo run --manifest-path verify/pico/Cargo.toml -- "$images" "${2:-classroom_servo}" out/pico.svg "${@:3}"
    exit
fi
[ "${1:-}" = build ] || cargo run --quiet --package fivebar-bounds -- check "$images" rp2350
if [ $# -eq 0 ]; then
    cargo test --quiet --package fivebar-bounds --features pico --test pico
    manifest=(--manifest-path verify/pico/Cargo.toml)
    cargo fmt "${manifest[@]}" --check
    cargo clippy "${manifest[@]}" --all-targets --quiet -- -D warnings
    PICO_IMAGES=$images cargo test "${manifest[@]}"
fi
echo "$images"
