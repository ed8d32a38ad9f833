#!/usr/bin/env bash
# Tests `fivebar bridge` with two real senders, in a fresh virtual environment: Printrun's printcore
# over TCP and grbl-streamer, which counts characters, at the pseudo-terminal.
#
#   scripts/senders.sh              with a simulated arm of each kind of drive
#   scripts/senders.sh --robot leg  with this one
#   scripts/senders.sh --emulated   with the firmware on the emulated board (scripts/firmware.sh)
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

build_program
venv=$built/senders-venv
rm -rf "$venv"
if ! python3 -m venv "$venv"; then
    echo "senders: python3 with its venv module is needed (Debian: apt-get install python3-venv)" >&2
    exit 1
fi
# Without the packages that they name: those of Printrun are for its windows.
"$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
    --requirement tests/senders/requirements.txt
"$venv/bin/python" tests/senders/senders.py "$built/debug/fivebar" "$@"
