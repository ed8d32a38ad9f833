#!/usr/bin/env bash
# With the production image on the simulated chip: the test of a bare board, then docs/use/bring-up.md, step by step,
# with a hand at the simulated arm; then the first drawings with the images for other motors, and a circle that Python streams
# to each image. ci.sh's step chip installs the CPU emulator that this needs.
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
# ci.sh's step python installs the package.
venv=$built/python-venv
if ! [ -x "$venv/bin/python" ]; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check ./python
fi
"$venv/bin/python" verify/chip/circle.py "$board" "$image"
