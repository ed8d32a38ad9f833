#!/usr/bin/env bash
# Runs the production image on the simulated STM32F405 of the folder verify/chip: builds the image, the
# simulation and its tests. Installs the CPU emulator's library (Debian: libunicorn-dev) if it is
# missing.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
source scripts/toolchain.sh

if ! [ -e /usr/include/unicorn/unicorn.h ] && ! install_packages libunicorn-dev; then
    echo "chip: no CPU emulator. Install Unicorn 2 with its header and library" \
        "(Debian: apt-get install libunicorn-dev)." >&2
    exit 1
fi
# The image's compiler is not this crate's.
unset RUSTC RUSTC_BOOTSTRAP
manifest=(--manifest-path verify/chip/Cargo.toml)
cargo fmt "${manifest[@]}" --check
cargo clippy "${manifest[@]}" --all-targets --quiet -- -D warnings

# What the tests ran, how long the tick was and how deep the stack, compared with what is committed.
chip_built=${CARGO_TARGET_DIR:-$PWD/verify/chip/target}
export CHIP_FIGURES=$chip_built/figures
rm -rf "$CHIP_FIGURES"
mkdir -p "$CHIP_FIGURES"
cargo test "${manifest[@]}"
image=$(verify/chip/image.sh | tail -n 1)
cargo run --quiet "${manifest[@]}" --bin figures "$image" "$CHIP_FIGURES" verify/chip/figures.txt
