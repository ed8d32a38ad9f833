#!/usr/bin/env bash
# Runs an image of scripts/firmware.sh on the emulated board: scripts/emulate.sh instructions
#
# With -icount shift=0 each instruction takes 1 ns of virtual time, so that counts repeat.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
exec timeout 120 qemu-system-arm -machine netduinoplus2 -display none -monitor none \
    -icount shift=0 -semihosting-config enable=on,target=native -serial stdio \
    -kernel "$built/firmware/thumbv7em-none-eabihf/firmware/$1" </dev/null
