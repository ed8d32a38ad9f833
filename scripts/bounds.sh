#!/usr/bin/env bash
# Checks the bounds of time and stack of the images that scripts/firmware.sh linked, and compares
# them with those committed. Then it shows that mistakes put into the images are found, and
# compares how each instruction is read with LLVM's disassembler, where that is installed.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

images=$built/firmware/thumbv7em-none-eabihf/firmware
cargo run --quiet --package fivebar-bounds -- check "$images"
cargo test --quiet --package fivebar-bounds --features images

if command -v llvm-objdump >/dev/null; then
    cargo build --quiet --package fivebar-bounds --example decode
    for image in tick stm32f405 stm32f405_stepper stm32f405_can qemu qemu_stepper qemu_can; do
        "$built/debug/examples/decode" "$images/$image" >"$built/decoded.txt"
        llvm-objdump --disassemble --triple=thumbv7em-none-eabihf --mcpu=cortex-m4 \
            --no-show-raw-insn --no-print-imm-hex "$images/$image" >"$built/disassembled.txt"
        python3 verify/bounds/compare_llvm.py "$built/decoded.txt" "$built/disassembled.txt"
    done
else
    echo "bounds: no llvm-objdump; the decoder was not compared with it" >&2
fi
