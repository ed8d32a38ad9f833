#!/usr/bin/env bash
# Runs a job through OctoPrint, from PyPI, and `fivebar bridge`: a trial by hand, because OctoPrint
# brings a hundred packages along.
#
#   scripts/octoprint.sh              with the simulated arm
#   scripts/octoprint.sh --emulated   with the firmware on the emulated board (scripts/firmware.sh)
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

build_program
venv=$built/octoprint-venv
if ! "$venv/bin/octoprint" --version >/dev/null 2>&1; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check octoprint==1.11.8
fi
exec python3 tests/senders/octoprint.py "$venv/bin/octoprint" "$built/debug/fivebar" "$@"
