#!/usr/bin/env bash
# Checks our output with other programs, from PyPI: MuJoCo must move the exported arm as our plant
# does, and the reader of the MCAP project must find every sample in a run's log.
set -euo pipefail
cd "$(dirname "$0")/.."

venv=target/peers-venv
if ! "$venv/bin/python" -c 'import mujoco, mcap' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet mujoco mcap
fi
out=target/peers
mkdir -p "$out"
fivebar() { cargo run --quiet --release -- "$@"; }
fivebar export mjcf usp_2dof --out "$out/arm.xml"
fivebar export urdf usp_2dof --out "$out/arm.urdf"
fivebar sim sim-harness/scenarios/no_mismatch.toml --robot usp_2dof \
    --out "$out" --log "$out/run.mcap" >"$out/run.log"
"$venv/bin/python" tests/peers/mujoco_motion.py "$out/arm.xml" "$out/arm.urdf" "$out/trace.csv"
"$venv/bin/python" tests/peers/mcap_counts.py "$out/run.mcap" "$out/trace.csv"
