#!/usr/bin/env bash
# Checks the bounds of time and stack of the images that scripts/firmware.sh linked, and compares
# them with those committed. First it shows that mistakes put into the images are found.
set -euo pipefail
cd "$(dirname "$0")/.."

images=target/firmware/thumbv7em-none-eabihf/firmware
cargo test --quiet --package fivebar-bounds --features images
cargo run --quiet --package fivebar-bounds -- check "$images"
