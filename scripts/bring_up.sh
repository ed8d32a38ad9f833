#!/usr/bin/env bash
# With the production image on the simulated chip: the test of a bare board, then docs/use/bring-up.md, step by step,
# with a hand at the simulated arm; then the first drawings with the images for other motors. ci.sh's step chip installs the CPU emulator that this needs.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

# The image's compiler is not these programs'.
image=$(verify/chip/image.sh | tail -n 1)
cargo build --quiet --manifest-path verify/chip/Cargo.toml --bin board
build_program
board=${CARGO_TARGET_DIR:-$PWD/verify/chip/target}/debug/board
verify/chip/board_test.py "$board" "$image" "$built/debug/fivebar"
verify/chip/bring_up.py "$board" "$image" "$built/debug/fivebar" --until dynamics
verify/chip/first_drawing.py "$board" "$image" "$built/debug/fivebar"
